//! The pages of `audit.pdf`: the claims that differ, all claims by section, the tests of consistency.

use crate::number::Rounding;
use crate::pages::PageData;
use crate::typeset::Pdf;
use pipeline_audit::claims::Relation;
use pipeline_audit::findings::{Audit, Case, ClaimFinding, RuleFinding, Verdict};
use pipeline_audit::printed::Printed;
use pipeline_audit::recompute::Status;
use pipeline_base::error::Result;
use serde::Serialize;

const TEMPLATE: &str = include_str!("templates/audit.typ");

#[derive(Serialize)]
struct Own {
    counts: Counts,
    differ: Vec<Row>,
    last_digit: Vec<Row>,
    inconsistent: Vec<Inconsistent>,
    /// Claims that are reproduced, section by section.
    sections: Vec<Section>,
    /// Claims that rest on what the authors alone have.
    cannot: Vec<Row>,
    rules: Vec<Rule>,
}

#[derive(Serialize)]
struct Counts {
    claims: usize,
    reproduced: usize,
    differ: usize,
    last_digit: usize,
    cannot: usize,
    tests: usize,
    inconsistent: usize,
}

#[derive(Clone, Serialize)]
struct Row {
    at: String,
    quote: String,
    printed: String,
    recomputed: String,
    unit: String,
    off: String,
    status: &'static str,
    remark: String,
}

#[derive(Serialize)]
struct Section {
    title: String,
    rows: Vec<Row>,
}

#[derive(Serialize)]
struct Inconsistent {
    rule: &'static str,
    subject: String,
}

#[derive(Serialize)]
struct Rule {
    title: &'static str,
    idea: &'static str,
    tests: usize,
    inconsistent: usize,
    cases: Vec<CaseRow>,
}

#[derive(Serialize)]
struct CaseRow {
    subject: String,
    inconsistent: bool,
    reasoning: String,
}

/// Typesets `audit.pdf`; `input` is the digest of the inputs.
///
/// # Errors
/// A template that does not compile.
pub fn audit_pdf(audit: &Audit, input: &str, date: Option<(i32, u8, u8)>) -> Result<Pdf> {
    PageData::new(input, [], own(audit))
        .document(TEMPLATE, date)?
        .compile()
}

/// A status in words.
pub fn status(status: &Status) -> &'static str {
    match status {
        Status::Reproduced => "reproduced",
        Status::Differs {
            rounding: false, ..
        } => "differs",
        Status::Differs { rounding: true, .. } => "differs in the last digit",
        Status::CannotBeRecomputed(_) => "cannot be recomputed",
    }
}

/// A number with one digit more than it is printed with.
pub fn near(printed: &Printed, value: f64) -> String {
    let text = &printed.text;
    let rounding = match (text.contains('e'), text.split_once('.')) {
        (true, _) => Rounding::Digits(4),
        (false, None) => Rounding::Decimals(1),
        (false, Some((_, fraction))) => Rounding::Decimals(fraction.len() + 1),
    };
    rounding
        .round(value)
        .map_or_else(String::new, |r| r.typeset())
}

/// What stands beside a claim, in words.
pub fn besides(finding: &ClaimFinding) -> String {
    let printed = &finding.claim.printed;
    let one = |b: &pipeline_audit::beside::Beside| {
        let honest = b.honest.map(|x| near(printed, x));
        let compatible = b
            .compatible
            .map(|x| format!("printed by a robust fit {}", near(printed, x)));
        let both: Vec<String> = honest.into_iter().chain(compatible).collect();
        format!("{}: {}", b.from, both.join(", "))
    };
    let all: Vec<String> = finding.beside.iter().map(one).collect();
    all.join("; ")
}

/// What there is to say of a claim: how it was recomputed, or why not, and where its error comes from.
pub fn remark(finding: &ClaimFinding) -> String {
    let claim = &finding.claim;
    let mut parts = Vec::new();
    if let Some(expression) = &claim.recompute {
        parts.push(format!("= {}", expression.text));
    }
    if let Status::CannotBeRecomputed(why) = &finding.status {
        parts.push(why.clone());
    }
    if let (Status::Differs { .. }, Some(own), Some(holds)) = (
        &finding.status,
        finding.from_print,
        finding.own_arithmetic_holds(),
    ) {
        let own = near(&claim.printed, own.value);
        parts.push(match holds {
            true => format!("from the numbers as printed: {own}, which its rounding allows"),
            false => format!("from the numbers as printed: {own}"),
        });
    }
    if !finding.traced_to.is_empty() {
        parts.push(format!(
            "its error enters with {}",
            finding.traced_to.join(", ")
        ));
    }
    let beside = besides(finding);
    if !beside.is_empty() {
        parts.push(format!("beside it: {beside}"));
    }
    parts.join("; ")
}

