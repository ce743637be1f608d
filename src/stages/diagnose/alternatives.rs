//! What a yielding frame, the shape of the ends and a dependence on the resting length explain of one another: the law with and without each. All
//! three cost a short actuator more of its strain than a long one.

use crate::base::{self, Base};
use crate::library::{Scope, Term};
use crate::problem::ForceProblem;
use crate::{answer, unseen};
use pipeline_inference::fit::{Fitted, Free, Setting};
use pipeline_inference::problem::Point;
use pipeline_inference::search::Found;

/// Fits end within this of the largest log-likelihood.
const UNSETTLED: f64 = 0.1;

/// A row that is fitted: whether the law depends on the resting length, the other part, if there is one.
struct Row {
    law: bool,
    part: Option<usize>,
    fit: Fitted,
}

impl Row {
    /// The same with what a larger model has beside it, which is nothing: `point` is this row's with the part of the larger model at its end, if it
    /// lacks that.
    fn within(
        &self,
        (law, part): (bool, Option<usize>),
        point: &Point,
        setting: &Setting,
    ) -> Fitted {
        let mut nothing = setting.clone();
        if self.law != law {
            let coefficient = Free::Coefficient(base::LENGTH_LAW);
            nothing.pinned.push(coefficient);
        }
        if self.part != part {
            let value = Free::Value(point.terms.len() - 1, 0);
            nothing.pinned.push(value);
        }
        nothing.fit(point, std::slice::from_ref(&self.fit.variances))
    }
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
    let parts = [None, Some(frame)].into_iter().chain(ends.map(Some));
    let mut list = Vec::new();
    let mut rows: Vec<Row> = Vec::new();
    for part in parts {
        for law in [false, true] {
            let (problem, setting) = (&problems[usize::from(law)], &settings[usize::from(law)]);
            let mut from = found.model.point.clone();
            from.terms.retain(|(t, _)| {
                let term = &problem.library[*t];
                let stands_for_ends = is_of_ends(term) && term.scope == Scope::All;
                !term.is_frame() && !stands_for_ends
            });
            if !law {
                from.coefficients[base::LENGTH_LAW] = without.coefficients[base::LENGTH_LAW].start;
            }
            // What a model with fewer parts came to is a start of one with more: parts that act alike have optima of their own.
            let is_simpler = |r: &&Row| r.law <= law && (r.part.is_none() || r.part == part);
            let simpler = rows.iter().filter(is_simpler);
            let mut starts = vec![(None, from)];
            starts.extend(simpler.clone().map(|r| (r.part, r.fit.point.clone())));
            let with_part = |(p, mut point): (Option<usize>, Point), size: f64| {
                let missing = part.filter(|_| p.is_none());
                let term = missing.map(|t| (t, problem.library[t].start(size)));
                point.terms.extend(term);
                point
            };
            let starts: Vec<Point> = starts.into_iter().map(|s| with_part(s, 1.0)).collect();
            let known = &found.model.variances;
            let variances = [known.clone(), setting.widened(known)];
            let Some(mut fit) = setting.best(&starts, &variances) else {
                continue;
            };
            // A model is no worse than one that it contains: where no start led that far, what that lacks is nothing here either.
            let likeliest = simpler.max_by(|a, b| {
                let [a, b] = [a, b].map(|r| r.fit.log_likelihood);
                a.total_cmp(&b)
            });
            let least = fit.log_likelihood + UNSETTLED;
            if let Some(row) = likeliest.filter(|r| r.fit.log_likelihood > least) {
                let point = with_part((row.part, row.fit.point.clone()), 0.0);
                fit = row.within((law, part), &point, setting);
            }
            list.push(answer::alternative(
                &fit,
                law,
                part,
                (setting, problem),
                unseen::of_model(setting, problem, &fit),
            ));
            rows.push(Row { law, part, fit });
        }
    }
    let first = list.first().map_or(0.0, |a| a.log_likelihood);
    for a in &mut list {
        a.log_likelihood -= first;
    }
    list
}
