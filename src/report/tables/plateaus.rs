//! `plateaus`: one line a steady reading.

use crate::input::ReportInput;
use crate::table::{Cell, Column, Rounding, Table};
use pipeline_base::row::{Row, label_names};
use pipeline_base::session::Kind;
use std::collections::BTreeSet;

/// The table; extra columns follow the fixed ones by name, then labels. Torque sessions have theirs among the extra ones.
pub fn table(input: &ReportInput) -> Table {
    let labels = label_names(&input.rows);
    let names = input.rows.iter().flat_map(|r| r.extras.keys());
    let extras: BTreeSet<&String> = names.filter(|n| !labels.contains(*n)).collect();
    let mut columns = vec![
        Column::text("session", "Session"),
        Column::text("specimen", "Specimen"),
        Column::text("log", "Log"),
        Column::number("run", "Run", ""),
        Column::number("t_s", "\\v{t}", "s"),
        Column::text("phase", "Phase"),
        Column::number("pressure_kpa", "\\v{P}", "kPa"),
        Column::number("force_n", "\\v{F}", "N"),
        Column::number("length_mm", "\\v{l}", "mm"),
        Column::number("contraction", "ε", ""),
        Column::number("contraction_rel", "ε*", ""),
        Column::number("n_samples", "Samples", ""),
        Column::number("sd_force_n", "s.d. of \\v{F}", "N"),
        Column::text("campaign", "Campaign"),
    ];
    columns.extend(
        extras
            .iter()
            .map(|name| Column::number(name, &name.replace('_', "\\_"), "")),
    );
    columns.extend(
        labels
            .iter()
            .map(|name| Column::text(name, &name.replace('_', "\\_"))),
    );
    let mut table = Table::new("plateaus", "Steady readings", columns);
    for row in &input.rows {
        let mut cells = fixed(row);
        let extra =
            |name: &&String| Cell::number(row.extras.get(*name).copied(), Rounding::Digits(6));
        cells.extend(extras.iter().map(extra));
        let label = |name: &String| row.label(name).map_or(Cell::Empty, |w| Cell::text(&w));
        cells.extend(labels.iter().map(label));
        table.push(cells);
    }
    table
}

fn fixed(row: &Row) -> Vec<Cell> {
    let number = |x: f64, decimals: usize| {
        Cell::number(x.is_finite().then_some(x), Rounding::Decimals(decimals))
    };
    let force = if row.kind == Kind::Isometric {
        row.force_n
    } else {
        f64::NAN
    };
    vec![
        Cell::text(&row.session),
        Cell::text(&row.specimen),
        Cell::text(&row.log),
        row.run.map_or(Cell::Empty, Cell::Integer),
        number(row.time_s, 3),
        row.phase.map_or(Cell::Empty, |p| Cell::text(p.name())),
        number(row.pressure_kpa, 2),
        number(force, 2),
        number(1e3 * row.length_m, 1),
        number(row.contraction, 4),
        number(row.contraction_rel, 4),
        Cell::Integer(row.samples),
        number(row.sd_force_n, 2),
        Cell::text(&row.campaign),
    ]
}
