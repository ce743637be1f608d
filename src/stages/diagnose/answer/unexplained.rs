//! What depends on a column and has no name in the library.

use super::super::data::PLACEBO;
use super::super::findings::{Question, Suspect, Unexplained};
use super::super::model::Fitted;
use super::super::term::What;
use super::super::{Work, noise};
use crate::numerics::distributions::f_upper_tail;
use std::collections::BTreeSet;

/// Share of the residual below which a dependence is not worth a word.
const WORTH_SAYING: f64 = 0.05;

/// Corrected p of a question above which a column says nothing.
const SAYS_NOTHING: f64 = 0.01;

/// The empirical terms that were chosen; and where nothing was, the columns on which the residual depends.
pub(super) fn unexplained(
    work: &Work,
    fitted: &Fitted,
    after: &[Question],
    least_n: f64,
) -> Vec<Unexplained> {
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
        .filter(|q| q.p_adjusted < SAYS_NOTHING && q.column != PLACEBO)
        .filter(matters)
        .collect();
    others.sort_by(|a, b| b.share.total_cmp(&a.share).then(a.column.cmp(&b.column)));
    list.extend(
        work.suspects
            .iter()
            .filter(|s| s.set_aside)
            .map(|s| set_aside(s, work)),
    );
    // Misfit without a column is worth a word only where nothing else is.
    let found = !work.judgements.is_empty() || others.len() + list.len() > 1;
    others.retain(|q| q.column != noise::SET_POINT || !found);
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
