//! `knee_design`: over which angles the full-size actuators meet the human muscles.

use super::{law_words, mm};
use crate::input::ReportInput;
use crate::table::{Audience, Cell, Column, Rounding, Table};
use pipeline_torque::diagnose::fittings::LAWS;

/// The table.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("muscle", "Muscle"),
        Column::text("human", "Human"),
        Column::number("diameter_mm", "⌀", "mm"),
        Column::number("rest_length_mm", "l_{rest}", "mm"),
        Column::text("law", "Law of force").seen_by(Audience::Machines),
        Column::text("law_words", "Law of force").seen_by(Audience::People),
        Column::number("largest_nm", "Largest", "N.m"),
        Column::number("human_largest_nm", "Human, largest", "N.m"),
        Column::text("met_deg", "Meets the human muscle at"),
        Column::text("met_within_data_deg", "Of that within its data"),
    ];
    let mut table = Table::new(
        "knee_design",
        "Full-size actuators on the biomimetic knee at 620 kPa beside the human muscles that they stand for",
        columns,
    );
    let largest = |values: &[f64]| values.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    for d in input.knee.iter().flat_map(|k| &k.reference.design) {
        let met = d.met_deg.iter().zip(&d.met_within_data_deg);
        for ((law, torques), (met, within_data)) in LAWS.iter().zip(&d.actuator_nm).zip(met) {
            let torques: Vec<f64> = torques.iter().flatten().copied().collect();
            table.push(vec![
                Cell::text(&d.muscle),
                Cell::text(&d.human),
                Cell::Integer(i64::from(d.diameter_mm)),
                mm(d.rest_length_m, 0),
                Cell::text(*law),
                Cell::text(law_words(law)),
                Cell::number(largest(&torques), Rounding::Decimals(1)),
                Cell::number(largest(&d.human_nm), Rounding::Decimals(1)),
                Cell::text(stretches(met)),
                Cell::text(stretches(within_data)),
            ]);
        }
    }
    table
}

/// "−120 to −68 deg".
fn stretches(met: &[(f64, f64)]) -> String {
    let one = |(from, to): &(f64, f64)| format!("{from:.0} to {to:.0}°");
    if met.is_empty() {
        "no angle".to_owned()
    } else {
        met.iter().map(one).collect::<Vec<_>>().join(", ")
    }
}
