//! Both methods for the moment arm, along every shipped route: r = -dL/dtheta (Eq. 2) and the projection (Eq. 3).
//!
//! [`pipeline_mechanics::knee::path`] derives where the two part: by the share of the segment that lies in the plane, by the centre about which the
//! projection is taken, by an insertion that moves on the tibia, and at switches.

use super::largest;
use crate::curve::angles;
use pipeline_mechanics::knee::route::Place;
use pipeline_mechanics::knee::{Geometry, Leg, Switch, shipped};
use serde::{Deserialize, Serialize};

/// Steps over the range of a joint.
const STEPS: u32 = 200;
/// Arms that differ by less are the same, m: a hundredth of what a tape measure tells.
const SAME_M: f64 = 1e-5;

/// One route.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Arms {
    /// Name of the knee.
    pub knee: String,
    /// Name of the route.
    pub route: String,
    /// Angles, rad.
    pub angles_rad: Vec<f64>,
    /// r by Eq. 2, m.
    pub arm_m: Vec<f64>,
    /// r by Eq. 3 about the instantaneous centre, m.
    pub projected_m: Vec<f64>,
    /// r by Eq. 3 about the origin of the tibia's frame, m.
    pub about_origin_m: Vec<f64>,
    /// Largest difference of Eq. 3 from Eq. 2, m, and its angle, degrees.
    pub apart: (f64, f64),
    /// The same after Eq. 3 was multiplied with the share of the force in the plane.
    pub apart_in_plane: (f64, f64),
    /// The same about the origin of the tibia's frame.
    pub apart_about_origin: (f64, f64),
    /// Why the two part.
    pub why: String,
    /// Where points begin or cease to take part.
    pub switches: Vec<At>,
    /// The route in the femur's frame at three angles: the angle in degrees, points as x and y in m.
    pub drawn: Vec<(f64, Vec<(f64, f64)>)>,
    /// Where the tibia's frame stands at these angles: origin, and a point 0.15 m down the tibia, m.
    pub tibia: Vec<[(f64, f64); 2]>,
}

/// A switch of the route.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct At {
    /// The angle, rad.
    pub angle_rad: f64,
    /// Length just above the angle less that just below it, m.
    pub length_jump_m: f64,
    /// Arm just above the angle less that just below it, m.
    pub arm_jump_m: f64,
}

impl From<Switch> for At {
    fn from(s: Switch) -> Self {
        Self {
            angle_rad: s.angle,
            length_jump_m: s.length_jump_m,
            arm_jump_m: s.arm_jump_m,
        }
    }
}

/// The routes of all shipped knees.
pub fn arms() -> Vec<Arms> {
    let knees = shipped().unwrap_or_default();
    let legs = knees.iter().flat_map(|knee| {
        let routes = knee.routes.iter();
        routes.filter_map(|r| Some((knee.name.as_str(), knee.leg(&r.name)?)))
    });
    legs.map(|(knee, leg)| of_leg(knee, &leg)).collect()
}

/// Both methods along one leg.
pub fn of_leg(knee: &str, leg: &Leg) -> Arms {
    let all: Vec<(f64, Geometry)> = angles(leg.joint.range, STEPS)
        .into_iter()
        .filter_map(|a| Some((a, leg.geometry(a).ok()?)))
        .collect();
    let apart =
        |of: &dyn Fn(&Geometry) -> f64| largest(all.iter().map(|(a, g)| (*a, of(g) - g.arm_m)));
    let in_plane = apart(&|g| g.about_centre.arm_m * g.about_centre.in_plane);
    let column = |of: &dyn Fn(&Geometry) -> f64| all.iter().map(|(_, g)| of(g)).collect();
    let whole = apart(&|g| g.about_centre.arm_m);
    let drawn = shown(leg);
    Arms {
        knee: knee.to_owned(),
        route: leg.route.name.clone(),
        angles_rad: all.iter().map(|(a, _)| *a).collect(),
        arm_m: column(&|g| g.arm_m),
        projected_m: column(&|g| g.about_centre.arm_m),
        about_origin_m: column(&|g| g.about_origin.arm_m),
        apart: whole,
        apart_in_plane: in_plane,
        apart_about_origin: apart(&|g| g.about_origin.arm_m * g.about_origin.in_plane),
        why: why(leg, whole.0, in_plane.0),
        switches: leg
            .switches()
            .unwrap_or_default()
            .into_iter()
            .map(At::from)
            .collect(),
        tibia: drawn
            .iter()
            .filter_map(|(degrees, _)| tibia(leg, degrees.to_radians()))
            .collect(),
        drawn,
    }
}

/// Why the two methods part, in words.
fn why(leg: &Leg, apart_m: f64, in_plane_m: f64) -> String {
    let on_patella =
        |p: &pipeline_mechanics::knee::route::RoutePoint| matches!(p.place, Place::Patella(_));
    let words = if leg.route.points.iter().any(on_patella) {
        "the insertion moves on the tibia with the patella, and the projection holds it still"
    } else if apart_m < SAME_M {
        "they agree"
    } else if in_plane_m < SAME_M {
        "the segment leaves the plane, and the projection divides by its projected length"
    } else if in_plane_m < 10.0 * SAME_M {
        "the segment leaves the plane; what is left is the rounding of the tabulated centre"
    } else {
        "the tabulated centre is not quite that about which the tibia turns"
    };
    words.to_owned()
}

/// The route at the ends of the joint's range and with the leg half bent.
fn shown(leg: &Leg) -> Vec<(f64, Vec<(f64, f64)>)> {
    let (low, high) = leg.joint.range;
    let at = [high.min(0.0), 0.5 * (low + high), low];
    let points = |angle: f64| {
        let points = leg.points(angle).ok()?;
        let flat = points.iter().map(|p| (p[0], p[1])).collect();
        Some((angle.to_degrees(), flat))
    };
    at.into_iter().filter_map(points).collect()
}

/// The tibia's origin and a point 0.15 m below it along its axis.
fn tibia(leg: &Leg, angle: f64) -> Option<[(f64, f64); 2]> {
    let pose = leg.joint.pose(angle).ok()?;
    let at = |y: f64| {
        let [x, y, _] = pose.place([0.0, y, 0.0]);
        (x, y)
    };
    Some([at(0.0), at(-0.15)])
}
