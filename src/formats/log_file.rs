//! Log files on disk: read whole, but not before a look has shown that they can be logs.

use super::foreign;
use super::gzip;
use super::table::{LARGEST_LOG, unreadable};
use super::{FORMATS, csv};
use pipeline_base::diagnostics::Diagnostic;
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::path::Path;

/// A line longer than this is no line of a log, bytes.
pub const LONGEST_LINE: usize = 64 * 1024;

/// The bytes of a log file; messages call it `file`.
///
/// # Errors
/// No such file, no file, no permission, or contents that cannot be a log.
pub fn load(path: &Path, file: &str) -> Result<Vec<u8>, Diagnostic> {
    let failed = |e: std::io::Error| cannot_read(file, &e);
    let metadata = match std::fs::metadata(path) {
        Err(_) if path.is_symlink() => return Err(broken_link(file)),
        metadata => metadata.map_err(failed)?,
    };
    if !metadata.is_file() {
        return Err(no_file(file, &metadata));
    }
    let open = std::fs::File::open(path).map_err(failed)?;
    check(file, metadata.len(), BufReader::new(open)).map_err(failed)??;
    std::fs::read(path).map_err(failed)
}

/// Checks, without holding it in memory, that what is read can be a log of `size` bytes: text by its lines, anything else by its size.
///
/// # Errors
/// The diagnostic says why it cannot. System errors are passed on.
pub fn check(
    file: &str,
    size: u64,
    mut read: impl BufRead,
) -> std::io::Result<Result<(), Diagnostic>> {
    let mut head = vec![0; 1024];
    let n = read_full(&mut read, &mut head)?;
    head.truncate(n);
    if !is_binary(&head) {
        return check_line_lengths(file, head.as_slice().chain(read));
    }
    if size > LARGEST_LOG {
        return Ok(Err(unreadable(
            file,
            format!("{size} bytes"),
            format!("a log of at most {LARGEST_LOG} bytes"),
            "cut it into several logs",
        )));
    }
    Ok(Ok(()))
}

/// Whether the beginning of a file is of a format that is no text.
pub(super) fn is_known_binary(head: &[u8]) -> bool {
    let mut binary = FORMATS.iter().filter(|f| f.name != csv::FORMAT.name);
    binary.any(|f| (f.recognises)(head))
}

fn is_binary(head: &[u8]) -> bool {
    is_known_binary(head) || gzip::is_compressed(head) || foreign::refuse("", head, "").is_err()
}

fn read_full(read: &mut impl Read, buffer: &mut [u8]) -> std::io::Result<usize> {
    let mut n = 0;
    while n < buffer.len() {
        match read.read(&mut buffer[n..])? {
            0 => break,
            more => n += more,
        }
    }
    Ok(n)
}

fn no_file(file: &str, metadata: &std::fs::Metadata) -> Diagnostic {
    let (found, hint) = if metadata.is_dir() {
        ("a folder", "name the log inside it, or remove its [[log]]")
    } else {
        (
            "something that is not a file (a pipe or device)",
            "copy the log itself beside session.toml",
        )
    };
    unreadable(file, found, "a readable log", hint)
}

fn broken_link(file: &str) -> Diagnostic {
    unreadable(
        file,
        "a link that leads to itself or to nothing",
        "a readable log",
        "replace the link by the log",
    )
}

fn cannot_read(file: &str, error: &std::io::Error) -> Diagnostic {
    let (found, hint) = match error.kind() {
        ErrorKind::NotFound => (
            "no such file".to_owned(),
            "put the log beside session.toml, or remove its [[log]]",
        ),
        kind => (format!("\"{kind}\""), "give yourself permission to read it"),
    };
    unreadable(file, found, "a readable log", hint)
}

/// Checks, without holding the text in memory, that no line is longer than [`LONGEST_LINE`].
///
/// # Errors
/// The line that is too long. System errors are passed on.
pub fn check_line_lengths(
    file: &str,
    mut read: impl BufRead,
) -> std::io::Result<Result<(), Diagnostic>> {
    let (mut line, mut length) = (1_u64, 0_usize);
    loop {
        let chunk = read.fill_buf()?;
        let n = chunk.len();
        if n == 0 {
            return Ok(Ok(()));
        }
        let mut rest = chunk;
        while let Some(end) = memchr::memchr(b'\n', rest) {
            if length + end > LONGEST_LINE {
                return Ok(Err(too_long(file, line)));
            }
            length = 0;
            line += 1;
            rest = &rest[end + 1..];
        }
        length += rest.len();
        if length > LONGEST_LINE {
            return Ok(Err(too_long(file, line)));
        }
        read.consume(n);
    }
}

fn too_long(file: &str, line: u64) -> Diagnostic {
    unreadable(
        file,
        format!("a line of more than {LONGEST_LINE} bytes"),
        "lines of a few numbers",
        "check that the file is a log and has line ends",
    )
    .at_row(line)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_without_end_is_refused_before_it_is_read() {
        let endless = std::io::repeat(b'1');
        let refused = check("t", u64::MAX, BufReader::new(endless)).unwrap();
        assert!(refused.unwrap_err().found.contains("more than"));
        assert!(check("t", 7, &b"1,2\n3,4"[..]).unwrap().is_ok());
    }

    #[test]
    fn a_binary_file_is_measured_and_not_searched_for_lines() {
        let workbook =
            || std::io::Cursor::new([b"PK\x03\x04".as_slice(), &[b'1'; 1 << 17]].concat());
        assert!(check("t", 1 << 17, workbook()).unwrap().is_ok());
        assert!(check("t", LARGEST_LOG + 1, workbook()).unwrap().is_err());
    }
}
