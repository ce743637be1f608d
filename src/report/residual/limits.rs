//! What a campaign could not have shown, and what to measure next.

use crate::number::Rounding;
use crate::wording::name;
use crate::wording::number::{
    self, NONE, error_rounding, error_with_unit, percent, plain, rounded,
};
use crate::wording::sentence::{
    assumed, conditions, has_terms, is_worth_credible, measurement, worth_words,
};
use pipeline_effects as effects;
use pipeline_findings::{
    Alias, CampaignFindings, ColumnLimit, DetectionLimit, EffectFinding, NextKind, NextMeasurement,
    NotMeasurable, WhyNot,
};
use pipeline_torque::diagnose::terms;
use serde::Serialize;

/// The smallest detectable sizes of effects, then of dependences on columns.
pub(super) fn limits(found: &CampaignFindings) -> Vec<[String; 4]> {
    let effects = found.detection_limits.iter().map(limit);
    effects
        .chain(found.column_limits.iter().map(column_limit))
        .collect()
}

/// Effect, form, smallest detectable size, identifiable share.
fn limit(l: &DetectionLimit) -> [String; 4] {
    let beyond = if l.smallest > largest_possible(l) {
        ", beyond its bounds"
    } else {
        ""
    };
    [
        name::capitalised(&name::effect(&l.id)),
        l.form.clone(),
        plain(l.smallest, &l.unit) + beyond,
        percent(l.identifiable_share),
    ]
}

/// The same of a dependence on a column: its change over the column's range.
fn column_limit(l: &ColumnLimit) -> [String; 4] {
    let smallest = l.smallest.map_or_else(
        || "not at any possible size".to_owned(),
        |smallest| match l.unit.as_str() {
            "1" => rounded(100.0 * smallest, Rounding::Digits(2)) + "% of the force",
            unit => plain(smallest, unit),
        },
    );
    [
        format!("Dependence on {}", name::column(&l.column)),
        l.shape.clone(),
        smallest,
        NONE.to_owned(),
    ]
}

/// `These readings do not tell apart: A and B (cosine of their sensitivities 1.000); ...`: the pairs of effects of nearly one sensitivity; empty where there
/// is none.
pub(super) fn alike(found: &CampaignFindings) -> String {
    let pair = |a: &Alias| {
        let [one, other] = [0, 1].map(|k| name::effect(&a.ids[k]));
        let cosine = rounded(a.cosine, Rounding::Decimals(3));
        format!("{one} and {other} (cosine of their sensitivities {cosine})")
    };
    let pairs: Vec<String> = found.aliases.iter().map(pair).collect();
    if pairs.is_empty() {
        return String::new();
    }
    format!(
        "These readings do not tell apart: {}; what is found as one of a pair may be the other.",
        pairs.join("; ")
    )
}

/// Largest size that the effect's bounds allow.
fn largest_possible(l: &DetectionLimit) -> f64 {
    let of_force = bounds_of_force(&l.id, &l.form);
    of_force.map_or(f64::INFINITY, |(low, high)| low.abs().max(high.abs()))
}

fn bounds_of_force(id: &str, form: &str) -> Option<(f64, f64)> {
    let forms = effects::all()[effects::index(id)?].forms();
    let form = forms.iter().find(|f| f.name == form)?;
    Some(form.amplitude.bounds)
}

/// The sizes that are physically possible for an effect's form, about a knee those of the joint's terms; unbounded where nobody says.
pub(super) fn possible(found: &CampaignFindings, id: &str, form: &str) -> (f64, f64) {
    let of_joint = || {
        let mut terms = terms::ALL.iter();
        terms
            .find(|t| t.id == id && t.form == form)
            .map(|t| t.bounds)
    };
    let bounds = match found.kind.as_str() {
        "knee-torque" => of_joint(),
        _ => bounds_of_force(id, form),
    };
    bounds.unwrap_or((f64::NEG_INFINITY, f64::INFINITY))
}

/// Effects that cannot be shown for one reason.
#[derive(Serialize)]
pub(super) struct Cannot {
    why: String,
    /// Whether the table of the law and its parts has it as a part.
    is_part: bool,
    effects: Vec<String>,
}

