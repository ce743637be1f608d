//! The integration tests, one binary: a debug build of the dependencies is large, and one link is enough.

mod bad_input;
mod cache;
mod closed_loop;
mod commands;
mod coverage;
mod formats;
mod golden;
mod intervals;
mod kill;
mod knee;
mod labels;
mod lookup;
mod mistakes;
mod models;
mod new_session;
mod numerics;
mod predict;
mod predict_coverage;
mod rig;
mod shipped;
mod simulated;
mod support;
mod torque;
mod torque_loop;
