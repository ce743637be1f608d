//! A log that nobody has described yet: one panel a column, over time, in the units that it may have.

use crate::figures::Named;
use crate::figures::formatting::verbatim;
use crate::plot::{Axis, DOUBLE_MM, Dash, Figure, Ink, Panel, Series, Stroke};
use pipeline_base::columns::TIME;
use pipeline_draft::{Draft, Guess};
use pipeline_formats::overview::place;

/// Height of a panel, mm.
const PANEL_MM: f64 = 38.0;
/// More panels than this are no figure; the columns that may be quantities come first.
const MOST_PANELS: usize = 8;
/// A line is drawn through the ends of so many stretches: finer than a printed hairline.
const STRETCHES: usize = 1000;

/// The log over time; nothing where no column holds numbers.
pub fn figure(draft: &Draft) -> Option<Named> {
    let time = draft.quantity(TIME);
    let (label, x) = match time {
        Some(time) => (label(time), time.numbers.clone()),
        None => {
            let rows = (1..=draft.rows).map(|k| k as f64);
            ("Row".to_owned(), rows.collect())
        }
    };
    let mut shown: Vec<&Guess> = draft.guesses.iter().filter(|g| is_drawn(g)).collect();
    shown.sort_by_key(|g| g.quantity.is_none());
    shown.truncate(MOST_PANELS);
    let height = PANEL_MM * shown.len() as f64 + 4.0;
    let title = format!("Log {}", draft.file);
    let mut figure = Figure::new(&title, DOUBLE_MM, height).grid(1);
    for (n, guess) in shown.iter().enumerate() {
        let points: Vec<(f64, f64)> = x
            .iter()
            .copied()
            .zip(guess.numbers.iter().copied())
            .collect();
        let stroke = Stroke::hair(INKS[n % INKS.len()], Dash::Solid);
        let panel = Panel::new(Axis::new(&label), Axis::new(&self::label(guess)));
        figure = figure.with(panel.with(Series::line("", thinned(points), stroke)));
    }
    (!shown.is_empty()).then(|| Named {
        name: "log".to_owned(),
        caption: format!("The log {} as it is in the file.", verbatim(&draft.file)),
        figure,
    })
}

const INKS: [Ink; 4] = [Ink::Blue, Ink::Vermilion, Ink::Green, Ink::Purple];

fn is_drawn(guess: &Guess) -> bool {
    guess.column() != Some(TIME) && guess.range().is_some()
}

fn label(guess: &Guess) -> String {
    let Some(quantity) = guess.quantity else {
        return verbatim(&place(&guess.position));
    };
    let mut name = quantity.quantity_name.replace('_', " ");
    if let Some(first) = name.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    match guess.unit {
        Some(unit) => format!("{name} ({})", unit.symbol),
        None => name,
    }
}

/// Smallest and largest value of every stretch, so that no spike is lost.
fn thinned(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    if points.len() <= 2 * STRETCHES {
        return points;
    }
    let stretch = points.len().div_ceil(STRETCHES);
    let ends = points.chunks(stretch).flat_map(|chunk| {
        let finite = || chunk.iter().copied().filter(|p| p.1.is_finite());
        let low = finite().min_by(|a, b| a.1.total_cmp(&b.1));
        let high = finite().max_by(|a, b| a.1.total_cmp(&b.1));
        let mut ends = [low, high];
        ends.sort_by(|a, b| {
            a.map(|p| p.0)
                .partial_cmp(&b.map(|p| p.0))
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        ends.into_iter().flatten()
    });
    ends.collect()
}
