//! `table2`: the force paper's Table 2, the surface F*(eps*, P*): coefficients with intervals and goodness of fit on training and
//! validation rows.

use crate::input::{GroupInput, ReportInput};
use crate::table::{Column, Table};
use crate::tables::paper::{self, Block, Side};
use pipeline_audit::claims::Split;
use pipeline_fit::equations::SURFACE;

/// All groups.
pub fn table(input: &ReportInput) -> Table {
    build(input.groups.iter().collect())
}

/// One group.
pub fn of_group(group: &GroupInput) -> Table {
    paper::of_group(build(vec![group]), group)
}

fn build(groups: Vec<&GroupInput>) -> Table {
    let mut table = Table::new(
        "table2",
        "Relative force: coefficients and goodness of fit",
        paper::columns(&[
            Column::number("max_abs_error", "Max. error", "%"),
            Column::number("compared_max_abs_error", "Max. error", "%"),
        ]),
    )
    .span("Model", "adj_r2", "max_abs_error")
    .span("Validation", "compared_adj_r2", "compared_max_abs_error")
    .note(
        "Model: the rows that the split by row trains on; validation: the others. Honest coefficients and intervals are those of all \
         rows, LAR-compatible ones those of the training rows. Rows of one log lie on both sides of this split: it says how well the \
         surface interpolates, not how well it predicts another actuator.",
    );
    for group in groups {
        let Some(equation) = group.fit.equation(SURFACE) else {
            continue;
        };
        let split = equation.by_rows.as_ref();
        let block = Block {
            group,
            equation,
            number: "Eq. 8",
            model: split.map_or_else(|| paper::all_rows(equation), |s| Side::of(&s.train)),
            lar: split.and_then(|s| s.compatible.as_ref()),
            compared: split.map(|s| Side::of(&s.validation)),
            compared_as: Split::Validation,
            percent: true,
        };
        paper::push(&mut table, &block);
    }
    table
}
