//! The residual against every column that it was asked about, before and after the effects: two figures with the same axes.

use crate::base::row::{NO_LABEL, Row, label_names};
use crate::config::Config;
use crate::report::answers::{SIGNIFICANT, p_words};
use crate::report::figures::trend::{spread, trend};
use crate::report::figures::words::plain;
use crate::report::input::GroupInput;
use crate::report::plot::axis::{Span, Ticks};
use crate::report::plot::{Axis, DOUBLE_MM, Figure, Ink, Layer, Mark, Panel, Series, Shape};
use crate::stages::diagnose::Diagnosis;
use crate::stages::diagnose::findings::Question;
use std::collections::BTreeSet;

/// The column of the diagnosis that says of which sessions the zero of the force is not known, 0 or 1.
const ZERO_UNKNOWN: &str = "zero_unknown";
/// Most readings drawn in a panel; the medians are those of all.
const DRAWN: usize = 700;
/// Panels beyond these are left out, the least explained first.
const MOST_PANELS: usize = 10;
/// Height of a row of panels, mm.
const ROW_MM: f64 = 35.0;
/// Width of a dot where there are many readings and where there are few, mm.
const DOT_MM: [f64; 2] = [0.6, 1.0];
/// Up to so many readings are few.
const FEW: usize = 250;
/// Up to so many specimens have a colour each.
const COLOURS: [Ink; 6] = [
    Ink::Blue,
    Ink::Orange,
    Ink::Green,
    Ink::Purple,
    Ink::Black,
    Ink::Sky,
];

/// The residual of the base model.
pub fn before(group: &GroupInput, _config: &Config) -> Option<(String, Figure)> {
    let diagnosis = group.diagnosis.as_ref()?;
    let caption = caption(group, diagnosis, "the base model");
    let title = format!("Residual before, {}", group.fit.group.campaign);
    let shown = Shown {
        residuals: &diagnosis.residuals.before,
        questions: &diagnosis.findings.questions,
    };
    let figure = figure(group, diagnosis, &shown, &title)?;
    Some((caption, figure))
}

/// The residual of the model with the effects; none where nothing was added.
pub fn after(group: &GroupInput, _config: &Config) -> Option<(String, Figure)> {
    let diagnosis = group.diagnosis.as_ref()?;
    let residuals = &diagnosis.residuals;
    if residuals.before == residuals.after {
        return None;
    }
    let mut model = "the model with the effects".to_owned();
    if diagnosis.findings.after_empirical.is_some() {
        model.push_str(" and the empirical corrections");
    }
    let caption = format!(
        "{} Axes, grey strips and colours are those of the residual before.",
        caption(group, diagnosis, &model)
    );
    let title = format!("Residual after, {}", group.fit.group.campaign);
    let shown = Shown {
        residuals: &residuals.after,
        questions: &diagnosis.findings.questions_after,
    };
    let figure = figure(group, diagnosis, &shown, &title)?;
    Some((caption, figure))
}

/// What one of the two figures shows.
struct Shown<'a> {
    residuals: &'a [f64],
    questions: &'a [Question],
}

fn figure(group: &GroupInput, diagnosis: &Diagnosis, shown: &Shown, title: &str) -> Option<Figure> {
    let mut asked = panels(group, diagnosis);
    for a in &mut asked {
        a.question = shown.questions.iter().find(|q| q.column == a.name);
    }
    if asked.is_empty() {
        return None;
    }
    let in_a_row = columns(asked.len());
    let mut figure = Figure::new(title, DOUBLE_MM, 0.0)
        .grid(in_a_row)
        .shared_legend();
    for (k, asked) in asked.iter().enumerate() {
        let mut panel = panel(diagnosis, shown.residuals, asked);
        if k % in_a_row > 0 {
            panel.y = panel.y.bare();
        }
        figure = figure.with(panel);
    }
    figure.height_mm = 12.0 + ROW_MM * asked.len().div_ceil(in_a_row) as f64;
    Some(figure)
}

/// Panels in a row: two rows at most, so that the figure before and the one after leave room for words.
fn columns(panels: usize) -> usize {
    match panels {
        0..=4 => panels.max(1),
        more => more.div_ceil(2),
    }
}

