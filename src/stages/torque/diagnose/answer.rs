//! The findings of one joint.

use super::judge::{Judged, fold_of};
use super::refit::{Reading, Sizes};
use super::terms::{ALL, place};
use super::tests::TestErrors;
use super::traces::{ALIKE, Traces, VISIBLE};
use super::{Group, Searched, black_box};
use crate::numerics::statistics::sum_of_squares;
use crate::stages::diagnose::findings::{
    Alias, CampaignFindings, DetectionLimit, EffectFinding, Errors, FoldErrors, NextMeasurement,
    NotMeasurable, ParameterFinding, Rejected, Unexplained, Verdict,
};
use std::collections::BTreeSet;

/// Share of the held-out error that a smooth curve has to take away to count as structure.
const STRUCTURE: f64 = 0.8;

/// Everything that the findings are made of.
pub(super) struct Answered<'s, 'a> {
    pub campaign: &'s str,
    pub simulated: bool,
    pub group: &'s Group<'a>,
    pub readings: &'s [Reading<'a>],
    pub candidates: &'s [usize],
    pub most: usize,
    pub whole: &'s Searched,
    pub held_out: &'s [(usize, Sizes)],
    pub largest: Option<&'s Sizes>,
    pub tests: &'s [TestErrors],
    pub confidence: f64,
}

fn rms(residuals: &[f64]) -> f64 {
    (sum_of_squares(residuals) / residuals.len().max(1) as f64).sqrt()
}

fn largest(residuals: &[f64]) -> f64 {
    residuals.iter().fold(0.0, |m: f64, r| m.max(r.abs()))
}

impl Answered<'_, '_> {
    fn sizes(&self) -> &Sizes {
        &self.whole.accepted.sizes
    }

    /// Residuals of readings by the search without their fold.
    fn held_out_residuals(&self) -> Vec<f64> {
        let fold = fold_of(self.readings);
        let of = |r: &Reading| {
            let found = self.held_out.iter().find(|(f, _)| *f == fold(r));
            found.map_or(f64::NAN, |(_, sizes)| r.torque_nm - sizes.predict(r).0)
        };
        self.readings.iter().map(of).collect()
    }

    pub fn findings(&self) -> CampaignFindings {
        let rigid = Sizes::rigid(self.readings).residuals(self.readings);
        let (fitted, held_out) = (
            self.sizes().residuals(self.readings),
            self.held_out_residuals(),
        );
        let fold = fold_of(self.readings);
        let folds: Vec<usize> = self.readings.iter().map(fold).collect();
        let angles: Vec<f64> = self.readings.iter().map(|r| r.at.angle_rad).collect();
        let smooth = black_box::left(&angles, &rigid, &folds);
        let smooth_after = black_box::left(&angles, &held_out, &folds);
        let errors = |train: &[f64], out: &[f64]| Errors {
            rmse_train: rms(train),
            rmse_heldout: rms(out),
            max_abs_error_heldout: largest(out),
            rmse_heldout_own_strength: rms(out),
        };
        let (before, after) = (errors(&rigid, &rigid), errors(&fitted, &held_out));
        let traces = Traces::new(self.readings, self.sizes());
        let effects: Vec<EffectFinding> = self
            .whole
            .accepted
            .judged
            .iter()
            .map(|j| self.effect(j, &traces))
            .collect();
        let (now, then) = if effects.is_empty() {
            // Effects may stand without an actuator and fall with it: that is structure, too.
            (rms(&rigid), rms(&smooth).min(rms(&held_out)))
        } else {
            (rms(&held_out), rms(&smooth_after))
        };
        let mut unexplained = Vec::new();
        if then < STRUCTURE * now {
            unexplained.push(Unexplained {
                column: "angle".to_owned(),
                shape: "offset".to_owned(),
                p_adjusted: f64::NAN,
                share_of_residual: 1.0 - then * then / (now * now),
                rmse_heldout_before: Some(now),
                rmse_heldout_after: Some(then),
                curve: Vec::new(),
            });
        }
        let verdict = match (effects.is_empty(), unexplained.is_empty()) {
            (false, _) => Verdict::EffectFound,
            (true, false) => Verdict::Unexplained,
            (true, true) => Verdict::None,
        };
        let configuration = &self.group.members[0].1;
        let part = format!("{} knee, {}", configuration.knee, configuration.muscle);
        let tests: BTreeSet<usize> = self.readings.iter().map(|r| r.test).collect();
        let actuators: BTreeSet<usize> = self.readings.iter().map(|r| r.actuator).collect();
        CampaignFindings {
            campaign: self.campaign.to_owned(),
            part: Some(part),
            diameter_mm: configuration.diameter_mm,
            simulated: self.simulated,
            kind: "knee-torque".to_owned(),
            base_model: self.group.law.id().to_owned(),
            base_refitted: false,
            unit: "N.m".to_owned(),
            verdict,
            summary: self.summary(verdict, &effects, &before, &after),
            readings: self.readings.len(),
            sessions: tests.len(),
            specimens: actuators.len(),
            readings_held_out: self.group.all.len() - self.readings.len(),
            held_out_by: self.held_out_by(actuators.len()).to_owned(),
            questions: Vec::new(),
            unexplained,
            suspects: Vec::new(),
            before,
            after,
            after_as_chosen: None,
            after_empirical: None,
            by_specimen: self.by_fold(&rigid, &held_out, &smooth),
            noise_floor: None,
            black_box_rmse_heldout: Some(rms(&smooth)),
            black_box_after_rmse_heldout: (!effects.is_empty()).then(|| rms(&smooth_after)),
            rejected: self.rejected(),
            detection_limits: self.limits(&traces),
            not_measurable: self.not_measurable(&traces),
            aliases: self.aliases(&traces),
            readings_of_the_base: self.alternatives(),
            coefficients: Vec::new(),
            next_measurement: self.next(&effects),
            notes: self.notes(&tests),
            effects,
        }
    }

