//! The residual against the columns that were tested: without effects, with them, and with the predicted values of the random effects too;
//! rows of panels with the same axes.

use super::super::formatting::plain;
use super::{Shown, TEXT_MM};
use crate::figures::trend::{spread, trend};
use crate::plot::axis::{Span, Ticks};
use crate::plot::{Axis, Figure, Ink, Layer, Mark, Panel, Series, Shape};
use crate::wording::COMES_IN;
use crate::wording::number::equals_probability;
use crate::wording::sentence::has_terms;
use pipeline_base::row::{NO_LABEL, Row, label_names};
use pipeline_findings::{Residuals, Tested};
use std::collections::BTreeSet;

/// The column of the diagnosis that says of which sessions the zero of the force is not known, 0 or 1.
const ZERO_UNKNOWN: &str = "zero_unknown";
/// Most readings drawn in a panel; the medians are those of all.
const DRAWN: usize = 500;
/// Most columns; the most telling are shown.
const MOST_COLUMNS: usize = 5;
/// Height of a row of panels, and of what is around them, mm.
const ROW_MM: f64 = 29.0;
const AROUND_MM: f64 = 10.0;
/// Width of a dot where there are many readings and where there are few, mm.
const DOT_MM: [f64; 2] = [0.6, 1.0];
/// Up to so many readings are few.
const FEW: usize = 250;
/// Columns that are shown where nothing was more telling.
const PLAIN: [&str; 4] = ["force_n", "pressure_kpa", "contraction_rel", "angle_deg"];
/// Up to so many specimens have a colour each.
const COLOURS: [Ink; 6] = [
    Ink::Blue,
    Ink::Orange,
    Ink::Green,
    Ink::Purple,
    Ink::Black,
    Ink::Sky,
];

/// The figure; none where there are no residuals.
pub fn figure(shown: &Shown) -> Option<(String, Figure)> {
    let columns = columns(shown);
    if shown.residuals.before.is_empty() || columns.is_empty() {
        return None;
    }
    let rows = rows(shown.residuals);
    let title = format!(
        "Residual against the tested columns, {}",
        shown.found.campaign
    );
    let height = AROUND_MM + ROW_MM * rows.len() as f64;
    let mut figure = Figure::new(&title, TEXT_MM, height)
        .grid(columns.len())
        .shared_legend();
    figure.lettered = false;
    for (r, row) in rows.iter().enumerate() {
        for (k, column) in columns.iter().enumerate() {
            let mut panel = panel(shown, row, column, r == 0);
            if k > 0 {
                panel.y = panel.y.bare();
            }
            if r + 1 < rows.len() {
                panel.x = panel.x.bare();
            }
            figure = figure.with(panel);
        }
    }
    Some((caption(shown, &rows), figure))
}

/// One residual of every reading, and what it is called on the axis.
struct OneResidual<'a> {
    name: &'static str,
    values: &'a [f64],
}

/// The residuals that differ: that without effects first.
fn rows(residuals: &Residuals) -> Vec<OneResidual<'_>> {
    let all = [
        ("Before", &residuals.before),
        ("After", &residuals.after),
        ("Own values", &residuals.conditional),
    ];
    let mut rows: Vec<OneResidual> = Vec::new();
    for (name, values) in all {
        let new = rows.iter().all(|r| r.values != values.as_slice());
        if new && values.len() == residuals.before.len() {
            rows.push(OneResidual { name, values });
        }
    }
    rows
}

/// A column with its test; none where it was not tested by itself.
struct Tried<'a> {
    name: &'a str,
    values: &'a [f64],
    tested: Option<&'a Tested>,
    /// What its values stand for, from the smallest, in a column of words.
    words: Vec<String>,
}

/// The columns to show: those that a test found first, then those that everybody looks for, then the others by their gain.
fn columns<'a>(shown: &'a Shown) -> Vec<Tried<'a>> {
    let tested = |name: &str| {
        let mut all = shown.found.tested.iter();
        all.find(|t| t.is_column && t.id == name)
    };
    let all = shown.residuals.columns.iter();
    let mut columns: Vec<Tried> = all
        .map(|(name, values)| Tried {
            name,
            values,
            tested: tested(name),
            words: labels_of(shown.rows, name, values),
        })
        .collect();
    let rank = |t: &Tried| (!t.is_significant(), !PLAIN.contains(&t.name));
    let gain = |t: &Tried| t.tested.map_or(0.0, |t| t.log_likelihood_gain);
    columns.sort_by(|a, b| rank(a).cmp(&rank(b)).then(gain(b).total_cmp(&gain(a))));
    columns.truncate(MOST_COLUMNS);
    columns
}

