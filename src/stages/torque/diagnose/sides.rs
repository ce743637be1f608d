//! By which sizes of torques readings of slack actuators are told from pulls: what is within the noise may be either.

use super::data::Reading;
use super::settings;
use pipeline_diagnose::settings as shared;
use pipeline_inference::decisions::FEWEST;
use pipeline_numerics::statistics::sd_by_median;

/// Sizes of torques by which those of slack actuators are told from pulls, N.m.
#[derive(Clone, Copy, Debug)]
pub struct Torques {
    /// The largest of the joint.
    pub largest: f64,
    /// Up to this a reading may be of a slack actuator where the rigid leg would pull.
    pub near: f64,
    /// The same where it would push.
    pub slack: f64,
}

impl Torques {
    /// Of the readings of a joint.
    pub fn of(readings: &[Reading]) -> Self {
        let sizes = readings.iter().map(|r| r.torque_nm.abs());
        let largest = sizes.fold(0.0, f64::max);
        let share = settings::NEAR_SLACK * largest;
        // What is within the noise of nothing may be of an actuator that an offset of its length has made slack.
        let noise = settings::SLACK_DEVIATIONS * noise_nm(readings);
        Self {
            largest,
            near: noise.min(share).max(shared::NEAR_SLACK * largest),
            slack: of_slack_nm(readings, share),
        }
    }
}

/// The noise of the torques, N.m: third divided differences of neighbours in angle, among those of a test before which the joint turned the same way
/// (Gasser, Sroka and Jennen-Steinmetz, Biometrika 73 (1986) 625, have second ones; here by the median). With readings 14 degrees apart the second ones
/// hold the bend of the torque. Where the pressure varies as well, that is in it.
fn noise_nm(readings: &[Reading]) -> f64 {
    let mut off = Vec::new();
    for test in readings.chunk_by(|a, b| a.test == b.test) {
        for sense in [-1.0, 0.0, 1.0] {
            let alike = test.iter().filter(|r| r.at.sense == sense);
            let mut points: Vec<(f64, f64)> =
                alike.map(|r| (r.at.angle_rad, r.torque_nm)).collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            off.extend(points.windows(4).filter_map(off_the_parabola));
        }
    }
    if off.len() < FEWEST {
        return 0.0;
    }
    sd_by_median(&off)
}

/// The third divided difference of four points, by the deviation of one value; none where two are at one place.
fn off_the_parabola(four: &[(f64, f64)]) -> Option<f64> {
    let weight = |i: usize| {
        let others = (0..four.len()).filter(|j| *j != i);
        let product: f64 = others.map(|j| four[i].0 - four[j].0).product();
        1.0 / product
    };
    let weights: Vec<f64> = (0..four.len()).map(weight).collect();
    let off: f64 = weights.iter().zip(four).map(|(w, (_, y))| w * y).sum();
    let variance: f64 = weights.iter().map(|w| w * w).sum();
    Some(off.abs() / variance.sqrt()).filter(|x| x.is_finite())
}

