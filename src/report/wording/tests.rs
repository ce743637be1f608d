//! What is said of findings like those of the laboratory's 10 mm specimens.

use super::name::{self, listed};
use super::number::{amount, cells, equals_probability, error, percent, size};
use super::sentence::{
    clauses, differ, full_answer, implausible, measurement, sentences, worth_words,
};
use crate::table::Cell;
use pipeline_findings::{
    CampaignFindings, Estimate, Findings, FormPoint, FreeForm, HeldOutBy, Level, NextKind,
    NextMeasurement, NotAssessed, Parameter, Tested, Verdict,
};

/// Findings in which every field has a value, shared with `tests/it`.
pub(crate) const EXAMPLE: &str = include_str!("../../../tests/data/findings-2.json");

/// The first campaign of [`EXAMPLE`].
pub(crate) fn example() -> CampaignFindings {
    let all: Findings = pipeline_base::json::from_slice(EXAMPLE.as_bytes()).unwrap();
    all.campaigns.into_iter().next().unwrap()
}

/// Sentences in which lines may break everywhere.
fn broken(sentences: &[String]) -> Vec<String> {
    sentences.iter().map(|s| s.replace('\u{a0}', " ")).collect()
}

#[test]
fn the_answer_of_the_issue() {
    assert_eq!(
        broken(&sentences(&example())),
        [
            "Threshold pressure of the bladder 60.0 kPa (indistinguishable from zero of the pressure sensor): the mixed model's error on unseen \
             specimens falls from 18.7 to 15.8 N.",
            "The zero of the force scatters by 0.60 N, not by the declared 0.20 N.",
            "What the effects leave is not all noise: the error depends on humidity (5% of the force over its range, p = 0.0020; \
             temperature and creep after a step explain it as well), in a way that no effect of the library has (12% of its variance).",
            "The 13.4 N error expected on an unseen specimen combines, in quadrature, 12.0 from set lengths (0.90 mm), 4.1 from specimen gain \
             (4.2%), 3.0 from \
             estimation, 1.4 from other sources and 2.6 from noise; knowing set lengths to 0.2 mm would lower the error by 6.0 N; three readings \
             spread over each session of a new specimen reduce the error to 5.1 N.",
            "Recording error: session s05 (set length, \u{2212}10.0 mm; set aside here only).",
        ]
    );
}

#[test]
fn an_error_that_rises_and_a_density_that_falls_are_said_in_plain_words() {
    let mut found = example();
    let said = |found: &CampaignFindings| clauses(found).errors.unwrap().replace('\u{a0}', " ");
    found.after.log_density_heldout = Some(-4.5);
    assert_eq!(
        said(&found),
        "the mixed model's error on unseen specimens falls from 18.7 to 15.8 N, but the prediction intervals become less reliable (log \
         predictive density per reading \u{2212}4.31 before, \u{2212}4.50 after)"
    );
    found.after.rmse_heldout = Some(25.0);
    assert_eq!(
        said(&found),
        "the mixed model's error on unseen specimens rises with the effects, from 18.7 to 25.0 N, and the prediction intervals \
         become less reliable too (log predictive density per reading \u{2212}4.31 before, \u{2212}4.50 after): the effects describe these specimens and do \
         not help on others"
    );
    found.after.log_density_heldout = Some(-4.0);
    assert!(said(&found).contains("25.0 N, but the prediction intervals become more reliable"));
    found.after.rmse_heldout_calibrated = Some(9.0);
    found.before.rmse_heldout_calibrated = Some(5.0);
    assert!(said(&found).ends_with("; where gain and lengths are known, the error is larger with the effects: 9.0 against 5.0 N"));
    found.after.rmse_heldout = Some(18.6);
    assert!(said(&found).starts_with(
        "the mixed model's error on unseen specimens hardly changes: 18.7 without, 18.6 N with the effects"
    ));
}

#[test]
fn an_expected_error_far_from_what_came_out_says_so() {
    let mut found = example();
    found.expected_rmse_heldout = Some(30.0);
    let said = clauses(&found).budget.unwrap().replace('\u{a0}', " ");
    assert!(
        said.starts_with(
            "the 30.0 N error expected on an unseen specimen (15.8 N observed) combines, "
        ),
        "{said}"
    );
}

#[test]
fn arms_by_hand_are_set_aside_alone() {
    let mut found = example();
    let error = &mut found.recording_errors[0];
    error.level = pipeline_findings::Level::Test;
    error.quantity = Some("moment_arm".into());
    let said = clauses(&found).recording_errors.unwrap();
    assert!(
        said.ends_with("; its arms alone set aside, its torques stay)"),
        "{said}"
    );
}

