//! The tables: a file has one, or a few that are variants of each other, as [`Described`]. A new file is one line in the list below, with the
//! tables in it; `docs/adding-a-table.md` is a worked example.

use crate::described::{Described, Unit::Mm, Unit::One, finite};
use crate::figures::slug;
use crate::input::{GroupInput, ReportInput};
use crate::symbols;
use crate::table::{Audience, Table};
use crate::wording::name::uncapitalised;
use crate::wording::number::error_rounding;
use pipeline_base::group::Group;
use pipeline_findings::CampaignFindings;
use pipeline_torque::CampaignTorque;
use std::slice::from_ref;

/// What a table is made of.
#[derive(Clone, Copy)]
pub enum Of {
    /// Everything.
    Report(fn(&ReportInput) -> Table),
    /// Groups of rows: all of them, or one.
    Groups(fn(&[GroupInput]) -> Table),
    /// Campaigns of torque: all of them, or one.
    Torque(fn(&[CampaignTorque]) -> Table),
}

impl Of {
    /// The table of everything there is.
    pub fn all(self, input: &ReportInput) -> Table {
        match self {
            Of::Report(make) => make(input),
            Of::Groups(make) => make(&input.groups),
            Of::Torque(make) => make(input.torque()),
        }
    }
}

/// Declares the files of tables and lists their tables, so that both stand in one line a file.
macro_rules! tables {
    ($($file:ident: $of:ident[$($table:ident),+],)+) => {
        $(pub mod $file;)+

        /// Every table, in the order in which the summary lists them.
        pub const ALL: &[$crate::tables::Of] = &[$($($crate::tables::Of::$of($file::$table),)+)+];
    };
}

// rustfmt does not follow modules declared by a macro: check them with `rustfmt --edition 2024 --check src/report/tables/*.rs`.
tables! {
    sessions: Report[sessions],
    rejects: Report[rejects],
    zeros: Report[zeros],
    plateaus: Report[plateaus],
    specimens: Groups[specimens],
    paper: Groups[table1, table2],
    coefficients: Groups[coefficients, intervals],
    goodness: Groups[fits, statistics],
    baselines: Report[baselines],
    comparison: Groups[models, by_length],
    findings: Report[findings],
    scatter: Report[scatter, budget],
    tested: Report[tested, detection_limits],
    recording_errors: Report[recording_errors],
    held_out: Report[residual_errors, alternatives],
    provenance: Report[provenance],
}

/// Tables that people read in another arrangement than programs, by id, and what is printed in their place.
const IN_PRINT: [(&str, Of); 4] = [
    ("table1", Of::Groups(paper::table1_in_print)),
    ("table2", Of::Groups(paper::table2_in_print)),
    ("intervals", Of::Groups(coefficients::intervals_in_print)),
    ("knee_found", Of::Torque(knee::joints::found_in_print)),
];

/// What is printed of a table of everything there is.
pub fn in_print(data: &Table, input: &ReportInput) -> Table {
    let other = IN_PRINT.iter().find(|(id, _)| *id == data.id);
    other.map_or_else(|| data.clone(), |(_, of)| of.all(input))
}

mod audit;
pub mod knee;
pub mod meanings;
pub mod prediction;

pub use audit::audit;

/// The tables that the pages show once.
pub fn once(input: &ReportInput) -> [Table; 1] {
    [rejects::summary(input)]
}

/// The tables that the supplement shows once.
pub fn supplementary(input: &ReportInput) -> [Table; 4] {
    [
        sessions::sessions(input),
        zeros::zeros(input),
        baselines::baselines(input),
        provenance::provenance(input),
    ]
}

/// The tables that the pages show of one group, named after it.
pub fn of_group(group: &GroupInput) -> impl Iterator<Item = Table> {
    let shown: [fn(&[GroupInput]) -> Table; 3] = [
        paper::table1_in_print,
        paper::table2_in_print,
        comparison::models_in_print,
    ];
    of_one(shown, group, (slug(group), group_name(group)))
}

/// What captions call a group.
fn group_name(group: &GroupInput) -> String {
    let of = &group.fit.group;
    format!("{}, {} mm", of.campaign, of.diameter_mm)
}

/// The tables that the supplement shows of one group, named after it.
pub fn supplementary_of_group(group: &GroupInput) -> impl Iterator<Item = Table> {
    let shown: [fn(&[GroupInput]) -> Table; 5] = [
        specimens::specimens,
        coefficients::coefficients,
        coefficients::intervals_in_print,
        goodness::statistics,
        comparison::by_length,
    ];
    of_one(shown, group, (slug(group), group_name(group)))
}

/// The tables that the pages show of one thing, named after it in their files and in their captions.
fn of_one<T, const N: usize>(
    shown: [fn(&[T]) -> Table; N],
    one: &T,
    (file, name): (String, String),
) -> impl Iterator<Item = Table> {
    let tables = shown.into_iter().map(|make| make(from_ref(one)));
    tables.map(move |mut table| {
        table.caption = format!("{name}: {}", uncapitalised(&table.caption));
        table.named(&file)
    })
}

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

    /// A coefficient: its name for machines, its symbol for people.
    fn coefficient(self, heading: &str, name: impl Fn(R) -> &'a str + Copy + 'a) -> Self {
        let symbol = move |r| symbols::coefficient(name(r));
        self.text("coefficient", "Coefficient", name)
            .machines()
            .symbol("coefficient", heading, symbol)
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
