//! Refits as steps from the fit to all rows, so that a refit costs nothing that grows with the rows.
//!
//! A fit is where the influences of all rows, summed, are zero. A refit without a specimen, or to specimens taken several times, weighs the
//! sums of the specimens otherwise. Near the full fit each specimen's sum is replaced by a quadratic polynomial of the coefficients
//! ([`pipeline_numerics::group_polynomials`]), made of some fifty evaluations of the rows that all refits share; the root of the weighted sum is then a
//! Gauss-Newton step that knows the curvature. For an equation that is linear in its coefficients it is exact.
//!
//! **What is checked.** The longest steps, on the rows: the influences at the end of a step, summed over the rows of the refit, give the next
//! Gauss-Newton step. The polynomials are the worse the longer a step is, so checks go from the longest step down, a few at a time, until all
//! of them agree, and then to a few spread evenly over the remaining ones; where one of these does not agree, everything is checked. A step
//! agrees with the refit if the next one moves no coefficient by more than a tolerance, in units of how that coefficient scatters from refit
//! to refit. A checked step goes on, a few times at most, until it does, and the step that shows it is taken as well, so that what is left is far below
//! the tolerance. Where it never does, or leaves the region of the polynomials or the bounds, the refit is made in full.
//!
//! Where the model has a kink (a force that is cut at zero) and readings on it, an objective may have several minima, some hundredths of the
//! scatter apart; steps and full refits then need not end in the same one.

use crate::engine::{Equation, Solution};
use crate::specimens::Specimens;
use pipeline_base::row::Row;
use pipeline_numerics::cholesky::Cholesky;
use pipeline_numerics::group_polynomials::{GroupPolynomials, design};
use pipeline_numerics::matrix::{Matrix, norm};
use pipeline_numerics::real::{Dual, Real};
use rayon::prelude::*;

/// Fewest specimens for which steps are taken: those of fewer are long, and their refits in full soon made.
pub(super) const FEWEST_SPECIMENS: usize = 10;
/// Largest next step of one that is as good as a refit, in units of how the coefficient scatters from refit to refit. An interval is made of that
/// scatter, so it is wrong by less than this part of its width even if every refit were wrong by the tolerance in one direction. Its own sampling
/// error is larger: that of a jackknife with 250 specimens is 1/sqrt(2 * 250) = 0.045, that of a percentile of a thousand draws 0.08.
const TOLERANCE: f64 = 1e-2;
/// Steps on the rows after which a refit is made in full.
pub(super) const MOST_STEPS: usize = 6;
/// How many steps are checked at a time.
const AT_A_TIME: usize = 8;
/// The polynomials go through points so many standard deviations of the refits away.
const REACH: f64 = 2.0;
/// The longest step that is followed, in units of the reach.
const LONGEST: f64 = 3.0;
/// The part of the axes that is as the rows would have it if they were independent: where specimens are fewer than coefficients, their steps
/// alone span too little.
const OF_ROWS: f64 = 0.01;

/// Sums over the rows of one or more specimens.
#[derive(Clone)]
pub(super) struct Sums<const N: usize> {
    /// Influence times derivative.
    pub(super) gradient: [f64; N],
    /// Slope of the influence times products of derivatives.
    gram: [[f64; N]; N],
    /// Squared residuals.
    pub(super) squares: f64,
}

impl<const N: usize> Sums<N> {
    fn zero() -> Self {
        Self {
            gradient: [0.0; N],
            gram: [[0.0; N]; N],
            squares: 0.0,
        }
    }

    fn add(&mut self, factor: f64, other: &Self) {
        for i in 0..N {
            self.gradient[i] += factor * other.gradient[i];
            for j in 0..N {
                self.gram[i][j] += factor * other.gram[i][j];
            }
        }
        self.squares += factor * other.squares;
    }

    pub(super) fn total(specimens: &[Self]) -> Self {
        let mut total = Self::zero();
        for one in specimens {
            total.add(1.0, one);
        }
        total
    }

    pub(super) fn less(&self, other: &Self) -> Self {
        let mut rest = self.clone();
        rest.add(-1.0, other);
        rest
    }

