//! From what was chosen to what is said.

use super::findings::{
    CampaignFindings, CoefficientChange, EffectFinding, NextMeasurement, ParameterFinding,
    Question, Reading, Rejected, Residuals, Suspect, Unexplained, Verdict,
};
use super::folds::Tally;
use super::judge::{self, Judgement};
use super::limits::{Limits, limits};
use super::model::{Fitted, Model, Place, USUAL_SCATTER};
use super::search::{Search, State};
use super::term::{Scope, Term, What};
use super::uncertainty::{Uncertainty, uncertainties};
use super::{Diagnosis, Work, base::Base, data::Data, questions, train_error};
use crate::effects;
use crate::models::{ForceModel, new};
use crate::numerics::distributions::{chi_square_upper_tail, f_upper_tail};
use std::collections::BTreeSet;

/// Share of the residual below which a dependence is not worth a word.
const WORTH_SAYING: f64 = 0.05;
/// Corrected p of a question above which a column says nothing.
const SAYS_NOTHING: f64 = 0.01;
/// A reading of the data whose held-out error is larger by less than this is as good.
const AS_GOOD: f64 = 1.05;
/// Effects beside those that were found in the readings of the base.
const MOST_MORE: usize = 2;
/// Candidates whose held-out error is looked at for each.
const MOST_TRIED: usize = 5;
/// p below which the strengths scatter more than is usual.
const MORE_THAN_USUAL: f64 = 0.005;

/// The answer.
pub(super) fn answer(work: &Work) -> Diagnosis {
    let thin = work.train.thinned(work.options.most_readings);
    let search = Search::new(
        work.base,
        &thin,
        work.candidates,
        work.options.most_effects,
        judge::SIGNIFICANT.0,
    );
    let all_terms: Vec<Term> = work
        .best
        .chosen
        .iter()
        .map(|c| work.candidates[*c].clone())
        .collect();
    let full = Model {
        base: work.base,
        data: work.train,
        terms: all_terms,
    };
    let fitted = full.fit(Some(&work.best.fitted), 1);
    let effective = work.best.effective
        * (work.train.len() as f64 / thin.len() as f64).min(
            if work.best.effective < 0.9 * thin.len() as f64 {
                1.0
            } else {
                f64::INFINITY
            },
        );
    let uncertain = uncertainties(&full, &fitted, effective.min(work.train.len() as f64), &[]);
    let null_model = Model {
        base: work.base,
        data: work.train,
        terms: Vec::new(),
    };
    let null = null_model.fit(Some(&work.null.fitted), 1);
    let mut effects = effects_found(work, &search, &full, &fitted, &uncertain);
    let after_questions = questions_after(&search, &work.best, work);
    let strengths = strengths_found(work, &fitted, &full);
    if let Some(finding) = strengths {
        effects.push(finding);
    }
    let unexplained = unexplained(work, &fitted, &after_questions, search.least_n);
    let verdict = verdict(work, &effects, &unexplained);
    let limits = limits(&search, &work.best);
    let physical = physical_only(work, &fitted);
    let before = super::errors(train_error(&null_model, &null), work.held.before);
    let (after_model, after_fit) = &physical;
    let after = super::errors(train_error(after_model, after_fit), work.held.after);
    let found = &after_model.terms;
    let after_as_chosen =
        (!found.is_empty()).then(|| reading(work, &search, work.base, "", found.clone()).errors);
    let after_empirical = work
        .held
        .empirical
        .map(|t: Tally| super::errors(train_error(&full, &fitted), t));
    let residuals = residuals(work, &null_model, &null, &full, &fitted);
    let readings_of_the_base = readings_of_the_base(work, &search);
    let mut rejected = work.rejected.clone();
    rejected.extend(rivals(&search, work));
    let findings = CampaignFindings {
        campaign: work.group.campaign.clone(),
        diameter_mm: work.group.diameter_mm,
        simulated: work.group.simulated,
        kind: "isometric".to_owned(),
        base_model: work.base.id.clone(),
        base_refitted: work.base.coefficients.iter().any(|c| c.free),
        unit: "N".to_owned(),
        verdict,
        summary: summary(
            verdict,
            &effects,
            &unexplained,
            work,
            after_as_chosen.map(|e| e.rmse_heldout),
        ),
        readings: work.train.len(),
        sessions: work.train.session.iter().collect::<BTreeSet<_>>().len(),
        specimens: work.train.specimen.iter().collect::<BTreeSet<_>>().len(),
        readings_held_out: work.all.len() - work.train.len(),
        held_out_by: work.held_out_by.to_owned(),
        questions: work.questions.clone(),
        next_measurement: next(&effects, &limits, &readings_of_the_base),
        effects,
        unexplained,
        suspects: work.suspects.clone(),
        before,
        after,
        after_as_chosen,
        after_empirical,
        by_specimen: work.held.by_unit.clone(),
        noise_floor: noise_floor(work.train, &fitted.residuals),
        black_box_rmse_heldout: work.held.black_box,
        black_box_after_rmse_heldout: work.held.black_box_after,
        rejected,
        detection_limits: limits.detection,
        not_measurable: limits.not_measurable,
        aliases: limits.aliases,
        readings_of_the_base,
        coefficients: coefficients(work, &null, &full, &fitted, &uncertain),
        notes: notes(work),
    };
    Diagnosis {
        findings,
        residuals,
    }
}

