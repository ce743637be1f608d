//! The answer of a campaign in sentences: what was found, what the error is made of, what is worth measuring.

use super::name::{self, Nouns, capitalised, listed, nouns};
use super::number::{
    amounts, count, equals_probability, error, error_with_unit, percent, plain, rounded, with_unit,
};
use crate::number::Rounding;
use pipeline_findings::{
    ActsOn, BudgetEntry, CampaignFindings, EffectFinding, ErrorKind, FormPoint, FreeForm, Level,
    NextKind, NextMeasurement, RecordingError, Scatter, UnitErrors, Verdict,
};
use pipeline_mechanics::effects;
use pipeline_torque::diagnose::terms::usual;

/// A source that makes less than this share of the expected variance is summed up with others; noise is always named.
const NAMED_SHARE: f64 = 0.02;
/// Sources that the answer on a page and on the terminal names, beside noise; the table has all.
const SOURCES_NAMED: usize = 3;
/// A measurement that lowers the expected error by less than this share of it is not worth a sentence; the table has it.
const WORTH_SAYING: f64 = 0.02;
/// An error that is more than this share of the one before has not fallen; one that is more than the other has risen.
const NO_BETTER: f64 = 0.98;
const WORSE: f64 = 1.02;
/// Log predictive densities a reading that differ by less are alike.
const DENSITIES_ALIKE: f64 = 0.01;
/// An expected error that is further than this factor from what came out is said to be.
const FAR_FROM_EXPECTED: f64 = 1.25;
/// Most members of an alias set, and most recording errors, that a sentence names.
const MOST_NAMED: usize = 3;
/// A range that is shorter than this share of its larger end says nothing of a change along it.
const NARROW: f64 = 0.1;
/// The readings of each set-up of which the answer speaks; beside it the table has the others.
const READINGS_GIVEN: &str = "3";

/// What there is to say of a campaign; the report says all of it, the command line as much as fits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Clauses {
    /// Recording errors; none where there are none.
    pub recording_errors: Option<String>,
    /// Uncertainties that were declared and are contradicted.
    pub contradicted: Option<String>,
    /// What was found.
    pub found: String,
    /// Whether "the smallest detectable sizes are in" a table belongs behind what was found.
    pub limits: bool,
    /// What stays without a name beside an effect.
    pub unexplained: Option<String>,
    /// What the errors on unseen units are, before and after, and whether what was predicted of their spread fits better or worse.
    pub errors: Option<String>,
    /// The same in fewer words, for a line on the terminal and the first page.
    pub errors_in_short: Option<String>,
    /// What the expected error is made of.
    pub budget: Option<String>,
    /// What the best next measurement is worth.
    pub worth: Option<String>,
    /// What a few readings of a new unit are worth.
    pub readings: Option<String>,
}

/// Everything that there is to say, each clause without a capital and without a full stop.
pub fn clauses(found: &CampaignFindings) -> Clauses {
    Clauses {
        recording_errors: recording_errors(&found.recording_errors),
        contradicted: contradicted(found),
        found: answer(found),
        limits: found.verdict == Verdict::None && !found.detection_limits.is_empty(),
        unexplained: (found.verdict == Verdict::EffectFound)
            .then(|| beside(found))
            .flatten(),
        errors: errors(found),
        errors_in_short: errors_in_short(found),
        budget: budget(found),
        worth: worth(found),
        readings: few_readings(found),
    }
}

