//! The answer at one state.

use crate::calibration::{At, Calibration};
use crate::interval::{self, Interval};
use crate::law::{Choice, Law};
use crate::muscle::{Contraction, Muscle, check_state, mm};
use pipeline_base::error::{Error, Result};
use pipeline_fit::{GroupFit, Ranges};
use pipeline_mechanics::models::{
    Direction, P_620_KPA, PRESSURE_SLACK_KPA, Prediction, Reason, State, new, published,
};
use serde::Serialize;

/// Where eps_620 comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FreeContraction {
    /// It was given.
    Given,
    /// The mean of the group's specimens, with their standard deviation.
    MeanOfSpecimens {
        /// How many.
        specimens: usize,
        /// None for a single one.
        standard_deviation: Option<f64>,
    },
    /// Nobody measured it.
    Unknown,
}

/// A quantity beside the range in which it was measured, in the units of people.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// What.
    pub quantity: &'static str,
    /// Its unit; empty for a fraction.
    pub unit: &'static str,
    /// Its value here.
    pub value: f64,
    /// Smallest measured value.
    pub low: f64,
    /// Largest measured value.
    pub high: f64,
    /// Whether the value lies inside, give or take the resolution of a reading.
    pub inside: bool,
}

/// What another model says.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Other {
    /// Id.
    pub model: &'static str,
    /// For people.
    pub title: &'static str,
    /// Force, N; none where the model gives nothing.
    pub force_n: Option<f64>,
    /// Why it is extrapolated or absent.
    pub outside: Option<String>,
}

/// The answer at one state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// The muscle, with the eps_620 that was used.
    pub muscle: Muscle,
    /// Gauge pressure, kPa.
    pub pressure_kpa: f64,
    /// Present length, m.
    pub length_m: f64,
    /// eps.
    pub contraction: f64,
    /// eps*; none where eps_620 is unknown.
    pub contraction_rel: Option<f64>,
    /// Force, N; none where a published model gives nothing.
    pub force_n: Option<f64>,
    /// Its interval; none where there are too few specimens, or none.
    pub interval: Option<Interval>,
    /// Force and interval before the readings of the muscle were known; none where none are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncalibrated: Option<(f64, Interval)>,
    /// Every quantity beside its measured range; empty for a published model.
    pub measured: Vec<Measured>,
    /// What a user has to know: quantities outside of what was measured or is allowed.
    pub warnings: Vec<String>,
    /// Every other model.
    pub others: Vec<Other>,
}

impl Answer {
    /// Whether the law only extrapolates here, or gives nothing.
    pub fn is_outside(&self) -> bool {
        !self.warnings.is_empty()
    }
}

/// Answers for one muscle.
#[derive(Clone)]
pub struct Predictor<'a> {
    /// The law.
    pub choice: Choice<'a>,
    /// The muscle, with the eps_620 that is used.
    pub muscle: Muscle,
    /// Where its eps_620 comes from.
    pub free: FreeContraction,
    /// What readings of it say.
    pub calibration: Option<Calibration<'a>>,
    /// What stands in the way of believing those readings.
    pub doubts: Vec<String>,
}

impl<'a> Predictor<'a> {
    /// A muscle under a law.
    ///
    /// # Errors
    /// A published model needs an eps_620 that is not given, or the muscle is shorter than its end caps.
    pub fn new(choice: Choice<'a>, muscle: Muscle) -> Result<Self> {
        let free = match muscle.contraction_620 {
            Some(_) => FreeContraction::Given,
            None => FreeContraction::Unknown,
        };
        let rest_length_m = muscle.rest_length_m;
        let law = choice.law;
        let mut predictor = Self {
            choice,
            muscle,
            free,
            calibration: None,
            doubts: Vec::new(),
        };
        if let Law::Fitted(fit, _) = law {
            predictor = predictor.with_specimens_of(fit);
        }
        predictor.with_rest_length(rest_length_m)
    }

    /// The same with the mean eps_620 of a fit's specimens, where nobody gave one: a published model knows none.
    pub fn with_specimens_of(mut self, fit: &GroupFit) -> Self {
        if self.free == FreeContraction::Unknown {
            let (mean, standard_deviation) = interval::free_contraction(fit);
            self.muscle.contraction_620 = Some(mean);
            self.free = FreeContraction::MeanOfSpecimens {
                specimens: fit.specimens.len(),
                standard_deviation,
            };
        }
        self
    }