/// The words of a column of labels in their order, which is that of the numbers that stand for them; none if they do not match.
fn labels_of(rows: &[Row], name: &str, values: &[f64]) -> Vec<String> {
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

impl Tried<'_> {
    fn is_significant(&self) -> bool {
        self.tested.is_some_and(|t| t.p_familywise <= COMES_IN)
    }

    /// Whether its values stand for names.
    fn is_named(&self) -> bool {
        !self.words.is_empty() || ["direction", "session", "log"].contains(&self.name)
    }

    /// Whether it is a column of numbers of the user's own, called as in the log.
    fn is_of_the_log(&self) -> bool {
        self.words.is_empty() && label(self.name) == plain(self.name)
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
        self.tested.map_or_else(String::new, |t| {
            format!("\\v{{p}} {}", equals_probability(t.p_familywise))
        })
    }

    fn axis(&self, (low, high): (f64, f64)) -> Axis {
        let label = label(self.name);
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
        "pressure_kpa" | "pressure" => "Pressure (kPa)",
        "angle_deg" => "Knee angle (°)",
        "order" => "Place in the test (first 0, last 1)",
        "contraction_rel" => "ε* (–)",
        "contraction" => "ε (–)",
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

fn panel(shown: &Shown, row: &OneResidual, column: &Tried, first: bool) -> Panel {
    let values = column.shown();
    let ends = range(values.iter().copied());
    let both = shown.residuals;
    let all = both.before.iter().chain(&both.after);
    // What is left with own values may be on the other side of the rest, where an effect took the wrong share.
    let all = all.chain(&both.conditional).copied();
    let (low, high) = range(all.chain([0.0]));
    let margin = 0.04 * (high - low);
    let y = Axis::new(&format!("{} ({})", row.name, shown.unit()));
    let y = y.fixed(low - margin, high + 3.0 * margin);
    let mut panel = Panel::new(column.axis(ends), y);
    if first {
        panel = panel.title(&column.title());
    }
    if first && column.is_significant() {
        let strip = |x: f64| (x, high + 1.5 * margin, high + 3.0 * margin);
        let wide = ends.1 - ends.0 + 9.0;
        let name = "the error depends on this column";
        let points = vec![strip(ends.0 - wide), strip(ends.1 + wide)];
        panel = panel.with(Layer::band(name, points, Ink::Black));
    }
    panel = panel.with(Layer::zero());
    let places = if column.is_named() {
        spread(&values)
    } else {
        values.clone()
    };
    let width = DOT_MM[usize::from(row.values.len() <= FEW)];
    for ((ink, name), points) in by_specimen(&both.specimen, &places, row.values) {
        let mark = Mark::filled(Shape::Dot, ink).wide(width);
        panel = panel.with(Series::marks(&name, points, mark));
    }
    panel.with(trend(&values, row.values, column.is_named()))
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

fn caption(shown: &Shown, rows: &[OneResidual]) -> String {
    let readings = shown.residuals.before.len();
    let every = readings.div_ceil(DRAWN).max(1);
    let drawn = match every {
        1 => String::new(),
        n => format!(" One reading in {n} is drawn, the medians are those of all."),
    };
    let misfit = match shown.found.kind.as_str() {
        "knee-torque" => {
            "law and effects alone, without the common misfit and group-specific terms"
        }
        _ => {
            "law, effects and the misfit that all specimens share, fitted to these readings; without group-specific terms"
        }
    };
    let units = match columns(shown).iter().any(Tried::is_of_the_log) {
        true => " Columns of the log without a unit here have that of their `session.toml`.",
        false => "",
    };
    let own = if rows
        .iter()
        .any(|r| r.values == shown.residuals.conditional.as_slice())
    {
        " _Own values_: also with the predicted gains, lengths and zeros."
    } else {
        ""
    };
    let (both, which) = if has_terms(shown.found) {
        (", before and after the effects", "_Before_ and _after_")
    } else {
        ("", "Predicted by")
    };
    format!(
        "Residual (measured minus predicted) of {readings} readings{both}, against the columns tested that show most; _p_ is \
         that of the family-wise test of a \
         smooth dependence, where the column was tested. {which}: {misfit}.{own}{units}{drawn}"
    )
}
