//! How much the pages and the tables for people hold.
//!
//! A laboratory of ten years has thousands of sessions and dozens of campaigns. Nobody reads a table of five thousand rows on paper, and
//! typesetting it takes more memory than everything else together. So the pages show the groups in which something was found, and the largest, in full and the first rows of long
//! tables, and say what they leave out and where it is: data files and figures are always complete.

use crate::input::GroupInput;
use pipeline_findings::Verdict;

/// Most rows of a table in a PDF.
pub const MOST_ROWS_ON_PAGES: usize = 100;
/// Most rows of a table as LaTeX, Typst or Markdown.
pub const MOST_ROWS_PRINTED: usize = 20_000;
/// Most groups, and logs, that a PDF shows in full.
pub const MOST_GROUPS: usize = 12;
/// Up to so many sessions the documents are typeset side by side; beyond, the largest waits until the others no longer need their memory.
pub const SIDE_BY_SIDE: usize = 1000;
/// Most sessions that a sentence names.
pub const MOST_NAMED: usize = 10;

/// Which of the groups have a section of their own: those of several campaigns first, then those in which something was found, then those with most
/// readings.
pub fn with_section(groups: &[GroupInput]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..groups.len()).collect();
    let is_found = |k: usize| {
        let diagnosis = groups[k].diagnosis.as_ref();
        let verdict = diagnosis.map(|d| d.findings.verdict);
        matches!(verdict, Some(Verdict::EffectFound | Verdict::Unexplained))
    };
    let weight = |k: usize| {
        (
            groups[k].fit.group.members.len() > 1,
            is_found(k),
            groups[k].fit.rows,
        )
    };
    order.sort_by_key(|k| std::cmp::Reverse(weight(*k)));
    let mut shown = vec![false; groups.len()];
    for k in order.into_iter().take(MOST_GROUPS) {
        shown[k] = true;
    }
    shown
}
