//! `specimens`: the actuators, and their measured maximum force.

use crate::described::*;
use crate::input::GroupInput;
use pipeline_fit::SpecimenSummary;

type Row<'a> = (&'a GroupInput, &'a SpecimenSummary);

/// One row a specimen.
#[rustfmt::skip]
pub fn specimens(groups: &[GroupInput]) -> Table {
    Described::<Row>::new("specimens", "Specimens, and their measured maximum force at 620 kPa and resting length")
        .text("group", "Group", |(g, _)| &g.fit.group.campaign).machines()
        .count("diameter_mm", "⌀", Mm, |(g, _)| g.fit.group.diameter_mm).machines()
        .text("specimen", "Specimen", |(_, s)| &s.id)
        .text("campaign", "Campaign", |(_, s)| &s.campaign).machines()
        .number("rest_length_mm", "l_{rest}", Mm, Decimals(0), |(_, s)| 1e3 * s.rest_length_m)
        .number("contraction_620", "ε_{620}", One, Decimals(3), |(_, s)| s.contraction_620)
        .count("sessions", "Sessions", One, |(_, s)| s.sessions)
        .count("rows", "Readings", One, |(_, s)| s.rows)
        .number("largest_force_n", "Largest \\v{F}", N, Decimals(1), |(_, s)| s.largest_force_n)
        .number("f_620_n", "F_{620}", N, Decimals(1), |(_, s)| s.maximum.as_ref().map(|m| m.force_n))
        .text("f_620_from", "F_{620} from", |(_, s)| s.maximum.as_ref().map(|m| &m.method))
        .blocks(groups.iter().map(|g| g.fit.specimens.iter().map(move |s| (g, s))))
}
