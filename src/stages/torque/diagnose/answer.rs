//! The findings of one joint: what this search computes of them. No mixed model is fitted to torque, so that there are no random effects, no
//! likelihoods and no predictive distribution; what would be made of these stays empty.

use super::judge::{Judged, Task, fold_of};
use super::questions::Asked;
use super::refit::{Reading, Sizes};
use super::terms::{ALL, place};
use super::tests::TestErrors;
use super::traces::{ALIKE, Traces, VISIBLE};
use super::{Group, Searched, black_box, questions};
use crate::findings::{
    ActsOn, Alias, CampaignFindings, Design, DetectionLimit, EffectFinding, Errors, HeldOutBy,
    NextKind, NextMeasurement, NotMeasurable, Parameter, Unexplained, UnitErrors, Verdict, WhyNot,
};
use crate::numerics::statistics::sum_of_squares;
use std::collections::{BTreeMap, BTreeSet};

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
    pub tests: &'s [TestErrors],
    pub confidence: f64,
}

pub(super) fn rms(residuals: &[f64]) -> f64 {
    (sum_of_squares(residuals) / residuals.len().max(1) as f64).sqrt()
}

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

/// Errors of what was fitted and of what was held out.
fn errors(train: &[f64], out: &[f64]) -> Errors {
    let largest = out.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
    Errors {
        rmse_train: rms(train),
        rmse_heldout: finite(rms(out)),
        max_abs_error_heldout: finite(largest).filter(|_| rms(out).is_finite()),
        rmse_heldout_calibrated: None,
        rmse_heldout_after: BTreeMap::new(),
        log_density_heldout: None,
    }
}

