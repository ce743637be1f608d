//! A joint as a problem for the engine: groups, forward model with derivatives, nuisance components.
//!
//! Torque, length and arm of a row follow from one balance ([`super::operator`]). M_i = M(theta_i, P_i; phi, d_t, g_k) + z_t + misfit + noise, where d_t is
//! the mounting of the test (an offset of the length, mm), z_t the zero of its torque and g_k the gain of the actuator. The law of force is the
//! published one: a knee has too few pressures and lengths to determine it, so there are no free coefficients. The misfit is proportional to a
//! frozen torque with a floor, and absent where the actuator is slack: one along the angle that all tests share, with a constant (the law may be
//! wrong by a factor on all actuators), and one of each test.
//!
//! Lengths and arms taken by hand are further readings of the same geometry, in mm, each with its noise and with a bias of its test: where
//! attachments are elsewhere than drawn, torque, length and arm say so together.

use super::data::Data;
use super::library::What;
use super::operator::Shown;
use super::settings;
use super::terms::{SIZES, place};
use pipeline_diagnose::problem::{LARGE_CHANGES, SAME_DIRECTION, cosine};
use pipeline_diagnose::settings as shared;
use pipeline_diagnose::slack::Side;
use pipeline_diagnose::smooth::cosines;
use pipeline_inference::fit::Setting;
use pipeline_inference::problem::Term as EngineTerm;
use pipeline_inference::problem::{Coefficient, Component, Direction, Linearised, Point, Problem};
use pipeline_inference::tree::{Block, Tree};
use pipeline_inference::variance::{Prior, Scale};
use pipeline_numerics::real::{Dual, Real};
use rayon::prelude::*;

/// The components, by their numbers.
pub mod component {
    /// Misfit that all tests share, share of the torque.
    pub const COMMON_MISFIT: usize = 0;
    /// Gain of an actuator, relative.
    pub const GAIN: usize = 1;
    /// Mounting of a test, mm.
    pub const MOUNTING: usize = 2;
    /// Zero of the torque of a test, N.m.
    pub const ZERO: usize = 3;
    /// Misfit of a test along the angle, share of the torque.
    pub const TEST_MISFIT: usize = 4;
    /// Bias of a test's hand-measured lengths, mm.
    pub const LENGTH_BIAS: usize = 5;
    /// Bias of a test's hand-measured arms, mm.
    pub const ARM_BIAS: usize = 6;
}

/// Classes of noise, by their numbers.
pub mod class {
    /// Torques, N.m.
    pub const TORQUE: usize = 0;
    /// Torques in the corner to slackness.
    pub const CORNER: usize = 1;
    /// Lengths by hand, mm.
    pub const LENGTH: usize = 2;
    /// Arms by hand, mm.
    pub const ARM: usize = 3;
}

/// Most terms in one model.
pub const MOST_TERMS: usize = 4;
/// Slots of the derivatives: mounting, gain, two for each term.
const SLOTS: usize = 2 + 2 * MOST_TERMS;
const MOUNTING: usize = 0;
const GAIN: usize = 1;
const TERMS: usize = 2;
/// Cosines of the misfits along the angle.
const COSINES: usize = 8;

/// What is read in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Torque,
    Length,
    Arm,
}

/// A joint.
pub struct TorqueProblem<'a> {
    /// The rows.
    pub data: &'a Data<'a>,
    /// The terms of the library.
    pub library: &'a [What],
    tree: Tree,
    /// Node of each actuator that has rows.
    pub actuators: Vec<Option<usize>>,
    /// Node of each test that has rows.
    pub tests: Vec<Option<usize>>,
    /// Row of each reading of the engine.
    pub row: Vec<usize>,
    quantity: Vec<Quantity>,
    node: Vec<usize>,
    class: Vec<usize>,
    observed: Vec<f64>,
    components: Vec<Component>,
    noise: Vec<Scale>,
    terms: Vec<EngineTerm>,
    /// Cosines of the misfits, row by row.
    basis: Vec<Vec<f64>>,
    /// The torque by which the misfit is scaled, N.m, row by row: that of a fit without misfit, and no more than the largest that was measured. It is
    /// frozen, so that all models have one covariance for it; it is not the measured one, because a misfit in proportion to that could take
    /// the place of the law.
    reference: Vec<f64>,
}

