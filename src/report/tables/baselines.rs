//! `baselines`: what each compared model reproduces of its authors' own numbers.

use crate::input::ReportInput;
use crate::table::{Cell, Column, Rounding, Table};
use pipeline_mechanics::models::gate::{Gate, gate};

/// The table; it depends on no data.
pub fn table(_: &ReportInput) -> Table {
    let columns = vec![
        Column::text("model", "Model"),
        Column::number("diameter_mm", "⌀", "mm"),
        Column::text("against", "Reproduces"),
        Column::number("values", "Values", ""),
        Column::number("miss", "Miss", ""),
        Column::number("claimed", "Claimed", ""),
        Column::number("allowed", "Allowed", ""),
        Column::text("verdict", "Compared"),
    ];
    let mut table = Table::new(
        "baselines",
        "Baselines: what each model reproduces before it is compared",
        columns,
    )
    .note("Misses are the largest, as a share of the largest force among the values. A model that misses by more than is allowed is not compared.");
    let mut model = None;
    for gate in gate() {
        if model != Some(gate.model) {
            table.rule();
        }
        model = Some(gate.model);
        table.push(row(&gate));
    }
    table
}

fn row(gate: &Gate) -> Vec<Cell> {
    let share = |x: f64| {
        let decimals = if x < 1e-3 { 3 } else { 1 };
        Cell::number(x.is_finite().then_some(x), Rounding::Percent(decimals))
    };
    let known = gate.values > 0;
    vec![
        Cell::text(gate.model),
        if known {
            Cell::Integer(i64::from(gate.diameter_mm))
        } else {
            Cell::Empty
        },
        Cell::text(if known {
            gate.against
        } else {
            "nothing: its authors printed no force"
        }),
        Cell::Integer(gate.values as i64),
        share(gate.miss),
        gate.claimed.map_or(Cell::Empty, share),
        share(gate.allowed),
        Cell::text(match (known, gate.passes()) {
            (false, _) => "yes, unchecked",
            (true, true) => "yes",
            (true, false) => "no",
        }),
    ]
}
