#![warn(missing_docs)]
#![deny(clippy::print_stderr, clippy::print_stdout, clippy::dbg_macro)]
//! One session by itself: whether its logs are whole, its readings settled, its zero right, and whether they suit what other actuators of the
//! diameter did.
//!
//! The stages ingest, clean and normalize are the same functions that a run calls, so that what is called steady here is steady there. Nothing is
//! written and no cache is read: it takes seconds, while the actuator is still on the rig.
//!
//! | module | asks |
//! |---|---|
//! | [`logs`] | of each log: can it be read, rows left out, samples at the converter's limit, samples that are missing, plateaus that never settled |
//! | [`zero`] | the zero of the force: whether it contradicts the slack actuator, and whether it is like those of other sessions |
//! | [`population`] | the readings against a law and the scatter of other actuators: gain, set length, what is left; recording errors |
//! | [`otherwise`] | where they do not suit: whether they would with exchanged columns, another unit or sign |
//! | [`plausible`] | the readings against the published law alone: what no actuator does, for a run, which may have nothing else to compare with |

pub mod logs;
pub mod otherwise;
pub mod plausible;
pub mod population;
pub mod zero;

use otherwise::Otherwise;
use pipeline_base::diagnostics::{Diagnostic, Severity};
use pipeline_base::digest::Digest;
use pipeline_base::row::Row;
use pipeline_base::session::{Kind, LogSpec, Session};
use pipeline_clean::Cleaned;
use pipeline_config::Config;
use pipeline_findings::RecordingError;
use pipeline_fit::zeros::with_zeros_of_run;
use pipeline_formats::discover::{Located, discover};
use pipeline_formats::log_file;
use pipeline_ingest::{Ingested, LogBytes};
use plausible::{Phases, Stretched};
use population::{Known, Suit};
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;

/// How a check came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// Nothing stands out.
    Fine,
    /// Somebody should look before the actuator is off the rig.
    Look,
    /// It cannot be used as it is.
    Bad,
}

/// One check: of what, of which log, and how it came out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// The log; none of the session as a whole.
    pub log: Option<String>,
    /// How it came out.
    pub state: State,
    /// What was found.
    #[serde(flatten)]
    pub seen: Seen,
}

/// What a check found. Shares are of 1, forces in N, lengths in mm, times in s.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "check", rename_all = "snake_case")]
pub enum Seen {
    /// `session.toml` or a log that cannot be read, or says what cannot be.
    Description {
        /// The message.
        message: String,
    },
    /// A log that was left out whole.
    LeftOut {
        /// Why.
        reason: String,
    },
    /// The bytes are those of another log.
    Copy {
        /// The other log.
        of: String,
        /// The session whose log that is; none where it is one of this session.
        session: Option<String>,
    },
    /// The last run has the specimen or campaign otherwise.
    Otherwise {
        /// What is noted differently.
        what: Noted,
        /// Here: mm.
        here_mm: f64,
        /// In the other sessions: mm.
        others_mm: f64,
    },
    /// Rows that are no measurements.
    Rows {
        /// All rows of the log.
        rows: usize,
        /// Those left out.
        left_out: u64,
        /// Why most of them were.
        reason: Option<String>,
    },
    /// Samples of the force at the converter's limit.
    Clipping {
        /// Their share.
        share: f64,
        /// Their share of the samples at high pressure.
        at_pressure: f64,
    },
    /// The highest force of a log stands still for longer than any other.
    FlatTop {
        /// That force, before the zero is subtracted.
        at_n: f64,
        /// Samples in a row.
        samples: usize,
    },
    /// The highest pressure of a log stands still for longer than any other.
    PressureFlatTop {
        /// That pressure.
        at_kpa: f64,
        /// Samples in a row.
        samples: usize,
    },
    /// The clock of a time series.
    Clock {
        /// Usual time from sample to sample.
        step_s: f64,
        /// Places where samples are missing.
        gaps: usize,
        /// The longest of them.
        longest_s: f64,
    },
    /// Steady plateaus.
    Plateaus {
        /// Those that became readings.
        steady: usize,
        /// Those in which pressure or force still drifted.
        unsettled: usize,
    },
    /// The zero of the force.
    Zero {
        /// Where it comes from, as tables name it.
        source: &'static str,
        /// What was taken off.
        applied_n: f64,
        /// Share of the zero log at the converter's limit.
        clipped: Option<f64>,
        /// What the slack actuator shows.
        slack_n: Option<f64>,
    },
    /// The zero of the force beside those of other sessions of the campaign.
    ZeroOfOthers {
        /// What was taken off here.
        applied_n: f64,
        /// Their median.
        usual_n: f64,
        /// How far it is off, in their standard deviations.
        deviations: f64,
        /// How many there are.
        sessions: usize,
    },
    /// The gain of the actuator beside that of others.
    Gain {
        /// Relative, less the median of the other sessions.
        value: f64,
        /// Standard deviation of those of others.
        sd: f64,
        /// Relative to the law itself.
        by_law: f64,
        /// Other sessions of which the median is; none where `value` is relative to the law.
        others: usize,
    },
    /// The length at which the readings were taken, less the one noted.
    SetLength {
        /// mm, less the median of the other sessions.
        value_mm: f64,
        /// Standard deviation of those of other sessions, mm.
        sd_mm: f64,
        /// By the law itself, mm.
        by_law_mm: f64,
        /// See `Gain`.
        others: usize,
    },
    /// What is left beside gain and set length.
    Misfit {
        /// Root mean square, N.
        rms_n: f64,
        /// What is usual, N.
        usual_n: f64,
    },
    /// Specimen gain or set length: the readings hardly tell it.
    NotTold {
        /// Which.
        quantity: Own,
    },
    /// The readings do not suit others, and would if the columns of the logs were described otherwise.
    Columns {
        /// How.
        otherwise: Otherwise,
        /// Readings that there are then.
        readings: usize,
        /// What is then left beside gain, set length and zero, root mean square, N.
        rms_n: f64,
        /// What is usual, N.
        usual_n: f64,
    },
    /// The lengths noted stretch the actuator.
    Stretched(Stretched),
    /// Pressure goes the other way than the states of the phase say.
    Phases(Phases),
    /// The session is kept out of fits.
    Excluded {
        /// Why, as `session.toml` has it.
        why: String,
    },
    /// The readings look as if something were noted wrongly.
    Mistake {
        /// What.
        error: RecordingError,
    },
    /// The readings were held against nothing.
    NotCompared {
        /// Why.
        why: NotCompared,
    },
}

