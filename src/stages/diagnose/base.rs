//! The base model: what the effects are added to.

use super::settings;
use super::slack::Shape;
use pipeline_config::FitOptions;
use pipeline_effects::{Actuator, Conditions};
use pipeline_fit::equations;
use pipeline_mechanics::models::{
    Coefficient, Direction, ForceModel, P_620_KPA, State, hunt2017, new, published,
};
use pipeline_numerics::real::Real;

/// A coefficient of a base model.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseCoefficient {
    /// Symbol.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Where the fit starts.
    pub start: f64,
    /// Where it may go.
    pub bounds: (f64, f64),
    /// Whether it is fitted.
    pub free: bool,
    /// What is known of it beforehand: its usual value and the standard deviation about that. None of a scale, and of a law that is taken as published.
    pub known: Option<(f64, f64)>,
    /// The published coefficient of which it is the reciprocal.
    pub reciprocal_of: Option<&'static str>,
}

enum Equation {
    /// Eq. 9 of the force paper: b1, 1/b2, c0, c1, c2. The reciprocal is 0 where the force does not depend on the resting length, and the
    /// fit can end there.
    New {
        /// l_0, m.
        cap_length_m: f64,
    },
    /// Hunt's, knee paper Eq. 4: p0, A, w, q, k, g.
    Hunt,
    /// A published model times a scale.
    Published(&'static dyn ForceModel),
}

/// The base model of a diagnosis.
pub struct Base {
    /// Id in findings: "new" where it is refitted, else that of the published model.
    pub id: String,
    /// Coefficients, in the order of the equation.
    pub coefficients: Vec<BaseCoefficient>,
    equation: Equation,
    /// The shape that tells where an actuator is slack, if it is not the usual one of the diameter.
    shape: Option<Shape>,
}

/// Place of the coefficient by which the force depends on the resting length.
pub const LENGTH_LAW: usize = 1;
/// Its symbol: the reciprocal of b2 is 0 where the force does not depend on the length.
const LENGTH_LAW_NAME: &str = "1/b2";
/// The coefficients of which nothing is known beforehand: b1 scales the force, and both together the pressure. What is known of them would tell a
/// gain of a sensor from the law.
const SCALES: [&str; 2] = ["b1", "c0"];
/// 1/b2 of a force that does not depend on the resting length, m.
const NO_LENGTH_LAW: f64 = 1e-4;

/// Bounds of the coefficients of Hunt's law p0, A, w, q, k, g. The largest contraction, eps_max - k F, stays positive up to the 600 N that no 10 mm
/// actuator reaches; with the published k, of forces up to 107 N, it vanishes at 500 N.
const HUNT_BOUNDS: [(f64, f64); 6] = [
    (-1000.0, 1000.0),
    (1.0, 2000.0),
    (0.2, 3.0),
    (-0.5, 1.5),
    (0.0, 2.4e-4),
    (0.2, 10.0),
];

/// The published coefficient, or a neutral value.
fn published_or(diameter_mm: u32, symbol: &str, otherwise: f64) -> f64 {
    new::published(diameter_mm, [symbol]).map_or(otherwise, |[value]| value)
}

impl Base {
    /// The new model, refitted or with its published coefficients.
    pub fn new(diameter_mm: u32, refit: bool, lengths: usize, options: &FitOptions) -> Self {
        let value = |symbol: &str, otherwise: f64| published_or(diameter_mm, symbol, otherwise);
        let constant = value("F_620", 1000.0) / std::f64::consts::FRAC_PI_2;
        let law = equations::length_law(diameter_mm);
        let spread = match Shape::published(diameter_mm) {
            Some(_) => settings::LAW_SPREAD,
            None => settings::UNPUBLISHED_LAW_SPREAD,
        };
        let list = [
            ("b1", "N", value("b1", constant), (1e-3, 1e5), true),
            (
                LENGTH_LAW_NAME,
                "m",
                law.map_or(NO_LENGTH_LAW, |b2| 1.0 / b2),
                (NO_LENGTH_LAW, 10.0),
                lengths > 1 && law.is_some(),
            ),
            ("c0", "1", value("c0", 0.4), (0.0, 5.0), true),
            ("c1", "1", value("c1", 5.0), (1e-3, 100.0), true),
            ("c2", "1", value("c2", 1.0), (-2.0, 50.0), true),
        ];
        let coefficients = list
            .into_iter()
            .map(|(name, unit, start, bounds, free)| BaseCoefficient {
                name: name.to_owned(),
                unit: unit.to_owned(),
                start,
                bounds,
                free: free && refit,
                known: (refit && !SCALES.contains(&name)).then_some((start, spread * start)),
                reciprocal_of: (name == LENGTH_LAW_NAME).then_some("b2"),
            })
            .collect();
        Self {
            id: if refit { "new" } else { "new_published" }.to_owned(),
            coefficients,
            equation: Equation::New {
                cap_length_m: equations::cap_length_m(diameter_mm, options),
            },
            shape: None,
        }
    }

