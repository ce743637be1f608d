//! Predicted torque over the range of a knee, beside a human muscle.

use crate::figures::Named;
use crate::figures::formatting::plain;
use crate::plot::{Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Legend, Panel, Series, Stroke};
use pipeline_predict::Predictor;
use pipeline_predict::muscle::mm;
use pipeline_predict::torque::{AtAngle, Built};

const HEIGHT_MM: f64 = 90.0;

/// The figure.
pub fn figure(
    predictor: &Predictor,
    built: &Built,
    human: Option<&str>,
    pressure_kpa: f64,
    found: &[AtAngle],
) -> Named {
    let law = predictor.choice.law.title();
    let title = format!("Predicted torque, {law}");
    let muscle = &predictor.muscle;
    let heading = format!(
        "{} mm, l_{{rest}} {}, {pressure_kpa:.0} kPa; route {}; {}",
        muscle.diameter_mm,
        mm(muscle.rest_length_m),
        plain(&built.leg.route.name),
        plain(&law)
    );
    let mut panel = Panel::new(Axis::new("Knee angle θ (°)"), Axis::new("Torque (N m)"))
        .legend(Legend::Beside)
        .title(&heading)
        .with(Layer::zero());
    let band = found.iter().filter_map(|a| {
        let (one, other) = a.interval_nm?;
        Some((a.angle_deg, one.min(other), one.max(other)))
    });
    let band: Vec<(f64, f64, f64)> = band.collect();
    if !band.is_empty() {
        panel = panel.with(Layer::band("95% interval", band, Ink::Blue));
    }
    let curve = |of: &dyn Fn(&AtAngle) -> Option<f64>| {
        let point = |a: &AtAngle| (a.angle_deg, of(a).unwrap_or(f64::NAN));
        found.iter().map(point).collect::<Vec<_>>()
    };
    let inside = curve(&|a| a.torque_nm.filter(|_| a.warnings.is_empty()));
    let outside = curve(&|a| a.torque_nm.filter(|_| !a.warnings.is_empty()));
    for (name, points, dash) in [
        ("actuator", inside, Dash::Solid),
        ("actuator, extrapolated", outside, Dash::Dotted),
    ] {
        if points.iter().any(|p| p.1.is_finite()) {
            panel = panel.with(Series::line(name, points, Stroke::new(Ink::Blue, dash)));
        }
    }
    if let Some(human) = human {
        let stroke = Stroke::new(Ink::Black, Dash::Dashed);
        let name = format!("human, {}", plain(human));
        panel = panel.with(Series::line(&name, curve(&|a| a.human_nm), stroke));
    }
    Named {
        name: "torque".to_owned(),
        caption: title.clone(),
        figure: Figure::new(&title, DOUBLE_MM, HEIGHT_MM).with(panel),
    }
}
