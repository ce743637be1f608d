//! Recomputing a claim, twice: with the numbers as the text prints them, and all the way down, every number recomputed that can be.
//!
//! The verdict is that of the second. The first tells whether the text's own arithmetic holds, and so where an error enters a worked
//! example. Printed numbers are rounded: `slack` is how far their rounding can move the result, the sum over all printed numbers of
//! the change that half a unit of the last digit makes. A setting is exact: 620 kPa is what forces are normalised by, not a reading.

use super::claims::{Cannot, Claim, ClaimList, Relation};
use super::expression::Expression;
use super::printed::is_within;
use std::collections::BTreeSet;

/// How far down numbers are recomputed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// Every number as printed.
    Printed,
    /// Every number recomputed that can be.
    Recomputed,
}

/// A recomputed number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// Its value.
    pub value: f64,
    /// How far the rounding of printed numbers can move it.
    pub slack: f64,
}

/// What became of a claim.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// The recomputed number is printed like the claim, or fulfils what is claimed of it.
    Reproduced,
    /// It is not.
    Differs {
        /// Recomputed over printed, less one.
        relative: f64,
        /// Whether rounding of the printed numbers can explain it.
        rounding: bool,
    },
    /// There is nothing to recompute it from.
    CannotBeRecomputed(String),
}

/// Evaluates an expression with its slack.
pub fn evaluate(list: &ClaimList, expression: &Expression, depth: Depth) -> Number {
    let value = Values {
        list,
        depth,
        nudge: None,
    }
    .of(expression);
    let mut slack = 0.0;
    for leaf in leaves(list, expression, depth) {
        let change = |sign: f64| {
            let nudge = Some((leaf.id.as_str(), sign * leaf.printed.half_unit));
            let moved = Values { list, depth, nudge }.of(expression) - value;
            if moved.is_finite() { moved.abs() } else { 0.0 }
        };
        slack += change(1.0).max(change(-1.0));
    }
    Number { value, slack }
}

/// The verdict on a number that was recomputed for a claim.
pub fn judge(claim: &Claim, number: Number) -> Status {
    let (printed, tolerance) = (claim.printed.value, claim.tolerance());
    if !number.value.is_finite() {
        return Status::CannotBeRecomputed("the model has no answer at this state".to_owned());
    }
    let off = match claim.relation {
        Relation::Equal => number.value - printed,
        Relation::AtMost => (number.value - printed - tolerance).max(0.0),
    };
    if is_within(off, tolerance, printed) {
        return Status::Reproduced;
    }
    Status::Differs {
        relative: number.value / printed - 1.0,
        rounding: is_within(off, tolerance + number.slack, printed),
    }
}

/// The claims whose printed, rounded numbers enter an expression.
fn leaves<'a>(list: &'a ClaimList, expression: &Expression, depth: Depth) -> Vec<&'a Claim> {
    let mut seen = BTreeSet::new();
    let mut open: Vec<&Claim> = expression
        .claims()
        .iter()
        .filter_map(|id| list.claim(id))
        .collect();
    let mut leaves = Vec::new();
    while let Some(claim) = open.pop() {
        if !seen.insert(claim.id.as_str()) {
            continue;
        }
        match source(claim, depth) {
            Some(inner) => open.extend(inner.claims().iter().filter_map(|id| list.claim(id))),
            None if claim.cannot == Some(Cannot::Setting) => {}
            None => leaves.push(claim),
        }
    }
    leaves.sort_by(|a, b| a.id.cmp(&b.id));
    leaves
}

/// What a claim's number is taken from where another needs it; none for the printed number itself. A limit ("at most 10%") stays as
/// printed, for what is recomputed is not the limit.
fn source(claim: &Claim, depth: Depth) -> Option<&Expression> {
    let recomputed = depth == Depth::Recomputed && claim.relation == Relation::Equal;
    claim.recompute.as_ref().filter(|_| recomputed)
}

struct Values<'a> {
    list: &'a ClaimList,
    depth: Depth,
    nudge: Option<(&'a str, f64)>,
}

impl Values<'_> {
    fn of(&self, expression: &Expression) -> f64 {
        expression.evaluate(&|id| self.claim(id))
    }

    fn claim(&self, id: &str) -> f64 {
        let Some(claim) = self.list.claim(id) else {
            return f64::NAN;
        };
        match source(claim, self.depth) {
            Some(expression) => self.of(expression),
            None => {
                let nudge = self.nudge.filter(|(at, _)| *at == id).map_or(0.0, |n| n.1);
                claim.printed.value + nudge
            }
        }
    }
}
