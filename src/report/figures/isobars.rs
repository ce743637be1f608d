//! Relative force against relative contraction along isobars, with the readings near them (force paper, Fig. 4).

use crate::config::Config;
use crate::models::{ForceModel, P_620_KPA, new};
use crate::report::input::GroupInput;
use crate::report::plot::{
    Axis, DOUBLE_MM, Dash, Figure, Layer, Legend, Mark, Panel, Series, Stroke, look,
};
use crate::stages::fit::equations::{JOINT, cap_length_m};

/// Pressures of the isobars, kPa.
const ISOBARS_KPA: [f64; 6] = [100.0, 200.0, 300.0, 400.0, 500.0, 620.0];
/// Readings within this of an isobar are drawn with it, kPa.
const NEAR_KPA: f64 = 15.0;

/// The figure: the joint fit beside the published surface, with the same readings.
pub fn figure(group: &GroupInput, config: &Config) -> Option<(&'static str, String, Figure)> {
    let diameter = group.fit.group.diameter_mm;
    let c = group.fit.equation(JOINT)?.values();
    let offset = cap_length_m(diameter, &config.fit);
    let fitted = panel(group, [c[2], c[3], c[4]], |l| {
        new::f620(c[0], c[1], offset, l)
    })
    .title("Fitted here");
    let mut figure = Figure::new(
        &format!("Relative force along isobars, {}", group.fit.group.campaign),
        DOUBLE_MM,
        82.0,
    )
    .grid(2)
    .shared_legend()
    .with(fitted);
    if let Some(([b1, b2], surface)) = published(diameter) {
        figure = figure.with(
            panel(group, surface, |l| new::f620(b1, b2, offset, l)).title("Published coefficients"),
        );
    }
    let caption = format!(
        "Relative force against relative contraction. Curves are isobars of the surface; marks are readings within {NEAR_KPA:.0} kPa of \
         them, divided by F#sub[620] of their resting length from the same coefficients."
    );
    Some(("isobars", caption, figure))
}

fn panel(group: &GroupInput, c: [f64; 3], f620: impl Fn(f64) -> f64) -> Panel {
    let most = group
        .predictions
        .rows
        .iter()
        .map(|r| r.contraction_rel)
        .fold(0.0, f64::max);
    let least = group
        .predictions
        .rows
        .iter()
        .map(|r| r.contraction_rel)
        .fold(0.0, f64::min);
    let (low, high) = (least.max(-0.2) - 0.02, most.clamp(1.0, 1.3) + 0.02);
    let mut panel = Panel::new(
        Axis::new("ε* = ε/ε_{620}").fixed(low, high),
        Axis::new("F* = \\v{F}/F_{620}")
            .including(0.0)
            .including(1.05),
    )
    .legend(Legend::Above);
    for (k, isobar) in ISOBARS_KPA.iter().enumerate() {
        let (ink, shape, _) = look(k);
        let line = (0..=120)
            .map(|i| low + (high - low) * f64::from(i) / 120.0)
            .map(|e| (e, new::surface(c, e, isobar / P_620_KPA)))
            .collect();
        let near: Vec<(f64, f64)> = group
            .predictions
            .rows
            .iter()
            .filter(|r| (r.pressure_kpa - isobar).abs() <= NEAR_KPA)
            .map(|r| (r.contraction_rel, r.force_n / f620(r.rest_length_m)))
            .collect();
        let series = Series::line(
            &format!("{isobar:.0} kPa"),
            line,
            Stroke::new(ink, Dash::Solid),
        );
        panel = panel.with(series);
        if !near.is_empty() {
            panel = panel.with(Layer::from(Series::marks(
                "",
                near,
                Mark::open(shape, ink).wide(1.2),
            )));
        }
    }
    panel
}

/// The published b1, b2 and surface of a diameter; for 40 mm there is no law of length.
fn published(diameter_mm: u32) -> Option<([f64; 2], [f64; 3])> {
    let list = new::NewPublished.coefficients(diameter_mm);
    let of = |symbol: &str| list.iter().find(|c| c.symbol == symbol).map(|c| c.value);
    Some(([of("b1")?, of("b2")?], [of("c0")?, of("c1")?, of("c2")?]))
}
