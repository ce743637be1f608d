//! The readings of one joint, with everything that is known of each.

use super::operator::{At, Joint, Shown};
use super::sides::Torques;
use super::terms::SIZES;
use crate::point::{ByHand, Point};
use pipeline_base::random::Stream;
use pipeline_diagnose::slack::Side;
use pipeline_inference::decisions::{FEWEST, PARALLEL};
use pipeline_numerics::statistics::{mean, median};
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Name of the shuffled column.
pub const PLACEBO: &str = "placebo";

/// A row: a torque, and what a tape measure showed with it.
#[derive(Clone, Copy)]
pub struct Reading<'a> {
    /// The joint.
    pub joint: Joint<'a>,
    /// Angle, pressure and how the joint came there.
    pub at: At,
    /// Side of the corner to slackness.
    pub side: Side,
    /// Measured torque, N.m.
    pub torque_nm: f64,
    /// What was measured by hand.
    pub by_hand: ByHand,
    /// Number of the actuator.
    pub actuator: usize,
    /// Number of the test.
    pub test: usize,
    /// Place in the order of its test's readings: 0 for the first, 1 for the last.
    pub order: f64,
    /// Log file and line of the reading.
    pub source: (&'a str, i64),
    /// Other columns.
    pub extras: &'a BTreeMap<String, f64>,
}

impl Reading<'_> {
    /// What the leg shows with effects of these sizes, an actuator that would push taken as slack; none where there is no answer.
    pub fn shown(&self, sizes: &[f64; SIZES]) -> Option<Shown<f64>> {
        let shown = self.joint.seen(&self.at, sizes)?;
        Some(shown).filter(|s| s.torque.is_finite())
    }
}

/// A column on which torques may depend without a physical name.
#[derive(Clone, Debug)]
pub struct Column {
    /// Name, as in files.
    pub name: String,
    /// Standardised values, one a row.
    pub values: Vec<f64>,
    /// What was taken off.
    pub middle: f64,
    /// By what it was divided.
    pub sd: f64,
    /// Whether it belongs to the law, so that an offset over it would be no other than a gain.
    pub of_the_law: bool,
    /// Whether its square is more than the angle by another name, as that of the order of readings is not where a joint turns there and back.
    pub curved: bool,
}

/// The rows of a search.
pub struct Data<'a> {
    /// The rows, test by test.
    pub readings: Vec<Reading<'a>>,
    /// Names of all tests of the joint, by number.
    pub tests: Vec<&'a str>,
    /// Names of all actuators, by number.
    pub actuators: Vec<&'a str>,
    /// Columns.
    pub columns: Vec<Column>,
    /// Largest torque, N.m.
    pub largest_nm: f64,
}

impl<'a> Data<'a> {
    /// The rows of some tests.
    pub fn new(
        mut readings: Vec<Reading<'a>>,
        tests: Vec<&'a str>,
        actuators: Vec<&'a str>,
    ) -> Self {
        let torques = Torques::of(&readings);
        for r in &mut readings {
            r.side = r.joint.side(&r.at, r.torque_nm, &torques);
        }
        let mut data = Self {
            readings,
            tests,
            actuators,
            columns: Vec::new(),
            largest_nm: torques.largest,
        };
        data.columns = data.all_columns();
        data
    }

    /// The same with every reading on the side of slackness that the law says.
    pub fn as_published(mut self) -> Self {
        for r in &mut self.readings {
            r.side = Side::AsPublished;
        }
        self
    }

    /// The same without a test.
    pub fn without(self, test: usize) -> Self {
        let mut readings = self.readings;
        readings.retain(|r| r.test != test);
        Self::new(readings, self.tests, self.actuators)
    }

    /// Whether the joint turned both ways often enough for friction to show.
    pub fn turns_both_ways(&self) -> bool {
        let turned = |sense: f64| self.readings.iter().filter(|r| r.at.sense == sense).count();
        turned(1.0).min(turned(-1.0)) >= FEWEST
    }

    /// The angle is not among them: the misfit runs along it, and a second curve over it would carry over to actuators that it was not seen on.
    fn all_columns(&self) -> Vec<Column> {
        let of = |name: &str, of_the_law: bool, value: &dyn Fn(&Reading) -> f64| {
            let values = self.readings.iter().map(value).collect();
            self.column(name, values, of_the_law)
        };
        let shuffled = self.shuffled_angles();
        let mut all = vec![
            of("order", false, &|r| r.order),
            of("pressure", true, &|r| r.at.pressure_kpa),
            self.column(PLACEBO, shuffled, false),
        ];
        let first = self.readings.first().map(|r| r.extras);
        for name in first.into_iter().flat_map(BTreeMap::keys) {
            let values = self.readings.iter().map(|r| r.extras.get(name).copied());
            if let Some(values) = values.collect::<Option<Vec<f64>>>() {
                all.push(self.column(name, values, false));
            }
        }
        all.into_iter().flatten().collect()
    }

