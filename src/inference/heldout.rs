//! Readings that took no part: their joint predictive density, and the errors with what a few of them tell of their own group.
//!
//! Coefficients, amplitudes and common columns enter with their posterior mean and covariance given the readings that were fitted; random
//! effects below the root as their components have them. The restricted likelihood gives the variances.

use crate::fit::{Fitted, Setting};
use crate::gram::{Design, Square};
use crate::problem::Point;
use crate::system::{Factor, Likelihood, Posterior, Variances, dot};
use crate::tree::{Block, Tree};

/// What a fitted model says of a group that it has not seen.
pub struct Unseen<'a> {
    setting: &'a Setting<'a>,
    model: &'a Fitted,
    variances: Variances,
    /// Means of the root's random effects.
    root_mean: Vec<f64>,
    /// Square root of the covariance of the root's random effects and the fixed effects.
    root: Square,
}

/// The readings of one unseen group.
#[derive(Clone, Debug)]
pub struct Predicted {
    /// Their places among all readings.
    pub places: Vec<usize>,
    /// Measured less expected.
    pub errors: Vec<f64>,
    /// Standard deviation of each.
    pub sd: Vec<f64>,
    /// Joint log density of all of them.
    pub log_density: f64,
    /// Mean variance by source: one entry a component, then estimation (fixed effects and the root), then noise.
    pub sources: Vec<f64>,
}

impl<'a> Unseen<'a> {
    /// The predictions of a model.
    pub fn new(setting: &'a Setting<'a>, model: &'a Fitted) -> Self {
        let variances = model.restricted(setting);
        let posterior = Factor::new(&model.design.tree, &model.gram, &variances)
            .posterior(Likelihood::Restricted);
        let width = model.design.tree.width(0);
        Self {
            setting,
            model,
            variances,
            root_mean: posterior.random[..width].to_vec(),
            root: square_root(&posterior.path_covariances[0]),
        }
    }

    /// The variances of the predictions.
    pub fn variances(&self) -> &Variances {
        &self.variances
    }

    /// The readings below a node.
    fn below(&self, node: usize) -> Vec<usize> {
        let tree = &self.model.design.tree;
        let of = self.model.design.node.iter().enumerate();
        of.filter(|(_, n)| tree.path(**n).contains(&node))
            .map(|(i, _)| i)
            .collect()
    }

    /// Columns of root and fixed effects of a reading, in units of independent standard normal numbers.
    fn parameters(&self, i: usize) -> Vec<f64> {
        let design = &self.model.design;
        let root = design.tree.width(0);
        let row: Vec<f64> = design.z[i][..root]
            .iter()
            .copied()
            .chain(design.x.iter().map(|x| x[i]))
            .collect();
        (0..row.len())
            .map(|j| (j..row.len()).map(|k| row[k] * self.root.at(k, j)).sum())
            .collect()
    }

    /// The linear model of the readings at some places: a tree of the path and what is below it.
    fn design(&self, places: &[usize], response: &[f64]) -> Design {
        let whole = &self.model.design;
        let parameters = self.root.n;
        let own = self.variances.components.len();
        let mut tree = Tree::new(vec![Block {
            component: own,
            columns: parameters,
        }]);
        let mut numbers = vec![usize::MAX; whole.tree.len()];
        numbers[0] = 0;
        let mut design = Design {
            tree: Tree::default(),
            node: Vec::new(),
            class: Vec::new(),
            classes: whole.classes,
            z: Vec::new(),
            x: Vec::new(),
            y: response.to_vec(),
        };
        let root = whole.tree.width(0);
        for &i in places {
            for node in whole.tree.path(whole.node[i]) {
                if numbers[node] == usize::MAX {
                    let parent = numbers[whole.tree.parent(node)];
                    numbers[node] = tree.add(parent, whole.tree.blocks(node).to_vec());
                }
            }
            design.node.push(numbers[whole.node[i]]);
            design.class.push(whole.class[i]);
            let mut row = self.parameters(i);
            row.extend_from_slice(&whole.z[i][root..]);
            design.z.push(row);
        }
        design.tree = tree;
        design
    }

