//! Models from a fit of an earlier run, and from published coefficients.

use crate::domain::{Domain, Fitted};
use crate::law::Law;
use crate::model::{BoxOf, Model, Named, Spread};
use pipeline_base::error::{Error, Result};
use pipeline_fit::GroupFit;
use pipeline_fit::engine::{CoefficientFit, EquationFit};
use pipeline_fit::equations::JOINT;
use pipeline_mechanics::models::new::NewPublished;
use pipeline_mechanics::models::{Coefficient, ForceModel, P_620_KPA, knee_paper, new, values};

/// Published models by the names of `--published`.
pub const PUBLISHED: [&str; 2] = ["new", "knee_paper"];

/// Eqs. 5, 6, 8 and 9 of the force paper.
const NEW_EQUATIONS: [&str; 3] = [
    "F = F_620 max(0, F*), in N; F_620 = b1 atan(b2 (l_rest - l_0))",
    "F* = c0 (exp(-c1 eps*) - 1) + P* exp(-c2 eps*^2)",
    "eps* = (l_rest - l)/(l_rest - l_620), P* = P/620 kPa",
];
const CONSTANT_EQUATIONS: [&str; 3] = [
    "F = F_620 max(0, F*), in N; F_620 constant (40 mm)",
    NEW_EQUATIONS[1],
    NEW_EQUATIONS[2],
];
/// Eqs. 8, 10 and 11 of the knee paper, corrected.
const KNEE_20: [&str; 3] = [
    "F = F_max max(0, F*), in N",
    "F* = b0 + exp(-b1 eps* + b2) + P* exp(-b3 eps*^2 + b4) + b5 P*",
    "eps* = (l_rest - l)/(l_rest eps_max), P* = P/P_max; l_620 is not used",
];
/// Eq. 12 of the knee paper, corrected.
const KNEE_40: [&str; 3] = [
    KNEE_20[0],
    "F* = b0 + exp(-b1 eps* + b2) + P* exp(-b3 eps* + b4) + b5 P*",
    KNEE_20[2],
];

/// The papers state no range of eps_620.
const ANY: (f64, f64) = (0.0, 1.0);
/// eps_620 in examples: of 10 mm, and of 20 and 40 mm (force paper, Fig. 5).
const USUAL: [f64; 2] = [0.17, 0.25];

/// The law of the new model with the coefficients b1, b2, c0, c1, c2.
pub(crate) fn new_law(c: [f64; 5], cap_length_m: f64) -> Law {
    let [b1, b2, c0, c1, c2] = c;
    Law {
        constant_n: 0.0,
        b1_n: b1,
        b2_per_m: b2,
        cap_length_m,
        length_linear_per_m: 0.0,
        length_saturating_per_m: 0.0,
        middle_length_m: 0.0,
        contraction_max: 0.0,
        reference_kpa: P_620_KPA,
        threshold_sharp_kpa: 0.0,
        threshold_gradual_kpa: 0.0,
        surface: Law::new_surface([c0, c1, c2]),
    }
}

/// The box of a fit.
pub(crate) fn fitted(fit: &GroupFit) -> Fitted {
    Fitted {
        rest_length_m: fit.ranges.rest_length_m,
        contraction_620: fit.ranges.contraction_620,
        contraction_rel: fit.ranges.contraction_rel,
        pressure_kpa: fit.ranges.pressure_kpa,
    }
}

fn middle((low, high): (f64, f64)) -> f64 {
    0.5 * (low + high)
}

/// The joint fit of a group (Eq. 9). `inputs`: digest of the raw files.
///
/// # Errors
/// The group has no joint fit.
pub fn of_fit(fit: &GroupFit, inputs: &str) -> Result<Model> {
    let joint = joint(fit)?;
    let c: Vec<f64> = joint.values();
    let [b1, b2, c0, c1, c2] = c[..] else {
        return Err(Error::internal("a joint fit without its five coefficients"));
    };
    let law = new_law([b1, b2, c0, c1, c2], fit.cap_length_m);
    let fitted = fitted(fit);
    let mut coefficients: Vec<Named> = joint.coefficients.iter().map(of_coefficient).collect();
    coefficients.push(cap_length(fit));
    Ok(Model {
        title: format!("new model, least-squares fit to {}", campaign(fit)),
        diameter_mm: fit.group.diameter_mm,
        domain: Domain::new(&law, fitted),
        box_of: BoxOf::Readings,
        usual_contraction_620: middle(fitted.contraction_620),
        law,
        equations: NEW_EQUATIONS.to_vec(),
        coefficients,
        spread: spread(fit),
        provenance: vec![
            format!(
                "{} readings of {} specimens; intervals: {}, 95%; RMSE {:.2} N on these readings",
                fit.rows,
                fit.specimens.len(),
                joint.ci_method,
                joint.rmse
            ),
            format!("raw files: {inputs}"),
        ],
        effects: vec!["Effects: none, as least squares has none.".to_owned()],
    })
}

/// The joint fit of a group.
///
/// # Errors
/// There is none.
pub(crate) fn joint(fit: &GroupFit) -> Result<&EquationFit> {
    fit.equation(JOINT).ok_or_else(|| {
        Error::Usage(format!(
            "{} ({} mm) has no joint fit of all coefficients: {}",
            fit.group.campaign,
            fit.group.diameter_mm,
            fit.notes.join("; ")
        ))
    })
}

/// The campaign, with what its data are.
pub(crate) fn campaign(fit: &GroupFit) -> String {
    let simulated = if fit.group.simulated {
        " (simulated data)"
    } else {
        ""
    };
    format!("{}{simulated}", fit.group.campaign)
}

