//! The parts of the search against closed forms and against refits that take no short cut.

use super::base::Base;
use super::candidates::candidates;
use super::data::{Data, PLACEBO};
use super::linear::Linear;
use super::model::{Fitted, Model, Place};
use super::search::effective_readings;
use super::term::{Scope, Term};
use super::{between, black_box, folds, questions, uncertainty};
use crate::base::row::Row;
use crate::base::session::Role;
use crate::config::FitOptions;
use crate::simulate::campaign_rows;
use crate::simulate::trials;

fn rows(effect: &str) -> Vec<Row> {
    let made = campaign_rows(&trials::truth(trials::NULL.design, effect, 31));
    let kept = made.rows.into_iter();
    kept.filter(|r| r.role != Some(Role::Holdout)).collect()
}

fn data(effect: &str) -> Data {
    let rows = rows(effect);
    Data::new(&rows.iter().collect::<Vec<&Row>>()).thinned(400)
}

/// A base whose coefficients are held: the model is then linear in strengths and zero.
fn held(data: &Data) -> Base {
    assert!(data.len() > 100);
    Base::new(10, false, 6, &FitOptions::default())
}

fn term(data: &Data, id: &str, form: &str) -> Term {
    let all = candidates(data);
    let found = all
        .iter()
        .find(|t| t.id() == Some(id) && t.scope == Scope::Whole && t.form().unwrap().name == form);
    found.unwrap_or_else(|| panic!("{id} {form}")).clone()
}

fn rss(fitted: &Fitted) -> f64 {
    fitted.residuals.iter().map(|r| r * r).sum()
}

#[test]
fn the_linearised_model_foretells_what_a_refit_finds() {
    let data = data("[[effect]]\nid = \"force_zero_offset\"\nzero_n = 2.0\n");
    let base = held(&data);
    let zero = term(&data, "force_zero_offset", "constant");
    let null = Model {
        base: &base,
        data: &data,
        terms: Vec::new(),
    };
    let fitted = null.fit(None, 1);
    let linear = Linear::new(&null, &fitted, fitted.scatter, std::slice::from_ref(&zero));
    let gain = linear.stand(&linear.all_sessions(), &[]).gain(0);
    let with = Model {
        base: &base,
        data: &data,
        terms: vec![zero],
    }
    .fit(Some(&fitted), 0);
    let fall = rss(&fitted) - rss(&with);
    assert!(
        (gain.amplitude - with.terms[0].0[0]).abs() < 0.05,
        "{gain:?} {:?}",
        with.terms
    );
    assert!((gain.fall - fall).abs() < 0.1 * fall, "{gain:?} {fall}");
    assert!(gain.visible > 0.3 && gain.visible <= 1.0);
}

#[test]
fn a_trace_is_parallel_to_itself_and_a_swallowed_one_is_invisible() {
    let data = data("");
    let base = Base::new(10, true, 6, &FitOptions::default());
    let terms = [
        term(&data, "pressure_zero_offset", "constant"),
        term(&data, "bladder_threshold", "sharp"),
        term(&data, "force_gain", "gain"),
    ];
    let null = Model {
        base: &base,
        data: &data,
        terms: Vec::new(),
    };
    let fitted = null.fit(None, 1);
    let linear = Linear::new(&null, &fitted, fitted.scatter, &terms);
    let stand = linear.stand(&linear.all_sessions(), &[]);
    assert!((stand.cosine(0, 0) - 1.0).abs() < 1e-9);
    assert!(
        stand.cosine(0, 1).abs() > 0.99,
        "one pressure less another is the same"
    );
    assert!(
        stand.gain(2).visible < 0.05,
        "b1 takes a gain of all forces"
    );
    assert!(stand.gain(0).visible > 0.05);
}

