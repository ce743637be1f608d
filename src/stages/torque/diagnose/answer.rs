//! The findings of one joint.

use super::judge::{Judged, fold_of};
use super::questions::Asked;
use super::refit::{Reading, Sizes};
use super::terms::{ALL, Term, place};
use super::tests::TestErrors;
use super::traces::{ALIKE, Traces, VISIBLE};
use super::{Group, Searched, black_box, questions};
use crate::numerics::statistics::sum_of_squares;
use crate::stages::diagnose::findings::{
    Alias, CampaignFindings, DetectionLimit, EffectFinding, Errors, FoldErrors, NextMeasurement,
    NotMeasurable, ParameterFinding, Rejected, Unexplained, Verdict,
};
use std::collections::BTreeSet;

/// Sets whose criterion is worse by so much are told apart by the readings: "very strong" evidence (Kass and Raftery, *J. Am. Stat. Assoc.* 90,
/// 1995).
const TOLD_APART: f64 = 10.0;
/// Part of the held-out error that a curve over a column leaves at most, for the column to be named.
const HELPS: f64 = 0.95;
/// Part of the error that is left where searches without a fold found something, for it to count as structure.
const STRUCTURE: f64 = 0.8;

/// Everything that the findings are made of.
pub(super) struct Answered<'s, 'a> {
    pub campaign: &'s str,
    pub simulated: bool,
    pub group: &'s Group<'a>,
    pub whole: &'s Searched<'a>,
    pub held_out: &'s [(usize, Sizes)],
    pub largest: Option<&'s Sizes>,
    pub tests: &'s [TestErrors],
    pub confidence: f64,
}

pub(super) fn rms(residuals: &[f64]) -> f64 {
    (sum_of_squares(residuals) / residuals.len().max(1) as f64).sqrt()
}

fn largest(residuals: &[f64]) -> f64 {
    residuals.iter().fold(0.0, |m: f64, r| m.max(r.abs()))
}

