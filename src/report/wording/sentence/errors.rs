//! The errors on unseen units, before and after.

use super::found::has_terms;
use super::next::READINGS_GIVEN;
use crate::number::Rounding;
use crate::wording::name::{self, nouns};
use crate::wording::number::{error, error_with_unit, rounded};
use pipeline_findings::{CampaignFindings, Errors, UnitErrors};

/// An error that is more than this share of the one before has not fallen; one that is more than the other has risen.
const NO_BETTER: f64 = 0.98;

const WORSE: f64 = 1.02;

/// Log predictive densities a reading that differ by less are alike.
const DENSITIES_ALIKE: f64 = 0.01;

/// How an error or a log predictive density on unseen units has changed with the effects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    Better,
    Alike,
    Worse,
}

/// An error before and after, and its change; none where nothing was held out or nothing was put into the model.
pub(super) fn error_change(found: &CampaignFindings) -> Option<(f64, f64, Change)> {
    let (before, after) = (found.before.rmse_heldout?, found.after.rmse_heldout?);
    let change = if after > WORSE * before {
        Change::Worse
    } else if after > NO_BETTER * before {
        Change::Alike
    } else {
        Change::Better
    };
    has_terms(found).then_some((before, after, change))
}

/// The same of the log predictive density a reading.
fn density_change(found: &CampaignFindings) -> Option<(f64, f64, Change)> {
    let before = found.before.log_density_heldout?;
    let after = found.after.log_density_heldout?;
    let change = if after < before - DENSITIES_ALIKE {
        Change::Worse
    } else if after > before + DENSITIES_ALIKE {
        Change::Better
    } else {
        Change::Alike
    };
    has_terms(found).then_some((before, after, change))
}

/// `the mixed model's error on unseen specimens falls from 18.7 to 15.8 N (larger on 1 of the 5 specimens)`, and where the uncertainty that was predicted with it fits worse, or better though the
/// error does not, that too.
pub(super) fn errors(found: &CampaignFindings) -> Option<String> {
    let on = name::held_out(found);
    let Some((before, after, change)) = error_change(found) else {
        let Some(before) = found.before.rmse_heldout else {
            return untried(found);
        };
        return Some(format!(
            "the mixed model's error on {on} is {}",
            error_with_unit(before, &found.unit)
        ));
    };
    let (from, to) = (
        error(before, &found.unit),
        error_with_unit(after, &found.unit),
    );
    let sizes = match change {
        Change::Better => format!("the mixed model's error on {on} falls from {from} to {to}"),
        Change::Alike => {
            format!(
                "the mixed model's error on {on} hardly changes: {from} without, {to} with the effects"
            )
        }
        Change::Worse => {
            format!("the mixed model's error on {on} rises with the effects, from {from} to {to}")
        }
    };
    let of_some = match change {
        Change::Better => larger_on_some(found),
        Change::Alike | Change::Worse => String::new(),
    };
    Some(sizes + &of_some + &densities(found, change) + &with_own_values(found))
}

/// On how many units an error that falls on the whole is larger with the effects, if on any.
fn larger_on_some(found: &CampaignFindings) -> String {
    let is_larger = |unit: &&UnitErrors| {
        let [before, after] = [&unit.before, &unit.after].map(|e| e.rmse_heldout);
        matches!((before, after), (Some(before), Some(after)) if after > WORSE * before)
    };
    let count = found.by_unit.iter().filter(is_larger).count();
    if count == 0 {
        return String::new();
    }
    format!(
        " (larger on {count} of the {} {})",
        found.by_unit.len(),
        nouns(found).units
    )
}

/// Whether a smooth black box on the residual does better on unseen units than the model with what was found.
pub fn black_box_beats(found: &CampaignFindings) -> bool {
    let both = found.rmse_of_answer().zip(found.black_box_rmse_heldout);
    both.is_some_and(|(own, black_box)| WORSE * black_box < own)
}

/// What a black box is called in a sentence, before its error.
const REACHES: &str = "a black-box smoother on the residual reaches";

/// What a black box reaches, where it does better.
fn beside_black_box(found: &CampaignFindings, called: &str) -> String {
    match found.black_box_rmse_heldout {
        Some(error) if black_box_beats(found) => {
            format!("; {called} {}", error_with_unit(error, &found.unit))
        }
        _ => String::new(),
    }
}

/// That the effects do harm where the gain and the lengths of the unseen unit are known, if they do.
fn with_own_values(found: &CampaignFindings) -> String {
    let before = found.before.rmse_heldout_calibrated;
    let after = found.after.rmse_heldout_calibrated;
    let (Some(before), Some(after)) = (before, after) else {
        return String::new();
    };
    if after <= WORSE * before {
        return String::new();
    }
    format!(
        "; where gain and lengths are known, the error is larger with the effects: {} against {}",
        error(after, &found.unit),
        error_with_unit(before, &found.unit)
    )
}

