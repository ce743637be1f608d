//! The languages, one file each: a template of its own and what is filled into it.

pub mod c;
pub mod golden;
pub mod lookup;
pub mod matlab;
pub mod mujoco;
pub mod python;
pub mod readme;

use crate::domain::{EDGE, FADE, SLACK};
use crate::header;
use crate::model::Model;

/// A file: its name and contents.
pub type File = (&'static str, String);

/// A language that models are handed over in.
#[derive(Clone, Copy, Debug)]
pub struct Language {
    /// For people.
    pub name: &'static str,
    /// Its files.
    pub files: fn(&Model) -> Vec<File>,
}

/// Every language.
pub const LANGUAGES: &[Language] = &[
    c::LANGUAGE,
    python::LANGUAGE,
    matlab::LANGUAGE,
    mujoco::LANGUAGE,
    lookup::LANGUAGE,
    golden::LANGUAGE,
    readme::LANGUAGE,
];

/// How a language writes the head of a file.
struct Comment {
    first: &'static str,
    line: &'static str,
    last: &'static str,
}

impl Comment {
    fn of(&self, model: &Model) -> String {
        let lines = header::lines(model);
        let lines = lines.iter().map(|l| format!("{}{l}", self.line));
        let lines: Vec<String> = lines.map(|l| l.trim_end().to_owned()).collect();
        format!("{}{}{}", self.first, lines.join("\n"), self.last)
    }
}

/// The shortest decimal that is read as this number again.
fn number(x: f64) -> String {
    // A number without a point would be an integer in C.
    format!("{:?}", x + 0.0)
}

/// A template with its places `@NAME@` filled in.
fn fill(template: &str, places: &[(&str, String)]) -> String {
    let filled = places
        .iter()
        .fold(template.to_owned(), |text, (name, value)| {
            text.replace(&format!("@{name}@"), value)
        });
    debug_assert!(!filled.contains("@HEADER@"));
    filled
}

/// The numbers that every language has.
fn numbers(model: &Model) -> Vec<(&'static str, String)> {
    let (law, fitted) = (&model.law, model.fitted());
    let [s0, s1, s2, s3, s4, s5, s6] = law.surface;
    let all = [
        ("REST_MIN", fitted.rest_length_m.0),
        ("REST_MAX", fitted.rest_length_m.1),
        ("FREE_MIN", fitted.contraction_620.0),
        ("FREE_MAX", fitted.contraction_620.1),
        ("U_MIN", fitted.contraction_rel.0),
        ("U_MAX", fitted.contraction_rel.1),
        ("P_MIN", fitted.pressure_kpa.0),
        ("P_MAX", fitted.pressure_kpa.1),
        ("F0", law.constant_n),
        ("B1", law.b1_n),
        ("B2", law.b2_per_m),
        ("L_0", law.cap_length_m),
        ("K1", law.length_linear_per_m),
        ("K2", law.length_saturating_per_m),
        ("L_MID", law.middle_length_m),
        ("S0", s0),
        ("S1", s1),
        ("S2", s2),
        ("S3", s3),
        ("S4", s4),
        ("S5", s5),
        ("S6", s6),
        ("EPS_MAX", law.contraction_max),
        ("P_REF", law.reference_kpa),
        ("P1", law.threshold_sharp_kpa),
        ("P2", law.threshold_gradual_kpa),
        ("END", model.domain.end),
        ("FADE", FADE),
        ("EDGE", EDGE),
        ("SLACK", SLACK),
    ];
    let diameter = ("DIAMETER_MM", model.diameter_mm.to_string());
    let filled = all.into_iter().map(|(name, x)| (name, number(x)));
    filled.chain([diameter]).collect()
}

/// A template with the numbers and the head.
fn source(template: &str, comment: &Comment, model: &Model) -> String {
    let head = ("HEADER", comment.of(model));
    let places: Vec<(&str, String)> = numbers(model).into_iter().chain([head]).collect();
    fill(template, &places)
}