#[test]
fn an_error_that_falls_on_the_whole_is_said_to_grow_on_some() {
    let mut found = example();
    let of = |before: f64, after: f64| {
        let errors = |x: f64| pipeline_findings::Errors {
            rmse_heldout: Some(x),
            ..example().before
        };
        pipeline_findings::UnitErrors {
            unit: "one".into(),
            readings: 10,
            before: errors(before),
            after: errors(after),
            realised_over_expected: None,
            inside_95: None,
            found: Vec::new(),
        }
    };
    found.by_unit = vec![of(20.0, 10.0), of(10.0, 15.0), of(30.0, 20.0)];
    let c = clauses(&found);
    for said in [c.errors, c.errors_in_short] {
        assert!(said.is_some_and(|s| s.contains("larger on 1 of the 3 specimens")));
    }
}

#[test]
fn three_lines_have_names_numbers_and_what_is_worth_most() {
    let lines = super::sentence::in_three_lines(&example(), None);
    let lines: Vec<String> = lines.iter().map(|l| l.replace('\u{a0}', " ")).collect();
    assert_eq!(lines.len(), 3, "{lines:?}");
    for (line, part) in [
        (
            0,
            "threshold pressure of the bladder 60.0 kPa (or zero of the pressure sensor), a dependence on the humidity; ",
        ),
        (0, "recording error: session s05 ("),
        (1, "error on unseen specimens 18.7 → 15.8 N"),
        (1, "5.1 N after three readings spread over each session"),
        (
            2,
            "expected error 13.4 N; largest source: set lengths (80% of the variance)",
        ),
        (2, "next: knowing"),
    ] {
        assert!(lines[line].contains(part), "{part}: {lines:?}");
    }
    assert!(!lines[0].contains("indistinguishable"), "{lines:?}");
    let law = |is_published| super::sentence::LawAlone {
        is_published,
        rmse_n: 12.0,
    };
    let beside = super::sentence::in_three_lines(&example(), Some(law(false))).swap_remove(1);
    let beside = beside.replace('\u{a0}', " ");
    assert!(
        beside.ends_with("; the law alone, by least squares, has 12.0 N on all readings"),
        "{beside}"
    );
    let published = law(true).in_words().replace('\u{a0}', " ");
    assert_eq!(
        published,
        "the law as published, without effects, has 12.0 N on all readings"
    );
}

#[test]
fn sizes_of_levels_are_said_with_their_levels() {
    let mut found = example();
    let e = &mut found.effects[0];
    (e.column, e.reference_level) = (Some("operator".into()), Some("A".into()));
    e.parameters[0].of_level = Some("B".into());
    e.parameters.push(e.parameters[0].clone());
    e.parameters[1].of_level = Some("C".into());
    e.class.truncate(1);
    let line = super::sentence::in_three_lines(&found, None).swap_remove(0);
    let line = line.replace('\u{a0}', " ");
    let sizes =
        "threshold pressure of the bladder 60.0 kPa for B, 60.0 kPa for C against A (operator)";
    assert!(line.starts_with(sizes), "{line}");
    assert!(size(&found.effects[0].parameters[1]).starts_with("P_th of C = 60"));
}

#[test]
fn a_column_that_explains_as_well_is_one_of_the_alias_set() {
    let mut found = example();
    found.effects[0].explained_as_well_by = vec!["age_days".into()];
    let others = super::sentence::alias_set(&found.effects[0]);
    assert_eq!(
        others.last().map(String::as_str),
        Some("a dependence on age_days")
    );
    found.effects[0].class.truncate(1);
    let line = super::sentence::in_three_lines(&found, None).swap_remove(0);
    assert!(line.contains("(or a dependence on age_days"), "{line}");
}

#[test]
fn fewer_newtons_without_the_effects_are_said_beside_those_with_them() {
    let said = |before: f64| {
        let mut found = example();
        found.before.rmse_heldout_spread.insert("3".into(), before);
        let of_line = super::sentence::in_three_lines(&found, None).swap_remove(1);
        [of_line, clauses(&found).readings.unwrap()].map(|s| s.replace('\u{a0}', " "))
    };
    // With the effects 5.1 N; a difference of less than a twentieth is none.
    for words in said(4.8) {
        assert!(words.contains("(4.8 N without the effects)"), "{words}");
    }
    for words in said(4.9) {
        assert!(!words.contains("without"), "{words}");
    }
}

#[test]
fn lengths_that_forces_contradict_are_told_with_what_was_declared() {
    let mut found = example();
    let mut declared = found.scatter[0].clone();
    (declared.id, declared.level) = ("contracted_length".to_owned(), Level::Specimen);
    (declared.unit, declared.sd) = ("mm".to_owned(), 0.25);
    (declared.declared, declared.declared_contradicted) = (Some(0.25), true);
    found.scatter = vec![declared];
    let line = super::sentence::in_three_lines(&found, None).swap_remove(0);
    let line = line.replace('\u{a0}', " ");
    let words = "; the contracted length must be off by more than the declared 0.25 mm";
    assert!(line.ends_with(words), "{line}");
}