/// What a row shows, in the units of the engine: N.m, mm, mm.
type Three<R> = [R; 3];

impl<'a> TorqueProblem<'a> {
    /// The problem of some rows.
    pub fn new(data: &'a Data<'a>, library: &'a [What]) -> Self {
        let block = |component, columns| Block { component, columns };
        let mut tree = Tree::new(vec![block(component::COMMON_MISFIT, COSINES)]);
        let mut actuators = vec![None; data.actuators.len()];
        let mut tests = vec![None; data.tests.len()];
        let (mut row, mut quantity, mut node) = (Vec::new(), Vec::new(), Vec::new());
        let (mut class, mut observed) = (Vec::new(), Vec::new());
        for (k, r) in data.readings.iter().enumerate() {
            let above = *actuators[r.actuator]
                .get_or_insert_with(|| tree.add(0, vec![block(component::GAIN, 1)]));
            let own = *tests[r.test].get_or_insert_with(|| {
                let blocks = vec![
                    block(component::MOUNTING, 1),
                    block(component::ZERO, 1),
                    block(component::TEST_MISFIT, COSINES),
                    block(component::LENGTH_BIAS, 1),
                    block(component::ARM_BIAS, 1),
                ];
                tree.add(above, blocks)
            });
            let of_torque = match r.side {
                Side::Corner => class::CORNER,
                Side::Pulls | Side::Slack | Side::AsPublished => class::TORQUE,
            };
            let list = [
                (Quantity::Torque, of_torque, Some(r.torque_nm)),
                (
                    Quantity::Length,
                    class::LENGTH,
                    r.by_hand.length_m.map(|l| 1e3 * l),
                ),
                (Quantity::Arm, class::ARM, r.by_hand.arm_m.map(|a| 1e3 * a)),
            ];
            for (what, of, value) in list {
                let Some(value) = value.filter(|v| v.is_finite()) else {
                    continue;
                };
                row.push(k);
                quantity.push(what);
                node.push(own);
                class.push(of);
                observed.push(value);
            }
        }
        let counts = |c: usize| class.iter().filter(|k| **k == c).count();
        let noise = noise(data, counts(class::LENGTH), counts(class::ARM));
        let present = |nodes: &[Option<usize>]| nodes.iter().flatten().count();
        Self {
            components: components(data, present(&actuators), present(&tests)),
            noise,
            basis: bases(data),
            reference: vec![0.0; data.readings.len()],
            terms: library.iter().map(|t| t.for_engine()).collect(),
            data,
            library,
            tree,
            actuators,
            tests,
            row,
            quantity,
            node,
            class,
            observed,
        }
    }

    /// The problem of which the fit is plain least squares on the torques, as in the papers: no random effects, no misfit, nothing by hand, one
    /// noise; `data` are as published ([`Data::as_published`]).
    pub fn least_squares(data: &'a Data<'a>, library: &'a [What]) -> Self {
        let mut plain = Self::new(data, library);
        for component in &mut plain.components {
            component.scale.prior = Prior::Fixed(0.0);
        }
        let torques: Vec<usize> = (0..plain.row.len())
            .filter(|i| plain.is_torque(*i))
            .collect();
        let take = |of: &[usize]| -> Vec<usize> { torques.iter().map(|i| of[*i]).collect() };
        plain.row = take(&plain.row);
        plain.node = take(&plain.node);
        plain.class = vec![class::TORQUE; torques.len()];
        plain.quantity = vec![Quantity::Torque; torques.len()];
        plain.observed = torques.iter().map(|i| plain.observed[*i]).collect();
        plain
    }

