//! How alike a simulated log looks to a measured one: the same staircase side by side, with the numbers that make a log.
//!
//! ```text
//! cargo run --release --example look_alike -- --measured ../shared/rig/isometric-10mm-2022-11/l182/c25 --out look.png
//! cargo run --release --example look_alike -- --measured SESSION --simulated truths/simulated-10mm.toml --out look.png
//! ```
//! Without `--simulated` the rig's defaults simulate the session's own actuator, length and runs. With a truth file, its session of
//! nearest resting length and contraction is taken. `--run N` draws another run than the first one of both. The numbers are medians over
//! all steady readings of all runs of a session.

use pipeline::base::columns::{FORCE, LENGTH, PRESSURE, TIME};
use pipeline::base::reading::Reading;
use pipeline::base::session::{Phase, Sampling, Session};
use pipeline::config::CleanOptions;
use pipeline::formats::session_toml;
use pipeline::numerics::statistics::{mean, median, quantile, standard_deviation};
use pipeline::report::plot::{
    Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Legend, Panel, Series, Stroke,
};
use pipeline::report::raster::svg_to_png;
use pipeline::simulate::{read_truth, simulate};
use pipeline::stages::clean::clean;
use pipeline::stages::ingest::{LogSamples, ingest};
use std::path::{Path, PathBuf};

type Failure = Box<dyn std::error::Error>;
/// Names and bytes of a session's files, `session.toml` first.
type Files = Vec<(String, Vec<u8>)>;

/// Pressure near which a plateau is drawn large, kPa.
const ZOOM_KPA: f64 = 300.0;
/// Longest time before a window in which its step began, s.
const STEP_S: f64 = 0.5;
const DPI: f64 = 110.0;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().collect();
    let value = |name: &str| {
        let place = arguments.iter().position(|a| a == name)?;
        arguments.get(place + 1).cloned()
    };
    let usage = "--measured SESSION_DIR [--simulated TRUTH.toml] [--run N] --out FILE.png";
    let folder = PathBuf::from(value("--measured").ok_or(usage)?);
    let out = value("--out").ok_or(usage)?;
    let run = value("--run").map(|n| n.parse::<i64>()).transpose()?;
    let measured = Look::new("measured", &files_of(&folder)?)?;
    let truth = match value("--simulated") {
        Some(path) => std::fs::read_to_string(path)?,
        None => truth_like(&measured.session)?,
    };
    let simulated = simulated(&truth, &measured.session)?;
    println!(
        "measured {}, simulated {}\n",
        measured.session.id, simulated.session.id
    );
    println!("{:<44} {:>10} {:>10}", "", "measured", "simulated");
    for (a, b) in measured.numbers().iter().zip(simulated.numbers()) {
        println!("{:<44} {:>10.3} {:>10.3}", a.0, a.1, b.1);
    }
    let svg = figure([&measured, &simulated], run).to_svg()?;
    std::fs::write(out, svg_to_png(&svg, DPI)?)?;
    Ok(())
}

fn files_of(folder: &Path) -> Result<Files, Failure> {
    let toml = std::fs::read(folder.join("session.toml"))?;
    let session = checked(&toml)?;
    let mut files = vec![("session.toml".to_owned(), toml)];
    for log in &session.logs {
        files.push((log.file.clone(), std::fs::read(folder.join(&log.file))?));
    }
    Ok(files)
}

fn checked(toml: &[u8]) -> Result<Session, Failure> {
    let text = std::str::from_utf8(toml)?;
    session_toml::read("session.toml", text).map_err(|mistakes| format!("{mistakes:?}").into())
}

/// A truth file without effects that measures the session's actuator at its length, on the rig as it is by default.
fn truth_like(session: &Session) -> Result<String, Failure> {
    let specimen = &session.specimen;
    let (rest, least) = (specimen.rest_length_m, specimen.contracted_length_m);
    let runs: Vec<String> = session
        .logs
        .iter()
        .filter(|l| !l.is_zero)
        .zip(1..)
        .map(|(l, k)| l.run.unwrap_or(k).to_string())
        .collect();
    Ok(format!(
        "schema = \"bpa-truth/1\"\ncampaign = \"look-alike\"\nseed = 1\ndiameter_mm = {}\ncoefficients = \"published\"\n\
         contractions = [{:.4}]\nruns = [{}]\nsampling = \"timeseries\"\n\
         [[specimen]]\nid = \"look-alike\"\nrest_length_mm = {:.2}\ncontraction_max = {:.5}\n",
        specimen.diameter_mm,
        (rest - length(session)?) / (rest - least),
        runs.join(", "),
        1e3 * rest,
        (rest - least) / rest,
    ))
}

