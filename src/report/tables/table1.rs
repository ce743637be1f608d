//! `table1`: the force paper's Table 1, maximum force: coefficients with intervals and goodness of fit, model and comparison.
//!
//! Eq. 7 is compared with the measured maxima at 620 kPa, Eqs. 5 and 6 with what the Festo tool says of the same maxima.

use crate::input::{GroupInput, ReportInput};
use crate::table::{Column, Table};
use crate::tables::paper::{self, Block, Side};
use pipeline_audit::claims::Split;
use pipeline_fit::equations::{FORCE_AT_REST, MAXIMUM_FORCE};

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
        "table1",
        "Maximum force: coefficients and goodness of fit",
        paper::columns(&[
            Column::number("max_abs_error", "Max. error", ""),
            Column::number("compared_max_abs_error", "Max. error", ""),
        ]),
    )
    .span("Model", "adj_r2", "max_abs_error")
    .span("Comparison", "compared_adj_r2", "compared_max_abs_error")
    .note(
        "As in the force paper, the comparison of F_{max} is with the measured maxima at 620 kPa, and that of F_{620} is what the Festo \
         tool leaves of the same maxima. Honest: of the residuals, intervals as configured; LAR-compatible: as a robust fit prints them.",
    );
    for group in groups {
        let maxima = group.comparison.maxima.as_ref();
        for (id, number, compared) in [
            (FORCE_AT_REST, "Eq. 7", maxima.and_then(|m| m.force_at_rest)),
            (
                MAXIMUM_FORCE,
                "Eqs. 5, 6",
                maxima.and_then(|m| m.festo_tool),
            ),
        ] {
            if let Some(equation) = group.fit.equation(id) {
                let model = paper::all_rows(equation);
                let block = Block {
                    group,
                    equation,
                    number,
                    model,
                    lar: equation.compatible.as_ref(),
                    compared: compared.map(|g| Side::of(&g)),
                    compared_as: Split::Comparison,
                    percent: false,
                };
                paper::push(&mut table, &block);
            }
        }
    }
    table
}
