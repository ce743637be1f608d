//! Files of other programs that are known by their first bytes and not read: a message can say what to do with each.

use super::table::unreadable;
use pipeline_base::diagnostics::Diagnostic;

/// First bytes, what they are, and how to get from there to a log.
const FOREIGN: &[(&[u8], &str, &str)] = &[
    (
        b"\xd0\xcf\x11\xe0",
        "an old Excel workbook (.xls)",
        "save it as .xlsx or CSV",
    ),
    (
        b"TDSm",
        "a LabVIEW file (.tdms)",
        "export it as CSV from LabVIEW or DIAdem",
    ),
    (
        b"\xff\xfe",
        "text in UTF-16",
        "save it as CSV in UTF-8 (Excel: \"CSV UTF-8\")",
    ),
    (
        b"\xfe\xff",
        "text in UTF-16",
        "save it as CSV in UTF-8 (Excel: \"CSV UTF-8\")",
    ),
    (b"7z\xbc\xaf", "a 7-Zip archive", "unpack it"),
    (b"BZh", "a bzip2 archive", "unpack it, or use gzip"),
    (b"\xfd7zXZ", "an xz archive", "unpack it, or use gzip"),
    (
        b"\x28\xb5\x2f\xfd",
        "a Zstandard archive",
        "unpack it, or use gzip",
    ),
    (b"%PDF", "a PDF document", "name the log instead"),
];

/// Refuses the bytes if they are of a program whose files are not read.
///
/// # Errors
/// What they are and how to convert them.
pub fn refuse(file: &str, bytes: &[u8], readable: &str) -> Result<(), Diagnostic> {
    match FOREIGN.iter().find(|(magic, ..)| bytes.starts_with(magic)) {
        None => Ok(()),
        Some((_, what, hint)) => Err(unreadable(file, *what, format!("one of {readable}"), *hint)),
    }
}
