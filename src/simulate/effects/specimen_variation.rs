//! Specimen variation: F_620 (1 + u), u the specimen's own. It needs `sd`, and is drawn once for each specimen.
//!
//! - `normal`: u from a normal distribution.
//! - `two_batch`: u = +sd or -sd, each with probability one half, as with two deliveries of tube.
//!
//! It comes on top of `specimen_scatter` of the rig, which is the same with a normal distribution.

use super::{Column, Effect, Form, Given, Link, Moment, Parameter, Per};
use pipeline_effects as library;

const STRENGTH: Parameter = Parameter::size("u", "1", -0.5, 0.5);

/// The effect.
pub static EFFECT: Effect = Effect {
    id: library::specimen_variation::ID,
    column: Column::None,
    per: Per::Specimen,
    forms: &[
        Form::new("normal", Link::Actuator, &[STRENGTH], stronger),
        Form {
            two_batches: true,
            ..Form::new("two_batch", Link::Actuator, &[STRENGTH], stronger)
        },
    ],
};

fn stronger(given: &Given, _: &Moment, force: f64) -> f64 {
    force * (1.0 + given.p[0])
}
