//! What the function of a rule gets to see: the inputs and options that the rule declares, and nothing else.

use crate::artifact::Artifact;
use crate::engine::Engine;
use crate::made::{self, Steps, UnitMade};
use crate::raw::Logs;
use crate::rule::{Input, Rule};
use crate::units::Unit;
use pipeline_base::error::{Error, Result};
use pipeline_base::frame::Frame;
use pipeline_base::session::Session;
use pipeline_config::Config;
use pipeline_fit::Group;
use pipeline_formats::discover::Located;
use pipeline_ingest::LogBytes;

/// The inputs of one unit. Asking for what the rule does not declare is an error, since the key would not have it.
pub struct Given<'a> {
    /// The cache.
    pub(crate) engine: &'a Engine,
    /// What is declared.
    pub(crate) rule: &'a Rule,
    /// The unit.
    pub(crate) unit: &'a Unit,
    /// Its sessions as they were found.
    pub(crate) located: Vec<&'a Located>,
    /// What the stages have made of its sessions; nothing while these are worked on.
    pub(crate) sessions: Vec<&'a UnitMade>,
    /// What earlier stages have made of the same unit.
    pub(crate) own: &'a Steps,
    /// Its raw logs, if it reads them.
    pub(crate) logs: Option<&'a Logs<'a>>,
    /// The options that are declared.
    pub(crate) config: &'a Config,
}

impl<'a> Given<'a> {
    fn declares(&self, input: Input) -> Result<()> {
        if self.rule.inputs.contains(&input) {
            return Ok(());
        }
        Err(undeclared(&format!("{input:?}")))
    }

    /// The options that the rule declares; all others have their defaults.
    pub fn config(&self) -> &Config {
        self.config
    }

    /// Name of the unit. It enters no key: whatever is made with it has to follow from the inputs too.
    pub fn name(&self) -> &str {
        &self.unit.name
    }

    /// What the sessions of the unit say of themselves, by id.
    ///
    /// # Errors
    /// It is not declared.
    pub fn descriptions(&self) -> Result<Vec<&'a Session>> {
        self.declares(Input::Descriptions)?;
        Ok(self.located.iter().map(|l| &l.session).collect())
    }

    /// What the session says of itself.
    ///
    /// # Errors
    /// It is not declared, or the unit is no session.
    pub fn description(&self) -> Result<&'a Session> {
        match self.descriptions()?[..] {
            [session] => Ok(session),
            _ => Err(undeclared("the description of one session")),
        }
    }

    /// Folder of the session relative to its raw directory, and the bytes of its logs or why there are none.
    ///
    /// # Errors
    /// It is not declared, or a log changes while it is read.
    pub fn logs(&self) -> Result<(&'a str, Vec<LogBytes>)> {
        match (self.logs, &self.located[..]) {
            (Some(logs), [located]) => Ok((&located.relative, logs.read()?)),
            _ => Err(undeclared("raw logs")),
        }
    }

    /// Which rows the group has.
    ///
    /// # Errors
    /// It is not declared, or the unit is no group.
    pub fn group(&self) -> Result<&'a Group> {
        self.declares(Input::Group)?;
        self.unit
            .group
            .as_ref()
            .ok_or_else(|| undeclared("a group"))
    }

    /// An output that an earlier stage has made of this unit.
    ///
    /// # Errors
    /// It is not declared; a damaged cache.
    pub fn own<T>(&self, artifact: &Artifact<T>) -> Result<T> {
        if !self.rule.inputs.contains(&Input::All(artifact.stage)) {
            self.declares(Input::Own(artifact.stage, artifact.name))?;
        }
        made::read(self.engine, self.own, artifact)
    }

    /// A table among all the outputs of an earlier stage.
    ///
    /// # Errors
    /// They are not declared; a damaged cache.
    pub fn own_table(&self, stage: &'static str, name: &str) -> Result<Frame> {
        self.declares(Input::All(stage))?;
        Frame::from_parquet(&made::bytes(self.engine, self.own, stage, name)?)
    }

    /// An output that a stage has made of each session, by id.
    ///
    /// # Errors
    /// It is not declared; a damaged cache.
    pub fn each<T>(&self, artifact: &Artifact<T>) -> Result<Vec<T>> {
        let of = |input: &Input| matches!(input, Input::Each(s, n, _) if (*s, *n) == (artifact.stage, artifact.name));
        if !self.rule.inputs.iter().any(of) {
            return Err(undeclared(artifact.name));
        }
        let sessions = self.sessions.iter();
        sessions.map(|s| s.read(self.engine, artifact)).collect()
    }
}

fn undeclared(what: &str) -> Error {
    Error::Internal(format!("{what} is read, but not declared as an input"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::fit::FIT;
    use crate::stages::normalize::ROWS;
    use crate::units::Scope;
    use crate::{RunOptions, Silent};
    use pipeline_base::digest::Outputs;

    const RULE: Rule = Rule {
        scope: Scope::Group,
        takes: crate::rule::every,
        inputs: &[ROWS.each("")],
        options: &[],
        run: |_| Ok(Outputs::new()),
    };

    #[test]
    fn what_a_rule_does_not_declare_it_cannot_read() {
        let folder = tempfile::tempdir().unwrap();
        let options = RunOptions::below(folder.path());
        let engine = Engine::open(&options, None, &Silent).unwrap();
        let unit = Unit {
            name: "small 10 mm".to_owned(),
            sessions: Vec::new(),
            group: None,
        };
        let given = Given {
            engine: &engine,
            rule: &RULE,
            unit: &unit,
            located: Vec::new(),
            sessions: Vec::new(),
            own: &Steps::new(),
            logs: None,
            config: &options.config,
        };
        assert!(given.each(&ROWS).unwrap().is_empty());
        let undeclared = |e: Error| e.to_string().contains("not declared as an input");
        assert!(undeclared(given.own(&FIT).unwrap_err()));
        assert!(undeclared(given.group().unwrap_err()));
        assert!(undeclared(given.descriptions().unwrap_err()));
        assert!(undeclared(given.logs().unwrap_err()));
    }
}
