//! What the generating model says of its own readings: how likely each specimen's are, how large the error of an unseen specimen has to be,
//! and how strongly an effect shows. No search can do better than this by more than luck.
//!
//! The generating model knows its law, misfit in common included, its effects and its standard deviations; it does not know what was drawn
//! for a specimen or session. The readings y of a specimen are taken as Gaussian about the mode of what was drawn, b:
//! y ~ N(h(b) - J b, J D J' + R), J the derivative of h, D the variances, R the misfit of each session and the noise.

use super::draw::Drawn;
use super::forward::{Departure, Forward};
use super::rows::Taken;
use super::{Campaign, Put, Settings};
use crate::coefficients::Coefficients;

/// The generating model of a campaign.
pub struct Generating<'a> {
    settings: &'a Settings,
    drawn: &'a Drawn,
    readings: &'a [Taken],
}

/// Steps to the mode of what was drawn; the second already changes little.
const STEPS: usize = 3;
/// What is drawn for each session.
const OF_SESSION: usize = 2;
/// What is drawn for each specimen.
const OF_SPECIMEN: usize = 3;
/// Steps of the differences: gain, mm, mm, mm, N, share, kPa.
const DIFFERENCE: [f64; 7] = [1e-3, 1e-2, 1e-2, 1e-2, 1e-2, 1e-3, 0.1];
/// Relative step of a coefficient.
const COEFFICIENT_STEP: f64 = 1e-3;

impl<'a> Generating<'a> {
    /// The model behind a campaign.
    pub fn new(campaign: &'a Campaign) -> Self {
        Self {
            settings: &campaign.truth.settings,
            drawn: &campaign.truth.drawn,
            readings: &campaign.truth.readings,
        }
    }

    /// Joint log density of the readings of each specimen, specimen by specimen.
    pub fn log_densities(&self) -> Vec<f64> {
        let forward = Forward::new(self.settings, self.drawn, &self.settings.effects);
        (0..self.drawn.muscles.len())
            .map(|k| Block::at_mode(self, &forward, k).log_density())
            .collect()
    }

    /// Log density a reading, as the findings state it: summed over specimens, over readings.
    pub fn log_density(&self) -> f64 {
        self.log_densities().iter().sum::<f64>() / self.readings.len() as f64
    }

    /// Mean square of the whitened readings of each specimen: 1 but for luck.
    pub fn mahalanobis(&self) -> Vec<f64> {
        let forward = Forward::new(self.settings, self.drawn, &self.settings.effects);
        (0..self.drawn.muscles.len())
            .map(|k| {
                let block = Block::at_mode(self, &forward, k);
                let white = Factor::new(&block.covariance()).forward(&block.residual());
                white.iter().map(|x| x * x).sum::<f64>() / white.len() as f64
            })
            .collect()
    }

    /// Root mean square of measured less expected, N: an unseen specimen, law and effects known.
    pub fn rmse(&self) -> f64 {
        let square =
            |t: &Taken| (t.force_n - t.expected_force_n) * (t.force_n - t.expected_force_n);
        (self.readings.iter().map(square).sum::<f64>() / self.readings.len() as f64).sqrt()
    }

