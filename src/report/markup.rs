//! The tiny neutral markup in which headings, captions and axis labels are written once and shown right everywhere.
//!
//! | written | meaning |
//! |---|---|
//! | `F_{620}`, `F_620` | subscript: what stands in the braces, else the letters and digits that follow |
//! | `m^{-1}`, `R^2` | superscript, likewise |
//! | `\v{x}` | a variable, set in italics |
//! | `\_`, `\^`, `\{`, `\}`, `\\` | the character itself |
//!
//! The usual variables need no `\v`: a lone Latin letter with a subscript (`b_1`, `l_{rest}`), a lone small Greek letter (`ε*`,
//! `2σ`, but not the prefix in `µm`), and `R` before a square. Units and words stay upright.

/// Where a piece stands relative to the base line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Script {
    /// On the base line.
    Base,
    /// Subscript.
    Sub,
    /// Superscript.
    Super,
}

/// A stretch of text in one style.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// The characters, free of markup.
    pub text: String,
    /// Base line, subscript or superscript.
    pub script: Script,
    /// A variable: set in italics.
    pub italic: bool,
}

/// Splits markup into pieces; anything that is no markup is taken as it stands.
pub fn parse(markup: &str) -> Vec<Piece> {
    let mut parser = Parser {
        rest: markup,
        pieces: Vec::new(),
    };
    while let Some(c) = parser.next() {
        match c {
            '\\' => parser.escape(),
            '_' => parser.script(Script::Sub, '_'),
            '^' => parser.script(Script::Super, '^'),
            other => parser.push(other, Script::Base, false),
        }
    }
    with_variables(parser.pieces)
}

/// The text without styles (`F_{620}` as `F_620`), for CSV files, identifiers and screen readers.
pub fn plain(markup: &str) -> String {
    let mut text = String::new();
    for piece in parse(markup) {
        match piece.script {
            Script::Base => {}
            Script::Sub => text.push('_'),
            Script::Super => text.push('^'),
        }
        text.push_str(&piece.text);
    }
    text
}

/// Pieces of which so many characters are kept, half of them at each end, with an ellipsis in the middle.
pub fn without_middle(pieces: &[Piece], kept: usize) -> Vec<Piece> {
    let count: usize = pieces.iter().map(|p| p.text.chars().count()).sum();
    let (head, tail) = (kept.div_ceil(2), count - kept / 2);
    let mut shortened: Vec<Piece> = Vec::new();
    let mut at = 0;
    let mut parted = false;
    for piece in pieces {
        let mut text = String::new();
        for c in piece.text.chars() {
            if at < head || at >= tail {
                text.push(c);
            } else if !parted {
                parted = true;
                text.push('…');
            }
            at += 1;
        }
        if !text.is_empty() {
            shortened.push(Piece {
                text,
                ..piece.clone()
            });
        }
    }
    shortened
}

struct Parser<'a> {
    rest: &'a str,
    pieces: Vec<Piece>,
}

impl Parser<'_> {
    fn next(&mut self) -> Option<char> {
        let c = self.rest.chars().next()?;
        self.rest = &self.rest[c.len_utf8()..];
        Some(c)
    }

    fn push(&mut self, c: char, script: Script, italic: bool) {
        match self.pieces.last_mut() {
            Some(last) if last.script == script && last.italic == italic => last.text.push(c),
            _ => self.pieces.push(Piece {
                text: c.to_string(),
                script,
                italic,
            }),
        }
    }

    /// After a backslash: `\v{...}` or a character taken literally.
    fn escape(&mut self) {
        if let Some(inner) = self.rest.strip_prefix('v').and_then(braced) {
            self.rest = &self.rest[1 + inner.len() + 2..];
            inner
                .chars()
                .for_each(|c| self.push(c, Script::Base, c.is_alphabetic()));
        } else if let Some(c) = self.next() {
            self.push(c, Script::Base, false);
        }
    }

    /// After `_` or `^`: braces, else the letters and digits that follow, else the character itself.
    fn script(&mut self, script: Script, sign: char) {
        let (inner, length) = match braced(self.rest) {
            Some(inner) => (inner, inner.len() + 2),
            None => {
                let end = self
                    .rest
                    .find(|c: char| !c.is_alphanumeric())
                    .unwrap_or(self.rest.len());
                (&self.rest[..end], end)
            }
        };
        self.rest = &self.rest[length..];
        if length == 0 {
            self.push(sign, Script::Base, false);
        }
        inner.chars().for_each(|c| self.push(c, script, false));
    }
}

