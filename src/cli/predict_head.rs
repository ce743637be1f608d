//! What stands above every answer of `predict`: the muscle, the law, and how both were chosen.

use crate::predict_calibrate;
use crate::predict_print::warnings;
use crate::print::{counted, line};
use pipeline_diagnose::mixed_law::Whose;
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
    } else if let Some(expected) = expected_contraction(predictor) {
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

/// What the law has for the contraction that is given, where that is another.
fn expected_contraction(predictor: &Predictor) -> Option<String> {
    let Law::Fitted(Fitted { mixed, .. }) = predictor.choice.law else {
        return None;
    };
    let given = predictor.muscle.contraction_620?;
    let law = mixed.as_ref()?;
    let expected = law.expected_contraction(given);
    let differs = (expected - given).abs() >= LEAST_DIFFERENCE;
    differs.then(|| {
        format!(
            "taken as {:.1}%: of the differences between noted contractions {:.0}% is error",
            100.0 * expected,
            100.0 * law.noting_error().min(1.0)
        )
    })
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
