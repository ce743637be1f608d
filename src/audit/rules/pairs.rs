//! Two printed forms of one thing, evaluated at the same state.

use super::show;
use crate::claims::{ClaimList, Pair, Relation};
use crate::findings::{Case, Rule, Verdict};
use crate::printed::is_within;
use crate::recompute::{Depth, evaluate};

pub(super) const RULE: Rule = Rule {
    id: "pairs",
    title: "Printed forms that must agree",
    idea: "An equation that is printed in two places, or that must have a known value at a known state, is evaluated in both forms with the printed coefficients; they may differ by what the rounding of these allows, and by the tolerance named.",
    cases,
};

fn cases(list: &ClaimList) -> Vec<Case> {
    list.pairs().map(|pair| case(list, pair)).collect()
}

fn case(list: &ClaimList, pair: &Pair) -> Case {
    let left = evaluate(list, &pair.left, Depth::Printed);
    let right = evaluate(list, &pair.right, Depth::Printed);
    let allowed = left.slack + right.slack + pair.tolerance * right.value.abs();
    let off = match pair.relation {
        Relation::Equal => left.value - right.value,
        Relation::AtMost => (left.value - right.value).max(0.0),
    };
    // Where rounding moves a value by more than itself it has no value there, and allows for nothing.
    let at_pole = left.slack > left.value.abs() && left.value.abs() > right.value.abs();
    let holds = !at_pole && off.is_finite() && is_within(off, allowed, right.value);
    let unit = if pair.unit.is_empty() {
        String::new()
    } else {
        format!(" {}", pair.unit)
    };
    let apart = match pair.relation {
        Relation::Equal => format!(
            "{}% apart",
            show(100.0 * (left.value / right.value - 1.0).abs(), 2)
        ),
        Relation::AtMost if holds => "not more, as it must be".to_owned(),
        Relation::AtMost => "more than it can be".to_owned(),
    };
    Case {
        subject: pair.what.clone(),
        of: vec![pair.id.clone()],
        verdict: if holds {
            Verdict::Consistent
        } else {
            Verdict::Inconsistent
        },
        left: Some(left.value),
        right: Some(right.value),
        unit: pair.unit.clone(),
        reasoning: format!(
            "{}: {}{unit}. {}: {}{unit}, {apart}{}. {}",
            pair.left_at,
            show(left.value, 4),
            pair.right_at,
            show(right.value, 4),
            match (holds, at_pole) {
                (true, _) => "",
                (false, true) =>
                    " (a pole: the rounding of the coefficients alone moves it by more than itself)",
                (false, false) => ", more than rounding and tolerance allow",
            },
            pair.because
        ),
    }
}
