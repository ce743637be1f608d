//! A grid of forces, for machines that interpolate.

use super::{File, Language};
use crate::domain::{Range, State};
use crate::model::Model;

/// The table.
pub const LANGUAGE: Language = Language {
    name: "lookup table",
    files,
};

/// Points along the resting length, the relative contraction and the pressure.
const POINTS: [u32; 3] = [9, 33, 26];

fn files(model: &Model) -> Vec<File> {
    vec![("bpa_lookup.csv", table(model))]
}

/// The force depends on the lengths through l_rest and eps* = (l_rest - l)/(l_rest - l_620) alone, so that three columns are enough. From the lower
/// edge of the box to where the muscle is slack, and from no pressure on.
fn table(model: &Model) -> String {
    let fitted = model.fitted();
    let (shortest, longest) = fitted.rest_length_m;
    let lengths = if longest > shortest { POINTS[0] } else { 1 };
    let contractions = (fitted.contraction_rel.0, model.domain.end);
    let mut text = String::from("rest_length_m,contraction_rel,pressure_kpa,force_n\n");
    for rest_length_m in grid((shortest, longest), lengths) {
        for u in grid(contractions, POINTS[1]) {
            for pressure_kpa in grid((0.0, fitted.pressure_kpa.1), POINTS[2]) {
                let force_n = force_n(model, rest_length_m, u, pressure_kpa);
                text.push_str(&format!("{rest_length_m},{u},{pressure_kpa},{force_n}\n"));
            }
        }
    }
    text
}

/// The force at a relative contraction.
fn force_n(model: &Model, rest_length_m: f64, u: f64, pressure_kpa: f64) -> f64 {
    let contracted_length_m = rest_length_m * (1.0 - model.usual_contraction_620);
    let stroke = model.law.stroke_m(rest_length_m, contracted_length_m);
    let state = State {
        rest_length_m,
        contracted_length_m,
        length_m: rest_length_m - u * stroke,
        pressure_kpa,
    };
    model.force(&state).force_n
}

fn grid((low, high): Range, points: u32) -> impl Iterator<Item = f64> {
    let steps = f64::from(points.max(2) - 1);
    (0..points).map(move |k| low + (high - low) * f64::from(k) / steps)
}
