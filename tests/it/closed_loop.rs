//! The loop on campaigns that scatter as a laboratory's rig does: a handful of campaigns, what the log of
//! `cargo run --release --example closed_loop` has, and, long, the answers to the fixed campaigns that say whether it is of this loop.

#[path = "../../examples/closed_loop/bench/mod.rs"]
mod bench;

use bench::cases::{self, Case, SINGLE};
use bench::digest;
use bench::outcome::Outcome;
use bench::plan::{MULTIPLES, Plan};
use bench::progress::known;
use bench::rate::Rate;
use bench::search::search;
use bench::table;
use bench::trial::{Part, Trial};
use pipeline::base::row::Row;
use pipeline::config::{DiagnoseOptions, FitOptions};
use pipeline::findings::{CampaignFindings, ColumnLimit, Verdict};
use pipeline::simulate::rig_like::{
    Campaign, Family, Mistake, Pace, Put, Scatter, Settings, campaign, group,
};
use pipeline::stages::diagnose::diagnose;

/// The page that has the published table.
const DOCUMENT: &str = include_str!("../../docs/closed-loop.md");

fn put(id: &'static str, form: &'static str, size: f64, from: f64) -> Vec<Put> {
    vec![Put {
        id,
        form,
        size,
        others: &[],
        from,
    }]
}

fn searched(seed: u64, effects: Vec<Put>) -> (CampaignFindings, Campaign) {
    let settings = Settings {
        specimens: Some(5),
        effects,
        ..Settings::default()
    };
    let made = campaign(seed, &settings);
    (search(&made.rows, "new"), made)
}

fn names(found: &CampaignFindings) -> Vec<&str> {
    found.effects.iter().map(|e| e.id.as_str()).collect()
}

fn has(found: &CampaignFindings, id: &str) -> bool {
    found
        .effects
        .iter()
        .any(|e| e.id == id || e.class.iter().any(|c| c == id))
}

#[test]
fn scatter_alone_is_no_effect_and_is_reported_as_scatter() {
    let (found, made) = searched(211, Vec::new());
    assert_eq!(found.verdict, Verdict::None, "{:?}", names(&found));
    let set_length = found.scatter.iter().find(|s| s.id == "length_offset");
    let ratio = set_length.expect("set lengths").sd / made.truth.drawn.sizes.length_mm;
    assert!((0.5..2.0).contains(&ratio), "{ratio}");
    assert!(
        found
            .detection_limits
            .iter()
            .any(|l| l.id == "hysteresis" && l.smallest < 3.0)
    );
    // Of every logged column, and of the channels themselves; not of the shuffled one.
    let mut columns: Vec<&str> = found
        .column_limits
        .iter()
        .map(|l| l.column.as_str())
        .collect();
    columns.dedup();
    assert_eq!(
        columns,
        [
            "age_days",
            "humidity",
            "temperature_c",
            "force_n",
            "pressure_kpa"
        ]
    );
}

/// The library has what the temperature does to the size of the force, not to the zero of a load cell.
#[test]
fn a_zero_that_moves_with_the_temperature_is_told_as_a_dependence_on_it() {
    let settings = Settings {
        specimens: Some(5),
        ..Settings::default()
    };
    let mut rows = campaign(211, &settings).rows;
    let temperature = |row: &Row| row.extras["temperature_c"];
    let mean = rows.iter().map(temperature).sum::<f64>() / rows.len() as f64;
    for row in &mut rows {
        row.force_n += 1.5 * (temperature(row) - mean);
    }
    let found = search(&rows, "new");
    assert_eq!(names(&found), [""; 0]);
    let columns: Vec<(&str, &str)> = found
        .unexplained
        .iter()
        .map(|u| (u.column.as_str(), u.shape.as_str()))
        .collect();
    assert_eq!(columns, [("temperature_c", "offset")]);
}

#[test]
fn a_wrong_resting_length_is_pointed_at() {
    let settings = Settings {
        specimens: Some(5),
        mistake: Some(Mistake::RestLength),
        ..Settings::default()
    };
    let made = campaign(215, &settings);
    let found = search(&made.rows, "new");
    let told = made.truth.mistaken.expect("a mistake");
    let right = |g: &String| *g == told.group || told.sessions.contains(g);
    assert!(found.recording_errors.iter().any(|r| right(&r.group)));
    assert!(found.effects.is_empty(), "{:?}", names(&found));
}

/// What the benchmark stands on: sizes become those of the simulator, and every case is one of its effects.
#[test]
fn every_case_of_the_benchmark_can_be_simulated() {
    let families = [Family::Design, Family::Published];
    let others = families
        .iter()
        .flat_map(|f| [cases::other_forms(*f), cases::outside(*f)]);
    let all: Vec<Case> = others.flatten().chain(SINGLE).copied().collect();
    for case in all {
        let settings = Settings {
            specimens: Some(4),
            pace: case.pace,
            effects: vec![case.put(0.1 * case.most, 16)],
            ..Settings::default()
        };
        let made = campaign(217, &settings);
        assert!(
            made.rows.iter().all(|r| r.force_n.is_finite()),
            "{}",
            case.name()
        );
        let plain = Settings {
            effects: Vec::new(),
            ..settings
        };
        let read = |c: &Campaign| -> Vec<[f64; 2]> {
            let both = |r: &Row| [r.force_n, r.pressure_kpa];
            c.rows.iter().map(both).collect()
        };
        assert_ne!(read(&made), read(&campaign(217, &plain)), "{}", case.name());
    }
    assert_eq!(SINGLE.iter().filter(|c| c.pace == Pace::Dwell).count(), 1);
}

