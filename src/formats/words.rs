//! Columns of words in a log: when a column is one, and what stands in it.

use polars::prelude::*;

/// What people write where they have nothing to say, in small letters.
const NOTHING: &[&str] = &["", "na", "n/a", "null", "-", "--"];

fn says_nothing(text: &str) -> bool {
    NOTHING.contains(&text.trim().to_ascii_lowercase().as_str())
}

/// The number that a cell holds; NaN where it holds none.
pub fn number(text: &str) -> f64 {
    text.trim().parse().unwrap_or(f64::NAN)
}

/// Whether most of the cells in which something stands are no numbers.
pub fn are_words(texts: &StringChunked) -> bool {
    let said = texts.iter().flatten().filter(|t| !says_nothing(t));
    let (words, all) = said.fold((0, 0), |(words, all), text| {
        (
            words + usize::from(text.trim().parse::<f64>().is_err()),
            all + 1,
        )
    });
    2 * words > all
}

/// The words of a column; none where nothing is said.
pub fn words(texts: &StringChunked) -> Vec<Option<String>> {
    let word = |text: &str| (!says_nothing(text)).then(|| text.trim().to_owned());
    texts.iter().map(|t| t.and_then(word)).collect()
}

#[cfg(test)]
mod tests {
    use crate::log::{Request, read};
    use pipeline_base::session::{Cells, Position};

    #[test]
    fn a_column_of_words_is_one_where_most_cells_are_words_or_where_it_is_declared() {
        let read_as = |cells: Cells, text: &str| {
            let request = Request {
                name: "c1".to_owned(),
                position: Position::Index(1),
                cells,
                codes: Vec::new(),
            };
            read("t", text.as_bytes(), None, &[request]).unwrap()
        };
        let mixed = "1, bench A\n2,\"bench B\"\n3,n/a\n4,7\n";
        let words = ["bench A", "bench B", "", "7"].map(|w| (!w.is_empty()).then(|| w.to_owned()));
        let log = read_as(Cells::Either, mixed);
        assert_eq!((&log.words[&0][..], log.bad_cell_count), (&words[..], 0));
        assert!(log.columns[0].is_empty());
        let log = read_as(Cells::Either, "1,40\n2,41\n3,wet\n");
        assert_eq!(log.columns[0][..2], [40.0, 41.0]);
        assert_eq!(
            (log.bad_cells[0].found.as_str(), log.bad_cells[0].of),
            ("\"wet\"", 1)
        );
        let log = read_as(Cells::Words, "1,40\n2,41\n");
        assert_eq!(log.words[&0][1].as_deref(), Some("41"));
        assert_eq!(read_as(Cells::Numbers, mixed).bad_cell_count, 3);
    }
}
