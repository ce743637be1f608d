//! The nuisance components, by their numbers: what is plausible of each.

use crate::diagnose::data::Data;
use crate::diagnose::settings;
use pipeline_diagnose::settings as shared;
use pipeline_inference::problem::Component;
use pipeline_inference::variance::{Prior, Scale};

/// Misfit that all tests share, share of the torque.
pub const COMMON_MISFIT: usize = 0;
/// Gain of an actuator, relative.
pub const GAIN: usize = 1;
/// Mounting of a test, mm.
pub const MOUNTING: usize = 2;
/// Zero of the torque of a test, N.m.
pub const ZERO: usize = 3;
/// Misfit of a test along the angle, share of the torque.
pub const TEST_MISFIT: usize = 4;
/// Bias of a test's hand-measured lengths, mm.
pub const LENGTH_BIAS: usize = 5;
/// Bias of a test's hand-measured arms, mm.
pub const ARM_BIAS: usize = 6;
/// Friction at those readings of a test before which nobody knows how the joint turned, N.m.
pub const UNKNOWN_SENSE: usize = 7;
/// What the coefficients of the law are off by, in units of [`settings::LAW_SD`].
pub const LAW: usize = 8;

pub(super) fn components(data: &Data, actuators: usize, tests: usize) -> Vec<Component> {
    let of = |scale: f64, usual: f64, groups: usize| Component {
        scale: Scale {
            prior: Prior::HalfNormal(scale),
            usual,
            groups,
        },
        linear: true,
        calibrates: false,
        misfit: false,
    };
    let misfit = |scale: f64, groups: usize| Component {
        misfit: true,
        ..of(scale, scale, groups)
    };
    let scatter = |usual: f64, groups: usize| of(shared::LARGEST_SCATTER * usual, usual, groups);
    let known = |component: Component, linear: bool| Component {
        linear,
        calibrates: true,
        ..component
    };
    let bias = || of(settings::USUAL_BIAS_MM, settings::USUAL_BIAS_MM, tests);
    vec![
        misfit(settings::COMMON_MISFIT, tests),
        known(
            of(settings::LARGEST_GAIN, shared::USUAL_GAIN, actuators),
            false,
        ),
        known(
            of(
                settings::LARGEST_MOUNTING_MM,
                settings::USUAL_MOUNTING_MM,
                tests,
            ),
            false,
        ),
        known(scatter(settings::USUAL_ZERO * data.largest_nm, tests), true),
        misfit(shared::SESSION_MISFIT, tests),
        bias(),
        bias(),
        scatter(settings::USUAL_ZERO * data.largest_nm, tests),
        Component {
            scale: Scale {
                prior: Prior::Fixed(1.0),
                usual: 1.0,
                groups: 1,
            },
            ..of(1.0, 1.0, 1)
        },
    ]
}
