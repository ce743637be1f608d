//! The law by itself says of a specimen what the engine does that has all readings.

use super::{Acts, Beside, Held, MixedLaw, Muscle, Parts, Sizes, What, Whose};
use crate::base::Base;
use crate::data::{Data, Origins};
use crate::library;
use crate::problem::misfit::common_pairs;
use crate::problem::{ForceProblem, component};
use crate::settings;
use crate::suited::{Declared, part_of, suited};
use pipeline_base::row::Row;
use pipeline_config::FitOptions;
use pipeline_inference::fit::Fitted;
use pipeline_inference::heldout::Unseen;
use pipeline_inference::problem::Problem;
use pipeline_inference::system::Factor;
use pipeline_mechanics::models::new;
use pipeline_simulate::rig_like;
use std::collections::BTreeSet;

/// A campaign with a threshold, fitted without its last specimen.
struct Case {
    rows: Vec<Row>,
    held_out: String,
}

impl Case {
    fn new(seed: u64) -> Self {
        let settings = rig_like::Settings {
            specimens: Some(5),
            effects: vec![rig_like::Put {
                id: "bladder_threshold",
                form: "sharp",
                size: 50.0,
                others: &[],
                from: 0.0,
            }],
            ..rig_like::Settings::default()
        };
        let rows = rig_like::campaign(seed, &settings).rows;
        let held_out = rows.last().unwrap().specimen.clone();
        Self { rows, held_out }
    }

    fn of_held_out(&self) -> Vec<&Row> {
        let rows = self.rows.iter();
        rows.filter(|r| r.specimen == self.held_out).collect()
    }

    /// What somebody sees of a fit without the specimen.
    fn with<T>(&self, see: impl Fn(&ForceProblem, (&Fitted, &Unseen), usize, &MixedLaw) -> T) -> T {
        let rows: Vec<&Row> = self.rows.iter().collect();
        let data = Data::new(&rows);
        let base = Base::new(10, true, 5, &FitOptions::default());
        let library = library::terms(&data);
        let kept_out: BTreeSet<&str> = self
            .of_held_out()
            .iter()
            .map(|r| r.session.as_str())
            .collect();
        let (problem, null) = suited(&base, &data, &library, &kept_out, Declared::Taken);
        let threshold = library
            .iter()
            .position(|t| t.id() == Some("bladder_threshold"));
        let setting = part_of(&problem, &kept_out);
        let mut from = null.point.clone();
        let threshold = threshold.unwrap();
        from.terms.push((threshold, library[threshold].start(40.0)));
        let model = setting.fit(&from, std::slice::from_ref(&null.variances));
        let law = MixedLaw::of(&rig_like::group(), &problem, &setting, &model, &[], None).unwrap();
        let text = serde_json::to_string(&law).unwrap();
        let law: MixedLaw = serde_json::from_str(&text).unwrap();
        let specimen = data.specimens.iter().position(|s| *s == self.held_out);
        let node = problem.specimens[specimen.unwrap()];
        see(
            &problem,
            (&model, &Unseen::new(&setting, &model)),
            node,
            &law,
        )
    }
}

#[test]
fn a_specimen_that_took_no_part_is_predicted_as_by_the_engine() {
    let case = Case::new(3);
    let rows = case.of_held_out();
    case.with(|problem, (_, unseen), node, law| {
        let engine = unseen.predict_where(node, |_| true);
        let own = Muscle::unread(law).forecast_of(&rows);
        let mut pulling = 0;
        for (k, &i) in engine.places.iter().enumerate() {
            if !problem.pulls(i) {
                continue;
            }
            pulling += 1;
            let place = rows
                .iter()
                .position(|r| std::ptr::eq(*r, &case.rows[problem.data.place[i]]));
            let of = own[place.unwrap()];
            let expected = problem.observed()[i] - engine.errors[k];
            // The reference of the misfit of that specimen's sessions is another in the engine: it has readings of them.
            assert!(
                (of.mean_n() - expected).abs() < 0.02 * engine.sd[k],
                "{} {expected}",
                of.mean_n()
            );
            let sd = of.parts.variance().sqrt();
            assert!(
                (sd / engine.sd[k] - 1.0).abs() < 0.02,
                "{sd} {}",
                engine.sd[k]
            );
        }
        assert!(pulling > 20, "{pulling}");
        let sources = engine.sources;
        let mean = |of: &dyn Fn(&Parts) -> f64| {
            own.iter().map(|f| of(&f.parts) * of(&f.parts)).sum::<f64>() / own.len() as f64
        };
        let gain = mean(&|p| p.gain_n);
        assert!((gain / sources[component::GAIN] - 1.0).abs() < 0.02);
    });
}

