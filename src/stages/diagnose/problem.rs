//! The isometric campaign as a problem for the engine: groups, forward model with derivatives, nuisance components.
//!
//! F_i = sensor(effects; (1 + u_k) (1 + g_c) A(P_i, l_i + d_s; theta)) + z_s + z_c + misfit + noise, where u_k is the gain of the specimen,
//! d_s the set length and z_s the zero of the force of the session, g_c and z_c gain and zero of the campaign (of a pool only). Resting and
//! contracted length of a specimen are known as well as declared, or else to their rounding; where the standard deviation of a session's set
//! length is declared, it is not estimated. The misfit is proportional to the force, with a small floor, and absent
//! where the actuator is slack: one over (eps*, P*) that all specimens share, one of each session along P and, where the readings show it, one
//! of each stroke along P, Gaussian processes in a cosine basis (Solin and Sarkka, Statistics and Computing 30 (2020) 419).
//!
//! The common misfit is what the law cannot be with any coefficients: its columns stand at right angles to the derivatives by the free
//! coefficients at the fit without misfit, over the scale of the misfit. Else the two share the force between them as the prior of the misfit
//! would have it, not the data: on the rig it took 45% of the force, and the coefficients meant nothing.
//!
//! A stroke is the filling or the venting of one log. On the laboratory's rig readings of one stroke are alike beyond everything else: most of
//! all those of the first filling after the length was set, which is up to 15 N below the next ones.

use super::base::{Base, BaseCoefficient};
use super::bent::Bent;
use super::data::Data;
use super::library::{Term, What};
use super::settings;
use super::slack::{self, Side, Sided};
use super::smooth::cosines;
use pipeline_inference::fit::{Fitted, Setting};
use pipeline_inference::problem::Term as EngineTerm;
use pipeline_inference::problem::{Coefficient, Component, Direction, Linearised, Point, Problem};
use pipeline_inference::query;
use pipeline_inference::system::Variances;
use pipeline_inference::tree::{Block, Tree};
use pipeline_inference::variance::{Prior, Scale};
use pipeline_mechanics::effects::{self, Applied, Conditions};
use pipeline_mechanics::models::P_620_KPA;
use pipeline_numerics::matrix::Matrix;
use pipeline_numerics::qr::PivotedQr;
use pipeline_numerics::real::{Dual, Real};
use pipeline_numerics::statistics::median;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// The components, by their numbers.
pub mod component {
    /// Gain of a specimen, relative.
    pub const GAIN: usize = 0;
    /// Set length of a session, mm.
    pub const SET_LENGTH: usize = 1;
    /// Zero of the force of a session, N.
    pub const ZERO: usize = 2;
    /// Resting length of a specimen, in units of its declared standard deviation, or of that of rounding to 1 mm.
    pub const REST_LENGTH: usize = 3;
    /// The same of its contracted length.
    pub const CONTRACTED_LENGTH: usize = 4;
    /// Misfit that all specimens share, share of the force.
    pub const COMMON_MISFIT: usize = 5;
    /// Misfit of a session along the pressure, share of the force.
    pub const SESSION_MISFIT: usize = 6;
    /// Gain of a campaign of a pool, relative.
    pub const CAMPAIGN_GAIN: usize = 7;
    /// Zero of the force of a campaign of a pool, N.
    pub const CAMPAIGN_ZERO: usize = 8;
    /// Misfit of a stroke (the filling or the venting of one log) along the pressure, share of the force.
    pub const STROKE_MISFIT: usize = 9;
    /// Set length of a session for which its standard deviation is declared, in units of that.
    pub const DECLARED_LENGTH: usize = 10;
    /// How many there are.
    pub const COUNT: usize = 11;
}

/// Most terms in one model.
pub const MOST_TERMS: usize = pipeline_config::MOST_EFFECTS;
/// Slots of the derivatives: coefficients, gain, length, zero, resting and contracted length, two for each term and for one that is tried
/// beside them.
const SLOTS: usize = TERMS + 2 * (MOST_TERMS + 1);
/// Most coefficients of a law.
const COEFFICIENTS: usize = 6;
const GAIN: usize = COEFFICIENTS;
const LENGTH: usize = GAIN + 1;
const ZERO: usize = GAIN + 2;
const REST: usize = GAIN + 3;
const CONTRACTED: usize = GAIN + 4;
const TERMS: usize = GAIN + 5;

/// Changes of the force, as shares of its root mean square, at which an effect that enters nonlinearly is looked at again; no larger than
/// four fifths of its bounds. A sharp threshold has an optimum between any two pressures that were set: with two shares one of 150 kPa was missed.
pub const LARGE_CHANGES: [f64; 3] = [0.08, 0.24, 0.72];
/// Cosine above which two amplitudes of one effect show alike.
pub const SAME_DIRECTION: f64 = 0.98;

/// Cosines of a session's misfit along the pressure.
const SESSION_COSINES: usize = 8;
/// Cosines of a stroke's misfit along the pressure.
const STROKE_COSINES: usize = 5;
/// Cosines of the common misfit along each of eps* and P*.
const COMMON_COSINES: usize = 6;

