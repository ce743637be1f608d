#![warn(missing_docs)]
//! Fit: the coefficients of the new model, equation by equation and all together, with intervals that respect the specimens.
//!
//! A group of rows is fitted at a time: one campaign and diameter, or one diameter over all measured campaigns ("pooled").
//!
//! | equation | of | file |
//! |---|---|---|
//! | Eqs. 5, 6 | F_620(l_rest), from the measured maximum of each specimen | [`maxima`], [`equations`] |
//! | Eq. 7 | F_max(l_rest, P), from the rows at resting length | [`equations`] |
//! | Eq. 8 | F*(eps*, P*), rows divided by the fitted F_620 | [`equations`] |
//! | Eq. 9 | all coefficients jointly, in N: the model that is compared | [`equations`] |
//! | - | eps_620 against l_rest, a straight line | [`equations`] |
//!
//! Intervals: rows of one specimen share its gain and rows of one session its zero, so the usual covariance, which counts every
//! row as independent, gives intervals that contain a true b1 in one campaign of seven (measured on simulated campaigns of eight
//! specimens with 2% scatter). The default interval is therefore the jackknife over specimens with Student's t of G - 1 degrees of
//! freedom (Efron 1982; Tukey 1958), which the refits for leave-one-specimen-out give for nothing; below three specimens there is only
//! the linearised one, and the table says so.
//!
//! Rows come with the zeros that their sessions declare; which of these are pulls of the actuator, the zeros of a campaign show beside one another
//! ([`zeros`]).
//!
//! Refits of ten specimens and more are steps from the full fit, checked on the rows (`steps`), so that the work grows with the rows and not
//! with specimens times rows.

mod bootstrap;
pub mod engine;
pub mod equations;
pub mod intervals;
mod leave_out;
pub mod maxima;
pub mod scatter;
mod specimens;
pub mod split;
mod steps;
#[cfg(test)]
mod tests_of_refits;
pub mod zeros;

use engine::EquationFit;
use maxima::Maximum;
pub use pipeline_base::group::Group;
use pipeline_base::row::Row;
use pipeline_base::session::{Kind, Role};
use pipeline_config::FitOptions;
use pipeline_findings::RecordingError;
use scatter::Scatter;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Raised when results change without a change of this stage's source files.
pub const VERSION: u32 = 1;

/// One specimen of a group.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpecimenSummary {
    /// Specimen id.
    pub id: String,
    /// Campaign id.
    pub campaign: String,
    /// l_rest, m.
    pub rest_length_m: f64,
    /// eps_620.
    pub contraction_620: f64,
    /// Rows of it.
    pub rows: usize,
    /// Sessions of it.
    pub sessions: usize,
    /// Largest measured force, N.
    pub largest_force_n: f64,
    /// Measured maximum force at 620 kPa and resting length, where the rows allow it.
    pub maximum: Option<Maximum>,
}

/// The smallest and largest value of each quantity among fitted rows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ranges {
    /// l_rest, m.
    #[serde(deserialize_with = "range_or_empty")]
    pub rest_length_m: (f64, f64),
    /// Gauge pressure, kPa.
    #[serde(deserialize_with = "range_or_empty")]
    pub pressure_kpa: (f64, f64),
    /// eps*.
    #[serde(deserialize_with = "range_or_empty")]
    pub contraction_rel: (f64, f64),
    /// eps_620.
    #[serde(deserialize_with = "range_or_empty")]
    pub contraction_620: (f64, f64),
}

/// The ends of a range; those of no rows (every session of the group is excluded) are infinite, for which JSON has only null.
fn range_or_empty<'de, D: Deserializer<'de>>(from: D) -> Result<(f64, f64), D::Error> {
    let (low, high) = <(Option<f64>, Option<f64>)>::deserialize(from)?;
    Ok((
        low.unwrap_or(f64::INFINITY),
        high.unwrap_or(f64::NEG_INFINITY),
    ))
}

/// Everything that was fitted to one group.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroupFit {
    /// Which rows.
    pub group: Group,
    /// Rows fitted (held-out and excluded ones are not among them).
    pub rows: usize,
    /// Rows of the group that are kept out by their role.
    pub rows_kept_out: usize,
    /// Rows of excluded sessions.
    pub rows_excluded: usize,
    /// What was measured of it: the range in which its fits interpolate.
    pub ranges: Ranges,
    /// The specimens, by resting length.
    pub specimens: Vec<SpecimenSummary>,
    /// The equations, in the order of the force paper.
    pub equations: Vec<EquationFit>,
    /// Length at which the end caps touch, m: what the equations were fitted with.
    pub cap_length_m: f64,
    /// How the specimens scatter about the joint fit; none where they are too few.
    pub scatter: Option<Scatter>,
    /// What could not be fitted, and why.
    pub notes: Vec<String>,
    /// Sessions and specimens whose readings it holds and that look mistaken. The search for effects finds them, after the fit: the report fills
    /// them in for whoever reads `derived/fits.json`.
    #[serde(default)]
    pub doubtful: Vec<RecordingError>,
}

impl GroupFit {
    /// The fit of an equation, if there is one.
    pub fn equation(&self, id: &str) -> Option<&EquationFit> {
        self.equations.iter().find(|e| e.id == id)
    }
}

/// Whether a row takes part in fits: an isometric force of a session that is neither excluded nor held out.
pub fn is_fitted(row: &Row) -> bool {
    is_usable(row) && matches!(row.role, None | Some(Role::Train))
}

/// Whether a row can be compared with a model at all.
pub fn is_usable(row: &Row) -> bool {
    row.kind == Kind::Isometric
        && !row.excluded
        && [row.force_n, row.pressure_kpa, row.contraction_rel]
            .iter()
            .all(|x| x.is_finite())
}

