//! Declared lengths, intervals of effects, and campaigns of a pool, on simulated campaigns.

use super::base::Base;
use super::data::Data;
use super::problem::{ForceProblem, component};
use super::suited::start;
use super::{diagnose, library};
use pipeline_base::random::Stream;
use pipeline_base::row::Row;
use pipeline_base::session::Role;
use pipeline_config::{DiagnoseOptions, FitOptions};
use pipeline_effects as effects;
use pipeline_findings::{CampaignFindings, SmallestP, Verdict};
use pipeline_fit::Group;
use pipeline_inference::fit::{Free, Setting};
use pipeline_inference::heldout::Unseen;
use pipeline_inference::problem::Problem;
use pipeline_inference::profile::Profiles;
use pipeline_mechanics::models::new;
use pipeline_simulate::coefficients::Coefficients;
use pipeline_simulate::rig_like;

#[test]
fn with_the_fewest_draws_something_can_come_in() {
    let smallest = SmallestP::of(pipeline_config::FEWEST_DRAWS, 2).familywise;
    assert!(smallest <= pipeline_inference::decisions::COMES_IN);
}

/// What is found in a campaign of which these standard deviations of set lengths are declared, mm.
fn found_declaring(declared_mm: f64) -> CampaignFindings {
    let settings = rig_like::Settings {
        specimens: Some(4),
        ..rig_like::Settings::default()
    };
    let mut rows = rig_like::campaign(1, &settings).rows;
    for row in &mut rows {
        row.length_sd_m = 1e-3 * declared_mm;
    }
    let group = rig_like::group();
    let options = DiagnoseOptions::default();
    let found = diagnose(&group, &rows, &FitOptions::default(), &options);
    found.unwrap().findings
}

/// Its scatter of set lengths.
fn scatter_of(declared_mm: f64) -> pipeline_findings::Scatter {
    let scatter = found_declaring(declared_mm).scatter.into_iter();
    let mut of_lengths = scatter.filter(|s| s.id == "length_offset");
    let one = of_lengths.next().unwrap();
    assert!(of_lengths.next().is_none());
    one
}

#[test]
fn a_declared_set_length_is_taken_and_contradicted_where_it_is_too_small() {
    // The sessions were set to 0.8 mm; these happen to scatter by 0.565.
    let right = scatter_of(0.8);
    assert_eq!(right.declared, Some(0.8));
    assert!(!right.declared_contradicted);
    assert_eq!(right.values.len(), 16);
    let wrong = scatter_of(0.1);
    assert!(wrong.declared_contradicted);
    assert_eq!(wrong.declared, Some(0.1));
    assert!((wrong.sd / 0.565 - 1.0).abs() < 0.2, "{}", wrong.sd);
    // The interval is in mm as well, not in units of what was declared.
    let (low, high) = (wrong.ci_low.unwrap(), wrong.ci_high.unwrap());
    assert!(
        low < wrong.sd && wrong.sd < high && high < 3.0,
        "{low} {high}"
    );
}

#[test]
fn a_declaration_that_is_contradicted_changes_no_answer() {
    let (wrong, none) = (found_declaring(0.01), found_declaring(f64::NAN));
    let ids = |found: &CampaignFindings| -> Vec<String> {
        found.effects.iter().map(|e| e.id.clone()).collect()
    };
    assert_eq!(ids(&wrong), ids(&none));
    let errors = |found: &CampaignFindings| [&found.before, &found.after].map(|e| e.rmse_heldout);
    for (wrong, none) in errors(&wrong).into_iter().zip(errors(&none)) {
        let (wrong, none) = (wrong.unwrap(), none.unwrap());
        assert!((wrong / none - 1.0).abs() < 0.02, "{wrong} {none}");
    }
}

/// By how much the contracted lengths of six specimens are noted longer than they are, shares of the resting length; they add up to nothing.
const NOTED_LONGER: [f64; 6] = [0.02, -0.01, 0.015, -0.02, -0.012, 0.007];

fn noted_rightly(_: usize, row: &Row) -> f64 {
    row.contracted_length_m
}

fn noted_wrongly(specimen: usize, row: &Row) -> f64 {
    row.contracted_length_m + NOTED_LONGER[specimen] * row.rest_length_m
}

fn noted_alike(_: usize, row: &Row) -> f64 {
    (1.0 - 0.167) * row.rest_length_m
}

