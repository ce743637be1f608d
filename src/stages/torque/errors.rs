//! Errors of torque: measured minus predicted, by test and model, and how far the geometry is from what was measured by hand.
//!
//! FVU is the fraction of the variance that is not explained, SSE/SST with SST about the mean of the measured torques. Nothing is fitted to the
//! points here, so that RMSE is sqrt(SSE/n).

use crate::point::Point;
use pipeline_mechanics::models::ForceModel;
use pipeline_numerics::statistics::{GoodnessOfFit, mean, sum_of_squares};
use serde::{Deserialize, Serialize};

/// From what a torque is predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Basis {
    /// Length and arm of the described leg.
    Geometry,
    /// Length and arm measured by hand.
    ByHand,
}

impl Basis {
    /// As tables have it.
    pub fn name(self) -> &'static str {
        match self {
            Basis::Geometry => "geometry",
            Basis::ByHand => "by_hand",
        }
    }
}

/// Errors of one model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Model id.
    pub model: String,
    /// From what it predicts.
    pub basis: Basis,
    /// Readings with a prediction.
    pub n: usize,
    /// Readings without one: beyond the joint's range, or of no answer.
    pub n_outside: usize,
    /// Readings beyond the model's data.
    pub n_extrapolated: usize,
    /// The statistics; none of no readings.
    pub size: Option<Size>,
}

/// How large errors are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Size {
    /// Readings.
    pub n: usize,
    /// Sum of squares, (N.m)^2.
    pub sse: f64,
    /// Root mean square, N.m.
    pub rmse: f64,
    /// SSE/SST; none where the measured torques do not vary.
    pub fvu: Option<f64>,
    /// Largest size, N.m.
    pub max_abs: f64,
    /// Mean, N.m.
    pub bias: f64,
}

/// How far the geometry is from what was measured by hand: mean and root mean square of measured minus expected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Hand {
    /// eps*.
    pub contraction_rel: Option<Difference>,
    /// l_m, m.
    pub length_m: Option<Difference>,
    /// Arm by Eq. 2, size of the measured less size of the expected, m.
    pub arm_m: Option<Difference>,
    /// The same of Eq. 3.
    pub projected_arm_m: Option<Difference>,
}

/// Mean and root mean square of a difference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// Readings.
    pub n: usize,
    /// Mean.
    pub mean: f64,
    /// Root mean square.
    pub rms: f64,
}

impl Size {
    /// Of measured and predicted torques, N.m; none of no readings.
    pub fn new(pairs: &[(f64, f64)]) -> Option<Self> {
        let (measured, predicted): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
        let g = GoodnessOfFit::new(&measured, &predicted, 0);
        (g.n > 0).then(|| Self {
            n: g.n,
            sse: g.sse,
            rmse: g.rmse,
            fvu: Some(1.0 - g.r2).filter(|f| f.is_finite()),
            max_abs: g.max_abs_error,
            bias: g.bias,
        })
    }
}

/// The errors of every model that covers the diameter (mm): from the geometry, then from what was measured by hand.
pub fn of_models(points: &[Point], models: &[&dyn ForceModel], diameter_mm: f64) -> Vec<Errors> {
    let covers = |m: &dyn ForceModel| m.diameters().contains(&(diameter_mm as u32));
    let listed = models.iter().enumerate().filter(|(_, m)| covers(**m));
    let of_basis = |basis: Basis| {
        listed
            .clone()
            .map(move |(k, m)| errors(points, k, m.id(), basis))
    };
    let mut all: Vec<Errors> = of_basis(Basis::Geometry).collect();
    all.extend(of_basis(Basis::ByHand).filter(|e| e.n > 0));
    all
}

fn errors(points: &[Point], k: usize, model: &str, basis: Basis) -> Errors {
    let predicted = |p: &Point| match basis {
        Basis::Geometry => p.predicted[k].torque_nm,
        Basis::ByHand => p.back_calculated[k],
    };
    let pairs: Vec<(f64, f64)> = points
        .iter()
        .filter_map(|p| Some((p.torque_nm, predicted(p)?)))
        .collect();
    let extrapolated = |p: &&Point| basis == Basis::Geometry && p.predicted[k].extrapolated;
    Errors {
        model: model.to_owned(),
        basis,
        n: pairs.len(),
        n_outside: points.len() - pairs.len(),
        n_extrapolated: points.iter().filter(extrapolated).count(),
        size: Size::new(&pairs),
    }
}

/// What was measured by hand, less what the geometry expects.
pub fn by_hand(points: &[Point]) -> Hand {
    let of = |f: &dyn Fn(&Point) -> Option<f64>| {
        let all: Vec<f64> = points.iter().filter_map(f).collect();
        (!all.is_empty()).then(|| Difference {
            n: all.len(),
            mean: mean(&all),
            rms: (sum_of_squares(&all) / all.len() as f64).sqrt(),
        })
    };
    Hand {
        contraction_rel: of(&|p| {
            Some(p.by_hand.contraction_rel? - p.expected.as_ref()?.contraction_rel)
        }),
        length_m: of(&|p| Some(p.by_hand.length_m? - p.expected.as_ref()?.length_m)),
        arm_m: of(&|p| Some(p.by_hand.arm_m?.abs() - p.expected.as_ref()?.arm_m.abs())),
        projected_arm_m: of(&|p| {
            Some(p.by_hand.arm_m?.abs() - p.expected.as_ref()?.projected_arm_m.abs())
        }),
    }
}