/// The base with the physical terms alone, fitted.
fn physical_only<'a>(work: &'a Work, fitted: &Fitted) -> (Model<'a>, Fitted) {
    let chosen: Vec<Term> = work
        .best
        .chosen
        .iter()
        .map(|c| work.candidates[*c].clone())
        .collect();
    let physical: Vec<Term> = chosen
        .iter()
        .filter(|t| matches!(t.what, What::Effect { .. }))
        .cloned()
        .collect();
    let same = physical.len() == chosen.len();
    let model = Model {
        base: work.base,
        data: work.train,
        terms: physical,
    };
    let fit = if same {
        fitted.clone()
    } else {
        model.fit(None, 1)
    };
    (model, fit)
}

fn scope_word(scope: &Scope) -> &'static str {
    match scope {
        Scope::Whole => "global",
        Scope::Specimen(_) => "specimen",
        _ => "session",
    }
}

fn effects_found(
    work: &Work,
    search: &Search,
    full: &Model,
    fitted: &Fitted,
    uncertain: &[Uncertainty],
) -> Vec<EffectFinding> {
    let layout = full.layout();
    work.judgements
        .iter()
        .enumerate()
        .filter_map(|(k, judgement)| {
            let term = &work.candidates[judgement.candidate];
            let What::Effect { effect, .. } = term.what else {
                return None;
            };
            let form = term.form()?;
            let described = effects::all()[effect];
            Some(EffectFinding {
                id: described.id().to_owned(),
                title: described.title().to_owned(),
                equation: form.equation.to_owned(),
                form: form.name.to_owned(),
                class: class(search, judgement, described.id(), work),
                scope: scope_word(&term.scope).to_owned(),
                acts_on: judge::acts_on(term, work.train),
                parameters: parameters(k, term, fitted, &layout, uncertain),
                p_adjusted: judgement.p_adjusted,
                selected_in_folds: judgement.chosen_again,
                helps_in_folds: judgement.helps,
                rmse_before: judgement.train.0,
                rmse_after: judgement.train.1,
                rmse_heldout_before: judgement.held_out.0,
                rmse_heldout_after: judgement.held_out.1,
                criterion_gain: judgement.criterion_gain,
                source: described.source().to_owned(),
                measurement: described.measurement().to_owned(),
            })
        })
        .collect()
}

/// The ids of a class, the effect's own first.
fn class(search: &Search, judgement: &Judgement, id: &str, work: &Work) -> Vec<String> {
    let mut class = vec![id.to_owned()];
    for c in &judgement.class {
        if let Some(other) = search.candidates[*c].id() {
            class.push(other.to_owned());
        }
    }
    let term = &search.candidates[judgement.candidate];
    // A gain of every reading of a specimen is its strength.
    let gain = ["force_gain", "misalignment"].contains(&id);
    if gain && follows_specimens(term, work.train) {
        class.push(super::candidates::STRENGTHS.to_owned());
    }
    let mut seen = BTreeSet::new();
    class.retain(|x| seen.insert(x.clone()));
    class
}

