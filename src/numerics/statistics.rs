//! Descriptive statistics and the goodness of a fit.
//!
//! Sums are compensated (Neumaier, *Zeitschrift für angewandte Mathematik und Mechanik* 54, 1974, pp. 39-51) and run in slice
//! order. A statistic that does not exist (of no values, of one value where two are needed) is NaN. NaN among the values makes
//! sums NaN; order statistics put it last and so must not be given any.

use crate::distributions::{NORMAL_50, chi_square_upper_tail};

/// The median absolute deviation of a standard normal variable, to the four digits that robust regression has always used.
pub const NORMAL_MAD: f64 = 0.6745;

/// The sum, exact but for one rounding unless the condition is extreme; 0 of no values.
pub fn sum(values: &[f64]) -> f64 {
    let (mut total, mut lost) = (0.0_f64, 0.0_f64);
    for &value in values {
        let next = total + value;
        lost += if total.abs() >= value.abs() {
            (total - next) + value
        } else {
            (value - next) + total
        };
        total = next;
    }
    if total.is_finite() {
        total + lost
    } else {
        total
    }
}

/// The sum of squares.
pub fn sum_of_squares(values: &[f64]) -> f64 {
    let squares: Vec<f64> = values.iter().map(|v| v * v).collect();
    sum(&squares)
}

/// The arithmetic mean; NaN of no values.
pub fn mean(values: &[f64]) -> f64 {
    sum(values) / values.len() as f64
}

/// The sum of squares about the mean; NaN of no values.
pub fn sum_of_squares_about_mean(values: &[f64]) -> f64 {
    let centre = mean(values);
    let deviations: Vec<f64> = values.iter().map(|v| v - centre).collect();
    if values.is_empty() {
        f64::NAN
    } else {
        sum_of_squares(&deviations)
    }
}

/// The sample standard deviation, with `n - 1`; NaN of fewer than two values.
pub fn standard_deviation(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return f64::NAN;
    }
    (sum_of_squares_about_mean(values) / (values.len() - 1) as f64).sqrt()
}

/// Pearson's correlation of pairs; NaN where one of both does not vary.
pub fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let centres = (mean(a), mean(b));
    let products = a.iter().zip(b);
    let products = products.map(|(x, y)| (x - centres.0) * (y - centres.1));
    let size = (sum_of_squares_about_mean(a) * sum_of_squares_about_mean(b)).sqrt();
    sum(&products.collect::<Vec<f64>>()) / size
}

/// The values in ascending order.
fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// The quantile at `probability` between 0 and 1, interpolated between order statistics; NaN of no values or outside 0..1.
///
/// Definition 7 of Hyndman and Fan, *The American Statistician* 50, 1996: the default of R, NumPy and Excel.
pub fn quantile(values: &[f64], probability: f64) -> f64 {
    quantile_in_place(&mut values.to_vec(), probability)
}

/// The same as [`quantile`], without a copy: the order of the values is lost.
pub fn quantile_in_place(values: &mut [f64], probability: f64) -> f64 {
    if values.is_empty() || !(0.0..=1.0).contains(&probability) {
        return f64::NAN;
    }
    let position = probability * (values.len() - 1) as f64;
    let place = position.floor() as usize;
    // Two order statistics do not need all of them sorted.
    let (_, below, larger) = values.select_nth_unstable_by(place, f64::total_cmp);
    let above = larger.iter().copied().min_by(f64::total_cmp);
    *below + (position - place as f64) * (above.unwrap_or(*below) - *below)
}

/// The distance between two quantiles, such as 0.01 and 0.99 for a range that stray values do not widen; NaN like [`quantile`].
pub fn quantile_range(values: &[f64], low: f64, high: f64) -> f64 {
    let mut values = values.to_vec();
    quantile_in_place(&mut values, high) - quantile_in_place(&mut values, low)
}

/// The median; NaN of no values.
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// The median absolute deviation from the median, unscaled; NaN of no values.
pub fn median_absolute_deviation(values: &[f64]) -> f64 {
    let centre = median(values);
    let deviations: Vec<f64> = values.iter().map(|v| (v - centre).abs()).collect();
    median(&deviations)
}

/// Standard deviation of normal numbers about zero, by the median of their sizes: half of them may be anything.
pub fn sd_by_median(sizes: &[f64]) -> f64 {
    median(sizes) / NORMAL_50
}

