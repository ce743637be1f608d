//! `knee_fittings`: the length of the end fittings, as stated, as the paper fitted it, and as fitted here.

use super::{decimals, law_words, mm, named};
use crate::input::ReportInput;
use crate::table::{Audience, Cell, Column, Table};
use pipeline_torque::CampaignTorque;
use pipeline_torque::diagnose::fittings::{FittingFit, Origin};
use pipeline_torque::errors::Size;

/// All campaigns.
pub fn table(input: &ReportInput) -> Table {
    build(input.torque())
}

/// One campaign.
pub fn of_campaign(campaign: &CampaignTorque) -> Table {
    named(build([campaign]), campaign)
}

/// Where a length comes from, in words.
pub fn origin(fit: &FittingFit) -> String {
    match fit.origin {
        Origin::Stated => "as stated".to_owned(),
        Origin::Paper => "knee paper".to_owned(),
        Origin::Largest => format!("fitted to {}", fit.specimen),
        Origin::All => "fitted to all".to_owned(),
        Origin::Without => format!("without {}", fit.specimen),
    }
}

fn build<'a>(campaigns: impl IntoIterator<Item = &'a CampaignTorque>) -> Table {
    let columns = vec![
        Column::text("campaign", "Campaign").seen_by(Audience::Machines),
        Column::number("diameter_mm", "⌀", "mm").seen_by(Audience::Machines),
        Column::text("muscle", "Muscle").seen_by(Audience::Machines),
        Column::text("law", "Law of force").seen_by(Audience::Machines),
        Column::text("group", "Of").seen_by(Audience::People),
        Column::text("origin", "Fittings"),
        Column::number("fitting_mm", "l_{fit}", "mm"),
        Column::interval("interval_mm", "Interval", "mm"),
        Column::text("interval_by", "Interval by").seen_by(Audience::Machines),
        Column::text("state", "State").seen_by(Audience::Machines),
        Column::number("n_fitted", "\\v{n}", ""),
        Column::number("sse_fitted_nm2", "SSE", "N^{2}m^{2}"),
        Column::number("rmse_fitted_nm", "RMSE", "N.m"),
        Column::number("n_held_out", "\\v{n}", ""),
        Column::number("sse_held_out_nm2", "SSE", "N^{2}m^{2}"),
        Column::number("rmse_held_out_nm", "RMSE", "N.m"),
        Column::number("max_held_out_nm", "Max.", "N.m").seen_by(Audience::Machines),
    ];
    let mut table = Table::new(
        "knee_fittings",
        "The length of one end fitting as the torque has it, and the errors on what was fitted and on what was not",
        columns,
    )
    .span("Fitted", "n_fitted", "rmse_fitted_nm")
    .span("Held out", "n_held_out", "rmse_held_out_nm")
    .note("Held out are other actuators, other tendons and other knees of the same diameter and muscle. As stated and knee paper: nothing was fitted here; the paper fitted its length to tests of a 48.5 cm flexor, which may be among these. Excluded tests take no part. Fitted by plain least squares, as in the paper; what the mixed model says of the length is among the effects of the joint.");
    for campaign in campaigns {
        let mut last = None;
        for fit in &campaign.fits {
            let group = (fit.diameter_mm, &fit.muscle, &fit.law);
            let first = last != Some(group);
            if first {
                table.rule();
            }
            last = Some(group);
            table.push(row(campaign, fit, first));
        }
        table.rule();
    }
    table
}

fn row(campaign: &CampaignTorque, fit: &FittingFit, first: bool) -> Vec<Cell> {
    let [value, interval] = match fit.interval_m {
        Some((low, high)) => Cell::with_interval(1e3 * fit.fitting_m, 1e3 * low, 1e3 * high),
        None => [mm(fit.fitting_m, 1), Cell::Empty],
    };
    let n = |s: &Option<Size>| {
        s.as_ref()
            .map_or(Cell::Empty, |s| Cell::Integer(s.n as i64))
    };
    let size = |s: &Option<Size>, f: fn(&Size) -> f64, d| decimals(s.as_ref().map(f), d);
    vec![
        Cell::text(&campaign.campaign),
        Cell::Integer(i64::from(fit.diameter_mm)),
        Cell::text(&fit.muscle),
        Cell::text(&fit.law),
        if first { group(fit) } else { Cell::Empty },
        Cell::text(origin(fit)),
        value,
        interval,
        Cell::text(&fit.interval_by),
        Cell::text(&fit.state),
        n(&fit.fitted),
        size(&fit.fitted, |s| s.sse, 1),
        size(&fit.fitted, |s| s.rmse, 2),
        n(&fit.held_out),
        size(&fit.held_out, |s| s.sse, 1),
        size(&fit.held_out, |s| s.rmse, 2),
        size(&fit.held_out, |s| s.max_abs, 2),
    ]
}

/// Which configurations, under which law.
fn group(fit: &FittingFit) -> Cell {
    let law = law_words(&fit.law);
    Cell::text(format!("{} mm {}, {law}", fit.diameter_mm, fit.muscle))
}
