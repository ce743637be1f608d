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
    use crate::described::*;

    #[derive(Clone, Copy)]
    struct Row {
        model: &'static str,
        campaign: &'static str,
        symbol: &'static str,
        value: f64,
        ends: Option<(f64, f64)>,
        n: usize,
        fitted: bool,
    }

    const ROWS: [Row; 2] = [
        Row {
            model: "A&B \"x\", #1",
            campaign: "c_1",
            symbol: "b_1",
            value: -7.1234,
            ends: Some((-8.3, -5.9)),
            n: 12345,
            fitted: true,
        },
        Row {
            model: "two\nlines | a_b",
            campaign: "c2",
            symbol: "F_{620}",
            value: 0.25,
            ends: None,
            n: 7,
            fitted: false,
        },
    ];

    fn estimate(row: Row) -> [Cell; 2] {
        match row.ends {
            Some((low, high)) => Cell::with_interval(row.value, low, high),
            None => [Cell::number(row.value, Decimals(2)), Cell::Empty],
        }
    }

    /// A small table that uses every kind of cell, a span, a rule, a note and characters that need escapes.
    pub(crate) fn sample() -> Table {
        Described::<Row>::new("coefficients", "Coefficients of F_{620}, R^2 & ε*")
            .text("model", "Model", |r| r.model)
            .text("campaign", "Campaign", |r| r.campaign)
            .machines()
            .symbol("coefficient", "Coefficient", |r| r.symbol.to_owned())
            .value("value", "Value", NPerM, estimate)
            .interval("ci", "95 % CI", NPerM, estimate)
            .count("n", "\\v{n}", One, |r| r.n)
            .flag("fitted_here", "Fitted", |r| r.fitted)
            .note("Sizes in µm_; 5 % of all.")
            .span("Estimate", "value", "ci")
            .blocks(ROWS.map(|row| [row]))
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
