//! `zeros`: the zero of the force channel of every session, where it came from, and what speaks against it.

use crate::described::*;
use crate::input::ReportInput;
use crate::wording::name;
use pipeline_base::session::{Sampling, Session};
use pipeline_clean::zero::Zero;

/// Where a zero is from that replaces one that holds a pull.
const USUAL: &str = "usual";

/// One row a session of logs over time, or of points that have a zero log.
#[rustfmt::skip]
pub fn zeros(input: &ReportInput) -> Table {
    let all = input.sessions.iter().filter_map(|s| Some((&s.ingest.session, s.clean.zero.as_ref()?)));
    let known = all.filter(|(s, zero)| s.sampling == Sampling::Timeseries || zero.zero_log_n.is_some());
    let usual = |session: &Session| input.usual_zeros.get(&session.id).copied();
    Described::<(&Session, &Zero)>::new("zeros", "The zero of the force channel")
        .text("session", "Session", |(s, _)| &s.id)
        .number("applied_n", "Subtracted", N, Decimals(2), |(s, z)| usual(s).unwrap_or(z.applied_n))
        .text("source", "From", |(s, z)| usual(s).map_or(z.source.name(), |_| USUAL)).machines()
        .text("source_words", "From", |(s, z)| usual(s).map_or(name::zero_source(z.source), |_| USUAL)).people()
        .number("zero_log_n", "Zero log", N, Decimals(2), |(_, z)| z.zero_log_n)
        .number("zero_log_clipped", "clipped", One, Percent(0), |(_, z)| z.zero_log_clipped)
        .number("slack_n", "Slack state", N, Decimals(2), |(_, z)| z.slack_n)
        .flag("contradicted", "Contra", |(_, z)| z.contradicted)
        .number("zero_log_pressure_kpa", "\\v{P} then", KPa, Decimals(1), |(_, z)| z.zero_log_pressure_kpa)
        .note(
            "The slack state is the force of the session's own plateaus while the actuator carries no load, before any zero. \
             A zero log that contradicts the slack state is applied nevertheless, because the measurers declared it, unless half of it is clipped. \
             Usual: the zero log of a session at resting length holds a pull, and the median zero of its campaign's sessions away from it was subtracted in \
             its place. The pressure in the zero log is not subtracted.",
        )
        .blocks(runs(known, |a, b| a.0.campaign == b.0.campaign))
}
