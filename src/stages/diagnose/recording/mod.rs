//! Mistakes of recording: sessions and specimens whose readings are too improbable under the model fitted without them.
//!
//! An effect is a property of a rig or of actuators; a value for one session alone is a mistake or scatter. The sessions that a fit to all
//! puts furthest off, and their specimens, are left out in turn, and their readings are held against the model of the others. How far off a
//! group is, is one number: the root mean square of its misses in units of noise and misfit, at the set lengths that suit it best, of which
//! each counts in units of its usual size. A session that is merely set 1 mm off is then about 1 off, one set 10 mm off about 10, and one with
//! swapped columns more. Rigs scatter more or less than usual, so the yardstick is the standard deviation of
//! the other sessions of the same campaign (by their median), by a model without the group.
//!
//! The worst group goes first, for it spoils the fits that judge the others. What it is, its own readings say: each usual mistake is taken
//! back, and of those that leave no more than is usual the likeliest explains it.
//!
//! What all sessions share is no mistake, but beside a law that lacks it the sessions in which it shows most look mistaken. So the question is
//! asked beside the effects and dependences on columns that a search of all readings found; beside the law alone only where it found none.
//!
//! Lengths are in mm, forces in N, in all of these files.
//!
//! | file | idea |
//! |---|---|
//! | `law` | the law by which sessions are judged |
//! | `left` | sessions and specimens, and what is left when some are gone |
//! | `judged` | who is furthest off, beside what is usual |
//! | `seen` | the readings of a group beside a model fitted without it: how far off it is |
//! | `mistakes` | the usual mistakes, each taken back |
//! | `least` | the least value of a function on an interval |

mod judged;
mod law;
mod least;
mod left;
mod mistakes;
mod seen;
#[cfg(test)]
mod tests;

pub use law::Law;

use super::data::Data;
use judged::{Judged, Ranked, Usual};
use left::{Group, Left};
use pipeline_findings::RecordingError;
use pipeline_inference::decisions::{EXPLAINS, LEVEL, MOST_MISTAKEN, MOST_MISTAKEN_SHARE};
use rayon::prelude::*;
use seen::Seen;

/// Readings of a session that are looked at: a wrong length, zero or unit shows in all of them, and the time goes with their number.
const READINGS: usize = 16;

/// The sessions and specimens of a campaign that look mistaken beside a law, worst first: those with a family-wise probability below [`LEVEL`].
/// They are to be set aside. Only readings of actuators of `group_diameter_mm` are judged.
pub fn recording_errors(group_diameter_mm: u32, law: &Law, data: &Data) -> Vec<RecordingError> {
    let of_group =
        |i: &usize| data.conditions[*i].diameter_mm.round() == f64::from(group_diameter_mm);
    let places: Vec<usize> = (0..data.len()).filter(of_group).collect();
    let data = data.select(&places);
    let data = data.thinned(READINGS * data.sessions.len());
    let mut left = Left::all(&data);
    let mut errors = Vec::new();
    if (left.sessions.len() as f64) * MOST_MISTAKEN_SHARE.0 < 1.0 {
        return errors;
    }
    let mut ranked = Ranked::new(law, &data, &left);
    while errors.len() < MOST_MISTAKEN {
        let judged = Judged::new(law, &data, &left, ranked.shortlist(&left));
        let Some(furthest) = judged.furthest() else {
            break;
        };
        let off = furthest.1.off;
        let specimen = judged.specimen_of(furthest.0, &left);
        // Whose mistake it would be takes much longer to tell than whether it is improbable.
        let [of_furthest, of_specimen] = [Some(furthest), specimen]
            .map(|seen| Improbable::of(law, &data, &left, (seen?.0, off)));
        if of_furthest.is_none() && of_specimen.is_none() {
            break;
        }
        let is_of_specimen = specimen.is_some_and(|(_, seen)| explains(seen, furthest.0));
        let (improbable, seen) = match specimen {
            Some((_, seen)) if is_of_specimen => (of_specimen, seen),
            _ => (of_furthest, furthest.1),
        };
        let Some(Improbable {
            group,
            p,
            rest,
            others,
            usual,
        }) = improbable
        else {
            break;
        };
        match spoiling(law, &data, &left, &others) {
            Some((error, rest, others)) => {
                errors.push(error);
                (left, ranked) = (rest, others);
            }
            None => {
                errors.push(seen.error(group, p, &usual));
                (left, ranked) = (rest, others);
            }
        }
    }
    errors
}

/// A group that is too far off to be one of the others.
struct Improbable {
    group: Group,
    /// Family-wise probability.
    p: f64,
    /// What is left without it.
    rest: Left,
    /// The others without it: with it they would all be off, or the noise so large that nobody is.
    others: Ranked,
    usual: Usual,
}

impl Improbable {
    /// A group that is so far off; none where that is not improbable, or the others are too few to say so.
    fn of(law: &Law, data: &Data, left: &Left, (group, off): (Group, f64)) -> Option<Self> {
        let rest = left.without(group);
        if !rest.is_most_of(data) {
            return None;
        }
        let others = Ranked::new(law, data, &rest);
        let usual = others.usual()?;
        let p = usual.p(off) * left.groups() as f64;
        (p < LEVEL).then_some(Self {
            group,
            p,
            rest,
            others,
            usual,
        })
    }
}

/// Whether a mistake about a specimen explains its sessions better than they agree without the one that is furthest off.
fn explains(specimen: &Seen, furthest: Group) -> bool {
    matches!(furthest, Group::Session(s) if specimen.least_off() < specimen.without(s))
}

/// The specimen without which nobody is half as far off as somebody is without the group that is furthest off, `others` of which are given: where all
/// sessions of a specimen are wrong they carry the fit, and it is the right ones that look mistaken.
fn spoiling(
    law: &Law,
    data: &Data,
    left: &Left,
    others: &Ranked,
) -> Option<(RecordingError, Left, Ranked)> {
    let without = |k: usize| {
        let rest = left.without(Group::Specimen(k));
        let others = rest.is_most_of(data).then(|| Ranked::new(law, data, &rest));
        others.map(|others| (k, rest, others))
    };
    let specimens = left.specimens().into_par_iter();
    let (k, rest, agreeing) = specimens.filter_map(without).min_by(|a, b| {
        let furthest = a.2.furthest().total_cmp(&b.2.furthest());
        furthest.then(a.0.cmp(&b.0))
    })?;
    if agreeing.furthest() * EXPLAINS > others.furthest() {
        return None;
    }
    let group = Group::Specimen(k);
    let judged = Judged::new(law, data, left, vec![group]);
    let seen = judged.of(group).filter(|seen| seen.off.is_finite())?;
    let usual = agreeing.usual()?;
    let p = usual.p(seen.off) * left.groups() as f64;
    (p < LEVEL).then(|| (seen.error(group, p, &usual), rest, agreeing))
}
