//! The models of a group's comparison, ready to be asked anywhere, and their answers along the contraction as curves.

use crate::figures::laws::state;
use crate::figures::looks::{Look, of_model};
use crate::input::GroupInput;
use pipeline_compare::NEW;
use pipeline_config::Config;
use pipeline_fit::SpecimenSummary;
use pipeline_fit::equations::{JOINT, cap_length_m};
use pipeline_mechanics::models::{ForceModel, P_620_KPA, Prediction, new, published};

/// One model's answers along the contraction.
pub struct Curve {
    /// Contraction in percent and force, N; NaN where the model gives nothing or goes beyond its data.
    pub inside: Vec<(f64, f64)>,
    /// The same where it goes beyond its data.
    pub beyond: Vec<(f64, f64)>,
}

impl Curve {
    /// The curve through answers at contractions given as fractions.
    pub fn new(answers: &[(f64, Prediction)]) -> Self {
        let is_beyond = |k: usize| {
            let at = |k: usize| matches!(answers[k].1, Prediction::Extrapolated { .. });
            // A point inside next to one beyond belongs to both parts, so that they meet.
            at(k) || (k > 0 && at(k - 1)) || (k + 1 < answers.len() && at(k + 1))
        };
        let force = |p: &Prediction| p.force_n().unwrap_or(f64::NAN);
        let part = |keep: &dyn Fn(usize) -> bool| {
            let points = answers.iter().enumerate();
            points
                .map(|(k, (e, p))| (100.0 * e, if keep(k) { force(p) } else { f64::NAN }))
                .collect()
        };
        Self {
            inside: part(&|k| !matches!(answers[k].1, Prediction::Extrapolated { .. })),
            beyond: part(&is_beyond),
        }
    }

    /// Whether the model gives nothing anywhere.
    pub fn is_empty(&self) -> bool {
        let both = self.inside.iter().chain(&self.beyond);
        both.into_iter().all(|p| p.1.is_nan())
    }
}

/// A compared model that can be asked anywhere.
pub struct Model<'a> {
    /// How it is drawn.
    pub look: Look,
    /// What it says of a specimen at a contraction (fraction) and gauge pressure, kPa.
    pub answer: Answer<'a>,
}

/// The models of the comparison, in its order.
pub fn models<'a>(group: &'a GroupInput, config: &'a Config) -> Vec<Model<'a>> {
    let mut models: Vec<Model<'a>> = Vec::new();
    let mut seen: Vec<&str> = Vec::new();
    for (k, line) in group.comparison.comparisons.iter().enumerate() {
        if seen.contains(&line.model.as_str()) {
            continue;
        }
        seen.push(&line.model);
        let look = of_model(&line.model, &line.title, k);
        let published = published().into_iter().find(|m| m.id() == line.model);
        let answer = match published {
            Some(model) => Some(answer_of(group.fit.group.diameter_mm, model)),
            None if line.model == NEW => fitted(group, config),
            None => None,
        };
        models.extend(answer.map(|answer| Model { look, answer }));
    }
    models
}

/// A model's answer for a specimen, a contraction (fraction) and a gauge pressure in kPa.
pub type Answer<'a> = Box<dyn Fn(&SpecimenSummary, f64, f64) -> Prediction + Sync + 'a>;

fn answer_of<'a>(diameter_mm: u32, model: &'static dyn ForceModel) -> Answer<'a> {
    Box::new(move |specimen, contraction, pressure_kpa| {
        model.predict(&state(
            diameter_mm,
            specimen.rest_length_m,
            specimen.contraction_620,
            contraction,
            pressure_kpa,
        ))
    })
}

/// The joint fit of the group.
fn fitted<'a>(group: &'a GroupInput, config: &'a Config) -> Option<Answer<'a>> {
    let c = group.fit.equation(JOINT)?.values();
    let offset = cap_length_m(group.fit.group.diameter_mm, &config.fit);
    Some(Box::new(move |specimen, contraction, pressure_kpa| {
        let f620 = new::f620(c[0], c[1], offset, specimen.rest_length_m);
        let relative = contraction / specimen.contraction_620;
        let surface = [c[2], c[3], c[4]];
        let force = new::force(surface, f620, relative, pressure_kpa / P_620_KPA);
        Prediction::new(force, None)
    }))
}
