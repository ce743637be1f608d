//! Whether the columns of a session may be meant otherwise than `session.toml` has it.
//!
//! A wrong sign, unit or exchange of columns may leave no reading to judge: cleaning throws away what no sensor can have shown. So the logs are
//! read again with each of these mistakes taken back. Where the readings as described do not suit others and those of another description do,
//! the one that suits best is named. Lengths are the business of [`crate::population`].

use crate::population::{Known, Suit};
use crate::{Check, Seen, State, normalized, population};
use pipeline_base::columns::{FORCE, PRESSURE};
use pipeline_base::session::{ColumnSpec, Session};
use pipeline_base::units::Quantity;
use pipeline_config::Config;
use pipeline_findings::ErrorKind;
use pipeline_formats::discover::Located;
use pipeline_ingest::LogBytes;
use rayon::prelude::*;
use serde::Serialize;

/// Another description of the columns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Otherwise {
    /// The mistake that it takes back: exchanged columns, a sign or a unit.
    pub kind: ErrorKind,
    /// The column; none of exchanged ones.
    pub column: Option<&'static str>,
    /// Of a unit: as noted, and as it looks.
    pub units: Option<(String, &'static str)>,
}

/// The check of the columns of a session that does not suit others as it is described; none where no other description suits either.
pub(crate) fn check(
    (located, session): (&Located, &Session),
    files: &[LogBytes],
    as_described: &Suit,
    config: &Config,
    known: &Known,
) -> Option<Check> {
    let suits = |(otherwise, session): (Otherwise, Session)| {
        let rows = normalized(located, &session, files.to_vec(), config).rows;
        let suit = population::suit(&session, &rows, known)?;
        let is_no_less = suit.readings >= as_described.readings;
        (is_no_less && suit.tells_gain() && !suit.is_unusual()).then_some((otherwise, suit))
    };
    let all: Vec<(Otherwise, Suit)> = descriptions(session)
        .into_par_iter()
        .filter_map(suits)
        .collect();
    let (otherwise, suit) = all
        .into_iter()
        .min_by(|a, b| a.1.off().total_cmp(&b.1.off()))?;
    Some(Check {
        log: None,
        state: State::Bad,
        seen: Seen::Columns {
            otherwise,
            readings: suit.readings,
            rms_n: suit.rms_n,
            usual_n: suit.usual_n,
        },
    })
}

/// The session with each mistake of its description taken back.
fn descriptions(session: &Session) -> Vec<(Otherwise, Session)> {
    let with = |change: &dyn Fn(&mut ColumnSpec), name: &str| {
        let mut other = session.clone();
        let found = other.columns.iter_mut().find(|c| c.column == name)?;
        change(found);
        Some(other)
    };
    let mut all = Vec::new();
    if let Some(other) = exchanged(session) {
        let otherwise = Otherwise {
            kind: ErrorKind::SwappedColumns,
            column: None,
            units: None,
        };
        all.push((otherwise, other));
    }
    let turned = |c: &mut ColumnSpec| {
        c.factor = -c.factor;
        c.constant = -c.constant;
    };
    for name in [FORCE, PRESSURE] {
        let otherwise = Otherwise {
            kind: ErrorKind::Sign,
            column: Some(name),
            units: None,
        };
        all.extend(with(&turned, name).map(|other| (otherwise, other)));
    }
    for (name, quantity) in [(FORCE, Quantity::Force), (PRESSURE, Quantity::Pressure)] {
        let noted = session
            .column(name)
            .and_then(|c| Some((&c.unit, quantity.unit(&c.unit)?)));
        let Some((symbol, noted)) = noted else {
            continue;
        };
        for unit in quantity.units().filter(|u| u.symbol != noted.symbol) {
            let times = unit.to_inside(1.0) / noted.to_inside(1.0);
            let scaled = |c: &mut ColumnSpec| {
                c.factor *= times;
                c.constant *= times;
            };
            let otherwise = Otherwise {
                kind: ErrorKind::Unit,
                column: Some(name),
                units: Some((symbol.clone(), unit.symbol)),
            };
            all.extend(with(&scaled, name).map(|other| (otherwise, other)));
        }
    }
    all
}

/// With force and pressure in each other's place in the logs.
fn exchanged(session: &Session) -> Option<Session> {
    let place = |name: &str| session.columns.iter().position(|c| c.column == name);
    let (force, pressure) = (place(FORCE)?, place(PRESSURE)?);
    let mut other = session.clone();
    other.columns[force].position = session.columns[pressure].position.clone();
    other.columns[pressure].position = session.columns[force].position.clone();
    Some(other)
}
