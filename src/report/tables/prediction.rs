//! Predicted forces as a table: a sweep or the designer's table, one row a state. Not among the tables of a run.

use crate::table::{Cell, Column, Rounding, Table};
use pipeline_predict::Answer;

/// One row an answer.
pub fn table<'a>(answers: impl IntoIterator<Item = &'a Answer>) -> Table {
    let columns = vec![
        Column::number("diameter_mm", "⌀", "mm"),
        Column::number("rest_length_mm", "l_{rest}", "mm"),
        Column::number("contraction_620", "ε_{620}", ""),
        Column::number("pressure_kpa", "\\v{P}", "kPa"),
        Column::number("length_mm", "\\v{l}", "mm"),
        Column::number("contraction", "ε", ""),
        Column::number("contraction_rel", "ε*", ""),
        Column::number("force_n", "\\v{F}", "N"),
        Column::interval("interval_n", "95% interval", "N"),
        Column::text("warnings", "Outside"),
    ];
    let mut table = Table::new("prediction", "Predicted force", columns);
    for answer in answers {
        table.push(row(answer));
    }
    table
}

fn row(answer: &Answer) -> Vec<Cell> {
    let number = |x: f64, decimals: usize| Cell::number(x, Rounding::Decimals(decimals));
    let optional = |x: Option<f64>| Cell::number(x, Rounding::Decimals(3));
    let muscle = &answer.muscle;
    let force = match (answer.force_n, &answer.interval) {
        (Some(force), Some(i)) => Cell::with_interval(force, i.low_n, i.high_n),
        (force, _) => [Cell::number(force, Rounding::Digits(4)), Cell::Empty],
    };
    let [force, interval] = force;
    vec![
        Cell::Integer(i64::from(muscle.diameter_mm)),
        number(1e3 * muscle.rest_length_m, 1),
        optional(muscle.contraction_620),
        number(answer.pressure_kpa, 1),
        number(1e3 * answer.length_m, 1),
        number(answer.contraction, 4),
        optional(answer.contraction_rel),
        force,
        interval,
        Cell::text(answer.warnings.join("; ")),
    ]
}
