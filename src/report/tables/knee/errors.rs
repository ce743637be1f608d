//! `knee_laws`, `knee_models`, `knee_errors`: errors of torque by test, with the laws of force of both papers, with every force model, and in the
//! long form by model and basis.

use super::law_words;
use crate::described::*;
use crate::wording::name::model_author;
use pipeline_mechanics::models::published;
use pipeline_torque::diagnose::fittings::LAWS;
use pipeline_torque::errors::{Basis, Errors, Size};
use pipeline_torque::{CampaignTorque, Test};

type OfTest<'a> = (&'a CampaignTorque, &'a Test);

fn tests(campaign: &CampaignTorque) -> impl Iterator<Item = OfTest<'_>> {
    let all = campaign.configurations.iter().flat_map(|c| &c.tests);
    all.map(move |test| (campaign, test))
}

/// The errors of a test with one model.
fn of<'a>(test: &'a Test, model: &str, basis: Basis) -> Option<&'a Errors> {
    let mut all = test.errors.iter();
    all.find(|e| e.model == model && e.basis == basis)
}

/// A test with one of the laws of force.
#[derive(Clone, Copy)]
struct WithLaw<'a> {
    campaign: &'a CampaignTorque,
    test: &'a Test,
    law: &'static str,
}

impl<'a> WithLaw<'a> {
    fn geometry(self) -> Option<&'a Errors> {
        of(self.test, self.law, Basis::Geometry)
    }

    /// From length and arm of the geometry.
    fn size(self) -> Option<&'a Size> {
        self.geometry()?.size.as_ref()
    }

    /// From length and arm by hand.
    fn by_hand(self) -> Option<&'a Size> {
        of(self.test, self.law, Basis::ByHand)?.size.as_ref()
    }
}

/// One row a test and law.
#[rustfmt::skip]
pub fn laws(campaigns: &[CampaignTorque]) -> Table {
    let fvu = |size: &Size| size.fvu.unwrap_or(f64::NAN);
    let rows = |(campaign, test)| LAWS.map(|law| WithLaw { campaign, test, law });
    Described::<WithLaw>::new("knee_laws", "Errors of torque, measured minus predicted: length and arm from the geometry of a rigid leg, and as measured by hand")
        .text("campaign", "Campaign", |r| &r.campaign.campaign).machines()
        .text("session", "Test", |r| &r.test.session)
        .text("law", "Law of force", |r| r.law).machines()
        .text("law_words", "Law of force", |r| law_words(r.law)).people()
        .count("n", "\\v{n}", One, |r| r.geometry().map(|e| e.n))
        .count("n_extrapolated", "Extrap.", One, |r| r.geometry().map(|e| e.n_extrapolated))
        .number("rmse_nm", "RMSE", Nm, Decimals(2), |r| r.size().map(|s| s.rmse))
        .number("max_abs_nm", "Max.", Nm, Decimals(2), |r| r.size().map(|s| s.max_abs))
        .number("sse_nm2", "SSE", Nm2, Decimals(1), |r| r.size().map(|s| s.sse))
        .number("fvu", "FVU", One, Decimals(2), move |r| r.size().map(fvu))
        .number("bias_nm", "Bias", Nm, Decimals(2), |r| r.size().map(|s| s.bias)).machines()
        .number("by_hand_rmse_nm", "RMSE", Nm, Decimals(2), |r| r.by_hand().map(|s| s.rmse))
        .number("by_hand_max_abs_nm", "Max.", Nm, Decimals(2), |r| r.by_hand().map(|s| s.max_abs))
        .number("by_hand_sse_nm2", "SSE", Nm2, Decimals(1), |r| r.by_hand().map(|s| s.sse)).machines()
        .number("by_hand_fvu", "FVU", One, Decimals(2), move |r| r.by_hand().map(fvu))
        .text("left_out", "Left out", |r| r.test.left_out_because()).machines()
        .span("From the geometry", "n", "fvu")
        .span("By hand", "by_hand_rmse_nm", "by_hand_fvu")
        .note("FVU: SSE over the sum of squares about the mean. Extrap.: readings beyond the data of the law of force, most of them stretched beyond the resting length. Nothing is fitted.")
        .blocks(campaigns.iter().map(|c| tests(c).flat_map(rows)))
}

/// One row a test, one column a model.
#[rustfmt::skip]
pub fn models(campaigns: &[CampaignTorque]) -> Table {
    let mut table = Described::<OfTest>::new("knee_models", "Root-mean-square error of torque by every force model, N m: length and arm from the geometry of a rigid leg")
        .text("campaign", "Campaign", |(campaign, _)| &campaign.campaign).machines()
        .text("session", "Test", |(_, test)| &test.session);
    for model in published() {
        let heading = model_author(model.id(), model.title());
        let rmse = |test| Some(of(test, model.id(), Basis::Geometry)?.size.as_ref()?.rmse);
        table = table.number(model.id(), heading, One, Decimals(2), move |(_, test)| rmse(test));
    }
    table
        .note("Empty: the model has no coefficients for the diameter or no answer for any reading. Readings for which a model has no answer are left out of its error; the table of all errors (knee\\_errors) counts them.")
        .blocks(campaigns.iter().map(tests))
}

type Long<'a> = (&'a CampaignTorque, &'a Test, &'a Errors);

/// One row a test, model and basis.
#[rustfmt::skip]
pub fn errors(campaigns: &[CampaignTorque]) -> Table {
    let rows = |(campaign, test)| (test as &Test).errors.iter().map(move |e| (campaign, test, e));
    Described::<Long>::new("knee_errors", "Errors of torque of every model: length and arm from the geometry of a rigid leg, or as measured by hand")
        .text("campaign", "Campaign", |(campaign, ..)| &campaign.campaign)
        .text("session", "Test", |(_, test, _)| &test.session)
        .text("model", "Model", |(.., e)| &e.model)
        .text("basis", "From", |(.., e)| e.basis.name())
        .count("n", "\\v{n}", One, |(.., e)| e.n)
        .count("n_outside", "Outside", One, |(.., e)| e.n_outside)
        .count("n_extrapolated", "Extrapolated", One, |(.., e)| e.n_extrapolated)
        .number("rmse_nm", "RMSE", Nm, Decimals(2), |(.., e)| e.size.map(|s| s.rmse))
        .number("sse_nm2", "SSE", Nm2, Decimals(1), |(.., e)| e.size.map(|s| s.sse))
        .number("fvu", "FVU", One, Decimals(3), |(.., e)| e.size.and_then(|s| s.fvu))
        .number("max_abs_nm", "Max.", Nm, Decimals(2), |(.., e)| e.size.map(|s| s.max_abs))
        .number("bias_nm", "Bias", Nm, Decimals(2), |(.., e)| e.size.map(|s| s.bias))
        .blocks(campaigns.iter().map(|c| tests(c).flat_map(rows)))
}
