//! Everything that is asked of the result of a search.

use crate::alternatives::alternatives;
use crate::answer::{self, Work};
use crate::base::Base;
use crate::expected;
use crate::length_law::Outcome;
use crate::mixed_law::MixedLaw;
use crate::problem::ForceProblem;
use crate::{Diagnosis, draws, form, in_time, limits, next, unseen, verdict};
use pipeline_config::DiagnoseOptions;
use pipeline_findings::{CampaignFindings, Errors, FreeForm, Misfit};
use pipeline_fit::Group;
use pipeline_inference::fit::{Fitted, Setting};
use pipeline_inference::profile::Profiles;
use pipeline_inference::screen::Normal;
use pipeline_inference::search::Decision;
use pipeline_inference::system::Variances;
use std::collections::BTreeMap;

/// A search that is done.
pub(crate) struct Searched<'a> {
    pub(crate) outcome: &'a Outcome<'a>,
    pub(crate) setting: &'a Setting<'a>,
    pub(crate) decision: Decision,
    pub(crate) normal: &'a Normal<'a>,
}

/// Everything that is asked of the result of a search.
pub(crate) fn answered(
    group: &Group,
    base: &Base,
    searched: &Searched,
    options: &DiagnoseOptions,
    mut findings: CampaignFindings,
) -> Diagnosis {
    let Searched {
        outcome,
        setting,
        decision,
        normal,
    } = *searched;
    let Outcome { problem, found, .. } = outcome;
    let name = |t: usize| problem.library[t].name(problem.data);
    let held = unseen::held_out(outcome, setting, decision, normal, name);
    let forms = free_forms(setting, problem, &found.model, options);
    let work = Work {
        diameter_mm: group.diameter_mm,
        base,
        problem,
        setting,
        found,
        null: outcome.null(),
        held: &held,
        forms: &forms,
        smallest_n: options.smallest_effect_n,
        profiles: Profiles::new(setting, &found.model, normal),
    };
    let residuals = work.residuals();
    let variances = found.model.restricted(setting);
    let limits = limits::limits(setting, problem, &found.model, found.critical);
    put_model(&mut findings, &work, &variances);
    findings.next_measurement = next::next(setting, problem, found, &held.budget);
    findings.alternatives = alternatives(problem, setting, found, base);
    put_limits(&mut findings, limits);
    put_held_out(&mut findings, held);
    let mixed_law = MixedLaw::of(
        group,
        problem,
        setting,
        &found.model,
        &findings.effects,
        findings.after.rmse_heldout,
    );
    Diagnosis {
        findings,
        residuals,
        mixed_law,
    }
}

/// What the model has, and its errors without and with what was found.
fn put_model(findings: &mut CampaignFindings, work: &Work, variances: &Variances) {
    findings.effects = work.effects();
    findings.unexplained = work.unexplained();
    findings.verdict = verdict(&findings.effects, !findings.unexplained.is_empty());
    findings.scatter = work.scatter(variances);
    findings.noted_contractions = work.noted_contractions();
    findings.misfit = Some(Misfit {
        sensitive: work.sensitive(),
        ..answer::misfit(variances, work.problem)
    });
    let errors = |model: &Fitted, of_unseen: &Errors| Errors {
        rmse_train: Some(work.error_in_sample(model)),
        ..of_unseen.clone()
    };
    findings.before = errors(work.null, &work.held.before);
    findings.after = errors(&work.found.model, &work.held.after);
    findings.noise = Some(work.problem.noise_of(variances));
    findings.noise_in_time = in_time::noise_in_time(work.problem, work.setting, work.found);
    findings.tested = work.tested();
    findings.coefficients = work.coefficients();
}

/// What could have been seen. What cannot be seen while it is small may have been found, or stand beside what was.
fn put_limits(findings: &mut CampaignFindings, limits: limits::Limits) {
    findings.detection_limits = limits.smallest;
    findings.column_limits = limits.columns;
    findings.not_measurable = limits.not_measurable;
    let is_named = |id: &String| findings.effects.iter().any(|e| e.class.contains(id));
    findings.not_measurable.retain(|n| !is_named(&n.id));
    findings.aliases = limits.aliases;
}

/// What is known of unseen specimens, beside the errors.
fn put_held_out(findings: &mut CampaignFindings, held: unseen::HeldOut) {
    findings.design.held_out_by = held.by;
    findings.expected_rmse_heldout = expected(&held.budget);
    findings.inside_50 = held.inside.map(|i| i.0);
    findings.inside_95 = held.inside.map(|i| i.1);
    findings.pit = held.pit;
    findings.black_box_rmse_heldout = held.black_box_rmse;
    findings.by_unit = held.units;
    findings.budget = held.budget;
}

/// Whether one number is enough for the size of each effect, by term; the draws are the question's own.
fn free_forms(
    setting: &Setting,
    problem: &ForceProblem,
    model: &Fitted,
    options: &DiagnoseOptions,
) -> BTreeMap<usize, FreeForm> {
    let normal = draws("form", options.seed);
    form::free_forms(setting, problem, model, options.draws, &normal)
}
