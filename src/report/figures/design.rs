//! The curve that a design has to meet, and the muscles of every diameter beside it.

use crate::figures::Named;
use crate::plot::{Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Legend, Panel, Series, Stroke, look};
use pipeline_predict::design::{AtPoint, Design};
use pipeline_predict::muscle::mm;

const HEIGHT_MM: f64 = 90.0;

/// The figure. `scale`: from the abscissa of the points to the one that is shown.
pub fn figure(label: &str, unit: &str, scale: f64, found: &[Design]) -> Named {
    let title = "Muscles that meet a curve";
    let name = if unit == "N" { "Force" } else { "Torque" };
    let unit = unit.replace('.', " ");
    let mut panel = Panel::new(
        Axis::new(label),
        Axis::new(&format!("{name} ({unit})")).including(0.0),
    )
    .legend(Legend::Beside);
    let x = |p: &AtPoint| scale * p.point.at;
    for (k, design) in found.iter().enumerate() {
        let ink = look(k).0;
        let ends = |p: &AtPoint| Some((x(p), p.low?, p.high?));
        let band: Vec<(f64, f64, f64)> = design.points.iter().filter_map(ends).collect();
        if !band.is_empty() {
            panel = panel.with(Layer::band("", band, ink));
        }
        let line = design.points.iter().map(|p| (x(p), p.available));
        let short = if design.meets { "" } else { ", falls short" };
        let name = format!(
            "{} mm muscle, {} long{short}",
            design.diameter_mm,
            mm(design.rest_length_m)
        );
        let dash = if design.meets {
            Dash::Solid
        } else {
            Dash::Dotted
        };
        panel = panel.with(Series::line(&name, line.collect(), Stroke::new(ink, dash)));
    }
    if let Some(design) = found.first() {
        let needed = design.points.iter().map(|p| (x(p), p.point.needed));
        let stroke = Stroke::new(Ink::Black, Dash::Dashed);
        panel = panel.with(Series::line("needed", needed.collect(), stroke));
        panel = panel.title("bands: 95% interval");
    }
    Named {
        name: "design".to_owned(),
        caption: title.to_owned(),
        figure: Figure::new(title, DOUBLE_MM, HEIGHT_MM).with(panel),
    }
}
