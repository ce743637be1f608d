//! The readings of one joint, with everything that is known of each.

use super::operator::{At, Joint, Shown};
use super::settings;
use super::terms::SIZES;
use crate::point::{ByHand, Point};
use pipeline_base::random::Stream;
use pipeline_diagnose::slack::Side;
use pipeline_inference::decisions::FEWEST;
use pipeline_numerics::statistics::{mean, median, sd_by_median};
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

/// The torque up to which a reading may be of a slack actuator, N.m: a share of the largest, or what the readings show where the rigid leg would push by
/// more than that.
fn of_slack_nm(readings: &[Reading], largest_nm: f64) -> f64 {
    let share = settings::NEAR_SLACK * largest_nm;
    let is_slack = |r: &&Reading| r.joint.pushed_nm(&r.at).is_some_and(|push| push > share);
    let slack = readings.iter().filter(is_slack);
    let sizes: Vec<f64> = slack.map(|r| r.torque_nm.abs()).collect();
    if sizes.len() < FEWEST {
        return share;
    }
    share.max(settings::SLACK_DEVIATIONS * sd_by_median(&sizes))
}

impl<'a> Data<'a> {
    /// The rows of some tests.
    pub fn new(
        mut readings: Vec<Reading<'a>>,
        tests: Vec<&'a str>,
        actuators: Vec<&'a str>,
    ) -> Self {
        let largest_nm = readings
            .iter()
            .fold(0.0, |m: f64, r| m.max(r.torque_nm.abs()));
        let slack_nm = of_slack_nm(&readings, largest_nm);
        for r in &mut readings {
            r.side = r.joint.side(&r.at, r.torque_nm, largest_nm, slack_nm);
        }
        let mut data = Self {
            readings,
            tests,
            actuators,
            columns: Vec::new(),
            largest_nm,
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

    /// A standardised column; none of one that does not vary within tests: what differs between tests alone is scatter.
    fn column(&self, name: &str, values: Vec<f64>, of_the_law: bool) -> Option<Column> {
        let mut pairs = self.readings.windows(2).zip(values.windows(2));
        let varies = pairs.any(|(r, v)| r[0].test == r[1].test && v[0] != v[1]);
        let middle = mean(&values);
        let squares: Vec<f64> = values.iter().map(|x| (x - middle) * (x - middle)).collect();
        let sd = mean(&squares).sqrt();
        let usable = varies && sd > 0.0 && sd.is_finite();
        usable.then(|| Column {
            name: name.to_owned(),
            values: values.iter().map(|x| (x - middle) / sd).collect(),
            middle,
            sd,
            of_the_law,
        })
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
    use crate::build::Build;
    use pipeline_config::FitOptions;
    use pipeline_diagnose::base::Base;
    use pipeline_mechanics::knee::{Setup, choice::named};

    fn extensor() -> Build {
        Build {
            knee: named("pinned").unwrap(),
            route: "extensor".to_owned(),
            setup: Setup {
                diameter_mm: 10.0,
                rest_length_m: 0.485,
                contracted_length_m: 0.398,
                fitting_m: 0.0254,
                tendon_m: 0.0,
            },
            remarks: Vec::new(),
        }
    }

    fn at(degrees: f64) -> At {
        At::still(degrees.to_radians(), 610.0)
    }

    fn reading<'a>(
        joint: Joint<'a>,
        degrees: f64,
        torque_nm: f64,
        none: &'a BTreeMap<String, f64>,
    ) -> Reading<'a> {
        Reading {
            joint,
            at: at(degrees),
            side: Side::Pulls,
            torque_nm,
            by_hand: ByHand {
                length_m: None,
                contraction_rel: None,
                arm_m: None,
                length_sd_m: None,
                arm_sd_m: None,
            },
            actuator: 0,
            test: 0,
            order: 0.0,
            source: ("points.csv", 2),
            extras: none,
        }
    }

    /// An extensor that works at more than half of its contraction: its largest torque, 4 N.m, is a quarter of that at none.
    #[test]
    fn where_the_law_would_push_a_torque_is_noise_unless_nearer_to_the_push() {
        let (build, law) = (extensor(), Base::new(10, false, 1, &FitOptions::default()));
        let joint = Joint::new(&build, &law);
        let push = joint.pushed_nm(&at(-5.0)).unwrap();
        assert!(push > 1.0, "{push}");
        for torque in [0.49 * push, -0.49 * push] {
            assert_eq!(joint.side(&at(-5.0), torque, 4.0, 0.1), Side::Slack);
        }
        for torque in [0.51 * push, -0.51 * push] {
            assert_eq!(joint.side(&at(-5.0), torque, 4.0, 0.1), Side::Pulls);
        }
        // Where it pulls, nothing is slack.
        assert_eq!(joint.pushed_nm(&at(-90.0)), None);
        assert_eq!(joint.side(&at(-90.0), 0.5, 4.0, 1.0), Side::Pulls);
    }

    #[test]
    fn what_slack_actuators_show_is_no_pull_beside_the_corner() {
        let (build, law) = (extensor(), Base::new(10, false, 1, &FitOptions::default()));
        let joint = Joint::new(&build, &law);
        let none = BTreeMap::new();
        let slack = |torques: &[f64]| -> f64 {
            let readings: Vec<Reading> = torques
                .iter()
                .map(|t| reading(joint, -5.0, *t, &none))
                .collect();
            of_slack_nm(&readings, 4.0)
        };
        // Two tell nothing of the noise; three with a median of 0.2 N.m do.
        assert_eq!(slack(&[0.2, -0.2]), 0.4);
        let three = slack(&[0.2, -0.2, 0.1]);
        assert!((three - 3.0 * 0.2 / 0.674_489_750_196_082).abs() < 1e-12);
        // Quiet ones leave the share of the largest torque.
        assert_eq!(slack(&[0.01, -0.01, 0.01]), 0.4);
        let corner = joint.pushed_nm(&at(-28.0)).unwrap();
        assert!(corner < 0.4, "{corner}");
        assert_eq!(joint.side(&at(-28.0), 0.6, 4.0, 0.4), Side::Pulls);
        assert_ne!(joint.side(&at(-28.0), 0.6, 4.0, three), Side::Pulls);
    }
}