#[test]
fn once_some_readings_are_known_the_others_are_predicted_as_by_the_engine() {
    let case = Case::new(4);
    let rows = case.of_held_out();
    case.with(|problem, (_, unseen), node, law| {
        let places = unseen.readings(node, |_| true);
        let row_of = |i: usize| &case.rows[problem.data.place[i]];
        // In the corner the engine has the noise that is held while models are fitted.
        let pull = places.iter().copied().filter(|i| problem.pulls(*i));
        let known: Vec<usize> = pull.step_by(7).collect();
        let given: Vec<&Row> = known.iter().map(|i| row_of(*i)).collect();
        let muscle = Muscle::read(law, &given);
        assert_eq!(muscle.others(), 4);
        let own = muscle.forecast_of(&rows);
        let after = unseen.errors_after(node, &known);
        let before = Muscle::unread(law).forecast_of(&rows);
        let (mut errors, mut of_none) = (0.0, 0.0);
        for (i, error) in after {
            if !problem.pulls(i) {
                continue;
            }
            let k = rows
                .iter()
                .position(|r| std::ptr::eq(*r, row_of(i)))
                .unwrap();
            let expected = problem.observed()[i] - error;
            let sd = own[k].parts.variance().sqrt();
            let off = (own[k].mean_n() - expected).abs() / sd;
            assert!(off < 0.3, "{} {expected} {sd}", own[k].mean_n());
            let [with, without] = [&own, &before].map(|f| rows[k].force_n - f[k].mean_n());
            errors += with * with;
            of_none += without * without;
        }
        assert!(errors < of_none, "{errors} {of_none}");
    });
}

#[test]
fn a_specimen_of_the_fit_has_the_gain_that_the_fit_gave_it() {
    let case = Case::new(5);
    case.with(|problem, (model, unseen), node, law| {
        // By the variances of predictions, as the law has them.
        let factor = Factor::new(&model.design.tree, &model.gram, unseen.variances());
        let random = factor.estimates().random;
        for (id, of) in problem.data.specimens.iter().zip(&problem.specimens) {
            let rows: Vec<&Row> = case.rows.iter().filter(|r| r.specimen == *id).collect();
            let muscle = Muscle::read(law, &rows);
            assert_eq!(muscle.is_in_law(), *of != node, "{id}");
            if *of == node {
                continue;
            }
            let (column, _) = problem.tree().columns_of(*of, component::GAIN).unwrap();
            let gain = muscle.gain();
            let off = (gain.value - random[column]).abs() / gain.sd_before;
            assert!(off < 0.2, "{id}: {gain:?} {}", random[column]);
            assert!(gain.sd < gain.sd_before);
        }
    });
}

/// A law that is known exactly, with nothing but gain, set length, zero and noise to be known of a muscle.
fn exact() -> MixedLaw {
    let common = common_pairs().count();
    MixedLaw {
        campaign: "c".to_owned(),
        diameter_mm: 10,
        campaigns: vec!["c".to_owned()],
        specimens: (0..7).map(|k| k.to_string()).collect(),
        lengths_m: vec![[0.2, 0.167]; 7],
        noted_contraction: None,
        sessions: 28,
        readings: 500,
        unseen_n: None,
        cap_length_m: 0.0075,
        shape: [0.5682, 4.254, 0.5597],
        coefficients: vec![303.5, 1.0 / 19.03, 0.5682, 4.254, 0.5597],
        terms: Vec::new(),
        origins: Origins::default(),
        largest_n: 450.0,
        floor_n: 90.0,
        beside: Beside {
            coefficients: vec![303.5, 1.0 / 19.03, 0.5682, 4.254, 0.5597],
            free: vec![0, 1, 2, 3, 4],
            weights: vec![vec![0.0; 5]; common],
        },
        free: Vec::new(),
        common_mean: vec![0.0; common + 1],
        root: vec![0.0; (common + 1) * (common + 2) / 2],
        sd: Sizes {
            gain: 0.05,
            rest_length_mm: 0.0,
            contracted_length_mm: 0.0,
            contraction: 0.0,
            set_length_mm: 0.9,
            set_length_declared: false,
            declared_factor: 1.0,
            zero_n: 1.5,
            session_misfit: 0.0,
            stroke_misfit: None,
            campaign_gain: 0.0,
            campaign_zero_n: 0.0,
            noise_n: vec![2.0],
            corner_n: vec![(0.0, 5.0); 4],
        },
    }
}

