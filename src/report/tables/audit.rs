//! `audit`: every numeric claim of the papers beside what is recomputed, then every test of consistency.

use crate::audit::{besides, near, remark, status};
use crate::table::{Audience, Cell, Column, Rounding, Table};
use pipeline_audit::claims::Relation;
use pipeline_audit::findings::{Audit, Case, ClaimFinding, RuleFinding};
use pipeline_audit::recompute::Status;

/// The table of an audit.
pub fn table(audit: &Audit) -> Table {
    let mut table = Table::new(
        "audit",
        "The papers' numeric claims beside what is recomputed, and their consistency",
        columns(),
    );
    for finding in &audit.claims {
        table.push(claim(finding));
    }
    for rule in &audit.rules {
        table.rule();
        for found in &rule.cases {
            table.push(case(rule, found));
        }
    }
    table
}

fn columns() -> Vec<Column> {
    let machines = |column: Column| column.seen_by(Audience::Machines);
    vec![
        machines(Column::text("kind", "Kind")),
        machines(Column::text("id", "Id")),
        machines(Column::text("paper", "Paper")),
        machines(Column::text("section", "Section")),
        Column::text("where", "Where"),
        Column::text("quote", "Claim"),
        Column::text("printed", "Printed"),
        machines(Column::number("published", "Published", "")),
        Column::text("recomputed", "Recomputed").seen_by(Audience::People),
        machines(Column::number("recomputed", "Recomputed", "")),
        machines(Column::number(
            "from_printed_inputs",
            "From the printed inputs",
            "",
        )),
        machines(Column::number(
            "relative_difference",
            "Relative difference",
            "",
        )),
        Column::text("unit", "Unit"),
        Column::text("status", "Status"),
        machines(Column::text("relation", "Relation")),
        machines(Column::text("how", "How")),
        machines(Column::text("traced_to", "Traced to")),
        machines(Column::text("beside", "Beside")),
        machines(Column::text("reasoning", "Reasoning")),
    ]
}

fn number(value: Option<f64>) -> Cell {
    Cell::number(value, Rounding::Digits(5))
}

fn claim(finding: &ClaimFinding) -> Vec<Cell> {
    let claim = &finding.claim;
    let relative = match finding.status {
        Status::Differs { relative, .. } => Some(relative),
        Status::Reproduced | Status::CannotBeRecomputed(_) => None,
    };
    let how = claim.recompute.as_ref().map_or("", |e| e.text.as_str());
    vec![
        Cell::text("claim"),
        Cell::text(&claim.id),
        Cell::text(&finding.paper),
        Cell::text(&finding.section),
        Cell::text(&claim.at),
        Cell::text(&claim.quote),
        Cell::text(&claim.printed.text),
        number(Some(claim.printed.value)),
        finding
            .recomputed
            .map_or(Cell::Empty, |n| Cell::text(near(&claim.printed, n.value))),
        number(finding.recomputed.map(|n| n.value)),
        number(finding.from_print.map(|n| n.value)),
        number(relative),
        Cell::text(&claim.unit),
        Cell::text(status(&finding.status)),
        Cell::text(match claim.relation {
            Relation::Equal => "equal",
            Relation::AtMost => "at most",
        }),
        Cell::text(how),
        Cell::text(finding.traced_to.join(" ")),
        Cell::text(besides(finding)),
        Cell::text(remark(finding)),
    ]
}

fn case(rule: &RuleFinding, case: &Case) -> Vec<Cell> {
    let text = |value: Option<f64>| {
        let rounded = value.and_then(|x| Rounding::Digits(4).round(x));
        rounded.map_or(Cell::Empty, |r| Cell::text(r.ascii()))
    };
    let relative = case.left.zip(case.right).map(|(a, b)| b / a - 1.0);
    vec![
        Cell::text("consistency"),
        Cell::text(rule.id),
        Cell::Empty,
        Cell::text(rule.title),
        Cell::text(&case.subject),
        Cell::Empty,
        text(case.left),
        number(case.left),
        text(case.right),
        number(case.right),
        Cell::Empty,
        number(relative.filter(|x| x.is_finite())),
        Cell::text(&case.unit),
        Cell::text(case.verdict.name()),
        Cell::Empty,
        Cell::text(case.of.join(" ")),
        Cell::Empty,
        Cell::Empty,
        Cell::text(&case.reasoning),
    ]
}