/// The jackknife in one Gauss-Newton step a session, against refits without each session.
#[test]
fn the_interval_of_a_zero_is_that_of_refits_without_each_session() {
    let data =
        data("[[effect]]\nid = \"force_zero_offset\"\nzero_n = 3.0\nsd = 1.0\nper = \"session\"\n");
    let base = held(&data);
    let zero = term(&data, "force_zero_offset", "constant");
    let fit = |part: &Data, from: Option<&Fitted>| {
        let model = Model {
            base: &base,
            data: part,
            terms: vec![zero.clone()],
        };
        model.fit(from, usize::from(from.is_none()))
    };
    let all = fit(&data, None);
    let sessions: Vec<usize> = (0..data.sessions.len())
        .filter(|s| data.session.contains(s))
        .collect();
    let each: Vec<f64> = sessions
        .iter()
        .map(|s| {
            let others: Vec<usize> = (0..data.len()).filter(|i| data.session[*i] != *s).collect();
            fit(&data.select(&others), Some(&all)).terms[0].0[0]
        })
        .collect();
    let n = each.len() as f64;
    let mean = each.iter().sum::<f64>() / n;
    let squares: f64 = each.iter().map(|x| (x - mean) * (x - mean)).sum();
    let expected = ((n - 1.0) / n * squares).sqrt();
    let model = Model {
        base: &base,
        data: &data,
        terms: vec![zero.clone()],
    };
    let effective = effective_readings(&data, &all.residuals);
    let uncertain = uncertainty::uncertainties(&model, &all, effective, &[]);
    let place = model
        .layout()
        .iter()
        .position(|p| *p == Place::Amplitude(0, 0))
        .unwrap();
    let error = uncertain[place].error;
    assert!(
        (error - expected).abs() < 0.1 * expected,
        "{error} {expected}"
    );
}

#[test]
fn own_strengths_take_off_what_only_a_strength_differs_by() {
    let mut data = data("");
    let base = held(&data);
    let model = Model {
        base: &base,
        data: &data,
        terms: Vec::new(),
    };
    let fitted = model.fit(None, 0);
    let predicted = model.predict(&fitted, false);
    for (i, f) in predicted.iter().enumerate() {
        data.force[i] = f * (1.0 + 0.05 * data.specimen[i] as f64);
    }
    let model = Model {
        base: &base,
        data: &data,
        terms: Vec::new(),
    };
    let own = model.predict_with_own_strength(&fitted);
    let error = own
        .iter()
        .zip(&data.force)
        .map(|(f, y)| (f - y).abs())
        .fold(0.0, f64::max);
    assert!(error < 1e-9, "{error}");
}

#[test]
fn a_repeated_residual_counts_as_one() {
    let data = data("");
    let mut stream = crate::base::random::Stream::new(5, &["noise"]);
    let noise: Vec<f64> = (0..data.len()).map(|_| stream.normal()).collect();
    let n = data.len() as f64;
    assert!(effective_readings(&data, &noise) > 0.75 * n);
    let by_log: Vec<f64> = data.log.iter().map(|k| noise[*k]).collect();
    assert!(effective_readings(&data, &by_log) < 0.1 * n);
}

#[test]
fn a_question_is_answered_where_the_column_decides_and_not_where_it_is_shuffled() {
    let data = data("").with_placebo(3);
    let fitted = vec![100.0; data.len()];
    let residual: Vec<f64> = data
        .conditions
        .iter()
        .map(|c| c.pressure_kpa - 300.0)
        .collect();
    let columns = questions::columns(&data, &fitted);
    let asked = questions::ask(&data, &residual, &columns, 199, 1);
    let of = |name: &str| asked.iter().find(|q| q.column == name).unwrap();
    assert!(of("pressure_kpa").p <= 1.0 / 200.0 && of("pressure_kpa").share > 0.9);
    assert!(of(PLACEBO).p_adjusted > 0.05, "{:?}", of(PLACEBO));
    assert!(asked.iter().all(|q| q.p_adjusted >= q.p));
    assert!(
        asked.iter().all(|q| q.column != "rest_length_m"),
        "constant within a specimen"
    );
}

