//! Design: the shortest muscle of a diameter that meets a curve of force or torque at one pressure.
//!
//! A muscle meets a point where the lower end of its interval does (`Surety::Interval`), or the law itself (`Surety::Law`, and where there is no
//! interval). A stretched muscle counts with the force at the smallest contraction measured. Lengths are tried from the shortest to the longest one measured, in steps of a millimetre: about a joint a longer muscle can be the
//! weaker one, so that no bisection would do.

use crate::answer::Predictor;
use crate::law::{Choice, Fitted, Law};
use crate::muscle::{Contraction, FreeLength, Muscle};
use pipeline_base::error::{Error, Result};
use pipeline_mechanics::knee::{Leg, Setup};
use serde::Serialize;

/// Step between lengths, m.
const STEP_M: f64 = 1e-3;

/// A point of a curve that is to be met.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Point {
    /// The abscissa: eps, shortening from the resting length in m, or the angle in degrees.
    pub at: f64,
    /// Force in N, or torque in N.m with its sign.
    pub needed: f64,
}

/// What a curve is of.
#[derive(Clone, Copy)]
pub enum Curve<'a> {
    /// Force against eps.
    Contraction,
    /// Force against the shortening from the resting length, m.
    Travel,
    /// Torque against the angle of a joint.
    Angle(Joint<'a>),
}

/// Where a muscle is built in.
#[derive(Clone, Copy)]
pub struct Joint<'a> {
    /// Joint and route.
    pub leg: Leg<'a>,
    /// l_fit, m.
    pub fitting_m: f64,
    /// l_tendon, m.
    pub tendon_m: f64,
}

/// What has to meet the curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Surety {
    /// The lower end of the 95% interval for a muscle that was not measured.
    Interval,
    /// The law: half of the muscles.
    Law,
}

/// How a curve is to be met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms {
    /// Gauge pressure, kPa.
    pub pressure_kpa: f64,
    /// By what.
    pub surety: Surety,
    /// Standard deviation of the length, m; none as lengths are set on the rig. Of no effect under a law without an interval.
    pub length_sd_m: Option<f64>,
}

/// A muscle at a point of the curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AtPoint {
    /// The point.
    pub point: Point,
    /// Length of the muscle, m.
    pub length_m: f64,
    /// Force or torque of the law, with its sign.
    pub available: f64,
    /// Lower end of its interval.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// What a user has to know.
    pub warnings: Vec<String>,
}

impl AtPoint {
    /// What counts in the direction that is needed, less what is needed.
    pub fn margin(&self, surety: Surety) -> f64 {
        let end = if self.direction() < 0.0 {
            self.high
        } else {
            self.low
        };
        let counts = match surety {
            Surety::Interval => end.unwrap_or(self.available),
            Surety::Law => self.available,
        };
        self.direction() * counts - self.point.needed.abs()
    }

    /// Whether the muscle turns the joint the other way, or not at all.
    pub fn is_opposite(&self) -> bool {
        self.direction() * self.available <= 0.0
    }

    fn direction(&self) -> f64 {
        if self.point.needed < 0.0 { -1.0 } else { 1.0 }
    }
}

/// A muscle of one diameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Design {
    /// Nominal diameter, mm.
    pub diameter_mm: u32,
    /// l_rest, m.
    pub rest_length_m: f64,
    /// eps_620 that was assumed.
    pub contraction_620: Option<f64>,
    /// The model, for people.
    pub model: String,
    /// Whether it meets the curve.
    pub meets: bool,
    /// The smallest margin over the points, N or N.m.
    pub margin: f64,
    /// The point with the smallest margin.
    pub tightest: Point,
    /// The points.
    pub points: Vec<AtPoint>,
}

/// The shortest muscle under a fit that meets a curve; where none does, the one that falls least short.
///
/// # Errors
/// A law without measured lengths; a curve without points; what [`Predictor::at`] and [`Predictor::with_length_sd`] object to.
pub fn shortest(
    choice: &Choice,
    contraction_620: Option<f64>,
    curve: Curve,
    points: &[Point],
    terms: &Terms,
) -> Result<Design> {
    let Law::Fitted(Fitted { fit, .. }) = choice.law else {
        return Err(Error::Usage(
            "a design takes a fit, whose measured lengths bound it: `pipeline run` makes fits"
                .to_owned(),
        ));
    };
    let free = contraction_620.map_or(FreeLength::Unknown, FreeLength::Contraction);
    let (shortest, longest) = fit.ranges.rest_length_m;
    let steps = ((longest - shortest) / STEP_M + 1e-9).floor() as usize;
    let lengths = (0..=steps).map(|k| shortest + k as f64 * STEP_M);
    let mut best: Option<Design> = None;
    for rest_length_m in lengths {
        let muscle = Muscle::new(f64::from(fit.group.diameter_mm), rest_length_m, free)?;
        let mut predictor = Predictor::new(choice.clone(), muscle)?;
        if let Some(sd_m) = terms.length_sd_m.filter(|_| predictor.mixed.is_some()) {
            predictor = predictor.with_length_sd(sd_m)?;
        }
        let found = design(&predictor, curve, points, terms)?;
        if found.meets {
            return Ok(found);
        }
        if best.as_ref().is_none_or(|b| found.margin > b.margin) {
            best = Some(found);
        }
    }
    best.ok_or_else(|| Error::Usage("no length of this diameter was measured".to_owned()))
}