    /// The same with the misfit scaled by the predictions of a fit without it.
    pub fn with_reference(mut self) -> Self {
        let setting = Setting {
            misfit_factor: 0.0,
            ..Setting::new(&self).usual()
        };
        let fit = setting.fit(&self.start(), &setting.fresh()[..1]);
        let predicted = self.predict(&fit.point);
        for (i, p) in predicted.iter().enumerate() {
            if self.quantity[i] == Quantity::Torque {
                self.reference[self.row[i]] = p.abs().min(self.data.largest_nm);
            }
        }
        self
    }

    /// Whether a reading is a torque.
    pub fn is_torque(&self, i: usize) -> bool {
        self.quantity[i] == Quantity::Torque
    }

    /// All sizes of a model's effects, and the dependences on columns that it has.
    pub fn sizes(&self, point: &Point) -> [f64; SIZES] {
        let mut sizes = [0.0; SIZES];
        for (t, values) in &point.terms {
            self.library[*t].add(pair(values), &mut sizes);
        }
        sizes
    }

    /// What law, effects and columns alone predict for the torque of reading `i`, N.m; an actuator that would push is slack.
    pub fn without_scatter(&self, point: &Point, i: usize) -> f64 {
        let r = self.row[i];
        let shown = self.data.readings[r].shown(&self.sizes(point));
        let torque = shown.map_or(f64::NAN, |s| s.torque);
        let apply = |torque: f64, (t, values): &(usize, Vec<f64>)| {
            self.library[*t].apply(torque, pair(values), self.data, r)
        };
        point.terms.iter().fold(torque, apply)
    }

    /// What row `r` shows, misfit, zero and biases left out.
    fn shows<R: Real>(
        &self,
        r: usize,
        [mounting, gain]: [R; 2],
        terms: &[(usize, [R; 2])],
    ) -> Three<R> {
        let mut sizes = [R::constant(0.0); SIZES];
        for (t, values) in terms {
            self.library[*t].add(*values, &mut sizes);
        }
        sizes[place::LENGTH] = sizes[place::LENGTH] + mounting;
        sizes[place::GAIN] = (sizes[place::GAIN] + 1.0) * (gain + 1.0) - 1.0;
        let reading = &self.data.readings[r];
        let none = R::constant(f64::NAN);
        let Some(shown) = reading.joint.shown(&reading.at, reading.side, &sizes) else {
            return [none; 3];
        };
        let Shown {
            torque,
            length,
            arm,
            ..
        } = shown;
        let apply = |torque: R, (t, values): &(usize, [R; 2])| {
            self.library[*t].apply(torque, *values, self.data, r)
        };
        [terms.iter().fold(torque, apply), length * 1e3, arm * 1e3]
    }

    /// Mounting and gain that act on row `r`.
    fn random(&self, point: &Point, r: usize) -> [f64; 2] {
        let reading = &self.data.readings[r];
        let of = |node: Option<usize>, c: usize| {
            let column = node.and_then(|n| self.tree.columns_of(n, c));
            column.map_or(0.0, |(k, _)| point.random[k])
        };
        [
            of(self.tests[reading.test], component::MOUNTING),
            of(self.actuators[reading.actuator], component::GAIN),
        ]
    }

    fn values(&self, point: &Point, r: usize) -> Three<f64> {
        let terms: Vec<(usize, [f64; 2])> =
            point.terms.iter().map(|(t, v)| (*t, pair(v))).collect();
        self.shows(r, self.random(point, r), &terms)
    }

    /// The scale of the misfit of row `r`, N.m.
    fn misfit_scale(&self, r: usize) -> f64 {
        match self.data.readings[r].side {
            Side::Slack => 0.0,
            Side::Pulls | Side::Corner | Side::AsPublished => {
                self.reference[r] + settings::MISFIT_FLOOR * self.data.largest_nm
            }
        }
    }

