//! The forward model with effects: from a set-up to what the sensor shows.

use super::{Conditions, Link, Place, all, apply};
use pipeline_numerics::real::{Dual, Real};
use std::sync::LazyLock;

/// The place of every form of every effect: a model asks for them with every reading.
static PLACES: LazyLock<Vec<Vec<Place>>> = LazyLock::new(|| {
    let places = |e: &&dyn super::Effect| e.forms().iter().map(|f| f.place).collect();
    all().iter().map(places).collect()
});

/// An effect in a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Applied<R> {
    /// Place in [`super::all`].
    pub effect: usize,
    /// Place in its forms.
    pub form: usize,
    /// Amplitude and shape.
    pub parameters: [R; 2],
}

impl<R> Applied<R> {
    /// Where in the chain it acts.
    pub fn place(&self) -> Place {
        PLACES[self.effect][self.form]
    }
}

/// The static force of an actuator, N, as a function of gauge pressure in kPa and length in m.
pub trait Actuator {
    /// The force at a pressure and length; `R` carries the derivatives.
    fn force<R: Real>(&self, coefficients: &[R], pressure: R, length: R, at: &Conditions) -> R;
}

/// A number with its derivative by the force that the frame carries.
type Force = Dual<1>;

const MOST_STEPS: usize = 40;
/// The force balance is solved to this, N.
const BALANCED_N: f64 = 1e-10;

/// The force that the sensor shows, N: base model, gain of the specimen (1 for a mean one) and effects, those at one place in the order of
/// [`all`], whatever that of the list.
pub fn force<A: Actuator, R: Real>(
    actuator: &A,
    coefficients: &[R],
    gain: R,
    effects: &[Applied<R>],
    at: &Conditions,
) -> R {
    let mut effects: Vec<&Applied<R>> = effects.iter().collect();
    effects.sort_by_key(|e| e.effect);
    let effects = effects.as_slice();
    let mut link = Link {
        pressure: R::constant(at.pressure_kpa),
        length: R::constant(at.length_m),
        force: R::constant(0.0),
    };
    at_place(Place::Input, effects, at, &mut link);
    let yields = effects.iter().any(|e| e.place() == Place::Frame);
    link.force = if yields {
        balanced(actuator, coefficients, gain, effects, at, link)
    } else {
        pulled(actuator, coefficients, gain, effects, at, link)
    };
    at_place(Place::Sensor, effects, at, &mut link);
    link.force
}

/// The factor by which an effect on the actuator's force changes it.
pub fn scale(effect: &Applied<f64>, at: &Conditions) -> f64 {
    let mut link = Link {
        pressure: at.pressure_kpa,
        length: at.length_m,
        force: 1.0,
    };
    at_place(Place::Actuator, &[effect], at, &mut link);
    link.force
}

fn at_place<R: Real>(place: Place, effects: &[&Applied<R>], at: &Conditions, link: &mut Link<R>) {
    for e in effects.iter().filter(|e| e.place() == place) {
        apply(e.effect, e.form, e.parameters, at, link);
    }
}

/// The actuator's force at the pressure and length of a link.
fn pulled<A: Actuator, R: Real>(
    actuator: &A,
    coefficients: &[R],
    gain: R,
    effects: &[&Applied<R>],
    at: &Conditions,
    mut link: Link<R>,
) -> R {
    link.force = actuator.force(coefficients, link.pressure, link.length, at) * gain;
    at_place(Place::Actuator, effects, at, &mut link);
    at_place(Place::Braid, effects, at, &mut link);
    link.force
}

/// The force at which actuator and frame balance: F = A(P, l - s(F)).
///
/// The balance is found by Newton's method within a bracket, the force the one variable: A falls with a shorter length, so that
/// g(F) = F - A(P, l - s(F)) rises with F. The derivatives then follow from the theorem of implicit functions: one evaluation at the
/// balance, with F held in s, and its gradient divided by g'(F).
fn balanced<A: Actuator, R: Real>(
    actuator: &A,
    coefficients: &[R],
    gain: R,
    effects: &[&Applied<R>],
    at: &Conditions,
    link: Link<R>,
) -> R {
    let plain = |x: R| Force::constant(x.value());
    let values: Vec<Force> = coefficients.iter().map(|c| plain(*c)).collect();
    let held: Vec<Applied<Force>> = effects
        .iter()
        .map(|e| Applied {
            effect: e.effect,
            form: e.form,
            parameters: e.parameters.map(plain),
        })
        .collect();
    let held: Vec<&Applied<Force>> = held.iter().collect();
    let at_force = |force: f64| {
        let mut yielded = Link {
            force: Force::variable(force, 0),
            pressure: plain(link.pressure),
            length: plain(link.length),
        };
        at_place(Place::Frame, &held, at, &mut yielded);
        pulled(actuator, &values, plain(gain), &held, at, yielded)
    };
    let (force, slope) = solve(at_force);
    let mut yielded = Link {
        force: R::constant(force),
        ..link
    };
    at_place(Place::Frame, effects, at, &mut yielded);
    let pulled = pulled(actuator, coefficients, gain, effects, at, yielded);
    pulled.chain(force, 1.0 / slope)
}

/// The root of g(F) = F - A(F) and g' there; A must not be negative.
fn solve(pulled: impl Fn(f64) -> Force) -> (f64, f64) {
    let stiff = pulled(0.0).value;
    let (mut low, mut high) = (0.0_f64.min(stiff), stiff.max(0.0));
    let mut force = stiff;
    let mut slope = 1.0;
    for _ in 0..MOST_STEPS {
        let there = pulled(force);
        let g = force - there.value;
        slope = (1.0 - there.gradient[0]).max(1e-3);
        if g.abs() < BALANCED_N {
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
        if high - low < BALANCED_N {
            break;
        }
    }
    (force, slope)
}
