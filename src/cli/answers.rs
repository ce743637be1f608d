//! The answers on the terminal: at most three lines a campaign. `findings.json` and `residual.pdf` have the rest.

use crate::findings::CampaignFindings;
use crate::report::wording::name;
use crate::report::wording::sentence::{Clauses, clauses};
use serde_json::{Value, json};

/// Letters in a line.
const WIDTH: usize = 100;
/// Lines of a campaign.
const LINES: usize = 3;
/// Between a number and its unit, where no line ends; a terminal gets a blank.
const NO_BREAK: char = '\u{a0}';
/// What the lines after the first begin with.
const INDENT: &str = "  ";

/// The lines of one campaign.
pub(super) fn lines(found: &CampaignFindings) -> Vec<String> {
    let said = clauses(found);
    let mut fits = Vec::new();
    for clause in by_weight(found, &said) {
        fits.push(clause);
        if wrapped(&fits.join("; ")).len() > LINES {
            fits.pop();
        }
    }
    if fits.is_empty() {
        fits.push(name::campaign(found));
    }
    let lines = wrapped(&(fits.join("; ") + "."));
    let printed = lines.into_iter().take(LINES);
    printed.map(|line| line.replace(NO_BREAK, " ")).collect()
}

/// What there is to say, the weightiest first.
fn by_weight(found: &CampaignFindings, said: &Clauses) -> Vec<String> {
    let limits = if said.limits {
        " (smallest detectable sizes: tables/detection_limits.csv)"
    } else {
        ""
    };
    let first = format!("{}: {}{limits}", name::campaign(found), said.found);
    let in_short = format!(
        "{}: {}",
        name::campaign(found),
        name::verdict(found.verdict)
    );
    let first = if wrapped(&first).len() > LINES {
        in_short
    } else {
        first
    };
    let rest = [
        &said.recording_errors,
        &said.errors,
        &said.unexplained,
        &said.budget_in_short,
        &said.worth,
        &said.readings,
    ];
    let rest = rest.into_iter().flatten().cloned();
    [first].into_iter().chain(rest).collect()
}

/// A text in lines, parted at blanks.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if letters(line) + 1 + letters(word) <= WIDTH => {
                line.push(' ');
                line.push_str(word);
            }
            Some(_) => lines.push(format!("{INDENT}{word}")),
            None => lines.push(word.to_owned()),
        }
    }
    lines
}

fn letters(text: &str) -> usize {
    text.chars().count()
}

/// The answer of one campaign for other programs.
pub(super) fn as_json(found: &CampaignFindings) -> Value {
    json!({
        "campaign": found.campaign, "part": found.part, "diameter_mm": found.diameter_mm, "verdict": found.verdict,
        "rmse_heldout_before": found.before.rmse_heldout, "rmse_heldout_after": found.after.rmse_heldout,
        "expected_rmse_heldout": found.expected_rmse_heldout, "unit": found.unit,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::wording::tests::example;

    #[test]
    fn three_lines_at_most_and_none_too_long() {
        let found = example();
        let lines = lines(&found);
        assert_eq!(
            lines,
            [
                "iso10, 10 mm: threshold pressure of the bladder 60.0 kPa (indistinguishable from zero of the",
                "  pressure sensor); recording error: session s05 (set length, \u{2212}10.0 mm; set aside); the error on",
                "  unseen specimens goes from 18.7 to 15.8 N; knowing set lengths to 0.2 mm is worth 6.0 N.",
            ]
        );
        assert!(lines.iter().all(|l| letters(l) <= WIDTH));
    }

    #[test]
    fn a_name_that_fills_three_lines_is_cut_and_not_more() {
        let mut found = example();
        found.campaign = "word ".repeat(200);
        assert_eq!(lines(&found).len(), LINES);
    }
}
