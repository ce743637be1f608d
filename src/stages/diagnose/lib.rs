#![warn(missing_docs)]
//! Diagnose: where does the error of the base model come from, and what does the law lack?
//!
//! One mixed model of a campaign ([`problem`]) and what is asked of it ([`pipeline_inference`]). Nobody tells this stage what is in the data.
//! For each campaign and diameter, and each small pool of campaigns of one diameter:
//!
//! 1. [`data`]: the readings with everything that is known of each ([`labels`] are words); [`base`]: the law to which effects are added.
//!    [`recording`]: sessions and specimens that look mistaken beside what all readings show are set aside and reported.
//! 2. [`library`]: the terms that may be added: forms of effects, and smooth functions of columns.
//! 3. The null model has the gain of each specimen, the set length and the zero of the force of each session, and a smooth misfit of the law.
//!    The search tests every term against the maximum over all of them in draws from it ([`pipeline_inference::search`]).
//! 4. [`unseen`]: the same search without each specimen; [`tally`]: errors, predictive intervals, the budget of the expected error.
//! 5. [`form`]: whether one number is enough for the size of what was found.
//! 6. [`limits`]: what could have been seen, and what is indistinguishable. [`answer`]: the [`pipeline_findings`], as values.
//!
//! The numbers that decide stand in [`decisions`], those that say what is plausible in [`settings`], each with its reason. No rule names an effect.
//!
//! Deliberately absent: sentences, and knowledge of how a campaign was made. The stage sees rows.

pub mod answer;
pub mod base;
pub mod bent;
pub mod black_box;
pub mod data;
pub mod form;
pub mod labels;
pub mod library;
pub mod limits;
pub mod next;
pub mod problem;
pub mod recording;
pub mod settings;
pub mod slack;
pub mod smooth;
pub mod steps;
pub mod tally;
pub mod unseen;

use answer::Work;
use base::Base;
use data::Data;
use library::What;
use pipeline_base::random::Stream;
use pipeline_base::row::Row;
use pipeline_base::session::Role;
use pipeline_config::{DiagnoseOptions, FitOptions};
use pipeline_findings::{
    CampaignFindings, Design, EffectFinding, Errors, FreeForm, HeldOutBy, Level, Misfit,
    NotAssessed, RecordingError, Residuals, Verdict,
};
use pipeline_fit::{Group, is_fitted, is_usable};
use pipeline_inference::decisions;
use pipeline_inference::fit::{Fitted, Setting};
use pipeline_inference::screen::Normal;
use pipeline_inference::search::{Decision, Found, Search};
use pipeline_mechanics::effects::{self, Conditions};
use problem::ForceProblem;
use rayon::prelude::*;
use recording::Law;
use std::collections::{BTreeMap, BTreeSet};

/// Raised when results change without a change of this stage's source files.
pub const VERSION: u32 = 2;

/// The answer for one campaign, and its residuals for the figures.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The answer.
    pub findings: CampaignFindings,
    /// One entry a reading.
    pub residuals: Residuals,
}

/// Searches the rows of a group; none where the base model has no value for any of them.
pub fn diagnose(
    group: &Group,
    rows: &[Row],
    fit: &FitOptions,
    options: &DiagnoseOptions,
) -> Option<Diagnosis> {
    let searched = |r: &&Row| is_usable(r) && (is_fitted(r) || r.role == Some(Role::Holdout));
    let rows: Vec<&Row> = rows.iter().filter(searched).collect();
    let base = base_model(group, &rows, fit, options)?;
    let answered: Vec<&Row> = rows
        .iter()
        .copied()
        .filter(|r| base_answers(&base, r))
        .collect();
    if answered.is_empty() {
        return None;
    }
    let outside = rows.len() - answered.len();
    let judged = judged(&answered);
    let beside_law = mistakes_among(group, &Law::new(&base), &judged);
    let campaign = Campaign {
        group,
        base: &base,
        rows: &answered,
        outside,
        judged: &judged,
        beside_law: &beside_law,
        options,
    };
    // What all sessions share shows most in those that are measured where it is largest: if it explains what looks mistaken beside the law alone,
    // nothing is set aside.
    let (mut mistakes, mut again) = match campaign.assessed(&[], true) {
        Answer::Given(diagnosis) => return Some(*diagnosis),
        Answer::OtherMistakes(fewer) if is_part(&fewer, &beside_law) => (fewer, false),
        Answer::OtherMistakes(_) => (beside_law.clone(), true),
    };
    loop {
        match campaign.assessed(&mistakes, again) {
            Answer::Given(diagnosis) => return Some(*diagnosis),
            Answer::OtherMistakes(others) => (mistakes, again) = (others, false),
        }
    }
}

