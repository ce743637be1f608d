#![warn(missing_docs)]
//! `pipeline`: from raw test-rig sessions of braided pneumatic actuators to a paper's tables, figures and reports.
//!
//! This page is the map. The `lib.rs` or `mod.rs` of every folder goes on from here.
//!
//! # What happens to a session
//! ```text
//! raw/…/session.toml + logs        (never written)
//!   ingest     every row, calibrated, one unit a quantity        stages::ingest     formats
//!   clean      rows that are no measurements out; the force       stages::clean      numerics::plateaus
//!              channel's zero off; steady plateaus -> readings
//!   normalize  eps, eps*, P* of every reading -> rows             stages::normalize
//!   fit        the new model, equation by equation and jointly,   stages::fit        models, numerics
//!              with intervals from refits without each specimen
//!   compare    every model on the same rows                       stages::compare    models
//!   diagnose   one mixed model: scatter, misfit, the effects     stages::diagnose   inference, effects, models
//!              that the law lacks, the budget of the error
//!   torque     torque about a knee: geometry, every model, the    stages::torque     knee, models, numerics
//!              length of the end fittings, what the rigid leg
//!              lacks
//!   report     tables, figures, force.pdf, knee.pdf,              stages::report     report
//!              residual.pdf, supplement.pdf, explorer.html,
//!              findings.json, summary.json
//! derived/  the cache and the tidy data        reports/  for people
//! ```
//! The first three stages work on one session at a time, `fit` and `compare` on one group of rows (a campaign and diameter, or a
//! diameter over all measured campaigns), `diagnose` on one of these (not on large pools), `torque` on one campaign of torque, `report` on everything.
//!
//! # Where things are
//! | folder | idea | to add to it |
//! |---|---|---|
//! | [`base`] | units, column names, tables, diagnostics, errors; what a session, a reading and a row are | |
//! | [`cache`] | keys, objects by content, reasons for a rerun, what may go ([`cache::collect`]) | |
//! | [`formats`] | `session.toml`, logs, finding sessions | a log format: one file, one line in `formats/lib.rs` |
//! | [`models`] | one file a force model: pure equations, published coefficients, domain | one file, one line in `models/mod.rs` |
//! | [`effects`] | the one registry, a file an effect: what a force model, a rig or a joint may lack, with its operator on the force | one file, one line in `effects/lib.rs`; torque, simulator: `docs/effects.md` |
//! | [`numerics`] | least squares, robust losses, statistics, plateaus: slices in, vectors out | |
//! | [`knee`] | joints, routes, moment arms, torque of actuators and of human muscles | a knee: one TOML file |
//! | [`inference`] | one mixed model and what is asked of it; knows neither force nor torque (a crate of its own) | |
//! | [`findings`] | the answers of the loop as values: `findings.json` | |
//! | [`simulate`] | the test rig in software | |
//! | [`stages`] | one crate a stage, pure; what each declares is in [`run::stages`] | a stage: `docs/adding-a-stage.md` |
//! | [`audit`] | the papers' numeric claims, recomputed | a claim: a few lines of TOML |
//! | [`report`] | tables, figures, pages, the page for a browser | a table or figure: one file, one line in its folder's `mod.rs` |
//! | [`predict`] | the force of a muscle that somebody describes, with its interval; its torque in a described leg | |
//! | [`portable`] | a model of the force as C, Python, MATLAB, MuJoCo and a table, with the points that hold them to it | a language: one file, one line in `portable/languages/mod.rs` |
//! | [`inspect`] | one session by itself, against what a run knows of others | a check: one file, one line in `inspect/lib.rs` |
//! | [`plan`] | what a campaign that has not been measured yet could show | |
//! | [`draft`] | a first `session.toml` for a log, guessed from its columns | |
//! | [`golden`] | fresh tables against blessed ones | a table: one entry in `tests/golden/golden.toml` |
//! | [`run`] | the list of stages as declarations ([`run::rule`]), and what walks it through the cache ([`run::walk`]): one whole run at a time on a directory, or many jobs ([`run::jobs`]); where an artifact comes from ([`run::ancestry`]) | |
//! | [`bundle`] | a run as an RO-Crate for a repository | |
//! | [`export`] | the jobs of a run as a workflow of another engine | an engine: one file, one line in `export/lib.rs` |
//! | [`config`] | `pipeline.toml` | |
//! | [`cli`] | arguments, and all printing: init, run, status, summary, explain, graph, check, predict, design, plan, diff, check-session, explore, simulate, new-session, gc, export, bundle, completions, man | |
//!
//! # Invariants
//! - **Directions**: every folder with a `Cargo.toml` is a crate, and what it does not name there it cannot use. Each line has all that one crate
//!   names, and names only crates of lines below it; `tests/it/crates.rs` holds every `Cargo.toml` to this list:
//!   ```text
//!   cli       -> bundle, export, run, report, inspect, plan, portable, predict, draft, compare, diagnose, fit, config, formats, simulate, cache, golden, mechanics, base, findings
//!   bundle    -> run, config, formats, base
//!   export    -> run, formats, base
//!   run       -> report, inspect, torque, clean, compare, diagnose, fit, ingest, config, formats, cache, normalize, base, findings
//!   report    -> audit, predict, torque, clean, compare, diagnose, draft, fit, ingest, config, formats, effects, inference, mechanics, base, findings, numerics
//!   audit     -> compare, fit, mechanics, numerics
//!   portable  -> fit, effects, mechanics, base, findings, numerics
//!   predict   -> compare, diagnose, fit, mechanics, base, numerics
//!   inspect   -> clean, diagnose, fit, ingest, config, formats, normalize, effects, mechanics, base, findings, numerics
//!   plan      -> diagnose, fit, config, mechanics, base, findings
//!   torque    -> diagnose, config, inference, effects, mechanics, base, findings, numerics
//!   clean     -> ingest, config, base, numerics
//!   compare   -> fit, config, mechanics, base, numerics
//!   diagnose  -> fit, config, inference, effects, mechanics, base, findings, numerics; its tests -> simulate
//!   draft     -> formats, base
//!   fit       -> config, mechanics, base, findings, numerics
//!   ingest    -> formats, base
//!   config    -> mechanics, base, numerics
//!   simulate  -> effects, mechanics, base, numerics; its tests -> formats
//!   formats   -> mechanics, base
//!   cache     -> base
//!   golden    -> base
//!   inference -> numerics
//!   effects   -> mechanics, numerics
//!   mechanics -> base, numerics
//!   normalize -> base
//!   base      -> nothing
//!   findings  -> nothing
//!   numerics  -> nothing
//!   ```
//!   and these libraries are used by no other crate:
//!   ```text
//!   plotters, plotters-backend, resvg, rustybuzz, png, typst, typst-as-lib, typst-pdf: report
//!   clap, clap_complete, clap_mangen, indicatif: cli
//!   multiversion: inference
//!   polars, polars-buffer, polars-parquet: base, formats
//!   ```
//!   So `cache` knows no stage, and stages know neither cache nor command line; `mechanics`, `effects`, `inference` and `numerics` do no I/O and see no data
//!   frame. Only
//!   `report` knows plotters, Typst and HTML, and it computes no statistic: every number comes from a stage, every
//!   curve, band and running median, and whether specimens' own estimates differ, from `mechanics` and `numerics`.
//! - **Values, then words**: what was found travels as values ([`findings`]); [`report::wording`] makes names and sentences of them for pages, tables and the
//!   terminal, and nothing reads a sentence back. A message on bad input is made where the input is read, with file, row and column, and is not changed
//!   afterwards.
//! - **Nothing below `raw/` is ever written**, and nothing is left out without a line in `rejects.csv`.
//! - **Same inputs, same bytes**: no clock, host, path or hash order in an output; sums in the order of rows; transcendental functions
//!   from `libm` (`clippy.toml` bans the platform's); units meet only in sorted collections, so the number of jobs does not matter.
//! - **A stage reads what it declares** ([`run::rule`]): its function gets these inputs and options and no others ([`run::given`]). Order, jobs, `explain`,
//!   `graph`, `status`, export and keys follow from the list; only `report` is driven by hand ([`run::reports`]).
//! - **A key holds everything that a result depends on** ([`cache::key`]): the code of the stage too, which is its crate, the crates below it and their
//!   libraries, with their features, from the graph of crates (`src/run/fingerprint.rs`).
//! - **Bad input is a value, not an error**: it becomes a [`base::diagnostics::Diagnostic`] and a [`base::reject::Reject`]; the run goes
//!   on. An [`base::error::Error`] ends a command and has an exit code.
//! - **A figure or document that cannot be built is a value as well** ([`report::left_out`]): it is left out and named, tables and findings are
//!   in place before any of them is begun.
//! - **Only what is declared is corrected** ([`stages::clean`]): a drift, gain or compliance stays in the readings for the residual search.
//! - **One unit a quantity inside** ([`base::units`]): N, kPa, m, rad, s, N.m, degrees Celsius; and one home of column names
//!   ([`base::columns`]).

pub use pipeline_audit as audit;
pub use pipeline_base as base;
pub use pipeline_bundle as bundle;
pub use pipeline_cache as cache;
pub use pipeline_cli as cli;
pub use pipeline_config as config;
pub use pipeline_draft as draft;
pub use pipeline_effects as effects;
pub use pipeline_export as export;
pub use pipeline_findings as findings;
pub use pipeline_formats as formats;
pub use pipeline_golden as golden;
pub use pipeline_inference as inference;
pub use pipeline_inspect as inspect;
pub use pipeline_mechanics::{knee, models};
pub use pipeline_numerics as numerics;
pub use pipeline_plan as plan;
pub use pipeline_portable as portable;
pub use pipeline_predict as predict;
pub use pipeline_report as report;
pub use pipeline_run as run;
pub use pipeline_simulate as simulate;

/// The stages, in the order in which they run; that of the report is [`report::stage`].
pub mod stages {
    pub use pipeline_clean as clean;
    pub use pipeline_compare as compare;
    pub use pipeline_diagnose as diagnose;
    pub use pipeline_fit as fit;
    pub use pipeline_ingest as ingest;
    pub use pipeline_normalize as normalize;
    pub use pipeline_torque as torque;
}
