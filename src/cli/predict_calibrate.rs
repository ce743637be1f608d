//! What `predict` takes from readings of the muscle itself.

use crate::check_session;
use crate::places::Places;
use crate::predict::PredictArgs;
use crate::print::{counted, line};
use pipeline_base::error::{Error, Result};
use pipeline_base::row::Row;
use pipeline_base::session::Kind;
use pipeline_diagnose::mixed_law::{
    Estimate, Muscle as Calibrated, Next, SAME_LENGTH_M, STANDS_OUT,
};
use pipeline_fit::is_usable;
use pipeline_inspect::population::Known;
use pipeline_inspect::{Inspection, Seen, State};
use pipeline_predict::{Answer, FreeLength, Law, Muscle, Predictor};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Readings of a muscle, and what the last run knows of others.
pub struct Read {
    rows: Vec<Row>,
    /// What stands in the way of believing them.
    pub doubts: Vec<String>,
}

/// The readings that the arguments name; none where they name none.
pub fn read(args: &PredictArgs, places: &Places) -> Result<Option<Read>> {
    if args.specimen.is_none() && args.calibrate.is_empty() {
        return Ok(None);
    }
    let known = check_session::known(&places.derived, &places.reports, &places.config)?;
    let mut rows = Vec::new();
    let mut doubts = Vec::new();
    if let Some(id) = &args.specimen {
        rows.extend(of_specimen(&known, id)?);
    }
    for folder in &args.calibrate {
        rows.extend(of_folder(folder, places, &known)?);
        doubts.extend(doubts_of(folder, places, &known));
    }
    doubts.dedup();
    Ok(Some(Read {
        doubts,
        rows: each_once(of_one_muscle(rows)?)?,
    }))
}

/// Every reading once: somebody may name a session twice, or one of the run.
///
/// # Errors
/// Two sessions of one id.
fn each_once(rows: Vec<Row>) -> Result<Vec<Row>> {
    let mut seen: BTreeMap<(String, String, i64), [u64; 3]> = BTreeMap::new();
    let mut once = Vec::new();
    for row in rows {
        let key = (row.session.clone(), row.log.clone(), row.first_row);
        let values = [row.force_n, row.pressure_kpa, row.length_m].map(f64::to_bits);
        match seen.get(&key) {
            None => {
                seen.insert(key, values);
                once.push(row);
            }
            Some(before) if *before == values => {}
            Some(_) => {
                return Err(Error::Usage(format!(
                    "two sessions with different readings are called {}: give one of them another id",
                    row.session
                )));
            }
        }
    }
    Ok(once)
}

/// What the last run has of a specimen.
fn of_specimen(known: &Known, id: &str) -> Result<Vec<Row>> {
    let own = known.rows.iter().filter(|r| r.specimen == *id);
    let own: Vec<Row> = own.cloned().collect();
    if !own.is_empty() {
        return Ok(own);
    }
    let ids: BTreeSet<&str> = known.rows.iter().map(|r| r.specimen.as_str()).collect();
    let ids: Vec<&str> = ids.into_iter().collect();
    Err(Error::Usage(format!(
        "--specimen {id}: the last run has no readings of it; it has {}",
        if ids.is_empty() {
            "none at all: `pipeline run` makes them".to_owned()
        } else {
            ids.join(", ")
        }
    )))
}

/// The readings of the sessions in a folder.
fn of_folder(folder: &Path, places: &Places, known: &Known) -> Result<Vec<Row>> {
    let (own, unusable) = pipeline_inspect::readings(folder, &places.config, known);
    if !unusable.is_empty() {
        return Err(Error::Config(unusable));
    }
    if own.is_empty() {
        return Err(Error::Usage(format!(
            "--calibrate {}: there is no session with readings in it; `pipeline check-session {0}` says more",
            folder.display()
        )));
    }
    Ok(own)
}

/// The sessions in a folder whose readings themselves are flagged; logs that are left out are no part of them.
fn doubts_of(folder: &Path, places: &Places, known: &Known) -> Vec<String> {
    let is_doubtful = |found: &Inspection| {
        let mut flagged = found.checks.iter().filter(|c| c.state != State::Fine);
        flagged.any(|c| c.state == State::Bad || is_of_readings(&c.seen))
    };
    let sessions = pipeline_inspect::sessions(folder, &places.config, known);
    let doubtful = sessions.iter().filter(|found| is_doubtful(found));
    let doubt = |found: &Inspection| {
        format!(
            "{}: `pipeline check-session {}` flags this session, and the answer depends on it: a wrong length passes for a specimen gain",
            found.session,
            folder.display()
        )
    };
    doubtful.map(doubt).collect()
}

