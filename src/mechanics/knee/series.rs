//! What yields in series with the actuator: tendon and brackets, and the force at which everything balances.
//!
//! A force F along the path stretches the tendon by F/k, k = n A E/L, and moves an attachment by d = F K^-1 u, where u is the direction in which
//! the actuator pulls there and K the stiffness of the bracket, diagonal in the bracket's own axes; along the actuator that is the stiffness
//! k_u = 1/(u' K^-1 u). u is taken at the unloaded attachment, which leaves out terms of second order in the deflection. With the
//! attachments moved, the path is shorter by about F/k_u and its moment arm changes, so that length, arm and torque all follow from
//!
//! F = A(P, L_MT(theta, F) - 2 l_fit - l_tendon - F/k).
//!
//! What is loose (knots, bolts in their holes, a tendon that straightens) gives way at once and then no more: besides F/k it takes s F/(F + 100 N).
//!
//! Attachments may also be elsewhere than drawn, whatever pulls ([`Series::shifted`]).
//!
//! Compliances (m/N) stand for stiffnesses throughout: a rigid part has none, and fits start there. Every one of them may carry derivatives
//! `R`, and the balance passes them on (theorem of implicit functions, as the effects have it).

use super::path::{Leg, Yield};
use super::torque::Setup;
use super::{Beyond, Point};
use crate::models::ForceModel;
use pipeline_numerics::real::{Dual, Real};

/// Stiffness of a tendon of parallel strands, k = n A E/L, N/m: number of strands, cross-section of one in m2, Young's modulus in Pa, length in m.
pub fn tendon_stiffness<R: Real>(strands: R, area: R, modulus: R, length: R) -> R {
    strands * area * modulus / length
}

/// A bracket that carries an attachment.
///
/// Its axes: from foot to attachment; at right angles to that in the sagittal plane; at right angles to both. A bracket that stands out
/// sideways (foot and attachment differ in z alone) has x as its second axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bracket<R> {
    /// Where it is fixed to the bone, in the frame of the attachment's body, m.
    pub foot: Point<f64>,
    /// Compliance along the three axes, m/N.
    pub compliance: [R; 3],
}

/// Everything that yields in series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Series<R> {
    /// Compliance of the tendon and whatever else yields along the actuator, 1/k, m/N.
    pub axial: R,
    /// What is loose along the actuator, s, m: all of it is taken up by a large force, half of it by [`HALF_TAKEN_UP_N`].
    pub loose: R,
    /// The bracket at the origin, if it yields.
    pub origin: Option<Bracket<R>>,
    /// The bracket at the insertion, if it yields.
    pub insertion: Option<Bracket<R>>,
    /// By how much origin (in the femur's frame) and insertion (in the tibia's) are elsewhere than drawn before anything pulls, m.
    pub shifted: [Point<R>; 2],
}

/// Force that takes up half of what is loose, N.
pub const HALF_TAKEN_UP_N: f64 = 100.0;

impl<R: Real> Series<R> {
    /// By how much everything along the actuator gives way to a force in N, m.
    fn stretch(&self, force: R) -> R {
        let stretched = self.axial * force;
        if self.loose.is_constant() && self.loose.value() == 0.0 {
            return stretched;
        }
        // Odd in the force: a law of force that is not cut off where it is negative may push.
        let size = if force.value() < 0.0 { -force } else { force };
        stretched + self.loose * (force / (size + HALF_TAKEN_UP_N))
    }

    /// Nothing yields.
    pub fn rigid() -> Self {
        Self {
            axial: R::constant(0.0),
            loose: R::constant(0.0),
            origin: None,
            insertion: None,
            shifted: [[R::constant(0.0); 3]; 2],
        }
    }

    /// The ends as they are before anything pulls.
    fn ends(&self) -> Yield<R> {
        let [origin, insertion] = self.shifted;
        Yield { origin, insertion }
    }
}

/// The force of an actuator as a function of its length.
pub trait Pull {
    /// Force in N at a length in m; `R` carries derivatives. NaN where there is no answer.
    fn force<R: Real>(&self, length: R) -> R;
}

/// A registered force model at a set-up and a gauge pressure.
pub struct Published<'a> {
    /// The model.
    pub model: &'a dyn ForceModel,
    /// The actuator.
    pub setup: &'a Setup,
    /// Gauge pressure, kPa.
    pub pressure_kpa: f64,
}

/// Step of the length over which the slope of a force model is taken, m.
const STEP_M: f64 = 1e-6;