fn published(length_m: f64) -> f64 {
    of_stroke(0.033, length_m)
}

fn of_stroke(stroke_m: f64, length_m: f64) -> f64 {
    let f620 = new::f620(303.5, 19.03, 0.0075, 0.2);
    let relative = (0.2 - length_m) / stroke_m;
    new::force([0.5682, 4.254, 0.5597], f620, relative, 500.0 / 620.0)
}

/// One reading y gives the gain tau^2 f (y - f)/(tau^2 f^2 + s_l^2 f'^2 + s_z^2 + s_e^2), f' by the set length, and the set length likewise.
#[test]
fn one_reading_is_shared_out_by_the_variances() {
    let law = exact();
    let close =
        |a: f64, b: f64| assert!((a - b).abs() < 1e-2 * b.abs().max(1e-3), "{a} against {b}");
    let state = [0.2, 0.2 - 0.033, 0.19, 500.0];
    let f = published(0.19);
    let slope = (published(0.19001) - published(0.18999)) / 0.02;
    let (tau, length, zero, noise) = (0.05, 0.9 * slope, 1.5, 2.0);
    // Without a reading it is the law.
    let before = Muscle::unread(&law).at(state, Whose::Rig);
    close(before.mean_n(), f);
    let own = tau * tau * f * f;
    let session = length * length + zero * zero;
    close(before.parts.variance(), own + session + noise * noise);
    // The actuator itself has neither zero nor noise.
    let itself = Muscle::unread(&law).at(state, Whose::Actuator);
    close(itself.parts.variance(), own + length * length);
    let known = Muscle::unread(&law)
        .with_length_sd(0.0)
        .at(state, Whose::Actuator);
    close(known.parts.variance(), own);
    // Groups less one, weighted by the squares of what they make.
    let parts = [(own, 6.0), (length * length, 27.0)];
    let squares: f64 = parts.iter().map(|(v, freedom)| v * v / freedom).sum();
    close(
        itself.freedom,
        (own + length * length) * (own + length * length) / squares,
    );
    let mut row = rig_like::campaign(1, &rig_like::Settings::default())
        .rows
        .swap_remove(0);
    (row.rest_length_m, row.contracted_length_m) = (state[0], state[1]);
    (row.length_m, row.pressure_kpa, row.force_n) = (state[2], state[3], f + 3.0);
    row.length_sd_m = f64::NAN;
    let read = Muscle::read(&law, &[&row]);
    let total = own + session + noise * noise;
    let gain = read.gain();
    // Slopes are taken anew where the length is then, a little off.
    assert!((gain.value / (tau * tau * f * 3.0 / total) - 1.0).abs() < 0.02);
    close(gain.sd, tau * (1.0 - own / total).sqrt());
    let set = &read.set_lengths()[0];
    // Slopes are taken anew where the length is then, a little off.
    assert!(
        (set.value - 0.9 * length * 3.0 / total).abs() < 0.02,
        "{set:?}"
    );
    // A reading of the same session comes back nearer to the reading than one of another, which has the gain alone.
    let again = read.forecast_of(&[&row])[0].mean_n();
    let other = read.at(state, Whose::Rig);
    assert!(f < other.mean_n() && other.mean_n() < again && again < f + 3.0);
    close(other.mean_n(), f * (1.0 + gain.value));
    // Its slope is that at the gain that it has now.
    let left = own - own * own / total + session + noise * noise;
    assert!((other.parts.variance() / left - 1.0).abs() < 0.02);
}

