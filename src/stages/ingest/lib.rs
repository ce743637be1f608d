#![warn(missing_docs)]
//! Ingest: the logs of one session, calibrated and in one unit a quantity.
//!
//! Every row of a log is kept, in its order; a cell that is no number is NaN. A column of words is kept as labels. What follows from it is for the clean stage. A log that
//! cannot be read at all is left out here, with its diagnostic and a reject; a session without any usable log is left out.

use pipeline_base::columns::{self, ANGLE, FORCE, LENGTH, PHASE, PRESSURE, TIME, TORQUE};
use pipeline_base::diagnostics::{Diagnostic, Severity};
use pipeline_base::frame::{Frame, Values};
use pipeline_base::reject::{Extent, Reject};
use pipeline_base::session::{LogSpec, Session};
use pipeline_formats::log::{BadCell, RawLog, Request};
use pipeline_formats::text_format;
use serde::{Deserialize, Serialize};

/// Raised when results change without a change of this stage's source files.
pub const VERSION: u32 = 1;

/// One log as ingested.
#[derive(Clone, Debug, PartialEq)]
pub struct LogSamples {
    /// Which log of the session.
    pub spec: LogSpec,
    /// Line of the first row in the file, counted from 1.
    pub first_line: u64,
    /// Column names and values in the units used inside.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Names and words of the columns that hold labels; none where a row has none.
    pub labels: Vec<(String, Vec<Option<String>>)>,
}

impl LogSamples {
    /// The values of a column, if the log has it.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns
            .iter()
            .find(|(n, _)| n == name)
            .map(|(_, v)| v.as_slice())
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, |(_, v)| v.len())
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The log as a table.
    pub fn to_frame(&self) -> Frame {
        let mut frame = Frame::default();
        for (name, values) in &self.columns {
            frame = frame.with(name, Values::Number(values.clone()));
        }
        for (name, words) in &self.labels {
            frame = frame.with(name, Values::Text(words.clone()));
        }
        frame
    }

    /// The log in a table written by [`LogSamples::to_frame`].
    pub fn from_frame(spec: LogSpec, first_line: u64, frame: Frame) -> Self {
        let mut log = Self {
            spec,
            first_line,
            columns: Vec::new(),
            labels: Vec::new(),
        };
        for (name, values) in frame.columns {
            match values {
                Values::Number(x) => log.columns.push((name, x)),
                Values::Text(words) => log.labels.push((name, words)),
                Values::Integer(_) => {}
            }
        }
        log
    }
}

/// What is known of a log beside its values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LogHeader {
    /// Which log of the session.
    pub spec: LogSpec,
    /// Line of the first row in the file, counted from 1.
    pub first_line: u64,
    /// Name of the output that holds the values.
    pub output: String,
}

/// A session as ingested, without the values of its logs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct IngestHeader {
    /// The session.
    pub session: Session,
    /// Readable logs, in the order of `session.toml`.
    pub logs: Vec<LogHeader>,
    /// What is wrong with the logs.
    pub diagnostics: Vec<Diagnostic>,
    /// Logs that could not be read.
    pub rejects: Vec<Reject>,
}

/// What ingest gives for one session.
#[derive(Clone, Debug)]
pub struct Ingested {
    /// Everything but the values.
    pub header: IngestHeader,
    /// The values, in the order of `header.logs`.
    pub logs: Vec<LogSamples>,
}

/// A log file as it was found: its bytes, or why there are none.
pub type LogBytes = Result<Vec<u8>, Diagnostic>;

