//! What belongs to one test or one actuator and is no effect of the joint: how the test was mounted, and how strong the actuator is.
//!
//! Tests differ by some millimetres in the length that is left for the actuator, and actuators by a few percent in strength. Readings of one
//! test share both, so that counting readings would make nonsense significant. They are random effects b of the null model,
//! r = Z b + e with b ~ N(0, s^2), e ~ N(0, sigma^2): a fit minimises |r - Z b|^2 + sum (sigma b/s)^2 over its sizes and b at once. Seen from the
//! sizes alone that is least squares of what an orthogonal projection leaves of r, [`Nuisance::left`].
//!
//! How much tests differ comes from the readings by expectation-maximisation (Dempster, Laird and Rubin, *J. R. Stat. Soc. B* 39, 1977), together
//! with what is known before any was measured, which counts as [`WORTH`] tests: one test cannot tell how much tests differ. How much actuators
//! differ in strength is known from rigs that measure forces, and a knee would take for it whatever acts like a strength.

use super::refit::{Reading, Sizes};
use super::terms::place;
use crate::numerics::cholesky::Cholesky;
use crate::numerics::matrix::{Matrix, dot, norm};
use crate::numerics::statistics::sum_of_squares;
use std::collections::BTreeMap;

/// Kinds: how a test was mounted (mm), how strong an actuator is (1).
const KINDS: usize = 2;
const MOUNTING: usize = 0;
/// Spreads before anything was measured: a tape measure, and the scatter of actuators' maximum force in the force paper.
const BEFORE: [f64; KINDS] = [1.0, 0.02];
/// So many tests is that knowledge worth.
pub const WORTH: f64 = 4.0;
/// No load cell of a knee does better, N.m.
pub const FINEST_NM: f64 = 0.01;
const PASSES: usize = 60;

/// Standard deviations of the null model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spreads {
    /// Of a reading, N.m.
    pub noise_nm: f64,
    /// Between tests in the length, mm, and between actuators in the strength, 1.
    pub between: [f64; KINDS],
}

/// The projection that takes off what tests and actuators have of their own.
pub struct Nuisance {
    /// Orthonormal, of readings and one row a random effect.
    basis: Vec<Vec<f64>>,
    effects: usize,
}

impl Spreads {
    /// Before anything was measured, with this much noise in N.m.
    pub fn before(noise_nm: f64) -> Self {
        Self {
            noise_nm: noise_nm.max(FINEST_NM),
            between: BEFORE,
        }
    }

    /// From what a fit leaves. Length and strength common to all readings are no part of the spreads and are fitted along.
    pub fn of(readings: &[Reading], sizes: &Sizes) -> Self {
        let left = sizes.residuals(readings);
        let n = left.len();
        let traces = sizes.traces(readings);
        let mut common = sizes.terms.clone();
        common.extend([place::LENGTH, place::GAIN]);
        common.sort_unstable();
        common.dedup();
        let random = columns(readings);
        let mut all: Vec<&[f64]> = random.iter().map(|(_, c)| &c[..]).collect();
        all.extend(common.iter().map(|t| &traces[*t][..]));
        let mut now = Self::before((sum_of_squares(&left) / n as f64).sqrt());
        for _ in 0..PASSES {
            let penalty = |k: usize| random.get(k).map_or(0.0, |(kind, _)| now.ratio(*kind));
            let mut gram = Matrix::zeros(all.len(), all.len());
            for (i, a) in all.iter().enumerate() {
                for (j, b) in all.iter().enumerate() {
                    gram[(i, j)] = dot(a, b) + if i == j { penalty(i) } else { 0.0 };
                }
            }
            let factor = Cholesky::new(&gram);
            let wanted: Vec<f64> = all.iter().map(|c| dot(c, &left)).collect();
            let fitted = factor.solve(&wanted);
            let variance = |row: &[f64]| sum_of_squares(&factor.forward(row));
            let mut noise = 0.0;
            for (k, r) in left.iter().enumerate() {
                let row: Vec<f64> = all.iter().map(|c| c[k]).collect();
                let miss = r - dot(&row, &fitted);
                noise += miss * miss + now.noise_nm * now.noise_nm * variance(&row);
            }
            let (mut sum, mut count) = (WORTH * BEFORE[MOUNTING] * BEFORE[MOUNTING], WORTH);
            let tests = random.iter().enumerate();
            for (k, _) in tests.filter(|(_, (kind, _))| *kind == MOUNTING) {
                let mut unit = vec![0.0; all.len()];
                unit[k] = 1.0;
                let unsure = now.noise_nm * now.noise_nm * variance(&unit);
                sum += fitted[k] * fitted[k] + unsure;
                count += 1.0;
            }
            now.between[MOUNTING] = (sum / count).sqrt();
            now.noise_nm = (noise / n as f64).sqrt().max(FINEST_NM);
        }
        now
    }

    /// sigma^2/s^2 of a kind.
    fn ratio(&self, kind: usize) -> f64 {
        let ratio = self.noise_nm / self.between[kind];
        ratio * ratio
    }
}

