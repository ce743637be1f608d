//! The tables, one file each. A new table is one new file and one line in [`ALL`].

mod alternatives;
mod audit;
mod baselines;
mod budget;
mod coefficients;
mod comparison_by_length;
mod described;
mod detection_limits;
mod findings;
mod fits;
mod intervals;
pub mod knee;
pub mod leg_prediction;
mod model_comparison;
mod paper;
mod plateaus;
pub mod prediction;
mod provenance;
mod recording_errors;
mod rejects;
mod residual_errors;
mod scatter;
mod sessions;
mod specimens;
mod statistics;
mod table1;
mod table2;
mod tested;
mod zeros;

use crate::input::ReportInput;
use crate::table::{Audience, Table};

/// Every table, in the order in which the summary lists them.
pub const ALL: &[fn(&ReportInput) -> Table] = &[
    sessions::table,
    rejects::table,
    zeros::table,
    plateaus::table,
    specimens::table,
    table1::table,
    table2::table,
    coefficients::table,
    intervals::table,
    fits::table,
    statistics::table,
    baselines::table,
    model_comparison::table,
    comparison_by_length::table,
    findings::table,
    scatter::table,
    budget::table,
    tested::table,
    detection_limits::table,
    recording_errors::table,
    residual_errors::table,
    alternatives::table,
    provenance::table,
];

pub use audit::table as audit;
pub use baselines::table as baselines;
pub use coefficients::of_group as coefficients_of;
pub use comparison_by_length::of_group as comparison_by_length_of;
pub use fits::of_group as fits_of;
pub use intervals::of_group as intervals_of;
pub use model_comparison::of_group as comparison_of;
pub use provenance::table as provenance;
pub use rejects::summary as rejects_summary;
pub use sessions::table as sessions;
pub use specimens::of_group as specimens_of;
pub use statistics::of_group as statistics_of;
pub use table1::of_group as table1_of;
pub use table2::of_group as table2_of;
pub use zeros::table as zeros;

/// The columns that tell groups of rows apart, in tables of all groups.
const GROUPS: [&str; 3] = ["campaign", "group", "diameter_mm"];

/// The same table with the columns for people that tell its groups apart, where it has more than one.
pub fn naming_groups(mut table: Table) -> Table {
    for k in 0..table.columns.len() {
        let varies = table.rows.iter().any(|row| row[k] != table.rows[0][k]);
        let column = &mut table.columns[k];
        if varies && GROUPS.contains(&column.key.as_str()) && column.audience == Audience::Machines
        {
            column.audience = Audience::Everyone;
        }
    }
    table
}
