//! The part of the options that a stage reads: written down for its key, and the only part that its function gets to see.

use crate::{Config, flatten};
use pipeline_base::error::{Error, Result};
use std::collections::BTreeMap;
use toml::{Table, Value};

/// Some of the options.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The options of the part as they are set, all others with their defaults: what a function reads beyond its part cannot depend on what a
    /// user has set, and so needs no place in a key.
    pub config: Config,
    /// The options of the part by dotted name, for a key.
    pub keyed: BTreeMap<String, String>,
}

impl Config {
    /// The options of these names: sections (`fit`) or single options (`fit.confidence`).
    ///
    /// # Errors
    /// An option that TOML cannot hold, or a name that no option has.
    pub fn part(&self, names: &[&str]) -> Result<Part> {
        let set = Table::try_from(self).map_err(Error::internal)?;
        let mut all = Table::try_from(Config::default()).map_err(Error::internal)?;
        let mut keyed = BTreeMap::new();
        for name in names {
            let (section, option) = name.split_once('.').map_or((*name, None), named);
            let missing = || Error::Internal(format!("there is no section {name}"));
            let options = set.get(section).and_then(Value::as_table);
            let options = options.ok_or_else(missing)?.iter();
            let meant = |(key, _): &(&String, _)| option.is_none_or(|option| option == *key);
            let meant: Table = options
                .filter(meant)
                .map(|(key, value)| (key.clone(), value.clone()))
                .collect();
            if meant.is_empty() {
                return Err(missing());
            }
            keyed.extend(flatten(section, &meant)?);
            let place = all.entry(section).or_insert_with(|| Table::new().into());
            match (option, place) {
                (Some(_), Value::Table(defaults)) => defaults.extend(meant),
                (_, whole) => *whole = meant.into(),
            }
        }
        let config = all.try_into().map_err(Error::internal)?;
        Ok(Part { config, keyed })
    }
}

fn named<'n>((section, option): (&'n str, &'n str)) -> (&'n str, Option<&'n str>) {
    (section, Some(option))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_has_what_is_named_and_nothing_else_of_what_is_set() {
        let mut set = Config::default();
        set.fit.confidence = 0.9;
        set.fit.seed += 1;
        set.diagnose.draws = 49;
        let part = set.part(&["fit.confidence", "diagnose"]).unwrap();
        assert_eq!(part.keyed["fit.confidence"], "0.9");
        assert_eq!(part.keyed["diagnose.draws"], "49");
        assert!(!part.keyed.contains_key("fit.seed"));
        let mut expected = Config::default();
        expected.fit.confidence = 0.9;
        expected.diagnose.draws = 49;
        assert_eq!(part.config, expected);
        let whole = ["clean", "fit", "compare", "diagnose", "torque", "report"];
        let whole = set.part(&whole).unwrap();
        assert_eq!(whole.config, set);
        assert_eq!(whole.keyed, set.flattened().unwrap());
        assert_eq!(set.part(&[]).unwrap().config, Config::default());
    }

    #[test]
    fn a_name_that_no_option_has_is_a_mistake() {
        for name in ["fits", "fit.confidense"] {
            assert!(Config::default().part(&[name]).is_err(), "{name}");
        }
    }
}
