//! The zero of the force.

use crate::population::Known;
use crate::{Check, Seen, State, others};
use pipeline_base::session::{Sampling, Session};
use pipeline_clean::Cleaned;
use pipeline_clean::zero::ZeroSource;
use pipeline_fit::zeros::{Beside, FAR_FROM_OTHERS, beside_others};
use std::collections::BTreeMap;

/// Share of a zero log at the converter's limit from which somebody should look.
const CLIPPED: f64 = 0.01;
/// The zero against the slack actuator, and against other sessions.
pub fn checks(session: &Session, cleaned: &Cleaned, known: &Known) -> Vec<Check> {
    let Some(zero) = &cleaned.header.zero else {
        return Vec::new();
    };
    // Where no reading is left, it is no question of the zero.
    if cleaned.readings.is_empty() && zero.source == ZeroSource::None {
        return Vec::new();
    }
    let series = session.sampling == Sampling::Timeseries;
    let nothing = series && zero.source == ZeroSource::None;
    let clipped = zero.zero_log_clipped.is_some_and(|share| share > CLIPPED);
    let look = zero.contradicted || clipped || nothing;
    let mut all = vec![Check {
        log: None,
        state: if look { State::Look } else { State::Fine },
        seen: Seen::Zero {
            source: zero.source.name(),
            applied_n: zero.applied_n,
            clipped: zero.zero_log_clipped,
            slack_n: zero.slack_n,
        },
    }];
    if zero.source != ZeroSource::None {
        all.extend(of_others(session, zero.applied_n, known));
    }
    all
}

/// The zero beside those of the other sessions of the campaign; none where these are too few.
fn of_others(session: &Session, applied_n: f64, known: &Known) -> Option<Check> {
    let mut zeros = BTreeMap::new();
    for row in others(&known.rows, session).filter(|r| r.campaign == session.campaign) {
        if row.zero_force_n.is_finite() {
            zeros.insert(&row.session, row.zero_force_n);
        }
    }
    let zeros: Vec<f64> = zeros.into_values().collect();
    let Beside { median, deviations } = beside_others(applied_n, &zeros)?;
    Some(Check {
        log: None,
        state: if deviations.abs() > FAR_FROM_OTHERS {
            State::Look
        } else {
            State::Fine
        },
        seen: Seen::ZeroOfOthers {
            applied_n,
            usual_n: median,
            deviations,
            sessions: zeros.len(),
        },
    })
}
