//! How a table is described: column after column, each with its name in data files, its heading, its unit, its rounding and what it says of a
//! row.
//!
//! ```text
//! Described::<Row>::new("zeros", "The zero of the force channel")
//!     .text("session", "Session", |r| &r.session)
//!     .number("applied_n", "Taken off", N, Decimals(2), |r| r.applied_n)
//!     .rows(rows)
//! ```
//!
//! Rows are any small value that can be copied, mostly references into what the stages left. From a description and its rows comes a [`Table`], of
//! which every file is made.

pub use crate::number::Rounding::{self, Decimals, Digits, Percent};
pub use crate::table::Unit::{self, *};
pub use crate::table::{Audience, Cell, Column, Table};

/// What a cell of a column says of a row.
type Says<'a, R> = Box<dyn Fn(R) -> Cell + 'a>;

/// A table without its rows, which are made of `R`.
pub struct Described<'a, R> {
    table: Table,
    says: Vec<Says<'a, R>>,
    /// Columns that say nothing below the first row of a block.
    once: Vec<usize>,
}

impl<'a, R: Copy + 'a> Described<'a, R> {
    /// A table without columns.
    pub fn new(id: &str, caption: &str) -> Self {
        Self {
            table: Table::new(id, caption, Vec::new()),
            says: Vec::new(),
            once: Vec::new(),
        }
    }

    /// Adds a column.
    pub fn column(mut self, column: Column, says: impl Fn(R) -> Cell + 'a) -> Self {
        self.table.columns.push(column);
        self.says.push(Box::new(says));
        self
    }

    /// Adds a column of words; empty where there are none.
    pub fn text<W: Words>(self, key: &str, heading: &str, says: impl Fn(R) -> W + 'a) -> Self {
        let cell = move |row| says(row).text().map_or(Cell::Empty, Cell::Text);
        self.column(Column::text(key, heading), cell)
    }

    /// Adds a column of symbols in markup.
    pub fn symbol(self, key: &str, heading: &str, says: impl Fn(R) -> String + 'a) -> Self {
        let cell = move |row| Cell::Symbol(says(row));
        self.column(Column::text(key, heading), cell)
    }

    /// Adds a column of whole numbers; empty where there is none.
    pub fn count<C: Count>(
        self,
        key: &str,
        heading: &str,
        unit: Unit,
        says: impl Fn(R) -> C + 'a,
    ) -> Self {
        let cell = move |row| says(row).count().map_or(Cell::Empty, Cell::Integer);
        self.column(Column::number(key, heading, unit), cell)
    }

    /// Adds a column of numbers that are rounded alike; empty where there is none.
    pub fn number<X: Into<Option<f64>>>(
        self,
        key: &str,
        heading: &str,
        unit: Unit,
        rounding: Rounding,
        says: impl Fn(R) -> X + 'a,
    ) -> Self {
        self.rounded(key, heading, unit, move |row| (says(row), rounding))
    }

    /// Adds a column of numbers that are rounded row by row; empty where there is none.
    pub fn rounded<X: Into<Option<f64>>>(
        self,
        key: &str,
        heading: &str,
        unit: Unit,
        says: impl Fn(R) -> (X, Rounding) + 'a,
    ) -> Self {
        let cell = move |row| {
            let (value, rounding) = says(row);
            Cell::number(value, rounding)
        };
        self.column(Column::number(key, heading, unit), cell)
    }

    /// Adds a column of the values of estimates, which are rounded as their intervals allow.
    pub fn value(
        self,
        key: &str,
        heading: &str,
        unit: Unit,
        estimate: impl Fn(R) -> [Cell; 2] + 'a,
    ) -> Self {
        self.part_of_estimate(Column::number(key, heading, unit), 0, estimate)
    }

    /// Adds a column of the intervals of estimates.
    pub fn interval(
        self,
        key: &str,
        heading: &str,
        unit: Unit,
        estimate: impl Fn(R) -> [Cell; 2] + 'a,
    ) -> Self {
        self.part_of_estimate(Column::interval(key, heading, unit), 1, estimate)
    }

    fn part_of_estimate(
        self,
        column: Column,
        part: usize,
        estimate: impl Fn(R) -> [Cell; 2] + 'a,
    ) -> Self {
        self.column(column, move |row| estimate(row)[part].clone())
    }

    /// Adds a column of marks; empty where there is none.
    pub fn flag<F: Into<Option<bool>>>(
        self,
        key: &str,
        heading: &str,
        says: impl Fn(R) -> F + 'a,
    ) -> Self {
        let cell = move |row| says(row).into().map_or(Cell::Empty, Cell::Flag);
        self.column(Column::flag(key, heading), cell)
    }

    /// The last column in data files only.
    pub fn machines(self) -> Self {
        self.seen_by(Audience::Machines)
    }

    /// The last column in print only.
    pub fn people(self) -> Self {
        self.seen_by(Audience::People)
    }

    fn seen_by(mut self, audience: Audience) -> Self {
        if let Some(column) = self.table.columns.last_mut() {
            column.audience = audience;
        }
        self
    }

    /// The last column in the first row of every block only.
    pub fn once(mut self) -> Self {
        self.once.push(self.says.len() - 1);
        self
    }

    /// Adds a heading over the columns from `first` to `last`.
    pub fn span(mut self, heading: &str, first: &str, last: &str) -> Self {
        self.table = self.table.span(heading, first, last);
        self
    }

    /// Adds a remark below the table.
    pub fn note(mut self, note: &str) -> Self {
        self.table = self.table.note(note);
        self
    }

    /// The table of these rows.
    pub fn rows(self, rows: impl IntoIterator<Item = R>) -> Table {
        self.blocks([rows])
    }

    /// The table of these rows, parted by a rule where a block ends.
    pub fn blocks<B: IntoIterator<Item = R>>(
        mut self,
        blocks: impl IntoIterator<Item = B>,
    ) -> Table {
        for block in blocks {
            self.table.rule();
            for (k, row) in block.into_iter().enumerate() {
                let mut cells: Vec<Cell> = self.says.iter().map(|says| says(row)).collect();
                if k > 0 {
                    self.once.iter().for_each(|c| cells[*c] = Cell::Empty);
                }
                self.table.push(cells);
            }
        }
        self.table
    }
}

