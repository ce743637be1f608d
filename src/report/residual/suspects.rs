//! Mistakes of recording: what to look at before believing anything else of a campaign.

use super::words::newtons;
use crate::report::answers::rounded;
use crate::report::number::Rounding;
use crate::stages::diagnose::findings::{CampaignFindings, Suspect as Found};
use serde::Serialize;

/// A session, a specimen or the campaign, and the mistake that would explain it.
#[derive(Serialize)]
pub(super) struct Suspect {
    what: String,
    /// Its error, and how often the usual one that is.
    error: String,
    usual: String,
    times: String,
    explanation: String,
    /// Whether one of the usual mistakes explains it, and the error that it would leave.
    then: Option<String>,
    set_aside: bool,
}

/// All of them, those first that were set aside.
pub(super) fn suspects(found: &CampaignFindings) -> Vec<Suspect> {
    let aside = found.suspects.iter().filter(|s| s.set_aside);
    let others = found.suspects.iter().filter(|s| !s.set_aside);
    aside.chain(others).map(suspect).collect()
}

fn suspect(s: &Found) -> Suspect {
    let times = s.error_n / s.usual_n.max(f64::MIN_POSITIVE);
    let decimals = if times < 10.0 { 1 } else { 0 };
    Suspect {
        what: s.what.clone(),
        error: newtons(s.error_n),
        usual: newtons(s.usual_n),
        times: rounded(times, Rounding::Decimals(decimals)),
        explanation: s.explanation.clone(),
        then: s.error_then_n.map(newtons),
        set_aside: s.set_aside,
    }
}

/// The summary of a campaign without what the page says better beside it: the suspects, which stand in a block of their own before it,
/// and the effects, which are listed with their intervals.
pub(super) fn summary(found: &CampaignFindings) -> String {
    let mut rest = found.summary.as_str();
    for s in &found.suspects {
        let begins = format!("Look at {} first", s.what);
        let Some((_, after)) = rest
            .strip_prefix(begins.as_str())
            .and_then(|r| r.split_once(&s.explanation))
        else {
            break;
        };
        rest = after.split_once(". ").map_or("", |(_, rest)| rest);
    }
    // Full stops within numbers and ids are not followed by a blank.
    let after_effects = rest
        .strip_prefix("Found: ")
        .and_then(|r| r.split_once(". "));
    after_effects.map_or(rest, |(_, errors)| errors).to_owned()
}
