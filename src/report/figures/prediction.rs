//! Predicted force along one quantity or along isobars, with the interval for a muscle that was not measured.

use crate::figures::Named;
use crate::plot::{Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Legend, Panel, Series, Stroke, look};
use crate::wording::name::model_name;
use pipeline_predict::muscle::mm;
use pipeline_predict::sweep::{Axis as Along, TABLE_KPA};
use pipeline_predict::{Answer, Predictor};

const HEIGHT_MM: f64 = 90.0;
/// A pressure of the table that would stand too close to its neighbour, kPa.
const CLOSE_KPA: f64 = 600.0;

/// Force along one quantity, beside every other model.
pub fn sweep(predictor: &Predictor, along: Along, answers: &[Answer]) -> Named {
    let x = |a: &Answer| match along {
        Along::Pressure => a.pressure_kpa,
        Along::Contraction => 100.0 * a.contraction,
        Along::RestLength => 1e3 * a.muscle.rest_length_m,
    };
    let label = match along {
        Along::Pressure => "Gauge pressure \\v{P} (kPa)",
        Along::Contraction => "Contraction ε (%)",
        Along::RestLength => "Resting length l_{rest} (mm)",
    };
    let mut panel = panel(label);
    let first: &[Answer] = &answers[..answers.len().min(1)];
    for (n, other) in first.iter().flat_map(|a| &a.others).enumerate() {
        let (ink, dash) = style(n);
        let points = answers
            .iter()
            .map(|a| (x(a), a.others[n].force_n.unwrap_or(f64::NAN)));
        let points: Vec<(f64, f64)> = points.collect();
        if points.iter().any(|p| p.1.is_finite()) {
            let name = model_name(other.model, other.model);
            panel = panel.with(Series::line(name, points, Stroke::hair(ink, dash)));
        }
    }
    let name = match predictor.calibrated() {
        Some(_) => "this muscle, by its readings".to_owned(),
        None if predictor.mixed.is_some() => "New model, mixed-model fit".to_owned(),
        None => {
            let id = predictor.choice.law.id();
            model_name(id, id).to_owned()
        }
    };
    let names = [name.clone(), format!("{name}, extrapolated")];
    panel = with_curve(panel, names, answers, &x, Ink::Blue, "95% interval");
    let pressure = first.first().map_or(0.0, |a| a.pressure_kpa);
    let contraction = first.first().map_or(0.0, |a| 100.0 * a.contraction);
    let rest = mm(predictor.muscle.rest_length_m);
    let held = match along {
        Along::Pressure => format!("l_{{rest}} {rest}, ε {contraction:.2}%"),
        Along::Contraction => format!("l_{{rest}} {rest}, {pressure:.1} kPa"),
        Along::RestLength => format!("ε {contraction:.2}%, {pressure:.1} kPa"),
    };
    named(predictor, "sweep", &held, panel)
}

/// Force along isobars against contraction: rows of answers at [`TABLE_KPA`].
pub fn isobars(predictor: &Predictor, rows: &[Vec<Answer>]) -> Named {
    let mut panel = panel("Contraction ε (%)");
    // From the top down, so that the legend has the order of the curves.
    let isobars = TABLE_KPA.iter().enumerate().rev();
    for (n, (k, pressure)) in isobars.filter(|(_, p)| **p != CLOSE_KPA).enumerate() {
        let answers: Vec<Answer> = rows.iter().map(|row| row[k].clone()).collect();
        let x = |a: &Answer| 100.0 * a.contraction;
        let outside = if n == 0 { "extrapolated" } else { "" };
        let names = [format!("{pressure:.0} kPa"), outside.to_owned()];
        panel = with_curve(panel, names, &answers, &x, look(n).0, "");
    }
    let held = format!("l_{{rest}} {}", mm(predictor.muscle.rest_length_m));
    named(predictor, "isobars", &held, panel)
}

fn panel(label: &str) -> Panel {
    Panel::new(
        Axis::new(label),
        Axis::new("Force \\v{F} (N)").including(0.0),
    )
    .legend(Legend::Beside)
}

/// The look of another model: none like the curve in question.
fn style(n: usize) -> (Ink, Dash) {
    const INKS: [Ink; 7] = [
        Ink::Vermilion,
        Ink::Green,
        Ink::Purple,
        Ink::Orange,
        Ink::Black,
        Ink::Sky,
        Ink::Grey,
    ];
    const DASHES: [Dash; 4] = [Dash::Dashed, Dash::DashDot, Dash::Long, Dash::Dotted];
    (INKS[n % 7], DASHES[(n + 2 * (n / 7)) % 4])
}

/// A curve with its band and the names of both its parts: solid where the law was measured, dotted where it extrapolates.
fn with_curve(
    mut panel: Panel,
    [name, name_outside]: [String; 2],
    answers: &[Answer],
    x: &dyn Fn(&Answer) -> f64,
    ink: Ink,
    band: &str,
) -> Panel {
    let ends = |a: &Answer| a.interval.as_ref().map(|i| (x(a), i.low_n, i.high_n));
    let points: Vec<(f64, f64, f64)> = answers.iter().filter_map(ends).collect();
    if !points.is_empty() {
        panel = panel.with(Layer::band(band, points, ink));
    }
    let inside = part(answers, x, false);
    let outside = part(answers, x, true);
    let any = |points: &[(f64, f64)]| points.iter().any(|p| p.1.is_finite());
    let solid = any(&inside);
    if solid {
        panel = panel.with(Series::line(&name, inside, Stroke::new(ink, Dash::Solid)));
    }
    if any(&outside) {
        let name = if solid { name_outside } else { name };
        panel = panel.with(Series::line(&name, outside, Stroke::new(ink, Dash::Dotted)));
    }
    panel
}

/// The points inside of, or outside of what was measured; the others part the line. The first point beyond joins both parts.
fn part(answers: &[Answer], x: &dyn Fn(&Answer) -> f64, outside: bool) -> Vec<(f64, f64)> {
    let belongs = |k: usize| {
        let here = answers[k].is_outside() == outside;
        let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten();
        let mut beside = beside.filter_map(|j| answers.get(j));
        here || (outside && beside.any(Answer::is_outside))
    };
    let force = |k: usize| {
        answers[k]
            .force_n
            .filter(|_| belongs(k))
            .unwrap_or(f64::NAN)
    };
    (0..answers.len())
        .map(|k| (x(&answers[k]), force(k)))
        .collect()
}

/// The figure, which says what it is of and what is held.
fn named(predictor: &Predictor, name: &str, held: &str, panel: Panel) -> Named {
    let muscle = &predictor.muscle;
    let free = muscle
        .contraction_620
        .map_or_else(String::new, |e| format!(", ε_{{620}} {:.1}%", 100.0 * e));
    let (diameter, law) = (muscle.diameter_mm, predictor.choice.law.title());
    let law = match predictor.calibrated() {
        Some(_) => format!("{law}, calibrated by its readings"),
        None => law,
    };
    let title = format!("Predicted force of a {diameter} mm muscle, {law}");
    // As short as a panel is wide.
    let short = law
        .replace("new model, ", "")
        .replace("calibrated by its readings", "calibrated");
    let heading = format!("{diameter} mm, {held}{free}; {}", short.replace('_', "\\_"));
    Named {
        name: name.to_owned(),
        caption: title.clone(),
        figure: Figure::new(&title, DOUBLE_MM, HEIGHT_MM).with(panel.title(&heading)),
    }
}
