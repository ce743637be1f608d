//! The one model of a table: what its columns mean and what its cells hold. Renderers turn it into files.
//!
//! Headings, captions and notes are written in the markup of [`crate::markup`]; text cells are taken as they stand.

pub use crate::number::Rounding;

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Nothing to say: an empty field in data files, blank in print.
    Empty,
    /// Plain text.
    Text(String),
    /// A symbol in markup, such as `b_1`; data files hold it without braces.
    Symbol(String),
    /// A count.
    Integer(i64),
    /// A measured or computed value.
    Number {
        /// The value, in the unit of its column.
        value: f64,
        /// How it is rounded in print.
        rounding: Rounding,
    },
    /// Both ends of an interval: two fields in data files, `[low, high]` in print.
    Interval {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
        /// How the ends are rounded in print.
        rounding: Rounding,
    },
    /// Yes or no.
    Flag(bool),
}

impl Cell {
    /// Plain text.
    pub fn text(text: impl Into<String>) -> Cell {
        Cell::Text(text.into())
    }

    /// A value with so many significant digits in print; empty where there is none.
    pub fn number(value: impl Into<Option<f64>>, rounding: Rounding) -> Cell {
        match value.into() {
            Some(value) => Cell::Number { value, rounding },
            None => Cell::Empty,
        }
    }

    /// A value and its interval as two cells, both rounded to two digits of the half width.
    pub fn with_interval(value: f64, low: f64, high: f64) -> [Cell; 2] {
        let rounding = Rounding::ByInterval { low, high };
        [
            Cell::Number { value, rounding },
            Cell::Interval {
                low,
                high,
                rounding,
            },
        ]
    }
}

/// On which side of its column a cell stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// Marks.
    Center,
    /// Numbers, aligned at the decimal point.
    Right,
}

/// Who gets to see a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Audience {
    /// Data files and print.
    Everyone,
    /// Data files only.
    Machines,
    /// Print only.
    People,
}

/// The unit of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Pure numbers, and numbers whose unit stands in another column.
    One,
    /// Percent.
    PerCent,
    /// Percent of the maximum force.
    PercentOfMaximum,
    /// m.
    M,
    /// mm.
    Mm,
    /// Degrees.
    Degree,
    /// s.
    S,
    /// N.
    N,
    /// N.m.
    Nm,
    /// (N.m)^2.
    Nm2,
    /// N/m.
    NPerM,
    /// kPa.
    KPa,
}

impl Unit {
    /// In markup, as it stands in headings; empty for pure numbers.
    pub fn markup(self) -> &'static str {
        match self {
            Unit::One => "",
            Unit::PerCent => "%",
            Unit::PercentOfMaximum => "% of F_{max}",
            Unit::M => "m",
            Unit::Mm => "mm",
            Unit::Degree => "°",
            Unit::S => "s",
            Unit::N => "N",
            Unit::Nm => "N\u{a0}m",
            Unit::Nm2 => "N^{2}m^{2}",
            Unit::NPerM => "N/m",
            Unit::KPa => "kPa",
        }
    }
}

/// What a column means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name in data files, in snake case; an interval column becomes `{key}_low` and `{key}_high`.
    pub key: String,
    /// Name for people, in markup, without its unit.
    pub heading: String,
    /// Unit, shown in parentheses.
    pub unit: Unit,
    /// Side on which cells stand.
    pub align: Align,
    /// Holds intervals: two fields in data files.
    pub interval: bool,
    /// Who gets to see it.
    pub audience: Audience,
}

impl Column {
    /// A column of words.
    pub fn text(key: &str, heading: &str) -> Column {
        Column {
            key: key.into(),
            heading: heading.into(),
            unit: Unit::One,
            align: Align::Left,
            interval: false,
            audience: Audience::Everyone,
        }
    }

    /// A column of numbers in `unit`.
    pub fn number(key: &str, heading: &str, unit: Unit) -> Column {
        Column {
            unit,
            align: Align::Right,
            ..Column::text(key, heading)
        }
    }

    /// A column of intervals in `unit`.
    pub fn interval(key: &str, heading: &str, unit: Unit) -> Column {
        Column {
            unit,
            align: Align::Center,
            interval: true,
            ..Column::text(key, heading)
        }
    }