/// Whether a term acts on all sessions of a specimen or on none.
fn follows_specimens(term: &Term, data: &Data) -> bool {
    let of = data.specimen_of_session();
    let mut acts: Vec<Option<Option<usize>>> = vec![None; data.specimens.len()];
    (0..of.len()).all(|s| *acts[of[s]].get_or_insert(term.acts_on[s]) == term.acts_on[s])
}

fn parameters(
    k: usize,
    term: &Term,
    fitted: &Fitted,
    layout: &[Place],
    uncertain: &[Uncertainty],
) -> Vec<ParameterFinding> {
    let Some(form) = term.form() else {
        return Vec::new();
    };
    let (amplitudes, second) = &fitted.terms[k];
    let of = |place: Place| {
        layout
            .iter()
            .position(|p| *p == place)
            .map(|i| uncertain[i])
    };
    let one = |name: String, value: f64, absent: f64, unit: &str, u: Option<Uncertainty>| {
        let half = u.map_or(f64::NAN, Uncertainty::half_width);
        ParameterFinding {
            name,
            value: absent + value,
            ci_low: absent + value - half,
            ci_high: absent + value + half,
            unit: unit.to_owned(),
        }
    };
    let a = form.amplitude;
    if amplitudes.len() == 1 {
        let mut list = vec![one(
            a.name.to_owned(),
            amplitudes[0],
            a.absent,
            a.unit,
            of(Place::Amplitude(k, 0)),
        )];
        if let Some((shape, _)) = form.shape {
            list.push(one(
                shape.name.to_owned(),
                *second,
                0.0,
                shape.unit,
                of(Place::Shape(k)),
            ));
        }
        return list;
    }
    let n = amplitudes.len() as f64;
    let mean = amplitudes.iter().sum::<f64>() / n;
    let sd = (amplitudes
        .iter()
        .map(|x| (x - mean) * (x - mean))
        .sum::<f64>()
        / (n - 1.0))
        .sqrt();
    // Normal values: the interval of a standard deviation (Wilson and Hilferty's chi-square).
    let chi = |z: f64| {
        let f = n - 1.0;
        let cube = 1.0 - 2.0 / (9.0 * f) + z * (2.0 / (9.0 * f)).sqrt();
        f * cube * cube * cube
    };
    let half = 2.07 * sd / n.sqrt();
    vec![
        ParameterFinding {
            name: format!("sd of {}", a.name),
            value: sd,
            ci_low: sd * ((n - 1.0) / chi(1.96)).sqrt(),
            ci_high: sd * ((n - 1.0) / chi(-1.96)).sqrt(),
            unit: a.unit.to_owned(),
        },
        ParameterFinding {
            name: format!("mean of {}", a.name),
            value: a.absent + mean,
            ci_low: a.absent + mean - half,
            ci_high: a.absent + mean + half,
            unit: a.unit.to_owned(),
        },
    ]
}

