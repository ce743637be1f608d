//! The answers of the loop on the terminal: three lines a campaign, or all there are. `findings.json` and `residual.pdf` have the rest.

use pipeline_findings::CampaignFindings;
use pipeline_report::wording::name;
use pipeline_report::wording::sentence::{LawAlone, clauses, in_three_lines};
use serde_json::{Value, json};

/// Letters in a line.
const WIDTH: usize = 100;
/// Letters before the text of a line.
const MARGIN: usize = 11;
/// Before the second and later lines of a paragraph.
const INDENT: &str = "  ";
/// Before what is left of a line that is one of several.
const FURTHER: &str = "    ";
/// The lines of a campaign of which nothing but a verdict is known: nothing was held out.
const SHORT: [&str; 4] = ["found", "", "error", "next"];
/// Between a number and its unit, where no line ends; a terminal gets a blank. Within a unit it gets nothing.
const NO_BREAK: char = '\u{a0}';
const JOINER: char = '\u{2060}';

/// The lines of one campaign: its name, and below it what the models make of it, what was found, the errors before and after, what they are
/// made of, what to measure next, and what in the records looks wrong. A line that has nothing to say is not there; what was found alone stands
/// behind the name.
pub(super) fn lines(found: &CampaignFindings, models: Option<&str>) -> Vec<String> {
    let said = clauses(found);
    let limits = match said.limits {
        true => " (smallest detectable sizes: tables/detection_limits.csv)",
        false => "",
    };
    let joined = |parts: [Option<String>; 2]| {
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        (!parts.is_empty()).then(|| parts.join("; "))
    };
    let below = [
        ("models", models.map(ToOwned::to_owned)),
        ("found", Some(said.found + limits)),
        ("", said.unexplained),
        ("error", said.errors_in_short),
        ("sources", said.budget),
        ("next", joined([said.worth, said.readings])),
        (
            "records",
            joined([said.recording_errors, said.contradicted]),
        ),
    ];
    let name = name::campaign(found);
    let below = below.into_iter();
    let below: Vec<(&str, String)> = below.filter_map(|(l, text)| Some((l, text?))).collect();
    if found.before.rmse_heldout.is_none() && below.iter().all(|(l, _)| SHORT.contains(l)) {
        let texts: Vec<&str> = below.iter().map(|(_, text)| text.as_str()).collect();
        return indented(&format!("{name}: {}", texts.join("; ")), "", INDENT);
    }
    let below = below.iter().flat_map(|(l, text)| labelled(l, text));
    std::iter::once(name).chain(below).collect()
}

/// The same in three lines, each of which may be wrapped; with the law alone where that is the better one.
pub(super) fn in_short(
    found: &CampaignFindings,
    better_law_alone: Option<LawAlone>,
) -> Vec<String> {
    let mut said = in_three_lines(found, better_law_alone);
    if let Some(first) = said.first_mut() {
        *first = format!("{}: {first}", name::campaign(found));
    }
    let lines = said.iter().enumerate();
    let begin = |k: usize| if k == 0 { "" } else { INDENT };
    lines
        .flat_map(|(k, line)| indented(line, begin(k), FURTHER))
        .collect()
}

/// A text in lines, with what stands before the first and before the others.
fn indented(text: &str, first: &str, others: &str) -> Vec<String> {
    let mut lines = wrapped(text, WIDTH - first.len().max(others.len()));
    let before = std::iter::once(first).chain(std::iter::repeat(others));
    lines
        .iter_mut()
        .zip(before)
        .for_each(|(line, before)| line.insert_str(0, before));
    lines
}

/// A text in lines beside its label, the first with it and the others below the text.
pub(super) fn labelled(label: &str, text: &str) -> Vec<String> {
    let wrapped = wrapped(text, WIDTH - MARGIN).into_iter().enumerate();
    let line = |(k, line): (usize, String)| {
        let label = if k == 0 { label } else { "" };
        format!("  {label:<width$}{line}", width = MARGIN - 2)
    };
    wrapped.map(line).collect()
}