impl Pull for Published<'_> {
    fn force<R: Real>(&self, length: R) -> R {
        let at = |length_m: f64| {
            let state = self.setup.state(length_m, self.pressure_kpa);
            self.model.predict(&state).force_n().unwrap_or(f64::NAN)
        };
        let l = length.value();
        let slope = (at(l + STEP_M) - at(l - STEP_M)) / (2.0 * STEP_M);
        // At the rim of a model's domain one side has no answer; the force has.
        length.chain(at(l), if slope.is_nan() { 0.0 } else { slope })
    }
}

/// Actuator and leg in balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance<R> {
    /// F, N.
    pub force: R,
    /// L_MT with the attachments moved, m.
    pub path_length: R,
    /// l_m, m.
    pub actuator_length: R,
    /// r with the attachments moved, m, positive in extension.
    pub arm: R,
    /// M = r F, N.m, positive in extension.
    pub torque: R,
}

const MOST_STEPS: usize = 60;
/// The balance is solved to this, N.
const BALANCED_N: f64 = 1e-9;

impl Leg<'_> {
    /// The balance at an angle in rad. `None` where the actuator's force has no answer.
    ///
    /// # Errors
    /// If the angle lies outside the joint's or the patella's range.
    pub fn balance<R: Real>(
        &self,
        setup: &Setup,
        series: &Series<R>,
        pull: &impl Pull,
        angle: f64,
    ) -> Result<Option<Balance<R>>, Beyond> {
        let taken = 2.0 * setup.fitting_m + setup.tendon_m;
        let balance = self.balanced(
            series,
            angle,
            |free: Dual<1>| pull.force(free - taken),
            |free: R| pull.force(free - taken),
        )?;
        Ok(balance.map(|b| Balance {
            actuator_length: b.actuator_length - taken,
            ..b
        }))
    }

    /// The balance with any law of force, given as a function of the length in m that path and series leave for actuator, fittings and tendon
    /// ([`Balance::actuator_length`] is that length here): once with the derivative by this length, for Newton's method, and once with those
    /// of its own parameters, which the balance passes on.
    ///
    /// # Errors
    /// As [`Leg::balance`].
    pub fn balanced<R: Real>(
        &self,
        series: &Series<R>,
        angle: f64,
        plain_pull: impl Fn(Dual<1>) -> Dual<1>,
        pull: impl Fn(R) -> R,
    ) -> Result<Option<Balance<R>>, Beyond> {
        if series.origin.is_none() && series.insertion.is_none() {
            return self.balanced_along(series, angle, plain_pull, pull);
        }
        let plain = series.map(R::value).map(Dual::<1>::constant);
        let yielding = self.yielding(&plain, angle)?;
        let pulled = |force: f64| -> Result<Dual<1>, Beyond> {
            let force = Dual::<1>::variable(force, 0);
            let (path, _) = self.loaded(&plain, &yielding, force, angle)?;
            Ok(plain_pull(path - plain.stretch(force)))
        };
        let Some((force, slope)) = solve(pulled)? else {
            return Ok(None);
        };
        let yielding = self.yielding(series, angle)?;
        let held = R::constant(force);
        let (path, _) = self.loaded(series, &yielding, held, angle)?;
        let at_held = pull(path - series.stretch(held));
        let force = at_held.chain(force, 1.0 / slope);
        let (path_length, arm) = self.loaded(series, &yielding, force, angle)?;
        Ok(Some(Balance {
            force,
            path_length,
            actuator_length: path_length - series.stretch(force),
            arm,
            torque: arm * force,
        }))
    }

    /// [`Leg::balanced`] where no attachment yields to the force: the path stays where it is.
    fn balanced_along<R: Real>(
        &self,
        series: &Series<R>,
        angle: f64,
        plain_pull: impl Fn(Dual<1>) -> Dual<1>,
        pull: impl Fn(R) -> R,
    ) -> Result<Option<Balance<R>>, Beyond> {
        let path = self.path(angle, series.ends())?;
        let (length, arm) = (path.length(), path.arm());
        let plain = series.map(R::value).map(Dual::<1>::constant);
        let nothing = |r: R| r.is_constant() && r.value() == 0.0;
        let force = if nothing(series.axial) && nothing(series.loose) {
            pull(length)
        } else {
            let stretched = |force: f64| {
                let force = Dual::<1>::variable(force, 0);
                Ok(plain_pull(-plain.stretch(force) + length.value()))
            };
            let Some((force, slope)) = solve(stretched)? else {
                return Ok(None);
            };
            let at_held = pull(length - series.stretch(R::constant(force)));
            at_held.chain(force, 1.0 / slope)
        };
        if !force.value().is_finite() {
            return Ok(None);
        }
        Ok(Some(Balance {
            force,
            path_length: length,
            actuator_length: length - series.stretch(force),
            arm,
            torque: force * arm,
        }))
    }

    /// By how much each end gives way per newton, m/N.
    fn yielding<R: Real>(&self, series: &Series<R>, angle: f64) -> Result<Yield<R>, Beyond> {
        let path = self.path(angle, series.map(R::value).ends())?;
        let pose = self.joint.pose(angle)?;
        let active = self.route.active(angle)?;
        let [x, y, z] = path.pull_on_insertion();
        let in_tibia = [pose.cos * x + pose.sin * y, pose.cos * y - pose.sin * x, z];
        let end = |bracket: &Option<Bracket<R>>, attachment, pull| {
            bracket.map_or([R::constant(0.0); 3], |b| b.displacement(attachment, pull))
        };
        Ok(Yield {
            origin: end(&series.origin, active[0].position, path.pull_on_origin()),
            insertion: end(
                &series.insertion,
                active[active.len() - 1].position,
                in_tibia,
            ),
        })
    }

    /// Length and arm of the path under a force in N.
    fn loaded<R: Real>(
        &self,
        series: &Series<R>,
        per_newton: &Yield<R>,
        force: R,
        angle: f64,
    ) -> Result<(R, R), Beyond> {
        let ends = series.ends();
        let moved = |from: Point<R>, by: Point<R>| std::array::from_fn(|k| from[k] + by[k] * force);
        let moved = Yield {
            origin: moved(ends.origin, per_newton.origin),
            insertion: moved(ends.insertion, per_newton.insertion),
        };
        let path = self.path(angle, moved)?;
        Ok((path.length(), path.arm()))
    }
}