#[test]
fn classes_are_ranks_with_equal_values_together() {
    let classes = questions::classes(&[1.0, 1.0, 1.0, 5.0, 9.0, 9.0]);
    assert_eq!(classes[0], classes[1]);
    assert_eq!(classes[4], classes[5]);
    assert!(classes[0] < classes[4]);
}

/// Slope 1.1, r^2 = 121/175; with two degrees of freedom p = 1 - t/sqrt(t^2 + 2).
#[test]
fn strengths_on_a_column_are_a_straight_line() {
    let mut data = data("");
    let values = [0.0, 1.0, 2.0, 3.0];
    let places: Vec<usize> = (0..data.len()).filter(|i| data.specimen[*i] < 4).collect();
    data = data.select(&places);
    data.specimens.truncate(4);
    data.extras = vec![super::data::Extra {
        name: "age".into(),
        values: data.specimen.iter().map(|k| values[*k]).collect(),
        scale: (0.0, 1.0),
        constant_in_sessions: true,
        names_groups: false,
        words: Vec::new(),
    }];
    let columns = between::columns(&data, &[1.0, 3.0, 2.0, 5.0]);
    let age = columns.iter().find(|c| c.name == "age").unwrap();
    assert!((age.regression.slope - 1.1).abs() < 1e-12, "{age:?}");
    assert!((age.regression.share - 121.0 / 175.0).abs() < 1e-12);
    let t = (2.0_f64 * 121.0 / 54.0).sqrt();
    assert!(
        (age.regression.p - (1.0 - t / (t * t + 2.0).sqrt())).abs() < 1e-9,
        "{age:?}"
    );
    assert!((age.left - (8.75 - 1.1 * 5.5)).abs() < 1e-12);
}

#[test]
fn the_black_box_follows_a_smooth_dependence_into_an_unseen_specimen() {
    let data = data("");
    let plain = vec![200.0; data.len()];
    let wave = |p: f64| 10.0 * libm::sin(p / 150.0);
    let residual: Vec<f64> = data
        .conditions
        .iter()
        .map(|c| wave(c.pressure_kpa))
        .collect();
    let (list, _) = folds::folds(&data, &vec![false; data.len()]);
    let features = black_box::Features::new(&data, &plain);
    let predicted = black_box::predict(&features, &residual, &list[0].train, &list[0].held_out);
    let squares = |f: &dyn Fn(usize) -> f64| -> f64 {
        let held = list[0].held_out.iter().enumerate();
        held.map(|(k, i)| (residual[*i] - f(k)) * (residual[*i] - f(k)))
            .sum()
    };
    let best = predicted
        .iter()
        .map(|p| squares(&|k| p[k]))
        .fold(f64::INFINITY, f64::min);
    assert!(
        best < 0.05 * squares(&|_| 0.0),
        "{best} {}",
        squares(&|_| 0.0)
    );
}

#[test]
fn folds_leave_whole_specimens_out_and_every_reading_once() {
    let data = data("");
    let (list, by) = folds::folds(&data, &vec![false; data.len()]);
    assert_eq!(by, "leave-one-specimen-out");
    let mut seen: Vec<usize> = list.iter().flat_map(|f| f.held_out.clone()).collect();
    seen.sort_unstable();
    assert_eq!(seen, (0..data.len()).collect::<Vec<usize>>());
    for fold in &list {
        let out = data.specimen[fold.held_out[0]];
        assert!(fold.train.iter().all(|i| data.specimen[*i] != out));
    }
}

#[test]
fn a_placebo_has_the_values_of_its_column_and_the_same_seed_shuffles_alike() {
    let (a, b) = (data("").with_placebo(3), data("").with_placebo(3));
    let of = |d: &Data| {
        d.extras
            .iter()
            .find(|e| e.name == PLACEBO)
            .unwrap()
            .values
            .clone()
    };
    assert_eq!(of(&a), of(&b));
    assert_ne!(of(&a), of(&data("").with_placebo(4)));
}
