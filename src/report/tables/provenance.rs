//! `provenance`: from what every session and every fit was made.

use crate::described::*;
use crate::input::{Provenance, ReportInput};

/// Digits of a digest in print.
const SHOWN: usize = 16;

/// One row a session, then one a fit.
#[rustfmt::skip]
pub fn provenance(input: &ReportInput) -> Table {
    Described::<&Provenance>::new("provenance", "Where every number comes from")
        .text("kind", "Of", |r| r.kind)
        .text("unit", "Session or fit", |r| &r.unit)
        .text("inputs", "Inputs (SHA-256)", |r| &r.inputs).machines()
        .text("outputs", "Outputs (SHA-256)", |r| &r.outputs).machines()
        .text("inputs", "Inputs (SHA-256)", |r| shown(&r.inputs)).people()
        .text("outputs", "Outputs (SHA-256)", |r| shown(&r.outputs)).people()
        .note(
            "Inputs of a session are its description and its calibrated logs as they were read, its outputs the normalised readings; inputs of \
             a fit are the readings of its sessions. Whole digests are in tables/provenance.csv, those of the raw files, byte by byte, in \
             provenance.json.",
        )
        .blocks(runs(&input.provenance, |a, b| a.kind == b.kind))
}

fn shown(digest: &str) -> String {
    let digits = digest.split(':').next_back().unwrap_or(digest);
    digits.chars().take(SHOWN).collect()
}