/// Where the operators of the random effects stand in the library.
struct Operators {
    length: usize,
    zero: usize,
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
    /// Node of each specimen.
    pub specimens: Vec<usize>,
    /// Node of each session.
    pub sessions: Vec<usize>,
    /// Node of each campaign of a pool.
    pub campaigns: Vec<usize>,
    components: Vec<Component>,
    noise: Vec<Scale>,
    coefficients: Vec<Coefficient>,
    terms: Vec<EngineTerm>,
    operators: Operators,
    /// Side of the corner to slackness of each reading.
    side: Vec<Side>,
    /// Cosines of the session's misfit, reading by reading.
    session_basis: Vec<Vec<f64>>,
    /// Cosines of the stroke's misfit; none where sessions are of one stroke.
    stroke_basis: Vec<Vec<f64>>,
    /// Columns of the common misfit, reading by reading, N for a misfit of 1.
    common_misfit: Vec<Vec<f64>>,
    /// Derivatives of the reference by the free coefficients of the law, one column each.
    slopes: Vec<Vec<f64>>,
    /// Largest force, N.
    largest: f64,
    /// Floor of the scale of the misfit, N.
    floor: f64,
    /// The force by which the misfit is scaled, N: predictions of a fit without misfit. They are frozen, so that all models of a campaign have
    /// one covariance for it.
    reference: Vec<f64>,
}

/// The space of what other coefficients of the law would do, as shares of the scale of the misfit.
struct LawSpan {
    factor: PivotedQr,
    rank: usize,
    /// Scale of the misfit of every reading, N.
    scales: Vec<f64>,
    /// The readings that have one.
    places: Vec<usize>,
}

impl LawSpan {
    /// What the law leaves of shares of the scale, at the readings that have a misfit.
    fn left_of(&self, shares: &[f64]) -> Vec<f64> {
        let mut left: Vec<f64> = self.places.iter().map(|i| shares[*i]).collect();
        self.factor.apply_q_transposed(&mut left);
        left[..self.rank].fill(0.0);
        self.factor.apply_q(&mut left);
        left
    }

    /// The same of forces, N.
    fn left_of_forces(&self, forces: &[f64]) -> Vec<f64> {
        let shares = forces.iter().zip(&self.scales);
        self.left_of(&shares.map(|(f, scale)| f / scale).collect::<Vec<f64>>())
    }
}

/// The groups of some readings as nodes of a tree, and the node of each reading.
struct Hierarchy {
    tree: Tree,
    node: Vec<usize>,
    specimens: Vec<usize>,
    sessions: Vec<usize>,
    /// Of a pool.
    campaigns: Vec<usize>,
    /// Number of strokes that are nodes.
    strokes: usize,
}

impl Hierarchy {
    /// A specimen that was measured in two campaigns is one specimen in each.
    fn of(data: &Data, by_stroke: bool) -> Self {
        let root = vec![block(component::COMMON_MISFIT, common_pairs().count())];
        let mut all = Self {
            tree: Tree::new(root),
            node: Vec::with_capacity(data.len()),
            specimens: vec![usize::MAX; data.specimens.len()],
            sessions: vec![usize::MAX; data.sessions.len()],
            campaigns: Vec::new(),
            strokes: 0,
        };
        if data.campaigns.len() > 1 {
            let of = |_| {
                let gain = block(component::CAMPAIGN_GAIN, 1);
                let zero = block(component::CAMPAIGN_ZERO, 1);
                all.tree.add(0, vec![gain, zero])
            };
            all.campaigns = (0..data.campaigns.len()).map(of).collect();
        }
        let mut nodes = BTreeMap::new();
        for (i, stroke) in data.strokes().into_iter().enumerate() {
            let session = all.session_of(data, i);
            let node = if by_stroke {
                let blocks = || vec![block(component::STROKE_MISFIT, STROKE_COSINES)];
                let add = || all.tree.add(session, blocks());
                *nodes.entry(stroke).or_insert_with(add)
            } else {
                session
            };
            all.node.push(node);
        }
        all.strokes = nodes.len();
        all
    }

    /// The node of the session of reading `i`, which is added with its specimen where it is new.
    fn session_of(&mut self, data: &Data, i: usize) -> usize {
        let (k, s) = (data.specimen[i], data.session[i]);
        if self.specimens[k] == usize::MAX {
            let campaign = self.campaigns.get(data.campaign[i]);
            let blocks = vec![
                block(component::GAIN, 1),
                block(component::REST_LENGTH, 1),
                block(component::CONTRACTED_LENGTH, 1),
            ];
            self.specimens[k] = self.tree.add(campaign.copied().unwrap_or(0), blocks);
        }
        if self.sessions[s] == usize::MAX {
            let length = if data.set_length_sd_mm[s].is_finite() {
                component::DECLARED_LENGTH
            } else {
                component::SET_LENGTH
            };
            let blocks = vec![
                block(length, 1),
                block(component::ZERO, 1),
                block(component::SESSION_MISFIT, SESSION_COSINES),
            ];
            self.sessions[s] = self.tree.add(self.specimens[k], blocks);
        }
        self.sessions[s]
    }
}

fn block(component: usize, columns: usize) -> Block {
    Block { component, columns }
}

/// The noise of each class of readings: of every campaign, which is estimated, and of the parts of the corner to slackness.
fn noise(campaigns: usize, largest_n: f64) -> Vec<Scale> {
    let in_corner = Prior::Held(settings::CORNER_WIDTH * largest_n);
    let priors = vec![Prior::Free; campaigns].into_iter();
    priors
        .chain([in_corner; slack::BANDS])
        .map(|prior| Scale {
            prior,
            usual: 0.01 * largest_n,
            groups: 1,
        })
        .collect()
}

