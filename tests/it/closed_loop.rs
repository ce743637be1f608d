//! Campaigns with an effect that nothing tells, searched, and judged on what was found and on the held-out error; null campaigns beside
//! them. The short form of `cargo run --release --example closed_loop`.

use pipeline::base::row::Row;
use pipeline::base::session::Role;
use pipeline::config::{DiagnoseOptions, FitOptions};
use pipeline::simulate::campaign_rows;
use pipeline::simulate::trials::{self, Case, Size};
use pipeline::stages::diagnose::findings::{CampaignFindings, Verdict};
use pipeline::stages::diagnose::former as diagnose;
use pipeline::stages::fit::Group;

fn group() -> Group {
    Group {
        campaign: "trial".into(),
        diameter_mm: 10,
        members: vec!["trial".into()],
        simulated: true,
    }
}

/// What is found in a trial, and the error of the generating model on the specimens that were held out, N.
fn search(cases: &[&Case], size: Size, seed: u64, base_model: &str) -> (CampaignFindings, f64) {
    let tables: Vec<String> = cases.iter().map(|c| c.table(size)).collect();
    let made = campaign_rows(&trials::truth(cases[0].design, &tables.join("\n"), seed));
    let options = DiagnoseOptions {
        base_model: base_model.into(),
        ..DiagnoseOptions::default()
    };
    let found = diagnose(&group(), &made.rows, &FitOptions::default(), &options).unwrap();
    let held: Vec<f64> = made
        .rows
        .iter()
        .zip(&made.readings)
        .filter(|(r, _)| r.role == Some(Role::Holdout))
        .map(|(r, t)| (r.force_n - t.expected_force_n) * (r.force_n - t.expected_force_n))
        .collect();
    let error = (held.iter().sum::<f64>() / held.len() as f64).sqrt();
    (found.findings, error)
}

