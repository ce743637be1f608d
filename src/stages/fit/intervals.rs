//! The interval of a coefficient, by four methods that stand side by side in `intervals.csv`.
//!
//! | method | what it assumes |
//! |---|---|
//! | jackknife by specimen | refits without each specimen (`leave_out`), Student's t of G - 1 degrees of freedom (Tukey 1958; Efron 1982): rows of one specimen may depend on each other in any way |
//! | bootstrap by specimen | refits to G specimens drawn with replacement (`bootstrap`), percentiles (Efron and Tibshirani 1993, section 8.5): as before; too narrow for few specimens |
//! | profile likelihood | values at which the best sum of squares of the other coefficients rises by t^2 s^2 (Bates and Watts 1988, chapter 6): independent rows, any curvature |
//! | linearised | (JtJ)^-1 s^2: independent rows, no curvature |
//!
//! The last two stand beside the published intervals, which were made in the same way; rows of one log are not independent, so they are too
//! narrow. A method that needs specimens gives nothing below three of them, and an end that the data do not determine is open.

use crate::bootstrap;
use crate::engine::{Equation, Solution};
use crate::leave_out::{Refit, Refits};
use crate::specimens::Specimens;
use pipeline_base::row::Row;
use pipeline_config::{FitOptions, IntervalMethod};
use pipeline_numerics::distributions::student_t_quantile;
use pipeline_numerics::dual_problem::DualProblem;
use pipeline_numerics::fit::{Fit, Options, Status, fit as minimise};
use pipeline_numerics::jackknife::{FEWEST_GROUPS as FEWEST_SPECIMENS, standard_error};
use pipeline_numerics::real::Dual;
use pipeline_numerics::statistics::{quantile, sum_of_squares};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Relative change of the sum of squares that ends a refit: percentiles of a thousand refits have no use for more.
const TOLERANCE: f64 = 1e-8;
/// Largest fraction of bootstrap refits that may fail to determine a coefficient.
const MOST_UNDETERMINED: f64 = 0.05;

/// The interval of one coefficient by one method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// How it was made.
    pub method: IntervalMethod,
    /// Lower end; none where it is open.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl Interval {
    fn new(method: IntervalMethod, ends: [Option<f64>; 2]) -> Self {
        let [low, high] = ends.map(|x| x.filter(|x| x.is_finite()));
        Self { method, low, high }
    }

    fn around(method: IntervalMethod, value: f64, half: f64) -> Self {
        let known = half.is_finite() && half > 0.0;
        Self::new(
            method,
            [known.then_some(value - half), known.then_some(value + half)],
        )
    }

    /// Both ends, where neither is open.
    pub fn ends(&self) -> Option<(f64, f64)> {
        self.low.zip(self.high)
    }
}

/// The intervals of every coefficient, by every method that applies.
pub(super) fn intervals<const N: usize>(
    equation: &Equation<N>,
    rows: &[&Row],
    specimens: &Specimens,
    full: &Solution<N>,
    refits: &Refits<N>,
    options: &FitOptions,
) -> [Vec<Interval>; N] {
    let level = 0.5 + 0.5 * options.confidence;
    let errors = linearised_errors(&full.fit);
    let freedom = full.fit.residuals.len() - full.fit.parameters.len();
    let t_of_rows = student_t_quantile(level, freedom as f64);
    let spread = jackknife(full, refits);
    let draws = bootstrap::refits(equation, rows, specimens, full, options);
    let work: Vec<usize> = (0..N).collect();
    let found: Vec<Vec<Interval>> = work
        .into_par_iter()
        .map(|k| {
            let Some(free) = full.place(k) else {
                return Vec::new();
            };
            let value = full.values[k];
            let mut list = Vec::new();
            if let Some(spread) = &spread {
                let t = student_t_quantile(level, (refits.len() - 1) as f64);
                list.push(Interval::around(
                    IntervalMethod::Jackknife,
                    value,
                    t * spread[k],
                ));
            }
            if let Some(draws) = &draws {
                list.push(Interval::new(
                    IntervalMethod::Bootstrap,
                    percentiles(draws, k, level),
                ));
            }
            let half = t_of_rows * errors[free];
            let profile = Profile::new(equation, rows, full, k);
            list.push(Interval::new(
                IntervalMethod::Profile,
                profile.ends(half, t_of_rows),
            ));
            list.push(Interval::around(IntervalMethod::Linearised, value, half));
            list
        })
        .collect();
    let mut found = found.into_iter();
    std::array::from_fn(|_| found.next().unwrap_or_default())
}

