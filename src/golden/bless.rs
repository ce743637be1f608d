//! Accepting the fresh tables as golden ones, with a reason that stays.

use crate::settings::{Settings, Tolerance};
use crate::{blessed, compare, fresh, settings_file};
use pipeline_base::error::{Error, Result};
use serde::Serialize;
use std::path::Path;

/// Name of the log of blessings.
pub const LOG: &str = "BLESSED.md";

const HEAD: &str = "# Blessed\n\nWhy the golden tables are what they are: one line a blessing, the latest last, written by \
                    `pipeline check --bless --reason \"why\"`.\n\n";

/// What a blessing changed in one table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Change {
    /// Table.
    pub table: String,
    /// Cells, rows and columns that are not what they were; of a table that had no golden one, its rows.
    pub changed: usize,
    /// Whether it had none.
    pub new: bool,
}

impl Change {
    /// In words: "3 changed".
    pub fn text(&self) -> String {
        match self.new {
            true => format!("new, {} rows", self.changed),
            false => format!("{} changed", self.changed),
        }
    }
}

/// What a blessing changed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Blessing {
    /// Why.
    pub reason: String,
    /// Tables that changed.
    pub changed: Vec<Change>,
    /// Golden tables that were taken away, having no entry in the settings any more.
    pub removed: Vec<String>,
}

impl Blessing {
    /// Whether anything changed.
    pub fn is_empty(&self) -> bool {
        self.changed.is_empty() && self.removed.is_empty()
    }

    fn line(&self) -> String {
        let changed = self.changed.iter();
        let mut parts: Vec<String> = changed
            .map(|c| format!("{} ({})", c.table, c.text()))
            .collect();
        parts.extend(self.removed.iter().map(|t| format!("{t} (taken away)")));
        format!(
            "- {} *Cells:* {}.\n",
            sentence(&self.reason),
            parts.join(", ")
        )
    }
}

/// The reason on one line, as a sentence.
fn sentence(reason: &str) -> String {
    let text = reason.split_whitespace().collect::<Vec<_>>().join(" ");
    if text.ends_with(['.', '!', '?']) {
        text
    } else {
        text + "."
    }
}

/// Writes the tables of the last run below `reports` as golden ones and appends to the log; writes nothing where nothing changed.
///
/// # Errors
/// No reason, no settings, a table of the settings that the run does not make, a file that cannot be written.
pub fn bless(golden: &Path, reports: &Path, reason: &str) -> Result<Blessing> {
    if reason.trim().is_empty() {
        return Err(Error::Usage(
            "--bless needs --reason \"why the new results are right\"; it is kept in the log"
                .to_owned(),
        ));
    }
    let settings = Settings::load(golden)?;
    let (old, new) = (blessed(golden)?, fresh(reports)?);
    if let Some(unmade) = settings.table.keys().find(|name| !new.contains_key(*name)) {
        return Err(Error::Usage(format!(
            "{} names the table {unmade}, which the run does not make; take its entry out",
            settings_file(golden)
        )));
    }
    let mut blessing = Blessing {
        reason: reason.trim().to_owned(),
        changed: Vec::new(),
        removed: Vec::new(),
    };
    for (name, of_table) in &settings.table {
        let fresh = &new[name];
        let changes = match old.get(name) {
            Some(old) => compare::tables(name, &of_table.key, &|_| Tolerance::EXACT, old, fresh)
                .differences
                .len(),
            None => fresh.rows.len(),
        };
        if changes == 0 && old.get(name) == Some(fresh) {
            continue;
        }
        let file = format!("{name}.csv");
        let (from, to) = (reports.join("tables").join(&file), golden.join(&file));
        std::fs::copy(&from, &to).map_err(Error::io("write", &to))?;
        let new = !old.contains_key(name);
        // A table of what a project does not have, such as torque, is kept and not worth a word.
        if new && changes == 0 {
            continue;
        }
        blessing.changed.push(Change {
            table: name.clone(),
            changed: changes,
            new,
        });
    }
    for name in old
        .keys()
        .filter(|name| !settings.table.contains_key(*name))
    {
        let path = golden.join(format!("{name}.csv"));
        std::fs::remove_file(&path).map_err(Error::io("remove", &path))?;
        blessing.removed.push(name.clone());
    }
    if !blessing.is_empty() {
        log(golden, &blessing)?;
    }
    Ok(blessing)
}

fn log(golden: &Path, blessing: &Blessing) -> Result<()> {
    let path = golden.join(LOG);
    let before = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => HEAD.to_owned(),
        Err(e) => return Err(Error::io("read", &path)(e)),
    };
    std::fs::write(&path, before + &blessing.line()).map_err(Error::io("write", &path))
}
