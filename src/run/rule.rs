//! What a stage declares: its name, on what it works, from what, with which options, and the function.
//!
//! The keys, the order of the work, what waits for what, the jobs and their export, and what `status`, `explain` and `graph` say follow from
//! the declarations in [`crate::stages::LIST`]. A function gets what its rule declares and nothing else ([`Given`]), so that a key cannot lack
//! anything that the result depends on.

use crate::given::Given;
use crate::step::Stage;
use crate::units::{Scope, Unit};
use pipeline_base::digest::Outputs;
use pipeline_base::error::Result;
use pipeline_config::Config;
use pipeline_formats::discover::Discovery;

/// A stage: one file in [`crate::stages`].
#[derive(Clone, Copy)]
pub struct Declared {
    /// Name, version and code.
    pub stage: Stage,
    /// What it does, one rule for each kind of unit.
    pub rules: &'static [Rule],
}

/// How the results of one kind of unit are made.
#[derive(Clone, Copy)]
pub struct Rule {
    /// What a unit is.
    pub scope: Scope,
    /// Which of these units it is for.
    pub takes: fn(&Unit, &Discovery, &Config) -> bool,
    /// What it reads.
    pub inputs: &'static [Input],
    /// The options that it reads: sections of `pipeline.toml` or single options, such as `fit.confidence`.
    pub options: &'static [&'static str],
    /// Makes the outputs, from what is given alone.
    pub run: fn(&Given) -> Result<Outputs>,
}

/// Something that a rule reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// What the `session.toml` of each session of the unit says.
    Descriptions,
    /// The raw logs of the session.
    Logs,
    /// Which rows the group has.
    Group,
    /// All outputs that an earlier stage has made of the same unit.
    All(&'static str),
    /// An output that an earlier stage has made of the same unit: stage and name.
    Own(&'static str, &'static str),
    /// An output that a stage has made of each session of the unit: stage, name, and what stands behind the session's id in the key.
    Each(&'static str, &'static str, &'static str),
}

/// For a rule that takes every unit of its scope.
pub fn every(_: &Unit, _: &Discovery, _: &Config) -> bool {
    true
}

impl Rule {
    /// Its units, in order.
    pub fn units(&self, discovery: &Discovery, config: &Config) -> Vec<Unit> {
        let mut units = self.scope.units(discovery, config);
        units.retain(|unit| (self.takes)(unit, discovery, config));
        units
    }

    /// The stages of which it reads what they have made of the same unit.
    pub fn reads_own(&self) -> impl Iterator<Item = &'static str> {
        self.inputs.iter().filter_map(|input| match input {
            Input::All(stage) | Input::Own(stage, _) => Some(*stage),
            _ => None,
        })
    }
}

impl Declared {
    /// Whether it reads raw logs.
    pub fn reads_raw(&self) -> bool {
        let mut inputs = self.rules.iter().flat_map(|rule| rule.inputs);
        inputs.any(|input| *input == Input::Logs)
    }
}