#[test]
fn noise_is_the_largest_source_where_it_is() {
    let mut found = example();
    let noise = found.budget.iter_mut().find(|b| b.source == "noise");
    let noise = noise.unwrap();
    (noise.variance, noise.rmse) = (144.1, 12.004);
    let line = super::sentence::in_three_lines(&found, None).swap_remove(2);
    let line = line.replace('\u{a0}', " ");
    let said = "expected error 13.4 N; largest source: noise (80% of the variance)";
    assert!(line.starts_with(said), "{line}");
}

/// Nothing is worth what a model promises that expected far less than what came out.
#[test]
fn what_a_measurement_is_worth_is_said_where_the_error_is_about_as_large_as_expected() {
    let mut found = example();
    for (observed, is_said) in [
        (1.49 * 13.4, true),
        (1.51 * 13.4, false),
        // Where the expected error falls by 6 N the variance falls by 11.2^2.
        (11.1, false),
        (11.3, true),
    ] {
        found.before.rmse_heldout = Some(30.0);
        found.after.rmse_heldout = Some(observed);
        let credible = super::sentence::is_worth_credible(&found, 6.0);
        assert_eq!(credible, is_said, "{observed}");
    }
}

#[test]
fn a_line_with_nothing_to_say_is_not_there() {
    let mut found = example();
    found.before.rmse_heldout = None;
    found.after.rmse_heldout = None;
    (found.budget, found.next_measurement) = (Vec::new(), Vec::new());
    let lines = super::sentence::in_three_lines(&found, None);
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert!(lines[1].starts_with("next: a second"), "{lines:?}");
    found.verdict = Verdict::None;
    (found.effects, found.unexplained) = (Vec::new(), Vec::new());
    let lines = super::sentence::in_three_lines(&found, None);
    assert_eq!(lines.len(), 1, "{lines:?}");
}

#[test]
fn nothing_found_points_to_the_detection_limits() {
    let mut none = example();
    none.verdict = Verdict::None;
    none.effects.clear();
    none.unexplained.clear();
    let c = clauses(&none);
    assert_eq!((c.found.as_str(), c.limits), ("no effect detected", true));
    assert_eq!(
        c.errors.unwrap(),
        "the mixed model's error on unseen specimens is 18.7\u{a0}N"
    );
    assert_eq!(c.unexplained, None);
    let said = full_answer(&none);
    assert_eq!(
        (said.opening.as_str(), said.limits),
        ("No effect detected", true)
    );
    assert_eq!(
        broken(&said.rest)[..2],
        [
            "The zero of the force scatters by 0.60 N, not by the declared 0.20 N.",
            "The mixed model's error on unseen specimens is 18.7 N."
        ]
    );
}

#[test]
fn what_was_not_assessed_says_why_and_no_more() {
    let mut few = example();
    few.verdict = Verdict::NotAssessed;
    few.not_assessed = Some(NotAssessed::TooFewSpecimens);
    few.effects.clear();
    few.unexplained.clear();
    few.budget.clear();
    few.next_measurement.clear();
    few.recording_errors.clear();
    few.scatter.clear();
    few.before.rmse_heldout = None;
    few.after.rmse_heldout = None;
    assert_eq!(sentences(&few), ["Not assessed: fewer than two specimens."]);
}

#[test]
fn a_joint_is_told_of_in_actuators_and_newton_metres() {
    let mut joint = example();
    joint.kind = "knee-torque".into();
    joint.unit = "N.m".into();
    joint.part = Some("pinned knee, flexor".into());
    assert_eq!(name::campaign(&joint), "iso10, pinned knee, flexor, 10 mm");
    let c = clauses(&joint);
    assert!(
        c.errors
            .unwrap()
            .ends_with("unseen actuators falls from 18.70 to 15.80\u{a0}N\u{a0}m")
    );
    assert!(c.readings.unwrap().contains("each test of a new actuator"));
}

#[test]
fn where_one_test_alone_shows_nothing_its_mounting_is_said_if_it_is_far_off() {
    let mut joint = example();
    joint.kind = "knee-torque".into();
    joint.verdict = Verdict::None;
    joint.effects.clear();
    joint.unexplained.clear();
    let mut mounting = joint.scatter[0].clone();
    mounting.id = "length_offset".into();
    (mounting.level, mounting.unit) = (Level::Test, "mm".into());
    let said = |values: &[(&str, f64)]| {
        let mut joint = joint.clone();
        let mut own = mounting.clone();
        own.values = values.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect();
        joint.scatter = vec![own];
        clauses(&joint).found.replace('\u{a0}', " ")
    };
    assert_eq!(
        said(&[("one", -17.6)]),
        "no effect detected; the only test fits only with a mounting length that is 18 mm off"
    );
    assert_eq!(said(&[("one", 2.9)]), "no effect detected");
    assert_eq!(said(&[("one", 17.6), ("two", 17.6)]), "no effect detected");
}

