//! The human muscles beside OpenSim's exports: moment arms and torques.

use super::angle_axis;
use crate::figures::Named;
use crate::figures::formatting::{number, plain};
use crate::plot::{Axis, DOUBLE_MM, Dash, Figure, Ink, Mark, Panel, Series, Shape, Stroke};
use crate::wording::name::muscle;
use pipeline_torque::reference::Reference;
use pipeline_torque::reference::human::{Compared, Compares, TARGET};

/// Name of its files.
pub const NAME: &str = "knee-human";
const HEIGHT_MM: f64 = 100.0;
/// Every so manieth row of an export is marked.
const EVERY: usize = 6;

/// The figure.
pub fn figure(reference: &Reference) -> Named {
    let of = |what: Compares, target: bool| {
        let all = reference.human.iter();
        all.filter(move |h| h.what == what && (h.against == TARGET) == target)
    };
    let flexor = |h: &&Compared| h.muscle == "bifemsh";
    let title = "Human muscles against OpenSim";
    let panels = [
        panel(
            "Biceps femoris, moment arm",
            of(Compares::Arm, false).filter(flexor),
        ),
        panel(
            "Vasti, moment arms",
            of(Compares::Arm, false).filter(|h| !flexor(h)),
        ),
        panel("Vasti, torques", of(Compares::Torque, false)),
        panel("Beside the design targets", of(Compares::Torque, true)),
    ];
    let figure = Figure::new(title, DOUBLE_MM, HEIGHT_MM);
    let figure = panels.into_iter().fold(figure, Figure::with).grid(2);
    let worst = |what: Compares| {
        let all = of(what, false).map(|h| (h.max, h.max_relative));
        all.fold((0.0, 0.0), |a: (f64, f64), b| (a.0.max(b.0), a.1.max(b.1)))
    };
    Named {
        name: NAME.to_owned(),
        caption: format!(
            "Calculated moment arms and torques of the human muscles (lines) against OpenSim's exports of Gait2392 (marks, every sixth row). Arms are at most {} mm apart, torques {}%. (D) The laboratory's design targets (marks) are moment arm times maximum isometric force and leave out what length, tendon and pennation take.",
            number(1e3 * worst(Compares::Arm).0, 2),
            number(100.0 * worst(Compares::Torque).1, 1)
        ),
        figure: figure.grid(2),
    }
}

fn panel<'a>(title: &str, compared: impl Iterator<Item = &'a Compared>) -> Panel {
    let looks = [
        (Ink::Blue, Dash::Solid, Shape::Circle),
        (Ink::Vermilion, Dash::Dashed, Shape::Square),
        (Ink::Green, Dash::DashDot, Shape::Triangle),
        (Ink::Black, Dash::Long, Shape::Diamond),
    ];
    let compared: Vec<&Compared> = compared.collect();
    let arms = compared.iter().any(|h| h.what == Compares::Arm);
    let (label, factor) = if arms {
        ("Moment arm \\v{r} (mm)", 1e3)
    } else {
        ("Torque (N m)", 1.0)
    };
    let mut panel = Panel::new(angle_axis(), Axis::new(label)).title(title);
    for (h, (ink, dash, shape)) in compared.iter().zip(looks) {
        let at = |k: usize, x: f64| (h.rows[k].0.to_degrees(), factor * x);
        let line = (0..h.rows.len()).map(|k| at(k, h.rows[k].1)).collect();
        let marks = (0..h.rows.len()).step_by(EVERY);
        let marks = marks.map(|k| at(k, h.rows[k].2)).collect();
        let name = plain(muscle(&h.muscle));
        let mark = Mark::open(shape, ink).wide(1.2);
        panel = panel
            .with(Series::line(&name, line, Stroke::new(ink, dash)))
            .with(Series::marks("", marks, mark));
    }
    panel
}
