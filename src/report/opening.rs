//! The first page of `force.pdf`: what was measured, the models on common readings, what the loop found and what to do next, group by group.

use crate::input::{GroupInput, ReportInput};
use crate::number::Rounding;
use crate::residual::better_law_alone;
use crate::wording::name;
use crate::wording::number::{NONE, error_or_none, rounded};
use crate::wording::sentence::{answer_in_short, in_doubt};
use pipeline_base::session::Session;
use pipeline_compare::{COMMON, NEW, NEW_PUBLISHED};
use serde::Serialize;

/// The models of the first page: the new one as fitted and as published, and those with which it is ranked.
pub(crate) const SHOWN: [&str; 4] = [NEW, NEW_PUBLISHED, "hunt2017", "festo_tool"];

/// One group of rows on the first page.
#[derive(Serialize)]
pub(crate) struct Line {
    name: String,
    simulated: bool,
    /// Specimens, range of lengths, of pressures, dates, sessions, readings.
    measured: [String; 6],
    /// Readings that the ranked models all answer, of how many; the errors of the models on these.
    compared: [String; 5],
    /// What the loop found, what would help, and what looks mistaken, in sentences.
    answer: Vec<String>,
}

/// Names of the models of the first page.
pub(crate) fn models() -> Vec<&'static str> {
    SHOWN.iter().map(|id| name::model_name(id, id)).collect()
}

/// The groups with a section, what was measured before what was simulated.
pub(crate) fn lines(input: &ReportInput) -> Vec<Line> {
    let mut groups: Vec<&GroupInput> = input.with_section().map(|(g, _)| g).collect();
    groups.sort_by_key(|g| g.fit.group.simulated);
    groups.into_iter().map(|g| line(input, g)).collect()
}

fn line(input: &ReportInput, group: &GroupInput) -> Line {
    let of = &group.fit.group;
    Line {
        name: format!("{}, {} mm", of.campaign, of.diameter_mm),
        simulated: of.simulated,
        measured: measured(input, group),
        compared: compared(group),
        answer: answer(group),
    }
}

fn measured(input: &ReportInput, group: &GroupInput) -> [String; 6] {
    let (fit, ranges) = (&group.fit, &group.fit.ranges);
    let (low, high) = ranges.rest_length_m;
    let whole = Rounding::Decimals(0);
    let sessions: usize = fit.specimens.iter().map(|s| s.sessions).sum();
    [
        fit.specimens.len().to_string(),
        range((1e3 * low, 1e3 * high), whole, "mm"),
        range(ranges.pressure_kpa, whole, "kPa"),
        dates(input, group),
        sessions.to_string(),
        rounded(fit.rows as f64, whole),
    ]
}

/// The ends of a range with their unit; a dash where there is none.
fn range((low, high): (f64, f64), rounding: Rounding, unit: &str) -> String {
    if !(low.is_finite() && high.is_finite()) {
        return NONE.to_owned();
    }
    let (low, high) = (rounded(low, rounding), rounded(high, rounding));
    if low == high {
        return format!("{low}\u{a0}{unit}");
    }
    format!("{low} to {high}\u{a0}{unit}")
}

/// The first and the last date on which sessions of the group were measured.
fn dates(input: &ReportInput, group: &GroupInput) -> String {
    let of = &group.fit.group;
    let sessions = input.sessions.iter().map(|s| &s.ingest.session);
    let is_of_group = |s: &&Session| of.takes_in(&s.campaign, s.specimen.diameter_mm);
    let dates = sessions
        .filter(is_of_group)
        .filter_map(|s| s.date.as_deref());
    let (first, last) = (dates.clone().min(), dates.max());
    match (first, last) {
        (Some(first), Some(last)) if first == last => first.to_owned(),
        (Some(first), Some(last)) => format!("{first} to {last}"),
        _ => NONE.to_owned(),
    }
}

