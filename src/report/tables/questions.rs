//! `questions`: does the residual of the base model depend on this column?

use crate::report::answers::finite;
use crate::report::input::ReportInput;
use crate::report::table::{Cell, Column, Rounding, Table};

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("campaign", "Campaign"),
        Column::number("diameter_mm", "⌀", "mm"),
        Column::text("column", "Column"),
        Column::text("blocks", "Permuted"),
        Column::number("share", "Share", ""),
        Column::number("p", "\\v{p}", ""),
        Column::number("p_adjusted", "\\v{p}, corrected", ""),
    ];
    let mut table = Table::new(
        "questions",
        "The questions asked of the residual before anything was added",
        columns,
    )
    .note(
        "\\v{Share} of the residual's sum of squares that the column explains beyond chance; \\v{p} by permutation of what is \
         exchangeable if the column says nothing, then corrected for the number of questions (Holm).",
    );
    for found in input.findings() {
        table.rule();
        for q in &found.questions {
            table.push(vec![
                Cell::text(&found.campaign),
                Cell::Integer(i64::from(found.diameter_mm)),
                Cell::text(&q.column),
                Cell::text(&q.blocks),
                finite(q.share, Rounding::Decimals(3)),
                finite(q.p, Rounding::Digits(2)),
                finite(q.p_adjusted, Rounding::Digits(2)),
            ]);
        }
    }
    table
}