/// A column with the question about it; none where the strengths of the specimens answer for it.
struct Asked<'a> {
    name: &'a str,
    values: &'a [f64],
    question: Option<&'a Question>,
    /// What its values stand for, from the smallest, in a column of words.
    words: Vec<String>,
}

/// The columns to show: what is not asked about and names no specimen says little.
fn panels<'a>(group: &GroupInput, diagnosis: &'a Diagnosis) -> Vec<Asked<'a>> {
    let questions = &diagnosis.findings.questions;
    let columns = diagnosis.residuals.columns.iter();
    let mut asked: Vec<Asked> = columns
        .map(|(name, values)| Asked {
            name,
            values,
            question: questions.iter().find(|q| q.column == *name),
            words: words(&group.predictions.rows, name, values),
        })
        .filter(|a| a.name != "log" || a.is_significant())
        .collect();
    while asked.len() > MOST_PANELS {
        let share = |a: &Asked| a.question.map_or(0.0, |q| q.share);
        let least = (0..asked.len()).min_by(|a, b| share(&asked[*a]).total_cmp(&share(&asked[*b])));
        asked.remove(least.unwrap_or(0));
    }
    asked
}

/// The words of a column of labels in their order, which is that of the numbers that stand for them; none if they do not match.
fn words(rows: &[Row], name: &str, values: &[f64]) -> Vec<String> {
    if name == ZERO_UNKNOWN {
        return ["known", "not known"].map(str::to_owned).to_vec();
    }
    if !label_names(rows).contains(name) {
        return Vec::new();
    }
    let mut words: BTreeSet<String> = rows.iter().filter_map(|r| r.label(name)).collect();
    let levels = levels(values);
    if levels.len() == words.len() + 1 {
        words.insert(NO_LABEL.to_owned());
    }
    if levels.len() == words.len() {
        words.into_iter().collect()
    } else {
        Vec::new()
    }
}

/// The values that occur, rising.
fn levels(values: &[f64]) -> Vec<f64> {
    let mut levels = values.to_vec();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    levels
}

impl Asked<'_> {
    fn is_significant(&self) -> bool {
        self.question.is_some_and(|q| q.p_adjusted < SIGNIFICANT)
    }

    /// Whether its values stand for names.
    fn is_named(&self) -> bool {
        !self.words.is_empty() || ["direction", "session", "log"].contains(&self.name)
    }

    /// The values in the unit of the axis.
    fn shown(&self) -> Vec<f64> {
        if !self.words.is_empty() {
            let levels = levels(self.values);
            let place = |v: &f64| levels.partition_point(|l| l < v) as f64;
            return self.values.iter().map(place).collect();
        }
        let factor = factor(self.name);
        // Sessions and logs are counted from 1.
        let first = f64::from(u8::from(self.is_named() && self.name != "direction"));
        self.values.iter().map(|v| first + factor * v).collect()
    }

    fn title(&self) -> String {
        match self.question {
            Some(q) => format!("\\v{{p}} {}", p_words(q.p_adjusted)),
            None => "not asked".to_owned(),
        }
    }

    fn axis(&self, (low, high): (f64, f64)) -> Axis {
        let mut label = label(self.name);
        // Columns of the user's own are asked about in standard deviations from their mean.
        if label == plain(self.name) && self.words.is_empty() {
            label.push_str(" (s.d.)");
        }
        match self.name {
            "direction" => Axis {
                span: Span::Fixed(-1.6, 1.6),
                ticks: Ticks::Named(
                    [(-1.0, "venting"), (1.0, "filling")]
                        .map(|(at, name)| (at, name.to_owned()))
                        .to_vec(),
                ),
                ..Axis::new(&label)
            },
            _ if !self.words.is_empty() => {
                let words: Vec<String> = self.words.iter().map(|w| plain(w)).collect();
                let words: Vec<&str> = words.iter().map(String::as_str).collect();
                Axis::categories(&label, &words)
            }
            _ if self.is_named() => Axis::new(&label).fixed(low - 0.6, high + 0.6),
            _ => {
                let margin = 0.04 * (high - low);
                Axis::new(&label).fixed(low - margin, high + margin)
            }
        }
    }
}

