//! The force of a reading as the engine asks for it: by coefficients, random effects and terms, with its derivatives by all of them.

use super::{ForceProblem, MOST_TERMS, Noted, Operators, component, settings};
use crate::library::What;
use crate::slack::{Side, Sided};
use pipeline_effects as effects;
use pipeline_effects::{Applied, Conditions};
use pipeline_inference::problem::{Linearised, Point};
use pipeline_numerics::real::{Dual, Real};
use rayon::prelude::*;

/// Slots of the derivatives: coefficients, gain, length, zero, resting and contracted length, two for each term and for one that is tried
/// beside them.
pub(crate) const SLOTS: usize = TERMS + 2 * (MOST_TERMS + 1);

/// Most coefficients of a law.
pub(crate) const COEFFICIENTS: usize = 6;

pub(crate) const GAIN: usize = COEFFICIENTS;

pub(crate) const LENGTH: usize = GAIN + 1;

pub(crate) const ZERO: usize = GAIN + 2;

pub(crate) const REST: usize = GAIN + 3;

pub(crate) const CONTRACTED: usize = GAIN + 4;

pub(crate) const TERMS: usize = GAIN + 5;

/// The force that the sensor shows, misfit left out: by coefficients, gain, set length, zero, what resting and contracted length are longer than
/// noted, mm, and the effects that act.
pub(crate) fn sensed<R: Real>(
    law: &Sided,
    operators: &Operators,
    at: &Conditions,
    coefficients: &[R],
    [gain, length, zero, rest, contracted]: [R; 5],
    effects: impl Iterator<Item = Applied<R>>,
) -> R {
    let applied = |effect: usize, value: R| Applied {
        effect,
        form: 0,
        parameters: [value, R::constant(0.0)],
    };
    let mut list = Vec::with_capacity(MOST_TERMS + 2);
    list.push(applied(operators.length, length));
    list.extend(effects);
    list.push(applied(operators.zero, zero));
    let at = &Conditions {
        pulls: law.side == Side::Pulls,
        ..*at
    };
    let mut parameters = [rest; COEFFICIENTS + 2];
    let known = coefficients.len();
    parameters[..known].copy_from_slice(coefficients);
    parameters[known + 1] = contracted;
    effects::force(law, &parameters[..known + 2], gain, &list, at)
}

