//! The stages of one session: ingest, clean, normalize.

use crate::engine::{self, Engine};
use crate::step::{Stage, Step};
use pipeline_base::digest::Digest;
use pipeline_base::digest::Outputs;
use pipeline_base::error::{Error, Result};
use pipeline_base::frame::Frame;
use pipeline_base::reject::Reject;
use pipeline_base::row::{self, Row};
use pipeline_base::{reading, reading::Reading};
use pipeline_cache::store::{Entry, Object};
use pipeline_clean as clean;
use pipeline_clean::CleanHeader;
use pipeline_config::{CleanOptions, Config, flatten};
use pipeline_formats::discover::Located;
use pipeline_formats::log_file;
use pipeline_ingest as ingest;
use pipeline_ingest::{IngestHeader, LogBytes, LogSamples};
use pipeline_normalize as normalize;
use std::collections::BTreeMap;
use std::path::Path;

const INGEST: Stage = Stage {
    name: "ingest",
    version: ingest::VERSION,
    code: engine::INGEST,
};
const CLEAN: Stage = Stage {
    name: "clean",
    version: clean::VERSION,
    code: engine::CLEAN,
};
const NORMALIZE: Stage = Stage {
    name: "normalize",
    version: normalize::VERSION,
    code: engine::NORMALIZE,
};

/// Names of outputs.
pub const HEADER: &str = "header.json";
/// Readings of the clean stage.
pub const READINGS: &str = "readings.parquet";
/// Rows of the normalize stage.
pub const ROWS: &str = "rows.parquet";
/// Rejects of the normalize stage.
pub const REJECTS: &str = "rejects.json";

/// The steps of one session.
pub struct SessionResult {
    /// Session id.
    pub id: String,
    /// Ingest.
    pub ingest: Step,
    /// Clean.
    pub clean: Step,
    /// Normalize.
    pub normalize: Step,
    /// Digests of what the three gave, in order; none while one of them is pending.
    pub gave: Option<[Digest; 3]>,
}

/// Why a session has to be started again.
enum Again {
    /// A file changed between hashing and reading.
    Retry,
    Failed(Error),
}

impl From<Error> for Again {
    fn from(error: Error) -> Self {
        Again::Failed(error)
    }
}

/// What all sessions are processed with.
pub struct Workshop<'a> {
    engine: &'a Engine,
    clean: &'a CleanOptions,
    /// The same as the key of a step has them.
    keyed: BTreeMap<String, String>,
}

impl<'a> Workshop<'a> {
    /// With these options.
    ///
    /// # Errors
    /// An option that TOML cannot hold.
    pub fn new(engine: &'a Engine, config: &'a Config) -> Result<Self> {
        let clean = &config.clean;
        let keyed = flatten("clean", clean)?;
        Ok(Self {
            engine,
            clean,
            keyed,
        })
    }
}

/// Brings one session up to date.
///
/// # Errors
/// System errors of the store; bad input is no error here.
pub fn process(workshop: &Workshop, located: &Located) -> Result<SessionResult> {
    const ATTEMPTS: usize = 3;
    for _ in 0..ATTEMPTS {
        match attempt(workshop, located) {
            Ok(result) => return Ok(result),
            Err(Again::Failed(error)) => return Err(error),
            Err(Again::Retry) => {}
        }
    }
    Err(Error::Usage(format!(
        "the logs of session {} change while they are read; run again when they are at rest",
        located.session.id
    )))
}

