//! A joint as a problem for the engine: groups, forward model with derivatives, nuisance components.
//!
//! Torque, length and arm of a row follow from one balance ([`super::operator`]). M_i = M(theta_i, P_i; phi, d_t, g_k) + z_t + misfit + noise, where d_t is
//! the mounting of the test (an offset of the length, mm), z_t the zero of its torque and g_k the gain of the actuator. The law of force is the
//! published one: a knee has too few pressures and lengths to determine it, so there are no free coefficients; what it is off by is a random
//! effect of the joint, one of each coefficient but its scale. The misfit is proportional to a frozen torque with a floor, and absent where the
//! actuator is slack: one along the angle and the pressure that all tests share, with a constant (the law may be wrong by a factor on all actuators),
//! and one of each test along the angle. How the joint turned before the first reading of a test nobody knows: friction there has a value of its own.
//!
//! Lengths and arms taken by hand are further readings of the same geometry, in mm, each with its noise and with a bias of its test: where
//! attachments are elsewhere than drawn, torque, length and arm say so together.
//!
//! | file | idea |
//! |---|---|
//! | [`component`], [`class`] | the nuisance components and the classes of noise, with what is plausible of each |
//! | `forward` | what a row shows, with its derivatives |
//! | `directions` | what each term of the library would change |

pub mod class;
pub mod component;
mod directions;
mod forward;
#[cfg(test)]
mod tests;

use super::data::{Data, Reading};
use super::library::What;
use super::settings;
use super::terms::LAW_COEFFICIENTS;
use class::noise;
use component::components;
use forward::Three;
use pipeline_diagnose::settings as shared;
use pipeline_diagnose::slack::Side;
use pipeline_diagnose::smooth::cosines;
use pipeline_inference::fit::Setting;
use pipeline_inference::problem::Term as EngineTerm;
use pipeline_inference::problem::{Coefficient, Component, Direction, Linearised, Point, Problem};
use pipeline_inference::tree::{Block, Tree};
use pipeline_inference::variance::{Prior, Scale};
use pipeline_mechanics::models::P_620_KPA;
use rayon::prelude::*;

/// Most terms in one model.
pub const MOST_TERMS: usize = 4;

/// Cosines of the misfits along the angle.
const COSINES: usize = 8;

/// Cosines of the common misfit along the pressure; a constant is among those along the angle.
const ALONG_PRESSURE: usize = 3;

/// What is read in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Torque,
    Length,
    Arm,
}

/// A joint.
pub struct TorqueProblem<'a> {
    /// The rows.
    pub data: &'a Data<'a>,
    /// The terms of the library.
    pub library: &'a [What],
    tree: Tree,
    /// Node of each actuator that has rows.
    pub actuators: Vec<Option<usize>>,
    /// Node of each test that has rows.
    pub tests: Vec<Option<usize>>,
    /// Row of each reading of the engine.
    pub row: Vec<usize>,
    quantity: Vec<Quantity>,
    node: Vec<usize>,
    class: Vec<usize>,
    observed: Vec<f64>,
    components: Vec<Component>,
    noise: Vec<Scale>,
    terms: Vec<EngineTerm>,
    /// Cosines of the misfits along the angle, row by row.
    basis: Vec<Vec<f64>>,
    /// Cosines of the common misfit along the pressure, row by row.
    along_pressure: Vec<Vec<f64>>,
    /// The torque by which the misfit is scaled, N.m, row by row: that of a fit without misfit, and no more than the largest that was measured. It is
    /// frozen, so that all models have one covariance for it; it is not the measured one, because a misfit in proportion to that could take
    /// the place of the law.
    reference: Vec<f64>,
}

impl<'a> TorqueProblem<'a> {
    /// The problem of some rows.
    pub fn new(data: &'a Data<'a>, library: &'a [What]) -> Self {
        let block = |component, columns| Block { component, columns };
        let mut tree = Tree::new(vec![
            block(component::COMMON_MISFIT, COSINES + ALONG_PRESSURE),
            block(component::LAW, LAW_COEFFICIENTS.len()),
        ]);
        let mut actuators = vec![None; data.actuators.len()];
        let mut tests = vec![None; data.tests.len()];
        let (mut row, mut quantity, mut node) = (Vec::new(), Vec::new(), Vec::new());
        let (mut class, mut observed) = (Vec::new(), Vec::new());
        for (k, r) in data.readings.iter().enumerate() {
            let above = *actuators[r.actuator]
                .get_or_insert_with(|| tree.add(0, vec![block(component::GAIN, 1)]));
            let own = *tests[r.test].get_or_insert_with(|| {
                let blocks = vec![
                    block(component::MOUNTING, 1),
                    block(component::ZERO, 1),
                    block(component::TEST_MISFIT, COSINES),
                    block(component::LENGTH_BIAS, 1),
                    block(component::ARM_BIAS, 1),
                    block(component::UNKNOWN_SENSE, 1),
                ];
                tree.add(above, blocks)
            });
            let of_torque = match r.side {
                Side::Corner => class::CORNER,
                Side::Pulls | Side::Slack | Side::AsPublished => class::TORQUE,
            };
            let list = [
                (Quantity::Torque, of_torque, Some(r.torque_nm)),
                (
                    Quantity::Length,
                    class::LENGTH,
                    r.by_hand.length_m.map(|l| 1e3 * l),
                ),
                (Quantity::Arm, class::ARM, r.by_hand.arm_m.map(|a| 1e3 * a)),
            ];
            for (what, of, value) in list {
                let Some(value) = value.filter(|v| v.is_finite()) else {
                    continue;
                };
                row.push(k);
                quantity.push(what);
                node.push(own);
                class.push(of);
                observed.push(value);
            }
        }
        let counts = |c: usize| class.iter().filter(|k| **k == c).count();
        let noise = noise(data, counts(class::LENGTH), counts(class::ARM));
        let present = |nodes: &[Option<usize>]| nodes.iter().flatten().count();
        Self {
            components: components(data, present(&actuators), present(&tests)),
            noise,
            basis: bases(data),
            along_pressure: along_pressure(data),
            reference: vec![0.0; data.readings.len()],
            terms: library.iter().map(|t| t.for_engine(data)).collect(),
            data,
            library,
            tree,
            actuators,
            tests,
            row,
            quantity,
            node,
            class,
            observed,
        }
    }