#[test]
fn a_joint_of_which_little_was_computed_has_nothing_said_about_the_rest() {
    let mut joint = example();
    joint.kind = "knee-torque".into();
    joint.unit = "N.m".into();
    (joint.misfit, joint.expected_rmse_heldout) = (None, None);
    joint.scatter.clear();
    joint.budget.clear();
    joint.next_measurement.clear();
    joint.after.rmse_heldout_spread.clear();
    let c = clauses(&joint);
    assert_eq!((c.budget, c.worth, c.readings), (None, None, None));
    let half = NextMeasurement {
        kind: NextKind::Separate,
        separates: vec!["length_offset".into(), "series_compliance".into()],
        at: [("pressure_share".to_owned(), 0.5)].into(),
        worth: None,
        unit: "1".into(),
    };
    assert_eq!(worth_words(&half), None);
    for (worth, begins) in [
        (
            0.049,
            "would hardly separate offset of the length and compliance in series with the actuator; no",
        ),
        (
            0.051,
            "would separate offset of the length and compliance in series with the actuator by 0.1 in log-likelihood",
        ),
    ] {
        let known = NextMeasurement {
            worth: Some(worth),
            ..half.clone()
        };
        let words = worth_words(&known).unwrap();
        assert!(words.starts_with(begins), "{words}");
    }
    assert_eq!(
        measurement(&half, &name::nouns(&joint)).replace('\u{a0}', " "),
        "readings at 50% of the pressure"
    );
}

#[test]
fn sizes_share_their_decimals_and_an_open_end_says_so() {
    let c = Parameter {
        name: "C".into(),
        value: 7.123,
        ci_low: Some(5.91),
        ci_high: Some(8.33),
        unit: "um/N".into(),
        of_level: None,
    };
    assert_eq!(size(&c), "C = 7.1 [5.9, 8.3]\u{a0}µm/N");
    assert_eq!(amount(&c), "7.1\u{a0}µm/N");
    let open = Parameter {
        ci_high: None,
        unit: "1".into(),
        ..c
    };
    assert_eq!(size(&open), "C = 7.12 [5.91, unbounded]");
    assert_eq!(cells(open.value, None, None)[1], Cell::Empty);
    let time = Parameter {
        name: "tau".into(),
        value: 15.25,
        ci_low: Some(7.86),
        ci_high: Some(2463.0),
        unit: "s".into(),
        of_level: None,
    };
    assert_eq!(size(&time), "tau = 15 [7.9, 2500]\u{a0}s");
}

#[test]
fn numbers_are_short() {
    assert_eq!(equals_probability(3e-9), "< 0.0001");
    assert_eq!(equals_probability(0.0045), "= 0.0045");
    assert_eq!(equals_probability(1.0), "= 1.00");
    assert_eq!(
        (error(13.44, "N"), error(0.62, "N"), error(2.168, "N.m")),
        ("13.4".into(), "0.62".into(), "2.17".into())
    );
    assert_eq!(percent(0.954), "95%");
    assert_eq!(listed(&["a", "b", "c"]), "a, b and c");
}

#[test]
fn an_id_without_a_name_is_spelled() {
    assert_eq!(name::effect("creep"), "creep after a step");
    assert_eq!(name::effect("hose_inertia"), "hose inertia");
    assert_eq!(name::column("humidity"), "humidity");
}

#[test]
fn a_free_form_says_whether_one_number_is_enough_and_over_what_range() {
    let mut effect = example().effects.remove(0);
    let said = |effect: &pipeline_findings::EffectFinding| {
        super::sentence::form(effect).map(|s| s.replace('\u{a0}', " "))
    };
    assert_eq!(
        said(&effect).unwrap(),
        "One value is enough for its size over the force range in which it acts, from 0 to 50 N (p = 0.40)."
    );
    let free = effect.free_form.as_mut().unwrap();
    (free.p, free.differs) = (0.01, true);
    let differs = said(&effect).unwrap();
    assert!(
        differs.starts_with("Its size changes with the force, from ")
            && differs.contains(" at 50 N, everything else refitted")
            && differs.ends_with("one value is not enough (p = 0.010)."),
        "{differs}"
    );
    let free = effect.free_form.as_mut().unwrap();
    let middle = free.curve.len() / 2;
    free.curve[middle].amplitude = 1000.0;
    assert!(said(&effect).unwrap().contains(" through 1000 "));
    effect.free_form = None;
    assert_eq!(said(&effect), None);
}

#[test]
fn a_free_form_over_a_short_range_says_that_nothing_can_be_told() {
    let mut effect = example().effects.remove(0);
    let free = effect.free_form.as_mut().unwrap();
    free.curve.first_mut().unwrap().at = 615.0;
    free.curve.last_mut().unwrap().at = 620.0;
    let said = super::sentence::form(&effect).unwrap();
    assert!(
        said.starts_with("Whether its size changes") && !said.contains("enough"),
        "{said}"
    );
}

