//! The effects that were found, the candidates that were tested, and what stays without a name.

use crate::number::Rounding;
use crate::wording::COMES_IN;
use crate::wording::name;
use crate::wording::number::{
    NONE, error_with_unit, gain, gain_or_none, percent, plain, probability, rounded, size,
};
use crate::wording::sentence::{PLACEBO, beside_noise, beyond_usual, differ, plain_number};
use pipeline_findings::{
    BesideNoise, CampaignFindings, EffectFinding, Parameter, Tested, Unexplained,
};
use serde::Serialize;

/// Most tested candidates in print; `tested.csv` has all.
const TESTED: usize = 8;

#[derive(Serialize)]
pub(super) struct Effect {
    id: String,
    title: String,
    equation: String,
    acts_on: String,
    sizes: Vec<String>,
    others: Vec<String>,
    /// Whether one number is enough for its size.
    form: Option<String>,
    negligible: bool,
    facts: Vec<(&'static str, String)>,
    measurement: String,
    source: String,
}

/// The effects that were found, in the order of the findings.
pub(super) fn effects(found: &CampaignFindings) -> Vec<Effect> {
    found.effects.iter().map(|e| effect(found, e)).collect()
}

fn effect(found: &CampaignFindings, e: &EffectFinding) -> Effect {
    Effect {
        id: e.id.clone(),
        title: name::capitalised(&name::effect_with_form(&e.id, &e.form)),
        equation: e.equation.clone(),
        acts_on: name::acts_on(e),
        sizes: e.parameters.iter().map(size).collect(),
        others: crate::wording::sentence::alias_set(e),
        form: crate::wording::sentence::form(e),
        negligible: e.negligible,
        facts: facts(found, e),
        measurement: e.measurement.clone(),
        source: e.source.clone(),
    }
}

fn facts(found: &CampaignFindings, e: &EffectFinding) -> Vec<(&'static str, String)> {
    let mut facts = vec![
        ("family-wise p", familywise(found, e.p_familywise)),
        ("RMS on its readings", error_with_unit(e.rms, &found.unit)),
    ];
    if let Some(share) = e.found_in_folds {
        let unit = name::without_one(found);
        let searches = format!(
            "{} of the searches without one {unit}, in this or another form or as a member of its alias set",
            percent(share)
        );
        facts.insert(1, ("found again in", searches));
    }
    if let Some(log_likelihood) = e.log_likelihood_gain {
        facts.insert(1, ("gain in log-likelihood", gain(log_likelihood)));
    }
    let most = beyond_usual(found, e);
    facts.extend(most.map(|most| {
        (
            "implausibly large",
            format!("such parts measure at most {most}"),
        )
    }));
    facts.extend(differ(found, e).map(|words| ("own estimates", words)));
    let beside = beside_noise(found, e).and_then(|beside| in_time(beside, e));
    facts.extend(beside.map(|size| ("beside correlated noise", size)));
    let mut misfit = found.misfit.iter();
    if misfit.any(|m| m.sensitive.contains(&e.id)) {
        facts.push((
            "misfit prior",
            "the result changes when it is halved or doubled".to_owned(),
        ));
    }
    facts
}

/// The size of an effect beside noise that is correlated in time; none of one without a size.
fn in_time(beside: &BesideNoise, e: &EffectFinding) -> Option<String> {
    let there = size(&Parameter {
        value: beside.value?,
        ci_low: beside.ci_low,
        ci_high: beside.ci_high,
        ..e.parameters.first()?.clone()
    });
    let comes_in = match (beside.stands, beside.ci_low) {
        (true, _) => String::new(),
        (false, None) => ", its bound: it would not come in".to_owned(),
        (false, Some(_)) => format!(
            "; gain in log-likelihood {}, too little to come in",
            gain(beside.log_likelihood_gain)
        ),
    };
    Some(there + &comes_in)
}

/// A family-wise p; with `≤` where none of the draws came as far.
fn familywise(found: &CampaignFindings, p: f64) -> String {
    let words = probability(p);
    if p <= found.design.smallest_p.familywise {
        format!("≤ {words}")
    } else {
        words
    }
}

/// An alias set: its effect, and the likelihood of each other member in its place.
#[derive(Serialize)]
pub(super) struct AliasRow {
    effect: String,
    /// Member, log-likelihood less that of the effect, cosine of the sensitivities.
    members: Vec<[String; 3]>,
}

pub(super) fn alias_sets(found: &CampaignFindings) -> Vec<AliasRow> {
    // Without likelihoods there is nothing to compare; the block of the effect names the others.
    let with_others = found.effects.iter().filter(|e| !e.in_its_place.is_empty());
    let row = |e: &EffectFinding| AliasRow {
        effect: crate::wording::sentence::called(e),
        members: e
            .class
            .iter()
            .filter(|id| **id != e.id)
            .map(|id| member(found, e, id))
            .collect(),
    };
    with_others.map(row).collect()
}

fn member(found: &CampaignFindings, e: &EffectFinding, id: &str) -> [String; 3] {
    let likelihood = e.in_its_place.iter().find(|(other, _)| other == id);
    let is_pair = |ids: &[String; 2]| ids.contains(&e.id) && ids.iter().any(|other| other == id);
    let alias = found.aliases.iter().find(|a| is_pair(&a.ids));
    [
        name::capitalised(&name::effect(id)),
        likelihood.map_or_else(|| NONE.to_owned(), |(_, l)| gain(*l)),
        alias.map_or_else(
            || NONE.to_owned(),
            |a| rounded(a.cosine, Rounding::Decimals(3)),
        ),
    ]
}

#[derive(Serialize)]
pub(super) struct TestedRow {
    /// Candidate, acts on, size, gain, p.
    cells: [String; 5],
    significant: bool,
}

pub(super) fn tested(found: &CampaignFindings) -> Vec<TestedRow> {
    let row = |t: &Tested| TestedRow {
        cells: [
            if t.id == PLACEBO {
                "shuffled column (placebo)".to_owned()
            } else if t.is_column {
                format!("{} (column)", name::column(&t.id))
            } else {
                name::effect_with_form(&t.id, &t.form)
            },
            name::acts_on_what(t.acts_on).to_owned(),
            t.amplitude
                .map_or_else(|| NONE.to_owned(), |a| amplitude(found, t, a)),
            gain(t.log_likelihood_gain),
            familywise(found, t.p_familywise),
        ],
        significant: is_significant(t),
    };
    found.tested.iter().take(TESTED).map(row).collect()
}

fn is_significant(t: &Tested) -> bool {
    t.p_familywise <= COMES_IN && t.id != PLACEBO
}

/// Whether nothing is in the answer though the linearised gain of a candidate would let it in.
pub(super) fn is_some_not_accepted(found: &CampaignFindings) -> bool {
    let is_empty = found.effects.is_empty() && found.unexplained.is_empty();
    is_empty && found.tested.iter().take(TESTED).any(is_significant)
}

/// The linearised amplitude of a candidate; one that is physically impossible by the bound that it passes.
fn amplitude(found: &CampaignFindings, t: &Tested, value: f64) -> String {
    let (low, high) = super::limits::possible(found, &t.id, &t.form);
    if value > high {
        format!("beyond {}", plain_number(high, &t.unit))
    } else if value < low {
        format!("below {}", plain_number(low, &t.unit))
    } else {
        plain(value, &t.unit)
    }
}

/// What there is to say of the shuffled column where it is among the candidates in print: it is there to be wrong, and sometimes is. Empty where it
/// looks like nothing.
pub(super) fn shuffled(found: &CampaignFindings) -> String {
    let mut printed = found.tested.iter().take(TESTED);
    let low = printed.any(|t| t.id == PLACEBO && t.p_familywise <= COMES_IN);
    if low {
        "The shuffled column carries no information and is never accepted: others here may be significant by chance, too."
    } else {
        ""
    }
    .to_owned()
}

/// Column with what explains the readings as well, share of the variance, gain, p.
pub(super) fn unexplained(found: &CampaignFindings, u: &Unexplained) -> [String; 4] {
    let columns = std::iter::once(name::column(&u.column));
    let others = u.explained_as_well_by.iter().map(|id| name::candidate(id));
    [
        name::capitalised(&columns.chain(others).collect::<Vec<String>>().join(", or ")),
        percent(u.share_of_variance),
        gain_or_none(u.log_likelihood_gain),
        familywise(found, u.p_familywise),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wording::tests::example;
    use pipeline_findings::ActsOn;

    #[test]
    fn a_shuffled_column_with_a_low_p_is_commented_and_not_set_in_bold() {
        let mut found = example();
        assert_eq!(shuffled(&found), "");
        found.tested.insert(
            0,
            Tested {
                id: PLACEBO.into(),
                is_column: true,
                form: String::new(),
                acts_on: ActsOn::All,
                log_likelihood_gain: 9.1,
                amplitude: None,
                unit: "1".into(),
                p_familywise: 0.01,
            },
        );
        assert!(shuffled(&found).contains("never accepted"));
        assert!(!tested(&found)[0].significant);
    }
}
