//! The tables of torque: `knee_*`.

mod arms;
mod by_hand;
mod centres;
mod design;
mod effects;
mod errors;
mod fitting_errors;
mod fittings;
mod found;
mod human;
mod laws;
mod models;
mod stress;
mod switches;
mod table1;
mod tests;

use crate::input::ReportInput;
use crate::table::{Cell, Rounding, Table};
use pipeline_base::names::file_name;
use pipeline_torque::CampaignTorque;

/// Every table of torque, in the order in which the summary lists them.
pub const ALL: &[fn(&ReportInput) -> Table] = &[
    tests::table,
    laws::table,
    models::table,
    errors::table,
    fittings::table,
    fitting_errors::table,
    found::table,
    effects::table,
    by_hand::table,
    table1::table,
    arms::table,
    switches::table,
    centres::table,
    human::table,
    design::table,
    stress::table,
];

/// The tables that the pages show for one campaign, named after it.
pub const OF_CAMPAIGN: &[fn(&CampaignTorque) -> Table] = &[
    tests::of_campaign,
    laws::of_campaign,
    models::of_campaign,
    fittings::of_campaign,
    found::of_campaign,
    effects::of_campaign,
    by_hand::of_campaign,
];

/// The tables that the pages show once.
pub const ONCE: &[fn(&ReportInput) -> Table] = &[
    table1::table,
    arms::table,
    switches::table,
    centres::table,
    human::table,
    design::table,
    stress::table,
];

/// The same table, named after its campaign.
fn named(mut table: Table, campaign: &CampaignTorque) -> Table {
    table.id = format!("{}-{}", table.id, file_name(&campaign.campaign));
    table
}

/// A length in mm, given in m.
fn mm(length_m: impl Into<Option<f64>>, decimals: usize) -> Cell {
    let length: Option<f64> = length_m.into();
    Cell::number(length.map(|m| 1e3 * m), Rounding::Decimals(decimals))
}

/// A number with so many decimals.
fn decimals(value: impl Into<Option<f64>>, decimals: usize) -> Cell {
    Cell::number(value.into(), Rounding::Decimals(decimals))
}

/// What people call a law of force.
fn law_words(law: &str) -> &'static str {
    match law {
        "knee_paper" => "knee paper",
        _ => "force paper",
    }
}
