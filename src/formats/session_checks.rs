//! What the parts of a `session.toml` have to say together: columns that are needed, logs that measure, a length that the specimen can have.

use super::session_toml::split_unit;
use pipeline_base::columns;
use pipeline_base::normalized::CONTRACTION_RANGE;
use pipeline_base::session::{ColumnSpec, Kind, Position, Sampling, Session};
use pipeline_base::toml_reader::Section;

/// Looks at a session whose parts are all right by themselves; mistakes go to the reader.
pub fn check(root: &Section, session: &Session) {
    check_columns(root, session);
    check_positions(root, session);
    check_logs(root, session);
    check_held_length(root, session);
}

/// The columns that this kind and sampling cannot do without.
fn check_columns(root: &Section, session: &Session) {
    let mut needed: Vec<&str> = match session.kind {
        Kind::Isometric => vec![columns::FORCE, columns::PRESSURE],
        Kind::KneeTorque => vec![columns::TORQUE, columns::ANGLE, columns::PRESSURE],
    };
    if session.sampling == Sampling::Timeseries {
        needed.push(columns::TIME);
    }
    if session.kind == Kind::Isometric {
        needed.push(columns::LENGTH);
    }
    for column in needed {
        let name = columns::KNOWN
            .iter()
            .find(|k| k.column == column)
            .map_or(column, |k| k.quantity_name);
        let constant = session.setup.contains_key(column) && column != columns::TIME;
        if session.column(column).is_none() && !constant {
            root.reader().report(
                root.line(),
                &format!("columns.{name}"),
                "nothing",
                &format!("the column `{name}`, or where it is constant the set-up's `{column}`"),
                "say where it is in the log",
            );
        }
    }
}

/// The length that was held has to be one that the specimen can have.
fn check_held_length(root: &Section, session: &Session) {
    let Some(length) = session.setup_number(columns::LENGTH) else {
        return;
    };
    let Some(setup) = root.get("setup").and_then(|e| e.table()) else {
        return;
    };
    let rest = session.specimen.rest_length_m;
    let (low, high) = CONTRACTION_RANGE;
    let contraction = (rest - length) / rest;
    let held = setup.entries();
    let held = held
        .iter()
        .find(|(key, _)| split_unit(key).is_some_and(|(known, _)| known.column == columns::LENGTH));
    if let (Some((_, entry)), false) = (held, (low..=high).contains(&contraction)) {
        let (shortest, longest) = (1e3 * rest * (1.0 - high), 1e3 * rest * (1.0 - low));
        entry.reject_for(
            &format!("{} mm", 1e3 * length),
            &format!(
                "a length of {shortest:.0} to {longest:.0} mm, as a specimen of {} mm can have",
                1e3 * rest
            ),
            "check the length, its unit, and `rest_length_mm`",
        );
    }
}

fn check_positions(root: &Section, session: &Session) {
    let by_name = |c: &&ColumnSpec| matches!(c.position, Position::Name(_));
    let named = session.columns.iter().filter(by_name).count();
    if named != 0 && named != session.columns.len() {
        root.reader().report(
            root.line(),
            "columns",
            "some columns by `index` and some by `name`",
            "all by `index` (files without header) or all by `name` (files with a header line)",
            "use one way for all columns",
        );
    }
}

fn check_logs(root: &Section, session: &Session) {
    let measuring = session.logs.iter().filter(|l| !l.is_zero).count();
    if measuring == 0 {
        root.reader().report(
            root.line(),
            "log",
            format!("{} zero logs and no other", session.logs.len()),
            "at least one [[log]] that measures",
            "add it, or remove role = \"zero\"",
        );
    }
    for (k, log) in session.logs.iter().enumerate() {
        if session.logs[..k].iter().any(|l| l.name() == log.name()) {
            root.reader().report(
                root.line(),
                &format!("log[{k}].file"),
                format!("\"{}\" a second time", log.name()),
                "every log once",
                "remove one of them",
            );
        }
    }
}