/// What other sessions of a specimen or campaign share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Noted {
    /// Resting length of the specimen.
    RestLength,
    /// Its length at 620 kPa.
    ContractedLength,
    /// Diameter of the actuators of the campaign.
    Diameter,
}

/// What is a session's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Own {
    /// The gain of the actuator.
    SpecimenGain,
    /// The set length.
    SetLength,
}

/// Why readings were held against nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NotCompared {
    /// There are none.
    NoReadings,
    /// There are none, for none of its logs is there.
    NoLogs,
    /// They are torques.
    Torque,
    /// No law is known of the diameter.
    NoLaw,
}

/// What was found of a session.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspection {
    /// Id of the session; its folder where it has none.
    pub session: String,
    /// The checks, in the order in which they were made.
    pub checks: Vec<Check>,
    /// Against what the readings were held; none where they were not.
    pub against: Option<String>,
    /// The readings with what the law expects of them.
    #[serde(skip)]
    pub expected: Vec<population::Expected>,
}

impl Inspection {
    /// The worst of its checks.
    pub fn state(&self) -> State {
        let states = self.checks.iter().map(|c| c.state);
        states.max().unwrap_or(State::Fine)
    }
}

/// The sessions in a folder or below it. `known`: what a run knows of others.
pub fn sessions(folder: &Path, config: &Config, known: &Known) -> Vec<Inspection> {
    let found = discover(&[folder.to_path_buf()]);
    // The one session whose folder this is has no path below it.
    let named = |relative: &str| match relative {
        "." | "" => folder
            .file_name()
            .unwrap_or(folder.as_os_str())
            .to_string_lossy()
            .into_owned(),
        _ => relative.to_owned(),
    };
    let unusable = found.unusable.iter().map(|u| Inspection {
        session: named(&u.relative),
        checks: placed(folder, &u.diagnostics)
            .iter()
            .map(described)
            .collect(),
        against: None,
        expected: Vec::new(),
    });
    let usable = found.sessions.par_iter();
    let usable: Vec<Inspection> = usable.map(|s| session(s, config, known)).collect();
    unusable.chain(usable).collect()
}

/// One session with all its logs.
pub fn session(located: &Located, config: &Config, known: &Known) -> Inspection {
    inspect(located, &located.session, config, known)
}

