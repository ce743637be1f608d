//! `plan`: what it foresees of a small campaign, and what it says of mistakes in a plan.

use crate::support::{Bench, searched};
use pipeline::plan::design;
use serde_json::Value;

/// A plan that is searched in a second: two lengths of three actuators, five pressures.
const SMALL: &str = "schema = \"bpa-plan/1\"\ndiameter_mm = 10\nrest_lengths_mm = [112, 233, 382]\ncontraction_620 = 0.165\n\
                     contractions = [0, 0.5]\npressures_kpa = [100, 200, 300, 450, 620]\n";

fn planned(bench: &Bench, text: &str, options: &[&str]) -> crate::support::Said {
    std::fs::write(bench.root().join("plan.toml"), text).unwrap();
    bench.run(&[&["plan", "plan.toml"], options].concat())
}

#[test]
fn the_example_is_a_plan() {
    let bench = Bench::empty();
    let said = bench.run(&["plan", "--example"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let plan = design::read("example", &said.out).unwrap_or_else(|d| panic!("{d:?}"));
    assert_eq!(plan.readings(), 5 * 4 * 2 * 24);
    assert_eq!(plan.scatter, design::Scatter::default());
}

#[test]
fn mistakes_of_a_plan_are_named_with_their_line() {
    let bench = Bench::empty();
    for (from, to, parts) in [
        (
            "diameter_mm = 10",
            "diameter_mm = 15",
            &["plan.toml:2", "10, 20 or 40"][..],
        ),
        ("[112, 233, 382]", "[112]", &["plan.toml:3", "2 or more"]),
        (
            "contraction_620 = 0.165",
            "contraction_620 = 16.5",
            &["plan.toml:4", "0.05 to 0.4"],
        ),
        (
            "contractions",
            "contraction",
            &["contractions", "plan.toml"],
        ),
        (
            "620]\n",
            "620]\n[scatter]\ncontracted = 0.04\n",
            &["plan.toml:8", "0 to 0.033"],
        ),
        (
            "diameter_mm",
            "scatter_of = \"nobody\"\ndiameter_mm",
            &["nobody", "it has none"],
        ),
    ] {
        let said = planned(&bench, &SMALL.replace(from, to), &[]);
        assert_eq!(said.code, 2, "{to}: {}", said.out);
        said.warns_of(parts);
    }
    assert_eq!(bench.run(&["plan", "nowhere.toml"]).code, 2);
    assert_eq!(bench.run(&["plan"]).code, 2);
}

mod long {
    use super::*;
    use pipeline::base::row::Row;
    use pipeline::base::session::Phase;
    use pipeline::config::{DiagnoseOptions, FitOptions};
    use pipeline::plan::{design, draw, foresee};
    use pipeline::stages::diagnose::{decision, diagnose, draws, unseen};
    use pipeline::stages::fit::Group;
    use rayon::prelude::*;

    #[test]
    #[ignore = "long: 116 s of processor time"]
    fn a_small_campaign_is_foreseen_with_what_would_lower_its_error() {
        let bench = Bench::empty();
        let files = ["--csv", "limits.csv", "--plot", "plan.svg"];
        let said = planned(&bench, SMALL, &[&["--json"], &files[..]].concat());
        let drawn = std::fs::read_to_string(bench.root().join("plan.svg")).unwrap();
        assert!(drawn.contains("Plan of"), "{}", &drawn[..300]);
        assert_eq!(said.code, 0, "{}", said.err);
        let value: Value = serde_json::from_str(&said.out).unwrap();
        let foreseen = &value["foreseen"];
        assert_eq!(foreseen["draws"][0], 3);
        let error = foreseen["expected_rmse_n"].as_f64().unwrap();
        assert!(error > 1.0, "{foreseen}");
        let worth = foreseen["worth"].as_array().unwrap();
        assert_eq!(worth.len(), 5);
        let known = worth
            .iter()
            .find(|w| w["more"].get("lengths_known").is_some());
        assert!(
            known.unwrap()["less_n"].as_f64().unwrap() > 0.0,
            "{foreseen}"
        );
        let limits = crate::support::read_table(&bench.root().join("limits.csv"));
        assert_eq!(limits.len(), foreseen["limits"].as_array().unwrap().len());
        assert!(limits.iter().any(|l| l["effect"] == "hysteresis"));
        // The same plan has the same answer.
        assert_eq!(planned(&bench, SMALL, &["--json"]).out, said.out);
    }

    /// Campaigns for every effect, none of those from which the limits come.
    const SEEDS: std::ops::Range<u64> = 1000..1020;

    type Put = fn(&mut Row, f64);

    /// The effects as the readings show them, written down without the library.
    const EFFECTS: [(&str, &str, Put); 3] = [
        ("hysteresis", "constant, slack too", |r, size| {
            r.force_n += match r.phase {
                Some(Phase::Depressurizing) => size,
                _ => -size,
            };
        }),
        ("force_drift", "within a log", |r, size| {
            r.force_n += size * r.time_s
        }),
        ("length_offset", "constant", |r, size| {
            // What is noted is shorter than what is.
            r.length_m -= 1e-3 * size;
            r.contraction += 1e-3 * size / r.rest_length_m;
            r.contraction_rel += 1e-3 * size / (r.rest_length_m - r.contracted_length_m);
        }),
    ];

    #[test]
    #[ignore = "long: 430 s of processor time"]
    fn planned_campaigns_show_what_was_foreseen_at_its_limit() {
        let example = design::read("example", design::EXAMPLE).unwrap();
        let plan = design::Plan { runs: 1, ..example };
        let foreseen = foresee::foresee(&plan, &|_, _| {}).unwrap();
        // A limit is of the search and an error of its folds; a whole diagnosis also sets mistaken sessions aside, of which there are none here: two
        // show that it says the same.
        let options = DiagnoseOptions::default();
        let normal = draws("draw", options.seed);
        let number_and_error = |seed: &u64| {
            let rows = draw::rows(&plan, *seed);
            let rows: Vec<&Row> = rows.iter().collect();
            searched(plan.diameter_mm, &rows, |outcome, setting| {
                let decision = decision(&options);
                let nameless = |_| String::new();
                let held = unseen::held_out(outcome, setting, decision, &normal, nameless);
                let found = outcome.found.accepted.len();
                (found, held.after.rmse_heldout.unwrap())
            })
        };
        let seeds: Vec<u64> = SEEDS.collect();
        let plain: Vec<(usize, f64)> = seeds.par_iter().map(number_and_error).collect();
        let group = Group {
            campaign: draw::CAMPAIGN.to_owned(),
            diameter_mm: plan.diameter_mm,
            members: vec![draw::CAMPAIGN.to_owned()],
            simulated: true,
        };
        for (seed, (number, error)) in seeds.iter().zip(&plain).take(2) {
            let rows = draw::rows(&plan, *seed);
            let whole = diagnose(&group, &rows, &FitOptions::default(), &options).unwrap();
            let found = whole.findings;
            assert_eq!(found.effects.len() + found.unexplained.len(), *number);
            assert_eq!(found.after.rmse_heldout, Some(*error));
        }
        let answered = plain.iter().filter(|(n, _)| *n > 0).count();
        let realised = (plain.iter().map(|(_, e)| e * e).sum::<f64>() / plain.len() as f64).sqrt();
        let expected = foreseen.expected_rmse_n.unwrap();
        println!(
            "nothing in them: {answered} of {} answered; error {realised:.1} N, expected {expected:.1} N",
            plain.len()
        );
        // 5% of 20; more than 4 have a probability of 0.3%.
        assert!(answered <= 4);
        assert!(
            (0.6..1.7).contains(&(realised / expected)),
            "{realised} against {expected}"
        );
        for (id, form, put) in EFFECTS {
            let limit = foreseen
                .limits
                .iter()
                .find(|l| l.id == id && l.form == form)
                .unwrap();
            let shows = |seed: &&u64| {
                let mut rows = draw::rows(&plan, **seed);
                rows.iter_mut().for_each(|r| put(r, limit.smallest));
                let rows: Vec<&Row> = rows.iter().collect();
                searched(plan.diameter_mm, &rows, |outcome, _| {
                    let library = outcome.problem.library;
                    let mut terms = outcome.found.accepted.iter().map(|a| &library[a.term]);
                    terms.any(|t| t.id() == Some(id))
                })
            };
            let at = seeds.par_iter().filter(shows).count();
            println!(
                "{id}, {form}: {} {}: {at} of {}",
                limit.smallest,
                limit.unit,
                seeds.len()
            );
            // 80% of 20; fewer than 11 have a probability of 0.3%.
            assert!(at >= 11, "{id}: {at}");
        }
    }
}
