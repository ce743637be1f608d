//! From the fitted models of a joint to the findings: values, no sentences.

use super::library::What;
use super::problem::{TorqueProblem, class, component};
use super::terms::{ALL, place};
use super::unseen::{self, HeldOut};
use pipeline_diagnose::answer::rms;
use pipeline_diagnose::settings as shared;
use pipeline_diagnose::tally;
use pipeline_effects::{force_zero_offset, length_offset, specimen_variation};
use pipeline_findings::{
    ActsOn, EffectFinding, Estimate, Level, Misfit, NextKind, NextMeasurement, Parameter,
    Residuals, Scatter, Tested, Unexplained,
};
use pipeline_inference::fit::Setting;
use pipeline_inference::problem::{Point, Problem};
use pipeline_inference::profile::Profiles;
use pipeline_inference::query;
use pipeline_inference::search::{Accepted, Found};
use pipeline_inference::statistic::upper_tail;
use pipeline_inference::system::Variances;
use std::collections::BTreeMap;

/// The random effects as findings name them: component, id, level, unit; and the class of readings without which it is not listed.
#[rustfmt::skip]
const RANDOM_EFFECTS: [(usize, &str, Level, &str, Option<usize>); 5] = [
    (component::MOUNTING, length_offset::ID, Level::Test, "mm", None),
    (component::GAIN, specimen_variation::ID, Level::Actuator, "1", None),
    (component::ZERO, force_zero_offset::ID, Level::Test, "N.m", None),
    (component::LENGTH_BIAS, "hand_length_bias", Level::Test, "mm", Some(class::LENGTH)),
    (component::ARM_BIAS, "hand_arm_bias", Level::Test, "mm", Some(class::ARM)),
];

/// What the answers are made of.
pub struct Work<'a> {
    /// The problem.
    pub problem: &'a TorqueProblem<'a>,
    /// Its active part.
    pub setting: &'a Setting<'a>,
    /// What the search found.
    pub found: &'a Found,
    /// What it says of unseen actuators.
    pub held: &'a HeldOut,
    /// Smallest effect of interest, N.m.
    pub smallest_nm: f64,
    /// Profiles of the final model.
    pub profiles: Profiles<'a>,
}

