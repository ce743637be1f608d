//! Full-size actuators of the biomimetic leg beside the human muscles (the knee paper's Fig. 15).

use super::{angle_axis, over_angle};
use crate::figures::Named;
use crate::plot::{
    Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Legend, Mark, Panel, Series, Shape, Stroke,
};
use pipeline_torque::reference::Reference;
use pipeline_torque::reference::design::Design;
use pipeline_torque::reference::human::Compares;

/// Name of its files.
pub const NAME: &str = "knee-design";
const HEIGHT_MM: f64 = 66.0;
/// Every so manieth row of an export is marked.
const EVERY: usize = 6;

/// The figure.
pub fn figure(reference: &Reference) -> Named {
    let title = "Torque of full-size actuators and of human muscles";
    let figure = Figure::new(title, DOUBLE_MM, HEIGHT_MM);
    let panels = reference.design.iter().map(|d| panel(reference, d));
    Named {
        name: NAME.to_owned(),
        caption: "Torque of the full-size actuators of the biomimetic leg at 620 kPa against that of the human muscles that they represent: (A) 20 mm and the short head of biceps femoris, (B) 40 mm and the vasti. Design targets are moment arm times maximum isometric force. The extensor follows the route of the 10 mm actuator, and the fittings are taken as 25.4 mm.".to_owned(),
        figure: panels.fold(figure, Figure::with).grid(2),
    }
}

fn panel(reference: &Reference, d: &Design) -> Panel {
    let heading = format!(
        "{}, {} mm, l_{{rest}} {:.0} mm",
        if d.muscle == "flexor" {
            "Flexor"
        } else {
            "Extensor"
        },
        d.diameter_mm,
        1e3 * d.rest_length_m
    );
    let mut panel = Panel::new(angle_axis(), Axis::new("Torque (N m)"))
        .title(&heading)
        .legend(Legend::Above)
        .with(Layer::zero());
    let human = over_angle(&d.angles_rad, d.human_nm.iter().copied());
    let stroke = Stroke::new(Ink::Black, Dash::Solid);
    panel = panel.with(Series::line("human, calculated", human, stroke));
    let names = [
        ("actuator, knee paper", Ink::Blue, Dash::Dashed),
        ("actuator, force paper", Ink::Vermilion, Dash::DashDot),
    ];
    for ((name, ink, dash), values) in names.into_iter().zip(&d.actuator_nm) {
        let values = values.iter().map(|t| t.unwrap_or(f64::NAN));
        let line = over_angle(&d.angles_rad, values);
        panel = panel.with(Series::line(name, line, Stroke::new(ink, dash)));
    }
    let references = reference.human.iter();
    for h in references.filter(|h| h.what == Compares::Torque && h.muscle == d.human) {
        let rows = h.rows.iter().step_by(EVERY);
        let marks = rows.map(|r| (r.0.to_degrees(), r.2)).collect();
        let (name, mark) = if h.against == pipeline_torque::reference::human::TARGET {
            ("design target", Mark::open(Shape::Cross, Ink::Grey))
        } else {
            ("OpenSim", Mark::open(Shape::Circle, Ink::Green))
        };
        panel = panel.with(Series::marks(name, marks, mark.wide(1.2)));
    }
    panel
}
