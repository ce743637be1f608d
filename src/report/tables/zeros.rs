//! `zeros`: the zero of the force channel of every session, where it came from, and what speaks against it.

use crate::input::ReportInput;
use crate::table::{Cell, Column, Rounding, Table};

/// The table.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("session", "Session"),
        Column::number("applied_n", "Taken off", "N"),
        Column::text("source", "From"),
        Column::number("zero_log_n", "Zero log", "N"),
        Column::number("zero_log_clipped", "clipped", ""),
        Column::number("slack_n", "Slack state", "N"),
        Column::flag("contradicted", "Contra"),
        Column::number("zero_log_pressure_kpa", "\\v{P} then", "kPa"),
    ];
    let mut table = Table::new("zeros", "The zero of the force channel", columns).note(
        "The slack state is the force of the session's own plateaus while the actuator carries no load, before any zero. \
         A zero log that contradicts the slack state is applied all the same, being what the measurers declared, unless half of it is clipped. \
         The pressure in the zero log is not taken off.",
    );
    let mut campaign = None;
    for session in &input.sessions {
        let Some(zero) = &session.clean.zero else {
            continue;
        };
        if zero.zero_log_n.is_none() && zero.slack_n.is_none() {
            continue;
        }
        let s = &session.ingest.session;
        if campaign.is_some_and(|c| c != &s.campaign) {
            table.rule();
        }
        campaign = Some(&s.campaign);
        table.push(vec![
            Cell::text(&s.id),
            Cell::number(zero.applied_n, Rounding::Decimals(2)),
            Cell::text(zero.source.name()),
            Cell::number(zero.zero_log_n, Rounding::Decimals(2)),
            Cell::number(zero.zero_log_clipped, Rounding::Percent(0)),
            Cell::number(zero.slack_n, Rounding::Decimals(2)),
            Cell::Flag(zero.contradicted),
            Cell::number(zero.zero_log_pressure_kpa, Rounding::Decimals(1)),
        ]);
    }
    table
}
