//! The readings of a group beside the model fitted without it: how far off it is.

use super::READINGS;
use super::judged::Usual;
use super::law::{Law, applied, columns};
use super::least::least;
use super::left::Group;
use super::mistakes::Taken;
use crate::base::Base;
use crate::data::{Data, contraction_620};
use crate::library::Column;
use crate::problem::{ForceProblem, Noted, component};
use crate::settings;
use crate::slack::{Side, Sided};
use pipeline_effects as effects;
use pipeline_effects::{Applied, Conditions};
use pipeline_findings::{ErrorKind, Level, RecordingError};
use pipeline_inference::fit::{Fitted, Setting};
use pipeline_inference::problem::Problem;

/// The readings of a group, and the model fitted without it.
pub(super) struct Seen<'a> {
    base: &'a Base,
    pub(super) data: &'a Data,
    pub(super) level: Level,
    /// Its sessions, each with the places of its readings.
    pub(super) sessions: Vec<(usize, Vec<usize>)>,
    coefficients: Vec<f64>,
    effects: Vec<Applied<f64>>,
    /// Dependences on columns.
    columns: Vec<(Column, [f64; 2])>,
    /// Factor on the force, of the specimen as its other sessions show it.
    pub(super) factor: f64,
    /// By how much its contracted length is longer than what is noted is worth, as its other sessions show it, share of the resting length.
    contraction: f64,
    /// What noted contractions are worth; none where its own is declared, or all are noted alike.
    noted: Option<Noted>,
    /// Usual sizes of the gain of a specimen and of a set length, mm.
    usual_gain: f64,
    usual_length_mm: f64,
    /// Standard deviation of a reading, N.
    noise: f64,
    /// Floor of the misfit's scale, N.
    floor: f64,
    /// How far off it is: 1 is usual.
    pub(super) off: f64,
}

impl<'a> Seen<'a> {
    pub(super) fn new(
        law: &Law<'a>,
        data: &'a Data,
        (problem, setting, fit): (&ForceProblem, &Setting, &Fitted),
        sessions: Vec<usize>,
        group: Group,
    ) -> Self {
        let (level, node) = match group {
            Group::Session(s) => (Level::Session, problem.sessions[s]),
            Group::Specimen(k) => (Level::Specimen, problem.specimens[k]),
        };
        let of_group = sessions.first();
        let campaign = of_group
            .and_then(|s| data.session.iter().position(|k| k == s))
            .map_or(0, |i| data.campaign[i]);
        let tree = problem.tree();
        let of = |node: usize, c: usize| {
            let column = tree.columns_of(node, c);
            column.map_or(0.0, |(k, _)| fit.point.random[k])
        };
        let above = tree.path(node);
        let of_campaign = problem.campaign_column(campaign, component::CAMPAIGN_GAIN);
        let of_campaign = 1.0 + of_campaign.map_or(0.0, |k| fit.point.random[k]);
        let factor = above.iter().map(|n| 1.0 + of(*n, component::GAIN));
        let factor = of_campaign * factor.product::<f64>();
        let specimen_of = problem.data.specimen_of_session();
        let noted = of_group.and_then(|s| problem.noted_of(&fit.point, specimen_of[*s]));
        let readings = |s: usize| (0..data.len()).filter(|i| data.session[*i] == s).collect();
        let others = fit.predicted.iter().zip(problem.node());
        let usual = |c: usize| problem.components()[c].scale.usual;
        let mut seen = Self {
            base: law.base,
            data,
            level,
            sessions: sessions.into_iter().map(|s| (s, readings(s))).collect(),
            coefficients: fit.point.coefficients.clone(),
            effects: applied(problem, fit),
            columns: columns(problem, fit),
            factor,
            contraction: above.iter().map(|n| of(*n, component::CONTRACTION)).sum(),
            noted,
            usual_gain: usual(component::GAIN),
            usual_length_mm: usual(component::SET_LENGTH),
            noise: fit.variances.noise[campaign],
            floor: settings::MISFIT_FLOOR
                * others
                    .filter(|(_, n)| setting.active[**n])
                    .map(|(f, _)| *f)
                    .fold(0.0, f64::max),
            off: 0.0,
        };
        seen.off = seen.off_by(&|_, _| {}, None);
        seen
    }

