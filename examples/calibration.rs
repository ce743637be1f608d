//! How often campaigns with nothing in them are answered with something, against the nominal level, for 4, 6 and 8 specimens.
//!
//! ```sh
//! cargo run --release --example calibration -- [CAMPAIGNS] [FIRST_SEED] [--redrawn] [--clean] [--published]
//! ```
//!
//! The search alone, without folds. With `--redrawn` the forces of every campaign are drawn anew from the null model fitted to it, with its own
//! restricted standard deviations: the level in a world in which the model is right. Prints a line a campaign: the probability of the
//! strongest candidate by the screen (linear, at the null), and what was accepted.

use pipeline::base::random::Stream;
use pipeline::base::row::Row;
use pipeline::config::{DiagnoseOptions, FitOptions};
use pipeline::effects;
use pipeline::inference::decisions;
use pipeline::inference::fit::Setting;
use pipeline::inference::problem::Problem;
use pipeline::inference::search::Search;
use pipeline::inference::statistic::upper_tail;
use pipeline::simulate::rig_like::{Family, Scatter, Settings, campaign};
use pipeline::stages::diagnose::base::Base;
use pipeline::stages::diagnose::data::Data;
use pipeline::stages::diagnose::library::{self, What};
use pipeline::stages::diagnose::{Declared, decision, draws, suited};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// What came of one campaign.
struct Outcome {
    /// The strongest candidate by the screen.
    screened: f64,
    /// Whether something was accepted.
    found: bool,
    words: String,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let given = |name: &str| arguments.iter().any(|a| a == name);
    let numbers: Vec<u64> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    let count = numbers.first().copied().unwrap_or(40);
    let first = numbers.get(1).copied().unwrap_or(1);
    let level = decisions::COMES_IN;
    println!("| specimens | campaigns | screen below {level} | found something |");
    println!("|---|---|---|---|");
    for specimens in [4, 6, 8] {
        let settings = Settings {
            specimens: Some(specimens),
            scatter: if given("--clean") {
                Scatter::Clean
            } else {
                Scatter::RigLike
            },
            family: if given("--published") {
                Family::Published
            } else {
                Family::Design
            },
            ..Settings::default()
        };
        let outcomes: Vec<Outcome> = (first..first + count)
            .into_par_iter()
            .map(|seed| {
                let outcome = tried(seed, &settings, given("--redrawn"));
                eprintln!("{specimens} {seed} {}", outcome.words);
                outcome
            })
            .collect();
        let screened = outcomes.iter().filter(|o| o.screened < decisions::COMES_IN);
        let found = outcomes.iter().filter(|o| o.found);
        println!(
            "| {specimens} | {count} | {} | {} |",
            screened.count(),
            found.count()
        );
    }
}

fn tried(seed: u64, settings: &Settings, redrawn: bool) -> Outcome {
    let rows = campaign(seed, settings).rows;
    let rows: Vec<&Row> = rows.iter().collect();
    let lengths: BTreeSet<u64> = rows.iter().map(|r| r.rest_length_m.to_bits()).collect();
    let base = Base::new(10, true, lengths.len(), &FitOptions::default());
    let mut data = Data::new(&rows).beside(&base).with_placebo(seed);
    if redrawn {
        data.force = anew(&base, &data, seed);
    }
    let library = library::terms(&data);
    let (problem, null) = suited(&base, &data, &library, &BTreeSet::new(), Declared::Taken);
    let setting = Setting::new(&problem);
    let options = DiagnoseOptions {
        most_effects: 5,
        ..DiagnoseOptions::default()
    };
    let search = Search {
        setting: &setting,
        decision: decision(&options),
        tried: None,
    };
    let found = search.run(null, &draws("draw", seed), None);
    let strongest = found.tested.first().map_or(f64::MIN, |(_, s)| s.deviate());
    let screened = upper_tail(&found.draws, strongest);
    let name = |t: usize| match library[t].what {
        What::Column(column) => column.name(&data),
        What::Effect { effect, .. } => {
            format!("{} {:?}", effects::all()[effect].id(), library[t].scope)
        }
    };
    let accepted = found.accepted.iter().map(|a| {
        let at = found.model.values(a.term).unwrap_or(&[]);
        format!("{} {at:.3?} p {:.3} gain {:.2}", name(a.term), a.p, a.gain)
    });
    let accepted: Vec<String> = accepted.collect();
    let first = found
        .tested
        .first()
        .map_or(String::new(), |(t, _)| name(*t));
    let sd: Vec<f64> = found.null.variances.components.clone();
    Outcome {
        screened,
        found: !found.accepted.is_empty(),
        words: format!(
            "screen {screened:.3} {first} critical {:.2}, sd {sd:.4?}: {}",
            found.critical,
            accepted.join("; ")
        ),
    }
}

/// Forces drawn from the null model that is fitted to some data: its own law at drawn random effects, not its tangent.
fn anew(base: &Base, data: &Data, seed: u64) -> Vec<f64> {
    let library = Vec::new();
    let (problem, null) = suited(base, data, &library, &BTreeSet::new(), Declared::Taken);
    let setting = Setting::new(&problem);
    let sd = null.restricted(&setting);
    let mut stream = Stream::new(seed, &["redrawn"]);
    let tree = problem.tree();
    let mut point = null.point.clone();
    let components = (0..tree.len()).flat_map(|n| tree.components_of(n));
    point.random = components
        .map(|c| sd.components[c] * stream.normal())
        .collect();
    let nonlinear = setting.nonlinear_columns();
    let noise: Vec<f64> = problem
        .class()
        .iter()
        .map(|c| sd.noise[*c] * stream.normal())
        .collect();
    let forces = problem.predict(&point).into_iter().enumerate();
    forces
        .map(|(i, force)| {
            let path = tree.path_numbers(problem.node()[i]);
            let linear = path
                .iter()
                .zip(&null.design.z[i])
                .filter(|(c, _)| !nonlinear[**c]);
            force + linear.map(|(c, z)| z * point.random[*c]).sum::<f64>() + noise[i]
        })
        .collect()
}