/// What was found, without the errors; of an effect its name and size, and all remarks in one bracket.
fn answer(found: &CampaignFindings) -> String {
    let weighty: Vec<&EffectFinding> = found.effects.iter().filter(|e| !e.negligible).collect();
    let of_effect = |e: &EffectFinding| {
        let large = beyond_usual(found, e).map(|_| "implausibly large".to_owned());
        let remarks = [large, of_one_group(found, e), indistinguishable(e)];
        let remarks: Vec<String> = remarks.into_iter().flatten().collect();
        let name = size_of(e);
        if remarks.is_empty() {
            name
        } else {
            format!("{name} ({})", remarks.join("; "))
        }
    };
    match found.verdict {
        Verdict::NotAssessed => format!("not assessed: {}", name::not_assessed(found)),
        Verdict::None if found.effects.is_empty() => "no effect detected".to_owned(),
        Verdict::None => {
            let all: Vec<String> = found.effects.iter().map(of_effect).collect();
            format!(
                "nothing beyond the smallest effect of interest; below it: {}",
                all.join("; ")
            )
        }
        Verdict::Unexplained => unexplained(found),
        Verdict::EffectFound => {
            let all: Vec<String> = weighty.into_iter().map(of_effect).collect();
            all.join("; ")
        }
    }
}

/// `the set length scatters by 0.83 mm and not by the 0.10 mm that were declared`.
fn contradicted(found: &CampaignFindings) -> Option<String> {
    let of_sessions = found.scatter.iter().filter(|s| s.declared_contradicted);
    let list: Vec<String> = of_sessions
        .filter(|s| matches!(s.level, Level::Session | Level::Test))
        .filter_map(|s| {
            let declared = plain(s.declared?, &s.unit);
            Some(format!(
                "the {} scatters by {} and not by the {declared} that were declared",
                name::scatter(&s.id, s.level),
                plain(s.sd, &s.unit)
            ))
        })
        .collect();
    (!list.is_empty()).then(|| list.join("; "))
}

/// Of an effect of a joint that it is larger than such parts were measured to be, and what these have up to: something else is probably in it.
pub fn beyond_usual(found: &CampaignFindings, e: &EffectFinding) -> Option<String> {
    let size = e.parameters.first()?;
    let (most, unit) = usual(&e.id, &e.form).filter(|_| found.kind == "knee-torque")?;
    (size.value.abs() > most).then(|| with_unit(&most.to_string(), unit))
}

/// Of an effect of which groups scatter as well, where there is but one of them: its own value and the effect are one number.
fn of_one_group(found: &CampaignFindings, e: &EffectFinding) -> Option<String> {
    let scatters = |s: &&Scatter| s.id == e.id && s.values.len() == 1;
    let own = found.scatter.iter().find(scatters)?;
    let (own, level) = (name::scatter(&own.id, own.level), name::level(own.level));
    (e.acts_on == ActsOn::All).then(|| format!("perhaps the {own} of the only {level}"))
}

/// `indistinguishable from zero of the pressure sensor`; none where its alias set holds it alone.
fn indistinguishable(effect: &EffectFinding) -> Option<String> {
    let others: Vec<String> = alias_set(effect);
    match others.len() {
        0 => None,
        n if n <= MOST_NAMED => Some(format!("indistinguishable from {}", listed(&others))),
        n => Some(format!("indistinguishable from {} other effects", count(n))),
    }
}

/// `threshold pressure of the bladder 60 kPa`.
fn size_of(effect: &EffectFinding) -> String {
    let size = amounts(&effect.parameters).map_or_else(String::new, |amount| format!(" {amount}"));
    let from = match (&effect.from, &effect.column) {
        (Some(session), _) => format!(" from session {session} on"),
        (None, Some(_)) => format!(", {}", name::acts_on(effect)),
        (None, None) => String::new(),
    };
    called(effect) + &size + &from
}

/// What an effect is called; with its form where its size has not the unit by which the effect is known: a compliance in mm.
pub fn called(effect: &EffectFinding) -> String {
    let known = effects::index(&effect.id).and_then(|k| effects::all()[k].forms().first());
    let unit = effect.parameters.first().map(|p| p.unit.as_str());
    if known.is_some_and(|form| unit.is_some_and(|u| u != form.amplitude.unit)) {
        name::effect_with_form(&effect.id, &effect.form)
    } else {
        name::effect(&effect.id)
    }
}

/// The other members of an effect's alias set.
pub fn alias_set(effect: &EffectFinding) -> Vec<String> {
    let others = effect.class.iter().filter(|id| **id != effect.id);
    others.map(|id| name::effect(id)).collect()
}