    /// The factor of the sums of products of the free coefficients; `None` where they do not determine all of them.
    fn factor(&self, free: &[usize]) -> Option<Cholesky> {
        let mut gram = Matrix::zeros(free.len(), free.len());
        for (i, k) in free.iter().enumerate() {
            for (j, l) in free.iter().enumerate() {
                gram[(i, j)] = self.gram[*k][*l];
            }
        }
        Some(Cholesky::new(&gram)).filter(Cholesky::is_definite)
    }

    fn free_gradient(&self, free: &[usize]) -> Vec<f64> {
        free.iter().map(|k| self.gradient[*k]).collect()
    }

    /// The Gauss-Newton step of the free coefficients.
    pub(super) fn step(&self, free: &[usize]) -> Option<Vec<f64>> {
        Some(self.factor(free)?.solve(&self.free_gradient(free)))
    }
}

/// The influence of a row by its place and residual, and the influence's slope.
pub(super) type Influence<'a> = &'a (dyn Fn(usize, f64) -> (f64, f64) + Sync);

/// What is refitted.
pub(super) struct Readings<'a, 'e, const N: usize> {
    pub(super) equation: &'a Equation<'e, N>,
    pub(super) rows: &'a [&'a Row],
    pub(super) specimens: &'a Specimens<'a>,
    /// Coefficients held in the full fit, and hence in every step.
    pub(super) held: [Option<f64>; N],
    pub(super) free: Vec<usize>,
    observed: Vec<f64>,
}

impl<'a, 'e, const N: usize> Readings<'a, 'e, N> {
    /// The readings of a full fit from which steps can be taken; `None` where it has too few specimens, or coefficients that its rows
    /// do not determine.
    pub(super) fn new(
        equation: &'a Equation<'e, N>,
        rows: &'a [&'a Row],
        specimens: &'a Specimens<'a>,
        full: &Solution<N>,
    ) -> Option<Self> {
        let free: Vec<usize> = (0..N).filter(|k| full.held[*k].is_none()).collect();
        let sound = free.iter().all(|k| full.determines(*k));
        (sound && specimens.count() >= FEWEST_SPECIMENS).then(|| Self {
            equation,
            rows,
            specimens,
            held: full.held,
            free,
            observed: rows.iter().map(|r| (equation.observed)(r)).collect(),
        })
    }

    /// The sums of every specimen at one point; `None` where the model has no value at a row.
    pub(super) fn sums(&self, at: &[f64; N], influence: Influence) -> Option<Vec<Sums<N>>> {
        let seeded: [Dual<N>; N] = std::array::from_fn(|k| match self.held[k] {
            Some(value) => Dual::constant(value),
            None => Dual::variable(at[k], k),
        });
        let mut sums = vec![Sums::zero(); self.specimens.count()];
        for (i, row) in self.rows.iter().enumerate() {
            let model = (self.equation.model)(row, &seeded);
            let residual = self.observed[i] - model.value;
            let (influence, slope) = influence(i, residual);
            let sum = &mut sums[self.specimens.of_row[i]];
            sum.squares += residual * residual;
            for k in 0..N {
                sum.gradient[k] += influence * model.gradient[k];
                let weighted = slope * model.gradient[k];
                for l in 0..N {
                    sum.gram[k][l] += weighted * model.gradient[l];
                }
            }
        }
        let finite = |s: &Sums<N>| {
            let gram = s.gram.iter().flatten();
            s.squares.is_finite() && s.gradient.iter().chain(gram).all(|x| x.is_finite())
        };
        sums.iter().all(finite).then_some(sums)
    }

    /// Whether the specimens that are taken have the rows and lengths for the same coefficients as all of them.
    pub(super) fn allow(&self, taken: impl Fn(usize) -> bool) -> bool {
        let extent = self.specimens.extent(taken);
        extent.rows > self.free.len() && (self.equation.held)(extent.lengths) == self.held
    }

    pub(super) fn is_within_bounds(&self, values: &[f64; N]) -> bool {
        self.free.iter().all(|k| {
            let (low, high) = self.equation.symbols[*k].bounds;
            low < values[*k] && values[*k] < high
        })
    }

    /// The values moved by a step of the free coefficients.
    pub(super) fn moved(&self, values: &[f64; N], step: &[f64]) -> [f64; N] {
        let mut moved = *values;
        for (k, s) in self.free.iter().zip(step) {
            moved[*k] += s;
        }
        moved
    }
}