fn length(session: &Session) -> Result<f64, Failure> {
    let length = session.setup_number(LENGTH);
    length.ok_or_else(|| "a session whose length is held".into())
}

/// The session of a truth file that is most like another.
fn simulated(truth: &str, like: &Session) -> Result<Look, Failure> {
    let truth = read_truth("truth file", truth).map_err(|mistakes| format!("{mistakes:?}"))?;
    if truth.sampling != Sampling::Timeseries {
        return Err("a truth file with sampling = \"timeseries\"".into());
    }
    let campaign = simulate(&truth);
    let wanted = [like.specimen.rest_length_m, length(like)?];
    let mut best: Option<(f64, &Files)> = None;
    for candidate in &campaign.sessions {
        let session = checked(&candidate.files[0].1)?;
        let lengths = [session.specimen.rest_length_m, length(&session)?];
        let far = (lengths[0] - wanted[0]).abs() + (lengths[1] - wanted[1]).abs();
        if best.is_none_or(|(least, _)| far < least) {
            best = Some((far, &candidate.files));
        }
    }
    Look::new("simulated", best.ok_or("a truth file with a session")?.1)
}

/// A session with its samples and steady readings.
struct Look {
    name: &'static str,
    session: Session,
    logs: Vec<LogSamples>,
    readings: Vec<Reading>,
}

impl Look {
    fn new(name: &'static str, files: &Files) -> Result<Self, Failure> {
        let session = checked(&files[0].1)?;
        let bytes = |log: &str| files.iter().find(|(name, _)| name == log);
        let logs = session
            .logs
            .iter()
            .map(|l| Ok(bytes(&l.file).map(|(_, b)| b.clone()).unwrap_or_default()))
            .collect();
        let logs = ingest(&session, name, logs).logs;
        let readings = clean(&session, &logs, &CleanOptions::default()).readings;
        Ok(Self {
            name,
            session,
            logs,
            readings,
        })
    }

    fn measuring(&self) -> impl Iterator<Item = &LogSamples> {
        self.logs.iter().filter(|l| !l.spec.is_zero)
    }

    fn log(&self, file: &str) -> &LogSamples {
        let own = self.logs.iter().find(|l| l.spec.file == file);
        own.unwrap_or(&self.logs[0])
    }

