//! Errors of every test: rigid, with the effects, held out, and as the measurers did it, with sizes from the configuration with most readings alone.
//!
//! Tests that take no part in fits are here too. An actuator that would push is taken as slack.

use super::data::Reading;
use super::terms::{SIZES, place};
use crate::errors::Size;
use pipeline_numerics::statistics::mean;
use serde::{Deserialize, Serialize};

/// Offsets of a test's own length that are looked at, mm.
const REACH_MM: f64 = 60.0;
/// To which they are found, mm.
const FOUND_MM: f64 = 0.01;

/// The errors of one test, N.m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TestErrors {
    /// Session id.
    pub session: String,
    /// Actuator.
    pub specimen: String,
    /// Whether it takes part in fits.
    pub fitted: bool,
    /// Rigid.
    pub before: Option<Size>,
    /// With the effects, found and fitted on all tests that take part.
    pub after: Option<Size>,
    /// With the effects that the search finds without the actuator; of a test that its owner holds out, with those found on all others; none
    /// for tests that take no part, and where there is one actuator only.
    pub held_out: Option<Size>,
    /// With the effects found on all tests, their sizes fitted to the configuration with most readings alone, as the measurers did.
    pub from_largest: Option<Size>,
    /// Whether it is of that configuration.
    pub in_largest: bool,
    /// By how much the test's own offset of the length differs from what was fitted to all, mm: how it was mounted, or how long the actuator is.
    pub own_offset_mm: f64,
    /// With that offset of its own: what no value for all tests can do better than.
    pub with_own_offset: Option<Size>,
    /// Root mean square of the arm measured by hand less the rigid one, m.
    pub arm_before_m: Option<f64>,
    /// The same with the attachments as the effects move them.
    pub arm_after_m: Option<f64>,
    /// Root mean square of the length measured by hand less the rigid one, m.
    #[serde(default)]
    pub length_before_m: Option<f64>,
    /// The same with the effects.
    #[serde(default)]
    pub length_after_m: Option<f64>,
}

/// The sizes with which a test is predicted.
pub struct Predictors<'s> {
    /// Of the effects that were found on all tests.
    pub all: &'s [f64; SIZES],
    /// Without the test's actuator, where it is held out.
    pub held_out: Option<&'s [f64; SIZES]>,
    /// Fitted to the largest configuration, where there are others.
    pub largest: Option<&'s [f64; SIZES]>,
}

/// Errors of readings with effects of these sizes.
pub fn size(readings: &[Reading], sizes: &[f64; SIZES]) -> Option<Size> {
    let pair = |r: &Reading| Some((r.torque_nm, r.shown(sizes)?.torque));
    let pairs: Option<Vec<(f64, f64)>> = readings.iter().map(pair).collect();
    Size::new(&pairs?)
}

/// The errors of one test, whose readings these are.
pub fn errors(
    (session, specimen): (&str, &str),
    readings: &[Reading],
    (fitted, in_largest): (bool, bool),
    with: &Predictors,
) -> TestErrors {
    let rigid = [0.0; SIZES];
    let (own_offset_mm, with_own_offset) = with_own_offset(with.all, readings);
    TestErrors {
        session: session.to_owned(),
        specimen: specimen.to_owned(),
        fitted,
        before: size(readings, &rigid),
        after: size(readings, with.all),
        held_out: with.held_out.and_then(|s| size(readings, s)),
        from_largest: with.largest.and_then(|s| size(readings, s)),
        in_largest,
        own_offset_mm,
        with_own_offset,
        arm_before_m: arm_miss(readings, &rigid),
        arm_after_m: arm_miss(readings, with.all),
        length_before_m: length_miss(readings, &rigid),
        length_after_m: length_miss(readings, with.all),
    }
}

fn rms(of: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let squares: Vec<f64> = of.flatten().map(|x| x * x).collect();
    (!squares.is_empty()).then(|| mean(&squares).sqrt())
}

fn arm_miss(readings: &[Reading], sizes: &[f64; SIZES]) -> Option<f64> {
    rms(readings
        .iter()
        .map(|r| Some(r.by_hand.arm_m? - r.shown(sizes)?.arm)))
}

fn length_miss(readings: &[Reading], sizes: &[f64; SIZES]) -> Option<f64> {
    rms(readings
        .iter()
        .map(|r| Some(r.by_hand.length_m? - r.shown(sizes)?.length)))
}

/// The sizes with so much more of an offset of the length, mm.
fn shifted(sizes: &[f64; SIZES], more: f64) -> [f64; SIZES] {
    let mut own = *sizes;
    own[place::LENGTH] += more;
    own
}

/// The offset that is best for some readings, all other sizes held, less that of the fit, mm; and the errors with it.
pub(super) fn with_own_offset(sizes: &[f64; SIZES], readings: &[Reading]) -> (f64, Option<Size>) {
    let with = |more: f64| size(readings, &shifted(sizes, more));
    let offset = narrowed(REACH_MM, |more| with(more).map_or(f64::INFINITY, |s| s.sse));
    (offset, with(offset))
}

/// Where a function of a length in mm is least, up to `reach` mm from 0. A search on a grid that narrows: one number, and a sum of squares may have
/// several minima where forces are cut off at zero.
pub(super) fn narrowed(reach: f64, of: impl Fn(f64) -> f64) -> f64 {
    let (mut best, mut step) = (0.0, reach / 16.0);
    while step > FOUND_MM {
        let near = (-16..=16).map(|k| best + f64::from(k) * step);
        let near = near.filter(|x| x.abs() <= reach);
        let least = near.map(|x| (x, of(x))).min_by(|a, b| a.1.total_cmp(&b.1));
        best = least.map_or(best, |(x, _)| x);
        step /= 8.0;
    }
    best
}
