//! `audit`: every numeric claim of the papers beside what is recomputed, then every test of consistency.

use crate::audit::{besides, near, remark, status};
use crate::described::*;
use pipeline_audit::claims::Relation;
use pipeline_audit::findings::{Audit, Case, ClaimFinding, RuleFinding};
use pipeline_audit::recompute::Status;

/// What a row says.
#[derive(Clone, Copy)]
enum Row<'a> {
    Claim(&'a ClaimFinding),
    Case(&'a RuleFinding, &'a Case),
}

impl<'a> Row<'a> {
    /// Something of a claim, or else of a case.
    fn of<T>(
        self,
        claim: impl Fn(&'a ClaimFinding) -> T,
        case: impl Fn(&'a RuleFinding, &'a Case) -> T,
    ) -> T {
        match self {
            Row::Claim(c) => claim(c),
            Row::Case(rule, c) => case(rule, c),
        }
    }

    /// Something of a claim, and nothing of a case.
    fn claim<T>(self, claim: impl Fn(&'a ClaimFinding) -> T) -> Option<T> {
        self.of(|c| Some(claim(c)), |_, _| None)
    }
}

/// The table of an audit.
#[rustfmt::skip]
pub fn audit(audit: &Audit) -> Table {
    let claims: Vec<Row> = audit.claims.iter().map(Row::Claim).collect();
    let cases = audit.rules.iter().map(|rule| rule.cases.iter().map(move |case| Row::Case(rule, case)).collect());
    Described::<Row>::new("audit", "The papers' numeric claims against what is recomputed, and their consistency")
        .text("kind", "Kind", |r| r.of(|_| "claim", |_, _| "consistency")).machines()
        .text("id", "Id", |r| r.of(|f| f.claim.id.as_str(), |rule, _| rule.id)).machines()
        .text("paper", "Paper", |r| r.claim(|f| &f.paper)).machines()
        .text("section", "Section", |r| r.of(|f| f.section.as_str(), |rule, _| rule.title)).machines()
        .text("where", "Where", |r| r.of(|f| &f.claim.at, |_, c| &c.subject))
        .text("quote", "Claim", |r| r.claim(|f| &f.claim.quote))
        .text("printed", "Printed", |r| r.of(|f| Some(f.claim.printed.text.clone()), |_, c| ascii(c.left)))
        .number("published", "Published", One, Digits(5), |r| r.of(|f| Some(f.claim.printed.value), |_, c| c.left)).machines()
        .text("recomputed", "Recomputed", |r| r.of(|f| Some(near(&f.claim.printed, f.recomputed?.value)), |_, c| ascii(c.right))).people()
        .number("recomputed", "Recomputed", One, Digits(5), |r| r.of(|f| Some(f.recomputed?.value), |_, c| c.right)).machines()
        .number("from_printed_inputs", "From the printed inputs", One, Digits(5), |r| r.of(|f| Some(f.from_print?.value), |_, _| None)).machines()
        .number("relative_difference", "Relative difference", One, Digits(5), |r| r.of(|f| off(&f.status), |_, c| finite(c.right? / c.left? - 1.0))).machines()
        .text("unit", "Unit", |r| r.of(|f| &f.claim.unit, |_, c| &c.unit))
        .text("status", "Status", |r| r.of(|f| status(&f.status), |_, c| c.verdict.name()))
        .text("relation", "Relation", |r| r.claim(|f| relation(f.claim.relation))).machines()
        .text("how", "How", |r| r.of(|f| f.claim.recompute.as_ref().map_or_else(String::new, |e| e.text.clone()), |_, c| c.of.join(" "))).machines()
        .text("traced_to", "Traced to", |r| r.claim(|f| f.traced_to.join(" "))).machines()
        .text("beside", "Beside", |r| r.claim(besides)).machines()
        .text("reasoning", "Reasoning", |r| r.of(remark, |_, c| c.reasoning.clone())).machines()
        .blocks([claims].into_iter().chain(cases))
}

/// A number of a test of consistency, as people read it.
fn ascii(value: Option<f64>) -> Option<String> {
    Some(Digits(4).round(value?)?.ascii())
}

fn off(status: &Status) -> Option<f64> {
    match status {
        Status::Differs { relative, .. } => Some(*relative),
        Status::Reproduced | Status::CannotBeRecomputed(_) => None,
    }
}

fn relation(relation: Relation) -> &'static str {
    match relation {
        Relation::Equal => "equal",
        Relation::AtMost => "at most",
    }
}
