//! The isometric campaign as a problem for the engine: groups, forward model with derivatives, nuisance components.
//!
//! F_i = sensor(effects; (1 + u_k) (1 + g_c) A(P_i, l_i + d_s; theta)) + z_s + z_c + misfit + noise, where u_k is the gain of the specimen, d_s
//! the set length and z_s the zero of the force of the session, g_c and z_c gain and zero of the campaign (of a pool only). Resting and
//! contracted length of a specimen are known as well as declared, or else to their rounding, and how far contracted lengths are off beside that
//! is estimated, as a share of the resting length: the laboratory's nine specimens of 10 mm are noted with contractions of 0.157 to 0.188 at 620
//! kPa, and their forces show others (log-likelihood larger by 21.6). What is noted is itself a reading, and a share s of what the noted contractions
//! differ by may be error (classical error, to which the scatter beside it is Berkson's: Carroll et al., Measurement Error in Nonlinear Models,
//! 2nd ed. (2006), 1.4): each is taken nearer to their mean by the share s, one normal number ([`settings::NOTING_ERROR`]). Where the standard
//! deviation of a session's set length is declared, it is not estimated. The misfit is proportional to the force, with a small floor, and absent where the actuator is slack: one over (eps*, P*) that
//! all specimens share, one of each session along P and, where the readings show it, one of each stroke along P, Gaussian processes in a cosine
//! basis (Solin and Sarkka, Statistics and Computing 30 (2020) 419).
//!
//! Noise is independent from reading to reading; a variant has noise that is correlated in time within every stroke (`in_time` asks it).
//!
//! A stroke is the filling or the venting of one log. On the laboratory's rig readings of one stroke are alike beyond everything else: most of
//! all those of the first filling after the length was set, which is up to 15 N below the next ones.
//!
//! | file | idea |
//! |---|---|
//! | `hierarchy` | the groups of the readings as a tree |
//! | [`component`] | the nuisance components and the noise, with what is plausible of each |
//! | `misfit` | the columns of the misfit, those of the common one beside the law |
//! | `forward` | the force of a reading with its derivatives |
//! | `known` | what is known of coefficients beforehand, as further readings |
//! | `directions` | what each term of the library would change |
//! | `variants` | the same readings under other assumptions: floor, strokes, correlated noise, declared lengths, base law |

pub mod component;
mod directions;
pub(crate) mod forward;
mod hierarchy;
mod known;
pub(crate) mod misfit;
#[cfg(test)]
mod tests;
mod variants;

pub use directions::{LARGE_CHANGES, SAME_DIRECTION, cosine};

use super::base::{Base, BaseCoefficient};
use super::data::Data;
use super::library::{Scope, Term, What};
use super::settings;
use super::slack::{self, Side};
use component::{components, noise};
use forward::{SLOTS, TERMS};
use hierarchy::Hierarchy;
use known::Known;
use misfit::{
    SESSION_COSINES, STROKE_COSINES, WANDER_COSINES, along_pressure, along_stroke, common_pairs,
};
use pipeline_effects as effects;
use pipeline_inference::problem::Term as EngineTerm;
use pipeline_inference::problem::{Coefficient, Component, Direction, Linearised, Point, Problem};
use pipeline_inference::system::Variances;
use pipeline_inference::tree::Tree;
use pipeline_inference::variance::Scale;

/// Most terms in one model.
pub const MOST_TERMS: usize = pipeline_config::MOST_EFFECTS;

/// Where the operators of the random effects stand in the registry of effects.
#[derive(Clone, Copy)]
pub(crate) struct Operators {
    length: usize,
    zero: usize,
}

impl Operators {
    pub(crate) fn registered() -> Self {
        Self {
            length: registered(effects::length_offset::ID),
            zero: registered(effects::force_zero_offset::ID),
        }
    }
}

