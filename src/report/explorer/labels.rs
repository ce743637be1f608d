//! What the page calls columns and models.

use crate::input::ReportInput;
use crate::wording::name;
use pipeline_base::columns::{self, TORQUE, unit_in};
use pipeline_base::frame::Frame;
use pipeline_compare::NEW;
use pipeline_mechanics::models::published;
use std::collections::BTreeMap;

use super::readings::Model;

const CALLED: &[(&str, &str)] = &[
    ("contraction", "contraction ε"),
    ("contraction_rel", "relative contraction ε*"),
    ("pressure_rel", "relative pressure P*"),
    ("contracted_length_m", "contracted length"),
    ("length_m", "length"),
    ("diameter_mm", "diameter"),
    ("sd_force_n", "scatter of the samples' force"),
    ("zero_force_n", "zero of the force, subtracted"),
    ("zero_pressure_kpa", "zero of the pressure, not subtracted"),
    ("n_samples", "samples"),
    ("phase", "branch"),
    ("row", "first line"),
    ("last_row", "last line"),
    ("session_order", "order of the sessions"),
    ("role", "role in session.toml"),
    ("muscle_length_m", "length measured by hand"),
    ("moment_arm_m", "moment arm measured by hand"),
    ("expected_path_length_m", "expected path length"),
    ("expected_length_m", "expected length"),
    ("expected_contraction_rel", "expected relative contraction"),
    ("expected_arm_m", "expected moment arm"),
    ("projected_arm_m", "moment arm by projection"),
];

/// A column, for people.
pub fn column(column: &str) -> String {
    let known = CALLED.iter().find(|(id, _)| *id == column);
    let text = known.map_or_else(|| name::column(column), |(_, text)| (*text).to_owned());
    text.replace('_', " ")
}

/// Its unit; empty where it has none.
pub fn unit(name: &str, frame: &Frame) -> String {
    let own = columns::is_reserved(name).then(|| unit_in(name)).flatten();
    let given = frame.units.get(name).map(String::as_str).or(own);
    given.filter(|u| *u != "1").unwrap_or_default().to_owned()
}

/// What the search's part of a column's name says.
fn of_search(part: &str) -> Option<String> {
    let part = part.strip_prefix("loop_")?;
    Some(match part {
        "before" => "Search: without effects".to_owned(),
        "after" => "Search: with all effects".to_owned(),
        "conditional" => "Search: with effects, and this specimen and session known".to_owned(),
        "unseen_before" => "Search: without effects, fitted without the specimen".to_owned(),
        "unseen" => "Search: with effects, made without the specimen".to_owned(),
        _ => match part.strip_prefix("after_")? {
            "1" => "Search: with the first effect".to_owned(),
            number => format!("Search: with {number} effects"),
        },
    })
}

/// Models of forces: those that are fitted here first, then published ones, then the search, then what pools say.
pub fn of_forces<'a>(input: &ReportInput, columns: impl Iterator<Item = &'a String>) -> Vec<Model> {
    let lines = input.groups.iter().flat_map(|g| &g.comparison.comparisons);
    let titles: BTreeMap<&str, &str> = lines
        .map(|c| (c.model.as_str(), name::model_name(&c.model, &c.title)))
        .collect();
    let title = |id: &str| match id {
        "new_unseen" => "New model, fitted without the specimen".to_owned(),
        id => of_search(id)
            .or_else(|| titles.get(id).map(|t| (*t).to_owned()))
            .unwrap_or_else(|| column(id)),
    };
    let mut models: Vec<(u8, Model)> = columns
        .map(|column| {
            let id = column.strip_prefix("predicted_").unwrap_or(column);
            let id = id.strip_suffix("_n").unwrap_or(id);
            let (pool, id) = match id.strip_prefix("pooled_") {
                Some(id) => (true, id),
                None => (false, id),
            };
            let is_search = id.starts_with("loop_");
            let rank = match (pool, is_search, id) {
                (false, false, NEW) => 0,
                (false, false, "new_unseen") => 1,
                (false, false, _) => 2,
                (false, true, _) => 3 + order_of_search(id),
                _ => 7,
            };
            let of_pool = if pool { "Pool of campaigns: " } else { "" };
            let model = Model {
                column: column.clone(),
                label: format!("{of_pool}{}", title(id)),
                is_search: is_search && !pool,
            };
            (rank, model)
        })
        .collect();
    models.sort_by_key(|(rank, _)| *rank);
    models.into_iter().map(|(_, model)| model).collect()
}

/// Before, after each effect, after all of them, with the groups' own values.
fn order_of_search(id: &str) -> u8 {
    match id {
        "loop_before" => 0,
        "loop_after" | "loop_conditional" => 2,
        "loop_unseen_before" | "loop_unseen" => 3,
        _ => 1,
    }
}

/// Models of torques, in the order of the frame.
pub fn of_torques(frame: &Frame) -> Vec<Model> {
    let suffix = format!("_{TORQUE}");
    let title = |id: &str| {
        let all = published();
        let found = all.iter().find(|m| m.id() == id);
        found.map(|m| name::model_name(id, m.title()).to_owned())
    };
    let mut models: Vec<(u8, Model)> = frame
        .columns
        .iter()
        .filter_map(|(column, _)| {
            let id = column.strip_suffix(&suffix)?;
            let (rank, label, is_search) = match id.strip_suffix("_by_hand") {
                Some(id) => (1, format!("{}, length and arm by hand", title(id)?), false),
                None => match of_search(id) {
                    Some(label) => (2 + order_of_search(id), label, true),
                    None => (0, title(id)?, false),
                },
            };
            let model = Model {
                column: column.clone(),
                label,
                is_search,
            };
            Some((rank, model))
        })
        .collect();
    models.sort_by_key(|(rank, _)| *rank);
    models.into_iter().map(|(_, model)| model).collect()
}
