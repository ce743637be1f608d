//! MuJoCo: a callback in Python, and a load that the muscle lifts.

use super::{Comment, File, Language, fill, number, python, source};
use crate::domain::State;
use crate::model::Model;

/// MuJoCo.
pub const LANGUAGE: Language = Language {
    name: "MuJoCo",
    files,
};

/// A comment inside of another one's marks, in which two hyphens may not stand together.
const XML: Comment = Comment {
    first: "",
    line: "  ",
    last: "",
};
/// Standard gravity, m/s2.
const GRAVITY: f64 = 9.81;

fn files(model: &Model) -> Vec<File> {
    let callback = include_str!("../templates/bpa_mujoco.py");
    vec![
        ("bpa_mujoco.py", source(callback, &python::COMMENT, model)),
        ("bpa_example.xml", example(model)),
    ]
}

/// A muscle of a middle length whose load balances it halfway through the box at the highest pressure, a little less damped than critically.
fn example(model: &Model) -> String {
    let fitted = model.fitted();
    let middle = |(low, high): (f64, f64)| 0.5 * (low + high);
    let rest_length_m = millimetres(middle(fitted.rest_length_m).min(0.5));
    let contracted_length_m = millimetres(rest_length_m * (1.0 - model.usual_contraction_620));
    let stroke = model.law.stroke_m(rest_length_m, contracted_length_m);
    let at = model.force(&State {
        rest_length_m,
        contracted_length_m,
        length_m: rest_length_m - middle(fitted.contraction_rel) * stroke,
        pressure_kpa: fitted.pressure_kpa.1,
    });
    let mass = at.force_n / GRAVITY;
    let stiffness = at.by_length;
    let damping = 1.4 * (mass * stiffness).sqrt();
    let places = [
        ("HEADER", XML.of(model).replace("--", "- -")),
        ("REST", number(rest_length_m)),
        ("CONTRACTED", number(contracted_length_m)),
        ("MASS", format!("{mass:.3}")),
        ("DAMPING", format!("{damping:.1}")),
        ("LIFT", format!("{:.3}", 1.5 * stroke)),
        (
            "WIDTH",
            format!("{:.3}", 0.5e-3 * f64::from(model.diameter_mm)),
        ),
        ("P_MAX", number(fitted.pressure_kpa.1)),
    ];
    fill(include_str!("../templates/bpa_example.xml"), &places)
}

fn millimetres(length_m: f64) -> f64 {
    (1e3 * length_m).round() / 1e3
}
