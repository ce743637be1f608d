//! A reading as a linear function of what is not known, about a point: every column in units of independent standard normal numbers.

use super::{Held, MixedLaw, Slot, What};
use crate::base::Base;
use crate::data::{Data, contraction_620};
use crate::library::{bent, force_argument, pressure_argument};
use crate::problem::forward::{
    COEFFICIENTS, CONTRACTED, GAIN, LENGTH, REST, SLOTS, TERMS, ZERO, sensed,
};
use crate::problem::misfit::{
    SESSION_COSINES, STROKE_COSINES, at_pressure, common_basis, common_pairs,
};
use crate::problem::{Operators, component};
use crate::settings;
use crate::slack::{self, Shape, Side, Sided};
use pipeline_base::row::Row;
use pipeline_effects as effects;
use pipeline_effects::{Actuator, Applied, Conditions};
use pipeline_numerics::matrix::{dot, norm};
use pipeline_numerics::real::{Dual, Real};
use std::collections::BTreeMap;

/// Whose force is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whose {
    /// The actuator's own: without effects of the rig, zeros of its force channel and noise of its readings.
    Actuator,
    /// What the rig would read.
    Rig,
}

/// A state or reading, with all that the chain takes.
#[derive(Clone, Debug)]
pub(super) struct Reading {
    pub(super) at: Conditions,
    pub(super) side: Side,
    /// Place among the campaigns of the law.
    pub(super) campaign: Option<usize>,
    /// The terms that act: place in the model, the places of amplitude and shape among its values, the value of its column.
    terms: Vec<(usize, [usize; 2], f64)>,
    lengths: Lengths,
    whose: Whose,
}

/// How well lengths are known: standard deviations, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lengths {
    /// Of the set length of a session.
    pub(super) set_mm: f64,
    /// Of the muscle's own.
    pub(super) own: OwnLengths,
}

/// How well a muscle's own lengths are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OwnLengths {
    /// Standard deviations of resting and contracted length, mm.
    pub(super) sd_mm: [f64; 2],
    /// Whether somebody declared that of the contracted one.
    pub(super) contracted_is_declared: bool,
}

impl Reading {
    /// 1 where the sensor takes part, with its zero and its noise.
    fn sensed(&self) -> f64 {
        f64::from(u8::from(self.whose == Whose::Rig))
    }

    /// The same without a term.
    pub(super) fn without(&self, term: usize) -> Self {
        let mut without = self.clone();
        without.terms.retain(|(t, ..)| *t != term);
        without
    }

    /// How well its lengths are known: what random lengths are in units of.
    pub(super) fn lengths(&self) -> Lengths {
        self.lengths
    }
}

/// Gains and offsets about which a reading is linear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Own {
    /// Gain of the specimen.
    pub(super) gain: f64,
    /// Gain of a campaign that the law does not know.
    pub(super) campaign_gain: f64,
    /// Set length, mm.
    pub(super) length_mm: f64,
    /// Zero of the session and of a campaign that the law does not know, N.
    pub(super) zero_n: f64,
    /// What the contracted length is longer than others that are noted alike, mm.
    pub(super) contracted_mm: f64,
}

/// The columns of a reading.
#[derive(Clone, Debug)]
pub(super) struct View {
    /// The force at the point, N, with the mean of what all share.
    pub(super) force_n: f64,
    pub(super) parameters: Vec<f64>,
    /// Gain and zero of a campaign that the law does not know.
    pub(super) campaign: [f64; 2],
    /// Gain, resting and contracted length.
    pub(super) specimen: [f64; 3],
    /// Set length, zero, cosines of the misfit.
    pub(super) session: Vec<f64>,
    pub(super) stroke: Vec<f64>,
    /// Mean of what readings in the corner to slackness show, N.
    pub(super) shown_n: f64,
    pub(super) noise_n: f64,
}

/// Columns of a session, and of a stroke.
pub(super) const OF_SESSION: usize = 2 + SESSION_COSINES;
pub(super) const OF_STROKE: usize = STROKE_COSINES;

