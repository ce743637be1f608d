//! The functions that a recomputation can use: equations of the models, whole models, and a few statistics.
//!
//! A new function is one line in the list below; equations as the papers print them, mistakes included, stand in
//! [`super::printed_forms`].

use super::printed_forms;
use pipeline_mechanics::models::{
    Direction, ForceModel, State, hunt2017, knee_paper, new, published,
};

/// A function of some words, then some numbers.
#[derive(Debug)]
pub struct Function {
    /// Its name.
    pub name: &'static str,
    /// How many words it takes first.
    pub words: usize,
    /// How many numbers it takes then.
    pub numbers: usize,
    /// Its arguments in words.
    pub arguments: &'static str,
    /// Its value.
    pub evaluate: fn(&[String], &[f64]) -> f64,
}

impl PartialEq for Function {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Function {
    /// Its name and arguments, for messages.
    pub fn signature(&self) -> String {
        format!("{}({})", self.name, self.arguments)
    }
}

/// A function by its name.
pub fn find(name: &str) -> Option<&'static Function> {
    ALL.iter().find(|f| f.name == name)
}

const fn numeric(
    name: &'static str,
    numbers: usize,
    arguments: &'static str,
    evaluate: fn(&[String], &[f64]) -> f64,
) -> Function {
    Function {
        name,
        words: 0,
        numbers,
        arguments,
        evaluate,
    }
}

static ALL: &[Function] = &[
    numeric("sqrt", 1, "x", |_, x| x[0].sqrt()),
    numeric("abs", 1, "x", |_, x| x[0].abs()),
    numeric("percent_error", 2, "of, against", |_, x| {
        100.0 * (x[0] - x[1]).abs() / x[1].abs()
    }),
    numeric("f620", 4, "b1, b2, l_0, l_rest", |_, x| {
        new::f620(x[0], x[1], x[2], x[3])
    }),
    numeric("fmax", 5, "a1, a2, l_0, l_rest, P", |_, x| {
        new::fmax(x[0], x[1], x[2], x[3], x[4])
    }),
    numeric("surface", 5, "c0, c1, c2, eps*, P*", |_, x| {
        new::surface([x[0], x[1], x[2]], x[3], x[4])
    }),
    numeric(
        "hunt_pressure",
        9,
        "p0, A, w, q, k, g, F, eps, eps_620",
        |_, x| {
            let c = [x[0], x[1], x[2], x[3], x[4], x[5], 0.0];
            hunt2017::pressure(c, x[6], x[7], x[8], 0.0)
        },
    ),
    numeric("knee_surface_20", 8, "b0, ..., b5, eps*, P*", |_, x| {
        knee_paper::surface_20(printed_forms::six(x), x[6], x[7])
    }),
    numeric("knee_surface_40", 8, "b0, ..., b5, eps*, P*", |_, x| {
        knee_paper::surface_40(printed_forms::six(x), x[6], x[7])
    }),
    numeric(
        "force_paper_eq1_as_printed",
        9,
        "p0, A, w, q, k, g, F, eps, eps_620",
        |_, x| printed_forms::force_paper_eq1(x),
    ),
    numeric(
        "knee_paper_eq8_as_printed",
        8,
        "b0, ..., b5, eps*, P*",
        |_, x| printed_forms::knee_paper_eq8(x),
    ),
    numeric(
        "knee_paper_eq11_as_printed",
        8,
        "b0, ..., b5, eps*, P*",
        |_, x| printed_forms::knee_paper_eq11(x),
    ),
    numeric(
        "knee_paper_eq12_as_printed",
        8,
        "b0, ..., b5, eps*, P*",
        |_, x| printed_forms::knee_paper_eq12(x),
    ),
    Function {
        name: "force",
        words: 1,
        numbers: 5,
        arguments: "model, diameter in mm, l_rest in m, eps_620, eps*, P in kPa",
        evaluate: force,
    },
    Function {
        name: "coefficient",
        words: 2,
        numbers: 1,
        arguments: "model, symbol, diameter in mm",
        evaluate: coefficient,
    },
    Function {
        name: "coefficients",
        words: 1,
        numbers: 1,
        arguments: "model, diameter in mm",
        evaluate: |words, x| {
            model(&words[0]).map_or(f64::NAN, |m| m.coefficients(x[0] as u32).len() as f64)
        },
    },
];

fn model(id: &str) -> Option<&'static dyn ForceModel> {
    published().into_iter().find(|m| m.id() == id)
}

/// A model's isometric force, N; NaN where it has no answer.
fn force(words: &[String], x: &[f64]) -> f64 {
    let [
        diameter_mm,
        rest_length_m,
        contraction_620,
        contraction_rel,
        pressure_kpa,
    ] = *x
    else {
        return f64::NAN;
    };
    let state = State {
        diameter_mm,
        rest_length_m,
        contracted_length_m: rest_length_m * (1.0 - contraction_620),
        length_m: rest_length_m * (1.0 - contraction_620 * contraction_rel),
        pressure_kpa,
        direction: Direction::Isometric,
    };
    let force = model(&words[0]).and_then(|m| m.predict(&state).force_n());
    force.unwrap_or(f64::NAN)
}

/// A coefficient as the program has it; NaN where there is none.
fn coefficient(words: &[String], x: &[f64]) -> f64 {
    let list = model(&words[0]).map_or(&[][..], |m| m.coefficients(x[0] as u32));
    let found = list.iter().find(|c| c.symbol == words[1]);
    found.map_or(f64::NAN, |c| c.value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn call(name: &str, words: &[&str], numbers: &[f64]) -> f64 {
        let words: Vec<String> = words.iter().map(ToString::to_string).collect();
        (find(name).unwrap().evaluate)(&words, numbers)
    }

    #[test]
    fn models_answer_at_a_state() {
        // Values of the specification, section 2.
        let new = call(
            "force",
            &["new_published"],
            &[10.0, 0.182, 0.17, 0.5, 620.0],
        );
        assert!((new - 143.139).abs() < 1e-3);
        let hunt = call("force", &["hunt2017"], &[10.0, 0.25, 0.168, 0.5, 620.0]);
        assert!((hunt - 181.016).abs() < 1e-3);
        assert!(call("force", &["nobody"], &[10.0, 0.2, 0.17, 0.5, 620.0]).is_nan());
        assert!(call("coefficient", &["hunt2017", "zz"], &[10.0]).is_nan());
        assert_eq!(call("coefficients", &["sarosi2012"], &[10.0]), 6.0);
    }

    #[test]
    fn an_error_in_percent_is_of_the_second() {
        assert!((call("percent_error", &[], &[270.0, 103.0]) - 162.1359).abs() < 1e-4);
    }

    #[test]
    fn names_are_unique() {
        let names: std::collections::BTreeSet<&str> = ALL.iter().map(|f| f.name).collect();
        assert_eq!(names.len(), ALL.len());
    }
}