/// Groups that look mistaken.
fn groups_of(mistakes: &[RecordingError]) -> BTreeSet<&str> {
    mistakes.iter().map(|m| m.group.as_str()).collect()
}

/// Whether some mistakes are among others, and fewer.
fn is_part(mistakes: &[RecordingError], of: &[RecordingError]) -> bool {
    let (part, whole) = (groups_of(mistakes), groups_of(of));
    part.len() < whole.len() && part.is_subset(&whole)
}

/// What looks mistaken beside a law among the sessions that are searched.
fn mistakes_among(group: &Group, law: &Law, data: &Data) -> Vec<RecordingError> {
    if data.len() < decisions::FEWEST_READINGS || data.specimens.len() < decisions::FEWEST_SPECIMENS
    {
        return Vec::new();
    }
    recording::recording_errors(group.diameter_mm, law, data)
}

/// The readings whose sessions and specimens may be mistaken: those that are searched.
fn judged(rows: &[&Row]) -> Data {
    let searched = rows.iter().filter(|r| r.role != Some(Role::Holdout));
    let searched: Vec<&Row> = searched.copied().collect();
    Data::new(&searched)
}

/// The rows without what is set aside.
fn without_mistakes<'a>(mistakes: &[RecordingError], rows: &[&'a Row]) -> Vec<&'a Row> {
    let searched = rows.iter().filter(|r| r.role != Some(Role::Holdout));
    let campaigns: BTreeSet<&str> = searched.map(|r| r.campaign.as_str()).collect();
    let is_aside = |row: &&&Row| {
        mistakes.iter().any(|m| match m.level {
            Level::Specimen => {
                m.set_aside && m.group == data::specimen_id(row, campaigns.len() > 1)
            }
            _ => m.set_aside && m.group == row.session,
        })
    };
    rows.iter().filter(|r| !is_aside(r)).copied().collect()
}

/// The readings of a group, to be assessed.
struct Campaign<'a> {
    group: &'a Group,
    base: &'a Base,
    rows: &'a [&'a Row],
    /// Rows that the base law has no value for.
    outside: usize,
    /// The readings among which mistakes are looked for.
    judged: &'a Data,
    /// What looks mistaken beside the base law.
    beside_law: &'a [RecordingError],
    options: &'a DiagnoseOptions,
}

/// What comes of an assessment.
enum Answer {
    Given(Box<Diagnosis>),
    /// Beside the effects that were found, other sessions look mistaken than were set aside.
    OtherMistakes(Vec<RecordingError>),
}

