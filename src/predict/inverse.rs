//! The inverse of a prediction: the pressure, or the length, at which a muscle has a force.
//!
//! Force rises with pressure and falls with contraction, so that there is one answer or none. Its interval is that of the force turned over: the
//! pressures (lengths) at which the interval of the force of a muscle that was not measured holds the force asked for.

use crate::answer::{Answer, Predictor};
use crate::law::Law;
use crate::muscle::Contraction;
use pipeline_base::error::{Error, Result};
use pipeline_mechanics::models::P_620_KPA;
use serde::Serialize;

/// Halvings of a bracket: what is left is below any reading.
const HALVINGS: usize = 60;

/// What is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wanted {
    /// The gauge pressure at this contraction.
    Pressure(Contraction),
    /// The length at this gauge pressure, kPa.
    Length(f64),
}

/// The pressure or length for a force.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solved {
    /// The force asked for, N.
    pub force_n: f64,
    /// The state at which the law has it.
    pub answer: Answer,
    /// The state at which all but the strongest muscles have it, from the upper end of the interval; none beyond the range searched, where they
    /// have it at its least state too, or without an interval.
    pub strongest: Option<Answer>,
    /// The state at which all but the weakest muscles have it.
    pub weakest: Option<Answer>,
}

/// The state of a muscle at which it has a force in N.
///
/// # Errors
/// A force that the muscle does not have at any pressure up to the highest one measured, or at any length from its resting length on; what
/// [`Predictor::at`] objects to.
pub fn solve(predictor: &Predictor, wanted: Wanted, force_n: f64) -> Result<Solved> {
    if force_n < 0.0 {
        return Err(Error::Usage(format!(
            "a force of {force_n} N would push, and a muscle only pulls: give a force above zero"
        )));
    }
    if !(force_n.is_finite() && force_n > 0.0) {
        return Err(Error::Usage(format!(
            "a force of {force_n} N is that of a slack muscle, which has it at many states: give a force above zero"
        )));
    }
    let search = Search::new(predictor, wanted);
    let most = search.at(1.0)?;
    if most.force_n.is_none_or(|most| most < force_n) {
        return Err(search.unreachable(&most, force_n));
    }
    let of_law = |a: &Answer| a.force_n.unwrap_or(0.0);
    let answer = search
        .first(force_n, &of_law)?
        .ok_or_else(|| Error::internal("a force between its bounds that is nowhere"))?;
    let of_interval = |end: fn(&Answer) -> Option<f64>| -> Result<Option<Answer>> {
        if end(&answer).is_none() {
            return Ok(None);
        }
        let of = |a: &Answer| end(a).unwrap_or(0.0);
        // Where the interval holds the force from the least state on, no state is its end.
        if of(&search.at(0.0)?) >= force_n {
            return Ok(None);
        }
        search.first(force_n, &of)
    };
    Ok(Solved {
        force_n,
        strongest: of_interval(|a| a.interval.map(|i| i.high_n))?,
        weakest: of_interval(|a| a.interval.map(|i| i.low_n))?,
        answer,
    })
}

/// States in the order of their force: from none at share 0 to the largest at share 1.
struct Search<'a> {
    predictor: &'a Predictor<'a>,
    wanted: Wanted,
    highest_kpa: f64,
    /// eps at which every muscle is slack.
    slack: f64,
}

impl<'a> Search<'a> {
    fn new(predictor: &'a Predictor, wanted: Wanted) -> Self {
        let highest_kpa = match predictor.choice.law {
            Law::Fitted(f) => f.fit.ranges.pressure_kpa.1,
            Law::Published(_) => P_620_KPA,
        };
        let free = predictor.muscle.contraction_620.unwrap_or(0.25);
        Self {
            predictor,
            wanted,
            highest_kpa,
            slack: (1.5 * free).min(0.9),
        }
    }

    fn at(&self, share: f64) -> Result<Answer> {
        match self.wanted {
            Wanted::Pressure(contraction) => {
                self.predictor.at(contraction, share * self.highest_kpa)
            }
            Wanted::Length(pressure_kpa) => {
                let contraction = Contraction::Fraction((1.0 - share) * self.slack);
                self.predictor.at(contraction, pressure_kpa)
            }
        }
    }

    /// The state with the least share at which a force is reached; none where it is not.
    fn first(&self, force_n: f64, of: &dyn Fn(&Answer) -> f64) -> Result<Option<Answer>> {
        if of(&self.at(1.0)?) < force_n {
            return Ok(None);
        }
        let (mut below, mut above) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (below + above);
            if of(&self.at(middle)?) < force_n {
                below = middle;
            } else {
                above = middle;
            }
        }
        self.at(above).map(Some)
    }

    fn unreachable(&self, most: &Answer, force_n: f64) -> Error {
        let there = most
            .force_n
            .map_or_else(|| "none".to_owned(), |f| format!("{f:.1} N"));
        Error::Usage(match self.wanted {
            Wanted::Pressure(_) => format!(
                "this muscle does not reach {force_n:.1} N at this length: at {:.1} kPa, the highest pressure known of the model, it has {there}; a \
                 smaller contraction, a longer or a thicker muscle",
                self.highest_kpa
            ),
            Wanted::Length(pressure_kpa) => format!(
                "this muscle does not reach {force_n:.1} N at {pressure_kpa:.1} kPa: at its resting length it has {there}; a higher pressure, a longer \
                 or a thicker muscle"
            ),
        })
    }
}