/// Robust scale of residuals about zero: the median of `|r|` from the `parameters`-th smallest up, divided by 0.6745.
///
/// A fit of `p` parameters makes about `p` residuals nearly zero, and these say nothing of the scale (DuMouchel and O'Brien 1989).
/// NaN of no residuals; with fewer residuals than parameters only the largest is left.
pub fn residual_mad_scale(residuals: &[f64], parameters: usize) -> f64 {
    let sizes: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
    let sizes = sorted(&sizes);
    let first = parameters.max(1).min(sizes.len().max(1)) - 1;
    median(&sizes[first..]) / NORMAL_MAD
}

/// How well a model meets the data: the honest statistics, those of the residuals themselves.
///
/// Fields that do not exist are NaN: all of them without rows, `rmse` and `adjusted_r2` unless `n > parameters`, `r2` and
/// `adjusted_r2` where the observations do not vary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoodnessOfFit {
    /// Number of rows.
    pub n: usize,
    /// Coefficients fitted on these rows; 0 for a split or a model that was not fitted on them.
    pub parameters: usize,
    /// Sum of squared residuals, in the squared unit of the data.
    pub sse: f64,
    /// `sqrt(sse/(n - parameters))`, which is `sqrt(sse/n)` where nothing was fitted.
    pub rmse: f64,
    /// `1 - sse/sst` with the sum of squares about the mean of the observations.
    pub r2: f64,
    /// `1 - (1 - r2)(n - 1)/(n - parameters)`.
    pub adjusted_r2: f64,
    /// Largest absolute residual.
    pub max_abs_error: f64,
    /// Mean residual, observed minus predicted.
    pub bias: f64,
}

impl GoodnessOfFit {
    /// Compares rows of observations with predictions.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn new(observed: &[f64], predicted: &[f64], parameters: usize) -> Self {
        assert_eq!(observed.len(), predicted.len(), "one prediction a row");
        let residuals: Vec<f64> = observed.iter().zip(predicted).map(|(y, f)| y - f).collect();
        let n = observed.len();
        if n == 0 {
            return Self::undefined(parameters);
        }
        let sse = sum_of_squares(&residuals);
        let sst = sum_of_squares_about_mean(observed);
        let freedom = if n > parameters {
            (n - parameters) as f64
        } else {
            f64::NAN
        };
        let r2 = if sst > 0.0 { 1.0 - sse / sst } else { f64::NAN };
        Self {
            n,
            parameters,
            sse,
            rmse: (sse / freedom).sqrt(),
            r2,
            adjusted_r2: 1.0 - (1.0 - r2) * (n - 1) as f64 / freedom,
            max_abs_error: largest_size(&residuals),
            bias: mean(&residuals),
        }
    }

    fn undefined(parameters: usize) -> Self {
        Self {
            n: 0,
            parameters,
            sse: f64::NAN,
            rmse: f64::NAN,
            r2: f64::NAN,
            adjusted_r2: f64::NAN,
            max_abs_error: f64::NAN,
            bias: f64::NAN,
        }
    }
}

/// The largest absolute value; NaN if one of them is.
fn largest_size(values: &[f64]) -> f64 {
    values.iter().fold(
        0.0,
        |largest: f64, v| {
            if v.abs() <= largest { largest } else { v.abs() }
        },
    )
}

