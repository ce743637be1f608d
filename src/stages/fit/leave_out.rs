//! Refits without each specimen: by steps from the full fit ([`super::steps`]), where those are as good, else in full.
//!
//! Huber's loss bends at a multiple of the RMSE of the least-squares fit, so that a specimen that is left out changes the bend of the others as
//! well. Its refits are therefore two steps: one of least squares, which gives the RMSE without the specimen, and one of the robust fit,
//! whose polynomials have the bend as a further coordinate. The scale of the other losses is a median that no sum gives: they are
//! always refitted in full.

use crate::engine::{Equation, Solution};
use crate::specimens::Specimens;
use crate::steps::{MOST_STEPS, Next, Readings, Spread, Step, Sums, Surface, checked};
use pipeline_base::row::Row;
use pipeline_numerics::loss::Loss;
use rayon::prelude::*;
use std::sync::OnceLock;

/// A refit without one specimen.
pub(super) struct Refit<const N: usize> {
    pub(super) values: [f64; N],
    /// Which coefficients its rows could not determine at all.
    pub(super) held: [bool; N],
    /// Which they did determine: neither held nor at a bound.
    pub(super) determined: [bool; N],
    /// Whether it was made in full.
    pub(super) in_full: bool,
}

/// Refits without each specimen, by id; none where the others are too few.
pub(super) type Refits<'a, const N: usize> = [(&'a str, Option<Refit<N>>)];

impl<const N: usize> Refit<N> {
    fn in_full(solution: &Solution<N>) -> Self {
        Self {
            values: solution.values,
            held: solution.held.map(|h| h.is_some()),
            determined: std::array::from_fn(|k| solution.determines(k)),
            in_full: true,
        }
    }

    fn stepped(values: [f64; N], full: &Solution<N>) -> Self {
        Self {
            values,
            in_full: false,
            ..Self::in_full(full)
        }
    }
}

/// The refits without each specimen.
pub(super) fn refits<'a, const N: usize>(
    equation: &Equation<N>,
    rows: &[&Row],
    specimens: &Specimens<'a>,
    full: &Solution<N>,
    loss: Loss,
) -> Vec<(&'a str, Option<Refit<N>>)> {
    let steps = steps(equation, rows, specimens, full, loss);
    let refit = |g: usize| {
        let stepped = steps.as_ref().and_then(|s| s[g]);
        let found = match stepped {
            Some(values) => Some(Refit::stepped(values, full)),
            None => without(equation, rows, specimens, full, loss, g),
        };
        (specimens.ids[g], found)
    };
    (0..specimens.count()).into_par_iter().map(refit).collect()
}

/// The refit in full.
pub(super) fn without<const N: usize>(
    equation: &Equation<N>,
    rows: &[&Row],
    specimens: &Specimens,
    full: &Solution<N>,
    loss: Loss,
    g: usize,
) -> Option<Refit<N>> {
    let rows = rows.iter().zip(&specimens.of_row);
    let others: Vec<&Row> = rows.filter(|(_, of)| **of != g).map(|(r, _)| *r).collect();
    let solution = equation.solve(&others, &[full.values], loss)?;
    Some(Refit::in_full(&solution))
}

/// The refits that steps give; `None` where no steps can be taken at all.
pub(super) fn steps<const N: usize>(
    equation: &Equation<N>,
    rows: &[&Row],
    specimens: &Specimens,
    full: &Solution<N>,
    loss: Loss,
) -> Option<Vec<Option<[f64; N]>>> {
    let bend = match loss {
        Loss::LeastSquares => None,
        Loss::Huber { k } => Some(k),
        _ => return None,
    };
    let readings = Readings::new(equation, rows, specimens, full)?;
    let first = LeastSquares::new(&readings, full)?;
    let Some(bend) = bend else {
        let steps: Vec<Option<Step<N>>> = first
            .steps
            .iter()
            .map(|s| Some(s.as_ref()?.step.clone()))
            .collect();
        return Some(checked(&steps, &|g, values| {
            first.next(&readings, g, values).map(|(next, _)| next)
        }));
    };
    let robust = Robust::new(&readings, full, &first, bend)?;
    Some(checked(&robust.steps, &|g, values| {
        robust.next(&readings, &first, g, values)
    }))
}

/// One step of least squares without a specimen.
struct FirstStep<const N: usize> {
    step: Step<N>,
    /// RMSE of the others at its end.
    rmse: f64,
    /// The same from the rows, once somebody has asked; none where steps do not arrive.
    checked_rmse: OnceLock<Option<f64>>,
}

/// The least-squares steps without each specimen.
struct LeastSquares<const N: usize> {
    surface: Surface<N>,
    steps: Vec<Option<FirstStep<N>>>,
}

fn of_least_squares(_: usize, residual: f64) -> (f64, f64) {
    (residual, 1.0)
}