#[test]
fn a_worth_that_cannot_be_relied_on_is_not_offered() {
    let mut found = example();
    assert!(clauses(&found).worth.is_some());
    found
        .next_measurement
        .retain(|n| n.kind != NextKind::Separate);
    found.next_measurement[0].worth = Some(16.0);
    assert!(found.after.rmse_heldout < Some(16.0));
    assert_eq!(clauses(&found).worth, None, "more than all of the error");
    found.next_measurement[0].worth = example().next_measurement[0].worth;
    found.after.rmse_heldout = Some(25.0);
    assert_eq!(clauses(&found).worth, None, "the error rises");
}

#[test]
fn what_is_said_of_an_effect_stands_in_one_bracket() {
    let mut found = example();
    let effect = &mut found.effects[0];
    let own = &mut found.scatter[0];
    own.id = effect.id.clone();
    own.values = [("s".to_owned(), 1.0)].into();
    let said = clauses(&found).found;
    assert!(said.contains(" of the only "), "{said}");
    assert_eq!(said.matches('(').count(), 1, "{said}");
}

#[test]
fn a_page_has_the_answer_in_points() {
    let mut found = example();
    let of = |found: &CampaignFindings| {
        let points = super::sentence::points(found);
        let rest = points.rest.into_iter();
        let rest: Vec<String> = rest
            .map(|(about, words)| format!("{about}: {}", words.replace('\u{a0}', " ")))
            .collect();
        (points.found.replace('\u{a0}', " "), rest)
    };
    let (what, rest) = of(&found);
    assert!(what.starts_with("Threshold pressure of the bladder 60.0 kPa"));
    let starts = [
        "Error: 18.7 → 15.8 N on unseen specimens, ",
        "Made of: 13.4 N expected: set lengths (0.90 mm) 12.0, specimen gain (4.2%) 4.1, estimation 3.0, others 1.4, noise 2.6",
        "Not named: ",
        "Declared: ",
        "Records: Recording error: session s05",
        "Next: Knowing set lengths to 0.2 mm would lower the error by 6.0 N",
    ];
    assert_eq!(rest.len(), starts.len(), "{rest:#?}");
    for (point, start) in rest.iter().zip(starts) {
        assert!(point.starts_with(start), "{point}\n{start}");
    }
    found.before.rmse_heldout = None;
    found.next_measurement.clear();
    let (_, rest) = of(&found);
    assert!(!rest[0].starts_with("Error"), "{rest:#?}");
    assert_eq!(
        rest.last().unwrap(),
        "Next: A second specimen would show whether the effects hold"
    );
}

#[test]
fn where_no_measurement_lowers_the_error_the_next_one_separates_effects() {
    let mut found = example();
    let separate = NextMeasurement {
        kind: NextKind::Separate,
        separates: vec!["hysteresis".into(), "force_drift".into()],
        at: [("pressure_kpa".to_owned(), 280.0)].into(),
        worth: Some(2.2),
        unit: "1".into(),
    };
    let useless = NextMeasurement {
        worth: Some(0.01),
        ..separate.clone()
    };
    let next = |found: &CampaignFindings| clauses(found).worth.map(|w| w.replace('\u{a0}', " "));
    found.next_measurement = vec![useless.clone(), separate];
    assert_eq!(
        next(&found).unwrap(),
        "readings at 280 kPa would separate hysteresis between filling and venting and drift of the load cell"
    );
    found.next_measurement = vec![useless];
    assert_eq!(next(&found), None);
}

#[test]
fn an_effect_that_few_searches_find_again_is_marked_where_it_is_stated() {
    let mut found = example();
    let said = |found: &CampaignFindings| clauses(found).found.replace('\u{a0}', " ");
    for (share, words) in [
        (
            Some(0.0),
            "found in none of the searches without one specimen",
        ),
        (
            Some(0.25),
            "found in 25% of the searches without one specimen",
        ),
    ] {
        found.effects[0].found_in_folds = share;
        assert!(said(&found).contains(words), "{}", said(&found));
        let line = super::sentence::in_three_lines(&found, None).swap_remove(0);
        let line = line.replace('\u{a0}', " ");
        assert!(line.contains("; weak evidence)"), "{line}");
        let short = super::sentence::answer_in_short(&found).join(" ");
        assert!(
            short.contains("(weak evidence; ") && !short.contains("searches"),
            "{short}"
        );
    }
    for share in [None, Some(0.5), Some(1.0)] {
        found.effects[0].found_in_folds = share;
        assert!(!said(&found).contains("searches"), "{}", said(&found));
    }
}

/// The effect in the points of a page: all that stands behind its size.
fn remarks(found: &CampaignFindings) -> String {
    let said = super::sentence::points(found).found.replace('\u{a0}', " ");
    let from = said.find('(').unwrap();
    said[from..].to_owned()
}