impl Campaign<'_> {
    /// The search without what is set aside, and everything that is asked of its result; `again` if mistakes may be judged anew beside it.
    fn assessed(&self, mistakes: &[RecordingError], again: bool) -> Answer {
        let rows = without_mistakes(mistakes, self.rows);
        let data = Data::new(&rows)
            .beside(self.base)
            .with_placebo(self.options.seed)
            .thinned(self.options.most_readings);
        let held_out = rows.iter().filter(|r| r.role == Some(Role::Holdout));
        let kept_out: BTreeSet<&str> = held_out.map(|r| r.session.as_str()).collect();
        let mut findings = unassessed(self.group, self.base, &data, self.outside, &kept_out);
        findings.recording_errors = mistakes.to_vec();
        if let Some(reason) = too_few(&data, &kept_out) {
            return not_assessed(reason, findings);
        }
        let library = library::terms(&data);
        let (problem, null) = suited(self.base, &data, &library, &kept_out);
        if !null.log_likelihood.is_finite() {
            return if again && groups_of(self.beside_law) != groups_of(mistakes) {
                Answer::OtherMistakes(self.beside_law.to_vec())
            } else {
                not_assessed(NotAssessed::NoConvergence, findings)
            };
        }
        let normal = draws("draw", self.options.seed);
        let (problem, found) = self.searched(problem, null, &kept_out, &normal);
        if again {
            let others = self.mistakes_beside(&problem, &found);
            if groups_of(&others) != groups_of(mistakes) {
                return Answer::OtherMistakes(others);
            }
        }
        let searched = Searched {
            problem: &problem,
            setting: &part_of(&problem, &kept_out),
            decision: self.decision(),
            found: &found,
            normal: &normal,
        };
        let mut diagnosis = answered(self.group, self.base, &searched, self.options, findings);
        let residuals = &mut diagnosis.residuals;
        let of = data.place.iter().map(|place| rows[*place]);
        (residuals.log, residuals.row) = of.map(|r| (r.log.clone(), r.first_row)).unzip();
        Answer::Given(Box::new(diagnosis))
    }

    fn decision(&self) -> Decision {
        Decision {
            level: decisions::LEVEL,
            draws: self.options.draws,
            alike: decisions::ALIKE,
            most_terms: self.options.most_effects,
            thorough: true,
        }
    }

    /// What a search finds, and the problem that it was made of: with declared standard deviations estimated, if what was found contradicts them.
    fn searched<'p>(
        &self,
        problem: ForceProblem<'p>,
        null: Fitted,
        kept_out: &BTreeSet<&str>,
        normal: &Normal,
    ) -> (ForceProblem<'p>, Found) {
        let searched = |problem: &ForceProblem, null: Fitted| {
            let search = Search {
                setting: &part_of(problem, kept_out),
                decision: self.decision(),
                tried: None,
            };
            search.run(null, normal, None)
        };
        let found = searched(&problem, null);
        // An effect that was accepted beside too little scatter may be no more than the rest of that scatter.
        if !problem.contradicts_declared(&part_of(&problem, kept_out), &found.model) {
            return (problem, found);
        }
        let problem = problem.with_declared_estimated();
        let null = start(&part_of(&problem, kept_out));
        let found = searched(&problem, null);
        (problem, found)
    }

    /// What looks mistaken beside the law with what was found.
    fn mistakes_beside(&self, problem: &ForceProblem, found: &Found) -> Vec<RecordingError> {
        let law = law_found(self.base, self.judged, problem, found);
        if law.is_bare() {
            self.beside_law.to_vec()
        } else {
            mistakes_among(self.group, &law, self.judged)
        }
    }
}

/// Why readings are too few to be searched.
fn too_few(data: &Data, kept_out: &BTreeSet<&str>) -> Option<NotAssessed> {
    let searched = data.session.iter();
    let searched = searched.filter(|s| !kept_out.contains(data.sessions[**s].as_str()));
    if searched.count() < decisions::FEWEST_READINGS {
        Some(NotAssessed::TooFewReadings)
    } else if data.specimens.len() < decisions::FEWEST_SPECIMENS {
        Some(NotAssessed::TooFewSpecimens)
    } else {
        None
    }
}

fn not_assessed(reason: NotAssessed, findings: CampaignFindings) -> Answer {
    Answer::Given(Box::new(Diagnosis {
        findings: CampaignFindings {
            not_assessed: Some(reason),
            ..findings
        },
        residuals: Residuals::default(),
    }))
}

/// Standard normal numbers by draw, for one question.
fn draws(question: &'static str, seed: u64) -> impl Fn(usize) -> Box<dyn FnMut() -> f64> + Sync {
    move |k| {
        let mut stream = Stream::new(seed, &[question, &k.to_string()]);
        Box::new(move || stream.normal())
    }
}