fn attempt(workshop: &Workshop, located: &Located) -> std::result::Result<SessionResult, Again> {
    let engine = workshop.engine;
    let (session, id) = (&located.session, located.session.id.clone());
    let description = Digest::of(&to_json(session)?);
    let (ingest, at_hand) = ingest_step(engine, located, &description)?;
    let Some(entry) = ingest.entry() else {
        return Ok(SessionResult {
            clean: engine.waits(CLEAN, &id, "ingest")?,
            normalize: engine.waits(NORMALIZE, &id, "clean")?,
            gave: None,
            id,
            ingest,
        });
    };
    let (options, inputs) = (workshop.keyed.clone(), digests(entry, "ingest"));
    let clean = engine.step(CLEAN, &id, options, inputs, || {
        let logs = at_hand.map_or_else(|| read_logs(engine, &ingest), Ok)?;
        let cleaned = clean::clean(session, &logs, workshop.clean);
        let readings = reading::to_frame(&cleaned.readings).to_parquet()?;
        Ok(Outputs::from([
            (HEADER.to_owned(), to_json(&cleaned.header)?),
            (READINGS.to_owned(), readings),
        ]))
    })?;
    let ingest = ingest.settled();
    let Some(entry) = clean.entry() else {
        return Ok(SessionResult {
            normalize: engine.waits(NORMALIZE, &id, "clean")?,
            gave: None,
            id,
            ingest,
            clean,
        });
    };
    let mut inputs = digests(entry, "clean");
    inputs.insert("session.toml".to_owned(), description);
    inputs.remove(&format!("clean/{HEADER}"));
    let normalize = engine.step(NORMALIZE, &id, BTreeMap::new(), inputs, || {
        let readings = read_readings(engine, &clean)?;
        let (rows, rejects) = normalize::normalize(session, &readings);
        let rows = row::to_frame(&rows).to_parquet()?;
        Ok(Outputs::from([
            (ROWS.to_owned(), rows),
            (REJECTS.to_owned(), to_json(&rejects)?),
        ]))
    })?;
    let gave = |step: &Step| step.entry().map(Entry::digest);
    let gave = (gave(&ingest), gave(&clean), gave(&normalize));
    Ok(SessionResult {
        id,
        ingest,
        clean: clean.settled(),
        normalize: normalize.settled(),
        gave: match gave {
            (Some(i), Some(c), Some(n)) => Some([i, c, n]),
            _ => None,
        },
    })
}

/// The outputs of a stage as inputs of the next.
fn digests(entry: &Entry, stage: &str) -> BTreeMap<String, Digest> {
    let named = |(name, o): (&String, &Object)| (format!("{stage}/{name}"), o.digest.clone());
    entry.outputs.iter().map(named).collect()
}

/// The ingest of a session, with its samples if it was done now.
fn ingest_step(
    engine: &Engine,
    located: &Located,
    description: &Digest,
) -> std::result::Result<(Step, Option<Vec<LogSamples>>), Again> {
    let session = &located.session;
    let mut inputs = BTreeMap::from([("session.toml".to_owned(), description.clone())]);
    let mut at_hand = Vec::with_capacity(session.logs.len());
    for log in &session.logs {
        let path = located.directory.join(&log.file);
        let (digest, bytes) = engine
            .hashes
            .digest(&format!("{}:{}", session.id, log.file), &path)
            .unwrap_or_else(|e| (unreadable_digest(&e), None));
        inputs.insert(log.file.clone(), digest.clone());
        at_hand.push((path, digest, bytes));
    }
    let options = BTreeMap::from([("folder".to_owned(), located.relative.clone())]);
    let (mut changed, mut samples) = (false, None);
    let step = engine.step(INGEST, &session.id, options, inputs, || {
        let mut files = Vec::with_capacity(at_hand.len());
        for (log, (path, digest, bytes)) in session.logs.iter().zip(at_hand) {
            let (bytes, read) =
                read_log(&path, &format!("{}/{}", located.relative, log.file), bytes);
            changed |= read.is_some_and(|read| read != digest);
            files.push(bytes);
        }
        if changed {
            return Err(Error::Usage(String::new()));
        }
        let ingested = ingest::ingest(session, &located.relative, files);
        let outputs = ingest_outputs(&ingested)?;
        samples = Some(ingested.logs);
        Ok(outputs)
    });
    match step {
        Err(_) if changed => Err(Again::Retry),
        Err(error) => Err(error.into()),
        Ok(step) => Ok((step, samples)),
    }
}

