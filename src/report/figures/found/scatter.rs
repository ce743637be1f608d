//! What varies from group to group: the predicted value of every group, one panel a random effect.

use super::{HALF_MM, MOST_GROUPS, Shown, TEXT_MM, axis_label, ending, group_names};
use crate::plot::axis::{Span, Ticks};
use crate::plot::{Axis, Figure, Ink, Layer, Legend, Mark, Panel, Series, Shape};
use crate::wording::name::{self, listed};
use pipeline_findings::Scatter;

/// Panels in a row; more would cut their titles.
const COLUMNS: usize = 3;
/// Letters of a name that a tick of a panel of these has room for, and of one whose beginning is cut, with its dots.
const NAME: [usize; 2] = [13, 12];
/// Height of a group, and of what is around the panels, mm.
const GROUP_MM: f64 = 2.7;
const AROUND_MM: f64 = 15.0;
/// Least and greatest height of a panel, mm.
const HEIGHT_MM: (f64, f64) = (22.0, 105.0);
/// Greatest height of the figure, so that it fits on a page with its caption, mm.
const PAGE_MM: f64 = 222.0;
/// A group that is predicted to differ by less than this share of the standard deviation with which unseen ones are predicted does not differ.
const NOTHING: f64 = 1e-3;

/// The figure; none where nothing has a value of its own.
pub fn figure(shown: &Shown) -> Option<(String, Figure)> {
    let several = shown.found.scatter.iter().filter(|s| s.values.len() > 1);
    let (all, alike): (Vec<&Scatter>, Vec<&Scatter>) = several.partition(|s| differs(s));
    let most = all.iter().map(|s| s.values.len().min(MOST_GROUPS)).max()?;
    let height = (GROUP_MM * most as f64).clamp(HEIGHT_MM.0, HEIGHT_MM.1) + AROUND_MM;
    let columns = all.len().min(COLUMNS);
    let rows = ((PAGE_MM / height) as usize).max(1);
    let drawn: Vec<&Scatter> = all.iter().take(rows * columns).copied().collect();
    let width = if drawn.len() == 1 { HALF_MM } else { TEXT_MM };
    let title = format!("Values of the random effects, {}", shown.found.campaign);
    let rows = drawn.len().div_ceil(columns);
    let mut figure = Figure::new(&title, width, height * rows as f64).grid(columns);
    figure.lettered = false;
    for scatter in &drawn {
        figure = figure.with(panel(scatter, &shown.found.scatter));
    }
    Some((caption(shown, &drawn, &all, &alike), figure))
}

/// Whether any group is predicted to differ from the others.
fn differs(scatter: &Scatter) -> bool {
    let mut values = scatter.values.values();
    values.any(|v| v.abs() > NOTHING * scatter.sd_predictive.max(scatter.sd))
}

fn caption(shown: &Shown, drawn: &[&Scatter], all: &[&Scatter], alike: &[&Scatter]) -> String {
    let many = drawn.iter().any(|s| s.values.len() > MOST_GROUPS);
    let named = if many {
        " Many groups are sorted by size, without names."
    } else {
        ""
    };
    let names = |of: &[&Scatter]| {
        let names: Vec<String> = of
            .iter()
            .map(|s| full_name(s, &shown.found.scatter))
            .collect();
        listed(&names)
    };
    let same = match alike.len() {
        0 => String::new(),
        _ => format!(" Not drawn, since all groups are alike: {}.", names(alike)),
    };
    let left = match &all[drawn.len()..] {
        [] => String::new(),
        others => format!(" Not drawn for lack of space: {}.", names(others)),
    };
    format!(
        "Predicted value of every group of each random effect; shaded: one standard deviation on either side.{named}{same}{left}"
    )
}

/// A random effect, with its level where another has the same name.
fn full_name(scatter: &Scatter, all: &[Scatter]) -> String {
    let name = name::scatter(&scatter.id, scatter.level);
    let same = |s: &&Scatter| name::scatter(&s.id, s.level) == name;
    if all.iter().filter(same).count() > 1 {
        format!("{name}, {}", name::level(scatter.level))
    } else {
        name
    }
}

fn short(name: &str) -> String {
    let [whole, cut] = NAME;
    if name.chars().count() > whole {
        ending(name, cut)
    } else {
        name.to_owned()
    }
}

/// Gains are shown as percentages.
fn factor(scatter: &Scatter) -> (f64, &str) {
    if scatter.unit == "1" {
        (100.0, "%")
    } else {
        (1.0, &scatter.unit)
    }
}

fn panel(scatter: &Scatter, all: &[Scatter]) -> Panel {
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
    let names: Vec<String> = names.iter().map(|n| short(n)).collect();
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
    let title = full_name(scatter, all);
    let mut x = Axis::new(&axis_label("Predicted value", unit));
    x.span = Span::Around(vec![-sd, sd]);
    let mark = Mark::filled(Shape::Circle, Ink::Blue).wide(if many { 0.9 } else { 1.4 });
    Panel::new(x, y)
        .title(&name::capitalised(&title))
        .legend(Legend::None)
        .with(Layer::windows("", vec![(-sd, sd)]))
        .with(Series::marks("", points, mark))
}