/// What there is to say of the uncertainty that was predicted, behind the sizes of the errors: nothing where it changes as they do.
fn densities(found: &CampaignFindings, error: Change) -> String {
    let Some((before, after, density)) = density_change(found) else {
        return String::new();
    };
    let decimals = |x: f64| rounded(x, Rounding::Decimals(2));
    let numbers = format!(
        "(log predictive density per reading {} before, {} after)",
        decimals(before),
        decimals(after)
    );
    match (error, density) {
        (Change::Better, Change::Worse) => {
            format!(", but the prediction intervals become less reliable {numbers}")
        }
        (Change::Alike | Change::Worse, Change::Worse) => format!(
            ", and the prediction intervals become less reliable too {numbers}{}",
            these_only(found)
        ),
        (Change::Alike | Change::Worse, Change::Better) => {
            format!(", but the prediction intervals become more reliable {numbers}")
        }
        _ => String::new(),
    }
}

/// What follows where neither the error falls nor the predictive density rises.
fn these_only(found: &CampaignFindings) -> String {
    let units = nouns(found).units;
    format!(": the effects describe these {units} and do not help on others")
}

/// `the mixed model's error on unseen actuators falls from 8.09 to 3.02 N m (larger on 1 of the 4 actuators), but its prediction intervals become less reliable`.
pub(super) fn errors_in_short(found: &CampaignFindings) -> Option<String> {
    let Some((before, after, change)) = error_change(found) else {
        return errors(found);
    };
    let on = name::held_out(found);
    let (from, to) = (
        error(before, &found.unit),
        error_with_unit(after, &found.unit),
    );
    let density = density_change(found).map_or(Change::Alike, |(.., change)| change);
    let worse = density == Change::Worse;
    let on_some = larger_on_some(found);
    let sizes = match change {
        Change::Better if worse => {
            format!(
                "the mixed model's error on {on} falls from {from} to {to}{on_some}, but its prediction intervals become less reliable"
            )
        }
        Change::Better => {
            format!("the mixed model's error on {on} falls from {from} to {to}{on_some}")
        }
        Change::Alike if worse => {
            format!(
                "the mixed model's error on {on} hardly changes ({from} to {to}), and its prediction intervals become less reliable{}",
                these_only(found)
            )
        }
        Change::Alike => format!("the mixed model's error on {on} hardly changes ({from} to {to})"),
        Change::Worse if worse => {
            format!(
                "the mixed model's error on {on} rises from {from} to {to}, and its prediction intervals become less reliable{}",
                these_only(found)
            )
        }
        Change::Worse => format!("the mixed model's error on {on} rises from {from} to {to}"),
    };
    Some(sizes + &with_own_values(found) + &beside_black_box(found, REACHES))
}

/// `error on unseen specimens 18.7 → 15.8 N (larger on 1 of the 5 specimens), prediction intervals become less reliable`.
pub(super) fn errors_in_numbers(found: &CampaignFindings) -> Option<String> {
    let on = name::held_out(found);
    let Some((before, after, change)) = error_change(found) else {
        let only = found.before.rmse_heldout;
        let only = only.map(|e| format!("error on {on} {}", error_with_unit(e, &found.unit)));
        return only.or_else(|| untried(found));
    };
    let (from, to) = (
        error(before, &found.unit),
        error_with_unit(after, &found.unit),
    );
    let on_some = match change {
        Change::Better => larger_on_some(found),
        Change::Alike | Change::Worse => String::new(),
    };
    let worse = density_change(found).is_some_and(|(.., change)| change == Change::Worse);
    let density = if worse {
        ", prediction intervals become less reliable"
    } else {
        ""
    };
    Some(format!("error on {on} {from} → {to}{on_some}{density}"))
}

/// `22.3 → 15.6 N on unseen specimens (larger on 1 of the 4 specimens), 4.3 → 3.4 N after three readings,
/// 3.6 → 2.6 N with its own gain and lengths; black-box smoother 11.0 N`.
pub(super) fn points(found: &CampaignFindings) -> Option<String> {
    if found.before.rmse_heldout.is_none() {
        return untried(found);
    }
    let sizes = |of: &dyn Fn(&Errors) -> Option<f64>| {
        let (before, after) = (of(&found.before), of(&found.after));
        let with_unit = |e: f64| error_with_unit(e, &found.unit);
        match before.zip(after.filter(|_| has_terms(found))) {
            Some((before, after)) => Some(format!(
                "{}\u{a0}→\u{a0}{}",
                error(before, &found.unit),
                with_unit(after)
            )),
            None => before.map(with_unit),
        }
    };
    let on_some = match error_change(found) {
        Some((.., Change::Better)) => larger_on_some(found),
        _ => String::new(),
    };
    let worse = density_change(found).is_some_and(|(.., change)| change == Change::Worse);
    let unseen =
        sizes(&|e| e.rmse_heldout).map(|s| format!("{s} on {}{on_some}", name::held_out(found)));
    let known =
        sizes(&|e| e.rmse_heldout_calibrated).map(|s| format!("{s} with its own gain and lengths"));
    let after = sizes(&|e| e.rmse_heldout_spread.get(READINGS_GIVEN).copied())
        .map(|s| format!("{s} after three readings"));
    let forms: Vec<String> = [unseen, after, known].into_iter().flatten().collect();
    let worse = if worse {
        "; prediction intervals less reliable"
    } else {
        ""
    };
    let black_box = beside_black_box(found, "black-box smoother");
    Some(forms.join(", ") + worse + &black_box)
}

/// `not tried on another actuator, since there is none`, of effects that could not be.
fn untried(found: &CampaignFindings) -> Option<String> {
    let unit = nouns(found).unit;
    has_terms(found).then(|| format!("not tested on another {unit}, since there is none"))
}
