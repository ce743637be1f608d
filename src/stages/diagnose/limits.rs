//! What a campaign could have shown: detection limits, effects that it cannot show, and effects that it cannot tell apart.
//!
//! All of it follows from the design of the campaign at hand: from the trace of every effect after base model and strengths have been
//! refitted, and from the residual that is left.

use super::findings::{Alias, DetectionLimit, NotMeasurable};
use super::judge::ALIKE;
use super::linear::{BLIND, Linear};
use super::search::{LEAST_FALL, Search, State};
use super::term::{Scope, What};
use crate::effects;

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
        // One unit for an effect, so that campaigns can be compared: that of its first form.
        let unit = effect.forms().first().map(|f| f.amplitude.unit);
        let of_effect = |c: &usize| {
            search.candidates[*c].id() == Some(effect.id())
                && search.candidates[*c].scope == Scope::Whole
                && search.candidates[*c].form().map(|f| f.amplitude.unit) == unit
        };
        let whole: Vec<usize> = (0..search.candidates.len()).filter(of_effect).collect();
        let best = whole
            .iter()
            .map(|c| (*c, stand.information(*c)))
            .filter(|(_, i)| i.visible >= BLIND && i.left > 0.0)
            .max_by(|a, b| a.1.visible.total_cmp(&b.1.visible).then(b.0.cmp(&a.0)));
        let Some((candidate, information)) = best else {
            limits.not_measurable.push(NotMeasurable {
                id: effect.id().to_owned(),
                why: why_not(search, e, &whole),
            });
            continue;
        };
        shown.push(candidate);
        let inflation = (search.data.len() as f64 / state.effective).max(1.0).sqrt();
        let by_noise = SURE * state.fitted.sigma * inflation / information.left.sqrt();
        let least = search.least_n * search.least_n * search.data.len() as f64;
        let by_use = ((LEAST_FALL * stand.left).max(least) / information.left).sqrt();
        let What::Effect { form, .. } = search.candidates[candidate].what else {
            continue;
        };
        let form = &effect.forms()[form];
        let (size, unit) = if effect.near() > 0.0 {
            // The trace of an angle grows with its square: F (1 - cos phi).
            (
                (2.0 * by_noise.max(by_use) * effect.near()).sqrt(),
                form.amplitude.unit,
            )
        } else {
            (by_noise.max(by_use), form.amplitude.unit)
        };
        let (low, high) = form.amplitude.bounds;
        if size > low.abs().max(high.abs()) {
            limits.not_measurable.push(NotMeasurable {
                id: effect.id().to_owned(),
                why: format!(
                    "it would have to be larger than is physically possible ({} = {size:.2} {})",
                    form.amplitude.name, form.amplitude.unit
                ),
            });
            continue;
        }
        limits.detection.push(DetectionLimit {
            id: effect.id().to_owned(),
            form: form.name.to_owned(),
            smallest: size,
            unit: unit.to_owned(),
            visible: information.visible,
        });
    }
    for (k, a) in shown.iter().enumerate() {
        for b in &shown[k + 1..] {
            let cosine = stand.cosine(*a, *b);
            if cosine.abs() > ALIKE {
                limits.aliases.push(Alias {
                    ids: [*a, *b].map(|c| search.candidates[c].id().unwrap_or_default().to_owned()),
                    cosine,
                });
            }
        }
    }
    limits
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
