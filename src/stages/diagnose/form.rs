//! Free forms: whether one number is enough for the size of an effect that was found, or whether the size changes along the effect's own
//! argument ([`pipeline_effects::Argument`]).
//!
//! At the mode of the found model the effect changes reading i by s_i = phi dh_i/dphi. The free form is s_i (1 + g(x_i)), x the argument over
//! the range of the readings on which the effect acts, g a Gaussian process in a cosine basis that bends over most of that range
//! ([`super::settings::FORM_LENGTH`]). Its coefficients are one more component at the root ([`pipeline_inference::form`]); the constant is left out,
//! because phi is free beside g. The size at x is then (phi + its change) + phi g(x), whatever part of a constant size the cosines take.
//!
//! The argument is frozen, also where it is the force: that of the found model, with its random effects. Sensitivities are those of the found
//! model too, so that a curve that doubles the size is right to the second order only; the test is made at the plain form, where they hold.
//!
//! Where many readings stand near the corner to slackness the linear model is not right by itself, and a constant size is called different too
//! often: half of sharp thresholds of 150 kPa, one in ten of 36 to 70 kPa. Leaving out the readings that do not pull is no way out: of 23 constant
//! zeros of the pressure 8 were then called different instead of 3.
//!
//! What a bent form does to the force, a misfit of the law may do as well. The model with g has the misfits too, and all variances are
//! estimated again: only what is too large or too much of one shape for the law's misfit tells that the form differs.

use super::bent::Bent;
use super::problem::ForceProblem;
use pipeline_findings::{FormPoint, FreeForm};
use pipeline_inference::decisions;
use pipeline_inference::fit::{Fitted, Setting};
use pipeline_inference::form::{Answer, Bootstrap, answers};
use pipeline_inference::screen::Normal;
use std::collections::BTreeMap;

/// Points of the curve, less one.
const STEPS: usize = 20;

/// An effect with an argument, beside the found model.
struct Asked {
    term: usize,
    bent: Bent,
    /// What is reported where the effect is absent.
    absent: f64,
    /// The first amplitude, and its place among the fixed effects.
    amplitude: f64,
    place: usize,
}

/// The free form of every effect that was found and has an argument, by its term.
pub fn free_forms(
    setting: &Setting,
    problem: &ForceProblem,
    model: &Fitted,
    draws: usize,
    normal: &Normal,
) -> BTreeMap<usize, FreeForm> {
    let terms = model.point.terms.iter();
    let asked: Vec<Asked> = terms
        .filter_map(|(term, _)| asked(setting, problem, model, *term))
        .collect();
    let sets: Vec<Vec<Vec<f64>>> = asked.iter().map(|a| a.bent.columns.clone()).collect();
    if sets.is_empty() {
        return BTreeMap::new();
    }
    let bootstrap = Bootstrap {
        level: decisions::LEVEL,
        draws,
    };
    let answers = answers(setting, model, &sets, bootstrap, normal);
    let both = asked.iter().zip(&answers);
    both.filter_map(|(asked, answer)| Some((asked.term, asked.free_form(answer.as_ref()?))))
        .collect()
}

fn asked(setting: &Setting, problem: &ForceProblem, model: &Fitted, term: usize) -> Option<Asked> {
    let values = model.values(term)?;
    let design = &model.design;
    let amplitudes = values.iter().take(problem.library[term].amplitudes);
    let by_amplitudes: Vec<(f64, &[f64])> = amplitudes
        .enumerate()
        .filter_map(|(k, a)| Some((*a, design.x[model.place(term, k)?].as_slice())))
        .collect();
    Some(Asked {
        term,
        bent: Bent::new(
            &problem.library[term],
            &problem.data.conditions,
            &by_amplitudes,
            &model.predicted,
            |i| setting.active[design.node[i]],
        )?,
        absent: problem.library[term].form()?.amplitude.absent,
        amplitude: values[0],
        place: model.place(term, 0)?,
    })
}

impl Asked {
    fn free_form(&self, answer: &Answer) -> FreeForm {
        let curve = (0..=STEPS).map(|k| {
            let share = k as f64 / STEPS as f64;
            let x = self.bent.range.0 + share * (self.bent.range.1 - self.bent.range.0);
            let (amplitude, sd) = self.size(answer, x);
            FormPoint {
                at: self.bent.argument.unscaled(x),
                amplitude,
                low: amplitude - decisions::NORMAL_95 * sd,
                high: amplitude + decisions::NORMAL_95 * sd,
            }
        });
        FreeForm {
            argument: self.bent.argument.id().to_owned(),
            unit: self.bent.argument.unit().to_owned(),
            log_likelihood_gain: answer.gain,
            p: answer.p,
            differs: answer.p < decisions::LEVEL,
            curve: curve.collect(),
        }
    }

