//! `baselines`: what each compared model reproduces of its authors' own numbers.

use crate::described::*;
use crate::input::ReportInput;
use crate::wording::name::model_name;
use pipeline_mechanics::models::gate::{Gate, gate};

/// The table; it depends on no data.
#[rustfmt::skip]
pub fn baselines(_: &ReportInput) -> Table {
    let gates = gate();
    Described::<&Gate>::new("baselines", "Baselines: what each model reproduces before it is compared")
        .text("model", "Model", |g| g.model).machines()
        .text("title", "Model", |g| model_name(g.model, g.model)).people().once()
        .count("diameter_mm", "⌀", Mm, |g| is_known(g).then_some(g.diameter_mm))
        .text("against", "Reproduces", |g| if is_known(g) { g.against } else { "nothing: its authors printed no force" })
        .count("values", "Values", One, |g| g.values)
        .rounded("miss", "Miss", One, |g| share(g.miss))
        .rounded("claimed", "Claimed", One, |g| share(g.claimed.unwrap_or(f64::NAN)))
        .rounded("allowed", "Allowed", One, |g| share(g.allowed))
        .text("verdict", "Compared", verdict)
        .note("Misses are the largest, as a share of the largest force among the values. A model that misses by more than is allowed is not compared.")
        .blocks(runs(&gates, |a, b| a.model == b.model))
}

fn is_known(gate: &Gate) -> bool {
    gate.values > 0
}

fn share(x: f64) -> (Option<f64>, Rounding) {
    (finite(x), Percent(if x < 1e-3 { 3 } else { 1 }))
}

fn verdict(gate: &Gate) -> &'static str {
    match (is_known(gate), gate.passes()) {
        (false, _) => "yes, unchecked",
        (true, true) => "yes",
        (true, false) => "no",
    }
}