/// A coefficient of the law as the engine sees it.
fn for_engine(c: &BaseCoefficient) -> Coefficient {
    Coefficient {
        start: c.start,
        bounds: c.bounds,
        free: c.free,
    }
}

impl<'a> ForceProblem<'a> {
    /// The problem of some readings, the misfit of strokes left out.
    pub fn new(base: &'a Base, data: &'a Data, library: &'a [Term]) -> Self {
        Self::built(base, data, library, false)
    }

    fn built(base: &'a Base, data: &'a Data, library: &'a [Term], by_stroke: bool) -> Self {
        let Hierarchy {
            tree,
            node,
            specimens,
            sessions,
            campaigns,
            strokes,
        } = Hierarchy::of(data, by_stroke);
        let largest = data.force.iter().copied().fold(0.0, f64::max);
        let columns = data.extras.len();
        let forces = data.force.iter().zip(&data.conditions);
        let side: Vec<Side> = forces.map(|(f, at)| slack::side(*f, largest, at)).collect();
        let corner = data.campaigns.len();
        let class_of = |i: usize| match side[i] {
            Side::Corner => corner + slack::band(&data.conditions[i]),
            _ => data.campaign[i],
        };
        Self {
            base,
            data,
            library,
            class: (0..data.len()).map(class_of).collect(),
            tree,
            node,
            specimens,
            sessions,
            components: components(base, data, !campaigns.is_empty(), strokes),
            campaigns,
            noise: noise(corner, largest),
            coefficients: base.coefficients.iter().map(for_engine).collect(),
            terms: library.iter().map(|t| t.for_engine(columns)).collect(),
            operators: Operators {
                length: effects::index("length_offset").unwrap_or(0),
                zero: effects::index("force_zero_offset").unwrap_or(0),
            },
            side,
            session_basis: along_pressure(data, SESSION_COSINES, settings::PRESSURE_LENGTH_KPA),
            stroke_basis: if by_stroke {
                along_pressure(data, STROKE_COSINES, settings::STROKE_LENGTH_KPA)
            } else {
                vec![Vec::new(); data.len()]
            },
            common_misfit: vec![vec![0.0; common_pairs().count()]; data.len()],
            slopes: Vec::new(),
            reference: vec![0.0; data.len()],
            floor: settings::MISFIT_FLOOR * largest,
            largest,
        }
    }

    /// The same with the misfit scaled by the predictions of a fit without it.
    pub fn with_reference(mut self) -> Self {
        let setting = Setting {
            misfit_factor: 0.0,
            ..Setting::new(&self).usual()
        };
        let fit = setting.fit(&self.start(), &setting.fresh()[..1]);
        let linear = self.linearise(&fit.point);
        self.reference = linear.predicted;
        let columns = linear.by_coefficients.into_iter().zip(&self.coefficients);
        self.slopes = columns.filter(|(_, c)| c.free).map(|(x, _)| x).collect();
        self.common_misfit = self.beside_the_law();
        self
    }

    /// What other coefficients of the law would do, at the readings that have a misfit; none where these are too few.
    fn law_span(&self) -> Option<LawSpan> {
        let scales: Vec<f64> = (0..self.data.len()).map(|i| self.misfit_scale(i)).collect();
        let places: Vec<usize> = (0..scales.len()).filter(|i| scales[*i] > 0.0).collect();
        if places.len() <= self.slopes.len() {
            return None;
        }
        let mut law = Matrix::zeros(places.len(), self.slopes.len());
        for (k, slope) in self.slopes.iter().enumerate() {
            let column = law.column_mut(k).iter_mut().zip(&places);
            column.for_each(|(x, i)| *x = slope[*i] / scales[*i]);
        }
        law.normalise_columns();
        let factor = PivotedQr::new(law);
        Some(LawSpan {
            rank: factor.rank(factor.default_tolerance()),
            factor,
            scales,
            places,
        })
    }

    /// Columns of the common misfit: cosines over (eps*, P*) times the scale of the misfit, less what other coefficients of the law would do as
    /// well.
    fn beside_the_law(&self) -> Vec<Vec<f64>> {
        let count = common_pairs().count();
        let mut columns = vec![vec![0.0; count]; self.data.len()];
        let Some(span) = self.law_span() else {
            return columns;
        };
        let cosines: Vec<Vec<f64>> = self.data.conditions.iter().map(common_basis).collect();
        for c in 0..count {
            let shares = cosines.iter().map(|all| all[c]).collect::<Vec<f64>>();
            for (i, share) in span.places.iter().zip(span.left_of(&shares)) {
                columns[*i][c] = span.scales[*i] * share;
            }
        }
        columns
    }

    /// The same with another floor of the scale of the misfit, a share of the largest force.
    pub fn with_floor(&self, share: f64) -> Self {
        let mut other = Self {
            reference: self.reference.clone(),
            slopes: self.slopes.clone(),
            floor: share * self.largest,
            ..Self::built(self.base, self.data, self.library, self.has_strokes())
        };
        other.common_misfit = other.beside_the_law();
        other
    }

    /// The same with a misfit of every stroke; none where no session has several strokes, whose own that would be.
    pub fn with_strokes(&self) -> Option<Self> {
        let strokes = self.data.strokes().into_iter().max()? + 1;
        (strokes > self.sessions.len()).then(|| Self {
            reference: self.reference.clone(),
            slopes: self.slopes.clone(),
            common_misfit: self.common_misfit.clone(),
            floor: self.floor,
            ..Self::built(self.base, self.data, self.library, true)
        })
    }

