//! `provenance`: from what every session and every fit was made.

use crate::input::ReportInput;
use crate::table::{Audience, Cell, Column, Table};

/// Digits of a digest in print.
const SHOWN: usize = 16;

/// The table.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("kind", "Of"),
        Column::text("unit", "Session or fit"),
        Column::text("inputs", "Inputs (SHA-256)").seen_by(Audience::Machines),
        Column::text("outputs", "Outputs (SHA-256)").seen_by(Audience::Machines),
        Column::text("inputs", "Inputs (SHA-256)").seen_by(Audience::People),
        Column::text("outputs", "Outputs (SHA-256)").seen_by(Audience::People),
    ];
    let mut table = Table::new("provenance", "Where every number comes from", columns).note(
        "Inputs of a session are its description and its calibrated logs as they were read, its outputs the normalised readings; inputs of \
         a fit are the readings of its sessions. Whole digests are in tables/provenance.csv, those of the raw files, byte by byte, in \
         provenance.json.",
    );
    let mut kind = None;
    for row in &input.provenance {
        if kind != Some(row.kind) {
            table.rule();
        }
        kind = Some(row.kind);
        table.push(vec![
            Cell::text(row.kind),
            Cell::text(&row.unit),
            Cell::text(&row.inputs),
            Cell::text(&row.outputs),
            Cell::text(shown(&row.inputs)),
            Cell::text(shown(&row.outputs)),
        ]);
    }
    table
}

fn shown(digest: &str) -> String {
    let digits = digest.split(':').next_back().unwrap_or(digest);
    digits.chars().take(SHOWN).collect()
}
