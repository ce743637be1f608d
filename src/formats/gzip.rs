//! Logs compressed with gzip (`.csv.gz` and the like).

use super::log_file;
use super::table::{LARGEST_LOG, unreadable};
use flate2::read::MultiGzDecoder;
use pipeline_base::diagnostics::Diagnostic;
use std::borrow::Cow;
use std::io::{BufReader, Read};

/// Whether the bytes are compressed.
pub fn is_compressed(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b])
}

/// The bytes, decompressed if they were compressed; never more than [`LARGEST_LOG`].
///
/// # Errors
/// A damaged archive, more than a log can be, or a line without end in it.
pub fn unpacked<'a>(file: &str, bytes: &'a [u8]) -> Result<Cow<'a, [u8]>, Diagnostic> {
    if !is_compressed(bytes) {
        return Ok(Cow::Borrowed(bytes));
    }
    let damaged = |e: std::io::Error| {
        unreadable(
            file,
            format!("a damaged gzip archive ({e})"),
            "a log compressed with gzip",
            "copy the file again, or compress it again",
        )
    };
    // The lines of a text are looked at before anything is held in memory: a few kilobytes may unpack to gigabytes.
    log_file::check(file, 0, BufReader::new(MultiGzDecoder::new(bytes))).map_err(damaged)??;
    let mut unpacked = Vec::new();
    MultiGzDecoder::new(bytes)
        .take(LARGEST_LOG + 1)
        .read_to_end(&mut unpacked)
        .map_err(damaged)?;
    if unpacked.len() as u64 > LARGEST_LOG {
        return Err(unreadable(
            file,
            format!("more than {LARGEST_LOG} bytes once decompressed"),
            "a log of a few minutes",
            "check that it is a log, or cut it into several",
        ));
    }
    Ok(Cow::Owned(unpacked))
}
