//! Joints: where the tibia stands, and about which centre it turns, at a knee angle.
//!
//! The tibia moves in the sagittal plane. Its pose at the angle theta is the position p(theta) of its frame's origin in the femur's frame and
//! its rotation by theta about z; a point q of the tibia is then at p + R(theta) q. The instantaneous centre of rotation c is the point at
//! rest, dp/dtheta = z x (p - c), so that c = p + z x dp/dtheta.

use super::four_bar::FourBar;
use super::{Beyond, Point};
use pipeline_numerics::cubic_spline::CubicSpline;
use pipeline_numerics::real::{Dual, Real};

/// Position and rotation of the tibia in the femur's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<R> {
    /// Origin of the tibia's frame, m.
    pub origin: [R; 2],
    /// Cosine of the knee angle.
    pub cos: R,
    /// Sine of the knee angle.
    pub sin: R,
}

impl<R: Real> Pose<R> {
    /// Where a point of the tibia is in the femur's frame, m.
    pub fn place(&self, [x, y, z]: Point<R>) -> Point<R> {
        let [right, up] = turned(self.cos, self.sin, [x, y]);
        [self.origin[0] + right, self.origin[1] + up, z]
    }
}

/// A vector of the plane, turned by the angle with this cosine and sine.
pub(super) fn turned<R: Real>(cos: R, sin: R, [x, y]: [R; 2]) -> [R; 2] {
    [cos * x - sin * y, sin * x + cos * y]
}

/// How the tibia moves.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// About a fixed centre, which is also the origin of the tibia's frame, m.
    Pinned([f64; 2]),
    /// The frame's origin moves along two curves of the angle in rad (Gait2392: `knee_r`), m.
    Translating([CubicSpline; 2]),
    /// The centre is tabulated twice: in the femur's frame, and in the tibia's (x, y each, over the angle in rad), m.
    Centre {
        /// In the femur's frame.
        femur: [CubicSpline; 2],
        /// In the tibia's frame.
        tibia: [CubicSpline; 2],
    },
    /// A four-bar linkage.
    FourBar(FourBar),
}

/// A knee joint with the range over which it turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// How the tibia moves.
    pub motion: Motion,
    /// Smallest and largest knee angle, rad; flexion is negative.
    pub range: (f64, f64),
}

impl Joint {
    /// The tibia's pose at an angle in rad; `R` carries derivatives with respect to the angle.
    ///
    /// # Errors
    /// If the angle lies outside the joint's range, or outside the knots, or the linkage does not close there.
    pub fn pose<R: Real>(&self, angle: R) -> Result<Pose<R>, Beyond> {
        let (cos, sin) = (angle.cos(), angle.sin());
        let origin =
            match &self.motion {
                _ if !(self.range.0..=self.range.1).contains(&angle.value()) => None,
                Motion::Pinned(centre) => Some(centre.map(R::constant)),
                Motion::Translating(curves) => point(curves, angle),
                Motion::Centre { femur, tibia } => point(femur, angle)
                    .zip(point(tibia, angle))
                    .map(|(at, own)| {
                        let [x, y] = turned(cos, sin, own);
                        [at[0] - x, at[1] - y]
                    }),
                Motion::FourBar(linkage) => linkage.origin(cos, sin),
            };
        let beyond = Beyond {
            angle: angle.value(),
            range: self.range,
        };
        origin.map(|origin| Pose { origin, cos, sin }).ok_or(beyond)
    }

    /// The tibia's pose at an angle in rad, and how fast it changes: its derivative with respect to the angle.
    ///
    /// # Errors
    /// As [`Joint::pose`].
    pub fn pose_and_rate(&self, angle: f64) -> Result<(Pose<f64>, [f64; 2]), Beyond> {
        let pose = self.pose(Dual::<1>::variable(angle, 0))?;
        let [x, y] = pose.origin;
        let plain = Pose {
            origin: [x.value, y.value],
            cos: pose.cos.value,
            sin: pose.sin.value,
        };
        Ok((plain, [x.gradient[0], y.gradient[0]]))
    }

    /// The instantaneous centre of rotation in the femur's frame, m, as the joint defines it: the fixed point, the tabulated centre, the
    /// crossing of a linkage's links; for a translating joint c = p + z x dp/dtheta.
    ///
    /// # Errors
    /// As [`Joint::pose`].
    pub fn centre(&self, angle: f64) -> Result<[f64; 2], Beyond> {
        let (pose, rate) = self.pose_and_rate(angle)?;
        let tabulated = match &self.motion {
            Motion::Centre { femur, .. } => point(femur, angle),
            Motion::FourBar(linkage) => linkage.crossing(&pose),
            Motion::Pinned(_) | Motion::Translating(_) => None,
        };
        Ok(tabulated.unwrap_or([pose.origin[0] - rate[1], pose.origin[1] + rate[0]]))
    }
}

fn point<R: Real>([x, y]: &[CubicSpline; 2], angle: R) -> Option<[R; 2]> {
    Some([x.value(angle)?, y.value(angle)?])
}
