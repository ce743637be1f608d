//! What `predict` prints.

use crate::columns::{Align, aligned};
use crate::predict_calibrate;
use crate::predict_head;
use crate::predict_head::head;
use crate::print::{line, print_json};
use pipeline_base::error::Result;
use pipeline_diagnose::mixed_law::Whose;
use pipeline_mechanics::models::festo_tool::TOLERANCE;
use pipeline_predict::answer::{LEAST_CHANGE_N, Measured, Other};
use pipeline_predict::interval::CONFIDENCE;
use pipeline_predict::inverse::{Solved, Wanted};
use pipeline_predict::sweep::{Axis, TABLE_KPA};
use pipeline_predict::{Answer, Fitted, Law, Predictor};
use serde_json::{Value, json};

const LEFT: Align = Align::Left;
const RIGHT: Align = Align::Right;

/// The answer at one state.
pub fn single(predictor: &Predictor, answer: &Answer, as_json: bool) -> Result<()> {
    if as_json {
        let mut value = with_head(predictor, "answer", json!(answer));
        value["calibration"] = predict_calibrate::as_json(predictor, Some(answer));
        return print_json(&value);
    }
    head(predictor);
    let relative = answer.contraction_rel.map_or_else(String::new, |noted| {
        let taken = predict_head::taken_contraction(predictor).map(|taken| {
            format!(
                " of the noted one, {:.3} of that taken",
                answer.contraction / taken
            )
        });
        format!(
            ", relative contraction {noted:.3}{}",
            taken.unwrap_or_default()
        )
    });
    line(format!(
        "state    {:.1} kPa, length {:.1} mm: contraction {:.2}%{relative}",
        answer.pressure_kpa,
        1e3 * answer.length_m,
        100.0 * answer.contraction
    ));
    line("");
    line(format!("force    {}", force(predictor, answer)));
    predict_calibrate::tail(predictor, answer);
    effects(answer);
    if let Some(why) = no_interval(predictor) {
        line(format!("         {why}"));
    }
    warnings(answer.remarks());
    measured(&answer.measured);
    others(&answer.others);
    Ok(())
}

/// The pressure or length for a force.
pub fn solved(predictor: &Predictor, wanted: Wanted, solved: &Solved, as_json: bool) -> Result<()> {
    if as_json {
        return print_json(&with_head(predictor, "solved", json!(solved)));
    }
    head(predictor);
    line("");
    let (what, shown): (String, fn(&Answer) -> String) = match wanted {
        Wanted::Pressure(_) => (
            format!(
                "pressure for {:.1} N at {:.1} mm, contraction {:.2}%",
                solved.force_n,
                1e3 * solved.answer.length_m,
                100.0 * solved.answer.contraction
            ),
            |a| format!("{:.1} kPa", a.pressure_kpa),
        ),
        Wanted::Length(pressure_kpa) => (
            format!(
                "length for {:.1} N at {pressure_kpa:.1} kPa",
                solved.force_n
            ),
            |a| {
                format!(
                    "{:.1} mm, contraction {:.2}%",
                    1e3 * a.length_m,
                    100.0 * a.contraction
                )
            },
        ),
    };
    line(format!("{what}: {}", shown(&solved.answer)));
    if solved.answer.interval.is_some() {
        let end = |state: &Option<Answer>, open: &str| {
            let state = state.as_ref();
            state.map_or_else(|| open.to_owned(), shown)
        };
        let strongest = end(&solved.strongest, "no lower end");
        let weakest = end(&solved.weakest, "beyond the measured range");
        line(format!(
            "{:.0}% interval {}: {strongest} (a strong one) to {weakest} (a weak one)",
            100.0 * CONFIDENCE,
            of_which(predictor)
        ));
    }
    if let Some(why) = no_interval(predictor) {
        line(why);
    }
    warnings(solved.answer.remarks());
    measured(&solved.answer.measured);
    Ok(())
}

/// The answers along one quantity.
pub fn sweep(predictor: &Predictor, axis: Axis, answers: &[Answer], as_json: bool) -> Result<()> {
    if as_json {
        return print_json(&with_head(
            predictor,
            "sweep",
            json!({ "along": axis, "answers": answers }),
        ));
    }
    head(predictor);
    if let Some(first) = answers.first() {
        line(format!("along    {}", fixed(axis, first)));
    }
    line("");
    let (name, value): (&str, fn(&Answer) -> String) = match axis {
        Axis::Pressure => ("P (kPa)", |a| format!("{:.1}", a.pressure_kpa)),
        Axis::Contraction => ("contraction (%)", |a| {
            format!("{:.2}", 100.0 * a.contraction)
        }),
        Axis::RestLength => ("l_rest (mm)", |a| {
            format!("{:.1}", 1e3 * a.muscle.rest_length_m)
        }),
    };
    let end = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.1}"));
    let mut rows = vec![
        [name, "force (N)", "from", "to", ""]
            .map(str::to_owned)
            .to_vec(),
    ];
    rows.extend(answers.iter().map(|a| {
        vec![
            value(a),
            a.force_n
                .map_or_else(|| "none".to_owned(), |f| format!("{f:.1}")),
            end(a.interval.map(|i| i.low_n)),
            end(a.interval.map(|i| i.high_n)),
            star(a).to_owned(),
        ]
    }));
    for text in aligned(&rows, &[RIGHT, RIGHT, RIGHT, RIGHT, LEFT]) {
        line(text);
    }
    footnotes(predictor, answers, true);
    Ok(())
}