/// `Its size changes with the force: one number is not enough (p = 0.01).`, or that one number is enough over the range in which it acts; none where
/// that was not asked.
pub fn form(effect: &EffectFinding) -> Option<String> {
    let free = effect.free_form.as_ref()?;
    let along = name::column(&free.argument);
    let p = equals_probability(free.p);
    let range = range_of(free);
    Some(match range {
        Some(range) if is_narrow(range) => format!(
            "Whether its size changes with the {along} cannot be told: it acts {} only.",
            range_words(range, &free.unit)
        ),
        _ if free.differs => format!(
            "Its size changes with the {along}{}: one number is not enough (p {p}).",
            between_ends(effect, free)
        ),
        Some(range) => format!(
            "One number is enough for its size over the {along} at which it acts, {} (p {p}).",
            range_words(range, &free.unit)
        ),
        None => format!("One number is enough for its size, whatever the {along} (p {p})."),
    })
}

/// `, from 101 kPa at 38 kPa to 309 kPa at 625 kPa, all else fitted again`: the sizes at the ends of the range.
fn between_ends(effect: &EffectFinding, free: &FreeForm) -> String {
    let ends = free.curve.first().zip(free.curve.last());
    let (Some((first, last)), Some(size)) = (ends, effect.parameters.first()) else {
        return String::new();
    };
    let end = |point: &FormPoint| {
        let at = with_unit(&rounded(point.at, Rounding::Digits(2)), &free.unit);
        format!("{} at {at}", plain(point.amplitude, &size.unit))
    };
    let (first, last) = (end(first), end(last));
    format!(", from {first} to {last}, all else fitted again")
}

/// The range of the argument over which the size of an effect was looked at.
fn range_of(free: &FreeForm) -> Option<(f64, f64)> {
    let ends = free.curve.first().zip(free.curve.last());
    ends.map(|(first, last)| (first.at, last.at))
}

/// Whether a range is so short that no change along it could be seen.
fn is_narrow((low, high): (f64, f64)) -> bool {
    high - low < NARROW * low.abs().max(high.abs())
}

fn range_words((low, high): (f64, f64), unit: &str) -> String {
    let rounding = Rounding::Digits(3);
    let high = with_unit(&rounded(high, rounding), unit);
    format!("from {} to {high}", rounded(low, rounding))
}

/// `the error depends on humidity (p = 0.002), for which the library has no effect`.
fn unexplained(found: &CampaignFindings) -> String {
    let columns: Vec<String> = found
        .unexplained
        .iter()
        .map(|u| {
            format!(
                "{} (p {})",
                name::column(&u.column),
                equals_probability(u.p_familywise)
            )
        })
        .collect();
    format!(
        "the error depends on {}, for which the library has no effect",
        listed(&columns)
    )
}

/// The same beside effects that were found.
fn beside(found: &CampaignFindings) -> Option<String> {
    let share: f64 = found.unexplained.first()?.share_of_variance;
    let rest = unexplained(found);
    Some(format!(
        "what the effects leave is not all chance: {rest} ({} of its variance)",
        percent(share)
    ))
}

/// Whether anything was put into the model.
pub fn has_terms(found: &CampaignFindings) -> bool {
    !found.effects.is_empty() || !found.unexplained.is_empty()
}

/// How an error or a log predictive density on unseen units has changed with the effects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    Better,
    Alike,
    Worse,
}

