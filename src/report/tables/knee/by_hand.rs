//! `knee_by_hand`: what the measurers of the knee paper reached by hand, beside the loop.

use super::{decimals, named};
use crate::input::ReportInput;
use crate::table::{Audience, Cell, Column, Table};
use pipeline_torque::CampaignTorque;
use pipeline_torque::diagnose::JointDiagnosis;
use pipeline_torque::diagnose::measurers::{ByHand, Reached};

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    build(input.torque())
}

/// One campaign.
pub fn of_campaign(campaign: &CampaignTorque) -> Table {
    named(build([campaign]), campaign)
}

/// Whose error: name in files, heading.
const OF: [(&str, &str); 5] = [
    ("their_rigid", "rigid"),
    ("theirs", "by hand"),
    ("rigid", "rigid"),
    ("after", "loop"),
    ("held_out", "loop, held out"),
];

fn build<'a>(campaigns: impl IntoIterator<Item = &'a CampaignTorque>) -> Table {
    let mut columns = vec![
        Column::text("campaign", "Campaign").seen_by(Audience::Machines),
        Column::text("joint", "Joint"),
        Column::number("diameter_mm", "⌀", "mm"),
        Column::text("actuator", "Actuator"),
        Column::text("part", "By them"),
    ];
    for (id, heading) in OF {
        if id == "rigid" {
            columns.push(Column::number("n", "\\v{n}", ""));
        }
        columns.push(Column::number(&format!("{id}_rmse_nm"), heading, ""));
        columns.push(Column::number(&format!("{id}_max_nm"), "max.", ""));
    }
    let mut table = Table::new(
        "knee_by_hand",
        "What the measurers reached by hand, and the loop on actuators of the same length",
        columns,
    )
    .span("Measurers (N m)", "their_rigid_rmse_nm", "theirs_max_nm")
    .span("Here (N m)", "n", "held_out_max_nm")
    .note(
        "RMSE and largest size of the error. The measurers fitted by hand over years, with a law of force of their own and tests that they do not name, \
         so that their rigid leg has other errors than this one. Here every test of the actuator that is not excluded counts; held out means that neither effects nor sizes know the actuator.",
    );
    for campaign in campaigns {
        for joint in &campaign.diagnoses {
            for theirs in &joint.by_hand {
                table.push(row(joint, theirs));
            }
        }
    }
    table
}

fn row(joint: &JointDiagnosis, theirs: &ByHand) -> Vec<Cell> {
    let found = &joint.findings;
    let both = |r: Option<Reached>| {
        [
            decimals(r.map(|r| r.rmse_nm), 2),
            decimals(r.map(|r| r.max_nm), 2),
        ]
    };
    let mut row = vec![
        Cell::text(&found.campaign),
        Cell::text(found.part.as_deref().unwrap_or_default()),
        Cell::Integer(i64::from(found.diameter_mm)),
        Cell::text(&theirs.name),
        Cell::text(&theirs.part),
    ];
    row.extend(both(theirs.their_rigid));
    row.extend(both(Some(theirs.theirs)));
    row.push(Cell::Integer(theirs.readings as i64));
    row.extend(both(theirs.rigid));
    row.extend(both(theirs.after));
    row.extend(both(theirs.held_out));
    row
}
