//! A leg: the route over the knee at three angles, and its moment arm by both methods.

use super::{angle_axis, over_angle};
use crate::figures::Named;
use crate::figures::formatting::{number, plain};
use crate::plot::{
    Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Legend, Mark, Panel, Series, Shape, Stroke,
};
use crate::wording::name::route;
use pipeline_torque::Configuration;
use pipeline_torque::reference::arms::Arms;

const HEIGHT_MM: f64 = 88.0;
/// Width over height of the left plot, so that a metre is as long upwards as sideways.
const ASPECT: f64 = 0.95;

/// The name of a leg's figure.
pub fn name(c: &Configuration) -> String {
    match c.knee.as_str() {
        "described" => format!("knee-leg-{}", c.id),
        knee => format!("knee-leg-{knee}-{}", c.route),
    }
}

/// The figure.
pub fn figure(c: &Configuration) -> Named {
    let arms = &c.arms;
    let title = format!("{} knee, route {}", c.knee, route(&c.route));
    let figure = Figure::new(&title, DOUBLE_MM, HEIGHT_MM)
        .with(drawing(arms))
        .with(methods(arms))
        .grid(2);
    Named {
        name: name(c),
        caption: caption(c),
        figure,
    }
}

/// The route in the plane of the motion.
fn drawing(arms: &Arms) -> Panel {
    let routes = arms.drawn.iter().flat_map(|(_, points)| points);
    let tibia = arms.tibia.iter().flatten();
    let all: Vec<(f64, f64)> = routes.chain(tibia).copied().chain([(0.0, 0.0)]).collect();
    let ends = |f: fn(&(f64, f64)) -> f64| {
        let values = all.iter().map(f);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        })
    };
    let (left, right) = ends(|p| p.0);
    let (bottom, top) = ends(|p| p.1);
    let height = 1.1 * (top - bottom).max((right - left) / ASPECT);
    let (x, y) = (0.5 * (left + right), 0.5 * (bottom + top));
    let width = ASPECT * height;
    let mut panel = Panel::new(
        Axis::new("\\v{x}, forward (m)").fixed(x - 0.5 * width, x + 0.5 * width),
        Axis::new("\\v{y}, up (m)").fixed(y - 0.5 * height, y + 0.5 * height),
    )
    .title("The route at three knee angles");
    let looks = [
        (Ink::Blue, Dash::Solid, Shape::Circle),
        (Ink::Vermilion, Dash::Dashed, Shape::Square),
        (Ink::Green, Dash::DashDot, Shape::Triangle),
    ];
    if let Some([origin, _]) = arms.tibia.first() {
        let femur = vec![(0.0, 0.0), *origin];
        let stroke = Stroke::hair(Ink::Grey, Dash::Solid);
        panel = panel.with(Series::line("bones", femur, stroke));
    }
    for (((degrees, points), bone), (ink, dash, shape)) in
        arms.drawn.iter().zip(&arms.tibia).zip(looks)
    {
        let stroke = Stroke::hair(Ink::Grey, Dash::Solid);
        panel = panel.with(Series::line("", bone.to_vec(), stroke));
        let name = format!("{}°", number(*degrees, 0));
        let mark = Mark::open(shape, ink).wide(1.2);
        let line = Series::line(&name, points.clone(), Stroke::new(ink, dash));
        panel = panel.with(line.with_marks(mark));
    }
    panel
}

/// The moment arm by both methods, and where points come in.
fn methods(arms: &Arms) -> Panel {
    let line = |values: &[f64]| over_angle(&arms.angles_rad, values.iter().map(|r| 1e3 * r));
    let mut panel = Panel::new(angle_axis(), Axis::new("Moment arm \\v{r} (mm)"))
        .title("The moment arm by both methods")
        .legend(Legend::Above);
    let series = [
        ("−dL/dθ (Eq. 2)", &arms.arm_m, Ink::Black, Dash::Solid),
        (
            "projection about the centre (Eq. 3)",
            &arms.projected_m,
            Ink::Orange,
            Dash::Dotted,
        ),
        (
            "projection about p_k",
            &arms.about_origin_m,
            Ink::Purple,
            Dash::Long,
        ),
    ];
    // Where the tibia turns about the origin of its own frame, the last is the second.
    let parted = (arms.apart_about_origin.0 - arms.apart_in_plane.0).abs() > 1e-4;
    let shown = if parted { 3 } else { 2 };
    for (name, values, ink, dash) in series.into_iter().take(shown) {
        panel = panel.with(Series::line(name, line(values), Stroke::new(ink, dash)));
    }
    let switches: Vec<f64> = arms
        .switches
        .iter()
        .map(|s| s.angle_rad.to_degrees())
        .collect();
    if !switches.is_empty() {
        panel = panel.with(Layer::steps("points become active", switches));
    }
    panel
}

fn caption(c: &Configuration) -> String {
    let (arms, parted) = (&c.arms, c.arms.apart);
    let name = plain(&route(&c.route)).replace('\\', "");
    let mut caption = format!(
        "The {} knee with the route \"{name}\": points in the plane of the motion, and the moment arm. The two methods are at most {} mm apart, at {}°: {}.",
        c.knee,
        number(1e3 * parted.0, 2),
        number(parted.1, 0),
        arms.why
    );
    let jump = arms
        .switches
        .iter()
        .max_by(|a, b| a.length_jump_m.abs().total_cmp(&b.length_jump_m.abs()));
    if let Some(jump) = jump.filter(|j| j.length_jump_m.abs() > 5e-5) {
        caption += &format!(
            " At {}° the length of the path jumps by {} mm: a point becomes active that does not lie on the line that it bends.",
            number(jump.angle_rad.to_degrees(), 0),
            number(1e3 * jump.length_jump_m.abs(), 2)
        );
    }
    caption
}