    /// Variances with that of the parameters, which are standardised.
    fn with_parameters(&self) -> Variances {
        let mut variances = self.variances.clone();
        variances.components.push(1.0);
        variances
    }

    /// Measured less expected of a reading, random effects below the root 0.
    fn error(&self, i: usize) -> f64 {
        let design = &self.model.design;
        let root = design.tree.width(0);
        design.y[i] - dot(&design.z[i][..root], &self.root_mean)
    }

    /// The prediction of all readings below a node that took no part.
    pub fn predict(&self, node: usize) -> Predicted {
        let places = self.below(node);
        let errors: Vec<f64> = places.iter().map(|&i| self.error(i)).collect();
        let design = self.design(&places, &errors);
        let variances = self.with_parameters();
        let gram = design.gram();
        let log_density =
            Factor::new(&design.tree, &gram, &variances).log_likelihood(Likelihood::Full);
        let count = variances.components.len();
        let mut sources = vec![0.0; count + 1];
        let mut sd = Vec::with_capacity(places.len());
        for (row, &i) in design.z.iter().zip(&places) {
            let node = design.node[sd.len()];
            let path = design.tree.path(node);
            let components = path.iter().flat_map(|n| design.tree.components_of(*n));
            let noise = variances.noise[self.model.design.class[i]];
            let mut total = noise * noise;
            sources[count] += noise * noise;
            for (z, c) in row.iter().zip(components) {
                let variance = z * z * variances.components[c] * variances.components[c];
                sources[c] += variance;
                total += variance;
            }
            sd.push(total.sqrt());
        }
        for s in &mut sources {
            *s /= places.len().max(1) as f64;
        }
        Predicted {
            places,
            errors,
            sd,
            log_density,
            sources,
        }
    }

    /// Errors on the readings below a node once some of them are known, linear in the random effects at the expected ones: the mean of all
    /// readings given those at `known`.
    pub fn errors_after(&self, node: usize, known: &[usize]) -> Vec<(usize, f64)> {
        let places = self.below(node);
        let errors: Vec<f64> = places.iter().map(|&i| self.error(i)).collect();
        let design = self.design(&places, &errors);
        let posterior = self.given(&places, &errors, known);
        let of = |tree: &Tree, node: usize| tree.path_numbers(node);
        places
            .iter()
            .zip(&errors)
            .enumerate()
            .map(|(k, (i, e))| {
                let numbers = of(&design.tree, design.node[k]);
                let mean: f64 = numbers
                    .iter()
                    .zip(&design.z[k])
                    .map(|(c, z)| z * posterior.random[*c])
                    .sum();
                (*i, e - mean)
            })
            .collect()
    }

    /// The posterior of the group's random effects given some of its readings.
    fn given(&self, places: &[usize], errors: &[f64], known: &[usize]) -> Posterior {
        let mut design = self.design(places, errors);
        let variances = self.with_parameters();
        // What is not known takes no part, but keeps its place in the tree.
        let is_known: Vec<bool> = places.iter().map(|i| known.contains(i)).collect();
        let kept = |k: &usize| is_known[*k];
        let list: Vec<usize> = (0..places.len()).filter(kept).collect();
        design.node = list.iter().map(|&k| design.node[k]).collect();
        design.class = list.iter().map(|&k| design.class[k]).collect();
        design.z = list.iter().map(|&k| design.z[k].clone()).collect();
        design.y = list.iter().map(|&k| design.y[k]).collect();
        let gram = design.gram();
        Factor::new(&design.tree, &gram, &variances).posterior(Likelihood::Full)
    }

