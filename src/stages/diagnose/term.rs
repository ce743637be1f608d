//! What can be added to a model: an effect of the library, or an empirical dependence on a column, on all or on some of the readings.

use super::data::Data;
use crate::effects::{self, Applied, Form, Need, Parameter};
use crate::models::P_620_KPA;
use crate::numerics::real::Real;

/// What is added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// A form of an effect, by their places in [`effects::all`] and its forms, and the shape at which it is tried (not a number
    /// where the form has none).
    Effect {
        /// Place in [`effects::all`].
        effect: usize,
        /// Place in its forms.
        form: usize,
        /// Shape where the fit starts.
        shape: f64,
    },
    /// A dependence without a physical name.
    Empirical(Empirical),
}

/// A dependence without a physical name, with two coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Empirical {
    /// F (1 + a x + b x^2), x an extra column by its place in the data.
    Gain(usize),
    /// F + a x + b: where the column has its zero is not known.
    Offset(usize),
    /// F (1 + a F/S + b F^2/S^2): the force channel is not straight.
    Force,
    /// F (1 + a P* + b P*^2): the pressure channel is not straight, or the surface has another shape in P.
    Pressure,
}

/// S: the scale of the force in [`Empirical::Force`], N.
pub const FORCE_SCALE_N: f64 = 500.0;

/// On which readings it acts.
#[derive(Clone, Debug, PartialEq)]
pub enum Scope {
    /// All.
    Whole,
    /// One session.
    Session(usize),
    /// One session and all after it.
    From(usize),
    /// One specimen.
    Specimen(usize),
    /// A value for every session.
    EachSession,
    /// A value for every level of an extra column that names groups, less the first.
    Levels(usize),
}

/// An addition to a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// What.
    pub what: What,
    /// Where.
    pub scope: Scope,
    /// For each session the number of the amplitude that acts on it, or none.
    pub acts_on: Vec<Option<usize>>,
    /// Number of amplitudes.
    pub amplitudes: usize,
}

impl Term {
    /// A term on the sessions of some data.
    pub fn new(what: What, scope: Scope, data: &Data) -> Self {
        let sessions = data.sessions.len();
        let (acts_on, amplitudes): (Vec<Option<usize>>, usize) = match &scope {
            Scope::Whole => (vec![Some(0); sessions], 1),
            Scope::Session(one) => ((0..sessions).map(|s| (s == *one).then_some(0)).collect(), 1),
            Scope::From(first) => (
                (0..sessions).map(|s| (s >= *first).then_some(0)).collect(),
                1,
            ),
            Scope::Specimen(k) => {
                let of = data.specimen_of_session();
                (
                    (0..sessions).map(|s| (of[s] == *k).then_some(0)).collect(),
                    1,
                )
            }
            Scope::EachSession => ((0..sessions).map(Some).collect(), sessions),
            Scope::Levels(column) => data.levels(*column),
        };
        Self {
            what,
            scope,
            acts_on,
            amplitudes,
        }
    }

