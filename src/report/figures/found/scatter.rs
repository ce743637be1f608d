//! What varies from group to group: the predicted value of every group, one panel a random effect.

use super::{HALF_MM, MOST_GROUPS, Shown, TEXT_MM, axis_label, group_names};
use crate::findings::Scatter;
use crate::report::plot::axis::{Span, Ticks};
use crate::report::plot::{Axis, Figure, Ink, Layer, Legend, Mark, Panel, Series, Shape};
use crate::report::wording::name;

/// Most panels.
const MOST_PANELS: usize = 4;
/// Height of a group, and of what is around the panels, mm.
const GROUP_MM: f64 = 2.7;
const AROUND_MM: f64 = 15.0;
/// Least and greatest height of a panel, mm.
const HEIGHT_MM: (f64, f64) = (22.0, 105.0);

/// The figure; none where nothing has a value of its own.
pub fn figure(shown: &Shown) -> Option<(String, Figure)> {
    let estimated =
        |s: &&Scatter| s.values.len() > 1 && (s.declared.is_none() || s.declared_contradicted);
    let drawn: Vec<&Scatter> = shown
        .found
        .scatter
        .iter()
        .filter(estimated)
        .take(MOST_PANELS)
        .collect();
    if drawn.is_empty() {
        return None;
    }
    let most = drawn
        .iter()
        .map(|s| s.values.len().min(MOST_GROUPS))
        .max()?;
    let height = (GROUP_MM * most as f64).clamp(HEIGHT_MM.0, HEIGHT_MM.1) + AROUND_MM;
    let width = if drawn.len() == 1 { HALF_MM } else { TEXT_MM };
    let title = format!("Values of the random effects, {}", shown.found.campaign);
    let mut figure = Figure::new(&title, width, height).grid(drawn.len());
    figure.lettered = false;
    for scatter in &drawn {
        figure = figure.with(panel(scatter));
    }
    let many = drawn.iter().any(|s| s.values.len() > MOST_GROUPS);
    let named = if many {
        " Where there are many groups they stand by size and without names."
    } else {
        ""
    };
    let caption = format!(
        "Predicted value of every group of each random effect; shaded: one standard deviation to both sides.{named}"
    );
    Some((caption, figure))
}

/// Gains are shown as percentages.
fn factor(scatter: &Scatter) -> (f64, &str) {
    if scatter.unit == "1" {
        (100.0, "%")
    } else {
        (1.0, &scatter.unit)
    }
}

fn panel(scatter: &Scatter) -> Panel {
    let (factor, unit) = factor(scatter);
    let mut groups: Vec<(&String, f64)> = scatter
        .values
        .iter()
        .map(|(id, v)| (id, factor * v))
        .collect();
    let many = groups.len() > MOST_GROUPS;
    if many {
        groups.sort_by(|a, b| b.1.total_cmp(&a.1));
    }
    groups.reverse();
    let names = group_names(groups.iter().map(|(id, _)| *id));
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut y = Axis::categories("", &names);
    if many {
        y.ticks = Ticks::Named(Vec::new());
        y.label = format!("{} groups", groups.len());
    }
    let sd = factor * scatter.sd;
    let points = groups
        .iter()
        .enumerate()
        .map(|(k, (_, v))| (*v, k as f64))
        .collect();
    let title = name::scatter(&scatter.id, scatter.level);
    let mut x = Axis::new(&axis_label("Predicted value", unit));
    x.span = Span::Around(vec![-sd, sd]);
    let mark = Mark::filled(Shape::Circle, Ink::Blue).wide(if many { 0.9 } else { 1.4 });
    Panel::new(x, y)
        .title(&name::capitalised(&title))
        .legend(Legend::None)
        .with(Layer::windows("", vec![(-sd, sd)]))
        .with(Series::marks("", points, mark))
}
