//! Routes: the points that a muscle or an actuator runs through, from its origin on the femur to its insertion on the tibia.

use super::{Beyond, Point};
use pipeline_numerics::cubic_spline::CubicSpline;
use pipeline_numerics::real::{Dual, Real};

/// To which body a point is fixed; coordinates in that body's frame, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// The femur.
    Femur(Point<f64>),
    /// The tibia.
    Tibia(Point<f64>),
    /// The patella, which moves on the tibia ([`Patella`]).
    Patella(Point<f64>),
}

/// A point of a route and the angles at which it takes part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoutePoint {
    /// Where it is fixed.
    pub place: Place,
    /// The first angle at which it takes part, rad; minus infinity for no limit.
    pub from: f64,
    /// The angle below which it takes part, rad; infinity for no limit.
    pub below: f64,
}

impl RoutePoint {
    /// Whether the point takes part at an angle in rad.
    pub fn takes_part(&self, angle: f64) -> bool {
        (self.from..self.below).contains(&angle)
    }
}

/// The motion of the patella on the tibia, over the knee angle in rad.
///
/// Delp's model (Delp et al., *IEEE Transactions on Biomedical Engineering* 37, 1990) has a patella that slides and turns on the tibia;
/// OpenSim's Gait2392 keeps of it only where each muscle inserts in the tibia's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Patella {
    /// Position of the patella's origin (where rectus femoris inserts) in the tibia's frame, m.
    pub origin: [CubicSpline; 2],
    /// Rotation about z against the tibia, rad.
    pub rotation: CubicSpline,
}

impl Patella {
    /// Where a point of the patella is in the tibia's frame, m; `None` outside the knots.
    pub fn place<R: Real>(&self, [x, y, z]: Point<f64>, angle: R) -> Option<Point<R>> {
        let turn = self.rotation.value(angle)?;
        let (cos, sin) = (turn.cos(), turn.sin());
        let [px, py] = [self.origin[0].value(angle)?, self.origin[1].value(angle)?];
        Some([
            px + cos * x - sin * y,
            py + sin * x + cos * y,
            R::constant(z),
        ])
    }
}

/// A route.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// Name, unique within a knee.
    pub name: String,
    /// Points in order; those of the femur stand before those of the tibia and the patella.
    pub points: Vec<RoutePoint>,
    /// The patella, where a point is fixed to it.
    pub patella: Option<Patella>,
}

/// A point that takes part, in the frame of its body, with its motion in that frame.
pub(super) struct Active {
    /// Whether it belongs to the femur; else it is in the tibia's frame.
    pub on_femur: bool,
    /// Position, m.
    pub position: Point<f64>,
    /// Derivative of the position with respect to the knee angle, m/rad: other than zero on a patella.
    pub rate: Point<f64>,
}

impl Route {
    /// The points that take part at an angle in rad, in order.
    pub(super) fn active(&self, angle: f64) -> Result<Vec<Active>, Beyond> {
        let taking_part = self.points.iter().filter(|p| p.takes_part(angle));
        taking_part
            .map(|p| match p.place {
                Place::Femur(position) => Ok(still(true, position)),
                Place::Tibia(position) => Ok(still(false, position)),
                Place::Patella(position) => self.on_patella(position, angle),
            })
            .collect()
    }

    fn on_patella(&self, position: Point<f64>, angle: f64) -> Result<Active, Beyond> {
        let range = self
            .patella
            .as_ref()
            .map_or((0.0, 0.0), |p| p.rotation.range());
        let variable = Dual::<1>::variable(angle, 0);
        let placed = self
            .patella
            .as_ref()
            .and_then(|p| p.place(position, variable));
        let at = placed.ok_or(Beyond { angle, range })?;
        Ok(Active {
            on_femur: false,
            position: at.map(|c| c.value),
            rate: at.map(|c| c.gradient[0]),
        })
    }

    /// The angles at which a point begins or ceases to take part, rad, increasing.
    pub fn switches(&self) -> Vec<f64> {
        let limits = self.points.iter().flat_map(|p| [p.from, p.below]);
        let mut angles: Vec<f64> = limits.filter(|a| a.is_finite()).collect();
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        angles
    }
}

fn still(on_femur: bool, position: Point<f64>) -> Active {
    Active {
        on_femur,
        position,
        rate: [0.0; 3],
    }
}
