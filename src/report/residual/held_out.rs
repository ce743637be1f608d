//! Errors by held-out unit, coefficients before and after, and the law with and without its parts.

use super::MOST_ROWS;
use crate::number::Rounding;
use crate::wording::name::{self, listed, nouns};
use crate::wording::number::{
    NONE, error, error_or_none, error_with_unit, gain, percent_or_none, rounded, size,
    unit as unit_name,
};
use crate::wording::sentence::black_box_beats;
use crate::wording::{ALIKE, CLEARLY_LOWER};
use pipeline_findings::{
    Alternative, CampaignFindings, CoefficientChange, EffectFinding, Parameter, UnitErrors,
};

/// Most effects that are named of a unit; `residual_errors.csv` has all.
const MOST_NAMED: usize = 2;
/// Normal quantile of a 95% interval.
const Z: f64 = 1.96;

/// The first of the units that were held out, a row each.
pub(super) fn units(found: &CampaignFindings) -> Vec<[String; 8]> {
    let first = found.by_unit.iter().take(MOST_ROWS);
    first.map(|u| unit(found, u)).collect()
}

/// Unit, readings, before, after, own values, realised over expected, inside 95%, found without it.
fn unit(found: &CampaignFindings, u: &UnitErrors) -> [String; 8] {
    let error = |e: Option<f64>| error_or_none(e, &found.unit);
    [
        u.unit.clone(),
        u.readings.to_string(),
        error(u.before.rmse_heldout),
        error(u.after.rmse_heldout),
        error(u.after.rmse_heldout_calibrated),
        u.realised_over_expected
            .map_or_else(|| NONE.to_owned(), |r| rounded(r, Rounding::Decimals(2))),
        percent_or_none(u.inside_95),
        found_without(found, u),
    ]
}

/// What the search without a unit found: by name where that is little, else how many of the effects, and how many others.
fn found_without(found: &CampaignFindings, u: &UnitErrors) -> String {
    if u.found.is_empty() {
        return "nothing".to_owned();
    }
    if u.found.len() <= MOST_NAMED {
        let named: Vec<String> = u.found.iter().map(|id| name::candidate(id)).collect();
        return named.join(", ");
    }
    // Two that are one alias set here are one effect found again, and one more.
    let is_again = |e: &&EffectFinding| e.class.iter().any(|id| u.found.contains(id));
    let again = found
        .effects
        .iter()
        .filter(is_again)
        .count()
        .min(u.found.len());
    let negligible = match found.effects.iter().filter(|e| e.negligible).count() {
        0 => String::new(),
        some => format!(" ({some} negligible)"),
    };
    match u.found.len() - again {
        0 => format!("{again} of {}{negligible}", found.effects.len()),
        others => format!(
            "{again} of {}{negligible}, {others} more",
            found.effects.len()
        ),
    }
}

/// Whether the units have a predictive distribution, and errors with their own values: the columns of [`unit`] after the errors.
pub(super) fn is_predictive(found: &CampaignFindings) -> bool {
    let has = |u: &UnitErrors| {
        u.realised_over_expected.is_some()
            || u.inside_95.is_some()
            || u.after.rmse_heldout_calibrated.is_some()
    };
    found.by_unit.iter().any(has)
}

/// What a black box reaches, in a sentence; empty where there is none.
pub(super) fn black_box(found: &CampaignFindings) -> String {
    let reaches = |e: f64| {
        let beats = if black_box_beats(found) {
            format!(
                ", less than the final model: part of the residual may be systematic, or neighbouring ones of the {} {} resemble one another by chance",
                found.design.specimens,
                nouns(found).units
            )
        } else {
            String::new()
        };
        format!(
            "A black-box smoother on the residual of the base model, both fitted without the held-out readings, reaches {} on these{beats}. Its noise is chosen by this error, which favours it.",
            error_with_unit(e, &found.unit)
        )
    };
    found
        .black_box_rmse_heldout
        .map_or_else(String::new, reaches)
}

