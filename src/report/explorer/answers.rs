//! What was found, campaign by campaign, as the page shows it beside the readings.

use super::sample::Extent;
use crate::input::ReportInput;
use crate::wording::name;
use crate::wording::sentence::sentences;
use pipeline_findings::{CampaignFindings, Errors};
use serde::Serialize;

/// The answer for one campaign, pool or joint.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// Campaign id; of a pool "pooled-10mm".
    pub campaign: String,
    /// What the page calls it.
    pub title: String,
    /// Whether it is simulated.
    pub simulated: bool,
    /// "isometric" or "knee-torque".
    pub kind: String,
    /// Unit of the errors.
    pub unit: String,
    /// What was found, in sentences.
    pub sentences: Vec<String>,
    /// What came in, one after the other.
    pub steps: Vec<String>,
    /// What the held-out errors are of.
    pub held_out: String,
    /// Errors without effects.
    pub before: Error,
    /// Errors with them.
    pub after: Error,
    /// What the expected squared error is made of, largest first.
    pub budget: Vec<Source>,
    /// Root of the budget's sum.
    pub expected: Option<f64>,
}

/// Errors in the unit of the answer.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Error {
    /// On the readings of the fit.
    pub train: Option<f64>,
    /// On readings that took no part.
    pub heldout: Option<f64>,
}

/// One source of the expected error.
#[derive(Clone, Debug, Serialize)]
pub struct Source {
    /// What it is.
    pub label: String,
    /// Mean variance.
    pub variance: f64,
    /// Its root.
    pub rmse: f64,
}

/// The answers for what is on the page.
pub fn answers(input: &ReportInput, extent: Extent) -> Vec<Answer> {
    let all = input.all_findings();
    let shown = all.filter(|f| extent == Extent::Laboratory || extent.takes(&f.campaign));
    shown.map(answer).collect()
}

fn answer(found: &CampaignFindings) -> Answer {
    let mut budget: Vec<Source> = found
        .budget
        .iter()
        .map(|b| Source {
            label: name::source(&b.source),
            variance: b.variance,
            rmse: b.rmse,
        })
        .collect();
    budget.sort_by(|a, b| b.variance.total_cmp(&a.variance));
    let effects = found.effects.iter();
    let effects = effects.map(|e| name::effect_with_form(&e.id, &e.form));
    let columns = found.unexplained.iter().map(|u| name::column(&u.column));
    Answer {
        campaign: found.campaign.clone(),
        title: name::campaign(found),
        simulated: found.simulated,
        kind: found.kind.clone(),
        unit: found.unit.clone(),
        sentences: sentences(found),
        steps: effects.chain(columns).collect(),
        held_out: name::held_out(found),
        before: errors(&found.before),
        after: errors(&found.after),
        budget,
        expected: found.expected_rmse_heldout,
    }
}

fn errors(errors: &Errors) -> Error {
    Error {
        train: errors.rmse_train,
        heldout: errors.rmse_heldout,
    }
}
