//! Tables that are described: a column is its heading and what a cell of it says of a row.

use crate::input::ReportInput;
use crate::table::{Audience, Cell, Column, Table};
use crate::wording::name;
use pipeline_findings::CampaignFindings;

/// What a cell of a column says of a row.
type Says<R> = fn(&R) -> Cell;

/// A column of a table whose rows are made of `R`.
pub struct Described<R>(Column, Says<R>);

/// A column of words.
pub fn text<R>(key: &str, heading: &str, says: Says<R>) -> Described<R> {
    Described(Column::text(key, heading), says)
}

/// A column of numbers in a unit.
pub fn number<R>(key: &str, heading: &str, unit: &str, says: Says<R>) -> Described<R> {
    Described(Column::number(key, heading, unit), says)
}

/// A column of intervals.
pub fn interval<R>(key: &str, heading: &str, says: Says<R>) -> Described<R> {
    Described(Column::interval(key, heading, ""), says)
}

/// A column of marks.
pub fn flag<R>(key: &str, heading: &str, says: Says<R>) -> Described<R> {
    Described(Column::flag(key, heading), says)
}

impl<R> Described<R> {
    /// The same column in data files only.
    pub fn for_machines(self) -> Described<R> {
        Described(self.0.seen_by(Audience::Machines), self.1)
    }
}

/// One thing that was found, with the campaign, pool or joint that it was found of.
pub struct Of<'a, T> {
    /// The campaign, pool or joint.
    pub found: &'a CampaignFindings,
    /// The thing.
    pub one: T,
}

/// The columns that name the campaign, pool or joint, and the unit of its errors.
fn whose<'a, T>() -> Vec<Described<Of<'a, T>>> {
    vec![
        text("campaign", "Campaign", |r: &Of<T>| {
            Cell::text(&r.found.campaign)
        }),
        text("part", "Joint", |r| optional(r.found.part.as_deref())),
        number("diameter_mm", "⌀", "mm", |r| {
            Cell::Integer(i64::from(r.found.diameter_mm))
        }),
    ]
}

/// The unit of the errors of a row's campaign.
pub fn unit<'a, T>() -> Described<Of<'a, T>> {
    text("unit", "Unit", |r: &Of<T>| Cell::text(&r.found.unit))
}

/// The verdict of a row's campaign.
pub fn verdict<'a, T>() -> Described<Of<'a, T>> {
    text("verdict", "Verdict", |r: &Of<T>| {
        Cell::text(name::verdict_id(r.found.verdict))
    })
    .for_machines()
}

/// Words; an empty cell where there are none.
pub fn optional(text: Option<&str>) -> Cell {
    text.map_or(Cell::Empty, Cell::text)
}

/// A table of all campaigns, pools and joints: of each the things that `list` gives, in columns after those that name it.
pub fn of_all<'a, T>(
    input: &'a ReportInput,
    (id, caption): (&str, &str),
    columns: Vec<Described<Of<'a, T>>>,
    list: fn(&'a CampaignFindings) -> Vec<T>,
) -> Table {
    let columns: Vec<Described<Of<T>>> = whose().into_iter().chain(columns).collect();
    let headings = columns.iter().map(|c| c.0.clone()).collect();
    let mut table = Table::new(id, caption, headings);
    for found in input.all_findings() {
        table.rule();
        for one in list(found) {
            let row = Of { found, one };
            table.push(columns.iter().map(|c| (c.1)(&row)).collect());
        }
    }
    table
}
