//! From the fitted models to the findings: values, no sentences.
//!
//! | file | idea |
//! |---|---|
//! | `effects` | the accepted effects, and the candidates beside the null model |
//! | `unexplained` | columns that explain what no effect does |
//! | `scatter` | how groups differ, and the sizes of the misfit |
//! | `coefficients` | the law without and with the effects |
//! | `alternative` | the law with or without its dependence on the resting length, with or without a frame that yields |
//! | `residuals` | what is left of every reading, for the figures |

mod alternative;
mod coefficients;
mod effects;
mod residuals;
mod scatter;
mod unexplained;

pub use alternative::alternative;
pub use residuals::relative_contraction;
pub use scatter::misfit;

use super::base::Base;
use super::data::Data;
use super::library::{Scope, Term};
use super::problem::ForceProblem;
use super::unseen::HeldOut;
use pipeline_findings::{ActsOn, FreeForm};
use pipeline_inference::fit::{Fitted, Setting};
use pipeline_inference::problem::{Point, Problem};
use pipeline_inference::profile::Profiles;
use pipeline_inference::search::Found;
use std::collections::BTreeMap;

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
    /// The law as it is known, without any effect.
    pub null: &'a Fitted,
    /// What it says of unseen specimens.
    pub held: &'a HeldOut,
    /// Free forms of the effects, by term.
    pub forms: &'a BTreeMap<usize, FreeForm>,
    /// Smallest effect of interest, N.
    pub smallest_n: f64,
    /// Profiles of the final model.
    pub profiles: Profiles<'a>,
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
        self.term(term).name(self.data())
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

    /// Predictions of a point without what groups have of their own.
    fn unconditional(&self, point: &Point, without: Option<usize>) -> Vec<f64> {
        let mut bare = self.problem.bare(point);
        bare.terms.retain(|(t, _)| Some(*t) != without);
        let mut predicted = self.problem.predict(&bare);
        predicted.truncate(self.data().len());
        predicted
    }

    /// What is left of every reading, as on unseen specimens: with the misfit that all share in the prediction, without what groups have of their
    /// own.
    pub(crate) fn left_as_unseen(&self, fitted: &Fitted) -> Vec<f64> {
        let predicted = self.unconditional(&fitted.point, None);
        let common = self.problem.common_misfit_of(&fitted.point);
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
}