    /// The same with the scatter of the declared set lengths estimated, for readings that contradict what was declared.
    pub fn with_declared_estimated(mut self) -> Self {
        let declared = self.data.set_length_sd_mm.iter().copied();
        let declared: Vec<f64> = declared.filter(|sd| sd.is_finite()).collect();
        let usual = settings::USUAL_SET_LENGTH_MM / median(&declared);
        self.components[component::DECLARED_LENGTH].scale = Scale {
            prior: Prior::HalfNormal(settings::LARGEST_SCATTER * usual),
            usual,
            groups: declared.len(),
        };
        self
    }

    /// Whether somebody declared the standard deviations of a component.
    pub fn is_declared(&self, c: usize) -> bool {
        let of_specimens = |k: usize| {
            let mut all = self.data.specimen_lengths_sd_mm.iter();
            all.any(|sd| sd[k].is_finite())
        };
        match c {
            component::DECLARED_LENGTH => {
                self.data.set_length_sd_mm.iter().any(|sd| sd.is_finite())
            }
            component::REST_LENGTH => of_specimens(0),
            component::CONTRACTED_LENGTH => of_specimens(1),
            _ => false,
        }
    }

    /// Whether the readings contradict the set lengths that were declared, beside a model.
    pub fn contradicts_declared(&self, setting: &Setting, model: &Fitted) -> bool {
        let c = component::DECLARED_LENGTH;
        self.is_declared(c) && query::is_too_small(setting, model, &model.restricted(setting), c)
    }

