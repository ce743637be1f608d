//! One campaign, searched without what is set aside; if other sessions look mistaken beside what was found, that is the answer.

use crate::aside::{groups_of, law_found, mistakes_among, without_mistakes};
use crate::asked::{Searched, answered};
use crate::base::Base;
use crate::data::Data;
use crate::length_law::{Outcome, searched};
use crate::problem::ForceProblem;
use crate::suited::{Declared, part_of, suited};
use crate::unassessed::unassessed;
use crate::{Diagnosis, decision, draws, library};
use pipeline_base::row::Row;
use pipeline_base::session::Role;
use pipeline_config::DiagnoseOptions;
use pipeline_findings::{CampaignFindings, NotAssessed, RecordingError, Residuals};
use pipeline_fit::Group;
use pipeline_inference::decisions;
use pipeline_inference::fit::Fitted;
use pipeline_inference::screen::Normal;
use pipeline_inference::search::Found;
use std::collections::BTreeSet;

/// The readings of a group, to be assessed.
pub(crate) struct Campaign<'a> {
    pub(crate) group: &'a Group,
    pub(crate) base: &'a Base,
    /// The base law with and without its dependence on the resting length, by the readings alone; none where that is not fitted.
    pub(crate) laws: Option<&'a [Base; 2]>,
    pub(crate) rows: &'a [&'a Row],
    /// Rows that the base law has no value for.
    pub(crate) outside: usize,
    /// The readings among which mistakes are looked for.
    pub(crate) judged: &'a Data,
    /// What looks mistaken beside the base law.
    pub(crate) beside_law: &'a [RecordingError],
    pub(crate) options: &'a DiagnoseOptions,
}

/// What comes of an assessment.
pub(crate) enum Answer {
    Given(Box<Diagnosis>),
    /// Beside the effects that were found, other sessions look mistaken than were set aside.
    OtherMistakes(Vec<RecordingError>),
}

impl Campaign<'_> {
    /// The search without what is set aside, and everything that is asked of its result; `again` if mistakes may be judged anew beside it.
    pub(crate) fn assessed(&self, mistakes: &[RecordingError], again: bool) -> Answer {
        let rows = without_mistakes(mistakes, self.rows);
        let data = Data::new(&rows)
            .beside(self.base)
            .with_placebo(self.options.seed)
            .thinned(self.options.most_readings);
        let held_out = rows.iter().filter(|r| r.role == Some(Role::Holdout));
        let kept_out: BTreeSet<&str> = held_out.map(|r| r.session.as_str()).collect();
        let mut findings = unassessed(
            self.group,
            (self.base, self.options.draws),
            &data,
            self.outside,
            &kept_out,
        );
        findings.recording_errors = mistakes.to_vec();
        if let Some(reason) = too_few(&data, &kept_out) {
            return not_assessed(reason, findings);
        }
        let library = library::terms(&data);
        let (problem, null) = suited(self.base, &data, &library, &kept_out, Declared::Taken);
        if !null.log_likelihood.is_finite() {
            return if again && groups_of(self.beside_law) != groups_of(mistakes) {
                Answer::OtherMistakes(self.beside_law.to_vec())
            } else {
                not_assessed(NotAssessed::NoConvergence, findings)
            };
        }
        let normal = draws("draw", self.options.seed);
        let outcome = self.searched(problem, null, &kept_out, &normal);
        let Outcome { problem, found, .. } = &outcome;
        if again {
            let others = self.mistakes_beside(problem, found);
            if groups_of(&others) != groups_of(mistakes) {
                return Answer::OtherMistakes(others);
            }
        }
        let searched = Searched {
            outcome: &outcome,
            setting: &part_of(problem, &kept_out),
            decision: decision(self.options),
            normal: &normal,
        };
        let mut diagnosis = answered(self.group, self.base, &searched, self.options, findings);
        let residuals = &mut diagnosis.residuals;
        let of = data.place.iter().map(|place| rows[*place]);
        (residuals.log, residuals.row) = of.map(|r| (r.log.clone(), r.first_row)).unzip();
        Answer::Given(Box::new(diagnosis))
    }

    /// What a search finds: with declared standard deviations estimated, if what was found contradicts them.
    fn searched<'p>(
        &self,
        problem: ForceProblem<'p>,
        null: Fitted,
        kept_out: &BTreeSet<&str>,
        normal: &Normal,
    ) -> Outcome<'p>
    where
        Self: 'p,
    {
        let decision = decision(self.options);
        let outcome = searched(problem, null, self.laws, kept_out, decision, normal);
        let Outcome { problem, found, .. } = &outcome;
        // An effect that was accepted beside too little scatter may be no more than the rest of that scatter.
        if !problem.contradicts_declared(&part_of(problem, kept_out), &found.model) {
            return outcome;
        }
        let (data, library) = (problem.data, problem.library);
        let (problem, null) = suited(self.base, data, library, kept_out, Declared::Contradicted);
        searched(problem, null, self.laws, kept_out, decision, normal)
    }

    /// What looks mistaken beside the law with what was found.
    fn mistakes_beside(&self, problem: &ForceProblem, found: &Found) -> Vec<RecordingError> {
        let law = law_found(problem.base, self.judged, problem, found);
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
        mixed_law: None,
    }))
}