/// The coefficients without and with the effects, a row each.
pub(super) fn coefficients(found: &CampaignFindings) -> Vec<[String; 5]> {
    found.coefficients.iter().map(coefficient).collect()
}

/// Symbol, unit, published, before, after with interval.
fn coefficient(c: &CoefficientChange) -> [String; 5] {
    let half = Z * c.standard_error;
    let bounded = half.is_finite() && half > 0.0;
    let rounding = if bounded {
        Rounding::ByInterval {
            low: c.after - half,
            high: c.after + half,
        }
    } else {
        Rounding::Digits(4)
    };
    let after = rounded(c.after, rounding);
    let at_bound = |value: String| format!("{value} (at its bound)");
    let before = rounded(c.before, Rounding::Digits(4));
    let with = if c.left_out {
        "left out".to_owned()
    } else if c.at_bound {
        at_bound(after)
    } else if bounded {
        format!("{after} ± {}", rounded(half, rounding))
    } else {
        after
    };
    [
        c.name.clone(),
        unit_name(&c.unit).to_owned(),
        c.published
            .map_or_else(|| NONE.to_owned(), |p| rounded(p, Rounding::Digits(4))),
        if c.before_at_bound {
            at_bound(before)
        } else {
            before
        },
        with,
    ]
}

fn parts(a: &Alternative) -> String {
    let parts: Vec<String> = a.parts.iter().map(|p| name::part(p)).collect();
    if parts.is_empty() {
        "none of them".to_owned()
    } else {
        parts.join(" + ")
    }
}

/// The forms of the law that were compared, a row each.
pub(super) fn alternatives(found: &CampaignFindings) -> Vec<[String; 6]> {
    let all = found.alternatives.iter();
    all.map(|a| alternative(found, a)).collect()
}

/// Parts, parameters, log-likelihood, held-out error, log density, numbers.
fn alternative(found: &CampaignFindings, a: &Alternative) -> [String; 6] {
    let numbers: Vec<String> = a.numbers.iter().map(number).collect();
    [
        name::capitalised(&parts(a)),
        a.parameters.to_string(),
        gain(a.log_likelihood),
        error_or_none(a.rmse_heldout, &found.unit),
        a.log_density_heldout
            .map_or_else(|| NONE.to_owned(), |d| rounded(d, Rounding::Decimals(2))),
        numbers.join("; "),
    ]
}

/// A number of a part with its interval; where it has none, it ran to its bound.
fn number(p: &Parameter) -> String {
    let at_bound = p.ci_low.is_none() && p.ci_high.is_none();
    size(p) + if at_bound { " (at its bound)" } else { "" }
}