/// The strengths of the specimens as a finding, where they scatter more than is usual.
fn strengths_found(work: &Work, fitted: &Fitted, full: &Model) -> Option<EffectFinding> {
    let seen: BTreeSet<usize> = work.train.specimen.iter().copied().collect();
    let lost = work
        .base
        .coefficients
        .iter()
        .take(2)
        .filter(|c| c.free)
        .count();
    let freedom = seen.len().checked_sub(lost + 1)? as f64 + 1.0;
    if seen.len() < 4 || freedom < 2.0 {
        return None;
    }
    let squares: f64 = seen
        .iter()
        .map(|k| fitted.strengths[*k] * fitted.strengths[*k])
        .sum();
    let p = chi_square_upper_tail(squares / (USUAL_SCATTER * USUAL_SCATTER), freedom);
    if p > MORE_THAN_USUAL {
        return None;
    }
    let described = effects::all()[effects::index(super::candidates::STRENGTHS)?];
    let form = &described.forms()[0];
    let sd = (squares / freedom).sqrt();
    let quantile = |z: f64| {
        let cube = 1.0 - 2.0 / (9.0 * freedom) + z * (2.0 / (9.0 * freedom)).sqrt();
        freedom * cube * cube * cube
    };
    let own = full.predict(fitted, true);
    let mean = full.predict(fitted, false);
    let rmse = |f: &[f64]| {
        let squares: f64 = work
            .train
            .force
            .iter()
            .zip(f)
            .map(|(y, f)| (y - f) * (y - f))
            .sum();
        (squares / f.len() as f64).sqrt()
    };
    Some(EffectFinding {
        id: described.id().to_owned(),
        title: described.title().to_owned(),
        equation: form.equation.to_owned(),
        form: form.name.to_owned(),
        class: ["specimen_variation", "force_gain", "misalignment"]
            .map(str::to_owned)
            .to_vec(),
        scope: "specimen".to_owned(),
        acts_on: "every specimen, each with its own value".to_owned(),
        parameters: vec![ParameterFinding {
            name: form.amplitude.name.to_owned(),
            value: sd,
            ci_low: sd * (freedom / quantile(1.96)).sqrt(),
            ci_high: sd * (freedom / quantile(-1.96).max(1e-3)).sqrt(),
            unit: form.amplitude.unit.to_owned(),
        }],
        p_adjusted: p,
        selected_in_folds: 1.0,
        helps_in_folds: 0.0,
        rmse_before: rmse(&mean),
        rmse_after: rmse(&own),
        rmse_heldout_before: work.held.after.rmse(),
        rmse_heldout_after: work.held.after.rmse_own_strength(),
        criterion_gain: 0.0,
        source: described.source().to_owned(),
        measurement: described.measurement().to_owned(),
    })
}

/// The questions again, of what is left.
fn questions_after(search: &Search, best: &State, work: &Work) -> Vec<Question> {
    let predicted = search.model(&best.chosen).predict(&best.fitted, true);
    let columns = questions::columns(search.data, &predicted);
    questions::ask(
        search.data,
        &best.fitted.residuals,
        &columns,
        work.options.permutations,
        work.options.seed,
    )
}

/// The empirical terms that were chosen; and where nothing was, the columns on which the residual depends.
fn unexplained(work: &Work, fitted: &Fitted, after: &[Question], least_n: f64) -> Vec<Unexplained> {
    let mut list: Vec<Unexplained> = work
        .judgements
        .iter()
        .enumerate()
        .filter_map(|(k, judgement)| {
            let term = &work.candidates[judgement.candidate];
            let What::Empirical(empirical) = term.what else {
                return None;
            };
            let (shape, curve) =
                empirical.curve(work.train, [fitted.terms[k].0[0], fitted.terms[k].1]);
            Some(Unexplained {
                column: empirical.column(work.train),
                shape: shape.to_owned(),
                p_adjusted: judgement.p_adjusted,
                share_of_residual: judgement.share,
                rmse_heldout_before: Some(judgement.held_out.0),
                rmse_heldout_after: Some(judgement.held_out.1),
                curve,
            })
        })
        .collect();
    let rss =
        |f: &Fitted| f.residuals.iter().map(|r| r * r).sum::<f64>() / f.residuals.len() as f64;
    let left = rss(&work.best.fitted) / rss(&work.null.fitted).max(f64::MIN_POSITIVE);
    let matters = |q: &&Question| {
        q.share * left > WORTH_SAYING && (q.share * rss(&work.best.fitted)).sqrt() > least_n
    };
    let mut others: Vec<&Question> = after
        .iter()
        .filter(|q| q.p_adjusted < SAYS_NOTHING)
        .filter(matters)
        .collect();
    others.sort_by(|a, b| b.share.total_cmp(&a.share).then(a.column.cmp(&b.column)));
    list.extend(
        work.suspects
            .iter()
            .filter(|s| s.set_aside)
            .map(|s| set_aside(s, work)),
    );
    for question in others {
        if !list.iter().any(|u| u.column == question.column) {
            list.push(Unexplained {
                column: question.column.clone(),
                shape: "not fitted".to_owned(),
                p_adjusted: question.p_adjusted,
                share_of_residual: question.share,
                rmse_heldout_before: None,
                rmse_heldout_after: None,
                curve: Vec::new(),
            });
        }
    }
    list
}