    /// The new model for evaluation alone, with the shape that tells where an actuator is slack: nothing of it is fitted.
    pub fn evaluated(diameter_mm: u32, cap_length_m: f64, shape: Shape) -> Self {
        Self {
            equation: Equation::New { cap_length_m },
            shape: Some(shape),
            ..Self::new(diameter_mm, false, 1, &FitOptions::default())
        }
    }

    /// l_0 of the new model, m; none of another.
    pub fn cap_length_m(&self) -> Option<f64> {
        match self.equation {
            Equation::New { cap_length_m } => Some(cap_length_m),
            Equation::Hunt | Equation::Published(_) => None,
        }
    }

    /// The same for a diameter of which nothing is published: fits start at these coefficients b1, b2, c0, c1 and c2 of least squares, which also
    /// tell where an actuator is slack.
    pub fn starting_at(mut self, [b1, b2, c0, c1, c2]: [f64; 5]) -> Self {
        let values = [b1, 1.0 / b2, c0, c1, c2];
        for (c, value) in self.coefficients.iter_mut().zip(values) {
            c.start = value.clamp(c.bounds.0, c.bounds.1);
        }
        self.shape = Some(Shape([c0, c1, c2]));
        self
    }

    /// The shape that tells where an actuator is slack.
    pub fn shape(&self, at: &Conditions) -> Shape {
        self.shape
            .unwrap_or_else(|| Shape::usual(at.diameter_mm as u32))
    }

    /// A published model; refitted means its coefficients where they are few and smooth, else one factor on its force.
    pub fn published(id: &str, refit: bool) -> Option<Self> {
        let model = published().into_iter().find(|m| m.id() == id)?;
        if refit && id == hunt2017::Hunt2017.id() {
            return Some(Self::hunt());
        }
        Some(Self {
            id: id.to_owned(),
            coefficients: vec![BaseCoefficient {
                name: "scale".to_owned(),
                unit: "1".to_owned(),
                start: 1.0,
                bounds: (0.05, 20.0),
                free: refit,
                known: None,
                reciprocal_of: None,
            }],
            equation: Equation::Published(model),
            shape: None,
        })
    }

    /// Hunt's law refitted.
    fn hunt() -> Self {
        let published = hunt2017::PUBLISHED_10.iter().take(HUNT_BOUNDS.len());
        let one = |(c, bounds): (&Coefficient, (f64, f64))| BaseCoefficient {
            name: c.symbol.to_owned(),
            unit: c.unit.to_owned(),
            start: c.value.clamp(bounds.0, bounds.1),
            bounds,
            free: true,
            known: None,
            reciprocal_of: None,
        };
        Self {
            id: hunt2017::Hunt2017.id().to_owned(),
            coefficients: published.zip(HUNT_BOUNDS).map(one).collect(),
            equation: Equation::Hunt,
            shape: None,
        }
    }

    /// Prior scale of the misfit that all specimens share, share of the force: whether the shape of the law was fitted to such actuators.
    pub fn common_misfit(&self) -> f64 {
        let has_shape = !matches!(self.equation, Equation::Published(_));
        if has_shape && self.coefficients.iter().any(|c| c.free) {
            settings::COMMON_MISFIT
        } else {
            settings::PUBLISHED_MISFIT
        }
    }

    /// Starting values of all coefficients.
    pub fn starts(&self) -> Vec<f64> {
        self.coefficients.iter().map(|c| c.start).collect()
    }

    /// The same model with and without its dependence on the resting length, of which nothing is known beforehand in either, so that readings alone tell
    /// them apart: what is published of it may have been measured on the rig in question. None of a model in which it is not fitted.
    pub fn with_and_without_length_law(&self) -> Option<[Self; 2]> {
        let cap_length_m = self.cap_length_m()?;
        self.fits_length_law().then(|| {
            let of = |free: bool| {
                let mut coefficients = self.coefficients.clone();
                let c = &mut coefficients[LENGTH_LAW];
                c.known = None;
                c.free = free;
                if !free {
                    c.start = NO_LENGTH_LAW;
                }
                Self {
                    id: self.id.clone(),
                    coefficients,
                    equation: Equation::New { cap_length_m },
                    shape: self.shape,
                }
            };
            [of(true), of(false)]
        })
    }

