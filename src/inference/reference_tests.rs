//! The engine against other implementations: statsmodels for a linear model, a covariance written out as a matrix in NumPy for nonlinear ones.
//!
//! Readings and expected values are those of `tests/scripts/mixed_linear.py` and `mixed_nonlinear.py`.

use crate::fit::{Fitted, Setting};
use crate::gram::Design;
use crate::problem::{Coefficient, Component, Direction, Linearised, Point, Problem, Term};
use crate::system::{Factor, Likelihood, Variances};
use crate::tree::{Block, Tree};
use crate::variance::{Effort, Maximiser, Prior, Scale};
use std::f64::consts::PI;
use std::sync::Arc;

/// To the maximum as far as rounding allows: what is compared are maxima, not where an ascent stops.
const EXACT: Effort = Effort {
    evaluations: 500,
    tolerance: 1e-12,
};

fn rows(text: &str) -> Vec<Vec<f64>> {
    let lines = text.lines().filter(|l| !l.starts_with('#'));
    lines
        .map(|l| l.split(',').map(|v| v.parse().unwrap()).collect())
        .collect()
}

/// The values of the line that begins with a name.
fn expected(text: &'static str, name: &str) -> Vec<f64> {
    let of = |line: &'static str| line.strip_prefix(name)?.strip_prefix(',');
    let values = text.lines().find_map(of).unwrap().split(',');
    values.map(|v| v.parse().unwrap()).collect()
}

fn all_close(what: &str, a: &[f64], b: &[f64], tolerance: f64) {
    assert_eq!(a.len(), b.len(), "{what}");
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() <= tolerance, "{what}: {a} against {b}");
    }
}

fn ratios(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a / b).collect()
}

fn free(usual: f64) -> Scale {
    Scale {
        prior: Prior::Free,
        usual,
        groups: 1,
    }
}

fn standard_deviations(of: &Variances) -> Vec<f64> {
    [of.components.clone(), of.noise.clone()].concat()
}

fn block(component: usize, columns: usize) -> Block {
    Block { component, columns }
}

/// The nodes of the specimens and of the sessions, in the order of their numbers.
struct Groups {
    specimens: Vec<usize>,
    sessions: Vec<usize>,
}

/// The tree of sessions within specimens, in the order in which readings come.
fn groups(members: impl Iterator<Item = (usize, usize)>, specimen: &[Block]) -> (Tree, Groups) {
    let mut tree = Tree::new(Vec::new());
    let mut groups = Groups {
        specimens: Vec::new(),
        sessions: Vec::new(),
    };
    for (k, session) in members {
        if k == groups.specimens.len() {
            groups.specimens.push(tree.add(0, specimen.to_vec()));
        }
        if session == groups.sessions.len() {
            let node = tree.add(groups.specimens[k], vec![block(1, 1)]);
            groups.sessions.push(node);
        }
    }
    (tree, groups)
}

/// Random effects of a component in some groups.
fn effects(tree: &Tree, random: &[f64], nodes: &[usize], component: usize) -> Vec<f64> {
    let columns = nodes.iter().filter_map(|n| tree.columns_of(*n, component));
    columns
        .flat_map(|(first, width)| random[first..first + width].to_vec())
        .collect()
}

#[test]
fn a_linear_model_is_that_of_statsmodels() {
    let data = rows(include_str!("../../tests/data/mixed/linear.csv"));
    let answers = include_str!("../../tests/data/mixed/linear_expected.csv");
    let members = data.iter().map(|r| (r[0] as usize, r[1] as usize));
    let (tree, groups) = groups(members, &[block(0, 1)]);
    let design = Design {
        node: data
            .iter()
            .map(|r| groups.sessions[r[1] as usize])
            .collect(),
        class: vec![0; data.len()],
        classes: 1,
        z: Arc::new(data.iter().map(|r| vec![r[2], 1.0]).collect()),
        x: vec![vec![1.0; data.len()], data.iter().map(|r| r[2]).collect()],
        y: data.iter().map(|r| r[3]).collect(),
        tree,
    };
    let gram = design.gram();
    for (name, likelihood) in [("ml", Likelihood::Full), ("reml", Likelihood::Restricted)] {
        let of = |quantity: &str| expected(answers, &format!("{name},{quantity}"));
        let maximiser = Maximiser {
            tree: &design.tree,
            components: &[free(1.0); 2],
            noise: &[free(1.0)],
            likelihood,
        };
        let found = maximiser.maximise(&gram, &maximiser.start(1.0), EXACT);
        let factor = Factor::new(&design.tree, &gram, &found.variances);
        let estimates = factor.estimates();
        let sds = standard_deviations(&found.variances);
        let random = |nodes, c| effects(&design.tree, &estimates.random, nodes, c);
        // The file has ten digits; statsmodels itself is within 1e-7 of the maximum in the standard deviations.
        all_close(name, &[found.log_likelihood], &of("log_likelihood"), 1e-7);
        all_close(name, &ratios(&sds, &of("sd")), &[1.0; 3], 1e-6);
        all_close(name, &estimates.fixed, &of("fixed"), 1e-6);
        all_close(name, &random(&groups.specimens, 0), &of("gain"), 1e-6);
        all_close(name, &random(&groups.sessions, 1), &of("zero"), 1e-6);
        // What callers ask for ends where the gain is small.
        let usual = maximiser.maximise(&gram, &maximiser.start(1.0), Effort::FULL);
        all_close(name, &[usual.log_likelihood], &of("log_likelihood"), 1e-5);
    }
}