/// The inside of the braces with which `text` begins.
fn braced(text: &str) -> Option<&str> {
    text.strip_prefix('{')?
        .split_once('}')
        .map(|(inner, _)| inner)
}

/// Sets the letters that are variables by convention in italics.
fn with_variables(pieces: Vec<Piece>) -> Vec<Piece> {
    let mut parser = Parser {
        rest: "",
        pieces: Vec::new(),
    };
    for (i, piece) in pieces.iter().enumerate() {
        let letters: Vec<char> = piece.text.chars().collect();
        let follower = pieces.get(i + 1);
        for (k, &c) in letters.iter().enumerate() {
            let before = k.checked_sub(1).map(|k| letters[k]);
            let after = letters.get(k + 1).copied();
            let variable = piece.script == Script::Base && is_variable(c, before, after, follower);
            parser.push(c, piece.script, piece.italic || variable);
        }
    }
    parser.pieces
}

fn is_variable(
    c: char,
    before: Option<char>,
    after: Option<char>,
    follower: Option<&Piece>,
) -> bool {
    let letter = |c: Option<char>| c.is_some_and(char::is_alphabetic);
    let script = follower
        .filter(|_| after.is_none())
        .map(|f| (f.script, f.text.as_str()));
    if ('α'..='ω').contains(&c) {
        return !letter(before) && !letter(after);
    }
    if !c.is_alphabetic() || before.is_some_and(char::is_alphanumeric) {
        return false;
    }
    let subscript = matches!(script, Some((Script::Sub, _)));
    let square = after == Some('²') || matches!(script, Some((Script::Super, "2")));
    subscript || (c == 'R' && square)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pieces as `text`, `_text`, `^text`, with italics between slashes.
    fn show(markup: &str) -> String {
        let piece = |p: Piece| {
            let sign = match p.script {
                Script::Base => "",
                Script::Sub => "_",
                Script::Super => "^",
            };
            if p.italic {
                format!("{sign}/{}/", p.text)
            } else {
                format!("{sign}{}", p.text)
            }
        };
        parse(markup)
            .into_iter()
            .map(piece)
            .collect::<Vec<_>>()
            .join("|")
    }

    #[test]
    fn symbols_of_the_field_are_recognised() {
        assert_eq!(show("F_{620} (N)"), "/F/|_620| (N)");
        assert_eq!(show("l_rest"), "/l/|_rest");
        assert_eq!(show("b_1"), "/b/|_1");
        assert_eq!(show("ε*"), "/ε/|*");
        assert_eq!(show("Adj. R²"), "Adj. |/R/|²");
        assert_eq!(show("R^2"), "/R/|^2");
        assert_eq!(show("2σ, 5 μm, ΔF"), "2|/σ/|, 5 μm, ΔF");
        assert_eq!(show("N/m^2, 1/m, RMSE"), "N/m|^2|, 1/m, RMSE");
        assert_eq!(show(r"\v{p} = 3"), "/p/| = 3");
    }

    #[test]
    fn escapes_and_stray_signs_are_literal() {
        assert_eq!(show(r"a\_b \\ \{x\}"), r"a_b \ {x}");
        assert_eq!(show("_ and ^ alone"), "_ and ^ alone");
        assert_eq!(show("open F_{6"), "open F_{6");
    }

    #[test]
    fn plain_text_keeps_the_reading() {
        assert_eq!(plain("F_{620} (N)"), "F_620 (N)");
        assert_eq!(plain("m^{-1}"), "m^-1");
    }
}