    fn held_out_by(&self, actuators: usize) -> &'static str {
        match (actuators, self.group.by_test) {
            (1, true) => "leave-one-test-out",
            (1, false) => "leave-one-stretch-of-the-angle-out",
            _ => "leave-one-actuator-out",
        }
    }

    fn effect(&self, judged: &Judged, traces: &Traces) -> EffectFinding {
        let (term, sizes) = (&ALL[judged.term], self.sizes());
        let value = sizes.values[judged.term];
        let half = judged.half_width.unwrap_or(f64::NAN);
        let mut others = sizes.terms.clone();
        others.retain(|t| *t != judged.term);
        let without = Sizes::of(&others, self.readings, Some(sizes));
        let n = self.readings.len() as f64;
        let criterion = |terms: &[usize]| {
            let set = self.whole.sets.iter().find(|s| s.sizes.terms == terms);
            set.map_or(f64::NAN, |s| s.criterion)
        };
        EffectFinding {
            id: term.id.to_owned(),
            title: term.title.to_owned(),
            equation: term.equation.to_owned(),
            form: term.form.to_owned(),
            class: self.class(judged.term, traces),
            scope: "global".to_owned(),
            acts_on: "all readings".to_owned(),
            parameters: vec![ParameterFinding {
                name: term.symbol.to_owned(),
                value,
                ci_low: value - half,
                ci_high: value + half,
                unit: term.unit.to_owned(),
            }],
            p_adjusted: judged.p_adjusted,
            selected_in_folds: judged.chosen_again,
            helps_in_folds: judged.helps,
            rmse_before: (without.sse / n).sqrt(),
            rmse_after: (sizes.sse / n).sqrt(),
            rmse_heldout_before: (judged.held_out.0 / n).sqrt(),
            rmse_heldout_after: (judged.held_out.1 / n).sqrt(),
            criterion_gain: criterion(&others) - criterion(&sizes.terms),
            source: term.source.to_owned(),
            measurement: term.measurement.to_owned(),
        }
    }

    /// The effect and all that leave its trace; a force that is not along the sensor shrinks as one of a weaker actuator.
    fn class(&self, term: usize, traces: &Traces) -> Vec<String> {
        let alike = |t: &&usize| **t == term || traces.cosine(term, **t).abs() > ALIKE;
        let candidates = self.candidates.iter().filter(|t| **t != place::PLACEBO);
        let mut ids = vec![ALL[term].id.to_owned()];
        for other in candidates.filter(alike) {
            ids.push(ALL[*other].id.to_owned());
        }
        if ids.iter().any(|id| id == "force_gain") {
            ids.extend(["misalignment", "specimen_variation"].map(str::to_owned));
        }
        let mut seen = BTreeSet::new();
        ids.retain(|id| seen.insert(id.clone()));
        ids
    }

    fn by_fold(&self, rigid: &[f64], held_out: &[f64], smooth: &[f64]) -> Vec<FoldErrors> {
        let fold = fold_of(self.readings);
        let of = |out: usize, all: &[f64]| {
            let own = self.readings.iter().zip(all);
            let own: Vec<f64> = own
                .filter(|(r, _)| fold(r) == out)
                .map(|(_, e)| *e)
                .collect();
            own
        };
        let one = |(out, sizes): &(usize, Sizes)| {
            let first = self.readings.iter().find(|r| fold(r) == *out);
            let unit = first.map_or(String::new(), |r| {
                let actuator = self.group.actuators[r.actuator];
                match fold(r) == r.actuator {
                    true => actuator.to_owned(),
                    false => format!("{actuator}, part {}", out + 1),
                }
            });
            let chosen = sizes.terms.iter().map(|t| label(*t, sizes)).collect();
            FoldErrors {
                unit,
                readings: of(*out, rigid).len(),
                before: rms(&of(*out, rigid)),
                after: rms(&of(*out, held_out)),
                black_box: Some(rms(&of(*out, smooth))),
                chosen,
            }
        };
        self.held_out.iter().map(one).collect()
    }

    /// Single terms that were not taken: what they would explain by themselves.
    fn rejected(&self) -> Vec<Rejected> {
        let rigid = Sizes::rigid(self.readings).sse;
        let taken = |t: &&usize| !self.sizes().terms.contains(t);
        let one = |t: &usize| {
            let alone = Sizes::of(&[*t], self.readings, None);
            let why = if alone.inside {
                "another set of effects explains more, or it does not stand beside it"
            } else {
                "runs to a bound of what is physically possible"
            };
            Rejected {
                id: format!("{} ({})", ALL[*t].id, ALL[*t].form),
                acts_on: "all readings".to_owned(),
                share: 1.0 - alone.sse / rigid,
                why: why.to_owned(),
            }
        };
        let mut all: Vec<Rejected> = self.candidates.iter().filter(taken).map(one).collect();
        all.sort_by(|a, b| b.share.total_cmp(&a.share));
        all
    }

    fn measurable(&self, term: usize, traces: &Traces) -> Result<f64, &'static str> {
        let smallest = traces.smallest(term, self.candidates.len());
        if !smallest.is_finite() {
            return Err("leaves no trace in these readings");
        }
        if traces.visible(term) < VISIBLE {
            return Err("the effects that were found take up its trace");
        }
        if smallest > ALL[term].bounds.1 {
            return Err("only a size beyond what is possible would show");
        }
        Ok(smallest)
    }

    fn limits(&self, traces: &Traces) -> Vec<DetectionLimit> {
        let candidates = self.candidates.iter().filter(|t| **t != place::PLACEBO);
        let limit = |t: &usize| {
            let smallest = self.measurable(*t, traces).ok()?;
            Some(DetectionLimit {
                id: ALL[*t].id.to_owned(),
                form: ALL[*t].form.to_owned(),
                smallest,
                unit: ALL[*t].unit.to_owned(),
                visible: traces.visible(*t),
            })
        };
        candidates.filter_map(limit).collect()
    }

    fn not_measurable(&self, traces: &Traces) -> Vec<NotMeasurable> {
        let candidates = self.candidates.iter().filter(|t| **t != place::PLACEBO);
        let of = |id: &str, why: &str| NotMeasurable {
            id: id.to_owned(),
            why: why.to_owned(),
        };
        let mut all: Vec<NotMeasurable> = candidates
            .filter_map(|t| {
                let why = self.measurable(*t, traces).err()?;
                Some(of(ALL[*t].id, &format!("{}: {why}", ALL[*t].form)))
            })
            .collect();
        all.push(of(
            "joint_friction",
            "no reading says in which direction the joint moved before it",
        ));
        all.push(of("misalignment", "leaves the trace of force_gain"));
        if !self.candidates.contains(&place::WRAPPING) {
            all.push(of("wrapping_loss", "the route does not touch the knee"));
        }
        for (term, end) in [(place::ORIGIN, "origin"), (place::INSERTION, "insertion")] {
            if !self.candidates.contains(&term) {
                let why = format!("{end} bracket: its foot on the bone is not known");
                all.push(of("series_compliance", &why));
            }
        }
        all
    }

    fn aliases(&self, traces: &Traces) -> Vec<Alias> {
        let all: Vec<usize> = self.candidates.to_vec();
        let mut found = Vec::new();
        for (k, a) in all.iter().enumerate() {
            for b in &all[k + 1..] {
                let cosine = traces.cosine(*a, *b);
                if cosine.abs() > ALIKE {
                    let name = |t: usize| format!("{} ({})", ALL[t].id, ALL[t].form);
                    found.push(Alias {
                        ids: [name(*a), name(*b)],
                        cosine,
                    });
                }
            }
        }
        found
    }

    fn next(&self, effects: &[EffectFinding]) -> Vec<NextMeasurement> {
        let of = |e: &EffectFinding| NextMeasurement {
            separates: e.class.clone(),
            action: e.measurement.clone(),
            difference_n: None,
        };
        let mut next: Vec<NextMeasurement> = effects.iter().map(of).collect();
        if effects.iter().any(|e| e.id == "series_compliance") {
            next.push(NextMeasurement {
                separates: vec!["length_offset".to_owned(), "series_compliance".to_owned()],
                action: "repeat a test at half the pressure: an offset of the length stays, what yields halves"
                    .to_owned(),
                difference_n: None,
            });
        }
        next
    }
}

/// A term with its size in words: "series_compliance (insertion bracket) 94 um/N".
pub(super) fn label(term: usize, sizes: &Sizes) -> String {
    let t = &ALL[term];
    format!("{} ({}) {:.3} {}", t.id, t.form, sizes.values[term], t.unit)
}
