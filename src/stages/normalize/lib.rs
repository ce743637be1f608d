#![warn(missing_docs)]
//! Normalize: readings with what is known of their specimen, and the dimensionless numbers of the force paper
//! ([`pipeline_base::normalized`]).

use pipeline_base::normalized::{CONTRACTION_RANGE, row};
use pipeline_base::reading::Reading;
use pipeline_base::reject::{Extent, Reject};
use pipeline_base::row::Row;
use pipeline_base::session::Session;

/// Raised when results change without a change of this stage's source files.
pub const VERSION: u32 = 1;

/// Why no reading is left: what was logged, and what the specimen can have.
fn no_length_fits(session: &Session, readings: &[Reading]) -> String {
    let lengths = readings.iter().map(|r| 1e3 * row(session, r).length_m);
    let (low, high) = lengths.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    let rest = 1e3 * session.specimen.rest_length_m;
    let (least, most) = CONTRACTION_RANGE;
    format!(
        "no reading has a length that fits the specimen: found {low:.3} to {high:.3} mm, expected {:.0} to {:.0} mm; check the unit of the length in [columns]",
        rest * (1.0 - most),
        rest * (1.0 - least)
    )
}

/// The rows of one session, and the readings that could not be normalised.
pub fn normalize(session: &Session, readings: &[Reading]) -> (Vec<Row>, Vec<Reject>) {
    let mut rejects = Vec::new();
    let mut rows = Vec::with_capacity(readings.len());
    for reading in readings {
        let row = row(session, reading);
        if !row.length_m.is_nan()
            && !(CONTRACTION_RANGE.0..=CONTRACTION_RANGE.1).contains(&row.contraction)
        {
            rejects.push(Reject {
                session: session.id.clone(),
                log: reading.log.clone(),
                first_row: Some(reading.first_row as u64),
                last_row: Some(reading.last_row as u64),
                count: reading.samples as u64,
                extent: Extent::Plateau,
                reason: "a length that gives a contraction outside -30% to 60%".to_owned(),
            });
        } else {
            rows.push(row);
        }
    }
    if rows.is_empty() && !readings.is_empty() {
        rejects.push(Reject {
            session: session.id.clone(),
            log: String::new(),
            first_row: None,
            last_row: None,
            count: 0,
            extent: Extent::Session,
            reason: no_length_fits(session, readings),
        });
    }
    (rows, rejects)
}
