//! Walks the list of stages: every unit goes through its stages in order, units of one kind side by side.

use crate::engine::Engine;
use crate::given::Given;
use crate::made::{self, Made, Steps, UnitMade};
use crate::raw::{ATTEMPTS, Logs};
use crate::rule::{Input, Rule};
use crate::stages::LIST;
use crate::step::{Stage, Step};
use crate::units::{Scope, Unit};
use crate::{Progress, parallel, watched};
use pipeline_base::digest::Digest;
use pipeline_base::error::{Error, Result};
use pipeline_config::{Config, Part};
use pipeline_formats::discover::{Discovery, Located, SESSION_FILE};
use serde::Serialize;
use std::collections::BTreeMap;

/// All that a walk needs.
pub struct Walk<'a> {
    /// The cache.
    pub engine: &'a Engine,
    /// What is below the raw directories.
    pub discovery: &'a Discovery,
    /// Options of the stages.
    pub config: &'a Config,
    /// Threads for the work on groups and campaigns.
    pub pool: &'a rayon::ThreadPool,
    /// Units at a time; 0 for as many as there are cores.
    pub jobs: usize,
}

/// A rule with the options that it reads.
struct Ready {
    stage: Stage,
    rule: &'static Rule,
    part: Part,
}

/// Digests of inputs by name; or what is to be waited for.
type Inputs = std::result::Result<BTreeMap<String, Digest>, String>;

impl<'a> Walk<'a> {
    /// Brings every unit up to date.
    ///
    /// # Errors
    /// System errors of the store, damaged entries; bad input is no error here.
    pub fn all(&self, progress: &dyn Progress) -> Result<Made> {
        let mut made = Made::default();
        for scope in Scope::ALL {
            let done = self.units(scope, made.of(Scope::Session), progress)?;
            made.add(scope, done);
        }
        Ok(made)
    }

    /// Brings the units of one kind up to date, with what has been made of the sessions.
    ///
    /// # Errors
    /// System errors of the store, damaged entries.
    pub fn units(
        &self,
        scope: Scope,
        sessions: &[UnitMade],
        progress: &dyn Progress,
    ) -> Result<Vec<UnitMade>> {
        let rules = rules(scope, self.config)?;
        let units = scope.units(self.discovery, self.config);
        parallel::each(self.jobs, &units, |unit| {
            let work = || self.unit(&rules, unit, sessions, progress);
            // Why the threads of sessions are no workers of the pool: see `parallel`.
            match scope {
                Scope::Session => work(),
                _ => self.pool.install(work),
            }
        })
    }

    /// One unit through all its stages.
    fn unit(
        &self,
        rules: &[Ready],
        unit: &Unit,
        sessions: &[UnitMade],
        progress: &dyn Progress,
    ) -> Result<UnitMade> {
        let mut own = Steps::new();
        let mine = |ready: &&Ready| (ready.rule.takes)(unit, self.discovery, self.config);
        for ready in rules.iter().filter(mine) {
            let step = watched(progress, (ready.stage.name, &unit.name), || {
                self.step(ready, unit, sessions, &own)
            })?;
            own.push((ready.stage.name, step));
        }
        Ok(UnitMade::new(unit.clone(), own))
    }

    /// One stage of one unit; begun again where a raw log changes meanwhile.
    fn step(&self, ready: &Ready, unit: &Unit, sessions: &[UnitMade], own: &Steps) -> Result<Step> {
        let (true, [k]) = (ready.rule.inputs.contains(&Input::Logs), &unit.sessions[..]) else {
            return self.attempt(ready, &self.given(ready, unit, sessions, own, None));
        };
        let mut attempts = 1;
        loop {
            let logs = Logs::hash(self.engine, &self.discovery.sessions[*k]);
            let step = self.attempt(ready, &self.given(ready, unit, sessions, own, Some(&logs)));
            if !logs.changed() || attempts == ATTEMPTS {
                return step;
            }
            attempts += 1;
        }
    }

