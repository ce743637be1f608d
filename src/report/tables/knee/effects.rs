//! `knee_effects`: the errors of every test, rigid and with what the loop found.

use super::{decimals, mm, named};
use crate::report::input::ReportInput;
use crate::report::table::{Audience, Cell, Column, Table};
use crate::stages::torque::CampaignTorque;
use crate::stages::torque::diagnose::JointDiagnosis;
use crate::stages::torque::diagnose::tests::TestErrors;
use crate::stages::torque::errors::Size;

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    build(input.torque())
}

/// One campaign.
pub fn of_campaign(campaign: &CampaignTorque) -> Table {
    named(build([campaign]), campaign)
}

/// By what a test is predicted: name in files, heading.
const PREDICTED: [(&str, &str); 4] = [
    ("rigid", "rigid"),
    ("fitted", "with effects"),
    ("held_out", "held out"),
    ("from_largest", "from largest"),
];

fn build<'a>(campaigns: impl IntoIterator<Item = &'a CampaignTorque>) -> Table {
    let machines = |c: Column| c.seen_by(Audience::Machines);
    let mut columns = vec![
        machines(Column::text("campaign", "Campaign")),
        Column::text("joint", "Joint"),
        machines(Column::number("diameter_mm", "⌀", "mm")),
        Column::text("session", "Test"),
        machines(Column::text("specimen", "Specimen")),
        Column::flag("takes_part", "In fits"),
        machines(Column::flag("in_largest", "In largest")),
        machines(Column::text("verdict", "Verdict")),
        Column::number("n", "\\v{n}", ""),
    ];
    for (id, heading) in PREDICTED {
        columns.push(Column::number(
            &format!("{id}_rmse_nm"),
            &format!("RMSE {heading}"),
            "N.m",
        ));
        columns.push(machines(Column::number(
            &format!("{id}_fvu"),
            &format!("FVU {heading}"),
            "",
        )));
        columns.push(machines(Column::number(
            &format!("{id}_max_nm"),
            &format!("Max. {heading}"),
            "N.m",
        )));
    }
    columns.extend([
        Column::number("own_offset_mm", "Own offset", "mm"),
        Column::number("arm_rigid_mm", "Δ\\v{r} rigid", "mm"),
        Column::number("arm_fitted_mm", "Δ\\v{r} after", "mm"),
    ]);
    let mut table = Table::new(
        "knee_effects",
        "Errors of torque, rigid and with the effects that the loop found",
        columns,
    )
    .note(
        "Held out: effects and sizes found without the actuator (with one actuator, without the test or the stretch of angles). From largest: \
         effects found on all, their sizes fitted to the configuration with most readings alone. Own offset: by how much the length of the test differs from what was fitted to all. \
         Δ\\v{r}: root mean square of the arm measured by hand less the expected one; no fit knows it.",
    );
    for campaign in campaigns {
        for joint in &campaign.diagnoses {
            table.rule();
            for test in &joint.tests {
                table.push(row(joint, test));
            }
        }
    }
    table
}

fn row(joint: &JointDiagnosis, test: &TestErrors) -> Vec<Cell> {
    let found = &joint.findings;
    let part = found.part.as_deref().unwrap_or_default();
    let mut row = vec![
        Cell::text(&found.campaign),
        Cell::text(part),
        Cell::Integer(i64::from(found.diameter_mm)),
        Cell::text(&test.session),
        Cell::text(&test.specimen),
        Cell::Flag(test.fitted),
        Cell::Flag(test.in_largest),
        Cell::text(crate::report::answers::verdict(found.verdict)),
        test.before
            .map_or(Cell::Empty, |s| Cell::Integer(s.n as i64)),
    ];
    for size in [test.before, test.after, test.held_out, test.from_largest] {
        let of = |f: fn(&Size) -> Option<f64>| size.as_ref().and_then(f);
        row.extend([
            decimals(of(|s| Some(s.rmse)), 2),
            decimals(of(|s| s.fvu), 3),
            decimals(of(|s| Some(s.max_abs)), 2),
        ]);
    }
    row.extend([
        decimals(test.own_offset_mm, 1),
        mm(test.arm_before_m, 1),
        mm(test.arm_after_m, 1),
    ]);
    row
}
