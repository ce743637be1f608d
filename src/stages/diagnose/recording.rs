//! Mistakes of recording: sessions and specimens whose readings are too improbable under the model fitted without them.
//!
//! An effect is a property of a rig or of actuators; a value for one session alone is a mistake or scatter. The sessions that a fit to all
//! puts furthest off, and their specimens, are left out in turn, and their readings are held against the model of the others. How far off a
//! group is, is one number: the root mean square of its misses in units of noise and misfit, at the set lengths that suit it best, of which
//! each counts in units of its usual size. A session that is merely set 1 mm off is then about 1 off, one set 10 mm off about 10, and one with
//! swapped columns more. Rigs scatter more or less than usual, so the yardstick is the standard deviation of
//! the other sessions of the same campaign (by their median), by a model without the group.
//!
//! The worst group goes first, for it spoils the fits that judge the others. What it is, its own readings say: each usual mistake is taken
//! back, and of those that leave no more than is usual the likeliest explains it.
//!
//! What all sessions share is no mistake, but beside a law that lacks it the sessions in which it shows most look mistaken. So the question is
//! asked beside the effects and dependences on columns that a search of all readings found; beside the law alone only where it found none.
//!
//! Lengths are in mm, forces in N, in all that follows.

use super::base::Base;
use super::data::Data;
use super::library::{Column, Scope, Term, What};
use super::problem::{ForceProblem, component};
use super::settings;
use super::slack::{Side, Sided};
use pipeline_findings::{ErrorKind, Level, RecordingError};
use pipeline_inference::decisions::{EXPLAINS, LEVEL, MOST_MISTAKEN, MOST_MISTAKEN_SHARE};
use pipeline_inference::fit::{Fitted, Setting};
use pipeline_inference::problem::Problem;
use pipeline_mechanics::effects::{self, Applied, Conditions};
use pipeline_numerics::distributions::{NORMAL_50, student_t_two_sided};
use pipeline_numerics::statistics::{mean, median, standard_deviation};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Readings of a session that are looked at: a wrong length, zero or unit shows in all of them, and the time goes with their number.
const READINGS: usize = 16;
/// Sessions that a fit to all puts furthest off, and that are then judged without themselves: the one that spoils that fit is among them.
const SHORTLIST: usize = 4;
/// Units that are taken for one another (lbf, kgf, psi, bar, and powers of ten), as factors; their inverses too.
const UNITS: [f64; 6] = [4.448, 9.807, 6.895, 10.0, 100.0, 1000.0];

/// Least standard deviation, in usual ones: where the others happen to agree better, a specimen that is a few percent stronger than they is no mistake.
const LEAST_SCALE: f64 = 0.5;

/// The law by which sessions are judged: what acts on all readings, named or a dependence on a column, with the values from which a fit starts.
pub struct Law<'a> {
    base: &'a Base,
    effects: Vec<(What, Vec<f64>)>,
}

impl<'a> Law<'a> {
    /// The base law alone.
    pub fn new(base: &'a Base) -> Self {
        Self {
            base,
            effects: Vec::new(),
        }
    }

    /// With an effect on all readings, and its amplitude and shape.
    pub fn with(mut self, what: What, values: &[f64]) -> Self {
        self.effects.push((what, values.to_vec()));
        self
    }

    /// Whether nothing is beside the base law.
    pub fn is_bare(&self) -> bool {
        self.effects.is_empty()
    }

    /// The effects as terms of the readings that a fit is made to.
    fn terms(&self, data: &Data) -> Vec<Term> {
        let one = |(what, _): &(What, Vec<f64>)| Term::new(*what, Scope::All, data);
        self.effects.iter().map(one).collect()
    }

    /// A fit from where all fits start: one from a fit to other readings may end anywhere, if those are far off.
    fn fit(&self, problem: &ForceProblem, setting: &Setting) -> Fitted {
        let mut from = problem.start();
        let values = self.effects.iter().map(|(_, values)| values.clone());
        from.terms = values.enumerate().collect();
        setting.fit(&from, &setting.fresh()[..1])
    }
}

