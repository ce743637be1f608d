//! The library of effects: what a force model of an actuator may lack, and what may be wrong with a rig.
//!
//! An effect is an *operator on the forward model*, never a column that is glued to a residual. It is written once, for every model
//! that it applies to, generic over [`Real`], so that fits have exact derivatives. The chain from a set-up to a sensor is
//!
//! 1. **inputs**: gauge pressure and length as they were read become those of the actuator ([`Place::Input`]);
//! 2. **frame**: the length yields to the force, F = A(P, l - s(F)), solved together with the force ([`Place::Frame`]);
//! 3. **actuator**: the base model times what changes the actuator itself ([`Place::Actuator`]), less what its braid loses in friction
//!    ([`Place::Braid`]): the frame carries what is left;
//! 4. **sensor**: what the load cell shows of the force ([`Place::Sensor`]).
//!
//! Each effect has *forms*: equations of one physical idea that differ in shape (a constant or a proportional hysteresis). A form has
//! an **amplitude**, which is 0 where the effect is absent, and at most one **shape** parameter (a time constant), which means
//! nothing while the amplitude is 0 and is therefore searched on a grid first.
//!
//! About a joint the same effect shows in a torque. What it is there stands in the same file ([`Effect::joint_forms`]); some effects
//! are of a joint only.
//!
//! This is the one registry: what an effect is called, its equations, units, bounds, what would measure it and where it is described stand
//! here and nowhere else. Its operator on the force is in its file, that on the torque in `stages::torque::diagnose::operator`, and the
//! simulator's own equation in `simulate::effects`; both refer to the id that is given here.
//!
//! A new effect on the force is one new file here and one line in the list below; search, detection limits, classes, report and
//! documentation follow from the list. `docs/effects.md` shows it by an example, and what a torque and the simulator take.
//!
//! Deliberately absent: data frames, fitting, statistics. `stages::diagnose` searches.

mod chain;
mod conditions;
mod joint;
#[cfg(test)]
mod tests;

pub use chain::{Actuator, Applied, force, scale};
pub use conditions::{Argument, Conditions, Need};
pub use joint::{JointForm, JointNeed, StandsFor};

use pipeline_numerics::real::Real;

/// Where in the chain an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// On pressure and length, before the force.
    Input,
    /// On the length, by the force.
    Frame,
    /// On the actuator's force.
    Actuator,
    /// On what the braid passes on of it.
    Braid,
    /// On what the sensor shows.
    Sensor,
}

/// A number that an effect has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Symbol.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// What is reported where the effect is absent: 1 for a gain. Reported is this plus the amplitude.
    pub absent: f64,
    /// Physically possible values of the amplitude.
    pub bounds: (f64, f64),
}

/// One equation of an effect.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// A word for it.
    pub name: &'static str,
    /// Where in the chain.
    pub place: Place,
    /// The equation, as plain text.
    pub equation: &'static str,
    /// 0 where the effect is absent.
    pub amplitude: Parameter,
    /// A second parameter and the values at which the search tries it.
    pub shape: Option<(Parameter, &'static [f64])>,
    /// What must be known of a reading.
    pub needs: &'static [Need],
}

impl Form {
    /// Whether a function of lengths and pressure alone can hold it: it needs nothing of the past, the rate or the surroundings.
    pub fn is_static(&self) -> bool {
        let given = |need: &Need| matches!(need, Need::RestLengths | Need::LengthLaw);
        self.needs.iter().all(given)
    }
}

/// On what one value of the amplitude may act: on all readings, or on a part of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grouping {
    /// One value for all readings.
    Whole,
    /// Also a value for some sessions only, or for one specimen only: something of the set-up.
    Parts,
    /// A value for each specimen, all drawn from one distribution: scatter that every model has, and no candidate.
    Drawn,
}

/// Of what an effect is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Of the actuator: it goes with the muscle to another machine.
    Actuator,
    /// Of what it was measured in: sensors, frame, set-up, joint.
    Rig,
}

