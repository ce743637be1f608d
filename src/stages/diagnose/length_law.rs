//! Whether an effect takes the place of the law's dependence on the resting length.
//!
//! A frame that yields costs a short actuator more of its strain than a long one, and so does the dependence of the law: what a rig's own actuators show of the
//! one may be the other, and what was published of the dependence may come from such a rig. The search is therefore made again beside the law without it.
//! Where that ends with as good a model, by the readings alone and with every effect at its price, the dependence is one parameter that the readings do not
//! need, and what was found has taken its place. Beside the law without any effect they have to need it: what no reading shows is as published.

use crate::base::Base;
use crate::problem::ForceProblem;
use crate::suited::{part_of, start};
use pipeline_inference::fit::{Fitted, Setting};
use pipeline_inference::screen::Normal;
use pipeline_inference::search::{Decision, Found, Search};
use std::collections::BTreeSet;

/// What a search ends with.
pub struct Outcome<'p> {
    /// The problem of its law.
    pub problem: ForceProblem<'p>,
    /// What was found beside that.
    pub found: Found,
    /// The law with its dependence on the resting length, where what was found took the place of that.
    pub replaced: Option<Replaced<'p>>,
}

impl Outcome<'_> {
    /// The law as it is known, without any effect.
    pub fn null(&self) -> &Fitted {
        let with = self.replaced.as_ref();
        with.map_or(&self.found.null, |with| &with.found.null)
    }
}

/// The law with its dependence on the resting length, beside another without it.
pub struct Replaced<'p> {
    /// Its problem.
    pub problem: ForceProblem<'p>,
    /// What was found beside it.
    pub found: Found,
    /// The same problem by the readings alone: nothing is known beforehand of the dependence.
    freed: ForceProblem<'p>,
}

impl Replaced<'_> {
    /// Whether what was found beside the law without the dependence takes its place, in the part of the campaign that `setting` marks.
    pub(crate) fn gives_way(
        &self,
        found: &Found,
        instead: &Found,
        setting: &Setting,
        decision: Decision,
    ) -> bool {
        let freed = of_active(&self.freed, setting);
        is_shown(
            refitted(&freed, &found.null),
            instead.null.log_likelihood,
            decision,
        ) && is_replaced(priced(&freed, found, instead), decision)
    }
}

/// The readings of one problem that are active in another.
pub(crate) fn of_active<'a>(problem: &'a ForceProblem, setting: &Setting) -> Setting<'a> {
    Setting {
        active: setting.active.clone(),
        ..Setting::new(problem)
    }
}

/// The log-likelihood of a model by the readings alone.
fn refitted(freed: &Setting, model: &Fitted) -> f64 {
    let again = freed.fit(&model.point, std::slice::from_ref(&model.variances));
    again.log_likelihood
}

/// Whether readings show a dependence on the resting length beside the law without any effect, by the log-likelihoods with it and without.
fn is_shown(with: f64, without: f64, decision: Decision) -> bool {
    with > without + decision.alike
}

/// The log-likelihoods of what was found with the dependence and without, less what each effect has to gain to come in: at one critical value, since each search has
/// its own draws, and many effects would add up what these differ by.
fn priced(freed: &Setting, found: &Found, instead: &Found) -> [f64; 2] {
    let price = |f: &Found| f.price(freed.problem.terms(), |_| found.critical);
    [
        refitted(freed, &found.model) - price(found),
        instead.model.log_likelihood - price(instead),
    ]
}

/// Whether a model without the dependence is no worse than one with it.
fn is_replaced([with, without]: [f64; 2], decision: Decision) -> bool {
    without > with - decision.alike
}

/// The search beside the law, and beside the law without its dependence on the resting length where `laws` are both by the readings alone; without the sessions
/// that are kept out.
pub fn searched<'p>(
    problem: ForceProblem<'p>,
    null: Fitted,
    laws: Option<&'p [Base; 2]>,
    kept_out: &BTreeSet<&str>,
    decision: Decision,
    normal: &Normal,
) -> Outcome<'p> {
    let found = search(&part_of(&problem, kept_out), decision).run(null, normal, None);
    let mut outcome = Outcome {
        problem,
        found,
        replaced: None,
    };
    let Some([with, without]) = laws else {
        return outcome;
    };
    let freed = outcome.problem.with_base(with);
    let bare = outcome.problem.with_base(without);
    let parts = [&freed, &bare].map(|p| part_of(p, kept_out));
    if let Some(instead) = in_its_place(&parts, &outcome.found, decision, normal) {
        let with = std::mem::replace(&mut outcome.problem, bare);
        outcome.replaced = Some(Replaced {
            problem: with,
            found: std::mem::replace(&mut outcome.found, instead),
            freed,
        });
    }
    outcome
}

/// What is found beside the law without the dependence, where that takes its place; of the law with it, by the readings alone, and without it.
fn in_its_place(
    [freed, bare]: &[Setting; 2],
    found: &Found,
    decision: Decision,
    normal: &Normal,
) -> Option<Found> {
    let null = start(bare);
    if !is_shown(refitted(freed, &found.null), null.log_likelihood, decision) {
        return None;
    }
    // The same design: its draws stand for draws from this null.
    let instead = search(bare, decision).run(null, normal, Some(&found.draws));
    is_replaced(priced(freed, found, &instead), decision).then_some(instead)
}

/// A search that nothing is known for.
fn search<'a>(setting: &'a Setting<'a>, decision: Decision) -> Search<'a> {
    Search {
        setting,
        decision,
        tried: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decision;
    use pipeline_config::DiagnoseOptions;

    #[test]
    fn a_dependence_gives_way_where_it_shows_by_itself_and_not_beside_what_was_found() {
        let decision = decision(&DiagnoseOptions::default());
        assert_eq!(decision.alike, 2.0);
        assert!(is_shown(-97.9, -100.0, decision) && !is_shown(-98.1, -100.0, decision));
        assert!(is_replaced([-50.0, -51.9], decision) && !is_replaced([-50.0, -52.1], decision));
    }
}