impl MixedLaw {
    /// Conditions of a steady reading without a history.
    pub(super) fn steady(
        &self,
        rest_length_m: f64,
        contracted_length_m: f64,
        length_m: f64,
        pressure_kpa: f64,
    ) -> Conditions {
        Conditions {
            diameter_mm: f64::from(self.diameter_mm),
            middle_rest_length_m: self.origins.middle_rest_length_m,
            campaign_time: self.origins.later(),
            ..Conditions::at(rest_length_m, contracted_length_m, length_m, pressure_kpa)
        }
    }

    /// A state in a session of its own, on the side where the muscle pulls.
    pub(super) fn state(
        &self,
        at: Conditions,
        whose: Whose,
        campaign: Option<usize>,
        lengths: Lengths,
    ) -> Reading {
        Reading {
            side: Side::Pulls,
            at,
            campaign,
            terms: self.acting(None, None, |held| {
                whose == Whose::Rig || held.is_of_actuator()
            }),
            lengths,
            whose,
        }
    }

    /// Whether how well the muscle's own lengths are known is mostly estimated: nobody declared it, and rounding is the smaller part of the contracted one.
    pub(super) fn estimates_lengths(&self, reading: &Reading) -> bool {
        let beside = 1e3 * reading.at.rest_length_m * self.sd.contraction;
        !reading.lengths.own.contracted_is_declared && beside > self.sd.contracted_length_mm
    }

    /// How well the lengths of a muscle are known where nobody says it.
    pub(super) fn usual_lengths(&self, rest_length_m: f64) -> OwnLengths {
        let beside = 1e3 * rest_length_m * self.sd.contraction;
        OwnLengths {
            sd_mm: [
                self.sd.rest_length_mm,
                libm::hypot(self.sd.contracted_length_mm, beside),
            ],
            contracted_is_declared: false,
        }
    }

    /// The column of the share of noted contractions that is error.
    pub(super) fn noting_column() -> usize {
        common_pairs().count()
    }

    /// The share of what noted contractions differ by that is error.
    pub fn noting_error(&self) -> f64 {
        component::noting_error(self.common_mean[Self::noting_column()])
    }

    /// Standard deviation of that share.
    pub fn noting_error_sd(&self) -> f64 {
        let column = Self::noting_column();
        let first = column * (column + 1) / 2;
        settings::NOTING_ERROR.1 * norm(&self.root[first..=first + column])
    }

    /// By how many mm the contracted length of a reading's muscle is longer than noted if what is noted were all error.
    pub(super) fn noted_off_mm(&self, reading: &Reading) -> f64 {
        let noted = contraction_620(&reading.at);
        match self.noted_contraction {
            Some(mean) if !reading.lengths.own.contracted_is_declared => {
                1e3 * reading.at.rest_length_m * (noted - mean)
            }
            _ => 0.0,
        }
    }

    /// Readings that somebody made.
    pub(super) fn readings(&self, data: &Data, rows: &[&Row]) -> Vec<Reading> {
        let shape = Shape(self.shape);
        let of = |i: usize| {
            let (at, row) = (data.conditions[i], rows[data.place[i]]);
            let or = |declared: f64, usual: f64| {
                if declared.is_finite() {
                    declared
                } else {
                    usual
                }
            };
            let usual = self.usual_lengths(at.rest_length_m).sd_mm;
            let declared_mm = self.sd.declared_factor * data.set_length_sd_mm[data.session[i]];
            let [rest, contracted] = data.specimen_lengths_sd_mm[data.specimen[i]];
            Reading {
                at,
                side: slack::side(
                    data.force[i],
                    settings::NEAR_SLACK,
                    self.largest_n,
                    &at,
                    &shape,
                ),
                campaign: self.campaigns.iter().position(|c| *c == row.campaign),
                terms: self.acting(Some(&row.session), Some(&row.extras), |_| true),
                lengths: Lengths {
                    set_mm: or(declared_mm, self.sd.set_length_mm),
                    own: OwnLengths {
                        sd_mm: [or(rest, usual[0]), or(contracted, usual[1])],
                        contracted_is_declared: contracted.is_finite(),
                    },
                },
                whose: Whose::Rig,
            }
        };
        (0..data.len()).map(of).collect()
    }