/// What an effect is: names, equations, bounds, source.
pub trait Effect: Sync {
    /// Name in files; never changes.
    fn id(&self) -> &'static str;
    /// Name for a reader.
    fn title(&self) -> &'static str;
    /// Of what it is: only an effect of the actuator is a part of a model that leaves the rig.
    fn subject(&self) -> Subject;
    /// Its equations on the force; none of an effect of a joint.
    fn forms(&self) -> &'static [Form] {
        &[]
    }
    /// Its equations about a joint; none where it has no operator there.
    fn joint_forms(&self) -> &'static [JointForm] {
        &[]
    }
    /// Of an effect without an operator about a joint: the effect that takes it up wholly there.
    fn joint_absorbed_by(&self) -> Option<&'static str> {
        None
    }
    /// On what it may act.
    fn grouping(&self) -> Grouping {
        Grouping::Whole
    }
    /// What would measure it apart from the force, or the torque.
    fn measurement(&self) -> &'static str;
    /// Where it is described.
    fn source(&self) -> &'static str;
    /// Of what a negative size is a sign, where its source expects a positive one; none where either is usual.
    fn if_negative(&self) -> Option<&'static str> {
        None
    }
    /// Value of the amplitude near which its sensitivity is taken; other than 0 only where the trace vanishes to first order at 0.
    fn near(&self) -> f64 {
        0.0
    }
    /// Along what the size of a form may change, so that one number would not be enough for it.
    fn argument(&self, _form: usize) -> Option<Argument> {
        None
    }
}

/// What is between two links of the chain.
#[derive(Clone, Copy, Debug)]
pub struct Link<R> {
    /// Gauge pressure in the actuator, kPa.
    pub pressure: R,
    /// Length of the actuator, m.
    pub length: R,
    /// Force, N; at [`Place::Frame`] the force that the frame carries.
    pub force: R,
}

/// A change of the force that the tension itself causes, as friction does: it stays below the tension, and does so smoothly. A jump or a corner
/// where the actuator goes slack would leave fits without a fixed point; so would, for a reading that pulls, a model on its way that has no
/// tension there: friction that cancels what is left of it takes its derivatives away.
fn within_tension<R: Real>(change: R, tension: R, at: &Conditions) -> R {
    if at.pulls {
        return change;
    }
    if tension.value() <= 0.0 {
        return R::constant(0.0);
    }
    let share = change / tension;
    change / (share * share + 1.0).sqrt()
}

/// Declares the files and lists their effects, so that both stand in one line an effect.
macro_rules! effects {
    (
        on the force: { $($file:ident :: $effect:ident,)+ }
        of a joint only: { $($joint_file:ident :: $joint_effect:ident,)+ }
    ) => {
        $(pub mod $file;)+
        $(pub mod $joint_file;)+

        /// Every effect: those on the force in the order in which operators at one place of the chain are applied, then those of a joint only.
        pub fn all() -> &'static [&'static dyn Effect] {
            &[$(&$file::$effect,)+ $(&$joint_file::$joint_effect),+]
        }

        /// Applies a form of the effect number `effect` of [`all`].
        #[inline]
        fn apply<R: Real>(effect: usize, form: usize, parameters: [R; 2], at: &Conditions, link: &mut Link<R>) {
            let table: &[fn(usize, [R; 2], &Conditions, &mut Link<R>)] = &[$($file::apply::<R>),+];
            table[effect](form, parameters, at, link);
        }
    };
}

// rustfmt does not follow modules declared by a macro: check them with `rustfmt --edition 2024 --check src/effects/*.rs`.
effects! {
    on the force: {
        pressure_gain::PressureGain,
        pressure_zero_offset::PressureZeroOffset,
        bladder_threshold::BladderThreshold,
        length_offset::LengthOffset,
        series_compliance::SeriesCompliance,
        rest_length_scaling::RestLengthScaling,
        specimen_variation::SpecimenVariation,
        temperature::Temperature,
        creep::Creep,
        conditioning::Conditioning,
        hysteresis::Hysteresis,
        rate_dependence::RateDependence,
        misalignment::Misalignment,
        force_gain::ForceGain,
        force_zero_offset::ForceZeroOffset,
        force_drift::ForceDrift,
    }
    of a joint only: {
        kinking::Kinking,
        wrapping_loss::WrappingLoss,
        joint_friction::JointFriction,
        attachment_shift::AttachmentShift,
    }
}

/// The place in [`all`] of an effect.
pub fn index(id: &str) -> Option<usize> {
    all().iter().position(|e| e.id() == id)
}
