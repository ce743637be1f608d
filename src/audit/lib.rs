#![warn(missing_docs)]
//! The audit: what the papers claim in numbers, beside what the program recomputes by itself.
//!
//! The claims are data ([`claims`], TOML files below `claims/`). Each says where it stands, what is printed, and how it is recomputed, in
//! a small language ([`expression`], [`functions`]): equations and models at a state, and arithmetic on other claims. A claim agrees
//! if the recomputed number lies within half a unit of its last printed digit. It is recomputed from the printed numbers and all the
//! way down ([`recompute`]), so that a worked example shows where its error enters. Statistics of the authors' own points cannot be
//! recomputed; what the measured campaigns at hand give for them stands beside ([`beside`]).
//!
//! [`rules`] test the list for consistency: the same quantity twice, copied rows, training against validation errors, what a robust fit's
//! printed RMSE stands for, values outside stated ranges, printed forms of one equation, intervals, impossible residuals.
//!
//! | to add | where |
//! |---|---|
//! | a claim, a fit, a pair | a table in a file below `claims/` |
//! | a function for recomputations | a line in [`functions`] |
//! | a rule | a file in `rules/` and a line in [`rules::ALL`] |
//!
//! Architecture invariant: pure, no I/O; and no code here knows a particular claim, so that a corrected paper passes.

pub mod beside;
pub mod claims;
pub mod expression;
pub mod findings;
pub mod functions;
pub mod printed;
pub mod printed_forms;
pub mod recompute;
pub mod rules;

#[cfg(test)]
mod tests;

use beside::Beside;
use claims::{Claim, ClaimList, EMBEDDED, Kind, Section, Split};
use findings::{Audit, ClaimFinding, RuleFinding};
use pipeline_compare::GroupComparison;
use pipeline_fit::GroupFit;
use recompute::{Depth, Status, evaluate, judge};

/// Audits the embedded claims; the groups' fits and comparisons stand beside what cannot be recomputed.
pub fn audit(fits: &[&GroupFit], comparisons: &[&GroupComparison]) -> Audit {
    audit_list(&EMBEDDED, fits, comparisons)
}

/// Audits a list of claims.
pub fn audit_list(list: &ClaimList, fits: &[&GroupFit], comparisons: &[&GroupComparison]) -> Audit {
    let of_section = |section: &Section| -> Vec<ClaimFinding> {
        let of = |c: &Claim| find(list, section, c, fits, comparisons);
        section.claims.iter().map(of).collect()
    };
    let mut claims: Vec<ClaimFinding> = list.sections.iter().flat_map(of_section).collect();
    trace(&mut claims);
    let rules = rules::ALL.iter().map(|rule| RuleFinding {
        id: rule.id,
        title: rule.title,
        idea: rule.idea,
        cases: (rule.cases)(list),
    });
    Audit {
        claims,
        rules: rules.collect(),
    }
}

/// A printed statistic of a fit of the force paper: of the program's equation id, diameter in mm, rows, kind, and coefficient where it
/// is of one. `None` where the paper prints none. Tables come before the text.
pub fn published(
    equation: &str,
    diameter_mm: u32,
    split: Split,
    kind: Kind,
    symbol: Option<&str>,
) -> Option<&'static Claim> {
    let list: &'static ClaimList = &EMBEDDED;
    let of_force_paper = list.sections.iter().filter(|s| s.paper == "force");
    let matches = |claim: &&Claim| {
        claim.statistic.as_ref().is_some_and(|s| {
            let of_equation =
                |f: &claims::Fit| f.equation == equation && f.diameter_mm == diameter_mm;
            s.split == split
                && s.kind == kind
                && s.symbol.as_deref() == symbol
                && list.fit(&s.fit).is_some_and(of_equation)
        })
    };
    let found = of_force_paper.flat_map(|s| &s.claims).filter(matches);
    found.min_by_key(|c| !c.at.starts_with("Table"))
}

fn find(
    list: &ClaimList,
    section: &Section,
    claim: &Claim,
    fits: &[&GroupFit],
    comparisons: &[&GroupComparison],
) -> ClaimFinding {
    let recompute = claim.recompute.as_ref();
    let recomputed = recompute.map(|e| evaluate(list, e, Depth::Recomputed));
    let reason = claim.cannot.map_or("", |c| c.reason());
    let cannot = || Status::CannotBeRecomputed(reason.to_owned());
    ClaimFinding {
        section: section.title.clone(),
        paper: section.paper.clone(),
        claim: claim.clone(),
        recomputed: recomputed.filter(|n| n.value.is_finite()),
        from_print: recompute
            .filter(|e| !e.claims().is_empty())
            .map(|e| evaluate(list, e, Depth::Printed)),
        status: recomputed.map_or_else(cannot, |number| judge(claim, number)),
        traced_to: Vec::new(),
        beside: stand_beside(list, claim, fits, comparisons),
    }
}

fn stand_beside(
    list: &ClaimList,
    claim: &Claim,
    fits: &[&GroupFit],
    comparisons: &[&GroupComparison],
) -> Vec<Beside> {
    let mut found = Vec::new();
    if let Some(expression) = &claim.beside {
        let value = evaluate(list, expression, Depth::Printed).value;
        found.push(Beside {
            from: expression.text.clone(),
            honest: value.is_finite().then_some(value),
            compatible: None,
        });
    }
    if let Some(statistic) = &claim.statistic
        && let Some(fit) = list.fit(&statistic.fit)
    {
        let percent = claim.unit == "%";
        found.extend(beside::of_fits(fit, statistic, percent, fits));
    }
    if let Some(error) = &claim.error_of {
        found.extend(beside::of_models(error, comparisons));
    }
    found
}

/// Names, for every claim that differs, those among the claims it rests on that differ beyond rounding.
fn trace(findings: &mut [ClaimFinding]) {
    let differs = |f: &ClaimFinding| {
        matches!(
            f.status,
            Status::Differs {
                rounding: false,
                ..
            }
        )
    };
    let wrong: Vec<String> = findings
        .iter()
        .filter(|f| differs(f))
        .map(|f| f.claim.id.clone())
        .collect();
    for finding in findings
        .iter_mut()
        .filter(|f| matches!(f.status, Status::Differs { .. }))
    {
        let rests_on = finding.claim.recompute.iter().flat_map(|e| e.claims());
        let found = rests_on.filter(|id| wrong.iter().any(|w| w == id));
        finding.traced_to = found.map(str::to_owned).collect();
    }
}