/// A session that took no part, as a dependence that nothing explains. Its p: that of its error among those of all sessions, as an F.
fn set_aside(suspect: &Suspect, work: &Work) -> Unexplained {
    let sessions = work.train.session.iter().collect::<BTreeSet<_>>().len() as f64;
    let ratio = suspect.error_n / suspect.usual_n.max(f64::MIN_POSITIVE);
    Unexplained {
        column: "session".to_owned(),
        shape: format!("{}: {}", suspect.what, suspect.explanation),
        p_adjusted: (sessions * f_upper_tail(ratio * ratio, 1.0, sessions - 1.0)).min(1.0),
        share_of_residual: 1.0 - 1.0 / (1.0 + ratio * ratio / sessions),
        rmse_heldout_before: None,
        rmse_heldout_after: None,
        curve: Vec::new(),
    }
}

fn verdict(
    work: &Work,
    effects: &[super::findings::EffectFinding],
    unexplained: &[Unexplained],
) -> Verdict {
    let empirical = work
        .judgements
        .iter()
        .filter(|j| matches!(work.candidates[j.candidate].what, What::Empirical(_)));
    let strongest_empirical = empirical.map(|j| j.share).fold(0.0, f64::max);
    if !effects.is_empty() {
        Verdict::EffectFound
    } else if strongest_empirical > 0.0 || !unexplained.is_empty() {
        Verdict::Unexplained
    } else {
        Verdict::None
    }
}

fn summary(
    verdict: Verdict,
    effects: &[EffectFinding],
    unexplained: &[Unexplained],
    work: &Work,
    as_chosen: Option<f64>,
) -> String {
    let (before, after) = (work.held.before.rmse(), work.held.after.rmse());
    let first: String = work.suspects.iter().map(look_at).collect();
    let then = match verdict {
        Verdict::EffectFound => {
            let names: Vec<String> = effects
                .iter()
                .map(|e| {
                    let p = &e.parameters[0];
                    let class = if e.class.len() > 1 {
                        format!(", not to be told from {} here", e.class[1..].join(", "))
                    } else {
                        String::new()
                    };
                    format!(
                        "{} ({} = {}{class})",
                        e.title,
                        p.name,
                        with_unit(p.value, &p.unit)
                    )
                })
                .collect();
            let fixed = as_chosen.map_or_else(String::new, |e| {
                format!(" (to {e:.1} N where only the sizes are found anew in each fold)")
            });
            format!(
                "Missing: {}. With the search inside each fold the held-out error goes from {before:.1} N to {after:.1} N{fixed}.",
                names.join("; ")
            )
        }
        Verdict::None => "Nothing is missing that this campaign could show.".to_owned(),
        Verdict::Unexplained => {
            let aside = |u: &&Unexplained| u.shape.starts_with("session ");
            let columns: Vec<&str> = unexplained
                .iter()
                .filter(|u| !aside(u))
                .map(|u| u.column.as_str())
                .collect();
            if columns.is_empty() {
                "Nothing else is missing that this campaign could show.".to_owned()
            } else {
                format!(
                    "Something is missing: the residual depends on {}, and no effect of the library explains it.",
                    columns.join(", ")
                )
            }
        }
    };
    format!("{first}{then}")
}

/// What to look at before anything else.
fn look_at(suspect: &Suspect) -> String {
    let then = suspect
        .error_then_n
        .map_or_else(String::new, |e| format!("; {e:.0} N if so"));
    let aside = if suspect.set_aside { ", set aside" } else { "" };
    format!(
        "Look at {} first (off by {:.0} N, usual are {:.0} N{aside}): {}{then}. ",
        suspect.what, suspect.error_n, suspect.usual_n, suspect.explanation
    )
}

fn residuals(
    work: &Work,
    null_model: &Model,
    null: &Fitted,
    full: &Model,
    fitted: &Fitted,
) -> Residuals {
    let data = work.train;
    let predicted = null_model.predict(null, false);
    let after = full.predict(fitted, false);
    let minus = |f: &[f64]| {
        data.force
            .iter()
            .zip(f)
            .map(|(y, f)| y - f)
            .collect::<Vec<f64>>()
    };
    Residuals {
        session: data
            .session
            .iter()
            .map(|s| data.sessions[*s].clone())
            .collect(),
        specimen: data
            .specimen
            .iter()
            .map(|k| data.specimens[*k].clone())
            .collect(),
        before: minus(&predicted),
        after: minus(&after),
        columns: questions::columns(data, &predicted)
            .into_iter()
            .map(|a| (a.name, a.values))
            .collect(),
        predicted,
    }
}

