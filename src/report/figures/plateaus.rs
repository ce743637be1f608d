//! Logs with the steady windows that were found in them: the whole log, and a few seconds of it.

use crate::base::columns::{FORCE, PRESSURE, TIME};
use crate::base::names::file_name;
use crate::base::row::Row;
use crate::base::session::Phase;
use crate::report::figures::Named;
use crate::report::input::{ReportInput, Trace};
use crate::report::plot::{
    Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Mark, Panel, Series, Shape, Stroke,
};

/// Time shown in the close-up, s.
const CLOSE_UP_S: f64 = 4.0;

/// One figure for every trace.
pub fn figures(input: &ReportInput) -> Vec<Named> {
    input
        .traces
        .iter()
        .filter_map(|trace| figure(input, trace))
        .collect()
}

fn figure(input: &ReportInput, trace: &Trace) -> Option<Named> {
    let time = trace.samples.numbers(TIME)?;
    let columns = [
        (
            trace.samples.numbers(PRESSURE)?,
            "Pressure (kPa)",
            Ink::Vermilion,
        ),
        (
            trace.samples.numbers(FORCE)?,
            "Force as logged (N)",
            Ink::Blue,
        ),
    ];
    let readings: Vec<&Row> = input
        .rows
        .iter()
        .filter(|r| r.session == trace.session && r.log == trace.log)
        .collect();
    let session = input
        .sessions
        .iter()
        .find(|s| s.ingest.session.id == trace.session)?;
    let first_line = session
        .ingest
        .logs
        .iter()
        .find(|l| l.spec.file == trace.log)?
        .first_line as i64;
    let zero = session.clean.zero.as_ref().map_or(0.0, |z| z.applied_n);
    let spans: Vec<(f64, f64)> = readings
        .iter()
        .map(|r| window(r, first_line, time))
        .collect();
    let first = readings.first()?.time_s;
    let filled = readings
        .iter()
        .rfind(|r| r.phase == Some(Phase::Pressurizing))
        .map_or(first, |r| r.time_s);
    let from = first + 0.35 * (filled - first);
    let whole = (
        time.iter().copied().fold(f64::INFINITY, f64::min),
        time.iter().copied().fold(0.0, f64::max),
    );
    let mut figure = Figure::new(
        &format!("Plateaus of {} {}", trace.session, trace.log),
        DOUBLE_MM,
        105.0,
    )
    .grid(2)
    .shared_legend();
    for (values, label, ink) in columns {
        for (low, high) in [whole, (from, from + CLOSE_UP_S)] {
            let inside = |t: &f64| (low..=high).contains(t);
            let line: Vec<(f64, f64)> = time
                .iter()
                .copied()
                .zip(values.iter().copied())
                .filter(|(t, _)| inside(t))
                .collect();
            let means = readings.iter().filter(|r| inside(&r.time_s)).map(|r| {
                let value = if ink == Ink::Vermilion {
                    r.pressure_kpa
                } else {
                    r.force_n + zero
                };
                (r.time_s, value)
            });
            let windows = spans
                .iter()
                .copied()
                .filter(|(a, b)| inside(a) && inside(b))
                .collect();
            let panel = Panel::new(Axis::new("Time (s)").fixed(low, high), Axis::new(label))
                .with(Layer::windows("steady window", windows))
                .with(Series::line("log", line, Stroke::hair(ink, Dash::Solid)))
                .with(Series::marks(
                    "reading",
                    means.collect(),
                    Mark::filled(Shape::Circle, Ink::Black).wide(1.0),
                ));
            figure = figure.with(panel);
        }
    }
    let word = if trace.simulated {
        "Simulated log"
    } else {
        "Log"
    };
    let caption = format!(
        "{word} {} of session {} (campaign {}): pressure (A, B) and force (C, D), whole and over {CLOSE_UP_S:.0} s, with the steady \
         windows and their readings. {} of its stretches gave a reading.",
        trace.log,
        trace.session,
        trace.campaign,
        readings.len()
    );
    Some(Named {
        name: format!("plateaus-{}", file_name(&trace.campaign)),
        caption,
        figure,
    })
}

/// Beginning and end of a reading's window: its lines in the log are the rows of the samples.
fn window(row: &Row, first_line: i64, time: &[f64]) -> (f64, f64) {
    let at = |line: i64| {
        let index = usize::try_from(line - first_line).unwrap_or(0);
        time.get(index).copied().unwrap_or(f64::NAN)
    };
    (at(row.first_row), at(row.last_row))
}