/// The readings that can be used, of which there have to be some, and of one muscle.
fn of_one_muscle(rows: Vec<Row>) -> Result<Vec<Row>> {
    let is_torque = rows.iter().all(|r| r.kind == Kind::KneeTorque);
    let is_excluded = rows.iter().all(|r| r.excluded);
    let mut rows = rows;
    rows.retain(|r| is_usable(r) && r.length_m.is_finite());
    let Some(first) = rows.first() else {
        return Err(Error::Usage(if is_torque {
            "these are torques about a joint: a calibration needs isometric forces".to_owned()
        } else if is_excluded {
            "these sessions are excluded (`exclude` in session.toml)".to_owned()
        } else {
            "none of the readings can be used: `pipeline check-session` says why".to_owned()
        }));
    };
    let differs = |a: f64, b: f64| (a - b).abs() > SAME_LENGTH_M;
    let is_other = |r: &&Row| {
        r.specimen != first.specimen
            || r.diameter_mm != first.diameter_mm
            || differs(r.rest_length_m, first.rest_length_m)
            || differs(r.contracted_length_m, first.contracted_length_m)
    };
    let Some(other) = rows.iter().find(is_other) else {
        return Ok(rows);
    };
    let muscle = |r: &Row| {
        format!(
            "{} has specimen {} of {} mm, {:.1} mm long, {:.1} mm at 620 kPa",
            r.session,
            r.specimen,
            r.diameter_mm,
            1e3 * r.rest_length_m,
            1e3 * r.contracted_length_m
        )
    };
    Err(Error::Usage(format!(
        "the readings are of more than one muscle: {}; {}. Sessions of one muscle have its id and its lengths in common",
        muscle(first),
        muscle(other)
    )))
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

    /// A predictor that was told the readings; `was_asked_for` where its law is not the program's choice.
    ///
    /// # Errors
    /// A law that does not say how muscles differ.
    pub fn told<'a>(self, predictor: Predictor<'a>, was_asked_for: bool) -> Result<Predictor<'a>> {
        let needs = |what: &str| {
            Err(Error::Usage(format!(
                "--specimen and --calibrate need the mixed model, which says how muscles differ: {what}"
            )))
        };
        match predictor.choice.law {
            Law::Fitted(fitted) if fitted.mixed.is_some() => {}
            _ if was_asked_for => return needs("leave out --model"),
            Law::Fitted(_) if !predictor.choice.has_mixed => {
                return needs("mixed_laws.json is missing; `pipeline run` writes it");
            }
            Law::Fitted(fitted) => {
                return needs(&format!(
                    "there is none of {}; it takes two specimens, 20 readings and the new model as diagnose.base_model",
                    fitted.fit.group.campaign
                ));
            }
            Law::Published(_) => {
                return needs(
                    "there is no fit for this diameter; `pipeline run` makes it from sessions of other muscles",
                );
            }
        }
        let mut told = predictor.reading(&self.rows);
        told.doubts = self.doubts;
        let contradictions = told.calibrated().map_or_else(Vec::new, contradictions);
        told.doubts.extend(contradictions);
        Ok(told)
    }
}

/// Where the readings contradict the scatter between muscles and sessions: a wrong length, diameter or unit is likelier than such a muscle.
fn contradictions(muscle: &Calibrated) -> Vec<String> {
    let deviations = |e: &Estimate| ((e.value - e.value_before) / e.sd_before).abs();
    let stands_out = |e: &Estimate| deviations(e) > STANDS_OUT;
    let gain = muscle.gain();
    let of_gain = stands_out(&gain).then(|| {
        format!(
            "a specimen gain of {:+.1}% is {:.0} standard deviations from those of the mixed model",
            100.0 * gain.value,
            deviations(&gain)
        )
    });
    let of_contracted = muscle.contracted_length().filter(stands_out).map(|e| {
        format!(
            "a contracted length that is off by {:+.1} mm is {:.0} standard deviations from what is expected of others that are noted alike ({:+.1} mm)",
            e.value,
            deviations(&e),
            e.value_before
        )
    });
    let lengths = muscle.set_lengths().into_iter().filter(|e| stands_out(e));
    let of_lengths = lengths.map(|e| {
        format!(
            "{}: a length that is off by {:+.1} mm is {:.0} standard deviations from those that are set on the rig",
            e.session.clone().unwrap_or_default(),
            e.value,
            deviations(&e)
        )
    });
    let left = muscle.left();
    let of_readings = (left > STANDS_OUT).then(|| {
        format!(
            "what gain, lengths and misfit leave of the readings is {left:.0} times their noise"
        )
    });
    let advice = |what: String| {
        format!(
            "{what}: check lengths, diameter and units of the session; the answer is not to be relied on"
        )
    };
    let all = of_gain.into_iter().chain(of_contracted).chain(of_lengths);
    all.chain(of_readings).map(advice).collect()
}

/// Contractions and pressures among which the next reading is looked for: steps of the ranges that were measured.
const STEPS: (usize, usize) = (7, 7);

