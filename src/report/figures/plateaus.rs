//! Logs with the steady windows that were found in them: the whole log, and a few seconds of it.

use crate::figures::formatting::verbatim;
use crate::figures::{Composed, Named, compose};
use crate::input::{ReportInput, SessionInput, Trace};
use crate::plot::{Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Mark, Panel, Series, Shape, Stroke};
use pipeline_base::columns::{FORCE, PRESSURE, TIME};
use pipeline_base::names::file_name;
use pipeline_base::row::Row;
use pipeline_base::session::Phase;

/// Time shown in the close-up, s.
const CLOSE_UP_S: f64 = 4.0;

/// One figure for every trace, in their order.
pub fn figures(input: &ReportInput) -> Vec<Option<Composed>> {
    let one = |trace: &Trace| compose(&name(trace), || figure(input, trace));
    input.traces.iter().map(one).collect()
}

fn name(trace: &Trace) -> String {
    format!("plateaus-{}", file_name(&trace.campaign))
}

/// One channel of a log with its readings.
struct Channel<'a> {
    label: &'static str,
    ink: Ink,
    values: &'a [f64],
    readings: Vec<(f64, f64)>,
}

impl Channel<'_> {
    /// The channel over a stretch of time.
    fn panel(&self, time: &[f64], windows: &[(f64, f64)], (low, high): (f64, f64)) -> Panel {
        let inside = |t: f64| (low..=high).contains(&t);
        let within = |points: &mut dyn Iterator<Item = (f64, f64)>| -> Vec<(f64, f64)> {
            points.filter(|(t, _)| inside(*t)).collect()
        };
        let line = within(&mut time.iter().copied().zip(self.values.iter().copied()));
        let means = within(&mut self.readings.iter().copied());
        let windows = windows.iter().copied();
        let windows = windows.filter(|(a, b)| inside(*a) && inside(*b)).collect();
        let mark = Mark::filled(Shape::Circle, Ink::Black).wide(1.0);
        Panel::new(
            Axis::new("Time (s)").fixed(low, high),
            Axis::new(self.label),
        )
        .with(Layer::windows("steady window", windows))
        .with(Series::line(
            "log",
            line,
            Stroke::hair(self.ink, Dash::Solid),
        ))
        .with(Series::marks("reading", means, mark))
    }
}

/// The force of a reading before its zero was subtracted, N.
fn logged_n(reading: &Row) -> f64 {
    let zero = reading.zero_force_n;
    reading.force_n + if zero.is_finite() { zero } else { 0.0 }
}

fn figure(input: &ReportInput, trace: &Trace) -> Option<Named> {
    let time = trace.samples.numbers(TIME)?;
    let of_log = |r: &&Row| r.session == trace.session && r.log == trace.log;
    let readings: Vec<&Row> = input.rows.iter().filter(of_log).collect();
    let of_trace = |s: &&SessionInput| s.ingest.session.id == trace.session;
    let session = input.sessions.iter().find(of_trace)?;
    let pressure = Channel {
        label: "Pressure (kPa)",
        ink: Ink::Vermilion,
        values: trace.samples.numbers(PRESSURE)?,
        readings: readings
            .iter()
            .map(|r| (r.time_s, r.pressure_kpa))
            .collect(),
    };
    let force = Channel {
        label: "Force as logged (N)",
        ink: Ink::Blue,
        values: trace.samples.numbers(FORCE)?,
        readings: readings.iter().map(|r| (r.time_s, logged_n(r))).collect(),
    };
    let windows = windows(session, trace, &readings, time)?;
    let from = close_up(&readings)?;
    let end = time.iter().copied().fold(0.0, f64::max);
    let begin = time.iter().copied().fold(end, f64::min);
    let title = format!("Plateaus of {} {}", trace.session, trace.log);
    let mut figure = Figure::new(&title, DOUBLE_MM, 98.0).grid(2).shared_legend();
    for channel in [pressure, force] {
        figure = figure
            .with(channel.panel(time, &windows, (begin, end)))
            .with(channel.panel(time, &windows, (from, from + CLOSE_UP_S)));
    }
    Some(Named {
        name: name(trace),
        caption: caption(trace, readings.len()),
        figure,
    })
}

fn caption(trace: &Trace, readings: usize) -> String {
    let word = if trace.simulated {
        "Simulated log"
    } else {
        "Log"
    };
    format!(
        "{word} {} of session {} (campaign {}): pressure (A, B) and force (C, D), whole and over {CLOSE_UP_S:.0}\u{a0}s, with the steady \
         windows and their readings, {readings} in all.",
        verbatim(&trace.log),
        verbatim(&trace.session),
        verbatim(&trace.campaign)
    )
}

/// Where the close-up begins: a third of the way from the first reading to the last one of filling.
fn close_up(readings: &[&Row]) -> Option<f64> {
    let first = readings.first()?.time_s;
    let filling = |r: &&&Row| r.phase == Some(Phase::Pressurizing);
    let filled = readings.iter().rfind(filling).map_or(first, |r| r.time_s);
    Some(first + (filled - first) / 3.0)
}

/// Beginning and end of every reading's window.
fn windows(
    session: &SessionInput,
    trace: &Trace,
    readings: &[&Row],
    time: &[f64],
) -> Option<Vec<(f64, f64)>> {
    let header = session
        .ingest
        .logs
        .iter()
        .find(|l| l.spec.name() == trace.log)?;
    let first_line = header.first_line as i64;
    Some(
        readings
            .iter()
            .map(|r| window(r, first_line, time))
            .collect(),
    )
}

/// Beginning and end of a reading's window: its lines in the log are the rows of the samples.
fn window(row: &Row, first_line: i64, time: &[f64]) -> (f64, f64) {
    let at = |line: i64| {
        let index = usize::try_from(line - first_line).unwrap_or(0);
        time.get(index).copied().unwrap_or(f64::NAN)
    };
    (at(row.first_row), at(row.last_row))
}
