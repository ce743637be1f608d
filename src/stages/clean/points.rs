//! One reading for every row of points: they were steady when they were written down.

use crate::screen::Screened;
use crate::steady::CLIPPED;
use crate::zero::is_clipped;
use pipeline_base::columns::{FORCE, PHASE};
use pipeline_base::reading::Reading;
use pipeline_base::reject::{Extent, Reject};
use pipeline_base::session::{Phase, Session};

/// Adds the readings of one log of points; rows at the limit of the converter are left out.
pub fn readings(
    session: &Session,
    log: &Screened,
    readings: &mut Vec<Reading>,
    rejects: &mut Vec<Reject>,
) {
    let column = session.column(FORCE);
    for (k, row) in log.rows.iter().enumerate() {
        let line = log.line(k);
        let value = |name: &str| log.log.column(name).map_or(f64::NAN, |v| v[*row]);
        if column.is_some_and(|c| is_clipped(c, value(FORCE))) {
            rejects.push(Reject {
                session: session.id.clone(),
                log: log.log.spec.name(),
                first_row: Some(line),
                last_row: Some(line),
                count: 1,
                extent: Extent::Row,
                reason: CLIPPED.to_owned(),
            });
            continue;
        }
        readings.push(Reading {
            log: log.log.spec.name(),
            run: log.log.spec.run,
            first_row: line as i64,
            last_row: line as i64,
            phase: Phase::from_code(value(PHASE)),
            samples: 1,
            sd_force_n: f64::NAN,
            zero_force_n: f64::NAN,
            zero_pressure_kpa: f64::NAN,
            sd_pressure_kpa: f64::NAN,
            values: log
                .log
                .columns
                .iter()
                .filter(|(name, _)| name != PHASE)
                .map(|(name, values)| (name.clone(), values[*row]))
                .filter(|(_, x)| x.is_finite())
                .collect(),
            labels: log
                .log
                .labels
                .iter()
                .filter_map(|(name, words)| Some((name.clone(), words[*row].clone()?)))
                .collect(),
        });
    }
}
