//! `report`: tables, figures and pages of everything. No rule of the list: its results are put in place between its units
//! ([`crate::reports`]), tables before the first figure is drawn.

use super::parts::*;
use pipeline_report::stage as report;

/// The stage.
pub const STAGE: Declared = Declared {
    stage: Stage {
        name: "report",
        version: report::VERSION,
        code: code::REPORT,
    },
    rules: &[],
};