/// An error before and after, and its change; none where nothing was held out or nothing was put into the model.
fn error_change(found: &CampaignFindings) -> Option<(f64, f64, Change)> {
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

/// `the error on unseen specimens goes from 18.7 to 15.8 N (larger on 1 of the 5 specimens)`, and where the uncertainty that was predicted with it fits worse, or better though the
/// error does not, that too.
fn errors(found: &CampaignFindings) -> Option<String> {
    let on = name::held_out(found);
    let Some((before, after, change)) = error_change(found) else {
        let Some(before) = found.before.rmse_heldout else {
            return untried(found);
        };
        return Some(format!(
            "the error on {on} is {}",
            error_with_unit(before, &found.unit)
        ));
    };
    let (from, to) = (
        error(before, &found.unit),
        error_with_unit(after, &found.unit),
    );
    let sizes = match change {
        Change::Better => format!("the error on {on} goes from {from} to {to}"),
        Change::Alike => {
            format!("the error on {on} does not fall: {from} without, {to} with the effects")
        }
        Change::Worse => format!("the error on {on} rises with the effects, from {from} to {to}"),
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
        "; where its gain and lengths are known the error is larger with the effects, {} against {}",
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
        "(log predictive density a reading {} before, {} after)",
        decimals(before),
        decimals(after)
    );
    match (error, density) {
        (Change::Better, Change::Worse) => {
            format!(", but the uncertainty stated with the predictions gets worse {numbers}")
        }
        (Change::Alike | Change::Worse, Change::Worse) => format!(
            ", and the uncertainty stated with the predictions gets worse too {numbers}{}",
            these_only(found)
        ),
        (Change::Alike | Change::Worse, Change::Better) => {
            format!(", but the uncertainty stated with the predictions gets better {numbers}")
        }
        _ => String::new(),
    }
}

/// What follows where neither the error nor its stated uncertainty gets better.
fn these_only(found: &CampaignFindings) -> String {
    let units = nouns(found).units;
    format!(": the effects describe these {units}, and do not help on another")
}

/// `the error on unseen actuators goes from 8.09 to 3.02 N m (larger on 1 of the 4 actuators), but its stated uncertainty gets worse`.
fn errors_in_short(found: &CampaignFindings) -> Option<String> {
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
    Some(match change {
        Change::Better if worse => {
            format!(
                "the error on {on} goes from {from} to {to}{on_some}, but its stated uncertainty gets worse"
            )
        }
        Change::Better => format!("the error on {on} goes from {from} to {to}{on_some}"),
        Change::Alike if worse => {
            format!(
                "the error on {on} does not fall ({from} to {to}), its stated uncertainty gets worse{}",
                these_only(found)
            )
        }
        Change::Alike => format!("the error on {on} does not fall ({from} to {to})"),
        Change::Worse if worse => {
            format!(
                "the error on {on} rises from {from} to {to}, its stated uncertainty gets worse{}",
                these_only(found)
            )
        }
        Change::Worse => format!("the error on {on} rises from {from} to {to}"),
    })
}

/// `not tried on another actuator, since there is none`, of effects that could not be.
fn untried(found: &CampaignFindings) -> Option<String> {
    let unit = name::held_out_unit(found);
    has_terms(found).then(|| format!("not tried on another {unit}, since there is none"))
}

/// The sources that a sentence names, largest first, and noise; and the root of what the others make together.
fn named_sources(found: &CampaignFindings) -> (Vec<&BudgetEntry>, f64) {
    let total: f64 = found.budget.iter().map(|b| b.variance).sum();
    let mut order: Vec<&BudgetEntry> = found.budget.iter().collect();
    order.sort_by(|a, b| b.variance.total_cmp(&a.variance));
    let is_noise = |b: &BudgetEntry| b.source == "noise";
    let large = order
        .iter()
        .filter(|b| !is_noise(b) && b.variance >= NAMED_SHARE * total);
    let mut named: Vec<&BudgetEntry> = large.take(SOURCES_NAMED).copied().collect();
    let left: f64 = order
        .iter()
        .filter(|b| !is_noise(b) && !named.iter().any(|n| n.source == b.source))
        .map(|b| b.variance)
        .sum();
    named.extend(order.iter().filter(|b| is_noise(b)));
    (named, left.max(0.0).sqrt())
}

/// `of the 13.4 N expected on an unseen specimen, 12.0 come from set lengths (0.9 mm), 4.1 from specimen gain and 2.6
/// from noise (added in quadrature)`.
fn budget(found: &CampaignFindings) -> Option<String> {
    let (named, left) = named_sources(found);
    let from = |b: &&BudgetEntry| {
        let scatter = scattered(found, b);
        format!(
            "{} from {}{scatter}",
            error(b.rmse, &found.unit),
            name::source(&b.source)
        )
    };
    let mut parts: Vec<String> = named.iter().map(from).collect();
    if left > 0.0 && left.is_finite() {
        let others = format!("{} from all else", error(left, &found.unit));
        parts.insert(
            parts.len().saturating_sub(1).max(1).min(parts.len()),
            others,
        );
    }
    let (first, others) = (named.first()?, parts.get(1..).unwrap_or_default());
    let first = format!(
        "{} come from {}{}",
        error(first.rmse, &found.unit),
        name::source(&first.source),
        scattered(found, first)
    );
    let all: Vec<String> = [first].into_iter().chain(others.iter().cloned()).collect();
    let total = error_with_unit(found.expected_rmse_heldout?, &found.unit);
    let unit = nouns(found).unit;
    Some(format!(
        "of the {total} expected on an unseen {unit}{}, {} (added in quadrature)",
        came_out(found),
        listed(&all)
    ))
}

/// ` (78.5 N came out)`, where that is far from what was expected.
fn came_out(found: &CampaignFindings) -> String {
    let expected = found.expected_rmse_heldout;
    let came_out = found.after.rmse_heldout.or(found.before.rmse_heldout);
    let (Some(expected), Some(came_out)) = (expected, came_out) else {
        return String::new();
    };
    let far = came_out > FAR_FROM_EXPECTED * expected || expected > FAR_FROM_EXPECTED * came_out;
    if far {
        format!(" ({} came out)", error_with_unit(came_out, &found.unit))
    } else {
        String::new()
    }
}

/// ` (0.9 mm)`: the scatter behind a source of error, where it is one random effect.
fn scattered(found: &CampaignFindings, entry: &BudgetEntry) -> String {
    let Some(scatter) = scatter_behind(found, &entry.source) else {
        return String::new();
    };
    format!(" ({})", scatter_size(scatter))
}

/// The random effect behind a source of error, where it is one.
pub fn scatter_behind<'a>(found: &'a CampaignFindings, source: &str) -> Option<&'a Scatter> {
    let (id, levels) = name::scatter_of(source)?;
    let is = |s: &&Scatter| s.id == id && levels.contains(&s.level);
    found.scatter.iter().find(is)
}