impl<'a> Answered<'_, 'a> {
    pub(super) fn readings(&self) -> &[Reading<'a>] {
        &self.whole.readings
    }

    fn task(&self) -> Task<'_, 'a> {
        Task {
            readings: self.readings(),
            spreads: &self.whole.spreads,
            candidates: &self.whole.candidates,
            most: self.whole.most,
            confidence: self.confidence,
        }
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
        let (rigid_out, after_out) = self
            .held_by_their_owner()
            .unwrap_or((rigid.clone(), held_out.clone()));
        let traces = Traces::new(&self.task().sample(), self.sizes());
        let judged = self.whole.accepted.judged.iter();
        let mut effects: Vec<EffectFinding> = judged.map(|j| self.effect(j, &traces)).collect();
        effects.sort_by(|a, b| b.rms.total_cmp(&a.rms));
        let recording_errors = self.odd();
        let mut unexplained = self.unexplained(&self.asked(), &held_out, &folds);
        if effects.is_empty() && unexplained.is_empty() && !recording_errors.is_empty() {
            unexplained.push(self.between_tests());
        }
        let verdict = match (effects.is_empty(), unexplained.is_empty()) {
            (false, _) => Verdict::EffectFound,
            (true, false) => Verdict::Unexplained,
            (true, true) => Verdict::None,
        };
        let configuration = &self.group.members[0].1;
        let part = format!("{} knee, {}", configuration.knee, configuration.muscle);
        CampaignFindings {
            campaign: self.campaign.to_owned(),
            part: Some(part),
            diameter_mm: configuration.diameter_mm,
            simulated: self.simulated,
            kind: "knee-torque".to_owned(),
            base_model: self.group.law.id().to_owned(),
            base_refitted: false,
            unit: "N.m".to_owned(),
            design: self.design(),
            verdict,
            not_assessed: None,
            next_measurement: next(&effects),
            effects,
            scatter: Vec::new(),
            misfit: None,
            unexplained,
            recording_errors,
            before: errors(&rigid, &rigid_out),
            after: errors(&fitted, &after_out),
            by_unit: self.by_unit(&rigid, &held_out),
            budget: Vec::new(),
            expected_rmse_heldout: None,
            inside_50: None,
            inside_95: None,
            pit: Vec::new(),
            noise: None,
            // Of other readings than those that the owner holds out.
            black_box_rmse_heldout: finite(rms(&smooth)).filter(|_| !self.has_holdout()),
            tested: Vec::new(),
            detection_limits: self.limits(&traces),
            not_measurable: self.not_measurable(&traces),
            aliases: self.aliases(&traces),
            coefficients: Vec::new(),
            alternatives: Vec::new(),
        }
    }

    fn design(&self) -> Design {
        let of = |unit: fn(&Reading) -> usize| -> BTreeSet<usize> {
            self.readings().iter().map(unit).collect()
        };
        let fitted = self.group.unanswered.iter().zip(&self.group.fitted);
        let outside = fitted.filter(|(_, fitted)| **fitted);
        let (tests, actuators) = (of(|r| r.test).len(), of(|r| r.actuator).len());
        Design {
            readings: self.readings().len(),
            readings_outside_domain: outside.map(|(n, _)| n).sum(),
            sessions: tests,
            specimens: actuators,
            readings_held_out: self.group.held_readings().len(),
            held_out_by: self.held_out_by(tests, actuators),
            doubtful_only: self.group.doubtful,
        }
    }

    fn has_holdout(&self) -> bool {
        !self.group.held_readings().is_empty()
    }

    /// Residuals of the tests that their owner holds out, rigid and with what was found on the others; none where there are none.
    fn held_by_their_owner(&self) -> Option<(Vec<f64>, Vec<f64>)> {
        let held = self.group.held_readings();
        let rigid = Sizes::rigid(&held, &self.whole.spreads).residuals(&held);
        (!held.is_empty()).then(|| (rigid, self.sizes().residuals(&held)))
    }

    fn held_out_by(&self, tests: usize, actuators: usize) -> HeldOutBy {
        if self.has_holdout() {
            return HeldOutBy::Holdout;
        }
        match (actuators, self.held_out.len() == tests) {
            (1, true) if tests > 1 => HeldOutBy::Test,
            (1, _) => HeldOutBy::Stretch,
            _ => HeldOutBy::Actuator,
        }
    }

    /// The columns on which what is left may depend.
    fn asked(&self) -> Vec<Asked> {
        let extras = self.group.searched_extras();
        questions::columns(self.readings(), self.sizes(), &extras)
    }

    /// The columns on which what the effects leave still depends, the strongest first: those over which a curve takes off some of the error on
    /// what was held out.
    fn unexplained(&self, asked: &[Asked], held_out: &[f64], folds: &[usize]) -> Vec<Unexplained> {
        let sample = self.task().sample();
        let answers = questions::ask(&sample, self.sizes(), asked);
        let left = sample.conditional(self.sizes());
        // Only what would help where nothing was fitted, and by more than chance does.
        let helps =
            |a: &Asked| rms(&black_box::left(&a.values, held_out, folds)) < HELPS * rms(held_out);
        let mut found: Vec<Unexplained> = answers
            .iter()
            .zip(asked)
            .filter(|(q, a)| questions::is_structure(q) && helps(a))
            .map(|(q, a)| Unexplained {
                column: q.column.clone(),
                shape: "offset".to_owned(),
                p_familywise: q.p_adjusted,
                log_likelihood_gain: None,
                share_of_variance: q.share,
                curve: black_box::curve(&a.values, &left),
            })
            .collect();
        found.sort_by(|a, b| b.share_of_variance.total_cmp(&a.share_of_variance));
        let nothing = self.sizes().terms.is_empty() && found.is_empty();
        let p_adjusted = answers.iter().map(|q| q.p_adjusted).fold(1.0, f64::min);
        let seen = self.seen_in_parts(held_out, p_adjusted);
        let seen = seen.or_else(|| self.seen_without_a_name());
        found.extend(seen.filter(|_| nothing));
        found
    }

    /// Effects may stand without an actuator and fall with it: that is structure, too.
    fn seen_in_parts(&self, held_out: &[f64], p_familywise: f64) -> Option<Unexplained> {
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
            p_familywise,
            log_likelihood_gain: None,
            share_of_variance: 1.0 - after * after / (before * before),
            curve: black_box::curve(&angles, &rigid),
        })
    }

    /// Several effects may each explain by far more than chance does, and the readings be too few to tell which: that is structure as well.
    fn seen_without_a_name(&self) -> Option<Unexplained> {
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
            p_familywise: (sets.len() as f64 * libm::exp(-0.5 * gain)).min(1.0),
            log_likelihood_gain: None,
            share_of_variance: 1.0 - best.sizes.sse / rigid.sizes.sse,
            curve: black_box::curve(&angles, &residuals),
        })
    }

    fn effect(&self, judged: &Judged, traces: &Traces) -> EffectFinding {
        let (term, sizes) = (&ALL[judged.term], self.sizes());
        let value = sizes.values[judged.term];
        let half = judged.half_width;
        let mut without = sizes.clone();
        without.values[judged.term] = 0.0;
        let does = |r: &Reading| sizes.predict(r).0 - without.predict(r).0;
        let does: Vec<f64> = self.readings().iter().map(does).collect();
        EffectFinding {
            id: term.id.to_owned(),
            class: self.class(judged.term, traces),
            acts_on: ActsOn::All,
            column: None,
            from: None,
            parameters: vec![Parameter {
                name: term.symbol.to_owned(),
                value,
                ci_low: finite(value - half),
                ci_high: finite(value + half),
                unit: term.unit.to_owned(),
            }],
            form: term.form.to_owned(),
            equation: term.equation.to_owned(),
            p_familywise: judged.p_adjusted.clamp(0.0, 1.0),
            log_likelihood_gain: None,
            found_in_folds: self.found_in_folds(judged.term, traces),
            negligible: false,
            rms: rms(&does),
            by_specimen: BTreeMap::new(),
            profile: Vec::new(),
            free_form: None,
            in_its_place: Vec::new(),
            measurement: term.measurement.to_owned(),
            source: term.source.to_owned(),
        }
    }

    /// Part of the folds whose own search found the effect, or one that leaves its trace.
    fn found_in_folds(&self, term: usize, traces: &Traces) -> f64 {
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

    /// The errors of every fold, with what the search without it found.
    fn by_unit(&self, rigid: &[f64], held_out: &[f64]) -> Vec<UnitErrors> {
        let fold = fold_of(self.readings());
        let part = |all: &[f64], keep: &dyn Fn(usize) -> bool| -> Vec<f64> {
            let kept = self
                .readings()
                .iter()
                .zip(all)
                .filter(|(r, _)| keep(fold(r)));
            kept.map(|(_, e)| *e).collect()
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
            let (own, others) = (|f: usize| f == *out, |f: usize| f != *out);
            let fitted = sizes.residuals(self.readings());
            let mut found: Vec<String> = Vec::new();
            for id in sizes.terms.iter().map(|t| ALL[*t].id.to_owned()) {
                if !found.contains(&id) {
                    found.push(id);
                }
            }
            UnitErrors {
                unit,
                readings: part(rigid, &own).len(),
                before: errors(&part(rigid, &others), &part(rigid, &own)),
                after: errors(&part(&fitted, &others), &part(held_out, &own)),
                realised_over_expected: None,
                inside_95: None,
                found,
            }
        };
        self.held_out.iter().map(one).collect()
    }

    /// The smallest size that would be found, or why there is none, and what takes it up where that is one effect.
    fn measurable(&self, term: usize, traces: &Traces) -> Result<f64, (WhyNot, Option<String>)> {
        if !traces.is_there(term) {
            return Err((WhyNot::NoTrace, None));
        }
        let smallest = traces.smallest(term, self.whole.candidates.len());
        if !smallest.is_finite() || traces.visible(term) < VISIBLE {
            let others = self.sizes().terms.iter().filter(|t| **t != term);
            let others: Vec<usize> = others.copied().collect();
            let by = match others[..] {
                [only] => Some(ALL[only].id.to_owned()),
                _ => None,
            };
            return Err((WhyNot::Absorbed, by));
        }
        if smallest > ALL[term].bounds.1 {
            return Err((WhyNot::Bound, None));
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
                identifiable_share: traces.visible(*t),
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
        let of =
            |id: &str, form: Option<&str>, (reason, by): (WhyNot, Option<String>)| NotMeasurable {
                id: id.to_owned(),
                form: form.map(str::to_owned),
                reason,
                by,
            };
        let mut all: Vec<NotMeasurable> = candidates
            .filter_map(|t| {
                let why = self.measurable(*t, traces).err()?;
                let forms = ALL.iter().filter(|other| other.id == ALL[*t].id).count();
                Some(of(ALL[*t].id, (forms > 1).then_some(ALL[*t].form), why))
            })
            .collect();
        if !self.whole.candidates.contains(&place::FRICTION) {
            let why = (WhyNot::NoTrace, Some("sense_of_motion".to_owned()));
            all.push(of(ALL[place::FRICTION].id, None, why));
        }
        let strength = ALL[place::GAIN].id.to_owned();
        let why = (WhyNot::Absorbed, Some(strength));
        all.push(of("misalignment", None, why));
        if !self.whole.candidates.contains(&place::WRAPPING) {
            let why = (WhyNot::NoTrace, None);
            all.push(of(ALL[place::WRAPPING].id, None, why));
        }
        for (term, foot) in [
            (place::ORIGIN, "origin_bracket_foot"),
            (place::INSERTION, "insertion_bracket_foot"),
        ] {
            if !self.whole.candidates.contains(&term) {
                let why = (WhyNot::NoColumn, Some(foot.to_owned()));
                all.push(of(ALL[term].id, Some(ALL[term].form), why));
            }
        }
        all
    }

    /// Pairs of effects of which some forms leave nearly one trace, with the cosine of those that are most alike.
    fn aliases(&self, traces: &Traces) -> Vec<Alias> {
        let of = self
            .whole
            .candidates
            .iter()
            .filter(|t| **t != place::PLACEBO);
        let all: Vec<usize> = of.copied().collect();
        let mut found: Vec<Alias> = Vec::new();
        for (k, a) in all.iter().enumerate() {
            for b in &all[k + 1..] {
                let cosine = traces.cosine(*a, *b);
                if cosine.abs() <= ALIKE || cosine.is_nan() || ALL[*a].id == ALL[*b].id {
                    continue;
                }
                let ids = [*a, *b].map(|t| ALL[t].id.to_owned());
                match found.iter_mut().find(|f| f.ids == ids) {
                    Some(known) if known.cosine.abs() < cosine.abs() => known.cosine = cosine,
                    Some(_) => {}
                    None => found.push(Alias { ids, cosine }),
                }
            }
        }
        found
    }
}

/// A test at half the pressure separates an offset of the length, which stays, from what yields, which halves. What else would measure an effect
/// stands beside it.
fn next(effects: &[EffectFinding]) -> Vec<NextMeasurement> {
    let yields = ALL[place::AXIAL].id;
    let is_found = effects.iter().any(|e| e.id == yields);
    let separates = [ALL[place::LENGTH].id, yields].map(str::to_owned).to_vec();
    let half = NextMeasurement {
        kind: NextKind::Separate,
        separates,
        at: BTreeMap::from([("pressure_share".to_owned(), 0.5)]),
        worth: None,
        unit: "1".to_owned(),
    };
    is_found.then_some(half).into_iter().collect()
}
