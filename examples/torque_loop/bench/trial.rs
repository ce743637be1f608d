//! One joint of the benchmark: nothing in it, or one effect at four times the limit that the loop itself states for the joint without it.

use super::joint::{KINDS, Kind, joint};
use pipeline::config::DiagnoseOptions;
use pipeline::findings::{CampaignFindings, EffectFinding};
use pipeline::stages::torque::diagnose::diagnose;
use pipeline::stages::torque::diagnose::terms::{ALL, SIZES, Term};
use rayon::prelude::*;

/// Multiple of the limit at which effects are put in.
const MULTIPLE: f64 = 4.0;

/// Seeds of joints with an effect are others than those of the joints without one.
const BESIDE: u64 = 1000;

/// What a search found.
pub struct Outcome {
    /// Route, and whether lengths and arms were taken by hand.
    pub kind: Kind,
    /// Form that was put in; none where nothing was.
    pub put: Option<&'static Term>,
    /// Its size; of a shift, along x.
    pub size: f64,
    /// Whether four times the limit is more than parts of its kind were ever measured to have, so that it has this size instead.
    pub capped: bool,
    /// Effects and columns, as text.
    pub found: Vec<String>,
    /// Recording errors that were pointed at.
    pub mistakes: usize,
    /// Whether what was put in was found, by its id or as a member of an alias set.
    pub detected: bool,
    /// Whether that is all that was found.
    pub exact: bool,
    /// Whether the interval covers the size; none where it was not found in this form.
    pub covered: Option<bool>,
}

/// The findings of a joint with effects of these sizes.
pub fn search(kind: Kind, sizes: &[f64; SIZES], seed: u64) -> CampaignFindings {
    let found = joint(kind, sizes, seed);
    let mut joints = diagnose("simulated", true, &found, &DiagnoseOptions::default());
    joints.remove(0).findings
}

/// All outcomes of some seeds: joints of every kind with nothing in them, and with every form that `wanted` wants and whose limit they state.
pub fn outcomes(seeds: &[u64], wanted: &(dyn Fn(&Term) -> bool + Sync)) -> Vec<Outcome> {
    let all: Vec<(Kind, u64)> = KINDS
        .iter()
        .flat_map(|kind| seeds.iter().map(|seed| (*kind, *seed)))
        .collect();
    let of = |(kind, seed): &(Kind, u64)| {
        let nothing = search(*kind, &[0.0; SIZES], *seed);
        let forms = ALL.iter().filter(|form| wanted(form));
        let with = forms.filter_map(|form| with(form, *kind, &nothing, BESIDE + seed));
        let mut outcomes: Vec<Outcome> = with.collect();
        outcomes.push(judged(&nothing, *kind, None, (0.0, false)));
        outcomes
    };
    all.par_iter().flat_map(of).collect()
}

/// A joint with one effect; none where the joint without it states no limit.
fn with(form: &'static Term, kind: Kind, nothing: &CampaignFindings, seed: u64) -> Option<Outcome> {
    let mut limits = nothing.detection_limits.iter();
    let limit = limits.find(|l| (l.id.as_str(), l.form.as_str()) == (form.id, form.form))?;
    let asked = MULTIPLE * limit.smallest;
    let most = form.usual.min(form.bounds.1);
    let size = asked.min(most);
    let mut sizes = [0.0; SIZES];
    sizes[form.first] = size;
    let found = search(kind, &sizes, seed);
    Some(judged(&found, kind, Some(form), (size, asked > most)))
}

fn judged(
    found: &CampaignFindings,
    kind: Kind,
    put: Option<&'static Term>,
    (size, capped): (f64, bool),
) -> Outcome {
    let is_it = |e: &&EffectFinding| put.is_some_and(|form| e.class.iter().any(|c| c == form.id));
    let it = found.effects.iter().find(is_it);
    let count = found.effects.len() + found.unexplained.len();
    let same_form = it.filter(|e| put.is_some_and(|p| (p.id, p.form) == (&e.id, &e.form)));
    let covered = same_form.and_then(|e| {
        let parameter = e.parameters.first()?;
        Some(parameter.ci_low? <= size && size <= parameter.ci_high?)
    });
    Outcome {
        kind,
        put,
        size,
        capped,
        found: said(found),
        mistakes: found.recording_errors.len(),
        detected: it.is_some(),
        exact: it.is_some() && count == 1,
        covered,
    }
}

/// What was found that has one value, as text.
fn said(found: &CampaignFindings) -> Vec<String> {
    let effects = found.effects.iter().map(|e| {
        let sizes = e.parameters.iter();
        let sizes: Vec<String> = sizes
            .map(|p| format!("{:.3} {}", p.value, p.unit))
            .collect();
        let sizes = sizes.join(", ");
        format!("{}/{} {sizes} p {:.3}", e.id, e.form, e.p_familywise)
    });
    let columns = found.unexplained.iter();
    effects
        .chain(columns.map(|u| format!("column {}", u.column)))
        .collect()
}
