//! A smooth black box: how much of a residual any smooth function of the columns could predict for a specimen that it has not seen.
//!
//! A Gaussian process (Rasmussen and Williams 2006) with a squared exponential over contraction, pressure, resting length and direction,
//! plus one for each other column times the predicted force, on up to 150 inducing readings (subset of regressors). What it sees is left by a base
//! model that was fitted without the held-out readings as well. Its noise is chosen from a short grid by the held-out error itself, which favours it: it
//! is a limit, not a competitor.

use super::data::{Data, Extra, PLACEBO};
use pipeline_base::columns::TEMPERATURE;
use pipeline_effects::Conditions;
use pipeline_numerics::cholesky::Cholesky;
use pipeline_numerics::matrix::Matrix;

/// Inducing readings.
const INDUCING: usize = 150;
/// Noise variances by that of the residual.
pub const NOISE: [f64; 4] = [0.003, 0.03, 0.3, 3.0];
/// Length scale in units of each column's standard deviation.
const LENGTH_SCALE: f64 = 1.2;

/// Standardised columns of some readings.
pub struct Features {
    /// Contraction, pressure, resting length, direction.
    state: Vec<[f64; 4]>,
    /// The other columns.
    others: Vec<Vec<f64>>,
    /// Predicted force by its largest.
    force: Vec<f64>,
}

impl Features {
    /// The columns of all readings of a campaign, so that training and held-out readings have one scale.
    pub fn new(data: &Data, predicted: &[f64]) -> Self {
        let c = &data.conditions;
        let column = |f: &dyn Fn(&Conditions) -> f64| standardised(c.iter().map(f).collect());
        let state = [
            column(&|c| (c.rest_length_m - c.length_m) / (c.rest_length_m - c.contracted_length_m)),
            column(&|c| c.pressure_kpa),
            column(&|c| c.rest_length_m),
            column(&|c| c.direction),
        ];
        let mut others: Vec<Vec<f64>> = vec![
            column(&|c| c.log_time_s),
            column(&|c| libm::log1p(c.since_step_s)),
            column(&|c| c.rate_kpa_per_s),
            column(&|c| c.temperature_c),
            column(&|c| c.cycles),
        ];
        // The temperature is there already.
        let is_further = |e: &&Extra| e.name != PLACEBO && e.name != TEMPERATURE;
        let extras = data.extras.iter().filter(is_further);
        others.extend(extras.map(|e| e.values.clone()));
        others.retain(|v| v.iter().any(|x| *x != 0.0));
        let largest = predicted.iter().copied().fold(1e-9, f64::max);
        Self {
            state: (0..data.len())
                .map(|i| [state[0][i], state[1][i], state[2][i], state[3][i]])
                .collect(),
            others,
            force: predicted.iter().map(|f| f / largest).collect(),
        }
    }

    fn kernel(&self, i: usize, j: usize) -> f64 {
        let scale = 1.0 / (2.0 * LENGTH_SCALE * LENGTH_SCALE);
        let squared: f64 = self.state[i]
            .iter()
            .zip(&self.state[j])
            .map(|(a, b)| (a - b) * (a - b))
            .sum();
        let mut sum = libm::exp(-squared * scale);
        for column in &self.others {
            let d = column[i] - column[j];
            sum += 0.25 * libm::exp(-d * d * scale) * (0.2 + self.force[i] * self.force[j]);
        }
        sum
    }
}

fn standardised(values: Vec<f64>) -> Vec<f64> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let sd = (values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n).sqrt();
    if sd > 1e-12 * (1.0 + mean.abs()) {
        values.into_iter().map(|x| (x - mean) / sd).collect()
    } else {
        vec![0.0; values.len()]
    }
}

/// Predicts `target` at the readings `held_out` from the readings `train`, once for each of [`NOISE`].
pub fn predict(
    features: &Features,
    target: &[f64],
    train: &[usize],
    held_out: &[usize],
) -> Vec<Vec<f64>> {
    let step = (train.len() as f64 / INDUCING as f64).max(1.0);
    let inducing: Vec<usize> = (0..train.len().min(INDUCING))
        .map(|k| train[((k as f64 * step) as usize).min(train.len() - 1)])
        .collect();
    let m = inducing.len();
    let row = |i: usize| -> Vec<f64> { inducing.iter().map(|j| features.kernel(i, *j)).collect() };
    let mut between = Matrix::zeros(m, m);
    for (a, i) in inducing.iter().enumerate() {
        for (b, k) in row(*i).into_iter().enumerate() {
            between[(a, b)] = k;
        }
        between[(a, a)] += 1e-6;
    }
    let mut products = Matrix::zeros(m, m);
    let mut right = vec![0.0; m];
    for &i in train {
        let k = row(i);
        for a in 0..m {
            right[a] += k[a] * target[i];
            for b in 0..=a {
                products[(a, b)] += k[a] * k[b];
            }
        }
    }
    let rows: Vec<Vec<f64>> = held_out.iter().map(|i| row(*i)).collect();
    NOISE
        .iter()
        .map(|noise| {
            let mut system = Matrix::zeros(m, m);
            for a in 0..m {
                for b in 0..m {
                    system[(a, b)] = products[(a.max(b), a.min(b))] + noise * between[(a, b)];
                }
            }
            let weights = Cholesky::new(&system).solve(&right);
            rows.iter()
                .map(|k| k.iter().zip(&weights).map(|(x, w)| x * w).sum())
                .collect()
        })
        .collect()
}
