//! The joint's effects: which forms of the library ([`pipeline_effects`]) have an operator on the torque, and where their sizes
//! stand. Equations are in [`super::operator`].

use pipeline_effects::{
    JointForm, attachment_shift, bladder_threshold, force_gain, force_zero_offset, joint_friction,
    kinking, length_offset, pressure_zero_offset, series_compliance, wrapping_loss,
};
use std::ops::Deref;

/// A form of the library with the place of its sizes.
#[derive(Debug)]
pub struct Term {
    /// Id of the effect, as in files.
    pub id: &'static str,
    /// Name of the form.
    pub form: &'static str,
    /// Where its sizes stand among all, the first of them: see [`place`].
    pub first: usize,
    /// What the library has of it.
    of_library: &'static JointForm,
}

impl Deref for Term {
    type Target = JointForm;

    fn deref(&self) -> &JointForm {
        self.of_library
    }
}

/// Number of forms.
pub const TERMS: usize = 16;
/// Number of sizes: one of most forms, two of a shift, and what the coefficients of the law are off by.
pub const SIZES: usize = place::LAW + LAW_COEFFICIENTS.len();

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
    /// What the coefficients of the law ([`super::LAW_COEFFICIENTS`]) are off by, relative: no term's, but a random effect of the joint.
    pub const LAW: usize = 18;
}

/// The coefficients of the law that may be off, one place each. What the scale of the force is off by is a gain.
pub const LAW_COEFFICIENTS: [&str; 3] = ["c0", "c1", "c2"];

/// Sizes of the knee angle beyond which an actuator may kink, rad (30 and 75 degrees).
pub const KINKS_FROM_RAD: [f64; 2] = [0.523_598_775_598_298_8, 1.308_996_938_995_747_2];

/// Up to which size parts of an effect of a joint, in one of its forms, were measured or are specified, and its unit.
pub fn usual(id: &str, form: &str) -> Option<(f64, &'static str)> {
    let term = ALL.iter().find(|t| t.id == id && t.form == form)?;
    Some((term.usual, term.unit))
}

const fn term(id: &'static str, of_library: &'static JointForm, first: usize) -> Term {
    Term {
        id,
        form: of_library.name,
        first,
        of_library,
    }
}

/// Every form, in the order in which the search tries them: a further one is its entry in the effect's file, one line here and its operator.
pub static ALL: [Term; TERMS] = [
    term(
        length_offset::ID,
        &length_offset::JOINT_FORMS[0],
        place::LENGTH,
    ),
    term(
        series_compliance::ID,
        &series_compliance::JOINT_FORMS[0],
        place::AXIAL,
    ),
    term(
        series_compliance::ID,
        &series_compliance::JOINT_FORMS[1],
        place::LOOSE,
    ),
    term(
        series_compliance::ID,
        &series_compliance::JOINT_FORMS[2],
        place::ORIGIN,
    ),
    term(
        series_compliance::ID,
        &series_compliance::JOINT_FORMS[3],
        place::INSERTION,
    ),
    term(
        pressure_zero_offset::ID,
        &pressure_zero_offset::JOINT_FORMS[0],
        place::PRESSURE,
    ),
    term(
        bladder_threshold::ID,
        &bladder_threshold::JOINT_FORMS[0],
        place::THRESHOLD,
    ),
    term(force_gain::ID, &force_gain::JOINT_FORMS[0], place::GAIN),
    term(
        force_zero_offset::ID,
        &force_zero_offset::JOINT_FORMS[0],
        place::ZERO,
    ),
    term(kinking::ID, &kinking::JOINT_FORMS[0], place::KINKING),
    term(kinking::ID, &kinking::JOINT_FORMS[1], place::KINKING + 1),
    term(
        wrapping_loss::ID,
        &wrapping_loss::JOINT_FORMS[0],
        place::WRAPPING,
    ),
    term(
        joint_friction::ID,
        &joint_friction::JOINT_FORMS[0],
        place::FRICTION,
    ),
    term(
        joint_friction::ID,
        &joint_friction::JOINT_FORMS[1],
        place::LOADED_FRICTION,
    ),
    term(
        attachment_shift::ID,
        &attachment_shift::JOINT_FORMS[0],
        place::ORIGIN_SHIFT,
    ),
    term(
        attachment_shift::ID,
        &attachment_shift::JOINT_FORMS[1],
        place::INSERTION_SHIFT,
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use pipeline_effects as effects;

    #[test]
    fn every_form_of_the_library_has_one_operator_and_its_sizes_one_place() {
        let mut places = Vec::new();
        let mut forms = 0;
        for effect in effects::all() {
            for form in effect.joint_forms() {
                let is = |t: &&Term| (t.id, t.form) == (effect.id(), form.name);
                let found: Vec<&Term> = ALL.iter().filter(is).collect();
                assert_eq!(found.len(), 1, "{} {}", effect.id(), form.name);
                forms += 1;
                places.extend((0..form.symbols.len()).map(|k| found[0].first + k));
            }
        }
        assert_eq!(forms, TERMS);
        places.sort_unstable();
        assert_eq!(places, (0..place::LAW).collect::<Vec<_>>());
    }
}
