//! The joint's effects: what a leg may have that the rigid one lacks.
//!
//! Ids are those of [`pipeline_mechanics::effects`] where an effect is the same thing seen through a torque; equations are in [`super::operator`].

/// An effect of the joint, in one of its forms.
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
    /// Where its sizes stand among all, the first of them: see [`place`].
    pub place: usize,
    /// Symbols of its sizes.
    pub symbols: &'static [&'static str],
    /// Unit of the sizes.
    pub unit: &'static str,
    /// Physically possible sizes; 0 is a leg without the effect.
    pub bounds: (f64, f64),
    /// Up to which size such parts were measured, or are specified: what is larger has probably more in it than its name says.
    pub usual: f64,
    /// Where it is described.
    pub source: &'static str,
    /// What would measure it apart from the torque.
    pub measurement: &'static str,
}

/// Number of forms.
pub const TERMS: usize = 16;
/// Number of sizes: one of most forms, two of a shift.
pub const SIZES: usize = 18;

/// Where sizes stand: [`super::operator`] needs them by name.
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
    /// Threshold of the bladder.
    pub const THRESHOLD: usize = 6;
    /// Gain.
    pub const GAIN: usize = 7;
    /// Zero of the torque.
    pub const ZERO: usize = 8;
    /// Kinking from [`super::KINKS_FROM_RAD`] on: two places.
    pub const KINKING: usize = 9;
    /// Wrapping.
    pub const WRAPPING: usize = 11;
    /// Dry friction.
    pub const FRICTION: usize = 12;
    /// Friction that grows with the load.
    pub const LOADED_FRICTION: usize = 13;
    /// Where the origin is less where it is drawn, x and y: two places.
    pub const ORIGIN_SHIFT: usize = 14;
    /// The same of the insertion.
    pub const INSERTION_SHIFT: usize = 16;
}

/// Sizes of the knee angle beyond which an actuator may kink, rad (30 and 75 degrees).
pub const KINKS_FROM_RAD: [f64; 2] = [0.523_598_775_598_298_8, 1.308_996_938_995_747_2];

const BRACKETS: &str = "bracket stiffness and series model of the measurers, after the knee paper";
const LOADED: &str =
    "hang a dead weight in place of the actuator and read the bracket's deflection on a dial gauge";

const SHIFTED: &str = "knee paper, table of attachments: read off drawings and printed parts";
const PHOTOGRAPHED: &str = "photograph the leg from the side with a scale and read the attachments off, or probe them with a caliper from the joint's axis";

/// Up to which size parts of an effect of a joint, in one of its forms, were measured or are specified, and its unit.
pub fn usual(id: &str, form: &str) -> Option<(f64, &'static str)> {
    let term = ALL.iter().find(|t| t.id == id && t.form == form)?;
    Some((term.usual, term.unit))
}

