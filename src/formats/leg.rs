//! The leg of a torque session: the file of a laboratory's own leg is read along with `session.toml`, and the route has to be there.

use super::discover::{SESSION_FILE, read_text};
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::session::Session;
use pipeline_mechanics::knee::choice;
use std::path::Path;

/// The session with the text of its own leg, if it has one.
///
/// # Errors
/// Every mistake of the file, or a route that the knee does not have.
pub fn complete(
    mut session: Session,
    directory: &Path,
    relative: &str,
) -> Result<Session, Vec<Diagnostic>> {
    let diameter_mm = session.specimen.diameter_mm;
    let Some(joint) = &mut session.joint else {
        return Ok(session);
    };
    if let Some(own) = &mut joint.description {
        let file = format!("{relative}/{}", own.file);
        own.text = read_text(&directory.join(&own.file), &file).map_err(|d| vec![d])?;
    }
    choice::choose(joint, diameter_mm, relative, SESSION_FILE)?;
    Ok(session)
}
