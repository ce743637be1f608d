//! The readings that stand near an isobar, and the pressures at which a group has any.

use crate::input::GroupInput;
use pipeline_base::row::Row;
use pipeline_mechanics::models::PRESSURE_SLACK_KPA;

/// Pressures of isobars, kPa, and pressures that stand in for the last one where nothing was measured there.
const ISOBARS_KPA: [f64; 6] = [100.0, 200.0, 300.0, 400.0, 500.0, 620.0];
const INSTEAD_OF_620_KPA: f64 = 600.0;

/// The rows within 10 kPa of a pressure, as in the force paper's Fig. 4.
pub fn near(rows: &[Row], pressure_kpa: f64) -> impl Iterator<Item = &Row> {
    rows.iter()
        .filter(move |r| (r.pressure_kpa - pressure_kpa).abs() <= PRESSURE_SLACK_KPA)
}

/// The isobars that have readings: 100 to 500 kPa and 620 kPa, or 600 kPa where there is none at 620.
pub fn isobars(group: &GroupInput) -> Vec<f64> {
    first_isobars(group, |_| true)
}

/// The isobars that have readings of the wanted kind.
pub fn first_isobars(group: &GroupInput, wanted: impl Fn(&Row) -> bool) -> Vec<f64> {
    let rows = &group.predictions.rows;
    let has = |p: &f64| near(rows, *p).any(&wanted);
    let mut found: Vec<f64> = ISOBARS_KPA.into_iter().filter(has).collect();
    if found.last() != Some(&620.0) && has(&INSTEAD_OF_620_KPA) {
        found.push(INSTEAD_OF_620_KPA);
    }
    found
}
