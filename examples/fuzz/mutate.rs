//! Mutations of real inputs: what transmission, editors, other programs and malice do to a file. Everything follows from a seed.

/// A reproducible source of numbers (SplitMix64, Steele et al. 2014).
pub struct Draw(u64);

impl Draw {
    /// The source for one case of one target.
    pub fn of_case(seed: u64, case: u64) -> Self {
        let mut draw = Self(seed ^ case.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        draw.next();
        draw
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `end`; 0 where `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        if end == 0 {
            return 0;
        }
        (self.next() % end as u64) as usize
    }

    /// One of the items.
    pub fn of<'a, T: ?Sized>(&mut self, items: &[&'a T]) -> &'a T {
        items[self.below(items.len())]
    }
}

/// Texts that readers trip over: numbers at their limits, names of nothing, brackets, line ends, encodings.
const TOKENS: &[&[u8]] = &[
    b"nan",
    b"NaN",
    b"inf",
    b"-inf",
    b"1e308",
    b"-1e308",
    b"1e999",
    b"1e-999",
    b"-0",
    b"0x10",
    b"0b1",
    b"9223372036854775807",
    b"-9223372036854775808",
    b"18446744073709551616",
    b"1_000",
    b"1,5",
    b"1.234,5",
    b"\"",
    b"\"\"\"",
    b"'",
    b"[",
    b"]",
    b"[[",
    b"]]",
    b"{",
    b"}",
    b"=",
    b"#",
    b",",
    b";",
    b"\t",
    b"\n",
    b"\r",
    b"\r\n",
    b"\0",
    b"\xff\xfe",
    b"\xef\xbb\xbf",
    b"\xc3\x28",
    "\u{202e}".as_bytes(),
    "ε".as_bytes(),
    b"\\u0000",
    b"\\",
    b"true",
    b"[a.b.c]",
    b"a.b = 1",
    b"\n[[log]]\n",
    b"\n[columns]\n",
    b"values = {}",
    b"index = -1",
    b"index = 99999",
    b"gain = 0",
    b"1979-05-27T07:32:00Z",
    b"<c r=\"ZZZ9999999\">",
    b"&#0;",
    b"&amp;",
    b"<!DOCTYPE a [<!ENTITY b \"c\">]>",
    b"<v>1e999</v>",
    b"t=\"s\"",
    b"r=\"A0\"",
    b"]]>",
    b"<row>",
];

/// Whole numbers that counts and lengths are set to, in every width and order.
const EXTREMES: &[u64] = &[
    0,
    1,
    2,
    0x7f,
    0x80,
    0xff,
    0x7fff,
    0x8000,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7fff_ffff_ffff_ffff,
    0xffff_ffff_ffff_ffff,
    0x1_0000_0000,
    1 << 40,
];

/// Mutations of one case at most; half of the cases have one only, which gets past the first look.
const MOST: usize = 8;

/// The input after some mutations; `other` is an input of the same kind, for parts to be taken from. Half of the cases keep every byte in
/// its place: the tables of binary formats point to places, and would all point beside them.
pub fn mutated(draw: &mut Draw, input: &[u8], other: &[u8]) -> Vec<u8> {
    let mut bytes = input.to_vec();
    let in_place = draw.below(2) == 0;
    let mutations = match draw.below(2) {
        0 => 1,
        _ => 1 + draw.below(MOST),
    };
    for _ in 0..mutations {
        if in_place {
            overwrite(draw, &mut bytes);
        } else {
            change(draw, &mut bytes, other);
        }
    }
    bytes
}

fn overwrite(draw: &mut Draw, bytes: &mut [u8]) {
    let at = draw.below(bytes.len() + 1);
    match draw.below(3) {
        0 => extreme(draw, bytes, at),
        _ => flip(draw, bytes),
    }
}

fn change(draw: &mut Draw, bytes: &mut Vec<u8>, other: &[u8]) {
    let at = draw.below(bytes.len() + 1);
    match draw.below(9) {
        0 => overwrite(draw, bytes),
        1 => insert(bytes, at, draw.of(TOKENS)),
        2 => replace_token(draw, bytes, at),
        3 => bytes.truncate(at),
        4 => remove(draw, bytes, at),
        5 => repeat(draw, bytes, at),
        6 => splice(draw, bytes, at, other),
        7 => nest(draw, bytes, at),
        _ => shuffle_lines(draw, bytes),
    }
}

fn flip(draw: &mut Draw, bytes: &mut [u8]) {
    let at = draw.below(bytes.len());
    if let Some(byte) = bytes.get_mut(at) {
        *byte ^= 1 << draw.below(8);
    }
}

fn insert(bytes: &mut Vec<u8>, at: usize, token: &[u8]) {
    bytes.splice(at..at, token.iter().copied());
}

/// A word or number, from here to the next separator, becomes another.
fn replace_token(draw: &mut Draw, bytes: &mut Vec<u8>, at: usize) {
    let is_end = |b: &u8| b",;\t\n =<>\"".contains(b);
    let length = bytes[at..].iter().position(is_end).unwrap_or(0);
    bytes.splice(at..at + length, draw.of(TOKENS).iter().copied());
}

/// A count or length becomes an extreme one.
fn extreme(draw: &mut Draw, bytes: &mut [u8], at: usize) {
    let value = EXTREMES[draw.below(EXTREMES.len())];
    let (little, big) = (value.to_le_bytes(), value.to_be_bytes());
    let width = [1, 2, 4, 8][draw.below(4)];
    let written = match draw.below(2) {
        0 => &little[..width],
        _ => &big[8 - width..],
    };
    if let Some(place) = bytes.get_mut(at..at + width) {
        place.copy_from_slice(written);
    }
}

fn remove(draw: &mut Draw, bytes: &mut Vec<u8>, at: usize) {
    let end = at + draw.below((bytes.len() - at).min(64) + 1);
    bytes.drain(at..end);
}

/// A part stands there many times: long lines, many rows, many columns.
fn repeat(draw: &mut Draw, bytes: &mut Vec<u8>, at: usize) {
    let end = at + draw.below((bytes.len() - at).min(32) + 1);
    let part = bytes[at..end].repeat(1 << draw.below(10));
    insert(bytes, at, &part);
}

fn splice(draw: &mut Draw, bytes: &mut Vec<u8>, at: usize, other: &[u8]) {
    let from = draw.below(other.len());
    let to = from + draw.below(other.len() - from);
    insert(bytes, at, &other[from..to]);
}

/// Brackets within brackets.
fn nest(draw: &mut Draw, bytes: &mut Vec<u8>, at: usize) {
    let depth = 1 << draw.below(12);
    let bracket: &[u8] = draw.of(&[&b"["[..], b"{a=", b"[[", b"<a>", b"("]);
    insert(bytes, at, &bracket.repeat(depth));
}

fn shuffle_lines(draw: &mut Draw, bytes: &mut Vec<u8>) {
    let mut lines: Vec<&[u8]> = bytes.split(|b| *b == b'\n').collect();
    let (a, b) = (draw.below(lines.len()), draw.below(lines.len()));
    lines.swap(a, b);
    *bytes = lines.join(&b'\n');
}