impl Nuisance {
    /// Of readings.
    pub fn of(readings: &[Reading], spreads: &Spreads) -> Self {
        let (n, columns) = (readings.len(), columns(readings));
        let effects = columns.len();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for (k, (kind, mut column)) in columns.into_iter().enumerate() {
            column.resize(n + effects, 0.0);
            column[n + k] = spreads.ratio(kind).sqrt();
            reduce(&mut column, &basis);
            let length = norm(&column);
            if length > 0.0 {
                column.iter_mut().for_each(|x| *x /= length);
                basis.push(column);
            }
        }
        Self { basis, effects }
    }

    /// Rows that [`Nuisance::left`] adds.
    pub fn effects(&self) -> usize {
        self.effects
    }

    /// What the best random effects leave of a residual or a trace, one number a reading, and then what they cost.
    pub fn left(&self, of_readings: &[f64]) -> Vec<f64> {
        let mut left = of_readings.to_vec();
        left.resize(of_readings.len() + self.effects, 0.0);
        reduce(&mut left, &self.basis);
        left
    }
}

/// One column a test and one an actuator, with its kind: the torque that each unit of its own gives to its readings.
fn columns(readings: &[Reading]) -> Vec<(usize, Vec<f64>)> {
    let mut all: BTreeMap<(usize, usize), Vec<f64>> = BTreeMap::new();
    for (k, r) in readings.iter().enumerate() {
        for (kind, owner) in [r.test, r.actuator].into_iter().enumerate() {
            let column = all.entry((kind, owner));
            column.or_insert_with(|| vec![0.0; readings.len()])[k] = r.own[kind];
        }
    }
    all.into_iter().map(|((kind, _), c)| (kind, c)).collect()
}

/// A vector less its part along orthonormal directions.
pub fn reduce(vector: &mut [f64], basis: &[Vec<f64>]) {
    for direction in basis {
        let along = dot(vector, direction);
        vector
            .iter_mut()
            .zip(direction)
            .for_each(|(v, d)| *v -= along * d);
    }
}

#[cfg(test)]
mod unit {
    use super::*;
    use crate::knee::{Setup, choice::named};
    use crate::models::published;
    use crate::stages::torque::build::Build;
    use crate::stages::torque::diagnose::operator::{At, Joint};

    fn build() -> Build {
        Build {
            knee: named("pinned").unwrap(),
            route: "flexor".to_owned(),
            setup: Setup {
                diameter_mm: 10.0,
                rest_length_m: 0.485,
                contracted_length_m: 0.398,
                fitting_m: 0.0352,
                tendon_m: 0.0,
            },
            remarks: Vec::new(),
        }
    }

    /// So many tests of two actuators, each read at the same angles.
    fn readings<'a>(build: &'a Build, tests: usize, angles: &[f64]) -> Vec<Reading<'a>> {
        let all = published();
        let law = all.iter().find(|m| m.id() == "new_published").unwrap();
        let joint = Joint::new(build, *law);
        let one = |test: usize, degrees: &f64| Reading {
            joint,
            at: At::still(degrees.to_radians(), 606.0),
            torque_nm: 0.0,
            actuator: test % 2,
            test,
            unit: test,
            own: [0.0; 2],
        };
        let all = (0..tests).flat_map(|t| angles.iter().map(move |a| one(t, a)));
        all.collect()
    }

    #[test]
    fn what_a_test_has_of_its_own_costs_what_theory_says() {
        let build = build();
        let mut all = readings(&build, 1, &[-60.0, -50.0, -40.0, -30.0]);
        all.iter_mut().for_each(|r| r.own = [1.0, 0.0]);
        let spreads = Spreads {
            noise_nm: 0.5,
            between: [2.0, 0.02],
        };
        let left = Nuisance::of(&all, &spreads).left(&[3.0; 4]);
        // Of sum (r - b)^2 + rho b^2 with n readings r the least is r^2 n rho/(n + rho).
        let spread = 0.5_f64 / 2.0;
        let rho = spread * spread;
        let least = 9.0 * 4.0 * rho / (4.0 + rho);
        assert!((sum_of_squares(&left) - least).abs() < 1e-9, "{left:?}");
    }

    #[test]
    fn the_spread_between_tests_is_found() {
        let build = build();
        let angles = [-80.0, -70.0, -60.0, -50.0, -40.0, -30.0];
        let (tests, offset_mm, noise_nm) = (24, 5.0, 0.05);
        let plain = readings(&build, tests, &angles);
        let rigid = Sizes::rigid(&plain, &Spreads::before(1.0));
        let mut all = rigid.with_own(&plain);
        for (k, r) in all.iter_mut().enumerate() {
            // Both signs in either actuator, which a strength of its own cannot take up.
            let mounted = if r.test % 4 < 2 {
                offset_mm
            } else {
                -offset_mm
            };
            let scatter = if k % 2 == 0 { noise_nm } else { -noise_nm };
            r.torque_nm = rigid.predict(r).0 + mounted * r.own[MOUNTING] + scatter;
        }
        let found = Spreads::of(&all, &rigid);
        let n = tests as f64;
        let expected = ((WORTH + n * offset_mm * offset_mm) / (WORTH + n)).sqrt();
        let between = found.between[MOUNTING];
        assert!((between - expected).abs() < 0.05 * expected, "{found:?}");
        assert!((0.03..0.08).contains(&found.noise_nm), "{found:?}");
    }
}