/// The designer's table.
pub fn table(predictor: &Predictor, rows: &[Vec<Answer>], as_json: bool) -> Result<()> {
    if as_json {
        return print_json(&with_head(
            predictor,
            "table",
            json!({ "pressures_kpa": TABLE_KPA, "rows": rows }),
        ));
    }
    head(predictor);
    line("");
    line("force in N, by contraction and gauge pressure");
    let heading = ["contraction".to_owned(), "length (mm)".to_owned()];
    let pressures = TABLE_KPA.iter().map(|p| format!("{p:.0} kPa "));
    let mut lines: Vec<Vec<String>> = vec![heading.into_iter().chain(pressures).collect()];
    for row in rows {
        let first = row.first().map_or_else(Vec::new, |a| {
            vec![
                format!("{:.1}%", 100.0 * a.contraction),
                format!("{:.1}", 1e3 * a.length_m),
            ]
        });
        let cells = row.iter().map(|a| {
            let force = a
                .force_n
                .map_or_else(|| "none".to_owned(), |f| format!("{f:.1}"));
            format!("{force}{:1}", star(a))
        });
        lines.push(first.into_iter().chain(cells).collect());
    }
    for text in aligned(&lines, &[RIGHT; 2 + TABLE_KPA.len()]) {
        line(text);
    }
    let all: Vec<Answer> = rows.iter().flatten().cloned().collect();
    footnotes(predictor, &all, false);
    Ok(())
}

fn star(answer: &Answer) -> &'static str {
    if answer.remarks().next().is_some() {
        "*"
    } else {
        ""
    }
}

fn force(predictor: &Predictor, answer: &Answer) -> String {
    let of = of_which(predictor);
    match (answer.force_n, &answer.interval) {
        (None, _) => "none: the model gives no force here".to_owned(),
        (Some(force), None) => format!("{force:.1} N"),
        (Some(force), Some(i)) => format!(
            "{force:.1} N, {:.0}% interval {:.1} to {:.1} N {of}",
            100.0 * CONFIDENCE,
            i.low_n,
            i.high_n
        ),
    }
}

/// What the effects of the mixed model change here.
fn effects(answer: &Answer) {
    let shown = answer.effects.iter();
    let shown = shown.filter(|e| e.change_n.abs() >= LEAST_CHANGE_N);
    for (k, e) in shown.enumerate() {
        let of = match (e.of_actuator, e.included) {
            (true, _) => "of the actuator: in the force",
            (false, true) => "of the rig: in the force",
            (false, false) => "of the rig: left out (--as-read puts it in)",
        };
        let others: Vec<&str> = e
            .class
            .iter()
            .map(String::as_str)
            .filter(|id| *id != e.effect)
            .collect();
        let alike = if others.is_empty() {
            String::new()
        } else {
            format!("; the readings cannot tell it from {}", others.join(", "))
        };
        line(format!(
            "{}{} {:+.1} N, {of}{alike}",
            if k == 0 { "effects  " } else { "         " },
            e.effect,
            e.change_n
        ));
    }
}

/// Of which muscle the interval is.
fn of_which(predictor: &Predictor) -> &'static str {
    match predictor.calibrated() {
        Some(_) => "for this muscle",
        None => "for an unmeasured muscle",
    }
}

/// Why there is no interval.
fn no_interval(predictor: &Predictor) -> Option<String> {
    match predictor.choice.law {
        Law::Published(_) => Some(format!(
            "no interval: the scatter of specimens is not published (Festo states {:.0}% of the force)",
            100.0 * TOLERANCE
        )),
        Law::Fitted(Fitted { mixed: Some(_), .. }) => None,
        Law::Fitted(_) if predictor.choice.is_least_squares => Some(
            "no interval: the least-squares fit is given without one; the mixed model (--model new) has one"
                .to_owned(),
        ),
        Law::Fitted(_) if !predictor.choice.has_mixed => Some(
            "no interval: mixed_laws.json, which has the scatter between muscles, is missing; `pipeline run` writes it"
                .to_owned(),
        ),
        Law::Fitted(fitted) => {
            let pool = if fitted.fit.group.is_pool() {
                "; a large pool is not searched"
            } else {
                ""
            };
            Some(format!(
                "no interval: there is no mixed model of {}, which would have the scatter between muscles. It takes two specimens, 20 readings and \
                 the new model as diagnose.base_model{pool} (Festo states {:.0}% of the force)",
                fitted.fit.group.campaign,
                100.0 * TOLERANCE
            ))
        }
    }
}

