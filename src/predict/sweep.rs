//! Answers along one quantity, and the designer's table of contraction by pressure.

use crate::answer::{Answer, Predictor};
use crate::law::Law;
use crate::muscle::Contraction;
use pipeline_base::error::{Error, Result};
use pipeline_mechanics::models::P_620_KPA;
use serde::Serialize;

/// What is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// Gauge pressure, kPa.
    Pressure,
    /// eps.
    Contraction,
    /// l_rest, m, at the same eps_620 and contraction.
    RestLength,
}

/// The largest number of steps that somebody can have meant.
const MOST_STEPS: f64 = 1000.0;
/// eps up to which a sweep goes where eps_620 is unknown.
const USUAL_CONTRACTION: f64 = 0.2;
/// Resting lengths of a sweep under a published model, m: those of the force paper's 10 mm specimens.
const USUAL_LENGTHS_M: (f64, f64) = (0.112, 0.518);

/// From, to and step of a sweep, in the inside unit of its quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// First value.
    pub from: f64,
    /// Last value, which is always among them.
    pub to: f64,
    /// Distance.
    pub step: f64,
}

impl Steps {
    /// What a sweep covers if nothing else is asked for: pressures up to 620 kPa, contractions up to eps_620, resting lengths as measured.
    pub fn usual(axis: Axis, predictor: &Predictor) -> Self {
        let of = |from, to, step| Self { from, to, step };
        match axis {
            Axis::Pressure => of(0.0, P_620_KPA, 50.0),
            Axis::Contraction => {
                let most = predictor.muscle.contraction_620;
                of(0.0, most.unwrap_or(USUAL_CONTRACTION), 0.01)
            }
            Axis::RestLength => {
                let (from, to) = match predictor.choice.law {
                    Law::Fitted(f) => f.fit.ranges.rest_length_m,
                    Law::Published(_) => USUAL_LENGTHS_M,
                };
                let to = if to > from { to } else { 2.0 * from };
                of(from, to, 0.025)
            }
        }
    }

    /// The values.
    ///
    /// # Errors
    /// No steps, or far too many.
    pub fn values(self) -> Result<Vec<f64>> {
        let Steps { from, to, step } = self;
        let count = (to - from) / step;
        if !(step > 0.0 && to > from && count <= MOST_STEPS) {
            return Err(Error::Usage(format!(
                "no sweep goes from {from} to {to} in steps of {step}: give --from below --to, and at most {MOST_STEPS} steps between them"
            )));
        }
        // A last step that is shorter than a thousandth is rounding.
        let whole = (count - 1e-3).ceil() as usize;
        let inner = (0..whole).map(|k| from + k as f64 * step);
        Ok(inner.chain([to]).collect())
    }

    /// Enough values for a smooth curve.
    pub fn fine(self) -> Vec<f64> {
        const POINTS: u32 = 160;
        let share = |k: u32| f64::from(k) / f64::from(POINTS);
        (0..=POINTS)
            .map(|k| self.from + (self.to - self.from) * share(k))
            .collect()
    }
}

/// The state around which a sweep goes; what is varied may be missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Around {
    /// The contraction.
    pub contraction: Option<Contraction>,
    /// Gauge pressure, kPa.
    pub pressure_kpa: Option<f64>,
}

/// The answers at the values of one quantity.
///
/// # Errors
/// A quantity that is missing, and what [`Predictor::at`] objects to.
pub fn sweep(
    predictor: &Predictor,
    axis: Axis,
    values: &[f64],
    around: Around,
) -> Result<Vec<Answer>> {
    let contraction = || around.contraction.ok_or_else(|| missing("--contraction"));
    let pressure = || around.pressure_kpa.ok_or_else(|| missing("--pressure"));
    let mut answers = Vec::with_capacity(values.len());
    for value in values {
        answers.push(match axis {
            Axis::Pressure => predictor.at(contraction()?, *value)?,
            Axis::Contraction => predictor.at(Contraction::Fraction(*value), pressure()?)?,
            Axis::RestLength => {
                let other = predictor.clone().with_rest_length(*value)?;
                other.at(contraction()?, pressure()?)?
            }
        });
    }
    Ok(answers)
}

fn missing(option: &str) -> Error {
    Error::Usage(format!(
        "{option} is missing: the sweep varies another quantity"
    ))
}

/// Pressures of the designer's table, kPa.
pub const TABLE_KPA: [f64; 7] = [100.0, 200.0, 300.0, 400.0, 500.0, 600.0, P_620_KPA];
/// Step of its contractions.
const TABLE_STEP: f64 = 0.025;

/// The contractions of the designer's table.
///
/// # Errors
/// None for a muscle that makes sense.
pub fn table_contractions(predictor: &Predictor) -> Result<Vec<f64>> {
    let usual = Steps::usual(Axis::Contraction, predictor);
    Steps {
        step: TABLE_STEP,
        ..usual
    }
    .values()
}

/// The designer's table: one row a contraction, one column a pressure of [`TABLE_KPA`].
///
/// # Errors
/// What [`Predictor::at`] objects to.
pub fn table(predictor: &Predictor, contractions: &[f64]) -> Result<Vec<Vec<Answer>>> {
    let row = |contraction: &f64| {
        let at = |pressure: &f64| predictor.at(Contraction::Fraction(*contraction), *pressure);
        TABLE_KPA.iter().map(at).collect()
    };
    contractions.iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_end_where_they_should() {
        let of = |from, to, step| Steps { from, to, step }.values();
        assert_eq!(
            of(0.0, 620.0, 200.0).unwrap(),
            [0.0, 200.0, 400.0, 600.0, 620.0]
        );
        assert_eq!(of(0.0, 600.0, 200.0).unwrap(), [0.0, 200.0, 400.0, 600.0]);
        assert_eq!(of(0.0, 0.3, 0.1).unwrap().len(), 4);
        for (from, to, step) in [
            (0.0, 0.0, 1.0),
            (5.0, 1.0, 1.0),
            (0.0, 1.0, 0.0),
            (0.0, 1.0, 1e-9),
        ] {
            assert!(of(from, to, step).is_err());
        }
    }
}
