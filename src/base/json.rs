//! JSON in which a missing number is `null`.
//!
//! A number that is not finite is written as `null`, for JSON has no other word for it. serde takes such a `null` for a mistake when
//! it reads a number back; [`from_slice`] takes it for NaN, so that what a stage has left behind can be read whatever it holds.

use crate::error::{self, Error};
use serde::de::value::{MapDeserializer, SeqDeserializer};
use serde::de::{DeserializeOwned, Deserializer, IntoDeserializer, Visitor};
use serde_json::Value;

/// Reads a value; `null` in the place of a number is NaN, in the place of an option none.
///
/// # Errors
/// The bytes are no JSON, or JSON of something else.
pub fn from_slice<T: DeserializeOwned>(bytes: &[u8]) -> error::Result<T> {
    let value: Value = serde_json::from_slice(bytes).map_err(Error::internal)?;
    T::deserialize(Lenient(value)).map_err(Error::internal)
}

/// A value in which `null` may stand for a number, at any depth.
struct Lenient(Value);

impl<'de> IntoDeserializer<'de, serde_json::Error> for Lenient {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> Deserializer<'de> for Lenient {
    type Error = serde_json::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        match self.0 {
            Value::Array(items) => {
                visitor.visit_seq(SeqDeserializer::new(items.into_iter().map(Lenient)))
            }
            Value::Object(fields) => {
                let fields = fields.into_iter().map(|(key, value)| (key, Lenient(value)));
                visitor.visit_map(MapDeserializer::new(fields))
            }
            other => other.deserialize_any(visitor),
        }
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        match self.0 {
            Value::Null => visitor.visit_f64(f64::NAN),
            number => number.deserialize_f64(visitor),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        match self.0 {
            Value::Null => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Self::Error> {
        self.0.deserialize_enum(name, variants, visitor)
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 char str string bytes byte_buf unit unit_struct newtype_struct seq tuple
        tuple_struct map struct identifier ignored_any
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::{Deserialize, Serialize};

    #[derive(Debug, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum Word {
        OneThing,
    }

    #[derive(Debug, Serialize, Deserialize)]
    struct Inner {
        word: Word,
        low: f64,
        curve: Vec<(f64, f64)>,
        perhaps: Option<f64>,
    }

    #[test]
    fn what_is_not_finite_comes_back_as_nan_at_any_depth() {
        let inner = Inner {
            word: Word::OneThing,
            low: f64::INFINITY,
            curve: vec![(1.0, f64::NAN)],
            perhaps: None,
        };
        let bytes = serde_json::to_vec(&Some(vec![inner])).unwrap();
        let back: Option<Vec<Inner>> = from_slice(&bytes).unwrap();
        let inner = &back.unwrap()[0];
        assert!(inner.low.is_nan() && inner.curve[0].1.is_nan() && inner.perhaps.is_none());
        assert_eq!(inner.curve[0].0, 1.0);
        assert!(matches!(inner.word, Word::OneThing));
        assert_eq!(serde_json::to_vec(&Some(vec![inner])).unwrap(), bytes);
    }

    #[test]
    fn null_is_nothing_and_other_mistakes_are_mistakes() {
        assert!(from_slice::<Option<Inner>>(b"null").unwrap().is_none());
        assert!(from_slice::<Vec<f64>>(b"[\"a\"]").is_err());
    }
}
