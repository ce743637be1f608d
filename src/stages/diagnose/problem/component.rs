//! The nuisance components, by their numbers, and the classes of noise: what is plausible of each.

use crate::base::Base;
use crate::data::Data;
use crate::{settings, slack};
use pipeline_inference::problem::Component;
use pipeline_inference::variance::{Prior, Scale};

/// Gain of a specimen, relative.
pub const GAIN: usize = 0;
/// Set length of a session, mm.
pub const SET_LENGTH: usize = 1;
/// Zero of the force of a session, N.
pub const ZERO: usize = 2;
/// Resting length of a specimen, in units of its declared standard deviation, or of that of rounding to 1 mm.
pub const REST_LENGTH: usize = 3;
/// The same of its contracted length.
pub const CONTRACTED_LENGTH: usize = 4;
/// Misfit that all specimens share, share of the force.
pub const COMMON_MISFIT: usize = 5;
/// Misfit of a session along the pressure, share of the force.
pub const SESSION_MISFIT: usize = 6;
/// Gain of a campaign of a pool, relative.
pub const CAMPAIGN_GAIN: usize = 7;
/// Zero of the force of a campaign of a pool, N.
pub const CAMPAIGN_ZERO: usize = 8;
/// Misfit of a stroke (the filling or the venting of one log) along the pressure, share of the force.
pub const STROKE_MISFIT: usize = 9;
/// Set length of a session for which its standard deviation is declared, in units of that.
pub const DECLARED_LENGTH: usize = 10;
/// How much longer a specimen is at 620 kPa than noted, rounding apart, as a share of its resting length; where nobody declares how well that is known.
pub const CONTRACTION: usize = 11;
/// Share of what the contractions that are noted at 620 kPa differ by that is an error of noting ([`noting_error`]): 0 believes what was noted, 1 gives all
/// specimens the mean. One number of all specimens, in standard deviations from the usual share; where nobody declares how well their contracted lengths
/// are known.
pub const NOTING_ERROR: usize = 12;
/// What the force wanders by within a stroke, N: noise that is correlated in time. No other component stands behind it: a search has none.
pub const WANDER: usize = 13;

/// The share of what noted contractions differ by that is an error, at a value of [`NOTING_ERROR`].
pub fn noting_error(value: f64) -> f64 {
    let (usual, sd) = settings::NOTING_ERROR;
    usual + sd * value
}

/// The components of a campaign or pool.
pub(super) fn components(base: &Base, data: &Data, pooled: bool, strokes: usize) -> Vec<Component> {
    let sessions = data.sessions.len();
    let component = |prior, usual, linear, calibrates, misfit| Component {
        scale: Scale {
            prior,
            usual,
            groups: 1,
        },
        linear,
        calibrates,
        misfit,
    };
    let misfit = |scale: f64| component(Prior::HalfNormal(scale), scale, true, false, true);
    let scatter = |usual: f64, groups: usize| {
        let prior = Prior::HalfNormal(settings::LARGEST_SCATTER * usual);
        with_groups(component(prior, usual, false, true, false), groups)
    };
    let pool = |usual: f64| {
        let prior = if pooled {
            Prior::Free
        } else {
            Prior::Fixed(0.0)
        };
        component(prior, usual, false, true, false)
    };
    vec![
        scatter(settings::USUAL_GAIN, data.specimens.len()),
        scatter(settings::USUAL_SET_LENGTH_MM, sessions),
        scatter(settings::USUAL_ZERO_N, sessions),
        component(Prior::Fixed(1.0), 1.0, true, true, false),
        component(Prior::Fixed(1.0), 1.0, true, true, false),
        misfit(base.common_misfit()),
        with_groups(misfit(settings::SESSION_MISFIT), sessions),
        pool(settings::USUAL_GAIN),
        pool(settings::USUAL_ZERO_N),
        with_groups(
            component(
                Prior::HalfNormal(settings::LARGEST_SCATTER * settings::USUAL_STROKE),
                settings::USUAL_STROKE,
                true,
                false,
                true,
            ),
            strokes,
        ),
        component(Prior::Fixed(1.0), 1.0, false, true, false),
        with_groups(
            component(
                Prior::HalfNormal(settings::LARGEST_SCATTER * settings::USUAL_CONTRACTION),
                settings::USUAL_CONTRACTION,
                true,
                true,
                false,
            ),
            (0..data.specimens.len())
                .filter(|k| !data.contracted_is_declared(*k))
                .count()
                .max(1),
        ),
        component(Prior::Fixed(1.0), 1.0, false, true, false),
    ]
}

/// [`WANDER`], of so many strokes, where the largest force is `largest_n`.
pub(super) fn wander(strokes: usize, largest_n: f64) -> Component {
    let usual = settings::USUAL_WANDER * largest_n;
    Component {
        scale: Scale {
            prior: Prior::HalfNormal(settings::LARGEST_SCATTER * usual),
            usual,
            groups: strokes,
        },
        linear: true,
        calibrates: false,
        misfit: false,
    }
}

fn with_groups(mut component: Component, groups: usize) -> Component {
    component.scale.groups = groups;
    component
}

/// The noise of each class of readings: of every campaign, which is estimated, and of the parts of the corner to slackness.
pub(super) fn noise(campaigns: usize, largest_n: f64) -> Vec<Scale> {
    let in_corner = Prior::Held(settings::CORNER_WIDTH * largest_n);
    let priors = vec![Prior::Free; campaigns].into_iter();
    priors
        .chain([in_corner; slack::BANDS])
        .map(|prior| Scale {
            prior,
            usual: 0.01 * largest_n,
            groups: 1,
        })
        .collect()
}