fn case(list: &'static [Case], id: &str, form: &str) -> &'static Case {
    let found = list.iter().find(|c| c.id == id && c.form == form);
    found.unwrap_or_else(|| panic!("no trial {id} {form}"))
}

fn names(found: &CampaignFindings, id: &str) -> bool {
    found
        .effects
        .iter()
        .any(|e| e.class.iter().any(|c| c == id))
}

#[test]
fn without_an_effect_none_is_found() {
    for seed in 100..104 {
        let (found, _) = search(&[&trials::NULL], Size::Medium, seed, "new");
        assert_eq!(found.verdict, Verdict::None, "seed {seed}: {found:#?}");
        assert!(found.effects.is_empty() && found.unexplained.is_empty());
        assert!(
            found
                .detection_limits
                .iter()
                .any(|l| l.id == "hysteresis" && l.smallest < 2.0)
        );
        assert!(
            found
                .not_measurable
                .iter()
                .any(|n| n.id == "force_gain" && n.why.contains("b1"))
        );
    }
}

#[test]
fn an_undeclared_effect_is_found_with_its_size_and_the_held_out_error_falls() {
    let trials = [
        ("series_compliance", "linear"),
        ("hysteresis", "constant"),
        ("temperature", "linear"),
        ("pressure_zero_offset", "constant"),
        ("creep", "logarithm"),
    ];
    for (id, form) in trials {
        let case = case(trials::SINGLE, id, form);
        let (found, _) = search(&[case], Size::Large, 77, "new");
        assert_eq!(found.verdict, Verdict::EffectFound, "{id}");
        assert!(names(&found, id), "{id}: {}", found.summary);
        let effect = found.effects.iter().find(|e| e.id == id).unwrap();
        let p = &effect.parameters[0];
        let truth = case.number(Size::Large);
        assert!(
            (p.value - truth).abs() < 0.1 * truth.abs(),
            "{id}: {} for {truth}",
            p.value
        );
        assert!(effect.p_adjusted < 1e-3 && effect.selected_in_resamples >= 0.9);
        assert!(
            found.after.rmse_heldout_own_strength < 0.9 * found.before.rmse_heldout_own_strength,
            "{id}: {:?} {:?}",
            found.before,
            found.after
        );
    }
}

#[test]
fn an_effect_of_another_form_than_the_library_s_keeps_its_name() {
    for (id, form) in [
        ("series_compliance", "stiffening"),
        ("hysteresis", "play"),
        ("conditioning", "power"),
    ] {
        let (found, _) = search(
            &[case(trials::OTHER_FORMS, id, form)],
            Size::Large,
            78,
            "new",
        );
        assert!(names(&found, id), "{id} {form}: {}", found.summary);
    }
}

#[test]
fn two_effects_together_are_both_found() {
    let pair = [
        case(trials::SINGLE, "series_compliance", "linear"),
        case(trials::SINGLE, "temperature", "linear"),
    ];
    let (found, _) = search(&pair, Size::Large, 79, "new");
    assert!(
        names(&found, "series_compliance") && names(&found, "temperature"),
        "{}",
        found.summary
    );
}

#[test]
fn what_the_library_does_not_know_is_unexplained_and_names_its_column() {
    for (column, form) in [("humidity", "gain"), ("force_n", "quadratic")] {
        let (found, _) = search(
            &[case(trials::OUTSIDE, column, form)],
            Size::Large,
            80,
            "new",
        );
        assert_eq!(
            found.verdict,
            Verdict::Unexplained,
            "{column}: {}",
            found.summary
        );
        assert_eq!(found.unexplained[0].column, column);
        assert!(found.effects.is_empty());
        let corrected = found.after_empirical.unwrap();
        assert!(corrected.rmse_heldout_own_strength < found.before.rmse_heldout_own_strength);
    }
}

#[test]
fn the_dependence_on_resting_length_is_rediscovered_from_a_model_without_it() {
    let (found, _) = search(&[&trials::NULL], Size::Medium, 81, "hunt2017");
    assert!(names(&found, "rest_length_scaling"), "{}", found.summary);
    assert!(found.after.rmse_heldout < found.before.rmse_heldout);
}

#[test]
fn an_offset_of_the_pressure_is_one_class_with_the_bladder_s_threshold() {
    let (found, _) = search(
        &[case(trials::SINGLE, "bladder_threshold", "sharp")],
        Size::Large,
        82,
        "new",
    );
    let effect = &found.effects[0];
    assert!(
        ["pressure_zero_offset", "bladder_threshold"]
            .iter()
            .all(|id| effect.class.iter().any(|c| c == id))
    );
    assert!(
        found
            .next_measurement
            .iter()
            .any(|n| n.separates.len() > 1 && n.action.contains("vent"))
    );
}

#[test]
fn the_same_seed_gives_the_same_findings() {
    let case = case(trials::SINGLE, "hysteresis", "constant");
    let one = search(&[case], Size::Medium, 83, "new").0;
    assert_eq!(
        format!("{one:?}"),
        format!("{:?}", search(&[case], Size::Medium, 83, "new").0)
    );
}

/// What a laboratory does wrong, on a simulated campaign: the search points at the session or specimen.
#[test]
fn mistakes_of_one_session_or_specimen_are_pointed_at() {
    let made = campaign_rows(&trials::truth(trials::NULL.design, "", 84));
    let search = |rows: &[Row]| {
        diagnose(
            &group(),
            rows,
            &FitOptions::default(),
            &DiagnoseOptions::default(),
        )
        .unwrap()
        .findings
    };
    let mut rows = made.rows.clone();
    for row in rows.iter_mut().filter(|r| r.session == "trial-t-l182-c25") {
        row.force_n += 12.0;
    }
    let ignored_zero = search(&rows);
    let zero = ignored_zero
        .effects
        .iter()
        .find(|e| e.id == "force_zero_offset")
        .unwrap_or_else(|| panic!("{}", ignored_zero.summary));
    assert!(
        zero.acts_on.contains("trial-t-l182-c25"),
        "{}",
        zero.acts_on
    );
    let mut rows = made.rows.clone();
    for row in rows.iter_mut().filter(|r| r.specimen == "t-l257") {
        row.rest_length_m += 0.005;
        let shortened = row.rest_length_m - row.contracted_length_m;
        row.contraction_rel = (row.rest_length_m - row.length_m) / shortened;
    }
    let wrong_length = search(&rows);
    let at_it =
        |e: &&pipeline::stages::diagnose::findings::EffectFinding| e.acts_on.contains("t-l257");
    assert!(
        wrong_length.effects.iter().any(|e| at_it(&e)),
        "{}",
        wrong_length.summary
    );
}

/// Mistakes that no effect is: they are named before anything is searched, and do not bend the rest.
#[test]
fn gross_mistakes_of_recording_are_named_and_set_aside() {
    let made = campaign_rows(&trials::truth(trials::NULL.design, "", 85));
    let search = |rows: &[Row]| {
        let found = diagnose(
            &group(),
            rows,
            &FitOptions::default(),
            &DiagnoseOptions::default(),
        );
        found.unwrap().findings
    };
    assert!(search(&made.rows).suspects.is_empty());

    let mut rows = made.rows.clone();
    for row in rows.iter_mut().filter(|r| r.session == "trial-t-l455-c00") {
        std::mem::swap(&mut row.force_n, &mut row.pressure_kpa);
    }
    let swapped = search(&rows);
    let suspect = &swapped.suspects[0];
    assert_eq!(suspect.what, "session trial-t-l455-c00");
    assert!(suspect.explanation.contains("swapped"), "{suspect:?}");
    assert!(suspect.set_aside && swapped.suspects.len() == 1);
    assert!(swapped.before.rmse_train < 1.2 * search(&made.rows).before.rmse_train);
    assert_eq!(swapped.verdict, Verdict::Unexplained);
    assert_eq!(swapped.unexplained[0].column, "session");

    let mut rows = made.rows.clone();
    for row in rows.iter_mut().filter(|r| r.specimen == "t-l182") {
        row.rest_length_m += 0.012;
    }
    let longer = search(&rows);
    let suspect = &longer.suspects[0];
    assert_eq!(suspect.what, "specimen t-l182");
    assert!(
        suspect.explanation.contains("resting length that is -1"),
        "{suspect:?}"
    );

    let mut rows = made.rows.clone();
    for row in &mut rows {
        row.force_n *= 0.39;
    }
    let scaled = search(&rows);
    assert_eq!(scaled.suspects[0].what, "the whole campaign");
    assert!(
        scaled.suspects[0].explanation.contains("calibration"),
        "{scaled:#?}"
    );
}

/// Zero logs in which the actuator pulled: what the real rig shows.
#[test]
fn a_pull_in_some_zero_logs_is_found_by_the_zeros_that_stand_out() {
    let mut rows = campaign_rows(&trials::truth(trials::NULL.design, "", 86)).rows;
    for row in &mut rows {
        row.zero_force_n = -5.0;
        if row.session.ends_with("c00") {
            row.zero_force_n = 18.0 + 20.0 * row.rest_length_m;
            row.force_n -= row.zero_force_n + 5.0;
        }
    }
    let found = diagnose(
        &group(),
        &rows,
        &FitOptions::default(),
        &DiagnoseOptions::default(),
    )
    .unwrap()
    .findings;
    let pull = found.effects.iter().find(|e| e.id == "force_zero_offset");
    let pull = pull.unwrap_or_else(|| panic!("{}", found.summary));
    assert_eq!(pull.form, "pull in the zero logs");
    assert!((pull.parameters[0].value - 1.0).abs() < 0.05, "{pull:?}");
}

/// What is found in readings, beside the published model as it is.
fn beside_the_published(rows: &[Row]) -> CampaignFindings {
    let options = DiagnoseOptions {
        base_model: "new_published".into(),
        refit: false,
        ..DiagnoseOptions::default()
    };
    diagnose(&group(), rows, &FitOptions::default(), &options)
        .unwrap()
        .findings
}

#[test]
fn a_gain_of_all_readings_is_found_beside_a_base_that_is_not_fitted() {
    let mut rows = campaign_rows(&trials::truth(trials::NULL.design, "", 85)).rows;
    rows.iter_mut().for_each(|r| r.force_n *= 1.06);
    let found = beside_the_published(&rows);
    assert_eq!(found.verdict, Verdict::EffectFound, "{}", found.summary);
    assert!(names(&found, "force_gain"), "{}", found.summary);
    let (before, after) = (found.before.rmse_heldout, found.after.rmse_heldout);
    assert!(after < 0.7 * before, "{before} {after}");
}

/// A residual of one shape and either sign, as the specimen: no column explains it, and yet readings of one set point agree.
#[test]
fn set_points_that_differ_by_more_than_repeats_are_asked_for() {
    let mut rows = campaign_rows(&trials::truth(trials::NULL.design, "", 86)).rows;
    let specimens: std::collections::BTreeSet<String> =
        rows.iter().map(|r| r.specimen.clone()).collect();
    let sign = |specimen: &str| match specimens.iter().position(|s| s == specimen) {
        Some(k) if k % 2 == 0 => 6.0,
        _ => -6.0,
    };
    for row in &mut rows {
        row.force_n += sign(&row.specimen) * libm::sin(9.0 * row.contraction_rel);
    }
    let options = DiagnoseOptions::default();
    let found = diagnose(&group(), &rows, &FitOptions::default(), &options)
        .unwrap()
        .findings;
    let asked = found.questions.iter().find(|q| q.column == "set_point");
    assert!(asked.is_some_and(|q| q.p_adjusted < 0.01), "{asked:?}");
    assert_ne!(found.verdict, Verdict::None, "{}", found.summary);
}
