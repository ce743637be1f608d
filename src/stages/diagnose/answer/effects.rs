//! What is said of each effect that was found, and of those that were not.

use super::super::Work;
use super::super::candidates::STRENGTHS;
use super::super::data::{Data, ZERO_UNKNOWN};
use super::super::findings::{EffectFinding, ParameterFinding, Rejected};
use super::super::judge::{self, Judgement};
use super::super::linear::Linear;
use super::super::model::{Fitted, Model, Place};
use super::super::search::Search;
use super::super::term::{Scope, Term, What};
use super::super::uncertainty::Uncertainty;
use crate::effects::{self, Parameter};
use crate::numerics::statistics::mean;
use std::collections::BTreeSet;

pub(super) fn effects_found(
    work: &Work,
    search: &Search,
    full: &Model,
    fitted: &Fitted,
    uncertain: &[Uncertainty],
) -> Vec<EffectFinding> {
    let layout = full.layout();
    work.judgements
        .iter()
        .enumerate()
        .filter_map(|(k, judgement)| {
            let term = &work.candidates[judgement.candidate];
            let What::Effect { effect, .. } = term.what else {
                return None;
            };
            let form = term.form()?;
            let described = effects::all()[effect];
            Some(EffectFinding {
                id: described.id().to_owned(),
                title: described.title().to_owned(),
                equation: form.equation.to_owned(),
                form: form.name.to_owned(),
                class: class(search, judgement, described.id(), work),
                scope: scope_word(&term.scope).to_owned(),
                acts_on: judge::acts_on(term, work.train),
                parameters: parameters(k, term, fitted, &layout, uncertain, work.train),
                p_adjusted: judgement.p_adjusted,
                selected_in_folds: judgement.chosen_again,
                chosen_in_folds: chosen_in_folds(work, described.id()),
                helps_in_folds: judgement.helps,
                rmse_before: judgement.train.0,
                rmse_after: judgement.train.1,
                rmse_heldout_before: judgement.held_out.0,
                rmse_heldout_after: judgement.held_out.1,
                criterion_gain: judgement.criterion_gain,
                source: described.source().to_owned(),
                measurement: described.measurement().to_owned(),
            })
        })
        .collect()
}

/// Part of the outer folds that chose an effect.
fn chosen_in_folds(work: &Work, id: &str) -> f64 {
    let names = |chosen: &String| chosen.split(' ').next() == Some(id);
    let units = &work.held.by_unit;
    let chose = units.iter().filter(|u| u.chosen.iter().any(names)).count();
    chose as f64 / units.len().max(1) as f64
}

fn scope_word(scope: &Scope) -> &'static str {
    match scope {
        Scope::Whole => "global",
        Scope::Specimen(_) => "specimen",
        _ => "session",
    }
}

/// The ids of a class, the effect's own first.
fn class(search: &Search, judgement: &Judgement, id: &str, work: &Work) -> Vec<String> {
    let mut class = vec![id.to_owned()];
    for c in &judgement.class {
        if let Some(other) = search.candidates[*c].id() {
            class.push(other.to_owned());
        }
    }
    let term = &search.candidates[judgement.candidate];
    // A gain of every reading of a specimen is its strength.
    let gain = ["force_gain", "misalignment"].contains(&id);
    if gain && follows_specimens(term, work.train) {
        class.push(STRENGTHS.to_owned());
    }
    let mut seen = BTreeSet::new();
    class.retain(|x| seen.insert(x.clone()));
    class
}

/// Whether a term acts on all sessions of a specimen or on none.
fn follows_specimens(term: &Term, data: &Data) -> bool {
    let of = data.specimen_of_session();
    let mut acts: Vec<Option<Option<usize>>> = vec![None; data.specimens.len()];
    (0..of.len()).all(|s| *acts[of[s]].get_or_insert(term.acts_on[s]) == term.acts_on[s])
}

