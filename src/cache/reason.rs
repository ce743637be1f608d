//! Why a computation has to be done again, in one line each.

use crate::key::KeyParts;
use pipeline_base::digest::Digest;
use std::fmt;

/// One cause of a computation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reason {
    /// There is no earlier result.
    FirstTime,
    /// The user asked for it.
    Forced,
    /// The stage's source files changed.
    CodeChanged,
    /// The stage's version was raised.
    VersionChanged(u32, u32),
    /// An option has another value.
    OptionChanged(String, String, String),
    /// An input has other contents.
    InputChanged(String, Digest, Digest),
    /// An input was not there before.
    InputAdded(String),
    /// An input is no longer there.
    InputRemoved(String),
    /// The entry of the cache cannot be read, or an output of it is missing or damaged.
    Damaged(String),
    /// An earlier stage will run first, and what it gives decides.
    Waits(String),
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Reason::FirstTime => write!(f, "no earlier result"),
            Reason::Forced => write!(f, "requested with --force"),
            Reason::CodeChanged => write!(f, "code of the stage changed"),
            Reason::VersionChanged(old, new) => write!(f, "version of the stage {old} -> {new}"),
            Reason::OptionChanged(name, old, new) => write!(f, "option {name} {old} -> {new}"),
            Reason::InputChanged(name, old, new) => {
                write!(
                    f,
                    "input changed: {name} {} -> {}",
                    old.short(),
                    new.short()
                )
            }
            Reason::InputAdded(name) => write!(f, "input added: {name}"),
            Reason::InputRemoved(name) => write!(f, "input removed: {name}"),
            Reason::Damaged(what) => write!(f, "cache entry damaged: {what}"),
            Reason::Waits(stage) => write!(f, "waits for {stage}"),
        }
    }
}

/// Every difference between the parts of two keys of one stage and unit.
pub fn differences(old: &KeyParts, new: &KeyParts) -> Vec<Reason> {
    let mut reasons = Vec::new();
    if old.version != new.version {
        reasons.push(Reason::VersionChanged(old.version, new.version));
    }
    if old.code != new.code {
        reasons.push(Reason::CodeChanged);
    }
    let unset = String::from("unset");
    let names = old.options.keys().chain(new.options.keys());
    let names: std::collections::BTreeSet<&String> = names.collect();
    for name in names {
        let before = old.options.get(name).unwrap_or(&unset);
        let after = new.options.get(name).unwrap_or(&unset);
        if before != after {
            reasons.push(Reason::OptionChanged(
                name.clone(),
                before.clone(),
                after.clone(),
            ));
        }
    }
    for (name, digest) in &new.inputs {
        match old.inputs.get(name) {
            None => reasons.push(Reason::InputAdded(name.clone())),
            Some(before) if before != digest => reasons.push(Reason::InputChanged(
                name.clone(),
                before.clone(),
                digest.clone(),
            )),
            Some(_) => {}
        }
    }
    let gone = old.inputs.keys().filter(|n| !new.inputs.contains_key(*n));
    reasons.extend(gone.map(|n| Reason::InputRemoved(n.clone())));
    reasons
}

/// Reasons as one line; of many, the first few and a count.
pub fn one_line(reasons: &[Reason]) -> String {
    const SHOWN: usize = 3;
    let mut line: Vec<String> = reasons
        .iter()
        .take(SHOWN)
        .map(ToString::to_string)
        .collect();
    if reasons.len() > SHOWN {
        line.push(format!("and {} more", reasons.len() - SHOWN));
    }
    line.join("; ")
}