    fn given<'g>(
        &'g self,
        ready: &'g Ready,
        unit: &'g Unit,
        sessions: &'g [UnitMade],
        own: &'g Steps,
        logs: Option<&'g Logs<'g>>,
    ) -> Given<'g> {
        let members = || unit.sessions.iter();
        Given {
            engine: self.engine,
            rule: ready.rule,
            unit,
            located: members().map(|k| &self.discovery.sessions[*k]).collect(),
            sessions: members().filter_map(|k| sessions.get(*k)).collect(),
            own,
            logs,
            config: &ready.part.config,
        }
    }

    fn attempt(&self, ready: &Ready, given: &Given) -> Result<Step> {
        let (stage, unit) = (ready.stage, given.unit);
        let inputs = match inputs(given)? {
            Ok(inputs) => inputs,
            Err(on) => return self.engine.waits(stage, &unit.name, &on),
        };
        let mut keyed = ready.part.keyed.clone();
        if let (Some(_), [located]) = (given.logs, &given.located[..]) {
            // Messages about the logs name it.
            keyed.insert("folder".to_owned(), located.relative.clone());
        }
        let run = || (ready.rule.run)(given);
        self.engine.step(stage, &unit.name, keyed, inputs, run)
    }
}

/// The rules for one kind of unit, in the order of stages.
fn rules(scope: Scope, config: &Config) -> Result<Vec<Ready>> {
    let of_scope = LIST.iter().flat_map(|declared| {
        let rules = declared.rules.iter().filter(move |r| r.scope == scope);
        rules.map(|rule| (declared.stage, rule))
    });
    let ready = |(stage, rule): (Stage, &'static Rule)| {
        Ok(Ready {
            stage,
            rule,
            part: config.part(rule.options)?,
        })
    };
    of_scope.map(ready).collect()
}

/// The digests of all that a rule reads.
fn inputs(given: &Given) -> Result<Inputs> {
    let mut all = BTreeMap::new();
    for input in given.rule.inputs {
        match of_input(given, *input)? {
            Ok(digests) => all.extend(digests),
            Err(on) => return Ok(Err(on)),
        }
    }
    Ok(Ok(all))
}

fn of_input(given: &Given, input: Input) -> Result<Inputs> {
    Ok(match input {
        Input::Descriptions => Ok(descriptions(given)?),
        Input::Logs => Ok(given.logs.iter().flat_map(|l| l.digests()).collect()),
        Input::Group => Ok(BTreeMap::from([(
            "group".to_owned(),
            of_json(&given.unit.group)?,
        )])),
        Input::All(stage) => own(given, stage, |_| true),
        Input::Own(stage, output) => own(given, stage, |name| name == output),
        Input::Each(stage, output, called) => each(given, stage, output, called),
    })
}

fn descriptions(given: &Given) -> Result<BTreeMap<String, Digest>> {
    let name = |located: &Located| match given.rule.scope {
        Scope::Session => SESSION_FILE.to_owned(),
        _ => format!("{} {SESSION_FILE}", located.session.id),
    };
    let located = given.located.iter();
    located
        .map(|l| Ok((name(l), of_json(&l.session)?)))
        .collect()
}

fn own(given: &Given, stage: &str, is_read: impl Fn(&str) -> bool) -> Inputs {
    let step = made::find(given.own, stage);
    let entry = step.and_then(Step::entry).ok_or_else(|| stage.to_owned())?;
    let read = entry.outputs.iter().filter(|(name, _)| is_read(name));
    let digests = read.map(|(name, o)| (format!("{stage}/{name}"), o.digest.clone()));
    Ok(digests.collect())
}

fn each(given: &Given, stage: &str, output: &str, called: &str) -> Inputs {
    let digest = |session: &&UnitMade| {
        let entry = session.step(stage).and_then(Step::entry);
        let object = entry.and_then(|e| e.outputs.get(output));
        let object = object.ok_or_else(|| format!("{stage} of {}", session.unit.name))?;
        let name = format!("{} {called}", session.unit.name);
        Ok((name.trim_end().to_owned(), object.digest.clone()))
    };
    given.sessions.iter().map(digest).collect()
}

fn of_json(value: &impl Serialize) -> Result<Digest> {
    let json = serde_json::to_vec(value).map_err(Error::internal)?;
    Ok(Digest::of(&json))
}