/// The effects at the values of a fit.
fn applied(problem: &ForceProblem, fit: &Fitted) -> Vec<Applied<f64>> {
    let of = |(t, values): &(usize, Vec<f64>)| {
        let shape = values.get(1).copied().unwrap_or(0.0);
        problem.library[*t].applied([values[0], shape])
    };
    fit.point.terms.iter().filter_map(of).collect()
}

/// The dependences on columns at the values of a fit.
fn columns(problem: &ForceProblem, fit: &Fitted) -> Vec<(Column, [f64; 2])> {
    let of = |(t, values): &(usize, Vec<f64>)| match problem.library[*t].what {
        What::Column(column) => Some((column, [values[0], values[1]])),
        What::Effect { .. } => None,
    };
    fit.point.terms.iter().filter_map(of).collect()
}

/// The sessions and specimens of a campaign that look mistaken beside a law, worst first: those with a family-wise probability below [`LEVEL`].
/// They are to be set aside. Only readings of actuators of `group_diameter_mm` are judged.
pub fn recording_errors(group_diameter_mm: u32, law: &Law, data: &Data) -> Vec<RecordingError> {
    let of_group =
        |i: &usize| data.conditions[*i].diameter_mm.round() == f64::from(group_diameter_mm);
    let places: Vec<usize> = (0..data.len()).filter(of_group).collect();
    let data = data.select(&places);
    let data = data.thinned(READINGS * data.sessions.len());
    let mut left = Left::all(&data);
    let mut errors = Vec::new();
    if (left.sessions.len() as f64) * MOST_MISTAKEN_SHARE.0 < 1.0 {
        return errors;
    }
    let mut ranked = Ranked::new(law, &data, &left);
    while errors.len() < MOST_MISTAKEN {
        let judged = Judged::new(law, &data, &left, ranked.shortlist(&left));
        let Some((group, seen, off)) = judged.worst(&left) else {
            break;
        };
        let rest = left.without(group);
        if !rest.is_most_of(&data) {
            break;
        }
        // The others without it: with it they would all be off, or the noise so large that nobody is.
        let others = Ranked::new(law, &data, &rest);
        let Some(usual) = others.usual() else {
            break;
        };
        let p = usual.p(off) * left.groups() as f64;
        if p.is_nan() || p >= LEVEL {
            break;
        }
        errors.push(seen.error(group, p.min(1.0), &usual));
        (left, ranked) = (rest, others);
    }
    errors
}

/// A session or a specimen, by its place in the lists of the data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Group {
    Session(usize),
    Specimen(usize),
}

/// The readings that are left, by session; a specimen goes with all its sessions.
#[derive(Clone)]
struct Left {
    sessions: BTreeSet<usize>,
    specimen_of: Vec<usize>,
}

impl Left {
    fn all(data: &Data) -> Self {
        Self {
            sessions: data.session.iter().copied().collect(),
            specimen_of: data.specimen_of_session(),
        }
    }

    /// The sessions of a group.
    fn of(&self, group: Group) -> Vec<usize> {
        let in_it = |s: &usize| match group {
            Group::Session(session) => *s == session,
            Group::Specimen(specimen) => self.specimen_of[*s] == specimen,
        };
        self.sessions.iter().copied().filter(in_it).collect()
    }

    fn without(&self, group: Group) -> Self {
        let mut rest = self.clone();
        for s in self.of(group) {
            rest.sessions.remove(&s);
        }
        rest
    }

    fn specimens(&self) -> BTreeSet<usize> {
        self.sessions.iter().map(|s| self.specimen_of[*s]).collect()
    }

    /// How many groups could be mistaken.
    fn groups(&self) -> usize {
        self.sessions.len() + self.specimens().len()
    }

