//! Runs campaigns in parallel, and does not run again what the log has.

use super::outcome::Outcome;
use super::trial::{Part, Trial};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;

/// One line of the log.
#[derive(Serialize, Deserialize)]
struct Line {
    /// The loop's answers to the fixed campaigns: a line of another program is not used.
    answers: String,
    trial: String,
    outcome: Outcome,
}

/// The log, and what it has.
pub struct Log {
    answers: String,
    file: Option<Mutex<File>>,
    known: BTreeMap<String, Outcome>,
}

impl Log {
    /// A log in memory only.
    pub fn none() -> Self {
        Self {
            answers: String::new(),
            file: None,
            known: BTreeMap::new(),
        }
    }

    /// Opens or begins a log file.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn open(path: &Path, answers: &str) -> std::io::Result<Self> {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let known = known(&text, answers);
        let file = File::options().create(true).append(true).open(path)?;
        Ok(Self {
            answers: answers.to_owned(),
            file: Some(Mutex::new(file)),
            known,
        })
    }

    fn write(&self, trial: &Trial, outcome: &Outcome) {
        let Some(file) = &self.file else { return };
        let line = Line {
            answers: self.answers.clone(),
            trial: trial.name(),
            outcome: outcome.clone(),
        };
        let mut text = serde_json::to_string(&line).expect("numbers and words");
        text.push('\n');
        let mut file = file.lock().expect("no thread has panicked");
        file.write_all(text.as_bytes()).expect("room for the log");
    }
}

/// What a log has of the campaigns that a loop with these answers searched, by the names of the trials.
pub fn known(log: &str, answers: &str) -> BTreeMap<String, Outcome> {
    let lines = log.lines();
    let lines = lines.filter_map(|l| serde_json::from_str::<Line>(l).ok());
    let own = lines.filter(|l| l.answers == answers);
    own.map(|l| (l.trial, l.outcome)).collect()
}

/// The outcomes of trials, in their order: first those without an effect, which say how large the others are.
pub fn run(trials: &[Trial], log: &Log, each: impl Fn(&Trial, &Outcome) + Sync) -> Vec<Outcome> {
    let mut plain: BTreeMap<String, Trial> = BTreeMap::new();
    for trial in trials {
        let limits = if trial.part == Part::Nothing {
            Some(trial.clone())
        } else {
            trial.without()
        };
        plain.extend(limits.map(|t| (t.name(), t)));
    }
    let plain: Vec<Trial> = plain.into_values().collect();
    let one = |trial: &Trial, without: Option<&Outcome>| {
        if let Some(outcome) = log.known.get(&trial.name()) {
            return outcome.clone();
        }
        let outcome = trial.run(without);
        log.write(trial, &outcome);
        each(trial, &outcome);
        outcome
    };
    let searched: BTreeMap<String, Outcome> =
        plain.par_iter().map(|t| (t.name(), one(t, None))).collect();
    trials
        .par_iter()
        .map(|t| match t.without() {
            Some(without) => one(t, searched.get(&without.name())),
            None => searched
                .get(&t.name())
                .cloned()
                .unwrap_or_else(|| one(t, None)),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::plan::Plan;
    use super::*;
    use pipeline::simulate::rig_like::Family;

    #[test]
    fn what_is_logged_is_known_again_unless_the_loop_answers_differently() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("log.jsonl");
        let trial = &Plan {
            family: Family::Design,
            seeds: 1,
        }
        .short()[0];
        let outcome = Outcome {
            verdict: "none".to_owned(),
            rmse: Some(12.5),
            scatter_ratios: [Some(1.1), None],
            ..Outcome::default()
        };
        Log::open(&path, "a").expect("a log").write(trial, &outcome);
        let again = Log::open(&path, "a").expect("a log");
        assert_eq!(again.known.get(&trial.name()), Some(&outcome));
        assert!(Log::open(&path, "b").expect("a log").known.is_empty());
    }
}
