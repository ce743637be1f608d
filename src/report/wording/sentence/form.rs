//! Whether one number is enough for the size of an effect.

use crate::number::Rounding;
use crate::wording::name::{self};
use crate::wording::number::{equals_probability, plain, rounded, with_unit};
use pipeline_findings::{EffectFinding, FormPoint, FreeForm};

/// A range that is shorter than this share of its larger end says nothing of a change along it; sizes on the other side of 0 by less than this share of
/// their range are no change of sign.
const NARROW: f64 = 0.1;

/// `Its size changes with the force: one number is not enough (p = 0.01).`, or that one number is enough over the range in which it acts; none where
/// that was not asked.
pub fn form(effect: &EffectFinding) -> Option<String> {
    let free = effect.free_form.as_ref()?;
    let along = name::column(&free.argument);
    let p = equals_probability(free.p);
    let range = range_of(free);
    Some(match range {
        Some(range) if is_narrow(range) => format!(
            "Whether its size changes with the {along} cannot be determined: it acts only {}.",
            range_words(range, &free.unit)
        ),
        _ if free.differs => format!(
            "Its size changes with the {along}{}: one value is not enough (p {p}).",
            between_ends(effect, free)
        ),
        Some(range) => format!(
            "One value is enough for its size over the {along} range in which it acts, {} (p {p}).",
            range_words(range, &free.unit)
        ),
        None => format!("One value is enough for its size, whatever the {along} (p {p})."),
    })
}

/// That a size has no interval: the readings tell that the effect is there, and not how large.
pub(super) fn undetermined(effect: &EffectFinding) -> Option<String> {
    let size = effect.parameters.first()?;
    let is_open = size.ci_low.is_none() && size.ci_high.is_none();
    is_open.then(|| "its size is not determined by these readings".to_owned())
}

/// `varies with the pressure: 4.1 to 14.4 N, everything else refitted`, of a size that varies by more than itself, so that one value beside its name
/// would mislead; of one that even changes its sign, which no such effect does, or is nowhere as large as its one value, that something else may stand
/// behind it.
pub(super) fn varying(effect: &EffectFinding) -> Option<String> {
    let free = effect.free_form.as_ref().filter(|free| free.differs)?;
    let size = effect.parameters.first()?;
    let sizes = || free.curve.iter().map(|point| point.amplitude);
    let (low, high) = (
        sizes().fold(f64::MAX, f64::min),
        sizes().fold(f64::MIN, f64::max),
    );
    let is_misleading = high - low > size.value.abs() && !is_narrow(range_of(free)?);
    is_misleading.then(|| {
        let along = name::column(&free.argument);
        let is_large = (-low).min(high) > NARROW * (high - low);
        if is_large && is_surely_of_both_signs(free) {
            return format!("changes its sign along the {along}: perhaps another effect");
        }
        if !(low..=high).contains(&size.value) {
            return format!("has no one size along the {along}: perhaps another effect");
        }
        let rounding = Rounding::ByInterval { low, high };
        format!(
            "varies with the {along}: {} to {}, everything else refitted",
            rounded(low, rounding),
            with_unit(&rounded(high, rounding), &size.unit)
        )
    })
}

/// Whether the intervals of a size exclude 0 on either side of it, each somewhere.
fn is_surely_of_both_signs(free: &FreeForm) -> bool {
    free.curve.iter().any(|p| p.low > 0.0) && free.curve.iter().any(|p| p.high < 0.0)
}

/// `, from 101 kPa at 38 kPa to 309 kPa at 625 kPa, everything else refitted`: the sizes at the ends of the range, and between them where it is largest
/// or smallest there: the ends alone would say that nothing is between.
fn between_ends(effect: &EffectFinding, free: &FreeForm) -> String {
    let ends = free.curve.first().zip(free.curve.last());
    let (Some((first, last)), Some(size)) = (ends, effect.parameters.first()) else {
        return String::new();
    };
    let end = |point: &FormPoint| {
        let at = with_unit(&rounded(point.at, Rounding::Digits(2)), &free.unit);
        format!("{} at {at}", plain(point.amplitude, &size.unit))
    };
    let between = beyond(&free.curve, size.value)
        .map_or(String::new(), |point| format!(" through {}", end(point)));
    let (first, last) = (end(first), end(last));
    format!(", from {first}{between} to {last}, everything else refitted")
}

/// The point of a curve that lies furthest beyond the sizes at both ends; none where none does by more than a tenth of the curve's range and the one
/// size lies between those at the ends.
fn beyond(curve: &[FormPoint], one_size: f64) -> Option<&FormPoint> {
    let (first, last) = (curve.first()?.amplitude, curve.last()?.amplitude);
    let outside = |x: f64| (first.min(last) - x).max(x - first.max(last));
    let sizes = || curve.iter().map(|p| p.amplitude);
    let range = sizes().fold(f64::MIN, f64::max) - sizes().fold(f64::MAX, f64::min);
    let furthest = curve
        .iter()
        .max_by(|a, b| outside(a.amplitude).total_cmp(&outside(b.amplitude)))?;
    let least = if outside(one_size) > 0.0 {
        0.0
    } else {
        NARROW * range
    };
    (outside(furthest.amplitude) > least).then_some(furthest)
}

/// The range of the argument over which the size of an effect was looked at.
fn range_of(free: &FreeForm) -> Option<(f64, f64)> {
    let ends = free.curve.first().zip(free.curve.last());
    ends.map(|(first, last)| (first.at, last.at))
}

/// Whether a range is so short that no change along it could be seen.
fn is_narrow((low, high): (f64, f64)) -> bool {
    high - low < NARROW * low.abs().max(high.abs())
}

fn range_words((low, high): (f64, f64), unit: &str) -> String {
    let rounding = Rounding::ByInterval { low, high };
    let high = with_unit(&rounded(high, rounding), unit);
    format!("from {} to {high}", rounded(low, rounding))
}
