//! The table in Markdown: what was put in, how often it was found, and the bar.

use super::joint::Kind;
use super::rate::Rate;
use super::trial::Outcome;
use std::fmt::Write as _;

/// The rows with a bar, and a row for each form.
pub fn document(outcomes: &[Outcome]) -> String {
    let mut text = "\n| joint | result | bar | |\n|---|---|---|---|\n".to_owned();
    for by_hand in [true, false] {
        let own: Vec<&Outcome> = of(outcomes, |o| o.kind.by_hand == by_hand);
        let hands = if by_hand {
            "with lengths and arms by hand"
        } else {
            "torques alone"
        };
        let mut row = |case: &str, rate: Rate, (low, high): (f64, f64)| {
            if rate.of == 0 {
                return;
            }
            let met = (low..=high).contains(&rate.share());
            let met = if met { "met" } else { "**missed**" };
            let bar = match (low > 0.0, high < 1.0) {
                (true, true) => format!("{:.0}% to {:.0}%", 100.0 * low, 100.0 * high),
                (true, false) => format!("at least {:.0}%", 100.0 * low),
                _ => format!("at most {:.1}%", 100.0 * high),
            };
            let _ = writeln!(text, "| {hands}; {case} | {rate} | {bar} | {met} |");
        };
        let nothing = || own.iter().filter(|o| o.put.is_none());
        let anything = Rate::of(nothing().map(|o| !o.found.is_empty()));
        row(
            "nothing: an effect or a column found",
            anything,
            (0.0, 0.075),
        );
        let mistakes = Rate::of(nothing().map(|o| o.mistakes > 0));
        row(
            "nothing: a recording error pointed at",
            mistakes,
            (0.0, 0.075),
        );
        let one = || own.iter().filter(|o| o.put.is_some() && !o.capped);
        row(
            "one effect, 4 times the limit: it and nothing else",
            Rate::of(one().map(|o| o.exact)),
            (0.9, 1.0),
        );
        row(
            "the same: it, whatever else",
            Rate::of(one().map(|o| o.detected)),
            (0.9, 1.0),
        );
        let covered = Rate::of(own.iter().filter_map(|o| o.covered));
        row("intervals of those found cover", covered, (0.9, 0.98));
    }
    text.push_str(&capped(outcomes));
    text.push_str(&by_form(outcomes));
    text
}

fn of(outcomes: &[Outcome], keep: impl Fn(&Outcome) -> bool) -> Vec<&Outcome> {
    outcomes.iter().filter(|o| keep(o)).collect()
}

/// Joints whose effect would have been larger than parts of its kind are known to have.
fn capped(outcomes: &[Outcome]) -> String {
    let all = of(outcomes, |o| o.capped);
    let put = outcomes.iter().filter(|o| o.put.is_some()).count();
    format!(
        "\nIn {} of {put} joints four times the limit is more than parts of that kind were ever measured to have. With the largest size that is not, a \
         smaller multiple, it and nothing else was found in {}, it and whatever else in {}.\n",
        all.len(),
        all.iter().filter(|o| o.exact).count(),
        all.iter().filter(|o| o.detected).count()
    )
}

/// Form by form: how often exact, and what was found otherwise.
fn by_form(outcomes: &[Outcome]) -> String {
    let mut text =
        "\n| joint | put in | it and nothing else | it | otherwise |\n|---|---|---|---|---|\n"
            .to_owned();
    let mut rows: Vec<(Kind, Option<usize>)> = Vec::new();
    let place = |o: &Outcome| o.put.map(|p| p.first);
    for o in outcomes {
        if !rows.contains(&(o.kind, place(o))) {
            rows.push((o.kind, place(o)));
        }
    }
    rows.sort();
    for row in rows {
        let own = of(outcomes, |o| (o.kind, place(o)) == row);
        let hands = if row.0.by_hand {
            "by hand as well"
        } else {
            "torques alone"
        };
        let form = own[0].put;
        let name = form.map_or("nothing".to_owned(), |p| format!("{} ({})", p.id, p.form));
        let right = |o: &&&Outcome| {
            if o.put.is_none() {
                o.found.is_empty()
            } else {
                o.exact
            }
        };
        let exact = own.iter().filter(right).count();
        let detected = own.iter().filter(|o| o.detected).count();
        let otherwise = own.iter().filter(|o| !right(o)).map(|o| {
            let found = if o.found.is_empty() {
                "nothing".to_owned()
            } else {
                o.found.join(" + ")
            };
            let size = if o.put.is_some() {
                format!("{:.3}: ", o.size)
            } else {
                String::new()
            };
            format!("{size}{found}{}", if o.capped { " (capped)" } else { "" })
        });
        let otherwise: Vec<String> = otherwise.collect();
        let _ = writeln!(
            text,
            "| {}, {hands} | {name} | {exact} of {} | {detected} | {} |",
            row.0.route,
            own.len(),
            otherwise.join("; ")
        );
    }
    text
}