/// The reading that would narrow the answer most.
fn next(predictor: &Predictor, answer: &Answer) -> Option<Next> {
    let muscle = predictor.calibrated()?;
    let Law::Fitted(fitted) = predictor.choice.law else {
        return None;
    };
    let ranges = &fitted.fit.ranges;
    let rest_m = answer.muscle.rest_length_m;
    let stroke_m = rest_m * answer.muscle.contraction_620?;
    let steps = |(low, high): (f64, f64), count: usize| {
        (0..count).map(move |k| low + (high - low) * k as f64 / (count - 1) as f64)
    };
    let state = |length_m: f64, kpa: f64| [rest_m, rest_m - stroke_m, length_m, kpa];
    let pressures = |rel: f64| {
        let all = steps(ranges.pressure_kpa, STEPS.1);
        all.map(move |kpa| state(rest_m - rel * stroke_m, kpa))
    };
    let (low, high) = ranges.contraction_rel;
    let all: Vec<[f64; 4]> = steps((low.max(0.0), high), STEPS.0)
        .flat_map(pressures)
        .collect();
    muscle.next(
        state(answer.length_m, answer.pressure_kpa),
        predictor.whose,
        &all,
    )
}

/// Whether a check is about the values of readings, and neither about what was left out of them nor about a muscle that is merely strong.
fn is_of_readings(seen: &Seen) -> bool {
    matches!(
        seen,
        Seen::SetLength { .. }
            | Seen::Misfit { .. }
            | Seen::Otherwise { .. }
            | Seen::ZeroOfOthers { .. }
    )
}

/// Prints what the readings say of the muscle.
pub fn head(muscle: &Calibrated) {
    let (readings, sessions) = muscle.count();
    let others = muscle.others();
    let with = if muscle.is_in_law() {
        format!(
            "it is one of the {} specimens of the mixed model",
            others + 1
        )
    } else {
        format!("combined with the mixed model of {others} others")
    };
    line(format!(
        "readings {readings} of this muscle in {}: {with}",
        counted(sessions, "session", "sessions")
    ));
    let gain = muscle.gain();
    line(format!(
        "         specimen gain {:+.1} ± {:.1}% relative to that law (standard deviation; ± {:.1}% without the readings): percentile {}",
        100.0 * gain.value,
        100.0 * gain.sd,
        100.0 * gain.sd_before,
        match muscle.percentile() {
            p if p < 1.0 => "<1".to_owned(),
            p if p > 99.0 => ">99".to_owned(),
            p => format!("{p:.0}"),
        }
    ));
    let contracted = muscle.contracted_length();
    if let Some(e) = contracted {
        line(format!(
            "         contracted length {} (without the readings {:.1} ± {:.1} mm {})",
            beside_noted(&e),
            e.value_before.abs(),
            e.sd_before,
            longer_or_shorter(e.value_before)
        ));
    }
    for length in muscle.set_lengths() {
        let session = length.session.as_deref().unwrap_or_default();
        line(format!("         {session}: {}", beside_noted(&length)));
    }
}

/// `0.3 ± 0.2 mm shorter than noted, by that law`.
fn beside_noted(length: &Estimate) -> String {
    let digits = if length.sd < 0.05 { 2 } else { 1 };
    format!(
        "{:.digits$} ± {:.digits$} mm {} than noted, by that law",
        length.value.abs(),
        length.sd,
        longer_or_shorter(length.value)
    )
}

fn longer_or_shorter(mm: f64) -> &'static str {
    if mm < 0.0 { "shorter" } else { "longer" }
}

/// A further reading that narrows the answer by less than this share is not worth a line.
const WORTH_SAYING: f64 = 0.02;

/// Prints what the answer was before, and what would narrow it.
pub fn tail(predictor: &Predictor, answer: &Answer) {
    if let Some((force, interval)) = &answer.uncalibrated {
        line(format!(
            "before   {force:.1} N, {:.1} to {:.1} N without the readings",
            interval.low_n, interval.high_n
        ));
    }
    let worth = |n: &Next| n.sd_after_n < (1.0 - WORTH_SAYING) * n.sd_before_n;
    if let Some(next) = next(predictor, answer).filter(worth) {
        line(format!(
            "next     a session with a reading at a contraction of {:.1}% and {:.0} kPa narrows it most: standard deviation from {:.1} to {:.1} N",
            100.0 * next.contraction,
            next.pressure_kpa,
            next.sd_before_n,
            next.sd_after_n
        ));
    }
}

/// The same as values.
pub fn as_json(predictor: &Predictor, answer: Option<&Answer>) -> Value {
    let Some(muscle) = predictor.calibrated() else {
        return Value::Null;
    };
    let (readings, sessions) = muscle.count();
    json!({
        "others": muscle.others(),
        "readings": readings,
        "doubts": predictor.doubts,
        "sessions": sessions,
        "specimen_gain": muscle.gain(),
        "percentile": muscle.percentile(),
        "contracted_length": muscle.contracted_length(),
        "set_lengths": muscle.set_lengths(),
        "next": answer.and_then(|a| next(predictor, a)),
    })
}
