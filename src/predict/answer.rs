//! The answer at one state.

use crate::interval::{self, Interval};
use crate::law::{Choice, Fitted, LEAST_SQUARES, Law};
use crate::muscle::{Contraction, Muscle, check_state, mm};
use pipeline_base::error::{Error, Result};
use pipeline_base::row::Row;
use pipeline_diagnose::mixed_law::{self, Whose};
use pipeline_fit::{GroupFit, Ranges};
use pipeline_mechanics::models::{
    Direction, P_620_KPA, PRESSURE_SLACK_KPA, Prediction, Reason, State, new, published,
};
use pipeline_numerics::matrix::norm;
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
    /// Its interval; none of a published model, of a least-squares fit, and where the mixed model has no force.
    pub interval: Option<Interval>,
    /// Force and interval before the readings of the muscle were known; none where none are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncalibrated: Option<(f64, Interval)>,
    /// What each effect of the mixed model changes here; empty without one.
    pub effects: Vec<OfEffect>,
    /// Every quantity beside its measured range; empty for a published model.
    pub measured: Vec<Measured>,
    /// What a user has to know: quantities outside of what was measured or is allowed.
    pub warnings: Vec<String>,
    /// That the force is far from what the rig reads, because effects were taken off as the rig's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inferred: Option<String>,
    /// Every other model.
    pub others: Vec<Other>,
}

/// What an effect changes at a state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OfEffect {
    /// Id of the effect, or name of the column.
    pub effect: String,
    /// Whether it goes with the muscle to another machine; else it is of the rig.
    pub of_actuator: bool,
    /// Whether it is in the force.
    pub included: bool,
    /// Change of the force of the rig, N.
    pub change_n: f64,
    /// Effects that the readings cannot tell from it.
    pub class: Vec<String>,
}

impl Answer {
    /// Whether the law only extrapolates here, or gives nothing.
    pub fn is_outside(&self) -> bool {
        !self.warnings.is_empty()
    }