/// Effects that cannot be shown, those of one reason together. Beside an effect that was found, those of its alias set have no sensitivity
/// of their own: they were measured with it.
pub(super) fn not_measurable(found: &CampaignFindings) -> Vec<Cannot> {
    let was_found = |n: &&NotMeasurable| {
        let is = |e: &EffectFinding| e.id == n.id || e.class.contains(&n.id);
        n.form.is_none() && found.effects.iter().any(is)
    };
    let mut reasons: Vec<Cannot> = Vec::new();
    for one in found.not_measurable.iter().filter(|n| !was_found(n)) {
        let (why, effect) = reason(found, one);
        let is_part = is_absorbed_part(found, one);
        let alike = |r: &&mut Cannot| r.why == why && r.is_part == is_part;
        match reasons.iter_mut().find(alike) {
            Some(reason) => reason.effects.push(effect),
            None => reasons.push(Cannot {
                why,
                is_part,
                effects: vec![effect],
            }),
        }
    }
    reasons
}

/// Whether an effect that the coefficients of the law absorb is a part with which the law was refitted: beside the others it has no size of its own,
/// in the place of one of them it has.
fn is_absorbed_part(found: &CampaignFindings, one: &NotMeasurable) -> bool {
    let mut parts = found.alternatives.iter().flat_map(|a| &a.parts);
    one.reason == WhyNot::Absorbed && parts.any(|part| *part == one.id)
}

/// Beside what the smallest sizes would have been found: the law, with the part that takes the place of others, and what was found.
pub(super) fn beside(found: &CampaignFindings) -> &'static str {
    if found.coefficients.iter().any(|c| c.left_out) {
        return "the law without its dependence on the resting length and the effects found";
    }
    match (found.alternatives.is_empty(), has_terms(found)) {
        (false, false) => "the law with its dependence on the resting length",
        (false, true) => "the law with its dependence on the resting length and the effects found",
        (true, false) => "the law",
        (true, true) => "the law and the effects found",
    }
}

/// Why not, and the effect; what the readings lack stands behind the effect, so that all of these are one reason.
fn reason(found: &CampaignFindings, one: &NotMeasurable) -> (String, String) {
    let form = one.form.as_deref().unwrap_or_default();
    let effect = name::effect_with_form(&one.id, form);
    match (one.reason, &one.by) {
        (WhyNot::NoColumn, Some(by)) => (
            "the readings lack what stands behind each in brackets".to_owned(),
            format!("{} ({})", name::effect(&one.id), name::quantity(by)),
        ),
        _ => (name::why_not(found, one), effect),
    }
}

/// What to measure, and what stands behind it of its worth; the latter empty where that was not computed.
pub(super) fn next(found: &CampaignFindings) -> Vec<[String; 2]> {
    let nouns = name::nouns(found);
    let is_credible = |n: &NextMeasurement| n.worth.is_none_or(|w| is_worth_credible(found, w));
    let row = |n: &NextMeasurement| {
        let credible = n.kind == NextKind::Separate || is_credible(n);
        let worth = match worth_words(n) {
            Some(words) if credible => format!(" {words}{}", assumed(found, n)),
            Some(_) => ": its worth is not stated, because the observed errors differ from the expected ones"
                .to_owned(),
            None => String::new(),
        };
        [name::capitalised(&measurement(n, &nouns)), worth]
    };
    let all = &found.next_measurement;
    let mut rows: Vec<[String; 2]> = all
        .iter()
        .filter(|n| n.kind != NextKind::SetPoints)
        .map(row)
        .collect();
    let mut points = all.iter().filter(|n| n.kind == NextKind::SetPoints);
    if points.all(is_credible) {
        rows.extend(set_points(found));
    }
    rows
}

/// Why what measurements would be worth is not said, or not of all, in a sentence; empty where it is.
pub(super) fn worth_withheld(found: &CampaignFindings) -> String {
    let of_error = found.next_measurement.iter();
    let mut of_error = of_error.filter(|n| n.kind != NextKind::Separate);
    if of_error.all(|n| n.worth.is_none_or(|w| is_worth_credible(found, w))) {
        return String::new();
    }
    let units = name::nouns(found).units;
    format!(
        "The worth of a measurement is the decrease in error that the model with the effects expects. It is omitted where that says nothing about \
         unseen {units}: where their error rises with the effects, is more than half as large again as expected, or is smaller \
         than what the measurement would take away."
    )
}

/// Under which a measurement has how many set points its worth is of together.
const TOTAL: &str = "set_points";