/// Reads the logs of a session that lies in the folder `relative` (for messages), with the bytes in the order of `session.logs`.
pub fn ingest(session: &Session, relative: &str, files: Vec<LogBytes>) -> Ingested {
    let requests: Vec<Request> = session
        .columns
        .iter()
        .map(|c| Request {
            name: c.column.clone(),
            position: c.position.clone(),
            cells: c.cells,
            codes: c
                .values
                .iter()
                .map(|(raw, phase)| (raw.clone(), phase.code()))
                .collect(),
        })
        .collect();
    let mut ingested = Ingested {
        header: IngestHeader {
            session: session.clone(),
            logs: Vec::new(),
            diagnostics: Vec::new(),
            rejects: Vec::new(),
        },
        logs: Vec::new(),
    };
    for (index, (spec, bytes)) in session.logs.iter().zip(files).enumerate() {
        let file = format!("{relative}/{}", spec.name());
        match bytes.and_then(|bytes| {
            text_format::read(
                (&file, &bytes),
                session.format,
                spec.part.as_ref(),
                &requests,
            )
        }) {
            Ok(raw) => keep(&mut ingested, index, spec, &file, raw),
            Err(diagnostic) => leave_out(&mut ingested.header, spec, diagnostic),
        }
    }
    ingested
}

fn keep(ingested: &mut Ingested, index: usize, spec: &LogSpec, file: &str, raw: RawLog) {
    let session = &ingested.header.session;
    for (cell, found) in by_column(&raw.bad_cells) {
        let (expected, hint) = what_follows(&cell.column, cell.of);
        ingested.header.diagnostics.push(
            Diagnostic::error(file, found, expected, hint)
                .with_severity(Severity::Warning)
                .at_row(cell.line)
                .in_column(cell.column.as_str()),
        );
    }
    let (mut columns, mut labels) = (Vec::new(), Vec::new());
    for (k, (c, mut values)) in session.columns.iter().zip(raw.columns).enumerate() {
        if let Some(words) = raw.words.get(&k) {
            labels.push((c.column.clone(), words.clone()));
            continue;
        }
        if c.factor != 1.0 || c.constant != 0.0 {
            values
                .iter_mut()
                .for_each(|x| *x = c.factor * *x + c.constant);
        }
        columns.push((c.column.clone(), values));
    }
    ingested.header.logs.push(LogHeader {
        spec: spec.clone(),
        first_line: raw.first_line,
        output: format!("{index:03}.parquet"),
    });
    ingested.logs.push(LogSamples {
        spec: spec.clone(),
        first_line: raw.first_line,
        columns,
        labels,
    });
}

/// The first bad cell of each column, with everything that was quoted of the column: its number of bad cells is said once.
fn by_column(cells: &[BadCell]) -> Vec<(&BadCell, String)> {
    let mut columns: Vec<(&BadCell, String)> = Vec::new();
    for cell in cells {
        match columns.iter_mut().find(|(c, _)| c.column == cell.column) {
            Some((_, found)) => *found += &format!(", {}", cell.found),
            None => columns.push((cell, cell.found.clone())),
        }
    }
    columns
}

/// What is expected of a cell that is no number, and what becomes of its row: without a force, torque, pressure, angle or length it is no reading,
/// anything else it may lack.
fn what_follows(column: &str, cells: usize) -> (&'static str, String) {
    let such = if cells == 1 {
        "1 such cell of this column in this log".to_owned()
    } else {
        format!("{cells} such cells of this column in this log")
    };
    if column == PHASE {
        return (
            "one of the states in `values`",
            format!("the row is left out ({such})"),
        );
    }
    if [TIME, FORCE, TORQUE, ANGLE, PRESSURE, LENGTH].contains(&column) {
        return ("a finite number", format!("the row is left out ({such})"));
    }
    let words = if columns::is_reserved(column) {
        ""
    } else {
        "; if the column holds words, write `text = true` beside its name in [columns]"
    };
    (
        "a finite number",
        format!("the row stays, without a value of {column} ({such}){words}"),
    )
}

fn leave_out(header: &mut IngestHeader, spec: &LogSpec, diagnostic: Diagnostic) {
    header.rejects.push(Reject {
        session: header.session.id.clone(),
        log: spec.name(),
        first_row: diagnostic.row,
        last_row: None,
        count: 0,
        extent: Extent::Log,
        reason: format!(
            "unreadable: {}, expected {}",
            diagnostic.found, diagnostic.expected
        ),
    });
    header.diagnostics.push(diagnostic);
}
