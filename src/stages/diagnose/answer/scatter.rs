//! How groups differ: random effects with their standard deviations and intervals, and the sizes of the misfit.

use super::Work;
use crate::problem::{ForceProblem, component, mean_noted};
use crate::settings;
use pipeline_effects::{force_gain, force_zero_offset, length_offset, specimen_variation};
use pipeline_findings::{Level, NotedContractions, Scatter};
use pipeline_inference::heldout::Unseen;
use pipeline_inference::problem::Problem;
use pipeline_inference::query;
use pipeline_inference::system::Variances;
use pipeline_inference::variance::Prior;
use pipeline_numerics::matrix::norm;
use pipeline_numerics::statistics::{median, standard_deviation};
use std::collections::BTreeMap;

/// The random effects as findings name them: component, id, level, unit.
#[rustfmt::skip]
const RANDOM_EFFECTS: [(usize, &str, Level, &str); 9] = [
    (component::GAIN, specimen_variation::ID, Level::Specimen, "1"),
    (component::SET_LENGTH, length_offset::ID, Level::Session, "mm"),
    (component::DECLARED_LENGTH, length_offset::ID, Level::Session, "mm"),
    (component::ZERO, force_zero_offset::ID, Level::Session, "N"),
    (component::REST_LENGTH, "rest_length", Level::Specimen, "mm"),
    (component::CONTRACTION, "contracted_length", Level::Specimen, "mm"),
    (component::CONTRACTED_LENGTH, "contracted_length", Level::Specimen, "mm"),
    (component::CAMPAIGN_GAIN, force_gain::ID, Level::Campaign, "1"),
    (component::CAMPAIGN_ZERO, force_zero_offset::ID, Level::Campaign, "N"),
];

impl Work<'_> {
    /// The random effects with their standard deviations.
    pub fn scatter(&self, variances: &Variances) -> Vec<Scatter> {
        let data = self.data();
        let p = self.problem;
        let column = |node: usize, c: usize| -> Option<usize> {
            let known = Some(node).filter(|n| *n < p.tree().len())?;
            p.tree().columns_of(known, c).map(|(k, _)| k)
        };
        let groups = |level: Level, c: usize| -> Vec<(String, Option<usize>)> {
            let of = |names: &[String], nodes: &[usize]| {
                let columns = nodes.iter().map(|n| column(*n, c));
                names.iter().cloned().zip(columns).collect()
            };
            match level {
                Level::Campaign => {
                    let all = data.campaigns.iter().enumerate();
                    all.map(|(k, name)| (name.clone(), p.campaign_column(k, c)))
                        .collect()
                }
                // Rounding is no finding where what is estimated stands beside it.
                Level::Specimen if c == component::CONTRACTED_LENGTH => {
                    let all: Vec<(String, Option<usize>)> = of(&data.specimens, &p.specimens);
                    let only = |(k, (name, column)): (usize, (String, Option<usize>))| {
                        (name, column.filter(|_| data.contracted_is_declared(k)))
                    };
                    all.into_iter().enumerate().map(only).collect()
                }
                Level::Specimen => of(&data.specimens, &p.specimens),
                _ => of(&data.sessions, &p.sessions),
            }
        };
        let predictive = self.found.model.predictive(self.setting);
        RANDOM_EFFECTS
            .into_iter()
            .filter_map(|(c, id, level, unit)| {
                let named = (id, level, unit);
                self.one_scatter([variances, &predictive], c, named, &groups(level, c))
            })
            .collect()
    }

    /// What the contractions that were noted are worth; none where they are declared or alike.
    pub fn noted_contractions(&self) -> Option<NotedContractions> {
        let noted = self.data().noted_contractions();
        let mean = mean_noted(&noted)?;
        let known: Vec<f64> = noted.into_iter().flatten().collect();
        let column = self.problem.noting_column()?;
        let unseen = Unseen::new(self.setting, &self.found.model);
        let (means, root) = unseen.parameters_known();
        let row: Vec<f64> = (0..=column).map(|j| root.at(column, j)).collect();
        Some(NotedContractions {
            specimens: known.len(),
            mean,
            sd: standard_deviation(&known),
            error: component::noting_error(means[column]),
            error_sd: settings::NOTING_ERROR.1 * norm(&row),
        })
    }

    /// The scatter of a component, from the standard deviations and from those of predictions; the groups with their columns. None where no group has
    /// it.
    fn one_scatter(
        &self,
        [variances, predictive]: [&Variances; 2],
        c: usize,
        (id, level, unit): (&str, Level, &str),
        groups: &[(String, Option<usize>)],
    ) -> Option<Scatter> {
        let mut values = BTreeMap::new();
        let mut units = Vec::new();
        for (place, (name, column)) in groups.iter().enumerate() {
            if let Some(k) = column {
                let unit = self.unit_of(c, place);
                units.push(unit);
                values.insert(name.clone(), unit * self.found.model.point.random[*k]);
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
            share_of_rest_length: (c == component::CONTRACTION).then_some(predictive.components[c]),
            ci_low,
            ci_high,
            unit: unit.to_owned(),
            declared: is_declared.then_some(unit_sd),
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
            component::CONTRACTION => self.data().rest_lengths_mm()[place],
            _ => 1.0,
        }
    }
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