    /// How many standard deviations these effects are away from nothing, coefficients of the law and misfit in common unknown: the norm of
    /// M V^-1/2 (h - h(0)), M the projection past both.
    pub fn strength(&self, effects: &[Put]) -> f64 {
        let nothing = Forward::new(self.settings, self.drawn, &[]);
        let with = Forward::new(self.settings, self.drawn, effects);
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); 1 + LAW + self.functions()];
        for k in 0..self.drawn.muscles.len() {
            let block = Block::new(self, &nothing, k, Vec::new());
            let factor = Factor::new(&block.covariance());
            for (list, column) in columns.iter_mut().zip(self.columns(&nothing, &with, k)) {
                list.extend(factor.forward(&column));
            }
        }
        let (effect, others) = columns.split_at(1);
        self.left(&effect[0], others).max(0.0).sqrt()
    }

    fn functions(&self) -> usize {
        self.drawn.misfit.over(0.0, 0.0).len()
    }

    /// The effect, the derivatives by the coefficients, and the functions of the misfit in common, for the readings of a specimen.
    fn columns(&self, nothing: &Forward, with: &Forward, k: usize) -> Vec<Vec<f64>> {
        let (of, still) = (self.of(k), Departure::default());
        let each = |f: &dyn Fn(&Taken) -> f64| of.iter().map(|t| f(t)).collect::<Vec<f64>>();
        let mut list = vec![each(&|t| {
            // What the pressure sensor makes of the pressure changes what is expected at the pressure that is read.
            let mut place = t.place;
            let shown = with.sensed_pressure(&place, place.at.pressure_kpa);
            let with = with.force(&place, &still);
            place.at.pressure_kpa = shown;
            with - nothing.force(&place, &still)
        })];
        list.extend((0..LAW).map(|c| {
            let (law, step) = changed(self.drawn.law, c);
            let other = Forward::new(self.settings, self.drawn, &[]).with_law(law);
            each(&|t| (other.force(&t.place, &still) - nothing.force(&t.place, &still)) / step)
        }));
        let size = self.drawn.sizes.common.max(1e-9) / (self.functions() as f64).sqrt();
        list.extend((0..self.functions()).map(|f| {
            each(&|t| {
                let setup = &self.drawn.setups[t.place.setup];
                let rel = t.place.at.pressure_kpa / pipeline_mechanics::models::P_620_KPA;
                let values = self.drawn.misfit.over(setup.contraction_rel, rel);
                size * values[f] * nothing.force(&t.place, &still)
            })
        }));
        list
    }

    /// Square of what the others leave of a column: coefficients are free, weights of the misfit have unit variance.
    fn left(&self, effect: &[f64], others: &[Vec<f64>]) -> f64 {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let entry = |(i, a): (usize, &Vec<f64>), (j, b): (usize, &Vec<f64>)| {
            dot(a, b) + if i == j && i >= LAW { 1.0 } else { 0.0 }
        };
        let row = |a| others.iter().enumerate().map(|b| entry(a, b)).collect();
        let gram: Vec<Vec<f64>> = others.iter().enumerate().map(row).collect();
        let explained: Vec<f64> = others.iter().map(|o| dot(o, effect)).collect();
        let half = Factor::new(&gram).forward(&explained);
        dot(effect, effect) - dot(&half, &half)
    }

    /// The readings of a specimen.
    fn of(&self, muscle: usize) -> Vec<&'a Taken> {
        let of = |t: &&Taken| self.drawn.setups[t.place.setup].muscle == muscle;
        self.readings.iter().filter(of).collect()
    }
}

/// Coefficients of the law that are taken as unknown: b1, b2, c0, c1, c2.
const LAW: usize = 5;

fn changed(mut law: Coefficients, k: usize) -> (Coefficients, f64) {
    let [c0, c1, c2] = &mut law.c;
    let list = [&mut law.b1, &mut law.b2, c0, c1, c2];
    let coefficient = list.into_iter().nth(k).expect("one of five");
    let step = COEFFICIENT_STEP * *coefficient;
    *coefficient += step;
    (law, step)
}

/// The readings of one specimen about a guess of what was drawn for it.
struct Block<'a> {
    generating: &'a Generating<'a>,
    taken: Vec<&'a Taken>,
    /// Sessions of the specimen, by their places.
    sessions: Vec<usize>,
    /// What was drawn: gain, l_rest, l_620, then length and zero of each session.
    b: Vec<f64>,
    force: Vec<f64>,
    slopes: Vec<[f64; 7]>,
}

