//! What is fuzzed: readers of what people put below `raw/`, each with real inputs to start from.

use super::mutate::{Draw, mutated};
use pipeline::base::diagnostics::Diagnostic;
use pipeline::base::session::{Cells, Part, PartKind, Position};
use pipeline::draft::Draft;
use pipeline::formats::log::{self, Request};
use pipeline::formats::log_file;
use pipeline::formats::overview::overview;
use pipeline::formats::session_toml;
use std::io::{Cursor, Read, Write};
use std::path::Path;

/// A reader with the inputs that are mutated for it.
pub struct Target {
    /// The name on the command line.
    pub name: &'static str,
    seeds: Vec<Vec<u8>>,
    pack: fn(&mut Draw, &[Vec<u8>]) -> Vec<u8>,
    read: fn(&[u8]) -> Outcome,
}

/// What became of an input.
#[derive(Default)]
pub struct Outcome {
    /// Whether it was read, in whole or in part.
    pub is_read: bool,
    /// What was said of it.
    pub diagnostics: Vec<Diagnostic>,
}

impl Target {
    /// The input of a case.
    pub fn input(&self, seed: u64, case: u64) -> Vec<u8> {
        (self.pack)(&mut Draw::of_case(seed, case), &self.seeds)
    }

    /// Reads an input.
    pub fn read(&self, input: &[u8]) -> Outcome {
        (self.read)(input)
    }
}

/// Every target.
pub fn targets() -> Vec<Target> {
    let log = |name, files: &[&str], pack| Target {
        name,
        seeds: files.iter().map(|f| fixture(f)).collect(),
        pack,
        read: read_log,
    };
    vec![
        Target {
            name: "session",
            seeds: sessions(),
            pack: plain,
            read: read_session,
        },
        log("text", &["points.csv", "semicolon.csv", "tab.txt"], plain),
        log("gzip", &["points.csv", "semicolon.csv"], compressed),
        log("gzip-bytes", &["points.csv.gz", "tab.txt.gz"], plain),
        log("xlsx", &["workbook.xlsx"], workbook),
        log("xlsx-bytes", &["workbook.xlsx"], plain),
        log(
            "mat5",
            &["vectors.mat", "structure.mat", "matrix.mat"],
            plain,
        ),
        log("mat73", &["v73.mat", "v73-compressed.mat"], plain),
        log("parquet", &["frame.parquet"], plain),
    ]
}

fn folder(below: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(below)
}

fn fixture(name: &str) -> Vec<u8> {
    std::fs::read(folder("tests/data/formats").join(name)).expect("a fixture")
}

/// The shipped sessions: points, logs over time, torque.
fn sessions() -> Vec<Vec<u8>> {
    let mut found: Vec<_> = walkdir::WalkDir::new(folder("raw"))
        .sort_by_file_name()
        .into_iter()
        .flatten()
        .filter(|e| e.file_name() == "session.toml")
        .map(|e| e.into_path())
        .collect();
    found.sort();
    let every = (found.len() / 6).max(1);
    let texts = found.iter().step_by(every).map(std::fs::read);
    texts
        .collect::<Result<_, _>>()
        .expect("the shipped sessions")
}

fn one<'a>(draw: &mut Draw, seeds: &'a [Vec<u8>]) -> &'a [u8] {
    &seeds[draw.below(seeds.len())]
}

fn plain(draw: &mut Draw, seeds: &[Vec<u8>]) -> Vec<u8> {
    let (input, other) = (one(draw, seeds), one(draw, seeds));
    mutated(draw, input, other)
}

/// A sound archive of mutated text.
fn compressed(draw: &mut Draw, seeds: &[Vec<u8>]) -> Vec<u8> {
    let text = plain(draw, seeds);
    let mut archive = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    archive.write_all(&text).expect("writing to memory");
    archive.finish().expect("writing to memory")
}

/// A sound archive of which one part is mutated: without it a mutation would seldom get past the checksums.
fn workbook(draw: &mut Draw, seeds: &[Vec<u8>]) -> Vec<u8> {
    let mut archive = zip::ZipArchive::new(Cursor::new(&seeds[0])).expect("a fixture");
    let mut written = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let stored =
        zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    // The sheets and their strings come more often than the rest.
    let chosen = draw.below(archive.len());
    let sheet = draw.below(3) > 0;
    for k in 0..archive.len() {
        let mut part = archive.by_index(k).expect("a fixture");
        let name = part.name().expect("a fixture").into_owned();
        let mut bytes = Vec::new();
        part.read_to_end(&mut bytes).expect("a fixture");
        let is_sheet = name.contains("sheet") || name.contains("Strings");
        if (sheet && is_sheet) || (!sheet && k == chosen) {
            bytes = mutated(draw, &bytes, &bytes);
        }
        written.start_file(name, stored).expect("writing to memory");
        written.write_all(&bytes).expect("writing to memory");
    }
    written.finish().expect("writing to memory").into_inner()
}

fn read_session(input: &[u8]) -> Outcome {
    let Ok(text) = std::str::from_utf8(input) else {
        return Outcome::default();
    };
    let read = session_toml::read("session.toml", text);
    Outcome {
        is_read: read.is_ok(),
        diagnostics: read.err().unwrap_or_default(),
    }
}

/// Everything that the program does with a log: the look before it is read, the columns that a session names, in the file and in its parts,
/// and the guess.
fn read_log(input: &[u8]) -> Outcome {
    let mut outcome = Outcome::default();
    if let Ok(Err(diagnostic)) = log_file::check("log", input.len() as u64, input) {
        outcome.diagnostics.push(diagnostic);
        return outcome;
    }
    let parts = [PartKind::Sheet, PartKind::Variable];
    let parts = parts.into_iter().zip(["Run 8", "log"]).map(|(kind, name)| {
        Some(Part {
            kind,
            name: name.to_owned(),
        })
    });
    for part in std::iter::once(None).chain(parts) {
        match log::read("log", input, part.as_ref(), &requests()) {
            Ok(_) => outcome.is_read = true,
            Err(diagnostic) => outcome.diagnostics.push(diagnostic),
        }
    }
    match overview("log", input, None) {
        Ok(columns) => {
            let draft = Draft::of("log", None, &columns);
            pipeline::draft::text::session_toml(&draft, "fuzz");
        }
        Err(diagnostic) => outcome.diagnostics.push(diagnostic),
    }
    outcome
}

fn requests() -> Vec<Request> {
    let request = |name: &str, cells, codes: &[(&str, f64)]| Request {
        name: name.to_owned(),
        position: Position::Name(name.to_owned()),
        cells,
        codes: codes.iter().map(|(t, c)| ((*t).to_owned(), *c)).collect(),
    };
    vec![
        request("force_n", Cells::Numbers, &[]),
        request("humidity", Cells::Either, &[]),
        request("length_mm", Cells::Words, &[]),
        request(
            "pressure_kpa",
            Cells::Numbers,
            &[("620.0", 1.0), ("400.5", 2.0)],
        ),
    ]
}
