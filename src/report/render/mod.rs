//! Tables as files: one renderer a format, in an explicit list. A new format is one file and one line in [`ALL`].

pub mod csv;
pub mod latex;
pub mod markdown;
mod printed;
pub mod typst;

use crate::table::Table;

/// Turns a table into the text of a file.
pub trait Renderer: Sync {
    /// Extension of the file, without a dot.
    fn extension(&self) -> &'static str;

    /// Whether programs read it, which want every row.
    fn is_data(&self) -> bool {
        false
    }

    /// The whole text of the file, lines ended by LF.
    fn render(&self, table: &Table) -> String;
}

/// Every format in which a table is written.
pub const ALL: [&dyn Renderer; 4] = [&csv::Csv, &latex::Latex, &typst::Typst, &markdown::Markdown];

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::table::{Audience, Cell, Column, Rounding};

    /// A small table that uses every kind of cell, a span, a rule, a note and characters that need escapes.
    pub(crate) fn sample() -> Table {
        let columns = vec![
            Column::text("model", "Model"),
            Column::text("campaign", "Campaign").seen_by(Audience::Machines),
            Column::text("coefficient", "Coefficient"),
            Column::number("value", "Value", "1/m"),
            Column::interval("ci", "95 % CI", "1/m"),
            Column::number("n", "\\v{n}", ""),
            Column::flag("fitted_here", "Fitted"),
        ];
        let mut table = Table::new("coefficients", "Coefficients of F_{620}, R^2 & ε*", columns)
            .note("Sizes in µm_; 5 % of all.")
            .span("Estimate", "value", "ci");
        let [value, ci] = Cell::with_interval(-7.1234, -8.3, -5.9);
        table.push(vec![
            Cell::text("A&B \"x\", #1"),
            Cell::text("c_1"),
            Cell::Symbol("b_1".into()),
            value,
            ci,
            Cell::Integer(12345),
            Cell::Flag(true),
        ]);
        table.rule();
        table.push(vec![
            Cell::text("two\nlines | a_b"),
            Cell::text("c2"),
            Cell::Symbol("F_{620}".into()),
            Cell::number(0.25, Rounding::Decimals(2)),
            Cell::Empty,
            Cell::Integer(7),
            Cell::Flag(false),
        ]);
        table
    }

    #[test]
    fn every_renderer_ends_its_lines_with_lf_and_repeats_itself() {
        for renderer in ALL {
            let text = renderer.render(&sample());
            assert!(text.ends_with('\n') && !text.contains('\r'));
            assert_eq!(text, renderer.render(&sample()));
            assert!(!renderer.extension().is_empty());
        }
    }
}
