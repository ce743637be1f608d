//! The jackknife over groups of rows: how far an estimate moves when each group in turn is left out.
//!
//! Tukey, *Annals of Mathematical Statistics* 29, 1958, p. 614; Efron, *The Jackknife, the Bootstrap and Other Resampling Plans*, 1982,
//! chapter 3.

use super::distributions::student_t_quantile;
use super::statistics::sum_of_squares;

/// Fewest groups: with two there is one degree of freedom and no interval worth the name.
pub const FEWEST_GROUPS: usize = 3;

/// The standard error `sqrt((G - 1)/G sum (b_g - b)^2)` of an estimate `full` from the `G` estimates without one group each.
///
/// About the full estimate, which is never smaller than about the mean of the others. NaN of no refits.
pub fn standard_error(full: f64, refits: &[f64]) -> f64 {
    let groups = refits.len() as f64;
    let deviations: Vec<f64> = refits.iter().map(|b| b - full).collect();
    ((groups - 1.0) / groups * sum_of_squares(&deviations)).sqrt()
}

/// Half the width of the interval at a `confidence` between 0 and 1, with Student's t of `G - 1` degrees of freedom; `None` below
/// [`FEWEST_GROUPS`], or where an estimate is not finite.
pub fn half_width(full: f64, refits: &[f64], confidence: f64) -> Option<f64> {
    if refits.len() < FEWEST_GROUPS {
        return None;
    }
    let t = student_t_quantile(0.5 + 0.5 * confidence, (refits.len() - 1) as f64);
    let half = t * standard_error(full, refits);
    half.is_finite().then_some(half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::{mean, standard_deviation};

    #[test]
    fn of_a_mean_it_is_the_usual_standard_error() {
        let x = [3.0, 7.0, 4.5, 9.0, 1.0];
        let without = |i: usize| {
            let others: Vec<f64> = (0..x.len()).filter(|k| *k != i).map(|k| x[k]).collect();
            mean(&others)
        };
        let refits: Vec<f64> = (0..x.len()).map(without).collect();
        let usual = standard_deviation(&x) / 5.0_f64.sqrt();
        assert!((standard_error(mean(&x), &refits) - usual).abs() < 1e-13);
        // Student's t at 97.5 % with four degrees of freedom, from printed tables.
        let half = half_width(mean(&x), &refits, 0.95).unwrap();
        assert!((half / usual - 2.776).abs() < 5e-4);
    }

    #[test]
    fn two_groups_and_lost_refits_give_no_interval() {
        assert_eq!(half_width(1.0, &[0.9, 1.1], 0.95), None);
        assert_eq!(half_width(1.0, &[0.9, 1.1, f64::NAN], 0.95), None);
    }
}