/// The law with what was found on all readings, for the data that is judged.
fn law_found<'a>(base: &'a Base, judged: &Data, problem: &ForceProblem, found: &Found) -> Law<'a> {
    let terms = found.model.point.terms.iter();
    let whole = terms.filter(|(t, _)| problem.library[*t].scope == library::Scope::All);
    whole.fold(Law::new(base), |law, (t, values)| {
        let what = match problem.library[*t].what {
            What::Column(column) => column.of(problem.data, judged).map(What::Column),
            effect @ What::Effect { .. } => Some(effect),
        };
        match what {
            Some(what) => law.with(what, values),
            None => law,
        }
    })
}

/// A search that is done.
struct Searched<'a> {
    problem: &'a ForceProblem<'a>,
    setting: &'a Setting<'a>,
    decision: Decision,
    found: &'a Found,
    normal: &'a Normal<'a>,
}

/// Everything that is asked of the result of a search.
fn answered(
    group: &Group,
    base: &Base,
    searched: &Searched,
    options: &DiagnoseOptions,
    mut findings: CampaignFindings,
) -> Diagnosis {
    let Searched {
        problem,
        setting,
        decision,
        found,
        normal,
    } = *searched;
    let (library, data) = (problem.library, problem.data);
    let name = |t: usize| match library[t].what {
        library::What::Column(column) => column.name(data),
        library::What::Effect { effect, .. } => effects::all()[effect].id().to_owned(),
    };
    let held = unseen::held_out(setting, problem, found, decision, normal, name);
    let forms = free_forms(setting, problem, &found.model, options);
    let work = Work {
        diameter_mm: group.diameter_mm,
        base,
        problem,
        setting,
        found,
        held: &held,
        forms: &forms,
        smallest_n: options.smallest_effect_n,
        normal,
    };
    let residuals = work.residuals();
    let variances = found.model.restricted(setting);
    let limits = limits::limits(setting, problem, &found.model, found.critical);
    findings.effects = work.effects();
    findings.unexplained = work.unexplained();
    findings.verdict = verdict(&findings.effects, !findings.unexplained.is_empty());
    findings.scatter = work.scatter(&variances);
    findings.misfit = Some(Misfit {
        sensitive: work.sensitive(),
        ..answer::misfit(&variances, problem)
    });
    findings.before = Errors {
        rmse_train: Some(work.error_in_sample(&found.null)),
        ..held.before.clone()
    };
    findings.after = Errors {
        rmse_train: Some(work.error_in_sample(&found.model)),
        ..held.after.clone()
    };
    findings.next_measurement = next::next(setting, problem, found, &held.budget);
    findings.noise = Some(problem.noise_of(&variances));
    findings.tested = work.tested();
    findings.coefficients = work.coefficients();
    findings.alternatives = alternatives(problem, setting, found, base);
    findings.black_box_rmse_heldout = unseen::black_box(setting, problem, &residuals.predicted);
    put_limits(&mut findings, limits);
    put_held_out(&mut findings, held);
    Diagnosis {
        findings,
        residuals,
    }
}

/// What could have been seen. What cannot be seen while it is small may have been found, or stand beside what was.
fn put_limits(findings: &mut CampaignFindings, limits: limits::Limits) {
    findings.detection_limits = limits.smallest;
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

/// A problem without the sessions that are kept out.
fn part_of<'a>(problem: &'a ForceProblem, kept_out: &BTreeSet<&str>) -> Setting<'a> {
    let nodes = problem.sessions.iter().zip(&problem.data.sessions);
    nodes
        .filter(|(_, id)| kept_out.contains(id.as_str()))
        .fold(Setting::new(problem), |part, (node, _)| part.without(*node))
}