/// What is found where such contracted lengths of six specimens are noted, and these standard deviations of them are declared, shares of the resting
/// length.
fn found_noting(
    scatter: rig_like::Scatter,
    noted_m: fn(usize, &Row) -> f64,
    declared: [f64; 6],
) -> CampaignFindings {
    let settings = rig_like::Settings {
        specimens: Some(6),
        scatter,
        ..rig_like::Settings::default()
    };
    let mut rows = rig_like::campaign(7, &settings).rows;
    let mut known: Vec<String> = Vec::new();
    for row in &mut rows {
        if !known.contains(&row.specimen) {
            known.push(row.specimen.clone());
        }
        let place = known.iter().position(|k| *k == row.specimen).unwrap();
        row.contracted_length_m = noted_m(place, row);
        row.contracted_length_sd_m = declared[place] * row.rest_length_m;
    }
    let options = DiagnoseOptions::default();
    let found = diagnose(&rig_like::group(), &rows, &FitOptions::default(), &options);
    found.unwrap().findings
}

fn contracted_lengths(found: &CampaignFindings) -> pipeline_findings::Scatter {
    let mut all = found.scatter.iter().filter(|s| s.id == "contracted_length");
    let one = all.next().unwrap().clone();
    assert!(all.next().is_none());
    one
}

/// Contractions between 0.157 and 0.177 (standard deviation 0.006) that are noted with errors of 0.016: 0.88 of the variance of what is noted is error.
#[test]
fn noted_contractions_are_worth_what_the_forces_say_and_their_errors_are_no_effect() {
    let found = |noted, declared: f64| {
        let found = found_noting(rig_like::Scatter::RigLike, noted, [declared; 6]);
        assert_eq!(found.verdict, Verdict::None);
        assert!(found.recording_errors.is_empty());
        found
    };
    let right = found(noted_rightly, f64::NAN);
    let wrong = found(noted_wrongly, f64::NAN);
    let alike = found(noted_alike, f64::NAN);
    let declared = found(noted_wrongly, 0.015);
    let worth = |found: &CampaignFindings| found.noted_contractions.unwrap();
    let (rightly, wrongly) = (worth(&right), worth(&wrong));
    assert!(wrongly.error_sd < 0.2 && (wrongly.error - 0.88).abs() < 2.0 * wrongly.error_sd);
    assert!(rightly.error < wrongly.error && rightly.error_sd > wrongly.error_sd);
    assert!(wrongly.sd > 2.0 * rightly.sd);
    assert_eq!((wrongly.specimens, alike.noted_contractions), (6, None));
    let known = contracted_lengths(&declared);
    assert!(known.declared.is_some() && contracted_lengths(&wrong).declared.is_none());
    assert_eq!(
        (known.log_likelihood_gain, declared.noted_contractions),
        (None, None)
    );
    // An unseen specimen is predicted nearly as well as if nothing were noted, and once its own lengths are known as if it had been noted rightly.
    let unseen = |found: &CampaignFindings| found.after.rmse_heldout.unwrap();
    assert!(unseen(&wrong) < 1.2 * unseen(&alike));
    let calibrated = |found: &CampaignFindings| found.after.rmse_heldout_calibrated.unwrap();
    assert!(calibrated(&wrong) < 1.3 * calibrated(&right));
    let mut next = wrong.next_measurement.iter();
    assert!(next.any(|n| n.separates.iter().any(|s| s == "contracted_length")));
}

/// Where every length is as it was recorded, readings show what noted contractions are worth; and where all are noted alike, how far apart the actuators are.
#[test]
fn contracted_lengths_scatter_by_what_is_not_noted_of_them() {
    let found = |noted| found_noting(rig_like::Scatter::Clean, noted, [f64::NAN; 6]);
    let (right, alike) = (found(noted_rightly), found(noted_alike));
    let rightly = right.noted_contractions.unwrap();
    assert!(rightly.error.abs() < 2.0 * rightly.error_sd && rightly.error_sd < 0.2);
    let [none, some] = [&right, &alike].map(contracted_lengths);
    let share = some.share_of_rest_length.unwrap();
    assert!((0.003..0.012).contains(&share), "{share}");
    assert!(some.log_likelihood_gain.unwrap() > 3.0);
    assert!(none.sd < 0.2 * some.sd);
}

