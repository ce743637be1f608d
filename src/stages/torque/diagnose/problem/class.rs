//! The classes of noise, by their numbers: what is known of each.

use crate::diagnose::data::Data;
use crate::diagnose::settings;
use pipeline_inference::variance::{Prior, Scale};

/// Torques, N.m.
pub const TORQUE: usize = 0;
/// Torques in the corner to slackness.
pub const CORNER: usize = 1;
/// Lengths by hand, mm.
pub const LENGTH: usize = 2;
/// Arms by hand, mm.
pub const ARM: usize = 3;

/// What is known of the noise of each class.
pub(super) fn noise(data: &Data, lengths: usize, arms: usize) -> Vec<Scale> {
    let scale = |prior, usual| Scale {
        prior,
        usual,
        groups: 1,
    };
    let by_hand = |count: usize, declared: Option<f64>, usual: f64| match declared {
        Some(sd) => scale(Prior::Fixed(sd), sd),
        None if count < settings::FEWEST_FOR_NOISE => scale(Prior::Fixed(usual), usual),
        None => scale(Prior::Free, usual),
    };
    let torque = 0.01 * data.largest_nm;
    vec![
        scale(Prior::Free, torque),
        scale(Prior::Held(settings::NEAR_SLACK * data.largest_nm), torque),
        by_hand(
            lengths,
            data.declared_sd_mm(|h| h.length_sd_m),
            settings::LENGTH_SD_MM,
        ),
        by_hand(
            arms,
            data.declared_sd_mm(|h| h.arm_sd_m),
            settings::ARM_SD_MM,
        ),
    ]
}
