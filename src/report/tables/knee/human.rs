//! `knee_human`, `knee_design`: the human muscles beside OpenSim's exports and the design targets; over which angles the full-size actuators meet
//! them.

use super::{law_words, mm};
use crate::described::*;
use crate::input::ReportInput;
use crate::wording::name::muscle;
use crate::wording::number::unit as unit_words;
use pipeline_torque::diagnose::fittings::LAWS;
use pipeline_torque::reference::design::Design;
use pipeline_torque::reference::human::{Compared, Compares};

/// One row a muscle and reference.
#[rustfmt::skip]
pub fn human(input: &ReportInput) -> Table {
    let unit = |h: &Compared| match h.what {
        Compares::Arm => (1e3, "mm"),
        Compares::Torque => (1.0, "N.m"),
    };
    Described::<&Compared>::new("knee_human", "Human muscles: calculated moment arm and torque against the references, over the whole range of the knee")
        .text("muscle", "Muscle", |h| &h.muscle).machines()
        .text("muscle_words", "Muscle", |h| muscle(&h.muscle)).people()
        .text("quantity", "Quantity", |h| h.what.name())
        .text("against", "Beside", |h| &h.against)
        .count("n", "\\v{n}", One, |h| h.rows.len())
        .number("rms", "rms", One, Digits(2), move |h| unit(h).0 * h.rms)
        .number("max", "Largest", One, Digits(2), move |h| unit(h).0 * h.max)
        .text("unit", "", move |h| unit(h).1).machines()
        .text("unit_words", "", move |h| unit_words(unit(h).1)).people()
        .number("at_deg", "at", Degree, Decimals(0), |h| h.at_deg)
        .number("max_relative", "Largest", PerCent, Digits(2), |h| 100.0 * h.max_relative)
        .text("why", "What is left", |h| &h.why).machines()
        .text("why_words", "What is left", |h| with_muscles(&h.why)).people()
        .rows(input.knee.iter().flat_map(|k| &k.reference.human))
}

/// One row an actuator and law of force, by its place.
#[rustfmt::skip]
pub fn design(input: &ReportInput) -> Table {
    let designs = input.knee.iter().flat_map(|k| &k.reference.design);
    Described::<(&Design, usize)>::new("knee_design", "Full-size actuators on the biomimetic knee at 620 kPa against the human muscles that they \
         represent")
        .text("muscle", "Muscle", |(d, _)| &d.muscle)
        .text("human", "Human", |(d, _)| &d.human).machines()
        .text("human_words", "Human", |(d, _)| muscle(&d.human)).people()
        .count("diameter_mm", "⌀", Mm, |(d, _)| d.diameter_mm)
        .number("rest_length_mm", "l_{rest}", Mm, Decimals(0), |(d, _)| mm(d.rest_length_m))
        .text("law", "Law of force", |(_, law)| LAWS[law]).machines()
        .text("law_words", "Law of force", |(_, law)| law_words(LAWS[law])).people()
        .number("largest_nm", "Largest", Nm, Decimals(1), |(d, law)| largest(d.actuator_nm[law].iter().flatten()))
        .number("human_largest_nm", "Human, largest", Nm, Decimals(1), |(d, _)| largest(&d.human_nm))
        .text("met_deg", "Meets the human muscle at", |(d, law)| stretches(&d.met_deg[law])).machines()
        .text("met_words", "Meets the human muscle at", |(d, law)| with_minus(&stretches(&d.met_deg[law]))).people()
        .text("met_within_data_deg", "Of which within its data", |(d, law)| stretches(&d.met_within_data_deg[law])).machines()
        .text("met_within_data_words", "Of which within its data", |(d, law)| with_minus(&stretches(&d.met_within_data_deg[law]))).people()
        .rows(designs.flat_map(|d| (0..LAWS.len()).map(move |law| (d, law))))
}

/// A sentence with the muscles by their names.
fn with_muscles(words: &str) -> String {
    let ids = ["bifemsh", "vas_int", "vas_lat", "vas_med"];
    let named = |words: String, id: &&str| words.replace(id, muscle(id));
    ids.iter().fold(words.to_owned(), named)
}

fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// Numbers in a text with the sign of print.
fn with_minus(text: &str) -> String {
    text.replace('-', "−")
}

/// "-120 to -68°".
fn stretches(met: &[(f64, f64)]) -> String {
    let one = |(from, to): &(f64, f64)| format!("{from:.0} to {to:.0}°");
    if met.is_empty() {
        "no angle".to_owned()
    } else {
        met.iter().map(one).collect::<Vec<_>>().join(", ")
    }
}