impl<R: Real> Series<R> {
    fn map<S: Real>(&self, f: impl Fn(R) -> S) -> Series<S> {
        let bracket = |b: &Option<Bracket<R>>| {
            b.map(|b| Bracket {
                foot: b.foot,
                compliance: b.compliance.map(&f),
            })
        };
        Series {
            axial: f(self.axial),
            loose: f(self.loose),
            origin: bracket(&self.origin),
            insertion: bracket(&self.insertion),
            shifted: self.shifted.map(|end| end.map(&f)),
        }
    }
}

impl<R: Real> Bracket<R> {
    /// K^-1 u: how far the attachment moves per newton that pulls along the unit vector `pull`, m/N.
    fn displacement(&self, attachment: Point<f64>, pull: Point<f64>) -> Point<R> {
        let axes = self.axes(attachment);
        let mut moved = [R::constant(0.0); 3];
        for (axis, compliance) in axes.iter().zip(self.compliance) {
            let share: f64 = axis.iter().zip(pull).map(|(a, p)| a * p).sum();
            for (slot, a) in moved.iter_mut().zip(axis) {
                *slot = *slot + compliance * (share * a);
            }
        }
        moved
    }

    fn axes(&self, attachment: Point<f64>) -> [Point<f64>; 3] {
        let [x, y, z]: Point<f64> = std::array::from_fn(|k| attachment[k] - self.foot[k]);
        let (flat, length) = (libm::hypot(x, y), (x * x + y * y + z * z).sqrt());
        let first = [x / length, y / length, z / length];
        let second = if flat > 0.0 {
            [-y / flat, x / flat, 0.0]
        } else {
            [1.0, 0.0, 0.0]
        };
        let third = [
            first[1] * second[2] - first[2] * second[1],
            first[2] * second[0] - first[0] * second[2],
            first[0] * second[1] - first[1] * second[0],
        ];
        [first, second, third]
    }
}

/// The root of g(F) = F - A(F) and g' there; `None` where A has no answer. A falls with a shorter actuator, so that g rises: Newton's method
/// within a bracket.
fn solve(pulled: impl Fn(f64) -> Result<Dual<1>, Beyond>) -> Result<Option<(f64, f64)>, Beyond> {
    let stiff = pulled(0.0)?.value;
    let (mut low, mut high, mut force) = (stiff.min(0.0), stiff.max(0.0), stiff);
    let mut slope = 1.0;
    for _ in 0..MOST_STEPS {
        let at = pulled(force)?;
        let g = force - at.value;
        slope = (1.0 - at.gradient[0]).max(1e-3);
        if !g.is_finite() {
            return Ok(None);
        }
        if g.abs() < BALANCED_N || high - low < BALANCED_N {
            break;
        }
        if g > 0.0 {
            high = force;
        } else {
            low = force;
        }
        let newton = force - g / slope;
        force = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
    }
    Ok(Some((force, slope)))
}
