//! How strong the evidence for an effect is, and whether the units agree on its size: in words that follow from its values.

use super::form::{undetermined, varying};
use super::found::opposed;
use crate::number::Rounding;
use crate::wording::name::{nouns, without_one};
use crate::wording::number::{equals_probability, percent, rounded, with_unit};
use crate::wording::{COMES_IN, SIGNIFICANT};
use pipeline_findings::{BesideNoise, CampaignFindings, EffectFinding, HeldOutBy, Tested};
use pipeline_numerics::statistics::homogeneity;

/// Largest family-wise p of strong evidence.
const CLEAR: f64 = 0.25 * COMES_IN;
/// Evidence with a larger family-wise p is weak.
const NEAR: f64 = 0.5 * COMES_IN;
/// Evidence for an effect that a smaller share of the searches without one unit finds again is weak.
const SELDOM: f64 = 0.5;
/// The column whose values were shuffled.
pub const PLACEBO: &str = "placebo";

/// How strong the evidence for an effect is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Evidence {
    /// A p near the level, found again in few of the searches without one unit, no stronger than a shuffled column, too little to come in beside noise
    /// that is correlated in time, or from tests that their owner doubts.
    Weak,
    /// Neither.
    Moderate,
    /// A small p, found again in every search without one unit, and of a size with the sign that its source expects, which neither differs between
    /// units nor varies by more than itself.
    Strong,
}

/// The grade, and why it is not strong.
fn graded(found: &CampaignFindings, e: &EffectFinding) -> (Evidence, Vec<Reason>) {
    let by_p = if e.p_familywise > NEAR {
        Evidence::Weak
    } else if e.p_familywise > CLEAR {
        Evidence::Moderate
    } else {
        Evidence::Strong
    };
    let by_folds = match again(found, e) {
        Some(share) if share < SELDOM => Evidence::Weak,
        Some(share) if share >= 1.0 => Evidence::Strong,
        Some(_) | None => Evidence::Moderate,
    };
    let placebo = placebo(found, e);
    let by_placebo = placebo.map_or(Evidence::Strong, |_| Evidence::Weak);
    let fold = match again(found, e) {
        Some(share) => Reason::Again(share),
        None => Reason::NotRepeated,
    };
    let by_owner = if found.design.doubtful_only {
        Evidence::Weak
    } else {
        Evidence::Strong
    };
    // One size with the expected sign does not describe what is there: the effect may be another.
    let doubts = [differ(found, e), opposed(e), varying(e), undetermined(e)];
    let is_one_size = doubts.iter().all(Option::is_none);
    let by_size = if is_one_size {
        Evidence::Strong
    } else {
        Evidence::Moderate
    };
    let by_noise = match beside_noise(found, e) {
        Some(beside) if !beside.stands => Evidence::Weak,
        _ => Evidence::Strong,
    };
    let reasons = [
        (by_owner, Reason::Doubtful),
        (by_p, Reason::Probability(e.p_familywise)),
        (by_placebo, Reason::Shuffled(placebo.unwrap_or_default())),
        (by_folds, fold),
        (by_noise, Reason::InTime),
    ];
    let by_others = by_folds.min(by_placebo).min(by_noise);
    let grade = by_owner.min(by_p).min(by_others).min(by_size);
    let lacking = reasons.into_iter().filter(|r| r.0 < Evidence::Strong);
    (grade, lacking.map(|r| r.1).collect())
}

/// Why evidence is not strong.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Reason {
    /// There are no readings but those that their owner doubts.
    Doubtful,
    /// The family-wise p.
    Probability(f64),
    /// That of a shuffled column, which is as strong.
    Shuffled(f64),
    /// Share of the searches without one unit that find the effect again.
    Again(f64),
    /// No search was made without one unit.
    NotRepeated,
    /// It would not have come in where noise is correlated in time, and the readings show that it is.
    InTime,
}

/// An effect beside noise that is correlated in time, where the readings show such noise.
pub fn beside_noise<'f>(found: &'f CampaignFindings, e: &EffectFinding) -> Option<&'f BesideNoise> {
    let all = found.noise_in_time.iter().flat_map(|n| &n.beside);
    let mut own = all.filter(|b| b.id == e.id);
    own.next()
}

/// Share of the searches without one unit that find an effect again; none where no search was made on less than everything.
fn again(found: &CampaignFindings, e: &EffectFinding) -> Option<f64> {
    match found.design.held_out_by {
        HeldOutBy::Holdout | HeldOutBy::None => None,
        HeldOutBy::Specimen | HeldOutBy::SpecimenGroups | HeldOutBy::Actuator => e.found_in_folds,
    }
}

