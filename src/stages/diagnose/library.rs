//! The terms of a campaign: every form of every effect that its readings can show, on all readings, on the levels of a column of labels,
//! or from a change point on; and smooth functions of every column.

use super::data::{Data, PLACEBO};
use pipeline_effects as effects;
use pipeline_effects::{Applied, Conditions, Form, Grouping, Need, Place};
use pipeline_inference::decisions::{FEWEST, FEWEST_SPECIMENS};
use pipeline_inference::problem;
use pipeline_mechanics::models::P_620_KPA;
use pipeline_numerics::real::Real;
use std::collections::BTreeSet;

/// What is added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// A form of an effect, by their places in [`effects::all`] and its forms, and the shape at which a fit starts (not a number where the
    /// form has none).
    Effect {
        /// Place in [`effects::all`].
        effect: usize,
        /// Place in its forms.
        form: usize,
        /// Shape where the fit starts.
        shape: f64,
    },
    /// A dependence without a physical name.
    Column(Column),
}

/// A smooth dependence on a column, a polynomial of second degree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// F (1 + a x + b x^2), x an extra column by its place in the data.
    Gain(usize),
    /// F + a x + b x^2.
    Offset(usize),
    /// F (1 + a F/S + b F^2/S^2): the force channel is not straight.
    Force,
    /// F (1 + a P* + b P*^2): the pressure channel is not straight.
    Pressure,
}

/// S: the scale of the force in [`Column::Force`], N.
const FORCE_SCALE_N: f64 = 500.0;

/// A dependence on a logged column is no larger than what it corrects. With half of it those that were there ended at the bound, and the answer was none.
const LARGEST_GAIN: f64 = 1.0;
/// A channel of force or pressure that is less straight than this is broken, and such a curve would be another law.
const LARGEST_CURVE: f64 = 0.5;
/// The same of an offset, N.
const LARGEST_OFFSET_N: f64 = 200.0;

/// On which readings a term acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// All.
    All,
    /// One session and all after it.
    From(usize),
    /// A value for every level of an extra column that names groups, less the first.
    Levels(usize),
}

/// A term of the library.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// What.
    pub what: What,
    /// Where.
    pub scope: Scope,
    /// For each session the number of the amplitude that acts on it, or none.
    pub acts_on: Vec<Option<usize>>,
    /// Number of amplitudes.
    pub amplitudes: usize,
}

/// The terms that the search tries. Their number follows from the design of the campaign alone.
pub fn terms(data: &Data) -> Vec<Term> {
    let mut terms = Vec::new();
    for (effect, e) in effects::all().iter().enumerate() {
        for (form, f) in e.forms().iter().enumerate() {
            let known = f.needs.iter().all(|n| !data.missing.contains_key(n));
            if !known || e.grouping() == Grouping::Drawn {
                continue;
            }
            for shape in f.shape.map_or(&[f64::NAN][..], |(_, grid)| grid) {
                let what = What::Effect {
                    effect,
                    form,
                    shape: *shape,
                };
                terms.push(Term::new(what, Scope::All, data));
                let within = !f.needs.contains(&Need::Zeros);
                if e.grouping() == Grouping::Parts && within {
                    terms.extend(parts(data).into_iter().map(|s| Term::new(what, s, data)));
                }
            }
        }
    }
    let columns = data.extras.iter().enumerate();
    let columns = columns.filter(|(_, e)| !e.names_groups);
    let extras = columns.flat_map(|(k, _)| [Column::Gain(k), Column::Offset(k)]);
    let columns = extras.chain([Column::Force, Column::Pressure]);
    terms.extend(columns.map(|c| Term::new(What::Column(c), Scope::All, data)));
    terms
}

fn parts(data: &Data) -> Vec<Scope> {
    let sessions = data.sessions.len();
    let specimens = data.specimen_of_session();
    let mut parts = Vec::new();
    if !data.missing.contains_key(&Need::CampaignTime) && sessions >= 2 * FEWEST {
        // Which of the sessions of one day came first is not known.
        let places = FEWEST..=sessions - FEWEST;
        let places = places.filter(|k| data.dates[k - 1] != data.dates[*k]);
        let is_after = |first: usize| (0..sessions).map(move |s| s >= first).collect::<Vec<_>>();
        let places = places.filter(|k| shows_beside_scatter(&specimens, &is_after(*k)));
        parts.extend(places.map(Scope::From));
    }
    let shows = |column: usize| {
        let (level, count) = data.levels(column);
        let mut sides = std::iter::once(None).chain((0..count).map(Some));
        sides.any(|l| {
            let is_there: Vec<bool> = level.iter().map(|of| *of == l).collect();
            shows_beside_scatter(&specimens, &is_there)
        })
    };
    let groups = data.extras.iter().enumerate();
    let groups = groups.filter(|(k, e)| e.names_groups && shows(*k));
    parts.extend(groups.map(|(k, _)| Scope::Levels(k)));
    parts
}

