//! The loop on torque, tried on joints that are simulated from scratch: nothing in them, each effect of the joint, attachments elsewhere than drawn;
//! with and without lengths and arms taken by hand.
//!
//! ```text
//! cargo run --release --example torque_loop -- 10 1        # joints a case, first seed
//! ```
//! Every joint has mountings, strengths, zeros, and a smooth misfit of the law; effects are 4 times the program's own detection limit in that
//! design. Success is the exact set: what was put in, or a class that holds it, and nothing else that has one value.

use pipeline::base::random::Stream;
use pipeline::config::{DiagnoseOptions, FitOptions};
use pipeline::findings::CampaignFindings;
use pipeline::knee::{Setup, choice::named};
use pipeline::stages::diagnose::base::Base;
use pipeline::stages::torque::build::Build;
use pipeline::stages::torque::curve::Curve;
use pipeline::stages::torque::diagnose::diagnose;
use pipeline::stages::torque::diagnose::operator::{At, Joint};
use pipeline::stages::torque::diagnose::terms::{ALL, SIZES, place};
use pipeline::stages::torque::errors::Hand;
use pipeline::stages::torque::point::{ByHand, Expected, Point};
use pipeline::stages::torque::reference::arms::of_leg;
use pipeline::stages::torque::{Configuration, Test};
use std::collections::BTreeMap;

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
fn joint(
    route: &str,
    sizes: &[f64; SIZES],
    by_hand: bool,
    seed: u64,
) -> Vec<(Build, Configuration)> {
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

fn findings(route: &str, sizes: &[f64; SIZES], by_hand: bool, seed: u64) -> CampaignFindings {
    let found = joint(route, sizes, by_hand, seed);
    let mut joints = diagnose("simulated", true, &found, &DiagnoseOptions::default());
    joints.remove(0).findings
}

/// What was found that has one value: ids and columns.
fn named_in(found: &CampaignFindings) -> Vec<String> {
    let effects = found.effects.iter().map(|e| {
        let sizes: Vec<String> = e
            .parameters
            .iter()
            .map(|p| format!("{:.3} {}", p.value, p.unit))
            .collect();
        format!(
            "{}/{} {} p {:.3}",
            e.id,
            e.form,
            sizes.join(", "),
            e.p_familywise
        )
    });
    let columns = found
        .unexplained
        .iter()
        .map(|u| format!("column {}", u.column));
    effects.chain(columns).collect()
}

fn is_exact(found: &CampaignFindings, id: &str) -> bool {
    let [effect] = &found.effects[..] else {
        return false;
    };
    found.unexplained.is_empty() && effect.class.iter().any(|c| c == id)
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut number = |otherwise: u64| {
        arguments
            .next()
            .and_then(|a| a.parse().ok())
            .unwrap_or(otherwise)
    };
    let (count, first) = (number(10), number(1));
    let only = std::env::args().nth(3);
    for route in ["flexor", "extensor"] {
        for by_hand in [true, false] {
            let seeds = || first..first + count;
            let nulls: Vec<CampaignFindings> = seeds()
                .map(|s| findings(route, &[0.0; SIZES], by_hand, s))
                .collect();
            let clean = nulls.iter().filter(|f| named_in(f).is_empty()).count();
            let mistakes: usize = nulls.iter().map(|f| f.recording_errors.len()).sum();
            println!(
                "{route:9} by hand {by_hand:5} nothing {clean}/{count}, {mistakes} recording errors"
            );
            for f in nulls.iter().filter(|f| !named_in(f).is_empty()) {
                println!("    {:?}", named_in(f));
            }
            for form in &ALL {
                if only
                    .as_deref()
                    .is_some_and(|o| o == "null" || (o != "all" && o != form.id))
                {
                    continue;
                }
                let (mut exact, mut with, mut tried, mut limits) = (0, 0, 0, Vec::new());
                let mut others = Vec::new();
                for (seed, null) in seeds().zip(&nulls) {
                    let limit = null
                        .detection_limits
                        .iter()
                        .find(|l| l.id == form.id && l.form == form.form);
                    let Some(limit) = limit else { continue };
                    let size = 4.0 * limit.smallest;
                    if size > form.bounds.1 {
                        continue;
                    }
                    tried += 1;
                    limits.push(limit.smallest);
                    let mut sizes = [0.0; SIZES];
                    sizes[form.first] = size;
                    let f = findings(route, &sizes, by_hand, 1000 + seed);
                    exact += usize::from(is_exact(&f, form.id));
                    with += usize::from(
                        f.effects
                            .iter()
                            .any(|e| e.class.iter().any(|c| c == form.id)),
                    );
                    if !is_exact(&f, form.id) {
                        others.push(named_in(&f));
                    }
                }
                let mean = limits.iter().sum::<f64>() / limits.len().max(1) as f64;
                println!(
                    "    {}/{} limit {mean:.3} {}: exact {exact}, with others {with} of {tried}",
                    form.id, form.form, form.unit
                );
                for o in others {
                    println!("        {o:?}");
                }
            }
        }
    }
}
