//! `pipeline check-session`: a session while the actuator is still on the rig.

use crate::args::ResultArgs;
use crate::columns::{Align, aligned};
use crate::print::{line, print_json};
use crate::{DONE, doubts, predict, watch};
use pipeline_base::columns::is_prediction;
use pipeline_base::error::{Error, Result};
use pipeline_base::frame::Frame;
use pipeline_base::names::file_name;
use pipeline_base::row::{self, Row};
use pipeline_config::Config;
use pipeline_findings::{ErrorKind, Findings};
use pipeline_inspect::otherwise::Otherwise;
use pipeline_inspect::population::Known;
use pipeline_inspect::{Check, Inspection, NotCompared, Noted, Own, Seen, State};
use pipeline_report::figures::inspection as drawing;
use pipeline_report::wording::name;
use pipeline_report::wording::number::{percent, with_unit};
use pipeline_report::wording::sentence::recorded_size;
use pipeline_run::check_outside;
use std::path::{Path, PathBuf};

/// Arguments of `check-session`.
#[derive(Debug, clap::Args)]
pub struct CheckSessionArgs {
    /// The session folder, or a folder above several
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Check each log of the session as it arrives, until Ctrl-C
    #[arg(long, conflicts_with = "json")]
    pub watch: bool,
    /// With --watch: stop after this many logs
    #[arg(long, value_name = "N", requires = "watch")]
    pub logs: Option<usize>,
    /// Plot the readings with their expected values into this folder, one file per session or log
    #[arg(long, value_name = "DIR")]
    pub plot: Option<PathBuf>,
    /// Where an earlier run left its results
    #[command(flatten)]
    pub results: ResultArgs,
    /// Print everything as JSON
    #[arg(long)]
    pub json: bool,
}

/// Exit codes: something to look at; something that cannot be used.
const LOOK: u8 = 1;
const BAD: u8 = 2;

/// Checks, and prints one line a check.
pub fn command(args: &CheckSessionArgs) -> Result<u8> {
    let places = args.results.places()?;
    places.check_outside_raw(args.plot.as_deref(), "--plot")?;
    if let Some(plot) = &args.plot {
        check_outside(&args.folder, plot, "--plot")?;
    }
    let known = known(&places.derived, &places.reports, &places.config)?;
    let named = args
        .results
        .cache
        .derived
        .as_ref()
        .or(args.results.reports.as_ref());
    if let (Some(named), true) = (named, known.is_empty()) {
        return Err(Error::Usage(format!(
            "there are no results of a run in {}; omit --derived and --reports to compare with the published law",
            named.display()
        )));
    }
    if args.watch {
        return watch::command(args, &places.config, &known);
    }
    let all = pipeline_inspect::sessions(&args.folder, &places.config, &known);
    if all.is_empty() {
        return Err(Error::Usage(format!(
            "there is no session.toml in {} or below it; `pipeline new-session LOG --out {}` begins one",
            args.folder.display(),
            args.folder.display()
        )));
    }
    for found in &all {
        draw(args, &found.session, found)?;
    }
    if args.json {
        print_json(&serde_json::to_value(&all).map_err(Error::internal)?)?;
    } else {
        all.iter().for_each(print);
        if all.len() > 1 {
            print_count(&all);
        }
    }
    let worst = all.iter().map(Inspection::state).max();
    Ok(exit_code(worst.unwrap_or(State::Fine)))
}

/// The exit code of a state.
pub(super) fn exit_code(state: State) -> u8 {
    match state {
        State::Fine => DONE,
        State::Look => LOOK,
        State::Bad => BAD,
    }
}

/// What the last run knows; nothing where there was none.
pub(super) fn known(derived: &Path, reports: &Path, config: &Config) -> Result<Known> {
    let read = |path: PathBuf| match std::fs::read(&path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(e) => Err(Error::io("read", &path)(e)),
    };
    let rows = read(derived.join("rows.parquet"))?;
    let rows = rows.map(|bytes| rows_of(&bytes)).transpose()?;
    let findings = read(reports.join("findings.json"))?;
    let findings =
        findings.and_then(|bytes| pipeline_base::json::from_slice::<Findings>(&bytes).ok());
    Ok(Known {
        rows: rows.unwrap_or_default(),
        findings,
        fit: config.fit.clone(),
    })
}

/// The rows of `rows.parquet`, without what models say of them.
fn rows_of(bytes: &[u8]) -> Result<Vec<Row>> {
    let mut frame = Frame::from_parquet(bytes)?;
    frame.columns.retain(|(name, _)| !is_prediction(name));
    row::from_frame(&frame)
}

