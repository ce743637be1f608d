//! The law by itself says of a specimen what the engine does that has all readings.

use super::{MixedLaw, Muscle, Parts};
use crate::base::Base;
use crate::data::Data;
use crate::library;
use crate::problem::ForceProblem;
use crate::suited::{Declared, part_of, suited};
use pipeline_base::row::Row;
use pipeline_config::FitOptions;
use pipeline_inference::heldout::Unseen;
use pipeline_inference::problem::Problem;
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
    fn with<T>(&self, see: impl Fn(&ForceProblem, &Unseen, usize, &MixedLaw) -> T) -> T {
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
        let law = MixedLaw::of(&rig_like::group(), &problem, &setting, &model, &[]).unwrap();
        let text = serde_json::to_string(&law).unwrap();
        let law: MixedLaw = serde_json::from_str(&text).unwrap();
        let specimen = data.specimens.iter().position(|s| *s == self.held_out);
        let node = problem.specimens[specimen.unwrap()];
        see(&problem, &Unseen::new(&setting, &model), node, &law)
    }
}

#[test]
fn a_specimen_that_took_no_part_is_predicted_as_by_the_engine() {
    let case = Case::new(3);
    let rows = case.of_held_out();
    case.with(|problem, unseen, node, law| {
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
                (of.mean_n - expected).abs() < 0.02 * engine.sd[k],
                "{} {expected}",
                of.mean_n
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
        assert!((gain / sources[crate::problem::component::GAIN] - 1.0).abs() < 0.02);
    });
}

#[test]
fn once_some_readings_are_known_the_others_are_predicted_as_by_the_engine() {
    let case = Case::new(4);
    let rows = case.of_held_out();
    case.with(|problem, unseen, node, law| {
        let places = unseen.readings(node, |_| true);
        let row_of = |i: usize| &case.rows[problem.data.place[i]];
        // In the corner the engine has the noise that is held while models are fitted.
        let pull = places.iter().copied().filter(|i| problem.pulls(*i));
        let known: Vec<usize> = pull.step_by(7).collect();
        let given: Vec<&Row> = known.iter().map(|i| row_of(*i)).collect();
        let muscle = Muscle::read(law, &given);
        assert_eq!(muscle.count().0, given.len());
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
            let off = (own[k].mean_n - expected).abs() / sd;
            assert!(off < 0.3, "{} {expected} {sd}", own[k].mean_n);
            errors += (rows[k].force_n - own[k].mean_n).powf(2.0);
            of_none += (rows[k].force_n - before[k].mean_n).powf(2.0);
        }
        assert!(errors < of_none, "{errors} {of_none}");
    });
}
