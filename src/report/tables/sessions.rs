//! `sessions`: what was measured, one line a session.

use crate::described::*;
use crate::input::{ReportInput, SessionInput};
use pipeline_base::reject::Extent;
use pipeline_base::row::{kind_name, role_name};
use pipeline_base::session::Session;

/// One row a session.
#[rustfmt::skip]
pub fn sessions(input: &ReportInput) -> Table {
    let all = input.sessions.iter().map(|s| (&s.ingest.session, s));
    Described::<(&Session, &SessionInput)>::new("sessions", "Sessions: what was measured, and how many steady readings it contains")
        .text("session", "Session", |(s, _)| &s.id)
        .text("campaign", "Campaign", |(s, _)| &s.campaign).machines()
        .text("kind", "Kind", |(s, _)| kind_name(s.kind)).machines()
        .text("kind_words", "Kind", |(s, _)| kind_name(s.kind).replace('-', " ")).people()
        .text("specimen", "Specimen", |(s, _)| &s.specimen.id).machines()
        .number("diameter_mm", "⌀", Mm, Decimals(0), |(s, _)| s.specimen.diameter_mm)
        .number("rest_length_mm", "l_{rest}", Mm, Decimals(0), |(s, _)| 1e3 * s.specimen.rest_length_m)
        .number("contracted_length_mm", "l_{620}", Mm, Decimals(0), |(s, _)| 1e3 * s.specimen.contracted_length_m)
        .count("rows", "Rows", One, |(_, i)| i.clean.rows)
        .count("readings", "Readings", One, |(_, i)| i.readings)
        .count("rejected_logs", "Logs left out", One, |(_, i)| i.rejects().filter(|r| r.extent == Extent::Log).count())
        .text("role", "Role", |(s, _)| s.role.map(role_name)).machines()
        .text("exclude", "Excluded because", |(s, _)| &s.exclude).machines()
        .flag("simulated", "Simulated", |(s, _)| s.is_simulated()).machines()
        .text("remark", "Remark", |(s, _)| remark(s)).people()
        .text("notes", "Notes", |(s, _)| &s.notes).machines()
        .blocks(runs(all, |a, b| a.0.campaign == b.0.campaign))
}

/// What a reader must know of a session.
fn remark(session: &Session) -> Option<String> {
    let excluded = session
        .exclude
        .as_ref()
        .map(|why| format!("excluded: {why}"));
    excluded.or_else(|| session.is_simulated().then(|| "simulated".to_owned()))
}
