//! One session beside what the law of other actuators expects of it.

use crate::figures::Named;
use crate::figures::formatting::verbatim;
use crate::plot::{Axis, DOUBLE_MM, Figure, Ink, Layer, Legend, Mark, Panel, Series, Shape};

const HEIGHT_MM: f64 = 80.0;

/// A reading: gauge pressure, kPa; measured, by the law, and with the session's own gain, length and zero, N.
pub type Point = [f64; 4];

/// Force over pressure, and what is left over pressure; nothing without readings.
pub fn figure(session: &str, points: &[Point]) -> Option<Named> {
    let force = |k: usize| points.iter().map(|p| (p[0], p[k])).collect();
    let left = |k: usize| points.iter().map(|p| (p[0], p[1] - p[k])).collect();
    let by_law = Mark::open(Shape::Square, Ink::Blue);
    let by_own = Mark::open(Shape::Diamond, Ink::Vermilion);
    let measured = Mark::filled(Shape::Circle, Ink::Black);
    let pressure = || Axis::new("Pressure (kPa)");
    let forces = Panel::new(pressure(), Axis::new("Force (N)").including(0.0))
        .legend(Legend::Above)
        .with(Series::marks("measured", force(1), measured))
        .with(Series::marks("law of others", force(2), by_law))
        .with(Series::marks(
            "with own gain, length and zero",
            force(3),
            by_own,
        ));
    let axis = Axis::new("Measured minus expected (N)").including(0.0);
    let residuals = Panel::new(pressure(), axis)
        .legend(Legend::None)
        .with(Layer::zero())
        .with(Series::marks("", left(2), by_law))
        .with(Series::marks("", left(3), by_own));
    let title = format!("Session {session}");
    (!points.is_empty()).then(|| Named {
        name: "inspection".to_owned(),
        caption: format!(
            "Session {} compared with the law of other actuators.",
            verbatim(session)
        ),
        figure: Figure::new(&title, DOUBLE_MM, HEIGHT_MM)
            .grid(2)
            .with(forces)
            .with(residuals),
    })
}