/// One log of a session, described as the others of it are where `session.toml` does not name it, with the zero log that it names.
pub fn log(located: &Located, file: &str, config: &Config, known: &Known) -> Inspection {
    let mut session = located.session.clone();
    let own = session.logs.iter().find(|l| l.file == file).cloned();
    let own = own.unwrap_or(LogSpec {
        file: file.to_owned(),
        part: None,
        is_zero: false,
        run: None,
    });
    session.logs.retain(|l| l.is_zero && l.file != own.file);
    session.logs.push(own);
    inspect(located, &session, config, known)
}

/// The readings of the sessions in a folder or below it, as a run with those that are known would have them, and the folders that cannot be read.
pub fn readings(folder: &Path, config: &Config, known: &Known) -> (Vec<Row>, Vec<Diagnostic>) {
    let found = discover(&[folder.to_path_buf()]);
    let rows = found
        .sessions
        .iter()
        .flat_map(|l| rows(l, config))
        .collect();
    let rows = with_zeros_of_run(rows, &known.rows, &config.fit);
    let unusable = found.unusable.iter();
    let messages = unusable.flat_map(|u| placed(folder, &u.diagnostics));
    (rows, messages.collect())
}

/// Messages with the paths of their files, which they have relative to the folder that was searched.
fn placed(folder: &Path, diagnostics: &[Diagnostic]) -> Vec<Diagnostic> {
    let place = |d: &Diagnostic| d.clone().below(folder);
    diagnostics.iter().map(place).collect()
}

/// The readings of a session by itself.
pub fn rows(located: &Located, config: &Config) -> Vec<Row> {
    let session = &located.session;
    normalized(located, session, files(located, session), config).rows
}

/// A session after the stages that it goes through by itself.
struct Normalized {
    ingested: Ingested,
    cleaned: Cleaned,
    rows: Vec<Row>,
}

fn files(located: &Located, session: &Session) -> Vec<LogBytes> {
    let logs = session.logs.iter();
    logs.map(|log| {
        let shown = located.directory.join(log.name()).display().to_string();
        log_file::load(&located.directory.join(&log.file), &shown)
    })
    .collect()
}

fn normalized(
    located: &Located,
    session: &Session,
    files: Vec<LogBytes>,
    config: &Config,
) -> Normalized {
    let shown = located.directory.display().to_string();
    let ingested = pipeline_ingest::ingest(session, &shown, files);
    let cleaned = pipeline_clean::clean(session, &ingested.logs, &config.clean);
    let (rows, _) = pipeline_normalize::normalize(session, &cleaned.readings);
    Normalized {
        ingested,
        cleaned,
        rows,
    }
}

fn inspect(located: &Located, session: &Session, config: &Config, known: &Known) -> Inspection {
    let files = files(located, session);
    let Normalized {
        ingested,
        cleaned,
        rows,
    } = normalized(located, session, files.clone(), config);
    let rows = with_zeros_of_run(rows, &known.rows, &config.fit);
    let mut checks: Vec<Check> = Vec::new();
    checks.extend(session.exclude.iter().map(|why| Check {
        log: None,
        state: State::Look,
        seen: Seen::Excluded { why: why.clone() },
    }));
    let errors = ingested.header.diagnostics.iter();
    checks.extend(errors.map(described));
    checks.extend(copies(session, &files));
    checks.extend(copies_of_others(session, &files, known));
    checks.extend(noted(session, known));
    let stretched = plausible::stretched(session, &rows);
    checks.extend(stretched.map(|stretched| Check {
        log: None,
        state: State::Look,
        seen: Seen::Stretched(stretched),
    }));
    let phases = plausible::phases(session, &rows, &config.clean);
    checks.extend(phases.map(|phases| Check {
        log: None,
        state: State::Bad,
        seen: Seen::Phases(phases),
    }));
    checks.extend(logs::checks(session, &ingested.logs, &cleaned));
    checks.extend(zero::checks(session, &cleaned, known));
    let mut compared = population::compared(session, &rows, known);
    if session
        .logs
        .iter()
        .all(|log| log.is_zero || located.lacks(log))
    {
        compared.checks.iter_mut().for_each(without_logs);
    }
    if let Some(suit) = compared.suit.filter(is_doubtful) {
        let columns = otherwise::check((located, session), &files, &suit, config, known);
        if columns.is_some() {
            // What the same readings look like as they are is no second mistake.
            let is_mistake = |c: &Check| matches!(c.seen, Seen::Mistake { .. });
            compared.checks.retain(|c| !is_mistake(c));
        }
        checks.extend(columns);
    }
    checks.extend(compared.checks);
    Inspection {
        session: session.id.clone(),
        checks,
        against: compared.against,
        expected: compared.expected,
    }
}

