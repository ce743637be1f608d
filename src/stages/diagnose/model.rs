//! A model of a campaign: base, strengths of the specimens, and effects; and its fit.
//!
//! F_i = sensor(effects; (1 + u_k) base(P_i, l_i; theta)), where u_k is the strength of the specimen of reading i, normal about 0 with
//! standard deviation s_u. Fitted are theta, every effect's parameters and the u_k, by penalised least squares
//!
//! sum_i (y_i - F_i)^2 + (s/s_u)^2 sum_k u_k^2 (+ the same for effects with a value a session),
//!
//! which for normal errors is the mode of the mixed model (Pinheiro and Bates 2000, section 7.2). The variances s^2 and s_u^2 follow from
//! the residuals and strengths by two passes (EM). So what two specimens' strengths can explain is not credited to an effect.

use super::base::Base;
use super::data::Data;
use super::term::{Term, What};
use crate::effects::{self, Applied};
use crate::numerics::cholesky::Cholesky;
use crate::numerics::matrix::Matrix;

use crate::numerics::real::{Dual, Real};
use std::collections::BTreeSet;

/// Derivatives that one evaluation carries: five coefficients, the strength, and two for each of five effects.
const SLOTS: usize = 16;
/// Most effects in one model.
pub const MOST_TERMS: usize = 5;
/// The slot of the strength.
pub const STRENGTH: usize = 5;

/// Usual relative scatter of the strengths of one make: what the null model expects.
pub const USUAL_SCATTER: f64 = 0.02;
/// Where a strength may go.
const STRENGTHS: (f64, f64) = (-0.8, 4.0);
/// Scatter of strengths that are free.
const FREE_SCATTER: f64 = 0.5;
/// Where the estimate of the scatter may go.
const SCATTER_RANGE: (f64, f64) = (0.005, 0.5);

/// A fitted model.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// Coefficients of the base, all of them.
    pub base: Vec<f64>,
    /// Amplitudes and shape of each term.
    pub terms: Vec<(Vec<f64>, f64)>,
    /// Strength of each specimen.
    pub strengths: Vec<f64>,
    /// Standard deviation of the strengths.
    pub scatter: f64,
    /// Standard deviation of the residuals, strengths taken off, N.
    pub sigma: f64,
    /// Measured less fitted, strengths included, N.
    pub residuals: Vec<f64>,
    /// Derivatives by the slots of [`Model::slot`], N by unit of the parameter, one list a slot.
    pub traces: Vec<Vec<f64>>,
}

/// Base and effects on the readings of a campaign.
pub struct Model<'a> {
    /// The base.
    pub base: &'a Base,
    /// The readings.
    pub data: &'a Data,
    /// The effects.
    pub terms: Vec<Term>,
}

/// Where a parameter stands in the vector of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A coefficient of the base.
    Base(usize),
    /// An amplitude: term, number.
    Amplitude(usize, usize),
    /// The shape of a term.
    Shape(usize),
    /// A specimen's strength.
    Strength(usize),
}

impl<'a> Model<'a> {
    /// The parameters of the fit, in their order.
    pub fn layout(&self) -> Vec<Place> {
        let free = (0..self.base.coefficients.len()).filter(|k| self.base.coefficients[*k].free);
        let mut layout: Vec<Place> = free.map(Place::Base).collect();
        for (t, term) in self.terms.iter().enumerate() {
            layout.extend((0..term.amplitudes).map(|g| Place::Amplitude(t, g)));
            if term.second().is_some() {
                layout.push(Place::Shape(t));
            }
        }
        layout.extend((0..self.data.specimens.len()).map(Place::Strength));
        layout
    }

    /// The fit with strengths of which nothing is known beforehand: what is left is what the readings of each specimen say by themselves.
    pub fn fit_with_free_strengths(&self, from: &Fitted) -> Fitted {
        let free = Fitted {
            scatter: FREE_SCATTER,
            ..from.clone()
        };
        let fitted = self.fit(Some(&free), 0);
        Fitted {
            scatter: FREE_SCATTER,
            ..fitted
        }
    }