/// A text in lines, parted at blanks.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let letters = |text: &str| text.chars().count();
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if letters(line) + 1 + letters(word) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    for line in &mut lines {
        *line = line.replace(NO_BREAK, " ").replace(JOINER, "");
    }
    lines
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

    /// The texts of the lines by label, each in one piece.
    fn by_label(lines: &[String]) -> Vec<(String, String)> {
        let mut all: Vec<(String, String)> = Vec::new();
        for line in &lines[1..] {
            let (label, text) = line.split_at(MARGIN);
            match (label.trim(), all.last_mut()) {
                ("", Some((_, before))) => *before += &format!(" {text}"),
                (label, _) => all.push((label.to_owned(), text.to_owned())),
            }
        }
        all
    }

    #[test]
    fn every_fact_has_its_label_and_no_line_is_too_long() {
        let found = example();
        let lines = lines(&found, Some("new 13.2 N"));
        assert!(lines.iter().all(|l| l.chars().count() <= WIDTH));
        assert!(lines[0].contains("iso10") && lines[0].contains("10 mm"));
        let said = by_label(&lines);
        for (label, facts) in [
            ("models", &["13.2 N"][..]),
            ("found", &["60.0 kPa", "zero of the pressure sensor"]),
            ("found", &["humidity", "12%"]),
            ("error", &["18.7", "15.8 N"]),
            (
                "sources",
                &["13.4 N", "set lengths", "0.90 mm", "4.1", "noise"],
            ),
            ("next", &["0.2 mm", "6.0 N", "5.1 N"]),
            ("records", &["s05", "10.0 mm", "0.20 N"]),
        ] {
            let of = said.iter().find(|(l, _)| l == label);
            let text = &of.unwrap_or_else(|| panic!("{label}: {lines:#?}")).1;
            for fact in facts {
                assert!(text.contains(fact), "{label}: {fact}: {text}");
            }
        }
    }

    #[test]
    fn each_of_many_effects_is_said_with_its_size() {
        let mut found = example();
        let one = found.effects[0].clone();
        found.effects = (1..=4)
            .map(|k| {
                let mut effect = one.clone();
                effect.parameters[0].value = 10.0 * f64::from(k) + 1.0;
                effect
            })
            .collect();
        found.after.log_density_heldout = Some(-5.0);
        let said = by_label(&lines(&found, None));
        let text = |label: &str| &said.iter().find(|(l, _)| l == label).unwrap().1;
        for size in ["11.0 kPa", "21.0 kPa", "31.0 kPa", "41.0 kPa"] {
            assert!(text("found").contains(size), "{size}: {}", text("found"));
        }
        assert!(text("error").contains("intervals become less reliable"));
    }

    #[test]
    fn a_verdict_alone_is_one_paragraph_with_the_name() {
        let mut found = example();
        found.recording_errors.clear();
        found.scatter.clear();
        found.budget.clear();
        found.next_measurement.clear();
        (found.before, found.after) = Default::default();
        let lines = lines(&found, None);
        assert!(lines[0].starts_with("iso10, 10 mm: "), "{lines:?}");
        let is_indented = |l: &String| l.starts_with(INDENT) && l.chars().count() <= WIDTH;
        assert!(lines[1..].iter().all(is_indented), "{lines:?}");
        assert!(lines.concat().contains("60.0 kPa"), "{lines:?}");
    }

    #[test]
    fn a_number_stays_with_its_unit_and_no_invisible_character_is_printed() {
        let lines = wrapped("rate 0.06\u{a0}N\u{a0}s/\u{2060}kPa here", 16);
        assert_eq!(lines, ["rate", "0.06 N s/kPa", "here"]);
    }

    #[test]
    fn what_there_is_nothing_to_say_of_has_no_line() {
        let mut found = example();
        found.recording_errors.clear();
        found.scatter.clear();
        found.budget.clear();
        let said = by_label(&lines(&found, None));
        let labels: Vec<&str> = said.iter().map(|(label, _)| label.as_str()).collect();
        assert_eq!(labels, ["found", "error", "next"]);
    }
}
