//! The effects that a simulated campaign can have: one file an effect, one entry in [`EFFECTS`].
//!
//! An effect is an operator at one link of the measurement chain ([`super::chain`]). It comes in forms: the first is the plain
//! operator of the library (`form = "operator"`, or its own name), the others are what nature might do instead. They differ from
//! the plain one by some percent of the effect, so that a search that knows the plain operator only is not given its own formula.
//!
//! Architecture invariant: nothing here but the ids and the reference pressure of 620 kPa is shared with the search for effects
//! ([`library`](pipeline_effects)). Both agree only if both are right.
//!
//! Throughout, F is in N, P in kPa, l in m, t in s; the sign s is -1 while filling and +1 while venting.

pub mod age;
pub mod bladder_threshold;
pub mod conditioning;
pub mod creep;
pub mod force_drift;
pub mod force_gain;
pub mod force_zero_offset;
pub mod humidity;
pub mod hysteresis;
pub mod length_offset;
pub mod misalignment;
pub mod pressure_gain;
pub mod pressure_zero_offset;
pub mod rate_dependence;
pub mod sensor_curvature;
pub mod series_compliance;
pub mod specimen_variation;
pub mod temperature;
pub mod unknown_column;

use super::moment::Moment;

/// Every effect, in the order of the alphabet.
pub static EFFECTS: &[&Effect] = &[
    &age::EFFECT,
    &bladder_threshold::EFFECT,
    &conditioning::EFFECT,
    &creep::EFFECT,
    &force_drift::EFFECT,
    &force_gain::EFFECT,
    &force_zero_offset::EFFECT,
    &humidity::EFFECT,
    &hysteresis::EFFECT,
    &length_offset::EFFECT,
    &misalignment::EFFECT,
    &pressure_gain::EFFECT,
    &pressure_zero_offset::EFFECT,
    &rate_dependence::EFFECT,
    &sensor_curvature::EFFECT,
    &series_compliance::EFFECT,
    &specimen_variation::EFFECT,
    &temperature::EFFECT,
    &unknown_column::EFFECT,
];

/// Where in the chain an operator works, in the order of the chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    /// On the pressure that drives the actuator, kPa.
    Pressure,
    /// On the length of the actuator, m, whatever the force.
    Length,
    /// On the length of the actuator, m, given the axial force that pulls at the frame: force and length are solved together.
    Frame,
    /// On the force of the actuator, N. A slack actuator stays slack, and none pushes.
    Actuator,
    /// On the force that the sensor receives, N.
    ForceSensor,
    /// On the pressure that the sensor shows, kPa.
    PressureSensor,
}

/// The column that an effect follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// None.
    None,
    /// The declared column of this name.
    Named(&'static str),
    /// The declared column that the key `column` names.
    Chosen,
}

/// A number of an effect's table.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Key, unit in the name.
    pub key: &'static str,
    /// Unit, for messages.
    pub unit: &'static str,
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Value where the key is left out; `None` where it must stand.
    pub default: Option<f64>,
    /// Value that does nothing: the mean of a drawn size whose key is left out.
    pub neutral: f64,
}

impl Parameter {
    /// The size of an effect; 0 does nothing.
    pub const fn size(key: &'static str, unit: &'static str, low: f64, high: f64) -> Self {
        Self {
            key,
            unit,
            low,
            high,
            default: None,
            neutral: 0.0,
        }
    }

    /// A gain; 1 does nothing.
    pub const fn gain(key: &'static str) -> Self {
        Self {
            neutral: 1.0,
            ..Self::size(key, "1", 0.5, 2.0)
        }
    }

    /// Another number of the form, with its default.
    pub const fn other(
        key: &'static str,
        unit: &'static str,
        (low, high): (f64, f64),
        default: f64,
    ) -> Self {
        Self {
            default: Some(default),
            ..Self::size(key, unit, low, high)
        }
    }
}

/// Most parameters of a form.
pub const MOST_PARAMETERS: usize = 3;

/// What an operator is given beside the moment and the quantity it works on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// The parameters, in the order of [`Form::parameters`].
    pub p: [f64; MOST_PARAMETERS],
    /// Value of the effect's column now; 0 without one.
    pub column: f64,
}

/// One form of an effect.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// Name in the truth file.
    pub name: &'static str,
    /// Where it works.
    pub link: Link,
    /// Its numbers; the first is the size, which may be drawn.
    pub parameters: &'static [Parameter],
    /// The operator: the quantity of the link after the effect, from the quantity before it.
    pub act: fn(&Given, &Moment, f64) -> f64,
    /// Drawn sizes lie one standard deviation above or below the mean, as in two batches, and nowhere between.
    pub two_batches: bool,
}

impl Form {
    /// A form whose drawn sizes are normal.
    pub const fn new(
        name: &'static str,
        link: Link,
        parameters: &'static [Parameter],
        act: fn(&Given, &Moment, f64) -> f64,
    ) -> Self {
        Self {
            name,
            link,
            parameters,
            act,
            two_batches: false,
        }
    }
}

/// What shares one drawn size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Per {
    /// A session.
    Session,
    /// A specimen.
    Specimen,
    /// A log.
    Log,
}

/// An effect: id, the column it follows, its forms.
#[derive(Debug)]
pub struct Effect {
    /// Id in the truth file: that of the library, where it has the effect.
    pub id: &'static str,
    /// The column that it follows.
    pub column: Column,
    /// What shares a drawn size unless the truth file says otherwise.
    pub per: Per,
    /// The plain operator first.
    pub forms: &'static [Form],
}

/// The effect of that id.
pub fn by_id(id: &str) -> Option<&'static Effect> {
    EFFECTS.iter().copied().find(|e| e.id == id)
}

#[cfg(test)]
mod tests;
