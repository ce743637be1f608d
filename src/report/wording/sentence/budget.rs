//! What the expected error is made of.

use crate::number::Rounding;
use crate::wording::ALIKE;
use crate::wording::name::{self, listed, nouns};
use crate::wording::number::{count, error, error_with_unit, percent, plain, rounded};
use pipeline_findings::{BudgetEntry, CampaignFindings, HeldOutBy, Scatter};

/// A source that makes less than this share of the expected variance is summed up with others; noise is always named.
const NAMED_SHARE: f64 = 0.02;

/// Sources that the answer on a page and on the terminal names, beside noise: the fewest, and the most where what is left of the others is larger than
/// each of those named; the table has all.
const SOURCES_NAMED: (usize, usize) = (3, 5);

/// Units from which the scatter that is stated is near those of the searches without one, which the expected error is of.
const FEWEST_FOR_SCATTER: usize = 3;

/// Where a search without one unit has fewer others than this left, what it expects of an unseen one rests on these few, and it is said.
const FEW_LEFT: usize = 3;

/// An expected error that is further than this factor from what came out is said to be.
const FAR_FROM_EXPECTED: f64 = 1.25;

/// The sources that a sentence names, largest first, and noise; and the root of what the others make together.
fn named_sources(found: &CampaignFindings) -> (Vec<&BudgetEntry>, f64) {
    let total: f64 = found.budget.iter().map(|b| b.variance).sum();
    let mut order: Vec<&BudgetEntry> = found.budget.iter().collect();
    order.sort_by(|a, b| b.variance.total_cmp(&a.variance));
    let is_noise = |b: &BudgetEntry| b.source == "noise";
    let others: Vec<&BudgetEntry> = order.iter().filter(|b| !is_noise(b)).copied().collect();
    let mut named: Vec<&BudgetEntry> = Vec::new();
    let left_beside = |named: &[&BudgetEntry]| -> f64 {
        let is_left = |b: &&&BudgetEntry| named.iter().all(|n| n.source != b.source);
        others.iter().filter(is_left).map(|b| b.variance).sum()
    };
    let mut left = left_beside(&named);
    for &entry in &others {
        let is_told = named
            .first()
            .is_some_and(|largest| left <= largest.variance);
        let is_enough = named.len() >= SOURCES_NAMED.0 && is_told;
        if is_enough || named.len() == SOURCES_NAMED.1 || entry.variance < NAMED_SHARE * total {
            break;
        }
        named.push(entry);
        left = left_beside(&named);
    }
    named.extend(order.iter().filter(|b| is_noise(b)));
    (named, left.max(0.0).sqrt())
}

/// `the 13.4 N error expected on an unseen specimen combines, in quadrature, 12.0 from set lengths (0.9 mm), 4.1 from
/// specimen gain and 2.6 from noise`.
pub(super) fn budget(found: &CampaignFindings) -> Option<String> {
    let (named, left) = named_sources(found);
    let from = |b: &&BudgetEntry| {
        let scatter = scattered(found, b);
        format!(
            "{} from {}{scatter}",
            error(b.rmse, &found.unit),
            name::source(&b.source)
        )
    };
    let mut parts: Vec<String> = named.iter().map(from).collect();
    if left > 0.0 && left.is_finite() {
        let others = format!("{} from other sources", error(left, &found.unit));
        parts.insert(
            parts.len().saturating_sub(1).max(1).min(parts.len()),
            others,
        );
    }
    let (first, others) = (named.first()?, parts.get(1..).unwrap_or_default());
    let first = format!(
        "{} from {}{}",
        error(first.rmse, &found.unit),
        name::source(&first.source),
        scattered(found, first)
    );
    let all: Vec<String> = [first].into_iter().chain(others.iter().cloned()).collect();
    let total = error_with_unit(found.expected_rmse_heldout?, &found.unit);
    let unit = nouns(found).unit;
    Some(format!(
        "the {total} error expected on an unseen {unit}{} combines, in quadrature, {}",
        came_out(found),
        listed(&all)
    ))
}

