//! The forward model with the joint's effects: torque of a reading, with exact derivatives by every size.
//!
//! At an angle the force balances everything that yields to it (theorem of implicit functions, [`crate::knee::series`]):
//! F = g A(P - p, l_m), l_m = L_MT(theta, F) - 2 l_fit - l_tendon - d - C F - s F/(F + 100 N) - dl, with attachments that their brackets let go, and
//! M = r(theta, F) F (1 - c (|theta| - theta_0)+) + z - f s, with s the sense in which the joint turned before the reading. The arm is that of
//! the moved attachments.

use super::terms::{KINKS_FROM_RAD, TERMS, place};
use crate::knee::{Bracket, Leg, Point, Series, data, route::Place};
use crate::models::ForceModel;
use crate::numerics::real::Real;
use crate::stages::torque::build::Build;

/// Radius of the arc on which an actuator lies in front of the knee, m (the laboratory's file of the pinned knee).
const WRAP_RADIUS_M: f64 = 0.03;
/// Steps of the length (m) and the pressure (kPa) over which the slopes of a force model are taken.
const STEPS: (f64, f64) = (1e-6, 1e-3);

/// What a leg has for the effects beside its geometry.
#[derive(Clone, Copy)]
pub struct Joint<'a> {
    build: &'a Build,
    leg: Leg<'a>,
    law: &'a dyn ForceModel,
    /// Feet of the brackets at origin and insertion, in the frame of the attachment's body, m.
    feet: [Option<Point<f64>>; 2],
    /// The angle below which the actuator lies on the knee, rad.
    wraps_below: Option<f64>,
}

/// A reading, as the operator needs it.
#[derive(Clone, Copy, Debug)]
pub struct At {
    /// Knee angle, rad.
    pub angle_rad: f64,
    /// Gauge pressure, kPa.
    pub pressure_kpa: f64,
    /// In which sense the joint turned before the reading: 1 in extension, -1 in flexion, 0 where nobody knows.
    pub sense: f64,
    /// Place in the order of its test's readings.
    pub order: f64,
    /// Shuffled column.
    pub placebo: f64,
}

impl At {
    /// At an angle in rad and a gauge pressure in kPa, and nothing known of how the joint came there.
    pub fn still(angle_rad: f64, pressure_kpa: f64) -> Self {
        Self {
            angle_rad,
            pressure_kpa,
            sense: 0.0,
            order: 0.0,
            placebo: 0.0,
        }
    }
}

impl<'a> Joint<'a> {
    /// The joint of a build, under a law of force.
    pub fn new(build: &'a Build, law: &'a dyn ForceModel) -> Self {
        let leg = build.leg();
        let via = leg.route.points.len() > 2;
        let on_femur = |p: &&crate::knee::route::RoutePoint| matches!(p.place, Place::Femur(_));
        let limits = leg.route.points.iter().filter(on_femur).map(|p| p.below);
        let first = limits
            .filter(|b| b.is_finite())
            .fold(f64::NEG_INFINITY, f64::max);
        Self {
            build,
            leg,
            law,
            feet: ["origin", "insertion"].map(|end| foot(build, end)),
            wraps_below: Some(first).filter(|b| via && b.is_finite()),
        }
    }

    /// Whether a term means anything for the joint.
    pub fn has(&self, term: usize) -> bool {
        match term {
            place::ORIGIN => self.feet[0].is_some(),
            place::INSERTION => self.feet[1].is_some(),
            place::WRAPPING => self.wraps_below.is_some(),
            _ => true,
        }
    }

