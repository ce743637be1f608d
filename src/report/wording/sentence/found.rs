//! What was found: effects with their sizes, columns without a name, contradicted declarations.

use super::evidence::{differ, grade, weak};
use super::form::{undetermined, varying};
use crate::wording::name::{self, listed, nouns};
use crate::wording::number::{amounts, count, equals_probability, percent, plain, with_unit};
use pipeline_effects as effects;
use pipeline_findings::{
    ActsOn, CampaignFindings, EffectFinding, Level, Scatter, Unexplained, Verdict,
};
use pipeline_torque::diagnose::terms::usual;

/// Most members of an alias set, and most recording errors, that a sentence names.
pub(super) const MOST_NAMED: usize = 3;

/// What was found, without the errors; of an effect its name and size, and all remarks in one bracket.
pub(super) fn answer(found: &CampaignFindings) -> String {
    let remarks = |e: &EffectFinding| [weak(found, e), undetermined(e), opposed(e)];
    answer_with(found, &|e| remarks(e).into_iter().flatten().collect())
}

/// The same with weak evidence called so, and not why.
pub(super) fn short_answer(found: &CampaignFindings) -> String {
    answer_with(found, &|e| called_weak(found, e).into_iter().collect())
}

fn called_weak(found: &CampaignFindings, e: &EffectFinding) -> Option<String> {
    weak(found, e).map(|_| "weak evidence".to_owned())
}

/// The same with the strength of the evidence for every effect, with the range of its size where one value would mislead, and with whether the units'
/// own estimates differ.
pub(super) fn graded_answer(found: &CampaignFindings) -> String {
    let graded = |e: &EffectFinding| {
        let differ = differ(found, e).map(|_| format!("{} differ", nouns(found).units));
        let open = undetermined(e);
        let all = [Some(grade(found, e)), open, varying(e), differ, opposed(e)];
        all.into_iter().flatten().collect()
    };
    answer_with(found, &graded)
}

fn answer_with(
    found: &CampaignFindings,
    evidence: &dyn Fn(&EffectFinding) -> Vec<String>,
) -> String {
    let weighty: Vec<&EffectFinding> = found.effects.iter().filter(|e| !e.negligible).collect();
    let of_effect = |e: &EffectFinding| {
        let large = beyond_usual(found, e).map(|_| "implausibly large".to_owned());
        let others = [large, of_one_group(found, e), indistinguishable(e)];
        bracketed(
            size_of(e),
            evidence(e).into_iter().chain(others.into_iter().flatten()),
        )
    };
    match found.verdict {
        Verdict::NotAssessed => format!("not assessed: {}", name::not_assessed(found)),
        Verdict::None if found.effects.is_empty() => nothing(found),
        Verdict::None => {
            let all: Vec<String> = found.effects.iter().map(of_effect).collect();
            format!(
                "no effect above the smallest of interest; below it: {}",
                all.join("; ")
            )
        }
        Verdict::Unexplained => unexplained(found),
        Verdict::EffectFound => {
            let all: Vec<String> = weighty.into_iter().map(of_effect).collect();
            all.join("; ")
        }
    }
}

/// A mounting that is further off than this, mm, is no accident of a tape measure.
const MOUNTED_OFF_MM: f64 = 3.0;

/// That there is no effect; of a single test what its own mounting then stands for, which is as far off as an effect would be.
fn nothing(found: &CampaignFindings) -> String {
    let nothing = Some("no effect detected".to_owned());
    let all = nothing.into_iter().chain(mounted_off(found));
    all.collect::<Vec<String>>().join("; ")
}

/// `the only test fits only with a mounting length that is 18 mm off`, where there is one test whose mounting is.
pub(super) fn mounted_off(found: &CampaignFindings) -> Option<String> {
    let of_one = |s: &&Scatter| s.level == Level::Test && s.unit == "mm" && s.values.len() == 1;
    let mut own = found.scatter.iter().filter(of_one);
    own.find_map(|s| {
        let off = s.values.values().next()?.abs();
        (off > MOUNTED_OFF_MM).then(|| {
            format!(
                "the only test fits only with a {} that is {} off",
                name::scatter(&s.id, s.level),
                plain(off, &s.unit)
            )
        })
    })
}