    fn acting(
        &self,
        session: Option<&str>,
        extras: Option<&BTreeMap<String, f64>>,
        wanted: impl Fn(&Held) -> bool,
    ) -> Vec<(usize, [usize; 2], f64)> {
        let terms = self.terms.iter().enumerate();
        let of = |(t, held): (usize, &Held)| {
            let group = held.amplitude(session)?;
            let (places, x) = match &held.what {
                What::Effect { id, form } => {
                    let (effect, form) = registered(id, form)?;
                    let has_shape = effects::all()[effect].forms()[form].shape.is_some();
                    let shape = held.values.len() - usize::from(has_shape);
                    ([group, shape], 0.0)
                }
                What::Column { name, scale, .. } => {
                    let value = extras.and_then(|all| all.get(name)).copied();
                    // Where nobody logged it, it is what it was on the average.
                    let x = value.map_or(0.0, |x| (x - scale.0) / scale.1);
                    ([2 * group, 2 * group + 1], x)
                }
                What::Force | What::Pressure => ([2 * group, 2 * group + 1], 0.0),
            };
            Some((t, places, x))
        };
        terms
            .filter(|(_, held)| wanted(held))
            .filter_map(of)
            .collect()
    }

    /// The columns of a reading about a point.
    pub(super) fn view(&self, base: &Base, reading: &Reading, own: Own) -> View {
        let force = self.chain(base, reading, own, reading.side);
        let shown = match reading.side {
            Side::Corner => self.sd.corner_n[slack::band(&reading.at, &Shape(self.shape))],
            _ => (0.0, self.noise_n(reading.campaign)),
        };
        self.columns(base, reading, own, &force, shown)
    }

    /// The columns of a state that nobody has read, where the law pulls: where it has no force it goes on below zero, and what it may be above that shows in
    /// its interval.
    pub(super) fn view_of_state(&self, base: &Base, state: &Reading, own: Own) -> View {
        let noise_n = state.sensed() * self.noise_n(state.campaign);
        let force = self.chain(base, state, own, state.side);
        let mut view = self.columns(base, state, own, &force, (0.0, noise_n));
        // From 1 where the law has no force to 0 on both sides.
        let width_n = settings::NEAR_SLACK * self.largest_n;
        let nearness = (1.0 - (view.force_n / width_n).abs()).max(0.0);
        view.stroke.push(nearness * self.in_corner_n(state));
        view
    }

    /// What a rig reads of a slack muscle: mean and standard deviation, N; nothing of the muscle itself.
    pub(super) fn slack(&self, base: &Base, state: &Reading, own: Own, view: &View) -> (f64, f64) {
        let zeros = [view.session[1], view.campaign[1], view.noise_n];
        (
            self.chain(base, state, own, Side::Slack).value,
            norm(&zeros),
        )
    }

    /// What readings in the corner to slackness show beside a rounded law and noise, N: beside the plain law it is no mean, but a misfit. The most of any
    /// part of the corner.
    fn in_corner_n(&self, state: &Reading) -> f64 {
        let noise_n = self.noise_n(state.campaign);
        let parts = self.sd.corner_n.iter();
        let squares = parts.map(|(mean, sd)| mean * mean + sd * sd - noise_n * noise_n);
        squares.fold(0.0, f64::max).sqrt()
    }