impl<'a> Answered<'_, 'a> {
    pub(super) fn readings(&self) -> &[Reading<'a>] {
        &self.whole.readings
    }

    pub(super) fn sizes(&self) -> &Sizes {
        &self.whole.accepted.sizes
    }

    /// Residuals of readings by the search without their fold.
    fn held_out_residuals(&self) -> Vec<f64> {
        let fold = fold_of(self.readings());
        let of = |r: &Reading| {
            let found = self.held_out.iter().find(|(f, _)| *f == fold(r));
            found.map_or(f64::NAN, |(_, sizes)| r.torque_nm - sizes.predict(r).0)
        };
        self.readings().iter().map(of).collect()
    }

    pub fn findings(&self) -> CampaignFindings {
        let rigid = Sizes::rigid(self.readings(), &self.whole.spreads).residuals(self.readings());
        let (fitted, held_out) = (
            self.sizes().residuals(self.readings()),
            self.held_out_residuals(),
        );
        let fold = fold_of(self.readings());
        let folds: Vec<usize> = self.readings().iter().map(fold).collect();
        let angles: Vec<f64> = self.readings().iter().map(|r| r.at.angle_rad).collect();
        let smooth = black_box::left(&angles, &rigid, &folds);
        let smooth_after = black_box::left(&angles, &held_out, &folds);
        let errors = |train: &[f64], out: &[f64]| Errors {
            rmse_train: rms(train),
            rmse_heldout: rms(out),
            max_abs_error_heldout: largest(out),
            rmse_heldout_own_strength: rms(out),
        };
        let (rigid_out, after_out) = self
            .held_by_their_owner()
            .unwrap_or((rigid.clone(), held_out.clone()));
        let (before, after) = (errors(&rigid, &rigid_out), errors(&fitted, &after_out));
        let traces = Traces::new(&self.task().sample(), self.sizes());
        let judged = self.whole.accepted.judged.iter();
        let effects: Vec<EffectFinding> = judged.map(|j| self.effect(j, &traces)).collect();
        let asked = self.asked();
        let sample = self.task().sample();
        let nothing = Sizes::rigid(self.readings(), &self.whole.spreads);
        let mut unexplained = self.unexplained(&asked, &held_out, &folds);
        if effects.is_empty() && unexplained.is_empty() && !self.odd().is_empty() {
            unexplained.push(self.between_tests(&held_out));
        }
        let verdict = match (effects.is_empty(), unexplained.is_empty()) {
            (false, _) => Verdict::EffectFound,
            (true, false) => Verdict::Unexplained,
            (true, true) => Verdict::None,
        };
        let configuration = &self.group.members[0].1;
        let part = format!("{} knee, {}", configuration.knee, configuration.muscle);
        let tests: BTreeSet<usize> = self.readings().iter().map(|r| r.test).collect();
        let actuators: BTreeSet<usize> = self.readings().iter().map(|r| r.actuator).collect();
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
            summary: self.summary(verdict, &effects, &unexplained, &before, &after),
            readings: self.readings().len(),
            sessions: tests.len(),
            specimens: actuators.len(),
            readings_held_out: self.group.held_readings().len(),
            held_out_by: self.held_out_by(actuators.len()).to_owned(),
            questions: questions::ask(&sample, &nothing, &asked),
            questions_after: questions::ask(&sample, self.sizes(), &asked),
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

    /// Residuals of the tests that their owner holds out, rigid and with what was found on the others; none where there are none.
    fn held_by_their_owner(&self) -> Option<(Vec<f64>, Vec<f64>)> {
        let held = self.group.held_readings();
        let rigid = Sizes::rigid(&held, &self.whole.spreads).residuals(&held);
        (!held.is_empty()).then(|| (rigid, self.sizes().residuals(&held)))
    }

    fn held_out_by(&self, actuators: usize) -> &'static str {
        let tests: BTreeSet<usize> = self.readings().iter().map(|r| r.test).collect();
        let folds = self.held_out.len();
        if self.group.held.contains(&true) {
            return "the sessions with the role holdout";
        }
        match (actuators, folds == tests.len()) {
            (1, true) if folds > 1 => "leave-one-test-out",
            (1, _) => "leave-one-stretch-of-the-angle-out",
            _ => "leave-one-actuator-out",
        }
    }

    /// The columns on which what is left may depend.
    fn asked(&self) -> Vec<Asked> {
        let extras = self.group.searched_extras();
        questions::columns(self.readings(), self.sizes(), &extras)
    }

    /// The columns on which what the effects leave still depends, the strongest first, with the error that a curve over each would take off what
    /// was held out.
    fn unexplained(&self, asked: &[Asked], held_out: &[f64], folds: &[usize]) -> Vec<Unexplained> {
        let sample = self.task().sample();
        let answers = questions::ask(&sample, self.sizes(), asked);
        let left = sample.conditional(self.sizes());
        let mut found: Vec<Unexplained> = answers
            .iter()
            .zip(asked)
            .filter(|(q, _)| questions::is_structure(q))
            .map(|(q, a)| Unexplained {
                column: q.column.clone(),
                shape: "offset".to_owned(),
                p_adjusted: q.p_adjusted,
                share_of_residual: q.share,
                rmse_heldout_before: Some(rms(held_out)),
                rmse_heldout_after: Some(rms(&black_box::left(&a.values, held_out, folds))),
                curve: black_box::curve(&a.values, &left),
            })
            .collect();
        found.sort_by(|a, b| b.share_of_residual.total_cmp(&a.share_of_residual));
        // Only what would help where nothing was fitted, and by more than chance does.
        let helps = |u: &Unexplained| {
            let (before, after) = (u.rmse_heldout_before, u.rmse_heldout_after);
            before.zip(after).is_some_and(|(b, a)| a < HELPS * b)
        };
        found.retain(helps);
        let nothing = self.sizes().terms.is_empty() && found.is_empty();
        let p_adjusted = answers.iter().map(|q| q.p_adjusted).fold(1.0, f64::min);
        let seen = self.seen_in_parts(held_out, p_adjusted);
        let seen = seen.or_else(|| self.seen_without_a_name(held_out));
        found.extend(seen.filter(|_| nothing));
        found
    }

    /// Effects may stand without an actuator and fall with it: that is structure, too.
    fn seen_in_parts(&self, held_out: &[f64], p_adjusted: f64) -> Option<Unexplained> {
        let rigid = Sizes::rigid(self.readings(), &self.whole.spreads);
        let rigid = rigid.residuals(self.readings());
        let (before, after) = (rms(&rigid), rms(held_out));
        let angles: Vec<f64> = self
            .readings()
            .iter()
            .map(|r| r.at.angle_rad.to_degrees())
            .collect();
        (after < STRUCTURE * before).then(|| Unexplained {
            column: "angle".to_owned(),
            shape: "offset".to_owned(),
            p_adjusted,
            share_of_residual: 1.0 - after * after / (before * before),
            rmse_heldout_before: Some(before),
            rmse_heldout_after: Some(after),
            curve: black_box::curve(&angles, &rigid),
        })
    }

    /// Several effects may each explain by far more than chance does, and the readings be too few to tell which: that is structure as well.
    fn seen_without_a_name(&self, held_out: &[f64]) -> Option<Unexplained> {
        let sets = &self.whole.sets;
        let rigid = sets.iter().find(|s| s.sizes.terms.is_empty())?;
        let real = |s: &&super::search::Ranked| !s.sizes.terms.contains(&place::PLACEBO);
        let best = sets.iter().find(real)?;
        let gain = rigid.criterion - best.criterion;
        let residuals = rigid.sizes.residuals(self.readings());
        let angles: Vec<f64> = self
            .readings()
            .iter()
            .map(|r| r.at.angle_rad.to_degrees())
            .collect();
        (gain > TOLD_APART).then(|| Unexplained {
            column: "angle".to_owned(),
            shape: "offset".to_owned(),
            // Odds of the rigid leg by the criterion (Kass and Raftery 1995), times the number of sets that were asked.
            p_adjusted: (sets.len() as f64 * libm::exp(-0.5 * gain)).min(1.0),
            share_of_residual: 1.0 - best.sizes.sse / rigid.sizes.sse,
            rmse_heldout_before: Some(rms(held_out)),
            rmse_heldout_after: None,
            curve: black_box::curve(&angles, &residuals),
        })
    }

    fn effect(&self, judged: &Judged, traces: &Traces) -> EffectFinding {
        let (term, sizes) = (&ALL[judged.term], self.sizes());
        let value = sizes.values[judged.term];
        let half = judged.half_width;
        let mut others = sizes.terms.clone();
        others.retain(|t| *t != judged.term);
        let without = Sizes::of(&others, self.readings(), &self.whole.spreads, Some(sizes));
        let n = self.readings().len() as f64;
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
            selected_in_resamples: judged.chosen_again,
            selected_in_folds: self.selected_in_folds(judged.term, traces),
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

    /// Part of the folds whose own search found the effect, or one that leaves its trace.
    fn selected_in_folds(&self, term: usize, traces: &Traces) -> f64 {
        let alike = |t: &usize| ALL[*t].id == ALL[term].id || traces.cosine(term, *t).abs() > ALIKE;
        let folds = self.held_out.iter();
        let chose = folds.filter(|(_, sizes)| sizes.terms.iter().any(alike));
        chose.count() as f64 / self.held_out.len() as f64
    }

    /// The effect and all that leave its trace and would explain the readings about as well in its place; a force that is not along the
    /// sensor shrinks as one of a weaker actuator.
    fn class(&self, term: usize, traces: &Traces) -> Vec<String> {
        let alike = |t: &usize| *t != place::PLACEBO && traces.cosine(term, *t).abs() > ALIKE;
        let candidates = self.whole.candidates.iter().copied();
        let alike: Vec<usize> = candidates.filter(alike).collect();
        let mut ids = vec![ALL[term].id.to_owned()];
        for other in self.as_good_in_place_of(term, &alike) {
            ids.push(ALL[other].id.to_owned());
        }
        if ids.iter().any(|id| id == "force_gain") {
            ids.extend(["misalignment", "specimen_variation"].map(str::to_owned));
        }
        // Where the joint drives the actuator, its own hysteresis is friction of the other sign.
        if term == place::FRICTION && self.sizes().values[term] < 0.0 {
            ids.push("hysteresis".to_owned());
        }
        let mut seen = BTreeSet::new();
        ids.retain(|id| seen.insert(id.clone()));
        ids
    }

    /// Those of `others` that the readings do not tell from a term when they take its place among what was found.
    fn as_good_in_place_of(&self, term: usize, others: &[usize]) -> Vec<usize> {
        let found = &self.sizes().terms;
        let with = |other: usize| {
            let kept = found.iter().filter(|t| **t != term).copied();
            let mut terms: Vec<usize> = kept.chain([other]).collect();
            terms.sort_unstable();
            terms.dedup();
            terms
        };
        let mut sets: Vec<Vec<usize>> = others.iter().map(|o| with(*o)).collect();
        sets.push(found.clone());
        let fits = self
            .task()
            .sample()
            .of(&sets, &super::known_of(&self.whole.sets));
        let criterion = |terms: &[usize]| {
            let fit = fits.iter().find(|f| f.sizes.terms == terms);
            fit.map_or(f64::INFINITY, |f| f.criterion)
        };
        let own = criterion(found);
        let near = |other: &&usize| {
            let terms = with(**other);
            terms.len() == found.len() && criterion(&terms) < own + TOLD_APART
        };
        others.iter().filter(near).copied().collect()
    }

    fn by_fold(&self, rigid: &[f64], held_out: &[f64], smooth: &[f64]) -> Vec<FoldErrors> {
        let fold = fold_of(self.readings());
        let of = |out: usize, all: &[f64]| {
            let own = self.readings().iter().zip(all);
            let own: Vec<f64> = own
                .filter(|(r, _)| fold(r) == out)
                .map(|(_, e)| *e)
                .collect();
            own
        };
        let one = |(out, sizes): &(usize, Sizes)| {
            let first = self.readings().iter().find(|r| fold(r) == *out);
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

    /// Sets that came before what was taken and do not stand, then every single term, with what it would explain by itself.
    fn rejected(&self) -> Vec<Rejected> {
        let rigid = Sizes::rigid(self.readings(), &self.whole.spreads).sse;
        let joined = |terms: &[usize], of: fn(&Term) -> &'static str| {
            let names: Vec<&str> = terms.iter().map(|t| of(&ALL[*t])).collect();
            names.join(" + ")
        };
        let rejected = |terms: &[usize], why: String| {
            let sizes = Sizes::of(terms, self.readings(), &self.whole.spreads, None);
            Rejected {
                id: joined(terms, |t| t.id),
                form: Some(joined(terms, |t| t.form)),
                acts_on: "all readings".to_owned(),
                share: 1.0 - sizes.sse / rigid,
                why,
            }
        };
        let refused = &self.whole.accepted.refused;
        let together = refused.iter().filter(|r| r.terms.len() > 1);
        let mut all: Vec<Rejected> = together
            .map(|r| rejected(&r.terms, format!("{}: {}", ALL[r.because_of].id, r.why)))
            .collect();
        let taken = |t: &&usize| !self.sizes().terms.contains(t);
        let why = |t: usize| {
            let own = refused.iter().find(|r| r.terms == [t]);
            let inside = self.whole.sets.iter().any(|s| s.sizes.terms == [t]);
            match (own, inside) {
                (Some(own), _) => own.why.clone(),
                (None, true) => "explains less than what was taken".to_owned(),
                (None, false) => "runs to a bound of what is physically possible".to_owned(),
            }
        };
        let alone = self.whole.candidates.iter().filter(taken);
        let mut alone: Vec<Rejected> = alone.map(|t| rejected(&[*t], why(*t))).collect();
        alone.sort_by(|a, b| b.share.total_cmp(&a.share));
        all.extend(alone);
        all
    }

    fn measurable(&self, term: usize, traces: &Traces) -> Result<f64, &'static str> {
        let smallest = traces.smallest(term, self.whole.candidates.len());
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
        let candidates = self
            .whole
            .candidates
            .iter()
            .filter(|t| **t != place::PLACEBO);
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
        let candidates = self
            .whole
            .candidates
            .iter()
            .filter(|t| **t != place::PLACEBO);
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
        if !self.whole.candidates.contains(&place::FRICTION) {
            let why = "the joint came to too few of the angles from the other side";
            all.push(of("joint_friction", why));
        }
        all.push(of("misalignment", "leaves the trace of force_gain"));
        if !self.whole.candidates.contains(&place::WRAPPING) {
            all.push(of("wrapping_loss", "the route does not touch the knee"));
        }
        for (term, end) in [(place::ORIGIN, "origin"), (place::INSERTION, "insertion")] {
            if !self.whole.candidates.contains(&term) {
                let why = format!("{end} bracket: its foot on the bone is not known");
                all.push(of("series_compliance", &why));
            }
        }
        all
    }

    fn aliases(&self, traces: &Traces) -> Vec<Alias> {
        let all: Vec<usize> = self.whole.candidates.to_vec();
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

/// A term with its size in words: "series_compliance (insertion bracket) 94.1 um/N".
pub(super) fn label(term: usize, sizes: &Sizes) -> String {
    let t = &ALL[term];
    let value = sizes.values[term];
    // Three digits, whatever the unit.
    let decimals = match value.abs() {
        v if v >= 100.0 => 0,
        v if v >= 10.0 => 1,
        v if v >= 1.0 => 2,
        _ => 3,
    };
    format!("{} ({}) {value:.decimals$} {}", t.id, t.form, t.unit)
}