    /// A column of marks.
    pub fn flag(key: &str, heading: &str) -> Column {
        Column {
            align: Align::Center,
            ..Column::text(key, heading)
        }
    }
}

/// A heading over several neighbouring columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Span {
    /// The heading, in markup.
    pub heading: String,
    /// Key of the first column below it.
    pub first: String,
    /// Key of the last column below it.
    pub last: String,
}

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Name of its files and anchor for references, in snake case.
    pub id: String,
    /// What it shows, in markup.
    pub caption: String,
    /// Remarks below it, in markup.
    pub notes: Vec<String>,
    /// Its columns.
    pub columns: Vec<Column>,
    /// Headings over several columns.
    pub spans: Vec<Span>,
    /// Its rows, each as long as `columns`.
    pub rows: Vec<Vec<Cell>>,
    /// Rows before which a rule parts two groups.
    pub rules: Vec<usize>,
}

impl Table {
    /// A table without rows.
    pub fn new(id: &str, caption: &str, columns: Vec<Column>) -> Table {
        Table {
            id: id.into(),
            caption: caption.into(),
            notes: Vec::new(),
            columns,
            spans: Vec::new(),
            rows: Vec::new(),
            rules: Vec::new(),
        }
    }

    /// The same table with a remark below it.
    pub fn note(mut self, note: &str) -> Table {
        self.notes.push(note.into());
        self
    }

    /// The same table with a heading over the columns from `first` to `last`.
    pub fn span(mut self, heading: &str, first: &str, last: &str) -> Table {
        self.spans.push(Span {
            heading: heading.into(),
            first: first.into(),
            last: last.into(),
        });
        self
    }

    /// Adds a row.
    ///
    /// # Panics
    /// If it has not as many cells as the table has columns: a mistake in the code that fills the table.
    pub fn push(&mut self, row: Vec<Cell>) {
        assert_eq!(
            row.len(),
            self.columns.len(),
            "table {}: a row must have a cell for every column",
            self.id
        );
        self.rows.push(row);
    }

    /// The same table under a name of its own: that of one group or campaign after that of the table.
    pub fn named(mut self, of: &str) -> Table {
        self.id = format!("{}-{of}", self.id);
        self
    }

    /// The same table with its first rows only, and a remark that says where the others are; the table as it is where it has no more.
    pub fn first_rows(mut self, most: usize) -> Table {
        let all = self.rows.len();
        if all <= most {
            return self;
        }
        self.rows.truncate(most);
        self.rules.retain(|at| *at < most);
        let file = self.id.replace('_', "\\_");
        self.note(&format!(
            "The first {most} of {all} rows; tables/{file}.csv has all."
        ))
    }

    /// Parts the rows so far from those to come by a rule; does nothing before the first row or twice in a row.
    pub fn rule(&mut self) {
        let at = self.rows.len();
        if at > 0 && self.rules.last() != Some(&at) {
            self.rules.push(at);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_and_its_interval_share_their_rounding() {
        let [value, interval] = Cell::with_interval(7.1234, 5.9, 8.3);
        let Cell::Number { rounding, value } = value else {
            panic!("a number");
        };
        assert_eq!(rounding.round(value).unwrap().ascii(), "7.1");
        assert!(matches!(interval, Cell::Interval { rounding: r, .. } if r == rounding));
    }

    #[test]
    fn a_long_table_is_cut_and_says_so() {
        let mut table = Table::new("t", "T", vec![Column::text("a", "A")]);
        for _ in 0..5 {
            table.push(vec![Cell::Empty]);
            table.rule();
        }
        assert_eq!(table.clone().first_rows(5), table);
        let cut = table.first_rows(3);
        assert_eq!((cut.rows.len(), cut.rules), (3, vec![1, 2]));
        assert_eq!(cut.notes, ["The first 3 of 5 rows; tables/t.csv has all."]);
    }

    #[test]
    fn rules_stand_between_rows_only() {
        let mut table = Table::new("t", "T", vec![Column::text("a", "A")]);
        table.rule();
        table.push(vec![Cell::Empty]);
        table.rule();
        table.rule();
        assert_eq!(table.rules, [1]);
    }

    #[test]
    #[should_panic(expected = "a cell for every column")]
    fn a_short_row_is_a_mistake() {
        Table::new("t", "T", vec![Column::text("a", "A")]).push(vec![]);
    }
}
