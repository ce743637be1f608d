//! `summary.json`: what a run was made of and what it says, for other programs.

use crate::input::{GroupInput, ReportInput};
use crate::left_out::LeftOut;
use crate::opening::SHOWN;
use crate::residual::{better_law_alone, published_n};
use crate::wording::sentence::sentences;
use pipeline_base::error::{Error, Result};
use pipeline_base::reject::Extent;
use pipeline_base::row;
use pipeline_compare::{COMMON, GroupComparison, NEW};
use pipeline_findings::CampaignFindings;
use serde_json::json;
use std::collections::BTreeMap;

/// `summary.json`: versions, digest of the inputs, sessions used and rejected with reasons, verdicts, paths of the tables, what could not be
/// built.
pub(crate) fn summary(input: &ReportInput, left_out: &[LeftOut]) -> Result<Vec<u8>> {
    let mut rejected: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (name, diagnostics) in &input.unusable {
        rejected.insert(name, diagnostics.iter().map(ToString::to_string).collect());
    }
    for reject in input.sessions.iter().flat_map(|s| s.rejects()) {
        if reject.extent == Extent::Session {
            rejected
                .entry(&reject.session)
                .or_default()
                .push(reject.reason.clone());
        }
    }
    let used = input
        .sessions
        .iter()
        .map(|s| &s.ingest.session)
        .filter(|s| !rejected.contains_key(s.id.as_str()));
    let tests = input.torque().iter().flat_map(|c| &c.configurations);
    let tests: Vec<_> = tests.flat_map(|c| &c.tests).collect();
    let session = |s: &pipeline_base::session::Session| {
        let doubtful = tests.iter().find(|t| t.session == s.id);
        let doubtful = doubtful.and_then(|t| t.doubtful.as_ref());
        json!({
            "id": s.id, "campaign": s.campaign, "kind": row::kind_name(s.kind), "simulated": s.is_simulated(), "exclude": s.exclude,
            "doubtful": doubtful, "usual_zero_n": input.usual_zeros.get(&s.id),
        })
    };
    let logs: Vec<_> = input
        .sessions
        .iter()
        .flat_map(|s| s.rejects())
        .filter(|r| r.extent == Extent::Log)
        .map(|r| json!({ "session": r.session, "log": r.log, "reason": r.reason }))
        .collect();
    let verdicts: Vec<_> = input.all_findings().map(verdict_json).collect();
    let summary = json!({
        "schema": "bpa-summary/1",
        "version": env!("CARGO_PKG_VERSION"),
        "input": input.input_digest,
        "sessions_used": used.map(session).collect::<Vec<_>>(),
        "sessions_rejected": rejected.iter().map(|(id, why)| json!({ "session": id, "reasons": why })).collect::<Vec<_>>(),
        "sessions_implausible": input.implausible,
        "logs_rejected": logs,
        "readings": input.rows.len(),
        "findings": "findings.json",
        "verdicts": verdicts,
        "models": input.groups.iter().filter_map(models_json).collect::<Vec<_>>(),
        "tables": input.tables,
        "left_out": left_out,
    });
    let mut bytes = serde_json::to_vec_pretty(&summary).map_err(Error::internal)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// The answer of one campaign, pool or joint in `summary.json`.
fn verdict_json(found: &CampaignFindings) -> serde_json::Value {
    json!({
        "campaign": found.campaign, "part": found.part, "diameter_mm": found.diameter_mm, "kind": found.kind,
        "verdict": found.verdict, "unit": found.unit,
        "rmse_heldout_before": found.before.rmse_heldout, "rmse_heldout_after": found.after.rmse_heldout,
        "expected_rmse_heldout": found.expected_rmse_heldout, "sentences": sentences(found),
    })
}

/// The models of the first page on the readings that all of them answer, of one group in `summary.json`; none where no model stands beside the new one.
fn models_json(input: &GroupInput) -> Option<serde_json::Value> {
    let GroupComparison {
        group, comparisons, ..
    } = &input.comparison;
    let of = |model: &str, split: &str| {
        let mut all = comparisons.iter();
        all.find(|c| c.model == model && c.split == split)
    };
    let new = of(NEW, COMMON)?;
    let shown = SHOWN.iter().filter_map(|model| of(model, COMMON));
    let errors: Vec<_> = shown
        .filter_map(|c| Some(json!({ "model": c.model, "rmse": c.rmse? })))
        .collect();
    (errors.len() > 1).then(|| {
        json!({
            "campaign": group.campaign, "diameter_mm": group.diameter_mm, "is_pool": group.is_pool(), "readings": new.n,
            "of": of(NEW, "loso").map(|c| c.n + c.n_excluded), "rmse_n": errors,
            "better_law_alone": better_law_alone(input),
            "published_n": published_n(input),
        })
    })
}
