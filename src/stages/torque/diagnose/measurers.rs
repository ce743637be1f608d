//! What the measurers of the knee paper reached by hand, beside what the loop reaches on actuators of the same length on the same joint.

use super::Group;
use super::by_test::TestErrors;
use crate::errors::Size;
use pipeline_mechanics::knee::data;
use serde::{Deserialize, Serialize};

/// Resting lengths that differ by less are the same, m.
const SAME_LENGTH_M: f64 = 1e-3;

/// Root mean square and largest size of errors, N.m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reached {
    /// Root mean square.
    pub rmse_nm: f64,
    /// Largest size.
    pub max_nm: f64,
}

/// One of their actuators.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ByHand {
    /// What they call it.
    pub name: String,
    /// "fitted" or "held out", by them.
    pub part: String,
    /// Their rigid leg; none where they give no number.
    pub their_rigid: Option<Reached>,
    /// What they reached.
    pub theirs: Reached,
    /// Readings of the tests that take part here.
    pub readings: usize,
    /// The rigid leg here.
    pub rigid: Option<Reached>,
    /// The loop, fitted to all tests.
    pub after: Option<Reached>,
    /// The loop without the actuator (or the test, or the stretch of angles).
    pub held_out: Option<Reached>,
}

/// Their actuators that a joint has.
pub(super) fn beside(group: &Group, tests: &[TestErrors]) -> Vec<ByHand> {
    let configuration = &group.members[0].1;
    let same = |theirs: &&Theirs| {
        theirs.knee == configuration.knee
            && theirs.muscle == configuration.muscle
            && theirs.diameter_mm == f64::from(configuration.diameter_mm)
    };
    let all = theirs();
    let with_tests = all.iter().filter(same).filter_map(|theirs| {
        let long = |m: &&(_, crate::Configuration)| {
            (m.1.rest_length_m - theirs.rest_length_m).abs() < SAME_LENGTH_M
        };
        let own = |t: &&TestErrors| {
            let mut of = group.members.iter().map(|m| &**m).filter(|m| long(m));
            t.fitted && of.any(|(_, c)| c.tests.iter().any(|k| k.session == t.session))
        };
        let own: Vec<&TestErrors> = tests.iter().filter(own).collect();
        (!own.is_empty()).then(|| theirs.beside(&own))
    });
    with_tests.collect()
}

struct Theirs {
    name: String,
    knee: String,
    muscle: String,
    diameter_mm: f64,
    rest_length_m: f64,
    part: String,
    rigid: Option<Reached>,
    after: Reached,
}

impl Theirs {
    fn beside(&self, tests: &[&TestErrors]) -> ByHand {
        ByHand {
            name: self.name.clone(),
            part: self.part.clone(),
            their_rigid: self.rigid,
            theirs: self.after,
            readings: tests.iter().filter_map(|t| Some(t.before?.n)).sum(),
            rigid: pooled(tests.iter().map(|t| t.before)),
            after: pooled(tests.iter().map(|t| t.after)),
            held_out: pooled(tests.iter().map(|t| t.held_out)),
        }
    }
}

/// The errors of some tests together; none where one has none.
fn pooled(tests: impl Iterator<Item = Option<Size>>) -> Option<Reached> {
    let all: Vec<Size> = tests.collect::<Option<_>>()?;
    let (n, sse) = all
        .iter()
        .fold((0, 0.0), |(n, sse), s| (n + s.n, sse + s.sse));
    Some(Reached {
        rmse_nm: (sse / n as f64).sqrt(),
        max_nm: all.iter().fold(0.0, |max, s| s.max_abs.max(max)),
    })
}

/// Their table; empty if it cannot be read, which its test excludes.
fn theirs() -> Vec<Theirs> {
    let read = || {
        let table = data::table("measurers_by_hand.csv").ok()?;
        let text = |column: &str| table.text(column).ok();
        let numbers = |column: &str| table.numbers(column).ok();
        let (name, knee, muscle) = (text("name")?, text("knee")?, text("muscle")?);
        let (part, diameter) = (text("part")?, numbers("diameter_mm")?);
        let length = numbers("rest_length_mm")?;
        let (rigid, rigid_max) = (numbers("rigid_rmse_nm")?, numbers("rigid_max_nm")?);
        let (after, after_max) = (numbers("after_rmse_nm")?, numbers("after_max_nm")?);
        let row = |k: usize| Theirs {
            name: name[k].to_owned(),
            knee: knee[k].to_owned(),
            muscle: muscle[k].to_owned(),
            diameter_mm: diameter[k],
            rest_length_m: 1e-3 * length[k],
            part: part[k].to_owned(),
            rigid: Some(reached(rigid[k], rigid_max[k])).filter(|r| r.rmse_nm.is_finite()),
            after: reached(after[k], after_max[k]),
        };
        Some((0..name.len()).map(row).collect())
    };
    read().unwrap_or_default()
}

fn reached(rmse_nm: f64, max_nm: f64) -> Reached {
    Reached { rmse_nm, max_nm }
}

#[cfg(test)]
mod unit {
    use super::*;

    #[test]
    fn their_table_is_read() {
        let all = theirs();
        assert_eq!(all.len(), 6);
        assert_eq!(all[0].rigid, Some(reached(4.82, 9.87)));
        assert_eq!(all[1].after, reached(2.12, 5.17));
        assert_eq!(all[3].rigid, None);
    }
}
