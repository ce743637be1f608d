//! RMSE and largest error of the same residuals: neither more than the largest error, nor less than that one residual alone makes it.

use super::{rows, show};
use crate::claims::{Claim, ClaimList, Fit, Kind, Split};
use crate::findings::{Case, Rule, Verdict};

pub(super) const RULE: Rule = Rule {
    id: "residuals",
    title: "RMSE against largest error",
    idea: "An RMSE cannot exceed the largest error by more than its degrees of freedom allow; and the largest error alone makes an RMSE of at least max/√(n − p).",
    cases,
};

fn cases(list: &ClaimList) -> Vec<Case> {
    let mut cases = Vec::new();
    for fit in list.fits() {
        for split in [Split::Model, Split::Validation, Split::Comparison] {
            let of = |kind| list.statistic(&fit.id, split, kind);
            if let (Some(rmse), Some(most)) = (of(Kind::Rmse), of(Kind::MaxError)) {
                cases.push(case(list, fit, split, rmse, most));
            }
        }
    }
    cases
}

fn case(list: &ClaimList, fit: &Fit, split: Split, rmse: &Claim, most: &Claim) -> Case {
    let share = if most.unit == "%" && rmse.unit != "%" {
        0.01
    } else {
        1.0
    };
    let (known, p) = match split {
        Split::Model => (rows(list, fit).0, fit.coefficients as f64),
        Split::Validation => (rows(list, fit).1, 0.0),
        Split::Comparison => (None, 0.0),
    };
    let largest = share * most.printed.value;
    let low = share * most.printed.ends().0;
    let least = known.map(|n| low / (n - p).sqrt());
    let too_small = least.is_some_and(|least| rmse.printed.ends().1 < least);
    let freedom = known.map_or(1.0, |n| (n / (n - p)).sqrt());
    let too_large = rmse.printed.ends().0 > freedom * share * most.printed.ends().1;
    let numbers = format!(
        "RMSE {}, largest error {}",
        show(rmse.printed.value, 4),
        show(largest, 3)
    );
    Case {
        subject: format!("{}: {}", fit.title, split.name()),
        of: vec![rmse.id.clone(), most.id.clone()],
        verdict: if too_small || too_large {
            Verdict::Inconsistent
        } else {
            Verdict::Consistent
        },
        left: Some(rmse.printed.value),
        right: Some(least.unwrap_or(largest)),
        unit: rmse.unit.clone(),
        reasoning: match (too_small, too_large, known) {
            (true, _, Some(n)) => format!(
                "{numbers}: among {n} rows this one residual alone makes the RMSE at least {}. The printed RMSE is not that of these residuals.",
                show(least.unwrap_or(f64::NAN), 3)
            ),
            (_, true, _) => format!("{numbers}: no RMSE exceeds the largest error."),
            (_, _, Some(n)) => format!("{numbers}, {n} rows: possible."),
            _ => format!("{numbers}: possible; the number of rows is not given."),
        },
    }
}
