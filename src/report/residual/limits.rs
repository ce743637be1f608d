//! What a campaign could not have shown, and what to measure next.

use crate::effects;
use crate::findings::{
    CampaignFindings, DetectionLimit, EffectFinding, NextMeasurement, NotMeasurable, WhyNot,
};
use crate::report::wording::name;
use crate::report::wording::number::{percent, plain};
use crate::report::wording::sentence::{measurement, worth_words};
use serde::Serialize;

/// Effect, form, smallest detectable size, identifiable share.
pub(super) fn limit(l: &DetectionLimit) -> [String; 4] {
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

/// Largest size that the effect's bounds allow.
fn largest_possible(l: &DetectionLimit) -> f64 {
    let forms = effects::index(&l.id).map_or(&[][..], |k| effects::all()[k].forms());
    let bounds = forms.iter().find(|f| f.name == l.form);
    bounds.map_or(f64::INFINITY, |f| {
        let (low, high) = f.amplitude.bounds;
        low.abs().max(high.abs())
    })
}

/// Effects that cannot be shown for one reason.
#[derive(Serialize)]
pub(super) struct Cannot {
    why: String,
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
        match reasons.iter_mut().find(|r| r.why == why) {
            Some(reason) => reason.effects.push(effect),
            None => reasons.push(Cannot {
                why,
                effects: vec![effect],
            }),
        }
    }
    reasons
}

/// Why not, and the effect; what was not recorded stands behind the effect, so that all of these are one reason.
fn reason(found: &CampaignFindings, one: &NotMeasurable) -> (String, String) {
    let form = one.form.as_deref().unwrap_or_default();
    let effect = name::effect_with_form(&one.id, form);
    match (one.reason, &one.by) {
        (WhyNot::NoColumn, Some(by)) => (
            name::NOT_RECORDED.to_owned(),
            format!("{} ({})", name::effect(&one.id), name::column(by)),
        ),
        _ => (name::why_not(found, one), effect),
    }
}

/// What to measure, what it is worth; the latter empty where it was not computed.
pub(super) fn next(found: &CampaignFindings) -> Vec<[String; 2]> {
    let nouns = name::nouns(found);
    let row = |n: &NextMeasurement| {
        let worth = worth_words(n).unwrap_or_default();
        [name::capitalised(&measurement(n, &nouns)), worth]
    };
    found.next_measurement.iter().map(row).collect()
}
