//! What varies from group to group, how far the law itself is from right, and groups that are recorded wrongly.

use super::MOST_ROWS;
use crate::number::Rounding;
use crate::wording::name::{self, listed};
use crate::wording::number::{
    NONE, error, error_or_none, error_with_unit, gain_or_none, plain, probability, rounded, unit,
    with_interval,
};
use crate::wording::sentence::{recorded_size, set_aside};
use pipeline_findings::{CampaignFindings, NotedContractions, RecordingError, Scatter};

/// A smaller misfit, as a share of the force, is printed as smaller than this.
const LEAST_MISFIT: f64 = 1e-4;

/// What, of each, how many, standard deviation with interval, declared, gain.
pub(super) fn scatter(s: &Scatter) -> [String; 7] {
    let (factor, in_unit) = if s.unit == "1" {
        (100.0, "%")
    } else {
        (1.0, unit(&s.unit))
    };
    let times = |x: Option<f64>| x.map(|x| factor * x);
    let (value, interval) = with_interval(factor * s.sd, times(s.ci_low), times(s.ci_high));
    let contradicted = if s.declared_contradicted {
        ", contradicted"
    } else {
        ""
    };
    [
        name::capitalised(&name::scatter(&s.id, s.level)),
        name::level(s.level).to_owned(),
        s.values.len().to_string(),
        format!("{value} {interval} {in_unit}"),
        plain(factor * s.sd_predictive, "1"),
        s.declared.map_or_else(
            || NONE.to_owned(),
            |d| plain(factor * d, "1") + contradicted,
        ),
        gain_or_none(s.log_likelihood_gain),
    ]
}

/// What noted contractions are worth, and the misfit of the law; empty where nothing was assessed.
pub(super) fn beside_scatter(found: &CampaignFindings) -> String {
    let worth = found.noted_contractions.as_ref().map(noted_contractions);
    let all = worth.into_iter().chain([misfit(found)]);
    let said: Vec<String> = all.filter(|s| !s.is_empty()).collect();
    said.join(" ")
}

/// `Of the differences between the contractions noted at 620 kPa (9 specimens, standard deviation 1.0% of the resting length), 89 ± 29% is error.`
fn noted_contractions(noted: &NotedContractions) -> String {
    // A normal number about a share may be outside of what shares are.
    let percentage = |x: f64| rounded(100.0 * x.clamp(0.0, 1.0), Rounding::Decimals(0));
    let mostly_error = noted.error - noted.error_sd > 0.5;
    format!(
        "Of the differences between the contractions noted at 620 kPa ({} specimens, standard deviation {}% of the resting length), {} ± {}% is error.{}",
        noted.specimens,
        rounded(100.0 * noted.sd, Rounding::Digits(2)),
        percentage(noted.error),
        rounded(100.0 * noted.error_sd, Rounding::Decimals(0)),
        if mostly_error {
            " Free lengths measured again would describe the specimens better."
        } else {
            ""
        }
    )
}

/// The misfit of the law in a sentence; empty where nothing was assessed.
fn misfit(found: &CampaignFindings) -> String {
    let Some(m) = &found.misfit else {
        return String::new();
    };
    let nouns = name::nouns(found);
    let share = |x: f64| {
        if x < LEAST_MISFIT {
            format!(
                "under {}",
                rounded(100.0 * LEAST_MISFIT, Rounding::Digits(1))
            )
        } else {
            rounded(100.0 * x, Rounding::Digits(2))
        }
    };
    let sensitive: Vec<String> = m.sensitive.iter().map(|id| name::candidate(id)).collect();
    let changes = if sensitive.is_empty() {
        "No result changes when the prior scales of the misfit are halved or doubled.".to_owned()
    } else {
        format!(
            "When the prior scales of the misfit are halved or doubled, the result changes for {}.",
            listed(&sensitive)
        )
    };
    let changes = match noise_in_time(found) {
        Some(words) => format!("{changes} {words}"),
        None => changes,
    };
    let quantity = name::load(found);
    let along = if found.kind == "knee-torque" {
        "angle"
    } else {
        "pressure"
    };
    format!(
        "Smooth misfit of the law, as a share of the {quantity}: {}% common to all {}, {}% per {} along the {along}{}. {changes}",
        share(m.common),
        nouns.units,
        share(m.session),
        nouns.setup,
        m.stroke.map_or_else(String::new, |s| {
            format!(
                ", {}% per stroke (the filling or the venting of one log)",
                share(s)
            )
        })
    )
}

/// Noise that is correlated in time, and what does not stand beside it; none where the readings show none.
fn noise_in_time(found: &CampaignFindings) -> Option<String> {
    let noise = found.noise_in_time.as_ref()?;
    let size = |x: f64| error_with_unit(x, &found.unit);
    let fallen = noise.beside.iter().filter(|b| !b.stands);
    let fallen: Vec<String> = fallen.map(|b| name::candidate(&b.id)).collect();
    let stands = match (noise.beside.is_empty(), fallen.is_empty()) {
        (true, _) => String::new(),
        (_, true) => " Everything that was found stands beside it.".to_owned(),
        (_, false) => format!(" Beside it these would not stand: {}.", listed(&fallen)),
    };
    Some(format!(
        "Readings of one stroke are alike beyond this: noise is correlated in time, or the law is wrong in finer ways. The force wanders by {}, with {} of noise beside it (log-likelihood +{}); the search takes noise for independent.{stands}",
        size(noise.sd),
        size(noise.noise),
        rounded(noise.log_likelihood_gain, Rounding::Decimals(0))
    ))
}

/// The first of the recording errors, a row each.
pub(super) fn recording_errors(found: &CampaignFindings) -> Vec<[String; 6]> {
    let first = found.recording_errors.iter().take(MOST_ROWS);
    first.map(|e| recording_error(found, e)).collect()
}

/// Group, what it looks like, size, p, RMS as recorded and corrected, set aside.
fn recording_error(found: &CampaignFindings, e: &RecordingError) -> [String; 6] {
    let rms = error(e.rms, &found.unit);
    let corrected = error_or_none(e.rms_corrected, &found.unit);
    [
        format!("{} {}", name::level(e.level), e.group),
        name::capitalised(&name::recording_error(e.kind, e.quantity.as_deref())),
        recorded_size(e).unwrap_or_else(|| NONE.to_owned()),
        e.p.map_or_else(|| NONE.to_owned(), probability),
        format!("{rms} → {corrected}"),
        set_aside(e)
            .unwrap_or(if e.set_aside { "yes" } else { "no" })
            .to_owned(),
    ]
}
