//! What every document has in common: the data of its template, the tables that it includes, the pictures that it shows, its date.

use crate::figures::Drawn;
use crate::figures::found::Kind;
use crate::input::ReportInput;
use crate::render::Renderer;
use crate::render::typst::{LONG, Typst};
use crate::table::Table;
use crate::typeset::Document;
use pipeline_base::date;
use pipeline_base::error::Result;
use pipeline_config::ReportOptions;
use serde::Serialize;

/// The data of a template: what stands on every document, and what one has of its own.
#[derive(Serialize)]
pub struct PageData<T> {
    /// Whether a part of it comes from a program.
    simulated: bool,
    /// Whether there are parts, and all of them do.
    only_simulated: bool,
    version: &'static str,
    /// Digest of all inputs.
    input: String,
    #[serde(flatten)]
    own: T,
}

impl<T: Serialize> PageData<T> {
    /// Of the digest of the inputs, whether each part is simulated, and what the document has of its own.
    pub fn new(input: &str, simulated: impl IntoIterator<Item = bool>, own: T) -> Self {
        let parts: Vec<bool> = simulated.into_iter().collect();
        Self {
            simulated: parts.contains(&true),
            only_simulated: parts.contains(&true) && !parts.contains(&false),
            version: env!("CARGO_PKG_VERSION"),
            input: input.to_owned(),
            own,
        }
    }

    /// The document of a template that reads these data as `/data.json`.
    ///
    /// # Errors
    /// Data that cannot be written as JSON.
    pub fn document(&self, template: &str, date: Option<(i32, u8, u8)>) -> Result<Document> {
        let document = Document::new(template).data("data.json", self)?;
        Ok(document.dated(date))
    }
}

/// A table as a template includes it.
#[derive(Serialize)]
pub struct Included {
    id: String,
    /// Whether it breaks across pages.
    long: bool,
}

impl Included {
    /// A table, of which the pages show no more than their most rows.
    pub fn new(table: &Table) -> Self {
        Self {
            id: table.id.clone(),
            long: table.rows.len() > LONG,
        }
    }
}

impl Document {
    /// The same document with tables that it can include as `/tables/ID.typ`.
    pub fn with_tables(self, tables: impl IntoIterator<Item = Table>) -> Document {
        let add = |document: Document, table: Table| {
            document.file(&format!("tables/{}.typ", table.id), Typst.render(&table))
        };
        tables.into_iter().fold(self, add)
    }

    /// The same document with the drawings of its pictures.
    pub fn with_figures<'a>(self, drawn: impl IntoIterator<Item = &'a Drawn>) -> Document {
        let add = |document: Document, drawn: &Drawn| document.file(&path(drawn), &drawn.svg);
        drawn.into_iter().fold(self, add)
    }
}

fn path(drawn: &Drawn) -> String {
    format!("figures/{}.svg", drawn.name)
}

/// A figure as a template shows it.
#[derive(Serialize)]
pub struct Picture {
    name: String,
    /// Its path from the root.
    file: String,
    caption: String,
    alt: String,
    width_mm: f64,
    /// What it shows of a residual.
    kind: Option<Kind>,
    /// Whether it needs a word of its own on where its data come from.
    simulated: bool,
}

impl Picture {
    /// A figure that was drawn.
    pub fn new(drawn: &Drawn) -> Self {
        Self {
            name: drawn.name.clone(),
            file: path(drawn),
            caption: drawn.caption.clone(),
            alt: drawn.title.clone(),
            width_mm: drawn.size_mm.0,
            kind: None,
            simulated: false,
        }
    }

    /// The same picture of what was found in a residual.
    pub fn of_kind(self, kind: Kind) -> Self {
        Self {
            kind: Some(kind),
            ..self
        }
    }

    /// The same picture of data that are simulated, or not.
    pub fn simulated(self, simulated: bool) -> Self {
        Self { simulated, ..self }
    }
}

/// The date that a document carries: the configured one, else the last day on which anything in it was measured. Never today's.
pub fn date_of(input: &ReportInput, options: &ReportOptions) -> Option<(i32, u8, u8)> {
    let measured = input.sessions.iter();
    let measured = measured.filter_map(|s| s.ingest.session.date.as_deref());
    date::of_document(&options.date, measured)
}
