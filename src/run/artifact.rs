//! A result as it lies in the cache: which stage makes it, what it is called, and how a value becomes its bytes and comes back.

use crate::rule::Input;
use pipeline_base::digest::Outputs;
use pipeline_base::error::{Error, Result};
use pipeline_base::frame::Frame;
use pipeline_base::json;
use pipeline_base::reading::{self, Reading};
use pipeline_base::row::{self, Row};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// An output of a stage that holds a value of one type.
pub struct Artifact<T> {
    /// Name of the stage.
    pub stage: &'static str,
    /// Name among the outputs of a unit; its ending says what it is.
    pub name: &'static str,
    encode: fn(&T) -> Result<Vec<u8>>,
    decode: fn(&[u8]) -> Result<T>,
}

/// A value that is kept as a table.
pub trait Tabular: Sized {
    /// The value as a table.
    fn to_frame(&self) -> Frame;

    /// The value in a table written by [`Tabular::to_frame`].
    ///
    /// # Errors
    /// A table that lacks something.
    fn from_frame(frame: Frame) -> Result<Self>;
}

impl<T> Artifact<T> {
    /// A value that is kept as JSON, in which a number that is not finite is null.
    pub const fn json(stage: &'static str, name: &'static str) -> Self
    where
        T: Serialize + DeserializeOwned,
    {
        Self {
            stage,
            name,
            encode: |value| serde_json::to_vec(value).map_err(Error::internal),
            decode: json::from_slice,
        }
    }

    /// A value that is kept as Parquet.
    pub const fn table(stage: &'static str, name: &'static str) -> Self
    where
        T: Tabular,
    {
        Self {
            stage,
            name,
            encode: |value| value.to_frame().to_parquet(),
            decode: |bytes| T::from_frame(Frame::from_parquet(bytes)?),
        }
    }

    /// The output of the same unit, as an input of a later stage.
    pub const fn own(&self) -> Input {
        Input::Own(self.stage, self.name)
    }

    /// The output of each session of a unit, as an input; the key has it under the session's id and what it is `called`.
    pub const fn each(&self, called: &'static str) -> Input {
        Input::Each(self.stage, self.name, called)
    }

    /// Adds a value to the outputs of its stage.
    ///
    /// # Errors
    /// A value that cannot be written.
    pub fn put(&self, value: &T, outputs: &mut Outputs) -> Result<()> {
        outputs.insert(self.name.to_owned(), (self.encode)(value)?);
        Ok(())
    }

    /// Outputs with this one alone.
    ///
    /// # Errors
    /// A value that cannot be written.
    pub fn alone(&self, value: &T) -> Result<Outputs> {
        let mut outputs = Outputs::new();
        self.put(value, &mut outputs)?;
        Ok(outputs)
    }

    /// The value in its bytes.
    ///
    /// # Errors
    /// Bytes of something else.
    pub fn decode(&self, bytes: &[u8]) -> Result<T> {
        (self.decode)(bytes)
    }
}

impl Tabular for Frame {
    fn to_frame(&self) -> Frame {
        self.clone()
    }

    fn from_frame(frame: Frame) -> Result<Self> {
        Ok(frame)
    }
}

impl Tabular for Vec<Row> {
    fn to_frame(&self) -> Frame {
        row::to_frame(self)
    }

    fn from_frame(frame: Frame) -> Result<Self> {
        row::from_frame(&frame)
    }
}

impl Tabular for Vec<Reading> {
    fn to_frame(&self) -> Frame {
        reading::to_frame(self)
    }

    fn from_frame(frame: Frame) -> Result<Self> {
        reading::from_frame(&frame)
    }
}
