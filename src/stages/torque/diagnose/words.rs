//! What the findings of a joint say in words: summary, notes, and the sets that do nearly as well.

use super::answer::{Answered, label};
use super::judge::Task;
use super::refit::Sizes;
use super::terms::{ALL, place};
use super::tests::TestErrors;
use crate::stages::diagnose::findings::{
    EffectFinding, Errors, Reading as Alternative, Unexplained, Verdict,
};
use crate::stages::diagnose::words::with_unit;
use crate::stages::torque::errors::Size;
use std::collections::BTreeSet;

/// Sets whose criterion is within this of the best are shown.
const NEAR: f64 = 6.0;
const MOST_SHOWN: usize = 8;
/// An actuator is predicted worse where its error grows by more than this factor.
const WORSE: f64 = 1.05;

impl Answered<'_, '_> {
    pub(super) fn summary(
        &self,
        verdict: Verdict,
        effects: &[EffectFinding],
        unexplained: &[Unexplained],
        before: &Errors,
        after: &Errors,
    ) -> String {
        let of_doubtful = match self.group.doubtful {
            true => "from doubtful tests alone: ",
            false => "",
        };
        let found = match verdict {
            Verdict::EffectFound => {
                let named: Vec<String> = effects
                    .iter()
                    .map(|e| {
                        let p = &e.parameters[0];
                        let twice = effects.iter().filter(|o| o.title == e.title).count() > 1;
                        let form = if twice {
                            format!(", {}", e.form)
                        } else {
                            String::new()
                        };
                        format!(
                            "{}{form} ({} = {})",
                            e.title,
                            p.name,
                            with_unit(p.value, &p.unit)
                        )
                    })
                    .collect();
                format!(
                    "{}; held-out error {:.2} -> {:.2} N.m",
                    named.join(" and "),
                    before.rmse_heldout,
                    after.rmse_heldout
                )
            }
            Verdict::None => "no structure beyond the scatter between tests".to_owned(),
            Verdict::Unexplained => {
                let columns: Vec<&str> = unexplained.iter().map(|u| u.column.as_str()).collect();
                format!(
                    "the residual follows {}, and no effect of the joint stands",
                    columns.join(" and ")
                )
            }
        };
        let large = match self.implausible().is_empty() {
            true => "",
            false => " (implausibly large: see the notes)",
        };
        let odd: String = self.odd().iter().map(|o| format!("; {o}")).collect();
        format!("{of_doubtful}{found}{large}{odd}")
    }

    /// The sets that do nearly as well as the best one, with held-out errors and numbers.
    pub(super) fn alternatives(&self) -> Vec<Alternative> {
        let best = self.whole.sets.first().map_or(f64::NAN, |s| s.criterion);
        let task = self.task();
        let n = self.readings().len() as f64;
        let near = self.whole.sets.iter();
        let near =
            near.filter(|s| s.criterion < best + NEAR && !s.sizes.terms.contains(&place::PLACEBO));
        near.take(MOST_SHOWN)
            .map(|set| {
                let sizes = &set.sizes;
                let held_out: f64 = task.held_out(&sizes.terms, sizes).iter().sum();
                let names: Vec<&str> = sizes.terms.iter().map(|t| ALL[*t].form).collect();
                let residuals = sizes.residuals(self.readings());
                Alternative {
                    model: format!("rigid + {}", names.join(" + ")),
                    parameters: sizes.terms.len(),
                    errors: Errors {
                        rmse_train: (sizes.sse / n).sqrt(),
                        rmse_heldout: (held_out / n).sqrt(),
                        max_abs_error_heldout: residuals.iter().fold(0.0, |m, r| m.max(r.abs())),
                        rmse_heldout_own_strength: (held_out / n).sqrt(),
                    },
                    numbers: sizes.terms.iter().map(|t| label(*t, sizes)).collect(),
                }
            })
            .collect()
    }

    pub(super) fn task(&self) -> Task<'_, '_> {
        Task {
            readings: self.readings(),
            spreads: &self.whole.spreads,
            candidates: &self.whole.candidates,
            most: self.whole.most,
            confidence: self.confidence,
        }
    }

