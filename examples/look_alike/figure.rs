//! The picture: courses, a step and its plateau, and histograms.

use crate::look::Look;
use pipeline::base::columns::{FORCE, PRESSURE, TIME};
use pipeline::base::reading::Reading;
use pipeline::base::session::Phase;
use pipeline::report::plot::{
    Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Legend, Panel, Series, Stroke,
};
use pipeline::stages::ingest::LogSamples;

/// Pressure near which a plateau is drawn large, kPa.
const ZOOM_KPA: f64 = 300.0;

/// A measured session beside a simulated one; `run` as declared, or the first.
pub fn figure(looks: [&Look; 2], run: Option<i64>) -> Figure {
    let mut figure = Figure::new("A measured log and a simulated one", DOUBLE_MM, 235.0).grid(2);
    for column in [PRESSURE, FORCE] {
        for look in looks {
            figure = figure.with(course(look, run, column));
        }
    }
    for column in [PRESSURE, FORCE] {
        for look in looks {
            figure = figure.with(zoom(look, run, column));
        }
    }
    let sd = |look: &Look| look.all(|r| r.sd_force_n);
    figure
        .with(histogram(
            "Standard deviation of force on a plateau (N)",
            looks.map(|l| (l.name, sd(l))),
            0.1,
            4.0,
        ))
        .with(histogram(
            "Spacing of samples (ms)",
            looks.map(|l| (l.name, l.spacings_ms())),
            1.0,
            6.0,
        ))
}

fn quantity(column: &str) -> &'static str {
    if column == PRESSURE {
        "Pressure (kPa)"
    } else {
        "Force (N)"
    }
}

fn drawn(look: &Look, run: Option<i64>) -> Option<&LogSamples> {
    let mut logs = look.measuring();
    logs.find(|l| run.is_none() || l.spec.run == run)
}

fn points(log: &LogSamples, column: &str, from_s: f64, to_s: f64) -> Vec<(f64, f64)> {
    let (time, values) = (log.column(TIME), log.column(column));
    let pairs = time
        .unwrap_or_default()
        .iter()
        .zip(values.unwrap_or_default());
    let here = pairs.filter(|(t, _)| (from_s..=to_s).contains(*t));
    here.map(|(t, v)| (*t, *v)).collect()
}

fn hair() -> Stroke {
    Stroke {
        width_pt: 0.5,
        ..Stroke::new(Ink::Blue, Dash::Solid)
    }
}

/// A whole log with its plateaus.
fn course(look: &Look, run: Option<i64>, column: &str) -> Panel {
    let panel = Panel::new(Axis::new("Time (s)"), Axis::new(quantity(column))).title(look.name);
    let Some(log) = drawn(look, run) else {
        return panel;
    };
    let here = look.readings.iter().filter(|r| r.log == log.spec.file);
    let spans = here.map(|r| {
        let time = look.window(r, TIME);
        (time[0], time[time.len() - 1])
    });
    panel
        .with(Layer::windows("", spans.collect()))
        .with(Series::line(
            "",
            points(log, column, f64::MIN, f64::MAX),
            hair(),
        ))
}

/// One step of the filling and the plateau after it.
fn zoom(look: &Look, run: Option<i64>, column: &str) -> Panel {
    let panel = Panel::new(Axis::new("Time (s)"), Axis::new(quantity(column))).title(look.name);
    let Some(log) = drawn(look, run) else {
        return panel;
    };
    let of_log = |r: &&Reading| r.log == log.spec.file && r.phase == Some(Phase::Pressurizing);
    let far = |r: &Reading| (r.value(PRESSURE) - ZOOM_KPA).abs();
    let nearest = look
        .readings
        .iter()
        .filter(of_log)
        .min_by(|a, b| far(a).total_cmp(&far(b)));
    let Some(reading) = nearest else {
        return panel;
    };
    let time = look.window(reading, TIME);
    let (from, to) = (time[0], time[time.len() - 1]);
    panel
        .with(Layer::windows("", vec![(from, to)]))
        .with(Series::line(
            "",
            points(log, column, from - 0.4, to + 0.1),
            hair(),
        ))
}

/// Shares of both by bins of a width.
fn histogram(label: &str, of: [(&str, Vec<f64>); 2], width: f64, most: f64) -> Panel {
    let mut panel = Panel::new(
        Axis::new(label).fixed(-0.5 * width, most),
        Axis::new("Share (%)").including(0.0),
    )
    .legend(Legend::Auto);
    for ((name, values), (ink, dash)) in of
        .into_iter()
        .zip([(Ink::Black, Dash::Solid), (Ink::Vermilion, Dash::Dashed)])
    {
        let bins = (most / width).ceil() as usize;
        let mut outline = vec![(-0.5 * width, 0.0)];
        for k in 0..bins {
            let (low, high) = ((k as f64 - 0.5) * width, (k as f64 + 0.5) * width);
            let hits = values.iter().filter(|v| (low..high).contains(*v)).count();
            let share = 100.0 * hits as f64 / values.len().max(1) as f64;
            outline.extend([(low, share), (high, share)]);
        }
        panel = panel.with(Series::line(name, outline, Stroke::new(ink, dash)));
    }
    panel
}
