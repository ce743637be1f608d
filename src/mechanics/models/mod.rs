//! The published force models, one file each, behind one interface.
//!
//! Every model maps a [`State`] to a [`Prediction`] through [`ForceModel`]. Pure equations are free functions, generic over
//! [`pipeline_numerics::real::Real`], so that the same code serves prediction (`f64`) and fitting or propagation of uncertainty
//! (`Dual`). A new model is one new file here and one line in the list below; comparison, report rows, help and the conformance
//! tests follow from the list.
//!
//! Deliberately absent: files at run time, data frames, fitting, global mutable state. Only the embedded Festo tables are parsed,
//! once, at their first use.

mod festo_table;
mod force_model;
pub mod gate;
mod ideal_braid;
mod martens_geometry;
mod prediction;
mod state;

pub use force_model::{Citation, Coefficient, ForceModel, values};
pub use prediction::{PRESSURE_SLACK_KPA, Prediction, Quantity, Reason};
pub use state::{Direction, P_620_KPA, State};

/// Declares the model files and lists their models, so that both stand in one line a model.
macro_rules! force_models {
    ($($file:ident :: $model:ident,)+) => {
        $(pub mod $file;)+

        /// Every published model, in the order of the report's rows.
        pub fn published() -> Vec<&'static dyn ForceModel> {
            vec![$(&$file::$model),+]
        }
    };
}

// rustfmt does not follow modules declared by a macro: check them with `rustfmt --edition 2024 --check src/mechanics/models/*.rs`.
force_models! {
    new::NewPublished,
    knee_paper::KneePaper,
    hunt2017::Hunt2017,
    festo_tool::FestoTool,
    sarosi2012::Sarosi2012,
    martens2017::Martens2017,
    chou_hannaford::ChouHannaford,
    tondu_lopez::TonduLopez,
}