    /// Whether so many are left that they can say what is right.
    fn is_most_of(&self, data: &Data) -> bool {
        let all = Self::all(data);
        let gone = |now: usize, before: usize| (before - now) as f64 / before as f64;
        gone(self.sessions.len(), all.sessions.len()) <= MOST_MISTAKEN_SHARE.0
            && gone(self.specimens().len(), all.specimens().len()) <= MOST_MISTAKEN_SHARE.1
    }
}

/// How far off the other sessions are.
struct Usual {
    /// Their standard deviation, by their median: where one set length makes nearly all of it, the number is the size of a normal one. Of a root mean
    /// square of several it is an upper bound.
    scale: f64,
    /// Number of sessions.
    sessions: f64,
}

impl Usual {
    /// Probability that a group is so far off.
    fn p(&self, off: f64) -> f64 {
        student_t_two_sided(off / self.scale, self.sessions)
    }
}

/// The readings of the sessions that are left.
fn readings_of(data: &Data, left: &Left) -> Data {
    let is_left = |i: &usize| left.sessions.contains(&data.session[*i]);
    let places: Vec<usize> = (0..data.len()).filter(is_left).collect();
    data.select(&places)
}

/// All sessions that are left, each as far off as the fit to all of them says, furthest first.
struct Ranked {
    sessions: Vec<(usize, f64)>,
}

impl Ranked {
    fn new(law: &Law, data: &Data, left: &Left) -> Self {
        let rest = readings_of(data, left);
        let terms = law.terms(&rest);
        let problem = ForceProblem::new(law.base, &rest, &terms).with_reference();
        let setting = Setting::new(&problem).usual();
        let fit = law.fit(&problem, &setting);
        let off = |s: &usize| {
            let group = Group::Session(*s);
            (
                *s,
                Seen::new(law, data, (&problem, &setting, &fit), vec![*s], group).off,
            )
        };
        let mut sessions: Vec<(usize, f64)> = left.sessions.iter().map(off).collect();
        sessions.sort_by(|a, b| b.1.total_cmp(&a.1));
        Self { sessions }
    }

    /// How far off sessions are; none with fewer than two.
    fn usual(&self) -> Option<Usual> {
        let off: Vec<f64> = self.sessions.iter().map(|(_, off)| *off).collect();
        (off.len() > 1).then(|| Usual {
            scale: (median(&off) / NORMAL_50).max(LEAST_SCALE),
            sessions: off.len() as f64,
        })
    }

    /// The sessions that are judged by a fit without them, and their specimens.
    fn shortlist(&self, left: &Left) -> Vec<Group> {
        let first = self.sessions.iter().take(SHORTLIST).map(|(s, _)| *s);
        let sessions: Vec<usize> = first.collect();
        let specimens: BTreeSet<usize> = sessions.iter().map(|s| left.specimen_of[*s]).collect();
        let several = left.specimens().len() > 1;
        let specimens = specimens
            .into_iter()
            .filter(|_| several)
            .map(Group::Specimen);
        sessions
            .into_iter()
            .map(Group::Session)
            .chain(specimens)
            .collect()
    }
}

/// Groups, each judged by a model fitted without it.
struct Judged<'a> {
    seen: Vec<(Group, Seen<'a>)>,
}

impl<'a> Judged<'a> {
    fn new(law: &Law<'a>, data: &'a Data, left: &Left, groups: Vec<Group>) -> Self {
        let rest = readings_of(data, left);
        let terms = law.terms(&rest);
        let problem = ForceProblem::new(law.base, &rest, &terms).with_reference();
        let judge = |group: Group| {
            let node = match group {
                Group::Session(s) => problem.sessions[s],
                Group::Specimen(k) => problem.specimens[k],
            };
            let setting = Setting::new(&problem).usual().without(node);
            let fit = law.fit(&problem, &setting);
            let by = (&problem, &setting, &fit);
            (group, Seen::new(law, data, by, left.of(group), group))
        };
        Self {
            seen: groups.into_par_iter().map(judge).collect(),
        }
    }

