//! The columns of the misfit: cosines over (eps*, P*) and along the pressure, times its scale.
//!
//! The common misfit is what the law cannot be with any coefficients: its columns stand at right angles to the derivatives by the free
//! coefficients at the fit without misfit, over the scale of the misfit. Else the two share the force between them as the prior of the misfit
//! would have it, not the data: on the rig it took 45% of the force, and the coefficients meant nothing.

use super::ForceProblem;
use crate::data::{Data, contraction_620};
use crate::mixed_law::Beside;
use crate::settings;
use crate::smooth::cosines;
use pipeline_effects::Conditions;
use pipeline_mechanics::models::P_620_KPA;
use pipeline_numerics::matrix::Matrix;
use pipeline_numerics::qr::PivotedQr;

/// Cosines of a session's misfit along the pressure.
pub(crate) const SESSION_COSINES: usize = 8;

/// Cosines of a stroke's misfit along the pressure.
pub(crate) const STROKE_COSINES: usize = 5;

/// Cosines of what the force wanders by, along the time of a stroke.
pub(crate) const WANDER_COSINES: usize = 7;

/// Cosines of the common misfit along each of eps* and P*.
const COMMON_COSINES: usize = 6;

/// The space of what other coefficients of the law would do, as shares of the scale of the misfit.
pub(super) struct LawSpan {
    factor: PivotedQr,
    rank: usize,
    /// Norms by which the columns of the law were divided.
    norms: Vec<f64>,
    /// Scale of the misfit of every reading, N.
    scales: Vec<f64>,
    /// The readings that have one.
    places: Vec<usize>,
}

impl LawSpan {
    /// What the law leaves of shares of the scale, at the readings that have a misfit.
    fn left_of(&self, shares: &[f64]) -> Vec<f64> {
        let mut left: Vec<f64> = self.places.iter().map(|i| shares[*i]).collect();
        self.factor.apply_q_transposed(&mut left);
        left[..self.rank].fill(0.0);
        self.factor.apply_q(&mut left);
        left
    }

    /// By how much each coefficient of the law would move to do what shares of the scale are.
    fn weights(&self, shares: &[f64]) -> Vec<f64> {
        let shares: Vec<f64> = self.places.iter().map(|i| shares[*i]).collect();
        let solved = self.factor.solve_least_squares(&shares, self.rank);
        solved.iter().zip(&self.norms).map(|(w, n)| w / n).collect()
    }

    /// The same of forces, N.
    pub(super) fn left_of_forces(&self, forces: &[f64]) -> Vec<f64> {
        let shares = forces.iter().zip(&self.scales);
        self.left_of(&shares.map(|(f, scale)| f / scale).collect::<Vec<f64>>())
    }
}