/// How refits scatter about the full fit, to first order.
pub(super) struct Spread<const N: usize> {
    /// The axes of the polynomials, as columns.
    axes: Cholesky,
    /// Standard deviation of each coefficient over the refits; 0 of held ones.
    pub(super) of_refits: [f64; N],
}

impl<const N: usize> Spread<N> {
    /// From the sums at the full fit; `refits` is how many standard deviations of a refit without one specimen the root of the summed
    /// squares is: the number of specimens for the jackknife, 1 for the bootstrap. `None` where the rows do not determine the coefficients.
    pub(super) fn new(free: &[usize], specimens: &[Sums<N>], refits: f64) -> Option<Self> {
        let total = Sums::total(specimens);
        let factor = total.factor(free)?;
        let p = free.len();
        let steps = specimens.iter().filter_map(|s| total.less(s).step(free));
        let mut scatter = Matrix::zeros(p, p);
        let mut by_rows = 0.0;
        for step in steps {
            let length = norm(&factor.transpose_multiply(&step));
            by_rows += length * length / (p as f64 * refits);
            for (i, x) in step.iter().enumerate() {
                for (j, y) in step.iter().enumerate() {
                    scatter[(i, j)] += x * y / refits;
                }
            }
        }
        let mut of_refits = [0.0; N];
        for (i, k) in free.iter().enumerate() {
            of_refits[*k] = scatter[(i, i)].sqrt();
        }
        let mut square = Matrix::zeros(p, p);
        for j in 0..p {
            let mut unit = vec![0.0; p];
            unit[j] = 1.0;
            let inverse = factor.solve(&unit);
            for i in 0..p {
                square[(i, j)] = REACH * REACH * (scatter[(i, j)] + OF_ROWS * by_rows * inverse[i]);
            }
        }
        let axes = Cholesky::new(&square);
        axes.is_definite().then_some(Self { axes, of_refits })
    }

    /// The largest part of its scatter that any coefficient moves by in a step.
    pub(super) fn share(&self, free: &[usize], step: &[f64]) -> f64 {
        let part = |(k, s): (&usize, &f64)| s.abs() / self.of_refits[*k];
        let parts = free.iter().zip(step).map(part);
        parts
            .map(|x| if x.is_finite() { x } else { f64::INFINITY })
            .fold(0.0, f64::max)
    }
}

/// The sums of every specimen as polynomials around a point.
pub(super) struct Surface<const N: usize> {
    center: [f64; N],
    pub(super) spread: Spread<N>,
    pub(super) polynomials: GroupPolynomials,
}

/// The influence of a row by its place, its residual, and a further coordinate (-1 to 1).
pub(super) type InfluenceAlong<'a> = &'a (dyn Fn(usize, f64, f64) -> (f64, f64) + Sync);

impl<const N: usize> Surface<N> {
    /// Of the coefficients and as many `further` coordinates (0 or 1); `None` where the model has no value at a point of the design.
    pub(super) fn new(
        readings: &Readings<N>,
        center: [f64; N],
        spread: Spread<N>,
        further: usize,
        influence: InfluenceAlong,
    ) -> Option<Self> {
        let free = &readings.free;
        let coordinates = free.len() + further;
        let evaluate = |point: &Vec<f64>| {
            let (own, further) = point.split_at(free.len());
            let along = further.first().copied().unwrap_or_default();
            let at = readings.moved(&center, &spread.axes.multiply(own));
            let sums = readings.sums(&at, &|i, r| influence(i, r, along))?;
            let of_specimen = |s: &Sums<N>| {
                let mut values = spread.axes.transpose_multiply(&s.free_gradient(free));
                values.push(s.squares);
                values
            };
            Some(sums.iter().map(of_specimen).collect())
        };
        let points = design(coordinates);
        let values: Option<Vec<Vec<Vec<f64>>>> = points.par_iter().map(evaluate).collect();
        let polynomials = GroupPolynomials::new(coordinates, &values?);
        Some(Self {
            center,
            spread,
            polynomials,
        })
    }

    /// The coefficients at a point of the polynomials.
    pub(super) fn values(&self, readings: &Readings<N>, point: &[f64]) -> [f64; N] {
        let own = &point[..readings.free.len()];
        readings.moved(&self.center, &self.spread.axes.multiply(own))
    }
}