/// From the unit of a column to that of its axis.
pub fn factor(column: &str) -> f64 {
    if column == "rest_length_m" { 1e3 } else { 1.0 }
}

/// What a column is called on an axis.
pub fn label(column: &str) -> String {
    let label = match column {
        "pressure_kpa" => "Pressure (kPa)",
        "contraction_rel" => "ε* (–)",
        "force_n" => "Predicted force (N)",
        "direction" => "Direction",
        "time_s" => "Time in the log (s)",
        "since_step_s" => "Since the step (s)",
        "pressure_rate" => "Rate (kPa/s)",
        "temperature_c" => "Temperature (°C)",
        "cycles" => "Cycles",
        "session_order" => "Order of sessions",
        "session" => "Session, by name",
        "log" => "Log",
        "rest_length_m" => "l_{rest} (mm)",
        ZERO_UNKNOWN => "Zero of the force",
        other => return plain(other),
    };
    label.to_owned()
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        })
}

fn panel(diagnosis: &Diagnosis, residuals: &[f64], asked: &Asked) -> Panel {
    let values = asked.shown();
    let ends = range(values.iter().copied());
    let both = &diagnosis.residuals;
    let (low, high) = range(both.before.iter().chain(&both.after).copied());
    let margin = 0.04 * (high - low);
    let y = Axis::new("Residual (N)").fixed(low - margin, high + 3.0 * margin);
    let mut panel = Panel::new(asked.axis(ends), y).title(&asked.title());
    if asked.is_significant() {
        let strip = |x: f64| (x, high + 1.5 * margin, high + 3.0 * margin);
        let wide = ends.1 - ends.0 + 9.0;
        let name = "the residual depends on this column";
        let points = vec![strip(ends.0 - wide), strip(ends.1 + wide)];
        panel = panel.with(Layer::band(name, points, Ink::Black));
    }
    panel = panel.with(Layer::zero());
    let places = if asked.is_named() {
        spread(&values)
    } else {
        values.clone()
    };
    let width = DOT_MM[usize::from(residuals.len() <= FEW)];
    for ((ink, name), points) in by_specimen(&both.specimen, &places, residuals) {
        let mark = Mark::filled(Shape::Dot, ink).wide(width);
        panel = panel.with(Series::marks(&name, points, mark));
    }
    panel.with(trend(&values, residuals, asked.is_named()))
}

type Cloud = ((Ink, String), Vec<(f64, f64)>);

/// The points of each specimen, thinned alike; beyond the colours one name for all.
fn by_specimen(specimens: &[String], places: &[f64], residuals: &[f64]) -> Vec<Cloud> {
    let ids: BTreeSet<&String> = specimens.iter().collect();
    let every = residuals.len().div_ceil(DRAWN).max(1);
    let mut clouds: Vec<Cloud> = ids
        .iter()
        .enumerate()
        .map(|(k, id)| {
            let look = if ids.len() > COLOURS.len() {
                (Ink::Blue, "reading".to_owned())
            } else {
                (COLOURS[k], plain(id))
            };
            (look, Vec::new())
        })
        .collect();
    for i in (0..residuals.len()).step_by(every) {
        if let Some(k) = ids.iter().position(|id| **id == specimens[i]) {
            clouds[k].1.push((places[i], residuals[i]));
        }
    }
    clouds
}

fn caption(group: &GroupInput, diagnosis: &Diagnosis, model: &str) -> String {
    let readings = diagnosis.residuals.before.len();
    let every = readings.div_ceil(DRAWN).max(1);
    let drawn = match every {
        1 => String::new(),
        n => format!(" One reading in {n} is drawn, the medians are those of all."),
    };
    let unasked = if panels(group, diagnosis)
        .iter()
        .any(|a| a.question.is_none())
    {
        " What is constant within every specimen is not asked: the strengths of the specimens answer for it."
    } else {
        ""
    };
    format!(
        "Residual (measured force minus that of {model}, no specimen with a strength of its own) of {readings} readings, against what it \
         was asked about; _p_ is corrected for the number of questions.{unasked}{drawn}"
    )
}
