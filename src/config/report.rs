//! The reports.

use crate::documented::Comments;
use serde::{Deserialize, Serialize};

documented! {
/// Options of the report stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReportOptions {
    /// Title of `force.pdf`.
    pub title: String,
    /// Authors, as printed; empty for none.
    pub author: String,
    /// Date of the document, ISO 8601; empty for none. Never today's.
    pub date: String,
    /// Resolution of the PNG figures, dots per inch.
    pub png_dpi: f64,
    /// Widths of the figures, one and two columns: "house" (85 and 175 mm), "ieee" (88 and 181 mm), "elsevier" (90 and 190 mm).
    pub figure_widths: FigureWidths,
    /// Whether `audit.pdf` is made: the papers' numeric claims, each recomputed. The table `audit` is made in any case.
    pub audit: bool,
}
}

/// For whose columns figures are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FigureWidths {
    /// Ours: two columns are as wide as the text of the reports.
    House,
    /// Journals of the IEEE.
    Ieee,
    /// Journals of Elsevier.
    Elsevier,
}

impl FigureWidths {
    /// Widths of one and of two columns, mm.
    pub fn columns_mm(self) -> [f64; 2] {
        match self {
            Self::House => [85.0, 175.0],
            Self::Ieee => [88.0, 181.0],
            Self::Elsevier => [90.0, 190.0],
        }
    }
}

impl Default for ReportOptions {
    fn default() -> Self {
        Self {
            title: "Isometric force of braided pneumatic actuators".to_owned(),
            author: String::new(),
            date: String::new(),
            png_dpi: 150.0,
            figure_widths: FigureWidths::House,
            audit: false,
        }
    }
}