    /// The form, of an effect of the library.
    pub fn form(&self) -> Option<&'static Form> {
        match self.what {
            What::Effect { effect, form, .. } => Some(&effects::all()[effect].forms()[form]),
            What::Empirical(_) => None,
        }
    }

    /// Id of the effect; none of an empirical dependence.
    pub fn id(&self) -> Option<&'static str> {
        match self.what {
            What::Effect { effect, .. } => Some(effects::all()[effect].id()),
            What::Empirical(_) => None,
        }
    }

    /// Id of the effect, with the name of the form where it has several; none of an empirical dependence.
    pub fn words(&self) -> Option<String> {
        let What::Effect { effect, form, .. } = self.what else {
            return None;
        };
        let effect = effects::all()[effect];
        Some(if effect.forms().len() > 1 {
            format!("{} ({})", effect.id(), effect.forms()[form].name)
        } else {
            effect.id().to_owned()
        })
    }

    /// Whether something beside the force speaks for it: zero logs that stand out.
    pub fn has_evidence(&self) -> bool {
        self.form().is_some_and(|f| f.needs.contains(&Need::Zeros))
    }

    /// Whether both are the same form of one effect.
    pub fn what_is(&self, other: &Term) -> bool {
        match (self.what, other.what) {
            (
                What::Effect { effect, form, .. },
                What::Effect {
                    effect: e, form: f, ..
                },
            ) => effect == e && form == f,
            (a, b) => a == b,
        }
    }

    /// Bounds of the amplitudes.
    pub fn amplitude_bounds(&self) -> (f64, f64) {
        self.form().map_or((-5e3, 5e3), |f| f.amplitude.bounds)
    }

    /// The second parameter, if it has one: a form's shape, or the second coefficient of a polynomial.
    pub fn second(&self) -> Option<Parameter> {
        match self.what {
            What::Effect { .. } => self.form().and_then(|f| f.shape).map(|(p, _)| p),
            What::Empirical(_) => Some(Parameter {
                name: "b",
                unit: "1",
                absent: 0.0,
                bounds: (-5e3, 5e3),
            }),
        }
    }

    /// Where the amplitude and the second parameter start.
    pub fn start(&self) -> (f64, f64) {
        match self.what {
            What::Effect { effect, shape, .. } => (effects::all()[effect].near(), shape),
            What::Empirical(_) => (0.0, 0.0),
        }
    }

    /// Parameters that it adds to a model.
    pub fn parameters(&self) -> usize {
        self.amplitudes + usize::from(self.second().is_some())
    }

    /// The operator of the library with these parameters, for the chain.
    pub fn applied<R>(&self, parameters: [R; 2]) -> Option<Applied<R>> {
        match self.what {
            What::Effect { effect, form, .. } => Some(Applied {
                effect,
                form,
                parameters,
            }),
            What::Empirical(_) => None,
        }
    }
}

impl Empirical {
    /// The force with the dependence, of reading `i`.
    pub fn apply<R: Real>(self, force: R, [a, b]: [R; 2], data: &Data, i: usize) -> R {
        match self {
            Empirical::Gain(column) => {
                let x = data.extras[column].values[i];
                force * ((b * x + a) * x + 1.0)
            }
            Empirical::Offset(column) => {
                let x = data.extras[column].values[i];
                force + a * x + b
            }
            Empirical::Force => {
                let x = force / FORCE_SCALE_N;
                force * ((b * x + a) * x + 1.0)
            }
            Empirical::Pressure => {
                let x = data.conditions[i].pressure_kpa / P_620_KPA;
                force * ((b * x + a) * x + 1.0)
            }
        }
    }

    /// How the force depends on the column with these coefficients: "gain" (relative) or "offset" (N), and its curve over the range
    /// of the column.
    pub fn curve(self, data: &Data, [a, b]: [f64; 2]) -> (&'static str, Vec<(f64, f64)>) {
        let spread = |values: &mut dyn Iterator<Item = f64>| {
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                (l.min(x), h.max(x))
            });
            (0..=20)
                .map(|k| low + f64::from(k) / 20.0 * (high - low))
                .collect::<Vec<f64>>()
        };
        match self {
            Empirical::Gain(k) | Empirical::Offset(k) => {
                let extra = &data.extras[k];
                let gain = matches!(self, Empirical::Gain(_));
                let at = |x: f64| if gain { (b * x + a) * x } else { a * x + b };
                let points = spread(&mut extra.values.iter().copied());
                let curve = points
                    .into_iter()
                    .map(|x| (extra.scale.0 + extra.scale.1 * x, at(x)))
                    .collect();
                (if gain { "gain" } else { "offset" }, curve)
            }
            Empirical::Force => {
                let points = spread(&mut data.force.iter().copied());
                let at = |f: f64| (b * f / FORCE_SCALE_N + a) * f / FORCE_SCALE_N;
                ("gain", points.into_iter().map(|f| (f, at(f))).collect())
            }
            Empirical::Pressure => {
                let points = spread(&mut data.conditions.iter().map(|c| c.pressure_kpa));
                let at = |p: f64| (b * p / P_620_KPA + a) * p / P_620_KPA;
                ("gain", points.into_iter().map(|p| (p, at(p))).collect())
            }
        }
    }

    /// The column on which it depends, as findings name it.
    pub fn column(self, data: &Data) -> String {
        match self {
            Empirical::Gain(k) | Empirical::Offset(k) => data.extras[k].name.clone(),
            Empirical::Force => "force_n".to_owned(),
            Empirical::Pressure => "pressure_kpa".to_owned(),
        }
    }
}
