//! `knee_table1`: the knee paper's Table 1, origins and insertions, as printed.

use super::decimals;
use crate::input::ReportInput;
use crate::table::{Cell, Column, Table};
use pipeline_mechanics::knee::data;

/// The table; empty where nobody measured torque.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("muscle", "Muscle"),
        Column::text("end", "End"),
        Column::text("knee", "Model"),
        Column::number("x_m", "\\v{x}", "m"),
        Column::number("y_m", "\\v{y}", "m"),
        Column::number("z_m", "\\v{z}", "m"),
    ];
    let mut table = Table::new(
        "knee_table1",
        "Origins (femur's frame) and insertions (tibia's frame) as the knee paper prints them in its Table 1",
        columns,
    )
    .note("The program follows the laboratory's own files where they differ: y of the biomimetic flexors' origin is 0.035 m (the printed −0.045 m belongs to the pinned flexor's insertion, and its path would be shorter than the actuator), and the second point of Bifemsh is not its insertion. An insertion without coordinates moves with the patella.");
    if input.knee.is_some() {
        fill(&mut table).unwrap_or_default();
    }
    table
}

fn fill(table: &mut Table) -> Option<()> {
    let printed = data::table("table1.csv").ok()?;
    let texts = |column| printed.text(column).ok();
    let numbers = |column| printed.numbers(column).ok();
    let (muscle, end, knee) = (texts("muscle")?, texts("end")?, texts("knee")?);
    let at = [numbers("x_m")?, numbers("y_m")?, numbers("z_m")?];
    for k in 0..muscle.len() {
        if k > 0 && knee[k] != knee[k - 1] {
            table.rule();
        }
        let coordinate = |c: usize| decimals(Some(at[c][k]).filter(|x| x.is_finite()), 4);
        table.push(vec![
            Cell::text(muscle[k]),
            Cell::text(end[k]),
            Cell::text(knee[k]),
            coordinate(0),
            coordinate(1),
            coordinate(2),
        ]);
    }
    Some(())
}
