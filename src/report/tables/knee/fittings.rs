//! `knee_fittings`, `knee_fitting_errors`: the length of the end fittings, as stated, as the paper fitted it, and as fitted here; how every length
//! does on every configuration.

use super::{law_words, mm};
use crate::described::*;
use pipeline_torque::CampaignTorque;
use pipeline_torque::diagnose::fittings::{FittingFit, On, Origin};
use pipeline_torque::errors::Size;

type Fit<'a> = (&'a CampaignTorque, &'a FittingFit);

fn fits(campaign: &CampaignTorque) -> impl Iterator<Item = Fit<'_>> {
    campaign.fits.iter().map(move |fit| (campaign, fit))
}

/// Where a length comes from, in words.
fn origin(fit: &FittingFit) -> String {
    match fit.origin {
        Origin::Stated => "as stated".to_owned(),
        Origin::Paper => "knee paper".to_owned(),
        Origin::Largest => format!("fitted to {}", fit.specimen),
        Origin::All => "fitted to all".to_owned(),
        Origin::Without => format!("without {}", fit.specimen),
    }
}

/// One row a length.
#[rustfmt::skip]
pub fn fittings(campaigns: &[CampaignTorque]) -> Table {
    let size = |s: &Option<Size>, of: fn(&Size) -> f64| s.as_ref().map(of);
    let group = |(_, f): &Fit| (f.diameter_mm, f.muscle.clone(), f.law.clone());
    let groups = campaigns.iter().flat_map(|c| runs(fits(c), |a, b| group(a) == group(b)));
    Described::<Fit>::new("knee_fittings", "The length of one end fitting inferred from the torque, and the errors on fitted and on held-out \
         configurations")
        .text("campaign", "Campaign", |(campaign, _)| &campaign.campaign).machines()
        .count("diameter_mm", "⌀", Mm, |(_, f)| f.diameter_mm).machines()
        .text("muscle", "Muscle", |(_, f)| &f.muscle).machines()
        .text("law", "Law of force", |(_, f)| &f.law).machines()
        .text("group", "Of", |(_, f)| format!("{} mm {}, {}", f.diameter_mm, f.muscle, law_words(&f.law))).people().once()
        .text("origin", "Fittings", |(_, f)| origin(f))
        .value("fitting_mm", "l_{fit}", Mm, length)
        .interval("interval_mm", "Interval", Mm, length)
        .text("interval_by", "Interval by", |(_, f)| &f.interval_by).machines()
        .text("state", "State", |(_, f)| &f.state).machines()
        .count("n_fitted", "\\v{n}", One, |(_, f)| f.fitted.map(|s| s.n))
        .number("sse_fitted_nm2", "SSE", Nm2, Decimals(1), move |(_, f)| size(&f.fitted, |s| s.sse))
        .number("rmse_fitted_nm", "RMSE", Nm, Decimals(2), move |(_, f)| size(&f.fitted, |s| s.rmse))
        .count("n_held_out", "\\v{n}", One, |(_, f)| f.held_out.map(|s| s.n))
        .number("sse_held_out_nm2", "SSE", Nm2, Decimals(1), move |(_, f)| size(&f.held_out, |s| s.sse))
        .number("rmse_held_out_nm", "RMSE", Nm, Decimals(2), move |(_, f)| size(&f.held_out, |s| s.rmse))
        .number("max_held_out_nm", "Max.", Nm, Decimals(2), move |(_, f)| size(&f.held_out, |s| s.max_abs)).machines()
        .span("Fitted", "n_fitted", "rmse_fitted_nm")
        .span("Held out", "n_held_out", "rmse_held_out_nm")
        .note("Held out are other actuators, other tendons and other knees of the same diameter and muscle. As stated and knee paper: nothing was \
             fitted here; the paper fitted its length to tests of a 48.5 cm flexor, which may be among these. Excluded tests are not used. Fitted \
             by plain least squares, as in the paper; what the mixed model says of the length is among the effects of the joint.")
        .blocks(groups)
}

fn length((_, fit): Fit) -> [Cell; 2] {
    match fit.interval_m {
        Some((low, high)) => Cell::with_interval(mm(fit.fitting_m), mm(low), mm(high)),
        None => [Cell::number(mm(fit.fitting_m), Decimals(1)), Cell::Empty],
    }
}

type OnOne<'a> = (&'a CampaignTorque, &'a FittingFit, &'a On);

/// One row a length and configuration.
#[rustfmt::skip]
pub fn fitting_errors(campaigns: &[CampaignTorque]) -> Table {
    let rows = |(campaign, fit)| (fit as &FittingFit).on.iter().map(move |on| (campaign, fit, on));
    Described::<OnOne>::new("knee_fitting_errors", "Errors of torque on every configuration, by the length of the end fittings")
        .text("campaign", "Campaign", |(campaign, ..)| &campaign.campaign)
        .count("diameter_mm", "⌀", Mm, |(_, f, _)| f.diameter_mm)
        .text("muscle", "Muscle", |(_, f, _)| &f.muscle)
        .text("law", "Law of force", |(_, f, _)| &f.law)
        .text("origin", "Length of the fittings", |(_, f, _)| origin(f))
        .number("fitting_mm", "l_{fit}", Mm, Decimals(2), |(_, f, _)| mm(f.fitting_m))
        .text("configuration", "On", |(.., on)| &on.configuration)
        .flag("fitted", "Fitted", |(.., on)| on.fitted)
        .count("n", "\\v{n}", One, |(.., on)| on.size.n)
        .number("sse_nm2", "SSE", Nm2, Decimals(1), |(.., on)| on.size.sse)
        .number("rmse_nm", "RMSE", Nm, Decimals(2), |(.., on)| on.size.rmse)
        .number("fvu", "FVU", One, Decimals(3), |(.., on)| on.size.fvu)
        .number("max_abs_nm", "Max.", Nm, Decimals(2), |(.., on)| on.size.max_abs)
        .blocks(campaigns.iter().flat_map(fits).map(rows))
}
