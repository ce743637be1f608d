//! Everything that may be added to a model of a campaign.

use super::data::Data;
use super::term::{Empirical, Scope, Term, What};
use crate::effects::{self, Grouping, Need};

/// Fewest sessions for which a part of the campaign is looked at by itself.
const FEWEST_SESSIONS: usize = 6;
/// Fewest specimens for which one of them is.
const FEWEST_SPECIMENS: usize = 4;
/// Fewest sessions on either side of a change.
const FEWEST_ON_A_SIDE: usize = 3;

/// The terms that the search tries. Their number follows from the design of the campaign alone.
pub fn candidates(data: &Data) -> Vec<Term> {
    let mut terms = Vec::new();
    for (effect, e) in effects::all().iter().enumerate() {
        for (form, f) in e.forms().iter().enumerate() {
            let known = f.needs.iter().all(|n| !data.missing.contains_key(n));
            if !known || e.id() == STRENGTHS {
                continue;
            }
            let shapes = f.shape.map_or(&[f64::NAN][..], |(_, grid)| grid);
            for shape in shapes {
                let what = What::Effect {
                    effect,
                    form,
                    shape: *shape,
                };
                terms.push(Term::new(what, Scope::Whole, data));
                // What has one value for a session anyway is no other thing in a single session.
                let within = !f.needs.contains(&Need::Zeros);
                if e.grouping() == Grouping::Parts && within {
                    terms.extend(
                        parts(what, data)
                            .into_iter()
                            .map(|scope| Term::new(what, scope, data)),
                    );
                }
            }
        }
    }
    let columns = data
        .extras
        .iter()
        .enumerate()
        .filter(|(_, e)| !e.names_groups);
    let extras = columns.flat_map(|(k, _)| [Empirical::Gain(k), Empirical::Offset(k)]);
    let empirical = extras.chain([Empirical::Force, Empirical::Pressure]);
    terms.extend(empirical.map(|e| Term::new(What::Empirical(e), Scope::Whole, data)));
    terms
}

/// Id of the effect that every model has anyway: see [`super::model`].
pub const STRENGTHS: &str = "specimen_variation";

/// The parts of a campaign on which something of the set-up may act by itself.
fn parts(what: What, data: &Data) -> Vec<Scope> {
    let sessions = data.sessions.len();
    let specimens = data.specimens.len();
    let mut parts = Vec::new();
    let gain = matches!(what, What::Effect { effect, .. } if ["force_gain", "misalignment"].contains(&effects::all()[effect].id()));
    if sessions >= FEWEST_SESSIONS {
        parts.extend((0..sessions).map(Scope::Session));
        if !data.missing.contains_key(&Need::CampaignTime) {
            parts.extend((FEWEST_ON_A_SIDE..=sessions - FEWEST_ON_A_SIDE).map(Scope::From));
        }
        parts.push(Scope::EachSession);
        let groups = data
            .extras
            .iter()
            .enumerate()
            .filter(|(_, e)| e.names_groups);
        parts.extend(groups.map(|(k, _)| Scope::Levels(k)));
    }
    // The gain of one specimen is its strength.
    if specimens >= FEWEST_SPECIMENS && !gain {
        parts.extend((0..specimens).map(Scope::Specimen));
    }
    parts
}

/// How many places a scope was chosen from: what a finding at one of them must pay for.
pub fn choices(scope: &Scope, data: &Data) -> f64 {
    match scope {
        Scope::Session(_) | Scope::From(_) => data.sessions.len() as f64,
        Scope::Specimen(_) => data.specimens.len() as f64,
        _ => 1.0,
    }
}