/// sqrt(SSE/(n - p)) without a specimen.
fn rmse<const N: usize>(readings: &Readings<N>, squares: f64, g: usize) -> f64 {
    let rows = readings.rows.len() - readings.specimens.rows[g];
    (squares / (rows as f64 - readings.free.len() as f64)).sqrt()
}

impl<const N: usize> LeastSquares<N> {
    fn new(readings: &Readings<N>, full: &Solution<N>) -> Option<Self> {
        let center = full.least_squares;
        let sums = readings.sums(&center, &of_least_squares)?;
        let refits = readings.specimens.count() as f64;
        let spread = Spread::new(&readings.free, &sums, refits)?;
        let surface = Surface::new(readings, center, spread, 0, &|i, r, _| {
            of_least_squares(i, r)
        })?;
        let step = |g: usize| {
            let polynomial = surface.polynomials.without(g);
            let root = polynomial
                .root(&[])
                .filter(|_| readings.allow(|other| other != g))?;
            let squares = polynomial.value(&root)[readings.free.len()];
            Some(FirstStep {
                step: Step::new(readings, surface.values(readings, &root), &root)?,
                rmse: rmse(readings, squares, g),
                checked_rmse: OnceLock::new(),
            })
        };
        let steps = (0..readings.specimens.count()).map(step).collect();
        Some(Self { surface, steps })
    }

    /// The next step without a specimen, and the RMSE at its end.
    fn next(&self, readings: &Readings<N>, g: usize, values: &[f64; N]) -> Option<(Next<N>, f64)> {
        let sums = readings.sums(values, &of_least_squares)?;
        let others = Sums::total(&sums).less(&sums[g]);
        let next = Next::new(readings, &self.surface.spread, values, &others)?;
        let gained: f64 = readings
            .free
            .iter()
            .map(|k| others.gradient[*k] * (next.values[*k] - values[*k]))
            .sum();
        let rmse = rmse(readings, others.squares - gained, g);
        Some((next, rmse))
    }

    /// The RMSE without a specimen, from the rows; once known it is kept.
    fn rmse(&self, readings: &Readings<N>, g: usize) -> Option<f64> {
        let first = self.steps[g].as_ref()?;
        let from_rows = || {
            let mut values = first.step.values;
            for _ in 0..MOST_STEPS {
                let (next, rmse) = self.next(readings, g, &values)?;
                if next.is_short() {
                    return Some(rmse);
                }
                values = next.values;
            }
            None
        };
        *first.checked_rmse.get_or_init(from_rows)
    }
}

/// The robust steps without each specimen.
struct Robust<const N: usize> {
    surface: Surface<N>,
    /// Where the loss bends, in units of the RMSE.
    bend: f64,
    steps: Vec<Option<Step<N>>>,
}

/// Huber's influence, bent at `limit`.
fn bent(residual: f64, limit: f64) -> (f64, f64) {
    if residual.abs() <= limit {
        (residual, 1.0)
    } else {
        (limit.copysign(residual), 0.0)
    }
}

/// Smallest reach of the further coordinate, as a part of the RMSE.
const LEAST_REACH: f64 = 1e-6;

impl<const N: usize> Robust<N> {
    fn new(
        readings: &Readings<N>,
        full: &Solution<N>,
        first: &LeastSquares<N>,
        bend: f64,
    ) -> Option<Self> {
        let scale = full.fit.scale;
        let change = |s: &FirstStep<N>| s.rmse / scale - 1.0;
        let changes = first.steps.iter().flatten().map(|s| change(s).abs());
        let reach = changes.fold(LEAST_REACH, f64::max);
        let sums = readings.sums(&full.values, &|_, r| bent(r, bend * scale))?;
        let refits = readings.specimens.count() as f64;
        let spread = Spread::new(&readings.free, &sums, refits)?;
        let surface = Surface::new(readings, full.values, spread, 1, &|_, r, along| {
            bent(r, bend * scale * (1.0 + reach * along))
        })?;
        let step = |(g, first): (usize, &Option<FirstStep<N>>)| {
            let along = change(first.as_ref()?) / reach;
            let root = surface.polynomials.without(g).root(&[along])?;
            Step::new(readings, surface.values(readings, &root), &root)
        };
        let steps = first.steps.iter().enumerate().map(step).collect();
        Some(Self {
            surface,
            bend,
            steps,
        })
    }

    /// The next step, with the RMSE without the specimen from the rows too.
    fn next(
        &self,
        readings: &Readings<N>,
        first: &LeastSquares<N>,
        g: usize,
        values: &[f64; N],
    ) -> Option<Next<N>> {
        let limit = self.bend * first.rmse(readings, g)?;
        let sums = readings.sums(values, &|_, r| bent(r, limit))?;
        let others = Sums::total(&sums).less(&sums[g]);
        Next::new(readings, &self.surface.spread, values, &others)
    }
}