/// Which of the alternatives the likelihood prefers: the one with the fewest parts that does as well as the best, if there is one such; what the next
/// one lacks; and what they come to on unseen units. Empty where there are none.
pub(super) fn alternatives_sentence(found: &CampaignFindings) -> String {
    let mut order: Vec<&Alternative> = found.alternatives.iter().collect();
    order.sort_by(|a, b| b.log_likelihood.total_cmp(&a.log_likelihood));
    let [best, _, ..] = order[..] else {
        return String::new();
    };
    let is_close = |a: &&&Alternative| best.log_likelihood - a.log_likelihood < ALIKE;
    let close: Vec<&Alternative> = order.iter().filter(is_close).copied().collect();
    let fewest = close.iter().map(|a| a.parts.len()).min();
    let simplest = |a: &&&Alternative| Some(a.parts.len()) == fewest;
    let least: Vec<&Alternative> = close.iter().filter(simplest).copied().collect();
    let [chosen] = least[..] else {
        let all: Vec<String> = least.iter().map(|a| parts(a)).collect();
        let error_of = |a: &Alternative| a.rmse_heldout.unwrap_or(f64::INFINITY);
        let mut by_error = least;
        by_error.sort_by(|a, b| error_of(a).total_cmp(&error_of(b)));
        let errors = match by_error[..] {
            [lowest, next, ..] => lower_error(found, lowest, next),
            _ => String::new(),
        };
        return format!(
            "{} fit equally well (log-likelihoods within {}): these readings cannot decide between them by their likelihood{errors}.",
            name::capitalised(&listed(&all)),
            rounded(ALIKE, Rounding::Decimals(0))
        );
    };
    let mut sentence = if close.len() == 1 {
        format!("The log-likelihood is highest with {}", parts(chosen))
    } else {
        let others: Vec<String> = close
            .iter()
            .filter(|a| a.parts != chosen.parts)
            .map(|a| parts(a))
            .collect();
        let with = if chosen.parts.is_empty() {
            "Without any of them".to_owned()
        } else {
            format!("With {} alone", parts(chosen))
        };
        format!(
            "{with}, the law fits as well as with {} (log-likelihoods within {})",
            listed(&others),
            rounded(ALIKE, Rounding::Decimals(0))
        )
    };
    let next = order
        .iter()
        .find(|a| !is_close(a) && a.parts.len() <= chosen.parts.len());
    if let Some(next) = next {
        sentence += &format!(
            "; the log-likelihood is {} above that with {}",
            gain(chosen.log_likelihood - next.log_likelihood),
            parts(next)
        );
        let errors = (chosen.rmse_heldout, next.rmse_heldout);
        if let (Some(here), Some(there)) = errors {
            sentence += &format!(
                ", and the error on {} is {} against {}",
                name::held_out(found),
                error(here, &found.unit),
                error_with_unit(there, &found.unit)
            );
        }
    }
    let lowest = lowest_error(found, chosen, next.copied());
    sentence + &lowest + "."
}

/// Where another alternative than the chosen one has the lowest error on unseen units: which, and the errors of both; empty if these were told of it
/// already.
fn lowest_error(
    found: &CampaignFindings,
    chosen: &Alternative,
    told: Option<&Alternative>,
) -> String {
    let known = found.alternatives.iter();
    // A part without a size has nothing to do with the error of its row.
    let has_size = |p: &Parameter| p.ci_low.is_some() || p.ci_high.is_some();
    let known = known.filter(|a| a.numbers.iter().all(has_size));
    let known = known.filter_map(|a| Some((a, a.rmse_heldout?)));
    let lowest = known.min_by(|a, b| a.1.total_cmp(&b.1));
    let lowest = lowest.filter(|(other, _)| told.is_none_or(|told| told.parts != other.parts));
    lowest.map_or_else(String::new, |(other, _)| lower_error(found, other, chosen))
}

/// Which of two alternatives has the lower error on unseen units, and the errors of both; empty where they are not known, or alike.
fn lower_error(found: &CampaignFindings, lower: &Alternative, other: &Alternative) -> String {
    let (Some(there), Some(here)) = (lower.rmse_heldout, other.rmse_heldout) else {
        return String::new();
    };
    if there >= CLEARLY_LOWER * here {
        return String::new();
    }
    format!(
        "; the error on {} is lowest with {}, {} against {}",
        name::held_out(found),
        parts(lower),
        error(there, &found.unit),
        error_with_unit(here, &found.unit)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wording::tests::example;

    #[test]
    fn two_members_of_one_alias_set_are_one_effect_found_again_and_one_more() {
        let mut found = example();
        found.effects.truncate(1);
        found.effects[0].class = vec!["hysteresis".into(), "force_drift".into()];
        let mut without = found.by_unit[0].clone();
        let mut said = |ids: &[&str]| {
            without.found = ids.iter().map(|id| (*id).to_owned()).collect();
            found_without(&found, &without)
        };
        let three = said(&["hysteresis", "force_drift", "creep"]);
        assert_eq!(three, "1 of 1, 2 more");
        found.effects[0].negligible = true;
        let mut said = |ids: &[&str]| {
            without.found = ids.iter().map(|id| (*id).to_owned()).collect();
            found_without(&found, &without)
        };
        let three = said(&["hysteresis", "force_drift", "creep"]);
        assert_eq!(three, "1 of 1 (1 negligible), 2 more");
        assert_eq!(said(&[]), "nothing");
    }
}