    fn derivatives(&self, point: &Point, r: usize) -> Three<Dual<SLOTS>> {
        let [mounting, gain] = self.random(point, r);
        let random = [
            Dual::variable(mounting, MOUNTING),
            Dual::variable(gain, GAIN),
        ];
        let of = |(k, (t, values)): (usize, &(usize, Vec<f64>))| {
            let [a, b] = pair(values);
            let slot = TERMS + 2 * k;
            let second = if values.len() > 1 {
                Dual::variable(b, slot + 1)
            } else {
                Dual::constant(b)
            };
            (*t, [Dual::variable(a, slot), second])
        };
        let terms: Vec<(usize, [Dual<SLOTS>; 2])> =
            point.terms.iter().enumerate().map(of).collect();
        self.shows(r, random, &terms)
    }

    /// Derivatives of reading `i` by the random effects of its path.
    fn random_row(&self, i: usize, shown: &Dual<SLOTS>) -> Vec<f64> {
        let (r, what) = (self.row[i], self.quantity[i]);
        let only = |q: Quantity| f64::from(u8::from(what == q));
        let scale = only(Quantity::Torque) * self.misfit_scale(r);
        let misfit = || self.basis[r].iter().map(move |c| c * scale);
        let mut row: Vec<f64> = misfit().collect();
        row.push(shown.gradient[GAIN]);
        row.push(shown.gradient[MOUNTING]);
        row.push(only(Quantity::Torque));
        row.extend(misfit());
        row.push(only(Quantity::Length));
        row.push(only(Quantity::Arm));
        row
    }

    /// Changes of all readings by a term, per unit of its amplitudes: at small amplitudes; for a term with one, also at amplitudes that change
    /// the torque visibly, where these have another form.
    fn shown_by(&self, point: &Point, base: &[f64], t: usize) -> Vec<Direction> {
        let engine = &self.terms[t];
        let (low, high) = engine.bounds[0];
        let small = 1e-4 * high;
        let count = engine.amplitudes;
        let direction = |columns| Direction {
            term: t,
            start: vec![1.0; count],
            columns,
        };
        let change = |k: usize, amplitude: f64| {
            let mut values = vec![0.0; count];
            values[k] = amplitude;
            self.change(point, base, t, values, amplitude)
        };
        if count > 1 {
            return vec![direction((0..count).map(|k| change(k, small)).collect())];
        }
        let near = change(0, small);
        let size = self.rms_of_torques(&near);
        let mut directions = vec![direction(vec![near])];
        if size > 0.0 && size.is_finite() {
            let target = LARGE_CHANGES[0] * self.rms_of_torques(base);
            let large = (target / size).min(0.5 * high);
            let mut far = vec![large];
            if low < 0.0 {
                far.push((-large).max(0.5 * low));
            }
            for amplitude in far {
                let column = change(0, amplitude);
                let alike = |d: &Direction| cosine(&d.columns[0], &column) >= SAME_DIRECTION;
                if !directions.iter().any(alike) {
                    directions.push(direction(vec![column]));
                }
            }
        }
        directions
    }

    fn change(
        &self,
        point: &Point,
        base: &[f64],
        t: usize,
        values: Vec<f64>,
        unit: f64,
    ) -> Vec<f64> {
        let mut with = point.clone();
        with.terms.push((t, values));
        let predicted = self.predict(&with);
        let pairs = predicted.iter().zip(base);
        pairs.map(|(a, b)| (a - b) / unit).collect()
    }

    fn rms_of_torques(&self, values: &[f64]) -> f64 {
        let torques = (0..values.len()).filter(|i| self.is_torque(*i));
        let squares: Vec<f64> = torques.map(|i| values[i] * values[i]).collect();
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
    }
}

