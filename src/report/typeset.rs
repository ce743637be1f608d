//! Typst documents as PDF: every file in memory, bundled fonts only, no clock.
//!
//! The engine is typst-as-lib's; its world is borrowed so that messages can name file, line and column. That world would tell a
//! template the present time: a test sees to it that no template asks.
//!
//! Fonts are parsed once a process. The results of layout are remembered from one document to the next, so that a second document
//! in the same style costs less than the first.

use crate::fonts;
use crate::layout::{self, Sheet};
use pipeline_base::error::{Error, Result};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::LazyLock;
use typst::diag::{SourceDiagnostic, Warned};
use typst::foundations::{Bytes, Datetime};
use typst::text::Font;
use typst::{World, WorldExt};
use typst_as_lib::{TypstEngine, TypstWorld};
use typst_pdf::{PdfOptions, PdfStandard, PdfStandards, Timestamp};

/// The house style, which every document finds as `/style.typ`.
const STYLE: &str = include_str!("templates/style.typ");
/// Name of the main file in messages.
const MAIN: &str = "main.typ";
/// For how many documents the results of layout are remembered.
const REMEMBERED: usize = 10;

static FONTS: LazyLock<Vec<Font>> = LazyLock::new(|| {
    let font = |bytes: &'static [u8]| Font::new(Bytes::new(bytes), 0);
    fonts::ALL.into_iter().filter_map(font).collect()
});

/// A document to be typeset.
#[derive(Clone, Debug)]
pub struct Document {
    files: BTreeMap<String, Vec<u8>>,
    date: Option<(i32, u8, u8)>,
    remembered: usize,
}

/// A typeset document.
#[derive(Clone, Debug, PartialEq)]
pub struct Pdf {
    /// The file.
    pub bytes: Vec<u8>,
    /// What was measured of every page.
    pub sheets: Vec<Sheet>,
    /// What Typst had to remark, each with file, line and column.
    pub warnings: Vec<String>,
}

impl Document {
    /// A document whose main file is `main`; it finds the house style as `/style.typ`.
    pub fn new(main: &str) -> Document {
        Document {
            files: BTreeMap::new(),
            date: None,
            remembered: REMEMBERED,
        }
        .file("style.typ", STYLE)
        .file("margins.json", layout::margins_json())
        .file(MAIN, main)
    }

    /// The same document with a file that it can include, read or show, under a path from its root. Characters of a text that no font has become question
    /// marks: a remark in another script must not cost the document.
    pub fn file(mut self, path: &str, bytes: impl AsRef<[u8]>) -> Document {
        let bytes = bytes.as_ref();
        let shown = match std::str::from_utf8(bytes) {
            Ok(text) if !text.is_ascii() => {
                text.chars().map(displayable).collect::<String>().into()
            }
            _ => bytes.to_vec(),
        };
        self.files.insert(path.into(), shown);
        self
    }

    /// The same document with data, which it reads by `json(path)`.
    ///
    /// # Errors
    /// If the data cannot be written as JSON.
    pub fn data(self, path: &str, data: &impl Serialize) -> Result<Document> {
        let bytes = serde_json::to_vec(data).map_err(Error::internal)?;
        Ok(self.file(path, bytes))
    }

    /// The same document with the date (year, month, day) of the configuration; with a date it conforms to PDF/A-2b, which demands
    /// one.
    pub fn dated(mut self, date: Option<(i32, u8, u8)>) -> Document {
        self.date = date;
        self
    }

    /// The same document, after which no results of layout are remembered: those of a long one take hundreds of megabytes.
    pub fn forgotten(mut self) -> Document {
        self.remembered = 0;
        self
    }

    /// Typesets the document.
    ///
    /// # Errors
    /// Whatever Typst objects to, each with file, line, column and hints.
    pub fn compile(&self) -> Result<Pdf> {
        let options = self.options()?;
        let (main, others) = self.sources()?;
        let binaries = self
            .files
            .iter()
            .filter(|(path, _)| !path.ends_with(".typ"));
        let engine = TypstEngine::builder()
            .main_file((MAIN, main))
            .fonts(FONTS.iter().cloned())
            .with_static_source_file_resolver(others)
            .with_static_file_resolver(
                binaries.map(|(path, bytes)| (path.as_str(), Bytes::new(bytes.clone()))),
            )
            .comemo_evict_max_age(Some(self.remembered))
            .build();
        engine
            .with_world(|world| typeset(world, &options))
            .map_err(Error::internal)?
    }

    /// The main file, and the other Typst files with their paths.
    fn sources(&self) -> Result<(String, Vec<(&str, String)>)> {
        let mut main = String::new();
        let mut others = Vec::new();
        for (path, bytes) in self.files.iter().filter(|(path, _)| path.ends_with(".typ")) {
            let text = String::from_utf8(bytes.clone()).map_err(Error::internal)?;
            if path == MAIN {
                main = text;
            } else {
                others.push((path.as_str(), text));
            }
        }
        Ok((main, others))
    }