    /// A standardised column; none of one that does not vary within tests, because what differs between tests alone is scatter, nor of one that is
    /// the angle by another name.
    fn column(&self, name: &str, values: Vec<f64>, of_the_law: bool) -> Option<Column> {
        let mut pairs = self.readings.windows(2).zip(values.windows(2));
        let varies = pairs.any(|(r, v)| r[0].test == r[1].test && v[0] != v[1]);
        let middle = mean(&values);
        let squares: Vec<f64> = values.iter().map(|x| (x - middle) * (x - middle)).collect();
        let sd = mean(&squares).sqrt();
        if !(varies && sd > 0.0 && sd.is_finite()) {
            return None;
        }
        let values: Vec<f64> = values.iter().map(|x| (x - middle) / sd).collect();
        let square: Vec<f64> = values.iter().map(|x| x * x).collect();
        let is_more = |values: &[f64]| self.beside_the_angle(values) > 1.0 - PARALLEL * PARALLEL;
        is_more(&values).then(|| Column {
            name: name.to_owned(),
            curved: is_more(&square),
            values,
            middle,
            sd,
            of_the_law,
        })
    }

    /// The share of the squares of a column about its means by test that no parabola over the angle explains, test by test.
    fn beside_the_angle(&self, values: &[f64]) -> f64 {
        let mut squares = (0.0, 0.0);
        let mut first = 0;
        for test in self.readings.chunk_by(|a, b| a.test == b.test) {
            let own = &values[first..first + test.len()];
            first += test.len();
            let angle: Vec<f64> = test.iter().map(|r| r.at.angle_rad).collect();
            let square = angle.iter().map(|a| a * a).collect();
            let mut left = own.to_vec();
            let mut basis: Vec<Vec<f64>> = Vec::new();
            for mut column in [vec![1.0; own.len()], angle, square] {
                basis.iter().for_each(|b| take_off(&mut column, b));
                take_off(&mut left, &column);
                if basis.is_empty() {
                    squares.1 += sum_of_squares(&left);
                }
                basis.push(column);
            }
            squares.0 += sum_of_squares(&left);
        }
        squares.0 / squares.1
    }

    /// The angles of every test in another order: a column that must never be chosen.
    fn shuffled_angles(&self) -> Vec<f64> {
        let mut angles: Vec<f64> = self
            .readings
            .iter()
            .map(|r| r.at.angle_rad.to_degrees())
            .collect();
        let tests = self.readings.chunk_by(|a, b| a.test == b.test);
        let mut first = 0;
        for test in tests {
            let mut stream = Stream::new(1, &["torque placebo", self.tests[test[0].test]]);
            let own = &mut angles[first..first + test.len()];
            for k in (1..own.len()).rev() {
                own.swap(k, stream.below(k + 1));
            }
            first += test.len();
        }
        angles
    }

    /// The declared standard deviation of hand-measured lengths or arms, mm: the median where rows differ; none where nobody declares one.
    pub fn declared_sd_mm(&self, of: impl Fn(&ByHand) -> Option<f64>) -> Option<f64> {
        let all: Vec<f64> = self
            .readings
            .iter()
            .filter_map(|r| of(&r.by_hand))
            .collect();
        (!all.is_empty()).then(|| 1e3 * median(&all))
    }
}

fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum()
}

/// Takes off the part of a vector that lies along another.
fn take_off(vector: &mut [f64], along: &[f64]) {
    let product: f64 = vector.iter().zip(along).map(|(v, a)| v * a).sum();
    let share = product / sum_of_squares(along);
    if share.is_finite() {
        let pairs = vector.iter_mut().zip(along);
        pairs.for_each(|(v, a)| *v -= share * a);
    }
}

/// In which sense the joint turned before each reading, from their order: 0 before the first move, and while it stands that of the last one.
pub fn senses(points: &[Point]) -> Vec<f64> {
    let mut senses = vec![0.0; points.len()];
    for k in 1..points.len() {
        let by = points[k].angle_rad - points[k - 1].angle_rad;
        senses[k] = match by.partial_cmp(&0.0) {
            Some(Ordering::Greater) => 1.0,
            Some(Ordering::Less) => -1.0,
            _ => senses[k - 1],
        };
    }
    senses
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::sides::tests::{extensor, reading};
    use pipeline_config::FitOptions;
    use pipeline_diagnose::base::Base;

    #[test]
    fn what_is_the_angle_by_another_name_is_no_column() {
        let (build, law) = (extensor(), Base::new(10, false, 1, &FitOptions::default()));
        let joint = Joint::new(&build, &law);
        let none = BTreeMap::new();
        let order = |angles: &[f64]| {
            let last = (angles.len() - 1) as f64;
            let all = angles.iter().enumerate().map(|(k, degrees)| Reading {
                order: k as f64 / last,
                ..reading(joint, *degrees, 1.0, &none)
            });
            let data = Data::new(all.collect(), vec!["t"], vec!["a"]);
            let mut columns = data.columns.into_iter();
            columns.find(|c| c.name == "order").map(|c| c.curved)
        };
        let there: Vec<f64> = (0..10).map(|k| -100.0 + 10.0 * f64::from(k)).collect();
        assert_eq!(order(&there), None);
        // There and back: the square of the order is the angle, the order itself is not.
        let back = there.iter().rev().copied();
        let both: Vec<f64> = there.iter().copied().chain(back).collect();
        assert_eq!(order(&both), Some(false));
        let mixed = [
            -50.0, -90.0, -20.0, -70.0, -10.0, -100.0, -40.0, -80.0, -30.0, -60.0,
        ];
        assert_eq!(order(&mixed), Some(true));
    }
}