/// Whether a value for some of the sessions, given the specimen of each, can be told from the scatter of specimens and sessions: the specimens that
/// were measured on both sides have enough sessions on each, or each side has two specimens or more that the other one has not. Else all that shows
/// is the value of one specimen, or of very few sessions.
fn shows_beside_scatter(specimens: &[usize], is_there: &[bool]) -> bool {
    let side = |there: bool| -> Vec<usize> {
        let of_side = specimens.iter().zip(is_there);
        let of_side = of_side.filter(|(_, is)| **is == there);
        of_side.map(|(s, _)| *s).collect()
    };
    let (there, elsewhere) = (side(true), side(false));
    let shared = |a: &[usize], b: &[usize]| a.iter().filter(|s| b.contains(s)).count();
    let own = |a: &[usize], b: &[usize]| {
        let own = a.iter().filter(|s| !b.contains(s));
        own.collect::<BTreeSet<_>>().len()
    };
    let within = shared(&there, &elsewhere).min(shared(&elsewhere, &there));
    let between = own(&there, &elsewhere).min(own(&elsewhere, &there));
    within >= FEWEST || between >= FEWEST_SPECIMENS
}

impl Term {
    /// A term on the sessions of some data.
    pub fn new(what: What, scope: Scope, data: &Data) -> Self {
        let sessions = data.sessions.len();
        let (acts_on, groups) = match scope {
            Scope::All => (vec![Some(0); sessions], 1),
            Scope::From(first) => {
                let acts = (0..sessions).map(|s| (s >= first).then_some(0));
                (acts.collect(), 1)
            }
            Scope::Levels(column) => data.levels(column),
        };
        Self {
            what,
            scope,
            acts_on,
            amplitudes: groups
                * if matches!(what, What::Column(_)) {
                    2
                } else {
                    1
                },
        }
    }

    /// The form, of an effect of the library.
    pub fn form(&self) -> Option<&'static Form> {
        match self.what {
            What::Effect { effect, form, .. } => Some(&effects::all()[effect].forms()[form]),
            What::Column(_) => None,
        }
    }

    /// The effect and its form, by their places in [`effects::all`] and its forms.
    pub fn effect(&self) -> Option<(usize, usize)> {
        match self.what {
            What::Effect { effect, form, .. } => Some((effect, form)),
            What::Column(_) => None,
        }
    }

    /// Id of the effect; none of a dependence on a column.
    pub fn id(&self) -> Option<&'static str> {
        match self.what {
            What::Effect { effect, .. } => Some(effects::all()[effect].id()),
            What::Column(_) => None,
        }
    }

    /// Id of the effect, or name of the column.
    pub fn name(&self, data: &Data) -> String {
        match self.what {
            What::Effect { effect, .. } => effects::all()[effect].id().to_owned(),
            What::Column(column) => column.name(data),
        }
    }

    /// Whether it has a shape.
    pub fn has_shape(&self) -> bool {
        self.form().is_some_and(|f| f.shape.is_some())
    }

    /// Values where a fit starts: amplitudes `amplitude`, and the shape.
    pub fn start(&self, amplitude: f64) -> Vec<f64> {
        let mut values = vec![amplitude; self.amplitudes];
        if let (true, What::Effect { shape, .. }) = (self.has_shape(), self.what) {
            values.push(shape);
        }
        values
    }

    /// Values at a size: an effect's amplitudes and shape, or a straight dependence on a column.
    pub fn of_size(&self, size: f64) -> Vec<f64> {
        match self.what {
            What::Column(_) => vec![size, 0.0],
            What::Effect { .. } => self.start(size),
        }
    }

    /// The term as the engine sees it.
    pub fn for_engine(&self, data: &Data) -> problem::Term {
        let amplitude = match self.what {
            What::Effect { .. } => self.form().map_or((0.0, 0.0), |f| f.amplitude.bounds),
            What::Column(Column::Force | Column::Pressure) => (-LARGEST_CURVE, LARGEST_CURVE),
            What::Column(Column::Gain(_)) => (-LARGEST_GAIN, LARGEST_GAIN),
            What::Column(_) => (-LARGEST_OFFSET_N, LARGEST_OFFSET_N),
        };
        let mut bounds = vec![amplitude; self.amplitudes];
        if let Some((shape, _)) = self.form().and_then(|f| f.shape) {
            bounds.push(shape.bounds);
        }
        let (effects, columns) = (effects::all().len(), data.extras.len());
        let kind = match self.what {
            What::Effect { effect, .. } => effect,
            What::Column(Column::Gain(k) | Column::Offset(k)) => effects + k,
            What::Column(Column::Force) => effects + columns,
            What::Column(Column::Pressure) => effects + columns + 1,
        };
        problem::Term {
            kind,
            named: self.id().is_some(),
            whole: self.scope == Scope::All,
            decoy: matches!(self.what, What::Column(c) if c.name(data) == PLACEBO),
            bounds,
            amplitudes: self.amplitudes,
            usual: f64::INFINITY,
        }
    }

    /// The operator of the library with these parameters, for the chain.
    pub fn applied<R>(&self, parameters: [R; 2]) -> Option<Applied<R>> {
        match self.what {
            What::Effect { effect, form, .. } => Some(Applied {
                effect,
                form,
                parameters,
            }),
            What::Column(_) => None,
        }
    }

    /// Whether it acts on the length by the force: a frame that yields.
    pub fn is_frame(&self) -> bool {
        self.form().is_some_and(|f| f.place == Place::Frame)
    }
}

