//! Readings that took no part: their joint predictive density, and the errors with what a few of them tell of their own group.
//!
//! Coefficients, amplitudes and common columns enter with their posterior mean and covariance given the readings that were fitted; random
//! effects below the root as their components have them. The restricted likelihood gives the variances.

use crate::fit::{Fitted, SHORTEST, Setting, Shown};
use crate::gram::{Design, Square};
use crate::problem::Point;
use crate::system::{Estimates, Factor, Likelihood, Variances, add_times, dot};
use crate::tree::{Block, Tree};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Most steps by which the mode of a group's random effects is found.
const MOST_STEPS: usize = 12;
/// Standard deviations by which starts are off, besides those from nothing.
const AWAY: [f64; 2] = [-2.0, 2.0];
/// A step by which the penalised sum of squares falls by less is the last.
const SETTLED: f64 = 1e-3;

/// What a fitted model says of a group that it has not seen.
pub struct Unseen<'a> {
    setting: &'a Setting<'a>,
    model: &'a Fitted,
    variances: Variances,
    /// Mean and noise of new readings: of a class that is held while models are fitted as its readings show them.
    shown: Shown,
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
        let variances = model.predictive(setting);
        let factor = Factor::new(&model.design.tree, &model.gram, &variances);
        let width = model.design.tree.width(0);
        let root_mean = factor.estimates().random[..width].to_vec();
        let root = square_root(&factor.covariance_at_root());
        Self {
            shown: model.shown(setting, &variances),
            setting,
            model,
            variances,
            root_mean,
            root,
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

    /// The readings below a node: those of one quantity, where a problem has several.
    pub fn readings(&self, node: usize, keep: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut places = self.below(node);
        places.retain(|i| keep(*i));
        places
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

    /// The prediction of some of the readings below a node that took no part: those of one quantity, where a problem has several. Errors and their
    /// standard deviations are those of somebody who knows nothing of the group; the joint density is Gaussian about the mode of its random effects,
    /// as the fit has it of the groups that take part: at 0 the model of a short group whose length is far off says little of it.
    pub fn predict_where(&self, node: usize, keep: impl Fn(usize) -> bool) -> Predicted {
        let places = self.readings(node, keep);
        let errors: Vec<f64> = places.iter().map(|&i| self.error(i)).collect();
        let variances = self.as_shown();
        let all: Vec<usize> = (0..places.len()).collect();
        let asked = Asked {
            places: &places,
            known: &all,
            variances: &variances,
        };
        let design = self.mode(&asked).1;
        let gram = design.gram();
        let log_density =
            Factor::new(&design.tree, &gram, &variances).log_likelihood(Likelihood::Full);
        let design = self.design(&places, &errors, |k| &self.model.design.z[places[k]]);
        let count = variances.components.len();
        let mut sources = vec![0.0; count + 1];
        let mut sd = Vec::with_capacity(places.len());
        for (row, &i) in design.z.iter().zip(&places) {
            let node = design.node[sd.len()];
            let components = design.tree.path_components(node);
            let noise = variances.noise[self.model.design.class[i]];
            let mut total = noise * noise;
            sources[count] += noise * noise;
            for (z, &c) in row.iter().zip(components) {
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

    /// Variance of a reading in groups that were never seen: noise and all random effects below the root.
    pub fn variance_in_new_groups(&self, i: usize) -> f64 {
        let design = &self.model.design;
        let tree = &design.tree;
        let noise = self.shown.noise[design.class[i]];
        let components = tree.path_components(design.node[i]).iter();
        let below = components.zip(&design.z[i]).skip(tree.width(0));
        let below = below.map(|(c, z)| z * self.variances.components[*c]);
        noise * noise + below.map(|x| x * x).sum::<f64>()
    }

    /// Of further readings like those at `candidates`, each in groups that were never seen: the ones by which the variance of the predictions at
    /// `targets` that is due to coefficients, amplitudes and common columns falls most on average, one after the other, each with its
    /// fall. A reading q with variance v changes the covariance C of these parameters by -C q q'C/(v + q'C q).
    pub fn best_additions(
        &self,
        candidates: &[usize],
        targets: &[usize],
        count: usize,
    ) -> Vec<(usize, f64)> {
        let p = self.root.n;
        let mut sought = Square::zeros(p);
        for &i in targets {
            let q = self.parameters(i);
            for (j, x) in q.iter().enumerate() {
                let row = &mut sought.a[j * p..(j + 1) * p];
                add_times(row, x / targets.len() as f64, &q);
            }
        }
        let rows: Vec<(usize, Vec<f64>, f64)> = candidates
            .iter()
            .map(|&i| (i, self.parameters(i), self.variance_in_new_groups(i)))
            .collect();
        let mut covariance = Square::zeros(p);
        for j in 0..p {
            *covariance.at_mut(j, j) = 1.0;
        }
        let times = |matrix: &Square, x: &[f64]| -> Vec<f64> {
            let rows = matrix.a.chunks_exact(p);
            rows.map(|row| dot(row, x)).collect()
        };
        let mut best = Vec::with_capacity(count);
        for _ in 0..count.min(rows.len()) {
            let gains = rows.iter().map(|(i, q, v)| {
                let moved = times(&covariance, q);
                let total = v + dot(q, &moved);
                let fall = dot(&moved, &times(&sought, &moved)) / total;
                (*i, fall, moved, total)
            });
            let Some((i, fall, moved, total)) = gains.max_by(|a, b| a.1.total_cmp(&b.1)) else {
                break;
            };
            for (j, x) in moved.iter().enumerate() {
                add_times(&mut covariance.a[j * p..(j + 1) * p], -x / total, &moved);
            }
            best.push((i, fall));
        }
        best
    }

    /// The readings below a node with the sizes that are expected of them while nothing is known of it.
    pub fn sizes(&self, node: usize, keep: impl Fn(usize) -> bool) -> Vec<(usize, f64)> {
        let observed = self.setting.problem.observed();
        let places = self.readings(node, keep).into_iter();
        places
            .map(|i| (i, (observed[i] - self.error(i)).abs()))
            .collect()
    }

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

    /// The same variances with nothing but what calibrates.
    fn calibrating(&self, variances: &Variances) -> Variances {
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

    /// The mode of what is not known of a group, and the linear model about it. It is looked for from nothing and from what the group shows without
    /// misfit: far from its mode a length that is off by millimetres is not straight, and the misfit takes its place.
    fn mode(&self, asked: &Asked) -> (Stand, Design) {
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
    fn descend(&self, from: &Point, asked: &Asked) -> (Stand, Design) {
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

    /// A point with what it leaves of the readings; linear components act by their columns in a linear model close by.
    fn stand(
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
        problem.observed()[i] - predicted - dot(&row[..root], &self.root_mean) - mean
    }

    /// The response of the linear model at a point: nonlinear random effects below the root added back.
    fn response(&self, point: &Point, predicted: f64, row: &[f64], i: usize) -> f64 {
        self.at_point(predicted, row, i) + self.below_root(point, row, i, false)
    }

    /// Measured less predicted with the random effects of a point.
    fn left(&self, point: &Point, predicted: f64, row: &[f64], i: usize) -> f64 {
        self.at_point(predicted, row, i) - self.below_root(point, row, i, true)
    }
}

/// Readings of a group, which of them are known (numbers in `places`), and how everything scatters that is not: nothing is known of what has no
/// scatter.
#[derive(Clone, Copy)]
struct Asked<'q> {
    places: &'q [usize],
    known: &'q [usize],
    variances: &'q Variances,
}

/// A place on the way to the mode of a group's random effects.
#[derive(Clone)]
struct Stand {
    point: Point,
    /// Root and fixed effects, in units of independent standard normal numbers.
    parameters: Vec<f64>,
    /// Measured less what is expected there.
    left: Vec<f64>,
    /// The penalised sum of squares of the readings that are known.
    value: f64,
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