/// What the log beside the published table has of this loop: the campaigns of so many seeds as have all been searched.
fn published() -> (Vec<Trial>, Vec<Outcome>) {
    let (_, answers) = DOCUMENT
        .split_once("Answers to the twelve fixed campaigns: `")
        .expect("the digest of the answers");
    let answers = answers.split('`').next().expect("its end");
    let known = known(include_str!("../../docs/closed-loop.jsonl"), answers);
    let of_seeds = |seeds| {
        let family = Family::Published;
        let trials = Plan { family, seeds }.trials();
        let outcomes = trials.iter().map(|t| known.get(&t.name()).cloned());
        let outcomes: Option<Vec<Outcome>> = outcomes.collect();
        outcomes.map(|o| (trials, o))
    };
    let complete = (1..).map_while(of_seeds);
    complete.last().expect("at least one seed of every case")
}

#[test]
fn the_rows_of_the_published_table_are_what_the_log_has() {
    let (trials, outcomes) = published();
    for scatter in [Scatter::RigLike, Scatter::Clean] {
        for bar in table::bars(&trials, &outcomes, scatter) {
            let line = bar.line();
            assert!(
                DOCUMENT.lines().any(|l| l == line),
                "docs/closed-loop.md does not have: {line}"
            );
        }
    }
}

/// The share of right answers that a part of the benchmark has to reach. Few campaigns cannot show that a bar is met: what fails here is far
/// below it.
struct Bar {
    part: Part,
    share: f64,
    right: fn(&Outcome) -> bool,
}

const fn bar(part: Part, share: f64, right: fn(&Outcome) -> bool) -> Bar {
    Bar { part, share, right }
}

/// Fails where a part of the published campaigns is far below its bar. Of what was put in at a multiple of its limit, those at the largest are judged.
fn keep_to_bars(bars: &[Bar]) {
    let (trials, outcomes) = published();
    for bar in bars {
        let own = trials.iter().zip(&outcomes).filter(|(t, o)| {
            let is_asked = t.cases.is_empty() || t.multiple == MULTIPLES[2] && !o.size.capped;
            t.part == bar.part && is_asked
        });
        let own: Vec<(&Trial, &Outcome)> = own.collect();
        let rate = Rate::of(own.iter().map(|(_, o)| (bar.right)(o)));
        let told: Vec<String> = own.into_iter().map(told).collect();
        let (part, share) = (bar.part, bar.share);
        assert!(
            rate.bounds().1 >= share,
            "{part:?}: {rate}, bar {share}\n{}",
            told.join("\n")
        );
    }
}

fn told((trial, outcome): (&Trial, &Outcome)) -> String {
    format!("{}: {}", trial.name(), outcome.text())
}

#[test]
fn every_part_of_the_published_benchmark_but_rediscovery_keeps_to_its_bar() {
    keep_to_bars(&[
        bar(Part::Nothing, 0.925, |o| o.found.is_empty()),
        bar(Part::Single, 0.9, |o| o.exact),
        bar(Part::Two, 0.85, |o| o.exact),
        bar(Part::OtherForm, 0.9, |o| o.exact),
        bar(Part::Outside, 0.9, |o| o.detected),
        bar(Part::Recording, 0.9, |o| o.detected),
    ]);
}

/// What is not reached yet, and why: run by nobody.
mod not_reached {
    use super::*;

    #[test]
    #[ignore = "not reached: on the seeds of docs/closed-loop.md in 1 of 2 campaigns of 6 to 8 lengths, 1 of 2 of ten (2 of 2 of sixteen); scatter, a gain of the pressure or a compliance take the place of the length law"]
    fn the_benchmark_rediscovers_the_resting_length_with_ten_lengths_or_fewer() {
        let (trials, outcomes) = published();
        let few = |t: &Trial| t.specimens.is_some_and(|lengths| lengths <= 10);
        let own = trials.iter().zip(&outcomes);
        let own = own.filter(|(t, _)| t.part == Part::Rediscovery && few(t));
        let found = Rate::of(own.map(|(_, o)| o.detected));
        assert!(found.bounds().1 >= 0.9, "{found}");
    }

    #[test]
    #[ignore = "not reached: at the level of 0.02 nothing is found with 7 lengths; at 0.05 it was"]
    fn the_dependence_on_resting_length_is_rediscovered_from_a_model_without_it() {
        let settings = Settings {
            specimens: Some(7),
            ..Settings::default()
        };
        let found = search(&campaign(216, &settings).rows, "hunt2017");
        assert!(has(&found, "rest_length_scaling"), "{:?}", names(&found));
    }
}

