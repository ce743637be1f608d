//! How much the page holds, so that it opens at once whatever the laboratory: of many readings and logs an even share.

use crate::input::SessionInput;
use pipeline_base::row::Row;
use pipeline_base::session::Sampling;
use std::collections::BTreeSet;

/// Most readings of one kind on the page of a whole laboratory.
pub const MOST_READINGS: usize = 9_000;
/// Most logs of which the page of a whole laboratory has a trace.
const MOST_LOGS: usize = 400;

/// What a page is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent<'a> {
    /// Everything, as far as it fits.
    Laboratory,
    /// One campaign in full.
    Campaign(&'a str),
}

impl Extent<'_> {
    /// Whether the page may have readings of a campaign.
    pub fn takes(self, campaign: &str) -> bool {
        match self {
            Extent::Laboratory => true,
            Extent::Campaign(id) => id == campaign,
        }
    }

    /// Of some readings, by place, those that fit on the page: every campaign is thinned alike, evenly along its sessions.
    pub fn thinned(self, places: Vec<usize>) -> Vec<usize> {
        match self {
            Extent::Laboratory => evenly(places, MOST_READINGS),
            Extent::Campaign(_) => places,
        }
    }

    /// The logs of which the page shows a trace, as places of session and log: time series with readings.
    pub fn logs(self, sessions: &[SessionInput], rows: &[Row]) -> Vec<(usize, usize)> {
        let of_rows = rows.iter().filter(|r| self.takes(&r.campaign));
        let with_readings: BTreeSet<(&str, &str)> = of_rows
            .map(|r| (r.session.as_str(), r.log.as_str()))
            .collect();
        let mut found = Vec::new();
        for (place, input) in sessions.iter().enumerate() {
            let session = &input.ingest.session;
            if session.sampling != Sampling::Timeseries {
                continue;
            }
            for (log, header) in input.ingest.logs.iter().enumerate() {
                let name = header.spec.name();
                if with_readings.contains(&(session.id.as_str(), name.as_str())) {
                    found.push((place, log));
                }
            }
        }
        match self {
            Extent::Laboratory => evenly(found, MOST_LOGS),
            Extent::Campaign(_) => found,
        }
    }
}

/// At most so many of a list, evenly along it.
fn evenly<T>(list: Vec<T>, most: usize) -> Vec<T> {
    let (all, kept) = (list.len(), list.len().min(most));
    let takes = |k: usize| k * kept / all != (k + 1) * kept / all;
    let numbered = list.into_iter().enumerate();
    numbered
        .filter(|(k, _)| takes(*k))
        .map(|(_, x)| x)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_is_of_the_size_asked_for_and_spread_evenly() {
        assert_eq!(evenly((0..10).collect(), 20), Vec::from_iter(0..10));
        let some = evenly((0..1000).collect::<Vec<usize>>(), 100);
        assert_eq!(some.len(), 100);
        assert!(some.windows(2).all(|w| w[1] - w[0] == 10));
        assert!(evenly(Vec::<usize>::new(), 5).is_empty());
    }
}
