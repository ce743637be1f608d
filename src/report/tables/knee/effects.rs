//! `knee_effects`: the errors of every test, rigid and with what the loop found.

use super::{decimals, mm, named};
use crate::input::ReportInput;
use crate::table::{Audience, Cell, Column, Table};
use pipeline_torque::CampaignTorque;
use pipeline_torque::diagnose::JointDiagnosis;
use pipeline_torque::diagnose::tests::TestErrors;
use pipeline_torque::errors::Size;

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    build(input.torque())
}

/// One campaign.
pub fn of_campaign(campaign: &CampaignTorque) -> Table {
    named(build([campaign]), campaign)
}

/// By what a test is predicted: name in files, heading, statistics that people see.
const PREDICTED: [(&str, &str, &[&str]); 4] = [
    ("rigid", "rigid", &["rmse_nm", "fvu", "max_nm"]),
    ("fitted", "loop", &["rmse_nm", "fvu", "max_nm"]),
    ("held_out", "held out", &["rmse_nm", "max_nm"]),
    ("from_largest", "largest", &[]),
];
/// Statistics: name in files. Their units stand in the headings over several columns.
const STATISTICS: [&str; 3] = ["rmse_nm", "fvu", "max_nm"];

fn build<'a>(campaigns: impl IntoIterator<Item = &'a CampaignTorque>) -> Table {
    let machines = |c: Column| c.seen_by(Audience::Machines);
    let mut columns = vec![
        machines(Column::text("campaign", "Campaign")),
        machines(Column::text("joint", "Joint")),
        machines(Column::number("diameter_mm", "⌀", "mm")),
        Column::text("session", "Test"),
        machines(Column::text("specimen", "Specimen")),
        Column::flag("takes_part", "In fits"),
        machines(Column::flag("in_largest", "In largest")),
        machines(Column::text("verdict", "Verdict")),
        Column::number("n", "\\v{n}", ""),
    ];
    for statistic in STATISTICS {
        for (id, heading, shown) in PREDICTED {
            let column = Column::number(&format!("{id}_{statistic}"), heading, "");
            let seen = shown.contains(&statistic);
            columns.push(if seen { column } else { machines(column) });
        }
    }
    columns.extend([
        Column::number("own_offset_mm", "offset", "mm"),
        Column::number("own_rmse_nm", "RMSE", "N.m"),
        machines(Column::number("arm_rigid_mm", "Δ\\v{r} rigid", "mm")),
        machines(Column::number("arm_fitted_mm", "Δ\\v{r} after", "mm")),
    ]);
    let mut table = Table::new(
        "knee_effects",
        "Errors of torque, rigid and with the effects that the loop found",
        columns,
    )
    .span("RMSE (N m)", "rigid_rmse_nm", "held_out_rmse_nm")
    .span("FVU", "rigid_fvu", "fitted_fvu")
    .span("Largest error (N m)", "rigid_max_nm", "held_out_max_nm")
    .span("Its own", "own_offset_mm", "own_rmse_nm")
    .note(
        "Held out: effects and sizes found without the actuator (none with one actuator). Its own: by how much the length of the test differs from what was fitted \
         to all, and the error with that, which no value for all tests can do better than. FVU: share of the variance that is not explained. Tests without a yes take part in no fit; where the owner doubts every test of a joint, these are fitted here by themselves, and in no other fit.",
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
        Cell::text(crate::wording::name::verdict_id(found.verdict)),
        test.before
            .map_or(Cell::Empty, |s| Cell::Integer(s.n as i64)),
    ];
    let sizes = [test.before, test.after, test.held_out, test.from_largest];
    type Of = fn(&Size) -> Option<f64>;
    let statistics: [(Of, usize); 3] = [
        (|s| Some(s.rmse), 2),
        (|s| s.fvu, 3),
        (|s| Some(s.max_abs), 2),
    ];
    for (of, digits) in statistics {
        row.extend(sizes.map(|size| decimals(size.as_ref().and_then(of), digits)));
    }
    row.extend([
        decimals(test.own_offset_mm, 1),
        decimals(test.with_own_offset.map(|s| s.rmse), 2),
        mm(test.arm_before_m, 1),
        mm(test.arm_after_m, 1),
    ]);
    row
}