/// Prints warnings, a line each.
pub fn warnings<'a>(all: impl IntoIterator<Item = &'a String>) {
    for warning in all {
        line(format!("warning: {warning}"));
    }
}

fn measured(all: &[Measured]) {
    if all.is_empty() {
        return;
    }
    line("");
    let mut rows = vec![
        ["quantity", "here", "measured from", "to", "unit"]
            .map(str::to_owned)
            .to_vec(),
    ];
    rows.extend(all.iter().map(|m| {
        let digits = if m.unit.is_empty() { 3 } else { 1 };
        let number = |x: f64| format!("{x:.digits$}");
        vec![
            m.quantity.to_owned(),
            number(m.value),
            number(m.low),
            number(m.high),
            m.unit.to_owned(),
        ]
    }));
    for text in aligned(&rows, &[LEFT, RIGHT, RIGHT, RIGHT, LEFT]) {
        line(text);
    }
}

fn others(all: &[Other]) {
    line("");
    let mut rows = vec![["other model", "force (N)", ""].map(str::to_owned).to_vec()];
    rows.extend(all.iter().map(|o| {
        let force = o
            .force_n
            .map_or_else(|| "none".to_owned(), |f| format!("{f:.1}"));
        vec![
            o.model.to_owned(),
            force,
            o.outside.clone().unwrap_or_default(),
        ]
    }));
    for text in aligned(&rows, &[LEFT, RIGHT, LEFT]) {
        line(text);
    }
}

/// What is held along a sweep.
fn fixed(axis: Axis, first: &Answer) -> String {
    let contraction = format!("contraction {:.2}%", 100.0 * first.contraction);
    let pressure = format!("{:.1} kPa", first.pressure_kpa);
    match axis {
        Axis::Pressure => format!("gauge pressure, at {contraction}"),
        Axis::Contraction => format!("contraction, at {pressure}"),
        Axis::RestLength => format!("resting length, at {pressure} and {contraction}"),
    }
}

fn footnotes(predictor: &Predictor, answers: &[Answer], with_intervals: bool) {
    line("");
    match no_interval(predictor) {
        Some(why) => line(why),
        None if !with_intervals => line("the intervals are in --json and --csv FILE"),
        None => line(format!(
            "from, to: {:.0}% interval {}",
            100.0 * CONFIDENCE,
            of_which(predictor)
        )),
    }
    let starred: Vec<&Answer> = answers.iter().filter(|a| !star(a).is_empty()).collect();
    if let (Some(first), Some(last)) = (starred.first(), starred.last()) {
        line(format!(
            "* {} of {} states have warnings:",
            starred.len(),
            answers.len()
        ));
        let mut said: Vec<&String> = first.remarks().collect();
        said.extend(last.remarks().filter(|w| !first.remarks().any(|f| f == *w)));
        warnings(said);
    }
}

/// One object with the muscle and the law first.
pub fn with_head(predictor: &Predictor, key: &str, value: Value) -> Value {
    let law = predictor.choice.law;
    let mut object = json!({
        "model": law.id(),
        "model_title": law.title(),
        "chosen_because": predictor.choice.why,
        "muscle": predictor.muscle,
        "contraction_620_from": predictor.free,
        "confidence": CONFIDENCE,
        "no_interval_because": no_interval(predictor),
    });
    if let Law::Fitted(Fitted { fit, mixed, .. }) = law {
        let of_fit = (fit.specimens.len(), fit.rows);
        let (specimens, readings) = mixed.map_or(of_fit, |m| (m.specimens.len(), m.readings));
        object["fit"] = json!({
            "is_mixed_model": mixed.is_some(),
            "as_read": predictor.whose == Whose::Rig,
            "contraction_620_expected": predict_head::expected_contraction(predictor).map(|(expected, _)| expected),
            "campaign": fit.group.campaign,
            "simulated": fit.group.simulated,
            "specimens": specimens,
            "readings": readings,
            "ranges": fit.ranges,
            "scatter": mixed.is_none().then_some(&fit.scatter),
            "doubtful": fit.doubtful,
        });
    }
    object[key] = value;
    object
}
