//! The figures of what was found in a residual, one file each; a new one is one file, one line in [`ALL`] and one in [`Kind`].
//!
//! They read [`CampaignFindings`] and the residuals behind them, of a campaign, a pool or a joint alike.

mod budget;
mod calibration;
mod effects;
mod held_out;
mod residuals;
mod scatter;
mod unexplained;

pub use budget::figure as budget;

use super::formatting::{plain, verbatim};
use super::{Composed, Named, compose};
use crate::plot::Figure;
use crate::wording::name::campaign;
use crate::wording::number::unit;
use pipeline_base::row::Row;
use pipeline_findings::{CampaignFindings, Residuals};
use serde::{Deserialize, Serialize};

/// Width of the text of the pages, and of a half of it, mm: nothing hangs over the margins.
const TEXT_MM: f64 = 175.0;
const HALF_MM: f64 = 85.0;
/// Most groups (specimens, sessions) that a figure names one by one.
pub(crate) const MOST_GROUPS: usize = 36;

/// What a figure shows, so that a page can put it where it belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// The residual against what was tested.
    Residuals,
    /// Likelihood profile and each specimen's own estimate of every effect.
    Effects,
    /// What varies from group to group.
    Scatter,
    /// The error on every held-out unit.
    HeldOut,
    /// Probability integral transform of the held-out readings.
    Calibration,
    /// Empirical dependences on columns.
    Unexplained,
}

impl Kind {
    /// Beginning of the names of its files.
    fn stem(self) -> &'static str {
        match self {
            Kind::Residuals => "residual-tested",
            Kind::Effects => "effects",
            Kind::Scatter => "scatter",
            Kind::HeldOut => "held-out",
            Kind::Calibration => "calibration",
            Kind::Unexplained => "unexplained",
        }
    }
}

/// What the figures are made of.
pub struct Shown<'a> {
    /// What was found.
    pub found: &'a CampaignFindings,
    /// The residuals; empty where there are none.
    pub residuals: &'a Residuals,
    /// The rows of the campaign, for the words of columns of labels; empty where there are none.
    pub rows: &'a [Row],
    /// The campaign in file names.
    pub slug: String,
}

impl Shown<'_> {
    /// The unit of the errors, for people.
    fn unit(&self) -> &str {
        unit(&self.found.unit)
    }
}

type Make = fn(&Shown) -> Option<(String, Figure)>;

/// Every figure, in the order of the page.
const ALL: &[(Kind, Make)] = &[
    (Kind::Residuals, residuals::figure),
    (Kind::Effects, effects::figure),
    (Kind::Scatter, scatter::figure),
    (Kind::HeldOut, held_out::figure),
    (Kind::Calibration, calibration::figure),
    (Kind::Unexplained, unexplained::figure),
];

/// The figures for which there is something to show.
pub fn figures(shown: &Shown) -> Vec<(Kind, Composed)> {
    let made = ALL.iter().filter_map(|(kind, make)| {
        let name = format!("{}-{}", kind.stem(), shown.slug);
        let composed = compose(&name, || {
            let (caption, figure) = make(shown)?;
            let simulated = if shown.found.simulated {
                "Simulated. "
            } else {
                ""
            };
            Some(Named {
                name: name.clone(),
                caption: format!("{simulated}{}. {caption}", verbatim(&campaign(shown.found))),
                figure,
            })
        });
        Some((*kind, composed?))
    });
    made.collect()
}

/// Groups of fewer ids keep what these have in common.
const FEW_IDS: usize = 3;

/// The ids of groups in the markup of figures, without the beginning that all have in common.
fn group_names<'a>(ids: impl Iterator<Item = &'a String>) -> Vec<String> {
    let ids: Vec<&str> = without_campaigns(ids.map(String::as_str).collect());
    let common = if ids.len() < FEW_IDS {
        0
    } else {
        common_beginning(&ids)
    };
    let shown = ids
        .iter()
        .map(|id| plain(&ending(&id[common..], LONGEST_NAME)));
    shown.collect()
}

/// The ids of the specimens of a pool without the campaign before each, where they are told apart by what is left.
fn without_campaigns(ids: Vec<&str>) -> Vec<&str> {
    let last: Vec<&str> = ids
        .iter()
        .map(|id| id.rsplit(' ').next().unwrap_or(id))
        .collect();
    let distinct: std::collections::BTreeSet<&&str> = last.iter().collect();
    if distinct.len() == ids.len() {
        last
    } else {
        ids
    }
}

/// Letters of a name that a tick has room for.
const LONGEST_NAME: usize = 24;

/// A name, its beginning left out where it is long: ids of a campaign differ at their ends.
fn ending(name: &str, longest: usize) -> String {
    let letters = name.chars().count();
    if letters <= longest {
        return name.to_owned();
    }
    let kept = name.chars().skip(letters + 1 - longest);
    ['…'].into_iter().chain(kept).collect()
}

/// Bytes up to the last separator of the beginning that all ids share.
fn common_beginning(ids: &[&str]) -> usize {
    let shared = |a: &str, b: &str| a.bytes().zip(b.bytes()).take_while(|(a, b)| a == b).count();
    let longest = ids.iter().map(|id| shared(ids[0], id)).min().unwrap_or(0);
    let separator = ids.first().and_then(|id| {
        id.as_bytes()[..longest]
            .iter()
            .rposition(|b| b"-_/. ".contains(b))
    });
    separator.map_or(0, |at| at + 1)
}

/// A symbol with its unit in the markup of axes: `P_th (kPa)`.
fn axis_label(symbol: &str, of: &str) -> String {
    match unit(of) {
        "" => symbol.to_owned(),
        unit => format!("{symbol} ({unit})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_named_by_what_tells_them_apart() {
        let ids = ["rig-l112-c00", "rig-l112-c25", "rig-l257-c00"].map(str::to_owned);
        assert_eq!(
            group_names(ids.iter()),
            ["l112-c00", "l112-c25", "l257-c00"]
        );
        assert_eq!(
            group_names(ids[..2].iter()),
            ["rig-l112-c00", "rig-l112-c25"]
        );
        assert_eq!(
            ending("0123456789012345678901234567", LONGEST_NAME),
            "…56789012345678901234567"
        );
        let pool = ["rig-1 rig-l182", "rig-2 rig-l83", "rig-2 rig-l90"].map(str::to_owned);
        assert_eq!(group_names(pool.iter()), ["l182", "l83", "l90"]);
        assert_eq!(without_campaigns(vec!["a x", "b x"]), ["a x", "b x"]);
        assert_eq!(common_beginning(&["a", "b"]), 0);
        assert_eq!(common_beginning(&["é-a", "é-b"]), 3);
    }
}
