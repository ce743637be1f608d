//! The force paper's split: by row, four fifths to train on and one fifth to validate with.
//!
//! Rows of one log lie on both sides of it, so that it says how well a surface interpolates between readings of actuators that it has seen,
//! and nothing about others; leave-one-specimen-out is the number for that. Each session is dealt by a stream of its own, so that a session
//! that is added or removed moves no row of another; a session with a role keeps it.

use pipeline_base::random::Stream;
use pipeline_base::row::Row;
use pipeline_base::session::Role;
use pipeline_config::FitOptions;
use std::collections::BTreeMap;

/// The side on which a row lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Fitted.
    Train,
    /// Predicted.
    Validation,
}

impl Part {
    /// What tables and files call it.
    pub fn name(self) -> &'static str {
        match self {
            Part::Train => "train",
            Part::Validation => "validation",
        }
    }
}

/// The part of every row; none for rows that their owner holds out.
pub fn by_row(rows: &[&Row], options: &FitOptions) -> Vec<Option<Part>> {
    let mut parts = vec![None; rows.len()];
    let mut of_session: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (k, row) in rows.iter().enumerate() {
        match row.role {
            None => of_session.entry(&row.session).or_default().push(k),
            Some(Role::Train) => parts[k] = Some(Part::Train),
            Some(Role::Validation) => parts[k] = Some(Part::Validation),
            Some(Role::Holdout) => {}
        }
    }
    for (session, mut members) in of_session {
        let mut stream = Stream::new(options.seed, &["split by row", session]);
        for k in (1..members.len()).rev() {
            members.swap(k, stream.below(k + 1));
        }
        let train = (options.train_fraction * members.len() as f64).round() as usize;
        for (place, k) in members.into_iter().enumerate() {
            parts[k] = Some(if place < train {
                Part::Train
            } else {
                Part::Validation
            });
        }
    }
    parts
}

/// The rows of one part.
pub fn part<'a>(rows: &[&'a Row], parts: &[Option<Part>], wanted: Part) -> Vec<&'a Row> {
    let pairs = rows.iter().zip(parts);
    pairs
        .filter(|(_, p)| **p == Some(wanted))
        .map(|(r, _)| *r)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(session: &str, n: usize, role: Option<Role>) -> Vec<Row> {
        let mut row = Row::blank();
        row.session = session.to_owned();
        row.role = role;
        vec![row; n]
    }

    #[test]
    fn four_fifths_of_each_session_and_no_session_moves_another() {
        let options = FitOptions::default();
        let (a, b) = (rows("a", 40, None), rows("b", 15, None));
        let both: Vec<&Row> = a.iter().chain(&b).collect();
        let parts = by_row(&both, &options);
        let train = |p: &[Option<Part>]| p.iter().filter(|p| **p == Some(Part::Train)).count();
        assert_eq!((train(&parts[..40]), train(&parts[40..])), (32, 12));
        let alone: Vec<&Row> = b.iter().collect();
        assert_eq!(by_row(&alone, &options), parts[40..]);
        let other = FitOptions {
            seed: 2,
            ..FitOptions::default()
        };
        assert_ne!(by_row(&both, &other), parts);
    }

    #[test]
    fn a_role_stands() {
        let held: Vec<Row> = [Role::Train, Role::Validation, Role::Holdout]
            .into_iter()
            .flat_map(|role| rows("s", 1, Some(role)))
            .collect();
        let held: Vec<&Row> = held.iter().collect();
        let parts = by_row(&held, &FitOptions::default());
        assert_eq!(parts, [Some(Part::Train), Some(Part::Validation), None]);
    }
}