#[test]
fn evidence_is_graded_by_p_by_searches_on_less_and_by_a_shuffled_column() {
    let mut found = example();
    found.effects.truncate(1);
    found.effects[0].class.truncate(1);
    let placebo = Tested {
        id: "placebo".into(),
        p_familywise: 1.0,
        log_likelihood_gain: 9.0,
        ..found.tested[0].clone()
    };
    found.tested = vec![placebo];
    let said = |p: f64, share: Option<f64>, shuffled: f64| {
        let mut found = found.clone();
        let e = &mut found.effects[0];
        (e.p_familywise, e.found_in_folds) = (p, share);
        e.log_likelihood_gain = Some(10.0);
        found.tested[0].p_familywise = shuffled;
        remarks(&found)
    };
    let all = Some(1.0);
    assert_eq!(said(0.005, all, 0.5), "(strong)");
    assert_eq!(said(0.0051, all, 0.5), "(moderate)");
    assert_eq!(said(0.01, all, 0.5), "(moderate)");
    assert_eq!(said(0.0101, all, 0.5), "(weak: p = 0.010)");
    assert_eq!(said(0.005, Some(0.75), 0.5), "(moderate)");
    assert_eq!(said(0.005, Some(0.5), 0.5), "(moderate)");
    assert_eq!(
        said(0.005, Some(0.49), 0.5),
        "(weak: found in 49% of the searches)"
    );
    assert_eq!(
        said(0.03, Some(0.0), 0.5),
        "(weak: p = 0.030, found in none of the searches)"
    );
    // A shuffled column with as small a p is as strong if its gain is no smaller: here it is.
    assert_eq!(said(0.005, all, 0.005), "(strong)");
    assert_eq!(
        said(0.045, all, 0.035),
        "(weak: p = 0.045, a shuffled column has p = 0.035)"
    );
    found.tested[0].log_likelihood_gain = 10.0;
    let mut tied = found.clone();
    tied.effects[0].log_likelihood_gain = Some(10.0);
    tied.effects[0].p_familywise = 0.005;
    tied.tested[0].p_familywise = 0.005;
    assert_eq!(remarks(&tied), "(weak: a shuffled column has p = 0.0050)");
}

#[test]
fn evidence_of_a_size_that_differs_or_has_the_wrong_sign_is_not_strong() {
    let mut found = example();
    found.effects.truncate(1);
    found.tested.clear();
    let e = &mut found.effects[0];
    (e.p_familywise, e.found_in_folds) = (0.005, Some(1.0));
    e.class.truncate(1);
    let estimate = |value| Estimate {
        value,
        standard_error: 1.0,
    };
    e.by_specimen = [("a", 60.0), ("b", 60.5)]
        .map(|(k, x)| (k.to_owned(), estimate(x)))
        .into();
    assert_eq!(remarks(&found), "(strong)");
    let mut differ = found.clone();
    differ.effects[0]
        .by_specimen
        .insert("b".to_owned(), estimate(70.0));
    assert!(
        remarks(&differ).starts_with("(moderate; specimens differ"),
        "{}",
        remarks(&differ)
    );
    let e = &mut found.effects[0];
    (e.id, e.form) = ("hysteresis".to_owned(), "constant".to_owned());
    e.class = vec![e.id.clone()];
    e.by_specimen.clear();
    assert!(remarks(&found).ends_with("(strong)"));
    found.effects[0].parameters[0].value = -3.0;
    assert!(
        remarks(&found).contains("(moderate; its sign is that of a lag"),
        "{}",
        remarks(&found)
    );
}

#[test]
fn a_size_without_an_interval_is_not_determined_and_not_strong() {
    let mut found = example();
    found.effects.truncate(1);
    found.effects[0].class.truncate(1);
    let mut with = |low, high| {
        let size = &mut found.effects[0].parameters[0];
        (size.ci_low, size.ci_high) = (low, high);
        (remarks(&found), clauses(&found).found)
    };
    let open = "its size is not determined by these readings";
    let (graded, said) = with(None, None);
    assert_eq!(graded, format!("(moderate; {open})"));
    assert!(said.contains(open), "{said}");
    for (low, high) in [
        (Some(50.0), None),
        (None, Some(70.0)),
        (Some(50.0), Some(70.0)),
    ] {
        let (graded, said) = with(low, high);
        assert_eq!(graded, "(strong)");
        assert!(!said.contains(open), "{said}");
    }
}

#[test]
fn what_scatters_between_campaigns_is_no_part_of_a_source() {
    let mut found = example();
    let set_lengths =
        |found: &CampaignFindings| clauses(found).budget.unwrap().replace('\u{a0}', " ");
    assert!(set_lengths(&found).contains("12.0 from set lengths (0.90 mm)"));
    let of_session = found
        .scatter
        .iter()
        .find(|s| s.id == "length_offset")
        .unwrap();
    let mut of_campaign = of_session.clone();
    (of_campaign.level, of_campaign.sd_predictive) = (Level::Campaign, 2.0);
    found.scatter.push(of_campaign);
    // What campaigns differ by is known of the unseen unit's, and no part of the source.
    assert!(set_lengths(&found).contains("12.0 from set lengths (0.90 mm)"));
}