/// Standard errors from the covariance (JtJ)^-1 s^2 with s of the residuals themselves, whatever the loss.
fn linearised_errors(fit: &Fit) -> Vec<f64> {
    let n = fit.residuals.len() as f64;
    let p = fit.parameters.len() as f64;
    let variance = sum_of_squares(&fit.residuals) / (n - p);
    (0..fit.parameters.len())
        .map(|k| (variance * fit.covariance_factor[(k, k)]).sqrt())
        .collect()
}

/// Jackknife standard errors over specimens. NaN for a coefficient that the full fit or one of the refits could not determine (at a bound,
/// held): its interval is open. `None` below three specimens, or where a refit failed altogether.
fn jackknife<const N: usize>(full: &Solution<N>, refits: &Refits<N>) -> Option<[f64; N]> {
    let found: Vec<&Refit<N>> = refits.iter().filter_map(|(_, r)| r.as_ref()).collect();
    if refits.len() < FEWEST_SPECIMENS || found.len() < refits.len() {
        return None;
    }
    Some(std::array::from_fn(|k| {
        if !full.determines(k) || !found.iter().all(|r| r.determined[k]) {
            return f64::NAN;
        }
        let refits: Vec<f64> = found.iter().map(|r| r.values[k]).collect();
        standard_error(full.values[k], &refits)
    }))
}

/// Least squares with given weights and held coefficients; `None` where there are too few rows or the model has no value.
pub(super) fn weighted<const N: usize>(
    equation: &Equation<N>,
    rows: &[&Row],
    weights: &[f64],
    held: [Option<f64>; N],
    start: &[f64; N],
) -> Option<Solution<N>> {
    let observed: Vec<f64> = rows.iter().map(|r| (equation.observed)(r)).collect();
    let free: Vec<usize> = (0..N).filter(|k| held[*k].is_none()).collect();
    if rows.len() < free.len() {
        return None;
    }
    let problem = DualProblem::new(&observed, |i, c: &[Dual<N>; N]| {
        (equation.model)(rows[i], c)
    })
    .with_weights(weights)
    .with_held(held);
    let options = Options {
        bounds: Some(free.iter().map(|k| equation.symbols[*k].bounds).collect()),
        tolerance: TOLERANCE,
        polish: false,
        ..Options::default()
    };
    let fit = minimise(&problem, &problem.free(start), &options);
    let values = problem.full(&fit.parameters);
    (fit.status != Status::NotFinite).then_some(Solution {
        values,
        held,
        least_squares: values,
        fit,
    })
}

/// The percentile interval; open where too many refits did not determine the coefficient.
fn percentiles<const N: usize>(draws: &[[f64; N]], k: usize, level: f64) -> [Option<f64>; 2] {
    let known: Vec<f64> = draws
        .iter()
        .map(|d| d[k])
        .filter(|x| x.is_finite())
        .collect();
    let lost = draws.len() - known.len();
    if lost as f64 > MOST_UNDETERMINED * draws.len() as f64 {
        return [None; 2];
    }
    [1.0 - level, level].map(|p| Some(quantile(&known, p)))
}

/// The sum of squares as a function of one coefficient, the others at their best; rows keep the weights of the full fit.
struct Profile<'a, 'e, const N: usize> {
    equation: &'a Equation<'e, N>,
    rows: &'a [&'a Row],
    full: &'a Solution<N>,
    k: usize,
    lowest: f64,
    variance: f64,
}

