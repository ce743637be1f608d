//! From what was chosen to what is said.

mod effects;
mod next;
mod notes;
mod readings;
mod strengths;
pub(super) mod summary;
mod unexplained;
mod zero_logs;

use super::data::PLACEBO;
use super::findings::{
    CampaignFindings, CoefficientChange, EffectFinding, Errors, Question, Residuals, Unexplained,
    Verdict,
};
use super::folds::Tally;
use super::judge;
use super::limits::limits;
use super::model::{Fitted, Model, Place};
use super::search::{Search, State};
use super::term::{Term, What};
use super::uncertainty::{Uncertainty, uncertainties};
use super::{Former, Work, noise, questions, train_error};
use crate::models::{ForceModel, new};
use std::collections::BTreeSet;
use strengths::Strengths;

/// The base alone and with everything that was chosen, fitted to all readings that are searched.
struct Fits<'a> {
    null_model: Model<'a>,
    null: Fitted,
    full: Model<'a>,
    fitted: Fitted,
    uncertain: Vec<Uncertainty>,
}

impl<'a> Fits<'a> {
    /// `searched`: readings that the search saw.
    fn of(work: &'a Work, searched: usize) -> Self {
        let model = |terms: Vec<Term>| Model {
            base: work.base,
            data: work.train,
            terms,
        };
        let null_model = model(Vec::new());
        let full = model(chosen_terms(work));
        let fitted = full.fit(Some(&work.best.fitted), 1);
        // Readings that repeat each other stay so, however many there are.
        let searched = searched as f64;
        let readings = work.train.len() as f64;
        let effective = if work.best.effective < 0.9 * searched {
            work.best.effective
        } else {
            work.best.effective * readings / searched
        };
        Fits {
            null: null_model.fit(Some(&work.null.fitted), 1),
            uncertain: uncertainties(&full, &fitted, effective.min(readings), &[]),
            null_model,
            full,
            fitted,
        }
    }
}

fn chosen_terms(work: &Work) -> Vec<Term> {
    let chosen = work.best.chosen.iter();
    chosen.map(|c| work.candidates[*c].clone()).collect()
}

/// The answer.
pub(super) fn answer(work: &Work) -> Former {
    let thin = work.train.thinned(work.options.most_readings);
    let search = Search::new(
        work.base,
        &thin,
        work.candidates,
        work.options.most_effects,
        judge::SIGNIFICANT.0,
    );
    let fits = Fits::of(work, thin.len());
    let (full, fitted) = (&fits.full, &fits.fitted);
    let mut effects = effects::effects_found(work, &search, full, fitted, &fits.uncertain);
    let questions_after = questions_after(&search, &work.best, work);
    let mut unexplained = unexplained::unexplained(work, fitted, &questions_after, search.least_n);
    let mut notes = notes::notes(work);
    let by_zero_logs = zero_logs::zero_logs_say(&effects, &work.train.zero_pressures());
    match strengths::strengths(work, fitted, full) {
        Strengths::Usual => {}
        Strengths::Scatter(finding, note) => {
            effects.push(*finding);
            notes.extend(note);
        }
        Strengths::GoWith(column) => unexplained.push(column),
    }
    let verdict = verdict(work, &effects, &unexplained);
    let mut limits = limits(&search, &work.best);
    limits.not_measurable.retain(|n| {
        !effects
            .iter()
            .any(|e| e.id == n.id || e.class.contains(&n.id))
    });
    let errors = errors(work, &search, &fits);
    let readings_of_the_base = readings::readings_of_the_base(work, &search);
    let mut rejected = work.rejected.clone();
    rejected.extend(effects::rivals(&search, work));
    let mut summary = summary::summary(verdict, &effects, &unexplained, work, errors.as_chosen);
    if let Some(sentence) = by_zero_logs {
        summary = format!("{summary} {sentence}");
    }
    let next_measurement = next::next(
        &search,
        work,
        &effects,
        &unexplained,
        &limits,
        &readings_of_the_base,
    );
    let findings = CampaignFindings {
        campaign: work.group.campaign.clone(),
        part: None,
        diameter_mm: work.group.diameter_mm,
        simulated: work.group.simulated,
        kind: "isometric".to_owned(),
        base_model: work.base.id.clone(),
        base_refitted: work.base.coefficients.iter().any(|c| c.free),
        unit: "N".to_owned(),
        verdict,
        summary,
        readings: work.train.len(),
        sessions: work.train.session.iter().collect::<BTreeSet<_>>().len(),
        specimens: work.train.specimen.iter().collect::<BTreeSet<_>>().len(),
        readings_held_out: work.all.len() - work.train.len(),
        held_out_by: work.held_out_by.to_owned(),
        questions: work.questions.clone(),
        questions_after,
        next_measurement,
        effects,
        unexplained,
        suspects: notes::suspects(work, &fits),
        before: errors.before,
        after: errors.after,
        after_as_chosen: errors.as_chosen,
        after_empirical: errors.empirical,
        by_specimen: work.held.by_unit.clone(),
        noise_floor: noise::noise_floor(work.train, &fitted.residuals),
        black_box_rmse_heldout: work.held.black_box,
        black_box_after_rmse_heldout: work.held.black_box_after,
        rejected,
        detection_limits: limits.detection,
        not_measurable: limits.not_measurable,
        aliases: limits.aliases,
        readings_of_the_base,
        coefficients: coefficients(work, &fits.null, full, fitted, &fits.uncertain),
        notes,
    };
    Former {
        findings,
        residuals: residuals(work, &fits),
    }
}