fn pair(values: &[f64]) -> [f64; 2] {
    [values[0], values.get(1).copied().unwrap_or(0.0)]
}

fn components(data: &Data, actuators: usize, tests: usize) -> Vec<Component> {
    let of = |scale: f64, usual: f64, groups: usize| Component {
        scale: Scale {
            prior: Prior::HalfNormal(scale),
            usual,
            groups,
        },
        linear: true,
        calibrates: false,
        misfit: false,
    };
    let misfit = |scale: f64, groups: usize| Component {
        misfit: true,
        ..of(scale, scale, groups)
    };
    let scatter = |usual: f64, groups: usize| of(shared::LARGEST_SCATTER * usual, usual, groups);
    let known = |component: Component, linear: bool| Component {
        linear,
        calibrates: true,
        ..component
    };
    let bias = || of(settings::USUAL_BIAS_MM, settings::USUAL_BIAS_MM, tests);
    vec![
        misfit(settings::COMMON_MISFIT, tests),
        known(
            of(settings::LARGEST_GAIN, shared::USUAL_GAIN, actuators),
            false,
        ),
        known(
            of(
                settings::LARGEST_MOUNTING_MM,
                settings::USUAL_MOUNTING_MM,
                tests,
            ),
            false,
        ),
        known(scatter(settings::USUAL_ZERO * data.largest_nm, tests), true),
        misfit(shared::SESSION_MISFIT, tests),
        bias(),
        bias(),
    ]
}

/// What is known of the noise of each class.
fn noise(data: &Data, lengths: usize, arms: usize) -> Vec<Scale> {
    let scale = |prior, usual| Scale {
        prior,
        usual,
        groups: 1,
    };
    let by_hand = |count: usize, declared: Option<f64>, usual: f64| match declared {
        Some(sd) => scale(Prior::Fixed(sd), sd),
        None if count < settings::FEWEST_FOR_NOISE => scale(Prior::Fixed(usual), usual),
        None => scale(Prior::Free, usual),
    };
    let torque = 0.01 * data.largest_nm;
    vec![
        scale(Prior::Free, torque),
        scale(Prior::Held(settings::NEAR_SLACK * data.largest_nm), torque),
        by_hand(
            lengths,
            data.declared_sd_mm(|h| h.length_sd_m),
            settings::LENGTH_SD_MM,
        ),
        by_hand(
            arms,
            data.declared_sd_mm(|h| h.arm_sd_m),
            settings::ARM_SD_MM,
        ),
    ]
}

/// Cosines along the angle over the range of the readings.
fn bases(data: &Data) -> Vec<Vec<f64>> {
    let angles: Vec<f64> = data.readings.iter().map(|r| r.at.angle_rad).collect();
    let low = angles.iter().copied().fold(f64::INFINITY, f64::min);
    let high = angles.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let range = (high - low).max(settings::ANGLE_LENGTH_RAD);
    let length = settings::ANGLE_LENGTH_RAD / range;
    angles
        .iter()
        .map(|a| cosines(COSINES, (a - low) / range, length))
        .collect()
}

