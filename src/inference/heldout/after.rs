//! Errors on the readings of a group once some of them are known, or all.

use super::point::Stand;
use super::{Asked, Unseen};
use crate::problem::Point;
use crate::system::Variances;
use std::collections::BTreeSet;

/// Standard deviations by which starts are off, besides those from nothing.
const AWAY: [f64; 2] = [-2.0, 2.0];

impl Unseen<'_> {
    /// Errors on the readings below a node once some of them are known: measured less the mode of all readings given those at `known`.
    pub fn errors_after(&self, node: usize, known: &[usize]) -> Vec<(usize, f64)> {
        let places = self.below(node);
        let list: Vec<usize> = (0..places.len())
            .filter(|k| known.contains(&places[*k]))
            .collect();
        let asked = Asked {
            places: &places,
            known: &list,
            variances: &self.with_parameters(),
        };
        let left = self.mode(&asked).0.left;
        places.into_iter().zip(left).collect()
    }

    /// Errors on the readings below a node with the random effects that calibrate as all of its readings show them, were there neither misfit nor
    /// other coefficients to take their place: in sample in these.
    pub fn errors_calibrated(&self, node: usize) -> Vec<(usize, f64)> {
        let places = self.below(node);
        let all: Vec<usize> = (0..places.len()).collect();
        // What is held while models are fitted is no reason to overlook a reading here.
        let variances = self.as_shown();
        let asked = Asked {
            places: &places,
            known: &all,
            variances: &variances,
        };
        let calibrating = self.calibrating(&variances);
        let alone = Asked {
            variances: &calibrating,
            ..asked
        };
        // From where the misfit led as well.
        let mut led = self.mode(&asked).0.point;
        let tree = self.setting.problem.tree();
        let components = (0..tree.len()).flat_map(|n| tree.components_of(n));
        for (b, c) in led.random.iter_mut().zip(components) {
            if calibrating.components[c] == 0.0 {
                *b = 0.0;
            }
        }
        let away = self.away_from_nothing(&alone);
        let left = self.lowest(&[&away[..], &[led]].concat(), &alone).left;
        places.into_iter().zip(left).collect()
    }

    /// The same variances with nothing but what calibrates.
    pub(super) fn calibrating(&self, variances: &Variances) -> Variances {
        let mut alone = variances.clone();
        let components = self.setting.problem.components();
        let calibrates = components.iter().map(|c| c.calibrates).chain([false]);
        for (sd, calibrates) in alone.components.iter_mut().zip(calibrates) {
            if !calibrates {
                *sd = 0.0;
            }
        }
        alone
    }

    /// Nothing, and starts in which all values of one component that is not linear are off by so many of its standard deviations, the same way: from
    /// nothing alone, lengths that are far off may end anywhere.
    fn away_from_nothing(&self, asked: &Asked) -> Vec<Point> {
        let problem = self.setting.problem;
        let (tree, components) = (problem.tree(), problem.components());
        let paths = asked.places.iter().map(|i| problem.node()[*i]);
        let nodes: BTreeSet<usize> = paths
            .flat_map(|n| tree.path(n))
            .filter(|n| *n > 0)
            .collect();
        let sd = |c: usize| asked.variances.components[c];
        let open = (0..components.len()).filter(|c| !components[*c].linear && sd(*c) > 0.0);
        let away = open.flat_map(|c| AWAY.map(|sds| (c, sds * sd(c))));
        let start = |(component, value): (usize, f64)| {
            let mut point = self.model.point.clone();
            for node in &nodes {
                if let Some((first, columns)) = tree.columns_of(*node, component) {
                    point.random[first..first + columns].fill(value);
                }
            }
            point
        };
        std::iter::once(self.model.point.clone())
            .chain(away.map(start))
            .collect()
    }

    /// Where the descents from some starts, of which there is one at least, end lowest.
    fn lowest(&self, starts: &[Point], asked: &Asked) -> Stand {
        let mut best = self.descend(&starts[0], asked).0;
        for start in &starts[1..] {
            let end = self.descend(start, asked).0;
            if end.value < best.value {
                best = end;
            }
        }
        best
    }
}
