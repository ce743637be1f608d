//! What people see of a table, rounded and parsed, before any format's signs are put around it.

use crate::markup::{self, Piece};
use crate::number::Rounded;
use crate::table::{Align, Audience, Cell, Column, Table};

/// A cell as people see it.
pub enum Printed {
    Empty,
    /// No finite number.
    Undefined,
    Text(String),
    Rich(Vec<Piece>),
    Number(Rounded),
    Interval(Rounded, Rounded),
    Flag(bool),
}

/// A column as people see it.
pub struct Head {
    /// Heading and unit.
    pub heading: Vec<Piece>,
    pub align: Align,
    /// Digits before and after the point, where the column holds nothing but plain numbers of about the same precision, not all
    /// whole: only then are they aligned at the point.
    pub decimal: Option<(usize, usize)>,
}

/// A heading over the columns `first..=last`, counted among those that people see.
pub struct Group {
    pub heading: Vec<Piece>,
    pub first: usize,
    pub last: usize,
}

/// A table as people see it.
pub struct PrintedTable {
    pub heads: Vec<Head>,
    pub groups: Vec<Group>,
    pub rows: Vec<Vec<Printed>>,
}

impl PrintedTable {
    /// Leaves out what only machines read, rounds, and parses the markup.
    pub fn new(table: &Table) -> PrintedTable {
        let seen: Vec<usize> = (0..table.columns.len())
            .filter(|&i| table.columns[i].audience != Audience::Machines)
            .collect();
        let row = |row: &Vec<Cell>| seen.iter().map(|&i| printed(&row[i])).collect();
        let rows: Vec<Vec<Printed>> = table.rows.iter().map(row).collect();
        let heads = seen.iter().enumerate();
        PrintedTable {
            heads: heads
                .map(|(at, &i)| head(&table.columns[i], rows.iter().map(|row| &row[at])))
                .collect(),
            groups: groups(table, &seen),
            rows,
        }
    }
}

fn head<'a>(column: &Column, cells: impl Iterator<Item = &'a Printed>) -> Head {
    let heading = match column.unit.markup() {
        "" => column.heading.clone(),
        unit => format!("{} ({unit})", column.heading),
    };
    Head {
        heading: markup::parse(&heading),
        align: column.align,
        decimal: (column.align == Align::Right)
            .then(|| decimal_places(cells))
            .flatten(),
    }
}

/// Decimals by which the numbers of an aligned column may differ; beyond, the gaps would look like mistakes.
const RAGGED: usize = 2;

fn decimal_places<'a>(cells: impl Iterator<Item = &'a Printed>) -> Option<(usize, usize)> {
    let mut numbers = Vec::new();
    for cell in cells {
        match cell {
            Printed::Empty => {}
            Printed::Number(n) if n.is_plain() => numbers.push(n),
            _ => return None,
        }
    }
    let wholes = numbers
        .iter()
        .map(|n| n.whole.len() + usize::from(n.negative));
    let fractions = || numbers.iter().map(|n| n.fraction.len());
    let (shortest, longest) = (fractions().min()?, fractions().max()?);
    let aligned = longest > 0 && longest - shortest <= RAGGED;
    aligned.then_some((wholes.max()?, longest))
}

fn groups(table: &Table, seen: &[usize]) -> Vec<Group> {
    let position = |key: &str| table.columns.iter().position(|c| c.key == key);
    let group = |span: &crate::table::Span| {
        let (first, last) = (position(&span.first)?, position(&span.last)?);
        let covered = |&at: &usize| (first..=last).contains(&seen[at]);
        let mut below = (0..seen.len()).filter(covered);
        let first = below.next()?;
        Some(Group {
            heading: markup::parse(&span.heading),
            first,
            last: below.next_back().unwrap_or(first),
        })
    };
    let mut groups: Vec<Group> = table.spans.iter().filter_map(group).collect();
    groups.sort_by_key(|g| g.first);
    groups
}

fn printed(cell: &Cell) -> Printed {
    match cell {
        Cell::Empty => Printed::Empty,
        Cell::Text(text) => Printed::Text(text.split_whitespace().collect::<Vec<_>>().join(" ")),
        Cell::Symbol(symbol) => Printed::Rich(markup::parse(symbol)),
        Cell::Integer(value) => Printed::Number(Rounded::integer(*value)),
        Cell::Number { value, rounding } => rounding
            .round(*value)
            .map_or(Printed::Undefined, Printed::Number),
        Cell::Interval {
            low,
            high,
            rounding,
        } => match (rounding.round(*low), rounding.round(*high)) {
            (Some(low), Some(high)) => Printed::Interval(low, high),
            _ => Printed::Undefined,
        },
        Cell::Flag(flag) => Printed::Flag(*flag),
    }
}
