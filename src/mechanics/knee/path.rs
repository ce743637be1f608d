//! A leg is a joint with a route over it: length of the path, and the moment arm by both methods.
//!
//! Sign. The paper's Eq. 2, r = dl/dtheta, is positive where flexion (negative theta) shortens the path, so that M = r F would have flexors
//! extend the knee. Here, as in OpenSim, **r = -dl/dtheta**: negative for a flexor, and M = r F has the sign of the torque.
//!
//! The two methods. By virtual work r = -dl/dtheta is exact for whatever path the points define. Eq. 3 looks at the one segment that runs from
//! femur to tibia, projected on the plane of the motion, and takes the distance from its line to a centre. The two part
//! - by the share of the segment that lies in the plane: Eq. 3 divides by the *projected* segment's length and so leaves out that only a part of
//!   the force acts in the plane. [`Projection::in_plane`] is that share; the product of both is what belongs with the whole force;
//! - where the centre is not the instantaneous one: about a centre that the tibia does not turn about, the arm lacks u . (dp/dtheta), the work on
//!   the moving frame ([`Centre::TibiaOrigin`] in a knee whose tibia translates);
//!   For bifemsh in Gait2392 that is up to 18.5 mm, of an arm of 4 to 34 mm;
//! - where the insertion moves on the tibia (patella): Eq. 3 holds it still, and the vasti come out 8 to 50 mm too long in the arm;
//! - at the angle of a switch, if the point that comes in does not lie on the line that it bends: then the length jumps, dl/dtheta has an impulse
//!   there that no arm on either side shows, and the torque is not that of an elastic path ([`Leg::switches`]).
//!
//! With the free *muscle segment* as first factor, as the text below Eq. 3 has it, the product is zero: it is perpendicular to the second
//! factor. What is meant, and stands here, is the vector from the centre to a point of the segment.

use super::joint::Joint;
use super::route::Route;
use super::{Beyond, Point};
use pipeline_numerics::real::Real;

/// A joint and a route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg<'a> {
    /// The joint.
    pub joint: &'a Joint,
    /// The route over it.
    pub route: &'a Route,
}

/// About what Eq. 3 takes the moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Centre {
    /// The instantaneous centre of rotation ([`Joint::centre`]).
    Instantaneous,
    /// The origin of the tibia's frame (the paper's p_k).
    TibiaOrigin,
}

/// A moment arm by Eq. 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// r by Eq. 3, m, positive in extension: to be multiplied with the force in the plane.
    pub arm_m: f64,
    /// Length of the projected segment over that of the segment: the share of the force that acts in the plane.
    pub in_plane: f64,
}

/// Length and moment arms at an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// L_MT, m.
    pub length_m: f64,
    /// r = -dL_MT/dtheta (Eq. 2), m.
    pub arm_m: f64,
    /// r by Eq. 3 about the instantaneous centre.
    pub about_centre: Projection,
    /// r by Eq. 3 about the origin of the tibia's frame.
    pub about_origin: Projection,
}

/// What happens to a path where a point comes in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switch {
    /// The angle, rad.
    pub angle: f64,
    /// Length just above the angle less that just below it, m.
    pub length_jump_m: f64,
    /// Moment arm just above the angle less that just below it, m.
    pub arm_jump_m: f64,
}

/// The points of a path in the femur's frame, m, and their derivatives with respect to the knee angle, m/rad.
pub(super) struct Path<R> {
    points: Vec<Point<R>>,
    rates: Vec<Point<R>>,
    /// The segment from femur to tibia begins here.
    crossing: usize,
}

/// By how much the ends of a route have given way, m: the origin in the femur's frame, the insertion in the tibia's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Yield<R> {
    pub origin: Point<R>,
    pub insertion: Point<R>,
}

impl<R: Real> Yield<R> {
    pub fn none() -> Self {
        let zero = [R::constant(0.0); 3];
        Self {
            origin: zero,
            insertion: zero,
        }
    }
}

/// Distance from a switch at which its two sides are looked at, rad.
const BESIDE: f64 = 1e-9;

