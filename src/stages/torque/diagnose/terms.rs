//! The joint's effects: what a leg may have that the rigid one lacks.
//!
//! Ids are those of [`crate::effects`] where an effect is the same thing seen through a torque; equations are in [`super::operator`].

/// An effect of the joint, in one of its forms, with one size.
#[derive(Debug)]
pub struct Term {
    /// Id of the effect, as in files.
    pub id: &'static str,
    /// Name of the form.
    pub form: &'static str,
    /// Name for a reader.
    pub title: &'static str,
    /// The equation, as plain text.
    pub equation: &'static str,
    /// Symbol.
    pub symbol: &'static str,
    /// Unit of the size.
    pub unit: &'static str,
    /// Physically possible sizes; 0 is a leg without the effect.
    pub bounds: (f64, f64),
    /// Up to which size such parts were measured, or are specified: what is larger has probably more in it than its name says.
    pub usual: f64,
    /// Where descents begin.
    pub start: f64,
    /// Where it is described.
    pub source: &'static str,
    /// What would measure it apart from the torque.
    pub measurement: &'static str,
}

/// Number of terms.
pub const TERMS: usize = 13;
/// Most terms of a set.
pub const MOST: usize = 3;

/// Places in [`ALL`] that [`super::operator`] needs by name.
pub mod place {
    /// Offset of the length.
    pub const LENGTH: usize = 0;
    /// Compliance along the actuator.
    pub const AXIAL: usize = 1;
    /// What is loose along the actuator.
    pub const LOOSE: usize = 2;
    /// Bending of the bracket at the origin.
    pub const ORIGIN: usize = 3;
    /// Bending of the bracket at the insertion.
    pub const INSERTION: usize = 4;
    /// Zero of the pressure.
    pub const PRESSURE: usize = 5;
    /// Strength.
    pub const GAIN: usize = 6;
    /// Zero of the torque.
    pub const ZERO: usize = 7;
    /// Kinking from [`super::KINKS_FROM_RAD`] on: two places.
    pub const KINKING: usize = 8;
    /// Wrapping.
    pub const WRAPPING: usize = 10;
    /// Friction.
    pub const FRICTION: usize = 11;
    /// A shuffled column, which must never be chosen.
    pub const PLACEBO: usize = 12;
}

/// Sizes of the knee angle beyond which an actuator may kink, rad (30 and 75 degrees).
pub const KINKS_FROM_RAD: [f64; 2] = [0.523_598_775_598_298_8, 1.308_996_938_995_747_2];

const BRACKETS: &str = "bracket stiffness and series model of the measurers, after the knee paper";
const LOADED: &str =
    "hang a dead weight in place of the actuator and read the bracket's deflection on a dial gauge";

/// Up to which size parts of an effect of a joint, in one of its forms, were measured or are specified, and its unit.
pub fn usual(id: &str, form: &str) -> Option<(f64, &'static str)> {
    let term = ALL.iter().find(|t| t.id == id && t.form == form)?;
    Some((term.usual, term.unit))
}

