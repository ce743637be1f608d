//! Predicted torque over the range of a knee, one row an angle. Not among the tables of a run.

use crate::table::{Cell, Column, Rounding, Table};
use pipeline_predict::torque::AtAngle;

/// One row an angle.
pub fn table(found: &[AtAngle]) -> Table {
    let columns = vec![
        Column::number("angle_deg", "Knee angle", "°"),
        Column::number("length_mm", "l_m", "mm"),
        Column::number("contraction_rel", "ε*", ""),
        Column::number("arm_mm", "\\v{r}", "mm"),
        Column::number("force_n", "\\v{F}", "N"),
        Column::number("torque_nm", "\\v{M}", "N.m"),
        Column::interval("interval_nm", "95% interval", "N.m"),
        Column::number("human_nm", "Human", "N.m"),
        Column::flag("meets", "Meets it"),
        Column::text("warnings", "Outside"),
    ];
    let mut table = Table::new("torque", "Predicted torque", columns);
    let number = |x: Option<f64>, decimals| Cell::number(x, Rounding::Decimals(decimals));
    for a in found {
        table.push(vec![
            number(Some(a.angle_deg), 1),
            number(Some(1e3 * a.length_m), 1),
            number(a.contraction_rel, 3),
            number(Some(1e3 * a.arm_m), 1),
            number(a.force_n, 1),
            number(a.torque_nm, 2),
            a.interval_nm
                .map_or(Cell::Empty, |(low, high)| Cell::Interval {
                    low,
                    high,
                    rounding: Rounding::Decimals(2),
                }),
            number(a.human_nm, 2),
            a.meets.map_or(Cell::Empty, Cell::Flag),
            Cell::text(a.warnings.join("; ")),
        ]);
    }
    table
}