impl<'a, 'e, const N: usize> Profile<'a, 'e, N> {
    /// Doublings of the distance in which an end must be found.
    const DOUBLINGS: usize = 30;
    /// Steps of the search between a point inside and one outside, and the precision that ends it.
    const STEPS: usize = 60;
    const PRECISION: f64 = 1e-6;

    fn new(
        equation: &'a Equation<'e, N>,
        rows: &'a [&'a Row],
        full: &'a Solution<N>,
        k: usize,
    ) -> Self {
        let weighted: Vec<f64> = full
            .fit
            .residuals
            .iter()
            .zip(&full.fit.weights)
            .map(|(r, w)| w * r * r)
            .collect();
        let lowest = pipeline_numerics::statistics::sum(&weighted);
        let freedom = full.fit.residuals.len() - full.fit.parameters.len();
        Self {
            equation,
            rows,
            full,
            k,
            lowest,
            variance: lowest / freedom as f64,
        }
    }

    /// Where the signed root of the rise over s^2 reaches `t`, below and above the estimate.
    fn ends(&self, half: f64, t: f64) -> [Option<f64>; 2] {
        if !(half.is_finite() && half > 0.0 && self.variance > 0.0) {
            return [None; 2];
        }
        let (low, high) = self.equation.symbols[self.k].bounds;
        let value = self.full.values[self.k];
        [
            self.end(-1.0, half, value - low, t),
            self.end(1.0, half, high - value, t),
        ]
    }

    fn end(&self, side: f64, half: f64, room: f64, t: f64) -> Option<f64> {
        let value = self.full.values[self.k];
        let mut start = self.full.values;
        let mut rise = |distance: f64| self.rise(value + side * distance, &mut start);
        let (mut inside, mut below) = (0.0, -t);
        let mut outside = half.min(room);
        let mut above = rise(outside)? - t;
        for _ in 0..Self::DOUBLINGS {
            if above >= 0.0 || outside >= room {
                break;
            }
            (inside, below) = (outside, above);
            outside = (2.0 * outside).min(room);
            above = rise(outside)? - t;
        }
        if above < 0.0 {
            return None;
        }
        // False position with halving of the end that stays (Illinois).
        for _ in 0..Self::STEPS {
            if above == 0.0 || (outside - inside) <= Self::PRECISION * outside {
                break;
            }
            let middle = (inside * above - outside * below) / (above - below);
            let at = rise(middle)? - t;
            if at.abs() <= Self::PRECISION * t {
                return Some(value + side * middle);
            }
            if at < 0.0 {
                (inside, below) = (middle, at);
                above *= 0.5;
            } else {
                (outside, above) = (middle, at);
                below *= 0.5;
            }
        }
        Some(value + side * outside)
    }

    /// sqrt((S - S_lowest)/s^2) with the coefficient at `at`; `start` follows the other coefficients.
    fn rise(&self, at: f64, start: &mut [f64; N]) -> Option<f64> {
        let mut held = self.full.held;
        held[self.k] = Some(at);
        let weights = &self.full.fit.weights;
        let solution = weighted(self.equation, self.rows, weights, held, start)?;
        *start = solution.values;
        let rise = (solution.fit.sse - self.lowest).max(0.0);
        Some((rise / self.variance).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_percentile_interval_is_open_where_more_than_one_refit_in_twenty_does_not_determine_the_coefficient()
     {
        let draws = |lost: usize| -> Vec<[f64; 1]> {
            let of = |k: usize| if k < lost { f64::NAN } else { k as f64 };
            (0..100).map(|k| [of(k)]).collect()
        };
        let ends = percentiles(&draws(5), 0, 0.9);
        let [low, high] = ends.map(|end| end.unwrap());
        assert!(low > 5.0 && high < 99.0 && high > low + 70.0, "{ends:?}");
        assert_eq!(percentiles(&draws(6), 0, 0.9), [None; 2]);
    }
}
