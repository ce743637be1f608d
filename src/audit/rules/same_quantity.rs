//! The same quantity, printed with different values in different places.

use super::show;
use crate::claims::{Claim, ClaimList};
use crate::findings::{Case, Rule, Verdict};
use std::collections::BTreeMap;

pub(super) const RULE: Rule = Rule {
    id: "same_quantity",
    title: "The same quantity in different places",
    idea: "A quantity that is printed in several places must be the same number in all of them, up to the digits printed.",
    cases,
};

fn cases(list: &ClaimList) -> Vec<Case> {
    let mut places: BTreeMap<&str, Vec<&Claim>> = BTreeMap::new();
    for claim in list.claims() {
        if let Some(quantity) = &claim.quantity {
            places.entry(quantity).or_default().push(claim);
        }
    }
    let several = places.into_iter().filter(|(_, claims)| claims.len() > 1);
    several
        .map(|(quantity, claims)| case(quantity, &claims))
        .collect()
}

fn case(quantity: &str, claims: &[&Claim]) -> Case {
    let first = claims[0];
    let other = claims
        .iter()
        .find(|c| !c.printed.may_equal(&first.printed) || c.unit != first.unit);
    let at = |c: &Claim| format!("{} {} ({})", c.printed.text, c.unit, c.at).replace("  ", " ");
    let places: Vec<String> = claims.iter().map(|c| at(c)).collect();
    let reasoning = match other {
        Some(other) => format!(
            "Printed as {}: {}% apart.",
            places.join(" and as "),
            show(
                100.0 * (other.printed.value / first.printed.value - 1.0).abs(),
                2
            )
        ),
        None => format!("Printed alike: {}.", places.join(", ")),
    };
    Case {
        subject: quantity.to_owned(),
        of: claims.iter().map(|c| c.id.clone()).collect(),
        verdict: if other.is_some() {
            Verdict::Inconsistent
        } else {
            Verdict::Consistent
        },
        left: Some(first.printed.value),
        right: Some(other.unwrap_or(&claims[1]).printed.value),
        unit: first.unit.clone(),
        reasoning,
    }
}