impl<'a> Block<'a> {
    fn new(generating: &'a Generating<'a>, forward: &Forward, muscle: usize, b: Vec<f64>) -> Self {
        let setups = generating.drawn.setups.iter().enumerate();
        let sessions: Vec<usize> = setups
            .filter(|(_, s)| s.muscle == muscle)
            .map(|(k, _)| k)
            .collect();
        let n = OF_SPECIMEN + OF_SESSION * sessions.len();
        let mut block = Self {
            generating,
            taken: generating.of(muscle),
            sessions,
            b: if b.is_empty() { vec![0.0; n] } else { b },
            force: Vec::new(),
            slopes: Vec::new(),
        };
        for t in block.taken.clone() {
            let at = block.departure(t);
            let (force, slopes) = differences(forward, t, at);
            block.force.push(force);
            block.slopes.push(slopes);
        }
        block
    }

    fn at_mode(generating: &'a Generating<'a>, forward: &Forward, muscle: usize) -> Self {
        let mut block = Self::new(generating, forward, muscle, Vec::new());
        for _ in 0..STEPS {
            let next = block.predicted();
            block = Self::new(generating, forward, muscle, next);
        }
        block
    }

    fn departure(&self, t: &Taken) -> Departure {
        let own = OF_SPECIMEN + OF_SESSION * self.own(t);
        Departure {
            gain: self.b[0],
            rest_mm: self.b[1],
            contracted_mm: self.b[2],
            length_mm: self.b[own],
            zero_n: self.b[own + 1],
            misfit: 0.0,
        }
    }

    /// Place of a reading's session among those of the specimen.
    fn own(&self, t: &Taken) -> usize {
        let found = self.sessions.iter().position(|s| *s == t.place.setup);
        found.expect("a session of the specimen")
    }

    /// Derivatives of a reading by everything that was drawn, times the standard deviations.
    fn scaled(&self, i: usize) -> Vec<f64> {
        let sizes = &self.generating.drawn.sizes;
        let (slopes, own) = (self.slopes[i], self.own(self.taken[i]));
        let mut row = vec![0.0; self.b.len()];
        row[0] = slopes[0] * sizes.gain;
        row[1] = slopes[1] * sizes.rounding_mm;
        row[2] = slopes[2] * sizes.rounding_mm;
        row[OF_SPECIMEN + OF_SESSION * own] = slopes[3] * sizes.length_mm;
        row[OF_SPECIMEN + OF_SESSION * own + 1] = slopes[4] * sizes.zero_n;
        row
    }

    fn covariance(&self) -> Vec<Vec<f64>> {
        let drawn = self.generating.drawn;
        let sizes = &drawn.sizes;
        let n = self.taken.len();
        let scaled: Vec<Vec<f64>> = (0..n).map(|i| self.scaled(i)).collect();
        let misfit: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                let along = drawn.misfit.along(self.taken[i].place.at.pressure_kpa);
                let factor = sizes.session * self.slopes[i][5];
                along.into_iter().map(|f| factor * f).collect()
            })
            .collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let mut v = vec![vec![0.0; n]; n];
        for i in 0..n {
            for j in 0..=i {
                let together = self.taken[i].place.setup == self.taken[j].place.setup;
                v[i][j] = dot(&scaled[i], &scaled[j]);
                if together {
                    v[i][j] += dot(&misfit[i], &misfit[j]);
                }
                v[j][i] = v[i][j];
            }
            let by_pressure = self.slopes[i][6] * sizes.noise_kpa;
            v[i][i] += sizes.noise_n * sizes.noise_n + by_pressure * by_pressure;
        }
        v
    }

    /// Measured less what the linear model expects.
    fn residual(&self) -> Vec<f64> {
        let sizes = &self.generating.drawn.sizes;
        let sd = [sizes.gain, sizes.rounding_mm, sizes.rounding_mm];
        let sd = |j: usize| match j {
            0..OF_SPECIMEN => sd[j],
            _ if (j - OF_SPECIMEN).is_multiple_of(OF_SESSION) => sizes.length_mm,
            _ => sizes.zero_n,
        };
        let linear = |i: usize| {
            let scaled = self.scaled(i);
            let terms = scaled.iter().zip(&self.b).enumerate();
            terms
                .filter(|(j, _)| sd(*j) > 0.0)
                .map(|(j, (s, b))| s * b / sd(j))
                .sum::<f64>()
        };
        (0..self.taken.len())
            .map(|i| self.taken[i].force_n - self.force[i] + linear(i))
            .collect()
    }

    /// The mode of what was drawn, in the linear model.
    fn predicted(&self) -> Vec<f64> {
        let sizes = &self.generating.drawn.sizes;
        let factor = Factor::new(&self.covariance());
        let weighted = factor.solve(&self.residual());
        let mut b = vec![0.0; self.b.len()];
        for (i, w) in weighted.iter().enumerate() {
            for (b, s) in b.iter_mut().zip(self.scaled(i)) {
                *b += s * w;
            }
        }
        for (j, b) in b.iter_mut().enumerate() {
            *b *= match j {
                0 => sizes.gain,
                1 | 2 => sizes.rounding_mm,
                _ if (j - OF_SPECIMEN).is_multiple_of(OF_SESSION) => sizes.length_mm,
                _ => sizes.zero_n,
            };
        }
        b
    }

    fn log_density(&self) -> f64 {
        let factor = Factor::new(&self.covariance());
        let white = factor.forward(&self.residual());
        let square: f64 = white.iter().map(|x| x * x).sum();
        let n = white.len() as f64;
        -0.5 * (square + n * libm::log(std::f64::consts::TAU)) - factor.log_root_determinant()
    }
}

