//! What the campaign can show and cannot, and what would decide.

use super::words::{named, newtons, percent};
use crate::effects;
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
        let beyond = if l.smallest > largest_possible(l) {
            ", beyond its bounds"
        } else {
            ""
        };
        let smallest = rounded(l.smallest, Rounding::Digits(2));
        let unit = unit_words(&l.unit);
        let size = if unit.is_empty() {
            smallest
        } else {
            format!("{smallest} {unit}")
        };
        [
            title(&l.id),
            l.form.clone(),
            size + beyond,
            percent(l.visible),
        ]
    };
    found.detection_limits.iter().map(limit).collect()
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

/// Effects that cannot be shown, those of one reason together.
pub(super) fn by_reason(found: &CampaignFindings) -> Vec<(String, Vec<String>)> {
    // Beside an effect that was found, its like leave no trace of their own: they were measured with it.
    let was_found = |n: &&NotMeasurable| {
        found
            .effects
            .iter()
            .any(|e| e.id == n.id || e.class.contains(&n.id))
    };
    let list = found.not_measurable.iter().filter(|n| !was_found(n));
    let mut reasons: Vec<(String, Vec<String>)> = Vec::new();
    for one in list.filter(|n| wanting(n).is_none()) {
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

/// Sets of effects of which no two can be told apart, with the smallest cosine between two of them.
pub(super) fn alike(aliases: &[Alias]) -> Vec<(Vec<String>, String)> {
    let pairs: Vec<[&str; 2]> = aliases
        .iter()
        .map(|a| [a.ids[0].as_str(), a.ids[1].as_str()])
        .collect();
    let smallest = |set: &[&str]| {
        let within = |a: &&Alias| a.ids.iter().all(|id| set.contains(&id.as_str()));
        let cosines = aliases.iter().filter(within).map(|a| a.cosine.abs());
        cosines.fold(1.0, f64::min)
    };
    cliques(&pairs)
        .into_iter()
        .map(|set| {
            let cosine = rounded(smallest(&set), Rounding::Decimals(2));
            (set.into_iter().map(title).collect(), cosine)
        })
        .collect()
}

/// Sets whose members all stand in pairs with each other: each pair joins the first set that it completes, or begins one.
fn cliques<'a>(pairs: &[[&'a str; 2]]) -> Vec<Vec<&'a str>> {
    let paired =
        |a: &str, b: &str| a == b || pairs.iter().any(|p| p.contains(&a) && p.contains(&b));
    let mut sets: Vec<Vec<&str>> = Vec::new();
    for pair in pairs {
        let fits = |set: &&mut Vec<&str>| pair.iter().all(|a| set.iter().all(|b| paired(a, b)));
        match sets.iter_mut().find(fits) {
            Some(set) => {
                for id in pair {
                    if !set.contains(id) {
                        set.push(id);
                    }
                }
            }
            None => sets.push(pair.to_vec()),
        }
    }
    sets
}

/// What would decide; pairs that are told apart by the same measurements together.
pub(super) fn next(found: &CampaignFindings) -> Vec<Next> {
    let is_plain = |n: &&NextMeasurement| n.separates.len() == 2 && n.difference_n.is_none();
    let pairs: Vec<[&str; 2]> = found
        .next_measurement
        .iter()
        .filter(is_plain)
        .map(|n| [n.separates[0].as_str(), n.separates[1].as_str()])
        .collect();
    let sets = cliques(&pairs);
    let mut list: Vec<Next> = Vec::new();
    let mut begun: Vec<&[&str]> = Vec::new();
    for n in &found.next_measurement {
        let of_pair = |set: &&Vec<&str>| {
            is_plain(&n) && n.separates.iter().all(|id| set.contains(&id.as_str()))
        };
        let set = sets.iter().find(of_pair);
        let actions: Vec<(String, String)> = n.action.split("; ").map(action).collect();
        let place = set.and_then(|s| begun.iter().position(|b| *b == s.as_slice()));
        if let Some(place) = place {
            for one in actions {
                if !list[place].actions.contains(&one) {
                    list[place].actions.push(one);
                }
            }
            continue;
        }
        begun.push(set.map_or(&[], Vec::as_slice));
        let separates = set.map_or_else(
            || n.separates.iter().map(|s| named(s)).collect(),
            |set| set.iter().map(|s| named(s)).collect(),
        );
        list.push(Next {
            separates,
            actions,
            difference: n.difference_n.map(newtons),
        });
    }
    list
}

/// `id: what to do`, or what to do.
fn action(text: &str) -> (String, String) {
    match text.split_once(": ") {
        Some((id, what)) if effects::index(id).is_some() => (title(id), what.to_owned()),
        _ => (String::new(), text.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_join_only_where_all_members_are_pairs() {
        assert_eq!(
            cliques(&[["a", "b"], ["a", "c"], ["b", "c"], ["c", "d"]]),
            [vec!["a", "b", "c"], vec!["c", "d"]]
        );
        assert!(cliques(&[]).is_empty());
    }
}