    /// Torque in N.m with effects of these sizes, and the arm in m; NaN where there is no answer.
    pub fn torque<R: Real>(&self, at: &At, sizes: &[R; TERMS]) -> (R, R) {
        let absent = |term: usize| sizes[term].is_constant() && sizes[term].value() == 0.0;
        let none = R::constant(0.0);
        let bracket = |end: usize, term: usize| {
            let bends = sizes[term] * 1e-6;
            let foot = self.feet[end].filter(|_| !absent(term))?;
            let compliance = [none, bends, bends];
            Some(Bracket { foot, compliance })
        };
        let series = Series {
            axial: sizes[place::AXIAL] * 1e-6,
            loose: sizes[place::LOOSE] * 1e-3,
            origin: bracket(0, place::ORIGIN),
            insertion: bracket(1, place::INSERTION),
        };
        let values = sizes.map(Real::value);
        let balance = self.leg.balanced(
            &series,
            at.angle_rad,
            |free| self.pull(at, &values.map(Real::constant), free),
            |free| self.pull(at, sizes, free),
        );
        let Ok(Some(balance)) = balance else {
            return (R::constant(f64::NAN), R::constant(f64::NAN));
        };
        let beyond = |from: f64| (at.angle_rad.abs() - from).max(0.0);
        let kinked = (0..2).fold(R::constant(1.0), |left, k| {
            left - sizes[place::KINKING + k] * beyond(KINKS_FROM_RAD[k])
        });
        let rubs = sizes[place::FRICTION] * at.sense;
        let sensor = sizes[place::ZERO] - rubs + sizes[place::PLACEBO] * at.placebo;
        (balance.torque * kinked + sensor, balance.arm)
    }

    /// The force at a length in m that path and series leave for actuator, fittings and tendon.
    fn pull<R: Real>(&self, at: &At, sizes: &[R; TERMS], free: R) -> R {
        let setup = &self.build.setup;
        let taken = 2.0 * setup.fitting_m + setup.tendon_m;
        let mut length = free - taken - sizes[place::LENGTH] * 1e-3;
        if let Some(wraps_below) = self.wraps_below {
            let on_knee = WRAP_RADIUS_M * (wraps_below - at.angle_rad).max(0.0);
            let stroke = setup.rest_length_m - setup.contracted_length_m;
            let slack = (length - setup.contracted_length_m) / stroke;
            length = length - sizes[place::WRAPPING] * on_knee * slack * slack;
        }
        let pressure = -sizes[place::PRESSURE] + at.pressure_kpa;
        let (l, p) = (length.value(), pressure.value());
        let force = |length_m: f64, pressure_kpa: f64| {
            let state = setup.state(length_m, pressure_kpa.max(0.0));
            self.law.predict(&state).force_n().unwrap_or(f64::NAN)
        };
        let here = force(l, p);
        let slope = |there: f64, step: f64| {
            let slope = (there - here) / step;
            if slope.is_nan() { 0.0 } else { slope }
        };
        let (dl, dp) = STEPS;
        let by_length = match length.is_constant() {
            true => 0.0,
            false => slope(force(l + dl, p), dl),
        };
        let mut pulled = length.chain(here, by_length);
        if !pressure.is_constant() {
            let by_pressure = slope(force(l, p + dp), dp);
            pulled = pulled + pressure.chain(0.0, by_pressure);
        }
        pulled * (sizes[place::GAIN] + 1.0)
    }
}

/// Where the bracket at an end of the route is fixed to the bone, if the laboratory's list of brackets has it.
fn foot(build: &Build, end: &str) -> Option<Point<f64>> {
    let route = match (build.knee.name.as_str(), build.route.as_str()) {
        ("pinned", "flexor" | "flexor_2023") => format!("pinned flexor {end} bracket"),
        ("pinned", "extensor") if end == "origin" => "pinned extensor rib midpoint".to_owned(),
        ("biomimetic", route) if end == "origin" => {
            let (muscle, diameter) = route.split_once('_')?;
            format!("biomimetic {muscle} {}", diameter.replace("mm", " mm"))
        }
        _ => return None,
    };
    let table = data::table("bracket_points.csv").ok()?;
    let row = table
        .text("configuration")
        .ok()?
        .iter()
        .position(|c| *c == route)?;
    let at = |column: &str| Some(table.numbers(column).ok()?[row]);
    Some([at("x_m")?, at("y_m")?, at("z_m")?])
}
