//! The mode of what is not known of a group: Gauss-Newton steps with the linear model about each point.

use super::point::Stand;
use super::{Asked, Unseen};
use crate::fit::SHORTEST;
use crate::gram::Design;
use crate::problem::Point;
use crate::system::{Estimates, Factor};
use std::sync::Arc;

/// Most steps by which the mode of a group's random effects is found.
const MOST_STEPS: usize = 12;

/// A step by which the penalised sum of squares falls by less is the last.
const SETTLED: f64 = 1e-3;

impl Unseen<'_> {
    /// The mode of what is not known of a group, and the linear model about it. It is looked for from nothing and from what the group shows without
    /// misfit: far from its mode a length that is off by millimetres is not straight, and the misfit takes its place.
    pub(super) fn mode(&self, asked: &Asked) -> (Stand, Design) {
        let nothing = &self.model.point;
        let calibrating = self.calibrating(asked.variances);
        let alone = Asked {
            variances: &calibrating,
            ..*asked
        };
        let alone = self.descend(nothing, &alone).0;
        let first = self.descend(&alone.point, asked);
        let second = self.descend(nothing, asked);
        if second.0.value < first.0.value {
            second
        } else {
            first
        }
    }

    /// Gauss-Newton steps from the random effects of a point, to no worse place than where they begin: a step is judged with the columns of linear
    /// components as they are, and where these are other ones at its end by far, what it seemed to gain is lost.
    pub(super) fn descend(&self, from: &Point, asked: &Asked) -> (Stand, Design) {
        let (mut design, mut rows) = self.linear(from, asked);
        let nothing = vec![0.0; self.root.n];
        let mut here = self.stand(from.clone(), nothing, asked, (&design, &rows));
        let begun = (here.clone(), design.clone());
        for _ in 0..MOST_STEPS {
            let to = given(&design, asked);
            let next = self.step(&here, &to, asked, (&design, &rows));
            let fall = next.as_ref().map_or(0.0, |next| here.value - next.value);
            here = next.unwrap_or(here);
            if fall < SETTLED {
                break;
            }
            (design, rows) = self.linear(&here.point, asked);
            here = self.stand(here.point, here.parameters, asked, (&design, &rows));
        }
        if here.value > begun.0.value {
            return begun;
        }
        (here, design)
    }

    /// The linear model of the readings at a point, and their rows of random effects.
    fn linear(&self, point: &Point, asked: &Asked) -> (Design, Vec<Vec<f64>>) {
        let (predicted, rows) = self.setting.problem.linearise_some(point, asked.places);
        let readings = asked.places.iter().zip(&predicted).zip(&rows);
        let response: Vec<f64> = readings
            .map(|((&i, predicted), row)| self.response(point, *predicted, row, i))
            .collect();
        (self.design(asked.places, &response, |k| &rows[k]), rows)
    }

    /// The step to the estimates of the linear model, shortened until the penalised sum of squares falls; none if it does not.
    fn step(
        &self,
        here: &Stand,
        to: &Estimates,
        asked: &Asked,
        (design, rows): (&Design, &[Vec<f64>]),
    ) -> Option<Stand> {
        let tree = self.setting.problem.tree();
        let (own, root) = (self.root.n, tree.width(0));
        let mut length = 1.0;
        while length >= SHORTEST {
            let between = |old: f64, new: f64| old + length * (new - old);
            let mut point = here.point.clone();
            for (k, &i) in asked.places.iter().enumerate() {
                let from = design.tree.path_numbers(design.node[k]);
                let numbers = tree.path_numbers(self.model.design.node[i]);
                for (f, t) in from[own..].iter().zip(&numbers[root..]) {
                    point.random[*t] = between(here.point.random[*t], to.random[*f]);
                }
            }
            let parameters = here.parameters.iter().zip(&to.random);
            let parameters = parameters.map(|(old, new)| between(*old, *new)).collect();
            let next = self.stand(point, parameters, asked, (design, rows));
            if next.value < here.value {
                return Some(next);
            }
            length *= 0.5;
        }
        None
    }
}

/// The posterior of a group's random effects given what is known of its readings.
fn given(design: &Design, asked: &Asked) -> Estimates {
    // What is not known takes no part, but keeps its place in the tree.
    let known = asked.known.iter();
    let part = Design {
        tree: design.tree.clone(),
        node: known.clone().map(|&k| design.node[k]).collect(),
        class: known.clone().map(|&k| design.class[k]).collect(),
        classes: design.classes,
        z: Arc::new(known.clone().map(|&k| design.z[k].clone()).collect()),
        x: Vec::new(),
        y: known.map(|&k| design.y[k]).collect(),
    };
    let gram = part.gram();
    Factor::new(&part.tree, &gram, asked.variances).estimates()
}
