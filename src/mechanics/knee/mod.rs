//! The knee: joints, routes over them, moment arms, and the torque of actuators and of human muscles.
//!
//! | module | idea |
//! |---|---|
//! | [`description`] | a knee in TOML: joint, routes, muscles; the shipped ones, and a laboratory's own |
//! | [`choice`] | which knee and route a session means |
//! | [`joint`], [`four_bar`] | where the tibia stands at an angle: pinned, translating (Gait2392), tabulated centre, four-bar linkage |
//! | [`route`] | the points that a muscle runs through, and the angles at which each takes part |
//! | [`path`] | a [`Leg`] is a joint with a route: length, moment arm by virtual work and by projection, switches |
//! | [`torque`] | M = r F(eps*, P*, l_rest) with any registered force model; back-calculated torque |
//! | [`series`] | tendon and brackets that yield, and the force at which all balances |
//! | [`hill`] | the human muscle: Hill type, elastic tendon in equilibrium |
//! | [`human`] | the human muscles by name, and where an actuator meets them |
//! | [`stress`] | axial stress in the actuator's wall |
//! | [`data`] | embedded tables: Table 1, bracket points, OpenSim's exports, the laboratory's design targets |
//!
//! Conventions (those of the paper and of OpenSim): right leg; x forward, y up, z to the right; the knee angle theta is 0 with the leg
//! straight, **flexion negative**; moment arm and torque have the sign of the torque, flexion negative. Metres, rad, N, kPa, N.m; files give
//! angles in degrees where people write them.
//!
//! ```
//! use pipeline_mechanics::knee::{self, Setup};
//! let knees = knee::shipped().unwrap();
//! let pinned = knees.iter().find(|k| k.name == "pinned").unwrap();
//! let leg = pinned.leg("flexor").unwrap();
//! let setup = Setup {
//!     diameter_mm: 10.0,
//!     rest_length_m: 0.485,
//!     contracted_length_m: 0.398,
//!     fitting_m: 0.0254,
//!     tendon_m: 0.0,
//! };
//! let model = &pipeline_mechanics::models::knee_paper::KneePaper;
//! let bent = leg.torque(&setup, model, 605.7, -0.5).unwrap();
//! assert!(bent.torque_nm.unwrap() < 0.0);
//! ```
//!
//! Architecture invariant: nothing here does I/O, sees a data frame or fits. Whatever may be fitted (compliances) carries derivatives.

pub mod choice;
pub mod data;
pub mod description;
pub mod four_bar;
pub mod hill;
pub mod human;
pub mod joint;
pub mod path;
pub mod route;
pub mod series;
pub mod stress;
pub mod torque;

pub use description::{Knee, shipped};
pub use path::{Centre, Geometry, Leg, Projection, Switch};
pub use series::{Balance, Bracket, Published, Pull, Series};
pub use torque::{Setup, Torque};

use std::fmt;

/// Coordinates in a body's frame, m: x forward, y up, z to the right.
pub type Point<R> = [R; 3];

/// An angle at which a leg has no geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beyond {
    /// The angle, rad.
    pub angle: f64,
    /// The range of the joint or the patella, rad.
    pub range: (f64, f64),
}

impl fmt::Display for Beyond {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (low, high) = self.range;
        write!(
            f,
            "knee angle {:.2} deg outside {:.2} to {:.2} deg",
            self.angle.to_degrees(),
            low.to_degrees(),
            high.to_degrees()
        )
    }
}

impl std::error::Error for Beyond {}