/// What a stroke, the filling or the venting of one log, has of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct OfStrokes {
    /// A misfit along the pressure.
    misfit: bool,
    /// Noise that is correlated in time.
    wander: bool,
}

/// An isometric campaign, or a pool of them.
pub struct ForceProblem<'a> {
    /// The base law.
    pub base: &'a Base,
    /// The readings.
    pub data: &'a Data,
    /// The terms of the library.
    pub library: &'a [Term],
    tree: Tree,
    node: Vec<usize>,
    class: Vec<usize>,
    /// The forces, then what is known of the law beforehand.
    observed: Vec<f64>,
    known: Vec<Known>,
    /// Node of each specimen.
    pub specimens: Vec<usize>,
    /// Node of each session.
    pub sessions: Vec<usize>,
    components: Vec<Component>,
    noise: Vec<Scale>,
    coefficients: Vec<Coefficient>,
    terms: Vec<EngineTerm>,
    operators: Operators,
    /// By how much the contraction at 620 kPa that is noted of each specimen is above the mean of those noted; 0 where it is declared.
    noted_off: Vec<f64>,
    /// That mean; none where all are declared or noted alike.
    noted_mean: Option<f64>,
    /// Side of the corner to slackness of each reading.
    side: Vec<Side>,
    /// Cosines of the session's misfit, reading by reading.
    session_basis: Vec<Vec<f64>>,
    /// What strokes have of their own.
    of_strokes: OfStrokes,
    /// Cosines of the stroke's misfit; none where strokes have none.
    stroke_basis: Vec<Vec<f64>>,
    /// Cosines of what the force wanders by within the stroke; none where it does not.
    wander_basis: Vec<Vec<f64>>,
    /// Columns of the common misfit, reading by reading, N for a misfit of 1.
    common_misfit: Vec<Vec<f64>>,
    /// Derivatives of the reference by the coefficients of the law that were free in it, one column each.
    slopes: Vec<Vec<f64>>,
    /// Places of these coefficients.
    sloped: Vec<usize>,
    /// The coefficients of the fit without misfit of which the reference is; none before there is one.
    reference_coefficients: Vec<f64>,
    /// Largest force, N.
    largest: f64,
    /// Floor of the scale of the misfit, N.
    floor: f64,
    /// The force by which the misfit is scaled, N: predictions of a fit without misfit. They are frozen, so that all models of a campaign have
    /// one covariance for it.
    reference: Vec<f64>,
}

/// A coefficient of the law as the engine sees it.
fn for_engine(c: &BaseCoefficient) -> Coefficient {
    Coefficient {
        start: c.start,
        bounds: c.bounds,
        free: c.free,
    }
}

/// The place in the registry of an effect that the model of every campaign has.
///
/// # Panics
/// If it is not registered, which is a defect.
fn registered(id: &str) -> usize {
    effects::index(id).unwrap_or_else(|| panic!("{id} is not in the registry of effects"))
}

/// What the contractions at 620 kPa that are noted of specimens are worth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Noted {
    /// Their mean.
    pub(crate) mean: f64,
    /// The share of what they differ by that is error of noting.
    pub(crate) error: f64,
}

/// Contractions that differ by less are one, noted alike.
const SAME_CONTRACTION: f64 = 1e-9;

/// Mean of the contractions that are noted; none where none is, and where they are alike, which says nothing of what another one is worth.
pub(crate) fn mean_noted(noted: &[Option<f64>]) -> Option<f64> {
    let known: Vec<f64> = noted.iter().flatten().copied().collect();
    let mean = known.iter().sum::<f64>() / known.len().max(1) as f64;
    let differ = known.iter().any(|n| (n - mean).abs() > SAME_CONTRACTION);
    differ.then_some(mean)
}

impl<'a> ForceProblem<'a> {
    /// The problem of some readings, the misfit of strokes left out.
    pub fn new(base: &'a Base, data: &'a Data, library: &'a [Term]) -> Self {
        Self::built(base, data, library, OfStrokes::default())
    }