/// Draws the readings, where that was asked for and there are any.
pub(super) fn draw(args: &CheckSessionArgs, name: &str, found: &Inspection) -> Result<()> {
    let Some(folder) = &args.plot else {
        return Ok(());
    };
    let points = found.expected.iter();
    let points: Vec<drawing::Point> = points
        .map(|e| [e.pressure_kpa, e.force_n, e.law_n, e.own_n])
        .collect();
    let Some(figure) = drawing::figure(name, &points) else {
        return Ok(());
    };
    std::fs::create_dir_all(folder).map_err(Error::io("create", folder))?;
    predict::draw(&folder.join(format!("{}.svg", file_name(name))), figure)
}

/// One session: what stands out, and how many checks are fine.
fn print(found: &Inspection) {
    line(format!("{}: {}", found.session, word(found.state())));
    let shown: Vec<&Check> = found.checks.iter().filter(|c| is_shown(c)).collect();
    let rows: Vec<Vec<String>> = shown
        .iter()
        .map(|c| {
            vec![
                format!("  {}", word(c.state)),
                c.log.clone().unwrap_or_default(),
                said(&c.seen),
            ]
        })
        .collect();
    for text in aligned(&rows, &[Align::Left; 3]) {
        line(text.trim_end());
    }
    let fine = found.checks.len() - shown.len();
    if fine > 0 {
        line(format!("  ok    {fine} more checks of its logs"));
    }
    if let Some(against) = &found.against {
        line(format!("  compared with {against}"));
    }
}

/// What stands out, and what is said of the session as a whole.
fn is_shown(check: &Check) -> bool {
    check.state != State::Fine || check.log.is_none()
}

/// One log in a line: its state, the readings, and what stands out.
pub(super) fn in_a_line(log: &str, found: &Inspection) -> String {
    let out = found.checks.iter().filter(|c| c.state != State::Fine);
    let out: Vec<String> = out.map(|c| said(&c.seen)).collect();
    let out = if out.is_empty() {
        let whole = found.checks.iter().filter(|c| c.log.is_none());
        let own = whole.filter(|c| matches!(c.seen, Seen::Gain { .. } | Seen::SetLength { .. }));
        own.map(|c| said(&c.seen)).collect()
    } else {
        out
    };
    format!(
        "{:<4}  {log}: {} readings; {}",
        word(found.state()),
        found.expected.len(),
        out.join("; ")
    )
}

fn print_count(all: &[Inspection]) {
    let count = |state: State| all.iter().filter(|i| i.state() == state).count();
    line(format!(
        "\n{} sessions: {} ok, {} to look at, {} that cannot be used as they are",
        all.len(),
        count(State::Fine),
        count(State::Look),
        count(State::Bad)
    ));
}

fn word(state: State) -> &'static str {
    match state {
        State::Fine => "ok",
        State::Look => "look",
        State::Bad => "BAD",
    }
}

