//! How often the law's dependence on the resting length is left out of simulated campaigns that have it, and of campaigns that do not; with a frame that
//! yields and without.
//!
//! ```sh
//! cargo run --release --example length_law -- [CAMPAIGNS] [FIRST_SEED] [--published]
//! ```
//!
//! The search alone, without folds. Forces of campaigns without the dependence are those of campaigns with it, divided for each specimen by what the
//! dependence makes of F_620. Prints a line a campaign on stderr, and a Markdown table.

use pipeline::base::row::Row;
use pipeline::config::{DiagnoseOptions, FitOptions};
use pipeline::effects;
use pipeline::models::new;
use pipeline::simulate::rig_like::{Campaign, Family, Put, Settings, campaign};
use pipeline::stages::diagnose::base::Base;
use pipeline::stages::diagnose::data::Data;
use pipeline::stages::diagnose::library::{self, What};
use pipeline::stages::diagnose::{Declared, decision, draws, length_law, suited};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_2;

/// Compliances of the frame, um/N: none, the laboratory's, and about three times that.
const COMPLIANCES: [f64; 3] = [0.0, 14.0, 40.0];

/// What a search said.
struct Answer {
    left_out: bool,
    found: Vec<&'static str>,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Vec<u64> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    let count = numbers.first().copied().unwrap_or(20);
    let first = numbers.get(1).copied().unwrap_or(1);
    let family = if arguments.iter().any(|a| a == "--published") {
        Family::Published
    } else {
        Family::Design
    };
    println!(
        "| law depends on the resting length | compliance, um/N | campaigns | left out | compliance found | nothing found |"
    );
    println!("|---|---|---|---|---|---|");
    for depends in [true, false] {
        for compliance in COMPLIANCES {
            let one = |seed: u64| {
                let answer = asked(seed, family, depends, compliance);
                eprintln!(
                    "{depends} {compliance} {seed}: left out {}, found {:?}",
                    answer.left_out, answer.found
                );
                answer
            };
            let answers: Vec<Answer> = (first..first + count).into_par_iter().map(one).collect();
            let of = |is: &dyn Fn(&Answer) -> bool| answers.iter().filter(|a| is(a)).count();
            println!(
                "| {} | {compliance} | {count} | {} | {} | {} |",
                if depends { "yes" } else { "no" },
                of(&|a| a.left_out),
                of(&|a| a.found.contains(&effects::series_compliance::ID)),
                of(&|a| a.found.is_empty()),
            );
        }
    }
}

fn asked(seed: u64, family: Family, depends: bool, compliance: f64) -> Answer {
    let put = Put {
        id: effects::series_compliance::ID,
        form: "linear",
        size: compliance,
        others: &[],
        from: 0.0,
    };
    let made = campaign(
        seed,
        &Settings {
            family,
            effects: if compliance > 0.0 {
                vec![put]
            } else {
                Vec::new()
            },
            ..Settings::default()
        },
    );
    let rows = if depends { made.rows } else { levelled(made) };
    let rows: Vec<&Row> = rows.iter().collect();
    let lengths: BTreeSet<u64> = rows.iter().map(|r| r.rest_length_m.to_bits()).collect();
    let base = Base::new(10, true, lengths.len(), &FitOptions::default());
    let laws = base.with_and_without_length_law();
    let options = DiagnoseOptions::default();
    let data = Data::new(&rows)
        .beside(&base)
        .with_placebo(seed)
        .thinned(options.most_readings);
    let library = library::terms(&data);
    let nobody = BTreeSet::new();
    let (problem, null) = suited(&base, &data, &library, &nobody, Declared::Taken);
    let outcome = length_law::searched(
        problem,
        null,
        laws.as_ref(),
        &nobody,
        decision(&options),
        &draws("draw", options.seed),
    );
    let name = |t: usize| match library[t].what {
        What::Column(_) => "column",
        What::Effect { effect, .. } => effects::all()[effect].id(),
    };
    Answer {
        left_out: outcome.replaced.is_some(),
        found: outcome
            .found
            .accepted
            .iter()
            .map(|a| name(a.term))
            .collect(),
    }
}

/// The rows of a campaign whose actuators are all as strong as an endless one.
fn levelled(made: Campaign) -> Vec<Row> {
    let law = &made.truth.drawn.law;
    let mut rows = made.rows;
    for row in &mut rows {
        let own = new::f620(law.b1, law.b2, law.l_0, row.rest_length_m);
        row.force_n *= law.b1 * FRAC_PI_2 / own;
    }
    rows
}