/// The family-wise p of the shuffled column, where that is no weaker a candidate than the effect.
fn placebo(found: &CampaignFindings, e: &EffectFinding) -> Option<f64> {
    let shuffled: &Tested = found.tested.iter().find(|t| t.id == PLACEBO)?;
    // The p of a bootstrap has a floor, at which the gains decide.
    let gain = e.log_likelihood_gain.unwrap_or(f64::NEG_INFINITY);
    let as_strong = shuffled.p_familywise < e.p_familywise
        || shuffled.p_familywise <= e.p_familywise && shuffled.log_likelihood_gain >= gain;
    as_strong.then_some(shuffled.p_familywise)
}

/// A reason; none where the errors beside it say the same: that there is one unit only.
fn in_words(found: &CampaignFindings, reason: Reason, of_searches: &str) -> Option<String> {
    let unit = nouns(found).unit;
    Some(match reason {
        Reason::Doubtful => format!("doubtful {}", nouns(found).setups),
        Reason::Probability(p) => format!("p {}", equals_probability(p)),
        Reason::Shuffled(p) => format!("a shuffled column has p {}", equals_probability(p)),
        Reason::Again(0.0) => format!("found in none of the searches{of_searches}"),
        Reason::Again(share) => format!("found in {} of the searches{of_searches}", percent(share)),
        Reason::NotRepeated
            if found.before.rmse_heldout.is_none() && found.design.specimens < 2 =>
        {
            return None;
        }
        Reason::InTime => "not shown beside noise that is correlated in time".to_owned(),
        Reason::NotRepeated => format!("no search without one {unit}"),
    })
}

/// What the words mean, for a page that has them.
pub fn grades() -> String {
    let number = |x: f64, decimals| rounded(x, Rounding::Decimals(decimals));
    format!(
        "Evidence is strong where p ≤ {} and every search without one specimen (actuator) finds the effect again, and its size has the sign that its source expects, varies by less than itself and is no other for some of them; weak where p > {}, fewer than {} \
         of these searches find it, a shuffled column does as well, it would not come in beside noise that is correlated in time or all tests are doubtful, else moderate. Specimens (actuators) differ where their own estimates do by more \
         than their standard errors allow (Cochran's Q).",
        number(CLEAR, 3),
        number(NEAR, 2),
        percent(SELDOM)
    )
}

/// `strong`, `moderate`, or `weak: found in 25% of the searches`: only of weak evidence it is said why.
pub(super) fn grade(found: &CampaignFindings, e: &EffectFinding) -> String {
    let (grade, reasons) = graded(found, e);
    match grade {
        Evidence::Strong => "strong".to_owned(),
        Evidence::Moderate => "moderate".to_owned(),
        Evidence::Weak => {
            let reasons = reasons.into_iter();
            let reasons: Vec<String> = reasons.filter_map(|r| in_words(found, r, "")).collect();
            format!("weak: {}", reasons.join(", "))
        }
    }
}

/// `weak evidence: p = 0.045, found in none of the searches without one specimen`, of weak evidence alone.
pub(super) fn weak(found: &CampaignFindings, e: &EffectFinding) -> Option<String> {
    let (grade, reasons) = graded(found, e);
    let of_searches = format!(" without one {}", without_one(found));
    let reasons: Vec<String> = { reasons.into_iter() }
        .filter_map(|r| in_words(found, r, &of_searches))
        .collect();
    (grade == Evidence::Weak).then(|| format!("weak evidence: {}", reasons.join(", ")))
}

/// `specimens differ: 5.2 to 17 N`, where their own estimates do by more than their standard errors allow: Cochran's Q, its p times the number of
/// effects of the campaign of which that is asked.
pub fn differ(found: &CampaignFindings, e: &EffectFinding) -> Option<String> {
    let has_several = |e: &&EffectFinding| e.by_specimen.len() > 1;
    let asked = found.effects.iter().filter(has_several).count();
    let own: Vec<(f64, f64)> = { e.by_specimen.values() }
        .map(|own| (own.value, own.standard_error))
        .collect();
    let values = || own.iter().map(|own| own.0);
    let (low, high) = (
        values().fold(f64::MAX, f64::min),
        values().fold(f64::MIN, f64::max),
    );
    let differ = asked as f64 * homogeneity(&own) < SIGNIFICANT;
    differ.then(|| {
        format!(
            "{} differ{}: {}",
            nouns(found).units,
            along(e),
            range(e, low, high)
        )
    })
}

/// ` in x`: the first of the two sizes of a shift, of which alone the units have estimates.
fn along(e: &EffectFinding) -> String {
    match e.parameters.as_slice() {
        [first, second, ..] if first.unit == second.unit => format!(" in {}", first.name),
        _ => String::new(),
    }
}

/// `5.2 to 17.1 N`.
fn range(e: &EffectFinding, low: f64, high: f64) -> String {
    let rounding = Rounding::ByInterval { low, high };
    let unit = e.parameters.first().map_or("1", |p| p.unit.as_str());
    let high = with_unit(&rounded(high, rounding), unit);
    format!("{} to {high}", rounded(low, rounding))
}
