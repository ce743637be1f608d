//! The marginal likelihood of a linear mixed model, and what follows from its factor.
//!
//! With b = T u, u ~ N(0, 1), T the standard deviations of the components, the joint precision of u and the readings is
//! M = I + T Z' S^-1 Z T, S the variances of the noise. M has the shape of the tree, so that its Cholesky factor is found node by node,
//! children first, each node leaving a Schur complement to its parent (multifrontal elimination; Duff and Reid, ACM TOMS 9 (1983) 302).
//! The fixed effects and the response come last: what is left of them at the root is X'V^-1 X, X'V^-1 y and y'V^-1 y, and
//! log|V| = log|M| + log|S| (Sylvester). Cost goes with the number of groups, not with the number of readings.
//!
//! | file | idea |
//! |---|---|
//! | `elimination` | one node of the factor: its rows, their elimination, what is left at the root |
//! | `estimates` | means and covariances of fixed and random effects |
//! | `gradient` | derivatives of the log-likelihood by the standard deviations |
//! | `panel` | what is left of further columns after whitening and projecting |
//! | `triangular` | solving with a lower triangular factor |
//! | `kernels` | sums of products, each in a fixed order |

mod elimination;
mod estimates;
mod gradient;
mod kernels;
mod panel;
mod triangular;

pub use estimates::Estimates;
pub(crate) use kernels::{add_times, dot};
pub use panel::{Panel, PanelPart, Projected};
pub(crate) use triangular::{back_substitute, forward};

use crate::gram::{Gram, Part, Square};
use crate::tree::Tree;
use elimination::{add_without_own, eliminate, finish, left_of_fixed, own_rows};
use kernels::add_products;
use std::f64::consts::TAU;

/// Standard deviations of components and classes of noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Variances {
    /// One a component.
    pub components: Vec<f64>,
    /// One a class of noise.
    pub noise: Vec<f64>,
}

/// Which likelihood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Likelihood {
    /// Of the response: to compare models with other fixed effects.
    Full,
    /// Of what is left of the response after the fixed effects: for variances and predictions (Patterson and Thompson, Biometrika 58
    /// (1971) 545).
    Restricted,
}

/// The factor of one node: L of its own columns, and L^-1 times the columns below which they stand.
struct Eliminated {
    /// Whether the node's own columns are as good as nothing: then L is 1, and the rest 0; both are empty.
    idle: bool,
    lower: Square,
    /// Own rows by the rest: columns above, fixed effects, response.
    rest: Vec<f64>,
}

/// A node is idle where its readings add less than this to the prior precision of every random effect of its own: standard deviations have
/// faded to where a likelihood no longer tells them from 0. A node adds less than as much to the log-likelihood for each of its columns.
const IDLE: f64 = 1e-6;

/// The factor of a system at some variances.
pub struct Factor<'a> {
    tree: &'a Tree,
    gram: &'a Gram,
    variances: &'a Variances,
    nodes: Vec<Eliminated>,
    /// Cholesky factor of X'V^-1 X; a zero pivot where a column is spanned by others.
    fixed_lower: Square,
    /// L^-1 X'V^-1 y.
    fixed_response: Vec<f64>,
    log_det: f64,
    /// y'P y.
    quadratic: f64,
}

/// Scales of the columns of a part: standard deviations of the path, 1 for the rest; all divided by the noise.
fn scales(tree: &Tree, variances: &Variances, part: &Part, fixed: usize) -> Vec<f64> {
    let noise = variances.noise[part.class];
    let of = tree.path_components(part.node).iter();
    let random = of.map(|c| variances.components[*c] / noise);
    random
        .chain(std::iter::repeat_n(1.0 / noise, fixed + 1))
        .collect()
}

impl Eliminated {
    fn idle() -> Self {
        Self {
            idle: true,
            lower: Square::zeros(0),
            rest: Vec::new(),
        }
    }
}

/// Whether all of a node's own columns are as good as nothing.
fn is_idle(tree: &Tree, gram: &Gram, variances: &Variances, node: usize) -> bool {
    let above = tree.above(node);
    tree.components_of(node).enumerate().all(|(k, c)| {
        let classes = variances.noise.iter().enumerate();
        let added: f64 = classes
            .filter_map(|(class, noise)| Some((gram.total(node, class)?.0, noise)))
            .map(|(sums, noise)| sums.at(above + k, above + k) / (noise * noise))
            .sum();
        variances.components[c] * variances.components[c] * added < IDLE
    })
}

impl<'a> Factor<'a> {
    /// Factors the system.
    pub fn new(tree: &'a Tree, gram: &'a Gram, variances: &'a Variances) -> Self {
        let mut log_det = 0.0;
        let mut nodes: Vec<Eliminated> = Vec::with_capacity(tree.len());
        // What the groups below take off a node's sums, upper triangles.
        let mut taken: Vec<Option<Square>> = vec![None; tree.len()];
        for node in (0..tree.len()).rev() {
            let off = taken[node].take();
            let (above, width) = (tree.above(node), tree.width(node));
            let eliminated = if is_idle(tree, gram, variances, node) {
                Eliminated::idle()
            } else {
                let own = own_rows(tree, gram, variances, node, off.as_ref());
                eliminate(&own, above, width)
            };
            if !eliminated.idle {
                log_det += (0..width)
                    .map(|k| 2.0 * libm::log(eliminated.lower.at(k, k)))
                    .sum::<f64>();
            }
            let here = if node == 0 { 0 } else { tree.parent(node) };
            if node == 0 || !eliminated.idle || off.is_some() {
                let rest = above + gram.fixed + 1;
                let mut parent = taken[here].take().unwrap_or_else(|| Square::zeros(rest));
                add_without_own(&mut parent, off.as_ref(), above, width);
                if !eliminated.idle {
                    add_products(&mut parent, &eliminated.rest, width);
                }
                taken[here] = Some(parent);
            }
            nodes.push(eliminated);
        }
        nodes.reverse();
        let left = left_of_fixed(tree, gram, variances, taken[0].as_ref());
        let (fixed_lower, fixed_response, quadratic) = finish(&left, gram.fixed);
        Self {
            tree,
            gram,
            variances,
            nodes,
            fixed_lower,
            fixed_response,
            log_det,
            quadratic,
        }
    }

    /// The sums of products that it was made of.
    pub fn gram(&self) -> &Gram {
        self.gram
    }

    /// How many nodes are passed over.
    #[cfg(test)]
    pub(crate) fn idle_nodes(&self) -> usize {
        self.nodes.iter().filter(|n| n.idle).count()
    }

    /// y'P y: the squared length of the whitened response after the fixed effects.
    pub fn quadratic(&self) -> f64 {
        self.quadratic
    }

    /// The logarithm of the likelihood.
    pub fn log_likelihood(&self, likelihood: Likelihood) -> f64 {
        let counts = self.gram.counts.iter().zip(&self.variances.noise);
        let noise: f64 = counts
            .map(|(n, s)| *n as f64 * libm::log(TAU * s * s))
            .sum();
        let full = -0.5 * (noise + self.log_det + self.quadratic);
        match likelihood {
            Likelihood::Full => full,
            Likelihood::Restricted => {
                let pivots = (0..self.gram.fixed).map(|k| self.fixed_lower.at(k, k));
                let known: Vec<f64> = pivots.filter(|l| *l > 0.0).collect();
                let log_det: f64 = known.iter().map(|l| 2.0 * libm::log(*l)).sum();
                full - 0.5 * (log_det - known.len() as f64 * libm::log(TAU))
            }
        }
    }
}