    /// Fits from where another fit ended (`None`: from the base's starting values), and `passes` times again with the variances that
    /// the fit before it showed.
    pub fn fit(&self, from: Option<&Fitted>, passes: usize) -> Fitted {
        let layout = self.layout();
        let mut point = self.start(from);
        let mut scatter = from.map_or(USUAL_SCATTER, |f| f.scatter);
        let mut sums = Sums::new(self, &layout, &point);
        let n = self.data.len() as f64;
        let mut sigma = from.map_or((sums.rss / n).sqrt(), |f| f.sigma);
        for _ in 0..=passes {
            let ratio = (sigma.max(1e-6) / scatter) * (sigma.max(1e-6) / scatter);
            let is_strength = |p: &Place| matches!(p, Place::Strength(_));
            let penalty: Vec<f64> = layout
                .iter()
                .map(|p| if is_strength(p) { ratio } else { 0.0 })
                .collect();
            descend(self, &layout, &mut point, &mut sums, &penalty);
            sigma = (sums.rss / (n - layout.len() as f64).max(1.0))
                .sqrt()
                .max(1e-9);
            scatter = self.scatter(&layout, &point, &sums, sigma, scatter);
        }
        let mut fitted = Fitted {
            base: self.base.starts(),
            terms: self
                .terms
                .iter()
                .map(|t| (vec![0.0; t.amplitudes], t.start().1))
                .collect(),
            strengths: vec![0.0; self.data.specimens.len()],
            scatter,
            sigma,
            residuals: sums.residuals,
            traces: sums.traces,
        };
        for (place, value) in layout.iter().zip(&point) {
            match place {
                Place::Base(k) => fitted.base[*k] = *value,
                Place::Amplitude(t, g) => fitted.terms[*t].0[*g] = *value,
                Place::Shape(t) => fitted.terms[*t].1 = *value,
                Place::Strength(k) => fitted.strengths[*k] = *value,
            }
        }
        self.fill_unseen(&mut fitted);
        fitted
    }

    /// What was not seen has a mean value: a session its effect's mean over the others, a specimen the mean strength. Where a fit
    /// started must not show.
    fn fill_unseen(&self, fitted: &mut Fitted) {
        let sessions: BTreeSet<usize> = self.data.session.iter().copied().collect();
        for (term, (amplitudes, _)) in self.terms.iter().zip(&mut fitted.terms) {
            let seen: BTreeSet<usize> = sessions.iter().filter_map(|s| term.acts_on[*s]).collect();
            let mean = if term.amplitudes > 1 {
                seen.iter().map(|g| amplitudes[*g]).sum::<f64>() / seen.len().max(1) as f64
            } else {
                0.0
            };
            for (g, amplitude) in amplitudes.iter_mut().enumerate() {
                if !seen.contains(&g) {
                    *amplitude = mean;
                }
            }
        }
        let specimens: BTreeSet<usize> = self.data.specimen.iter().copied().collect();
        for (k, strength) in fitted.strengths.iter_mut().enumerate() {
            if !specimens.contains(&k) {
                *strength = 0.0;
            }
        }
    }

    fn start(&self, from: Option<&Fitted>) -> Vec<f64> {
        self.layout()
            .into_iter()
            .map(|place| match place {
                Place::Base(k) => from.map_or(self.base.coefficients[k].start, |f| f.base[k]),
                Place::Amplitude(t, g) => {
                    let known = from
                        .and_then(|f| f.terms.get(t))
                        .and_then(|(a, _)| a.get(g));
                    known.copied().unwrap_or(self.terms[t].start().0)
                }
                Place::Shape(t) => {
                    let known = from.and_then(|f| f.terms.get(t)).map(|(_, shape)| *shape);
                    known
                        .filter(|x| x.is_finite())
                        .unwrap_or(self.terms[t].start().1)
                }
                Place::Strength(k) => from.map_or(0.0, |f| f.strengths[k]),
            })
            .collect()
    }

    /// Bounds of a parameter.
    pub fn bounds(&self, place: Place) -> (f64, f64) {
        match place {
            Place::Base(k) => self.base.coefficients[k].bounds,
            Place::Amplitude(t, _) => self.terms[t].amplitude_bounds(),
            Place::Shape(t) => self.terms[t].second().map_or((0.0, 1.0), |p| p.bounds),
            Place::Strength(_) => STRENGTHS,
        }
    }

