//! What stands above every answer of `predict`: the muscle, the law, and how both were chosen.

use crate::predict_calibrate;
use crate::predict_print::warnings;
use crate::print::{counted, line};
use pipeline_diagnose::mixed_law::{MixedLaw, Whose};
use pipeline_predict::answer::FreeContraction;
use pipeline_predict::muscle::mm;
use pipeline_predict::{Fitted, Law, Predictor};
use pipeline_report::wording::sentence::in_doubt;

/// A contraction that differs by less is printed alike.
const LEAST_DIFFERENCE: f64 = 0.0005;

/// The muscle and the law, and how both were chosen.
pub fn head(predictor: &Predictor) {
    line(format!("muscle   {}", muscle(predictor)));
    if let Some(muscle) = predictor.calibrated() {
        predict_calibrate::head(muscle);
        warnings(&predictor.doubts);
    } else if let Some(expected) = taken(predictor) {
        line(format!("         {expected}"));
    }
    line(format!("model    {}", model(&predictor.choice.law)));
    if !predictor.choice.why.is_empty() {
        line(format!("         {}", predictor.choice.why));
    }
    if predictor.whose == Whose::Rig {
        line("         as the rig reads it: with its effects, its zeros and its noise");
    }
    if let Law::Fitted(fitted) = predictor.choice.law {
        let doubt = in_doubt(fitted.fit.doubtful.iter());
        warnings(&doubt.into_iter().collect::<Vec<String>>());
    }
}

fn muscle(predictor: &Predictor) -> String {
    let muscle = &predictor.muscle;
    let free = match (muscle.contraction_620, predictor.free) {
        (Some(e), FreeContraction::MeanOfSpecimens { specimens, .. }) => format!(
            ", contraction at 620 kPa not given: {:.1}%, the mean of {}",
            100.0 * e,
            counted(specimens, "specimen", "specimens")
        ),
        (Some(e), _) => format!(
            ", contraction at 620 kPa {:.1}% (to {})",
            100.0 * e,
            mm(muscle.rest_length_m * (1.0 - e))
        ),
        (None, _) => ", contraction at 620 kPa unknown".to_owned(),
    };
    format!(
        "{} mm, resting length {}{free}",
        muscle.diameter_mm,
        mm(muscle.rest_length_m)
    )
}

/// The contraction at 620 kPa that the law has for the one that is given of a muscle without readings, and the law.
pub fn expected_contraction<'a>(predictor: &Predictor<'a>) -> Option<(f64, &'a MixedLaw)> {
    let Law::Fitted(Fitted { mixed, .. }) = predictor.choice.law else {
        return None;
    };
    let law = mixed.filter(|_| predictor.calibrated().is_none())?;
    let given = predictor.muscle.contraction_620?;
    Some((law.expected_contraction(given), law))
}

/// The contraction at 620 kPa that a muscle is taken to have, where that is another than the one given.
pub fn taken_contraction(predictor: &Predictor) -> Option<f64> {
    let (expected, _) = expected_contraction(predictor)?;
    let given = predictor.muscle.contraction_620?;
    ((expected - given).abs() >= LEAST_DIFFERENCE).then_some(expected)
}

/// `taken as 16.9%: of the differences between noted contractions 89 ± 29% is error`, where that is another.
fn taken(predictor: &Predictor) -> Option<String> {
    let taken = taken_contraction(predictor)?;
    let (_, law) = expected_contraction(predictor)?;
    // A normal number about a share may be outside of what shares are.
    let percentage = |x: f64| 100.0 * x.clamp(0.0, 1.0);
    Some(format!(
        "taken as {:.1}%: of the differences between noted contractions {:.0} ± {:.0}% is error",
        100.0 * taken,
        percentage(law.noting_error()),
        percentage(law.noting_error_sd())
    ))
}

fn model(law: &Law) -> String {
    match law {
        Law::Fitted(Fitted { fit, joint, mixed }) => {
            let of_fit = (fit.specimens.len(), joint.n);
            let (specimens, readings) = mixed.map_or(of_fit, |m| (m.specimens.len(), m.readings));
            let unseen = mixed.and_then(|law| law.unseen_n);
            let unseen = unseen.map_or_else(String::new, |rmse| {
                format!(", RMSE {rmse:.1} N on unseen specimens")
            });
            format!(
                "{}: {}, {readings} readings{unseen}",
                law.title(),
                counted(specimens, "specimen", "specimens")
            )
        }
        Law::Published(model) => {
            format!("{} ({}): {}", law.title(), model.id(), model.domain())
        }
    }
}
