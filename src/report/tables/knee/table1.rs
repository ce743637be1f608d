//! `knee_table1`: the knee paper's Table 1, origins and insertions, as printed.

use crate::described::*;
use crate::input::ReportInput;
use pipeline_mechanics::knee::data;

/// Muscle, end, model; coordinates, m, NaN where there are none.
type Point<'a> = ([&'a str; 3], [f64; 3]);

/// One row a point; empty where nobody measured torque.
#[rustfmt::skip]
pub fn table1(input: &ReportInput) -> Table {
    let printed = input.knee.as_ref().and_then(|_| data::table("table1.csv").ok());
    let points = printed.as_ref().and_then(points).unwrap_or_default();
    Described::<Point>::new("knee_table1", "Origins (femur's frame) and insertions (tibia's frame) as the knee paper prints them in its Table 1")
        .text("muscle", "Muscle", |(words, _)| words[0])
        .text("end", "End", |(words, _)| words[1])
        .text("knee", "Model", |(words, _)| words[2])
        .number("x_m", "\\v{x}", M, Decimals(4), |(_, at)| finite(at[0]))
        .number("y_m", "\\v{y}", M, Decimals(4), |(_, at)| finite(at[1]))
        .number("z_m", "\\v{z}", M, Decimals(4), |(_, at)| finite(at[2]))
        .note("The program follows the laboratory's own files where they differ: y of the biomimetic flexors' origin is 0.035 m (the printed −0.045 m belongs to the pinned flexor's insertion, and its path would be shorter than the actuator), and the second point of Bifemsh is not its insertion. An insertion without coordinates moves with the patella.")
        .blocks(runs(points, |a, b| a.0[2] == b.0[2]))
}

fn points(printed: &data::Table) -> Option<Vec<Point<'_>>> {
    let texts = |column| printed.text(column).ok();
    let numbers = |column| printed.numbers(column).ok();
    let words = [texts("muscle")?, texts("end")?, texts("knee")?];
    let at = [numbers("x_m")?, numbers("y_m")?, numbers("z_m")?];
    let point = |k| ([0, 1, 2].map(|c| words[c][k]), [0, 1, 2].map(|c| at[c][k]));
    Some((0..words[0].len()).map(point).collect())
}
