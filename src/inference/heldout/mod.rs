//! Readings that took no part: their joint predictive density, and the errors with what a few of them tell of their own group.
//!
//! Coefficients, amplitudes and common columns enter with their posterior mean and covariance given the readings that were fitted; random
//! effects below the root as their components have them. The restricted likelihood gives the variances.
//!
//! | file | idea |
//! |---|---|
//! | `predicted` | the prediction of a group of which nothing is known |
//! | `after` | errors once some readings of a group are known, or all |
//! | `mode` | the mode of what is not known of a group |
//! | `point` | what a point leaves of a group's readings, and what it costs |
//! | `additions` | of further readings, those that would tell most |

mod additions;
mod after;
mod mode;
mod point;
mod predicted;

pub use predicted::Predicted;

use crate::fit::{Fitted, Setting, Shown};
use crate::gram::{Design, Square};
use crate::system::{Factor, Variances, dot};
use crate::tree::{Block, Tree};
use std::sync::Arc;

/// What a fitted model says of a group that it has not seen.
pub struct Unseen<'a> {
    setting: &'a Setting<'a>,
    model: &'a Fitted,
    variances: Variances,
    /// Mean and noise of new readings: of a class that is held while models are fitted as its readings show them.
    shown: Shown,
    /// Means of the root's random effects.
    root_mean: Vec<f64>,
    /// The same less what the model's point has of those in which the forward model is nonlinear: predictions about the point contain that.
    root_beside_point: Vec<f64>,
    /// Square root of the covariance of the root's random effects and the fixed effects.
    root: Square,
}

/// Readings of a group, which of them are known (numbers in `places`), and how everything scatters that is not: nothing is known of what has no
/// scatter.
#[derive(Clone, Copy)]
struct Asked<'q> {
    places: &'q [usize],
    known: &'q [usize],
    variances: &'q Variances,
}

impl<'a> Unseen<'a> {
    /// The predictions of a model.
    pub fn new(setting: &'a Setting<'a>, model: &'a Fitted) -> Self {
        let variances = model.predictive(setting);
        let factor = Factor::new(&model.design.tree, &model.gram, &variances);
        let width = model.design.tree.width(0);
        let root_mean = factor.estimates().random[..width].to_vec();
        let nonlinear = setting.nonlinear_columns();
        let in_point = model.point.random.iter().zip(nonlinear);
        let in_point = in_point.map(|(b, nonlinear)| if nonlinear { *b } else { 0.0 });
        let root_beside_point = root_mean.iter().zip(in_point).map(|(m, b)| m - b);
        let root = square_root(&factor.covariance_at_root());
        Self {
            shown: model.shown(setting, &variances),
            setting,
            model,
            variances,
            root_beside_point: root_beside_point.collect(),
            root_mean,
            root,
        }
    }

    /// The variances of the predictions.
    pub fn variances(&self) -> &Variances {
        &self.variances
    }

    /// Means of the root's random effects, and a lower triangular square root of the covariance of these and the fixed effects, in this order: what
    /// the readings that were fitted say of any other.
    pub fn parameters_known(&self) -> (&[f64], &Square) {
        (&self.root_mean, &self.root)
    }

    /// Mean and standard deviation of what new readings show of themselves beside the model, by class of noise.
    pub fn shown_by_class(&self) -> (&[f64], &[f64]) {
        (&self.shown.means, &self.shown.noise)
    }

    /// The readings below a node: those of one quantity, where a problem has several.
    pub fn readings(&self, node: usize, keep: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut places = self.below(node);
        places.retain(|i| keep(*i));
        places
    }

    /// The readings below a node with the sizes that are expected of them while nothing is known of it.
    pub fn sizes(&self, node: usize, keep: impl Fn(usize) -> bool) -> Vec<(usize, f64)> {
        let observed = self.setting.problem.observed();
        let places = self.readings(node, keep).into_iter();
        places
            .map(|i| (i, (observed[i] - self.error(i)).abs()))
            .collect()
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

    /// The linear model of the readings at some places, their rows of random effects given: a tree of the path and what is below it.
    fn design<'r>(
        &self,
        places: &[usize],
        response: &[f64],
        row_of: impl Fn(usize) -> &'r [f64],
    ) -> Design {
        let whole = &self.model.design;
        let mut tree = Tree::new(vec![Block {
            component: self.variances.components.len(),
            columns: self.root.n,
        }]);
        let mut numbers = vec![usize::MAX; whole.tree.len()];
        numbers[0] = 0;
        let mut design = Design {
            tree: Tree::default(),
            node: Vec::new(),
            class: Vec::new(),
            classes: whole.classes,
            z: Arc::default(),
            x: Vec::new(),
            y: response.to_vec(),
        };
        let mut z = Vec::with_capacity(places.len());
        let root = whole.tree.width(0);
        for (k, &i) in places.iter().enumerate() {
            for node in whole.tree.path(whole.node[i]) {
                if numbers[node] == usize::MAX {
                    let parent = numbers[whole.tree.parent(node)];
                    numbers[node] = tree.add(parent, whole.tree.blocks(node).to_vec());
                }
            }
            design.node.push(numbers[whole.node[i]]);
            design.class.push(whole.class[i]);
            let mut row = self.parameters(i);
            row.extend_from_slice(&row_of(k)[root..]);
            z.push(row);
        }
        design.z = Arc::new(z);
        design.tree = tree;
        design
    }

    /// Variances with that of the parameters, which are standardised.
    fn with_parameters(&self) -> Variances {
        let mut variances = self.variances.clone();
        variances.components.push(1.0);
        variances
    }

    /// The same with the noise that new readings show.
    fn as_shown(&self) -> Variances {
        Variances {
            noise: self.shown.noise.clone(),
            ..self.with_parameters()
        }
    }

    /// Measured less expected of a reading, random effects below the root 0.
    fn error(&self, i: usize) -> f64 {
        let design = &self.model.design;
        let root = design.tree.width(0);
        design.y[i] - dot(&design.z[i][..root], &self.root_mean) - self.shown.means[design.class[i]]
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