/// The problem with the floor of the misfit under which the readings are most likely, and with a misfit of every stroke where they show it;
/// and its model without any effect.
pub fn suited<'a>(
    base: &'a Base,
    data: &'a Data,
    library: &'a [library::Term],
    kept_out: &BTreeSet<&str>,
) -> (ForceProblem<'a>, Fitted) {
    let with_null = |problem: ForceProblem<'a>| {
        let null = start(&part_of(&problem, kept_out));
        (problem, null)
    };
    // Whether strokes differ is asked first: their misfit has the same scale, and without it another floor would be the likelier one.
    let plain = with_null(ForceProblem::new(base, data, library).with_reference());
    let stroked = plain.0.with_strokes().map(with_null);
    let gain = |(_, null): &(ForceProblem, Fitted)| null.log_likelihood - plain.1.log_likelihood;
    let mut best = match stroked {
        Some(stroked) if gain(&stroked) > decisions::ALIKE => stroked,
        _ => plain,
    };
    let others: Vec<(ForceProblem, Fitted)> = settings::OTHER_FLOORS
        .into_par_iter()
        .map(|share| with_null(best.0.with_floor(share)))
        .collect();
    for other in others {
        if other.1.log_likelihood > best.1.log_likelihood {
            best = other;
        }
    }
    best
}

/// The model without any effect.
fn start(setting: &Setting) -> Fitted {
    setting.fit_afresh(&setting.problem.start())
}

/// The verdict on what was found.
pub fn verdict(effects: &[EffectFinding], unexplained: bool) -> Verdict {
    if effects.iter().any(|e| !e.negligible) {
        Verdict::EffectFound
    } else if unexplained {
        Verdict::Unexplained
    } else {
        Verdict::None
    }
}

/// The error that a budget comes to; none without one.
pub fn expected(budget: &[pipeline_findings::BudgetEntry]) -> Option<f64> {
    let total: f64 = budget.iter().map(|b| b.variance).sum();
    (!budget.is_empty()).then(|| total.sqrt())
}

/// The law with and without its dependence on the resting length, and with and without a frame that yields: what a yielding frame and a
/// dependence on the length explain of one another.
fn alternatives(
    problem: &ForceProblem,
    setting: &Setting,
    found: &Found,
    base: &Base,
) -> Vec<pipeline_findings::Alternative> {
    let Some(short) = base.without_length_law() else {
        return Vec::new();
    };
    let other = problem.with_base(&short);
    let mut without = Setting::new(&other);
    without.active.clone_from(&setting.active);
    let frame = problem
        .library
        .iter()
        .position(|t| t.scope == library::Scope::All && t.is_frame());
    let Some(frame) = frame else {
        return Vec::new();
    };
    let mut list = Vec::new();
    for (law, yields) in [(false, false), (true, false), (false, true), (true, true)] {
        let setting = if law { setting } else { &without };
        let mut from = found.model.point.clone();
        from.terms.retain(|(t, _)| !problem.library[*t].is_frame());
        if !law {
            from.coefficients[base::LENGTH_LAW] = short.coefficients[base::LENGTH_LAW].start;
        }
        if yields {
            from.terms.push((frame, problem.library[frame].start(1.0)));
        }
        let fit = setting.fit(&from, std::slice::from_ref(&found.model.variances));
        list.push(answer::alternative(
            &fit,
            law,
            yields.then_some(frame),
            problem,
            unseen::of_model(setting, if law { problem } else { &other }, &fit),
        ));
    }
    let first = list.first().map_or(0.0, |a| a.log_likelihood);
    for a in &mut list {
        a.log_likelihood -= first;
    }
    list
}

/// The findings of a campaign of which nothing is said yet.
fn unassessed(
    group: &Group,
    base: &Base,
    data: &Data,
    outside: usize,
    kept_out: &BTreeSet<&str>,
) -> CampaignFindings {
    let held = |s: &&usize| kept_out.contains(data.sessions[**s].as_str());
    let held = data.session.iter().filter(held).count();
    CampaignFindings {
        campaign: group.campaign.clone(),
        part: None,
        diameter_mm: group.diameter_mm,
        simulated: group.simulated,
        kind: "isometric".to_owned(),
        base_model: base.id.clone(),
        base_refitted: base.coefficients.iter().any(|c| c.free),
        unit: "N".to_owned(),
        design: Design {
            readings: data.len() - held,
            readings_outside_domain: outside,
            sessions: data.sessions.len() - kept_out.len(),
            specimens: data.specimens.len(),
            readings_held_out: held,
            held_out_by: HeldOutBy::None,
            doubtful_only: false,
        },
        verdict: Verdict::NotAssessed,
        not_assessed: None,
        effects: Vec::new(),
        scatter: Vec::new(),
        misfit: None,
        unexplained: Vec::new(),
        recording_errors: Vec::new(),
        before: Errors::default(),
        after: Errors::default(),
        by_unit: Vec::new(),
        budget: Vec::new(),
        expected_rmse_heldout: None,
        inside_50: None,
        inside_95: None,
        pit: Vec::new(),
        noise: None,
        black_box_rmse_heldout: None,
        tested: Vec::new(),
        detection_limits: Vec::new(),
        not_measurable: Vec::new(),
        aliases: Vec::new(),
        next_measurement: Vec::new(),
        coefficients: Vec::new(),
        alternatives: Vec::new(),
    }
}

