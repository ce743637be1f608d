//! The loop on campaigns that scatter as a laboratory's rig does: a handful of campaigns and, long, the answers to the fixed ones and some
//! campaigns of `cargo run --release --example closed_loop`.

#[path = "../../examples/closed_loop/bench/mod.rs"]
mod bench;

use bench::cases::{self, Case, SINGLE};
use bench::digest;
use bench::outcome::Outcome;
use bench::plan::Plan;
use bench::progress::{Log, run};
use bench::rate::Rate;
use bench::search::search;
use bench::trial::{Part, Trial};
use pipeline::base::row::Row;
use pipeline::findings::{CampaignFindings, ColumnLimit, Verdict};
use pipeline::simulate::rig_like::{Campaign, Family, Mistake, Pace, Put, Settings, campaign};

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
    assert_eq!(columns, ["age_days", "humidity", "force_n", "pressure_kpa"]);
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

/// The share of right answers that a part of the benchmark has to reach. So few campaigns cannot show that a bar is met: what fails here is far
/// below it.
struct Bar {
    part: Part,
    share: f64,
    right: fn(&Outcome) -> bool,
}

const fn bar(part: Part, share: f64, right: fn(&Outcome) -> bool) -> Bar {
    Bar { part, share, right }
}

/// Runs so many campaigns of each of these parts from the short form, and fails where a part is far below its bar.
fn keep_to_bars(bars: &[Bar], campaigns: usize) {
    let plan = Plan {
        family: Family::Design,
        seeds: 1,
    };
    let short = plan.short();
    let first = |bar: &Bar| {
        let own = short.iter().filter(|t| t.part == bar.part);
        own.take(campaigns).cloned().collect::<Vec<Trial>>()
    };
    let trials: Vec<Trial> = bars.iter().flat_map(first).collect();
    let outcomes = run(&trials, &Log::none(), |_, _| ());
    let told: Vec<String> = trials.iter().zip(&outcomes).map(told).collect();
    let told = told.join("\n");
    for bar in bars {
        let own = trials.iter().zip(&outcomes);
        let own = own.filter(|(t, _)| t.part == bar.part);
        let rate = Rate::of(own.map(|(_, o)| (bar.right)(o)));
        let (part, share) = (bar.part, bar.share);
        assert!(
            rate.bounds().1 >= share,
            "{part:?}: {rate}, bar {share}\n{told}"
        );
    }
}

fn told((trial, outcome): (&Trial, &Outcome)) -> String {
    format!("{}: {}", trial.name(), outcome.text())
}

/// What is not reached yet, and why: run by nobody.
mod not_reached {
    use super::*;

    #[test]
    #[ignore = "not reached: on the seeds of docs/closed-loop.md in 1 of 2 campaigns of 6 to 8 lengths, 1 of 2 of ten and 2 of 2 of sixteen; scatter, a gain of the pressure or a compliance take the place of the length law"]
    fn the_benchmark_rediscovers_the_resting_length() {
        keep_to_bars(&[bar(Part::Rediscovery, 0.9, |o| o.detected)], 2);
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
    #[ignore = "long: 26 s of processor time"]
    fn friction_of_a_sliding_braid_and_a_first_filling_are_found_together() {
        let mut effects = put("hysteresis", "sliding", 8.0, 0.0);
        effects.extend(put("conditioning", "first_filling", 9.0, 0.0));
        let (found, _) = searched(218, effects);
        let mut found_names = names(&found);
        found_names.sort_unstable();
        assert_eq!(found_names, ["conditioning", "hysteresis"]);
    }

    #[test]
    #[ignore = "long: 10 s of processor time"]
    fn what_the_library_does_not_know_is_unexplained_and_names_its_column() {
        let (found, _) = searched(214, put("humidity", "gain", 0.01, 0.0));
        assert_eq!(found.verdict, Verdict::Unexplained, "{:?}", names(&found));
        assert!(found.unexplained.iter().any(|u| u.column == "humidity"));
    }

    #[test]
    #[ignore = "long: 30 s of processor time"]
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
    #[ignore = "long: 10 s of processor time"]
    fn a_threshold_is_found_or_its_alias_and_both_are_named() {
        let (found, _) = searched(213, put("bladder_threshold", "sharp", 55.0, 0.0));
        assert!(has(&found, "bladder_threshold"), "{:?}", names(&found));
        assert_eq!(found.effects.len(), 1, "{:?}", names(&found));
    }

    #[test]
    #[ignore = "long: 120 s of processor time"]
    fn the_dependence_on_resting_length_is_the_strongest_candidate_beside_a_model_of_other_strength()
     {
        // Hunt's actuators were weaker by a third: a gain of all forces shows more. Whether the dependence comes in is another question: `not_reached`.
        let settings = Settings {
            specimens: Some(16),
            ..Settings::default()
        };
        let found = search(&campaign(216, &settings).rows, "hunt2017");
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
    #[ignore = "long: 14 s of processor time"]
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
    #[ignore = "long: 160 s of processor time"]
    fn the_published_table_is_of_this_loop() {
        let document = include_str!("../../docs/closed-loop.md");
        let answers = digest::line(&digest::answers());
        assert!(
            document.contains(&answers),
            "the loop's answers changed: the table in docs/closed-loop.md is out of date; run `cargo run --release --example closed_loop -- --published \
         --log FILE` and put what it prints below the introduction. Now: {answers}"
        );
    }

    #[test]
    #[ignore = "long: 390 s of processor time"]
    fn three_campaigns_of_every_part_of_the_benchmark_but_rediscovery_keep_to_its_bars() {
        let reached = [
            bar(Part::Nothing, 0.925, |o| o.found.is_empty()),
            bar(Part::Single, 0.9, |o| o.exact),
            bar(Part::Two, 0.85, |o| o.exact),
            bar(Part::OtherForm, 0.9, |o| o.exact),
            bar(Part::Outside, 0.9, |o| o.detected),
            bar(Part::Recording, 0.9, |o| o.detected),
        ];
        keep_to_bars(&reached, 3);
    }
}