    /// The derivative that a reading of this session and specimen has by a parameter, if any.
    pub fn slot(&self, place: Place, session: usize, specimen: usize) -> Option<usize> {
        match place {
            Place::Base(k) => Some(k),
            Place::Amplitude(t, g) => {
                (self.terms[t].acts_on[session] == Some(g)).then_some(STRENGTH + 1 + 2 * t)
            }
            Place::Shape(t) => self.terms[t].acts_on[session].map(|_| STRENGTH + 2 + 2 * t),
            Place::Strength(k) => (specimen == k).then_some(STRENGTH),
        }
    }

    /// One EM step for the scatter of the strengths: mean of u^2 and of its variance.
    fn scatter(
        &self,
        layout: &[Place],
        point: &[f64],
        sums: &Sums,
        sigma: f64,
        scatter: f64,
    ) -> f64 {
        let information = self.strength_information(&sums.traces);
        let seen: Vec<usize> = (0..information.len())
            .filter(|k| information[*k] > 0.0)
            .collect();
        if seen.len() < 3 {
            return USUAL_SCATTER;
        }
        let strength = |k: usize| {
            layout
                .iter()
                .position(|p| *p == Place::Strength(k))
                .map_or(0.0, |i| point[i])
        };
        let sum: f64 = seen
            .iter()
            .map(|k| {
                let variance =
                    1.0 / (information[*k] / (sigma * sigma) + 1.0 / (scatter * scatter));
                strength(*k) * strength(*k) + variance
            })
            .sum();
        let lost = self
            .base
            .coefficients
            .iter()
            .take(2)
            .filter(|c| c.free)
            .count();
        let freedom = seen.len().saturating_sub(lost).max(1) as f64;
        (sum / freedom)
            .sqrt()
            .clamp(SCATTER_RANGE.0, SCATTER_RANGE.1)
    }

    /// Sum of the squared derivatives by each specimen's strength, N^2; 0 for a specimen without readings.
    pub fn strength_information(&self, traces: &[Vec<f64>]) -> Vec<f64> {
        let mut information = vec![0.0; self.data.specimens.len()];
        for (k, d) in self.data.specimen.iter().zip(&traces[STRENGTH]) {
            information[*k] += d * d;
        }
        information
    }

    /// The force of each reading, N, with the strengths of the specimens or of mean ones.
    pub fn predict(&self, fitted: &Fitted, with_strengths: bool) -> Vec<f64> {
        (0..self.data.len())
            .map(|i| {
                let strength = if with_strengths {
                    fitted.strengths[self.data.specimen[i]]
                } else {
                    0.0
                };
                let acting = |t: usize| {
                    let g = self.terms[t].acts_on[self.data.session[i]]?;
                    let (amplitudes, second) = &fitted.terms[t];
                    Some([amplitudes[g], *second])
                };
                force(self, &fitted.base, 1.0 + strength, acting, i)
            })
            .collect()
    }
}

/// Steps in which a specimen's own strength is found: the force is nearly linear in it.
const STRENGTH_STEPS: usize = 6;

impl Model<'_> {
    /// The force of each reading, N, with the strength that its specimen shows in these very readings, all else as fitted: what is left is
    /// what a model that knew how strong the specimen is would miss.
    pub fn predict_with_own_strength(&self, fitted: &Fitted) -> Vec<f64> {
        let base: Vec<Dual<1>> = fitted.base.iter().map(|c| Dual::constant(*c)).collect();
        let specimens = self.data.specimens.len();
        let at = |i: usize, strength: f64| {
            let acting = |t: usize| {
                let g = self.terms[t].acts_on[self.data.session[i]]?;
                let (amplitudes, second) = &fitted.terms[t];
                Some([Dual::constant(amplitudes[g]), Dual::constant(*second)])
            };
            force(self, &base, Dual::variable(1.0 + strength, 0), acting, i)
        };
        let mut strengths = vec![0.0; specimens];
        for _ in 0..STRENGTH_STEPS {
            let mut sums = vec![(0.0, 0.0); specimens];
            for i in 0..self.data.len() {
                let k = self.data.specimen[i];
                let f = at(i, strengths[k]);
                sums[k].0 += f.gradient[0] * (self.data.force[i] - f.value);
                sums[k].1 += f.gradient[0] * f.gradient[0];
            }
            for (u, (slope, square)) in strengths.iter_mut().zip(sums) {
                if square > 0.0 {
                    *u = (*u + slope / square).clamp(STRENGTHS.0, STRENGTHS.1);
                }
            }
        }
        (0..self.data.len())
            .map(|i| at(i, strengths[self.data.specimen[i]]).value)
            .collect()
    }
}