/// The standard deviation with which unseen groups are predicted: a gain as a percentage.
pub fn scatter_size(scatter: &Scatter) -> String {
    if scatter.unit == "1" {
        let rounding = Rounding::Digits(2);
        return rounded(100.0 * scatter.sd_predictive, rounding) + "%";
    }
    plain(scatter.sd_predictive, &scatter.unit)
}

/// Whether what a measurement would be worth can be relied on: it is a fall of the error that the model with the effects expects, and says nothing
/// where that model is worse on unseen units than the one without, or where the fall would be more than all of the error that came out.
pub fn is_worth_credible(found: &CampaignFindings, worth: f64) -> bool {
    let rises = error_change(found).is_some_and(|(.., change)| change == Change::Worse);
    let came_out = found.after.rmse_heldout.or(found.before.rmse_heldout);
    !rises && came_out.is_none_or(|error| worth < error)
}

/// What the measurement that is worth most is worth.
fn worth(found: &CampaignFindings) -> Option<String> {
    let in_units = found
        .next_measurement
        .iter()
        .filter(|n| n.kind != NextKind::Separate)
        .filter_map(|n| Some((n, n.worth?)));
    let (best, worth) = in_units.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let words = worth_words(best)?;
    let error = found.expected_rmse_heldout.unwrap_or(0.0);
    let said = worth > WORTH_SAYING * error && is_worth_credible(found, worth);
    said.then(|| format!("{} {words}", measurement(best, &nouns(found))))
}