impl Problem for TorqueProblem<'_> {
    fn tree(&self) -> &Tree {
        &self.tree
    }
    fn node(&self) -> &[usize] {
        &self.node
    }
    fn class(&self) -> &[usize] {
        &self.class
    }
    fn noise(&self) -> &[Scale] {
        &self.noise
    }
    fn observed(&self) -> &[f64] {
        &self.observed
    }
    fn components(&self) -> &[Component] {
        &self.components
    }
    fn coefficients(&self) -> &[Coefficient] {
        &[]
    }
    fn terms(&self) -> &[EngineTerm] {
        &self.terms
    }

    fn predict(&self, point: &Point) -> Vec<f64> {
        let rows: Vec<Three<f64>> = (0..self.data.readings.len())
            .map(|r| self.values(point, r))
            .collect();
        let readings = self.row.iter().zip(&self.quantity);
        readings.map(|(r, what)| rows[*r][*what as usize]).collect()
    }

    fn linearise(&self, point: &Point) -> Linearised {
        let n = self.row.len();
        let values: usize = point.terms.iter().map(|(_, v)| v.len()).sum();
        let mut linear = Linearised {
            predicted: Vec::with_capacity(n),
            by_coefficients: Vec::new(),
            by_terms: vec![vec![0.0; n]; values],
            random: Vec::with_capacity(n),
        };
        let rows: Vec<Three<Dual<SLOTS>>> = (0..self.data.readings.len())
            .map(|r| self.derivatives(point, r))
            .collect();
        for i in 0..n {
            let shown = &rows[self.row[i]][self.quantity[i] as usize];
            let mut column = 0;
            for (k, (_, values)) in point.terms.iter().enumerate() {
                for j in 0..values.len() {
                    linear.by_terms[column][i] = shown.gradient[TERMS + 2 * k + j];
                    column += 1;
                }
            }
            linear.predicted.push(shown.value);
            linear.random.push(self.random_row(i, shown));
        }
        linear
    }

    fn directions(&self, point: &Point) -> Vec<Direction> {
        let base = self.predict(point);
        let free = |t: &usize| !point.terms.iter().any(|(u, _)| u == t);
        let terms: Vec<usize> = (0..self.library.len()).filter(free).collect();
        let all = terms.par_iter().map(|t| self.shown_by(point, &base, *t));
        all.collect::<Vec<_>>().into_iter().flatten().collect()
    }

    fn directions_of(&self, point: &Point, term: usize) -> Vec<Direction> {
        self.shown_by(point, &self.predict(point), term)
    }
}

#[cfg(test)]
mod unit {
    use super::super::data::Reading;
    use super::super::operator::{At, Joint};
    use super::super::{library, recording};
    use super::*;
    use crate::build::Build;
    use crate::point::ByHand;
    use pipeline_base::random::Stream;
    use pipeline_config::FitOptions;
    use pipeline_diagnose::base::Base;
    use pipeline_inference::decisions;
    use pipeline_inference::fit::Free;
    use pipeline_inference::search::{Decision, Found, Search};
    use pipeline_mechanics::knee::{Setup, choice::named};
    use std::collections::BTreeMap;

    const TESTS: [&str; 6] = ["a1", "a2", "b1", "b2", "c1", "c2"];

    fn builds() -> Vec<Build> {
        let build = |(rest, contracted): (f64, f64)| Build {
            knee: named("pinned").unwrap(),
            route: "flexor".to_owned(),
            setup: Setup {
                diameter_mm: 10.0,
                rest_length_m: rest,
                contracted_length_m: contracted,
                fitting_m: 0.0352,
                tendon_m: 0.485 - rest,
            },
            remarks: Vec::new(),
        };
        [(0.485, 0.398), (0.457, 0.375), (0.43, 0.353)]
            .map(build)
            .to_vec()
    }

