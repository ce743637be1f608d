//! `knee_tests`: what was measured of torque, and how far length, eps* and arm measured by hand are from the geometry.

use super::mm;
use crate::described::*;
use pipeline_numerics::statistics::mean;
use pipeline_torque::{CampaignTorque, Configuration, Test};

type Row<'a> = (&'a CampaignTorque, &'a Configuration, &'a Test);

/// One row a test.
#[rustfmt::skip]
pub fn tests(campaigns: &[CampaignTorque]) -> Table {
    let configurations = campaigns.iter().flat_map(|campaign| campaign.configurations.iter().map(move |c| (campaign, c)));
    Described::<Row>::new("knee_tests", "Tests of torque: values measured by hand minus those expected from the geometry of the leg (means over \
         the readings)")
        .text("campaign", "Campaign", |(campaign, ..)| &campaign.campaign).machines()
        .text("session", "Test", |(.., t)| &t.session)
        .text("configuration", "Configuration", |(_, c, _)| &c.id).machines()
        .text("knee", "Knee", |(_, c, _)| &c.knee).machines()
        .text("muscle", "Muscle", |(_, c, _)| &c.muscle).machines()
        .text("leg", "Leg", |(_, c, _)| format!("{} {}", c.knee, c.muscle)).people()
        .text("route", "Route", |(_, c, _)| &c.route).machines()
        .text("specimen", "Specimen", |(_, c, _)| &c.specimen).machines()
        .count("diameter_mm", "⌀", Mm, |(_, c, _)| c.diameter_mm)
        .number("rest_length_mm", "l_{rest}", Mm, Decimals(0), |(_, c, _)| mm(c.rest_length_m))
        .number("contracted_length_mm", "l_{620}", Mm, Decimals(0), |(_, c, _)| mm(c.contracted_length_m)).machines()
        .number("tendon_mm", "Tendon", Mm, Decimals(0), |(_, c, _)| c.tendon_m.map(mm))
        .number("fitting_mm", "l_{fit}", Mm, Decimals(1), |(_, c, _)| mm(c.fitting_m)).machines()
        .count("readings", "\\v{n}", One, |(.., t)| t.points.len())
        .count("beyond_joint", "Beyond joint", One, |(.., t)| t.points.iter().filter(|p| p.beyond.is_some()).count()).machines()
        .number("pressure_kpa", "\\v{P}", KPa, Decimals(0), |(.., t)| finite(pressure_kpa(t)))
        .number("contraction_rel_difference", "Δε*", One, Decimals(3), |(.., t)| Some(t.hand.contraction_rel?.mean))
        .number("contraction_rel_rms", "rms Δε*", One, Decimals(3), |(.., t)| Some(t.hand.contraction_rel?.rms)).machines()
        .number("length_difference_mm", "Δl_m", Mm, Decimals(1), |(.., t)| Some(mm(t.hand.length_m?.mean)))
        .number("length_rms_mm", "rms Δl_m", Mm, Decimals(1), |(.., t)| Some(mm(t.hand.length_m?.rms))).machines()
        .number("arm_difference_mm", "Δ\\v{r}", Mm, Decimals(1), |(.., t)| Some(mm(t.hand.arm_m?.mean)))
        .number("arm_rms_mm", "rms Δ\\v{r}", Mm, Decimals(1), |(.., t)| Some(mm(t.hand.arm_m?.rms))).machines()
        .number("projected_arm_difference_mm", "Δ\\v{r} (Eq. 3)", Mm, Decimals(1), |(.., t)| Some(mm(t.hand.projected_arm_m?.mean))).machines()
        .number("projected_arm_rms_mm", "rms Δ\\v{r} (Eq. 3)", Mm, Decimals(1), |(.., t)| Some(mm(t.hand.projected_arm_m?.rms))).machines()
        .flag("simulated", "Simulated", |(campaign, ..)| campaign.simulated).machines()
        .text("excluded", "Excluded because", |(.., t)| &t.excluded).machines()
        .text("doubtful", "Doubtful because", |(.., t)| &t.doubtful).machines()
        .text("remark", "Remark", |(.., t)| remark(t)).people()
        .text("remarks", "Remarks", |(_, c, _)| c.remarks.join("; ")).machines()
        .text("notes", "Notes", |(.., t)| &t.notes).machines()
        .note("Δε*, Δl_m and Δ\\v{r}: measured relative contraction, length and moment arm minus those that follow from the knee angle.")
        .blocks(configurations.map(|(campaign, c)| c.tests.iter().map(move |t| (campaign, c, t))))
}

fn pressure_kpa(test: &Test) -> f64 {
    let all: Vec<f64> = test.points.iter().map(|p| p.pressure_kpa).collect();
    mean(&all)
}

fn remark(test: &Test) -> Option<&'static str> {
    match (&test.excluded, &test.doubtful) {
        (Some(_), _) => Some("excluded"),
        (None, Some(_)) => Some("doubtful"),
        (None, None) => (!test.is_fitted()).then_some("not fitted"),
    }
}