    /// Misses of a session's readings, N, with the size that a miss usually has, N.
    fn misses(
        &self,
        readings: &[usize],
        change: &dyn Fn(&mut Conditions, &mut f64),
        factor: f64,
        length_mm: f64,
    ) -> Vec<(f64, f64)> {
        let one = |i: &usize| {
            let (mut at, mut measured) = (self.data.conditions[*i], self.data.force[*i]);
            change(&mut at, &mut measured);
            // What was noted is corrected first: a mistake of 10 mm is 10 mm, however little noted lengths are worth.
            let of_noted = |n: Noted| n.error * (contraction_620(&at) - n.mean);
            let longer = self.contraction + self.noted.map_or(0.0, of_noted);
            at.contracted_length_m += longer * at.rest_length_m;
            at.length_m += 1e-3 * length_mm;
            let law = Sided {
                base: self.base,
                side: Side::AsPublished,
            };
            let named = effects::force(&law, &self.coefficients, factor, &self.effects, &at);
            let expected = self.columns.iter().fold(named, |force, (column, values)| {
                column.apply(force, *values, &at, (self.data, *i))
            });
            (measured - expected, self.usual_miss(measured))
        };
        readings.iter().map(one).collect()
    }

    /// The size that a miss usually has, N: by what was measured, for what is expected where a length is wrong may be far too large.
    pub(super) fn usual_miss(&self, measured: f64) -> f64 {
        let misfit = libm::hypot(self.base.common_misfit(), settings::SESSION_MISFIT);
        libm::hypot(self.noise, misfit * (measured.abs() + self.floor))
    }

    /// The set length that suits a session best, mm, and its mean square of misses then, with the length's own; if the length is `free`,
    /// that does not count.
    pub(super) fn at_best_length(
        &self,
        readings: &[usize],
        change: &dyn Fn(&mut Conditions, &mut f64),
        factor: f64,
        free: bool,
    ) -> (f64, f64) {
        let stroke = self.stroke_mm(readings);
        least((-stroke, stroke), READINGS, |d| {
            let misses = self.misses(readings, change, factor, d);
            let squares: f64 = misses
                .iter()
                .map(|(e, usual)| (e / usual) * (e / usual))
                .sum();
            let own = if free { 0.0 } else { d / self.usual_length_mm };
            squares / misses.len() as f64 + own * own
        })
    }

    /// Resting less contracted length, mm: a length that is further off is no length of this actuator.
    pub(super) fn stroke_mm(&self, readings: &[usize]) -> f64 {
        let at = &self.data.conditions[readings[0]];
        1e3 * (at.rest_length_m - at.contracted_length_m).abs()
    }

    /// How far off the group is with a change, leaving out one session.
    pub(super) fn off_by(
        &self,
        change: &dyn Fn(&mut Conditions, &mut f64),
        without: Option<usize>,
    ) -> f64 {
        let kept = self.sessions.iter().filter(|(s, _)| Some(*s) != without);
        let kept: Vec<&Vec<usize>> = kept.map(|(_, readings)| readings).collect();
        let at = |factor: f64| {
            let of = kept
                .iter()
                .map(|r| self.at_best_length(r, change, factor, false).1);
            of.sum::<f64>() / kept.len() as f64
        };
        let square = match self.level {
            // Of a specimen that was left out nothing is known of its gain.
            Level::Specimen => {
                let of_gain = |u: f64| at(self.factor * (1.0 + u * self.usual_gain)) + u * u;
                least((-3.0, 3.0), 4, of_gain).1
            }
            _ => at(self.factor),
        };
        // Not a number where the law has none: that is far off.
        if square.is_nan() {
            f64::INFINITY
        } else {
            square.sqrt()
        }
    }

    /// How far off the specimen is without one of its sessions.
    pub(super) fn without(&self, session: usize) -> f64 {
        self.off_by(&|_, _| {}, Some(session))
    }

    /// Root mean square of the misses with a change, random effects of the group 0, N.
    fn rms(&self, change: &dyn Fn(&mut Conditions, &mut f64)) -> f64 {
        let of = |(_, r): &(usize, Vec<usize>)| self.misses(r, change, self.factor, 0.0);
        let misses: Vec<f64> = self.sessions.iter().flat_map(of).map(|(e, _)| e).collect();
        (misses.iter().map(|e| e * e).sum::<f64>() / misses.len() as f64).sqrt()
    }

    pub(super) fn error(&self, group: Group, p: f64, usual: &Usual) -> RecordingError {
        let id = match group {
            Group::Session(s) => &self.data.sessions[s],
            Group::Specimen(k) => &self.data.specimens[k],
        };
        let taken = self.explanation(usual);
        let corrected = |t: Taken| {
            let x = t.value.unwrap_or(-1.0);
            self.rms(&|at, f| (t.change)(at, f, x))
        };
        RecordingError {
            group: id.clone(),
            level: self.level,
            kind: taken.map_or(ErrorKind::Outlier, |t| t.kind),
            quantity: taken.and_then(|t| t.quantity).map(str::to_owned),
            value: taken.and_then(|t| t.value),
            unit: taken.map_or("1", |t| t.unit).to_owned(),
            p: Some(p),
            rms: self.rms(&|_, _| {}),
            rms_corrected: taken.map(corrected),
            set_aside: true,
        }
    }
}
