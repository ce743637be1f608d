//! `detection_limits`: the smallest size of every effect that a campaign could have shown, and what it cannot show at all.

use super::described::{Of, number, of_all, optional, text};
use crate::input::ReportInput;
use crate::table::{Cell, Rounding, Table};
use crate::wording::number::finite;
use pipeline_findings::{CampaignFindings, DetectionLimit, NotMeasurable, WhyNot};

/// What a row says.
enum Line<'a> {
    Limit(&'a DetectionLimit),
    Not(&'a NotMeasurable),
}

type Row<'a> = Of<'a, Line<'a>>;

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        text("id", "Effect", |r: &Row| match r.one {
            Line::Limit(l) => Cell::text(&l.id),
            Line::Not(n) => Cell::text(&n.id),
        }),
        text("form", "Form", |r: &Row| match r.one {
            Line::Limit(l) => Cell::text(&l.form),
            Line::Not(n) => optional(n.form.as_deref()),
        }),
        number("smallest", "Smallest", "", |r| {
            limit(r, |l| finite(l.smallest, Rounding::Digits(2)))
        }),
        text("unit", "Unit", |r| limit(r, |l| Cell::text(&l.unit))),
        number("identifiable_share", "Identifiable share", "", |r| {
            limit(r, |l| finite(l.identifiable_share, Rounding::Decimals(2)))
        }),
        text("not_measurable", "Not measurable", |r| {
            not(r, |n| Cell::text(reason(n.reason)))
        }),
        text("by", "By", |r| not(r, |n| optional(n.by.as_deref()))),
    ];
    let caption =
        "The smallest size of every effect that a campaign would have shown in 80 of 100 cases";
    of_all(input, ("detection_limits", caption), columns, rows).note(
        "\\v{Identifiable share}: what the fitted coefficients leave of the effect's sensitivity. \\v{Not measurable}: absorbed by a coefficient or an effect, no column for it, \
         beyond its physical bounds, or without any trace in the readings.",
    )
}

fn rows(found: &CampaignFindings) -> Vec<Line<'_>> {
    let limits = found.detection_limits.iter().map(Line::Limit);
    limits
        .chain(found.not_measurable.iter().map(Line::Not))
        .collect()
}

fn limit(row: &Row, cell: fn(&DetectionLimit) -> Cell) -> Cell {
    match row.one {
        Line::Limit(l) => cell(l),
        Line::Not(_) => Cell::Empty,
    }
}

fn not(row: &Row, cell: fn(&NotMeasurable) -> Cell) -> Cell {
    match row.one {
        Line::Limit(_) => Cell::Empty,
        Line::Not(n) => cell(n),
    }
}

fn reason(why: WhyNot) -> &'static str {
    match why {
        WhyNot::Absorbed => "absorbed",
        WhyNot::NoColumn => "no_column",
        WhyNot::Bound => "bound",
        WhyNot::NoTrace => "no_trace",
    }
}
