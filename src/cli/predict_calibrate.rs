//! What `predict` takes from readings of the muscle itself.

use crate::check_session;
use crate::places::Places;
use crate::predict::PredictArgs;
use crate::print::line;
use pipeline_base::error::{Error, Result};
use pipeline_base::row::Row;
use pipeline_findings::{CampaignFindings, Findings};
use pipeline_fit::{GroupFit, is_usable};
use pipeline_predict::calibration::{At, Calibration, Next, Reading, Sizes};
use pipeline_predict::{Answer, Choice, FreeLength, Law, Muscle, Predictor};
use pipeline_report::wording::number::percent;
use serde_json::{Value, json};

/// Readings of a muscle, and what the last run knows of others.
pub struct Read {
    rows: Vec<Row>,
    findings: Option<Findings>,
}

/// The readings that the arguments name; none where they name none.
pub fn read(args: &PredictArgs, places: &Places) -> Result<Option<Read>> {
    if args.specimen.is_none() && args.calibrate.is_empty() {
        return Ok(None);
    }
    let known = check_session::known(&places.derived, &places.reports, &places.config)?;
    let mut rows = Vec::new();
    if let Some(id) = &args.specimen {
        let own = known.rows.iter().filter(|r| r.specimen == *id);
        rows.extend(own.cloned());
        if rows.is_empty() {
            let mut ids: Vec<&str> = known.rows.iter().map(|r| r.specimen.as_str()).collect();
            ids.sort_unstable();
            ids.dedup();
            return Err(Error::Usage(format!(
                "--specimen {id}: the last run has no readings of it; it has {}",
                if ids.is_empty() {
                    "none at all: `pipeline run` makes them".to_owned()
                } else {
                    ids.join(", ")
                }
            )));
        }
    }
    for folder in &args.calibrate {
        let (own, unusable) = pipeline_inspect::readings(folder, &places.config);
        if let Some(diagnostic) = unusable.first() {
            return Err(Error::Usage(format!("--calibrate: {diagnostic}")));
        }
        if own.is_empty() {
            return Err(Error::Usage(format!(
                "--calibrate {}: there is no session with readings in it; `pipeline check-session {0}` says more",
                folder.display()
            )));
        }
        rows.extend(own);
    }
    rows.retain(|r| is_usable(r) && r.length_m.is_finite());
    let Some(first) = rows.first() else {
        return Err(Error::Usage(
            "none of the readings can be used: `pipeline check-session` says why".to_owned(),
        ));
    };
    let other = rows
        .iter()
        .find(|r| r.diameter_mm != first.diameter_mm || r.rest_length_m != first.rest_length_m);
    if let Some(other) = other {
        return Err(Error::Usage(format!(
            "the readings are of more than one muscle: {} of {} mm and {:.1} mm, {} of {} mm and {:.1} mm",
            first.session,
            first.diameter_mm,
            1e3 * first.rest_length_m,
            other.session,
            other.diameter_mm,
            1e3 * other.rest_length_m
        )));
    }
    Ok(Some(Read {
        rows,
        findings: known.findings,
    }))
}

impl Read {
    /// The muscle that was read.
    pub fn muscle(&self) -> Result<Muscle> {
        let row = &self.rows[0];
        let free = match row.contracted_length_m {
            length if length.is_finite() => FreeLength::Length(length),
            _ => FreeLength::Unknown,
        };
        Muscle::new(row.diameter_mm, row.rest_length_m, free)
    }

    /// The law of a choice, conditioned on the readings.
    pub fn calibration<'a>(&self, choice: &Choice<'a>) -> Result<Calibration<'a>> {
        let Law::Fitted(fit, joint) = choice.law else {
            return Err(Error::Usage(
                "--specimen and --calibrate need the fitted law: of published models nobody knows how muscles scatter about them; leave out --model"
                    .to_owned(),
            ));
        };
        let readings: Vec<Reading> = self.rows.iter().filter_map(reading).collect();
        let specimen = self.rows[0].specimen.as_str();
        Calibration::new(fit, joint, Some(specimen), self.sizes(fit), &readings).ok_or_else(|| {
            Error::Usage(format!(
                "the fit of {} has too few specimens to say how others scatter, and so what a reading of one tells",
                fit.group.campaign
            ))
        })
    }

    /// How sessions scatter about the fit: as the residual search found it, or else as is usual.
    fn sizes(&self, fit: &GroupFit) -> Sizes {
        let within_n = fit.scatter.as_ref().map_or(0.0, |s| s.within_n);
        let of_group = |c: &&CampaignFindings| {
            c.campaign == fit.group.campaign
                && c.diameter_mm == fit.group.diameter_mm
                && c.part.is_none()
        };
        let found = self.findings.iter().flat_map(|f| &f.campaigns);
        let found = found.filter(of_group).find_map(|c| {
            let sd = |id: &str| {
                let own = c.scatter.iter().find(|s| s.id == id);
                own.map(|s| s.sd_predictive)
            };
            Some(Sizes {
                length_mm: sd("length_offset")?,
                zero_n: sd("force_zero_offset")?,
                left_n: c.before.rmse_heldout_calibrated?,
                noise_n: c.noise?,
            })
        });
        found.unwrap_or_else(|| Sizes::usual(within_n))
    }
}

