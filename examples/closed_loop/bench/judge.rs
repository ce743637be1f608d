//! What a search found against what was put in.

use super::cases::{Case, right_columns};
use super::outcome::{Covered, Outcome};
use pipeline::findings::{CampaignFindings, EffectFinding, Level};
use pipeline::simulate::rig_like::{Mistaken, Sizes};

/// Standard errors of a 95% interval.
const TWO: f64 = 1.959_963_985;

/// The effects that count: a negligible one changes no verdict.
fn counted(found: &CampaignFindings) -> Vec<&EffectFinding> {
    found.effects.iter().filter(|e| !e.negligible).collect()
}

fn is(effect: &EffectFinding, id: &str) -> bool {
    effect.id == id || effect.class.iter().any(|c| c == id)
}

/// Whether every id has an effect of its own among those found.
fn each_has_its_own(ids: &[&str], found: &[&EffectFinding]) -> bool {
    let Some((first, rest)) = ids.split_first() else {
        return true;
    };
    (0..found.len()).any(|k| {
        let mut others = found.to_vec();
        let candidate = others.remove(k);
        is(candidate, first) && each_has_its_own(rest, &others)
    })
}

/// The outcome as far as effects of the library are concerned.
pub fn of_effects(found: &CampaignFindings, ids: &[&str]) -> Outcome {
    let all: Vec<&EffectFinding> = found.effects.iter().collect();
    let counted = counted(found);
    // What was put in may be found as negligible; nothing else may be found but as negligible.
    let detected = each_has_its_own(ids, &all);
    let others = counted.iter().filter(|e| !ids.iter().any(|id| is(e, id)));
    let wrong_names = others.count();
    let nothing_else = wrong_names == 0 && counted.len() <= ids.len();
    Outcome {
        verdict: verdict(found),
        found: counted.iter().map(|e| names(e)).collect(),
        columns: found.unexplained.iter().map(|u| u.column.clone()).collect(),
        pointed: found
            .recording_errors
            .iter()
            .map(|r| r.group.clone())
            .collect(),
        detected,
        exact: detected && nothing_else && found.unexplained.is_empty(),
        wrong_names,
        rmse: found.after.rmse_heldout,
        specimens: found.design.specimens,
        ..Outcome::default()
    }
}

/// The id and the others of its class.
fn names(effect: &EffectFinding) -> Vec<String> {
    let others = effect.class.iter().filter(|c| **c != effect.id);
    std::iter::once(&effect.id).chain(others).cloned().collect()
}

fn verdict(found: &CampaignFindings) -> String {
    let value = serde_json::to_value(found.verdict).expect("a verdict is a word");
    value.as_str().unwrap_or_default().to_owned()
}

/// An effect outside the library is right where its column is named, and exact where nothing else is.
pub fn of_column(found: &CampaignFindings, id: &str) -> Outcome {
    let mut outcome = of_effects(found, &[]);
    let right = |c: &String| right_columns(id).iter().any(|word| c.starts_with(word));
    outcome.detected = outcome.columns.iter().any(right);
    outcome.exact =
        outcome.detected && outcome.columns.iter().all(right) && outcome.found.is_empty();
    outcome
}

/// A recording error is right where it is pointed at, and exact where nothing else is found.
pub fn of_mistake(found: &CampaignFindings, mistaken: &Mistaken) -> Outcome {
    let mut outcome = of_effects(found, &[]);
    let right = |g: &String| *g == mistaken.group || mistaken.sessions.contains(g);
    outcome.detected = outcome.pointed.iter().any(right);
    outcome.exact = outcome.detected
        && outcome.pointed.iter().all(right)
        && outcome.found.is_empty()
        && outcome.columns.is_empty();
    outcome
}

/// Whether the interval of what was put in covers it: in the unit of the findings, and only where the form is the one put in.
pub fn covered(found: &CampaignFindings, case: &Case, amplitude: f64) -> Covered {
    let Some(effect) = found.effects.iter().find(|e| is(e, case.id)) else {
        return Covered {
            found: None,
            not_found: linear(found, case, amplitude),
        };
    };
    let same = effect.id == case.id && effect.form == case.plain;
    let truth = case.absent() + amplitude;
    let inside = effect.parameters.first().filter(|_| same).map(|p| {
        p.ci_low.is_none_or(|low| low <= truth) && p.ci_high.is_none_or(|high| truth <= high)
    });
    Covered {
        found: inside,
        not_found: None,
    }
}

/// The same for the estimate of the first step: its standard error follows from the gain in likelihood.
fn linear(found: &CampaignFindings, case: &Case, amplitude: f64) -> Option<bool> {
    let tested = found.tested.iter();
    let own = tested
        .filter(|t| !t.is_column && t.id == case.id && t.form == case.plain)
        .max_by(|a, b| a.log_likelihood_gain.total_cmp(&b.log_likelihood_gain))?;
    let estimate = own.amplitude?;
    let error = estimate.abs() / (2.0 * own.log_likelihood_gain).sqrt();
    error
        .is_finite()
        .then(|| (estimate - amplitude).abs() <= TWO * error)
}

/// Estimated over true standard deviation of set length and gain.
pub fn scatter_ratios(found: &CampaignFindings, sizes: &Sizes) -> [Option<f64>; 2] {
    let ratio = |id: &str, level: Level, truth: f64| {
        let scatter = found.scatter.iter();
        let own = scatter
            .filter(|s| s.id == id && s.level == level)
            .next_back()?;
        (truth > 0.0).then(|| own.sd / truth)
    };
    [
        ratio("length_offset", Level::Session, sizes.length_mm),
        ratio("specimen_variation", Level::Specimen, sizes.gain),
    ]
}
