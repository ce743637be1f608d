//! What a point leaves of a group's readings, and the penalised sum of squares there.

use super::{Asked, Unseen};
use crate::gram::Design;
use crate::problem::Point;
use crate::system::dot;
use std::collections::BTreeSet;

/// A place on the way to the mode of a group's random effects.
#[derive(Clone)]
pub(super) struct Stand {
    pub(super) point: Point,
    /// Root and fixed effects, in units of independent standard normal numbers.
    pub(super) parameters: Vec<f64>,
    /// Measured less what is expected there.
    pub(super) left: Vec<f64>,
    /// The penalised sum of squares of the readings that are known.
    pub(super) value: f64,
}

impl Unseen<'_> {
    /// A point with what it leaves of the readings; linear components act by their columns in a linear model close by.
    pub(super) fn stand(
        &self,
        point: Point,
        parameters: Vec<f64>,
        asked: &Asked,
        (design, rows): (&Design, &[Vec<f64>]),
    ) -> Stand {
        let predicted = self.setting.problem.predict_some(&point, asked.places);
        let left_of = |k: usize| {
            let own = dot(&design.z[k][..self.root.n], &parameters);
            self.left(&point, predicted[k], &rows[k], asked.places[k]) - own
        };
        let left: Vec<f64> = (0..asked.places.len()).map(left_of).collect();
        let readings = asked.known.iter().map(|&k| {
            let deviate = left[k] / asked.variances.noise[design.class[k]];
            deviate * deviate
        });
        let value =
            readings.sum::<f64>() + self.penalty(&point, asked) + dot(&parameters, &parameters);
        Stand {
            point,
            parameters,
            left,
            value,
        }
    }

    /// The response of the linear model at a point: nonlinear random effects below the root added back.
    pub(super) fn response(&self, point: &Point, predicted: f64, row: &[f64], i: usize) -> f64 {
        self.at_point(predicted, row, i) + self.below_root(point, row, i, false)
    }

    /// Sum of squares of the random effects of some readings' groups below the root, in standard deviations.
    fn penalty(&self, point: &Point, asked: &Asked) -> f64 {
        let tree = self.setting.problem.tree();
        let nodes = asked.places.iter().map(|&i| self.model.design.node[i]);
        let nodes: BTreeSet<usize> = nodes
            .flat_map(|n| tree.path(n))
            .filter(|n| *n > 0)
            .collect();
        let of = |node: usize| {
            let first = tree.first_column(node);
            let components = tree.components_of(node).enumerate();
            components.map(move |(k, c)| {
                let b = point.random[first + k];
                let u = b / asked.variances.components[c].max(f64::MIN_POSITIVE);
                if b == 0.0 { 0.0 } else { u * u }
            })
        };
        nodes.into_iter().flat_map(of).sum()
    }

    /// Sum over the random effects below the root of a reading that are linear in the forward model, or that are not.
    fn below_root(&self, point: &Point, row: &[f64], i: usize, linear: bool) -> f64 {
        let problem = self.setting.problem;
        let tree = problem.tree();
        let root = tree.width(0);
        let node = problem.node()[i];
        let numbers = tree.path_numbers(node);
        let of = tree.path_components(node);
        (root..numbers.len())
            .filter(|k| problem.components()[of[*k]].linear == linear)
            .map(|k| row[k] * point.random[numbers[k]])
            .sum()
    }

    /// Measured less expected at a point, the common columns at their mean.
    fn at_point(&self, predicted: f64, row: &[f64], i: usize) -> f64 {
        let problem = self.setting.problem;
        let root = problem.tree().width(0);
        let mean = self.shown.means[problem.class()[i]];
        problem.observed()[i] - predicted - dot(&row[..root], &self.root_beside_point) - mean
    }

    /// Measured less predicted with the random effects of a point.
    fn left(&self, point: &Point, predicted: f64, row: &[f64], i: usize) -> f64 {
        self.at_point(predicted, row, i) - self.below_root(point, row, i, true)
    }
}
