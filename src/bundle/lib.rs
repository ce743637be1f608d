#![warn(missing_docs)]
//! A run as an RO-Crate (<https://w3id.org/ro/crate/1.2>): one zip with the reports, tables and tidy data, the configuration, and the SHA-256 of every
//! raw file, or the raw files themselves.
//!
//! | module | what |
//! |---|---|
//! | `contents` | which files belong to a bundle, from what the last run wrote down of itself |
//! | `metadata` | `ro-crate-metadata.json` |
//! | `archive` | the zip |
//! | `kinds` | media type and description of a file by its place and ending |
//!
//! Same run and configuration, same bytes: entries in the order of their names, one fixed time stamp, the date of the documents.

mod archive;
mod contents;
mod kinds;
mod metadata;

use pipeline_base::date;
use pipeline_base::digest::Digest;
use pipeline_base::error::{Error, Result};
use pipeline_config::Config;
use pipeline_formats::discover::Discovery;
use std::path::{Path, PathBuf};

/// Where the pieces of a bundle are.
#[derive(Clone, Debug)]
pub struct Places {
    /// Raw directories.
    pub raw: Vec<PathBuf>,
    /// Cache and tidy data.
    pub derived: PathBuf,
    /// Tables, figures and reports.
    pub reports: PathBuf,
}

/// What is packed.
#[derive(Clone, Debug)]
pub struct Bundle {
    about: About,
    files: Vec<Packed>,
}

/// What is said of the whole.
#[derive(Clone, Debug)]
struct About {
    name: String,
    description: String,
    license: String,
    authors: Vec<pipeline_config::Author>,
    date: (i32, u8, u8),
    /// The version of the program.
    version: String,
}

/// One file of a bundle.
#[derive(Clone, Debug)]
struct Packed {
    /// Where it stands in the bundle, with forward slashes.
    path: String,
    contents: Contents,
    digest: Digest,
    size: u64,
}

/// Where the bytes of a file come from.
#[derive(Clone, Debug)]
enum Contents {
    /// A file on disk.
    File(PathBuf),
    /// Made for the bundle.
    Bytes(Vec<u8>),
    /// A raw file that is named with its digest, and stays where it is.
    Absent,
}

/// What was written.
#[derive(Clone, Debug)]
pub struct Written {
    /// Files in the bundle, its metadata included.
    pub files: usize,
    /// Raw files that are in it, or are named by their digests.
    pub raw_files: usize,
    /// Size of the zip, bytes.
    pub bytes: u64,
    /// Its digest.
    pub digest: Digest,
}

impl Bundle {
    /// The bundle of the last run on `places`, whose sessions are those of `discovery`; with the raw files where `with_raw` says so.
    ///
    /// # Errors
    /// There was no run; a file is not as the run left it; no session and no configuration has a date, which the standard demands.
    pub fn of_last_run(
        places: &Places,
        discovery: &Discovery,
        config: &Config,
        version: &str,
        with_raw: bool,
    ) -> Result<Self> {
        let measured = discovery.sessions.iter();
        let measured = measured.filter_map(|s| s.session.date.as_deref());
        let date = date::of_document(&config.report.date, measured).ok_or_else(|| {
            Error::Usage(
                "no session has a date, and a bundle has to have one; set `date` below [report] of pipeline.toml, or in session.toml"
                    .to_owned(),
            )
        })?;
        let options = &config.bundle;
        let or = |text: &str, other: &str| if text.is_empty() { other } else { text }.to_owned();
        let about = About {
            name: or(&options.name, &config.report.title),
            description: or(&options.description, metadata::DESCRIPTION),
            license: options.license.clone(),
            authors: options.authors_or(&config.report.author),
            date,
            version: version.to_owned(),
        };
        let mut files = contents::results(places)?;
        files.push(contents::configuration(config, places.raw.len())?);
        files.push(contents::citation());
        files.extend(contents::raw_files(places, discovery, with_raw)?);
        files.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(Self { about, files })
    }

    /// Writes the zip to `out`; whole or not at all.
    ///
    /// # Errors
    /// A file cannot be read or written, or has changed since its digest was taken.
    pub fn write(&self, out: &Path) -> Result<Written> {
        archive::write(self, out)
    }

    fn raw_files(&self) -> impl Iterator<Item = &Packed> {
        self.files.iter().filter(|f| f.path.starts_with(RAW))
    }
}

/// Folder of the raw files in a bundle.
const RAW: &str = "raw/";
