//! Remarks on the data and the search, and what is still suspected beside the effects.

use super::super::Work;
use super::super::data::PLACEBO;
use super::super::findings::Suspect;
use super::super::term::{Scope, Term};
use super::Fits;
use crate::numerics::statistics::mean;
use std::collections::BTreeSet;

/// Fewer specimens than these cannot agree on an effect.
const FEW: usize = 3;

/// What is still suspected beside the effects: an effect of all readings explains what one session or specimen seemed to have alone.
pub(super) fn suspects(work: &Work, fits: &Fits) -> Vec<Suspect> {
    let chosen = &fits.full.terms;
    let of_all = |t: &Term| t.scope == Scope::Whole && t.id().is_some();
    if chosen.is_empty() || !chosen.iter().all(of_all) {
        return work.suspects.clone();
    }
    let data = work.train;
    let error = |s: &Suspect| {
        let belongs = |i: &usize| {
            s.what == format!("session {}", data.sessions[data.session[*i]])
                || s.what == format!("specimen {}", data.specimens[data.specimen[*i]])
        };
        let own = (0..data.len()).filter(belongs);
        let squares: Vec<f64> = own
            .map(|i| fits.fitted.residuals[i] * fits.fitted.residuals[i])
            .collect();
        (!squares.is_empty()).then(|| mean(&squares).sqrt())
    };
    let still = |s: &&Suspect| s.set_aside || error(s).is_none_or(|e| e > s.usual_n);
    work.suspects.iter().filter(still).cloned().collect()
}

/// Sessions without a zero log, where others have one: their zero is that of the slack actuator, or none.
fn without_zero_log(work: &Work) -> Option<String> {
    let data = work.train;
    let known = |s: &usize| data.zero_pressure_kpa[*s].is_finite();
    let present: BTreeSet<usize> = data.session.iter().copied().collect();
    let names: Vec<&str> = present
        .iter()
        .filter(|s| !known(s))
        .map(|s| data.sessions[*s].as_str())
        .collect();
    (!names.is_empty() && names.len() < present.len()).then(|| {
        format!(
            "No zero log in {}, where other sessions have one: the zero there is that of the slack actuator, or none (table `zeros`)",
            names.join(", ")
        )
    })
}

/// Remarks on the data and the search.
pub(super) fn notes(work: &Work) -> Vec<String> {
    let mut notes = Vec::new();
    notes.extend(without_zero_log(work));
    let of_another_shape = !["new", "new_published"].contains(&work.base.id.as_str());
    if of_another_shape && !work.judgements.is_empty() {
        notes.push(
            "The base model has a shape of its own: an effect beside it may stand where that shape does not fit, and its size is no \
             calibration of a sensor."
                .to_owned(),
        );
    }
    let specimens: BTreeSet<usize> = work.train.specimen.iter().copied().collect();
    if specimens.len() < FEW {
        let s = if specimens.len() == 1 { "" } else { "s" };
        notes.push(format!(
            "{} specimen{s} only: the smallest sizes that would be found are those at which an effect stands out of the noise, and may not be \
             enough for every guard.",
            specimens.len()
        ));
    }
    if work.passed_over > 0 {
        notes.push(format!(
            "{} readings for which the base model has no force took no part",
            work.passed_over
        ));
    }
    let chance = work.rejected.iter().any(|r| r.id == PLACEBO);
    notes.push(
        if !work.searched {
            "No question was significant, so that nothing was searched."
        } else if chance {
            "A shuffled copy of a column was offered to the search, which chose it at first and rejected it: some of what is said here may be \
             chance."
        } else {
            "A shuffled copy of a column (placebo) was offered to the search and not chosen."
        }
        .to_owned(),
    );
    if work.train.len() > work.options.most_readings {
        notes.push(format!(
            "The search saw {} of {} readings, an equal share of each session; errors and intervals are those of all.",
            work.train.thinned(work.options.most_readings).len(),
            work.train.len()
        ));
    }
    notes
}