fn base_model(
    group: &Group,
    rows: &[&Row],
    fit: &FitOptions,
    options: &DiagnoseOptions,
) -> Option<Base> {
    let lengths: BTreeSet<u64> = rows.iter().map(|r| r.rest_length_m.to_bits()).collect();
    match options.base_model.as_str() {
        "new" => Some(Base::new(
            group.diameter_mm,
            options.refit,
            lengths.len(),
            fit,
        )),
        "new_published" => Some(Base::new(group.diameter_mm, false, lengths.len(), fit)),
        id => Base::published(id, options.refit),
    }
}

/// Whether the base model has a force for a row at all.
fn base_answers(base: &Base, row: &Row) -> bool {
    let mut at = Conditions::at(
        row.rest_length_m,
        row.contracted_length_m,
        row.length_m,
        row.pressure_kpa,
    );
    at.diameter_mm = row.diameter_mm;
    effects::force(base, &base.starts(), 1.0, &[], &at).is_finite()
}

#[cfg(test)]
mod tests {
    use super::problem::component;
    use super::*;
    use pipeline_inference::fit::Free;
    use pipeline_inference::problem::Problem;
    use pipeline_inference::profile::profile;
    use pipeline_simulate::rig_like;

    /// The scatter of set lengths of a campaign of which these standard deviations are declared, mm.
    fn scatter_of(declared_mm: f64) -> pipeline_findings::Scatter {
        let settings = rig_like::Settings {
            specimens: Some(4),
            ..rig_like::Settings::default()
        };
        let mut rows = rig_like::campaign(1, &settings).rows;
        for row in &mut rows {
            row.length_sd_m = 1e-3 * declared_mm;
        }
        let group = rig_like::group();
        let options = DiagnoseOptions::default();
        let found = diagnose(&group, &rows, &FitOptions::default(), &options).unwrap();
        let scatter = found.findings.scatter.into_iter();
        let mut of_lengths = scatter.filter(|s| s.id == "length_offset");
        let one = of_lengths.next().unwrap();
        assert!(of_lengths.next().is_none());
        one
    }

    #[test]
    fn a_declared_set_length_is_taken_and_contradicted_where_it_is_too_small() {
        // The sessions were set to 0.8 mm.
        let right = scatter_of(0.8);
        assert_eq!(right.declared, Some(0.8));
        assert!(!right.declared_contradicted);
        assert_eq!(right.values.len(), 16);
        let wrong = scatter_of(0.1);
        assert!(wrong.declared_contradicted);
        assert_eq!(wrong.declared, Some(0.1));
        assert!((0.5..1.3).contains(&wrong.sd), "{}", wrong.sd);
        // The interval is in mm as well, not in units of what was declared.
        let (low, high) = (wrong.ci_low.unwrap(), wrong.ci_high.unwrap());
        assert!(
            low < wrong.sd && wrong.sd < high && high < 3.0,
            "{low} {high}"
        );
    }