    /// All that a user has to know.
    pub fn remarks(&self) -> impl Iterator<Item = &String> {
        self.warnings.iter().chain(&self.inferred)
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
    /// The muscle under the law of the mixed model, with what readings of it say; none where another law answers.
    pub mixed: Option<mixed_law::Muscle<'a>>,
    /// Whose force is asked for.
    pub whose: Whose,
    /// What stands in the way of believing those readings.
    pub doubts: Vec<String>,
}

/// Largest standard deviation of a length that is any knowledge of it, share of the resting length: a third of what a muscle contracts.
const MOST_LENGTH_SD: f64 = 0.05;

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
            mixed: None,
            whose: Whose::Actuator,
            doubts: Vec::new(),
        };
        if let Law::Fitted(Fitted { fit, mixed, .. }) = law {
            predictor = predictor.with_specimens_of(fit);
            predictor.mixed = mixed.map(mixed_law::Muscle::unread);
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

    /// The same with readings of the muscle, where the law of a mixed model answers.
    pub fn reading(mut self, rows: &[Row]) -> Self {
        let rows: Vec<&Row> = rows.iter().collect();
        let law = self.mixed.as_ref().map(|m| m.law);
        self.mixed = law.map(|law| mixed_law::Muscle::read(law, &rows));
        self
    }

    /// The same as the rig would read it.
    ///
    /// # Errors
    /// A law that knows of no rig.
    pub fn as_read(mut self) -> Result<Self> {
        if self.mixed.is_none() {
            return Err(Error::Usage(
                "--as-read: what the rig adds to the force is known from the mixed model only; leave it out".to_owned(),
            ));
        }
        self.whose = Whose::Rig;
        Ok(self)
    }

    /// The same where the length is known to this standard deviation, m.
    ///
    /// # Errors
    /// A length that is none; a law without an interval.
    pub fn with_length_sd(mut self, sd_m: f64) -> Result<Self> {
        let most_m = MOST_LENGTH_SD * self.muscle.rest_length_m;
        if !(0.0..=most_m).contains(&sd_m) {
            return Err(Error::Usage(format!(
                "--length-sd {}: a standard deviation cannot be negative, and with more than {} nothing is known of this muscle; give one such as 0.2mm",
                mm(sd_m),
                mm(most_m)
            )));
        }
        let Some(mixed) = self.mixed else {
            return Err(Error::Usage(
                "--length-sd: how well the length is known changes the interval, which only the mixed model has; leave it out".to_owned(),
            ));
        };
        self.mixed = Some(mixed.with_length_sd(1e3 * sd_m));
        Ok(self)
    }

    /// The muscle with what readings of it say; none where there are none.
    pub fn calibrated(&self) -> Option<&mixed_law::Muscle<'a>> {
        self.mixed.as_ref().filter(|m| m.count().0 > 0)
    }

    /// The same with another resting length, m, and the same eps_620.
    ///
    /// # Errors
    /// The muscle is shorter than its end caps.
    pub fn with_rest_length(mut self, rest_length_m: f64) -> Result<Self> {
        if let Law::Fitted(Fitted { fit, .. }) = self.choice.law
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
            effects: Vec::new(),
            measured: Vec::new(),
            warnings: Vec::new(),
            inferred: None,
            others: others(&state, self.choice.law.id()),
        };
        match self.choice.law {
            Law::Fitted(fitted) => self.fitted(&fitted, &mut answer, contraction),
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
    fn fitted(&self, fitted: &Fitted, answer: &mut Answer, contraction: Contraction) {
        let Fitted { fit, joint, .. } = *fitted;
        let rest = self.muscle.rest_length_m;
        let Some(eps_620) = self.muscle.contraction_620 else {
            return;
        };
        let c = joint.values();
        let relative = contraction
            .relative(rest, Some(eps_620))
            .unwrap_or(f64::NAN);
        let f620 = new::f620(c[0], c[1], fit.cap_length_m, rest);
        let pressure_rel = answer.pressure_kpa / P_620_KPA;
        let least_squares = new::force([c[2], c[3], c[4]], f620, relative, pressure_rel);
        match &self.mixed {
            None => answer.force_n = Some(least_squares),
            Some(mixed) => {
                self.mixed(mixed, answer, contraction, eps_620);
                answer.others.insert(
                    0,
                    Other {
                        model: LEAST_SQUARES,
                        title: "New model, least-squares fit",
                        force_n: Some(least_squares),
                        outside: None,
                    },
                );
            }
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

    /// Fills in what the mixed model says.
    fn mixed(
        &self,
        muscle: &mixed_law::Muscle,
        answer: &mut Answer,
        contraction: Contraction,
        eps_620: f64,
    ) {
        let rest = self.muscle.rest_length_m;
        let state = |eps_620: f64| {
            let eps = contraction.fraction(rest, Some(eps_620));
            let length_m = rest * (1.0 - eps.unwrap_or(f64::NAN));
            [rest, rest * (1.0 - eps_620), length_m, answer.pressure_kpa]
        };
        let here = state(eps_620);
        // A muscle whose eps_620 nobody noted has one of the distribution of the specimens.
        let FreeContraction::MeanOfSpecimens {
            specimens,
            standard_deviation,
        } = self.free
        else {
            let forecast = muscle.at(here, self.whose);
            return self.put(muscle, answer, here, &forecast, 0.0);
        };
        let known = &muscle.clone().with_known_contraction();
        let law = muscle.law;
        // Its length goes with its contraction, or what is noted is right.
        let is_relative = matches!(contraction, Contraction::Relative(_));
        let (muscle, worth) = if is_relative || law.noted_contraction.is_none() {
            (known, 1.0)
        } else {
            (
                muscle,
                norm(&[1.0 - law.noting_error(), law.noting_error_sd()]),
            )
        };
        let forecast = muscle.at(here, self.whose);
        let of_free = standard_deviation.map_or(0.0, |sd| {
            let at = |e: f64| known.at(state(e.clamp(1e-3, 1.0 - 1e-3)), self.whose).law_n;
            let change = at(eps_620 + sd) - at(eps_620 - sd);
            0.5 * worth * change.abs() * (1.0 + 1.0 / specimens as f64).sqrt()
        });
        self.put(muscle, answer, here, &forecast, of_free);
    }

    fn put(
        &self,
        muscle: &mixed_law::Muscle,
        answer: &mut Answer,
        state: [f64; 4],
        forecast: &mixed_law::Forecast,
        contraction_620_n: f64,
    ) {
        if !(forecast.law_n.is_finite() && forecast.parts.variance().is_finite()) {
            answer
                .warnings
                .push("the mixed model has no force at this state".to_owned());
            return;
        }
        answer.force_n = Some(forecast.mean_n());
        answer.interval = Some(Interval::of(forecast, contraction_620_n));
        if self.calibrated().is_some() {
            let before = muscle.without_readings().at(state, self.whose);
            let interval = Interval::of(&before, contraction_620_n);
            answer.uncalibrated = Some((before.mean_n(), interval));
        }
        let terms = muscle.law.terms.iter().zip(muscle.changes(state));
        let of = |(term, change_n): (&mixed_law::Held, f64)| OfEffect {
            effect: term.name().to_owned(),
            of_actuator: term.is_of_actuator(),
            included: self.whose == Whose::Rig || term.is_of_actuator(),
            change_n,
            class: term.class.clone(),
        };
        answer.effects = terms.map(of).collect();
        let ends = answer.interval.map(|i| (i.low_n, i.high_n));
        answer.inferred = answer
            .force_n
            .zip(ends)
            .and_then(|(force, ends)| inferred(force, ends, &answer.effects));
    }

    fn needs(&self) -> Error {
        Error::Usage(format!(
            "the model {} needs the contraction at 620 kPa without load, which was not given: give --contracted-length or --contraction-620",
            self.choice.law.id()
        ))
    }
}

/// A change of the force below this is none, N.
pub const LEAST_CHANGE_N: f64 = 0.05;

/// That the force is far from what was read, because of effects that were taken off as the rig's; none where the reading lies in the interval.
fn inferred(force: f64, interval: (f64, f64), effects: &[OfEffect]) -> Option<String> {
    let counts = |e: &&OfEffect| !e.included && e.change_n.abs() >= LEAST_CHANGE_N;
    let left_out = || effects.iter().filter(counts);
    let of_rig: f64 = left_out().map(|e| e.change_n).sum();
    let read = (force + of_rig).max(0.0);
    let names: Vec<&str> = left_out().map(|e| e.effect.as_str()).collect();
    (read < interval.0 || read > interval.1).then(|| {
        format!(
            "the rig would read {read:.1} N: {of_rig:+.1} N are taken for the rig's own ({}), which is inferred from forces and was not measured; \
             residual.pdf has the evidence, `pipeline predict --as-read` the reading",
            names.join(", ")
        )
    })
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

#[cfg(test)]
mod tests {
    use super::*;

    fn effect(id: &str, change_n: f64, of_actuator: bool) -> OfEffect {
        OfEffect {
            effect: id.to_owned(),
            of_actuator,
            included: of_actuator,
            change_n,
            class: Vec::new(),
        }
    }

    #[test]
    fn what_is_taken_for_the_rigs_is_told_where_the_reading_is_outside_of_the_interval() {
        let said = |change_n: f64| {
            let effects = [
                effect("series_compliance", change_n, false),
                effect("force_drift", 0.04, false),
                effect("bladder_threshold", -90.0, true),
            ];
            inferred(500.0, (450.0, 550.0), &effects)
        };
        assert_eq!((said(-49.9), said(49.9)), (None, None));
        let low = said(-50.1).unwrap();
        assert!(low.starts_with(
            "the rig would read 449.9 N: -50.1 N are taken for the rig's own (series_compliance),"
        ));
        assert!(said(50.1).is_some());
        // A rig pulls no less than nothing.
        let slack = inferred(
            10.0,
            (0.0, 20.0),
            &[effect("force_zero_offset", -40.0, false)],
        );
        assert_eq!(slack, None);
    }
}
