//! A four-bar linkage: femur and tibia joined by two links, each pinned to both.
//!
//! At a knee angle the first link holds the tibia's origin p on a circle about A - R(theta) C, the second on one about B - R(theta) D, with A
//! and B the pins of the femur, C and D those of the tibia. p is where the circles meet, always on the same side of the line of their centres
//! (a linkage changes sides only through a singular position). Lines along the links cross in the instantaneous centre of rotation
//! (theorem of Aronhold and Kennedy; the paper's text on the knee joint).

use super::joint::{Pose, turned};
use pipeline_numerics::real::Real;

/// A four-bar linkage, lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub struct FourBar {
    femur: [[f64; 2]; 2],
    tibia: [[f64; 2]; 2],
    links: [f64; 2],
    left: bool,
}

impl FourBar {
    /// The linkage with these pins (first and second link) in the femur's and the tibia's frame and these lengths of links. Of the two
    /// ways of assembling it, that which puts the tibia's origin nearer to `near` (femur's frame) with the leg straight.
    ///
    /// `None` if it cannot be assembled with the leg straight.
    pub fn new(
        femur: [[f64; 2]; 2],
        tibia: [[f64; 2]; 2],
        links: [f64; 2],
        near: [f64; 2],
    ) -> Option<Self> {
        let assembled = |left| {
            let linkage = Self {
                femur,
                tibia,
                links,
                left,
            };
            let [x, y] = linkage.origin(1.0, 0.0)?;
            Some((libm::hypot(x - near[0], y - near[1]), linkage))
        };
        let (left, right) = (assembled(true)?, assembled(false)?);
        Some(if left.0 <= right.0 { left.1 } else { right.1 })
    }

    /// The tibia's origin in the femur's frame at the knee angle with this cosine and sine; `None` where the linkage does not close.
    pub(super) fn origin<R: Real>(&self, cos: R, sin: R) -> Option<[R; 2]> {
        let centre = |k: usize| {
            let [x, y] = turned(cos, sin, self.tibia[k].map(R::constant));
            [-x + self.femur[k][0], -y + self.femur[k][1]]
        };
        let ([ax, ay], [bx, by]) = (centre(0), centre(1));
        let (dx, dy) = (bx - ax, by - ay);
        let apart = (dx * dx + dy * dy).sqrt();
        let [first, second] = self.links;
        let along = (apart * apart + (first * first - second * second)) / (apart * 2.0);
        let across = -(along * along) + first * first;
        // A half chord of no length is a singular position; centres in one place are a parallelogram, which does not turn.
        if apart.value().is_nan() || apart.value() < 1e-9 || across.value() <= 0.0 {
            return None;
        }
        let side = if self.left { 1.0 } else { -1.0 };
        let (ux, uy, h) = (dx / apart, dy / apart, across.sqrt() * side);
        Some([ax + along * ux - h * uy, ay + along * uy + h * ux])
    }

    /// Where the lines along the links cross, in the femur's frame; `None` where they are parallel.
    pub(super) fn crossing(&self, pose: &Pose<f64>) -> Option<[f64; 2]> {
        let pin = |k: usize| {
            let [x, y] = self.tibia[k];
            pose.place([x, y, 0.0])
        };
        let along = |k: usize| [pin(k)[0] - self.femur[k][0], pin(k)[1] - self.femur[k][1]];
        let ([ux, uy], [vx, vy]) = (along(0), along(1));
        let [[ax, ay], [bx, by]] = self.femur;
        let sine = ux * vy - uy * vx;
        let share = ((bx - ax) * vy - (by - ay) * vx) / sine;
        (sine.abs() > 1e-12 * self.links[0] * self.links[1])
            .then_some([ax + share * ux, ay + share * uy])
    }
}