/// One muscle against the curve.
///
/// # Errors
/// A curve without points; what [`Predictor::at`] objects to.
pub fn design(
    predictor: &Predictor,
    curve: Curve,
    points: &[Point],
    terms: &Terms,
) -> Result<Design> {
    let Terms {
        pressure_kpa,
        surety,
        ..
    } = *terms;
    let found = points
        .iter()
        .map(|p| at_point(predictor, curve, *p, pressure_kpa));
    let found: Vec<AtPoint> = found.collect::<Result<_>>()?;
    let by_margin = |a: &&AtPoint, b: &&AtPoint| a.margin(surety).total_cmp(&b.margin(surety));
    let tightest = found
        .iter()
        .min_by(by_margin)
        .ok_or_else(|| Error::Usage("the curve has no points".to_owned()))?;
    let margin = tightest.margin(surety);
    Ok(Design {
        diameter_mm: predictor.muscle.diameter_mm,
        rest_length_m: predictor.muscle.rest_length_m,
        contraction_620: predictor.muscle.contraction_620,
        model: predictor.choice.law.title(),
        meets: margin >= 0.0,
        margin,
        tightest: tightest.point,
        points: found,
    })
}

fn at_point(
    predictor: &Predictor,
    curve: Curve,
    point: Point,
    pressure_kpa: f64,
) -> Result<AtPoint> {
    let rest = predictor.muscle.rest_length_m;
    let (length_m, arm) = match curve {
        Curve::Contraction => (rest * (1.0 - point.at), 1.0),
        Curve::Travel => (rest - point.at, 1.0),
        Curve::Angle(joint) => joint.place(predictor, point)?,
    };
    let mut found = AtPoint {
        point,
        length_m,
        available: 0.0,
        low: None,
        high: None,
        warnings: Vec::new(),
    };
    let contraction = (rest - length_m) / rest;
    if let Some(why) = crate::torque::impossible(contraction) {
        found.warnings.push(why);
        return Ok(found);
    }
    // Stretched beyond what was measured every law grows without bound, and no muscle is to be chosen for that.
    let edge = edge(predictor);
    if contraction < edge {
        found.warnings.push(format!(
            "the muscle is stretched beyond what was measured: it counts with the force at a contraction of {:.1}%",
            100.0 * edge
        ));
    }
    let answer = predictor.at(Contraction::Fraction(contraction.max(edge)), pressure_kpa)?;
    let turned = |force: f64| arm * force;
    found.available = answer.force_n.map_or(0.0, turned);
    let ends = answer.interval.map(|i| (turned(i.low_n), turned(i.high_n)));
    found.low = ends.map(|(a, b)| a.min(b));
    found.high = ends.map(|(a, b)| a.max(b));
    found.warnings.extend(answer.remarks().cloned());
    Ok(found)
}

/// The smallest contraction that was measured of muscles like this one.
fn edge(predictor: &Predictor) -> f64 {
    match (predictor.choice.law, predictor.muscle.contraction_620) {
        (Law::Fitted(f), Some(free)) => f.fit.ranges.contraction_rel.0 * free,
        _ => 0.0,
    }
}

impl Joint<'_> {
    /// Length of the muscle, m, and arm, m, with the sign of its torque.
    fn place(&self, predictor: &Predictor, point: Point) -> Result<(f64, f64)> {
        let (low, high) = self.leg.joint.range;
        let angle = point.at.to_radians();
        const ROUNDING: f64 = 1e-6;
        if angle < low - ROUNDING || angle > high + ROUNDING {
            return Err(Error::Usage(format!(
                "the curve asks for {} degrees, and the joint goes from {:.1} to {:.1} degrees (flexion is negative)",
                point.at,
                low.to_degrees(),
                high.to_degrees()
            )));
        }
        let geometry = self.leg.geometry(angle.clamp(low, high)).map_err(|e| {
            Error::Usage(format!(
                "the leg has no geometry at {} degrees: {e}",
                point.at
            ))
        })?;
        let setup = Setup {
            diameter_mm: f64::from(predictor.muscle.diameter_mm),
            rest_length_m: predictor.muscle.rest_length_m,
            contracted_length_m: f64::NAN,
            fitting_m: self.fitting_m,
            tendon_m: self.tendon_m,
        };
        Ok((setup.actuator_length(geometry.length_m), geometry.arm_m))
    }
}
