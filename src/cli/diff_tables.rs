//! The tables of `pipeline diff`: what two sides measured, fitted, missed and found.

use crate::diff::Side;
use crate::summary::GroupModels;
use pipeline_findings::{CampaignFindings, EffectFinding};
use pipeline_fit::GroupFit;
use pipeline_fit::engine::CoefficientFit;
use pipeline_report::number::Rounding;
use pipeline_report::wording::name;
use pipeline_report::wording::number::{amounts, rounded};

/// A part of the comparison: a heading, and lines of which the first has the names of the columns.
pub(super) struct Section {
    pub title: &'static str,
    pub rows: Vec<Vec<String>>,
}

const NOTHING: &str = "-";

fn digits(value: f64) -> String {
    rounded(value, Rounding::Digits(4))
}

fn or_nothing(value: Option<f64>) -> String {
    value.map_or_else(|| NOTHING.to_owned(), digits)
}

fn with_interval(c: &CoefficientFit) -> String {
    match c.ci_low.zip(c.ci_high) {
        Some((low, high)) => format!("{} [{}, {}]", digits(c.value), digits(low), digits(high)),
        None => digits(c.value),
    }
}

/// The parts of a comparison that are tables.
pub(super) fn sections([first, second]: [&Side; 2]) -> Vec<Section> {
    let heads = |what: &str, more: &[&str]| -> Vec<String> {
        let names = [what, &first.name, &second.name];
        names.iter().chain(more).map(|s| (*s).to_owned()).collect()
    };
    let of_fits = |name: &str, of: &dyn Fn(&GroupFit) -> usize| {
        vec![
            name.to_owned(),
            of(first.fit).to_string(),
            of(second.fit).to_string(),
        ]
    };
    let measured = vec![
        heads("", &[]),
        of_fits("specimens", &|f| f.specimens.len()),
        of_fits("sessions", &|f| {
            f.specimens.iter().map(|s| s.sessions).sum()
        }),
        of_fits("readings fitted", &|f| f.rows),
    ];
    let mut coefficients = vec![heads("", &["unit", "difference"])];
    for a in first.coefficients() {
        let other = second.coefficients().iter().find(|b| b.symbol == a.symbol);
        coefficients.push(vec![
            a.symbol.clone(),
            other.map_or_else(|| NOTHING.to_owned(), |_| with_interval(a)),
            other.map_or_else(|| NOTHING.to_owned(), with_interval),
            a.unit.clone(),
            or_nothing(other.map(|b| b.value - a.value)),
        ]);
    }
    vec![
        Section {
            title: "Measured",
            rows: measured,
        },
        Section {
            title: "Coefficients, fitted jointly (95% intervals)",
            rows: coefficients,
        },
        Section {
            title: "Errors (RMSE on unseen specimens, N)",
            rows: errors(first, second, heads("", &["difference"])),
        },
        Section {
            title: "Residual search",
            rows: found(first, second, heads("", &[])),
        },
    ]
}

fn errors(first: &Side, second: &Side, head: Vec<String>) -> Vec<Vec<String>> {
    let mut rows = vec![head];
    let mut push = |name: String, a: Option<f64>, b: Option<f64>| {
        if a.is_some() || b.is_some() {
            let change = a.zip(b).map(|(a, b)| b - a);
            rows.push(vec![name, or_nothing(a), or_nothing(b), or_nothing(change)]);
        }
    };
    let models = [first, second].into_iter().filter_map(|s| s.models);
    let mut ids: Vec<&str> = models.flat_map(GroupModels::ids).collect();
    ids.sort_unstable();
    ids.dedup();
    for id in ids {
        let of = |side: &Side| side.models.and_then(|m| m.rmse(id));
        let title = name::model_name(id, id);
        push(format!("{title}, law alone"), of(first), of(second));
    }
    type Of = fn(&CampaignFindings) -> Option<f64>;
    let of_search: [(&str, Of); 4] = [
        ("mixed model without effects", |f| f.before.rmse_heldout),
        ("mixed model with effects", |f| f.after.rmse_heldout),
        ("the same, own gain and lengths known", |f| {
            f.after.rmse_heldout_calibrated
        }),
        ("log density per reading", |f| f.after.log_density_heldout),
    ];
    for (title, of) in of_search {
        let of = |side: &Side| side.found.and_then(of);
        push(title.to_owned(), of(first), of(second));
    }
    rows
}

/// The effects that the search of a side found.
fn effects<'r>(side: &Side<'r>) -> Vec<&'r EffectFinding> {
    side.found
        .map_or(Vec::new(), |f| f.effects.iter().collect())
}

/// Verdicts, and the effects of either.
fn found(first: &Side, second: &Side, head: Vec<String>) -> Vec<Vec<String>> {
    let verdict = |side: &Side| {
        let found = side.found;
        found.map_or(NOTHING.to_owned(), |f| name::verdict(f.verdict).to_owned())
    };
    let mut rows = vec![
        head,
        vec!["verdict".to_owned(), verdict(first), verdict(second)],
    ];
    let (own, others) = (effects(first), effects(second));
    let size = |e: Option<&&EffectFinding>| {
        e.map_or_else(
            || NOTHING.to_owned(),
            |e| {
                let amounts = amounts(&e.parameters).unwrap_or_default();
                let form = if e.negligible { ", negligible" } else { "" };
                format!("{amounts} ({}{form})", e.form)
            },
        )
    };
    let mut ids: Vec<&str> = own.iter().chain(&others).map(|e| e.id.as_str()).collect();
    ids.sort_unstable();
    ids.dedup();
    for id in ids {
        let of = |all: &[&EffectFinding]| size(all.iter().find(|e| e.id == id));
        rows.push(vec![name::effect(id), of(&own), of(&others)]);
    }
    let columns = |side: &Side| {
        let found = side.found.iter().flat_map(|f| &f.unexplained);
        let all: Vec<&str> = found.map(|u| u.column.as_str()).collect();
        if all.is_empty() {
            NOTHING.to_owned()
        } else {
            all.join(", ")
        }
    };
    let (a, b) = (columns(first), columns(second));
    if a != NOTHING || b != NOTHING {
        rows.push(vec!["unexplained dependence on".to_owned(), a, b]);
    }
    rows
}