    /// The problem of which the fit is plain least squares on the torques, as in the papers: no random effects, no misfit, nothing by hand, one
    /// noise; `data` are as published ([`Data::as_published`]).
    pub fn least_squares(data: &'a Data<'a>, library: &'a [What]) -> Self {
        let mut plain = Self::new(data, library);
        for component in &mut plain.components {
            component.scale.prior = Prior::Fixed(0.0);
        }
        let torques: Vec<usize> = (0..plain.row.len())
            .filter(|i| plain.is_torque(*i))
            .collect();
        let take = |of: &[usize]| -> Vec<usize> { torques.iter().map(|i| of[*i]).collect() };
        plain.row = take(&plain.row);
        plain.node = take(&plain.node);
        plain.class = vec![class::TORQUE; torques.len()];
        plain.quantity = vec![Quantity::Torque; torques.len()];
        plain.observed = torques.iter().map(|i| plain.observed[*i]).collect();
        plain
    }

    /// The same with the misfit scaled by the predictions of a fit without it.
    pub fn with_reference(mut self) -> Self {
        let setting = Setting {
            misfit_factor: 0.0,
            ..Setting::new(&self).usual()
        };
        let fit = setting.fit(&self.start(), &setting.fresh()[..1]);
        let predicted = self.predict(&fit.point);
        for (i, p) in predicted.iter().enumerate() {
            if self.quantity[i] == Quantity::Torque {
                self.reference[self.row[i]] = p.abs().min(self.data.largest_nm);
            }
        }
        self
    }

    /// Whether a reading is a torque.
    pub fn is_torque(&self, i: usize) -> bool {
        self.quantity[i] == Quantity::Torque
    }
}

/// Cosines along the angle over the range of the readings.
fn bases(data: &Data) -> Vec<Vec<f64>> {
    let angles: Vec<f64> = data.readings.iter().map(|r| r.at.angle_rad).collect();
    let low = angles.iter().copied().fold(f64::INFINITY, f64::min);
    let high = angles.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let range = (high - low).max(settings::ANGLE_LENGTH_RAD);
    let length = settings::ANGLE_LENGTH_RAD / range;
    angles
        .iter()
        .map(|a| cosines(COSINES, (a - low) / range, length))
        .collect()
}

/// Cosines along the pressure without the constant.
fn along_pressure(data: &Data) -> Vec<Vec<f64>> {
    let of = |r: &Reading| {
        let share = r.at.pressure_kpa / P_620_KPA;
        cosines(ALONG_PRESSURE + 1, share, shared::SURFACE_LENGTH).split_off(1)
    };
    data.readings.iter().map(of).collect()
}

impl Problem for TorqueProblem<'_> {
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
        &[]
    }
    fn terms(&self) -> &[EngineTerm] {
        &self.terms
    }

    fn predict(&self, point: &Point) -> Vec<f64> {
        let rows: Vec<Three<f64>> = (0..self.data.readings.len())
            .map(|r| self.values(point, r))
            .collect();
        let readings = self.row.iter().zip(&self.quantity);
        readings.map(|(r, what)| rows[*r][*what as usize]).collect()
    }

    fn linearise(&self, point: &Point) -> Linearised {
        self.linearised(point)
    }

    fn directions(&self, point: &Point) -> Vec<Direction> {
        let base = self.predict(point);
        let free = |t: &usize| !point.terms.iter().any(|(u, _)| u == t);
        let terms: Vec<usize> = (0..self.library.len()).filter(free).collect();
        let all = terms.par_iter().map(|t| self.shown_by(point, &base, *t));
        all.collect::<Vec<_>>().into_iter().flatten().collect()
    }

    fn directions_of(&self, point: &Point, term: usize) -> Vec<Direction> {
        self.shown_by(point, &self.predict(point), term)
    }
}