    /// The size at a scaled argument as it is reported, and its standard error.
    fn size(&self, answer: &Answer, x: f64) -> (f64, f64) {
        let mut weights = vec![0.0; answer.mean.len()];
        for (w, c) in weights.iter_mut().zip(self.bent.basis(x)) {
            *w = self.amplitude * c;
        }
        weights[self.bent.columns.len() + self.place] = 1.0;
        let pairs = weights.iter().zip(&answer.mean);
        let change: f64 = pairs.map(|(w, m)| w * m).sum();
        let mut variance = 0.0;
        for (i, w) in weights.iter().enumerate() {
            for (j, v) in weights.iter().enumerate() {
                variance += w * v * answer.covariance.at(i, j);
            }
        }
        let sd = variance.max(0.0).sqrt();
        (self.absent + self.amplitude + change, sd)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Base;
    use crate::bent::COSINES;
    use crate::data::Data;
    use crate::library::{self, Scope};
    use pipeline_base::random::Stream;
    use pipeline_config::FitOptions;
    use pipeline_effects::Argument;
    use pipeline_inference::gram::Square;
    use pipeline_inference::problem::Problem;
    use pipeline_simulate::rig_like;

    #[test]
    fn the_size_is_the_amplitude_with_its_change_and_the_smooth_part() {
        let asked = Asked {
            term: 0,
            bent: Bent {
                argument: Argument::Pressure,
                range: (0.0, 600.0),
                columns: vec![Vec::new(); COSINES - 1],
            },
            absent: 1.0,
            amplitude: 0.1,
            place: 1,
        };
        let n = COSINES - 1 + 2;
        let mut answer = Answer {
            gain: 0.0,
            p: 1.0,
            sd: 0.0,
            mean: vec![0.0; n],
            covariance: Square::zeros(n),
        };
        // The second fixed effect is the amplitude, of a gain that is reported from 1.
        answer.mean[COSINES] = 0.02;
        *answer.covariance.at_mut(COSINES, COSINES) = 1e-4;
        let (size, sd) = asked.size(&answer, 300.0);
        assert!((size - 1.12).abs() < 1e-12 && (sd - 0.01).abs() < 1e-12);
        // The first cosine is 0 in the middle and falls from one end to the other; it is taken times the amplitude.
        answer.mean[0] = 0.5;
        *answer.covariance.at_mut(0, 0) = 0.04;
        let ends = [0.0, 300.0, 600.0].map(|x| (x, asked.size(&answer, x)));
        for (x, (size, sd)) in ends {
            let c = asked.bent.basis(x)[0];
            assert!((size - (1.12 + 0.1 * 0.5 * c)).abs() < 1e-12, "{x}");
            let expected = (1e-4 + 0.1 * 0.1 * 0.04 * c * c).sqrt();
            assert!((sd - expected).abs() < 1e-12, "{x}");
        }
        assert!(ends[0].1.0 > 1.12 && ends[2].1.0 < 1.12);
        assert!((ends[1].1.0 - 1.12).abs() < 1e-12);
    }

    /// The free form of the frame of a campaign with a frame that yields, in the simulator's form of this name.
    fn frame(form: &'static str, size: f64) -> FreeForm {
        let made = rig_like::campaign(
            7,
            &rig_like::Settings {
                specimens: Some(5),
                effects: vec![rig_like::Put {
                    id: "series_compliance",
                    form,
                    size,
                    others: &[],
                    from: 0.0,
                }],
                ..rig_like::Settings::default()
            },
        );
        let rows: Vec<_> = made.rows.iter().collect();
        let base = Base::new(10, true, 4, &FitOptions::default());
        let data = Data::new(&rows);
        let library = library::terms(&data);
        let problem = ForceProblem::new(&base, &data, &library).with_reference();
        let setting = Setting::new(&problem);
        let frame = library
            .iter()
            .position(|t| t.scope == Scope::All && t.is_frame());
        let frame = frame.unwrap();
        let mut from = problem.start();
        from.terms.push((frame, library[frame].start(20.0)));
        let model = setting.fit_afresh(&from);
        let normal = |k: usize| -> Box<dyn FnMut() -> f64> {
            let mut stream = Stream::new(1, &["form", &k.to_string()]);
            Box::new(move || stream.normal())
        };
        let mut all = free_forms(&setting, &problem, &model, 199, &normal);
        all.remove(&frame).unwrap()
    }

    #[test]
    fn a_frame_that_stiffens_is_told_from_one_that_does_not() {
        let plain = frame("", 30.0);
        assert!(!plain.differs && plain.p > decisions::LEVEL);
        assert_eq!(
            (plain.argument.as_str(), plain.unit.as_str()),
            ("force_n", "N")
        );
        let inside = plain.curve.iter().filter(|c| c.low < 30.0 && c.high > 30.0);
        assert!(inside.count() > STEPS / 2);
        let bent = frame("stiffening", 60.0);
        assert!(bent.differs && bent.p < decisions::LEVEL);
        let (first, last) = (&bent.curve[0], &bent.curve[STEPS]);
        assert!(last.high < first.low);
    }
}