    /// Force with its derivatives by coefficients, random effects and terms.
    fn chain(&self, base: &Base, reading: &Reading, own: Own, side: Side) -> Dual<SLOTS> {
        let mut coefficients = [Dual::<SLOTS>::constant(0.0); COEFFICIENTS];
        let known = self.coefficients.len();
        for (k, (slot, c)) in coefficients.iter_mut().zip(&self.coefficients).enumerate() {
            *slot = Dual::variable(*c, k);
        }
        let gain =
            (1.0 + own.gain) * (1.0 + own.campaign_gain) * (1.0 + self.campaign_known(reading)[0]);
        let zero_n = reading.sensed() * (own.zero_n + self.campaign_known(reading)[1]);
        let random = [
            Dual::variable(gain, GAIN),
            Dual::variable(own.length_mm, LENGTH),
            Dual::variable(zero_n, ZERO),
            Dual::variable(0.0, REST),
            Dual::variable(
                own.contracted_mm + self.noting_error() * self.noted_off_mm(reading),
                CONTRACTED,
            ),
        ];
        let values = |k: usize, (t, places, _): &(usize, [usize; 2], f64)| {
            let values = &self.terms[*t].values;
            let slot = TERMS + 2 * k;
            let of = |j: usize| values.get(places[j]).copied().unwrap_or(0.0);
            [Dual::variable(of(0), slot), Dual::variable(of(1), slot + 1)]
        };
        let law = Sided { base, side };
        let terms = reading.terms.iter().enumerate();
        let of_library = terms.clone().filter_map(|(k, term)| {
            let What::Effect { id, form } = &self.terms[term.0].what else {
                return None;
            };
            let (effect, form) = registered(id, form)?;
            Some(Applied {
                effect,
                form,
                parameters: values(k, term),
            })
        });
        let (at, operators) = (&reading.at, Operators::registered());
        let mut force = sensed(
            &law,
            &operators,
            at,
            &coefficients[..known],
            random,
            of_library,
        );
        for (k, term) in terms {
            let (x, is_gain) = match &self.terms[term.0].what {
                What::Effect { .. } => continue,
                What::Column { is_gain, .. } => (Dual::constant(term.2), *is_gain),
                What::Force => (force_argument(force), true),
                What::Pressure => (Dual::constant(pressure_argument(at)), true),
            };
            force = bent(force, values(k, term), x, is_gain);
        }
        force
    }

    /// Mean gain and zero of the campaign of a reading, if the law knows it.
    fn campaign_known(&self, reading: &Reading) -> [f64; 2] {
        let columns = self.campaign_columns(reading.campaign);
        columns.map_or([0.0; 2], |all| all.map(|k| self.common_mean[k]))
    }

    /// The columns of gain and zero of a campaign of a pool.
    fn campaign_columns(&self, campaign: Option<usize>) -> Option<[usize; 2]> {
        let place = campaign.filter(|_| self.is_pooled())?;
        let count = self.campaigns.len();
        let first = self.common() - 2 * count;
        Some([first + place, first + count + place])
    }