    /// The same with another resting length, m, and the same eps_620.
    ///
    /// # Errors
    /// The muscle is shorter than its end caps.
    pub fn with_rest_length(mut self, rest_length_m: f64) -> Result<Self> {
        if let Law::Fitted(fit, _) = self.choice.law
            && rest_length_m <= fit.cap_length_m
        {
            return Err(Error::Usage(format!(
                "a muscle of {} is not longer than its end caps, which touch at {}: give the length between the clamps",
                mm(rest_length_m),
                mm(fit.cap_length_m)
            )));
        }
        self.muscle.rest_length_m = rest_length_m;
        Ok(self)
    }

    /// The answer at a contraction and a gauge pressure in kPa.
    ///
    /// # Errors
    /// No state of a muscle; an eps_620 that the model needs and nobody gave.
    pub fn at(&self, contraction: Contraction, pressure_kpa: f64) -> Result<Answer> {
        let muscle = self.muscle;
        let rest = muscle.rest_length_m;
        let eps = contraction
            .fraction(rest, muscle.contraction_620)
            .ok_or_else(|| self.needs())?;
        check_state(eps, pressure_kpa, rest)?;
        let state = state(&muscle, eps, pressure_kpa);
        let mut answer = Answer {
            muscle,
            pressure_kpa,
            length_m: state.length_m,
            contraction: eps,
            contraction_rel: contraction.relative(rest, muscle.contraction_620),
            force_n: None,
            interval: None,
            uncalibrated: None,
            measured: Vec::new(),
            warnings: Vec::new(),
            others: others(&state, self.choice.law.id()),
        };
        match self.choice.law {
            Law::Fitted(..) => self.fitted(&mut answer, contraction),
            Law::Published(model) => {
                let prediction = model.predict(&state);
                if prediction.reason() == Some(&Reason::FreeContractionUnknown) {
                    return Err(self.needs());
                }
                answer.force_n = prediction.force_n();
                answer
                    .warnings
                    .extend(remark(&prediction).map(|r| format!("{}: {r}", model.id())));
            }
        }
        answer
            .warnings
            .extend(beyond_limit(muscle.diameter_mm, pressure_kpa));
        Ok(answer)
    }

    /// Fills in what a fit says.
    fn fitted(&self, answer: &mut Answer, contraction: Contraction) {
        let Law::Fitted(fit, joint) = self.choice.law else {
            return;
        };
        let rest = self.muscle.rest_length_m;
        let Some(eps_620) = self.muscle.contraction_620 else {
            return;
        };
        let pressure_rel = answer.pressure_kpa / P_620_KPA;
        let force = |c: &[f64], eps_620: f64| {
            let relative = contraction
                .relative(rest, Some(eps_620))
                .unwrap_or(f64::NAN);
            let f620 = new::f620(c[0], c[1], fit.cap_length_m, rest);
            new::force([c[2], c[3], c[4]], f620, relative, pressure_rel)
        };
        let assumed = match self.free {
            FreeContraction::MeanOfSpecimens {
                standard_deviation, ..
            } => standard_deviation,
            _ => None,
        };
        answer.force_n = Some(force(&joint.values(), eps_620));
        answer.interval = interval::interval(fit, joint, eps_620, assumed, &force);
        if let Some(calibration) = &self.calibration {
            let at = At {
                rest_length_m: rest,
                stroke_m: rest * eps_620,
                length_m: answer.length_m,
                pressure_kpa: answer.pressure_kpa,
            };
            let of_free = answer.interval.map_or(0.0, |i| i.contraction_620_n);
            let [(force_n, interval), before] = calibration.intervals(&at, of_free);
            answer.uncalibrated = Some(before);
            answer.force_n = Some(force_n);
            answer.interval = Some(interval);
        }
        answer.measured = measured(fit, answer, matches!(self.free, FreeContraction::Given));
        let slack = |contraction_rel: f64, pressure_kpa: f64| {
            let c = joint.values();
            let pressure_rel = pressure_kpa / P_620_KPA;
            new::surface_signed([c[2], c[3], c[4]], contraction_rel, pressure_rel) <= 0.0
        };
        forgive_slack(&mut answer.measured, &slack);
        let outside = answer.measured.iter().filter(|m| !m.inside).map(warning);
        answer.warnings.extend(outside);
    }

    fn needs(&self) -> Error {
        Error::Usage(format!(
            "the model {} needs the contraction at 620 kPa without load, which was not given: give --contracted-length or --contraction-620",
            self.choice.law.id()
        ))
    }
}