    #[test]
    fn at_the_ends_of_an_interval_the_likelihood_of_a_fit_has_fallen_alike() {
        // Size and time constant of a creep trade against each other: an interval with the time constant held would be too short.
        let settings = rig_like::Settings {
            specimens: Some(4),
            pace: rig_like::Pace::Dwell,
            effects: vec![rig_like::Put {
                id: "creep",
                form: "logarithm",
                size: 0.02,
                others: &[],
                from: 0.0,
            }],
            ..rig_like::Settings::default()
        };
        let rows = rig_like::campaign(3, &settings).rows;
        let rows: Vec<&Row> = rows.iter().collect();
        let data = Data::new(&rows);
        let base = Base::new(10, true, 4, &FitOptions::default());
        let library = library::terms(&data);
        let problem = ForceProblem::new(&base, &data, &library).with_reference();
        let setting = Setting::new(&problem);
        let creep = library.iter().position(|t| t.id() == Some("creep"));
        let mut from = problem.start();
        from.terms
            .push((creep.unwrap(), library[creep.unwrap()].start(0.02)));
        let model = setting.fit_afresh(&from);
        let normal = |k: usize| -> Box<dyn FnMut() -> f64> {
            let mut stream = Stream::new(1, &["profile", &k.to_string()]);
            Box::new(move || stream.normal())
        };
        let found = profile(&setting, &model, creep.unwrap(), 0, &normal).unwrap();
        let fallen = |size: f64| {
            let mut held = setting.clone();
            held.pinned.push(Free::Value(0, 0));
            let mut from = model.point.clone();
            from.terms[0].1[0] = size;
            let starts = [model.variances.clone(), setting.widened(&model.variances)];
            model.log_likelihood - held.fit(&from, &starts).log_likelihood
        };
        let ends = [found.low.unwrap(), found.high.unwrap()].map(fallen);
        assert!(ends.iter().all(|fall| *fall > 1.7), "{ends:?}");
        assert!((ends[0] - ends[1]).abs() < 0.15 * ends[0], "{ends:?}");
    }

    #[test]
    fn a_session_that_declares_nothing_takes_back_nothing_of_its_specimen() {
        let mut rows = rig_like::campaign(1, &rig_like::Settings::default()).rows;
        let first = rows[0].clone();
        let declaring = rows.iter_mut().filter(|r| r.session == first.session);
        declaring.for_each(|r| r.rest_length_sd_m = 1e-4);
        let rows: Vec<&Row> = rows.iter().collect();
        let data = Data::new(&rows);
        let place = data.specimens.iter().position(|s| *s == first.specimen);
        let [rest, contracted] = data.specimen_lengths_sd_mm[place.unwrap()];
        assert!((rest - 0.1).abs() < 1e-12);
        assert!(contracted.is_nan());
    }

    /// Two campaigns in one pool, the second of which is read with 8 N more noise and a load cell of 20% less: five times what the means of four specimens differ by.
    #[test]
    fn campaigns_of_a_pool_have_a_gain_and_a_noise_of_their_own() {
        let settings = rig_like::Settings {
            specimens: Some(4),
            ..rig_like::Settings::default()
        };
        let mut rows = rig_like::campaign(1, &settings).rows;
        let mut others = rig_like::campaign(2, &settings).rows;
        let mut stream = Stream::new(1, &["pool"]);
        for row in &mut others {
            row.campaign = "other".to_owned();
            row.session = format!("other {}", row.session);
            row.force_n = 0.8 * row.force_n + 8.0 * stream.normal();
        }
        rows.extend(others);
        let rows: Vec<&Row> = rows.iter().collect();
        let data = Data::new(&rows);
        assert_eq!((data.campaigns.len(), data.specimens.len()), (2, 8));
        let base = Base::new(10, true, 2, &FitOptions::default());
        let library = library::terms(&data);
        let problem = ForceProblem::new(&base, &data, &library).with_reference();
        let setting = Setting::new(&problem);
        let null = start(&setting);
        let other = data.campaigns.iter().position(|c| c == "other").unwrap();
        let noise = [1 - other, other].map(|c| null.variances.noise[c]);
        assert!((1.0..4.0).contains(&noise[0]), "{noise:?}");
        assert!((7.0..10.0).contains(&noise[1]), "{noise:?}");
        let both = problem.noise_of(&null.variances);
        assert!(noise[0] < both && both < noise[1], "{both}");
        let variances = null.restricted(&setting);
        let gain = variances.components[component::CAMPAIGN_GAIN];
        assert!((0.05..0.3).contains(&gain), "{gain}");
    }
}
