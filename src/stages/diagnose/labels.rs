//! Columns of words: a load cell, a bench, an operator. They measure nothing; where a session has one word, they name groups of sessions.

use super::data::{Data, Extra};
use pipeline_base::row::{NO_LABEL, Row, label_names};
use pipeline_inference::decisions::FEWEST;
use pipeline_numerics::statistics::mean;
use std::collections::BTreeSet;

/// The columns of words that name groups of sessions, and remarks on those that do not.
pub fn labels(rows: &[&Row], data: &Data) -> (Vec<Extra>, Vec<String>) {
    let (mut extras, mut notes) = (Vec::new(), Vec::new());
    for name in label_names(rows.iter().copied()) {
        // Where a session says nothing, that is a group of its own.
        let word = |r: &&Row| r.label(&name).unwrap_or_else(|| NO_LABEL.to_owned());
        let words: Vec<String> = rows.iter().map(word).collect();
        let distinct: BTreeSet<&String> = words.iter().collect();
        if distinct.len() < 2 {
            continue;
        }
        let mut of_session: Vec<Option<&String>> = vec![None; data.sessions.len()];
        let differs = words.iter().zip(&data.session).find(|(w, s)| {
            let first = *of_session[**s].get_or_insert(w);
            first != *w
        });
        if let Some((_, s)) = differs {
            notes.push(format!(
                "The column {name} holds words that differ within a session (first in {}), and is not searched.",
                data.sessions[*s]
            ));
        } else if FEWEST * distinct.len() > data.sessions.len() {
            notes.push(format!(
                "The column {name} names {} groups in {} sessions, too many to be searched.",
                distinct.len(),
                data.sessions.len()
            ));
        } else {
            extras.push(named_groups(name, &words, &distinct));
        }
    }
    (extras, notes)
}

fn named_groups(name: String, words: &[String], distinct: &BTreeSet<&String>) -> Extra {
    let place = |w: &String| distinct.iter().position(|d| *d == w).unwrap_or(0) as f64;
    let numbers: Vec<f64> = words.iter().map(place).collect();
    let middle = mean(&numbers);
    let squares: Vec<f64> = numbers
        .iter()
        .map(|x| (x - middle) * (x - middle))
        .collect();
    let sd = mean(&squares).sqrt();
    Extra {
        name,
        values: numbers.iter().map(|x| (x - middle) / sd).collect(),
        scale: (middle, sd),
        constant_in_sessions: true,
        names_groups: true,
        words: distinct.iter().map(|w| (*w).clone()).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two readings in each of six sessions.
    fn data(word: impl Fn(usize, usize) -> Option<&'static str>) -> Data {
        let row = |k: usize| {
            let mut row = Row::blank();
            row.session = format!("s{}", k / 2);
            row.specimen = "a".to_owned();
            let word = word(k / 2, k % 2).map(|w| ("bench".to_owned(), w.to_owned()));
            row.labels.extend(word);
            row
        };
        let rows: Vec<Row> = (0..12).map(row).collect();
        Data::new(&rows.iter().collect::<Vec<&Row>>())
    }

    #[test]
    fn words_that_sessions_share_are_levels_and_silence_is_one_of_them() {
        let data = data(|s, _| (s % 2 == 0).then_some("bench A"));
        let extra = &data.extras[0];
        assert!(extra.names_groups && data.notes.is_empty());
        let (levels, others) = data.levels(0);
        assert_eq!(others, 1);
        let names = data.level_names(0);
        for (s, level) in levels.into_iter().enumerate() {
            let name = &names[level.map_or(0, |l| l + 1)];
            assert_eq!(name, ["bench A", "not named"][s % 2]);
        }
    }

    #[test]
    fn words_that_differ_within_a_session_or_with_every_session_are_no_levels() {
        let within = data(|_, k| Some(["A", "B"][k]));
        assert!(within.extras.is_empty());
        assert!(within.notes[0].contains("differ within a session (first in s0)"));
        let many = data(|s, _| Some(["A", "B", "C"][s % 3]));
        assert!(many.extras.is_empty() && many.notes[0].contains("3 groups in 6 sessions"));
        let one = data(|_, _| Some("A"));
        assert!(one.extras.is_empty() && one.notes.is_empty());
    }
}