/// A file that cannot be read has a digest too, so that its return is a change of input.
fn unreadable_digest(error: &std::io::Error) -> Digest {
    Digest::of(format!("unreadable: {}", error.kind()).as_bytes())
}

/// The bytes of a log, or a diagnostic where it cannot be read; and the digest of what was read, if it was read now.
fn read_log(path: &Path, file: &str, at_hand: Option<Vec<u8>>) -> (LogBytes, Option<Digest>) {
    if let Some(bytes) = at_hand {
        return match log_file::check(file, bytes.len() as u64, bytes.as_slice()) {
            Ok(Err(diagnostic)) => (Err(diagnostic), None),
            _ => (Ok(bytes), None),
        };
    }
    let bytes = log_file::load(path, file);
    let digest = bytes.as_deref().ok().map(Digest::of);
    (bytes, digest)
}

fn ingest_outputs(ingested: &ingest::Ingested) -> Result<Outputs> {
    let mut outputs = Outputs::from([(HEADER.to_owned(), to_json(&ingested.header)?)]);
    for (header, log) in ingested.header.logs.iter().zip(&ingested.logs) {
        outputs.insert(header.output.clone(), log.to_frame().to_parquet()?);
    }
    Ok(outputs)
}

fn to_json(value: &impl serde::Serialize) -> Result<Vec<u8>> {
    serde_json::to_vec(value).map_err(Error::internal)
}

fn read_logs(engine: &Engine, ingest: &Step) -> Result<Vec<LogSamples>> {
    let header: IngestHeader =
        serde_json::from_slice(&engine.read(ingest, HEADER)?).map_err(Error::internal)?;
    header
        .logs
        .iter()
        .map(|log| {
            let frame = Frame::from_parquet(&engine.read(ingest, &log.output)?)?;
            Ok(LogSamples::from_frame(
                log.spec.clone(),
                log.first_line,
                frame,
            ))
        })
        .collect()
}

fn read_readings(engine: &Engine, clean: &Step) -> Result<Vec<Reading>> {
    reading::from_frame(&Frame::from_parquet(&engine.read(clean, READINGS)?)?)
}

impl SessionResult {
    /// Digests of what its stages gave, by stage in order; none while one of them is pending.
    pub fn gave(&self) -> Option<impl Iterator<Item = (&'static str, &Digest)>> {
        let stages = [INGEST, CLEAN, NORMALIZE].map(|stage| stage.name);
        self.gave.as_ref().map(|gave| stages.into_iter().zip(gave))
    }

    /// The headers of ingest and clean; `None` in a dry run.
    ///
    /// # Errors
    /// A damaged cache.
    pub fn headers(&self, engine: &Engine) -> Result<Option<(IngestHeader, CleanHeader)>> {
        if self.clean.entry().is_none() || self.ingest.entry().is_none() {
            return Ok(None);
        }
        let ingest =
            serde_json::from_slice(&engine.read(&self.ingest, HEADER)?).map_err(Error::internal)?;
        let clean =
            serde_json::from_slice(&engine.read(&self.clean, HEADER)?).map_err(Error::internal)?;
        Ok(Some((ingest, clean)))
    }

    /// The normalised rows.
    ///
    /// # Errors
    /// A damaged cache.
    pub fn rows(&self, engine: &Engine) -> Result<Vec<Row>> {
        row::from_frame(&Frame::from_parquet(&engine.read(&self.normalize, ROWS)?)?)
    }

    /// The readings that could not be normalised.
    ///
    /// # Errors
    /// A damaged cache.
    pub fn normalize_rejects(&self, engine: &Engine) -> Result<Vec<Reject>> {
        serde_json::from_slice(&engine.read(&self.normalize, REJECTS)?).map_err(Error::internal)
    }

    /// The samples of one log, by its position in the ingest header.
    ///
    /// # Errors
    /// A damaged cache.
    pub fn samples(&self, engine: &Engine, output_name: &str) -> Result<Frame> {
        Frame::from_parquet(&engine.read(&self.ingest, output_name)?)
    }
}
