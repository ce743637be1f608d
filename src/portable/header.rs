//! What stands at the head of every file: the law, its coefficients, the box, the sign, the interval, where it comes from.

use crate::domain::Range;
use crate::model::{BoxOf, Model, Named};

/// The head, a line each.
pub fn lines(model: &Model) -> Vec<String> {
    let mut lines = vec![
        format!(
            "Force of a braided pneumatic actuator of {} mm: {}.",
            model.diameter_mm, model.title
        ),
        format!(
            "Written by `pipeline export model`, version {}; do not edit, export again.",
            env!("CARGO_PKG_VERSION")
        ),
        String::new(),
        "Sign: tension is positive, a muscle that pulls its ends together; the force is never negative. Static: no history, no rate.".to_owned(),
        "Lengths between the clamps, m: l_rest without pressure, l_620 free at 620 kPa, l now. Gauge pressure P, kPa.".to_owned(),
        String::new(),
    ];
    lines.extend(model.equations.iter().map(|e| format!("  {e}")));
    lines.push("Coefficients, with 95% intervals where there are any:".to_owned());
    lines.extend(model.coefficients.iter().map(coefficient));
    lines.push(String::new());
    lines.extend(domain(model));
    lines.push(String::new());
    lines.extend(spread(model));
    lines.extend(model.effects.iter().cloned());
    lines.extend(model.provenance.iter().cloned());
    lines
}

fn coefficient(c: &Named) -> String {
    let unit = if c.unit == "1" {
        String::new()
    } else {
        format!(" {}", c.unit)
    };
    let interval = c.interval.map_or_else(String::new, |(low, high)| {
        format!(" ({low:.6} to {high:.6})")
    });
    format!("  {} = {}{unit}{interval}", c.symbol, c.value)
}

fn domain(model: &Model) -> Vec<String> {
    let fitted = model.fitted();
    let side = |name: &str, (low, high): Range, unit: &str| {
        format!("  {name} {low:.4} to {high:.4}{unit}")
    };
    let whose = match model.box_of {
        BoxOf::Readings => "Box of the readings fitted:",
        BoxOf::Source => "Box for which the coefficients are published; nothing was fitted here:",
    };
    vec![
        whose.to_owned(),
        side("resting length", fitted.rest_length_m, " m"),
        side("contraction at 620 kPa (l_rest - l_620)/l_rest", fitted.contraction_620, ""),
        side("relative contraction eps*", fitted.contraction_rel, ""),
        side("gauge pressure", fitted.pressure_kpa, " kPa"),
        "Outside of it the function is a continuation that never exceeds the largest force of the box: a stretched muscle keeps the force of the"
            .to_owned(),
        "edge, a pressure above counts as the highest one, a longer muscle as the longest one; a muscle contracted further, vented or shorter"
            .to_owned(),
        "follows the law down to zero. Derivatives may jump at the edges of the box and where the muscle goes slack.".to_owned(),
    ]
}

fn spread(model: &Model) -> Vec<String> {
    let Some(s) = model.spread else {
        return vec!["Interval for an unmeasured muscle: none, because how specimens scatter about it is not known.".to_owned()];
    };
    vec![
        "95% interval of the force of an unmeasured muscle of the same make, inside the box:"
            .to_owned(),
        format!(
            "  F -/+ {:.3} sqrt(({:.4} F)^2 + ({:.3} N)^2), Student's t of {} df: gains of specimens; {}.",
            s.t,
            s.between,
            s.within_n,
            s.freedom.round(),
            s.within_of
        ),
        "  `pipeline predict` has the interval state by state.".to_owned(),
    ]
}
