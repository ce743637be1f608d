//! The accepted effects with their intervals, and the candidates beside the null model.

use super::{Work, rms};
use crate::library::{Scope, What};
use crate::tally;
use pipeline_effects as effects;
use pipeline_findings::{EffectFinding, Estimate, Parameter, Tested};
use pipeline_inference::query;
use pipeline_inference::search::Accepted;
use pipeline_inference::statistic::upper_tail;
use std::collections::BTreeMap;

impl Work<'_> {
    /// The accepted effects. A constant beside an offset that goes with a column is part of that dependence ([`Self::unexplained`]).
    pub fn effects(&self) -> Vec<EffectFinding> {
        let all = self.accepted();
        let accepted = self.found.accepted.iter();
        let named = accepted.filter(|a| !self.problem.is_origin(a.term, &all));
        let effects = named.filter_map(|a| self.effect(a));
        let mut effects: Vec<EffectFinding> = effects.collect();
        effects.sort_by(|a, b| {
            let gain = |e: &EffectFinding| e.log_likelihood_gain.unwrap_or(0.0);
            gain(b).total_cmp(&gain(a))
        });
        tally::note_found_again(&mut effects, &self.held.searches);
        effects
    }

    fn effect(&self, accepted: &Accepted) -> Option<EffectFinding> {
        let term = self.term(accepted.term);
        let What::Effect { effect, .. } = term.what else {
            return None;
        };
        let e = effects::all()[effect];
        let form = term.form()?;
        let (acts_on, column, from) = self.acts_on(accepted.term);
        let is_column = |t: usize| self.term(t).id().is_none();
        let named = accepted.in_its_place.iter();
        let named = named.filter(|other| !is_column(other.term));
        let in_its_place: Vec<(String, f64)> = named
            .map(|other| (self.name(other.term), other.log_likelihood))
            .collect();
        let mut class = vec![e.id().to_owned()];
        for (id, _) in &in_its_place {
            if !class.contains(id) {
                class.push(id.clone());
            }
        }
        let values = self.found.model.values(accepted.term)?.to_vec();
        let (parameters, points) = self.parameters(accepted.term, &values);
        let change = rms(&self.change(accepted.term));
        Some(EffectFinding {
            id: e.id().to_owned(),
            acts_on,
            column,
            reference_level: self.levels_of(accepted.term).first().cloned(),
            from,
            parameters,
            form: form.name.to_owned(),
            equation: form.equation.to_owned(),
            p_familywise: accepted.p,
            log_likelihood_gain: Some(accepted.gain),
            found_in_folds: None,
            negligible: change < self.smallest_n,
            rms: change,
            by_specimen: self.by_specimen(accepted.term),
            profile: points,
            free_form: self.forms.get(&accepted.term).cloned(),
            in_its_place,
            explained_as_well_by: accepted.names_instead(|t| is_column(t).then(|| self.name(t))),
            measurement: e.measurement().to_owned(),
            source: e.source().to_owned(),
            class,
        })
    }

    /// Parameters with their intervals, and the profile of the first amplitude.
    fn parameters(&self, term: usize, values: &[f64]) -> (Vec<Parameter>, Vec<(f64, f64)>) {
        let Some(form) = self.term(term).form() else {
            return (Vec::new(), Vec::new());
        };
        let amplitudes = self.term(term).amplitudes;
        let levels = self.levels_of(term);
        let mut points = Vec::new();
        let parameters = values.iter().enumerate().map(|(k, value)| {
            let known = match form.shape {
                Some((shape, _)) if k >= amplitudes => shape,
                _ => form.amplitude,
            };
            let profile = self.profiles.of(term, k);
            if let (0, Some(p)) = (k, &profile) {
                points = p
                    .points
                    .iter()
                    .map(|(x, l)| (known.absent + x, *l))
                    .collect();
            }
            let end = |x: Option<f64>| x.map(|x| known.absent + x);
            Parameter {
                name: known.name.to_owned(),
                value: known.absent + value,
                ci_low: end(profile.as_ref().and_then(|p| p.low)),
                ci_high: end(profile.as_ref().and_then(|p| p.high)),
                unit: known.unit.to_owned(),
                of_level: (k < amplitudes)
                    .then(|| levels.get(k + 1).cloned())
                    .flatten(),
            }
        });
        (parameters.collect(), points)
    }

    /// The levels of the column that a term acts on, that on which it does not act first; none where it acts on no levels.
    fn levels_of(&self, term: usize) -> Vec<String> {
        match self.term(term).scope {
            Scope::Levels(column) => self.data().level_names(column),
            Scope::All | Scope::From(_) => Vec::new(),
        }
    }

    /// Each specimen's own estimate of the first amplitude, all else and the variances as found.
    fn by_specimen(&self, term: usize) -> BTreeMap<String, Estimate> {
        let data = self.data();
        let all = query::by_group(self.setting, &self.found.model, term, 0, &data.specimen);
        let absent = self.term(term).form().map_or(0.0, |f| f.amplitude.absent);
        let named = data.specimens.iter().zip(all);
        named
            .filter_map(|(name, e)| {
                let e = e?;
                let estimate = Estimate {
                    value: absent + e.value,
                    standard_error: e.standard_error,
                };
                Some((name.clone(), estimate))
            })
            .collect()
    }

    /// The candidates beside the null model, the best form of each effect and column.
    pub fn tested(&self) -> Vec<Tested> {
        let mut tested: Vec<Tested> = Vec::new();
        for (t, shown) in &self.found.tested {
            let id = self.name(*t);
            let form = self.term(*t).form();
            let form_name = form.map_or("smooth", |f| f.name);
            if tested.iter().any(|k| k.id == id && k.form == form_name) {
                continue;
            }
            let amplitude = form.and_then(|f| Some(f.amplitude.absent + shown.only_amplitude()?));
            tested.push(Tested {
                is_column: form.is_none(),
                form: form_name.to_owned(),
                acts_on: self.acts_on(*t).0,
                log_likelihood_gain: 0.5 * shown.likelihood_ratio,
                amplitude,
                unit: form.map_or("1", |f| f.amplitude.unit).to_owned(),
                p_familywise: upper_tail(&self.found.draws, shown.deviate()),
                id,
            });
        }
        tested
    }

    /// Names of effects and columns whose place in the answer changes with the prior of the misfit.
    pub fn sensitive(&self) -> Vec<String> {
        let mut sensitive: Vec<String> = Vec::new();
        for term in query::sensitive(self.setting, self.found) {
            let name = self.name(term);
            if !sensitive.contains(&name) {
                sensitive.push(name);
            }
        }
        sensitive
    }
}
