//! What the stages have made, by unit. The bytes are in the cache: a large campaign does not fit into memory.

use crate::artifact::Artifact;
use crate::engine::Engine;
use crate::step::Step;
use crate::units::{Scope, Unit};
use pipeline_base::digest::Digest;
use pipeline_base::error::{Error, Result};
use pipeline_base::frame::Frame;
use std::collections::BTreeMap;

/// Steps with the names of their stages, in the order of stages.
pub type Steps = Vec<(&'static str, Step)>;

/// What the stages have made of one unit.
pub struct UnitMade {
    /// On what they worked.
    pub unit: Unit,
    steps: Steps,
    /// Digests of the outputs of each step; none where it is pending.
    outputs: Vec<Option<Digest>>,
}

/// What the stages have made of all units.
#[derive(Default)]
pub struct Made {
    by_scope: BTreeMap<Scope, Vec<UnitMade>>,
}

impl Made {
    /// Takes up all units of one kind, in their order.
    pub fn add(&mut self, scope: Scope, units: Vec<UnitMade>) {
        self.by_scope.insert(scope, units);
    }

    /// The units of one kind, in their order.
    pub fn of(&self, scope: Scope) -> &[UnitMade] {
        self.by_scope.get(&scope).map_or(&[], Vec::as_slice)
    }

    /// All units, with their kinds.
    pub fn all(&self) -> impl Iterator<Item = (Scope, &UnitMade)> {
        let scopes = self.by_scope.iter();
        scopes.flat_map(|(scope, units)| units.iter().map(|unit| (*scope, unit)))
    }
}

impl UnitMade {
    /// What these steps have made of a unit.
    pub fn new(unit: Unit, steps: Steps) -> Self {
        let settled = steps
            .into_iter()
            .map(|(stage, step)| (stage, step.settled()));
        let steps: Steps = settled.collect();
        let outputs = steps.iter().map(|(_, step)| Some(step.entry()?.digest()));
        Self {
            unit,
            outputs: outputs.collect(),
            steps,
        }
    }

    /// The step of a stage, if the unit goes through it.
    pub fn step(&self, stage: &str) -> Option<&Step> {
        find(&self.steps, stage)
    }

    /// Names of its stages, with a digest of the output of each; none where that is pending.
    pub fn outputs(&self) -> impl Iterator<Item = (&'static str, Option<&Digest>)> {
        let stages = self.steps.iter().map(|(stage, _)| *stage);
        stages.zip(self.outputs.iter().map(Option::as_ref))
    }

    /// Whether none of its steps is pending.
    pub fn is_whole(&self) -> bool {
        self.outputs.iter().all(Option::is_some)
    }

    /// The value of an output.
    ///
    /// # Errors
    /// A damaged cache; a step that is pending.
    pub fn read<T>(&self, engine: &Engine, artifact: &Artifact<T>) -> Result<T> {
        read(engine, &self.steps, artifact)
    }

    /// The table in an output whose name stands in another one.
    ///
    /// # Errors
    /// A damaged cache; a step that is pending.
    pub fn table(&self, engine: &Engine, stage: &str, name: &str) -> Result<Frame> {
        Frame::from_parquet(&bytes(engine, &self.steps, stage, name)?)
    }
}

/// The step of a stage.
pub fn find<'s>(steps: &'s Steps, stage: &str) -> Option<&'s Step> {
    let named = steps.iter().find(|(name, _)| *name == stage);
    named.map(|(_, step)| step)
}

/// The value of an output of one of these steps.
///
/// # Errors
/// A damaged cache; a step that is pending or is not among them.
pub fn read<T>(engine: &Engine, steps: &Steps, artifact: &Artifact<T>) -> Result<T> {
    artifact.decode(&bytes(engine, steps, artifact.stage, artifact.name)?)
}

/// The bytes of an output of one of these steps.
///
/// # Errors
/// A damaged cache; a step that is pending or is not among them.
pub fn bytes(engine: &Engine, steps: &Steps, stage: &str, name: &str) -> Result<Vec<u8>> {
    let none = || Error::Internal(format!("{name} of a unit that does not go through {stage}"));
    engine.read(find(steps, stage).ok_or_else(none)?, name)
}