impl ForceProblem<'_> {
    /// What other coefficients of the law would do, at the readings that have a misfit; none where these are too few.
    pub(super) fn law_span(&self) -> Option<LawSpan> {
        let scales: Vec<f64> = (0..self.data.len()).map(|i| self.misfit_scale(i)).collect();
        let places: Vec<usize> = (0..scales.len()).filter(|i| scales[*i] > 0.0).collect();
        if places.len() <= self.slopes.len() {
            return None;
        }
        let mut law = Matrix::zeros(places.len(), self.slopes.len());
        for (k, slope) in self.slopes.iter().enumerate() {
            let column = law.column_mut(k).iter_mut().zip(&places);
            column.for_each(|(x, i)| *x = slope[*i] / scales[*i]);
        }
        let norms = law.normalise_columns();
        let factor = PivotedQr::new(law);
        Some(LawSpan {
            norms,
            rank: factor.rank(factor.default_tolerance()),
            factor,
            scales,
            places,
        })
    }

    /// The coefficients of the law at which the scale of the misfit is taken, the places of those that were free in it, and for every cosine of the common
    /// misfit by how much each of these would move to do the same; none where the readings are too few.
    pub(crate) fn law_in_misfit(&self) -> Option<Beside> {
        let span = self.law_span()?;
        let cosines: Vec<Vec<f64>> = self.data.conditions.iter().map(common_basis).collect();
        let of_cosine = |c: usize| {
            let shares: Vec<f64> = cosines.iter().map(|all| all[c]).collect();
            span.weights(&shares)
        };
        let weights = (0..common_pairs().count()).map(of_cosine).collect();
        Some(Beside {
            coefficients: self.reference_coefficients.clone(),
            free: self.sloped.clone(),
            weights,
        })
    }

    /// Largest force and floor of the scale of the misfit, N.
    pub(crate) fn misfit_sizes(&self) -> [f64; 2] {
        [self.largest, self.floor]
    }

    /// Columns of the common misfit: cosines over (eps*, P*) times the scale of the misfit, less what other coefficients of the law would do as
    /// well.
    pub(super) fn beside_the_law(&self) -> Vec<Vec<f64>> {
        let count = common_pairs().count();
        let mut columns = vec![vec![0.0; count]; self.data.len()];
        let Some(span) = self.law_span() else {
            return columns;
        };
        let cosines: Vec<Vec<f64>> = self.data.conditions.iter().map(common_basis).collect();
        for c in 0..count {
            let shares = cosines.iter().map(|all| all[c]).collect::<Vec<f64>>();
            for (i, share) in span.places.iter().zip(span.left_of(&shares)) {
                columns[*i][c] = span.scales[*i] * share;
            }
        }
        columns
    }
}

/// Cosines along the pressure of every reading, of a misfit with a correlation length in kPa.
pub(super) fn along_pressure(data: &Data, count: usize, length_kpa: f64) -> Vec<Vec<f64>> {
    let of = |at: &Conditions| at_pressure(at, count, length_kpa);
    data.conditions.iter().map(of).collect()
}

/// The same of one reading.
pub(crate) fn at_pressure(at: &Conditions, count: usize, length_kpa: f64) -> Vec<f64> {
    cosines(count, at.pressure_kpa / P_620_KPA, length_kpa / P_620_KPA)
}

/// Cosines along the time of the stroke of every reading, of what has a correlation length that is a share of its duration; zeros where it has none.
pub(super) fn along_stroke(data: &Data, count: usize, length: f64) -> Vec<Vec<f64>> {
    let strokes = data.strokes();
    let mut ends = vec![(f64::INFINITY, f64::NEG_INFINITY); data.len()];
    for (at, s) in data.conditions.iter().zip(&strokes) {
        let (first, last) = ends[*s];
        ends[*s] = (first.min(at.log_time_s), last.max(at.log_time_s));
    }
    let of = |(at, s): (&Conditions, &usize)| {
        let (first, last) = ends[*s];
        if last > first {
            cosines(count, (at.log_time_s - first) / (last - first), length)
        } else {
            vec![0.0; count]
        }
    };
    data.conditions.iter().zip(&strokes).map(of).collect()
}

/// Products of cosines over eps* and P*, without the constant, which is a gain of all readings, and without those that vary faster than the
/// fastest along one of the two.
pub(crate) fn common_basis(at: &Conditions) -> Vec<f64> {
    let contraction = (at.rest_length_m - at.length_m) / at.rest_length_m / contraction_620(at);
    let length = settings::SURFACE_LENGTH;
    let [over_contraction, over_pressure] =
        [contraction, at.pressure_kpa / P_620_KPA].map(|x| cosines(COMMON_COSINES, x, length));
    common_pairs()
        .map(|(j, k)| over_contraction[j] * over_pressure[k])
        .collect()
}

/// Numbers of the cosines of each product of the common misfit.
pub(crate) fn common_pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..COMMON_COSINES)
        .flat_map(|j| (0..COMMON_COSINES - j).map(move |k| (j, k)))
        .skip(1)
}
