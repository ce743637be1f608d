//! `rejects`: everything that was left out, and why.

use crate::input::ReportInput;
use crate::table::{Cell, Column, Table};
use pipeline_base::reject::{Extent, Reject};
use std::collections::BTreeMap;

/// Every reject, session by session.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("session", "Session"),
        Column::text("log", "Log"),
        Column::number("first_row", "First row", ""),
        Column::number("last_row", "Last row", ""),
        Column::number("count", "Rows", ""),
        Column::text("reason", "Reason"),
        Column::text("extent", "Extent"),
    ];
    let mut table = Table::new("rejects", "Everything that was left out, and why", columns);
    let row = |k: Option<u64>| k.map_or(Cell::Empty, |k| Cell::Integer(k as i64));
    for (name, diagnostics) in &input.unusable {
        for diagnostic in diagnostics {
            table.push(vec![
                Cell::text(name),
                Cell::text("session.toml"),
                row(diagnostic.row),
                row(diagnostic.row),
                Cell::Integer(0),
                Cell::text(format!(
                    "{}: found {}, expected {}",
                    diagnostic.column.as_deref().unwrap_or("session.toml"),
                    diagnostic.found,
                    diagnostic.expected
                )),
                Cell::text(Extent::Session.name()),
            ]);
        }
    }
    for reject in input.sessions.iter().flat_map(|s| s.rejects()) {
        table.push(vec![
            Cell::text(&reject.session),
            Cell::text(&reject.log),
            row(reject.first_row),
            row(reject.last_row),
            Cell::Integer(reject.count as i64),
            Cell::text(&reject.reason),
            Cell::text(reject.extent.name()),
        ]);
    }
    table
}

/// The rejects by extent and reason, for people: how often, and how many rows.
pub fn summary(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("extent", "Extent"),
        Column::text("reason", "Reason"),
        Column::number("times", "Times", ""),
        Column::number("rows", "Rows", ""),
        Column::number("sessions", "Sessions", ""),
    ];
    let mut table = Table::new("rejects_summary", "What was left out, by reason", columns);
    let mut by_reason: BTreeMap<(Extent, &str), (i64, i64, std::collections::BTreeSet<&str>)> =
        BTreeMap::new();
    let all: Vec<&Reject> = input.sessions.iter().flat_map(|s| s.rejects()).collect();
    for reject in all {
        let slot = by_reason
            .entry((reject.extent, &reject.reason))
            .or_default();
        slot.0 += 1;
        slot.1 += reject.count as i64;
        slot.2.insert(&reject.session);
    }
    for (name, diagnostics) in &input.unusable {
        let reason = diagnostics.first().map_or("unusable", |d| &d.found);
        let slot = by_reason.entry((Extent::Session, reason)).or_default();
        slot.0 += 1;
        slot.2.insert(name);
    }
    for ((extent, reason), (times, rows, sessions)) in by_reason {
        table.push(vec![
            Cell::text(extent.name()),
            Cell::text(reason),
            Cell::Integer(times),
            Cell::Integer(rows),
            Cell::Integer(sessions.len() as i64),
        ]);
    }
    table
}