/// A force with a dependence a x + b x^2 on a column: as a share of it, or in N.
pub(crate) fn bent<R: Real>(force: R, [a, b]: [R; 2], x: R, is_gain: bool) -> R {
    let change = (b * x + a) * x;
    if is_gain {
        force * (change + 1.0)
    } else {
        force + change
    }
}

/// The argument of [`Column::Force`].
pub(crate) fn force_argument<R: Real>(force: R) -> R {
    force / FORCE_SCALE_N
}

/// The argument of [`Column::Pressure`].
pub(crate) fn pressure_argument(at: &Conditions) -> f64 {
    at.pressure_kpa / P_620_KPA
}

impl Column {
    /// The force with the dependence, of reading `i` under conditions that may be other than those recorded.
    pub fn apply<R: Real>(
        self,
        force: R,
        values: [R; 2],
        at: &Conditions,
        (data, i): (&Data, usize),
    ) -> R {
        let x = match self {
            Column::Gain(column) | Column::Offset(column) => {
                R::constant(data.extras[column].values[i])
            }
            Column::Force => force_argument(force),
            Column::Pressure => R::constant(pressure_argument(at)),
        };
        bent(force, values, x, self.is_gain())
    }

    /// The same dependence for other data of the same rows' columns; none where these lack the column.
    pub fn of(self, data: &Data, other: &Data) -> Option<Self> {
        let place = |k: usize| {
            let name = &data.extras[k].name;
            other.extras.iter().position(|e| e.name == *name)
        };
        match self {
            Column::Gain(k) => place(k).map(Column::Gain),
            Column::Offset(k) => place(k).map(Column::Offset),
            Column::Force | Column::Pressure => Some(self),
        }
    }

    /// The column on which it depends, as findings name it.
    pub fn name(self, data: &Data) -> String {
        match self {
            Column::Gain(k) | Column::Offset(k) => data.extras[k].name.clone(),
            Column::Force => "force_n".to_owned(),
            Column::Pressure => "pressure_kpa".to_owned(),
        }
    }

    /// Whether it changes the force by a share of it, or by newtons.
    pub fn is_gain(self) -> bool {
        !matches!(self, Column::Offset(_))
    }

    /// The dependence over the range of its column: value of the column, share of the force or N.
    pub fn curve(self, data: &Data, [a, b]: [f64; 2]) -> Vec<(f64, f64)> {
        let (values, (middle, sd)) = match self {
            Column::Gain(k) | Column::Offset(k) => {
                (data.extras[k].values.clone(), data.extras[k].scale)
            }
            Column::Force => {
                let scaled = data.force.iter().map(|f| f / FORCE_SCALE_N);
                (scaled.collect(), (0.0, FORCE_SCALE_N))
            }
            Column::Pressure => {
                let scaled = data.conditions.iter().map(|c| c.pressure_kpa / P_620_KPA);
                (scaled.collect(), (0.0, P_620_KPA))
            }
        };
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (0..=20)
            .map(|k| low + f64::from(k) / 20.0 * (high - low))
            .map(|x| (middle + sd * x, (b * x + a) * x))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a change from a session on shows.
    fn from(specimens: &[usize], first: usize) -> bool {
        let is_after: Vec<bool> = (0..specimens.len()).map(|s| s >= first).collect();
        shows_beside_scatter(specimens, &is_after)
    }

    #[test]
    fn a_change_that_separates_one_specimen_from_the_others_is_that_specimens_value() {
        let one_after_another = [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3];
        let shown: Vec<usize> = (1..16).filter(|k| from(&one_after_another, *k)).collect();
        // Between two and two specimens, however many sessions of one of them are on the other side.
        assert_eq!(shown, [8]);
        let five = [&one_after_another[..], &[4, 4, 4, 4]].concat();
        let shown: Vec<usize> = (1..20).filter(|k| from(&five, *k)).collect();
        assert_eq!(shown, [8, 9, 10, 11, 12]);
    }

    #[test]
    fn a_change_within_a_specimen_shows_with_three_sessions_on_each_side() {
        let one = [0; 7];
        let shown: Vec<usize> = (1..7).filter(|k| from(&one, *k)).collect();
        assert_eq!(shown, [3, 4]);
        let in_turn = [0, 1, 0, 1, 0, 1, 0, 1];
        let shown: Vec<usize> = (1..8).filter(|k| from(&in_turn, *k)).collect();
        assert_eq!(shown, [3, 4, 5]);
    }
}
