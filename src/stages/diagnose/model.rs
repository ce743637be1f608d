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
use crate::numerics::levenberg_marquardt::{LeastSquaresProblem, Limits, minimise};
use crate::numerics::bounds::Bounds;
use crate::numerics::matrix::Matrix;

use crate::numerics::real::{Dual, Real};
use std::cell::RefCell;

/// Derivatives that one evaluation carries: five coefficients, the strength, and two for each of five effects.
const SLOTS: usize = 16;
/// Most effects in one model.
pub const MOST_TERMS: usize = 5;
const STRENGTH: usize = 5;
type D = Dual<SLOTS>;

/// Usual relative scatter of the strengths of one make: what the null model expects.
pub const USUAL_SCATTER: f64 = 0.02;
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
    /// Derivatives by the free parameters (see [`Model::layout`]), readings x parameters.
    pub jacobian: Matrix,
    /// Penalty on the square of each parameter, in units of the residuals' variance.
    pub penalty: Vec<f64>,
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

    /// Fits from where another fit ended (`None`: from the base's starting values).
    pub fn fit(&self, from: Option<&Fitted>, passes: usize) -> Fitted {
        let mut point = self.start(from);
        let (mut sigma, mut scatter) = from.map_or((f64::NAN, USUAL_SCATTER), |f| (f.sigma, f.scatter));
        if !sigma.is_finite() {
            sigma = self.first_guess_of_sigma(&point);
        }
        let mut fitted = self.fit_once(&mut point, sigma, scatter);
        for _ in 0..passes {
            (sigma, scatter) = (fitted.sigma, fitted.scatter);
            fitted = self.fit_once(&mut point, sigma, scatter);
        }
        fitted
    }

    fn first_guess_of_sigma(&self, point: &[f64]) -> f64 {
        let problem = Problem::new(self, vec![0.0; point.len()]);
        let mut r = vec![0.0; problem.observations()];
        problem.residuals(point, &mut r);
        let n = self.data.len();
        (r[..n].iter().map(|x| x * x).sum::<f64>() / n as f64).sqrt().max(1e-6)
    }

    fn start(&self, from: Option<&Fitted>) -> Vec<f64> {
        self.layout()
            .into_iter()
            .map(|place| match place {
                Place::Base(k) => from.map_or(self.base.coefficients[k].start, |f| f.base[k]),
                Place::Amplitude(t, g) => {
                    let known = from.and_then(|f| f.terms.get(t)).and_then(|(a, _)| a.get(g));
                    known.copied().unwrap_or(self.terms[t].start().0)
                }
                Place::Shape(t) => {
                    let known = from.and_then(|f| f.terms.get(t)).map(|(_, shape)| *shape);
                    known.filter(|x| x.is_finite()).unwrap_or(self.terms[t].start().1)
                }
                Place::Strength(k) => from.map_or(0.0, |f| f.strengths[k]),
            })
            .collect()
    }

    fn bounds(&self) -> Bounds {
        let bounds: Vec<(f64, f64)> = self
            .layout()
            .into_iter()
            .map(|place| match place {
                Place::Base(k) => self.base.coefficients[k].bounds,
                Place::Amplitude(t, _) => self.terms[t].amplitude_bounds(),
                Place::Shape(t) => self.terms[t].second().map_or((0.0, 1.0), |p| p.bounds),
                Place::Strength(_) => (-0.8, 4.0),
            })
            .collect();
        Bounds::new(Some(&bounds), bounds.len())
    }

    fn fit_once(&self, point: &mut Vec<f64>, sigma: f64, scatter: f64) -> Fitted {
        let layout = self.layout();
        let penalty: Vec<f64> = layout
            .iter()
            .map(|place| match place {
                Place::Strength(_) => (sigma / scatter) * (sigma / scatter),
                _ => 0.0,
            })
            .collect();
        let problem = Problem::new(self, penalty.clone());
        let factors = vec![1.0; problem.observations()];
        let limits = Limits {
            max_iterations: 60,
            tolerance: 1e-10,
            polish: false,
        };
        let minimum = minimise(&problem, point, &factors, &self.bounds(), limits);
        *point = minimum.parameters;
        let mut residuals = vec![0.0; problem.observations()];
        problem.residuals(point, &mut residuals);
        let mut jacobian = Matrix::zeros(problem.observations(), point.len());
        problem.jacobian(point, &mut jacobian);
        let n = self.data.len();
        residuals.truncate(n);
        self.fitted(&layout, point, residuals, &jacobian, penalty, scatter)
    }

    fn fitted(&self, layout: &[Place], point: &[f64], residuals: Vec<f64>, jacobian: &Matrix, penalty: Vec<f64>, scatter: f64) -> Fitted {
        let n = self.data.len();
        let mut readings = Matrix::zeros(n, layout.len());
        for k in 0..layout.len() {
            readings.column_mut(k).copy_from_slice(&jacobian.column(k)[..n]);
        }
        let mut fitted = Fitted {
            base: self.base.starts(),
            terms: self.terms.iter().map(|t| (vec![0.0; t.amplitudes], t.start().1)).collect(),
            strengths: vec![0.0; self.data.specimens.len()],
            scatter,
            sigma: 0.0,
            residuals,
            jacobian: readings,
            penalty,
        };
        for (place, value) in layout.iter().zip(point) {
            match place {
                Place::Base(k) => fitted.base[*k] = *value,
                Place::Amplitude(t, g) => fitted.terms[*t].0[*g] = *value,
                Place::Shape(t) => fitted.terms[*t].1 = *value,
                Place::Strength(k) => fitted.strengths[*k] = *value,
            }
        }
        let rss: f64 = fitted.residuals.iter().map(|r| r * r).sum();
        fitted.sigma = (rss / (n.saturating_sub(layout.len()).max(1)) as f64).sqrt().max(1e-9);
        fitted.scatter = self.scatter(&fitted, layout, scatter);
        fitted
    }

    /// One EM step for the scatter of the strengths: mean of u^2 and of its variance.
    fn scatter(&self, fitted: &Fitted, layout: &[Place], scatter: f64) -> f64 {
        let seen = self.data.specimen.iter().copied().collect::<std::collections::BTreeSet<usize>>();
        if seen.len() < 3 {
            return USUAL_SCATTER;
        }
        let mut sum = 0.0;
        for k in &seen {
            let place = layout.iter().position(|p| *p == Place::Strength(*k)).unwrap_or(0);
            let column = fitted.jacobian.column(place);
            let information = column.iter().map(|x| x * x).sum::<f64>() / (fitted.sigma * fitted.sigma);
            let variance = 1.0 / (information + 1.0 / (scatter * scatter));
            sum += fitted.strengths[*k] * fitted.strengths[*k] + variance;
        }
        let lost = self.base.coefficients.iter().take(2).filter(|c| c.free).count();
        let freedom = seen.len().saturating_sub(lost).max(1) as f64;
        (sum / freedom).sqrt().clamp(SCATTER_RANGE.0, SCATTER_RANGE.1)
    }

    /// The force of each reading, N, with the strengths of the specimens or of mean ones.
    pub fn predict(&self, fitted: &Fitted, with_strengths: bool) -> Vec<f64> {
        (0..self.data.len())
            .map(|i| {
                let strength = if with_strengths { fitted.strengths[self.data.specimen[i]] } else { 0.0 };
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

/// The force of reading `i`, N; `acting` gives the parameters of a term that acts on it.
fn force<R: Real>(model: &Model, base: &[R], strength: R, acting: impl Fn(usize) -> Option<[R; 2]>, i: usize) -> R {
    let parameters = (0..model.terms.len()).filter_map(|t| Some((&model.terms[t], acting(t)?)));
    let acting: Vec<(&Term, [R; 2])> = parameters.collect();
    let applied: Vec<Applied<R>> = acting.iter().filter_map(|(t, p)| t.applied(*p)).collect();
    let force = effects::force(model.base, base, strength, &applied, &model.data.conditions[i]);
    acting.iter().fold(force, |force, (term, p)| match term.what {
        What::Empirical(e) => e.apply(force, *p, model.data, i),
        What::Effect { .. } => force,
    })
}

/// The penalised least-squares problem: readings first, then one row a parameter that is penalised.
struct Problem<'a> {
    model: &'a Model<'a>,
    layout: Vec<Place>,
    roots: Vec<f64>,
    last: RefCell<Option<(Vec<f64>, Vec<f64>, Matrix)>>,
}

impl<'a> Problem<'a> {
    fn new(model: &'a Model<'a>, penalty: Vec<f64>) -> Self {
        Self {
            layout: model.layout(),
            model,
            roots: penalty.iter().map(|p| p.sqrt()).collect(),
            last: RefCell::new(None),
        }
    }

    fn penalised(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.roots.iter().copied().enumerate().filter(|(_, root)| *root > 0.0)
    }

    fn evaluate(&self, p: &[f64]) -> (Vec<f64>, Matrix) {
        let (model, data) = (self.model, self.model.data);
        let mut point = Point::new(model);
        for (place, value) in self.layout.iter().zip(p) {
            point.set(*place, *value);
        }
        let columns = point.columns(&self.layout);
        let mut residuals = vec![0.0; self.observations()];
        let mut jacobian = Matrix::zeros(residuals.len(), p.len());
        for i in 0..data.len() {
            let (session, specimen) = (data.session[i], data.specimen[i]);
            let force = point.force(i);
            residuals[i] = data.force[i] - force.value;
            for (slot, column) in columns.at(model, session, specimen) {
                jacobian[(i, column)] = force.gradient[slot];
            }
        }
        for (row, (k, root)) in self.penalised().enumerate() {
            residuals[data.len() + row] = -root * p[k];
            jacobian[(data.len() + row, k)] = root;
        }
        (residuals, jacobian)
    }
}

impl LeastSquaresProblem for Problem<'_> {
    fn parameters(&self) -> usize {
        self.layout.len()
    }

    fn observations(&self) -> usize {
        self.model.data.len() + self.penalised().count()
    }

    fn residuals(&self, p: &[f64], r: &mut [f64]) {
        let (residuals, jacobian) = self.evaluate(p);
        r.copy_from_slice(&residuals);
        *self.last.borrow_mut() = Some((p.to_vec(), residuals, jacobian));
    }

    fn jacobian(&self, p: &[f64], j: &mut Matrix) {
        let known = self.last.borrow().as_ref().is_some_and(|(at, _, _)| at.as_slice() == p);
        if !known {
            self.residuals(p, &mut vec![0.0; self.observations()]);
        }
        if let Some((_, _, jacobian)) = self.last.borrow().as_ref() {
            j.clone_from(jacobian);
        }
    }
}

/// All parameters of a model as dual numbers.
struct Point<'a> {
    model: &'a Model<'a>,
    base: Vec<D>,
    amplitudes: Vec<Vec<f64>>,
    shapes: Vec<f64>,
    strengths: Vec<f64>,
}