    fn built(base: &'a Base, data: &'a Data, library: &'a [Term], of_strokes: OfStrokes) -> Self {
        let Hierarchy {
            tree,
            mut node,
            specimens,
            sessions,
            strokes,
        } = Hierarchy::of(data, of_strokes);
        let largest = data.force.iter().copied().fold(0.0, f64::max);
        let forces = data.force.iter().zip(&data.conditions);
        let side: Vec<Side> = forces
            .map(|(f, at)| slack::side(*f, settings::NEAR_SLACK, largest, at, &base.shape(at)))
            .collect();
        let corner = data.campaigns.len();
        let class_of = |i: usize| match side[i] {
            Side::Corner => {
                let at = &data.conditions[i];
                corner + slack::band(at, &base.shape(at))
            }
            _ => data.campaign[i],
        };
        let mut noise = noise(corner, largest);
        let mut class: Vec<usize> = (0..data.len()).map(class_of).collect();
        let known = Known::of(base);
        if !known.is_empty() {
            node.resize(data.len() + known.len(), 0);
            class.resize(data.len() + known.len(), noise.len());
            noise.push(known::NOISE);
        }
        let forces = data.force.iter().copied();
        let noted = data.noted_contractions();
        let noted_mean = mean_noted(&noted);
        let off = |n: &Option<f64>| n.zip(noted_mean).map_or(0.0, |(n, mean)| n - mean);
        Self {
            base,
            data,
            library,
            class,
            observed: forces.chain(known.iter().map(Known::observed)).collect(),
            known,
            tree,
            node,
            specimens,
            sessions,
            components: components(base, data, data.campaigns.len() > 1, strokes),
            noise,
            coefficients: base.coefficients.iter().map(for_engine).collect(),
            terms: library.iter().map(|t| t.for_engine(data)).collect(),
            operators: Operators::registered(),
            noted_off: noted.iter().map(off).collect(),
            noted_mean,
            side,
            session_basis: along_pressure(data, SESSION_COSINES, settings::PRESSURE_LENGTH_KPA),
            of_strokes,
            stroke_basis: if of_strokes.misfit {
                along_pressure(data, STROKE_COSINES, settings::STROKE_LENGTH_KPA)
            } else {
                vec![Vec::new(); data.len()]
            },
            wander_basis: if of_strokes.wander {
                along_stroke(data, WANDER_COSINES, settings::WANDER_LENGTH)
            } else {
                vec![Vec::new(); data.len()]
            },
            common_misfit: vec![vec![0.0; common_pairs().count()]; data.len()],
            slopes: Vec::new(),
            sloped: Vec::new(),
            reference_coefficients: Vec::new(),
            reference: vec![0.0; data.len()],
            floor: settings::MISFIT_FLOOR * largest,
            largest,
        }
    }

    /// Root mean square of the noise of the readings that are not in the corner to slackness: every campaign has its own.
    pub fn noise_of(&self, variances: &Variances) -> f64 {
        let own = self
            .class
            .iter()
            .filter(|c| **c < self.data.campaigns.len());
        let squares: Vec<f64> = own
            .map(|c| variances.noise[*c] * variances.noise[*c])
            .collect();
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
    }

    /// A point without what specimens and sessions have of their own.
    pub fn bare(&self, point: &Point) -> Point {
        let mut bare = point.clone();
        bare.random[self.tree.width(0)..].fill(0.0);
        bare
    }