fn state(muscle: &Muscle, contraction: f64, pressure_kpa: f64) -> State {
    let rest = muscle.rest_length_m;
    State {
        diameter_mm: f64::from(muscle.diameter_mm),
        rest_length_m: rest,
        contracted_length_m: muscle
            .contraction_620
            .map_or(f64::NAN, |e| rest * (1.0 - e)),
        length_m: rest * (1.0 - contraction),
        pressure_kpa,
        direction: Direction::Isometric,
    }
}

/// Why a prediction is extrapolated or absent.
fn remark(prediction: &Prediction) -> Option<String> {
    let why = prediction.reason()?;
    Some(match prediction.force_n() {
        Some(_) => format!("extrapolated: {why}"),
        None => format!("outside its domain: {why}"),
    })
}

fn others(state: &State, chosen: &str) -> Vec<Other> {
    let all = published();
    all.iter()
        .filter(|m| m.id() != chosen)
        .map(|model| {
            let prediction = model.predict(state);
            Other {
                model: model.id(),
                title: model.title(),
                force_n: prediction.force_n(),
                outside: remark(&prediction),
            }
        })
        .collect()
}

const PRESSURE: &str = "gauge pressure";
const CONTRACTION_REL: &str = "relative contraction";

/// Every quantity beside its measured range. The slack is the resolution of a reading, as in [`pipeline_mechanics::models`]: half a millimetre, 10 kPa,
/// and what a millimetre read amiss makes of contractions.
fn measured(fit: &GroupFit, answer: &Answer, given: bool) -> Vec<Measured> {
    const SLACK: [f64; 4] = [0.5, PRESSURE_SLACK_KPA, 0.05, 0.005];
    let Ranges {
        rest_length_m,
        pressure_kpa,
        contraction_rel,
        contraction_620,
    } = fit.ranges;
    let one = |quantity, unit, value: f64, (low, high): (f64, f64), slack| Measured {
        quantity,
        unit,
        value,
        low,
        high,
        inside: value >= low - slack && value <= high + slack,
    };
    let in_mm = (1e3 * rest_length_m.0, 1e3 * rest_length_m.1);
    let rest_mm = 1e3 * answer.muscle.rest_length_m;
    let mut all = vec![
        one("resting length", "mm", rest_mm, in_mm, SLACK[0]),
        one(PRESSURE, "kPa", answer.pressure_kpa, pressure_kpa, SLACK[1]),
    ];
    let relative = answer.contraction_rel;
    all.extend(relative.map(|x| one(CONTRACTION_REL, "", x, contraction_rel, SLACK[2])));
    let free = answer.muscle.contraction_620.filter(|_| given);
    all.extend(free.map(|x| one("contraction at 620 kPa", "", x, contraction_620, SLACK[3])));
    all
}

/// A muscle that is slack at the edge of what was measured stays slack when it is contracted further or vented: no extrapolation.
fn forgive_slack(all: &mut [Measured], slack: &dyn Fn(f64, f64) -> bool) {
    let (mut contraction, mut pressure) = (f64::NAN, f64::NAN);
    for m in all.iter() {
        match m.quantity {
            CONTRACTION_REL => contraction = m.value.min(m.high),
            PRESSURE => pressure = m.value.max(m.low),
            _ => {}
        }
    }
    if slack(contraction, pressure) {
        for m in all.iter_mut() {
            let further = (m.quantity == CONTRACTION_REL && m.value > m.high)
                || (m.quantity == PRESSURE && m.value < m.low);
            m.inside |= further;
        }
    }
}

fn warning(m: &Measured) -> String {
    let unit = if m.unit.is_empty() {
        String::new()
    } else {
        format!(" {}", m.unit)
    };
    let digits = if m.unit.is_empty() { 3 } else { 0 };
    format!(
        "{} {:.digits$}{unit} is outside the measured range {:.digits$} to {:.digits$}{unit}: the force is extrapolated",
        m.quantity, m.value, m.low, m.high
    )
}

/// The manufacturer's largest gauge pressure, kPa, where it is known (10 mm: force paper, section 4).
pub fn pressure_limit_kpa(diameter_mm: u32) -> Option<f64> {
    (diameter_mm == 10).then_some(800.0)
}

fn beyond_limit(diameter_mm: u32, pressure_kpa: f64) -> Option<String> {
    let limit = pressure_limit_kpa(diameter_mm).filter(|limit| pressure_kpa > *limit)?;
    Some(format!(
        "{pressure_kpa:.0} kPa is above the manufacturer's limit of {limit:.0} kPa for {diameter_mm} mm: do not apply it"
    ))
}
