//! The effects that were found and the candidates that were not taken.

use super::words::{newtons, percent};
use crate::effects;
use crate::report::answers::{p_words, rounded, size, title};
use crate::report::number::Rounding;
use crate::stages::diagnose::findings::{CampaignFindings, EffectFinding, Rejected};
use serde::Serialize;
use std::collections::BTreeSet;

/// Most rejected candidates in print; `findings.json` has all.
const REJECTED: usize = 8;

#[derive(Serialize)]
pub(super) struct Effect {
    id: String,
    title: String,
    equation: String,
    acts_on: String,
    sizes: Vec<String>,
    others: Vec<String>,
    facts: Vec<(&'static str, String)>,
    source: String,
    measurement: String,
}

/// What speaks for an effect. Strengths are part of every model and were not searched, so that some of it says nothing of them.
fn facts(e: &EffectFinding) -> Vec<(&'static str, String)> {
    let arrow = |a: f64, b: f64| format!("{} → {} N", newtons(a), newtons(b));
    let p = p_words(e.p_adjusted);
    let mut facts = vec![("p, corrected", p.trim_start_matches("= ").to_owned())];
    if e.criterion_gain != 0.0 {
        let gain = rounded(e.criterion_gain, Rounding::Decimals(1));
        let again = format!("{} of the resamples", percent(e.selected_in_folds));
        let helps = format!("in {} of the folds", percent(e.helps_in_folds));
        facts.push(("gain in the criterion", gain));
        let folds = format!("in {} of the folds", percent(e.chosen_in_folds));
        facts.push(("chosen again", again));
        facts.push(("chosen by their own search", folds));
        facts.push(("helps", helps));
    }
    let held_out = arrow(e.rmse_heldout_before, e.rmse_heldout_after);
    facts.push(("held out, own strength", held_out));
    facts.push(("training", arrow(e.rmse_before, e.rmse_after)));
    facts
}

pub(super) fn effect(e: &EffectFinding) -> Effect {
    Effect {
        id: e.id.clone(),
        title: e.title.clone(),
        equation: e.equation.clone(),
        acts_on: e.acts_on.clone(),
        sizes: e.parameters.iter().map(size).collect(),
        others: e
            .class
            .iter()
            .filter(|id| **id != e.id)
            .map(|id| title(id))
            .collect(),
        facts: facts(e),
        source: e.source.clone(),
        measurement: e.measurement.clone(),
    }
}

/// The title of a candidate, with its form where the effect has several.
fn titled(r: &Rejected) -> String {
    let several = effects::index(&r.id).is_some_and(|k| effects::all()[k].forms().len() > 1);
    match &r.form {
        Some(form) if several => format!("{} ({form})", title(&r.id)),
        _ => title(&r.id),
    }
}

pub(super) fn rejected(found: &CampaignFindings) -> Vec<[String; 4]> {
    // A candidate that was chosen first and then failed also stands among those that were not chosen: its first reason says more. One that
    // failed in one set of effects and was chosen in another was taken.
    let mut seen = BTreeSet::new();
    let once = |r: &&Rejected| seen.insert((r.id.clone(), r.acts_on.clone()));
    let taken = |r: &&Rejected| {
        let same = |e: &EffectFinding| e.id == r.id && e.acts_on == r.acts_on;
        found.effects.iter().any(same)
    };
    let row = |r: &Rejected| {
        [
            titled(r),
            r.acts_on.clone(),
            percent(r.share),
            r.why.clone(),
        ]
    };
    let first = found.rejected.iter().filter(|r| !taken(r)).filter(once);
    first.take(REJECTED).map(row).collect()
}