/// The force of reading `i`, N; `acting` gives the parameters of a term that acts on it.
fn force<R: Real>(
    model: &Model,
    base: &[R],
    strength: R,
    acting: impl Fn(usize) -> Option<[R; 2]>,
    i: usize,
) -> R {
    let parameters = (0..model.terms.len()).filter_map(|t| Some((&model.terms[t], acting(t)?)));
    let acting: Vec<(&Term, [R; 2])> = parameters.collect();
    let applied: Vec<Applied<R>> = acting.iter().filter_map(|(t, p)| t.applied(*p)).collect();
    let force = effects::force(
        model.base,
        base,
        strength,
        &applied,
        &model.data.conditions[i],
    );
    acting
        .iter()
        .fold(force, |force, (term, p)| match term.what {
            What::Empirical(e) => e.apply(force, *p, model.data, i),
            What::Effect { .. } => force,
        })
}

/// Residuals and derivatives at a point, and their products summed by session.
#[derive(Clone)]
struct Sums {
    residuals: Vec<f64>,
    /// Derivatives by slot, then reading.
    traces: Vec<Vec<f64>>,
    /// Products of the derivatives and, last, of the residual, a matrix a session.
    moments: Vec<[[f64; SLOTS + 1]; SLOTS + 1]>,
    /// Sum of squared residuals, N^2.
    rss: f64,
}

impl Sums {
    /// The sums, with no more derivatives than the model has: they are most of the work.
    fn new(model: &Model, layout: &[Place], point: &[f64]) -> Self {
        match model.terms.len() {
            0..=1 => Self::with::<8>(model, layout, point),
            2..=3 => Self::with::<12>(model, layout, point),
            _ => Self::with::<SLOTS>(model, layout, point),
        }
    }

    fn with<const N: usize>(model: &Model, layout: &[Place], point: &[f64]) -> Self {
        let data = model.data;
        let mut at = Point::<Dual<N>>::new(model);
        for (place, value) in layout.iter().zip(point) {
            at.set(*place, *value);
        }
        let used = STRENGTH + 1 + 2 * model.terms.len();
        let mut sums = Self {
            residuals: Vec::with_capacity(data.len()),
            traces: vec![vec![0.0; data.len()]; SLOTS],
            moments: vec![[[0.0; SLOTS + 1]; SLOTS + 1]; data.sessions.len()],
            rss: 0.0,
        };
        for i in 0..data.len() {
            let force = at.force(i);
            let residual = data.force[i] - force.value;
            let d = &force.gradient;
            let moments = &mut sums.moments[data.session[i]];
            for a in 0..used {
                sums.traces[a][i] = d[a];
                for b in 0..=a {
                    moments[a][b] += d[a] * d[b];
                }
                moments[SLOTS][a] += d[a] * residual;
            }
            sums.residuals.push(residual);
            sums.rss += residual * residual;
        }
        sums
    }
}

const MOST_STEPS: usize = 60;
/// Relative fall of the penalised sum of squares at which a descent ends.
const STANDS: f64 = 1e-9;