    pub(super) fn notes(&self, tests: &BTreeSet<usize>) -> Vec<String> {
        let mut notes = Vec::new();
        if self.group.doubtful {
            let doubts: BTreeSet<&str> = self.group.doubts.iter().copied().flatten().collect();
            let doubts: Vec<&str> = doubts.into_iter().collect();
            notes.push(format!(
                "nothing but doubtful tests ({}): searched by themselves, and part of no other fit",
                doubts.join("; ")
            ));
        }
        if tests.len() == 1 {
            notes.push(
                "one test of the joint: how it was mounted cannot be told from what belongs to the joint, but for its size"
                    .to_owned(),
            );
        }
        let [mounting, strength] = self.whole.spreads.between;
        notes.push(format!(
            "taken as each test's and actuator's own: offsets of the length with a standard deviation of {mounting:.1} mm, strengths with one of {:.1} %; noise {:.2} N.m",
            100.0 * strength,
            self.whole.spreads.noise_nm
        ));
        notes.extend(self.both_brackets());
        notes.extend(self.odd());
        notes.extend(self.implausible());
        notes.extend(self.made_worse());
        if self.sizes().values[place::FRICTION] < 0.0 {
            notes.push(
                "the friction has the sign of an actuator's own hysteresis: dry friction of the joint would be positive"
                    .to_owned(),
            );
        }
        if let Some(largest) = self.largest {
            let named: Vec<String> = largest.terms.iter().map(|t| label(*t, largest)).collect();
            notes.push(match named.is_empty() {
                true => "no size could be fitted to the configuration with most readings alone"
                    .to_owned(),
                false => format!(
                    "fitted to the configuration with most readings alone: {}",
                    named.join(" and ")
                ),
            });
        }
        let own: Vec<f64> = self
            .tests
            .iter()
            .filter(|t| t.fitted && t.own_offset_mm.is_finite())
            .map(|t| t.own_offset_mm)
            .collect();
        if own.len() > 1 {
            let (low, high) = own
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                    (l.min(*x), h.max(*x))
                });
            notes.push(format!(
                "tests differ by offsets of the length from {low:.1} to {high:.1} mm: no value for all of them can do better than that allows"
            ));
        }
        let placebo = self
            .whole
            .again
            .iter()
            .filter(|s| s.contains(&place::PLACEBO));
        let placebo = placebo.count();
        if placebo > 0 {
            notes.push(format!(
                "the shuffled column was chosen in {placebo} of {} searches without one test or stretch: too few readings for the search",
                self.whole.again.len()
            ));
        }
        notes
    }

    /// Sizes beyond those that such parts were measured to have.
    fn implausible(&self) -> Vec<String> {
        let sizes = self.sizes();
        let beyond = |t: &&usize| sizes.values[**t].abs() > ALL[**t].usual;
        let terms = sizes.terms.iter().filter(beyond);
        terms
            .map(|t| {
                format!(
                    "{}: implausibly large for what its name says (such parts have up to {} {}); something else is probably in it",
                    label(*t, sizes),
                    ALL[*t].usual,
                    ALL[*t].unit
                )
            })
            .collect()
    }

    /// Actuators that are predicted worse than by the rigid leg.
    fn made_worse(&self) -> Vec<String> {
        let actuators: BTreeSet<&str> = self.tests.iter().map(|t| &t.specimen[..]).collect();
        let of = |actuator: &str, size: fn(&TestErrors) -> Option<Size>| {
            let own = self.tests.iter();
            let own = own.filter(|t| t.fitted && t.specimen == actuator);
            let sizes: Vec<Size> = own.filter_map(size).collect();
            let (n, sse) = sizes
                .iter()
                .fold((0, 0.0), |(n, sse), s| (n + s.n, sse + s.sse));
            (sse / n as f64).sqrt()
        };
        let worse = |actuator: &&str| {
            let rigid = of(actuator, |t| t.before);
            let (after, held_out) = (of(actuator, |t| t.after), of(actuator, |t| t.held_out));
            (after > WORSE * rigid || held_out > WORSE * rigid).then(|| {
                format!(
                    "worse than the rigid leg on {actuator}: {rigid:.2} → {after:.2} N.m fitted, {held_out:.2} held out"
                )
            })
        };
        actuators.iter().filter_map(worse).collect()
    }

    /// Whether the readings determine the stiffness of both brackets, beside an offset of the length.
    fn both_brackets(&self) -> Option<String> {
        let both = [place::LENGTH, place::ORIGIN, place::INSERTION];
        if !both.iter().all(|t| self.whole.candidates.contains(t)) {
            return None;
        }
        let sizes = Sizes::of(&both, self.readings(), &self.whole.spreads, None);
        let halves = self.task().half_widths(&sizes);
        let interval = |place: usize| {
            let value = sizes.values[both[place]];
            (value - halves[place], value, value + halves[place])
        };
        let words = |place: usize| {
            let (low, value, high) = interval(place);
            format!(
                "{} {value:.0} um/N (95% interval {:.0} to {high:.0})",
                ALL[both[place]].form,
                low.max(0.0)
            )
        };
        let open = |place: usize| interval(place).0.is_nan() || interval(place).0 <= 0.0;
        let undetermined = open(1) || open(2) || !sizes.inside;
        Some(format!(
            "both brackets at once: {} and {}; {}",
            words(1),
            words(2),
            if undetermined {
                "the torques do not determine both stiffnesses"
            } else {
                "the torques determine both"
            }
        ))
    }
}
