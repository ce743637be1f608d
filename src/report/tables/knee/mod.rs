//! The tables of torque: `knee_*`. A new file of tables is one line in the list below, with the tables in it.

use crate::input::ReportInput;
use crate::table::Table;
use pipeline_base::names::file_name;
use pipeline_torque::CampaignTorque;

tables! {
    tests: Torque[tests],
    errors: Torque[laws, models, errors],
    fittings: Torque[fittings, fitting_errors],
    joints: Torque[found, effects, by_hand],
    table1: Report[table1],
    geometry: Report[arms, switches, centres],
    human: Report[human, design],
    walls: Report[stress],
}

/// The tables that the pages show for one campaign, named after it.
pub fn of_campaign(campaign: &CampaignTorque) -> impl Iterator<Item = Table> {
    let shown: [fn(&[CampaignTorque]) -> Table; 7] = [
        tests::tests,
        errors::laws,
        errors::models,
        fittings::fittings,
        joints::found,
        joints::effects,
        joints::by_hand,
    ];
    super::of_one(shown, campaign, file_name(&campaign.campaign))
}

/// The tables that the pages show once.
pub fn once(input: &ReportInput) -> [Table; 7] {
    [
        table1::table1(input),
        geometry::arms(input),
        geometry::switches(input),
        geometry::centres(input),
        human::human(input),
        human::design(input),
        walls::stress(input),
    ]
}

/// A length in mm, given in m.
fn mm(length_m: f64) -> f64 {
    1e3 * length_m
}

/// What people call a law of force.
fn law_words(law: &str) -> &'static str {
    match law {
        "knee_paper" => "knee paper",
        _ => "force paper",
    }
}