/// The probability, were one number behind all of them, that independent estimates of it differ by as much as these; value and standard error each.
/// NaN with fewer than two that have both, the error above 0.
///
/// Cochran's Q, the sum of squared deviations from the weighted mean in standard errors, is chi-square with one degree of freedom fewer than there
/// are estimates (*Biometrics* 10, 1954, pp. 101-129).
pub fn homogeneity(estimates: &[(f64, f64)]) -> f64 {
    let usable =
        |(value, error): &&(f64, f64)| value.is_finite() && error.is_finite() && *error > 0.0;
    let all: Vec<&(f64, f64)> = estimates.iter().filter(usable).collect();
    if all.len() < 2 {
        return f64::NAN;
    }
    let weights: Vec<f64> = all.iter().map(|(_, error)| 1.0 / (error * error)).collect();
    let weighted: Vec<f64> = all
        .iter()
        .zip(&weights)
        .map(|((value, _), w)| w * value)
        .collect();
    let centre = sum(&weighted) / sum(&weights);
    let deviations: Vec<f64> = all
        .iter()
        .map(|(value, error)| (value - centre) / error)
        .collect();
    let freedom = (all.len() - 1) as f64;
    chi_square_upper_tail(sum_of_squares(&deviations), freedom)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_estimates_differ_as_their_difference_does() {
        // Of two estimates Q is the square of the difference over its standard error, and its probability that of a normal variable.
        let (a, b) = ((3.0, 0.6), (5.0_f64, 0.8_f64));
        let z = (b.0 - a.0) / (0.36_f64 + b.1 * b.1).sqrt();
        let expected = 2.0 * crate::distributions::normal_cdf(-z);
        assert!((homogeneity(&[a, b]) - expected).abs() < 1e-12);
        assert_eq!(homogeneity(&[a, a, a]), 1.0);
        assert!(homogeneity(&[a]).is_nan());
        assert!(homogeneity(&[a, (4.0, 0.0), (f64::NAN, 1.0)]).is_nan());
    }

    #[test]
    fn three_equal_errors_give_the_exponential_tail() {
        // With two degrees of freedom the tail is exp(-Q/2); here Q = (1 + 0 + 1) / 0.25.
        let p = homogeneity(&[(1.0, 0.5), (2.0, 0.5), (3.0, 0.5)]);
        assert!((p - libm::exp(-4.0)).abs() < 1e-12, "{p}");
    }

    #[test]
    fn sums_keep_what_plain_addition_loses() {
        assert_eq!(sum(&[1.0, 1e100, 1.0, -1e100]), 2.0);
        assert_eq!(sum(&[]), 0.0);
        assert_eq!(sum(&[f64::MAX, f64::MAX]), f64::INFINITY);
    }

    #[test]
    fn correlations_are_those_of_lines_and_of_what_is_square_to_them() {
        let x = [1.0, 2.0, 3.0, 4.0];
        assert_eq!(correlation(&x, &x.map(|x| 7.0 - 2.0 * x)), -1.0);
        assert_eq!(correlation(&x, &[1.0, -1.0, -1.0, 1.0]), 0.0);
        // 3/sqrt(5 * 5), by hand.
        assert!((correlation(&x, &[2.0, 1.0, 4.0, 3.0]) - 0.6).abs() < 1e-15);
        assert!(correlation(&x, &[5.0; 4]).is_nan());
    }

    #[test]
    fn quantiles_are_those_of_numpy() {
        let x = [3.0, 1.0, 2.0, 10.0];
        assert_eq!(median(&x), 2.5);
        assert_eq!(quantile(&x, 0.1), 1.3);
        assert_eq!(quantile(&x, 1.0), 10.0);
        assert_eq!(median_absolute_deviation(&x), 1.0);
        assert!(median(&[]).is_nan() && quantile(&x, 1.1).is_nan());
    }

    #[test]
    fn the_smallest_residuals_do_not_enter_the_scale() {
        let r = [0.0, -0.0, 1.0, -2.0, 3.0];
        assert_eq!(residual_mad_scale(&r, 3), 2.0 / NORMAL_MAD);
        assert_eq!(residual_mad_scale(&r, 0), 1.0 / NORMAL_MAD);
        assert_eq!(residual_mad_scale(&r, 9), 3.0 / NORMAL_MAD);
        assert!(residual_mad_scale(&[], 3).is_nan());
    }

    #[test]
    fn goodness_of_fit_by_hand() {
        let g = GoodnessOfFit::new(&[1.0, 2.0, 3.0, 6.0], &[1.0, 2.5, 2.0, 6.5], 2);
        assert_eq!((g.n, g.sse, g.max_abs_error, g.bias), (4, 1.5, 1.0, 0.0));
        assert_eq!(g.rmse, 0.75_f64.sqrt());
        assert!((g.r2 - (1.0 - 1.5 / 14.0)).abs() < 1e-15);
        assert!((g.adjusted_r2 - (1.0 - 1.5 / 14.0 * 1.5)).abs() < 1e-15);
        let unfitted = GoodnessOfFit::new(&[1.0, 3.0], &[0.0, 4.0], 0);
        assert_eq!(unfitted.rmse, 1.0);
        assert!((standard_deviation(&[1.0, 3.0]) - 2.0_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn statistics_that_do_not_exist_are_nan() {
        assert!(GoodnessOfFit::new(&[], &[], 0).sse.is_nan());
        let few = GoodnessOfFit::new(&[1.0, 2.0], &[1.0, 2.0], 2);
        assert!(few.rmse.is_nan() && few.adjusted_r2.is_nan() && few.r2 == 1.0);
        let flat = GoodnessOfFit::new(&[2.0, 2.0], &[1.0, 2.0], 1);
        assert!(flat.r2.is_nan() && flat.adjusted_r2.is_nan() && flat.rmse == 1.0);
        assert!(standard_deviation(&[1.0]).is_nan() && mean(&[]).is_nan());
    }
}
