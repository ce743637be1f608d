//! The rules of consistency, one file each, and their order in the report. None knows a particular claim.

mod copied_rows;
mod implied_spread;
mod intervals;
mod pairs;
mod ranges;
mod residuals;
mod robust_scale;
mod same_quantity;
mod train_and_validation;

use super::claims::{Claim, ClaimList, Fit, Kind, Split};
use super::findings::Rule;
use super::recompute::{Depth, evaluate};
use pipeline_numerics::distributions::f_upper_tail;

/// Every rule. A new one is a file and a line here.
pub const ALL: &[Rule] = &[
    same_quantity::RULE,
    copied_rows::RULE,
    train_and_validation::RULE,
    robust_scale::RULE,
    implied_spread::RULE,
    residuals::RULE,
    intervals::RULE,
    ranges::RULE,
    pairs::RULE,
];

/// Below this probability two numbers are said to contradict each other.
const UNLIKELY: f64 = 0.01;

/// A number for a sentence, with so many significant digits; very large and very small ones with a power of ten.
fn show(value: f64, digits: usize) -> String {
    let short = format!("{value:.*e}", digits - 1);
    let exponent = short
        .split_once('e')
        .and_then(|(_, e)| e.parse::<i32>().ok());
    match exponent {
        Some(e) if (-4..6).contains(&e) => {
            let decimals = (digits as i32 - 1 - e).max(0);
            format!("{value:.*}", decimals as usize)
        }
        Some(_) => short,
        None => "no number".to_owned(),
    }
}

/// A probability for a sentence.
fn probability(p: f64) -> String {
    if p < 1e-6 {
        "below one in a million".to_owned()
    } else {
        show(p, 2)
    }
}

/// The rows that were fitted and kept back, where the paper lets one know.
fn rows(list: &ClaimList, fit: &Fit) -> (Option<f64>, Option<f64>) {
    let judged_as = fit.validated_as.as_deref().and_then(|id| list.fit(id));
    let count = |e: Option<&_>| e.map(|e| evaluate(list, e, Depth::Printed).value.round());
    let validation = judged_as.unwrap_or(fit).validation_rows.as_ref();
    (count(fit.rows.as_ref()), count(validation))
}

/// A statistic on the validation rows, which may stand in another place.
fn validation<'a>(list: &'a ClaimList, fit: &Fit, kind: Kind) -> Option<&'a Claim> {
    let id = fit.validated_as.as_deref().unwrap_or(&fit.id);
    list.statistic(id, Split::Validation, kind)
}

/// Probability of a ratio of two variances as far from one, in either direction, with their degrees of freedom.
fn either_direction(ratio: f64, above: f64, below: f64) -> f64 {
    let tail = f_upper_tail(ratio, above, below).min(f_upper_tail(1.0 / ratio, below, above));
    (2.0 * tail).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_sentences_keep_their_digits() {
        for (value, digits, text) in [
            (0.0278135, 3, "0.0278"),
            (241360.99, 4, "241361"),
            (1.2e-9, 2, "1.2e-9"),
            (219.857, 4, "219.9"),
            (0.0, 3, "0.00"),
            (f64::NAN, 3, "no number"),
        ] {
            assert_eq!(show(value, digits), text);
        }
    }

    #[test]
    fn a_ratio_and_its_inverse_are_as_unlikely() {
        // scipy.stats.f.sf(4, 10, 20)
        assert!((either_direction(4.0, 10.0, 20.0) - 2.0 * 0.004039541130205944).abs() < 1e-14);
        let other = either_direction(0.25, 20.0, 10.0);
        assert!((other - either_direction(4.0, 10.0, 20.0)).abs() < 1e-15);
    }
}
