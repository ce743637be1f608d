//! When the sessions of a campaign are measured: their order and their dates.
//!
//! ```toml
//! order = "shuffled"            # optional; "specimen" (one specimen after the other, as in the file) where it is left out
//! first_date = "2026-01-12"     # optional, instead of `date`: day of the first session
//! days_between = 0.5            # optional, with first_date: days from one session to the next, 1 where it is left out
//! ```

use super::rig_settings::within;
use pipeline_base::random::Stream;
use pipeline_base::toml_reader::{Entry, Section};
use serde::Serialize;

/// The order of the sessions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Order {
    /// Specimen by specimen, contraction by contraction.
    Specimen,
    /// In an order that is drawn.
    Shuffled,
}

/// Order and dates.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calendar {
    /// The order.
    pub order: Order,
    /// Day of the first session, days since 1970-01-01.
    pub first_day: Option<i64>,
    /// Days from one session to the next.
    pub days_between: f64,
}

impl Calendar {
    /// Reads the keys of the calendar; `dated` says that the file has a `date` for all sessions.
    pub fn read(root: &Section, dated: bool) -> Option<Self> {
        let words = [("specimen", Order::Specimen), ("shuffled", Order::Shuffled)];
        let order = root.get("order");
        let order = order.map_or(Some(Order::Specimen), |e| e.choice(&words));
        let first = root.get("first_date").map(|e| {
            if dated {
                e.reject("no `date` beside it", "leave out one of them");
                return None;
            }
            first_day(&e)
        });
        let days = root.get("days_between").map(|e| {
            if first.is_none() {
                e.reject("`first_date` beside it", "say when the first session was");
            }
            within(&e, 0.0, 365.0, "days", "0.5 is two sessions a day")
        });
        Some(Self {
            order: order?,
            first_day: match first {
                None => None,
                Some(day) => Some(day?),
            },
            days_between: days.unwrap_or(Some(1.0))?,
        })
    }

    /// Place in time of each of `n` sessions.
    pub fn places(&self, seed: u64, n: usize) -> Vec<usize> {
        let mut places: Vec<usize> = (0..n).collect();
        if self.order == Order::Shuffled {
            let mut stream = Stream::new(seed, &["order of sessions"]);
            for k in (1..n).rev() {
                places.swap(k, stream.below(k + 1));
            }
        }
        places
    }

    /// Date of the session at a place in time, ISO 8601.
    pub fn date(&self, place: usize) -> Option<String> {
        let days = (self.days_between * place as f64).floor() as i64;
        Some(iso(self.first_day? + days))
    }
}

fn first_day(entry: &Entry) -> Option<i64> {
    let text = entry.string()?;
    let parts: Vec<i64> = text.split('-').filter_map(|p| p.parse().ok()).collect();
    let day = match parts[..] {
        [y, m, d] if (1..=12).contains(&m) => Some(day_number(y, m, d)),
        _ => None,
    };
    // Only a date that is written as it would be printed is one: no 31st of June.
    let day = day.filter(|d| iso(*d) == text);
    if day.is_none() {
        entry.reject("a day, ISO 8601", "write \"2026-01-12\"");
    }
    day
}

/// Days since 1970-01-01 (Gregorian calendar; the year begins in March, so that the leap day is its last).
fn day_number(year: i64, month: i64, day: i64) -> i64 {
    let year = if month > 2 { year } else { year - 1 };
    let in_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    365 * year + year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400) + in_year
        - 719_468
}

fn iso(days: i64) -> String {
    // The mean year has 365.2425 days; at most one step off, which the loop mends.
    let mut year = 1970 + days * 400 / 146_097;
    while day_number(year + 1, 1, 1) <= days {
        year += 1;
    }
    while day_number(year, 1, 1) > days {
        year -= 1;
    }
    let month = (2..=12).rev().find(|m| day_number(year, *m, 1) <= days);
    let month = month.unwrap_or(1);
    let day = days - day_number(year, month, 1) + 1;
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_counted_through_leap_years_and_back() {
        assert_eq!(day_number(1970, 1, 1), 0);
        assert_eq!(day_number(2000, 3, 1), 11_017);
        for (days, text) in [
            (0, "1970-01-01"),
            (11_016, "2000-02-29"),
            (19_782, "2024-02-29"),
            (20_453, "2025-12-31"),
            (20_454, "2026-01-01"),
        ] {
            assert_eq!(iso(days), text);
        }
    }

    #[test]
    fn a_shuffled_order_holds_every_session_once() {
        let calendar = Calendar {
            order: Order::Shuffled,
            first_day: Some(20_454),
            days_between: 0.5,
        };
        let mut places = calendar.places(1, 24);
        assert_ne!(places, calendar.places(2, 24));
        places.sort_unstable();
        assert_eq!(places, (0..24).collect::<Vec<_>>());
        assert_eq!(calendar.date(3).as_deref(), Some("2026-01-02"));
    }
}
