//! A linearised confidence interval lies symmetrically about its coefficient.

use super::show;
use crate::claims::{Claim, ClaimList, Fit, Kind};
use crate::findings::{Case, Rule, Verdict};
use crate::printed::is_within;

pub(super) const RULE: Rule = Rule {
    id: "intervals",
    title: "Coefficients and their intervals",
    idea: "The 95% intervals of these fits are the coefficient plus and minus a multiple of its standard error, so that the coefficient is their middle, up to the digits printed.",
    cases,
};

fn cases(list: &ClaimList) -> Vec<Case> {
    let of_fit = |fit: &Fit| -> Vec<Case> {
        let of = |kind| list.claims().filter(move |c| is_of(c, &fit.id, kind));
        of(Kind::Value)
            .filter_map(|value| {
                let end = |kind| {
                    let symbol = |c: &Claim| c.statistic.as_ref().and_then(|s| s.symbol.clone());
                    of(kind).find(|c| symbol(c) == symbol(value))
                };
                Some(case(fit, value, end(Kind::CiLow)?, end(Kind::CiHigh)?))
            })
            .collect()
    };
    list.fits().flat_map(of_fit).collect()
}

fn is_of(claim: &Claim, fit: &str, kind: Kind) -> bool {
    let of = claim.statistic.as_ref();
    of.is_some_and(|s| s.fit == fit && s.kind == kind)
}

fn case(fit: &Fit, value: &Claim, low: &Claim, high: &Claim) -> Case {
    let middle = 0.5 * (low.printed.value + high.printed.value);
    let rounding = value.printed.half_unit + 0.5 * (low.printed.half_unit + high.printed.half_unit);
    let symmetric = is_within(middle - value.printed.value, rounding, middle);
    let symbol = value
        .statistic
        .as_ref()
        .and_then(|s| s.symbol.as_deref())
        .unwrap_or("coefficient");
    Case {
        subject: format!("{}: {symbol}", fit.title),
        of: [value, low, high].map(|c| c.id.clone()).to_vec(),
        verdict: if symmetric {
            Verdict::Consistent
        } else {
            Verdict::Inconsistent
        },
        left: Some(value.printed.value),
        right: Some(middle),
        unit: value.unit.clone(),
        reasoning: format!(
            "{symbol} = {} with the interval ({}, {}), whose middle is {}{}",
            value.printed.text,
            low.printed.text,
            high.printed.text,
            show(middle, 5),
            if symmetric {
                "."
            } else {
                ", further off than rounding allows: one of the three is misprinted."
            },
        ),
    }
}