/// A check in words.
fn said(seen: &Seen) -> String {
    let newtons = |x: f64| with_unit(&format!("{x:.1}"), "N").replace('\u{a0}', " ");
    let deviations = |value: f64, sd: f64| format!("{:.1} standard deviations", value / sd);
    match seen {
        Seen::Description { message } => message.clone(),
        Seen::LeftOut { reason } => format!("the log is left out: {reason}"),
        Seen::Rows {
            rows,
            left_out,
            reason,
        } => {
            let why = reason
                .as_ref()
                .map_or_else(String::new, |r| format!(", most: {r}"));
            format!("{left_out} of {rows} rows are not measurements{why}")
        }
        Seen::Clipping { share, at_pressure } => format!(
            "{} of the samples of the force are at the limit of the converter, {} of those at high pressure",
            percent(*share),
            percent(*at_pressure)
        ),
        Seen::FlatTop { at_n, samples } => format!(
            "the force stays at its highest value, {}, for {samples} samples in a row: it looks cut off by the amplifier or the converter",
            newtons(*at_n)
        ),
        Seen::Clock {
            step_s, gaps: 0, ..
        } => format!("a sample every {:.3} ms, none missing", 1e3 * step_s),
        Seen::Clock {
            step_s,
            gaps,
            longest_s,
        } => format!(
            "samples are missing in {gaps} places, for {longest_s:.2} s at most (normally one every {:.1} ms)",
            1e3 * step_s
        ),
        Seen::Plateaus { steady, unsettled } => format!(
            "{steady} settled plateaus, {unsettled} in which pressure or force still drifts"
        ),
        Seen::Zero {
            source,
            applied_n,
            clipped,
            slack_n,
        } => zero(source, *applied_n, *clipped, *slack_n),
        Seen::ZeroOfOthers {
            applied_n,
            usual_n,
            deviations,
            sessions,
        } => format!(
            "a zero of {}; the median of {sessions} other sessions is {} ({deviations:.1} standard deviations)",
            newtons(*applied_n),
            newtons(*usual_n)
        ),
        Seen::Gain {
            value,
            sd,
            by_law,
            others,
        } => relative(
            ("specimen gain", &format!("{:+.1}%", 100.0 * value)),
            &deviations(*value, *sd),
            (
                *others,
                &format!("{:+.1}% relative to the law", 100.0 * by_law),
            ),
        ),
        Seen::SetLength {
            value_mm,
            sd_mm,
            by_law_mm,
            others,
        } => relative(
            ("set length", &format!("{value_mm:+.2} mm")),
            &deviations(*value_mm, *sd_mm),
            (
                *others,
                &format!("{by_law_mm:+.2} mm from the one noted, by the law"),
            ),
        ),
        Seen::Misfit { rms_n, usual_n } => format!(
            "residual {} (root mean square); typically {}",
            newtons(*rms_n),
            newtons(*usual_n)
        ),
        Seen::Mistake { error } => {
            let size = recorded_size(error).map_or_else(String::new, |s| format!(" ({s})"));
            format!(
                "looks like a recording error: {}{}",
                name::recording_error(error.kind, error.quantity.as_deref()),
                size.replace('\u{a0}', " ")
            )
        }
        Seen::Copy { of } => format!("the same bytes as {of}"),
        Seen::Otherwise {
            what,
            here_mm,
            others_mm,
        } => {
            let (quantity, of) = noted(*what);
            format!(
                "{quantity} is noted as {here_mm:.1} mm, and as {others_mm:.1} mm in other sessions of the {of}"
            )
        }
        Seen::NotTold { quantity } => format!(
            "the readings do not determine {}",
            match quantity {
                Own::SpecimenGain => "the specimen gain",
                Own::SetLength => "whether the set length is the one noted",
            }
        ),
        Seen::Columns {
            otherwise,
            readings,
            rms_n,
            usual_n,
        } => format!(
            "{}: {readings} readings would then agree with others, residual {}; typically {}",
            described(otherwise),
            newtons(*rms_n),
            newtons(*usual_n)
        ),
        Seen::Stretched(stretched) => format!(
            "{}; an actuator bears 3%: check both lengths and their units",
            doubts::in_words(stretched)
        ),
        Seen::Excluded { why } => format!("excluded from every fit in session.toml: {why}"),
        Seen::NotCompared { why } => not_compared(*why).to_owned(),
    }
}

/// A quantity of the session beside those of others, and what it is by the law alone.
fn relative(
    (quantity, value): (&str, &str),
    deviations: &str,
    (others, by_law): (usize, &str),
) -> String {
    match others {
        0 => format!("{quantity} {by_law}: {deviations}"),
        n => format!(
            "{quantity} {value} from the median of {n} other sessions: {deviations} ({by_law})"
        ),
    }
}

/// A quantity that other sessions share, and whose sessions they are.
fn noted(what: Noted) -> (&'static str, &'static str) {
    match what {
        Noted::RestLength => ("the resting length of the specimen", "specimen"),
        Noted::ContractedLength => ("the contracted length of the specimen", "specimen"),
        Noted::Diameter => ("the diameter", "campaign"),
    }
}

fn not_compared(why: NotCompared) -> &'static str {
    match why {
        NotCompared::NoReadings => "no reading to compare with other actuators",
        NotCompared::NoLogs => "its logs are missing: there is nothing to check",
        NotCompared::Torque => "torques are not compared with other actuators",
        NotCompared::NoLaw => {
            "no law is known for this diameter: not compared with other actuators"
        }
    }
}

/// Another description of the columns, as a message.
pub(super) fn described(otherwise: &Otherwise) -> String {
    let column = otherwise.column.as_deref();
    let column = column.map_or_else(String::new, name::column);
    match (otherwise.kind, &otherwise.units) {
        (ErrorKind::SwappedColumns, _) => {
            "force and pressure look exchanged in [columns]".to_owned()
        }
        (_, Some((noted, looks))) => {
            format!("the unit of the {column} looks like {looks}, not {noted}")
        }
        _ => format!("the sign of the {column} looks wrong (gain in [columns])"),
    }
}

fn zero(source: &str, applied_n: f64, clipped: Option<f64>, slack_n: Option<f64>) -> String {
    let from = match source {
        "zero-log" => "from the zero log",
        "slack" => "from the slack actuator",
        "clipped-zero-log" => "the limit of a clipped zero log",
        _ => "none: no zero log, and the actuator is never slack",
    };
    let clipped = clipped
        .filter(|share| *share > 0.0)
        .map_or_else(String::new, |share| {
            format!(
                "; {} of the zero log is at the limit of the converter",
                percent(share)
            )
        });
    let slack = slack_n.map_or_else(String::new, |n| {
        format!("; the slack actuator shows {n:.1} N")
    });
    format!("zero of the force {applied_n:.1} N, {from}{clipped}{slack}")
}