/// Where some are declared, these are taken as they are, and the others are estimated: two entries, each with its own specimens.
#[test]
fn contracted_lengths_of_which_some_are_declared_have_two_entries() {
    let none = f64::NAN;
    let found = found_noting(
        rig_like::Scatter::RigLike,
        noted_wrongly,
        [0.015, none, 0.015, none, 0.015, none],
    );
    let all = found.scatter.iter().filter(|s| s.id == "contracted_length");
    let all: Vec<&pipeline_findings::Scatter> = all.collect();
    assert_eq!(all.len(), 2);
    let [estimated, declared] = [all[0], all[1]];
    assert!(estimated.share_of_rest_length.is_some() && estimated.declared.is_none());
    assert!(declared.share_of_rest_length.is_none() && declared.declared.is_some());
    assert_eq!((estimated.values.len(), declared.values.len()), (3, 3));
    let both = |name: &String| declared.values.contains_key(name);
    assert!(!estimated.values.keys().any(both));
    let share = estimated.share_of_rest_length.unwrap();
    assert_eq!(found.contracted_sd_mm(200.0), 200.0 * share);
}

#[test]
fn at_the_ends_of_an_interval_the_likelihood_of_a_fit_has_fallen_alike() {
    // Size and time constant of a creep trade against each other: an interval with the time constant held would be too short.
    let settings = rig_like::Settings {
        specimens: Some(4),
        pace: rig_like::Pace::Dwell,
        effects: vec![rig_like::Put {
            id: "creep",
            form: "logarithm",
            size: 0.02,
            others: &[],
            from: 0.0,
        }],
        ..rig_like::Settings::default()
    };
    let rows = rig_like::campaign(3, &settings).rows;
    let rows: Vec<&Row> = rows.iter().collect();
    let data = Data::new(&rows);
    let base = Base::new(10, true, 4, &FitOptions::default());
    let library = library::terms(&data);
    let problem = ForceProblem::new(&base, &data, &library).with_reference();
    let setting = Setting::new(&problem);
    let creep = library.iter().position(|t| t.id() == Some("creep"));
    let mut from = problem.start();
    from.terms
        .push((creep.unwrap(), library[creep.unwrap()].start(0.02)));
    let model = setting.fit_afresh(&from);
    let normal = |k: usize| -> Box<dyn FnMut() -> f64> {
        let mut stream = Stream::new(1, &["profile", &k.to_string()]);
        Box::new(move || stream.normal())
    };
    let found = Profiles::new(&setting, &model, &normal)
        .of(creep.unwrap(), 0)
        .unwrap();
    let fallen = |size: f64| {
        let mut held = setting.clone();
        held.pinned.push(Free::Value(0, 0));
        let mut from = model.point.clone();
        from.terms[0].1[0] = size;
        let starts = [model.variances.clone(), setting.widened(&model.variances)];
        model.log_likelihood - held.fit(&from, &starts).log_likelihood
    };
    let ends = [found.low.unwrap(), found.high.unwrap()].map(fallen);
    assert!(ends.iter().all(|fall| *fall > 1.7), "{ends:?}");
    assert!((ends[0] - ends[1]).abs() < 0.15 * ends[0], "{ends:?}");
}

#[test]
fn a_session_that_declares_nothing_takes_back_nothing_of_its_specimen() {
    let mut rows = rig_like::campaign(1, &rig_like::Settings::default()).rows;
    let first = rows[0].clone();
    let declaring = rows.iter_mut().filter(|r| r.session == first.session);
    declaring.for_each(|r| r.rest_length_sd_m = 1e-4);
    let rows: Vec<&Row> = rows.iter().collect();
    let data = Data::new(&rows);
    let place = data.specimens.iter().position(|s| *s == first.specimen);
    let [rest, contracted] = data.specimen_lengths_sd_mm[place.unwrap()];
    assert!((rest - 0.1).abs() < 1e-12);
    assert!(contracted.is_nan());
}

