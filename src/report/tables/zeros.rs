//! `zeros`: the zero of the force channel of every session, where it came from, and what speaks against it.

use crate::described::*;
use crate::input::ReportInput;
use crate::wording::name;
use pipeline_base::session::Session;
use pipeline_clean::zero::Zero;

/// One row a session that has a zero log or a slack state.
#[rustfmt::skip]
pub fn zeros(input: &ReportInput) -> Table {
    let all = input.sessions.iter().filter_map(|s| Some((&s.ingest.session, s.clean.zero.as_ref()?)));
    let known = all.filter(|(_, zero)| zero.zero_log_n.is_some() || zero.slack_n.is_some());
    Described::<(&Session, &Zero)>::new("zeros", "The zero of the force channel")
        .text("session", "Session", |(s, _)| &s.id)
        .number("applied_n", "Subtracted", N, Decimals(2), |(_, z)| z.applied_n)
        .text("source", "From", |(_, z)| z.source.name()).machines()
        .text("source_words", "From", |(_, z)| name::zero_source(z.source)).people()
        .number("zero_log_n", "Zero log", N, Decimals(2), |(_, z)| z.zero_log_n)
        .number("zero_log_clipped", "clipped", One, Percent(0), |(_, z)| z.zero_log_clipped)
        .number("slack_n", "Slack state", N, Decimals(2), |(_, z)| z.slack_n)
        .flag("contradicted", "Contra", |(_, z)| z.contradicted)
        .number("zero_log_pressure_kpa", "\\v{P} then", KPa, Decimals(1), |(_, z)| z.zero_log_pressure_kpa)
        .note(
            "The slack state is the force of the session's own plateaus while the actuator carries no load, before any zero. \
             A zero log that contradicts the slack state is applied nevertheless, because the measurers declared it, unless half of it is clipped. \
             The pressure in the zero log is not subtracted.",
        )
        .blocks(runs(known, |a, b| a.0.campaign == b.0.campaign))
}