    /// The same readings and terms with another form of the base law.
    pub fn with_base<'b>(&self, base: &'b Base) -> ForceProblem<'b>
    where
        'a: 'b,
    {
        ForceProblem {
            reference: self.reference.clone(),
            slopes: self.slopes.clone(),
            common_misfit: self.common_misfit.clone(),
            floor: self.floor,
            components: self.components.clone(),
            ..ForceProblem::built(base, self.data, self.library, self.has_strokes())
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

    /// Whether the actuator pulls at reading `i`: it is neither slack nor near it.
    pub fn pulls(&self, i: usize) -> bool {
        self.side[i] == Side::Pulls
    }

    /// Whether strokes have a misfit of their own.
    pub fn has_strokes(&self) -> bool {
        self.stroke_basis.iter().any(|b| !b.is_empty())
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

    /// The force of reading `i`, misfit left out: by coefficients, gain, set length, zero, what resting and contracted length are longer than noted,
    /// mm, and terms.
    fn force<R: Real>(
        &self,
        i: usize,
        at: &Conditions,
        coefficients: &[R],
        [gain, length, zero, rest, contracted]: [R; 5],
        terms: &[(usize, [R; 2])],
    ) -> R {
        let applied = |effect: usize, value: R| Applied {
            effect,
            form: 0,
            parameters: [value, R::constant(0.0)],
        };
        let mut list = Vec::with_capacity(terms.len() + 2);
        list.push(applied(self.operators.length, length));
        let effects = terms.iter();
        list.extend(effects.filter_map(|(t, values)| self.library[*t].applied(*values)));
        list.push(applied(self.operators.zero, zero));
        let law = Sided {
            base: self.base,
            side: self.side[i],
        };
        let at = &Conditions {
            pulls: self.pulls(i),
            ..*at
        };
        let mut parameters = [rest; COEFFICIENTS + 2];
        let known = coefficients.len();
        parameters[..known].copy_from_slice(coefficients);
        parameters[known + 1] = contracted;
        let mut force = effects::force(&law, &parameters[..known + 2], gain, &list, at);
        for (t, values) in terms {
            if let What::Column(column) = self.library[*t].what {
                force = column.apply(force, *values, at, (self.data, i));
            }
        }
        force
    }

    /// The terms that act on reading `i`, with their amplitude and shape; the numbers of the values among all values of the terms.
    fn acting<'p>(
        &'p self,
        point: &'p Point,
        i: usize,
    ) -> impl Iterator<Item = (usize, [f64; 2], [usize; 2])> + 'p {
        let session = self.data.session[i];
        let mut before = 0;
        point.terms.iter().filter_map(move |(t, values)| {
            let first = before;
            before += values.len();
            let term = &self.library[*t];
            let group = term.acts_on[session]?;
            let places = match term.what {
                What::Column(_) => [2 * group, 2 * group + 1],
                What::Effect { .. } => [group, term.amplitudes],
            };
            let shape = values.get(places[1]).copied().unwrap_or(0.0);
            Some((*t, [values[places[0]], shape], places.map(|p| first + p)))
        })
    }

    /// Gain (as a factor), set length and zero that act on reading `i`.
    fn random(&self, point: &Point, i: usize) -> [f64; 3] {
        let b = &point.random;
        let of = |node: usize, c: usize| self.tree.columns_of(node, c).map_or(0.0, |(k, _)| b[k]);
        let session = self.sessions[self.data.session[i]];
        let specimen = self.tree.parent(session);
        let campaign = self.tree.parent(specimen);
        [
            (1.0 + of(specimen, component::GAIN)) * (1.0 + of(campaign, component::CAMPAIGN_GAIN)),
            of(session, component::SET_LENGTH)
                + self.set_length_unit(i) * of(session, component::DECLARED_LENGTH),
            of(session, component::ZERO) + of(campaign, component::CAMPAIGN_ZERO),
        ]
    }

    /// What the random set length of reading `i` is in units of, mm.
    fn set_length_unit(&self, i: usize) -> f64 {
        let declared = self.data.set_length_sd_mm[self.data.session[i]];
        if declared.is_finite() { declared } else { 1.0 }
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

    fn value(&self, point: &Point, i: usize, at: &Conditions) -> f64 {
        let acting = self.acting(point, i);
        let terms: Vec<_> = acting.map(|(t, values, _)| (t, values)).collect();
        let [gain, length, zero] = self.random(point, i);
        let random = [gain, length, zero, 0.0, 0.0];
        self.force(i, at, &point.coefficients, random, &terms)
    }

    /// The scale of the misfit of reading `i`, N: at the largest force it is that force, whatever the floor.
    fn misfit_scale(&self, i: usize) -> f64 {
        match self.side[i] {
            Side::Slack => 0.0,
            Side::Pulls | Side::Corner | Side::AsPublished => {
                (self.reference[i].max(0.0) + self.floor) / (1.0 + self.floor / self.largest)
            }
        }
    }

    fn derivatives<const N: usize>(&self, point: &Point, i: usize) -> (f64, [f64; N], Vec<f64>) {
        let at = &self.data.conditions[i];
        let mut coefficients = [Dual::<N>::constant(0.0); COEFFICIENTS];
        let known = point.coefficients.len();
        for (k, (slot, c)) in coefficients.iter_mut().zip(&point.coefficients).enumerate() {
            *slot = Dual::variable(*c, k);
        }
        let [gain, length, zero] = self.random(point, i);
        let random = [
            Dual::variable(gain, GAIN),
            Dual::variable(length, LENGTH),
            Dual::variable(zero, ZERO),
            Dual::variable(0.0, REST),
            Dual::variable(0.0, CONTRACTED),
        ];
        let mut terms = Vec::with_capacity(point.terms.len());
        for (k, (t, [amplitude, shape], _)) in self.acting(point, i).enumerate() {
            let slot = TERMS + 2 * k;
            let second = if self.library[t].has_shape() || self.library[t].id().is_none() {
                Dual::variable(shape, slot + 1)
            } else {
                Dual::constant(shape)
            };
            terms.push((t, [Dual::variable(amplitude, slot), second]));
        }
        let force = self.force(i, at, &coefficients[..known], random, &terms);
        let row = self.random_row(i, &force, gain, point);
        (force.value, force.gradient, row)
    }

    /// Predictions and derivatives at a point with so many slots.
    fn linearised<const N: usize>(&self, point: &Point) -> Linearised {
        let n = self.data.len();
        let values: usize = point.terms.iter().map(|(_, v)| v.len()).sum();
        let mut linear = Linearised {
            predicted: Vec::with_capacity(n),
            by_coefficients: vec![vec![0.0; n]; point.coefficients.len()],
            by_terms: vec![vec![0.0; n]; values],
            random: Vec::with_capacity(n),
        };
        let rows: Vec<_> = (0..n)
            .into_par_iter()
            .with_min_len(64)
            .map(|i| self.derivatives::<N>(point, i))
            .collect();
        for (i, (force, gradient, row)) in rows.into_iter().enumerate() {
            for (k, column) in linear.by_coefficients.iter_mut().enumerate() {
                column[i] = gradient[k];
            }
            for (k, (t, _, places)) in self.acting(point, i).enumerate() {
                linear.by_terms[places[0]][i] = gradient[TERMS + 2 * k];
                if self.library[t].has_shape() || self.library[t].id().is_none() {
                    linear.by_terms[places[1]][i] = gradient[TERMS + 2 * k + 1];
                }
            }
            linear.predicted.push(force);
            linear.random.push(row);
        }
        linear
    }

    /// Predictions at some readings, and their derivatives by the random effects.
    fn rows<const N: usize>(&self, point: &Point, readings: &[usize]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let of = |i: &usize| {
            let (force, _, row) = self.derivatives::<N>(point, *i);
            (force, row)
        };
        readings.iter().map(of).unzip()
    }

    /// By what the force of reading `i` changes if resting and contracted length are off by a standard deviation. In the corner to slackness, which
    /// a short actuator passes within that, a tangent would not tell: there it is half the difference between both ends, or where the domain of the
    /// law ends before one of them the difference to the other.
    fn by_lengths<const N: usize>(&self, point: &Point, i: usize, force: &Dual<N>) -> [f64; 2] {
        let [rest, contracted] = self.specimen_lengths_sd_mm(self.data.specimen[i]);
        if self.side[i] != Side::Corner {
            return [
                force.gradient[REST] * rest,
                force.gradient[CONTRACTED] * contracted,
            ];
        }
        let at = |rest_mm: f64, contracted_mm: f64| {
            let mut at = self.data.conditions[i];
            at.rest_length_m += 1e-3 * rest_mm;
            at.contracted_length_m += 1e-3 * contracted_mm;
            self.value(point, i, &at)
        };
        let between = |below: f64, above: f64| match (below.is_finite(), above.is_finite()) {
            (true, true) => 0.5 * (above - below),
            (true, false) => force.value - below,
            (false, true) => above - force.value,
            (false, false) => 0.0,
        };
        [
            between(at(-rest, 0.0), at(rest, 0.0)),
            between(at(0.0, -contracted), at(0.0, contracted)),
        ]
    }

    /// Derivatives by the random effects of the path of reading `i`.
    fn random_row<const N: usize>(
        &self,
        i: usize,
        force: &Dual<N>,
        gain: f64,
        point: &Point,
    ) -> Vec<f64> {
        let scale = self.misfit_scale(i);
        let mut row = Vec::with_capacity(self.tree.path_columns(self.node[i]));
        row.extend_from_slice(&self.common_misfit[i]);
        let specimen = self.tree.parent(self.sessions[self.data.session[i]]);
        let of = |node: usize, c: usize| {
            self.tree
                .columns_of(node, c)
                .map_or(0.0, |(k, _)| point.random[k])
        };
        // The gain is a product of two: its derivative by each is that by the product times the other.
        let by_gain = force.gradient[GAIN];
        let of_specimen = 1.0 + of(specimen, component::GAIN);
        if !self.campaigns.is_empty() {
            row.push(by_gain * of_specimen);
            row.push(force.gradient[ZERO]);
        }
        row.push(by_gain * gain / of_specimen);
        row.extend(self.by_lengths(point, i, force));
        row.push(force.gradient[LENGTH] * self.set_length_unit(i));
        row.push(force.gradient[ZERO]);
        let along = self.session_basis[i].iter().chain(&self.stroke_basis[i]);
        row.extend(along.map(|c| c * scale));
        row
    }
}

/// The components of a campaign or pool.
fn components(base: &Base, data: &Data, pooled: bool, strokes: usize) -> Vec<Component> {
    let sessions = data.sessions.len();
    let component = |prior, usual, linear, calibrates, misfit| Component {
        scale: Scale {
            prior,
            usual,
            groups: 1,
        },
        linear,
        calibrates,
        misfit,
    };
    let misfit = |scale: f64| component(Prior::HalfNormal(scale), scale, true, false, true);
    let scatter = |usual: f64, groups: usize| {
        let prior = Prior::HalfNormal(settings::LARGEST_SCATTER * usual);
        with_groups(component(prior, usual, false, true, false), groups)
    };
    let pool = |usual: f64| {
        let prior = if pooled {
            Prior::Free
        } else {
            Prior::Fixed(0.0)
        };
        component(prior, usual, false, true, false)
    };
    vec![
        scatter(settings::USUAL_GAIN, data.specimens.len()),
        scatter(settings::USUAL_SET_LENGTH_MM, sessions),
        scatter(settings::USUAL_ZERO_N, sessions),
        component(Prior::Fixed(1.0), 1.0, true, true, false),
        component(Prior::Fixed(1.0), 1.0, true, true, false),
        misfit(base.common_misfit()),
        with_groups(misfit(settings::SESSION_MISFIT), sessions),
        pool(settings::USUAL_GAIN),
        pool(settings::USUAL_ZERO_N),
        with_groups(
            component(
                Prior::HalfNormal(settings::LARGEST_SCATTER * settings::USUAL_STROKE),
                settings::USUAL_STROKE,
                true,
                false,
                true,
            ),
            strokes,
        ),
        component(Prior::Fixed(1.0), 1.0, false, true, false),
    ]
}

fn with_groups(mut component: Component, groups: usize) -> Component {
    component.scale.groups = groups;
    component
}

/// Cosines along the pressure of every reading, of a misfit with a correlation length in kPa.
fn along_pressure(data: &Data, count: usize, length_kpa: f64) -> Vec<Vec<f64>> {
    let of = |at: &Conditions| cosines(count, at.pressure_kpa / P_620_KPA, length_kpa / P_620_KPA);
    data.conditions.iter().map(of).collect()
}

/// Products of cosines over eps* and P*, without the constant, which is a gain of all readings, and without those that vary faster than the
/// fastest along one of the two.
fn common_basis(at: &Conditions) -> Vec<f64> {
    let eps_620 = (at.rest_length_m - at.contracted_length_m) / at.rest_length_m;
    let contraction = (at.rest_length_m - at.length_m) / at.rest_length_m / eps_620;
    let length = settings::SURFACE_LENGTH;
    let [over_contraction, over_pressure] =
        [contraction, at.pressure_kpa / P_620_KPA].map(|x| cosines(COMMON_COSINES, x, length));
    common_pairs()
        .map(|(j, k)| over_contraction[j] * over_pressure[k])
        .collect()
}

/// Numbers of the cosines of each product of the common misfit.
fn common_pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..COMMON_COSINES)
        .flat_map(|j| (0..COMMON_COSINES - j).map(move |k| (j, k)))
        .skip(1)
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
        &self.data.force
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
        conditions.map(|(i, at)| self.value(point, i, at)).collect()
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
        let Some(span) = self.law_span() else {
            return Vec::new();
        };
        let base = self.predict(point);
        let is_whole = |t: &usize| {
            let term = &self.library[*t];
            term.scope == Scope::All && term.id().is_some() && term.amplitudes == 1
        };
        let known = |t: &usize| point.terms.iter().any(|(u, _)| u == t);
        let terms: Vec<usize> = (0..self.library.len())
            .filter(|t| is_whole(t) && !known(t))
            .collect();
        let starts = terms.into_par_iter().flat_map_iter(|t| {
            let far = self.far_amplitudes(point, &base, t, &span);
            let start = move |a: f64| (t, self.library[t].start(a));
            far.into_iter().map(start)
        });
        starts.collect()
    }

    fn bends(&self, point: &Point, term: usize) -> Vec<Vec<f64>> {
        let linear = self.linearise(point);
        let mut place = 0;
        for (t, values) in &point.terms {
            let of_term = &linear.by_terms[place..place + values.len()];
            place += values.len();
            if *t == term {
                let amplitudes = values.iter().take(self.library[term].amplitudes);
                let columns = of_term.iter().map(Vec::as_slice);
                let by_amplitudes: Vec<(f64, &[f64])> = amplitudes.copied().zip(columns).collect();
                let bent = Bent::new(
                    &self.library[term],
                    &self.data.conditions,
                    &by_amplitudes,
                    &linear.predicted,
                    |_| true,
                );
                return bent.map_or_else(Vec::new, |b| b.columns);
            }
        }
        Vec::new()
    }

    fn directions(&self, point: &Point) -> Vec<Direction> {
        let base = self.predict(point);
        let mut whole: Vec<(What, Vec<Direction>)> = Vec::new();
        for (t, term) in self.library.iter().enumerate() {
            if term.scope == Scope::All && !point.terms.iter().any(|(u, _)| *u == t) {
                whole.push((term.what, Vec::new()));
            }
        }
        whole.par_iter_mut().for_each(|(what, directions)| {
            let t = self
                .library
                .iter()
                .position(|t| t.scope == Scope::All && t.what == *what || same(t, *what));
            if let Some(t) = t {
                *directions = self.whole_directions(point, &base, t);
            }
        });
        let mut all = Vec::new();
        for (t, term) in self.library.iter().enumerate() {
            if point.terms.iter().any(|(u, _)| *u == t) {
                continue;
            }
            let found = whole.iter().find(|(what, _)| same(term, *what));
            for direction in found.map_or(&[][..], |(_, d)| d) {
                all.push(self.masked(t, term, direction));
            }
        }
        all
    }
}

