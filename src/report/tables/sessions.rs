//! `sessions`: what was measured, one line a session.

use crate::input::ReportInput;
use crate::table::{Audience, Cell, Column, Rounding, Table};
use pipeline_base::reject::Extent;
use pipeline_base::row::{kind_name, role_name};

/// The table.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("session", "Session"),
        Column::text("campaign", "Campaign").seen_by(Audience::Machines),
        Column::text("kind", "Kind"),
        Column::text("specimen", "Specimen").seen_by(Audience::Machines),
        Column::number("diameter_mm", "⌀", "mm"),
        Column::number("rest_length_mm", "l_{rest}", "mm"),
        Column::number("contracted_length_mm", "l_{620}", "mm"),
        Column::number("rows", "Rows", ""),
        Column::number("readings", "Readings", ""),
        Column::number("rejected_logs", "Logs left out", ""),
        Column::text("role", "Role").seen_by(Audience::Machines),
        Column::text("exclude", "Excluded because").seen_by(Audience::Machines),
        Column::flag("simulated", "Simulated").seen_by(Audience::Machines),
        Column::text("remark", "Remark").seen_by(Audience::People),
        Column::text("notes", "Notes").seen_by(Audience::Machines),
    ];
    let mut table = Table::new(
        "sessions",
        "Sessions: what was measured, and how many steady readings it gave",
        columns,
    );
    let mut campaign = None;
    for session in &input.sessions {
        let s = &session.ingest.session;
        if campaign.is_some_and(|c| c != &s.campaign) {
            table.rule();
        }
        campaign = Some(&s.campaign);
        let lost = session
            .rejects()
            .filter(|r| r.extent == Extent::Log)
            .count();
        table.push(vec![
            Cell::text(&s.id),
            Cell::text(&s.campaign),
            Cell::text(kind_name(s.kind)),
            Cell::text(&s.specimen.id),
            Cell::number(s.specimen.diameter_mm, Rounding::Decimals(0)),
            Cell::number(1e3 * s.specimen.rest_length_m, Rounding::Decimals(0)),
            Cell::number(1e3 * s.specimen.contracted_length_m, Rounding::Decimals(0)),
            Cell::Integer(session.clean.rows as i64),
            Cell::Integer(session.readings as i64),
            Cell::Integer(lost as i64),
            s.role.map_or(Cell::Empty, |r| Cell::text(role_name(r))),
            s.exclude.as_ref().map_or(Cell::Empty, Cell::text),
            Cell::Flag(s.is_simulated()),
            remark(s),
            s.notes.as_ref().map_or(Cell::Empty, Cell::text),
        ]);
    }
    table
}

/// What a reader must know of a session.
fn remark(session: &pipeline_base::session::Session) -> Cell {
    match (&session.exclude, session.is_simulated()) {
        (Some(why), _) => Cell::text(format!("excluded: {why}")),
        (None, true) => Cell::text("simulated"),
        (None, false) => Cell::Empty,
    }
}
