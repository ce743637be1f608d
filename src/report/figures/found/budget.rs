//! What the expected error on an unseen specimen is made of: one bar a campaign, as long for all, because errors of 10 and 40 mm and of torque
//! have no common scale.

use super::super::Named;
use super::super::formatting::plain;
use super::{TEXT_MM, ending};
use crate::plot::{
    Anchor, Axis, Dash, Figure, Ink, Layer, Legend, Level, Panel, Place, Series, Side, Stroke,
};
use crate::wording::name;
use crate::wording::number::{error, error_with_unit};
use pipeline_findings::{BudgetEntry, CampaignFindings};

/// Height of a campaign's band, of the axis and of the legend, mm.
const BAND_MM: f64 = 3.9;
const AXIS_MM: f64 = 11.0;
const LEGEND_MM: f64 = 10.0;
/// Bands by which the figure may grow, where names are so long that the legend takes further rows.
const MOST_BANDS_MORE: usize = 6;
/// Half the height of a bar, in bands.
const HALF: f64 = 0.34;
/// Segments narrower than this share carry no number.
const NARROW: f64 = 0.055;
/// Letters of the name of a campaign that a bar leaves room for.
const LONGEST_CAMPAIGN: usize = 44;
/// Where the totals stand, and where the axis ends.
const TOTAL_AT: f64 = 1.02;
const END: f64 = 1.16;

/// Sources with name and colour in the legend, in the order in which they stand in a bar; others are grey.
const SOURCES: [(&[&str], &str, Ink); 7] = [
    (
        &["set_length", "mounting"],
        "set length, mounting",
        Ink::Blue,
    ),
    (&["specimen_gain", "actuator_gain"], "gain", Ink::Orange),
    (&["force_zero", "torque_zero"], "zero", Ink::Purple),
    (
        &["specimen_lengths", "contracted_length"],
        "free lengths",
        Ink::Sky,
    ),
    (
        &[
            "common_misfit",
            "session_misfit",
            "stroke_misfit",
            "test_misfit",
        ],
        "misfit",
        Ink::Green,
    ),
    (&["estimation"], "estimation", Ink::Vermilion),
    (&["noise"], "noise", Ink::Grey),
];
/// Name and colour of all others.
const OTHERS: (&str, Ink) = ("other", Ink::Black);

/// The figure of all campaigns; none where no campaign has a budget.
pub fn figure(all: &[&CampaignFindings]) -> Option<Named> {
    let with: Vec<&&CampaignFindings> = all.iter().filter(|f| !f.budget.is_empty()).rev().collect();
    if with.is_empty() {
        return None;
    }
    let name = |f: &&&CampaignFindings| plain(&ending(&name::campaign(f), LONGEST_CAMPAIGN));
    let names: Vec<String> = with.iter().map(name).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let x = Axis::new("Share of the expected squared error").fixed(0.0, END);
    let mut panel = Panel::new(x, Axis::categories("", &names)).legend(Legend::Above);
    panel.x.ticks = crate::plot::axis::Ticks::Named(
        [0.0, 0.25, 0.5, 0.75, 1.0]
            .map(|at| (at, format!("{at}")))
            .to_vec(),
    );
    for (row, found) in with.iter().enumerate() {
        for layer in bar(found, row as f64) {
            panel = panel.with(layer);
        }
    }
    let height = AXIS_MM + LEGEND_MM + BAND_MM * with.len() as f64;
    Some(Named {
        name: "budget".to_owned(),
        caption: "Shares of the squared error expected on an unseen specimen (actuator). Numbers are square roots, in N or N m."
            .to_owned(),
        figure: Figure::new("Budget of the expected error", TEXT_MM, height)
            .with(panel)
            .with_room(BAND_MM, MOST_BANDS_MORE),
    })
}

fn place(entry: &BudgetEntry) -> usize {
    let found = SOURCES
        .iter()
        .position(|(ids, ..)| ids.contains(&entry.source.as_str()));
    found.unwrap_or(SOURCES.len())
}

fn bar(found: &CampaignFindings, row: f64) -> Vec<Layer> {
    let total: f64 = found.budget.iter().map(|b| b.variance).sum();
    let mut entries: Vec<&BudgetEntry> = found.budget.iter().collect();
    entries.sort_by_key(|entry| place(entry));
    let mut layers = Vec::new();
    let mut at = 0.0;
    for entry in entries {
        let share = entry.variance / total.max(f64::MIN_POSITIVE);
        layers.extend(segment(found, entry, (at, at + share), row));
        at += share;
    }
    layers.extend(found.expected_rmse_heldout.map(|expected| Layer::Text {
        text: error_with_unit(expected, &found.unit),
        place: Place::Data(TOTAL_AT, row),
        anchor: Anchor::new(Side::Left, Level::Center),
    }));
    layers
}

fn segment(
    found: &CampaignFindings,
    entry: &BudgetEntry,
    (from, to): (f64, f64),
    row: f64,
) -> Vec<Layer> {
    let (name, ink) = SOURCES
        .get(place(entry))
        .map_or(OTHERS, |(_, name, ink)| (*name, *ink));
    let ends = [(from, row - HALF, row + HALF), (to, row - HALF, row + HALF)];
    let edge = vec![(to, row - HALF), (to, row + HALF)];
    let mut layers = vec![
        Layer::part(name, ends.to_vec(), ink),
        Series::line("", edge, Stroke::hair(Ink::White, Dash::Solid)).into(),
    ];
    if to - from >= NARROW {
        layers.push(Layer::Text {
            text: error(entry.rmse, &found.unit),
            place: Place::Data(0.5 * (from + to), row),
            anchor: Anchor::new(Side::Middle, Level::Center),
        });
    }
    layers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wording::tests::example;

    #[test]
    fn one_campaign_with_every_source_has_room() {
        let entry = |source: &str| BudgetEntry {
            source: source.to_owned(),
            variance: 1.0,
            rmse: 1.0,
            unit: "N".to_owned(),
        };
        let sources = SOURCES.iter().map(|(ids, ..)| ids[0]).chain(["else"]);
        let found = CampaignFindings {
            budget: sources.map(entry).collect(),
            unit: "N".to_owned(),
            ..example()
        };
        for letters in [1, 10, 22, 30, 44, 100] {
            let found = CampaignFindings {
                campaign: "m".repeat(letters),
                ..found.clone()
            };
            let drawn = figure(&[&found]).unwrap().figure.to_svg();
            assert!(drawn.is_ok(), "{letters}: {drawn:?}");
        }
    }
}
