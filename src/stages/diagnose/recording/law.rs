//! The law by which sessions are judged: the base law with what was found on all readings.

use crate::base::Base;
use crate::data::Data;
use crate::library::{Column, Scope, Term, What};
use crate::problem::ForceProblem;
use pipeline_effects::Applied;
use pipeline_inference::fit::{Fitted, Setting};
use pipeline_inference::problem::Problem;

/// The law by which sessions are judged: what acts on all readings, named or a dependence on a column, with the values from which a fit starts.
pub struct Law<'a> {
    pub(super) base: &'a Base,
    effects: Vec<(What, Vec<f64>)>,
}

impl<'a> Law<'a> {
    /// The base law alone.
    pub fn new(base: &'a Base) -> Self {
        Self {
            base,
            effects: Vec::new(),
        }
    }

    /// With an effect on all readings, and its amplitude and shape.
    pub fn with(mut self, what: What, values: &[f64]) -> Self {
        self.effects.push((what, values.to_vec()));
        self
    }

    /// Whether nothing is beside the base law.
    pub fn is_bare(&self) -> bool {
        self.effects.is_empty()
    }

    /// The effects as terms of the readings that a fit is made to.
    pub(super) fn terms(&self, data: &Data) -> Vec<Term> {
        let one = |(what, _): &(What, Vec<f64>)| Term::new(*what, Scope::All, data);
        self.effects.iter().map(one).collect()
    }

    /// A fit from where all fits start: one from a fit to other readings may end anywhere, if those are far off.
    pub(super) fn fit(&self, problem: &ForceProblem, setting: &Setting) -> Fitted {
        let mut from = problem.start();
        let values = self.effects.iter().map(|(_, values)| values.clone());
        from.terms = values.enumerate().collect();
        setting.fit(&from, &setting.fresh()[..1])
    }
}

/// The effects at the values of a fit.
pub(super) fn applied(problem: &ForceProblem, fit: &Fitted) -> Vec<Applied<f64>> {
    let of = |(t, values): &(usize, Vec<f64>)| {
        let shape = values.get(1).copied().unwrap_or(0.0);
        problem.library[*t].applied([values[0], shape])
    };
    fit.point.terms.iter().filter_map(of).collect()
}

/// The dependences on columns at the values of a fit.
pub(super) fn columns(problem: &ForceProblem, fit: &Fitted) -> Vec<(Column, [f64; 2])> {
    let of = |(t, values): &(usize, Vec<f64>)| match problem.library[*t].what {
        What::Column(column) => Some((column, [values[0], values[1]])),
        What::Effect { .. } => None,
    };
    fit.point.terms.iter().filter_map(of).collect()
}
