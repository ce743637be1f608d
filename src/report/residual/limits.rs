//! What the campaign can show and cannot, and what would decide.

use super::words::{newtons, percent};
use crate::report::answers::{rounded, title, unit_words};
use crate::report::number::Rounding;
use crate::stages::diagnose::findings::{
    Alias, CampaignFindings, DetectionLimit, NextMeasurement, NotMeasurable,
};
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct Next {
    separates: Vec<String>,
    /// For which effect, empty where there is one action for all; and what to do.
    actions: Vec<(String, String)>,
    difference: Option<String>,
}

pub(super) fn limits(found: &CampaignFindings) -> Vec<[String; 4]> {
    let limit = |l: &DetectionLimit| {
        let smallest = rounded(l.smallest, Rounding::Digits(2));
        let unit = unit_words(&l.unit);
        let size = if unit.is_empty() {
            smallest
        } else {
            format!("{smallest} {unit}")
        };
        [title(&l.id), l.form.clone(), size, percent(l.visible)]
    };
    found.detection_limits.iter().map(limit).collect()
}

/// Effects that cannot be shown, those of one reason together.
pub(super) fn by_reason(list: &[NotMeasurable]) -> Vec<(String, Vec<String>)> {
    let mut reasons: Vec<(String, Vec<String>)> = Vec::new();
    for one in list.iter().filter(|n| wanting(n).is_none()) {
        match reasons.iter_mut().find(|(why, _)| *why == one.why) {
            Some((_, ids)) => ids.push(title(&one.id)),
            None => reasons.push((one.why.clone(), vec![title(&one.id)])),
        }
    }
    reasons
}

/// What a campaign lacks for an effect to be shown, where that is why it cannot.
pub(super) fn wanting(one: &NotMeasurable) -> Option<(String, String)> {
    let what = one.why.strip_prefix("the campaign lacks ")?;
    Some((title(&one.id), what.to_owned()))
}

pub(super) fn alias(a: &Alias) -> (String, String, String) {
    let cosine = rounded(a.cosine, Rounding::Decimals(2));
    (title(&a.ids[0]), title(&a.ids[1]), cosine)
}

pub(super) fn next(found: &CampaignFindings) -> Vec<Next> {
    let one = |n: &NextMeasurement| Next {
        separates: n.separates.iter().map(|s| words(s)).collect(),
        actions: n.action.split("; ").map(action).collect(),
        difference: n.difference_n.map(newtons),
    };
    found.next_measurement.iter().map(one).collect()
}

/// `id: what to do`, or what to do.
fn action(text: &str) -> (String, String) {
    match text.split_once(": ") {
        Some((id, what)) if crate::effects::index(id).is_some() => (title(id), what.to_owned()),
        _ => (String::new(), text.to_owned()),
    }
}

/// The title of an effect; a reading of the data as it stands.
fn words(id: &str) -> String {
    if crate::effects::index(id).is_some() {
        title(id)
    } else {
        id.to_owned()
    }
}