    fn columns(
        &self,
        base: &Base,
        reading: &Reading,
        own: Own,
        force: &Dual<SLOTS>,
        (shown_n, noise_n): (f64, f64),
    ) -> View {
        let (scale, mut row) = self.common_columns(base, reading);
        row.resize(self.common(), 0.0);
        // What acts through the forward model is in its force.
        let common = dot(&row, &self.common_mean);
        let (_, error_sd) = settings::NOTING_ERROR;
        row[Self::noting_column()] =
            force.gradient[CONTRACTED] * error_sd * self.noted_off_mm(reading);
        let by_gain = force.gradient[GAIN];
        let by_zero = reading.sensed() * force.gradient[ZERO];
        let [known_gain, _] = self.campaign_known(reading);
        let gain = (1.0 + own.gain) * (1.0 + own.campaign_gain) * (1.0 + known_gain);
        if let Some([gains, zeros]) = self.campaign_columns(reading.campaign) {
            row[gains] = by_gain * gain / (1.0 + known_gain);
            row[zeros] = by_zero;
        }
        for slot in &self.free {
            row.push(match slot {
                Slot::Coefficient(k) => force.gradient[*k],
                Slot::Value(t, v) => {
                    let acting = reading.terms.iter().enumerate();
                    let found = acting
                        .filter(|(_, term)| term.0 == *t)
                        .find_map(|(k, term)| {
                            let place = term.1.iter().position(|p| p == v)?;
                            Some(force.gradient[TERMS + 2 * k + place])
                        });
                    found.unwrap_or(0.0)
                }
            });
        }
        let of_campaign = match (self.is_pooled(), reading.campaign) {
            (true, None) => [
                by_gain * gain / (1.0 + own.campaign_gain) * self.sd.campaign_gain,
                by_zero * self.sd.campaign_zero_n,
            ],
            _ => [0.0; 2],
        };
        let mut session = vec![
            force.gradient[LENGTH] * reading.lengths.set_mm,
            by_zero * self.sd.zero_n,
        ];
        let misfit = scale * self.sd.session_misfit;
        let along = at_pressure(&reading.at, SESSION_COSINES, settings::PRESSURE_LENGTH_KPA);
        session.extend(along.iter().map(|c| c * misfit));
        let stroke = self.sd.stroke_misfit.map_or_else(Vec::new, |sd| {
            let along = at_pressure(&reading.at, STROKE_COSINES, settings::STROKE_LENGTH_KPA);
            along.iter().map(|c| c * scale * sd).collect()
        });
        View {
            force_n: force.value + common,
            parameters: self.standardised(&row),
            campaign: of_campaign,
            specimen: [
                by_gain * gain / (1.0 + own.gain) * self.sd.gain,
                force.gradient[REST] * reading.lengths.own.sd_mm[0],
                force.gradient[CONTRACTED] * reading.lengths.own.sd_mm[1],
            ],
            session,
            stroke,
            shown_n,
            noise_n,
        }
    }

    /// Columns of common columns and parameters, in units of independent standard normal numbers.
    pub(super) fn standardised(&self, row: &[f64]) -> Vec<f64> {
        let mut columns = vec![0.0; row.len()];
        let mut line = 0;
        for (k, x) in row.iter().enumerate() {
            let of_line = columns.iter_mut().zip(&self.root[line..=line + k]);
            of_line.for_each(|(slot, root)| *slot += x * root);
            line += k + 1;
        }
        columns
    }

    /// Scale of the misfit, N, and the columns of the common one.
    fn common_columns(&self, base: &Base, reading: &Reading) -> (f64, Vec<f64>) {
        let mut coefficients = [Dual::<COEFFICIENTS>::constant(0.0); COEFFICIENTS];
        let known = self.beside.coefficients.len();
        for (k, (slot, c)) in coefficients
            .iter_mut()
            .zip(&self.beside.coefficients)
            .enumerate()
        {
            *slot = Dual::variable(*c, k);
        }
        let law = Sided {
            base,
            side: reading.side,
        };
        let at = &reading.at;
        let [pressure, length] = [at.pressure_kpa, at.length_m].map(Dual::constant);
        let reference = law.force(&coefficients[..known], pressure, length, at);
        let scale = match reading.side {
            Side::Slack => 0.0,
            _ => (reference.value.max(0.0) + self.floor_n) / (1.0 + self.floor_n / self.largest_n),
        };
        let cosines = common_basis(at).into_iter().zip(&self.beside.weights);
        let of = |(cosine, weights): (f64, &Vec<f64>)| {
            let free = weights.iter().zip(&self.beside.free);
            let law: f64 = free.map(|(w, k)| w * reference.gradient[*k]).sum();
            if scale > 0.0 {
                scale * cosine - law
            } else {
                0.0
            }
        };
        (scale, cosines.map(of).collect())
    }
}

/// Places of an effect's form in the registry; none of one that another version of the program has.
pub(super) fn registered(id: &str, form: &str) -> Option<(usize, usize)> {
    let effect = effects::index(id)?;
    let forms = effects::all()[effect].forms();
    Some((effect, forms.iter().position(|f| f.name == form)?))
}