/// Every form: a further one is one entry here and its operator.
pub static ALL: [Term; TERMS] = [
    Term {
        id: "length_offset",
        form: "constant",
        title: "offset of the length (end fittings, attachments)",
        equation: "l_m = L_MT - 2 l_fit - l_tendon - d",
        place: place::LENGTH,
        symbols: &["d"],
        unit: "mm",
        bounds: (-60.0, 60.0),
        usual: 20.0,
        source: "knee paper, fitted length of the end fittings",
        measurement: "measure clamp to clamp with a caliper at every angle, loaded and unloaded",
    },
    Term {
        id: "series_compliance",
        form: "axial",
        title: "compliance along the actuator (tendon, brackets)",
        equation: "l_m = L_MT - 2 l_fit - l_tendon - C F",
        place: place::AXIAL,
        symbols: &["C"],
        unit: "um/N",
        bounds: (0.0, 400.0),
        usual: 100.0,
        source: BRACKETS,
        measurement: LOADED,
    },
    Term {
        id: "series_compliance",
        form: "loose",
        title: "what is loose along the actuator and is taken up",
        equation: "l_m = L_MT - 2 l_fit - l_tendon - s F/(F + 100 N)",
        place: place::LOOSE,
        symbols: &["s"],
        unit: "mm",
        bounds: (0.0, 60.0),
        usual: 20.0,
        source: "series model of the measurers, stiffening: knots, bolts in their holes, a tendon that straightens",
        measurement: LOADED,
    },
    Term {
        id: "series_compliance",
        form: "origin bracket",
        title: "bending of the bracket at the origin",
        equation: "origin moves by C_o F (u - (u.a) a), a from foot to attachment",
        place: place::ORIGIN,
        symbols: &["C_o"],
        unit: "um/N",
        bounds: (0.0, 1000.0),
        usual: 200.0,
        source: BRACKETS,
        measurement: LOADED,
    },
    Term {
        id: "series_compliance",
        form: "insertion bracket",
        title: "bending of the bracket at the insertion",
        equation: "insertion moves by C_i F (u - (u.a) a), a from foot to attachment",
        place: place::INSERTION,
        symbols: &["C_i"],
        unit: "um/N",
        bounds: (0.0, 1000.0),
        usual: 200.0,
        source: BRACKETS,
        measurement: LOADED,
    },
    Term {
        id: "pressure_zero_offset",
        form: "constant",
        title: "zero of the pressure",
        equation: "P = P_meas - p",
        place: place::PRESSURE,
        symbols: &["p"],
        unit: "kPa",
        bounds: (-60.0, 60.0),
        usual: 20.0,
        source: "data sheets of pressure transducers: offset",
        measurement: "log the pressure channel with the actuator vented",
    },
    Term {
        id: "bladder_threshold",
        form: "constant",
        title: "threshold pressure of the bladder",
        equation: "P -> max(0, P - P_th)",
        place: place::THRESHOLD,
        symbols: &["P_th"],
        unit: "kPa",
        bounds: (0.0, 150.0),
        usual: 60.0,
        source: "pressure that stretches the bladder before the braid carries",
        measurement: "fill slowly at the resting length and read the pressure at which force sets in",
    },
    Term {
        id: "force_gain",
        form: "gain",
        title: "gain of the actuators",
        equation: "F = g A(l_m, P), reported is g - 1",
        place: place::GAIN,
        symbols: &["g - 1"],
        unit: "1",
        bounds: (-0.4, 0.4),
        usual: 0.1,
        source: "force paper, scatter of the actuators' maximum force",
        measurement: "measure the force of the same actuators on the isometric rig",
    },
    Term {
        id: "force_zero_offset",
        form: "torque",
        title: "zero of the torque",
        equation: "M_meas = M + z",
        place: place::ZERO,
        symbols: &["z"],
        unit: "N.m",
        bounds: (-10.0, 10.0),
        usual: 1.0,
        source: "data sheets of load cells: zero balance; weight of the leg",
        measurement: "log the torque at every angle with the actuator vented",
    },
    Term {
        id: "kinking",
        form: "past 30 deg",
        title: "kinking",
        equation: "M = r F (1 - c (|theta| - 30 deg)) past 30 deg",
        place: place::KINKING,
        symbols: &["c"],
        unit: "1/rad",
        bounds: (0.0, 2.0),
        usual: 1.0,
        source: "knee paper, last section: M = r (F - c F theta)",
        measurement: "photograph the actuator at large flexion and look for the kink",
    },
    Term {
        id: "kinking",
        form: "past 75 deg",
        title: "kinking",
        equation: "M = r F (1 - c (|theta| - 75 deg)) past 75 deg",
        place: place::KINKING + 1,
        symbols: &["c"],
        unit: "1/rad",
        bounds: (0.0, 2.0),
        usual: 1.0,
        source: "knee paper, last section: M = r (F - c F theta)",
        measurement: "photograph the actuator at large flexion and look for the kink",
    },
    Term {
        id: "wrapping_loss",
        form: "contact",
        title: "part of the actuator wrapped round the knee does not pull",
        equation: "l_m less chi R |theta_wrap - theta| (1 - eps*)^2, R = 30 mm",
        place: place::WRAPPING,
        symbols: &["chi"],
        unit: "1",
        bounds: (0.0, 3.0),
        usual: 2.0,
        source: "series model of the measurers, after the knee paper",
        measurement: "mark the actuator and photograph which part lies on the knee",
    },
    Term {
        id: "joint_friction",
        form: "dry",
        title: "friction of the joint, against the way it turned last",
        equation: "M_meas = M - f s, s = 1 after extension, -1 after flexion",
        place: place::FRICTION,
        symbols: &["f"],
        unit: "N.m",
        // An actuator's own hysteresis is friction of the other sign where it drives the joint.
        bounds: (-10.0, 10.0),
        usual: 3.0,
        source: "Coulomb friction; sense of motion from the order of the readings",
        measurement: "come to every angle from both sides, and turn the joint with the actuator vented",
    },
    Term {
        id: "joint_friction",
        form: "loaded",
        title: "friction of the joint in proportion to its load, against the way it turned last",
        equation: "M_meas = M - mu |M| s, s = 1 after extension, -1 after flexion",
        place: place::LOADED_FRICTION,
        symbols: &["mu"],
        unit: "1",
        bounds: (-0.5, 0.5),
        usual: 0.1,
        source: "Coulomb friction: what the joint carries grows with the torque; sense of motion from the order of the readings",
        measurement: "come to every angle from both sides, and turn the joint with the actuator vented",
    },
    Term {
        id: "attachment_shift",
        form: "origin",
        title: "origin elsewhere than drawn",
        equation: "origin = drawn + (x, y), in the femur's frame",
        place: place::ORIGIN_SHIFT,
        symbols: &["x", "y"],
        unit: "mm",
        bounds: (-40.0, 40.0),
        usual: 10.0,
        source: SHIFTED,
        measurement: PHOTOGRAPHED,
    },
    Term {
        id: "attachment_shift",
        form: "insertion",
        title: "insertion elsewhere than drawn",
        equation: "insertion = drawn + (x, y), in the tibia's frame",
        place: place::INSERTION_SHIFT,
        symbols: &["x", "y"],
        unit: "mm",
        bounds: (-40.0, 40.0),
        usual: 10.0,
        source: SHIFTED,
        measurement: PHOTOGRAPHED,
    },
];