/// Minutes: run by `.ci/run`.
mod long {
    use super::*;

    /// What the readings of the laboratory's rig show, in the simulator's own equations.
    #[test]
    #[ignore = "long: 47 s of processor time"]
    fn friction_of_a_sliding_braid_and_a_first_filling_are_found_together() {
        let mut effects = put("hysteresis", "sliding", 8.0, 0.0);
        effects.extend(put("conditioning", "first_filling", 9.0, 0.0));
        let (found, _) = searched(218, effects);
        let mut found_names = names(&found);
        found_names.sort_unstable();
        assert_eq!(found_names, ["conditioning", "hysteresis"]);
    }

    #[test]
    #[ignore = "long: 25 s of processor time"]
    fn what_the_library_does_not_know_is_unexplained_and_names_its_column() {
        let (found, _) = searched(214, put("humidity", "gain", 0.01, 0.0));
        assert_eq!(found.verdict, Verdict::Unexplained, "{:?}", names(&found));
        assert!(found.unexplained.iter().any(|u| u.column == "humidity"));
    }

    #[test]
    #[ignore = "long: 58 s of processor time"]
    fn a_dependence_on_a_column_is_found_beyond_its_limit_and_not_far_below() {
        let (nothing, made) = searched(219, Vec::new());
        let of_humidity = |l: &&ColumnLimit| l.column == "humidity" && l.shape == "gain";
        let limit = nothing.column_limits.iter().find(of_humidity);
        let change = limit.and_then(|l| l.smallest).expect("a limit");
        let values = || made.rows.iter().map(|r| r.extras["humidity"]);
        let range = values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min);
        let at = |times: f64| put("humidity", "gain", times * change / range, 0.0);
        let (beyond, _) = searched(219, at(2.5));
        assert!(beyond.unexplained.iter().any(|u| u.column == "humidity"));
        let (below, _) = searched(219, at(0.2));
        assert!(below.unexplained.is_empty(), "{:?}", below.unexplained);
    }

    #[test]
    #[ignore = "long: 19 s of processor time"]
    fn a_threshold_is_found_or_its_alias_and_both_are_named() {
        let (found, _) = searched(213, put("bladder_threshold", "sharp", 55.0, 0.0));
        assert!(has(&found, "bladder_threshold"), "{:?}", names(&found));
        assert_eq!(found.effects.len(), 1, "{:?}", names(&found));
    }

    #[test]
    #[ignore = "long: 71 s of processor time"]
    fn the_dependence_on_resting_length_is_the_strongest_candidate_beside_a_model_of_other_strength()
     {
        // Hunt's actuators were weaker by a third: a gain of all forces shows more. Whether the dependence comes in is another question: `not_reached`.
        let settings = Settings {
            specimens: Some(16),
            ..Settings::default()
        };
        // Candidates are ranked before any comes in, so none may.
        let options = DiagnoseOptions {
            base_model: "hunt2017".to_owned(),
            most_effects: 0,
            ..DiagnoseOptions::default()
        };
        let rows = campaign(216, &settings).rows;
        let found = diagnose(&group(), &rows, &FitOptions::default(), &options);
        let found = found.expect("enough readings").findings;
        let mut but_gain = found.tested.iter().filter(|t| t.id != "force_gain");
        let strongest = but_gain.next().unwrap();
        let is_it = strongest.id == "rest_length_scaling" && strongest.p_familywise < 0.05;
        assert!(is_it, "{strongest:?}");
    }

    #[test]
    #[ignore = "long: 42 s of processor time"]
    fn a_hysteresis_is_found_with_its_size() {
        let (found, _) = searched(212, put("hysteresis", "constant", 4.0, 0.0));
        assert_eq!(names(&found), ["hysteresis"]);
        let size = &found.effects[0].parameters[0];
        assert!((size.value - 4.0).abs() < 1.0, "{size:?}");
    }

    /// Two sessions show a large threshold most. Beside the law alone they look mistaken, and without them it hardly shows.
    #[test]
    #[ignore = "long: 28 s of processor time"]
    fn what_an_effect_of_all_sessions_explains_is_no_mistake_of_two() {
        let settings = Settings {
            effects: put("bladder_threshold", "sharp", 150.0, 0.0),
            ..Settings::default()
        };
        let found = search(&campaign(2, &settings).rows, "new");
        assert_eq!(names(&found), ["bladder_threshold"]);
        assert!(found.recording_errors.is_empty());
        let size = &found.effects[0].parameters[0];
        assert!((size.value - 150.0).abs() < 5.0, "{size:?}");
    }

    /// The table in the documentation is of these answers and no others.
    #[test]
    #[ignore = "long: 650 s of processor time"]
    fn the_published_table_is_of_this_loop() {
        let answers = digest::line(&digest::answers());
        assert!(
            DOCUMENT.contains(&answers),
            "the loop's answers changed: the table in docs/closed-loop.md is out of date; run `cargo run --release --example closed_loop -- --published \
         --log FILE` and put what it prints below the introduction. Now: {answers}"
        );
    }
}
