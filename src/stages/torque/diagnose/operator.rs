//! The forward model with the joint's effects: torque, length and arm of a reading, with exact derivatives by every size.
//!
//! At an angle the force balances everything that yields to it (theorem of implicit functions, [`pipeline_mechanics::knee::series`]):
//! F = g A(P - p, l_m), l_m = L_MT(theta, F) - 2 l_fit - l_tendon - d - C F - s F/(F + 100 N) - dl, with attachments that are elsewhere than drawn
//! and that their brackets let go, and M = r(theta, F) F (1 - c (|theta| - theta_0)+) (1 -+ mu s) + z - f s, with s the sense in which the joint turned
//! before the reading. The arm is that of the moved attachments; a tape measure sees l_m and r.
//!
//! On which side of the corner to slackness a reading is, is decided once ([`Joint::side`], [`pipeline_diagnose::slack`]): the law is then
//! smooth in every size.

use super::sides::Torques;
use super::terms::{KINKS_FROM_RAD, LAW_COEFFICIENTS, SIZES, place};
use crate::build::Build;
use pipeline_diagnose::base::Base;
use pipeline_diagnose::slack::{self, Shape, Side, Sided};
use pipeline_effects::{Actuator, Conditions, JointNeed};
use pipeline_mechanics::knee::{Bracket, Leg, Point, Series, data, route::Place};
use pipeline_numerics::real::Real;

/// Radius of the arc on which an actuator lies in front of the knee, m (the laboratory's file of the pinned knee).
const WRAP_RADIUS_M: f64 = 0.03;

/// What a leg has for the effects beside its geometry.
#[derive(Clone, Copy)]
pub struct Joint<'a> {
    build: &'a Build,
    leg: Leg<'a>,
    law: &'a Base,
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
}

impl At {
    /// At an angle in rad and a gauge pressure in kPa, and nothing known of how the joint came there.
    pub fn still(angle_rad: f64, pressure_kpa: f64) -> Self {
        Self {
            angle_rad,
            pressure_kpa,
            sense: 0.0,
        }
    }
}

impl<'a> Joint<'a> {
    /// The joint of a build, under a law of force.
    pub fn new(build: &'a Build, law: &'a Base) -> Self {
        let leg = build.leg();
        let via = leg.route.points.len() > 2;
        let on_femur =
            |p: &&pipeline_mechanics::knee::route::RoutePoint| matches!(p.place, Place::Femur(_));
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

    /// What it is built of.
    pub fn build(&self) -> &'a Build {
        self.build
    }