use super::library::Scope;

/// Whether a term is of this form (shapes are compared as bits: not a number where there is none).
fn same(term: &Term, what: What) -> bool {
    match (term.what, what) {
        (
            What::Effect {
                effect,
                form,
                shape,
            },
            What::Effect {
                effect: e,
                form: f,
                shape: s,
            },
        ) => effect == e && form == f && shape.to_bits() == s.to_bits(),
        (a, b) => a == b,
    }
}

impl ForceProblem<'_> {
    /// Changes of the force by a term on all readings, per unit of its amplitude: at a small amplitude, and at one that changes the force
    /// visibly, where that has another form.
    fn whole_directions(&self, point: &Point, base: &[f64], t: usize) -> Vec<Direction> {
        let term = &self.library[t];
        if let What::Column(_) = term.what {
            let columns = (0..2).map(|k| {
                let mut values = vec![0.0; 2];
                values[k] = 1e-3;
                self.change(point, base, t, &values, 1e-3)
            });
            return vec![Direction {
                term: t,
                start: vec![1.0; 2],
                columns: columns.collect(),
            }];
        }
        let mut directions: Vec<Direction> = Vec::new();
        for amplitude in self.amplitudes(point, base, t, &LARGE_CHANGES[..1]) {
            let change = self.change(point, base, t, &term.start(amplitude), amplitude);
            let alike = |d: &Direction| cosine(&d.columns[0], &change) >= SAME_DIRECTION;
            if !directions.iter().any(alike) {
                directions.push(Direction {
                    term: t,
                    start: term.start(1.0),
                    columns: vec![change],
                });
            }
        }
        directions
    }

    /// Amplitudes at which a term with one is looked at: a small one, and those that change the force by such shares, of either sign.
    fn amplitudes(&self, point: &Point, base: &[f64], t: usize, shares: &[f64]) -> Vec<f64> {
        let term = &self.library[t];
        let (low, high) = self.terms[t].bounds[0];
        let near = term
            .id()
            .and_then(effects::index)
            .map_or(0.0, |e| effects::all()[e].near());
        let small = if near == 0.0 { 1e-4 * high } else { near };
        let rms = |v: &[f64]| (v.iter().map(|x| x * x).sum::<f64>() / v.len().max(1) as f64).sqrt();
        let change = rms(&self.change(point, base, t, &term.start(small), small));
        let mut all = vec![small];
        if change > 0.0 && change.is_finite() {
            for share in shares {
                let large = (share * rms(base) / change).min(0.8 * high);
                all.push(large);
                if low < 0.0 {
                    all.push((-large).max(0.8 * low));
                }
            }
        }
        all
    }

    /// Amplitudes of a term at which what the law leaves of its change has another form than at a small one.
    fn far_amplitudes(&self, point: &Point, base: &[f64], t: usize, span: &LawSpan) -> Vec<f64> {
        let term = &self.library[t];
        let left = |amplitude: f64| {
            let change = self.change(point, base, t, &term.start(amplitude), amplitude);
            span.left_of_forces(&change)
        };
        let amplitudes = self.amplitudes(point, base, t, &LARGE_CHANGES);
        let near = left(amplitudes[0]);
        let mut far = amplitudes[1..].to_vec();
        far.retain(|a| cosine(&near, &left(*a)) < SAME_DIRECTION);
        far
    }

    /// The change of the force by a term on all readings at an amplitude, per unit of it.
    pub fn direction_at(&self, point: &Point, t: usize, amplitude: f64) -> Direction {
        let term = &self.library[t];
        let base = self.predict(point);
        Direction {
            term: t,
            start: term.start(1.0),
            columns: vec![self.change(point, &base, t, &term.start(amplitude), amplitude)],
        }
    }

    fn change(&self, point: &Point, base: &[f64], t: usize, values: &[f64], unit: f64) -> Vec<f64> {
        let mut with = point.clone();
        with.terms.push((t, values.to_vec()));
        let predicted = self.predict(&with);
        predicted
            .iter()
            .zip(base)
            .map(|(a, b)| (a - b) / unit)
            .collect()
    }

    /// The direction of a term that acts on a part of the sessions, from that on all readings.
    fn masked(&self, t: usize, term: &Term, whole: &Direction) -> Direction {
        if term.scope == Scope::All {
            return Direction {
                term: t,
                ..whole.clone()
            };
        }
        let columns = (0..term.amplitudes).map(|g| {
            let acts = |i: usize| term.acts_on[self.data.session[i]] == Some(g);
            let column = whole.columns[0].iter().enumerate();
            column
                .map(|(i, x)| if acts(i) { *x } else { 0.0 })
                .collect()
        });
        Direction {
            term: t,
            start: term.start(1.0),
            columns: columns.collect(),
        }
    }
}