    fn of(&self, group: Group) -> Option<&Seen<'a>> {
        self.seen.iter().find(|(g, _)| *g == group).map(|(_, s)| s)
    }

    /// The group that is furthest off, and how far; in place of a session its specimen, if another length of that explains its sessions
    /// better than they agree without the one.
    fn worst(&self, left: &Left) -> Option<(Group, &Seen<'a>, f64)> {
        let (group, seen) = self
            .seen
            .iter()
            .max_by(|a, b| a.1.off.total_cmp(&b.1.off))?;
        if let Group::Session(s) = *group {
            let whole = Group::Specimen(left.specimen_of[s]);
            if let Some(specimen) = self.of(whole)
                && specimen.sessions.len() > 1
                && specimen.least_off() < specimen.without(s)
            {
                return Some((whole, specimen, seen.off));
            }
        }
        Some((*group, seen, seen.off))
    }
}

/// A change that takes a mistake back: of the conditions and of the measured force, by a number.
type Change = fn(&mut Conditions, &mut f64, f64);

/// A mistake taken back.
#[derive(Clone, Copy)]
struct Taken {
    kind: ErrorKind,
    quantity: Option<&'static str>,
    unit: &'static str,
    change: Change,
    value: Option<f64>,
    /// How far off the group then is.
    off: f64,
    /// Log-likelihood, as of one reading.
    likelihood: f64,
}

/// The readings of a group, and the model fitted without it.
struct Seen<'a> {
    base: &'a Base,
    data: &'a Data,
    level: Level,
    /// Its sessions, each with the places of its readings.
    sessions: Vec<(usize, Vec<usize>)>,
    coefficients: Vec<f64>,
    effects: Vec<Applied<f64>>,
    /// Dependences on columns.
    columns: Vec<(Column, [f64; 2])>,
    /// Factor on the force, of the specimen as its other sessions show it.
    factor: f64,
    /// Usual sizes of the gain of a specimen and of a set length, mm.
    usual_gain: f64,
    usual_length_mm: f64,
    /// Standard deviation of a reading, N.
    noise: f64,
    /// Floor of the misfit's scale, N.
    floor: f64,
    /// How far off it is: 1 is usual.
    off: f64,
}

