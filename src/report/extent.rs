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
    let is_found = |group: &GroupInput| {
        let verdict = group.diagnosis.as_ref().map(|d| d.findings.verdict);
        matches!(verdict, Some(Verdict::EffectFound | Verdict::Unexplained))
    };
    let weight = |g: &GroupInput| (g.fit.group.members.len() > 1, is_found(g), g.fit.rows);
    heaviest(&groups.iter().map(weight).collect::<Vec<_>>())
}

/// Of groups with these weights, those that are shown: the heaviest, and of equal ones the first.
fn heaviest(weights: &[(bool, bool, usize)]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..weights.len()).collect();
    order.sort_by_key(|k| std::cmp::Reverse(weights[*k]));
    let mut shown = vec![false; weights.len()];
    for k in order.into_iter().take(MOST_GROUPS) {
        shown[k] = true;
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pools_and_what_was_found_are_shown_before_what_has_more_readings() {
        let mut groups = vec![(false, false, 1000); MOST_GROUPS];
        groups.push((false, true, 10));
        groups.push((true, false, 5));
        let shown = heaviest(&groups);
        let left_out: Vec<usize> = (0..groups.len()).filter(|k| !shown[*k]).collect();
        assert_eq!(left_out, [MOST_GROUPS - 2, MOST_GROUPS - 1]);
    }
}
