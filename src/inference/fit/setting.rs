//! A problem, the part of it that is fitted, and how its components scatter.

use super::Free;
use crate::problem::{Component, Problem};
use crate::system::{Likelihood, Variances};
use crate::variance::{Maximiser, Prior, Scale};

/// A problem, and the part of it that is fitted.
#[derive(Clone)]
pub struct Setting<'a> {
    /// The problem.
    pub problem: &'a dyn Problem,
    /// For each node whether its readings take part.
    pub active: Vec<bool>,
    /// Factor on the prior scales of the misfit.
    pub misfit_factor: f64,
    /// Factor on the usual sizes of components where searches start (the tests of convergence move it).
    pub start_factor: f64,
    /// Whether every component is held at its usual size.
    pub at_usual: bool,
    /// What is not fitted.
    pub pinned: Vec<Free>,
}

impl<'a> Setting<'a> {
    /// All readings of a problem.
    pub fn new(problem: &'a dyn Problem) -> Self {
        Self {
            problem,
            active: vec![true; problem.tree().len()],
            misfit_factor: 1.0,
            start_factor: 1.0,
            at_usual: false,
            pinned: Vec::new(),
        }
    }

    /// Without the readings of a node and of those below it.
    pub fn without(&self, node: usize) -> Self {
        let tree = self.problem.tree();
        let mut rest = self.clone();
        for n in 0..tree.len() {
            if tree.path(n).contains(&node) {
                rest.active[n] = false;
            }
        }
        rest
    }

    /// The same with every component at its usual size: only the noise is estimated.
    pub fn usual(&self) -> Self {
        Self {
            at_usual: true,
            ..self.clone()
        }
    }

    /// Scales of the components, with the prior of the misfit as set here.
    pub fn scales(&self) -> Vec<Scale> {
        let of = |c: &Component| {
            let mut scale = c.scale;
            if let (true, Prior::HalfNormal(s)) = (c.misfit, scale.prior) {
                scale.prior = if self.misfit_factor > 0.0 {
                    Prior::HalfNormal(s * self.misfit_factor)
                } else {
                    Prior::Fixed(0.0)
                };
            }
            if let (true, Prior::Free | Prior::HalfNormal(_) | Prior::Away(_)) =
                (self.at_usual, scale.prior)
            {
                scale.prior = Prior::Fixed(scale.usual);
            }
            scale
        };
        self.problem.components().iter().map(of).collect()
    }

    /// The maximiser over the variances.
    pub fn maximiser<'s>(&'s self, scales: &'s [Scale], likelihood: Likelihood) -> Maximiser<'s> {
        Maximiser {
            tree: self.problem.tree(),
            components: scales,
            noise: self.problem.noise(),
            likelihood,
        }
    }

    /// Variances where a search that knows nothing starts: usual sizes, and a fifth of them.
    pub fn fresh(&self) -> Vec<Variances> {
        let scales = self.scales();
        let maximiser = self.maximiser(&scales, Likelihood::Full);
        [1.0, 0.2]
            .map(|f| maximiser.start(f * self.start_factor))
            .to_vec()
    }

    /// Variances from which a fit with this setting starts: none so small that it cannot grow again.
    pub fn widened(&self, from: &Variances) -> Variances {
        let mut wide = from.clone();
        for (value, scale) in wide.components.iter_mut().zip(self.scales()) {
            *value = match scale.prior {
                Prior::Fixed(sd) | Prior::Held(sd) => sd,
                _ => value.max(0.5 * scale.usual),
            };
        }
        wide
    }
}
