//! `knee_errors`: errors of torque by test, model and basis, in the long form.

use super::decimals;
use crate::input::ReportInput;
use crate::table::{Cell, Column, Table};
use pipeline_torque::errors::{Errors, Size};

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("campaign", "Campaign"),
        Column::text("session", "Test"),
        Column::text("model", "Model"),
        Column::text("basis", "From"),
        Column::number("n", "\\v{n}", ""),
        Column::number("n_outside", "Outside", ""),
        Column::number("n_extrapolated", "Extrapolated", ""),
        Column::number("rmse_nm", "RMSE", "N.m"),
        Column::number("sse_nm2", "SSE", "N^{2}m^{2}"),
        Column::number("fvu", "FVU", ""),
        Column::number("max_abs_nm", "Max.", "N.m"),
        Column::number("bias_nm", "Bias", "N.m"),
    ];
    let mut table = Table::new(
        "knee_errors",
        "Errors of torque of every model: length and arm from the geometry of a rigid leg, or as measured by hand",
        columns,
    );
    for campaign in input.torque() {
        table.rule();
        for test in campaign.configurations.iter().flat_map(|c| &c.tests) {
            for e in &test.errors {
                table.push(row(&campaign.campaign, &test.session, e));
            }
        }
    }
    table
}

fn row(campaign: &str, session: &str, e: &Errors) -> Vec<Cell> {
    let size = |f: fn(&Size) -> f64, n| decimals(e.size.as_ref().map(f), n);
    vec![
        Cell::text(campaign),
        Cell::text(session),
        Cell::text(&e.model),
        Cell::text(e.basis.name()),
        Cell::Integer(e.n as i64),
        Cell::Integer(e.n_outside as i64),
        Cell::Integer(e.n_extrapolated as i64),
        size(|s| s.rmse, 2),
        size(|s| s.sse, 1),
        decimals(e.size.as_ref().and_then(|s| s.fvu), 3),
        size(|s| s.max_abs, 2),
        size(|s| s.bias, 2),
    ]
}
