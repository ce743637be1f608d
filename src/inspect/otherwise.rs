//! Whether the columns of a session may be meant otherwise than `session.toml` has it.
//!
//! A wrong sign, unit or exchange of columns may leave no reading to judge: cleaning throws away what no sensor can have shown. So the logs are
//! read again with each of these mistakes taken back. Where the readings as described do not suit others and those of another description do,
//! the one that suits best is named; one that leaves the session unusual as well only if little of that is left. Lengths are the business of
//! [`crate::population`].

use crate::population::{Known, Suit};
use crate::{Check, Seen, State, normalized, population};
use pipeline_base::columns::{FORCE, PRESSURE};
use pipeline_base::row::Row;
use pipeline_base::session::{ColumnSpec, Session};
use pipeline_base::units::Quantity;
use pipeline_config::Config;
use pipeline_findings::ErrorKind;
use pipeline_formats::discover::Located;
use pipeline_ingest::LogBytes;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Another description of the columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Otherwise {
    /// The mistake that it takes back: exchanged columns, a sign or a unit.
    pub kind: ErrorKind,
    /// The column; none of exchanged ones.
    pub column: Option<String>,
    /// Of a unit: as noted, and as it looks.
    pub units: Option<(String, String)>,
}

/// Least share of the readings that another description has to keep: with force and pressure exchanged, other plateaus are steady.
const KEPT: f64 = 0.5;
/// Most that another description leaves of what is unusual about a session ([`Suit::off`]), if it does not make it usual: a unit is wrong by factors,
/// a session by a few standard deviations.
const LEFT_OF_IT: f64 = 0.1;

/// Whether readings of a session suit others.
pub(crate) type Suits<'a> = &'a (dyn Fn(&[Row], &Suit) -> bool + Sync);

/// The description of the columns with which a session suits others best, among those with which it `suits` at all, and how. `readings`: those
/// that there are as it is described.
pub(crate) fn best(
    (located, session): (&Located, &Session),
    files: &[LogBytes],
    (readings, suits): (usize, Suits),
    config: &Config,
    known: &Known,
) -> Option<(Otherwise, Suit)> {
    let with = |(otherwise, session): (Otherwise, Session)| {
        let rows = normalized(located, &session, files.to_vec(), config).rows;
        let suit = population::suit(&session, &rows, known)?;
        let keeps = suit.readings as f64 >= KEPT * readings as f64;
        (keeps && suit.tells_gain() && suits(&rows, &suit)).then_some((otherwise, suit))
    };
    let all: Vec<(Otherwise, Suit)> = descriptions(session)
        .into_par_iter()
        .filter_map(with)
        .collect();
    let by_misfit = |a: &(_, Suit), b: &(_, Suit)| a.1.off().total_cmp(&b.1.off());
    all.into_iter().min_by(by_misfit)
}

/// The check of the columns of a session that does not suit others as it is described; none where no other description suits either.
pub(crate) fn check(
    session: (&Located, &Session),
    files: &[LogBytes],
    as_described: &Suit,
    config: &Config,
    known: &Known,
) -> Option<Check> {
    // A session may be unusual beside a wrong unit.
    let suits: Suits =
        &|_, suit| !suit.is_unusual() || suit.off() < LEFT_OF_IT * as_described.off();
    let described = (as_described.readings, suits);
    let (otherwise, suit) = best(session, files, described, config, known)?;
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
            column: Some(name.to_owned()),
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
                column: Some(name.to_owned()),
                units: Some((symbol.clone(), unit.symbol.to_owned())),
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