impl ForceProblem<'_> {
    /// The force of reading `i`, misfit left out ([`sensed`]).
    fn force<R: Real>(
        &self,
        i: usize,
        at: &Conditions,
        coefficients: &[R],
        random: [R; 5],
        terms: &[(usize, [R; 2])],
    ) -> R {
        let law = Sided {
            base: self.base,
            side: self.side[i],
        };
        let of_library = terms.iter();
        let of_library = of_library.filter_map(|(t, values)| self.library[*t].applied(*values));
        let operators = &self.operators;
        let mut force = sensed(&law, operators, at, coefficients, random, of_library);
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

    /// The column of what a campaign of a pool has of its own; none outside a pool.
    pub(crate) fn campaign_column(&self, campaign: usize, component: usize) -> Option<usize> {
        let (first, _) = self.tree.columns_of(0, component)?;
        Some(first + campaign)
    }

    /// The column of the share of noted contractions that is error.
    pub(crate) fn noting_column(&self) -> Option<usize> {
        self.tree
            .columns_of(0, component::NOTING_ERROR)
            .map(|(k, _)| k)
    }

    /// The share of what noted contractions differ by that is error, at a point.
    fn noting_error(&self, point: &Point) -> f64 {
        let value = self.noting_column().map_or(0.0, |k| point.random[k]);
        component::noting_error(value)
    }

    /// What noted contractions are worth at a point, for a specimen whose contracted length is not declared; none where all are noted alike.
    pub(crate) fn noted_of(&self, point: &Point, specimen: usize) -> Option<Noted> {
        let mean = self.noted_mean?;
        let error = self.noting_error(point);
        (!self.data.contracted_is_declared(specimen)).then_some(Noted { mean, error })
    }

    /// Gain (as a factor), set length, zero, and what resting and contracted length are longer than noted, that act on reading `i`.
    fn random(&self, point: &Point, i: usize) -> [f64; 5] {
        let b = &point.random;
        let of = |node: usize, c: usize| self.tree.columns_of(node, c).map_or(0.0, |(k, _)| b[k]);
        let session = self.sessions[self.data.session[i]];
        let specimen = self.tree.parent(session);
        let of_campaign = |c: usize| {
            self.campaign_column(self.data.campaign[i], c)
                .map_or(0.0, |k| b[k])
        };
        [
            (1.0 + of(specimen, component::GAIN)) * (1.0 + of_campaign(component::CAMPAIGN_GAIN)),
            of(session, component::SET_LENGTH)
                + self.set_length_unit(i) * of(session, component::DECLARED_LENGTH),
            of(session, component::ZERO) + of_campaign(component::CAMPAIGN_ZERO),
            0.0,
            self.contraction_unit_mm(i)
                * self.noting_error(point)
                * self.noted_off[self.data.specimen[i]],
        ]
    }

    /// What the random contracted length of reading `i` is in units of, mm.
    fn contraction_unit_mm(&self, i: usize) -> f64 {
        1e3 * self.data.conditions[i].rest_length_m
    }

    /// What the random set length of reading `i` is in units of, mm.
    fn set_length_unit(&self, i: usize) -> f64 {
        let declared = self.data.set_length_sd_mm[self.data.session[i]];
        if declared.is_finite() { declared } else { 1.0 }
    }

    pub(super) fn value(&self, point: &Point, i: usize, at: &Conditions) -> f64 {
        let acting = self.acting(point, i);
        let terms: Vec<_> = acting.map(|(t, values, _)| (t, values)).collect();
        self.force(i, at, &point.coefficients, self.random(point, i), &terms)
    }

    /// The scale of the misfit of reading `i`, N: at the largest force it is that force, whatever the floor.
    pub(super) fn misfit_scale(&self, i: usize) -> f64 {
        match self.side[i] {
            Side::Slack => 0.0,
            Side::Pulls | Side::Corner | Side::AsPublished => {
                (self.reference[i].max(0.0) + self.floor) / (1.0 + self.floor / self.largest)
            }
        }
    }

    pub(super) fn derivatives<const N: usize>(
        &self,
        point: &Point,
        i: usize,
    ) -> (f64, [f64; N], Vec<f64>) {
        let at = &self.data.conditions[i];
        let mut coefficients = [Dual::<N>::constant(0.0); COEFFICIENTS];
        let known = point.coefficients.len();
        for (k, (slot, c)) in coefficients.iter_mut().zip(&point.coefficients).enumerate() {
            *slot = Dual::variable(*c, k);
        }
        let random = self.random(point, i);
        let gain = random[0];
        let random = std::array::from_fn(|k| Dual::variable(random[k], GAIN + k));
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
    pub(super) fn linearised<const N: usize>(&self, point: &Point) -> Linearised {
        let n = self.observed.len();
        let values: usize = point.terms.iter().map(|(_, v)| v.len()).sum();
        let mut linear = Linearised {
            predicted: Vec::with_capacity(n),
            by_coefficients: vec![vec![0.0; n]; point.coefficients.len()],
            by_terms: vec![vec![0.0; n]; values],
            random: Vec::with_capacity(n),
        };
        let rows: Vec<_> = (0..self.data.len())
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
        self.linearise_known(point, &mut linear);
        linear
    }

    /// Predictions at some readings, and their derivatives by the random effects.
    pub(super) fn rows<const N: usize>(
        &self,
        point: &Point,
        readings: &[usize],
    ) -> (Vec<f64>, Vec<Vec<f64>>) {
        let of = |i: &usize| {
            let (force, _, row) = self.derivatives::<N>(point, *i);
            (force, row)
        };
        readings.iter().map(of).unzip()
    }

    /// By what the force of reading `i` changes if resting and contracted length are off by a standard deviation; and, where nobody declares that of the
    /// contracted length, if it is longer by the resting length. In the corner to slackness, which a short actuator passes within that, a tangent would
    /// not tell: there it is half the difference between both ends, or where the domain of the law ends before one of them the difference to the other.
    fn by_lengths<const N: usize>(&self, point: &Point, i: usize, force: &Dual<N>) -> Vec<f64> {
        let specimen = self.data.specimen[i];
        let [rest, contracted] = self.specimen_lengths_sd_mm(specimen);
        let is_declared = self.data.contracted_is_declared(specimen);
        let unit = (!is_declared).then(|| self.contraction_unit_mm(i));
        if self.side[i] != Side::Corner {
            let [by_rest, by_contracted] = [REST, CONTRACTED].map(|k| force.gradient[k]);
            let beside = unit.map(|unit| by_contracted * unit);
            let noted = [by_rest * rest, by_contracted * contracted];
            return noted.into_iter().chain(beside).collect();
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
        let by_rest = between(at(-rest, 0.0), at(rest, 0.0));
        let by_contracted = |mm: f64| between(at(0.0, -mm), at(0.0, mm));
        let usual = settings::USUAL_CONTRACTION;
        let beside = unit.map(|unit| by_contracted(usual * unit) / usual);
        let noted = [by_rest, by_contracted(contracted)];
        noted.into_iter().chain(beside).collect()
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
        let of_campaign = [
            (component::CAMPAIGN_GAIN, by_gain * of_specimen),
            (component::CAMPAIGN_ZERO, force.gradient[ZERO]),
        ];
        row.resize(self.tree.width(0), 0.0);
        for (c, derivative) in of_campaign {
            if let Some(column) = self.campaign_column(self.data.campaign[i], c) {
                row[column] = derivative;
            }
        }
        if let Some(column) = self.noting_column() {
            let off = self.noted_off[self.data.specimen[i]];
            let (_, sd) = settings::NOTING_ERROR;
            row[column] = force.gradient[CONTRACTED] * self.contraction_unit_mm(i) * sd * off;
        }
        row.push(by_gain * gain / of_specimen);
        row.extend(self.by_lengths(point, i, force));
        row.push(force.gradient[LENGTH] * self.set_length_unit(i));
        row.push(force.gradient[ZERO]);
        let along = self.session_basis[i].iter().chain(&self.stroke_basis[i]);
        row.extend(along.map(|c| c * scale));
        row.extend_from_slice(&self.wander_basis[i]);
        row
    }
}