/// A row as a reading; none without a stroke.
fn reading(row: &Row) -> Option<Reading> {
    let at = At {
        rest_length_m: row.rest_length_m,
        stroke_m: row.rest_length_m - row.contracted_length_m,
        length_m: row.length_m,
        pressure_kpa: row.pressure_kpa,
    };
    at.stroke_m.is_finite().then(|| Reading {
        session: row.session.clone(),
        at,
        force_n: row.force_n,
    })
}

/// Contractions and pressures among which the next reading is looked for: steps of the ranges that were measured.
const STEPS: (usize, usize) = (7, 7);

/// The reading that would narrow the answer most.
fn next(predictor: &Predictor, answer: &Answer) -> Option<Next> {
    let calibration = predictor.calibration.as_ref()?;
    let Law::Fitted(fit, _) = predictor.choice.law else {
        return None;
    };
    let rest_length_m = answer.muscle.rest_length_m;
    let stroke_m = rest_length_m * answer.muscle.contraction_620?;
    let steps = |(low, high): (f64, f64), count: usize| {
        (0..count).map(move |k| low + (high - low) * k as f64 / (count - 1) as f64)
    };
    let pressures = |rel: f64| {
        steps(fit.ranges.pressure_kpa, STEPS.1).map(move |pressure_kpa| At {
            rest_length_m,
            stroke_m,
            length_m: rest_length_m - rel * stroke_m,
            pressure_kpa,
        })
    };
    let all: Vec<At> = steps(fit.ranges.contraction_rel, STEPS.0)
        .flat_map(pressures)
        .collect();
    let wanted = At {
        rest_length_m,
        stroke_m,
        length_m: answer.length_m,
        pressure_kpa: answer.pressure_kpa,
    };
    calibration.next(&wanted, &all)
}

/// Prints what the readings say of the muscle.
pub fn head(calibration: &Calibration) {
    let (readings, sessions) = calibration.count();
    let plural = |n: usize| if n == 1 { "" } else { "s" };
    let gain = calibration.gain();
    line(format!(
        "readings {readings} of it in {sessions} session{}: strength {:+.1} ± {:.1}% of the mean of others, which scatter by {}: percentile {:.0}",
        plural(sessions),
        100.0 * gain.value,
        100.0 * gain.sd,
        percent(gain.sd_before),
        calibration.percentile()
    ));
    for length in calibration.set_lengths() {
        line(format!(
            "         {}: set {:+.1} ± {:.1} mm from the length noted; not carried over",
            length.session.unwrap_or_default(),
            length.value,
            length.sd
        ));
    }
}

/// Prints what the answer was before, and what would narrow it.
pub fn tail(predictor: &Predictor, answer: &Answer) {
    if let Some((force, interval)) = &answer.uncalibrated {
        line(format!(
            "before   {force:.1} N, {:.1} to {:.1} N without the readings",
            interval.low_n, interval.high_n
        ));
    }
    if let Some(next) = next(predictor, answer) {
        line(format!(
            "next     a reading at a contraction of {:.1}% and {:.0} kPa narrows it most: standard deviation {:.1} to {:.1} N",
            100.0 * next.contraction,
            next.pressure_kpa,
            next.sd_before_n,
            next.sd_after_n
        ));
    }
}

/// The same as values.
pub fn as_json(predictor: &Predictor, answer: Option<&Answer>) -> Value {
    let Some(calibration) = &predictor.calibration else {
        return Value::Null;
    };
    let (readings, sessions) = calibration.count();
    json!({
        "readings": readings,
        "sessions": sessions,
        "gain": calibration.gain(),
        "percentile": calibration.percentile(),
        "set_lengths": calibration.set_lengths(),
        "next": answer.and_then(|a| next(predictor, a)),
    })
}
