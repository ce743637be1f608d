//! What a yielding frame and a dependence on the resting length explain of one another: the law with and without each.

use crate::base::{self, Base};
use crate::problem::ForceProblem;
use crate::{answer, library, unseen};
use pipeline_inference::fit::Setting;
use pipeline_inference::search::Found;

/// The law with and without its dependence on the resting length, and with and without a frame that yields: what a yielding frame and a
/// dependence on the length explain of one another.
pub(crate) fn alternatives(
    problem: &ForceProblem,
    setting: &Setting,
    found: &Found,
    base: &Base,
) -> Vec<pipeline_findings::Alternative> {
    let Some(short) = base.without_length_law() else {
        return Vec::new();
    };
    let other = problem.with_base(&short);
    let mut without = Setting::new(&other);
    without.active.clone_from(&setting.active);
    let frame = problem
        .library
        .iter()
        .position(|t| t.scope == library::Scope::All && t.is_frame());
    let Some(frame) = frame else {
        return Vec::new();
    };
    let mut list = Vec::new();
    for (law, yields) in [(false, false), (true, false), (false, true), (true, true)] {
        let setting = if law { setting } else { &without };
        let mut from = found.model.point.clone();
        from.terms.retain(|(t, _)| !problem.library[*t].is_frame());
        if !law {
            from.coefficients[base::LENGTH_LAW] = short.coefficients[base::LENGTH_LAW].start;
        }
        if yields {
            from.terms.push((frame, problem.library[frame].start(1.0)));
        }
        let fit = setting.fit(&from, std::slice::from_ref(&found.model.variances));
        list.push(answer::alternative(
            &fit,
            law,
            yields.then_some(frame),
            problem,
            unseen::of_model(setting, if law { problem } else { &other }, &fit),
        ));
    }
    let first = list.first().map_or(0.0, |a| a.log_likelihood);
    for a in &mut list {
        a.log_likelihood -= first;
    }
    list
}
