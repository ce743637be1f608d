//! `pipeline check-session`: a session while the actuator is still on the rig.

use crate::args::ResultArgs;
use crate::check_session_words::said;
use crate::columns::{Align, aligned};
use crate::print::{counted, line, print_json};
use crate::{DONE, predict, watch};
use pipeline_base::columns::is_prediction;
use pipeline_base::digest::Digest;
use pipeline_base::error::{Error, Result};
use pipeline_base::frame::Frame;
use pipeline_base::names::file_name;
use pipeline_base::row::{self, Row};
use pipeline_config::Config;
use pipeline_findings::Findings;
use pipeline_inspect::population::{Known, RawFile};
use pipeline_inspect::{Check, Inspection, Seen, State};
use pipeline_report::figures::inspection as drawing;
use pipeline_run::ancestry::Provenance;
use pipeline_run::check_outside;
use pipeline_run::materialize::PROVENANCE;
use std::collections::BTreeMap;
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
    let provenance = read(reports.join(PROVENANCE))?;
    let provenance = provenance
        .and_then(|bytes| pipeline_base::json::from_slice::<Provenance>(&bytes).ok())
        .unwrap_or_default();
    Ok(Known {
        rows: rows.unwrap_or_default(),
        findings,
        fit: config.fit.clone(),
        files: by_contents(provenance),
    })
}

/// The raw files of a run by what is in them.
fn by_contents(provenance: Provenance) -> BTreeMap<Digest, Vec<RawFile>> {
    let mut files: BTreeMap<Digest, Vec<RawFile>> = BTreeMap::new();
    for (session, digests) in provenance.sessions {
        for (file, digest) in digests {
            let session = session.clone();
            files
                .entry(digest)
                .or_default()
                .push(RawFile { session, file });
        }
    }
    files
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
        let more = counted(fine, "more check", "more checks");
        line(format!("  ok    {more} of its logs"));
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
