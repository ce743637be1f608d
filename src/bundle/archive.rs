//! The zip: entries in the order of their names, one time stamp, written beside its place and renamed when it is whole.

use crate::{Bundle, Contents, Packed, Written, kinds, metadata};
use pipeline_base::digest;
use pipeline_base::error::{Error, Result};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Years that a zip can hold.
const YEARS: std::ops::RangeInclusive<i32> = 1980..=2107;
/// From here on an entry needs long fields.
const LARGE: u64 = u32::MAX as u64;

/// Writes a bundle to `out`.
pub(super) fn write(bundle: &Bundle, out: &Path) -> Result<Written> {
    let unfinished = beside(out);
    let done = fill(bundle, &unfinished)
        .and_then(|files| {
            std::fs::rename(&unfinished, out).map_err(Error::io("write", out))?;
            Ok(files)
        })
        .inspect_err(|_| drop(std::fs::remove_file(&unfinished)))?;
    let size = std::fs::metadata(out).map_err(Error::io("read", out))?;
    Ok(Written {
        files: done,
        raw_files: bundle.raw_files().count(),
        bytes: size.len(),
        digest: digest::of_file(out).map_err(Error::io("read", out))?,
    })
}

/// Where the zip grows.
fn beside(out: &Path) -> PathBuf {
    let name = out.file_name().unwrap_or_default().to_string_lossy();
    out.with_file_name(format!(".{name}.unfinished"))
}

/// Writes all entries; how many there are.
fn fill(bundle: &Bundle, path: &Path) -> Result<usize> {
    let file = File::create(path).map_err(Error::io("write", path))?;
    let mut zip = ZipWriter::new(BufWriter::new(file));
    let time = time_stamp(bundle.about.date)?;
    let json = metadata::of(bundle)?;
    // The metadata is the first entry: who lists the archive sees at once what it is.
    start(&mut zip, (metadata::NAME, json.len() as u64), time)?;
    zip.write_all(&json).map_err(Error::io("write", path))?;
    for folder in metadata::folders(bundle) {
        let options = SimpleFileOptions::default().last_modified_time(time);
        zip.add_directory(folder, options.unix_permissions(0o755))
            .map_err(Error::internal)?;
    }
    let mut files = 1;
    for packed in &bundle.files {
        if matches!(packed.contents, Contents::Absent) {
            continue;
        }
        start(&mut zip, (&packed.path, packed.size), time)?;
        copy(packed, &mut zip, path)?;
        files += 1;
    }
    let mut file = zip.finish().map_err(Error::internal)?;
    file.flush().map_err(Error::io("write", path))?;
    Ok(files)
}

fn start<W: Write + std::io::Seek>(
    zip: &mut ZipWriter<W>,
    (name, size): (&str, u64),
    time: DateTime,
) -> Result<()> {
    let method = match kinds::is_compressed(name) {
        true => CompressionMethod::Stored,
        false => CompressionMethod::Deflated,
    };
    let options = SimpleFileOptions::default()
        .compression_method(method)
        .last_modified_time(time)
        .unix_permissions(0o644)
        .large_file(size >= LARGE);
    zip.start_file(name, options).map_err(Error::internal)
}

/// Puts the bytes of a file into the open entry.
fn copy(packed: &Packed, zip: &mut impl Write, out: &Path) -> Result<()> {
    match &packed.contents {
        Contents::Absent => Ok(()),
        Contents::Bytes(bytes) => zip.write_all(bytes).map_err(Error::io("write", out)),
        Contents::File(path) => {
            let mut file = File::open(path).map_err(Error::io("read", path))?;
            let copied = std::io::copy(&mut file, zip).map_err(Error::io("pack", path))?;
            let now = digest::of_file(path).map_err(Error::io("read", path))?;
            if copied != packed.size || now != packed.digest {
                return Err(Error::Usage(format!(
                    "{} changed while it was packed; run again when nothing writes to it",
                    path.display()
                )));
            }
            Ok(())
        }
    }
}

/// Midnight of the date of the documents, or the nearest that a zip can hold.
fn time_stamp((year, month, day): (i32, u8, u8)) -> Result<DateTime> {
    let year = year.clamp(*YEARS.start(), *YEARS.end());
    let year = u16::try_from(year).map_err(Error::internal)?;
    DateTime::from_date_and_time(year, month, day, 0, 0, 0).map_err(Error::internal)
}
