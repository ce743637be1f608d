//! `rejects`: everything that was left out, and why.

use crate::described::*;
use crate::input::ReportInput;
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::reject::{Extent, Reject};
use std::collections::{BTreeMap, BTreeSet};

/// One row a reject: unusable sessions, then session by session.
#[rustfmt::skip]
pub fn rejects(input: &ReportInput) -> Table {
    let unusable = input.unusable.iter().flat_map(|(name, all)| all.iter().map(move |d| unusable(name, d)));
    let unusable: Vec<Reject> = unusable.collect();
    let of_sessions = input.sessions.iter().flat_map(|s| s.rejects());
    Described::<&Reject>::new("rejects", "Everything that was left out, and why")
        .text("session", "Session", |r| &r.session)
        .text("log", "Log", |r| &r.log)
        .count("first_row", "First row", One, |r| r.first_row)
        .count("last_row", "Last row", One, |r| r.last_row)
        .count("count", "Rows", One, |r| r.count)
        .text("reason", "Reason", |r| &r.reason)
        .text("extent", "Extent", |r| r.extent.name())
        .rows(unusable.iter().chain(of_sessions))
}

/// A session that could not be read.
fn unusable(name: &str, diagnostic: &Diagnostic) -> Reject {
    Reject {
        session: name.to_owned(),
        log: "session.toml".to_owned(),
        first_row: diagnostic.row,
        last_row: diagnostic.row,
        count: 0,
        extent: Extent::Session,
        reason: in_words(diagnostic),
    }
}

/// How often something was left out for one reason.
#[derive(Default)]
struct Tally<'a> {
    times: usize,
    rows: u64,
    sessions: BTreeSet<&'a str>,
}

/// The rejects by extent and reason, for people.
#[rustfmt::skip]
pub fn summary(input: &ReportInput) -> Table {
    let tallies = tallies(input);
    Described::<(Extent, &str, &Tally)>::new("rejects_summary", "What was left out, by reason")
        .text("extent", "Extent", |(extent, ..)| extent.name())
        .text("reason", "Reason", |(_, reason, _)| reason)
        .count("times", "Times", One, |(.., t)| t.times)
        .count("rows", "Rows", One, |(.., t)| t.rows)
        .count("sessions", "Sessions", One, |(.., t)| t.sessions.len())
        .rows(tallies.iter().map(|((extent, reason), t)| (*extent, reason.as_str(), t)))
}

fn tallies(input: &ReportInput) -> BTreeMap<(Extent, String), Tally<'_>> {
    let mut tallies: BTreeMap<(Extent, String), Tally> = BTreeMap::new();
    let mut add = |extent, reason: String, rows, session| {
        let tally = tallies.entry((extent, reason)).or_default();
        tally.times += 1;
        tally.rows += rows;
        tally.sessions.insert(session);
    };
    for r in input.sessions.iter().flat_map(|s| s.rejects()) {
        add(r.extent, r.reason.clone(), r.count, &r.session);
    }
    for (name, diagnostics) in &input.unusable {
        let reason = diagnostics.first().map_or_else(String::new, in_words);
        add(Extent::Session, reason, 0, name);
    }
    tallies
}

/// What is wrong with a session: what stands where, and what should.
fn in_words(diagnostic: &Diagnostic) -> String {
    let column = diagnostic.column.as_deref().unwrap_or("session.toml");
    let (found, expected) = (&diagnostic.found, &diagnostic.expected);
    format!("{column}: found {found}, expected {expected}")
}