fn coefficients(
    work: &Work,
    null: &Fitted,
    full: &Model,
    fitted: &Fitted,
    uncertain: &[Uncertainty],
) -> Vec<CoefficientChange> {
    let layout = full.layout();
    let published = new::NewPublished.coefficients(work.group.diameter_mm);
    work.base
        .coefficients
        .iter()
        .enumerate()
        .map(|(k, c)| {
            let place = layout.iter().position(|p| *p == Place::Base(k));
            let half = place.map_or(0.0, |i| uncertain[i].half_width());
            let after = fitted.base[k];
            let (low, high) = c.bounds;
            let remark = if !c.free {
                "held"
            } else if after <= low || after >= high {
                "at its bound: not needed"
            } else if c.name == "1/b2" && after - half <= low {
                "interval reaches 0: the dependence on the resting length is not needed"
            } else {
                ""
            };
            let value = |symbol: &str| {
                published
                    .iter()
                    .find(|p| p.symbol == symbol)
                    .map(|p| p.value)
            };
            CoefficientChange {
                name: c.name.clone(),
                unit: c.unit.clone(),
                before: null.base[k],
                after,
                ci_low: after - half,
                ci_high: after + half,
                published: if c.name == "1/b2" {
                    value("b2").map(|b| 1.0 / b)
                } else {
                    value(&c.name)
                },
                remark: remark.to_owned(),
            }
        })
        .collect()
}

/// A number to three significant digits with its unit; a pure number has none.
fn with_unit(value: f64, unit: &str) -> String {
    let digits = if value == 0.0 {
        0
    } else {
        2 - libm::floor(libm::log10(value.abs())) as i32
    };
    let number = format!("{value:.*}", digits.clamp(0, 6) as usize);
    if unit == "1" {
        number
    } else {
        format!("{number} {unit}")
    }
}

/// Base with and without its dependence on the resting length, each without effects, with those found, and with the one effect beside
/// which the dependence is needed least: neither is kept out of habit.
fn readings_of_the_base(work: &Work, search: &Search) -> Vec<Reading> {
    let Some(reduced) = work.base.without_length_law() else {
        return Vec::new();
    };
    let bases: [(&Base, &str); 2] = [
        (work.base, "F_620 depends on l_rest"),
        (&reduced, "F_620 constant"),
    ];
    let physical: Vec<Term> = work
        .best
        .chosen
        .iter()
        .map(|c| work.candidates[*c].clone())
        .filter(|t| t.id().is_some())
        .collect();
    let mut sets = vec![Vec::new()];
    if !physical.is_empty() {
        sets.push(physical.clone());
    }
    if work
        .questions
        .iter()
        .any(|q| q.p_adjusted < super::WORTH_ASKING)
    {
        for _ in 0..MOST_MORE {
            let from = sets.last().cloned().unwrap_or_default();
            let Some(more) = beside_no_law(work, search, &reduced, &from) else {
                break;
            };
            sets.push(more);
        }
    }
    let both = |terms: &Vec<Term>| {
        bases.map(|(base, words)| reading(work, search, base, words, terms.clone()))
    };
    sets.iter().flat_map(both).collect()
}

