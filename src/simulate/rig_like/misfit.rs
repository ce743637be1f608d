//! The smooth part of the law that the model lacks, as a share of the force: one surface over (eps*, P*) common to all specimens, and one
//! curve along the pressure for each session.
//!
//! Both are sums of functions with drawn weights: Gaussian bumps in one family, random waves (A. Rahimi and B. Recht, NIPS 2007) in the
//! other. The functions along the pressure are the same in all sessions of a campaign, so that the covariance of a session's misfit is
//! known exactly.

use super::families::Family;
use pipeline_base::random::Stream;
use pipeline_mechanics::models::P_620_KPA;
use pipeline_numerics::distributions::normal_quantile;

/// Of which functions a misfit is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// exp(-d^2/(2 w^2)).
    Bumps,
    /// cos(omega x + phase).
    Waves,
}

/// Width of the bumps along the pressure, kPa: their sum is correlated as exp(-d^2/(2 (99 kPa)^2)).
const BUMP_KPA: f64 = 70.0;
/// Distance of the bumps along the pressure, kPa.
const BUMP_STEP_KPA: f64 = 50.0;
/// Correlation lengths of the waves along the pressure, kPa: drawn between these.
const WAVE_KPA: (f64, f64) = (80.0, 125.0);
/// Pairs of waves along the pressure.
const WAVE_PAIRS: usize = 10;
/// Functions of the common surface.
const COMMON: usize = 12;
/// Widths of the bumps of the common surface over (eps*, P*).
const COMMON_WIDTHS: (f64, f64) = (0.25, 0.5);
/// Correlation length of the waves of the common surface.
const COMMON_LENGTH: f64 = 0.4;
/// Where the common surface has the root mean square 1 about its mean: eps* and P*.
const RANGE: [(f64, f64); 2] = [(0.0, 0.75), (0.08, 1.0)];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Along {
    Bump { centre_kpa: f64 },
    Wave { per_kpa: f64, phase: f64 },
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Over {
    shape: Shape,
    /// Centre of a bump; wave numbers.
    a: [f64; 2],
    /// Widths of a bump; the phase.
    b: [f64; 2],
    /// Factor and constant by which the function has mean 0 and root mean square 1 over [`RANGE`].
    factor: f64,
    mean: f64,
}

/// The functions of a campaign and the weights of its common surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Misfit {
    along: Vec<Along>,
    along_factor: f64,
    over: Vec<Over>,
    weights: Vec<f64>,
}

impl Misfit {
    /// Draws a campaign's.
    pub fn new(family: Family, seed: u64) -> Self {
        let mut stream = family.stream(seed, &["misfit"]);
        let along = along(family.shape(), &mut stream);
        let over: Vec<Over> = (0..COMMON)
            .map(|_| Over::new(family.shape(), &mut stream))
            .collect();
        let weights = over.iter().map(|_| stream.normal()).collect();
        let mut misfit = Self {
            along,
            along_factor: 1.0,
            over,
            weights,
        };
        misfit.along_factor = 1.0 / misfit.mean_square_along().sqrt();
        let rms = mean_over(|x, p| square(misfit.common(x, p))).sqrt();
        misfit.weights.iter_mut().for_each(|w| *w /= rms);
        misfit
    }

    /// Number of functions along the pressure.
    pub fn functions(&self) -> usize {
        self.along.len()
    }

    /// Values of the functions along the pressure; with standard normal weights their sum has unit variance.
    pub fn along(&self, pressure_kpa: f64) -> Vec<f64> {
        let value = |f: &Along| match *f {
            Along::Bump { centre_kpa } => bump((pressure_kpa - centre_kpa) / BUMP_KPA),
            Along::Wave { per_kpa, phase } => libm::cos(per_kpa * pressure_kpa + phase),
        };
        let scaled = |f: &Along| self.along_factor * value(f);
        self.along.iter().map(scaled).collect()
    }