    /// Errors on the readings below a node with the random effects that calibrate as all of its readings show them, coefficients and misfit
    /// as predicted: in sample in these.
    pub fn errors_calibrated(&self, node: usize) -> Vec<(usize, f64)> {
        let places = self.below(node);
        let problem = self.setting.problem;
        let tree = problem.tree();
        let mut point: Point = self.model.point.clone();
        let root = tree.width(0);
        let mut errors = vec![0.0; places.len()];
        // Two steps: the forward model is nearly linear in gain and lengths.
        for _ in 0..2 {
            let linear = problem.linearise(&point);
            let response: Vec<f64> = places
                .iter()
                .map(|&i| self.response(&point, &linear.predicted, &linear.random[i], i))
                .collect();
            let posterior = self.given(&places, &response, &places);
            let small = self.design(&places, &response);
            let components = problem.components();
            for (k, &i) in places.iter().enumerate() {
                let from = small.tree.path_numbers(small.node[k]);
                let to = tree.path_numbers(self.model.design.node[i]);
                let path = tree.path(self.model.design.node[i]);
                let of: Vec<usize> = path.iter().flat_map(|n| tree.components_of(*n)).collect();
                let own = from[self.root.n..].iter().zip(&to[root..]).zip(&of[root..]);
                for ((f, t), c) in own {
                    if components[*c].calibrates {
                        point.random[*t] = posterior.random[*f];
                    }
                }
            }
            let predicted = problem.predict(&point);
            for (k, &i) in places.iter().enumerate() {
                errors[k] = self.left(&point, &predicted, &linear.random[i], i);
            }
        }
        places.into_iter().zip(errors).collect()
    }

    /// Measured less predicted at a point, nonlinear random effects below the root added back.
    fn response(&self, point: &Point, predicted: &[f64], row: &[f64], i: usize) -> f64 {
        let problem = self.setting.problem;
        let tree = problem.tree();
        let root = tree.width(0);
        let node = problem.node()[i];
        let numbers = tree.path_numbers(node);
        let path = tree.path(node);
        let of: Vec<usize> = path.iter().flat_map(|n| tree.components_of(*n)).collect();
        let own: f64 = (root..numbers.len())
            .filter(|k| !problem.components()[of[*k]].linear)
            .map(|k| row[k] * point.random[numbers[k]])
            .sum();
        problem.observed()[i] - predicted[i] - dot(&row[..root], &self.root_mean) + own
    }

    /// Measured less predicted with the random effects of a point.
    fn left(&self, point: &Point, predicted: &[f64], row: &[f64], i: usize) -> f64 {
        let problem = self.setting.problem;
        let tree = problem.tree();
        let root = tree.width(0);
        let node = problem.node()[i];
        let numbers = tree.path_numbers(node);
        let path = tree.path(node);
        let of: Vec<usize> = path.iter().flat_map(|n| tree.components_of(*n)).collect();
        let linear: f64 = (root..numbers.len())
            .filter(|k| problem.components()[of[*k]].linear)
            .map(|k| row[k] * point.random[numbers[k]])
            .sum();
        problem.observed()[i] - predicted[i] - dot(&row[..root], &self.root_mean) - linear
    }
}

/// A lower triangular L with L L' = A for a matrix that is not negative.
fn square_root(a: &Square) -> Square {
    let n = a.n;
    let mut lower = Square::zeros(n);
    for j in 0..n {
        let mut pivot = a.at(j, j);
        for k in 0..j {
            pivot -= lower.at(j, k) * lower.at(j, k);
        }
        if pivot <= 1e-14 * a.at(j, j).max(f64::MIN_POSITIVE) {
            continue;
        }
        let root = pivot.sqrt();
        *lower.at_mut(j, j) = root;
        for i in j + 1..n {
            let mut x = a.at(i, j);
            for k in 0..j {
                x -= lower.at(i, k) * lower.at(j, k);
            }
            *lower.at_mut(i, j) = x / root;
        }
    }
    lower
}
