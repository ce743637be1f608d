//! Two rows of different equations or subjects that print the same statistics: one of them was copied.

use crate::claims::{Claim, ClaimList, Kind, Split};
use crate::findings::{Case, Rule, Verdict};

pub(super) const RULE: Rule = Rule {
    id: "copied_rows",
    title: "Rows that repeat each other",
    idea: "Adjusted R², RMSE and largest error are three numbers of one set of residuals; two different sets that agree in all three, to every digit printed, are in truth one.",
    cases,
};

const TRIPLE: [Kind; 3] = [Kind::AdjR2, Kind::Rmse, Kind::MaxError];

/// The triple of one fit on one set of rows.
struct Row<'a> {
    name: String,
    /// The fit and its rows: a fit that is printed in two places is one.
    of: (&'a str, Split),
    claims: [&'a Claim; 3],
}

fn cases(list: &ClaimList) -> Vec<Case> {
    let mut rows = Vec::new();
    for fit in list.fits() {
        for split in [Split::Model, Split::Validation, Split::Comparison] {
            let found = TRIPLE.map(|kind| list.statistic(&fit.id, split, kind));
            if let [Some(a), Some(b), Some(c)] = found {
                rows.push(Row {
                    name: format!("{} ({})", fit.title, split.name()),
                    of: (fit.validated_as.as_deref().unwrap_or(&fit.id), split),
                    claims: [a, b, c],
                });
            }
        }
    }
    let pairs = rows
        .iter()
        .enumerate()
        .flat_map(|(k, a)| rows[k + 1..].iter().map(move |b| (a, b)));
    pairs
        .filter(|(a, b)| a.of != b.of)
        .map(|(a, b)| case(a, b))
        .collect()
}

fn case(a: &Row, b: &Row) -> Case {
    let pairs = || a.claims.iter().zip(b.claims);
    let same = pairs().all(|(x, y)| x.printed.may_equal(&y.printed) && x.unit == y.unit);
    let triple = |row: &Row| {
        row.claims
            .map(|c| format!("{} {}", c.printed.text, c.unit).trim().to_owned())
            .join(", ")
    };
    Case {
        subject: format!("{} and {}", a.name, b.name),
        of: a
            .claims
            .iter()
            .chain(&b.claims)
            .map(|c| c.id.clone())
            .collect(),
        verdict: if same {
            Verdict::Inconsistent
        } else {
            Verdict::Consistent
        },
        left: Some(a.claims[1].printed.value),
        right: Some(b.claims[1].printed.value),
        unit: a.claims[1].unit.clone(),
        reasoning: if same {
            format!(
                "{} and {} print the same three statistics ({}; {}), so that one row repeats the other or both describe the same residuals.",
                a.name,
                b.name,
                triple(a),
                triple(b)
            )
        } else {
            "They differ.".to_owned()
        },
    }
}