    fn options(&self) -> Result<PdfOptions> {
        let Some((year, month, day)) = self.date else {
            return Ok(PdfOptions::default());
        };
        let date = Datetime::from_ymd_hms(year, month, day, 0, 0, 0)
            .ok_or_else(|| Error::Usage(format!("{year}-{month}-{day} is not a date")))?;
        let standards = PdfStandards::new(&[PdfStandard::A_2b]);
        Ok(PdfOptions {
            timestamp: Some(Timestamp::new_utc(date)),
            standards: standards.map_err(|e| Error::internal(e.message()))?,
            ..PdfOptions::default()
        })
    }
}

/// A character, or what stands for it where no font has it.
fn displayable(c: char) -> char {
    let is_known = c.is_control() || FONTS.iter().any(|f| f.info().coverage.contains(c.into()));
    if is_known { c } else { '?' }
}

/// A figure as a PDF of one page at the figure's size, mm.
///
/// # Errors
/// If the figure is no SVG.
pub fn svg_to_pdf(svg: &str, title: &str, (width, height): (f64, f64)) -> Result<Vec<u8>> {
    let title = format!("{title:?}");
    let main = format!(
        "#set document(title: {title}, date: none)\n#set page(width: {width}mm, height: {height}mm, margin: 0pt)\n\
         #image(\"figure.svg\", width: 100%, height: 100%, alt: {title})\n"
    );
    let pdf = Document::new(&main).file("figure.svg", svg).compile()?;
    Ok(pdf.bytes)
}

fn typeset(world: &TypstWorld, options: &PdfOptions) -> Result<Pdf> {
    let Warned { output, warnings } = typst::compile(world);
    let document = output.map_err(|errors| failure(world, &errors))?;
    let written = apart(|| typst_pdf::pdf(&document, options))?;
    Ok(Pdf {
        bytes: written.map_err(|errors| failure(world, &errors))?,
        sheets: document
            .pages()
            .iter()
            .map(|page| layout::measure(&page.frame))
            .collect(),
        warnings: warnings.iter().map(|w| message(world, w)).collect(),
    })
}

/// Does what `write` does on a thread of its own, in a pool of one.
///
/// While the PDF writer (krilla) waits for a part of a document it takes up any other work of its thread's pool, another document perhaps, on top of
/// the stack; the figures of nine campaigns filled two megabytes. Here it finds nothing but the parts of this document.
fn apart<T: Send>(write: impl FnOnce() -> T + Send) -> Result<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(Error::internal)?;
    let done = std::thread::scope(|scope| scope.spawn(|| pool.install(write)).join());
    Ok(done.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
}

fn failure(world: &TypstWorld, errors: &[SourceDiagnostic]) -> Error {
    let messages: Vec<String> = errors.iter().map(|e| message(world, e)).collect();
    Error::internal(format!(
        "a document cannot be typeset: {}",
        messages.join("; ")
    ))
}

/// `file:line:column: message (hint)`.
fn message(world: &TypstWorld, diagnostic: &SourceDiagnostic) -> String {
    let place = diagnostic.span.id().and_then(|id| {
        let source = world.source(id).ok()?;
        let range = world.range(diagnostic.span)?;
        let (line, column) = source.lines().byte_to_line_column(range.start)?;
        let path = id.get().vpath().get_without_slash();
        Some(format!("{path}:{}:{}: ", line + 1, column + 1))
    });
    let mut text = place.unwrap_or_default() + &diagnostic.message;
    for hint in &diagnostic.hints {
        let _ = write!(text, " ({})", hint.v);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_file_line_and_column() {
        let error = Document::new("= Title\n\n#unknown").compile().unwrap_err();
        assert!(
            error
                .to_string()
                .contains("main.typ:3:2: unknown variable: unknown"),
            "{error}"
        );
        let missing = Document::new("#image(\"no.svg\")").compile().unwrap_err();
        assert!(missing.to_string().contains("no.svg"), "{missing}");
    }

    #[test]
    fn no_template_asks_for_the_time() {
        for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/templates")).unwrap() {
            let path = entry.unwrap().path();
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(!text.contains("today"), "{}", path.display());
        }
    }

    #[test]
    fn warnings_come_back() {
        let pdf = Document::new("#set text(font: \"No Such Font\")\nText")
            .compile()
            .unwrap();
        assert!(
            pdf.warnings[0].contains("main.typ:1:"),
            "{:?}",
            pdf.warnings
        );
    }

    #[test]
    fn a_dated_document_is_archival_and_repeats_itself() {
        let document =
            Document::new("#set document(title: \"T\", author: \"A\")\n$ epsilon^* = 1 - l/l_0 $")
                .dated(Some((2024, 5, 17)));
        let pdf = document.compile().unwrap();
        let text = String::from_utf8_lossy(&pdf.bytes);
        assert!(text.contains("<pdfaid:part>2</pdfaid:part>"));
        assert!(text.contains("2024-05-17"));
        assert_eq!(pdf.bytes, document.compile().unwrap().bytes);
    }

    #[test]
    fn an_undated_document_carries_no_date() {
        let pdf = Document::new("Text").compile().unwrap();
        let text = String::from_utf8_lossy(&pdf.bytes);
        assert!(!text.contains("CreationDate") && !text.contains("CreateDate"));
    }

    #[test]
    fn an_impossible_date_is_a_usage_error() {
        let error = Document::new("Text")
            .dated(Some((2024, 13, 1)))
            .compile()
            .unwrap_err();
        assert_eq!(error.exit_code(), 2);
    }
}