/// `three readings of each session of a new specimen bring the error to 5.1 N`.
fn few_readings(found: &CampaignFindings) -> Option<String> {
    let nouns = nouns(found);
    let after = found.after.rmse_heldout_after.get(READINGS_GIVEN)?;
    let unseen = found.after.rmse_heldout?;
    let error = error_with_unit(*after, &found.unit);
    let verb = if *after < unseen {
        "bring the error to"
    } else {
        "leave it at"
    };
    Some(format!(
        "three readings of each {} of a new {} {verb} {error}",
        nouns.setup, nouns.unit
    ))
}

/// What to measure: `knowing set lengths to 0.2 mm`.
pub fn measurement(next: &NextMeasurement, nouns: &Nouns) -> String {
    let number = |key: &str| next.at.get(key).copied();
    match next.kind {
        NextKind::Precision => {
            let what: Vec<String> = next.separates.iter().map(|s| name::source(s)).collect();
            format!("knowing {} to {}", listed(&what), conditions(next))
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
            let ids: Vec<String> = next.separates.iter().map(|id| name::effect(id)).collect();
            format!(
                "readings at {} to separate {}",
                conditions(next),
                listed(&ids)
            )
        }
    }
}

/// What it is worth, as the end of a sentence: `is worth 6.0 N`; none where that was not computed.
pub fn worth_words(next: &NextMeasurement) -> Option<String> {
    let worth = next.worth?;
    let several = match next.kind {
        NextKind::Specimens => next.at.get("specimens") != Some(&1.0),
        NextKind::SetPoints | NextKind::Separate => true,
        NextKind::Precision => false,
    };
    let verb = if several { "are worth" } else { "is worth" };
    Some(match next.kind {
        NextKind::Separate => match rounded(worth, Rounding::Decimals(1)).as_str() {
            "0.0" => "hardly tell them apart, and no other set point does better".to_owned(),
            worth => format!("{verb} {worth} in log-likelihood"),
        },
        _ => format!("{verb} {}", error_with_unit(worth, &next.unit)),
    })
}

/// The conditions of a measurement: `120 kPa, ε* = 0.40`.
pub fn conditions(next: &NextMeasurement) -> String {
    let all: Vec<String> = next
        .at
        .iter()
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

/// `recording error: session s05 (set length, −10 mm; set aside here only)`; of lengths and arms by hand these alone are set aside.
fn recording_errors(all: &[RecordingError]) -> Option<String> {
    let mut order: Vec<&RecordingError> = all.iter().collect();
    order.sort_by_key(|e| !e.set_aside);
    let mut said: Vec<String> = order
        .iter()
        .take(MOST_NAMED)
        .map(|e| recording_error(e))
        .collect();
    if order.len() > MOST_NAMED {
        said.push(format!("{} more", count(order.len() - MOST_NAMED)));
    }
    let plural = if all.len() == 1 { "" } else { "s" };
    (!said.is_empty()).then(|| format!("recording error{plural}: {}", listed(&said)))
}

fn recording_error(e: &RecordingError) -> String {
    let size = recorded_size(e).map_or_else(String::new, |s| format!(", {s}"));
    let aside = match set_aside(e) {
        _ if !e.set_aside => String::new(),
        Some(alone) => format!("; {alone} set aside, its torques stay"),
        // The paper's tables are fits that came before the search.
        None if matches!(e.level, Level::Session | Level::Specimen) => {
            "; set aside here only".to_owned()
        }
        None => "; set aside".to_owned(),
    };
    let kind = name::recording_error(e.kind, e.quantity.as_deref());
    format!("{} {} ({kind}{size}{aside})", name::level(e.level), e.group)
}

/// What a fit holds that looks mistaken, and what to do, a sentence without its full stop; none where nothing does.
pub fn in_doubt<'a>(all: impl Iterator<Item = &'a RecordingError>) -> Option<String> {
    let named = |e: &RecordingError| {
        let kind = name::recording_error(e.kind, e.quantity.as_deref());
        format!("{} {} ({kind})", name::level(e.level), e.group)
    };
    let all: Vec<String> = all.map(named).collect();
    let (verb, them) = if all.len() == 1 {
        ("looks", "it")
    } else {
        ("look", "them")
    };
    (!all.is_empty()).then(|| {
        format!(
            "{} {verb} mistaken, and this fit holds {them}: correct session.toml or exclude {them} there (exclude = \"why\"), and run again",
            listed(&all)
        )
    })
}