/// Levenberg and Marquardt's descent on the normal equations, which are sums over sessions: a value for each session or specimen then
/// costs no more than one for all. Columns are scaled by their norms; parameters at a bound that the gradient pushes outwards are
/// held. Accurate to some 1e-6 of a standard error, which is enough here; published coefficients come from
/// [`crate::numerics::fit`].
fn descend(
    model: &Model,
    layout: &[Place],
    point: &mut Vec<f64>,
    sums: &mut Sums,
    penalty: &[f64],
) {
    let bounds: Vec<(f64, f64)> = layout.iter().map(|p| model.bounds(*p)).collect();
    let price = |p: &[f64]| -> f64 { p.iter().zip(penalty).map(|(x, w)| w * x * x).sum() };
    let mut damping = 1e-4;
    let mut settled = 0;
    for _ in 0..MOST_STEPS {
        let (gram, right) = normal_equations(model, layout, sums);
        let now = sums.rss + price(point);
        let slope: Vec<f64> = (0..point.len())
            .map(|k| right[k] - penalty[k] * point[k])
            .collect();
        let held = |k: usize| {
            (point[k] <= bounds[k].0 && slope[k] < 0.0)
                || (point[k] >= bounds[k].1 && slope[k] > 0.0)
        };
        let free: Vec<usize> = (0..point.len())
            .filter(|k| !held(*k) && gram[(*k, *k)] + penalty[*k] > 0.0)
            .collect();
        let mut reduced = Matrix::zeros(free.len(), free.len());
        for (a, i) in free.iter().enumerate() {
            for (b, j) in free.iter().enumerate() {
                reduced[(a, b)] = gram[(*i, *j)];
            }
            reduced[(a, a)] = (gram[(*i, *i)] + penalty[*i]) * (1.0 + damping);
        }
        let target: Vec<f64> = free.iter().map(|k| slope[*k]).collect();
        let step = Cholesky::new(&reduced).solve(&target);
        let mut trial = point.clone();
        for (k, d) in free.iter().zip(&step) {
            trial[*k] = (point[*k] + d).clamp(bounds[*k].0, bounds[*k].1);
        }
        let there = Sums::new(model, layout, &trial);
        let then = there.rss + price(&trial);
        if then <= now {
            *point = trial;
            *sums = there;
            damping = (damping * 0.1).max(1e-12);
            settled = if now - then <= STANDS * now {
                settled + 1
            } else {
                0
            };
            if settled == 2 {
                return;
            }
        } else {
            damping *= 20.0;
            if damping > 1e8 {
                return;
            }
        }
    }
}

fn normal_equations(model: &Model, layout: &[Place], sums: &Sums) -> (Matrix, Vec<f64>) {
    let p = layout.len();
    let specimens = model.data.specimen_of_session();
    let mut gram = Matrix::zeros(p, p);
    let mut right = vec![0.0; p];
    for (s, moments) in sums.moments.iter().enumerate() {
        let slots: Vec<(usize, usize)> = layout
            .iter()
            .enumerate()
            .filter_map(|(k, place)| Some((k, model.slot(*place, s, specimens[s])?)))
            .collect();
        for (i, a) in &slots {
            right[*i] += moments[SLOTS][*a];
            for (j, b) in &slots {
                gram[(*i, *j)] += if a >= b {
                    moments[*a][*b]
                } else {
                    moments[*b][*a]
                };
            }
        }
    }
    (gram, right)
}

/// All parameters of a model as dual numbers.
struct Point<'a, D> {
    model: &'a Model<'a>,
    base: Vec<D>,
    amplitudes: Vec<Vec<f64>>,
    shapes: Vec<f64>,
    strengths: Vec<f64>,
}

impl<'a, const N: usize> Point<'a, Dual<N>> {
    fn new(model: &'a Model<'a>) -> Self {
        let coefficients = model.base.coefficients.iter().enumerate();
        Self {
            base: coefficients
                .map(|(k, c)| {
                    if c.free {
                        Dual::variable(c.start, k)
                    } else {
                        Dual::constant(c.start)
                    }
                })
                .collect(),
            amplitudes: model
                .terms
                .iter()
                .map(|t| vec![0.0; t.amplitudes])
                .collect(),
            shapes: model.terms.iter().map(|t| t.start().1).collect(),
            strengths: vec![0.0; model.data.specimens.len()],
            model,
        }
    }

    fn set(&mut self, place: Place, value: f64) {
        match place {
            Place::Base(k) => self.base[k].value = value,
            Place::Amplitude(t, g) => self.amplitudes[t][g] = value,
            Place::Shape(t) => self.shapes[t] = value,
            Place::Strength(k) => self.strengths[k] = value,
        }
    }

    fn force(&self, i: usize) -> Dual<N> {
        let data = self.model.data;
        let acting = |t: usize| {
            let term = &self.model.terms[t];
            let g = term.acts_on[data.session[i]]?;
            let slot = STRENGTH + 1 + 2 * t;
            let second = if term.second().is_some() {
                Dual::variable(self.shapes[t], slot + 1)
            } else {
                Dual::constant(0.0)
            };
            Some([Dual::variable(self.amplitudes[t][g], slot), second])
        };
        let strength = Dual::variable(1.0 + self.strengths[data.specimen[i]], STRENGTH);
        force(self.model, &self.base, strength, acting, i)
    }
}
