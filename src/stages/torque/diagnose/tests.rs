//! Errors of every test: rigid, with the effects, held out, and as the measurers did it, with sizes from the configuration with most readings alone.

use super::Group;
use super::nuisance::Spreads;
use super::refit::{Reading, Sizes};
use super::terms::{ALL, place};
use crate::stages::torque::errors::Size;
use serde::{Deserialize, Serialize};

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
    /// With the effects that the search finds without the actuator (or stretch of the angle); of a test that its owner holds out, with those
    /// found on all others; none for tests that take no part.
    pub held_out: Option<Size>,
    /// With the effects found on all tests, their sizes fitted to the configuration with most readings alone, as the measurers did.
    pub from_largest: Option<Size>,
    /// Whether it is of that configuration.
    pub in_largest: bool,
    /// By how much the test's own offset of the length differs from what was fitted to all, mm: how it was mounted, or how long the actuator is.
    pub own_offset_mm: f64,
    /// With that offset of its own: what no value for all tests can do better than.
    pub with_own_offset: Option<Size>,
    /// Root mean square of the arm measured by hand less the rigid one, m; no hand-measured arm enters any fit.
    pub arm_before_m: Option<f64>,
    /// The same with the attachments as the effects move them.
    pub arm_after_m: Option<f64>,
}

/// The errors of every test of a joint.
pub(super) fn errors(
    group: &Group,
    sizes: &Sizes,
    held_out: &[(usize, Sizes)],
    fold: fn(&Reading) -> usize,
    largest: Option<&(Vec<usize>, Sizes)>,
) -> Vec<TestErrors> {
    let rigid = Sizes::rigid(&[], &Spreads::before(1.0));
    let one = |(number, session): (usize, &&str)| {
        let with_arms = group.all.iter().zip(&group.arms_by_hand);
        let (readings, arms): (Vec<Reading>, Vec<Option<f64>>) =
            with_arms.filter(|(r, _)| r.test == number).unzip();
        let size = |of: &dyn Fn(&Reading) -> Option<f64>| {
            let pairs: Option<Vec<(f64, f64)>> = readings
                .iter()
                .map(|r| Some((r.torque_nm, of(r)?)))
                .collect();
            Size::new(&pairs?)
        };
        let arm = |sizes: &Sizes| {
            let differences = readings.iter().zip(&arms);
            let squares: Vec<f64> = differences
                .filter_map(|(r, arm)| {
                    let miss = arm.as_ref()?.abs() - sizes.predict(r).1.abs();
                    Some(miss * miss)
                })
                .collect();
            let n = squares.len() as f64;
            (n > 0.0).then(|| (squares.iter().sum::<f64>() / n).sqrt())
        };
        if readings.is_empty() {
            return None;
        }
        let (fitted, held) = (group.fitted[number], group.held[number]);
        let without = |r: &Reading| match held {
            true => Some(sizes),
            false => {
                let of_fold = held_out.iter().find(|(f, _)| fitted && *f == fold(r));
                of_fold.map(|(_, sizes)| sizes)
            }
        };
        let own_offset_mm = own_offset(sizes, &readings);
        let with_own = shifted(sizes, own_offset_mm);
        Some(TestErrors {
            session: (*session).to_owned(),
            specimen: readings
                .first()
                .map_or(String::new(), |r| group.actuators[r.actuator].to_owned()),
            fitted,
            before: size(&|r| Some(rigid.predict(r).0)),
            after: size(&|r| Some(sizes.predict(r).0)),
            held_out: size(&|r| Some(without(r)?.predict(r).0)),
            from_largest: size(&|r| Some(largest?.1.predict(r).0)),
            in_largest: largest.is_some_and(|(tests, _)| tests.contains(&number)),
            own_offset_mm,
            with_own_offset: size(&|r| Some(with_own.predict(r).0)),
            arm_before_m: arm(&rigid),
            arm_after_m: arm(sizes),
        })
    };
    group.sessions.iter().enumerate().filter_map(one).collect()
}

/// The sizes with so much more of an offset of the length, mm.
fn shifted(sizes: &Sizes, more: f64) -> Sizes {
    let mut own = sizes.clone();
    own.values[place::LENGTH] = sizes.values[place::LENGTH] + more;
    own
}

/// The offset that is best for some readings, all other sizes held, less that of the fit; mm. A search on a grid that halves: one number, and
/// the sum of squares may have several minima where forces are cut off at zero.
fn own_offset(sizes: &Sizes, readings: &[Reading]) -> f64 {
    let sse = |more: f64| -> f64 {
        let residuals = shifted(sizes, more).residuals(readings);
        residuals.iter().map(|r| r * r).sum()
    };
    let reach = ALL[place::LENGTH].bounds.1;
    let (mut best, mut step) = (0.0, reach / 16.0);
    while step > 0.01 {
        let near = (-16..=16).map(|k| best + f64::from(k) * step);
        let near = near.filter(|x| x.abs() <= reach);
        best = near
            .min_by(|a, b| sse(*a).total_cmp(&sse(*b)))
            .unwrap_or(best);
        step /= 8.0;
    }
    best
}