const WAVES: usize = 3;

/// y = A (1 + u) (1 - exp(-(x + d) / c)) + m(x) + e in a session with offset d of a specimen with gain u and, where there is one, misfit m;
/// readings of the second class are y = A (1 + u) + e of a specimen itself.
struct Saturation {
    tree: Tree,
    groups: Groups,
    node: Vec<usize>,
    class: Vec<usize>,
    noise: Vec<Scale>,
    x: Vec<f64>,
    observed: Vec<f64>,
    components: Vec<Component>,
    coefficients: [Coefficient; 2],
}

impl Saturation {
    fn new(text: &str, gain: Scale, misfit: Option<Scale>) -> Self {
        let data = rows(text);
        let own = match misfit {
            None => vec![block(0, 1)],
            Some(_) => vec![block(0, 1), block(2, WAVES)],
        };
        let in_sessions = data.iter().filter(|r| r[0] == 0.0);
        let members = in_sessions.map(|r| (r[1] as usize, r[2] as usize));
        let (tree, groups) = groups(members, &own);
        let node = |r: &Vec<f64>| {
            if r[0] == 0.0 {
                groups.sessions[r[2] as usize]
            } else {
                groups.specimens[r[1] as usize]
            }
        };
        let node = data.iter().map(node).collect();
        let class: Vec<usize> = data.iter().map(|r| r[0] as usize).collect();
        let classes = class.iter().max().unwrap() + 1;
        let component = |scale, misfit| Component {
            scale,
            linear: misfit,
            calibrates: !misfit,
            misfit,
        };
        let mut components = vec![component(gain, false), component(free(0.3), false)];
        components.extend(misfit.map(|scale| component(scale, true)));
        let coefficient = |start, high| Coefficient {
            start,
            bounds: (0.1, high),
            free: true,
        };
        Self {
            tree,
            groups,
            node,
            class,
            noise: vec![free(1.0); classes],
            x: data.iter().map(|r| r[3]).collect(),
            observed: data.iter().map(|r| r[4]).collect(),
            components,
            coefficients: [coefficient(30.0, 200.0), coefficient(4.0, 50.0)],
        }
    }

    /// Value of reading `i` without its misfit; derivatives by A and c, and by the random effects of its path.
    fn at(&self, point: &Point, i: usize) -> (f64, [f64; 2], Vec<f64>) {
        let [a, c] = [point.coefficients[0], point.coefficients[1]];
        let numbers = self.tree.path_numbers(self.node[i]);
        let gain = 1.0 + point.random[numbers[0]];
        let waves = numbers.len().min(WAVES + 1) - 1;
        if self.class[i] == 1 {
            let mut random = vec![a];
            random.resize(1 + waves, 0.0);
            return (a * gain, [gain, 0.0], random);
        }
        let x = self.x[i] + point.random[numbers[numbers.len() - 1]];
        let rest = libm::exp(-x / c);
        let mut random = vec![a * (1.0 - rest)];
        if self.components.len() > 2 {
            random.extend((1..=WAVES).map(|j| libm::sin(PI * j as f64 * self.x[i] / 10.0)));
        }
        random.push(a * gain * rest / c);
        let by_c = -a * gain * rest * x / (c * c);
        (a * gain * (1.0 - rest), [gain * (1.0 - rest), by_c], random)
    }
}