#[test]
fn a_scatter_that_the_readings_hardly_show_is_called_assumed() {
    let mut found = example();
    let lengths = found
        .scatter
        .iter()
        .position(|s| s.id == "length_offset")
        .unwrap();
    let said = |found: &CampaignFindings| {
        let c = clauses(found);
        [c.budget, c.worth].map(|c| c.unwrap().replace('\u{a0}', " "))
    };
    for (gain, declared, is_assumed) in [
        (Some(1.99), None, true),
        (Some(2.0), None, false),
        (Some(0.0), Some(0.9), false),
        (None, None, false),
    ] {
        let of = &mut found.scatter[lengths];
        (of.log_likelihood_gain, of.declared) = (gain, declared);
        let [budget, worth] = said(&found);
        assert_eq!(
            budget.contains("set lengths (0.90 mm assumed)"),
            is_assumed,
            "{budget}"
        );
        assert_eq!(
            worth.ends_with("by 6.0 N if they scatter as assumed"),
            is_assumed,
            "{worth}"
        );
    }
}

#[test]
fn readings_that_separate_say_the_sense_of_motion_and_the_time() {
    let found = example();
    let separate = |direction: f64| NextMeasurement {
        kind: NextKind::Separate,
        separates: vec!["hysteresis".into(), "force_drift".into()],
        at: [
            ("pressure_kpa", 280.0),
            ("direction", direction),
            ("time_s", 95.0),
        ]
        .map(|(k, x)| (k.to_owned(), x))
        .into(),
        worth: Some(2.2),
        unit: "1".into(),
    };
    let said =
        |direction| measurement(&separate(direction), &name::nouns(&found)).replace('\u{a0}', " ");
    assert_eq!(
        said(1.0),
        "readings while filling at 280 kPa, 95.0 s into a log"
    );
    assert_eq!(
        said(-1.0),
        "readings while venting at 280 kPa, 95.0 s into a log"
    );
}

#[test]
fn evidence_from_no_search_on_less_is_not_strong() {
    let mut found = example();
    found.effects[0].class.truncate(1);
    found.effects[0].by_specimen.clear();
    found.effects[0].found_in_folds = None;
    found.design.held_out_by = HeldOutBy::None;
    assert_eq!(remarks(&found), "(moderate)");
    found.design.specimens = 1;
    found.before.rmse_heldout = None;
    // That there is one only is what the errors say.
    assert_eq!(remarks(&found), "(moderate)");
    // The holdout sessions take part in no search: it is the same one.
    found.design.held_out_by = HeldOutBy::Holdout;
    found.effects[0].found_in_folds = Some(1.0);
    found.before.rmse_heldout = Some(9.0);
    assert_eq!(remarks(&found), "(moderate)");
}

#[test]
fn evidence_from_doubtful_tests_alone_is_weak() {
    let mut found = example();
    found.effects[0].class.truncate(1);
    found.effects[0].by_specimen.clear();
    assert!(remarks(&found).starts_with("(strong)"));
    found.design.doubtful_only = true;
    assert!(remarks(&found).starts_with("(weak: doubtful sessions)"));
}

#[test]
fn evidence_that_does_not_stand_beside_correlated_noise_is_weak() {
    let mut found = example();
    found.effects[0].class.truncate(1);
    found.effects[0].by_specimen.clear();
    assert!(remarks(&found).starts_with("(strong)"));
    found.noise_in_time.as_mut().unwrap().beside[0].stands = false;
    let weak = "(weak: not shown beside noise that is correlated in time)";
    assert!(remarks(&found).starts_with(weak), "{}", remarks(&found));
}

#[test]
fn a_size_that_varies_and_one_of_the_wrong_sign_are_said_beside_it() {
    let mut found = example();
    found.effects.truncate(1);
    let e = &mut found.effects[0];
    e.class.truncate(1);
    e.by_specimen.clear();
    let point = |at, amplitude| FormPoint {
        at,
        amplitude,
        low: amplitude - 1.0,
        high: amplitude + 1.0,
    };
    let free = FreeForm {
        argument: "pressure_kpa".into(),
        unit: "kPa".into(),
        log_likelihood_gain: 9.0,
        p: 0.01,
        differs: true,
        curve: vec![point(186.0, -44.0), point(620.0, 5.5)],
    };
    let with = |found: &CampaignFindings, differs, to: f64| {
        let mut found = found.clone();
        let mut free = free.clone();
        free.differs = differs;
        free.curve[1].at = to;
        found.effects[0].free_form = Some(free);
        remarks(&found)
    };
    let said = "(moderate; changes its sign along the pressure: perhaps another effect)";
    found.effects[0].parameters[0].value = 49.0;
    assert_eq!(with(&found, true, 620.0), said);
    // Slightly below 0 at an end is no change of sign.
    let mut kept = free.clone();
    kept.curve = vec![point(186.0, -2.0), point(620.0, 52.0)];
    let mut same_sign = found.clone();
    same_sign.effects[0].free_form = Some(kept);
    let said = "(moderate; varies with the pressure: −2 to 52 kPa, everything else refitted)";
    assert_eq!(remarks(&same_sign), said);
    assert_eq!(with(&found, false, 620.0), "(strong)");
    // Over a range that is too short nothing can be said.
    assert_eq!(with(&found, true, 200.0), "(strong)");
    // 49.5 is no more than the size itself: one value does not mislead.
    found.effects[0].parameters[0].value = 50.0;
    assert_eq!(with(&found, true, 620.0), "(strong)");
    found.effects[0].id = "hysteresis".into();
    found.effects[0].class = vec!["hysteresis".into()];
    found.effects[0].parameters[0].value = -2.7;
    let said = remarks(&found);
    assert!(
        said.contains("(moderate; its sign is that of a lag, not of friction)"),
        "{said}"
    );
    found.effects[0].parameters[0].value = 2.7;
    assert!(!remarks(&found).contains("sign"));
}