    /// The samples of a reading's window.
    fn window<'a>(&'a self, r: &Reading, column: &str) -> &'a [f64] {
        let log = self.log(&r.log);
        let place = |line: i64| (line - log.first_line as i64).max(0) as usize;
        let values = log.column(column).unwrap_or_default();
        &values[place(r.first_row)..=place(r.last_row).min(values.len() - 1)]
    }

    /// The samples between a reading's step and its window.
    fn step<'a>(&'a self, r: &Reading, column: &str) -> &'a [f64] {
        let log = self.log(&r.log);
        let time = log.column(TIME).unwrap_or_default();
        let end = (r.first_row - log.first_line as i64).max(0) as usize;
        let start = time.partition_point(|t| *t < time[end] - STEP_S);
        &log.column(column).unwrap_or_default()[start.min(end)..end]
    }

    fn spacings_ms(&self) -> Vec<f64> {
        let spacing = |log: &LogSamples| -> Vec<f64> {
            let time = log.column(TIME).unwrap_or_default();
            time.windows(2).map(|w| 1e3 * (w[1] - w[0])).collect()
        };
        self.measuring().flat_map(spacing).collect()
    }

    /// Change along a window, per second.
    fn slope(&self, r: &Reading, column: &str) -> f64 {
        let (time, values) = (self.window(r, TIME), self.window(r, column));
        let (t0, v0) = (mean(time), mean(values));
        let products = time.iter().zip(values).map(|(t, v)| (t - t0) * (v - v0));
        let squares = time.iter().map(|t| (t - t0) * (t - t0));
        products.sum::<f64>() / squares.sum::<f64>()
    }

    fn of(&self, phase: Phase, number: impl Fn(&Reading) -> f64) -> Vec<f64> {
        let own = self.readings.iter().filter(|r| r.phase == Some(phase));
        own.map(number).collect()
    }

    fn all(&self, number: impl Fn(&Reading) -> f64) -> Vec<f64> {
        self.readings.iter().map(number).collect()
    }

    /// What a log is made of, in the order in which it is printed.
    fn numbers(&self) -> Vec<(&'static str, f64)> {
        let spacings = self.spacings_ms();
        let share = |ms: f64| {
            let hits = spacings.iter().filter(|s| (*s - ms).abs() < 0.1).count();
            100.0 * hits as f64 / spacings.len() as f64
        };
        let runs = self.measuring().count() as f64;
        let count = |phase| self.of(phase, |_| 1.0).len() as f64 / runs;
        let up = Phase::Pressurizing;
        let over = |r: &Reading, column| {
            let peak = self
                .step(r, column)
                .iter()
                .copied()
                .fold(f64::NAN, f64::max);
            peak - mean(self.window(r, column))
        };
        let raw = |column: &str| -> Vec<f64> {
            let values = self.measuring().filter_map(|l| l.column(column));
            values
                .flatten()
                .copied()
                .filter(|x| x.is_finite())
                .collect()
        };
        let zero = |column| {
            let logs = self.logs.iter().filter(|l| l.spec.is_zero);
            logs.filter_map(|l| l.column(column))
                .flatten()
                .copied()
                .filter(|x| x.is_finite())
                .collect::<Vec<f64>>()
        };
        let levels = self.of(up, |r| r.value(PRESSURE));
        let steps: Vec<f64> = levels.windows(2).map(|w| w[1] - w[0]).collect();
        let rising: Vec<f64> = steps.into_iter().filter(|s| *s > 0.0).collect();
        let sd =
            |column: &'static str| move |r: &Reading| standard_deviation(self.window(r, column));
        vec![
            ("rows a run", raw(TIME).len() as f64 / runs),
            ("mean spacing of samples (ms)", mean(&spacings)),
            ("  spacings of 0 ms (%)", share(0.0)),
            ("  of 1 ms (%)", share(1.0)),
            ("  of 2 ms (%)", share(2.0)),
            ("  of 3 ms (%)", share(3.0)),
            ("step of the force converter (N)", quantum(&raw(FORCE))),
            (
                "step of the pressure converter (kPa)",
                quantum(&raw(PRESSURE)),
            ),
            ("plateaus a run, filling", count(up)),
            ("plateaus a run, venting", count(Phase::Depressurizing)),
            ("step of pressure, filling (kPa)", median(&rising)),
            ("highest plateau (kPa)", quantile(&levels, 1.0)),
            ("sd of force on a plateau (N)", median(&self.all(sd(FORCE)))),
            ("  its 90% quantile", quantile(&self.all(sd(FORCE)), 0.9)),
            (
                "sd of pressure on a plateau (kPa)",
                median(&self.all(sd(PRESSURE))),
            ),
            ("  its 90% quantile", quantile(&self.all(sd(PRESSURE)), 0.9)),
            (
                "correlation of neighbouring samples' force",
                median(&self.all(|r| neighbours(self.window(r, FORCE)))),
            ),
            (
                "overshoot of pressure, filling (kPa)",
                median(&self.of(up, |r| over(r, PRESSURE))),
            ),
            (
                "  its 90% quantile",
                quantile(&self.of(up, |r| over(r, PRESSURE)), 0.9),
            ),
            (
                "overshoot of force, filling (N)",
                median(&self.of(up, |r| over(r, FORCE))),
            ),
            (
                "  its 90% quantile",
                quantile(&self.of(up, |r| over(r, FORCE)), 0.9),
            ),
            (
                "drift of pressure, filling (kPa/s)",
                median(&self.of(up, |r| self.slope(r, PRESSURE))),
            ),
            (
                "drift of pressure, venting (kPa/s)",
                median(&self.of(Phase::Depressurizing, |r| self.slope(r, PRESSURE))),
            ),
            (
                "drift of force, filling (N/s)",
                median(&self.of(up, |r| self.slope(r, FORCE))),
            ),
            (
                "drift of force, venting (N/s)",
                median(&self.of(Phase::Depressurizing, |r| self.slope(r, FORCE))),
            ),
            ("zero log: force (N)", mean(&zero(FORCE))),
            (
                "zero log: sd of force (N)",
                standard_deviation(&zero(FORCE)),
            ),
            ("zero log: pressure (kPa)", mean(&zero(PRESSURE))),
        ]
    }
}

/// The usual distance between neighbouring levels.
fn quantum(values: &[f64]) -> f64 {
    let mut levels = values.to_vec();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let steps: Vec<f64> = levels.windows(2).map(|w| w[1] - w[0]).collect();
    median(&steps)
}

/// Correlation of each sample with the one before it.
fn neighbours(values: &[f64]) -> f64 {
    let middle = mean(values);
    let products = values.windows(2).map(|w| (w[0] - middle) * (w[1] - middle));
    let squares = values.iter().map(|v| (v - middle) * (v - middle));
    products.sum::<f64>() / squares.sum::<f64>()
}

fn figure(looks: [&Look; 2], run: Option<i64>) -> Figure {
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