impl Leg<'_> {
    /// Length and moment arms at an angle in rad.
    ///
    /// # Errors
    /// If the angle lies outside the joint's or the patella's range.
    pub fn geometry(&self, angle: f64) -> Result<Geometry, Beyond> {
        let path = self.path(angle, Yield::<f64>::none())?;
        let origin = self.joint.pose(angle)?.origin;
        Ok(Geometry {
            length_m: path.length(),
            arm_m: path.arm(),
            about_centre: path.projection(self.joint.centre(angle)?),
            about_origin: path.projection(origin),
        })
    }

    /// L_MT at an angle in rad, m.
    ///
    /// # Errors
    /// As [`Leg::geometry`].
    pub fn length(&self, angle: f64) -> Result<f64, Beyond> {
        Ok(self.path(angle, Yield::<f64>::none())?.length())
    }

    /// r = -dL_MT/dtheta at an angle in rad, m: positive in extension.
    ///
    /// # Errors
    /// As [`Leg::geometry`].
    pub fn arm(&self, angle: f64) -> Result<f64, Beyond> {
        Ok(self.path(angle, Yield::<f64>::none())?.arm())
    }

    /// The points of the path at an angle in rad, from the origin to the insertion, in the femur's frame, m.
    ///
    /// # Errors
    /// As [`Leg::geometry`].
    pub fn points(&self, angle: f64) -> Result<Vec<Point<f64>>, Beyond> {
        Ok(self.path(angle, Yield::<f64>::none())?.points)
    }

    /// Eq. 3 at an angle in rad.
    ///
    /// # Errors
    /// As [`Leg::geometry`].
    pub fn projection(&self, angle: f64, about: Centre) -> Result<Projection, Beyond> {
        let geometry = self.geometry(angle)?;
        Ok(match about {
            Centre::Instantaneous => geometry.about_centre,
            Centre::TibiaOrigin => geometry.about_origin,
        })
    }

    /// The switches within the joint's range, in order of the angle: a route is fit for use where the lengths do not jump.
    ///
    /// # Errors
    /// As [`Leg::geometry`].
    pub fn switches(&self) -> Result<Vec<Switch>, Beyond> {
        let (low, high) = self.joint.range;
        let inside = |a: &f64| low + BESIDE < *a && *a < high - BESIDE;
        let within = self.route.switches().into_iter().filter(inside);
        within
            .map(|angle| {
                let (above, below) = (
                    self.geometry(angle + BESIDE)?,
                    self.geometry(angle - BESIDE)?,
                );
                Ok(Switch {
                    angle,
                    length_jump_m: above.length_m - below.length_m,
                    arm_jump_m: above.arm_m - below.arm_m,
                })
            })
            .collect()
    }

    /// The path at an angle in rad, its ends moved; `R` carries derivatives with respect to how far.
    pub(super) fn path<R: Real>(&self, angle: f64, moved: Yield<R>) -> Result<Path<R>, Beyond> {
        let (pose, rate) = self.joint.pose_and_rate(angle)?;
        let active = self.route.active(angle)?;
        let last = active.len() - 1;
        let mut path = Path {
            points: Vec::with_capacity(last + 1),
            rates: Vec::with_capacity(last + 1),
            crossing: 0,
        };
        for (k, point) in active.iter().enumerate() {
            let own = match k {
                0 => plus(moved.origin, point.position),
                k if k == last => plus(moved.insertion, point.position),
                _ => point.position.map(R::constant),
            };
            if point.on_femur {
                path.crossing = k;
                path.points.push(own);
                path.rates.push([R::constant(0.0); 3]);
                continue;
            }
            let (c, s) = (pose.cos, pose.sin);
            let [x, y, z] = own;
            let (right, up) = (x * c - y * s, x * s + y * c);
            let [vx, vy, vz] = point.rate;
            path.points
                .push([right + pose.origin[0], up + pose.origin[1], z]);
            // d(p + R q)/dtheta = dp/dtheta + z x R q + R dq/dtheta
            path.rates.push([
                -up + (rate[0] + c * vx - s * vy),
                right + (rate[1] + s * vx + c * vy),
                R::constant(vz),
            ]);
        }
        Ok(path)
    }
}

fn plus<R: Real>(moved: Point<R>, fixed: Point<f64>) -> Point<R> {
    [
        moved[0] + fixed[0],
        moved[1] + fixed[1],
        moved[2] + fixed[2],
    ]
}

impl<R: Real> Path<R> {
    /// Sum of the segments, m.
    pub fn length(&self) -> R {
        let segments = self.points.windows(2).map(|w| norm(from_to(w[0], w[1])));
        segments.fold(R::constant(0.0), |sum, l| sum + l)
    }

    /// -dl/dtheta, m.
    pub fn arm(&self) -> R {
        let segments = self.points.windows(2).zip(self.rates.windows(2));
        segments.fold(R::constant(0.0), |sum, (p, v)| {
            sum - dot(direction(p[0], p[1]), from_to(v[0], v[1]))
        })
    }

    /// The unit vector along the first segment, away from the origin.
    pub fn pull_on_origin(&self) -> Point<R> {
        direction(self.points[0], self.points[1])
    }

    /// The unit vector along the last segment, away from the insertion.
    pub fn pull_on_insertion(&self) -> Point<R> {
        let last = self.points.len() - 1;
        direction(self.points[last], self.points[last - 1])
    }
}

impl Path<f64> {
    /// Eq. 3 about a centre in the femur's frame.
    fn projection(&self, centre: [f64; 2]) -> Projection {
        let (on_femur, on_tibia) = (self.points[self.crossing], self.points[self.crossing + 1]);
        let segment = from_to(on_tibia, on_femur);
        let [fx, fy, _] = segment;
        let in_plane = libm::hypot(fx, fy);
        let (px, py) = (on_tibia[0] - centre[0], on_tibia[1] - centre[1]);
        // p_f x k = (fy, -fx, 0)
        Projection {
            arm_m: (px * fy - py * fx) / in_plane,
            in_plane: in_plane / norm(segment),
        }
    }
}

fn from_to<R: Real>(a: Point<R>, b: Point<R>) -> Point<R> {
    [b[0] - a[0], b[1] - a[1], b[2] - a[2]]
}

fn dot<R: Real>(a: Point<R>, b: Point<R>) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm<R: Real>(a: Point<R>) -> R {
    dot(a, a).sqrt()
}

fn direction<R: Real>(a: Point<R>, b: Point<R>) -> Point<R> {
    let d = from_to(a, b);
    let length = norm(d);
    d.map(|c| c / length)
}
