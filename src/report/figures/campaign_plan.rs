//! A campaign that has not been measured: the error to expect, with one thing more too, and its set points.

use crate::figures::Named;
use crate::plot::{
    Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Legend, Mark, Panel, Series, Shape, Stroke,
};

/// Height of a bar's band, and of what is around the bands, mm.
const BAND_MM: f64 = 7.0;
const AROUND_MM: f64 = 26.0;
/// Least height: below, the set points would be squeezed.
const LEAST_MM: f64 = 62.0;

/// An error to expect: of what, N, and its standard error against the plan as it is.
pub struct Expected {
    /// The plan, or what it has more.
    pub what: String,
    /// N.
    pub error_n: f64,
    /// Standard error of the difference from the plan, N; none of the plan itself.
    pub spread_n: Option<f64>,
}

/// The figure. `expected`: the plan first; `planned` and `best` are set points as relative contraction and gauge pressure, kPa.
pub fn figure(
    title: &str,
    expected: &[Expected],
    planned: Vec<(f64, f64)>,
    best: Vec<(f64, f64)>,
) -> Named {
    let rows: Vec<&Expected> = expected.iter().rev().collect();
    let names: Vec<&str> = rows.iter().map(|e| e.what.as_str()).collect();
    let mut errors = Panel::new(
        Axis::new("Error expected on an unseen actuator (N)").including(0.0),
        Axis::categories("", &names),
    )
    .legend(Legend::None);
    let places = rows.iter().enumerate().map(|(k, e)| (k as f64, *e));
    for (place, own) in places.clone() {
        let line = vec![(0.0, place), (own.error_n, place)];
        errors = errors.with(Series::line("", line, Stroke::hair(Ink::Grey, Dash::Solid)));
    }
    let points = places
        .clone()
        .map(|(place, e)| (e.error_n, place))
        .collect();
    let ends = places.map(|(_, e)| {
        let spread = e.spread_n.unwrap_or(0.0);
        (e.error_n - spread, e.error_n + spread)
    });
    let mark = Mark::filled(Shape::Circle, Ink::Blue);
    errors = errors.with(Layer::from(
        Series::marks("", points, mark).with_x_errors(ends.collect()),
    ));
    let mut set_points = Panel::new(
        Axis::new("Relative contraction ε*").including(0.0),
        Axis::new("Gauge pressure \\v{P} (kPa)").including(0.0),
    )
    .legend(Legend::Above)
    .with(Series::marks(
        "planned",
        planned,
        Mark::open(Shape::Circle, Ink::Grey),
    ));
    if !best.is_empty() {
        let mark = Mark::filled(Shape::Diamond, Ink::Vermilion);
        set_points = set_points.with(Series::marks("best further", best, mark));
    }
    let height = (AROUND_MM + BAND_MM * rows.len() as f64).max(LEAST_MM);
    Named {
        name: "plan".to_owned(),
        caption: format!(
            "{title}: the error expected on an unseen actuator as planned and with one addition (bars: standard error of the difference), and set \
             points."
        ),
        figure: Figure::new(title, DOUBLE_MM, height)
            .grid(2)
            .with(errors)
            .with(set_points),
    }
}
