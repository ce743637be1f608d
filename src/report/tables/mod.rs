//! The tables, one file each. A new table is one new file and one line in [`ALL`].

mod alternatives;
mod audit;
mod baselines;
mod coefficients;
mod comparison_by_length;
mod described;
mod detection_limits;
mod findings;
mod goodness;
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
mod table1;
mod table2;
mod tested;
mod zeros;

use crate::described::{Described, Unit::Mm, Unit::One, finite};
use crate::figures::slug;
use crate::input::{GroupInput, ReportInput};
use crate::symbols;
use crate::table::{Audience, Table};
use crate::wording::number::error_rounding;
use pipeline_base::group::Group;
use pipeline_findings::CampaignFindings;

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
    |input| goodness::fits(&input.groups),
    |input| goodness::statistics(&input.groups),
    baselines::table,
    model_comparison::table,
    comparison_by_length::table,
    findings::table,
    scatter::scatter,
    scatter::budget,
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
pub use intervals::of_group as intervals_of;
pub use model_comparison::of_group as comparison_of;
pub use provenance::table as provenance;
pub use rejects::summary as rejects_summary;
pub use sessions::table as sessions;
pub use specimens::of_group as specimens_of;

/// The statistics of one group.
pub fn statistics_of(group: &GroupInput) -> Table {
    goodness::statistics(std::slice::from_ref(group)).named(&slug(group))
}
pub use table1::of_group as table1_of;
pub use table2::of_group as table2_of;
pub use zeros::table as zeros;

impl<'a, R: Copy + 'a> Described<'a, R> {
    /// The columns that tell groups of rows apart, for machines: [`naming_groups`] shows people those that they need.
    fn group(self, of: impl Fn(R) -> &'a Group + Copy + 'a) -> Self {
        self.text("campaign", "Campaign", move |r| &of(r).campaign)
            .machines()
            .count("diameter_mm", "⌀", Mm, move |r| of(r).diameter_mm)
            .machines()
    }

    /// An equation: its id for machines, its symbol for people.
    fn equation(self, id: impl Fn(R) -> &'a str + Copy + 'a) -> Self {
        self.text("equation", "Equation", id)
            .machines()
            .symbol("equation", "Equation", move |r| symbols::equation(id(r)))
            .people()
    }
}

/// Tables of all campaigns, pools and joints: rows are one of these and a thing that was found of it.
impl<'a, T: Copy + 'a> Described<'a, (&'a CampaignFindings, T)> {
    /// A table with the columns that name the campaign, pool or joint.
    fn found(id: &str, caption: &str) -> Self {
        Self::new(id, caption)
            .text("campaign", "Campaign", |(found, _)| &found.campaign)
            .text("part", "Joint", |(found, _)| &found.part)
            .count("diameter_mm", "⌀", Mm, |(found, _)| found.diameter_mm)
    }

    /// Adds a column of errors, in the unit of the campaign's; empty where there is none.
    fn error<X: Into<Option<f64>>>(
        self,
        key: &str,
        heading: &str,
        says: impl Fn((&'a CampaignFindings, T)) -> X + 'a,
    ) -> Self {
        self.rounded(key, heading, One, move |row| {
            let error = finite(says(row));
            let rounding = error_rounding(error.unwrap_or(f64::NAN), &row.0.unit);
            (error, rounding)
        })
    }

    /// The table of the things that `list` gives of each campaign, pool and joint.
    fn of_all(
        self,
        input: &'a ReportInput,
        list: impl Fn(&'a CampaignFindings) -> Vec<T>,
    ) -> Table {
        let rows = |found| list(found).into_iter().map(move |one| (found, one));
        self.blocks(input.all_findings().map(rows))
    }
}

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
