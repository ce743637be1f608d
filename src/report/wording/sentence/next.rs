//! What is worth measuring next.

use super::budget::{is_assumed, scatter_behind};
use super::errors::{Change, error_change};
use super::found::has_terms;
use crate::number::Rounding;
use crate::wording::name::{self, Nouns, listed, nouns};
use crate::wording::number::{count, error_with_unit, percent, rounded, with_unit};
use pipeline_findings::{CampaignFindings, NextKind, NextMeasurement};

/// A measurement that lowers the expected error by less than this share of it is not worth a sentence; the table has it.
const WORTH_SAYING: f64 = 0.05;

/// The readings of each set-up of which the answer speaks; beside it the table has the others.
pub(super) const READINGS_GIVEN: &str = "3";

/// An error that came out so many times the expected one is not what the model knows of.
const BEYOND_EXPECTED: f64 = 1.5;

/// Whether what a measurement would be worth can be relied on: it is a fall of the error that the model with the effects expects, and says nothing
/// where that model is worse on unseen units than the one without, where the variance that it takes away is more than all that came out, or where the error
/// that came out is far larger than the expected one.
pub fn is_worth_credible(found: &CampaignFindings, worth: f64) -> bool {
    let rises = error_change(found).is_some_and(|(.., change)| change == Change::Worse);
    let expected = found.expected_rmse_heldout.unwrap_or(f64::INFINITY);
    let taken = found
        .expected_rmse_heldout
        .map_or(worth * worth, |e| worth * (2.0 * e - worth));
    let is_known =
        |error: f64| worth < error && taken < error * error && error < BEYOND_EXPECTED * expected;
    !rises && found.rmse_of_answer().is_none_or(is_known)
}

/// What to measure next: the measurement that lowers the error most, else the one that separates effects best, else another unit on which to test what was
/// found.
pub(super) fn worth(found: &CampaignFindings) -> Option<String> {
    worth_most(found)
        .or_else(|| separation(found))
        .or_else(|| another_unit(found))
}

/// `readings at ε* = 0.46, 280 kPa would separate hysteresis between filling and venting and drift of the load cell`.
fn separation(found: &CampaignFindings) -> Option<String> {
    let separate = found.next_measurement.iter();
    let separate = separate.filter(|n| n.kind == NextKind::Separate && !hardly_separates(n));
    let best = separate.max_by(|a, b| a.worth.unwrap_or(0.0).total_cmp(&b.worth.unwrap_or(0.0)))?;
    let readings = measurement(best, &nouns(found));
    Some(format!("{readings} would separate {}", separated(best)))
}

/// `a second actuator would show whether the effects hold`, where there is but one.
fn another_unit(found: &CampaignFindings) -> Option<String> {
    let is_untried = has_terms(found) && found.before.rmse_heldout.is_none();
    let unit = nouns(found).unit;
    is_untried.then(|| format!("a second {unit} would show whether the effects hold"))
}

/// Whether even the best readings tell the effects hardly apart.
fn hardly_separates(next: &NextMeasurement) -> bool {
    next.worth
        .is_none_or(|worth| rounded(worth, SEPARATION).as_str() == "0.0")
}

/// How an expected difference in log-likelihood is rounded.
const SEPARATION: Rounding = Rounding::Decimals(1);

fn separated(next: &NextMeasurement) -> String {
    let ids: Vec<String> = next.separates.iter().map(|id| name::effect(id)).collect();
    listed(&ids)
}

fn worth_most(found: &CampaignFindings) -> Option<String> {
    let in_units = found
        .next_measurement
        .iter()
        .filter(|n| n.kind != NextKind::Separate)
        .filter_map(|n| Some((n, n.worth?)));
    let (best, worth) = in_units.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let words = worth_words(best)?;
    let error = found.expected_rmse_heldout.unwrap_or(0.0);
    let said = worth > WORTH_SAYING * error && is_worth_credible(found, worth);
    let assumed = assumed(found, best);
    said.then(|| format!("{} {words}{assumed}", measurement(best, &nouns(found))))
}

/// ` if they scatter as assumed`, where the readings do not show what a better knowledge would take away.
pub fn assumed(found: &CampaignFindings, next: &NextMeasurement) -> &'static str {
    let mut of = next.separates.iter();
    let is_assumed = |source: &String| scatter_behind(found, source).is_some_and(is_assumed);
    if next.kind == NextKind::Precision && of.any(is_assumed) {
        " if they scatter as assumed"
    } else {
        ""
    }
}

/// `three readings spread over each session of a new specimen reduce the error to 5.1 N`.
pub(super) fn few_readings(found: &CampaignFindings) -> Option<String> {
    let nouns = nouns(found);
    let answer = found.errors_of_answer();
    let after = answer.rmse_heldout_spread.get(READINGS_GIVEN)?;
    let unseen = answer.rmse_heldout?;
    let error = error_with_unit(*after, &found.unit);
    let verb = if *after < (1.0 - WORTH_SAYING) * unseen {
        "reduce the error to"
    } else {
        "leave it at"
    };
    let without = less_without_effects(found, *after);
    let without = without.map_or_else(String::new, |e| format!(" ({e} without the effects)"));
    Some(format!(
        "three readings spread over each {} of a new {} {verb} {error}{without}",
        nouns.setup, nouns.unit
    ))
}