/// With two contractions the readings do not tell c1, and with it by how many newtons a millimetre of the set length changes the force between them:
/// errors of hundreds of newtons were expected where 20 were observed.
#[test]
fn with_two_contractions_errors_of_the_size_of_those_observed_are_expected() {
    let settings = rig_like::Settings {
        specimens: Some(3),
        ..rig_like::Settings::default()
    };
    let (mut expected, mut observed) = (0.0, 0.0);
    for seed in 1..=4 {
        let mut rows = rig_like::campaign(seed, &settings).rows;
        let mut levels: Vec<f64> = rows.iter().map(|r| r.contraction_rel).collect();
        levels.sort_by(f64::total_cmp);
        let middle = levels[levels.len() / 2];
        rows.retain(|r| r.contraction_rel < 0.1 || (r.contraction_rel - middle).abs() < 0.1);
        let group = rig_like::group();
        let options = DiagnoseOptions::default();
        let found = diagnose(&group, &rows, &FitOptions::default(), &options).unwrap();
        let found = found.findings;
        expected += found.expected_rmse_heldout.unwrap();
        observed += found.after.rmse_heldout.unwrap();
    }
    assert!(
        (0.5..2.0).contains(&(expected / observed)),
        "{expected} {observed}"
    );
}

/// Squared error of the black box on a specimen that its owner held out, N^2, whose forces are larger than they were by so much, N.
fn black_box_squared(shift_n: f64) -> f64 {
    let settings = rig_like::Settings {
        specimens: Some(4),
        scatter: rig_like::Scatter::Clean,
        ..rig_like::Settings::default()
    };
    let mut rows = rig_like::campaign(1, &settings).rows;
    let held_out = rows[0].specimen.clone();
    for row in rows.iter_mut().filter(|r| r.specimen == held_out) {
        row.role = Some(Role::Holdout);
        row.force_n += shift_n;
    }
    let options = DiagnoseOptions::default();
    let found = diagnose(&rig_like::group(), &rows, &FitOptions::default(), &options);
    let error = found.unwrap().findings.black_box_rmse_heldout.unwrap();
    error * error
}

/// The mean of (r + a - p)^2 and (r - a - p)^2 is that of (r - p)^2 and a^2 more, if the prediction p does not depend on the held-out force. It does
/// by very little: the scale of the misfit knows the largest force.
#[test]
fn what_a_black_box_predicts_does_not_hang_on_the_readings_held_out() {
    let [less, as_it_is, more] = [-1.0, 0.0, 1.0].map(black_box_squared);
    let mean = 0.5 * (less + more);
    assert!((mean - as_it_is - 1.0).abs() < 0.01, "{mean} {as_it_is}");
}

/// Where the law of 10 mm is slack, one of another shape pulls: its readings there were taken for slack, which made a zero of 6 to 15 N of them.
#[test]
fn a_diameter_of_which_nothing_is_published_is_slack_where_its_own_law_is() {
    let settings = rig_like::Settings {
        specimens: Some(4),
        scatter: rig_like::Scatter::Clean,
        ..rig_like::Settings::default()
    };
    let mut rows = rig_like::campaign(1, &settings).rows;
    let law = Coefficients::published(20).unwrap();
    let mut stream = Stream::new(1, &["thirty"]);
    for row in &mut rows {
        let f620 = law.f620(row.rest_length_m);
        let pressure = row.pressure_kpa / 620.0;
        row.force_n =
            f620 * new::surface(law.c, row.contraction_rel, pressure) + 2.0 * stream.normal();
        row.diameter_mm = 30.0;
    }
    let group = Group {
        diameter_mm: 30,
        ..rig_like::group()
    };
    let options = DiagnoseOptions::default();
    let found = diagnose(&group, &rows, &FitOptions::default(), &options)
        .unwrap()
        .findings;
    let named: Vec<&str> = found.effects.iter().map(|e| e.id.as_str()).collect();
    assert_eq!(found.verdict, Verdict::None, "{named:?}");
    assert!(
        (1.7..2.3).contains(&found.noise.unwrap()),
        "{:?}",
        found.noise
    );
}

