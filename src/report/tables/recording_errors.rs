//! `recording_errors`: sessions, specimens and tests that the model fitted without them makes too improbable.

use super::described::{Of, flag, number, of_all, optional, text};
use crate::input::ReportInput;
use crate::table::{Cell, Rounding, Table};
use crate::wording::name;
use crate::wording::number::{error_rounding, finite};
use pipeline_findings::{ErrorKind, RecordingError};

type Row<'a> = Of<'a, &'a RecordingError>;

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        text("level", "What", |r: &Row| {
            Cell::text(name::level(r.one.level))
        }),
        text("group", "Id", |r| Cell::text(&r.one.group)),
        text("kind", "Kind", |r| Cell::text(kind(r.one.kind))),
        text("quantity", "Quantity", |r| {
            optional(r.one.quantity.as_deref())
        }),
        number("value", "Size", "", |r| {
            finite(r.one.value, Rounding::Digits(3))
        }),
        text("unit", "Unit", |r| Cell::text(&r.one.unit)),
        number("p", "\\v{p}", "", |r| finite(r.one.p, Rounding::Digits(2))),
        number("rms", "RMS", "", |r| {
            finite(r.one.rms, error_rounding(r.one.rms, &r.found.unit))
        }),
        number("rms_corrected", "Corrected", "", |r| {
            let rms = r.one.rms_corrected.unwrap_or(f64::NAN);
            finite(rms, error_rounding(rms, &r.found.unit))
        }),
        flag("set_aside", "Set aside", |r| Cell::Flag(r.one.set_aside)),
    ];
    let caption = "Recording errors: what the model fitted without it makes too improbable";
    of_all(input, ("recording_errors", caption), columns, |f| f.recording_errors.iter().collect())
        .note("\\v{Size}: true less recorded, or the factor of a unit. \\v{RMS} of its readings about that model, as recorded and with the mistake taken back.")
}

fn kind(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::Length => "length",
        ErrorKind::SwappedColumns => "swapped_columns",
        ErrorKind::Unit => "unit",
        ErrorKind::Sign => "sign",
        ErrorKind::Zero => "zero",
        ErrorKind::Outlier => "outlier",
    }
}