pub(crate) fn cap_length(fit: &GroupFit) -> Named {
    Named {
        symbol: "l_0".to_owned(),
        value: fit.cap_length_m,
        unit: "m".to_owned(),
        interval: None,
    }
}

fn of_coefficient(c: &CoefficientFit) -> Named {
    Named {
        symbol: c.symbol.clone(),
        value: c.value,
        unit: c.unit.clone(),
        interval: c.ci_low.zip(c.ci_high),
    }
}

/// The scatter of the specimens about a fit.
pub(crate) fn spread(fit: &GroupFit) -> Option<Spread> {
    let scatter = fit.scatter.as_ref()?;
    Some(Spread::new(
        scatter.between,
        scatter.within_n,
        "readings about one specimen's curve; the error of the fit itself comes on top",
        scatter.freedom as f64,
    ))
}

/// A published model, by its name in [`PUBLISHED`].
///
/// # Errors
/// A diameter that it does not cover.
pub fn of_published(name: &str, diameter_mm: u32) -> Result<Model> {
    let model: &dyn ForceModel = if name == PUBLISHED[0] {
        &NewPublished
    } else {
        &knee_paper::KneePaper
    };
    if !model.diameters().contains(&diameter_mm) {
        return Err(Error::Usage(format!(
            "{} has no coefficients for {diameter_mm} mm, only for {:?} mm",
            model.id(),
            model.diameters()
        )));
    }
    let (law, fitted, equations) = match (name == PUBLISHED[0], diameter_mm) {
        (true, 40) => new_40(),
        (true, _) => new_published(diameter_mm),
        (false, 10) => knee_10(),
        (false, _) => knee_festo(diameter_mm),
    };
    let source = model.source();
    let unused = ["a1", "a2", "l_0 (Eq. 7)"];
    let list = model.coefficients(diameter_mm).iter();
    Ok(Model {
        title: model.title().to_owned(),
        diameter_mm,
        domain: Domain::new(&law, fitted),
        box_of: BoxOf::Source,
        usual_contraction_620: USUAL[usize::from(diameter_mm != 10)],
        law,
        equations: equations.to_vec(),
        coefficients: list
            .filter(|c| !unused.contains(&c.symbol))
            .map(of_published_coefficient)
            .collect(),
        spread: None,
        provenance: vec![
            format!("{}, {}", source.full, source.equations),
            format!("stated domain: {}", model.domain()),
        ],
        effects: Vec::new(),
    })
}

fn of_published_coefficient(c: &Coefficient) -> Named {
    Named {
        symbol: c.symbol.to_owned(),
        value: c.value,
        unit: c.unit.to_owned(),
        interval: c.interval_95,
    }
}

type Parts = (Law, Fitted, [&'static str; 3]);

/// The box of the force paper's rig: up to `rest_length_m`, eps* 0 to 1, up to 620 kPa.
fn paper_box(rest_length_m: (f64, f64)) -> Fitted {
    Fitted {
        rest_length_m,
        contraction_620: ANY,
        contraction_rel: (0.0, 1.0),
        pressure_kpa: (0.0, P_620_KPA),
    }
}

fn new_published(diameter_mm: u32) -> Parts {
    let (list, lengths) = if diameter_mm == 10 {
        (&new::PUBLISHED_10, LENGTHS_10_M)
    } else {
        (&new::PUBLISHED_20, LENGTHS_20_M)
    };
    let [b1, b2, offset, _, _, _, c0, c1, c2] = values(list);
    let law = new_law([b1, b2, c0, c1, c2], offset);
    (law, paper_box(lengths), NEW_EQUATIONS)
}

/// Resting lengths of the force paper's specimens, m.
const LENGTHS_10_M: (f64, f64) = (0.112, 0.518);
const LENGTHS_20_M: (f64, f64) = (0.300, 0.509);
/// A muscle of any length: the force does not depend on it.
const ANY_LENGTH_M: (f64, f64) = (0.01, 10.0);

fn new_40() -> Parts {
    let [f620, c0, c1, c2] = values(&new::PUBLISHED_40);
    let law = Law {
        constant_n: f620,
        ..new_law([0.0, 0.0, c0, c1, c2], 0.0)
    };
    (law, paper_box(ANY_LENGTH_M), CONSTANT_EQUATIONS)
}

fn knee_10() -> Parts {
    let [b1, b2, offset, _, _, c1, c2] = values(&knee_paper::PUBLISHED_10);
    let law = new_law([b1, b2, 1.0, c1, c2], offset);
    (law, paper_box(LENGTHS_10_M), NEW_EQUATIONS)
}

fn knee_festo(diameter_mm: u32) -> Parts {
    let (list, equations) = if diameter_mm == 20 {
        (&knee_paper::PUBLISHED_20, KNEE_20)
    } else {
        (&knee_paper::PUBLISHED_40, KNEE_40)
    };
    let [f_max, eps_max, p_max, b0, b1, b2, b3, b4, b5] = values(list);
    let (linear, square) = if diameter_mm == 20 {
        (0.0, b3)
    } else {
        (b3, 0.0)
    };
    let law = Law {
        constant_n: f_max,
        contraction_max: eps_max,
        reference_kpa: p_max,
        surface: [b0, libm::exp(b2), b1, libm::exp(b4), linear, square, b5],
        ..new_law([0.0; 5], 0.0)
    };
    let fitted = Fitted {
        rest_length_m: ANY_LENGTH_M,
        contraction_620: ANY,
        contraction_rel: (0.0, 1.0),
        pressure_kpa: (0.0, p_max),
    };
    (law, fitted, equations)
}