/// The numbers of a term: one with its shape, one a level, or mean and scatter of many.
fn parameters(
    k: usize,
    term: &Term,
    fitted: &Fitted,
    layout: &[Place],
    uncertain: &[Uncertainty],
    data: &Data,
) -> Vec<ParameterFinding> {
    let Some(form) = term.form() else {
        return Vec::new();
    };
    let (amplitudes, second) = &fitted.terms[k];
    let half_width = |place: Place| {
        let i = layout.iter().position(|p| *p == place);
        i.map_or(f64::NAN, |i| uncertain[i].half_width())
    };
    let size = |name: &str, g: usize| {
        let value = form.amplitude.absent + amplitudes[g];
        let half = half_width(Place::Amplitude(k, g));
        number(name, value, half, form.amplitude.unit)
    };
    let symbol = form.amplitude.name;
    match term.scope {
        _ if amplitudes.len() == 1 => {
            let shape = form.shape.map(|(shape, _)| {
                let half = half_width(Place::Shape(k));
                number(shape.name, *second, half, shape.unit)
            });
            [size(symbol, 0)].into_iter().chain(shape).collect()
        }
        Scope::Levels(column) => {
            let name = &data.extras[column].name;
            let levels = data.level_names(column);
            let title = |g: usize| {
                if name == ZERO_UNKNOWN {
                    symbol.to_owned()
                } else {
                    format!("{symbol} at {name} = {}", levels[g + 1])
                }
            };
            (0..amplitudes.len()).map(|g| size(&title(g), g)).collect()
        }
        _ => scatter_and_mean(form.amplitude, amplitudes).to_vec(),
    }
}

fn number(name: &str, value: f64, half_width: f64, unit: &str) -> ParameterFinding {
    ParameterFinding {
        name: name.to_owned(),
        value,
        ci_low: value - half_width,
        ci_high: value + half_width,
        unit: unit.to_owned(),
    }
}

/// Standard deviation and mean of many values, taken for normal.
fn scatter_and_mean(amplitude: Parameter, values: &[f64]) -> [ParameterFinding; 2] {
    let n = values.len() as f64;
    let middle = mean(values);
    let squares: f64 = values.iter().map(|x| (x - middle) * (x - middle)).sum();
    let sd = (squares / (n - 1.0)).sqrt();
    // The interval of a standard deviation (Wilson and Hilferty's chi-square).
    let chi = |z: f64| {
        let f = n - 1.0;
        let cube = 1.0 - 2.0 / (9.0 * f) + z * (2.0 / (9.0 * f)).sqrt();
        f * cube * cube * cube
    };
    let scatter = ParameterFinding {
        name: format!("sd of {}", amplitude.name),
        value: sd,
        ci_low: sd * ((n - 1.0) / chi(1.96)).sqrt(),
        ci_high: sd * ((n - 1.0) / chi(-1.96)).sqrt(),
        unit: amplitude.unit.to_owned(),
    };
    let name = format!("mean of {}", amplitude.name);
    let half = 2.07 * sd / n.sqrt();
    [
        scatter,
        number(&name, amplitude.absent + middle, half, amplitude.unit),
    ]
}

/// The best candidates that were not chosen, by what they would explain of the base model's residual.
pub(super) fn rivals(search: &Search, work: &Work) -> Vec<Rejected> {
    let model = search.model(&[]);
    let linear = Linear::new(
        &model,
        &work.null.fitted,
        work.null.fitted.scatter,
        search.candidates,
    );
    let stand = linear.stand(&linear.all_sessions(), &[]);
    let named: BTreeSet<String> = work
        .best
        .chosen
        .iter()
        .map(|c| judge::name(&search.candidates[*c], search.data))
        .collect();
    let mut gains: Vec<(f64, usize)> = (0..search.candidates.len())
        .filter(|c| search.candidates[*c].scope == Scope::Whole)
        .filter(|c| !named.contains(&judge::name(&search.candidates[*c], search.data)))
        .map(|c| (stand.gain(c).fall / stand.left.max(f64::MIN_POSITIVE), c))
        .filter(|(share, _)| *share > 0.01)
        .collect();
    gains.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut seen = BTreeSet::new();
    gains
        .into_iter()
        .filter(|(_, c)| seen.insert(judge::name(&search.candidates[*c], search.data)))
        .take(8)
        .map(|(share, c)| Rejected {
            form: search.candidates[c].form().map(|f| f.name.to_owned()),
            id: judge::name(&search.candidates[c], search.data),
            acts_on: judge::acts_on(&search.candidates[c], search.data),
            share,
            why: if work.best.chosen.is_empty() {
                "explains too little, or not surely"
            } else {
                "explains less than what was chosen, or nothing beside it"
            }
            .to_owned(),
        })
        .collect()
}
