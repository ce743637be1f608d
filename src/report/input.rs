//! Everything that a report is made of. Tables and figures read it and compute no statistic of their own.

use crate::explorer;
use crate::figures::Drawn;
use crate::figures::found::Kind;
use crate::left_out::LeftOut;
use crate::predictions::Predicted;
use pipeline_base::diagnostics::Diagnostic;
use pipeline_base::frame::Frame;
use pipeline_base::reject::Reject;
use pipeline_base::row::Row;
use pipeline_clean::CleanHeader;
use pipeline_compare::{GroupComparison, Predictions};
use pipeline_diagnose::Diagnosis;
use pipeline_findings::{CampaignFindings, RecordingError};
use pipeline_fit::GroupFit;
use pipeline_ingest::IngestHeader;
use pipeline_torque::CampaignTorque;
use pipeline_torque::reference::Reference;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One session as the stages left it.
#[derive(Clone, Debug)]
pub struct SessionInput {
    /// Of ingest.
    pub ingest: IngestHeader,
    /// Of clean.
    pub clean: CleanHeader,
    /// Of normalize.
    pub normalize_rejects: Vec<Reject>,
    /// Readings that are left.
    pub readings: usize,
}

impl SessionInput {
    /// Everything of this session that was left out, stage by stage.
    pub fn rejects(&self) -> impl Iterator<Item = &Reject> {
        self.ingest
            .rejects
            .iter()
            .chain(&self.clean.rejects)
            .chain(&self.normalize_rejects)
    }
}

/// One group of rows that were fitted together.
#[derive(Clone, Debug)]
pub struct GroupInput {
    /// The fit.
    pub fit: GroupFit,
    /// The comparison of models.
    pub comparison: GroupComparison,
    /// The rows with every model's prediction. Only its figures read them, group by group: those of a large laboratory do not fit into
    /// memory together, and in the report they are empty.
    pub predictions: Predictions,
    /// What the base model lacks; none for groups that were not asked.
    pub diagnosis: Option<Diagnosis>,
}

impl GroupInput {
    /// Sessions and specimens that the fit holds and that the search for effects set aside, because they look mistaken.
    pub fn doubtful(&self) -> impl Iterator<Item = &RecordingError> {
        let found = self.diagnosis.iter().map(|d| &d.findings);
        let all = found.flat_map(|f| &f.recording_errors);
        all.filter(|e| e.set_aside)
    }
}

/// The figures of one group, as drawn.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GroupFigures {
    /// Of the fit and the comparison.
    pub group: Vec<Drawn>,
    /// Of what was found in the residual.
    pub diagnosis: Vec<(Kind, Drawn)>,
}

/// The samples of one log, to be drawn.
#[derive(Clone, Debug)]
pub struct Trace {
    /// Session id.
    pub session: String,
    /// Campaign id.
    pub campaign: String,
    /// Log file.
    pub log: String,
    /// Whether the session is simulated.
    pub simulated: bool,
    /// Columns of the log as ingested.
    pub samples: Frame,
}

/// What was measured of torque, and what stands of the knees by themselves.
#[derive(Clone, Debug)]
pub struct KneeInput {
    /// By campaign id.
    pub campaigns: Vec<CampaignTorque>,
    /// What needs no session.
    pub reference: Reference,
}

/// Where the numbers of a session or of a group of rows come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    /// Session id, or the group's campaign and diameter.
    pub unit: String,
    /// "session", "fit" or "torque".
    pub kind: &'static str,
    /// Digest over what went in: the session as it was read, or the rows of a group.
    pub inputs: String,
    /// Digest over what came out: the session's rows, or the fit.
    pub outputs: String,
}

/// Everything that a report is made of.
#[derive(Clone, Debug)]
pub struct ReportInput {
    /// Sessions that cannot be used: id or folder, and every reason.
    pub unusable: Vec<(String, Vec<Diagnostic>)>,
    /// What is wrong with the raw tree itself.
    pub diagnostics: Vec<Diagnostic>,
    /// Usable sessions, by id.
    pub sessions: Vec<SessionInput>,
    /// What is taken off the force of sessions whose zero log holds a pull, N, by session.
    pub usual_zeros: BTreeMap<String, f64>,
    /// The rows of all sessions, by session.
    pub rows: Vec<Row>,
    /// What models and the residual search expect of the rows.
    pub predicted: Predicted,
    /// The groups, by campaign.
    pub groups: Vec<GroupInput>,
    /// The figures of each group; none of a group that has no section of its own ([`with_section`](crate::extent::with_section)).
    pub figures: Vec<Option<GroupFigures>>,
    /// The figures of groups that could not be built.
    pub left_out: Vec<LeftOut>,
    /// Files of the tables, below `reports/`.
    pub tables: Vec<String>,
    /// Torque; none where nobody measured any.
    pub knee: Option<KneeInput>,
    /// Ids of the sessions whose readings no such actuator gives; only the pages say so.
    pub implausible: Vec<String>,
    /// The logs to draw.
    pub traces: Vec<Trace>,
    /// The logs of the page for a browser, thinned.
    pub logs: Vec<explorer::trace::Trace>,
    /// Sessions, then groups.
    pub provenance: Vec<Provenance>,
    /// One digest over every input.
    pub input_digest: String,
}

impl ReportInput {
    /// The groups that have a section of their own, with their figures.
    pub fn with_section(&self) -> impl Iterator<Item = (&GroupInput, &GroupFigures)> {
        let both = self.groups.iter().zip(&self.figures);
        both.filter_map(|(group, figures)| Some((group, figures.as_ref()?)))
    }

    /// Everything that was found: campaigns and pools, then joints.
    pub fn all_findings(&self) -> impl Iterator<Item = &CampaignFindings> {
        self.findings().chain(self.torque_findings())
    }

    /// What was found of forces, campaign by campaign.
    pub fn findings(&self) -> impl Iterator<Item = &CampaignFindings> {
        let diagnoses = self.groups.iter().filter_map(|g| g.diagnosis.as_ref());
        diagnoses.map(|d| &d.findings)
    }

    /// What was found of torque, joint by joint.
    pub fn torque_findings(&self) -> impl Iterator<Item = &CampaignFindings> {
        self.torque()
            .iter()
            .flat_map(|c| &c.diagnoses)
            .map(|d| &d.findings)
    }

    /// The campaigns of torque.
    pub fn torque(&self) -> &[CampaignTorque] {
        self.knee.as_ref().map_or(&[], |k| &k.campaigns)
    }

    /// Whether a session's data are simulated, by its id.
    pub fn is_simulated(&self, session: &str) -> bool {
        self.sessions
            .iter()
            .any(|s| s.ingest.session.id == session && s.ingest.session.is_simulated())
    }
}
