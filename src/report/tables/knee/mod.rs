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
    let shown: [fn(&[CampaignTorque]) -> Table; 3] =
        [tests::tests, joints::found_in_print, joints::by_hand];
    super::of_one(shown, campaign, names(campaign))
}

/// The tables that the supplement shows for one campaign, named after it.
pub fn supplementary_of_campaign(campaign: &CampaignTorque) -> impl Iterator<Item = Table> {
    let shown: [fn(&[CampaignTorque]) -> Table; 5] = [
        tests::tests,
        joints::effects,
        errors::laws,
        errors::models,
        fittings::fittings,
    ];
    super::of_one(shown, campaign, names(campaign))
}

/// What files and captions call a campaign.
fn names(campaign: &CampaignTorque) -> (String, String) {
    (file_name(&campaign.campaign), campaign.campaign.clone())
}

/// The tables that the pages show once.
pub fn once(input: &ReportInput) -> [Table; 2] {
    [human::human(input), human::design(input)]
}

/// The tables that the supplement shows once; none where nobody measured torque.
pub fn supplementary(input: &ReportInput) -> impl Iterator<Item = Table> {
    let shown: [fn(&ReportInput) -> Table; 5] = [
        table1::table1,
        geometry::arms,
        geometry::switches,
        geometry::centres,
        walls::stress,
    ];
    let asked = input.knee.is_some();
    shown
        .into_iter()
        .filter(move |_| asked)
        .map(|make| make(input))
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
