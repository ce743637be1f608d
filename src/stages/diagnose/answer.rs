//! From the fitted models to the findings: values, no sentences.

use super::base::{Base, LENGTH_LAW};
use super::data::{Data, PLACEBO};
use super::library::{Scope, Term, What};
use super::problem::{ForceProblem, component};
use super::tally;
use super::unseen::HeldOut;
use pipeline_findings::{
    ActsOn, Alternative, CoefficientChange, EffectFinding, Estimate, FreeForm, Level, Parameter,
    Residuals, Scatter, Tested, Unexplained,
};
use pipeline_inference::decisions;
use pipeline_inference::fit::{Fitted, Free, Setting};
use pipeline_inference::problem::{Point, Problem};
use pipeline_inference::profile::profile;
use pipeline_inference::query;
use pipeline_inference::screen::Normal;
use pipeline_inference::search::{Accepted, Found};
use pipeline_inference::statistic::upper_tail;
use pipeline_inference::system::Variances;
use pipeline_inference::variance::Prior;
use pipeline_mechanics::effects::{
    self, force_gain, force_zero_offset, length_offset, specimen_variation,
};
use pipeline_mechanics::models::{ForceModel, new};
use pipeline_numerics::statistics::median;
use std::collections::BTreeMap;

/// The random effects as findings name them: component, id, level, unit.
#[rustfmt::skip]
const RANDOM_EFFECTS: [(usize, &str, Level, &str); 8] = [
    (component::GAIN, specimen_variation::ID, Level::Specimen, "1"),
    (component::SET_LENGTH, length_offset::ID, Level::Session, "mm"),
    (component::DECLARED_LENGTH, length_offset::ID, Level::Session, "mm"),
    (component::ZERO, force_zero_offset::ID, Level::Session, "N"),
    (component::REST_LENGTH, "rest_length", Level::Specimen, "mm"),
    (component::CONTRACTED_LENGTH, "contracted_length", Level::Specimen, "mm"),
    (component::CAMPAIGN_GAIN, force_gain::ID, Level::Campaign, "1"),
    (component::CAMPAIGN_ZERO, force_zero_offset::ID, Level::Campaign, "N"),
];

/// What the answers are made of.
pub struct Work<'a> {
    /// Diameter, mm.
    pub diameter_mm: u32,
    /// The base law.
    pub base: &'a Base,
    /// The problem.
    pub problem: &'a ForceProblem<'a>,
    /// Its active part.
    pub setting: &'a Setting<'a>,
    /// What the search found.
    pub found: &'a Found,
    /// What it says of unseen specimens.
    pub held: &'a HeldOut,
    /// Free forms of the effects, by term.
    pub forms: &'a BTreeMap<usize, FreeForm>,
    /// Smallest effect of interest, N.
    pub smallest_n: f64,
    /// Draws.
    pub normal: &'a Normal<'a>,
}

/// Root of the mean square.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

