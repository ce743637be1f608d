//! `specimens`: the actuators, and their measured maximum force.

use crate::figures::slug;
use crate::input::{GroupInput, ReportInput};
use crate::table::{Audience, Cell, Column, Rounding, Table};

/// All groups.
pub fn table(input: &ReportInput) -> Table {
    build("specimens", input.groups.iter().collect())
}

/// One group.
pub fn of_group(group: &GroupInput) -> Table {
    let mut table = build("specimens", vec![group]);
    table.id = format!("specimens-{}", slug(group));
    table
}

fn build(id: &str, groups: Vec<&GroupInput>) -> Table {
    let columns = vec![
        Column::text("group", "Group").seen_by(Audience::Machines),
        Column::number("diameter_mm", "⌀", "mm").seen_by(Audience::Machines),
        Column::text("specimen", "Specimen"),
        Column::text("campaign", "Campaign").seen_by(Audience::Machines),
        Column::number("rest_length_mm", "l_{rest}", "mm"),
        Column::number("contraction_620", "ε_{620}", ""),
        Column::number("sessions", "Sessions", ""),
        Column::number("rows", "Readings", ""),
        Column::number("largest_force_n", "Largest \\v{F}", "N"),
        Column::number("f_620_n", "F_{620}", "N"),
        Column::text("f_620_from", "F_{620} from"),
    ];
    let mut table = Table::new(
        id,
        "Specimens, and their measured maximum force at 620 kPa and resting length",
        columns,
    );
    for group in groups {
        table.rule();
        for s in &group.fit.specimens {
            let maximum = s.maximum.as_ref();
            table.push(vec![
                Cell::text(&group.fit.group.campaign),
                Cell::Integer(i64::from(group.fit.group.diameter_mm)),
                Cell::text(&s.id),
                Cell::text(&s.campaign),
                Cell::number(1e3 * s.rest_length_m, Rounding::Decimals(0)),
                Cell::number(s.contraction_620, Rounding::Decimals(3)),
                Cell::Integer(s.sessions as i64),
                Cell::Integer(s.rows as i64),
                Cell::number(s.largest_force_n, Rounding::Decimals(1)),
                Cell::number(maximum.map(|m| m.force_n), Rounding::Decimals(1)),
                maximum.map_or(Cell::Empty, |m| Cell::text(&m.method)),
            ]);
        }
    }
    table
}
