//! Columns in the text of the page: numbers as base64 of 32-bit floats, what has few different values as a list of these with a code each.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// Most different numbers that are listed; with more, each stands for itself.
const MOST_LEVELS: usize = 256;

/// A column as the page reads it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Encoded {
    /// Little-endian 32-bit floats; NaN where there is none.
    Floats {
        /// In base64.
        f32: String,
    },
    /// Different values and which of them each reading has.
    Levels {
        /// The values, rising; null for none.
        levels: Vec<Value>,
        /// Little-endian 16-bit places in `levels`, in base64.
        u16: String,
    },
}

/// Bytes as base64.
pub fn base64(bytes: &[u8]) -> String {
    STANDARD.encode(bytes)
}

/// Little-endian 16-bit numbers as base64.
pub fn words(words: impl Iterator<Item = u16>) -> String {
    base64(&words.flat_map(u16::to_le_bytes).collect::<Vec<u8>>())
}

/// A column of numbers; NaN is none.
pub fn numbers(values: &[f64]) -> Encoded {
    let mut levels: BTreeMap<u64, u16> = BTreeMap::new();
    for x in values {
        levels.insert(key(*x), 0);
        if levels.len() > MOST_LEVELS.min(values.len() / 4) {
            let floats = values.iter().flat_map(|x| single(*x).to_le_bytes());
            return Encoded::Floats {
                f32: base64(&floats.collect::<Vec<u8>>()),
            };
        }
    }
    for (place, code) in levels.values_mut().enumerate() {
        *code = place as u16;
    }
    let codes = values.iter().map(|x| levels[&key(*x)]);
    let of_key = |k: &u64| serde_json::Number::from_f64(number(*k));
    Encoded::Levels {
        u16: words(codes),
        levels: levels.keys().map(|k| of_key(k).into()).collect(),
    }
}

/// A column of texts.
pub fn texts<'a>(values: &[Option<&'a str>]) -> Encoded {
    let mut levels: BTreeMap<Option<&'a str>, u16> = values.iter().map(|t| (*t, 0)).collect();
    for (place, code) in levels.values_mut().enumerate() {
        *code = place as u16;
    }
    Encoded::Levels {
        u16: words(values.iter().map(|t| levels[t])),
        levels: levels.keys().map(|t| (*t).into()).collect(),
    }
}

/// One NaN has the bytes of any other.
fn single(x: f64) -> f32 {
    if x.is_nan() { f32::NAN } else { x as f32 }
}

/// A number that sorts as the float does, NaN last.
fn key(x: f64) -> u64 {
    let bits = if x.is_nan() { f64::NAN } else { x + 0.0 }.to_bits();
    if bits >> 63 == 0 {
        bits | (1 << 63)
    } else {
        !bits
    }
}

fn number(key: u64) -> f64 {
    f64::from_bits(if key >> 63 == 1 {
        key & !(1 << 63)
    } else {
        !key
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_numbers_are_listed_in_order_and_many_stand_for_themselves() {
        let few: Vec<f64> = (0..40).map(|k| [3.5, -1.0, f64::NAN, 0.0][k % 4]).collect();
        let Encoded::Levels { levels, u16 } = numbers(&few) else {
            panic!("listed");
        };
        assert_eq!(
            levels,
            [Value::from(-1.0), 0.0.into(), 3.5.into(), Value::Null]
        );
        let bytes = STANDARD.decode(u16).unwrap();
        assert_eq!(bytes[..8], [2, 0, 0, 0, 3, 0, 1, 0]);
        let many: Vec<f64> = (0..40).map(f64::from).collect();
        let Encoded::Floats { f32 } = numbers(&many) else {
            panic!("each for itself");
        };
        assert_eq!(STANDARD.decode(f32).unwrap()[4..8], 1.0_f32.to_le_bytes());
    }
}
