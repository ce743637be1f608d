//! What the conditions of a campaign's readings are counted from: further readings are counted from the same.

use super::{Data, temperature};
use pipeline_base::row::Row;
use pipeline_numerics::statistics::{mean, median};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Origins of a campaign.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Origins {
    /// Middle of the resting lengths, m.
    pub middle_rest_length_m: f64,
    /// Mean temperature, degrees; none where nobody logged it.
    pub mean_temperature_c: Option<f64>,
    /// Median over the sessions of the zero that was taken off the force, N; none where none was.
    pub usual_zero_n: Option<f64>,
    /// Place of each session in time, from 0 to 1; empty where sessions have no dates.
    pub campaign_time: BTreeMap<String, f64>,
}

impl Origins {
    /// Those of some rows, with the sessions of their data.
    pub(super) fn of(rows: &[&Row], data: &Data, dated: bool) -> Self {
        let lengths: BTreeSet<u64> = rows.iter().map(|r| r.rest_length_m.to_bits()).collect();
        let lengths: Vec<f64> = lengths.into_iter().map(f64::from_bits).collect();
        let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let temperatures = rows.iter().map(|r| temperature(r));
        let temperatures: Vec<f64> = temperatures.filter(|t| t.is_finite()).collect();
        let last = data.sessions.len().saturating_sub(1).max(1) as f64;
        let times = data.sessions.iter().enumerate();
        let times = times.map(|(k, s)| (s.clone(), k as f64 / last));
        Self {
            middle_rest_length_m: 0.5 * (shortest + longest),
            mean_temperature_c: (!temperatures.is_empty()).then(|| mean(&temperatures)),
            usual_zero_n: usual_zero(rows, data),
            campaign_time: if dated {
                times.collect()
            } else {
                BTreeMap::new()
            },
        }
    }

    /// Whether sessions have a place in time.
    pub(super) fn is_dated(&self) -> bool {
        !self.campaign_time.is_empty()
    }

    /// The place in time of a session to come.
    pub(crate) fn later(&self) -> f64 {
        f64::from(u8::from(self.is_dated()))
    }

    /// The place of a session in time: one that is not of the campaign comes after it.
    pub(super) fn campaign_time(&self, session: &str) -> f64 {
        let own = self.campaign_time.get(session).copied();
        own.unwrap_or_else(|| self.later())
    }
}

/// Median over the sessions of the zero that was taken off the force, N.
fn usual_zero(rows: &[&Row], data: &Data) -> Option<f64> {
    let mut zeros = vec![f64::NAN; data.sessions.len()];
    for (r, s) in rows.iter().zip(&data.session) {
        zeros[*s] = r.zero_force_n;
    }
    zeros.retain(|z| z.is_finite());
    (!zeros.is_empty()).then(|| median(&zeros))
}
