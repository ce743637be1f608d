//! The bootstrap by specimen: refits to as many specimens drawn with replacement, by steps from the full fit ([`super::steps`]) where those are as
//! good, else in full. Rows keep the weight that the robust loss gave them in the full fit.

use crate::engine::{Equation, Solution};
use crate::intervals::weighted;
use crate::specimens::Specimens;
use crate::steps::{Next, Readings, Spread, Step, Sums, Surface, checked};
use pipeline_base::random::Stream;
use pipeline_base::row::Row;
use pipeline_config::FitOptions;
use pipeline_numerics::jackknife::FEWEST_GROUPS as FEWEST_SPECIMENS;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// How many refits are made in full: as many as are wanted of up to ten thousand readings; of more, fewer, so that the work grows no
/// further, but never fewer than give an interval of 95% (with hundreds of specimens its ends are known well enough).
fn most_in_full(wanted: usize, readings: usize) -> usize {
    const MOST_READINGS_REFITTED: usize = 10_000_000;
    const FEWEST_REFITS: usize = 200;
    wanted.min((MOST_READINGS_REFITTED / readings.max(1)).max(FEWEST_REFITS))
}

/// How often each specimen is drawn, and how often that is drawn. G specimens give (2G - 1 choose G) different draws, 35 for four: each is
/// refitted once.
pub(super) type Draws = Vec<(Vec<usize>, usize)>;

pub(super) fn draws(id: &str, seed: u64, specimens: usize, number: usize) -> Draws {
    let mut stream = Stream::new(seed, &["bootstrap", id]);
    let mut times_drawn: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
    for _ in 0..number {
        let mut copies = vec![0_usize; specimens];
        for _ in 0..specimens {
            copies[stream.below(specimens)] += 1;
        }
        *times_drawn.entry(copies).or_default() += 1;
    }
    times_drawn.into_iter().collect()
}

/// The coefficients of every refit; NaN where it did not determine one. `None` below three specimens or without refits.
///
/// Where more refits would have to be made in full than [`most_in_full`] allows, there are only so many refits.
pub(super) fn refits<const N: usize>(
    equation: &Equation<N>,
    rows: &[&Row],
    specimens: &Specimens,
    full: &Solution<N>,
    options: &FitOptions,
) -> Option<Vec<[f64; N]>> {
    let wanted = options.bootstrap_refits;
    if specimens.count() < FEWEST_SPECIMENS || wanted == 0 {
        return None;
    }
    let draw = |number| draws(equation.id, options.seed, specimens.count(), number);
    let most = most_in_full(wanted, rows.len());
    let surface = Resampled::new(equation, rows, specimens, full);
    let steps = |draws: &Draws| match &surface {
        Some(surface) => surface.steps(draws),
        None => vec![None; draws.len()],
    };
    let mut drawn = draw(if surface.is_some() { wanted } else { most });
    let mut stepped = steps(&drawn);
    if stepped.iter().filter(|s| s.is_none()).count() > most {
        drawn = draw(most);
        stepped = steps(&drawn);
    }
    let solved: Vec<([f64; N], usize)> = drawn
        .par_iter()
        .zip(stepped)
        .map(|((copies, times), stepped)| {
            let in_full = || in_full(equation, rows, specimens, full, copies);
            (stepped.unwrap_or_else(in_full), *times)
        })
        .collect();
    Some(
        solved
            .into_iter()
            .flat_map(|(values, times)| std::iter::repeat_n(values, times))
            .collect(),
    )
}

/// The coefficients of the specimens taken so many times each, NaN where their rows do not determine one.
pub(super) fn in_full<const N: usize>(
    equation: &Equation<N>,
    rows: &[&Row],
    specimens: &Specimens,
    full: &Solution<N>,
    copies: &[usize],
) -> [f64; N] {
    let copies_of = specimens.of_row.iter().map(|g| copies[*g] as f64);
    let drawn = rows.iter().zip(copies_of).zip(&full.fit.weights);
    let (drawn, weights): (Vec<&Row>, Vec<f64>) = drawn
        .filter(|((_, copies), _)| *copies > 0.0)
        .map(|((row, copies), weight)| (*row, copies * weight))
        .unzip();
    let held = (equation.held)(specimens.extent(|g| copies[g] > 0).lengths);
    let solution = weighted(equation, &drawn, &weights, held, &full.values);
    let value = |k: usize| match &solution {
        Some(s) if s.determines(k) => s.values[k],
        _ => f64::NAN,
    };
    std::array::from_fn(value)
}

/// The sums of the specimens with the weights of the full fit.
pub(super) struct Resampled<'a, 'e, const N: usize> {
    readings: Readings<'a, 'e, N>,
    weights: &'a [f64],
    surface: Surface<N>,
}

impl<'a, 'e, const N: usize> Resampled<'a, 'e, N> {
    pub(super) fn new(
        equation: &'a Equation<'e, N>,
        rows: &'a [&'a Row],
        specimens: &'a Specimens<'a>,
        full: &'a Solution<N>,
    ) -> Option<Self> {
        let readings = Readings::new(equation, rows, specimens, full)?;
        let weights = full.fit.weights.as_slice();
        let sums = readings.sums(&full.values, &|i, r| (weights[i] * r, weights[i]))?;
        let spread = Spread::new(&readings.free, &sums, 1.0)?;
        let surface = Surface::new(&readings, full.values, spread, 0, &|i, r, _| {
            (weights[i] * r, weights[i])
        })?;
        Some(Self {
            readings,
            weights,
            surface,
        })
    }

    pub(super) fn steps(&self, draws: &Draws) -> Vec<Option<[f64; N]>> {
        let step = |(copies, _): &(Vec<usize>, usize)| {
            if !self.readings.allow(|g| copies[g] > 0) {
                return None;
            }
            let copies: Vec<f64> = copies.iter().map(|c| *c as f64).collect();
            let root = self.surface.polynomials.weighted(&copies).root(&[])?;
            let values = self.surface.values(&self.readings, &root);
            Step::new(&self.readings, values, &root)
        };
        let steps: Vec<Option<Step<N>>> = draws.par_iter().map(step).collect();
        checked(&steps, &|draw, values| self.next(&draws[draw].0, values))
    }

    fn next(&self, copies: &[usize], values: &[f64; N]) -> Option<Next<N>> {
        let weight = |i: usize| self.weights[i] * copies[self.readings.specimens.of_row[i]] as f64;
        let sums = self
            .readings
            .sums(values, &|i, r| (weight(i) * r, weight(i)))?;
        let total = Sums::total(&sums);
        Next::new(&self.readings, &self.surface.spread, values, &total)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fewer_refits_are_the_first_of_the_wanted_ones() {
        let few = draws("a", 1, 4, 50);
        let many = draws("a", 1, 4, 500);
        for (copies, times) in few {
            let again = many.iter().find(|(c, _)| *c == copies).unwrap().1;
            assert!(times <= again);
        }
        assert_eq!(most_in_full(1000, 10_000), 1000);
        assert_eq!(most_in_full(1000, 1_000_000), 200);
    }
}