/// `threshold pressure of the bladder 60 kPa (weak evidence: p = 0.045; implausibly large)`.
fn bracketed(what: String, remarks: impl Iterator<Item = String>) -> String {
    let remarks: Vec<String> = remarks.collect();
    if remarks.is_empty() {
        what
    } else {
        format!("{what} ({})", remarks.join("; "))
    }
}

/// The same in fewer words: names and sizes, with what does as well, and a mark where a size is no such effect's.
pub(super) fn in_names(found: &CampaignFindings) -> String {
    let weighty = found.effects.iter().filter(|e| !e.negligible);
    let marked = |e: &EffectFinding| {
        let large = beyond_usual(found, e).map(|_| "implausibly large".to_owned());
        let remarks = [or_others(e), large, called_weak(found, e)];
        bracketed(size_of(e), remarks.into_iter().flatten())
    };
    let unnamed = found.unexplained.iter();
    let unnamed = unnamed.map(|u| format!("a dependence on the {}", name::column(&u.column)));
    let all: Vec<String> = weighty.map(marked).chain(unnamed).collect();
    match found.verdict {
        Verdict::EffectFound => all.join(", "),
        Verdict::None => nothing(found),
        Verdict::Unexplained | Verdict::NotAssessed => answer(found),
    }
}

/// `the set length scatters by 0.83 mm, not by the declared 0.10 mm`.
pub(super) fn contradicted(found: &CampaignFindings) -> Option<String> {
    let contradicted = found.scatter.iter().filter(|s| s.declared_contradicted);
    let list: Vec<String> = contradicted
        .filter_map(|s| {
            let declared = plain(s.declared?, &s.unit);
            let what = name::scatter(&s.id, s.level);
            // What was declared of specimens is kept, and their scatter not estimated beside it.
            Some(match s.level {
                Level::Session | Level::Test => format!(
                    "the {what} scatters by {}, not by the declared {declared}",
                    plain(s.sd, &s.unit)
                ),
                _ => format!("the {what} must be off by more than the declared {declared}"),
            })
        })
        .collect();
    (!list.is_empty()).then(|| list.join("; "))
}

/// Of an effect of a joint that it is larger than such parts were measured to be, and what these have up to: something else is probably in it.
pub fn beyond_usual(found: &CampaignFindings, e: &EffectFinding) -> Option<String> {
    let (most, unit) = usual(&e.id, &e.form).filter(|_| found.kind == "knee-torque")?;
    // A shift has two parts.
    let squares: f64 = e.parameters.iter().map(|p| p.value * p.value).sum();
    (squares.sqrt() > most).then(|| with_unit(&most.to_string(), unit))
}

/// Of an effect of which groups scatter as well, where there is but one of them: its own value and the effect are one number.
fn of_one_group(found: &CampaignFindings, e: &EffectFinding) -> Option<String> {
    let scatters = |s: &&Scatter| s.id == e.id && s.values.len() == 1;
    let own = found.scatter.iter().find(scatters)?;
    let (own, level) = (name::scatter(&own.id, own.level), name::level(own.level));
    (e.acts_on == ActsOn::All).then(|| format!("perhaps the {own} of the only {level}"))
}

/// `its sign is that of a lag, not of friction`, of a size with the sign that its source does not expect.
pub(super) fn opposed(e: &EffectFinding) -> Option<String> {
    let size = e.parameters.first()?;
    let known = effects::all()[effects::index(&e.id)?];
    let words = known.if_negative().filter(|_| size.value < 0.0)?;
    Some(format!("its sign is that of {words}"))
}

/// `indistinguishable from zero of the pressure sensor`; none where its alias set holds it alone.
fn indistinguishable(effect: &EffectFinding) -> Option<String> {
    let others: Vec<String> = alias_set(effect);
    match others.len() {
        0 => None,
        n if n <= MOST_NAMED => Some(format!("indistinguishable from {}", listed(&others))),
        n => Some(format!("indistinguishable from {} other effects", count(n))),
    }
}