#[test]
fn estimates_that_differ_more_than_chance_allows_are_said_to() {
    let mut found = example();
    let effect = &mut found.effects[0];
    effect.class.truncate(1);
    // Two estimates with equal errors: Q is the square of half their distance over half the variance, chi-square with one degree of freedom.
    let estimate = |value| Estimate {
        value,
        standard_error: 1.0,
    };
    let mut with = |distance: f64| {
        let own = [("a", 50.0), ("b", 50.0 + distance)];
        let own = own.map(|(name, value)| (name.to_owned(), estimate(value)));
        found.effects.truncate(1);
        found.effects[0].by_specimen = own.into();
        differ(&found, &found.effects[0]).map(|said| said.replace('\u{a0}', " "))
    };
    // 1.96 standard errors of a difference, which is the root of two.
    assert_eq!(with(2.77), None);
    let said = with(2.775);
    assert_eq!(said.as_deref(), Some("specimens differ: 50.0 to 52.8 kPa"));
    assert_eq!(remarks(&found), "(moderate; specimens differ)");
    // With a second effect of which the same is asked, p counts twice: 2.24 standard errors.
    let mut two = found.clone();
    two.effects.push(two.effects[0].clone());
    assert!(!remarks(&two).contains("differ"));
    two.effects[0]
        .by_specimen
        .insert("b".to_owned(), estimate(53.18));
    assert!(remarks(&two).starts_with("(moderate; specimens differ)"));
}

#[test]
fn few_units_left_in_a_search_are_named_beside_an_expected_error_that_is_far_off() {
    let mut found = example();
    let said = |found: &CampaignFindings| {
        let rest = super::sentence::points(found).rest;
        let made_of = rest.into_iter().find(|(about, _)| *about == "Made of");
        made_of.unwrap().1.replace('\u{a0}', " ")
    };
    found.after.rmse_heldout = Some(10.0);
    found.expected_rmse_heldout = Some(12.5);
    assert!(
        said(&found).starts_with("12.5 N expected: "),
        "{}",
        said(&found)
    );
    found.expected_rmse_heldout = Some(12.6);
    for (specimens, words) in [
        (
            2,
            "(10.0 N observed; each search without one specimen uses only one other): ",
        ),
        (
            3,
            "(10.0 N observed; each search without one specimen uses only two others): ",
        ),
        (4, "(10.0 N observed): "),
    ] {
        found.design.specimens = specimens;
        let said = said(&found);
        assert!(
            said.starts_with(&format!("12.6 N expected {words}")),
            "{said}"
        );
    }
    found.design.specimens = 2;
    found.design.held_out_by = HeldOutBy::Holdout;
    assert!(said(&found).starts_with("12.6 N expected (10.0 N observed): "));
}

#[test]
fn implausible_sessions_are_named_and_many_counted() {
    let ids = |n: usize| (1..=n).map(|k| format!("s{k}")).collect::<Vec<_>>();
    assert_eq!(implausible(&ids(0)), None);
    let said = implausible(&ids(5)).unwrap();
    assert!(
        said.starts_with(
            "The readings of s1, s2, s3 and two more look doubtful for such an actuator: "
        ),
        "{said}"
    );
}

#[test]
fn the_error_beside_the_expected_one_is_that_of_the_answer() {
    let mut found = example();
    found.before.rmse_heldout = Some(7.1);
    found.after.rmse_heldout = Some(9.1);
    assert_eq!(found.rmse_of_answer(), Some(9.1));
    // Searches without one specimen may have found what the search of all did not.
    found.effects.clear();
    found.unexplained.clear();
    assert_eq!(found.rmse_of_answer(), Some(7.1));
    found.expected_rmse_heldout = Some(30.0);
    let said = super::sentence::points(&found).rest;
    let made_of = said.iter().find(|(about, _)| *about == "Made of").unwrap();
    let made_of = made_of.1.replace('\u{a0}', " ");
    assert!(made_of.contains("(7.1 N observed"), "{made_of}");
}
