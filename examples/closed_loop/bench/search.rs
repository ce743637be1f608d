//! The search, as the pipeline makes it.

use pipeline::base::row::Row;
use pipeline::config::{DiagnoseOptions, FitOptions};
use pipeline::findings::CampaignFindings;
use pipeline::simulate::rig_like;
use pipeline::stages::diagnose::diagnose;

/// What the loop says of a campaign with a base model.
///
/// # Panics
/// If it says nothing: every campaign here has more readings than it needs.
pub fn search(rows: &[Row], base: &str) -> CampaignFindings {
    let options = DiagnoseOptions {
        base_model: base.to_owned(),
        ..DiagnoseOptions::default()
    };
    diagnose(&rig_like::group(), rows, &FitOptions::default(), &options)
        .expect("enough readings")
        .findings
}