/// There are no readings because there are no logs.
fn without_logs(check: &mut Check) {
    if let Seen::NotCompared { why } = &mut check.seen
        && *why == NotCompared::NoReadings
    {
        *why = NotCompared::NoLogs;
    }
}

/// Logs that are copies of one before them, where one of the two is a zero log: a session with one log that measures twice cannot be read at all.
fn copies(session: &Session, files: &[LogBytes]) -> Vec<Check> {
    let logs: Vec<(&LogSpec, &Vec<u8>)> = whole_files(session, files).collect();
    let copy = |(k, (log, bytes)): (usize, &(&LogSpec, &Vec<u8>))| {
        let before = logs[..k].iter().find(|(_, other)| other == bytes)?;
        Some(copied(log, before.0.name(), None))
    };
    logs.iter().enumerate().filter_map(copy).collect()
}

/// Logs that are copies of a file of another session of the last run. Zero logs may be shared.
fn copies_of_others(session: &Session, files: &[LogBytes], known: &Known) -> Vec<Check> {
    let copy = |(log, bytes): (&LogSpec, &Vec<u8>)| {
        let alike = known.files.get(&Digest::of(bytes))?;
        let other = alike.iter().find(|raw| raw.session != session.id)?;
        Some(copied(log, other.file.clone(), Some(other.session.clone())))
    };
    let logs = whole_files(session, files).filter(|(log, _)| !log.is_zero);
    logs.filter_map(copy).collect()
}

/// The logs that can be read and are a file each: several parts of one workbook are one file.
fn whole_files<'a>(
    session: &'a Session,
    files: &'a [LogBytes],
) -> impl Iterator<Item = (&'a LogSpec, &'a Vec<u8>)> {
    let logs = session.logs.iter().zip(files);
    logs.filter_map(|(log, bytes)| Some((log, bytes.as_ref().ok()?)))
        .filter(|(log, bytes)| log.part.is_none() && !bytes.is_empty())
}

fn copied(log: &LogSpec, of: String, session: Option<String>) -> Check {
    Check {
        log: Some(log.name()),
        state: State::Bad,
        seen: Seen::Copy { of, session },
    }
}

/// Lengths of the specimen that other sessions have otherwise, and a diameter that none of the campaign has.
fn noted(session: &Session, known: &Known) -> Vec<Check> {
    /// Lengths are noted to a tenth of a millimetre at most.
    const SAME_MM: f64 = 0.05;
    let own = &session.specimen;
    let of_campaign = || others(&known.rows, session).filter(|r| r.campaign == session.campaign);
    let of_specimen = of_campaign().find(|r| r.specimen == own.id);
    let check = |what, here_mm: f64, others_mm: f64| {
        ((here_mm - others_mm).abs() > SAME_MM).then_some(Check {
            log: None,
            state: State::Look,
            seen: Seen::Otherwise {
                what,
                here_mm,
                others_mm,
            },
        })
    };
    let lengths = of_specimen.map(|r| {
        [
            check(
                Noted::RestLength,
                1e3 * own.rest_length_m,
                1e3 * r.rest_length_m,
            ),
            check(
                Noted::ContractedLength,
                1e3 * own.contracted_length_m,
                1e3 * r.contracted_length_m,
            ),
        ]
    });
    let is_own = |r: &&Row| (r.diameter_mm - own.diameter_mm).abs() < SAME_MM;
    let diameter = match (of_campaign().next(), of_campaign().find(is_own)) {
        // About a joint actuators of several diameters are measured together.
        (Some(other), None) if session.kind == Kind::Isometric => {
            check(Noted::Diameter, own.diameter_mm, other.diameter_mm)
        }
        _ => None,
    };
    let lengths = lengths.into_iter().flatten();
    lengths.chain([diameter]).flatten().collect()
}

/// Whether the columns may be meant otherwise: the readings are unusual, or tell no gain at all.
fn is_doubtful(suit: &Suit) -> bool {
    suit.is_unusual() || !suit.tells_gain()
}

fn described(diagnostic: &Diagnostic) -> Check {
    Check {
        log: None,
        state: match diagnostic.severity {
            Severity::Error => State::Bad,
            _ => State::Look,
        },
        seen: Seen::Description {
            message: diagnostic.to_string(),
        },
    }
}

/// The rows of sessions that are not this one.
pub(crate) fn others<'r>(rows: &'r [Row], session: &Session) -> impl Iterator<Item = &'r Row> {
    rows.iter().filter(|r| r.session != session.id)
}
