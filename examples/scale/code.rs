//! Makes a cache look as if the code of the models had been another one when it was filled.

use pipeline::base::digest::Digest;
use pipeline::cache::{State, Store};
use pipeline::run::cache::STATE;
use std::error::Error;
use std::path::Path;

/// The stages whose sources hold the models.
const STAGES: [&str; 5] = ["fit", "compare", "diagnose", "torque", "report"];

/// Gives the entries of these stages another fingerprint of their code, hence another key, in the state of the last run as well.
///
/// # Errors
/// The cache cannot be read or written.
pub fn pretend_other_models(derived: &Path) -> Result<(), Box<dyn Error>> {
    let store = Store::new(&derived.join("cache"));
    let mut state: State = store.read_aside(STATE);
    for (unit, left) in &mut state {
        if !STAGES.iter().any(|s| unit.starts_with(&format!("{s}/"))) {
            continue;
        }
        let mut entry = store.recorded(&left.key).ok_or("an entry is missing")?;
        store.forget(&left.key);
        entry.parts.code = Digest::of(b"other models").to_string();
        left.key = entry.parts.key();
        store.put_entry(&entry).map_err(|e| e.to_string())?;
    }
    store
        .write_aside(STATE, &state)
        .map_err(|e| e.to_string())?;
    Ok(())
}