/// `3.4 N after three readings spread over each session`, where that is less than on units of which nothing is known.
pub(super) fn error_after_few(found: &CampaignFindings) -> Option<String> {
    let answer = found.errors_of_answer();
    let after = *answer.rmse_heldout_spread.get(READINGS_GIVEN)?;
    let falls = after < (1.0 - WORTH_SAYING) * answer.rmse_heldout?;
    let without = less_without_effects(found, after);
    let without = without.map_or_else(String::new, |e| format!(" ({e} without the effects)"));
    falls.then(|| {
        let error = error_with_unit(after, &found.unit);
        let setup = nouns(found).setup;
        format!("{error} after three readings spread over each {setup}{without}")
    })
}

/// The error after as many readings without the effects, where that is less than `after` with them.
fn less_without_effects(found: &CampaignFindings, after: f64) -> Option<String> {
    let before = *found.before.rmse_heldout_spread.get(READINGS_GIVEN)?;
    let is_less = has_terms(found) && before < (1.0 - WORTH_SAYING) * after;
    is_less.then(|| error_with_unit(before, &found.unit))
}

/// What to measure: `knowing set lengths to 0.2 mm`.
pub fn measurement(next: &NextMeasurement, nouns: &Nouns) -> String {
    let number = |key: &str| next.at.get(key).copied();
    match next.kind {
        NextKind::Precision => {
            let is_of_specimens = next.separates.iter().any(|s| s == "specimen_lengths");
            let what = if is_of_specimens {
                "resting and contracted lengths".to_owned()
            } else {
                let what: Vec<String> = next.separates.iter().map(|s| name::source(s)).collect();
                listed(&what)
            };
            format!("knowing {what} to {}", conditions(next))
        }
        NextKind::Specimens => match number("specimens") {
            Some(1.0) => format!("one more {}", nouns.unit),
            Some(n) => format!("{} more {}", count(n as usize), nouns.units),
            None => format!("more {}", nouns.units),
        },
        NextKind::SetPoints => match number("set_points") {
            Some(n) => format!(
                "the best {} further set points on these {}",
                count(n as usize),
                nouns.units
            ),
            None => format!("readings at {}", conditions(next)),
        },
        NextKind::Separate => {
            let motion = match number("direction") {
                Some(direction) if direction > 0.0 => " while filling",
                Some(_) => " while venting",
                None => "",
            };
            format!("readings{motion} at {}", conditions(next))
        }
    }
}

/// What it is worth, as the end of a sentence: `would lower the error by 6.0 N`, `would separate A and B by 2.0 in log-likelihood`; none where
/// that was not computed.
pub fn worth_words(next: &NextMeasurement) -> Option<String> {
    let worth = next.worth?;
    Some(match next.kind {
        NextKind::Separate if hardly_separates(next) => {
            let ids = separated(next);
            format!("would hardly separate {ids}; no other set point does better")
        }
        NextKind::Separate => format!(
            "would separate {} by {} in log-likelihood",
            separated(next),
            rounded(worth, SEPARATION)
        ),
        _ => format!(
            "would lower the error by {}",
            error_with_unit(worth, &next.unit)
        ),
    })
}

/// The conditions of a measurement but the sense of the motion: `120 kPa, ε* = 0.40`.
pub fn conditions(next: &NextMeasurement) -> String {
    let all: Vec<String> = next
        .at
        .iter()
        .filter(|(key, _)| *key != "direction")
        .map(|(key, value)| condition(key, *value))
        .collect();
    all.join(", ")
}

fn condition(key: &str, value: f64) -> String {
    let digits = |unit: &str| with_unit(&rounded(value, Rounding::Digits(3)), unit);
    let short = |unit: &str| plain_number(value, unit);
    match key {
        "pressure_kpa" => digits("kPa"),
        "contraction_rel" => format!("ε* = {}", rounded(value, Rounding::Decimals(2))),
        "contraction" => format!("ε = {}", rounded(value, Rounding::Decimals(3))),
        "rest_length_mm" => format!("a resting length of {}", digits("mm")),
        "length_mm" => format!("a length of {}", digits("mm")),
        "angle_deg" => format!("{}°", rounded(value, Rounding::Decimals(0))),
        "temperature_c" => digits("°C"),
        "sd_mm" => short("mm"),
        "sd_n" => short("N"),
        "sd_kpa" => short("kPa"),
        "sd" => percent(value),
        "time_s" => format!("{} into a log", digits("s")),
        "pressure_share" => format!("{} of the pressure", percent(value)),
        other => format!("{} {}", other.replace('_', " "), short("1")),
    }
}

/// As many digits as it has, at most three.
pub fn plain_number(value: f64, unit: &str) -> String {
    let text = (0..3).map(Rounding::Decimals).find(|r| {
        r.round(value)
            .is_some_and(|x| x.ascii().parse() == Ok(value))
    });
    with_unit(&rounded(value, text.unwrap_or(Rounding::Digits(3))), unit)
}
