//! `knee_models`: the error of every force model, one column a model.

use super::{decimals, named};
use crate::input::ReportInput;
use crate::table::{Audience, Cell, Column, Table};
use crate::wording::name::model_author;
use pipeline_torque::CampaignTorque;
use pipeline_torque::errors::{Basis, Errors};

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    build(input.torque())
}

/// One campaign.
pub fn of_campaign(campaign: &CampaignTorque) -> Table {
    named(build([campaign]), campaign)
}

fn build<'a>(campaigns: impl IntoIterator<Item = &'a CampaignTorque>) -> Table {
    let models = pipeline_mechanics::models::published();
    let mut columns = vec![
        Column::text("campaign", "Campaign").seen_by(Audience::Machines),
        Column::text("session", "Test"),
    ];
    columns.extend(models.iter().map(|m| {
        let heading = match m.id() {
            "new_published" => "New",
            "knee_paper" => "Knee paper",
            id => model_author(id, m.title()),
        };
        Column::number(m.id(), heading, "")
    }));
    let mut table = Table::new(
        "knee_models",
        "Root-mean-square error of torque by every force model, N.m: length and arm from the geometry of a rigid leg",
        columns,
    )
    .note("Empty: the model has no coefficients for the diameter or no answer for any reading. Readings for which a model has no answer are left out of its error; the table of all errors (knee\\_errors) counts them.");
    for campaign in campaigns {
        table.rule();
        for test in campaign.configurations.iter().flat_map(|c| &c.tests) {
            let rmse = |e: &Errors| e.size.as_ref().map(|s| s.rmse);
            let of = |id: &str| {
                let found = test.errors.iter();
                let mut found = found.filter(|e| e.basis == Basis::Geometry && e.model == id);
                found.next().and_then(rmse)
            };
            let mut row = vec![Cell::text(&campaign.campaign), Cell::text(&test.session)];
            row.extend(models.iter().map(|m| decimals(of(m.id()), 2)));
            table.push(row);
        }
    }
    table
}