/// The further set points in one row: those that are worth something with what each is worth, and what the best are worth together; else that none is.
fn set_points(found: &CampaignFindings) -> Option<[String; 2]> {
    let all = || {
        let all = found.next_measurement.iter();
        all.filter(|n| n.kind == NextKind::SetPoints)
    };
    let is_total = |n: &&NextMeasurement| n.at.contains_key(TOTAL);
    let total = all().find(is_total);
    let total = total.and_then(|n| Some((*n.at.get(TOTAL)? as usize, n.worth?)));
    let single: Vec<(&NextMeasurement, f64)> = all()
        .filter(|n| !is_total(n))
        .filter_map(|n| Some((n, n.worth?)))
        .collect();
    let unit = &single.first()?.0.unit;
    let worthy = |worth: f64| worth >= least_worth(found);
    let good: Vec<&(&NextMeasurement, f64)> = single.iter().filter(|(_, w)| worthy(*w)).collect();
    let together = total.filter(|(_, total)| {
        let largest = single.iter().map(|(_, w)| *w).fold(0.0, f64::max);
        *total > largest
    });
    if good.is_empty() && !together.is_some_and(|(_, total)| worthy(total)) {
        let nothing = format!(
            "No further set point on these {} would lower the error by as much as {}",
            name::nouns(found).units,
            error_with_unit(least_worth(found), unit)
        );
        return Some([nothing, String::new()]);
    }
    let points: Vec<String> = if good.is_empty() {
        single.iter().map(|(n, _)| conditions(n)).collect()
    } else {
        let point = |(n, worth): &&(&NextMeasurement, f64)| {
            format!("{} ({})", conditions(n), error_with_unit(*worth, unit))
        };
        good.iter().map(point).collect()
    };
    let sum = together.map_or_else(String::new, |(count, total)| {
        format!(
            "; the best {} together {}",
            number::count(count),
            error_with_unit(total, unit)
        )
    });
    let least = error_with_unit(least_worth(found), unit);
    let plural = if points.len() == 1 { "" } else { "s" };
    let others = if good.is_empty() {
        format!("; none of them alone by as much as {least}")
    } else {
        format!("; no other alone by as much as {least}")
    };
    Some([
        format!(
            "Further set point{plural} on these {}",
            name::nouns(found).units
        ),
        format!(": {}{sum}{others}", points.join("; ")),
    ])
}

/// The smallest fall of the expected error that its printed digits show.
fn least_worth(found: &CampaignFindings) -> f64 {
    let expected = found.expected_rmse_heldout.unwrap_or(0.0);
    match error_rounding(expected, &found.unit) {
        Rounding::Decimals(1) => 0.05,
        _ => 0.005,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wording::tests::example;

    fn set_point(eps: f64, worth: f64) -> NextMeasurement {
        NextMeasurement {
            kind: NextKind::SetPoints,
            separates: Vec::new(),
            at: [("contraction_rel".to_owned(), eps)].into(),
            worth: Some(worth),
            unit: "N".into(),
        }
    }

    fn said(points: Vec<NextMeasurement>) -> String {
        let mut found = example();
        found.expected_rmse_heldout = Some(12.0);
        found.next_measurement = points;
        next(&found).concat().concat().replace('\u{a0}', " ")
    }

    #[test]
    fn a_part_of_the_law_that_is_absorbed_is_named_apart_from_the_other_effects() {
        let mut found = example();
        let absorbed = |id: &str| NotMeasurable {
            id: id.to_owned(),
            form: None,
            reason: WhyNot::Absorbed,
            by: None,
        };
        found.effects.clear();
        found.not_measurable = ["series_compliance", "force_gain"].map(absorbed).into();
        let parts: Vec<&String> = { found.alternatives.iter() }
            .flat_map(|a| &a.parts)
            .collect();
        assert!(parts.contains(&&"series_compliance".to_owned()));
        let apart: Vec<bool> = not_measurable(&found).iter().map(|c| c.is_part).collect();
        assert_eq!(apart, [true, false]);
        found.alternatives.clear();
        assert_eq!(not_measurable(&found).len(), 1);
    }

    #[test]
    fn set_points_that_no_printed_digit_shows_are_said_once_to_be_worth_nothing() {
        let mut best = set_point(5.0, 0.04);
        best.at = [("set_points".to_owned(), 5.0)].into();
        assert_eq!(
            said(vec![best, set_point(0.0, 0.014), set_point(0.25, 0.006)]),
            "No further set point on these specimens would lower the error by as much as 0.05 N"
        );
    }

    #[test]
    fn what_set_points_are_worth_is_said_once_for_each_that_is_worth_something() {
        assert_eq!(
            said(vec![set_point(0.0, 0.34), set_point(0.25, 0.01)]),
            "Further set point on these specimens: ε* = 0.00 (0.34 N); no other alone by as much as 0.05 N"
        );
    }
}
