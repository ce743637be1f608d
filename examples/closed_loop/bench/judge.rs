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
        smallest_p: found.tested.iter().map(|t| t.p_familywise).reduce(f64::min),
        inside: [found.inside_50, found.inside_95],
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
        let mut scatter = found.scatter.iter();
        let own = scatter.rfind(|s| s.id == id && s.level == level)?;
        (truth > 0.0).then(|| own.sd / truth)
    };
    [
        ratio("length_offset", Level::Session, sizes.length_mm),
        ratio("specimen_variation", Level::Specimen, sizes.gain),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::cases::SINGLE;
    use super::*;
    use serde_json::{Value, json};

    fn effect(id: &str, class: &[&str]) -> Value {
        json!({
            "id": id, "class": class, "acts_on": "all", "column": null, "from": null, "form": "constant", "equation": "",
            "parameters": [{"name": "h", "value": 4.2, "ci_low": 3.9, "ci_high": 4.5, "unit": "N"}],
            "p_familywise": 0.001, "log_likelihood_gain": 20.0, "found_in_folds": 1.0, "negligible": false, "rms": 1.0,
            "by_specimen": {}, "profile": [], "free_form": null, "in_its_place": [], "explained_as_well_by": [], "measurement": "", "source": "",
        })
    }

    fn found(effects: Vec<Value>, columns: &[&str]) -> CampaignFindings {
        let errors = json!({"rmse_train": 1.0, "rmse_heldout": 9.0, "max_abs_error_heldout": null, "rmse_heldout_calibrated": null,
            "rmse_heldout_after": {}, "log_density_heldout": null});
        let column = |c: &&str| json!({"column": c, "shape": "gain", "p_familywise": 0.001, "log_likelihood_gain": 9.0, "share_of_variance": 0.1, "explained_as_well_by": [], "curve": []});
        let columns: Vec<Value> = columns.iter().map(column).collect();
        let verdict = match (effects.is_empty(), columns.is_empty()) {
            (false, _) => "effect_found",
            (true, false) => "unexplained",
            (true, true) => "none",
        };
        let all = json!({
            "campaign": "c", "diameter_mm": 10, "simulated": true, "kind": "isometric", "base_model": "new", "base_refitted": true,
            "unit": "N", "design": {"readings": 100, "readings_outside_domain": 0, "sessions": 16, "specimens": 4, "readings_held_out": 0,
            "held_out_by": "specimen", "doubtful_only": false, "smallest_p": {"familywise": 0.005, "signs": 0.125}}, "verdict": verdict, "not_assessed": null, "effects": effects, "scatter": [],
            "misfit": {"common": 0.0, "session": 0.0, "sensitive": []}, "unexplained": columns, "recording_errors": [],
            "before": errors, "after": errors, "by_unit": [], "budget": [], "expected_rmse_heldout": 9.0, "inside_50": null,
            "inside_95": null, "pit": [], "noise": 2.0, "black_box_rmse_heldout": null, "tested": [], "detection_limits": [],
            "not_measurable": [], "aliases": [], "next_measurement": [], "coefficients": [], "alternatives": [],
        });
        serde_json::from_value(all).expect("findings")
    }

    #[test]
    fn the_exact_set_may_be_named_by_its_class_and_by_nothing_more() {
        let threshold = || {
            effect(
                "pressure_zero_offset",
                &["pressure_zero_offset", "bladder_threshold"],
            )
        };
        let right = of_effects(&found(vec![threshold()], &[]), &["bladder_threshold"]);
        assert!(right.detected && right.exact && right.wrong_names == 0);
        let two = || vec![threshold(), effect("hysteresis", &[])];
        let more = of_effects(&found(two(), &[]), &["bladder_threshold"]);
        assert!(more.detected && !more.exact && more.wrong_names == 1);
        assert!(of_effects(&found(two(), &[]), &["hysteresis", "bladder_threshold"]).exact);
        let column = of_effects(
            &found(vec![threshold()], &["humidity"]),
            &["bladder_threshold"],
        );
        assert!(column.detected && !column.exact);
    }

    #[test]
    fn one_effect_does_not_stand_for_two() {
        let one = || effect("force_gain", &["force_gain", "temperature"]);
        assert!(!of_effects(&found(vec![one()], &[]), &["force_gain", "temperature"]).detected);
        assert!(
            of_effects(
                &found(vec![one(), one()], &[]),
                &["force_gain", "temperature"]
            )
            .exact
        );
        // The same effect twice is more than was put in.
        assert!(!of_effects(&found(vec![one(), one()], &[]), &["temperature"]).exact);
    }

    #[test]
    fn what_is_negligible_counts_as_nothing_but_for_what_was_put_in() {
        let mut small = effect("hysteresis", &[]);
        small["negligible"] = json!(true);
        assert!(of_effects(&found(vec![small.clone()], &[]), &[]).exact);
        assert!(of_effects(&found(vec![small], &[]), &["hysteresis"]).exact);
    }

    #[test]
    fn outside_the_library_the_column_has_to_be_right_and_alone() {
        assert!(of_column(&found(vec![], &["humidity"]), "humidity").exact);
        assert!(!of_column(&found(vec![], &["temperature_c"]), "humidity").detected);
        let named = of_column(
            &found(vec![effect("temperature", &[])], &["humidity"]),
            "humidity",
        );
        assert!(named.detected && !named.exact);
    }

    #[test]
    fn an_interval_counts_only_for_the_form_that_was_put_in() {
        let case = SINGLE
            .iter()
            .find(|c| c.id == "hysteresis")
            .expect("a case");
        let covered_at = |f: &CampaignFindings, a: f64| covered(f, case, a).found;
        let mut own = effect("hysteresis", &[]);
        assert_eq!(covered_at(&found(vec![own.clone()], &[]), 4.0), Some(true));
        assert_eq!(covered_at(&found(vec![own.clone()], &[]), 5.0), Some(false));
        own["form"] = json!("proportional to force");
        assert_eq!(covered_at(&found(vec![own], &[]), 4.0), None);
        assert_eq!(covered(&found(vec![], &[]), case, 4.0), Covered::default());
    }
}