/// Two campaigns in one pool, the second of which is read with 8 N more noise and a load cell of 20% less: five times what the means of four specimens differ by.
#[test]
fn campaigns_of_a_pool_have_a_gain_and_a_noise_of_their_own() {
    let settings = rig_like::Settings {
        specimens: Some(4),
        ..rig_like::Settings::default()
    };
    let mut rows = rig_like::campaign(1, &settings).rows;
    let mut others = rig_like::campaign(2, &settings).rows;
    let mut stream = Stream::new(1, &["pool"]);
    for row in &mut others {
        row.campaign = "other".to_owned();
        row.session = format!("other {}", row.session);
        row.force_n = 0.8 * row.force_n + 8.0 * stream.normal();
    }
    rows.extend(others);
    let rows: Vec<&Row> = rows.iter().collect();
    let data = Data::new(&rows);
    assert_eq!((data.campaigns.len(), data.specimens.len()), (2, 8));
    let base = Base::new(10, true, 2, &FitOptions::default());
    let library = library::terms(&data);
    let problem = ForceProblem::new(&base, &data, &library).with_reference();
    let setting = Setting::new(&problem);
    let null = start(&setting);
    let other = data.campaigns.iter().position(|c| c == "other").unwrap();
    let noise = [1 - other, other].map(|c| null.variances.noise[c]);
    assert!((1.0..4.0).contains(&noise[0]), "{noise:?}");
    assert!((7.0..10.0).contains(&noise[1]), "{noise:?}");
    let both = problem.noise_of(&null.variances);
    assert!(noise[0] < both && both < noise[1], "{both}");
    let variances = null.restricted(&setting);
    let gain = variances.components[component::CAMPAIGN_GAIN];
    assert!((0.05..0.3).contains(&gain), "{gain}");
    // An unseen specimen has the gain that the others of its campaign show: without it all four would be about a tenth off, on one side.
    let mut share_off = Vec::new();
    for specimen in (0..data.specimens.len()).filter(|k| data.specimens[*k].starts_with("other")) {
        let node = problem.specimens[specimen];
        let rest = setting.without(node);
        let fit = rest.fit(&null.cleared(&rest), std::slice::from_ref(&null.variances));
        let predicted = Unseen::new(&rest, &fit).predict_where(node, |_| true);
        let measured: f64 = predicted.places.iter().map(|i| data.force[*i]).sum();
        share_off.push(predicted.errors.iter().sum::<f64>() / measured);
    }
    assert_eq!(share_off.len(), 4);
    let mean = share_off.iter().sum::<f64>() / 4.0;
    assert!(mean.abs() < 0.04, "{share_off:?}");
}

/// Six specimens whose forces do not depend on the resting length, on a frame that yields by so much, um/N.
fn on_a_frame(compliance_um_per_n: f64) -> Vec<Row> {
    let settings = rig_like::Settings {
        specimens: Some(6),
        scatter: rig_like::Scatter::Clean,
        ..rig_like::Settings::default()
    };
    let mut rows = rig_like::campaign(3, &settings).rows;
    let law = Base::new(10, true, 2, &FitOptions::default());
    let [_, without] = law.with_and_without_length_law().unwrap();
    let frame = effects::Applied {
        effect: effects::index(effects::series_compliance::ID).unwrap(),
        form: 0,
        parameters: [compliance_um_per_n, 0.0],
    };
    let mut stream = Stream::new(1, &["frame"]);
    for row in &mut rows {
        let at = effects::Conditions::at(
            row.rest_length_m,
            row.contracted_length_m,
            row.length_m,
            row.pressure_kpa,
        );
        let force = effects::force(&without, &without.starts(), 1.0, &[frame], &at);
        row.force_n = force.max(0.0) + 2.0 * stream.normal();
    }
    rows
}

#[test]
fn a_frame_that_yields_is_found_and_a_dependence_on_the_length_that_is_not_there_goes() {
    let rows = on_a_frame(15.0);
    let found = diagnose(
        &rig_like::group(),
        &rows,
        &FitOptions::default(),
        &DiagnoseOptions::default(),
    );
    let found = found.unwrap().findings;
    let [frame] = &found.effects[..] else {
        panic!("{:?}", found.effects);
    };
    assert_eq!(frame.id, "series_compliance");
    let size = &frame.parameters[0];
    let (low, high) = (size.ci_low.unwrap(), size.ci_high.unwrap());
    assert!(low < 15.0 && 15.0 < high && high - low < 6.0, "{size:?}");
    let length_law = &found.coefficients[super::base::LENGTH_LAW];
    assert!(
        length_law.left_out && length_law.before > 0.01,
        "{length_law:?}"
    );
    assert!(found.coefficients.iter().filter(|c| c.left_out).count() == 1);
    let errors = [&found.before, &found.after].map(|e| e.rmse_heldout.unwrap());
    assert!(errors[1] < 0.7 * errors[0], "{errors:?}");
}
