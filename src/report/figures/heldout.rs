//! The error on what was held out: base model, with effects, black box.

use crate::config::Config;
use crate::report::figures::words::{largest, plain};
use crate::report::input::GroupInput;
use crate::report::plot::{
    Axis, Dash, Figure, Ink, Layer, Legend, Mark, Panel, SINGLE_MM, Series, Shape, Stroke,
};
use crate::stages::diagnose::findings::FoldErrors;

/// Units beyond these are left out, so that the figure fits on a page with its caption.
const MOST_UNITS: usize = 26;
/// Distance between the marks of one unit, in bands.
const SHIFT: f64 = 0.16;

/// The figure; none of fewer than two units.
pub fn figure(group: &GroupInput, _config: &Config) -> Option<(String, Figure)> {
    let found = &group.diagnosis.as_ref()?.findings;
    let units = &found.by_specimen;
    if units.len() < 2 {
        return None;
    }
    let errors: Vec<f64> = units.iter().map(|u| u.after.max(u.before)).collect();
    let shown = largest(&errors, MOST_UNITS);
    let others = if shown.len() < units.len() {
        format!(
            " Shown are the {} of {} units with the largest error; `findings.json` has all.",
            shown.len(),
            units.len()
        )
    } else {
        String::new()
    };
    // The axis counts from below; the first unit stands above, as in a table.
    let units: Vec<&FoldErrors> = shown.into_iter().rev().map(|k| &units[k]).collect();
    let names: Vec<String> = units.iter().map(|u| plain(&u.unit)).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut panel = Panel::new(
        Axis::new("Held-out RMSE (N)").including(0.0),
        Axis::categories("", &names),
    )
    .legend(Legend::Above);
    for k in 1..units.len() {
        panel = panel.with(border(k));
    }
    let marks = |of: &dyn Fn(&FoldErrors) -> Option<f64>, shift: f64| -> Vec<(f64, f64)> {
        let point = |(k, u): (usize, &&FoldErrors)| Some((of(u)?, k as f64 + shift));
        units.iter().enumerate().filter_map(point).collect()
    };
    let arrows = units.iter().enumerate().flat_map(|(k, u)| {
        let place = k as f64;
        [
            (u.before, place + SHIFT),
            (u.after, place),
            (f64::NAN, f64::NAN),
        ]
    });
    let hair = Stroke::hair(Ink::Black, Dash::Solid);
    let series = [
        Series::line("", arrows.collect(), hair),
        Series::marks(
            "base model",
            marks(&|u| Some(u.before), SHIFT),
            Mark::open(Shape::Circle, Ink::Black).wide(1.8),
        ),
        Series::marks(
            "with the effects",
            marks(&|u| Some(u.after), 0.0),
            Mark::filled(Shape::Square, Ink::Blue).wide(1.8),
        ),
        Series::marks(
            "black box",
            marks(&|u| u.black_box, -SHIFT),
            Mark::open(Shape::Cross, Ink::Vermilion).wide(1.8),
        ),
    ];
    for one in series {
        panel = panel.with(one);
    }
    let title = format!("Error on what was held out, {}", group.fit.group.campaign);
    let height = 22.0 + 6.0 * units.len() as f64;
    let figure = Figure::new(&title, 1.5 * SINGLE_MM, height).with(panel);
    let caption = format!(
        "Root-mean-square error on each unit by models that have not seen it: the whole search was made without it, so that what \
                   was chosen may differ from unit to unit.{others}"
    );
    Some((caption, figure))
}

/// A thin line below a unit's band.
fn border(place: usize) -> Layer {
    Layer::Level {
        name: String::new(),
        at: place as f64 - 0.5,
        stroke: Stroke::hair(Ink::Grey, Dash::Dotted),
    }
}