/// What of a group was set aside where that is not all of its readings: lengths or arms that were measured by hand beside its torques.
pub fn set_aside(e: &RecordingError) -> Option<&'static str> {
    match e.quantity.as_deref() {
        _ if !e.set_aside || e.level != Level::Test => None,
        Some("moment_arm") => Some("its arms alone"),
        Some("muscle_length") => Some("its lengths alone"),
        _ => None,
    }
}

/// The size of a recording error: a factor, or true less recorded.
pub fn recorded_size(e: &RecordingError) -> Option<String> {
    let value = e.value?;
    let number = rounded(value, Rounding::Digits(3));
    Some(match e.kind {
        ErrorKind::Unit => format!("factor {number}"),
        ErrorKind::SwappedColumns => format!("then a zero of {}", with_unit(&number, &e.unit)),
        _ => with_unit(&number, &e.unit),
    })
}

/// The answer of a campaign for a page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// What was found, and the errors where something was: a sentence without its full stop.
    pub opening: String,
    /// Whether "; the smallest detectable sizes are in" a table belongs behind it.
    pub limits: bool,
    /// Everything else, in sentences.
    pub rest: Vec<String>,
}

/// What was found with the errors; what they are made of and what would help; recording errors.
pub fn full_answer(found: &CampaignFindings) -> Answer {
    said(clauses(found))
}

/// The same in fewer words, where a table beside it has the errors after a few readings.
pub fn answer_beside_errors(found: &CampaignFindings) -> Answer {
    let all = clauses(found);
    said(Clauses {
        readings: None,
        errors: all.errors_in_short.clone(),
        ..all
    })
}

fn said(c: Clauses) -> Answer {
    let (beside, apart) = if c.limits {
        (None, c.errors)
    } else {
        (c.errors, None)
    };
    let opening: Vec<String> = [Some(c.found), beside].into_iter().flatten().collect();
    let second: Vec<String> = [c.budget, c.worth, c.readings]
        .into_iter()
        .flatten()
        .collect();
    let second = (!second.is_empty()).then(|| second.join("; "));
    let rest = [
        c.contradicted,
        apart,
        c.unexplained,
        second,
        c.recording_errors,
    ]
    .into_iter()
    .flatten();
    Answer {
        opening: capitalised(&opening.join(": ")),
        limits: c.limits,
        rest: rest.map(|s| capitalised(&s) + ".").collect(),
    }
}

/// What was found with the errors, and what is worth measuring next, in sentences.
pub fn answer_in_short(found: &CampaignFindings) -> Vec<String> {
    let all = clauses(found);
    let first = [Some(all.found), all.errors_in_short];
    let first: Vec<String> = first.into_iter().flatten().collect();
    let next = all.worth.map(|worth| format!("next: {worth}"));
    let sentences = [Some(first.join(": ")), next].into_iter().flatten();
    sentences.map(|s| capitalised(&s) + ".").collect()
}

/// A count with its noun: `1 reading`, `1,290 readings`.
pub fn counted(n: usize, one: &str, several: &str) -> String {
    let number = rounded(n as f64, Rounding::Decimals(0));
    format!("{number} {}", if n == 1 { one } else { several })
}

/// The same as sentences, without a table to point to.
pub fn sentences(found: &CampaignFindings) -> Vec<String> {
    let Answer {
        opening,
        limits,
        rest,
    } = full_answer(found);
    let limits = if limits {
        "; the smallest detectable sizes are in tables/detection_limits.csv"
    } else {
        ""
    };
    [format!("{opening}{limits}.")]
        .into_iter()
        .chain(rest)
        .collect()
}
