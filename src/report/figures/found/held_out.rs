//! The error on every unit that was held out: without effects, with them, and with its own gain and lengths.

use super::super::formatting::largest;
use super::{HALF_MM, Shown, group_names};
use crate::plot::{Axis, Dash, Figure, Ink, Layer, Legend, Mark, Panel, Series, Shape, Stroke};
use crate::wording::name::nouns;
use crate::wording::sentence::has_terms;
use pipeline_findings::{Errors, UnitErrors};

/// Units beyond these are left out, so that the figure fits on a page with its caption.
const MOST_UNITS: usize = 26;
/// Distance between the marks of one unit, in bands.
const SHIFT: f64 = 0.16;
/// Height of a unit's band, and of what is around the panel, mm.
const BAND_MM: f64 = 4.6;
const AROUND_MM: f64 = 22.0;

/// The figure; none of fewer than two units.
pub fn figure(shown: &Shown) -> Option<(String, Figure)> {
    let found = shown.found;
    let units = &found.by_unit;
    if units.len() < 2 {
        return None;
    }
    let larger = |u: &UnitErrors| {
        let both = [u.before.rmse_heldout, u.after.rmse_heldout];
        both.into_iter().flatten().fold(0.0, f64::max)
    };
    let errors: Vec<f64> = units.iter().map(larger).collect();
    let shown_units = largest(&errors, MOST_UNITS);
    let others = if shown_units.len() < units.len() {
        format!(
            " Shown are the {} of {} units with the largest error; `findings.json` has all.",
            shown_units.len(),
            units.len()
        )
    } else {
        String::new()
    };
    // The axis counts from below; the first unit stands above, as in a table.
    let units: Vec<&UnitErrors> = shown_units.into_iter().rev().map(|k| &units[k]).collect();
    let names = group_names(units.iter().map(|u| &u.unit));
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let label = format!("Held-out error ({})", shown.unit());
    let mut panel = Panel::new(
        Axis::new(&label).including(0.0),
        Axis::categories("", &names),
    )
    .legend(Legend::Above);
    for k in 1..units.len() {
        panel = panel.with(border(k));
    }
    for one in series(&units, has_terms(found)) {
        panel = panel.with(one);
    }
    let title = format!("Held-out error, {}", found.campaign);
    let height = AROUND_MM + BAND_MM * units.len() as f64;
    let caption = format!(
        "Root-mean-square error on each {} by models that have not seen it: the whole search was repeated without it.{others}",
        nouns(found).unit
    );
    Some((caption, Figure::new(&title, HALF_MM, height).with(panel)))
}

fn series(units: &[&UnitErrors], with_effects: bool) -> Vec<Series> {
    let marks = |of: &dyn Fn(&UnitErrors) -> Option<f64>, shift: f64| -> Vec<(f64, f64)> {
        let point = |(k, u): (usize, &&UnitErrors)| Some((of(u)?, k as f64 + shift));
        units.iter().enumerate().filter_map(point).collect()
    };
    let unseen = |e: &Errors| e.rmse_heldout;
    let before = Series::marks(
        "without effects",
        marks(&|u| unseen(&u.before), SHIFT),
        Mark::open(Shape::Circle, Ink::Black).wide(1.6),
    );
    let after = Series::marks(
        "with the effects",
        marks(&|u| unseen(&u.after), 0.0),
        Mark::filled(Shape::Square, Ink::Blue).wide(1.6),
    );
    let calibrated = Series::marks(
        "own gain and lengths known",
        marks(&|u| u.after.rmse_heldout_calibrated, -SHIFT),
        Mark::open(Shape::Diamond, Ink::Vermilion).wide(1.8),
    );
    let mut series = vec![before];
    series.extend(with_effects.then_some(after));
    let has_calibrated = |u: &&UnitErrors| u.after.rmse_heldout_calibrated.is_some();
    series.extend(units.iter().any(has_calibrated).then_some(calibrated));
    series
}

/// A thin line below a unit's band.
fn border(place: usize) -> Layer {
    Layer::Level {
        name: String::new(),
        at: place as f64 - 0.5,
        stroke: Stroke::hair(Ink::Grey, Dash::Dotted),
    }
}