/// `expected error 14.1 N; largest source: set lengths (46% of the variance)`: roots do not add.
pub(super) fn largest_source(found: &CampaignFindings) -> Option<String> {
    let sources = found.budget.iter();
    let largest = sources.max_by(|a, b| a.variance.total_cmp(&b.variance))?;
    let total = found.expected_rmse_heldout?;
    Some(format!(
        "expected error {}; largest source: {} ({} of the variance)",
        error_with_unit(total, &found.unit),
        name::source(&largest.source),
        percent(largest.variance / (total * total)),
    ))
}

/// `14.1 N expected (20.3 N observed): set lengths (0.67 mm) 9.6, estimation 6.6, specimen gain (4.0%) 5.0, others 6.1, noise 1.0`.
pub(super) fn points(found: &CampaignFindings) -> Option<String> {
    let (named, left) = named_sources(found);
    let of = |b: &&BudgetEntry| {
        let size = error(b.rmse, &found.unit);
        format!("{}{} {size}", name::source(&b.source), scattered(found, b))
    };
    let mut parts: Vec<String> = named.iter().map(of).collect();
    if left > 0.0 && left.is_finite() {
        let before_noise = parts.len().saturating_sub(1);
        parts.insert(before_noise, format!("others {}", error(left, &found.unit)));
    }
    let total = error_with_unit(found.expected_rmse_heldout?, &found.unit);
    let came_out = came_out(found);
    (!named.is_empty()).then(|| format!("{total} expected{came_out}: {}", parts.join(", ")))
}

/// ` (78.5 N observed; each search without one specimen uses only one other)`, where that is far from what was expected.
pub(super) fn came_out(found: &CampaignFindings) -> String {
    let expected = found.expected_rmse_heldout;
    let (Some(expected), Some(came_out)) = (expected, found.rmse_of_answer()) else {
        return String::new();
    };
    let far = came_out > FAR_FROM_EXPECTED * expected || expected > FAR_FROM_EXPECTED * came_out;
    if !far {
        return String::new();
    }
    let unit = nouns(found).unit;
    let rests = few_left(found).map_or_else(String::new, |left| {
        let others = if left == 1 { "other" } else { "others" };
        let left = count(left);
        format!("; each search without one {unit} uses only {left} {others}")
    });
    let came_out = error_with_unit(came_out, &found.unit);
    format!(" ({came_out} observed{rests})")
}

/// How many units are left where one is held out in turn, if they are few.
fn few_left(found: &CampaignFindings) -> Option<usize> {
    let one_in_turn = matches!(
        found.design.held_out_by,
        HeldOutBy::Specimen | HeldOutBy::Actuator
    );
    let left = found.design.specimens.checked_sub(1)?;
    (one_in_turn && (1..FEW_LEFT).contains(&left)).then_some(left)
}

/// ` (0.9 mm)`: the scatter behind a source of error, where it is one random effect.
fn scattered(found: &CampaignFindings, entry: &BudgetEntry) -> String {
    // Without one of two units each search knows one alone, and its own scatter is another.
    if found.design.specimens < FEWEST_FOR_SCATTER {
        return String::new();
    }
    let Some(scatter) = scatter_behind(found, &entry.source) else {
        return String::new();
    };
    let assumed = if is_assumed(scatter) { " assumed" } else { "" };
    format!(" ({}{assumed})", scatter_size(scatter))
}

/// Whether the readings hardly show a scatter: what is expected of unseen groups is then the usual one, neither declared nor measured.
pub fn is_assumed(scatter: &Scatter) -> bool {
    let shown = scatter.log_likelihood_gain;
    scatter.declared.is_none() && shown.is_some_and(|gain| gain < ALIKE)
}

/// The random effect behind a source of error, where it is one.
pub fn scatter_behind<'a>(found: &'a CampaignFindings, source: &str) -> Option<&'a Scatter> {
    let (id, levels) = name::scatter_of(source)?;
    let is = |s: &&Scatter| s.id == id && levels.contains(&s.level);
    found.scatter.iter().find(is)
}

/// The standard deviation with which unseen groups are predicted: a gain, and what goes with the resting length, as a percentage.
pub fn scatter_size(scatter: &Scatter) -> String {
    let percentage = |share: f64| rounded(100.0 * share, Rounding::Digits(2)) + "%";
    if scatter.unit == "1" {
        return percentage(scatter.sd_predictive);
    }
    if let Some(share) = scatter.share_of_rest_length {
        return format!("{} of the resting length", percentage(share));
    }
    plain(scatter.sd_predictive, &scatter.unit)
}
