//! `knee_fitting_errors`: how every length of the end fittings does on every configuration.

use super::fittings::origin;
use super::{decimals, mm};
use crate::input::ReportInput;
use crate::table::{Cell, Column, Table};

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("campaign", "Campaign"),
        Column::number("diameter_mm", "⌀", "mm"),
        Column::text("muscle", "Muscle"),
        Column::text("law", "Law of force"),
        Column::text("origin", "Length of the fittings"),
        Column::number("fitting_mm", "l_{fit}", "mm"),
        Column::text("configuration", "On"),
        Column::flag("fitted", "Fitted"),
        Column::number("n", "\\v{n}", ""),
        Column::number("sse_nm2", "SSE", "N^{2}m^{2}"),
        Column::number("rmse_nm", "RMSE", "N.m"),
        Column::number("fvu", "FVU", ""),
        Column::number("max_abs_nm", "Max.", "N.m"),
    ];
    let mut table = Table::new(
        "knee_fitting_errors",
        "Errors of torque on every configuration, by the length of the end fittings",
        columns,
    );
    for campaign in input.torque() {
        for fit in &campaign.fits {
            table.rule();
            for on in &fit.on {
                table.push(vec![
                    Cell::text(&campaign.campaign),
                    Cell::Integer(i64::from(fit.diameter_mm)),
                    Cell::text(&fit.muscle),
                    Cell::text(&fit.law),
                    Cell::text(origin(fit)),
                    mm(fit.fitting_m, 2),
                    Cell::text(&on.configuration),
                    Cell::Flag(on.fitted),
                    Cell::Integer(on.size.n as i64),
                    decimals(on.size.sse, 1),
                    decimals(on.size.rmse, 2),
                    decimals(on.size.fvu, 3),
                    decimals(on.size.max_abs, 2),
                ]);
            }
        }
    }
    table
}
