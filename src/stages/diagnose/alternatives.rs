//! What a yielding frame, the shape of the ends and a dependence on the resting length explain of one another: the law with and without each. All
//! three cost a short actuator more of its strain than a long one.

use crate::base::{self, Base};
use crate::library::{Scope, Term};
use crate::problem::ForceProblem;
use crate::{answer, unseen};
use pipeline_inference::fit::{Fitted, Free, Setting};
use pipeline_inference::problem::Point;
use pipeline_inference::search::{Found, WORTH_A_SWAP};
use pipeline_inference::system::Variances;

/// What a row of the table has.
#[derive(Clone, Copy, PartialEq)]
struct Parts {
    /// Whether the law depends on the resting length.
    law: bool,
    /// The term beside it, if there is one.
    other: Option<usize>,
}

impl Parts {
    fn contain(self, simpler: Self) -> bool {
        simpler.law <= self.law && (simpler.other.is_none() || simpler.other == self.other)
    }

    /// `point` with the term, of this size where it lacks it.
    fn added_to(self, mut point: Point, size: f64, problem: &ForceProblem) -> Point {
        let of_point: Vec<usize> = point.terms.iter().map(|(t, _)| *t).collect();
        let missing = self.other.filter(|t| !of_point.contains(t));
        let term = missing.map(|t| (t, problem.library[t].start(size)));
        point.terms.extend(term);
        point
    }
}

/// A row that is fitted.
struct Row {
    parts: Parts,
    fit: Fitted,
}

impl Row {
    /// The same as a fit of a larger model, in which what this one lacks is nothing.
    fn within(&self, parts: Parts, setting: &Setting, problem: &ForceProblem) -> Fitted {
        let point = parts.added_to(self.fit.point.clone(), 0.0, problem);
        let mut nothing = setting.clone();
        if self.parts.law != parts.law {
            let coefficient = Free::Coefficient(base::LENGTH_LAW);
            nothing.pinned.push(coefficient);
        }
        if self.parts.other != parts.other {
            let value = Free::Value(point.terms.len() - 1, 0);
            nothing.pinned.push(value);
        }
        nothing.fit(&point, std::slice::from_ref(&self.fit.variances))
    }
}

/// The fit of a row from what was found and from the rows that it contains: parts that act alike have optima of their own.
fn fit(
    parts: Parts,
    (setting, problem): (&Setting, &ForceProblem),
    (from, known): (Point, &Variances),
    rows: &[Row],
) -> Option<Fitted> {
    let simpler = rows.iter().filter(|r| parts.contain(r.parts));
    let of_rows = simpler.clone().map(|r| r.fit.point.clone());
    let starts = std::iter::once(from).chain(of_rows);
    let starts: Vec<Point> = starts.map(|s| parts.added_to(s, 1.0, problem)).collect();
    let fit = setting.best(&starts, &[known.clone(), setting.widened(known)])?;
    // A model is no worse than one that it contains: where no start led that far, what that lacks is nothing here either.
    let likeliest = simpler.max_by(|a, b| {
        let [a, b] = [a, b].map(|r| r.fit.log_likelihood);
        a.total_cmp(&b)
    });
    let least = fit.log_likelihood + WORTH_A_SWAP;
    let better = likeliest.filter(|r| r.fit.log_likelihood > least);
    Some(better.map_or(fit, |r| r.within(parts, setting, problem)))
}

/// The law with and without its dependence on the resting length, each alone and with a frame that yields, or with a constant length that its ends take
/// (`length_offset`). Effects that were found are in all of them but for these two. What is published of the dependence counts for nothing here.
pub(crate) fn alternatives(
    problem: &ForceProblem,
    setting: &Setting,
    found: &Found,
    base: &Base,
) -> Vec<pipeline_findings::Alternative> {
    let Some(bases) = base.with_and_without_length_law() else {
        return Vec::new();
    };
    let [with, without] = &bases;
    let found_beside_law = problem.base.fits_length_law();
    let problems = [problem.with_base(without), problem.with_base(with)];
    let settings = [0, 1].map(|k| Setting {
        active: setting.active.clone(),
        ..Setting::new(&problems[k])
    });
    let of_all = |is: &dyn Fn(&Term) -> bool| {
        let all = problem.library.iter();
        all.clone().position(|t| t.scope == Scope::All && is(t))
    };
    let is_of_ends = |t: &Term| problem.is_length_offset(t);
    let Some(frame) = of_all(&Term::is_frame) else {
        return Vec::new();
    };
    let ends = of_all(&is_of_ends);
    let others = [None, Some(frame)].into_iter().chain(ends.map(Some));
    let mut list = Vec::new();
    let mut rows: Vec<Row> = Vec::new();
    for parts in others.flat_map(|other| [false, true].map(|law| Parts { law, other })) {
        let of_law = usize::from(parts.law);
        let (problem, setting) = (&problems[of_law], &settings[of_law]);
        let mut from = found.model.point.clone();
        from.terms.retain(|(t, _)| {
            let term = &problem.library[*t];
            let stands_for_ends = is_of_ends(term) && term.scope == Scope::All;
            !term.is_frame() && !stands_for_ends
        });
        let of_base = if parts.law { with } else { without };
        if !(parts.law && found_beside_law) {
            from.coefficients[base::LENGTH_LAW] = of_base.coefficients[base::LENGTH_LAW].start;
        }
        let model = (setting, problem);
        let Some(fit) = fit(parts, model, (from, &found.model.variances), &rows) else {
            continue;
        };
        let held = unseen::of_model(setting, problem, &fit);
        list.push(answer::alternative(
            &fit,
            parts.law,
            parts.other,
            model,
            held,
        ));
        rows.push(Row { parts, fit });
    }
    let first = list.first().map_or(0.0, |a| a.log_likelihood);
    for a in &mut list {
        a.log_likelihood -= first;
    }
    list
}