    /// The values of the common misfit at a point; it stands first among the columns of every reading.
    pub fn common_misfit_of<'p>(&self, point: &'p Point) -> &'p [f64] {
        &point.random[..common_pairs().count()]
    }

    /// Whether a term is an offset of the length, the operator of the random set lengths.
    pub(crate) fn is_length_offset(&self, term: &Term) -> bool {
        term.effect() == Some((self.operators.length, 0))
    }

    /// Whether the actuator pulls at reading `i`: it is neither slack nor near it.
    pub fn pulls(&self, i: usize) -> bool {
        self.side[i] == Side::Pulls
    }

    /// Whether strokes have a misfit of their own.
    pub fn has_strokes(&self) -> bool {
        self.of_strokes.misfit
    }

    /// Whether a term is no more than where the dependence on a column that is among others has its origin, which nobody knows: a zero of the force
    /// on all readings beside an offset that goes with the column.
    pub fn is_origin(&self, term: usize, others: &[usize]) -> bool {
        let zero = self.library[term].scope == Scope::All
            && self.library[term].effect() == Some((self.operators.zero, 0));
        let is_offset =
            |t: &usize| matches!(self.library[*t].what, What::Column(c) if !c.is_gain());
        zero && others.iter().any(is_offset)
    }

    /// Standard deviations of resting and contracted length of a specimen, mm.
    pub fn specimen_lengths_sd_mm(&self, specimen: usize) -> [f64; 2] {
        let or_rounded = |sd: f64| {
            if sd.is_finite() {
                sd
            } else {
                settings::ROUNDING_SD_MM
            }
        };
        self.data.specimen_lengths_sd_mm[specimen].map(or_rounded)
    }
}

impl Problem for ForceProblem<'_> {
    fn tree(&self) -> &Tree {
        &self.tree
    }
    fn node(&self) -> &[usize] {
        &self.node
    }
    fn class(&self) -> &[usize] {
        &self.class
    }
    fn noise(&self) -> &[Scale] {
        &self.noise
    }
    fn observed(&self) -> &[f64] {
        &self.observed
    }
    fn components(&self) -> &[Component] {
        &self.components
    }
    fn coefficients(&self) -> &[Coefficient] {
        &self.coefficients
    }
    fn terms(&self) -> &[EngineTerm] {
        &self.terms
    }

    fn predict(&self, point: &Point) -> Vec<f64> {
        let conditions = self.data.conditions.iter().enumerate();
        let forces = conditions.map(|(i, at)| self.value(point, i, at));
        forces.chain(self.known_at(point)).collect()
    }

    fn predict_some(&self, point: &Point, readings: &[usize]) -> Vec<f64> {
        let of = |i: &usize| self.value(point, *i, &self.data.conditions[*i]);
        readings.iter().map(of).collect()
    }

    fn linearise_some(&self, point: &Point, readings: &[usize]) -> (Vec<f64>, Vec<Vec<f64>>) {
        match point.terms.len() {
            0 => self.rows::<TERMS>(point, readings),
            1 => self.rows::<{ TERMS + 2 }>(point, readings),
            2 => self.rows::<{ TERMS + 4 }>(point, readings),
            3 => self.rows::<{ TERMS + 6 }>(point, readings),
            4 => self.rows::<{ TERMS + 8 }>(point, readings),
            _ => self.rows::<SLOTS>(point, readings),
        }
    }

    fn linearise(&self, point: &Point) -> Linearised {
        // Derivatives cost as much as there are slots.
        match point.terms.len() {
            0 => self.linearised::<TERMS>(point),
            1 => self.linearised::<{ TERMS + 2 }>(point),
            2 => self.linearised::<{ TERMS + 4 }>(point),
            3 => self.linearised::<{ TERMS + 6 }>(point),
            4 => self.linearised::<{ TERMS + 8 }>(point),
            _ => self.linearised::<SLOTS>(point),
        }
    }

    fn far(&self, point: &Point) -> Vec<(usize, Vec<f64>)> {
        self.far_starts(point)
    }

    fn bends(&self, point: &Point, term: usize) -> Vec<Vec<f64>> {
        self.bent_columns(point, term)
    }

    fn scatters(&self, point: &Point, term: usize) -> Vec<Vec<f64>> {
        self.scattered_columns(point, term)
    }

    fn directions(&self, point: &Point) -> Vec<Direction> {
        self.directions_beside(point)
    }
}