/// Cosine of the angle between two columns; 1 where one of them is nothing.
pub fn cosine(a: &[f64], b: &[f64]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let norms = (dot(a, a) * dot(b, b)).sqrt();
    if norms > 0.0 { dot(a, b) / norms } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library;
    use pipeline_config::FitOptions;
    use pipeline_numerics::matrix::norm;
    use pipeline_simulate::rig_like;

    #[test]
    fn derivatives_by_the_lengths_of_a_specimen_are_those_of_other_conditions() {
        let rows = rig_like::campaign(1, &rig_like::Settings::default()).rows;
        let rows: Vec<&_> = rows.iter().collect();
        let data = Data::new(&rows);
        let library = library::terms(&data);
        let base = Base::new(10, true, 2, &FitOptions::default());
        let problem = ForceProblem::new(&base, &data, &library);
        let frame = library
            .iter()
            .position(|t| t.scope == Scope::All && t.is_frame());
        let frame = frame.unwrap();
        let mut point = problem.start();
        point.terms.push((frame, library[frame].start(20.0)));
        let step = 1e-5;
        for i in (0..data.len()).filter(|i| problem.side[*i] != Side::Corner) {
            let (_, gradient, _) = problem.derivatives::<SLOTS>(&point, i);
            let value = |rest: f64, contracted: f64| {
                let mut at = data.conditions[i];
                at.rest_length_m += rest;
                at.contracted_length_m += contracted;
                problem.value(&point, i, &at)
            };
            let rest = value(step, 0.0) - value(-step, 0.0);
            let contracted = value(0.0, step) - value(0.0, -step);
            for (slot, difference) in [(REST, rest), (CONTRACTED, contracted)] {
                let slope = difference / (2e3 * step);
                assert!(
                    (gradient[slot] - slope).abs() < 1e-5 * (1.0 + slope.abs()),
                    "{i} {slot}: {} {slope}",
                    gradient[slot]
                );
            }
        }
    }

    #[test]
    fn the_common_misfit_is_nothing_that_the_law_could_be() {
        let rows = rig_like::campaign(1, &rig_like::Settings::default()).rows;
        let rows: Vec<&_> = rows.iter().collect();
        let data = Data::new(&rows);
        let base = Base::new(10, true, 4, &FitOptions::default());
        let problem = ForceProblem::new(&base, &data, &[]).with_reference();
        let scaled = |column: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let of = |i: usize| match problem.misfit_scale(i) {
                scale if scale > 0.0 => column(i) / scale,
                _ => 0.0,
            };
            (0..data.len()).map(of).collect()
        };
        assert_eq!(problem.slopes.len(), 5);
        let mut largest = 0.0_f64;
        for c in 0..common_pairs().count() {
            let misfit = scaled(&|i| problem.common_misfit[i][c]);
            for slope in &problem.slopes {
                let law = scaled(&|i| slope[i]);
                assert!(cosine(&law, &misfit).abs() < 1e-9, "{c}");
            }
            largest = largest.max(norm(&misfit));
        }
        // The cosines themselves are of the order of one at each reading.
        assert!(largest > 0.1 * (data.len() as f64).sqrt(), "{largest}");
    }

    /// At no contraction a resting length that is a little shorter is outside what Hunt's model describes.
    #[test]
    fn at_the_end_of_the_domain_of_a_published_law_all_derivatives_are_finite() {
        let settings = rig_like::Settings {
            specimens: Some(4),
            ..rig_like::Settings::default()
        };
        let rows = rig_like::campaign(9000, &settings).rows;
        let rows: Vec<&_> = rows.iter().collect();
        let data = Data::new(&rows);
        for model in ["hunt2017", "festo_tool"] {
            let base = Base::published(model, true).unwrap();
            let problem = ForceProblem::new(&base, &data, &[]).with_reference();
            let mut point = problem.start();
            // Among them 0.1 mm more than the set length, which stretches an actuator at no contraction.
            point.random.fill(0.1);
            let linear = problem.linearise(&point);
            let random = linear.random.iter().flatten();
            let all = random.chain(&linear.predicted);
            assert!(all.copied().all(f64::is_finite), "{model}");
        }
    }
}