fn compared(group: &GroupInput) -> [String; 5] {
    let all = &group.comparison.comparisons;
    let common = |model: &str| {
        let mut of_model = all.iter().filter(|c| c.model == model);
        of_model.find(|c| c.split == COMMON)
    };
    let readings = SHOWN.iter().find_map(|id| common(id));
    let readings = readings.map_or(0, |c| c.n + c.n_excluded);
    let whole = Rounding::Decimals(0);
    let of = format!(
        "{} of {}",
        rounded(readings as f64, whole),
        rounded(group.fit.rows as f64, whole)
    );
    let errors = SHOWN.map(|id| error_or_none(common(id).and_then(|c| c.rmse), "N"));
    let [new, published, hunt, festo] = errors;
    [of, new, published, hunt, festo]
}

fn answer(group: &GroupInput) -> Vec<String> {
    let found = group.diagnosis.as_ref().map(|d| &d.findings);
    let mut of_loop = found.map_or_else(Vec::new, answer_in_short);
    if let Some(law) = better_law_alone(group) {
        let after_errors = of_loop.len().min(1);
        of_loop.insert(after_errors, name::capitalised(&law.in_words()) + ".");
    }
    let doubtful = in_doubt(group.doubtful()).map(|s| name::capitalised(&s) + ".");
    of_loop.into_iter().chain(doubtful).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::tests::groups;
    use crate::wording::tests::example;
    use pipeline_diagnose::Diagnosis;
    use pipeline_findings::{ErrorKind, Residuals};

    #[test]
    fn the_models_of_the_first_page_are_compared_on_the_same_readings() {
        let group = groups().swap_remove(0);
        let [readings, new, published, hunt, festo] = compared(&group);
        assert!(
            readings.ends_with(&format!(" of {}", group.fit.rows)),
            "{readings}"
        );
        for error in [new, published, hunt, festo] {
            assert!(error.parse::<f64>().is_ok(), "{error}");
        }
    }

    #[test]
    fn the_law_alone_is_named_where_it_does_better() {
        let mut group = groups().swap_remove(0);
        let all = &mut group.comparison.comparisons;
        all.retain(|c| c.model != NEW_PUBLISHED);
        let mut published = { all.iter() }
            .find(|c| c.model == NEW && c.split == "loso")
            .cloned()
            .unwrap();
        let alone = published.rmse.unwrap();
        let said = |group: &mut GroupInput, own: f64| {
            let mut findings = example();
            findings.after.rmse_heldout = Some(own);
            let residuals = Residuals::default();
            group.diagnosis = Some(Diagnosis {
                findings,
                residuals,
                mixed_law: None,
            });
            answer(group).join(" ")
        };
        let words = "The law alone, by least squares, has ";
        assert!(said(&mut group, 2.0 * alone).contains(words));
        assert!(!said(&mut group, alone).contains("The law"));
        published.model = NEW_PUBLISHED.to_owned();
        published.rmse = Some(0.5 * alone);
        group.comparison.comparisons.push(published);
        assert!(said(&mut group, alone).contains("The law as published, without effects, has "));
    }

    #[test]
    fn sessions_that_look_mistaken_are_named_on_the_first_page() {
        let mut group = groups().swap_remove(0);
        let mut findings = example();
        let error = &mut findings.recording_errors[0];
        (error.kind, error.quantity) = (ErrorKind::SwappedColumns, None);
        let session = error.group.clone();
        let residuals = Residuals::default();
        group.diagnosis = Some(Diagnosis {
            findings,
            residuals,
            mixed_law: None,
        });
        let said = answer(&group).join(" ");
        assert!(
            said.contains(&session) && said.contains("force and pressure exchanged"),
            "{said}"
        );
    }

    #[test]
    fn a_range_of_one_value_is_said_once() {
        let whole = Rounding::Decimals(0);
        assert_eq!(range((620.0, 620.2), whole, "kPa"), "620\u{a0}kPa");
        assert_eq!(range((615.0, 620.0), whole, "kPa"), "615 to 620\u{a0}kPa");
        assert_eq!(
            range((f64::INFINITY, f64::NEG_INFINITY), whole, "kPa"),
            NONE
        );
    }
}