fn own(audit: &Audit) -> Own {
    let of = |wanted: &str| -> Vec<Row> {
        let found = audit.claims.iter().filter(|f| status(&f.status) == wanted);
        found.map(row).collect()
    };
    let rules: Vec<Rule> = audit.rules.iter().map(rule).collect();
    let (differ, last_digit) = (of("differs"), of("differs in the last digit"));
    let cannot = of("cannot be recomputed");
    Own {
        counts: Counts {
            claims: audit.claims.len(),
            reproduced: of("reproduced").len(),
            differ: differ.len(),
            last_digit: last_digit.len(),
            cannot: cannot.len(),
            tests: rules.iter().map(|r| r.tests).sum(),
            inconsistent: rules.iter().map(|r| r.inconsistent).sum(),
        },
        differ,
        last_digit,
        inconsistent: inconsistent(audit),
        sections: sections(audit),
        cannot,
        rules,
    }
}

fn inconsistent(audit: &Audit) -> Vec<Inconsistent> {
    let of_rule = |rule: &RuleFinding| -> Vec<Inconsistent> {
        let cases = rule.cases.iter().filter(|c| is_inconsistent(c));
        let entry = |c: &Case| Inconsistent {
            rule: rule.title,
            subject: c.subject.clone(),
        };
        cases.map(entry).collect()
    };
    audit.rules.iter().flat_map(of_rule).collect()
}

fn is_inconsistent(case: &Case) -> bool {
    case.verdict == Verdict::Inconsistent
}

fn sections(audit: &Audit) -> Vec<Section> {
    let mut sections: Vec<Section> = Vec::new();
    let reproduced = |f: &&ClaimFinding| matches!(f.status, Status::Reproduced);
    for finding in audit.claims.iter().filter(reproduced) {
        if sections.last().is_none_or(|s| s.title != finding.section) {
            sections.push(Section {
                title: finding.section.clone(),
                rows: Vec::new(),
            });
        }
        if let Some(section) = sections.last_mut() {
            section.rows.push(row(finding));
        }
    }
    sections
}

fn row(finding: &ClaimFinding) -> Row {
    let claim = &finding.claim;
    let off = match finding.status {
        Status::Differs { relative, .. } => Rounding::Percent(1)
            .round(relative)
            .map_or_else(String::new, |r| {
                format!("{}{}%", if relative > 0.0 { "+" } else { "" }, r.typeset())
            }),
        Status::Reproduced | Status::CannotBeRecomputed(_) => String::new(),
    };
    let bound = match claim.relation {
        Relation::Equal => "",
        Relation::AtMost => "≤ ",
    };
    Row {
        at: claim.at.clone(),
        quote: claim.quote.clone(),
        printed: format!("{bound}{}", typeset(&claim.printed)),
        recomputed: finding
            .recomputed
            .map_or_else(String::new, |n| near(&claim.printed, n.value)),
        unit: claim.unit.clone(),
        off,
        status: status(&finding.status),
        remark: remark(finding),
    }
}

/// The printed number with a true minus sign.
fn typeset(printed: &Printed) -> String {
    printed.text.replace('-', "\u{2212}")
}

fn rule(rule: &RuleFinding) -> Rule {
    // Cases that pass are worth a line only where the same rule finds others that do not, and where they are few.
    const SHOWN: usize = 6;
    let (bad, good): (Vec<&Case>, Vec<&Case>) = rule.cases.iter().partition(|c| is_inconsistent(c));
    let shown = if good.len() <= SHOWN { good.len() } else { 0 };
    let entry = |case: &&Case| CaseRow {
        subject: case.subject.clone(),
        inconsistent: is_inconsistent(case),
        reasoning: case.reasoning.clone(),
    };
    Rule {
        title: rule.title,
        idea: rule.idea,
        tests: rule.cases.len(),
        inconsistent: bad.len(),
        cases: bad.iter().chain(&good[..shown]).map(entry).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recomputed_number_gets_one_digit_more_than_the_printed_one() {
        let printed = |text: &str| Printed::try_from(text.to_owned()).unwrap();
        assert_eq!(near(&printed("230"), 219.857), "219.9");
        assert_eq!(near(&printed("0.49"), 0.48387), "0.484");
        assert_eq!(near(&printed("8.614e-4"), 8.6e-4), "0.0008600");
    }

    #[test]
    fn the_pages_compile_without_a_warning() {
        let audit = pipeline_audit::audit(&[], &[]);
        let pdf = audit_pdf(&audit, "sha256:0123456789abcdef0123", None).unwrap();
        assert_eq!(pdf.warnings, Vec::<String>::new());
        assert!(pdf.sheets.len() > 4);
    }
}
