//! Who is furthest off, beside what is usual: all sessions by a fit to all, the worst of them and their specimens by fits without each.

use super::law::Law;
use super::left::{Group, Left, readings_of};
use super::seen::Seen;
use crate::data::Data;
use crate::problem::ForceProblem;
use pipeline_inference::fit::Setting;
use pipeline_numerics::distributions::{NORMAL_50, student_t_two_sided};
use pipeline_numerics::statistics::median;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Sessions that a fit to all puts furthest off, and that are then judged without themselves: the one that spoils that fit is among them.
const SHORTLIST: usize = 4;

/// Least standard deviation, in usual ones: where the others happen to agree better, a specimen that is a few percent stronger than they is no mistake.
const LEAST_SCALE: f64 = 0.5;

/// How far off the other sessions are.
pub(super) struct Usual {
    /// Their standard deviation, by their median: where one set length makes nearly all of it, the number is the size of a normal one. Of a root mean
    /// square of several it is an upper bound.
    pub(super) scale: f64,
    /// Number of sessions.
    sessions: f64,
}

impl Usual {
    /// Probability that a group is so far off.
    pub(super) fn p(&self, off: f64) -> f64 {
        student_t_two_sided(off / self.scale, self.sessions)
    }
}

/// The sessions that are left and for which the law has a force, each as far off as the fit to all of them says, furthest first.
pub(super) struct Ranked {
    sessions: Vec<(usize, f64)>,
}

impl Ranked {
    pub(super) fn new(law: &Law, data: &Data, left: &Left) -> Self {
        let rest = readings_of(data, left);
        let terms = law.terms(&rest);
        let problem = ForceProblem::new(law.base, &rest, &terms).with_reference();
        let setting = Setting::new(&problem).usual();
        let fit = law.fit(&problem, &setting);
        let off = |s: &usize| {
            let group = Group::Session(*s);
            (
                *s,
                Seen::new(law, data, (&problem, &setting, &fit), vec![*s], group).off,
            )
        };
        let all: Vec<(usize, f64)> = left.sessions.par_iter().map(off).collect();
        // Where the law has no force nothing is known of who is wrong.
        let mut sessions: Vec<(usize, f64)> =
            all.into_iter().filter(|(_, off)| off.is_finite()).collect();
        sessions.sort_by(|a, b| b.1.total_cmp(&a.1));
        Self { sessions }
    }

    /// How far off the furthest is.
    pub(super) fn furthest(&self) -> f64 {
        self.sessions.first().map_or(0.0, |(_, off)| *off)
    }

    /// How far off sessions are; none with fewer than two.
    pub(super) fn usual(&self) -> Option<Usual> {
        let off: Vec<f64> = self.sessions.iter().map(|(_, off)| *off).collect();
        (off.len() > 1).then(|| Usual {
            scale: (median(&off) / NORMAL_50).max(LEAST_SCALE),
            sessions: off.len() as f64,
        })
    }

    /// The sessions that are judged by a fit without them, and their specimens.
    pub(super) fn shortlist(&self, left: &Left) -> Vec<Group> {
        let first = self.sessions.iter().take(SHORTLIST).map(|(s, _)| *s);
        let sessions: Vec<usize> = first.collect();
        let specimens: BTreeSet<usize> = sessions.iter().map(|s| left.specimen_of[*s]).collect();
        let several = left.specimens().len() > 1;
        let specimens = specimens
            .into_iter()
            .filter(|_| several)
            .map(Group::Specimen);
        sessions
            .into_iter()
            .map(Group::Session)
            .chain(specimens)
            .collect()
    }
}

/// Groups, each judged by a model fitted without it.
pub(super) struct Judged<'a> {
    seen: Vec<(Group, Seen<'a>)>,
}

impl<'a> Judged<'a> {
    pub(super) fn new(law: &Law<'a>, data: &'a Data, left: &Left, groups: Vec<Group>) -> Self {
        let rest = readings_of(data, left);
        let terms = law.terms(&rest);
        let problem = ForceProblem::new(law.base, &rest, &terms).with_reference();
        let judge = |group: Group| {
            let node = match group {
                Group::Session(s) => problem.sessions[s],
                Group::Specimen(k) => problem.specimens[k],
            };
            let setting = Setting::new(&problem).usual().without(node);
            let fit = law.fit(&problem, &setting);
            let by = (&problem, &setting, &fit);
            (group, Seen::new(law, data, by, left.of(group), group))
        };
        Self {
            seen: groups.into_par_iter().map(judge).collect(),
        }
    }

    /// What is seen of a group that was judged.
    pub(super) fn of(&self, group: Group) -> Option<&Seen<'a>> {
        self.seen.iter().find(|(g, _)| *g == group).map(|(_, s)| s)
    }

    /// The group that is furthest off, of those for which the law has a force.
    pub(super) fn furthest(&self) -> Option<(Group, &Seen<'a>)> {
        let judged = self.seen.iter().filter(|(_, seen)| seen.off.is_finite());
        let furthest = judged.max_by(|a, b| a.1.off.total_cmp(&b.1.off));
        furthest.map(|(group, seen)| (*group, seen))
    }

    /// The specimen of a group that is a session, if it has others that were judged with it.
    pub(super) fn specimen_of(&self, group: Group, left: &Left) -> Option<(Group, &Seen<'a>)> {
        let Group::Session(s) = group else {
            return None;
        };
        let whole = Group::Specimen(left.specimen_of[s]);
        let seen = self.of(whole)?;
        (seen.sessions.len() > 1).then_some((whole, seen))
    }
}
