//! The answers on the terminal: at most three lines a campaign. `findings.json` and `residual.pdf` have the rest.

use pipeline_findings::CampaignFindings;
use pipeline_report::wording::name;
use pipeline_report::wording::sentence::{Clauses, clauses};
use serde_json::{Value, json};

/// Letters in a line.
const WIDTH: usize = 100;
/// Lines of a campaign.
const LINES: usize = 3;
/// Between a number and its unit, where no line ends; a terminal gets a blank.
const NO_BREAK: char = '\u{a0}';
/// What the lines after the first begin with.
const INDENT: &str = "  ";

/// The lines of one campaign: what was found, what was set aside and the errors in any case, of the rest as much as there is room for.
pub(super) fn lines(found: &CampaignFindings) -> Vec<String> {
    let said = clauses(found);
    let errors = said.errors_in_short.clone();
    let (first, recording) = first(found, &said, errors.as_deref());
    // In the order in which they are said; the errors are chosen before all others.
    let mut chosen = vec![Some(first), recording, None, errors, None, None, None, None];
    let others = [
        (2, &said.contradicted),
        (4, &said.unexplained),
        (5, &said.budget_in_short),
        (6, &said.worth),
        (7, &said.readings),
    ];
    for (place, clause) in others {
        chosen[place].clone_from(clause);
        if !fits(&joined(&chosen)) {
            chosen[place] = None;
        }
    }
    let lines = wrapped(&(joined(&chosen) + "."));
    let printed = lines.into_iter().take(LINES);
    printed.map(|line| line.replace(NO_BREAK, " ")).collect()
}

fn joined(clauses: &[Option<String>]) -> String {
    let said: Vec<&str> = clauses.iter().flatten().map(String::as_str).collect();
    said.join("; ")
}

fn fits(text: &str) -> bool {
    wrapped(&format!("{text}.")).len() <= LINES
}

/// The name of the campaign and what was found, and the mistakes of recording: both at as great a length as leaves room for the errors; of the mistakes at
/// least how many there are.
fn first(
    found: &CampaignFindings,
    said: &Clauses,
    errors: Option<&str>,
) -> (String, Option<String>) {
    let limits = if said.limits {
        " (smallest detectable sizes: tables/detection_limits.csv)"
    } else {
        ""
    };
    let name = name::campaign(found);
    let mut lengths = vec![
        format!("{}{limits}", said.found),
        said.found_in_short.clone(),
        said.found_by_name.clone(),
    ];
    lengths.extend(said.found_in_part.iter().cloned());
    lengths.push(name::verdict(found.verdict).to_owned());
    let fitting = |lengths: &[String], recording: &Option<String>| {
        let mut with = lengths.iter().map(|what| format!("{name}: {what}"));
        let errors = errors.map(str::to_owned);
        let fits_in = |first: &String| {
            fits(&joined(&[
                Some(first.clone()),
                recording.clone(),
                errors.clone(),
            ]))
        };
        with.find(fits_in).map(|first| (first, recording.clone()))
    };
    // Rather the names of effects and how many mistakes than a verdict and what the mistakes are.
    let short = &said.recording_errors_in_short;
    let named = &lengths[..lengths.len() - 1];
    let found = fitting(named, &said.recording_errors).or_else(|| fitting(&lengths, short));
    found.unwrap_or_else(|| (name.clone(), short.clone()))
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
    use pipeline_findings::Findings;

    /// The first campaign of findings in which every field has a value.
    fn example() -> CampaignFindings {
        let all = include_bytes!("../../tests/data/findings-2.json");
        let all: Findings = pipeline_base::json::from_slice(all).unwrap();
        all.campaigns.into_iter().next().unwrap()
    }

    #[test]
    fn three_lines_at_most_and_none_too_long() {
        let found = example();
        let lines = lines(&found);
        assert_eq!(
            lines,
            [
                "iso10, 10 mm: threshold pressure of the bladder 60.0 kPa (indistinguishable from zero of the",
                "  pressure sensor); recording error: session s05 (set length, \u{2212}10.0 mm; set aside here only); the",
                "  error on unseen specimens goes from 18.7 to 15.8 N; knowing set lengths to 0.2 mm is worth 6.0 N.",
            ]
        );
        assert!(lines.iter().all(|l| letters(l) <= WIDTH));
    }

    #[test]
    fn the_errors_and_what_is_wrong_with_them_are_said_whatever_was_found() {
        let mut found = example();
        let one = found.effects[0].clone();
        found.effects = vec![one; 4];
        found.after.log_density_heldout = Some(-5.0);
        let lines = lines(&found);
        let all = lines.join(" ");
        let words: Vec<&str> = all.split(' ').filter(|w| !w.is_empty()).collect();
        let text = words.join(" ");
        assert!(lines.len() <= LINES && lines.iter().all(|l| letters(l) <= WIDTH));
        assert!(
            text.contains("goes from 18.7 to 15.8 N, but its stated uncertainty gets worse"),
            "{text}"
        );
    }

    #[test]
    fn a_name_that_fills_three_lines_is_cut_and_not_more() {
        let mut found = example();
        found.campaign = "word ".repeat(200);
        assert_eq!(lines(&found).len(), LINES);
    }
}