/// A muscle noted with 0.165 where others are noted with 0.155 has this, if all that the noted contractions differ by is error; not if it is declared.
#[test]
fn a_noted_contraction_counts_for_what_those_of_others_are_worth() {
    let (error, error_sd, own_sd) = (0.75, 0.2, 0.004);
    let mut law = exact();
    let column = MixedLaw::noting_column();
    law.noted_contraction = Some(0.155);
    let (usual, sd) = settings::NOTING_ERROR;
    law.common_mean[column] = (error - usual) / sd;
    *law.root.last_mut().unwrap() = error_sd / sd;
    law.sd.contraction = own_sd;
    assert!(law.is_sound());
    let close =
        |a: f64, b: f64| assert!((a - b).abs() < 1e-6 * b.abs().max(1.0), "{a} against {b}");
    let taken = 0.165 - error * 0.01;
    let state = [0.2, 0.2 - 0.033, 0.19, 500.0];
    let unread = Muscle::unread(&law).at(state, Whose::Actuator);
    close(unread.mean_n(), of_stroke(0.2 * taken, 0.19));
    let of = |eps: f64| of_stroke(0.2 * eps, 0.19);
    let slope = (of(taken + 1e-6) - of(taken - 1e-6)) / 2e-6;
    close(unread.parts.estimation_n, (slope * 0.01 * error_sd).abs());
    close(unread.parts.lengths_n, (slope * own_sd).abs());
    let mut row = rig_like::campaign(1, &rig_like::Settings::default())
        .rows
        .swap_remove(0);
    (row.rest_length_m, row.contracted_length_m) = (state[0], state[1]);
    (row.length_m, row.pressure_kpa, row.force_n) = (state[2], state[3], unread.mean_n());
    row.length_sd_m = f64::NAN;
    // It has just the force that is expected of it.
    let longer = Muscle::read(&law, &[&row]).contracted_length().unwrap();
    let mm = 200.0 * error * 0.01;
    close(longer.value_before, mm);
    close(longer.value, mm);
    let sd = 200.0 * libm::hypot(own_sd, 0.01 * error_sd);
    close(longer.sd_before, sd);
    assert!(longer.sd < sd);
    row.contracted_length_sd_m = 2e-4;
    row.force_n = of(0.165);
    let declared = Muscle::read(&law, &[&row]);
    let longer = declared.contracted_length().unwrap();
    close(longer.value_before, 0.0);
    close(longer.sd_before, 0.2);
    close(
        declared.at(state, Whose::Actuator).mean_n(),
        published(0.19),
    );
}

/// A change from a session on is none of the sessions before it, and one of all that are still to come.
#[test]
fn what_acts_from_a_session_on_acts_on_no_earlier_one() {
    let mut law = exact();
    let sessions = [("before", None), ("after", Some(0))];
    law.terms.push(Held {
        what: What::Effect {
            id: "force_zero_offset".to_owned(),
            form: "constant".to_owned(),
        },
        class: vec!["force_zero_offset".to_owned()],
        values: vec![10.0],
        acts: Acts::Sessions {
            amplitude: sessions.map(|(id, a)| (id.to_owned(), a)).into(),
            later: true,
        },
    });
    assert!(law.is_sound());
    let mut row = rig_like::campaign(1, &rig_like::Settings::default())
        .rows
        .swap_remove(0);
    (row.rest_length_m, row.contracted_length_m) = (0.2, 0.167);
    (row.length_m, row.pressure_kpa) = (0.19, 500.0);
    row.force_n = published(0.19);
    let read_in = |session: &str| {
        let row = Row {
            session: session.to_owned(),
            ..row.clone()
        };
        Muscle::unread(&law).forecast_of(&[&row])[0].mean_n() - published(0.19)
    };
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} against {b}");
    close(read_in("before"), 0.0);
    close(read_in("after"), 10.0);
    close(read_in("another"), 10.0);
    // Of the rig, so that the muscle itself has none of it.
    let at = |whose| {
        Muscle::unread(&law)
            .at([0.2, 0.167, 0.19, 500.0], whose)
            .mean_n()
    };
    close(at(Whose::Rig) - at(Whose::Actuator), 10.0);
}
