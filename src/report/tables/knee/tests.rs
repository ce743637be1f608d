//! `knee_tests`: what was measured of torque, and how far length, eps* and arm measured by hand are from the geometry.

use super::{decimals, mm, named};
use crate::input::ReportInput;
use crate::table::{Audience, Cell, Column, Table};
use pipeline_numerics::statistics::mean;
use pipeline_torque::errors::Difference;
use pipeline_torque::{CampaignTorque, Configuration, Test};

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    build(input.torque())
}

/// One campaign.
pub fn of_campaign(campaign: &CampaignTorque) -> Table {
    named(build([campaign]), campaign)
}

fn build<'a>(campaigns: impl IntoIterator<Item = &'a CampaignTorque>) -> Table {
    let columns = vec![
        Column::text("campaign", "Campaign").seen_by(Audience::Machines),
        Column::text("session", "Test"),
        Column::text("configuration", "Configuration").seen_by(Audience::Machines),
        Column::text("knee", "Knee").seen_by(Audience::Machines),
        Column::text("muscle", "Muscle").seen_by(Audience::Machines),
        Column::text("leg", "Leg").seen_by(Audience::People),
        Column::text("route", "Route").seen_by(Audience::Machines),
        Column::text("specimen", "Specimen").seen_by(Audience::Machines),
        Column::number("diameter_mm", "⌀", "mm"),
        Column::number("rest_length_mm", "l_{rest}", "mm"),
        Column::number("contracted_length_mm", "l_{620}", "mm").seen_by(Audience::Machines),
        Column::number("tendon_mm", "Tendon", "mm"),
        Column::number("fitting_mm", "l_{fit}", "mm").seen_by(Audience::Machines),
        Column::number("readings", "\\v{n}", ""),
        Column::number("beyond_joint", "Beyond joint", "").seen_by(Audience::Machines),
        Column::number("pressure_kpa", "\\v{P}", "kPa"),
        Column::number("contraction_rel_difference", "Δε*", ""),
        Column::number("contraction_rel_rms", "rms Δε*", "").seen_by(Audience::Machines),
        Column::number("length_difference_mm", "Δl_m", "mm"),
        Column::number("length_rms_mm", "rms Δl_m", "mm").seen_by(Audience::Machines),
        Column::number("arm_difference_mm", "Δ\\v{r}", "mm"),
        Column::number("arm_rms_mm", "rms Δ\\v{r}", "mm").seen_by(Audience::Machines),
        Column::number("projected_arm_difference_mm", "Δ\\v{r} (Eq. 3)", "mm")
            .seen_by(Audience::Machines),
        Column::number("projected_arm_rms_mm", "rms Δ\\v{r} (Eq. 3)", "mm")
            .seen_by(Audience::Machines),
        Column::flag("simulated", "Simulated").seen_by(Audience::Machines),
        Column::text("excluded", "Excluded because").seen_by(Audience::Machines),
        Column::text("doubtful", "Doubtful because").seen_by(Audience::Machines),
        Column::text("remark", "Remark").seen_by(Audience::People),
        Column::text("remarks", "Remarks").seen_by(Audience::Machines),
        Column::text("notes", "Notes").seen_by(Audience::Machines),
    ];
    let mut table = Table::new(
        "knee_tests",
        "Tests of torque: what was measured by hand, less what the geometry of the leg expects (means over the readings)",
        columns,
    )
    .note("Δε*, Δl_m and Δ\\v{r}: measured relative contraction, length and moment arm less those that follow from the knee angle.");
    for campaign in campaigns {
        for configuration in &campaign.configurations {
            table.rule();
            for test in &configuration.tests {
                table.push(row(campaign, configuration, test));
            }
        }
    }
    table
}

fn row(campaign: &CampaignTorque, c: &Configuration, test: &Test) -> Vec<Cell> {
    let pressures: Vec<f64> = test.points.iter().map(|p| p.pressure_kpa).collect();
    let beyond = test.points.iter().filter(|p| p.beyond.is_some()).count();
    let hand = &test.hand;
    let in_mm = |d: Option<Difference>, f: fn(&Difference) -> f64| mm(d.as_ref().map(f), 1);
    let plain = |d: Option<Difference>, f: fn(&Difference) -> f64| decimals(d.as_ref().map(f), 3);
    let text = |t: &Option<String>| t.as_ref().map_or(Cell::Empty, Cell::text);
    vec![
        Cell::text(&campaign.campaign),
        Cell::text(&test.session),
        Cell::text(&c.id),
        Cell::text(&c.knee),
        Cell::text(&c.muscle),
        Cell::text(format!("{} {}", c.knee, c.muscle)),
        Cell::text(&c.route),
        Cell::text(&c.specimen),
        Cell::Integer(i64::from(c.diameter_mm)),
        mm(c.rest_length_m, 0),
        mm(c.contracted_length_m, 0),
        mm(c.tendon_m, 0),
        mm(c.fitting_m, 1),
        Cell::Integer(test.points.len() as i64),
        Cell::Integer(beyond as i64),
        decimals(Some(mean(&pressures)).filter(|p| p.is_finite()), 0),
        plain(hand.contraction_rel, |d| d.mean),
        plain(hand.contraction_rel, |d| d.rms),
        in_mm(hand.length_m, |d| d.mean),
        in_mm(hand.length_m, |d| d.rms),
        in_mm(hand.arm_m, |d| d.mean),
        in_mm(hand.arm_m, |d| d.rms),
        in_mm(hand.projected_arm_m, |d| d.mean),
        in_mm(hand.projected_arm_m, |d| d.rms),
        Cell::Flag(campaign.simulated),
        text(&test.excluded),
        text(&test.doubtful),
        remark(test),
        Cell::text(c.remarks.join("; ")),
        text(&test.notes),
    ]
}

fn remark(test: &Test) -> Cell {
    match (&test.excluded, &test.doubtful) {
        (Some(_), _) => Cell::text("excluded"),
        (None, Some(_)) => Cell::text("doubtful"),
        (None, None) if test.is_fitted() => Cell::Empty,
        (None, None) => Cell::text("not fitted"),
    }
}
