//! The law with or without its dependence on the resting length, and with or without a frame that yields or ends that take a length.

use crate::base::LENGTH_LAW;
use crate::problem::ForceProblem;
use pipeline_findings::{Alternative, Parameter};
use pipeline_inference::decisions;
use pipeline_inference::fit::{Fitted, Free, Setting};

/// The law with or without its dependence on the resting length, and with or without another part, a term. Intervals are 1.96 standard errors to
/// either side, within the bounds.
pub fn alternative(
    fit: &Fitted,
    length_law: bool,
    part: Option<usize>,
    (setting, problem): (&Setting, &ForceProblem),
    held_out: Option<(f64, f64)>,
) -> Alternative {
    let covariance = fit.covariance(&fit.predictive(setting));
    let number = |name: &str, unit: &str, value: f64, place: Option<usize>, (low, high)| {
        let error = place.map(|p| covariance.at(p, p).max(0.0).sqrt());
        let end = |sign: f64| {
            let end = |e: f64| value + sign * decisions::NORMAL_95 * e;
            error.map(|e| end(e).clamp(low, high))
        };
        Parameter {
            name: name.to_owned(),
            value,
            ci_low: end(-1.0),
            ci_high: end(1.0),
            unit: unit.to_owned(),
            of_level: None,
        }
    };
    let mut parts = Vec::new();
    let mut numbers = Vec::new();
    if length_law {
        parts.push(pipeline_findings::LENGTH_LAW.to_owned());
        let c = &problem.base.coefficients[LENGTH_LAW];
        let place = fit
            .free
            .iter()
            .position(|f| *f == Free::Coefficient(LENGTH_LAW));
        numbers.push(number(
            &c.name,
            &c.unit,
            fit.point.coefficients[LENGTH_LAW],
            place,
            c.bounds,
        ));
    }
    if let Some(term) = part {
        parts.extend(problem.library[term].id().map(str::to_owned));
        if let (Some(form), Some(values)) = (problem.library[term].form(), fit.values(term)) {
            let a = form.amplitude;
            let place = fit.place(term, 0);
            numbers.push(number(a.name, a.unit, values[0], place, a.bounds));
        }
    }
    // Those that ended at a bound as well.
    let of_law = problem.base.coefficients.iter().filter(|c| c.free);
    let of_terms = fit.point.terms.iter().map(|(_, values)| values.len());
    Alternative {
        parts,
        parameters: of_law.count() + of_terms.sum::<usize>(),
        log_likelihood: fit.log_likelihood,
        rmse_heldout: held_out.map(|h| h.0),
        log_density_heldout: held_out.map(|h| h.1),
        numbers,
    }
}