impl Work<'_> {
    fn data(&self) -> &Data {
        self.problem.data
    }

    pub(crate) fn term(&self, term: usize) -> &Term {
        &self.problem.library[term]
    }

    /// Id of an effect, or name of a column.
    pub fn name(&self, term: usize) -> String {
        match self.term(term).what {
            What::Column(column) => column.name(self.data()),
            What::Effect { effect, .. } => effects::all()[effect].id().to_owned(),
        }
    }

    fn acts_on(&self, term: usize) -> (ActsOn, Option<String>, Option<String>) {
        match self.term(term).scope {
            Scope::All => (ActsOn::All, None, None),
            Scope::From(s) => (ActsOn::From, None, Some(self.data().sessions[s].clone())),
            Scope::Levels(k) => {
                let column = self.data().extras[k].name.clone();
                (ActsOn::Levels, Some(column), None)
            }
        }
    }

    /// Predictions of a point without its random effects.
    fn unconditional(&self, point: &Point, without: Option<usize>) -> Vec<f64> {
        let mut bare = point.clone();
        bare.random.fill(0.0);
        bare.terms.retain(|(t, _)| Some(*t) != without);
        self.problem.predict(&bare)
    }

    /// What is left of every reading, as on unseen specimens: with the misfit that all share in the prediction, without what groups have of their
    /// own.
    pub(crate) fn left_as_unseen(&self, fitted: &Fitted) -> Vec<f64> {
        let predicted = self.unconditional(&fitted.point, None);
        let root = self.problem.tree().width(0);
        let common = &fitted.point.random[..root];
        let left = |(i, predicted): (usize, &f64)| {
            let misfit = fitted.design.z[i].iter().zip(common);
            self.data().force[i] - predicted - misfit.map(|(z, b)| z * b).sum::<f64>()
        };
        predicted.iter().enumerate().map(left).collect()
    }

    /// Root mean square of what is left of the readings that were searched.
    pub fn error_in_sample(&self, fitted: &Fitted) -> f64 {
        let left = self.left_as_unseen(fitted).into_iter();
        let nodes = self.problem.node().iter();
        let active = left.zip(nodes).filter(|(_, n)| self.setting.active[**n]);
        rms(&active.map(|(e, _)| e).collect::<Vec<f64>>())
    }

    /// What a term does to the readings that it acts on.
    fn change(&self, term: usize) -> Vec<f64> {
        let point = &self.found.model.point;
        let with = self.unconditional(point, None);
        let without = self.unconditional(point, Some(term));
        let acting = &self.term(term).acts_on;
        let pairs = with.iter().zip(&without).enumerate();
        pairs
            .filter(|(i, _)| acting[self.data().session[*i]].is_some())
            .map(|(_, (a, b))| a - b)
            .collect()
    }

    /// The accepted terms.
    fn accepted(&self) -> Vec<usize> {
        self.found.accepted.iter().map(|a| a.term).collect()
    }

    /// The accepted effects. A constant beside an offset that goes with a column is part of that dependence ([`Self::unexplained`]).
    pub fn effects(&self) -> Vec<EffectFinding> {
        let all = self.accepted();
        let accepted = self.found.accepted.iter();
        let named = accepted.filter(|a| !self.problem.is_origin(a.term, &all));
        let mut effects: Vec<EffectFinding> = named.filter_map(|a| self.effect(a)).collect();
        effects.sort_by(|a, b| {
            let gain = |e: &EffectFinding| e.log_likelihood_gain.unwrap_or(0.0);
            gain(b).total_cmp(&gain(a))
        });
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
        let named = accepted
            .in_its_place
            .iter()
            .filter(|other| self.term(other.term).id().is_some());
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
            from,
            parameters,
            form: form.name.to_owned(),
            equation: form.equation.to_owned(),
            p_familywise: accepted.p,
            log_likelihood_gain: Some(accepted.gain),
            found_in_folds: tally::found_in_folds(&self.held.units, &class),
            negligible: change < self.smallest_n,
            rms: change,
            by_specimen: self.by_specimen(accepted.term),
            profile: points,
            free_form: self.forms.get(&accepted.term).cloned(),
            in_its_place,
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
        let mut points = Vec::new();
        let parameters = values.iter().enumerate().map(|(k, value)| {
            let known = match form.shape {
                Some((shape, _)) if k >= amplitudes => shape,
                _ => form.amplitude,
            };
            let profile = profile(self.setting, &self.found.model, term, k, self.normal);
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
            }
        });
        (parameters.collect(), points)
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

    /// Columns that explain what no effect does.
    pub fn unexplained(&self) -> Vec<Unexplained> {
        let point = &self.found.model.point;
        let before: Vec<f64> = self
            .unconditional(&self.found.null.point, None)
            .iter()
            .zip(&self.data().force)
            .map(|(p, y)| y - p)
            .collect();
        let all = self.accepted();
        let origin = all.iter().filter(|t| self.problem.is_origin(**t, &all));
        // Of two offsets the first to come in has it: which one nobody can know.
        let mut constant = origin
            .filter_map(|t| self.found.model.values(*t)?.first().copied())
            .next();
        let accepted = self.found.accepted.iter();
        accepted
            .filter_map(|a| {
                let What::Column(column) = self.term(a.term).what else {
                    return None;
                };
                let values = point.terms.iter().find(|(t, _)| *t == a.term)?.1.clone();
                let share = rms(&self.change(a.term)) / rms(&before).max(f64::MIN_POSITIVE);
                let mut curve = column.curve(self.data(), [values[0], values[1]]);
                if !column.is_gain() {
                    let constant = constant.take().unwrap_or(0.0);
                    curve.iter_mut().for_each(|(_, y)| *y += constant);
                }
                Some(Unexplained {
                    column: column.name(self.data()),
                    shape: if column.is_gain() { "gain" } else { "offset" }.to_owned(),
                    p_familywise: a.p,
                    log_likelihood_gain: Some(a.gain),
                    share_of_variance: (share * share).min(1.0),
                    curve,
                })
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

    /// The random effects with their standard deviations.
    pub fn scatter(&self, variances: &Variances) -> Vec<Scatter> {
        let data = self.data();
        let p = self.problem;
        let groups = |level: Level| -> Vec<(String, usize)> {
            let (names, nodes) = match level {
                Level::Specimen => (&data.specimens, &p.specimens),
                Level::Campaign => (&data.campaigns, &p.campaigns),
                _ => (&data.sessions, &p.sessions),
            };
            names.iter().cloned().zip(nodes.iter().copied()).collect()
        };
        let predictive = self.found.model.predictive(self.setting);
        RANDOM_EFFECTS
            .into_iter()
            .filter_map(|(c, id, level, unit)| {
                let named = (id, level, unit);
                self.one_scatter([variances, &predictive], c, named, &groups(level))
            })
            .collect()
    }

    /// The scatter of a component, from the standard deviations and from those of predictions; none where no group has it.
    fn one_scatter(
        &self,
        [variances, predictive]: [&Variances; 2],
        c: usize,
        (id, level, unit): (&str, Level, &str),
        groups: &[(String, usize)],
    ) -> Option<Scatter> {
        let tree = self.problem.tree();
        let mut values = BTreeMap::new();
        let mut units = Vec::new();
        for (place, (name, node)) in groups.iter().enumerate() {
            if *node < tree.len()
                && let Some((k, _)) = tree.columns_of(*node, c)
            {
                let unit = self.unit_of(c, place);
                units.push(unit);
                values.insert(name.clone(), unit * self.found.model.point.random[k]);
            }
        }
        if units.is_empty() {
            return None;
        }
        let unit_sd = median(&units);
        let is_fixed = matches!(self.problem.components()[c].scale.prior, Prior::Fixed(_));
        let is_declared = self.problem.is_declared(c);
        let sd = unit_sd * variances.components[c];
        let (ci_low, ci_high) = if is_fixed {
            (None, None)
        } else {
            let (low, high) = query::interval(self.setting, &self.found.model, variances, c);
            (Some(unit_sd * low), high.map(|h| unit_sd * h))
        };
        Some(Scatter {
            id: id.to_owned(),
            level,
            sd,
            sd_predictive: unit_sd * predictive.components[c],
            ci_low,
            ci_high,
            unit: unit.to_owned(),
            declared: (is_declared || is_fixed).then_some(unit_sd),
            declared_contradicted: is_declared
                && (!is_fixed
                    || query::is_too_small(self.setting, &self.found.model, variances, c)),
            log_likelihood_gain: (!is_fixed)
                .then(|| query::gain_of(self.setting, &self.found.model, c)),
            values,
        })
    }

    /// What a component of one group is in units of.
    fn unit_of(&self, c: usize, place: usize) -> f64 {
        match c {
            component::REST_LENGTH => self.problem.specimen_lengths_sd_mm(place)[0],
            component::CONTRACTED_LENGTH => self.problem.specimen_lengths_sd_mm(place)[1],
            component::DECLARED_LENGTH => self.data().set_length_sd_mm[place],
            _ => 1.0,
        }
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

    /// Coefficients of the law without and with the effects.
    pub fn coefficients(&self) -> Vec<CoefficientChange> {
        let model = &self.found.model;
        let covariance = model.covariance(&model.variances);
        let published = new::NewPublished.coefficients(self.diameter_mm);
        let list = self.base.coefficients.iter().enumerate();
        list.filter(|(_, c)| c.free)
            .map(|(k, c)| {
                let place = model.free.iter().position(|f| *f == Free::Coefficient(k));
                let error = place.map_or(0.0, |p| covariance.at(p, p).max(0.0).sqrt());
                let known = |symbol: &str| {
                    let found = published.iter().find(|p| p.symbol == symbol);
                    found.map(|p| p.value)
                };
                CoefficientChange {
                    name: c.name.clone(),
                    unit: c.unit.clone(),
                    before: self.found.null.point.coefficients[k],
                    after: model.point.coefficients[k],
                    standard_error: error,
                    published: match c.reciprocal_of {
                        Some(symbol) => known(symbol).map(|x| 1.0 / x),
                        None => known(&c.name),
                    },
                    at_bound: model.at_bound[k],
                    before_at_bound: self.found.null.at_bound[k],
                }
            })
            .collect()
    }

    /// Residuals for the figures.
    pub fn residuals(&self) -> Residuals {
        let data = self.data();
        Residuals {
            session: data
                .session
                .iter()
                .map(|s| data.sessions[*s].clone())
                .collect(),
            specimen: data
                .specimen
                .iter()
                .map(|k| data.specimens[*k].clone())
                .collect(),
            before: self.left_as_unseen(&self.found.null),
            after: self.left_as_unseen(&self.found.model),
            conditional: query::conditional(&self.found.model),
            unseen_before: self.held.left[0].clone(),
            unseen: self.held.left[1].clone(),
            predicted: self.unconditional(&self.found.null.point, None),
            columns: columns(data),
            steps: self.steps(),
            ..Residuals::default()
        }
    }
}

/// eps*: the contraction as a share of the largest.
pub fn relative_contraction(at: &effects::Conditions) -> f64 {
    (at.rest_length_m - at.length_m) / (at.rest_length_m - at.contracted_length_m)
}

/// The columns that were looked at, one value a reading.
fn columns(data: &Data) -> Vec<(String, Vec<f64>)> {
    let of = |f: &dyn Fn(&effects::Conditions) -> f64| -> Vec<f64> {
        data.conditions.iter().map(f).collect()
    };
    let mut columns = vec![
        ("pressure_kpa".to_owned(), of(&|c| c.pressure_kpa)),
        ("contraction_rel".to_owned(), of(&relative_contraction)),
        ("rest_length_m".to_owned(), of(&|c| c.rest_length_m)),
        ("direction".to_owned(), of(&|c| c.direction)),
        ("time_s".to_owned(), of(&|c| c.log_time_s)),
        ("since_step_s".to_owned(), of(&|c| c.since_step_s)),
        ("pressure_rate".to_owned(), of(&|c| c.rate_kpa_per_s)),
        ("temperature_c".to_owned(), of(&|c| c.temperature_c)),
        ("cycles".to_owned(), of(&|c| c.cycles)),
    ];
    let extras = data.extras.iter().filter(|e| e.name != PLACEBO);
    columns.extend(extras.map(|e| {
        let values = e.values.iter().map(|x| e.scale.0 + e.scale.1 * x);
        (e.name.clone(), values.collect())
    }));
    columns.retain(|(_, v)| v.iter().any(|x| (x - v[0]).abs() > 1e-9));
    columns
}

/// The sizes of the misfit.
pub fn misfit(variances: &Variances, problem: &ForceProblem) -> pipeline_findings::Misfit {
    let stroke = variances.components[component::STROKE_MISFIT];
    pipeline_findings::Misfit {
        common: variances.components[component::COMMON_MISFIT],
        session: variances.components[component::SESSION_MISFIT],
        stroke: problem.has_strokes().then_some(stroke),
        sensitive: Vec::new(),
    }
}

/// The law with or without its dependence on the resting length, and with or without a frame that yields.
pub fn alternative(
    fit: &Fitted,
    length_law: bool,
    frame: Option<usize>,
    problem: &ForceProblem,
    held_out: Option<(f64, f64)>,
) -> Alternative {
    let covariance = fit.covariance(&fit.variances);
    let number = |name: &str, unit: &str, value: f64, place: Option<usize>| {
        let error = place.map(|p| covariance.at(p, p).max(0.0).sqrt());
        let end = |sign: f64| error.map(|e| value + sign * decisions::NORMAL_95 * e);
        Parameter {
            name: name.to_owned(),
            value,
            ci_low: end(-1.0),
            ci_high: end(1.0),
            unit: unit.to_owned(),
        }
    };
    let mut parts = Vec::new();
    let mut numbers = Vec::new();
    if length_law {
        parts.push("length_law".to_owned());
        let c = &problem.base.coefficients[LENGTH_LAW];
        let place = fit
            .free
            .iter()
            .position(|f| *f == Free::Coefficient(LENGTH_LAW));
        numbers.push(number(
            &c.name,
            &c.unit,
            fit.point.coefficients[LENGTH_LAW],
            place,
        ));
    }
    if let Some(term) = frame {
        parts.extend(problem.library[term].id().map(str::to_owned));
        if let (Some(form), Some(values)) = (problem.library[term].form(), fit.values(term)) {
            let a = form.amplitude;
            numbers.push(number(a.name, a.unit, values[0], fit.place(term, 0)));
        }
    }
    Alternative {
        parts,
        parameters: fit.free.len(),
        log_likelihood: fit.log_likelihood,
        rmse_heldout: held_out.map(|h| h.0),
        log_density_heldout: held_out.map(|h| h.1),
        numbers,
    }
}