/// Some effects and one more, beside which a constant F_620 has the smallest held-out error, if that is clearly smaller than without it.
fn beside_no_law(
    work: &Work,
    search: &Search,
    reduced: &Base,
    physical: &[Term],
) -> Option<Vec<Term>> {
    let whole =
        |t: &&Term| t.scope == Scope::Whole && t.id().is_some() && !super::between::is_between(t);
    let found: BTreeSet<Option<&str>> = physical.iter().map(Term::id).collect();
    let with =
        |more: Option<&Term>| -> Vec<Term> { physical.iter().chain(more).cloned().collect() };
    let error = |terms: Vec<Term>| {
        reading(work, search, reduced, "", terms)
            .errors
            .rmse_heldout
    };
    let mut seen = BTreeSet::new();
    let candidates =
        work.candidates.iter().filter(whole).filter(|t| {
            !found.contains(&t.id()) && seen.insert((t.id(), t.form().map(|f| f.name)))
        });
    // The error of every candidate would take long; the best by the trace are enough.
    let model = Model {
        base: reduced,
        data: search.data,
        terms: physical.to_vec(),
    };
    let fitted = model.fit(None, 1);
    let candidates: Vec<Term> = candidates.cloned().collect();
    let linear = super::linear::Linear::new(&model, &fitted, fitted.scatter, &candidates);
    let stand = linear.stand(&linear.all_sessions(), &[]);
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by(|a, b| {
        stand
            .gain(*b)
            .fall
            .total_cmp(&stand.gain(*a).fall)
            .then(a.cmp(b))
    });
    let best = order
        .into_iter()
        .take(MOST_TRIED)
        .map(|k| &candidates[k])
        .map(|t| (error(with(Some(t))), t))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 * AS_GOOD < error(with(None)) && physical.len() < super::model::MOST_TERMS)
        .then(|| with(Some(best.1)))
}

fn reading(work: &Work, search: &Search, base: &Base, words: &str, terms: Vec<Term>) -> Reading {
    let model = Model {
        base,
        data: search.data,
        terms: terms.clone(),
    };
    let fitted = model.fit(None, 1);
    let mut tally = Tally::default();
    for fold in work.folds {
        let train = work
            .all
            .select(&fold.train)
            .thinned(work.options.most_readings);
        let held = work.all.select(&fold.held_out);
        let here = Model {
            base,
            data: &train,
            terms: terms.clone(),
        };
        let fit = here.fit(Some(&fitted), 1);
        let there = Model {
            base,
            data: &held,
            terms: terms.clone(),
        };
        tally = tally.plus(Tally::of(&held.force, &there.predict(&fit, false)));
    }
    let numbers = terms.iter().zip(&fitted.terms).filter_map(|(t, (a, _))| {
        let form = t.form()?;
        (a.len() == 1).then(|| {
            let value = form.amplitude.absent + a[0];
            format!(
                "{} = {}",
                form.amplitude.name,
                with_unit(value, form.amplitude.unit)
            )
        })
    });
    let free = base.coefficients.iter().filter(|c| c.free).count();
    let ids: Vec<&str> = terms.iter().filter_map(Term::id).collect();
    Reading {
        model: if terms.is_empty() {
            format!("{words}, no effects")
        } else {
            format!("{words}, with {}", ids.join(" and "))
        },
        parameters: free + terms.iter().map(Term::parameters).sum::<usize>(),
        errors: super::errors(train_error(&model, &fitted), tally),
        numbers: numbers.collect(),
    }
}

