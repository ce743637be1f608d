//! What the owner of a test doubts himself: notes that say so keep it out of every fit, as `exclude` does.

/// The part of some notes that says that a test is in doubt: the clause with one of the `words`, whole words of whatever case.
pub fn of(notes: &str, words: &[String]) -> Option<String> {
    let clauses = notes.split(';').flat_map(|part| part.split(". "));
    let mut clauses = clauses.map(|c| c.trim().trim_end_matches('.'));
    let doubts = |clause: &&str| {
        let lower = clause.to_lowercase();
        let mut all = lower.split(|c: char| !c.is_alphanumeric());
        all.any(|word| words.iter().any(|w| w.to_lowercase() == word))
    };
    clauses.find(doubts).map(str::to_owned)
}

#[cfg(test)]
mod unit {
    use super::of;

    fn doubt(notes: &str) -> Option<String> {
        of(
            notes,
            &["superseded", "excluded", "slipped"].map(str::to_owned),
        )
    }

    #[test]
    fn the_clause_that_doubts_is_quoted() {
        let notes = "pressure: average. l_620 given as 0.349; Excluded from the refit pool.";
        assert_eq!(
            doubt(notes).as_deref(),
            Some("Excluded from the refit pool")
        );
        assert_eq!(
            doubt("superseded; see the file").as_deref(),
            Some("superseded")
        );
    }

    #[test]
    fn other_notes_and_parts_of_words_are_no_doubt() {
        assert_eq!(doubt("pressure: assumed constant (spot checked)."), None);
        assert_eq!(doubt("the unexcluded one"), None);
        assert_eq!(doubt(""), None);
    }
}
