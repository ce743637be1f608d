//! What a campaign could have shown: detection limits, effects that it cannot show, and effects that it cannot tell apart.
//!
//! All of it follows from the design of the campaign at hand: from the trace of every effect after base model and strengths have been
//! refitted, and from the residual that is left.

use super::between;
use super::findings::{Alias, DetectionLimit, NotMeasurable};
use super::judge::ALIKE;
use super::linear::{BLIND, Information, Linear, Stand};
use super::search::{LEAST_FALL, Search, State};
use super::term::Scope;
use super::words::with_unit;
use crate::effects::{self, Effect};
use std::collections::BTreeSet;

/// Standard errors at which an effect passes all guards.
const SURE: f64 = 6.0;

/// What the design can show.
pub struct Limits {
    /// Smallest sizes, one an effect.
    pub detection: Vec<DetectionLimit>,
    /// Effects that leave no trace.
    pub not_measurable: Vec<NotMeasurable>,
    /// Pairs with one trace.
    pub aliases: Vec<Alias>,
}

/// The limits beside a fitted state.
pub fn limits(search: &Search, state: &State) -> Limits {
    let model = search.model(&state.chosen);
    let linear = Linear::new(
        &model,
        &state.fitted,
        state.fitted.scatter,
        search.candidates,
    );
    let stand = linear.stand(&linear.all_sessions(), &[]);
    let mut limits = Limits {
        detection: Vec::new(),
        not_measurable: Vec::new(),
        aliases: Vec::new(),
    };
    let mut shown: Vec<usize> = Vec::new();
    for (e, effect) in effects::all().iter().enumerate() {
        if effect.id() == super::candidates::STRENGTHS {
            continue;
        }
        let not_measurable = |why: String| NotMeasurable {
            id: effect.id().to_owned(),
            why,
        };
        let whole = on_all_readings(search, *effect);
        if let Some(c) = whole
            .iter()
            .find(|c| between::is_common_gain(search.base, &search.candidates[**c]))
        {
            limits.detection.extend(limit_of_gain(search, state, *c));
            continue;
        }
        let Some((candidate, information)) = most_visible(&stand, &whole) else {
            let why = why_not(search, e, &whole);
            limits.not_measurable.push(not_measurable(why));
            continue;
        };
        shown.push(candidate);
        let Some(form) = search.candidates[candidate].form() else {
            continue;
        };
        let size = smallest(search, state, &stand, information, *effect);
        let amplitude = form.amplitude;
        if size > amplitude.bounds.0.abs().max(amplitude.bounds.1.abs()) {
            let size = with_unit(size, amplitude.unit);
            limits.not_measurable.push(not_measurable(format!(
                "it would have to be larger than is physically possible ({} = {size})",
                amplitude.name
            )));
            continue;
        }
        limits.detection.push(DetectionLimit {
            id: effect.id().to_owned(),
            form: form.name.to_owned(),
            smallest: size,
            unit: amplitude.unit.to_owned(),
            visible: information.visible,
        });
    }
    limits.aliases = aliases(search, &stand, &shown);
    limits
}

/// The smallest gain of all readings that the strengths of the specimens would show beside a base that is not fitted.
fn limit_of_gain(search: &Search, state: &State, candidate: usize) -> Option<DetectionLimit> {
    let term = &search.candidates[candidate];
    let form = term.form()?;
    let specimens: BTreeSet<usize> = search.data.specimen.iter().copied().collect();
    Some(DetectionLimit {
        id: term.id()?.to_owned(),
        form: form.name.to_owned(),
        smallest: SURE * state.fitted.scatter / (specimens.len() as f64).sqrt(),
        unit: form.amplitude.unit.to_owned(),
        visible: 1.0,
    })
}

/// The candidates of an effect with one value for all readings. One unit for an effect, that of its first form, so that campaigns can be
/// compared.
fn on_all_readings(search: &Search, effect: &dyn Effect) -> Vec<usize> {
    let unit = effect.forms().first().map(|f| f.amplitude.unit);
    let of_effect = |c: &usize| {
        let term = &search.candidates[*c];
        term.id() == Some(effect.id())
            && term.scope == Scope::Whole
            && term.form().map(|f| f.amplitude.unit) == unit
    };
    (0..search.candidates.len()).filter(of_effect).collect()
}

/// The candidate of which a refit leaves most; none where it leaves nothing of any.
fn most_visible(stand: &Stand, candidates: &[usize]) -> Option<(usize, Information)> {
    candidates
        .iter()
        .map(|c| (*c, stand.information(*c)))
        .filter(|(_, i)| i.visible >= BLIND && i.left > 0.0)
        .max_by(|a, b| a.1.visible.total_cmp(&b.1.visible).then(b.0.cmp(&a.0)))
}

/// The size at which an effect passes all guards: it must stand out of the noise, and matter.
fn smallest(
    search: &Search,
    state: &State,
    stand: &Stand,
    information: Information,
    effect: &dyn Effect,
) -> f64 {
    let readings = search.data.len() as f64;
    let inflation = (readings / state.effective).max(1.0).sqrt();
    let by_noise = SURE * state.fitted.sigma * inflation / information.left.sqrt();
    let least = search.least_n * search.least_n * readings;
    let by_use = ((LEAST_FALL * stand.left).max(least) / information.left).sqrt();
    let size = by_noise.max(by_use);
    if effect.near() > 0.0 {
        // The trace of an angle grows with its square: F (1 - cos phi).
        (2.0 * size * effect.near()).sqrt()
    } else {
        size
    }
}

/// The pairs of candidates that leave one trace.
fn aliases(search: &Search, stand: &Stand, shown: &[usize]) -> Vec<Alias> {
    let id = |c: usize| search.candidates[c].id().unwrap_or_default().to_owned();
    let mut aliases = Vec::new();
    for (k, a) in shown.iter().enumerate() {
        for b in &shown[k + 1..] {
            let cosine = stand.cosine(*a, *b);
            if cosine.abs() > ALIKE {
                aliases.push(Alias {
                    ids: [id(*a), id(*b)],
                    cosine,
                });
            }
        }
    }
    aliases
}

fn why_not(search: &Search, effect: usize, whole: &[usize]) -> String {
    let effect = effects::all()[effect];
    let lacking: Vec<&String> = effect
        .forms()
        .iter()
        .flat_map(|f| f.needs)
        .filter_map(|n| search.data.missing.get(n))
        .collect();
    if whole.is_empty() {
        return lacking
            .first()
            .map_or_else(|| "no form of it applies".to_owned(), |s| (*s).clone());
    }
    if search.base.coefficients.iter().any(|c| c.free) {
        format!(
            "one value for all readings is absorbed by the coefficients of the base model ({})",
            search
                .base
                .coefficients
                .iter()
                .filter(|c| c.free)
                .map(|c| c.name.as_str())
                .collect::<Vec<&str>>()
                .join(", ")
        )
    } else {
        "it is absorbed by the strengths of the specimens".to_owned()
    }
}
