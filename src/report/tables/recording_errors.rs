//! `recording_errors`: sessions, specimens and tests that the model fitted without them makes too improbable.

use crate::described::*;
use crate::input::ReportInput;
use crate::wording::name;
use pipeline_findings::{CampaignFindings, ErrorKind, RecordingError};

/// One row a mistake.
#[rustfmt::skip]
pub fn recording_errors(input: &ReportInput) -> Table {
    let caption = "Recording errors: groups too improbable under the model fitted without them";
    Described::<(&CampaignFindings, &RecordingError)>::found("recording_errors", caption)
        .text("level", "What", |(_, e)| name::level(e.level))
        .text("group", "Id", |(_, e)| &e.group)
        .text("kind", "Kind", |(_, e)| kind(e.kind))
        .text("quantity", "Quantity", |(_, e)| &e.quantity)
        .number("value", "Size", One, Digits(3), |(_, e)| finite(e.value))
        .text("unit", "Unit", |(_, e)| &e.unit)
        .number("p", "\\v{p}", One, Digits(2), |(_, e)| finite(e.p))
        .error("rms", "RMS", |(_, e)| e.rms)
        .error("rms_corrected", "Corrected", |(_, e)| e.rms_corrected)
        .flag("set_aside", "Set aside", |(_, e)| e.set_aside)
        .note("\\v{Size}: true minus recorded, or the factor of a unit. \\v{RMS} of the group's readings about that model, as recorded and as \
             corrected.")
        .of_all(input, |found| found.recording_errors.iter().collect())
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