impl<'a> Seen<'a> {
    fn new(
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
        let gain = |node: usize, c: usize| {
            let column = tree.columns_of(node, c);
            1.0 + column.map_or(0.0, |(k, _)| fit.point.random[k])
        };
        let above = tree.path(node);
        let factor = above
            .iter()
            .map(|n| gain(*n, component::GAIN) * gain(*n, component::CAMPAIGN_GAIN))
            .product();
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
    fn usual_miss(&self, measured: f64) -> f64 {
        let misfit = libm::hypot(self.base.common_misfit(), settings::SESSION_MISFIT);
        libm::hypot(self.noise, misfit * (measured.abs() + self.floor))
    }

    /// The set length that suits a session best, mm, and its mean square of misses then, with the length's own; if the length is `free`,
    /// that does not count.
    fn at_best_length(
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
    fn stroke_mm(&self, readings: &[usize]) -> f64 {
        let at = &self.data.conditions[readings[0]];
        1e3 * (at.rest_length_m - at.contracted_length_m).abs()
    }

    /// How far off the group is with a change, leaving out one session.
    fn off_by(&self, change: &dyn Fn(&mut Conditions, &mut f64), without: Option<usize>) -> f64 {
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
    fn without(&self, session: usize) -> f64 {
        self.off_by(&|_, _| {}, Some(session))
    }

    /// The usual mistakes, each taken back.
    fn mistakes(&self) -> Vec<Taken> {
        match self.level {
            Level::Specimen => self.specimen_mistakes(),
            _ => self.session_mistakes(),
        }
    }

    /// How far off it is with the mistake taken back that leaves least.
    fn least_off(&self) -> f64 {
        let all = self.mistakes().into_iter();
        all.map(|t| t.off).fold(f64::INFINITY, f64::min)
    }

    /// The likeliest of the mistakes that leave no more than is usual.
    fn explanation(&self, usual: &Usual) -> Option<Taken> {
        let all = self.mistakes().into_iter();
        let most = EXPLAINS * usual.scale;
        all.filter(|t| t.off <= most)
            .max_by(|a, b| a.likelihood.total_cmp(&b.likelihood))
    }

    fn specimen_mistakes(&self) -> Vec<Taken> {
        let stroke = self.stroke_mm(&self.sessions[0].1);
        let rest: Change = |at, _, mm| at.rest_length_m += 1e-3 * mm;
        let contracted: Change = |at, _, mm| at.contracted_length_m += 1e-3 * mm;
        let both = [("rest_length", rest), ("contracted_length", contracted)];
        both.map(|(quantity, change)| {
            self.number(ErrorKind::Length, quantity, "mm", change, stroke)
        })
        .to_vec()
    }

    fn session_mistakes(&self) -> Vec<Taken> {
        let readings = &self.sessions[0].1;
        let largest = readings
            .iter()
            .map(|i| self.data.force[*i].abs())
            .fold(0.0, f64::max);
        let length: Change = |at, _, mm| at.length_m += 1e-3 * mm;
        let zero: Change = |_, f, n| *f += n;
        let on_force: Change = |_, f, times| *f *= times;
        let on_pressure: Change = |at, _, times| at.pressure_kpa *= times;
        // What a session took off as the zero of its force was then that of its pressure.
        let swap: Change = |at, f, n| {
            std::mem::swap(&mut at.pressure_kpa, f);
            *f += n;
        };
        let given = |kind, quantity, change: Change, value: Option<f64>| {
            let x = value.unwrap_or(-1.0);
            let off = self.off_by(&|at, f| change(at, f, x), None);
            self.taken(kind, quantity, "1", change, value, off)
        };
        let (value, square) = self.at_best_length(readings, &|_, _| {}, self.factor, true);
        let mut all = vec![
            Taken {
                quantity: None,
                ..self.number(ErrorKind::SwappedColumns, "force", "N", swap, largest)
            },
            given(ErrorKind::Sign, Some("force"), on_force, None),
            self.number(ErrorKind::Zero, "force", "N", zero, largest),
            self.taken(
                ErrorKind::Length,
                Some("length"),
                "mm",
                length,
                Some(value),
                square.sqrt(),
            ),
        ];
        for times in UNITS.iter().flat_map(|u| [*u, 1.0 / u]) {
            all.push(given(ErrorKind::Unit, Some("force"), on_force, Some(times)));
            all.push(given(
                ErrorKind::Unit,
                Some("pressure"),
                on_pressure,
                Some(times),
            ));
        }
        all
    }

    /// A mistake of a number, at its best value within `most` of 0.
    fn number(
        &self,
        kind: ErrorKind,
        quantity: &'static str,
        unit: &'static str,
        change: Change,
        most: f64,
    ) -> Taken {
        let (value, off) = least((-most, most), READINGS, |x| {
            self.off_by(&|at, f| change(at, f, x), None)
        });
        self.taken(kind, Some(quantity), unit, change, Some(value), off)
    }

    /// A mistake with its likelihood: of the readings as they were recorded, so that a unit that makes all forces small gains nothing by
    /// it.
    fn taken(
        &self,
        kind: ErrorKind,
        quantity: Option<&'static str>,
        unit: &'static str,
        change: Change,
        value: Option<f64>,
        off: f64,
    ) -> Taken {
        let (mut recorded, mut corrected, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
        for i in self.sessions.iter().flat_map(|(_, readings)| readings) {
            let (mut at, mut force) = (self.data.conditions[*i], self.data.force[*i]);
            recorded.push(force);
            change(&mut at, &mut force, value.unwrap_or(-1.0));
            corrected.push(force);
            sizes.push(libm::log(self.usual_miss(force)));
        }
        let stretch = standard_deviation(&corrected) / standard_deviation(&recorded);
        Taken {
            kind,
            quantity,
            unit,
            change,
            value,
            off,
            likelihood: libm::log(stretch) - mean(&sizes) - 0.5 * off * off,
        }
    }

    /// Root mean square of the misses with a change, random effects of the group 0, N.
    fn rms(&self, change: &dyn Fn(&mut Conditions, &mut f64)) -> f64 {
        let of = |(_, r): &(usize, Vec<usize>)| self.misses(r, change, self.factor, 0.0);
        let misses: Vec<f64> = self.sessions.iter().flat_map(of).map(|(e, _)| e).collect();
        (misses.iter().map(|e| e * e).sum::<f64>() / misses.len() as f64).sqrt()
    }

    fn error(&self, group: Group, p: f64, usual: &Usual) -> RecordingError {
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

/// Where a function is least between two bounds, and what it is there: a grid of so many steps, then golden sections about its best place.
fn least((low, high): (f64, f64), steps: usize, of: impl Fn(f64) -> f64) -> (f64, f64) {
    let at = |k: usize| low + (high - low) * k as f64 / steps as f64;
    let values: Vec<f64> = (0..=steps).map(|k| of(at(k))).collect();
    let best = (0..=steps)
        .min_by(|a, b| values[*a].total_cmp(&values[*b]))
        .unwrap_or(0);
    let (mut a, mut b) = (at(best.saturating_sub(1)), at((best + 1).min(steps)));
    let section = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut c, mut d) = (b - section * (b - a), a + section * (b - a));
    let (mut of_c, mut of_d) = (of(c), of(d));
    for _ in 0..16 {
        if of_c < of_d {
            (b, d, of_d) = (d, c, of_c);
            c = b - section * (b - a);
            of_c = of(c);
        } else {
            (a, c, of_c) = (c, d, of_d);
            d = a + section * (b - a);
            of_d = of(d);
        }
    }
    let inner = if of_c < of_d { (c, of_c) } else { (d, of_d) };
    if values[best] < inner.1 {
        (at(best), values[best])
    } else {
        inner
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pipeline_config::FitOptions;
    use pipeline_simulate::rig_like::{self, Campaign, DIAMETER_MM, Mistake};

    fn simulated(mistake: Option<Mistake>) -> Campaign {
        let settings = rig_like::Settings {
            specimens: Some(4),
            mistake,
            ..rig_like::Settings::default()
        };
        rig_like::campaign(1, &settings)
    }

    fn found(campaign: &Campaign) -> Vec<RecordingError> {
        let rows: Vec<_> = campaign.rows.iter().collect();
        let base = Base::new(DIAMETER_MM, true, 4, &FitOptions::default());
        recording_errors(DIAMETER_MM, &Law::new(&base), &Data::new(&rows))
    }

    fn assert_pointed_at(mistake: Mistake, kind: ErrorKind, quantity: Option<&str>) {
        let campaign = simulated(Some(mistake));
        let errors = found(&campaign);
        let group = campaign.truth.mistaken.map(|m| m.group);
        let named: Vec<_> = errors
            .iter()
            .map(|e| (Some(e.group.clone()), e.kind, e.quantity.as_deref()))
            .collect();
        assert_eq!(named, [(group, kind, quantity)], "{errors:?}");
        assert!(
            errors[0]
                .rms_corrected
                .is_some_and(|rms| rms < 0.3 * errors[0].rms)
        );
    }

    #[test]
    fn a_campaign_without_mistakes_has_none() {
        assert_eq!(found(&simulated(None)), []);
    }

    #[test]
    fn swapped_columns_are_swapped_columns_and_no_unit() {
        assert_pointed_at(Mistake::SwappedColumns, ErrorKind::SwappedColumns, None);
    }

    #[test]
    fn swapped_columns_of_a_log_have_the_zero_of_the_load_cell_left() {
        let settings = rig_like::Settings {
            specimens: Some(4),
            scatter: rig_like::Scatter::Clean,
            mistake: Some(Mistake::SwappedColumns),
            ..rig_like::Settings::default()
        };
        let mut campaign = rig_like::campaign(1, &settings);
        let id = campaign.truth.mistaken.clone().unwrap().group;
        for row in campaign.rows.iter_mut().filter(|r| r.session == id) {
            // The force, with what the load cell showed vented.
            row.pressure_kpa += 6.0;
        }
        let errors = found(&campaign);
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert_eq!(errors[0].group, id);
        assert_eq!(errors[0].kind, ErrorKind::SwappedColumns);
        let zero = errors[0].value.unwrap();
        assert!((zero + 6.0).abs() < 1.0, "{zero}");
    }

    #[test]
    fn forces_twenty_times_too_large_are_no_unit() {
        let settings = rig_like::Settings {
            specimens: Some(4),
            scatter: rig_like::Scatter::Clean,
            ..rig_like::Settings::default()
        };
        let mut campaign = rig_like::campaign(1, &settings);
        let id = campaign.rows[0].session.clone();
        for row in campaign.rows.iter_mut().filter(|r| r.session == id) {
            row.force_n *= 20.0;
        }
        let errors = found(&campaign);
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert_eq!(errors[0].kind, ErrorKind::Outlier, "{errors:?}");
    }

    #[test]
    fn a_wrong_sign_is_a_sign() {
        assert_pointed_at(Mistake::Sign, ErrorKind::Sign, Some("force"));
    }

    #[test]
    fn a_set_length_is_one_of_the_session() {
        assert_pointed_at(Mistake::SetLength, ErrorKind::Length, Some("length"));
    }

    #[test]
    fn a_resting_length_is_one_of_the_specimen() {
        assert_pointed_at(Mistake::RestLength, ErrorKind::Length, Some("rest_length"));
    }

    #[test]
    fn pounds_are_a_unit_of_the_force() {
        let mut campaign = simulated(None);
        // Without contraction the force goes nearly with the pressure: that could as well be in other units.
        let contracted = campaign.rows.iter().find(|r| r.session.ends_with("c25"));
        let id = contracted.unwrap().session.clone();
        for row in campaign.rows.iter_mut().filter(|r| r.session == id) {
            row.force_n /= UNITS[0];
        }
        let errors = found(&campaign);
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert_eq!((&errors[0].group, errors[0].kind), (&id, ErrorKind::Unit));
        assert_eq!(errors[0].value, Some(UNITS[0]));
    }

    #[test]
    fn sessions_of_an_extreme_column_are_no_mistake_beside_a_law_that_has_it() {
        let mut campaign = simulated(None);
        // One session is twice as humid as the others are at most; humidity lowers all forces in proportion.
        let id = campaign.rows[0].session.clone();
        for (k, row) in campaign.rows.iter_mut().enumerate() {
            let humidity = if row.session == id {
                2.0
            } else {
                (k % 7) as f64 / 6.0
            };
            row.extras.insert("moisture".to_owned(), humidity);
            row.force_n *= 1.0 - 0.3 * humidity;
        }
        let rows: Vec<_> = campaign.rows.iter().collect();
        let data = Data::new(&rows);
        let base = Base::new(DIAMETER_MM, true, 4, &FitOptions::default());
        let judged = |law: &Law| recording_errors(DIAMETER_MM, law, &data);
        let bare = judged(&Law::new(&base));
        assert!(bare.iter().any(|e| e.group == id), "{bare:?}");
        let place = data.extras.iter().position(|e| e.name == "moisture");
        let column = What::Column(Column::Gain(place.unwrap()));
        assert_eq!(judged(&Law::new(&base).with(column, &[0.0, 0.0])), []);
    }

    #[test]
    fn least_finds_the_bottom() {
        let (x, value) = least((-10.0, 10.0), 16, |x| (x - 3.3) * (x - 3.3) + 1.0);
        assert!((x - 3.3).abs() < 0.02 && (value - 1.0).abs() < 1e-3);
    }
}