    /// Its law of force.
    pub fn law(&self) -> &'a Base {
        self.law
    }

    /// Whether it has a part of a joint that an effect needs. In which sense it turned is of its readings.
    pub fn has(&self, part: JointNeed) -> bool {
        match part {
            JointNeed::OriginBracket => self.feet[0].is_some(),
            JointNeed::InsertionBracket => self.feet[1].is_some(),
            JointNeed::Contact => self.wraps_below.is_some(),
            JointNeed::BothSenses => true,
        }
    }

    /// The torque by which the rigid leg would push at a reading, N.m; none where it pulls.
    pub fn pushed_nm(&self, at: &At) -> Option<f64> {
        let rigid = self.shown(at, Side::Pulls, &[0.0; SIZES]);
        rigid.filter(|s| s.force < 0.0).map(|s| s.torque.abs())
    }

    /// On which side of the corner to slackness a reading of `torque_nm` is. Where the rigid leg would not pull, a torque is noise and zero of the
    /// sensor, unless it is larger than that of slack actuators and nearer to what the law would push, which is no share of the largest torque: that
    /// may be one at half of the contraction.
    pub fn side(&self, at: &At, torque_nm: f64, torques: &Torques) -> Side {
        let setup = &self.build.setup;
        let length = self
            .leg
            .length(at.angle_rad)
            .map_or(f64::NAN, |l| setup.actuator_length(l));
        let pushed = self.pushed_nm(at);
        let is_slack =
            pushed.is_some_and(|pushed| torque_nm.abs() < torques.slack.max(pushed / 2.0));
        let torque_nm = if is_slack { 0.0 } else { torque_nm };
        let at = self.conditions(at, length);
        slack::side(
            torque_nm,
            torques.near / torques.largest,
            torques.largest,
            &at,
            &Shape::usual(at.diameter_mm as u32),
        )
    }

    fn conditions(&self, at: &At, length_m: f64) -> Conditions {
        let setup = &self.build.setup;
        let mut conditions = Conditions::at(
            setup.rest_length_m,
            setup.contracted_length_m,
            length_m,
            at.pressure_kpa,
        );
        conditions.diameter_mm = setup.diameter_mm;
        conditions
    }

    /// What a leg with effects of these sizes shows at a reading, on a fixed side of the corner to slackness; none where there is no answer.
    pub fn shown<R: Real>(&self, at: &At, side: Side, sizes: &[R; SIZES]) -> Option<Shown<R>> {
        let absent = |term: usize| sizes[term].is_constant() && sizes[term].value() == 0.0;
        let none = R::constant(0.0);
        let bracket = |end: usize, term: usize| {
            let bends = sizes[term] * 1e-6;
            let foot = self.feet[end].filter(|_| !absent(term))?;
            let compliance = [none, bends, bends];
            Some(Bracket { foot, compliance })
        };
        let shift = |first: usize| [sizes[first] * 1e-3, sizes[first + 1] * 1e-3, none];
        let series = Series {
            axial: sizes[place::AXIAL] * 1e-6,
            loose: sizes[place::LOOSE] * 1e-3,
            origin: bracket(0, place::ORIGIN),
            insertion: bracket(1, place::INSERTION),
            shifted: [place::ORIGIN_SHIFT, place::INSERTION_SHIFT].map(shift),
        };
        let values = sizes.map(Real::value);
        let law = Sided {
            base: self.law,
            side,
        };
        let balance = self.leg.balanced(
            &series,
            at.angle_rad,
            |free| self.pull(&law, at, &values.map(Real::constant), free),
            |free| self.pull(&law, at, sizes, free),
        );
        let balance = balance.ok().flatten()?;
        let beyond = |from: f64| (at.angle_rad.abs() - from).max(0.0);
        let kinked = (0..2).fold(R::constant(1.0), |left, k| {
            left - sizes[place::KINKING + k] * beyond(KINKS_FROM_RAD[k])
        });
        let sensor = sizes[place::ZERO] - sizes[place::FRICTION] * at.sense;
        let pulled = balance.torque * kinked;
        let rubs = sizes[place::LOADED_FRICTION] * (at.sense * pulled.value().signum());
        let taken = self.taken_m();
        Some(Shown {
            torque: pulled - pulled * rubs + sensor,
            sensor,
            force: balance.force,
            length: balance.actuator_length - taken - sizes[place::LENGTH] * 1e-3,
            arm: balance.arm,
        })
    }

    /// What is seen at a reading: with an actuator that would push slack, so that nothing yields; none where there is no answer.
    pub fn seen(&self, at: &At, sizes: &[f64; SIZES]) -> Option<Shown<f64>> {
        let pulls = self.shown(at, Side::Pulls, sizes)?;
        if pulls.force < 0.0 {
            return self.shown(at, Side::Slack, sizes);
        }
        Some(pulls)
    }

    /// What fittings and tendon take of the path, m.
    fn taken_m(&self) -> f64 {
        2.0 * self.build.setup.fitting_m + self.build.setup.tendon_m
    }

    /// The force at a length in m that path and series leave for actuator, fittings and tendon.
    fn pull<R: Real>(&self, law: &Sided, at: &At, sizes: &[R; SIZES], free: R) -> R {
        let setup = &self.build.setup;
        let mut length = free - self.taken_m() - sizes[place::LENGTH] * 1e-3;
        if let Some(wraps_below) = self.wraps_below {
            let on_knee = WRAP_RADIUS_M * (wraps_below - at.angle_rad).max(0.0);
            let stroke = setup.rest_length_m - setup.contracted_length_m;
            let slack = (length - setup.contracted_length_m) / stroke;
            length = length - sizes[place::WRAPPING] * on_knee * slack * slack;
        }
        let pressure = -sizes[place::PRESSURE] - sizes[place::THRESHOLD] + at.pressure_kpa;
        let coefficients: Vec<R> = self
            .law
            .coefficients
            .iter()
            .map(
                |c| match LAW_COEFFICIENTS.iter().position(|n| *n == c.name) {
                    Some(k) => (sizes[place::LAW + k] + 1.0) * c.start,
                    None => R::constant(c.start),
                },
            )
            .collect();
        let conditions = self.conditions(at, length.value());
        let pulled = law.force(&coefficients, pressure.positive_part(), length, &conditions);
        pulled * (sizes[place::GAIN] + 1.0)
    }
}

/// What is seen of a leg in balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown<R> {
    /// Torque, N.m.
    pub torque: R,
    /// The part of it that is there without a force, N.m.
    pub sensor: R,
    /// Force, N.
    pub force: R,
    /// Length of the actuator, m.
    pub length: R,
    /// Moment arm, m.
    pub arm: R,
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
