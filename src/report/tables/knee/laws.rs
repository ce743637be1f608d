//! `knee_laws`: errors of torque by test, with the laws of force of both papers.

use super::{decimals, law_words, named};
use crate::input::ReportInput;
use crate::table::{Audience, Cell, Column, Table};
use pipeline_torque::diagnose::fittings::LAWS;
use pipeline_torque::errors::{Basis, Size};
use pipeline_torque::{CampaignTorque, Test};

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
        Column::text("law", "Law of force").seen_by(Audience::Machines),
        Column::text("law_words", "Law of force").seen_by(Audience::People),
        Column::number("n", "\\v{n}", ""),
        Column::number("n_extrapolated", "Extrap.", ""),
        Column::number("rmse_nm", "RMSE", "N.m"),
        Column::number("max_abs_nm", "Max.", "N.m"),
        Column::number("sse_nm2", "SSE", "N^{2}m^{2}"),
        Column::number("fvu", "FVU", ""),
        Column::number("bias_nm", "Bias", "N.m").seen_by(Audience::Machines),
        Column::number("by_hand_rmse_nm", "RMSE", "N.m"),
        Column::number("by_hand_max_abs_nm", "Max.", "N.m"),
        Column::number("by_hand_sse_nm2", "SSE", "N^{2}m^{2}").seen_by(Audience::Machines),
        Column::number("by_hand_fvu", "FVU", ""),
        Column::text("left_out", "Left out").seen_by(Audience::Machines),
    ];
    let mut table = Table::new(
        "knee_laws",
        "Errors of torque, measured minus predicted: length and arm from the geometry of a rigid leg, and as measured by hand",
        columns,
    )
    .span("From the geometry", "n", "fvu")
    .span("By hand", "by_hand_rmse_nm", "by_hand_fvu")
    .note("FVU: SSE over the sum of squares about the mean. Extrap.: readings beyond the data of the law of force, most of them stretched beyond the resting length. Nothing is fitted.");
    for campaign in campaigns {
        table.rule();
        for test in campaign.configurations.iter().flat_map(|c| &c.tests) {
            for law in LAWS {
                table.push(row(campaign, test, law));
            }
        }
    }
    table
}

fn row(campaign: &CampaignTorque, test: &Test, law: &str) -> Vec<Cell> {
    let of = |basis| {
        let found = test.errors.iter();
        found.clone().find(|e| e.model == law && e.basis == basis)
    };
    let (geometry, hand) = (of(Basis::Geometry), of(Basis::ByHand));
    let size = |e: Option<&pipeline_torque::errors::Errors>, f: fn(&Size) -> f64, n| {
        decimals(e.and_then(|e| e.size.as_ref()).map(f), n)
    };
    let fvu = |s: &Size| s.fvu.unwrap_or(f64::NAN);
    let count = |f: fn(&pipeline_torque::errors::Errors) -> usize| {
        geometry.map_or(Cell::Empty, |e| Cell::Integer(f(e) as i64))
    };
    vec![
        Cell::text(&campaign.campaign),
        Cell::text(&test.session),
        Cell::text(law),
        Cell::text(law_words(law)),
        count(|e| e.n),
        count(|e| e.n_extrapolated),
        size(geometry, |s| s.rmse, 2),
        size(geometry, |s| s.max_abs, 2),
        size(geometry, |s| s.sse, 1),
        size(geometry, fvu, 2),
        size(geometry, |s| s.bias, 2),
        size(hand, |s| s.rmse, 2),
        size(hand, |s| s.max_abs, 2),
        size(hand, |s| s.sse, 1),
        size(hand, fvu, 2),
        test.left_out_because().map_or(Cell::Empty, Cell::text),
    ]
}