/// Errors of the base, with the effects, and with the empirical terms too.
struct BeforeAfter {
    before: Errors,
    after: Errors,
    as_chosen: Option<Errors>,
    empirical: Option<Errors>,
}

fn errors(work: &Work, search: &Search, fits: &Fits) -> BeforeAfter {
    let of = |model: &Model, fitted: &Fitted, held: Tally| {
        super::errors(train_error(model, fitted), held)
    };
    let (physical, fitted) = physical_only(work, &fits.fitted);
    let found = !physical.terms.is_empty();
    let as_chosen = || readings::reading(work, search, work.base, "", physical.terms.clone());
    let empirical = |held: Tally| of(&fits.full, &fits.fitted, held);
    BeforeAfter {
        before: of(&fits.null_model, &fits.null, work.held.before),
        after: of(&physical, &fitted, work.held.after),
        as_chosen: found.then(|| as_chosen().errors),
        empirical: work.held.empirical.map(empirical),
    }
}

/// The base with the physical terms alone, fitted.
fn physical_only<'a>(work: &'a Work, fitted: &Fitted) -> (Model<'a>, Fitted) {
    let chosen = chosen_terms(work);
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

/// The questions again, of what is left.
fn questions_after(search: &Search, best: &State, work: &Work) -> Vec<Question> {
    let predicted = search.model(&best.chosen).predict(&best.fitted, true);
    let columns = questions::columns(search.data, &predicted);
    let mut list = questions::ask(
        search.data,
        &best.fitted.residuals,
        &columns,
        work.options.permutations,
        work.options.seed,
    );
    list.extend(noise::between_set_points(
        search.data,
        &best.fitted.residuals,
    ));
    list
}

fn verdict(work: &Work, effects: &[EffectFinding], unexplained: &[Unexplained]) -> Verdict {
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

fn residuals(work: &Work, fits: &Fits) -> Residuals {
    let data = work.train;
    let predicted = fits.null_model.predict(&fits.null, false);
    let after = fits.full.predict(&fits.fitted, false);
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
            .filter(|a| a.name != PLACEBO)
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
                "the interval reaches 0: these specimens do not show the dependence on the resting length by themselves"
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