impl<'a> Point<'a> {
    fn new(model: &'a Model<'a>) -> Self {
        let coefficients = model.base.coefficients.iter().enumerate();
        Self {
            base: coefficients
                .map(|(k, c)| if c.free { D::variable(c.start, k) } else { D::constant(c.start) })
                .collect(),
            amplitudes: model.terms.iter().map(|t| vec![0.0; t.amplitudes]).collect(),
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

    fn force(&self, i: usize) -> D {
        let data = self.model.data;
        let acting = |t: usize| {
            let term = &self.model.terms[t];
            let g = term.acts_on[data.session[i]]?;
            let slot = STRENGTH + 1 + 2 * t;
            let second = if term.second().is_some() { D::variable(self.shapes[t], slot + 1) } else { D::constant(0.0) };
            Some([D::variable(self.amplitudes[t][g], slot), second])
        };
        let strength = D::variable(1.0 + self.strengths[data.specimen[i]], STRENGTH);
        force(self.model, &self.base, strength, acting, i)
    }

    fn columns(&self, layout: &[Place]) -> Columns {
        let position = |place: Place| layout.iter().position(|p| *p == place);
        Columns {
            base: (0..self.base.len()).map(|k| position(Place::Base(k))).collect(),
            amplitudes: self
                .amplitudes
                .iter()
                .enumerate()
                .map(|(t, a)| (0..a.len()).map(|g| position(Place::Amplitude(t, g))).collect())
                .collect(),
            shapes: (0..self.shapes.len()).map(|t| position(Place::Shape(t))).collect(),
            strengths: (0..self.strengths.len()).map(|k| position(Place::Strength(k))).collect(),
        }
    }
}

/// In which column of the Jacobian a derivative stands.
struct Columns {
    base: Vec<Option<usize>>,
    amplitudes: Vec<Vec<Option<usize>>>,
    shapes: Vec<Option<usize>>,
    strengths: Vec<Option<usize>>,
}

impl Columns {
    /// Pairs of slot and column for a reading of this session and specimen.
    fn at<'b>(&'b self, model: &'b Model, session: usize, specimen: usize) -> impl Iterator<Item = (usize, usize)> + 'b {
        let base = self.base.iter().enumerate().filter_map(|(k, c)| Some((k, (*c)?)));
        let amplitudes = self.amplitudes.iter().enumerate().filter_map(move |(t, list)| {
            let g = model.terms[t].acts_on[session]?;
            Some((STRENGTH + 1 + 2 * t, list[g]?))
        });
        let shapes = self.shapes.iter().enumerate().filter_map(|(t, c)| Some((STRENGTH + 2 + 2 * t, (*c)?)));
        let strength = self.strengths[specimen].map(|c| (STRENGTH, c));
        base.chain(amplitudes).chain(shapes).chain(strength)
    }
}