/// The torque up to which a reading may be of a slack actuator where the rigid leg would push, N.m: a share of the largest, or what the readings show
/// where it would push by more than that.
fn of_slack_nm(readings: &[Reading], share: f64) -> f64 {
    let is_slack = |r: &&Reading| r.joint.pushed_nm(&r.at).is_some_and(|push| push > share);
    let slack = readings.iter().filter(is_slack);
    let sizes: Vec<f64> = slack.map(|r| r.torque_nm.abs()).collect();
    if sizes.len() < FEWEST {
        return share;
    }
    share.max(settings::SLACK_DEVIATIONS * sd_by_median(&sizes))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::build::Build;
    use crate::diagnose::operator::{At, Joint};
    use crate::point::ByHand;
    use pipeline_config::FitOptions;
    use pipeline_diagnose::base::Base;
    use pipeline_diagnose::slack::Side;
    use pipeline_mechanics::knee::{Setup, choice::named};
    use std::collections::BTreeMap;

    pub(in crate::diagnose) fn extensor() -> Build {
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

    /// Of a joint whose largest torque is 4 N.m.
    fn torques(slack: f64) -> Torques {
        Torques {
            largest: 4.0,
            near: 0.12,
            slack,
        }
    }

    pub(in crate::diagnose) fn at(degrees: f64) -> At {
        At::still(degrees.to_radians(), 610.0)
    }

    pub(in crate::diagnose) fn reading<'a>(
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
            assert_eq!(joint.side(&at(-5.0), torque, &torques(0.1)), Side::Slack);
        }
        for torque in [0.51 * push, -0.51 * push] {
            assert_eq!(joint.side(&at(-5.0), torque, &torques(0.1)), Side::Pulls);
        }
        // Where it pulls, nothing is slack.
        assert_eq!(joint.pushed_nm(&at(-90.0)), None);
        assert_eq!(joint.side(&at(-90.0), 0.5, &torques(1.0)), Side::Pulls);
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
            of_slack_nm(&readings, 0.4)
        };
        // Two tell nothing of the noise; three with a median of 0.2 N.m do.
        assert_eq!(slack(&[0.2, -0.2]), 0.4);
        let three = slack(&[0.2, -0.2, 0.1]);
        assert!((three - 3.0 * 0.2 / 0.674_489_750_196_082).abs() < 1e-12);
        // Quiet ones leave the share of the largest torque.
        assert_eq!(slack(&[0.01, -0.01, 0.01]), 0.4);
        let corner = joint.pushed_nm(&at(-28.0)).unwrap();
        assert!(corner < 0.4, "{corner}");
        assert_eq!(joint.side(&at(-28.0), 0.6, &torques(0.4)), Side::Pulls);
        assert_ne!(joint.side(&at(-28.0), 0.6, &torques(three)), Side::Pulls);
    }

    #[test]
    fn the_noise_is_what_lies_off_parabolas_through_neighbours() {
        let (build, law) = (extensor(), Base::new(10, false, 1, &FitOptions::default()));
        let joint = Joint::new(&build, &law);
        let none = BTreeMap::new();
        let of = |points: &[(f64, f64)], sense: &dyn Fn(usize) -> f64| -> f64 {
            let readings = points.iter().enumerate().map(|(k, (degrees, torque))| {
                let mut reading = reading(joint, *degrees, *torque, &none);
                reading.at.sense = sense(k);
                reading
            });
            noise_nm(&readings.collect::<Vec<_>>())
        };
        let still = |_: usize| 0.0;
        // In any order, at uneven steps.
        let bent = [-40.0, -90.0, -60.0, -80.0, -75.0, -50.0];
        let bent = bent.map(|x: f64| (x, 2.0 + 0.1 * x + 0.003 * x * x));
        assert!(of(&bent, &still) < 1e-9);
        // Differences with the weights -1, 3, -3, 1 are 1.2, their variance is 20.
        let saw = [
            (-80.0, 0.0),
            (-70.0, 0.3),
            (-60.0, 0.0),
            (-50.0, 0.3),
            (-40.0, 0.0),
            (-30.0, 0.3),
        ];
        let expected = 1.2 / 20_f64.sqrt() / 0.674_489_750_196_082;
        assert!((of(&saw, &still) - expected).abs() < 1e-12);
        // Friction, which makes the saw, is no noise.
        let turning = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let long = |n: usize| -> Vec<(f64, f64)> {
            let angle = |k: usize| -100.0 + 10.0 * k as f64;
            (0..n).map(|k| (angle(k), 0.3 * (k % 2) as f64)).collect()
        };
        assert!(of(&long(10), &turning) < 1e-12);
        // Two of three that are needed.
        assert_eq!(of(&saw[..5], &still), 0.0);
    }

    #[test]
    fn a_torque_within_the_noise_is_no_pull() {
        let (build, law) = (extensor(), Base::new(10, false, 1, &FitOptions::default()));
        let joint = Joint::new(&build, &law);
        let none = BTreeMap::new();
        // The rigid leg pulls at all of these; an offset of the length may have made it slack.
        let saw = |height: f64| -> Vec<Reading> {
            let torque = |k: usize| if k == 0 { 4.0 } else { height * (k % 2) as f64 };
            let angle = |k: usize| -100.0 + 5.0 * k as f64;
            let all = (0..12).map(|k| reading(joint, angle(k), torque(k), &none));
            all.collect()
        };
        let near = |height: f64| Torques::of(&saw(height)).near;
        let off = |height: f64| 4.0 * height / 20_f64.sqrt() / 0.674_489_750_196_082;
        // Three deviations, no less than 3% and no more than 10% of the largest.
        assert_eq!(near(0.0), 0.03 * 4.0);
        assert!((near(0.1) - 3.0 * off(0.1)).abs() < 1e-12);
        assert_eq!(near(0.4), 0.1 * 4.0);
        let torques = Torques::of(&saw(0.1));
        let side = |torque: f64| joint.side(&at(-70.0), torque, &torques);
        assert_eq!(side(0.99 * torques.near), Side::Corner);
        assert_eq!(side(1.01 * torques.near), Side::Pulls);
    }
}