/// `or zero of the pressure sensor`; none where its alias set holds it alone.
fn or_others(effect: &EffectFinding) -> Option<String> {
    let others = alias_set(effect);
    match &others[..] {
        [] => None,
        [one] => Some(format!("or {one}")),
        [one, other] => Some(format!("or {one}, or {other}")),
        _ => Some(format!("or one of {} others", count(others.len()))),
    }
}

/// `threshold pressure of the bladder 60 kPa`.
fn size_of(effect: &EffectFinding) -> String {
    let size = amounts(&effect.parameters).map_or_else(String::new, |amount| format!(" {amount}"));
    let from = match (&effect.from, &effect.column) {
        (Some(session), _) => format!(" from session {session} on"),
        (None, Some(column)) => match &effect.reference_level {
            Some(level) => format!(" against {level} ({})", name::column(column)),
            None => format!(", {}", name::acts_on(effect)),
        },
        (None, None) => String::new(),
    };
    called(effect) + &size + &from
}

/// What an effect is called; with its form where its size has not the unit by which the effect is known: a compliance in mm.
pub fn called(effect: &EffectFinding) -> String {
    let known = effects::index(&effect.id).and_then(|k| effects::all()[k].forms().first());
    let unit = effect.parameters.first().map(|p| p.unit.as_str());
    if known.is_some_and(|form| unit.is_some_and(|u| u != form.amplitude.unit)) {
        name::effect_with_form(&effect.id, &effect.form)
    } else {
        name::effect(&effect.id)
    }
}

/// The other members of an effect's alias set, then the columns a dependence on which explains the readings as well.
pub fn alias_set(effect: &EffectFinding) -> Vec<String> {
    let others = effect.class.iter().filter(|id| **id != effect.id);
    let columns = effect.explained_as_well_by.iter();
    let columns = columns.map(|column| format!("a dependence on {}", name::column(column)));
    others.map(|id| name::effect(id)).chain(columns).collect()
}

/// `the error depends on humidity (p = 0.002; temperature explains it as well), in a way that no effect of the library has`.
pub(super) fn unexplained(found: &CampaignFindings) -> String {
    let columns: Vec<String> = found
        .unexplained
        .iter()
        .map(|u| {
            let others: Vec<String> = u
                .explained_as_well_by
                .iter()
                .map(|id| name::candidate(id))
                .collect();
            let as_well = match others.len() {
                0 => String::new(),
                1 => format!("; {} explains it as well", others[0]),
                _ => format!("; {} explain it as well", listed(&others)),
            };
            format!(
                "{} ({}p {}{as_well})",
                name::column(&u.column),
                over_its_range(u, found),
                equals_probability(u.p_familywise)
            )
        })
        .collect();
    format!(
        "the error depends on {}, in a way that no effect of the library has",
        listed(&columns)
    )
}

/// `8.4% of the force over its range, `: how far a dependence goes, empty where that is not known.
fn over_its_range(u: &Unexplained, found: &CampaignFindings) -> String {
    let values = || u.curve.iter().map(|(_, change)| *change);
    let far = values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min);
    if !(far > 0.0 && far.is_finite()) {
        return String::new();
    }
    let size = if u.shape == "gain" {
        format!("{} of the {}", percent(far), name::load(found))
    } else {
        plain(far, &found.unit)
    };
    format!("{size} over its range, ")
}

/// The same beside effects that were found.
pub(super) fn beside(found: &CampaignFindings) -> Option<String> {
    let share: f64 = found.unexplained.first()?.share_of_variance;
    let rest = unexplained(found);
    Some(format!(
        "what the effects leave is not all noise: {rest} ({} of its variance)",
        percent(share)
    ))
}

/// Whether anything was put into the model.
pub fn has_terms(found: &CampaignFindings) -> bool {
    !found.effects.is_empty() || !found.unexplained.is_empty()
}