/// Every term, in the order of [`place`].
pub static ALL: [Term; TERMS] = [
    Term {
        id: "length_offset",
        form: "constant",
        title: "offset of the length (end fittings, attachments)",
        equation: "l_m = L_MT - 2 l_fit - l_tendon - d",
        symbol: "d",
        unit: "mm",
        bounds: (-60.0, 60.0),
        usual: 20.0,
        start: 5.0,
        source: "knee paper, fitted length of the end fittings",
        measurement: "measure clamp to clamp with a caliper at every angle, loaded and unloaded",
    },
    Term {
        id: "series_compliance",
        form: "axial",
        title: "compliance along the actuator (tendon, brackets)",
        equation: "l_m = L_MT - 2 l_fit - l_tendon - C F",
        symbol: "C",
        unit: "um/N",
        bounds: (0.0, 400.0),
        usual: 100.0,
        start: 30.0,
        source: BRACKETS,
        measurement: LOADED,
    },
    Term {
        id: "series_compliance",
        form: "loose",
        title: "what is loose along the actuator and is taken up",
        equation: "l_m = L_MT - 2 l_fit - l_tendon - s F/(F + 100 N)",
        symbol: "s",
        unit: "mm",
        bounds: (0.0, 60.0),
        usual: 20.0,
        start: 5.0,
        source: "series model of the measurers, stiffening: knots, bolts in their holes, a tendon that straightens",
        measurement: LOADED,
    },
    Term {
        id: "series_compliance",
        form: "origin bracket",
        title: "bending of the bracket at the origin",
        equation: "origin moves by C_o F (u - (u.a) a), a from foot to attachment",
        symbol: "C_o",
        unit: "um/N",
        bounds: (0.0, 1000.0),
        usual: 200.0,
        start: 60.0,
        source: BRACKETS,
        measurement: LOADED,
    },
    Term {
        id: "series_compliance",
        form: "insertion bracket",
        title: "bending of the bracket at the insertion",
        equation: "insertion moves by C_i F (u - (u.a) a), a from foot to attachment",
        symbol: "C_i",
        unit: "um/N",
        bounds: (0.0, 1000.0),
        usual: 200.0,
        start: 60.0,
        source: BRACKETS,
        measurement: LOADED,
    },
    Term {
        id: "pressure_zero_offset",
        form: "constant",
        title: "zero of the pressure",
        equation: "P = P_meas - p",
        symbol: "p",
        unit: "kPa",
        bounds: (-60.0, 60.0),
        usual: 20.0,
        start: 5.0,
        source: "data sheets of pressure transducers: offset",
        measurement: "log the pressure channel with the actuator vented",
    },
    Term {
        id: "force_gain",
        form: "strength",
        title: "strength of the actuators",
        equation: "F = g A(l_m, P), reported is g - 1",
        symbol: "g - 1",
        unit: "1",
        bounds: (-0.4, 0.4),
        usual: 0.1,
        start: 0.01,
        source: "force paper, scatter of the actuators' maximum force",
        measurement: "measure the force of the same actuators on the isometric rig",
    },
    Term {
        id: "force_zero_offset",
        form: "torque",
        title: "zero of the torque",
        equation: "M_meas = M + z",
        symbol: "z",
        unit: "N.m",
        bounds: (-10.0, 10.0),
        usual: 1.0,
        start: 0.1,
        source: "data sheets of load cells: zero balance; weight of the leg",
        measurement: "log the torque at every angle with the actuator vented",
    },
    Term {
        id: "kinking",
        form: "past 30 deg",
        title: "kinking",
        equation: "M = r F (1 - c (|theta| - 30 deg)) past 30 deg",
        symbol: "c",
        unit: "1/rad",
        bounds: (0.0, 2.0),
        usual: 1.0,
        start: 0.02,
        source: "knee paper, last section: M = r (F - c F theta)",
        measurement: "photograph the actuator at large flexion and look for the kink",
    },
    Term {
        id: "kinking",
        form: "past 75 deg",
        title: "kinking",
        equation: "M = r F (1 - c (|theta| - 75 deg)) past 75 deg",
        symbol: "c",
        unit: "1/rad",
        bounds: (0.0, 2.0),
        usual: 1.0,
        start: 0.02,
        source: "knee paper, last section: M = r (F - c F theta)",
        measurement: "photograph the actuator at large flexion and look for the kink",
    },
    Term {
        id: "wrapping_loss",
        form: "contact",
        title: "part of the actuator wrapped round the knee does not pull",
        equation: "l_m less chi R |theta_wrap - theta| (1 - eps*)^2, R = 30 mm",
        symbol: "chi",
        unit: "1",
        bounds: (0.0, 3.0),
        usual: 2.0,
        start: 0.1,
        source: "series model of the measurers, after the knee paper",
        measurement: "mark the actuator and photograph which part lies on the knee",
    },
    Term {
        id: "joint_friction",
        form: "dry",
        title: "friction of the joint, against the way it turned last",
        equation: "M_meas = M - f s, s = 1 after extension, -1 after flexion",
        symbol: "f",
        unit: "N.m",
        // An actuator's own hysteresis is friction of the other sign where it drives the joint.
        bounds: (-10.0, 10.0),
        usual: 3.0,
        start: 0.1,
        source: "Coulomb friction; sense of motion from the order of the readings",
        measurement: "come to every angle from both sides, and turn the joint with the actuator vented",
    },
    Term {
        id: "placebo",
        form: "shuffled angle",
        title: "a shuffled column",
        equation: "M_meas = M + b x",
        symbol: "b",
        unit: "N.m",
        bounds: (-10.0, 10.0),
        usual: 0.0,
        start: 0.1,
        source: "",
        measurement: "",
    },
];
