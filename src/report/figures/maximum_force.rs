//! Maximum force at 620 kPa against resting length: measured, fitted, published (force paper, Fig. 2).

use crate::config::Config;
use crate::models::{
    Direction, ForceModel, P_620_KPA, Prediction, State, festo_tool::FestoTool, new,
};
use crate::report::input::GroupInput;
use crate::report::plot::{Axis, Dash, Figure, Ink, Mark, Panel, SINGLE_MM, Series, Shape, Stroke};
use crate::stages::fit::equations::{JOINT, MAXIMUM_FORCE, cap_length_m};

/// The figure, for groups with at least two resting lengths.
pub fn figure(group: &GroupInput, config: &Config) -> Option<(&'static str, String, Figure)> {
    let measured: Vec<(f64, f64)> = group
        .fit
        .specimens
        .iter()
        .filter_map(|s| Some((1e3 * s.rest_length_m, s.maximum.as_ref()?.force_n)))
        .collect();
    if measured.len() < 2 {
        return None;
    }
    let panel = panel(group, config, &measured);
    let title = format!(
        "Maximum force against resting length, {}",
        group.fit.group.campaign
    );
    let caption = "Maximum force at 620 kPa and resting length: measured on each specimen, as fitted here to these maxima and jointly with \
        all coefficients, as published, and as the manufacturer's tool has it for any length."
        .to_owned();
    Some((
        "f620",
        caption,
        Figure::new(&title, SINGLE_MM, 65.0).with(panel),
    ))
}

/// Every curve there is, and the measured maxima.
fn panel(group: &GroupInput, config: &Config, measured: &[(f64, f64)]) -> Panel {
    let diameter = group.fit.group.diameter_mm;
    let longest = measured.iter().map(|m| m.0).fold(0.0, f64::max);
    let offset = cap_length_m(diameter, &config.fit);
    let curve = |b1: f64, b2: f64| -> Vec<(f64, f64)> {
        let step = 1.1 * longest / 150.0;
        (0..=150)
            .map(|k| f64::from(k) * step)
            .filter(|mm| 1e-3 * mm > offset)
            .map(|mm| (mm, new::f620(b1, b2, offset, 1e-3 * mm)))
            .collect()
    };
    let mut panel = Panel::new(
        Axis::new("l_{rest} (mm)").including(0.0),
        Axis::new("F_{620} (N)").including(0.0),
    );
    let fits = [
        (MAXIMUM_FORCE, "fitted to the maxima", Dash::Solid),
        (JOINT, "fitted jointly", Dash::Dashed),
    ];
    for (id, name, dash) in fits {
        if let Some(fit) = group.fit.equation(id) {
            let b = fit.values();
            panel = panel.with(Series::line(
                name,
                curve(b[0], b[1]),
                Stroke::new(Ink::Blue, dash),
            ));
        }
    }
    if let Some((b1, b2)) = published(diameter) {
        panel = panel.with(Series::line(
            "published",
            curve(b1, b2),
            Stroke::new(Ink::Vermilion, Dash::DashDot),
        ));
    }
    if let Some(force) = festo(diameter) {
        let line = vec![(0.0, force), (1.1 * longest, force)];
        panel = panel.with(Series::line(
            "Festo tool",
            line,
            Stroke::new(Ink::Grey, Dash::Dotted),
        ));
    }
    panel = panel.with(Series::marks(
        "measured",
        measured.to_vec(),
        Mark::filled(Shape::Circle, Ink::Black),
    ));
    panel
}

fn published(diameter_mm: u32) -> Option<(f64, f64)> {
    let list = new::NewPublished.coefficients(diameter_mm);
    let of = |symbol: &str| list.iter().find(|c| c.symbol == symbol).map(|c| c.value);
    of("b1").zip(of("b2"))
}

/// The Festo tool's force at 620 kPa without contraction.
fn festo(diameter_mm: u32) -> Option<f64> {
    let state = State {
        diameter_mm: f64::from(diameter_mm),
        rest_length_m: 0.3,
        contracted_length_m: 0.25,
        length_m: 0.3,
        pressure_kpa: P_620_KPA,
        direction: Direction::Isometric,
    };
    match FestoTool.predict(&state) {
        Prediction::Force(force) => Some(force),
        _ => None,
    }
}
