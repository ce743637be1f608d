//! What is drawn in a figure, as CSV beside it: one row a point, with its panel, axes and series. Texts and lines without data (`y = x`) are not in it.

use crate::described::*;
use crate::markup::plain;
use crate::plot::axis::Ticks;
use crate::plot::{Axis, Figure, Layer, Panel, Series};
use crate::render::{Renderer, csv::Csv};

/// A point of a layer.
#[derive(Clone, Debug, Default, PartialEq)]
struct Point {
    panel: usize,
    title: String,
    axes: [String; 2],
    series: String,
    kind: &'static str,
    x: f64,
    y: f64,
    /// Ends of a bar, band or window along each axis.
    ends: [Option<(f64, f64)>; 2],
    /// What the place on an axis of names stands for.
    category: Option<String>,
}

/// The data of a figure.
pub fn csv(figure: &Figure) -> String {
    let panels = figure.panels.iter().enumerate();
    let points: Vec<Point> = panels
        .flat_map(|(k, panel)| of_panel(k + 1, panel))
        .collect();
    Csv.render(&table(&points))
}

fn table(points: &[Point]) -> Table {
    let low = |ends: Option<(f64, f64)>| ends.map(|e| e.0).filter(|x| x.is_finite());
    let high = |ends: Option<(f64, f64)>| ends.map(|e| e.1).filter(|x| x.is_finite());
    let full = Digits(17);
    Described::<&Point>::new("figure", "")
        .count("panel", "", One, |p| p.panel)
        .text("title", "", |p| (!p.title.is_empty()).then_some(&p.title))
        .text("x_axis", "", |p| &p.axes[0])
        .text("y_axis", "", |p| &p.axes[1])
        .text("series", "", |p| {
            (!p.series.is_empty()).then_some(&p.series)
        })
        .text("kind", "", |p| p.kind)
        .number("x", "", One, full, |p| finite(p.x))
        .number("y", "", One, full, |p| finite(p.y))
        .number("x_low", "", One, full, move |p| low(p.ends[0]))
        .number("x_high", "", One, full, move |p| high(p.ends[0]))
        .number("y_low", "", One, full, move |p| low(p.ends[1]))
        .number("y_high", "", One, full, move |p| high(p.ends[1]))
        .text("category", "", |p| &p.category)
        .rows(points)
}

fn of_panel(number: usize, panel: &Panel) -> Vec<Point> {
    let of_layer = |layer: &Layer| {
        let points = of_layer(layer).into_iter();
        points.map(|point| Point {
            panel: number,
            title: plain(&panel.title),
            axes: [plain(&panel.x.label), plain(&panel.y.label)],
            category: category(&panel.x, point.x).or_else(|| category(&panel.y, point.y)),
            ..point
        })
    };
    panel.layers.iter().flat_map(of_layer).collect()
}

/// The name of the place nearest to a value, on an axis of categories; these stand at 0, 1, 2 and so on.
fn category(axis: &Axis, value: f64) -> Option<String> {
    let Ticks::Named(names) = &axis.ticks else {
        return None;
    };
    if names.iter().enumerate().any(|(k, (at, _))| *at != k as f64) {
        return None;
    }
    let off = |at: f64| (at - value).abs();
    let nearest = names.iter().min_by(|a, b| off(a.0).total_cmp(&off(b.0)))?;
    value.is_finite().then(|| plain(&nearest.1))
}

fn of_layer(layer: &Layer) -> Vec<Point> {
    let nowhere = |name: &String, kind| Point {
        series: plain(name),
        kind,
        x: f64::NAN,
        y: f64::NAN,
        ..Point::default()
    };
    match layer {
        Layer::Series(series) => of_series(series),
        Layer::Band { name, points, .. } => {
            let point = |(x, low, high): &(f64, f64, f64)| Point {
                x: *x,
                ends: [None, Some((*low, *high))],
                ..nowhere(name, "band")
            };
            points.iter().map(point).collect()
        }
        Layer::Windows { name, spans, .. } => {
            let point = |span: &(f64, f64)| Point {
                ends: [Some(*span), None],
                ..nowhere(name, "window")
            };
            spans.iter().map(point).collect()
        }
        Layer::Steps { name, at, .. } => {
            let point = |x: &f64| Point {
                x: *x,
                ..nowhere(name, "vertical line")
            };
            at.iter().map(point).collect()
        }
        Layer::Level { name, at, .. } => vec![Point {
            y: *at,
            ..nowhere(name, "horizontal line")
        }],
        Layer::Identity { .. } | Layer::Text { .. } => Vec::new(),
    }
}

fn of_series(series: &Series) -> Vec<Point> {
    let kind = match (&series.line, &series.mark) {
        (Some(_), Some(_)) => "line and marks",
        (Some(_), None) => "line",
        _ => "marks",
    };
    let point = |(k, (x, y)): (usize, &(f64, f64))| Point {
        series: plain(&series.name),
        kind,
        x: *x,
        y: *y,
        ends: [&series.x_errors, &series.y_errors].map(|ends| ends.get(k).copied()),
        ..Point::default()
    };
    series.points.iter().enumerate().map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Dash, Ink, Mark, SINGLE_MM, Shape, Stroke};

    #[test]
    fn every_point_that_is_drawn_is_a_row() {
        let marks = Series::marks(
            "F_{620}",
            vec![(1.0, 2.5), (2.0, f64::NAN)],
            Mark::open(Shape::Circle, Ink::Blue),
        );
        let line = Series::line("", vec![(0.0, 0.125)], Stroke::new(Ink::Black, Dash::Solid));
        let panel = Panel::new(
            Axis::new("\\v{P} (kPa)"),
            Axis::categories("", &["one", "two"]),
        )
        .with(marks.with_y_errors(vec![(2.0, 3.0)]))
        .with(Layer::band("b", vec![(1.0, 0.0, 1.0)], Ink::Sky))
        .with(Layer::zero())
        .with(Layer::identity("y = x"));
        let figure = Figure::new("t", SINGLE_MM, 60.0)
            .with(panel)
            .with(Panel::new(Axis::new("x"), Axis::new("y")).with(line));
        let text = csv(&figure);
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!(
            rows,
            [
                "panel,title,x_axis,y_axis,series,kind,x,y,x_low,x_high,y_low,y_high,category",
                "1,,P (kPa),,F_620,marks,1,2.5,,,2,3,two",
                "1,,P (kPa),,F_620,marks,2,,,,,,",
                "1,,P (kPa),,b,band,1,,,,0,1,",
                "1,,P (kPa),,,horizontal line,,0,,,,,one",
                "2,,x,y,,line,0,0.125,,,,,",
            ]
        );
    }
}
