//! Joints that are simulated from scratch: four actuators, each mounted two or three times, with what effects they are given.

use pipeline::base::random::Stream;
use pipeline::config::FitOptions;
use pipeline::knee::{Setup, choice::named};
use pipeline::stages::diagnose::base::Base;
use pipeline::stages::torque::build::Build;
use pipeline::stages::torque::curve::Curve;
use pipeline::stages::torque::diagnose::operator::{At, Joint};
use pipeline::stages::torque::diagnose::terms::{SIZES, place};
use pipeline::stages::torque::errors::Hand;
use pipeline::stages::torque::point::{ByHand, Expected, Point};
use pipeline::stages::torque::reference::arms::of_leg;
use pipeline::stages::torque::{Configuration, Test};
use std::collections::BTreeMap;

/// A route over the pinned knee, and whether lengths and arms were taken by hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Kind {
    /// `flexor` or `extensor`.
    pub route: &'static str,
    /// Whether every row has a length and an arm taken by hand.
    pub by_hand: bool,
}

/// Every kind.
pub const KINDS: [Kind; 4] = [
    Kind {
        route: "flexor",
        by_hand: true,
    },
    Kind {
        route: "flexor",
        by_hand: false,
    },
    Kind {
        route: "extensor",
        by_hand: true,
    },
    Kind {
        route: "extensor",
        by_hand: false,
    },
];

/// Scatter of the simulated joints: mounting (mm), strength, zero (N.m), misfits, noise (N.m), noise and bias of lengths and arms (mm).
const MOUNTING: f64 = 1.5;
const STRENGTH: f64 = 0.04;
const ZERO: f64 = 0.1;
const COMMON: f64 = 0.02;
const OWN: f64 = 0.015;
const NOISE: f64 = 0.25;
const LENGTH: [f64; 2] = [4.0, 2.0];
const ARM: [f64; 2] = [5.0, 2.0];

/// Resting and contracted lengths of the actuators, m, and how often each is mounted.
const ACTUATORS: [(f64, f64, usize); 4] = [
    (0.485, 0.398, 3),
    (0.457, 0.375, 2),
    (0.430, 0.353, 2),
    (0.406, 0.338, 2),
];
const ANGLES: usize = 18;

/// A smooth function of about unit size over the range of the angles.
struct Smooth {
    terms: Vec<(f64, f64, f64)>,
}

impl Smooth {
    fn new(stream: &mut Stream) -> Self {
        let term = |k: usize, stream: &mut Stream| {
            (
                0.6 * stream.normal(),
                k as f64 * 0.8,
                std::f64::consts::TAU * stream.uniform(),
            )
        };
        Self {
            terms: (1..4).map(|k| term(k, stream)).collect(),
        }
    }

    fn at(&self, angle: f64) -> f64 {
        self.terms
            .iter()
            .map(|(a, w, phase)| a * libm::cos(w * angle + phase))
            .sum()
    }
}

fn law() -> Base {
    Base::new(10, false, 1, &FitOptions::default())
}

/// A joint with effects of these sizes.
pub fn joint(kind: Kind, sizes: &[f64; SIZES], seed: u64) -> Vec<(Build, Configuration)> {
    let Kind { route, by_hand } = kind;
    let law = law();
    let mut stream = Stream::new(seed, &["torque loop", route]);
    let common = Smooth::new(&mut stream);
    let range = if route == "flexor" {
        (-105.0, -5.0)
    } else {
        (-100.0, 5.0)
    };
    let mut found = Vec::new();
    for (rest, contracted, tests) in ACTUATORS {
        let build = Build {
            knee: named("pinned").expect("a shipped knee"),
            route: route.to_owned(),
            setup: Setup {
                diameter_mm: 10.0,
                rest_length_m: rest,
                contracted_length_m: contracted,
                fitting_m: if route == "flexor" { 0.0352 } else { 0.0254 },
                // As much shorter, so much more tendon: all work in the same range of contraction.
                tendon_m: ACTUATORS[0].0 - rest,
            },
            remarks: Vec::new(),
        };
        let strength = STRENGTH * stream.normal();
        let tests = (0..tests)
            .map(|t| {
                let mut own = *sizes;
                own[place::LENGTH] += MOUNTING * stream.normal();
                own[place::GAIN] = (1.0 + own[place::GAIN]) * (1.0 + strength) - 1.0;
                own[place::ZERO] += ZERO * stream.normal();
                let smooth = Smooth::new(&mut stream);
                let bias = [LENGTH[1] * stream.normal(), ARM[1] * stream.normal()];
                let joint = Joint::new(&build, &law);
                let mut before = f64::NAN;
                let points = (0..ANGLES).filter_map(|row| {
                    let degrees = range.0 + (range.1 - range.0) * stream.uniform();
                    let angle = degrees.to_radians();
                    let sense = if before.is_nan() {
                        0.0
                    } else {
                        (angle - before).signum()
                    };
                    before = angle;
                    let at = At {
                        angle_rad: angle,
                        pressure_kpa: 610.0 + 5.0 * stream.normal(),
                        sense,
                    };
                    let shown = joint.seen(&at, &own)?;
                    let wrong = COMMON * common.at(angle) + OWN * smooth.at(angle);
                    let torque = shown.torque * (1.0 + wrong) + NOISE * stream.normal();
                    let hand = |x: f64, [noise, _]: [f64; 2], bias: f64, stream: &mut Stream| {
                        Some(x + 1e-3 * (bias + noise * stream.normal())).filter(|_| by_hand)
                    };
                    let geometry = build.leg().geometry(angle).ok()?;
                    Some(Point {
                        log: "points.csv".to_owned(),
                        row: row as i64,
                        angle_rad: angle,
                        torque_nm: torque,
                        pressure_kpa: at.pressure_kpa,
                        by_hand: ByHand {
                            length_m: hand(shown.length, LENGTH, bias[0], &mut stream),
                            contraction_rel: None,
                            arm_m: hand(shown.arm, ARM, bias[1], &mut stream),
                            length_sd_m: None,
                            arm_sd_m: None,
                        },
                        extras: BTreeMap::new(),
                        expected: Some(Expected::new(&build, &geometry)),
                        beyond: None,
                        predicted: Vec::new(),
                        back_calculated: Vec::new(),
                    })
                });
                let points = points.collect();
                Test {
                    session: format!("l{:.0}-t{t}", 1e3 * rest),
                    excluded: None,
                    doubtful: None,
                    role: None,
                    notes: None,
                    points,
                    errors: Vec::new(),
                    hand: Hand::default(),
                }
            })
            .collect();
        let configuration = Configuration {
            id: format!("l{:.0}", 1e3 * rest),
            knee: "pinned".to_owned(),
            muscle: route.to_owned(),
            route: route.to_owned(),
            specimen: format!("l{:.0}", 1e3 * rest),
            diameter_mm: 10,
            rest_length_m: rest,
            contracted_length_m: contracted,
            fitting_m: build.setup.fitting_m,
            tendon_m: Some(build.setup.tendon_m),
            remarks: Vec::new(),
            tests,
            curve: Curve::default(),
            arms: of_leg("pinned", &build.leg()),
        };
        found.push((build, configuration));
    }
    found
}