    /// The common surface, of root mean square 1.
    pub fn common(&self, contraction_rel: f64, pressure_rel: f64) -> f64 {
        let values = self.over(contraction_rel, pressure_rel);
        values.iter().zip(&self.weights).map(|(f, w)| f * w).sum()
    }

    /// Values of the functions of the common surface; with normal weights of variance 1/n their sum has about unit variance.
    pub fn over(&self, contraction_rel: f64, pressure_rel: f64) -> Vec<f64> {
        let value = |f: &Over| f.value(contraction_rel, pressure_rel);
        self.over.iter().map(value).collect()
    }

    fn mean_square_along(&self) -> f64 {
        let (low, high) = RANGE[1];
        let places = grid(low, high).map(|p| p * P_620_KPA);
        let squares = places.map(|p| self.along(p).iter().map(|f| f * f).sum::<f64>());
        squares.sum::<f64>() / GRID as f64
    }
}

fn along(shape: Shape, stream: &mut Stream) -> Vec<Along> {
    match shape {
        Shape::Bumps => {
            let first = -60.0 - BUMP_STEP_KPA * stream.uniform();
            let centre = |k| first + BUMP_STEP_KPA * f64::from(k);
            let bump = |k| Along::Bump {
                centre_kpa: centre(k),
            };
            (0..18).map(bump).collect()
        }
        Shape::Waves => {
            let length = WAVE_KPA.0 + (WAVE_KPA.1 - WAVE_KPA.0) * stream.uniform();
            // One wave number from each of as many equal parts of the upper half of a normal distribution.
            let number = |k: usize, u: f64| {
                normal_quantile(0.5 + 0.5 * (k as f64 + u) / WAVE_PAIRS as f64) / length
            };
            (0..WAVE_PAIRS)
                .flat_map(|k| {
                    let per_kpa = number(k, 0.02 + 0.96 * stream.uniform());
                    let quarter = -std::f64::consts::FRAC_PI_2;
                    [0.0, quarter].map(|phase| Along::Wave { per_kpa, phase })
                })
                .collect()
        }
    }
}

impl Over {
    fn new(shape: Shape, stream: &mut Stream) -> Self {
        let (a, b) = match shape {
            Shape::Bumps => {
                let (low, high) = COMMON_WIDTHS;
                let centre = RANGE.map(|(from, to)| from + (to - from) * stream.uniform());
                let widths = [(); 2].map(|()| low + (high - low) * stream.uniform());
                (centre, widths)
            }
            Shape::Waves => {
                let numbers = [(); 2].map(|()| stream.normal() / COMMON_LENGTH);
                (numbers, [std::f64::consts::TAU * stream.uniform(), 0.0])
            }
        };
        let mut over = Self {
            shape,
            a,
            b,
            factor: 1.0,
            mean: 0.0,
        };
        over.mean = mean_over(|x, p| over.value(x, p));
        let rms = mean_over(|x, p| square(over.value(x, p))).sqrt();
        over.factor = 1.0 / rms;
        over
    }

    fn value(&self, x: f64, p: f64) -> f64 {
        let raw = match self.shape {
            Shape::Bumps => bump((x - self.a[0]) / self.b[0]) * bump((p - self.a[1]) / self.b[1]),
            Shape::Waves => libm::cos(self.a[0] * x + self.a[1] * p + self.b[0]),
        };
        self.factor * (raw - self.mean)
    }
}

fn bump(d: f64) -> f64 {
    libm::exp(-0.5 * d * d)
}

fn square(x: f64) -> f64 {
    x * x
}

/// Points of a grid in one direction.
const GRID: usize = 16;

fn grid(low: f64, high: f64) -> impl Iterator<Item = f64> {
    (0..GRID).map(move |k| low + (high - low) * (k as f64 + 0.5) / GRID as f64)
}

fn mean_over(f: impl Fn(f64, f64) -> f64) -> f64 {
    let [(x0, x1), (p0, p1)] = RANGE;
    let sum: f64 = grid(x0, x1)
        .map(|x| grid(p0, p1).map(|p| f(x, p)).sum::<f64>())
        .sum();
    sum / (GRID * GRID) as f64
}