/// Standard deviation of a reading about its neighbours in pressure from other logs of the same session and direction, N.
fn noise_floor(data: &Data, residuals: &[f64]) -> Option<f64> {
    let mut keyed: Vec<(usize, i64, f64, usize)> = (0..data.len())
        .map(|i| {
            (
                data.session[i],
                data.conditions[i].direction as i64,
                data.conditions[i].pressure_kpa,
                i,
            )
        })
        .collect();
    keyed.sort_by(|a, b| {
        a.0.cmp(&b.0)
            .then(a.1.cmp(&b.1))
            .then(a.2.total_cmp(&b.2))
            .then(a.3.cmp(&b.3))
    });
    let near = |w: &[(usize, i64, f64, usize)]| {
        let (a, b) = (&w[0], &w[1]);
        a.0 == b.0 && a.1 == b.1 && (a.2 - b.2).abs() < 15.0 && data.log[a.3] != data.log[b.3]
    };
    let squares: Vec<f64> = keyed
        .windows(2)
        .filter(|w| near(w))
        .map(|w| {
            let d = residuals[w[0].3] - residuals[w[1].3];
            0.5 * d * d
        })
        .collect();
    (squares.len() >= 10).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// The best candidates that were not chosen, by what they would explain of the base model's residual.
fn rivals(search: &Search, work: &Work) -> Vec<Rejected> {
    let model = search.model(&[]);
    let linear = super::linear::Linear::new(
        &model,
        &work.null.fitted,
        work.null.fitted.scatter,
        search.candidates,
    );
    let stand = linear.stand(&linear.all_sessions(), &[]);
    let named: BTreeSet<String> = work
        .best
        .chosen
        .iter()
        .map(|c| judge::name(&search.candidates[*c], search.data))
        .collect();
    let mut gains: Vec<(f64, usize)> = (0..search.candidates.len())
        .filter(|c| search.candidates[*c].scope == Scope::Whole)
        .filter(|c| !named.contains(&judge::name(&search.candidates[*c], search.data)))
        .map(|c| (stand.gain(c).fall / stand.left.max(f64::MIN_POSITIVE), c))
        .filter(|(share, _)| *share > 0.01)
        .collect();
    gains.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut seen = BTreeSet::new();
    gains
        .into_iter()
        .filter(|(_, c)| seen.insert(judge::name(&search.candidates[*c], search.data)))
        .take(8)
        .map(|(share, c)| Rejected {
            id: judge::name(&search.candidates[c], search.data),
            acts_on: judge::acts_on(&search.candidates[c], search.data),
            share,
            why: if work.best.chosen.is_empty() {
                "explains too little, or not surely"
            } else {
                "explains less than what was chosen, or nothing beside it"
            }
            .to_owned(),
        })
        .collect()
}

fn next(effects: &[EffectFinding], limits: &Limits, readings: &[Reading]) -> Vec<NextMeasurement> {
    let measurement = |id: &str| effects::index(id).map_or("", |k| effects::all()[k].measurement());
    let mut list: Vec<NextMeasurement> = effects
        .iter()
        .filter(|e| e.class.len() > 1)
        .map(|e| NextMeasurement {
            separates: e.class.clone(),
            action: e
                .class
                .iter()
                .map(|id| format!("{id}: {}", measurement(id)))
                .collect::<Vec<String>>()
                .join("; "),
            difference_n: None,
        })
        .collect();
    let single = effects.iter().filter(|e| e.class.len() == 1);
    list.extend(single.map(|e| NextMeasurement {
        separates: vec![e.id.clone(), "every other explanation".to_owned()],
        action: e.measurement.clone(),
        difference_n: None,
    }));
    let error = |r: &&Reading| r.errors.rmse_heldout;
    let least = |constant: bool| {
        let kind = readings
            .iter()
            .filter(|r| r.model.starts_with("F_620 constant") == constant);
        kind.min_by(|a, b| error(a).total_cmp(&error(b)))
    };
    if let (Some(law), Some(constant)) = (least(false), least(true))
        && constant.errors.rmse_heldout < AS_GOOD * law.errors.rmse_heldout
    {
        list.push(NextMeasurement {
            separates: vec![law.model.clone(), constant.model.clone()],
            action: "measure one actuator at two frame lengths, or on a stiffer frame; put a dial gauge on the crossmember; hang a dead weight in \
                     place of the actuator"
                .to_owned(),
            difference_n: None,
        });
    }
    list.extend(
        limits
            .aliases
            .iter()
            .take(3)
            .filter(|a| !list_has(effects, a))
            .map(|a| NextMeasurement {
                separates: a.ids.to_vec(),
                action: a
                    .ids
                    .iter()
                    .map(|id| format!("{id}: {}", measurement(id)))
                    .collect::<Vec<String>>()
                    .join("; "),
                difference_n: None,
            }),
    );
    list
}

fn list_has(effects: &[EffectFinding], alias: &super::findings::Alias) -> bool {
    effects
        .iter()
        .any(|e| alias.ids.iter().all(|id| e.class.contains(id)))
}

fn notes(work: &Work) -> Vec<String> {
    let mut notes = Vec::new();
    if work.passed_over > 0 {
        notes.push(format!(
            "{} readings for which the base model has no force took no part",
            work.passed_over
        ));
    }
    if work.train.len() > work.options.most_readings {
        notes.push(format!(
            "The search saw {} of {} readings, an equal share of each session; errors and intervals are those of all.",
            work.train.thinned(work.options.most_readings).len(),
            work.train.len()
        ));
    }
    notes
}