impl Work<'_> {
    fn what(&self, term: usize) -> What {
        self.problem.library[term]
    }

    fn name(&self, term: usize) -> String {
        self.what(term).name(self.problem.data).to_owned()
    }

    /// The readings that are torques and take part.
    fn torques(&self) -> impl Iterator<Item = usize> + '_ {
        let active = |i: &usize| self.setting.active[self.problem.node()[*i]];
        (0..self.problem.row.len()).filter(move |i| self.problem.is_torque(*i) && active(i))
    }

    /// Predicted torques without random effects, each reading on the side of slackness on which it is fitted.
    fn unconditional(&self, point: &Point, without: Option<usize>) -> Vec<f64> {
        let mut bare = point.clone();
        bare.random.fill(0.0);
        bare.terms.retain(|(t, _)| Some(*t) != without);
        let all = self.problem.predict(&bare);
        self.torques().map(|i| all[i]).collect()
    }

    /// What law, effects and columns alone predict for the torques, an actuator that would push taken as slack: as unseen actuators are predicted.
    fn alone(&self, point: &Point) -> Vec<f64> {
        let torques = self.torques();
        torques
            .map(|i| self.problem.without_scatter(point, i))
            .collect()
    }

    fn change(&self, term: usize) -> Vec<f64> {
        let point = &self.found.model.point;
        let with = self.unconditional(point, None);
        let without = self.unconditional(point, Some(term));
        with.iter().zip(&without).map(|(a, b)| a - b).collect()
    }

    /// The accepted effects, strongest first.
    pub fn effects(&self) -> Vec<EffectFinding> {
        let accepted = self.found.accepted.iter();
        let effects = accepted.filter_map(|a| self.effect(a));
        let mut effects: Vec<EffectFinding> = effects.collect();
        let gain = |e: &EffectFinding| e.log_likelihood_gain.unwrap_or(0.0);
        effects.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
        // One actuator a search.
        let searches = self.held.units.iter().map(|u| u.found.clone());
        tally::note_found_again(&mut effects, &searches.collect::<Vec<_>>());
        effects
    }

    fn effect(&self, accepted: &Accepted) -> Option<EffectFinding> {
        let form = self.what(accepted.term).form()?;
        let values = self.found.model.values(accepted.term)?.to_vec();
        let others = accepted.in_its_place.iter();
        let named = others.filter(|other| self.what(other.term).form().is_some());
        let in_its_place: Vec<(String, f64)> = named
            .map(|other| (self.name(other.term), other.log_likelihood))
            .collect();
        let mut class = vec![form.id.to_owned()];
        let alike = in_its_place.iter().map(|(id, _)| id.as_str());
        let stood_for: Vec<&str> = form.stands_for(values[0]).collect();
        for id in alike.chain(stood_for) {
            if !class.iter().any(|c| c == id) {
                class.push(id.to_owned());
            }
        }
        let (parameters, profile) = self.parameters(accepted.term, &values);
        let change = rms(&self.change(accepted.term));
        Some(EffectFinding {
            id: form.id.to_owned(),
            acts_on: ActsOn::All,
            column: None,
            reference_level: None,
            from: None,
            parameters,
            form: form.form.to_owned(),
            equation: form.equation.to_owned(),
            p_familywise: accepted.p,
            log_likelihood_gain: Some(accepted.gain),
            found_in_folds: None,
            negligible: change < self.smallest_nm,
            rms: change,
            by_specimen: self.by_actuator(accepted.term),
            profile,
            free_form: None,
            in_its_place,
            explained_as_well_by: accepted
                .names_instead(|t| (self.what(t).form().is_none()).then(|| self.name(t))),
            measurement: form.measurement.to_owned(),
            source: form.source.to_owned(),
            class,
        })
    }

    /// Parameters with their intervals, and the profile of the first.
    fn parameters(&self, term: usize, values: &[f64]) -> (Vec<Parameter>, Vec<(f64, f64)>) {
        let Some(form) = self.what(term).form() else {
            return (Vec::new(), Vec::new());
        };
        let mut points = Vec::new();
        let parameters = values.iter().zip(form.symbols).enumerate();
        let parameters = parameters.map(|(k, (value, symbol))| {
            let profile = self.profiles.of(term, k);
            if let (0, Some(p)) = (k, &profile) {
                points.clone_from(&p.points);
            }
            Parameter {
                name: (*symbol).to_owned(),
                value: *value,
                ci_low: profile.as_ref().and_then(|p| p.low),
                ci_high: profile.as_ref().and_then(|p| p.high),
                unit: form.unit.to_owned(),
                of_level: None,
            }
        });
        (parameters.collect(), points)
    }

    /// Each actuator's own estimate of the first size.
    fn by_actuator(&self, term: usize) -> BTreeMap<String, Estimate> {
        let data = self.problem.data;
        let actuator = |r: &usize| data.readings[*r].actuator;
        let group: Vec<usize> = self.problem.row.iter().map(actuator).collect();
        let all = query::by_group(self.setting, &self.found.model, term, 0, &group);
        let named = data.actuators.iter().zip(all);
        named
            .filter_map(|(name, e)| {
                let e = e?;
                let estimate = Estimate {
                    value: e.value,
                    standard_error: e.standard_error,
                };
                Some(((*name).to_owned(), estimate))
            })
            .collect()
    }

    /// Columns that explain what no effect does.
    pub fn unexplained(&self) -> Vec<Unexplained> {
        let before = self.residual(&self.unconditional(&self.found.null.point, None));
        let one = |a: &Accepted| {
            let what = self.what(a.term);
            let values = self.found.model.values(a.term)?;
            let shape = match what {
                What::Effect(_) => return None,
                What::Gain(_) => "gain",
                What::Offset(_) => "offset",
            };
            let share = rms(&self.change(a.term)) / rms(&before).max(f64::MIN_POSITIVE);
            Some(Unexplained {
                column: self.name(a.term),
                shape: shape.to_owned(),
                p_familywise: a.p,
                log_likelihood_gain: Some(a.gain),
                share_of_variance: (share * share).min(1.0),
                explained_as_well_by: a.names_instead(|term| Some(self.name(term))),
                curve: what.curve(self.problem.data, values),
            })
        };
        self.found.accepted.iter().filter_map(one).collect()
    }

    /// The candidates beside the null model, the best of each form and column.
    pub fn tested(&self) -> Vec<Tested> {
        let mut tested: Vec<Tested> = Vec::new();
        for (t, shown) in &self.found.tested {
            let id = self.name(*t);
            let form = self.what(*t).form();
            let form_name = form.map_or("smooth", |f| f.form);
            if tested.iter().any(|k| k.id == id && k.form == form_name) {
                continue;
            }
            tested.push(Tested {
                is_column: form.is_none(),
                form: form_name.to_owned(),
                acts_on: ActsOn::All,
                log_likelihood_gain: 0.5 * shown.likelihood_ratio,
                amplitude: form.and_then(|_| shown.only_amplitude()),
                unit: form.map_or("1", |f| f.unit).to_owned(),
                p_familywise: upper_tail(&self.found.draws, shown.deviate()),
                id,
            });
        }
        tested
    }

    /// The random effects with their standard deviations. Biases of what was taken by hand are listed where something was.
    pub fn scatter(&self, variances: &Variances) -> Vec<Scatter> {
        let data = self.problem.data;
        let groups = |level: Level| -> Vec<(String, usize)> {
            let (names, nodes) = match level {
                Level::Actuator => (&data.actuators, &self.problem.actuators),
                _ => (&data.tests, &self.problem.tests),
            };
            let all = names.iter().zip(nodes);
            all.filter_map(|(n, node)| Some(((*n).to_owned(), (*node)?)))
                .collect()
        };
        let has = |c: usize| self.problem.class().contains(&c);
        let tree = self.problem.tree();
        let predictive = self.found.model.predictive(self.setting);
        let one = |(c, id, level, unit, _): (usize, &str, Level, &str, Option<usize>)| {
            let (low, high) = query::interval(self.setting, &self.found.model, variances, c);
            let value = |node: usize| {
                let (k, _) = tree.columns_of(node, c)?;
                Some(self.found.model.point.random[k])
            };
            Scatter {
                id: id.to_owned(),
                level,
                sd: variances.components[c],
                sd_predictive: predictive.components[c],
                share_of_rest_length: None,
                ci_low: Some(low),
                ci_high: high,
                unit: unit.to_owned(),
                declared: None,
                declared_contradicted: false,
                log_likelihood_gain: Some(query::gain_of(self.setting, &self.found.model, c)),
                values: groups(level)
                    .into_iter()
                    .filter_map(|(name, node)| Some((name, value(node)?)))
                    .collect(),
            }
        };
        let listed = RANDOM_EFFECTS.into_iter().filter(|e| e.4.is_none_or(has));
        listed.map(one).collect()
    }

    /// The sizes of the misfit, and what of the answer rests on their priors.
    pub fn misfit(&self, variances: &Variances) -> Misfit {
        let mut sensitive: Vec<String> = Vec::new();
        for term in query::sensitive(self.setting, self.found) {
            let name = self.name(term);
            if !sensitive.contains(&name) {
                sensitive.push(name);
            }
        }
        Misfit {
            common: variances.components[component::COMMON_MISFIT],
            session: variances.components[component::TEST_MISFIT],
            stroke: None,
            sensitive,
        }
    }

    fn residual(&self, predicted: &[f64]) -> Vec<f64> {
        let observed = self.torques().map(|i| self.problem.observed()[i]);
        observed.zip(predicted).map(|(y, p)| y - p).collect()
    }

    /// Residuals of the torques for the figures.
    pub fn residuals(&self) -> Residuals {
        let data = self.problem.data;
        let without = self.alone(&self.found.null.point);
        let with = self.alone(&self.found.model.point);
        let conditional = query::conditional(&self.found.model);
        let rows: Vec<usize> = self.torques().map(|i| self.problem.row[i]).collect();
        let named = |of: &dyn Fn(usize) -> usize, names: &[&str]| -> Vec<String> {
            rows.iter().map(|r| names[of(*r)].to_owned()).collect()
        };
        let angle = |r: &usize| data.readings[*r].at.angle_rad.to_degrees();
        let angles = ("angle_deg".to_owned(), rows.iter().map(angle).collect());
        let columns = data
            .columns
            .iter()
            .filter(|c| c.name != super::data::PLACEBO);
        let columns = columns.map(|c| {
            let values = rows.iter().map(|r| c.middle + c.sd * c.values[*r]);
            (c.name.clone(), values.collect())
        });
        Residuals {
            session: named(&|r| data.readings[r].test, &data.tests),
            specimen: named(&|r| data.readings[r].actuator, &data.actuators),
            before: self.residual(&without),
            after: self.residual(&with),
            conditional: self.torques().map(|i| conditional[i]).collect(),
            unseen_before: self.torques().map(|i| self.held.left[0][i]).collect(),
            unseen: self.torques().map(|i| self.held.left[1][i]).collect(),
            predicted: without,
            columns: [angles].into_iter().chain(columns).collect(),
            log: rows
                .iter()
                .map(|r| data.readings[*r].source.0.to_owned())
                .collect(),
            row: rows.iter().map(|r| data.readings[*r].source.1).collect(),
            steps: self.steps(),
        }
    }

    /// What is left of the torques with the first effect, with the first two, and so on, each model fitted again, in the order of the findings; then
    /// with the columns that explain what no effect does.
    fn steps(&self) -> Vec<(String, Vec<f64>)> {
        let model = &self.found.model;
        let is_effect = |a: &&Accepted| self.what(a.term).form().is_some();
        let (mut order, columns): (Vec<&Accepted>, Vec<&Accepted>) =
            self.found.accepted.iter().partition(is_effect);
        order.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        order.extend(columns);
        let step = |k: usize| {
            let name = self.name(order[k].term);
            let mut from = model.point.clone();
            let comes_in = |t: usize| order[..=k].iter().any(|a| a.term == t);
            from.terms.retain(|(t, _)| comes_in(*t));
            let point = if k + 1 == order.len() {
                from
            } else {
                self.setting
                    .fit(&from, std::slice::from_ref(&model.variances))
                    .point
            };
            (name, self.residual(&self.alone(&point)))
        };
        (0..order.len()).map(step).collect()
    }

    /// What is worth measuring next, best first.
    pub fn next(&self, variances: &Variances) -> Vec<NextMeasurement> {
        let budget = &self.held.budget;
        let total: f64 = budget.iter().map(|b| b.variance).sum();
        let of = |name: &str| {
            let found = budget.iter().find(|b| b.source == name);
            found.map_or(0.0, |b| b.variance)
        };
        let fall = |less: f64| total.sqrt() - (total - less).max(0.0).sqrt();
        let sd = variances.components[component::MOUNTING].max(shared::CALIPER_MM);
        let known = shared::CALIPER_MM / sd;
        let measurement =
            |kind, separates: &[&str], key: &str, value: f64, worth: Option<f64>| NextMeasurement {
                kind,
                separates: separates.iter().map(|s| (*s).to_owned()).collect(),
                at: BTreeMap::from([(key.to_owned(), value)]),
                unit: worth.map_or("1", |_| "N.m").to_owned(),
                worth,
            };
        let mounting = fall(of(unseen::MOUNTING) * (1.0 - known * known));
        // The variance of estimates falls with the number of actuators; with as many again, to half.
        let more = fall(0.5 * of("estimation"));
        let actuators = self.problem.actuators.iter().flatten().count() as f64;
        let mut list = vec![
            measurement(
                NextKind::Precision,
                &[unseen::MOUNTING],
                "sd_mm",
                shared::CALIPER_MM,
                Some(mounting),
            ),
            measurement(NextKind::Specimens, &[], "specimens", actuators, Some(more)),
        ];
        list.retain(|n| n.worth.is_some_and(|w| w > 0.0));
        list.sort_by(|a, b| b.worth.unwrap_or(0.0).total_cmp(&a.worth.unwrap_or(0.0)));
        // A test at half the pressure separates an offset of the length, which stays, from what yields, which halves.
        let yields = ALL
            .iter()
            .find(|f| f.first == place::AXIAL)
            .map_or("", |f| f.id);
        let pair = [ALL[place::LENGTH].id, yields];
        let stands_for_both = |a: &Accepted| {
            let alike = a.in_its_place.iter().map(|other| self.name(other.term));
            let names: Vec<String> = alike.chain([self.name(a.term)]).collect();
            pair.iter().all(|id| names.iter().any(|n| n == id))
        };
        if self.found.accepted.iter().any(stands_for_both) {
            list.insert(
                0,
                measurement(NextKind::Separate, &pair, "pressure_share", 0.5, None),
            );
        }
        list
    }
}