/// Force at a departure, and its derivatives by each part of the departure and by the pressure.
fn differences(forward: &Forward, t: &Taken, at: Departure) -> (f64, [f64; 7]) {
    let force = forward.force(&t.place, &at);
    let with = |k: usize, h: f64| {
        let mut other = at;
        let mut place = t.place;
        let part = match k {
            0 => &mut other.gain,
            1 => &mut other.rest_mm,
            2 => &mut other.contracted_mm,
            3 => &mut other.length_mm,
            4 => &mut other.zero_n,
            5 => &mut other.misfit,
            _ => &mut place.at.pressure_kpa,
        };
        *part += h;
        forward.force(&place, &other)
    };
    let slope =
        |k: usize| (with(k, DIFFERENCE[k]) - with(k, -DIFFERENCE[k])) / (2.0 * DIFFERENCE[k]);
    (force, std::array::from_fn(slope))
}

/// Cholesky's factor L of a positive matrix, V = L L'.
struct Factor {
    rows: Vec<Vec<f64>>,
}

impl Factor {
    fn new(v: &[Vec<f64>]) -> Self {
        let n = v.len();
        let mut rows = vec![vec![0.0; n]; n];
        for (i, own) in v.iter().enumerate() {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| rows[i][k] * rows[j][k]).sum();
                let rest = own[j] - known;
                rows[i][j] = if i == j {
                    rest.max(1e-12 * own[i]).sqrt()
                } else {
                    rest / rows[j][j]
                };
            }
        }
        Self { rows }
    }

    /// L^-1 b.
    fn forward(&self, b: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; b.len()];
        for (i, row) in self.rows.iter().enumerate() {
            let known: f64 = (0..i).map(|k| row[k] * x[k]).sum();
            x[i] = (b[i] - known) / row[i];
        }
        x
    }

    /// V^-1 b.
    fn solve(&self, b: &[f64]) -> Vec<f64> {
        let half = self.forward(b);
        let mut x = vec![0.0; b.len()];
        for i in (0..b.len()).rev() {
            let known: f64 = (i + 1..b.len()).map(|k| self.rows[k][i] * x[k]).sum();
            x[i] = (half[i] - known) / self.rows[i][i];
        }
        x
    }

    /// Logarithm of the root of the determinant of V.
    fn log_root_determinant(&self) -> f64 {
        let diagonal = self.rows.iter().enumerate();
        diagonal.map(|(i, row)| libm::log(row[i])).sum()
    }
}