/// The groups of a set of rows: every campaign and diameter, and every diameter that more than one measured campaign has.
pub fn groups(rows: &[(String, u32, bool)], pool: bool) -> Vec<Group> {
    let mut by_campaign: BTreeMap<(String, u32), bool> = BTreeMap::new();
    let mut by_diameter: BTreeMap<u32, BTreeSet<String>> = BTreeMap::new();
    for (campaign, diameter_mm, simulated) in rows {
        *by_campaign
            .entry((campaign.clone(), *diameter_mm))
            .or_default() |= simulated;
    }
    for ((campaign, diameter), _) in by_campaign.iter().filter(|(_, simulated)| !**simulated) {
        by_diameter
            .entry(*diameter)
            .or_default()
            .insert(campaign.clone());
    }
    let single = by_campaign
        .into_iter()
        .map(|((campaign, diameter_mm), simulated)| Group {
            members: vec![campaign.clone()],
            campaign,
            diameter_mm,
            simulated,
        });
    let pooled = by_diameter
        .into_iter()
        .filter(|(_, members)| pool && members.len() > 1)
        .map(|(diameter_mm, members)| Group {
            campaign: format!("pooled-{diameter_mm}mm"),
            diameter_mm,
            members: members.into_iter().collect(),
            simulated: false,
        });
    single.chain(pooled).collect()
}

/// Fits every equation to the rows of a group (all of one diameter; rows of other kinds are ignored).
pub fn fit_group(group: &Group, rows: &[Row], options: &FitOptions) -> GroupFit {
    let usable: Vec<&Row> = rows.iter().filter(|r| is_usable(r)).collect();
    let fitted: Vec<&Row> = usable.iter().copied().filter(|r| is_fitted(r)).collect();
    let maxima = maxima::maxima(&fitted, options);
    let mut notes = Vec::new();
    let mut equations =
        equations::fit_all(group.diameter_mm, &fitted, &maxima, options, &mut notes);
    notes.extend(held_in_folds(&equations));
    equations::judge_by_rows(group.diameter_mm, &mut equations, &usable, options);
    let scatter = equations
        .iter()
        .find(|e| e.id == equations::JOINT)
        .and_then(|joint| scatter::scatter(joint, group.diameter_mm, &fitted, options));
    GroupFit {
        cap_length_m: equations::cap_length_m(group.diameter_mm, options),
        scatter,
        group: group.clone(),
        rows: fitted.len(),
        rows_kept_out: usable.len() - fitted.len(),
        rows_excluded: rows.iter().filter(|r| r.excluded).count(),
        ranges: ranges(&fitted),
        specimens: summaries(&fitted, &maxima),
        equations,
        notes,
        doubtful: Vec::new(),
    }
}

/// Which coefficients of the joint fit the other specimens do not determine: leave-one-specimen-out then borrows them.
fn held_in_folds(equations: &[EquationFit]) -> Option<String> {
    let joint = equations.iter().find(|e| e.id == equations::JOINT)?;
    let held: BTreeSet<&str> = joint
        .folds
        .iter()
        .flat_map(|f| f.held.iter().map(String::as_str))
        .collect();
    if held.is_empty() {
        return None;
    }
    let names: Vec<&str> = held.into_iter().collect();
    Some(format!(
        "Without one of its specimens the others do not determine {}, which is held at its published value there, so that the error on \
         specimens that were not seen is not of this campaign alone",
        names.join(", ")
    ))
}

fn ranges(rows: &[&Row]) -> Ranges {
    let of = |quantity: fn(&Row) -> f64| {
        rows.iter()
            .map(|r| quantity(r))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            })
    };
    Ranges {
        rest_length_m: of(|r| r.rest_length_m),
        pressure_kpa: of(|r| r.pressure_kpa),
        contraction_rel: of(|r| r.contraction_rel),
        contraction_620: of(contraction_620),
    }
}

fn summaries(rows: &[&Row], maxima: &[Maximum]) -> Vec<SpecimenSummary> {
    let mut by_specimen: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        by_specimen.entry(&row.specimen).or_default().push(row);
    }
    let mut summaries: Vec<SpecimenSummary> = by_specimen
        .into_iter()
        .map(|(id, rows)| {
            let sessions: BTreeSet<&str> = rows.iter().map(|r| r.session.as_str()).collect();
            SpecimenSummary {
                id: id.to_owned(),
                campaign: rows[0].campaign.clone(),
                rest_length_m: rows[0].rest_length_m,
                contraction_620: contraction_620(rows[0]),
                rows: rows.len(),
                sessions: sessions.len(),
                largest_force_n: rows
                    .iter()
                    .map(|r| r.force_n)
                    .fold(f64::NEG_INFINITY, f64::max),
                maximum: maxima.iter().find(|m| m.specimen == id).cloned(),
            }
        })
        .collect();
    summaries.sort_by(|a, b| {
        a.rest_length_m
            .total_cmp(&b.rest_length_m)
            .then(a.id.cmp(&b.id))
    });
    summaries
}

/// eps_620 of a row's specimen.
pub fn contraction_620(row: &Row) -> f64 {
    (row.rest_length_m - row.contracted_length_m) / row.rest_length_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simulated_campaigns_are_never_pooled_with_measured_ones() {
        let rows = [
            ("lab".to_owned(), 10, false),
            ("map".to_owned(), 10, false),
            ("rig".to_owned(), 10, true),
            ("lab".to_owned(), 20, false),
        ];
        let groups = groups(&rows, true);
        let names: Vec<&str> = groups.iter().map(|g| g.campaign.as_str()).collect();
        assert_eq!(names, ["lab", "lab", "map", "rig", "pooled-10mm"]);
        assert_eq!(groups[4].members, ["lab", "map"]);
    }
}