/// Rows in blocks of neighbours that are alike.
pub fn runs<R: Copy>(
    rows: impl IntoIterator<Item = R>,
    alike: impl Fn(&R, &R) -> bool,
) -> Vec<Vec<R>> {
    let rows: Vec<R> = rows.into_iter().collect();
    rows.chunk_by(alike).map(<[R]>::to_vec).collect()
}

/// A number if it is finite.
pub fn finite(value: impl Into<Option<f64>>) -> Option<f64> {
    value.into().filter(|x| x.is_finite())
}

/// What a column of words can say.
pub trait Words {
    /// The words; none where there is nothing to say.
    fn text(self) -> Option<String>;
}

impl Words for String {
    fn text(self) -> Option<String> {
        Some(self)
    }
}

impl Words for &str {
    fn text(self) -> Option<String> {
        Some(self.to_owned())
    }
}

impl Words for &String {
    fn text(self) -> Option<String> {
        Some(self.clone())
    }
}

impl<W: Words> Words for Option<W> {
    fn text(self) -> Option<String> {
        self?.text()
    }
}

impl Words for &Option<String> {
    fn text(self) -> Option<String> {
        self.clone()
    }
}

/// What a column of whole numbers can say.
pub trait Count {
    /// The number; none where there is none.
    fn count(self) -> Option<i64>;
}

impl Count for i64 {
    fn count(self) -> Option<i64> {
        Some(self)
    }
}

impl Count for u32 {
    fn count(self) -> Option<i64> {
        Some(self.into())
    }
}

impl Count for u64 {
    fn count(self) -> Option<i64> {
        Some(self as i64)
    }
}

impl Count for usize {
    fn count(self) -> Option<i64> {
        Some(self as i64)
    }
}

impl<C: Count> Count for Option<C> {
    fn count(self) -> Option<i64> {
        self?.count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_follows_from_its_columns_and_its_rows() {
        let rows = [("a", 1.25), ("a", f64::NAN), ("b", -0.5)];
        let table = Described::<(&str, f64)>::new("t", "T")
            .text("word", "Word", |(word, _)| word)
            .once()
            .number("mm", "l", Mm, Decimals(1), |(_, x)| finite(x))
            .count("n", "\\v{n}", One, |(_, x)| (x > 0.0).then_some(7_usize))
            .machines()
            .blocks(runs(rows, |a, b| a.0 == b.0));
        assert_eq!(table.columns[1].unit, Mm);
        assert_eq!(table.columns[2].audience, Audience::Machines);
        assert_eq!(table.rules, [2]);
        let number = |x| Cell::number(x, Decimals(1));
        assert_eq!(
            table.rows,
            [
                vec![Cell::text("a"), number(1.25), Cell::Integer(7)],
                vec![Cell::Empty, Cell::Empty, Cell::Empty],
                vec![Cell::text("b"), number(-0.5), Cell::Empty],
            ]
        );
    }
}
