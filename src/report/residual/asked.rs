//! What was asked of the residual, and what stays unexplained.

use super::words::{percent, perhaps};
use crate::report::answers::{SIGNIFICANT, p_words};
use crate::stages::diagnose::findings::{CampaignFindings, Question, Unexplained};
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct Asked {
    cells: [String; 6],
    significant: bool,
}

pub(super) fn questions(found: &CampaignFindings) -> Vec<Asked> {
    let mut list: Vec<&_> = found.questions.iter().collect();
    list.sort_by(|a, b| {
        a.p_adjusted
            .total_cmp(&b.p_adjusted)
            .then(b.share.total_cmp(&a.share))
    });
    let after = |q: &Question| {
        let same = found.questions_after.iter().find(|a| a.column == q.column);
        same.map_or_else(
            || "–".to_owned(),
            |a| p_words(a.p_adjusted).trim_start_matches("= ").to_owned(),
        )
    };
    let asked = |q: &&Question| Asked {
        cells: [
            q.column.clone(),
            q.blocks.clone(),
            percent(q.share),
            p_words(q.p).trim_start_matches("= ").to_owned(),
            p_words(q.p_adjusted).trim_start_matches("= ").to_owned(),
            after(q),
        ],
        significant: q.p_adjusted < SIGNIFICANT,
    };
    list.iter().map(asked).collect()
}

/// What stays unexplained; a session that was set aside is no dependence and stands among the suspects.
pub(super) fn unexplained(found: &CampaignFindings) -> Vec<[String; 6]> {
    let aside = |u: &&Unexplained| {
        let is = |what: &str| u.shape.starts_with(&format!("{what}: "));
        found.suspects.iter().any(|s| s.set_aside && is(&s.what))
    };
    let list = found.unexplained.iter().filter(|u| !aside(u));
    list.map(unexplained_column).collect()
}

fn unexplained_column(u: &Unexplained) -> [String; 6] {
    [
        u.column.clone(),
        u.shape.clone(),
        percent(u.share_of_residual),
        p_words(u.p_adjusted).trim_start_matches("= ").to_owned(),
        perhaps(u.rmse_heldout_before),
        perhaps(u.rmse_heldout_after),
    ]
}
