//! Values outside the range that a paper itself states.

use crate::claims::{Bound, Claim, ClaimList, End};
use crate::findings::{Case, Rule, Verdict};
use std::collections::BTreeMap;

pub(super) const RULE: Rule = Rule {
    id: "ranges",
    title: "Values outside the stated range",
    idea: "Where a paper says in which range it measured, what it reports as measured or predicted must lie in it.",
    cases,
};

fn cases(list: &ClaimList) -> Vec<Case> {
    // Values in the order of their size, so that one actuator used in several sentences is one case.
    let mut used: BTreeMap<(&str, u64), (f64, Vec<&Claim>)> = BTreeMap::new();
    for claim in list.claims() {
        for u in &claim.uses {
            let key = (u.quantity.as_str(), u.value.to_bits());
            used.entry(key)
                .or_insert((u.value, Vec::new()))
                .1
                .push(claim);
        }
    }
    let of = |((quantity, _), (value, claims)): (_, (f64, Vec<&Claim>))| {
        case(list, quantity, value, &claims)
    };
    used.into_iter().filter_map(of).collect()
}

/// The value against the range; `None` without a range.
fn case(list: &ClaimList, quantity: &str, value: f64, claims: &[&Claim]) -> Option<Case> {
    let end = |end: End| {
        let of = |b: &Bound| b.quantity == quantity && b.end == end;
        list.claims().find(|c| c.bounds.as_ref().is_some_and(of))
    };
    let (low, high) = (end(End::Low)?, end(End::High)?);
    let inside = value >= low.printed.ends().0 && value <= high.printed.ends().1;
    let unit = &low.unit;
    let nearest = if value < low.printed.value { low } else { high };
    let mut places: Vec<&str> = claims.iter().map(|c| c.at.as_str()).collect();
    places.dedup();
    Some(Case {
        subject: format!("{quantity}: {value} {unit}"),
        of: claims.iter().map(|c| c.id.clone()).collect(),
        verdict: if inside {
            Verdict::Consistent
        } else {
            Verdict::Inconsistent
        },
        left: Some(value),
        right: Some(nearest.printed.value),
        unit: unit.clone(),
        reasoning: format!(
            "{value} {unit} is used in {} place{} ({}); {} states {} to {} {unit}.",
            claims.len(),
            if claims.len() == 1 { "" } else { "s" },
            places.join(", "),
            low.at,
            low.printed.text,
            high.printed.text,
        ),
    })
}