    /// Whether it has a dependence on the resting length that is fitted.
    pub fn fits_length_law(&self) -> bool {
        self.cap_length_m().is_some() && self.coefficients[LENGTH_LAW].free
    }
}

impl Base {
    /// The law as a product: what depends on the state, and the size. The law is not cut off where it is negative: `slack` sees to that.
    ///
    /// Two numbers may follow the coefficients: by what the resting and the contracted length are longer than noted, mm.
    fn factors<R: Real>(&self, c: &[R], pressure: R, length: R, at: &Conditions) -> (R, R) {
        let longer = |k: usize| {
            let by = c.get(self.coefficients.len() + k);
            by.map_or(R::constant(0.0), |mm| *mm * 1e-3)
        };
        let rest = longer(0) + at.rest_length_m;
        let contracted = longer(1) + at.contracted_length_m;
        match self.equation {
            Equation::New { cap_length_m } => {
                let contraction = (rest - length) / (rest - contracted);
                let f620 = new::f620(
                    c[0],
                    R::constant(1.0) / c[1],
                    R::constant(cap_length_m),
                    rest,
                );
                let surface =
                    new::surface_signed([c[2], c[3], c[4]], contraction, pressure / P_620_KPA);
                (surface, f620)
            }
            Equation::Hunt => {
                let contraction = (rest - length) / rest;
                let largest = (rest - contracted) / rest;
                let c = [c[0], c[1], c[2], c[3], c[4], c[5], R::constant(0.0)];
                let force = hunt2017::force_signed(c, pressure, contraction, largest);
                (force / USUAL_F620_N, R::constant(USUAL_F620_N))
            }
            Equation::Published(model) => (
                tangent(model, pressure, length, [rest, contracted], at) / USUAL_F620_N,
                c[0] * USUAL_F620_N,
            ),
        }
    }

    /// The law with its corner to slackness rounded over `width`, a share of the force at 620 kPa. The width goes with the size of the law, or the
    /// shape of the corner would tell a gain of the force from the size.
    pub fn rounded<R: Real>(
        &self,
        coefficients: &[R],
        pressure: R,
        length: R,
        at: &Conditions,
        width: f64,
    ) -> R {
        let (surface, size) = self.factors(coefficients, pressure, length, at);
        (surface + (surface * surface + width * width).sqrt()) * size * 0.5
    }
}

impl Actuator for Base {
    fn force<R: Real>(&self, coefficients: &[R], pressure: R, length: R, at: &Conditions) -> R {
        let (surface, size) = self.factors(coefficients, pressure, length, at);
        surface * size
    }
}

/// What the force of a published law is a share of, N.
const USUAL_F620_N: f64 = 500.0;

/// Steps of the differences by which a published model gets its derivatives: kPa, m.
const STEPS: (f64, f64) = (1.0, 1e-4);

/// Halvings by which the end of a model's domain is found on the way to a state outside.
const HALVINGS: u32 = 12;

/// A published model with derivatives by differences: by pressure, by length, and by resting and contracted length. Where random effects or
/// effects lead out of the domain of the model, it goes on with the slopes that it has at the last state inside on the way there from what was
/// set; not a number where that is outside itself.
fn tangent<R: Real>(
    model: &dyn ForceModel,
    pressure: R,
    length: R,
    [rest, contracted]: [R; 2],
    at: &Conditions,
) -> R {
    let variables = [pressure, length, rest, contracted];
    let force = |[pressure, length_m, rest_length_m, contracted_length_m]: [f64; 4]| {
        let state = State {
            diameter_mm: at.diameter_mm,
            rest_length_m,
            contracted_length_m,
            length_m,
            pressure_kpa: pressure.max(0.0),
            direction: Direction::Isometric,
        };
        model.predict(&state).force_n()
    };
    let here = variables.map(|v| v.value());
    let set = [
        at.pressure_kpa,
        at.length_m,
        at.rest_length_m,
        at.contracted_length_m,
    ];
    let on_the_way = |share: f64| std::array::from_fn(|k| set[k] + share * (here[k] - set[k]));
    let share = match force(here) {
        Some(_) => 1.0,
        None => share_inside(|share| force(on_the_way(share)).is_some()),
    };
    let inside: [f64; 4] = if share == 1.0 {
        here
    } else {
        on_the_way(share)
    };
    let Some(middle) = force(inside) else {
        return R::constant(f64::NAN);
    };
    let mut shown = R::constant(middle);
    for (k, v) in variables.into_iter().enumerate() {
        if v.is_constant() && share == 1.0 {
            continue;
        }
        let step = if k == 0 { STEPS.0 } else { STEPS.1 };
        let moved = |by: f64| {
            let mut there = inside;
            there[k] += by;
            force(there)
        };
        let slope = match (moved(-step), moved(step)) {
            (Some(below), Some(above)) => (above - below) / (2.0 * step),
            (Some(below), None) => (middle - below) / step,
            (None, Some(above)) => (above - middle) / step,
            (None, None) => 0.0,
        };
        shown = shown + (v - inside[k]) * slope;
    }
    shown
}

/// The share of the way from what was set to a state outside at which the domain of a model ends.
fn share_inside(is_inside: impl Fn(f64) -> bool) -> f64 {
    let (mut share, mut part) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        part *= 0.5;
        if is_inside(share + part) {
            share += part;
        }
    }
    share
}
