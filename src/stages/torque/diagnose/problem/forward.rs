//! What a row shows, torque, length and arm, by mounting, gain and terms, with its derivatives by all of them.

use super::{MOST_TERMS, Quantity, TorqueProblem, component};
use crate::diagnose::operator::Shown;
use crate::diagnose::settings;
use crate::diagnose::terms::{LAW_COEFFICIENTS, SIZES, place};
use pipeline_diagnose::slack::Side;
use pipeline_inference::problem::{Linearised, Point};
use pipeline_numerics::real::{Dual, Real};

/// Slots of the derivatives: mounting, gain, coefficients of the law, two for each term.
const SLOTS: usize = TERMS + 2 * MOST_TERMS;

const MOUNTING: usize = 0;

const GAIN: usize = 1;

const LAW: usize = 2;

const TERMS: usize = LAW + LAW_COEFFICIENTS.len();

/// What a row shows, in the units of the engine: N.m, mm, mm.
pub(super) type Three<R> = [R; 3];

impl TorqueProblem<'_> {
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
        law: [R; LAW_COEFFICIENTS.len()],
        terms: &[(usize, [R; 2])],
    ) -> Three<R> {
        let mut sizes = [R::constant(0.0); SIZES];
        sizes[place::LAW..].copy_from_slice(&law);
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

    pub(super) fn values(&self, point: &Point, r: usize) -> Three<f64> {
        let terms: Vec<(usize, [f64; 2])> =
            point.terms.iter().map(|(t, v)| (*t, pair(v))).collect();
        self.shows(r, self.random(point, r), [0.0; _], &terms)
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
        let law = std::array::from_fn(|k| Dual::variable(0.0, LAW + k));
        self.shows(r, random, law, &terms)
    }

    /// Predictions and derivatives at a point.
    pub(super) fn linearised(&self, point: &Point) -> Linearised {
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

    /// Derivatives of reading `i` by the random effects of its path.
    fn random_row(&self, i: usize, shown: &Dual<SLOTS>) -> Vec<f64> {
        let (r, what) = (self.row[i], self.quantity[i]);
        let only = |q: Quantity| f64::from(u8::from(what == q));
        let scale = only(Quantity::Torque) * self.misfit_scale(r);
        let misfit = || self.basis[r].iter().map(move |c| c * scale);
        let mut row: Vec<f64> = misfit().collect();
        row.extend(self.along_pressure[r].iter().map(|c| c * scale));
        let by_law = shown.gradient[LAW..TERMS].iter();
        row.extend(by_law.zip(settings::LAW_SD).map(|(d, sd)| d * sd));
        row.push(shown.gradient[GAIN]);
        row.push(shown.gradient[MOUNTING]);
        row.push(only(Quantity::Torque));
        row.extend(misfit());
        row.push(only(Quantity::Length));
        row.push(only(Quantity::Arm));
        row.push(
            only(Quantity::Torque) * f64::from(u8::from(self.data.readings[r].at.sense == 0.0)),
        );
        row
    }
}

fn pair(values: &[f64]) -> [f64; 2] {
    [values[0], values.get(1).copied().unwrap_or(0.0)]
}
