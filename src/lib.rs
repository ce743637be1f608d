#![warn(missing_docs)]
//! `pipeline`: from raw test-rig sessions of braided pneumatic actuators to a paper's tables, figures and reports.

pub mod base;
pub mod cache;
pub mod cli;
pub mod config;
pub mod formats;
pub mod models;
pub mod numerics;
pub mod report;
pub mod run;
pub mod simulate;
pub mod stages;
