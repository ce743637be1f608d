//! The stages, one file each, and their list.

pub mod clean;
pub mod compare;
pub mod diagnose;
pub mod fit;
pub mod ingest;
pub mod normalize;
pub mod report;
pub mod torque;

use crate::rule::{Declared, Rule};
use crate::units::Scope;

/// What declarations are made of.
mod parts {
    pub use crate::artifact::{Artifact, Tabular};
    pub use crate::code;
    pub use crate::given::Given;
    pub use crate::rule::{Declared, Input, Rule, every};
    pub use crate::step::Stage;
    pub use crate::units::Scope;
    pub use pipeline_base::digest::Outputs;
    pub use pipeline_base::error::Result;
}

/// Every stage, in the order in which a unit goes through them.
pub const LIST: &[Declared] = &[
    ingest::STAGE,
    clean::STAGE,
    normalize::STAGE,
    fit::STAGE,
    compare::STAGE,
    diagnose::STAGE,
    torque::STAGE,
    report::STAGE,
];

/// Their names, as users know them.
pub const NAMES: &[&str] = &names();

const fn names() -> [&'static str; LIST.len()] {
    let mut names = [""; LIST.len()];
    let mut k = 0;
    while k < names.len() {
        names[k] = LIST[k].stage.name;
        k += 1;
    }
    names
}

/// Every rule with the name of its stage, in order.
pub fn rules() -> impl Iterator<Item = (&'static str, &'static Rule)> {
    LIST.iter().flat_map(|declared| {
        let rules = declared.rules.iter();
        rules.map(|rule| (declared.stage.name, rule))
    })
}

/// The stages that a session goes through.
pub fn of_sessions() -> Vec<&'static str> {
    let of_session = rules().filter(|(_, rule)| rule.scope == Scope::Session);
    of_session.map(|(stage, _)| stage).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rule::Input;
    use pipeline_config::Config;

    #[test]
    fn a_stage_reads_what_earlier_stages_make_and_options_that_there_are() {
        for (k, (stage, rule)) in rules().enumerate() {
            let before: Vec<(&str, &Rule)> = rules().take(k).collect();
            for input in rule.inputs {
                let made_in = |of: &str, scope: Scope| {
                    let mut makers = before.iter();
                    makers.any(|(name, maker)| *name == of && maker.scope == scope)
                };
                let is_there = match input {
                    Input::All(of) | Input::Own(of, _) => made_in(of, rule.scope),
                    Input::Each(of, ..) => {
                        rule.scope != Scope::Session && made_in(of, Scope::Session)
                    }
                    Input::Logs => rule.scope == Scope::Session,
                    Input::Group => rule.scope == Scope::Group,
                    Input::Descriptions => true,
                };
                assert!(is_there, "{stage}: {input:?}");
            }
            assert!(Config::default().part(rule.options).is_ok(), "{stage}");
        }
    }
}