/// The end of a step that has not been checked.
#[derive(Clone)]
pub(super) struct Step<const N: usize> {
    pub(super) values: [f64; N],
    /// Its length in units of the design.
    length: f64,
}

impl<const N: usize> Step<N> {
    /// `None` where it leaves the region of the polynomials, or the bounds.
    pub(super) fn new(readings: &Readings<N>, values: [f64; N], point: &[f64]) -> Option<Self> {
        let length = norm(point);
        (length <= LONGEST && readings.is_within_bounds(&values)).then_some(Self { values, length })
    }
}

/// The next step, made of the rows.
pub(super) struct Next<const N: usize> {
    /// Where it ends.
    pub(super) values: [f64; N],
    /// Its size, in units of the scatter of the refits.
    share: f64,
}

impl<const N: usize> Next<N> {
    /// From the sums of the refit's rows at the end of the last step; `None` where it leaves the bounds.
    pub(super) fn new(
        readings: &Readings<N>,
        spread: &Spread<N>,
        values: &[f64; N],
        sums: &Sums<N>,
    ) -> Option<Self> {
        let step = sums.step(&readings.free)?;
        let values = readings.moved(values, &step);
        readings.is_within_bounds(&values).then(|| Self {
            values,
            share: spread.share(&readings.free, &step),
        })
    }

    /// Whether the sum of squares at its end is that of the minimum: it is flat there, and off by the square of what is left.
    pub(super) fn is_short(&self) -> bool {
        self.share <= 0.1
    }

    /// Whether the last step was as good as the refit.
    pub(super) fn agrees(&self) -> bool {
        self.share <= TOLERANCE
    }
}

/// A step that has been checked.
struct Checked<const N: usize> {
    /// The refit; none where it has to be made in full.
    values: Option<[f64; N]>,
    /// Whether the step itself was as good.
    agreed: bool,
}

/// Goes on from a step until the next one agrees.
fn follow<const N: usize>(
    step: &Step<N>,
    next: impl Fn(&[f64; N]) -> Option<Next<N>>,
) -> Checked<N> {
    let mut values = step.values;
    for k in 0..MOST_STEPS {
        let Some(next) = next(&values) else { break };
        values = next.values;
        if next.agrees() {
            return Checked {
                values: Some(values),
                agreed: k == 0,
            };
        }
    }
    Checked {
        values: None,
        agreed: false,
    }
}

/// Makes the next step of a unit (a specimen that is left out, a draw) from some coefficients.
pub(super) type Stepper<'a, const N: usize> =
    &'a (dyn Fn(usize, &[f64; N]) -> Option<Next<N>> + Sync);

/// The steps that are as good as refits; `None` for those that have to be refitted in full.
pub(super) fn checked<const N: usize>(
    steps: &[Option<Step<N>>],
    next: Stepper<N>,
) -> Vec<Option<[f64; N]>> {
    let mut found: Vec<Option<[f64; N]>> = steps.iter().map(|s| Some(s.as_ref()?.values)).collect();
    let mut check = |units: &[usize]| {
        let follow = |k: &usize| {
            let step = steps[*k].as_ref()?;
            Some(follow(step, |values| next(*k, values)))
        };
        let ends: Vec<Option<Checked<N>>> = units.par_iter().map(follow).collect();
        for (k, end) in units.iter().zip(&ends) {
            found[*k] = end.as_ref().and_then(|e| e.values);
        }
        ends.iter().flatten().all(|e| e.agreed)
    };
    let order = longest_first(steps);
    let mut done = 0;
    for units in order.chunks(AT_A_TIME) {
        done += units.len();
        if check(units) {
            break;
        }
    }
    let rest = &order[done..];
    let every = rest.len().div_ceil(AT_A_TIME).max(1);
    let some: Vec<usize> = rest.iter().copied().step_by(every).collect();
    if !check(&some) {
        check(rest);
    }
    found
}

fn longest_first<const N: usize>(steps: &[Option<Step<N>>]) -> Vec<usize> {
    let length = |k: usize| steps[k].as_ref().map_or(0.0, |s| s.length);
    let mut order: Vec<usize> = (0..steps.len()).filter(|k| steps[*k].is_some()).collect();
    order.sort_by(|a, b| length(*b).total_cmp(&length(*a)));
    order
}
