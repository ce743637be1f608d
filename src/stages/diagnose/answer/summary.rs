//! The answer in a few sentences.

use super::super::Work;
use super::super::findings::{EffectFinding, Errors, Rejected, Suspect, Unexplained, Verdict};
use super::super::held_out::FALLS;
use super::super::words::with_unit;
use crate::effects;

/// An effect that fewer of the folds found by themselves is not sure.
const HALF: f64 = 0.5;
/// Share of the residual above which an effect that failed is worth a word.
const MUCH: f64 = 0.3;

/// What is missing, how sure that is, and what it does to the error.
pub(super) fn summary(
    verdict: Verdict,
    effects: &[EffectFinding],
    unexplained: &[Unexplained],
    work: &Work,
    as_chosen: Option<Errors>,
) -> String {
    let mut sentences: Vec<String> = work.suspects.iter().map(look_at).collect();
    // Sessions that were set aside have been named already.
    let columns: Vec<&str> = unexplained
        .iter()
        .filter(|u| !u.shape.starts_with("session "))
        .map(|u| u.column.as_str())
        .collect();
    let columns = columns.join(", ");
    match verdict {
        Verdict::EffectFound => {
            let found: Vec<String> = effects.iter().map(effect).collect();
            sentences.push(format!("Found: {}.", found.join("; ")));
            if work.judgements.is_empty() {
                sentences.push(
                    "It says nothing of another specimen: the held-out error stays.".to_owned(),
                );
            } else {
                sentences.push(errors(work, as_chosen));
            }
            if !columns.is_empty() {
                sentences.push(format!("The residual still depends on {columns}, which no effect of the library explains."));
            }
        }
        Verdict::Unexplained if !columns.is_empty() => {
            sentences.push(format!(
                "Something is missing: the residual depends on {columns}, and no effect of the library is sure enough to explain it."
            ));
            sentences.extend(nearest(work));
        }
        Verdict::Unexplained => {
            sentences.push("Nothing else is missing that this campaign could show.".to_owned());
        }
        Verdict::None => {
            sentences.push("Nothing is missing that this campaign could show.".to_owned())
        }
    }
    sentences.join(" ")
}

/// The effect that came nearest, where one explains much and yet failed a guard.
fn nearest(work: &Work) -> Option<String> {
    // What acts on parts of a campaign explains much of anything.
    let effect = |r: &&Rejected| {
        effects::index(&r.id).is_some() && r.share > MUCH && r.acts_on == "all readings"
    };
    let near = work
        .rejected
        .iter()
        .filter(effect)
        .max_by(|a, b| a.share.total_cmp(&b.share))?;
    let title = effects::index(&near.id).map(|k| effects::all()[k].title())?;
    Some(format!(
        "Nearest comes {title}, which would explain {:.0}% of it and was not taken: {}.",
        100.0 * near.share,
        near.why
    ))
}

/// An effect with its first size, where it acts, and what it may be instead.
fn effect(e: &EffectFinding) -> String {
    let size = e.parameters.first().map_or_else(String::new, |p| {
        format!(" ({} = {})", p.name, with_unit(p.value, &p.unit))
    });
    let place = match e.acts_on.as_str() {
        "all readings" => String::new(),
        place => format!(" in {place}"),
    };
    let folds = if e.selected_in_folds < HALF {
        format!(
            ", chosen in {:.0}% of the folds only",
            100.0 * e.selected_in_folds
        )
    } else {
        String::new()
    };
    let class: Vec<&str> = e
        .class
        .iter()
        .filter(|id| **id != e.id)
        .map(String::as_str)
        .collect();
    let or = if class.is_empty() {
        String::new()
    } else {
        format!(", not to be told from {} here", class.join(", "))
    };
    format!("{}{size}{place}{folds}{or}", e.title)
}

/// Held-out errors before and after, and what is to be thought of them.
fn errors(work: &Work, as_chosen: Option<Errors>) -> String {
    let (before, after) = (work.held.before, work.held.after);
    let own = (before.rmse_own_strength(), after.rmse_own_strength());
    let fixed = as_chosen.map_or_else(String::new, |e| {
        format!(
            " (to {:.1} N where only the sizes are found anew in each fold)",
            e.rmse_heldout
        )
    });
    let first = format!(
        "With the search inside each fold the held-out error goes from {:.1} N to {:.1} N{fixed}; with each held-out specimen's own strength \
         taken off, from {:.1} N to {:.1} N.",
        before.rmse(),
        after.rmse(),
        own.0,
        own.1
    );
    let falls = |a: f64, b: f64| b < (1.0 - FALLS) * a;
    let word = match (falls(before.rmse(), after.rmse()), falls(own.0, own.1)) {
        (true, _) => "",
        (false, true) => {
            " The total does not fall: what was found acts within specimens, and how strong an unknown specimen is outweighs it."
        }
        (false, false) => {
            " Neither falls, so that each fold by itself did not find it: an explanation of these readings, not yet a better prediction."
        }
    };
    format!("{first}{word}")
}

/// What to look at before anything else.
fn look_at(suspect: &Suspect) -> String {
    let then = suspect
        .error_then_n
        .map_or_else(String::new, |e| format!("; {e:.0} N if so"));
    let aside = if suspect.set_aside { ", set aside" } else { "" };
    format!(
        "Look at {} first (off by {:.0} N, usual are {:.0} N{aside}): {}{then}.",
        suspect.what, suspect.error_n, suspect.usual_n, suspect.explanation
    )
}