impl Problem for Saturation {
    crate::problem::from_fields!();
    fn terms(&self) -> &[Term] {
        &[]
    }
    fn predict(&self, point: &Point) -> Vec<f64> {
        (0..self.x.len()).map(|i| self.at(point, i).0).collect()
    }
    fn linearise(&self, point: &Point) -> Linearised {
        let all: Vec<_> = (0..self.x.len()).map(|i| self.at(point, i)).collect();
        Linearised {
            predicted: all.iter().map(|r| r.0).collect(),
            by_coefficients: (0..2)
                .map(|k| all.iter().map(|r| r.1[k]).collect())
                .collect(),
            by_terms: Vec::new(),
            random: all.into_iter().map(|r| r.2).collect(),
        }
    }
    fn directions(&self, _: &Point) -> Vec<Direction> {
        Vec::new()
    }
}

/// Iterates until nothing moves: a fit ends where its steps are a small part of the standard errors.
fn settled(setting: &Setting, from: &Fitted) -> Fitted {
    let scales = setting.scales();
    let maximiser = setting.maximiser(&scales, Likelihood::Full);
    let mut fitted = from.clone();
    for _ in 0..20 {
        let maximum = maximiser.maximise(&fitted.gram, &fitted.variances, EXACT);
        fitted = setting.fit(&fitted.point, &[maximum.variances]);
    }
    fitted
}

/// How far a fit may be from the values expected.
struct Tolerance {
    log_likelihood: f64,
    /// Of the coefficients and standard deviations, relative.
    relative: f64,
    /// Of the random effects, in standard deviations of their component.
    modes: f64,
}

fn agrees(problem: &Saturation, fitted: &Fitted, answers: &'static str, within: &Tolerance) {
    let of = |quantity: &str| expected(answers, quantity);
    let sds = standard_deviations(&fitted.variances);
    all_close(
        "log-likelihood",
        &[fitted.log_likelihood],
        &of("log_likelihood"),
        within.log_likelihood,
    );
    let coefficients = ratios(&fitted.point.coefficients, &of("coefficients"));
    all_close("coefficients", &coefficients, &[1.0; 2], within.relative);
    let ones = vec![1.0; sds.len()];
    all_close("sds", &ratios(&sds, &of("sd")), &ones, within.relative);
    let groups = &problem.groups;
    let named = [
        ("gain", &groups.specimens),
        ("offset", &groups.sessions),
        ("misfit", &groups.specimens),
    ];
    for (c, (name, nodes)) in named.into_iter().enumerate().take(problem.components.len()) {
        let found = effects(&problem.tree, &fitted.point.random, nodes, c);
        all_close(name, &found, &of(name), within.modes * sds[c]);
    }
}

fn restricted_agrees(found: &Variances, answers: &'static str, name: &str) {
    let sds = ratios(&standard_deviations(found), &expected(answers, name));
    // Their ascent ends where the log-likelihood gains less than 1e-6: about 1e-3 standard errors of a logarithm, which are some tenths.
    all_close(name, &sds, &vec![1.0; sds.len()], 3e-4);
}

/// The fit as it is called, and where nothing moves any more.
fn check(problem: &Saturation, answers: &'static str) -> Fitted {
    let setting = Setting::new(problem);
    let fitted = setting.fit_afresh(&problem.start());
    assert!(fitted.converged);
    // A fit ends where the next step would be less than 0.05 standard errors, twice, and the likelihood changes by less than 0.05; as convergence
    // is linear and fast, what is left is a tenth of that or less.
    let loose = Tolerance {
        log_likelihood: 5e-3,
        relative: 5e-3,
        modes: 5e-3,
    };
    agrees(problem, &fitted, answers, &loose);
    let fitted = settled(&setting, &fitted);
    // The scripts' own starts agree to 1e-7.
    let tight = Tolerance {
        log_likelihood: 1e-6,
        relative: 1e-6,
        modes: 1e-6,
    };
    agrees(problem, &fitted, answers, &tight);
    restricted_agrees(&fitted.restricted(&setting), answers, "restricted_sd");
    fitted
}

#[test]
fn a_nonlinear_model_is_that_of_the_dense_covariance() {
    let text = include_str!("../../tests/data/mixed/one_noise.csv");
    let answers = include_str!("../../tests/data/mixed/one_noise_expected.csv");
    check(&Saturation::new(text, free(0.05), None), answers);
}

#[test]
fn priors_and_classes_of_noise_are_those_of_the_dense_covariance() {
    let text = include_str!("../../tests/data/mixed/two_noises.csv");
    let answers = include_str!("../../tests/data/mixed/two_noises_expected.csv");
    let half_normal = |scale, usual| Scale {
        prior: Prior::HalfNormal(scale),
        usual,
        groups: 6,
    };
    let problem = Saturation::new(text, half_normal(0.05, 0.02), Some(half_normal(0.4, 0.4)));
    let fitted = check(&problem, answers);
    restricted_agrees(
        &fitted.predictive(&Setting::new(&problem)),
        answers,
        "away_sd",
    );
}