    /// Six tests of three actuators with these sizes; every test is mounted differently, and lengths and arms are taken by hand.
    fn readings<'a>(
        builds: &'a [Build],
        law: &'a Base,
        none: &'a BTreeMap<String, f64>,
        sizes: &[f64; SIZES],
    ) -> Vec<Reading<'a>> {
        let mut stream = Stream::new(3, &["unit", "torque"]);
        let mut all = Vec::new();
        for test in 0..TESTS.len() {
            let joint = Joint::new(&builds[test / 2], law);
            let mut own = *sizes;
            own[place::LENGTH] += 1.5 * stream.normal();
            for k in 0..14 {
                let degrees = -100.0 + 6.5 * f64::from(k) + 2.0 * stream.uniform();
                let at = At::still(degrees.to_radians(), 600.0 + 5.0 * stream.normal());
                let shown = joint.seen(&at, &own).unwrap();
                let mut off = |sd: f64| sd * stream.normal();
                all.push(Reading {
                    joint,
                    at,
                    side: Side::Pulls,
                    torque_nm: shown.torque + off(0.2),
                    by_hand: ByHand {
                        length_m: Some(shown.length + off(0.004)),
                        contraction_rel: None,
                        arm_m: Some(shown.arm + off(0.005)),
                        length_sd_m: None,
                        arm_sd_m: None,
                    },
                    actuator: test / 2,
                    test,
                    order: f64::from(k) / 13.0,
                    source: ("log.csv", i64::from(k) + 2),
                    extras: none,
                });
            }
        }
        all
    }

    fn data(readings: Vec<Reading>) -> Data {
        Data::new(readings, TESTS.to_vec(), vec!["a", "b", "c"])
    }

    fn law() -> Base {
        Base::new(10, false, 1, &FitOptions::default())
    }

    fn with(list: &[(usize, f64)]) -> [f64; SIZES] {
        let mut sizes = [0.0; SIZES];
        for (place, value) in list {
            sizes[*place] = *value;
        }
        sizes
    }

    fn found(problem: &TorqueProblem) -> Found {
        let setting = Setting::new(problem);
        let decision = Decision {
            level: decisions::LEVEL,
            draws: 59,
            alike: decisions::ALIKE,
            most_terms: 3,
            thorough: true,
        };
        let normal = |k: usize| -> Box<dyn FnMut() -> f64> {
            let mut stream = Stream::new(1, &["unit draw", &k.to_string()]);
            Box::new(move || stream.normal())
        };
        let search = Search {
            setting: &setting,
            decision,
            tried: None,
        };
        search.run_exchanging(setting.fit_afresh(&problem.start()), &normal, None)
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let (builds, law, none) = (builds(), law(), BTreeMap::new());
        let data = data(readings(
            &builds,
            &law,
            &none,
            &with(&[(place::AXIAL, 60.0)]),
        ));
        let library = library::terms(&data);
        let problem = TorqueProblem::new(&data, &library).with_reference();
        for (t, term) in library.iter().enumerate() {
            let mut point = problem.start();
            // Somewhere off the origin, inside the bounds.
            let size = 0.05 * problem.terms()[t].bounds[0].1;
            point.terms.push((t, vec![size; term.values()]));
            for (k, b) in point.random.iter_mut().enumerate() {
                *b = 0.01 * (k % 7) as f64;
            }
            let linear = problem.linearise(&point);
            for (k, column) in linear.by_terms.iter().enumerate() {
                let step = 1e-4 * problem.terms()[t].bounds[k].1;
                let at = |sign: f64| {
                    let mut moved = point.clone();
                    moved.terms[0].1[k] += sign * step;
                    problem.predict(&moved)
                };
                let (up, down) = (at(1.0), at(-1.0));
                let largest = column.iter().fold(1e-6, |m: f64, x| m.max(x.abs()));
                for (i, slope) in column.iter().enumerate() {
                    let expected = (up[i] - down[i]) / (2.0 * step);
                    assert!(
                        (slope - expected).abs() < 2e-3 * largest,
                        "{:?} {i}: {slope} {expected}",
                        library[t]
                    );
                }
            }
        }
    }

    #[test]
    fn fits_from_several_starts_agree() {
        let (builds, law, none) = (builds(), law(), BTreeMap::new());
        let data = data(readings(&builds, &law, &none, &with(&[])));
        let library = library::terms(&data);
        let problem = TorqueProblem::new(&data, &library).with_reference();
        let setting = Setting::new(&problem);
        let best = setting.fit_afresh(&problem.start());
        for factor in [0.3, 3.0] {
            let other = Setting {
                start_factor: factor,
                ..setting.clone()
            };
            let fit = other.fit(&problem.start(), &other.fresh()[..1]);
            assert!(
                fit.log_likelihood < best.log_likelihood + 0.1,
                "{factor}: {} {}",
                fit.log_likelihood,
                best.log_likelihood
            );
            assert!(
                fit.log_likelihood > best.log_likelihood - 1.5,
                "{factor}: {} {}",
                fit.log_likelihood,
                best.log_likelihood
            );
        }
        let mounting = best.variances.components[component::MOUNTING];
        assert!((0.5..3.0).contains(&mounting), "{mounting}");
    }

    /// What a fit says of its likelihood is what a fit finds that starts there with the value held: a step that was refused is no convergence.
    #[test]
    fn a_fit_is_a_fixed_point() {
        let (builds, law, none) = (builds(), law(), BTreeMap::new());
        let yields = with(&[(place::AXIAL, 60.0)]);
        let data = data(readings(&builds, &law, &none, &yields));
        let library = library::terms(&data);
        let problem = TorqueProblem::new(&data, &library).with_reference();
        let setting = Setting::new(&problem);
        let axial = library
            .iter()
            .position(|t| t.form().is_some_and(|f| f.first == place::AXIAL));
        for from in [1.0, 20.0, 60.0, 150.0] {
            let mut point = problem.start();
            point.terms.push((axial.unwrap(), vec![from]));
            let fit = setting.fit(&point, &setting.fresh());
            let mut held = setting.clone();
            held.pinned.push(Free::Value(0, 0));
            let again = held.fit(&fit.point, std::slice::from_ref(&fit.variances));
            let off = fit.log_likelihood - again.log_likelihood;
            assert!(off.abs() < 0.2, "from {from}: {off}");
            let found = fit.values(axial.unwrap()).unwrap()[0];
            assert!((found - 60.0).abs() < 10.0, "from {from}: {found}");
        }
    }

    #[test]
    fn nothing_is_found_in_nothing_and_what_yields_where_it_does() {
        let (builds, law, none) = (builds(), law(), BTreeMap::new());
        let nothing = data(readings(&builds, &law, &none, &with(&[])));
        let library = library::terms(&nothing);
        let problem = TorqueProblem::new(&nothing, &library).with_reference();
        assert_eq!(found(&problem).accepted, []);
        let yields = data(readings(
            &builds,
            &law,
            &none,
            &with(&[(place::AXIAL, 90.0)]),
        ));
        let problem = TorqueProblem::new(&yields, &library).with_reference();
        let found = found(&problem);
        let ids: Vec<&str> = found
            .accepted
            .iter()
            .map(|a| library[a.term].name(&yields))
            .collect();
        assert_eq!(ids, ["series_compliance"]);
    }

    #[test]
    fn an_arm_that_is_measured_elsewhere_in_one_test_is_set_aside() {
        let (builds, law, none) = (builds(), law(), BTreeMap::new());
        let mut all = readings(&builds, &law, &none, &with(&[]));
        for r in all.iter_mut().filter(|r| r.test == 4) {
            r.by_hand.arm_m = r.by_hand.arm_m.map(|a| a - 0.04);
        }
        let mut data = data(all);
        let errors = recording::without_odd_hands(&mut data);
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert_eq!(
            (errors[0].group.as_str(), errors[0].quantity.as_deref()),
            ("c1", Some("moment_arm"))
        );
        assert!(
            data.readings
                .iter()
                .all(|r| (r.test == 4) == r.by_hand.arm_m.is_none())
        );
    }

    #[test]
    fn torques_of_the_other_sign_are_pointed_at() {
        let (builds, law, none) = (builds(), law(), BTreeMap::new());
        let mut all = readings(&builds, &law, &none, &with(&[]));
        for r in all.iter_mut().filter(|r| r.test == 2) {
            r.torque_nm = -r.torque_nm;
        }
        let errors = recording::wrong_signs(&data(all));
        assert_eq!(
            errors.iter().map(|e| e.group.as_str()).collect::<Vec<_>>(),
            ["b1"]
        );
    }
}
