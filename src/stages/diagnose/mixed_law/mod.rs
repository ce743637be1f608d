//! What the mixed model of a campaign says of readings that are still to be made: of a muscle of which nothing is known but its lengths, or of one
//! of which some readings are.
//!
//! A [`MixedLaw`] is the part of a fitted model that this takes, as plain numbers for a file: coefficients, effects, the common misfit, the
//! joint covariance of all these, and the standard deviations of what groups have of their own. It is made once, by the search, and asked as often
//! as somebody likes, without the readings that it came from.
//!
//! ```text
//! F = h(x; theta + dtheta, phi + dphi, u, D, d_s, z_s) + m(x) + m_s(P) + e
//! ```
//! with everything that is not known a normal number: coefficients, effects, common misfit and the share of noted contractions that is error about their
//! estimates with their joint covariance; lengths D of the muscle about those noted, as far as these are worth something; gain u of the muscle, set
//! length d_s, zero z_s and misfit m_s of a session, gain and zero of a campaign of its own (of a pool), and noise, about 0. Its variance at a state is the
//! sum of their parts ([`Parts`]). Readings of the muscle change mean and covariance ([`Muscle`]).
//!
//! | file | idea |
//! |---|---|
//! | `made` | the law of a search |
//! | `view` | a reading as a linear function of what is not known |
//! | `muscle` | a muscle, without readings or with some, and what is asked of it |
//! | `readings` | what its readings say of everything that is not known |
//! | `parts` | the variance of a reading by its sources, and the degrees of freedom of it |
//!
//! # What is predicted
//! A steady reading in one more session, of no direction and no history: effects that need one are 0 there. Those that the search found of the rig
//! are left out, or put in where somebody wants what the rig would read ([`Whose`]). A value for some sessions only says nothing of others, but
//! for one from a session on.
//!
//! A muscle does not push: where the law goes below zero it is slack, and the force, with each end of its interval, is the larger one of the law's and
//! that of a slack muscle. Near the onset of the force, what readings there show beside the law is one more part of the misfit.

mod made;
mod muscle;
mod parts;
mod readings;
#[cfg(test)]
mod tests;
mod view;

pub use muscle::{Estimate, Muscle, Next};
pub use parts::{Forecast, Parts};
/// A muscle that differs by more standard deviations from those of the law contradicts it.
pub use pipeline_inference::decisions::STANDS_OUT;
pub use view::Whose;

use crate::base::Base;
use crate::data::Origins;
use crate::problem::MOST_TERMS;
use crate::problem::misfit::common_pairs;
use crate::slack::{self, Shape};
use pipeline_effects::Subject;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What a fitted model says of further readings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MixedLaw {
    /// Id of the campaign, or of the pool.
    pub campaign: String,
    /// Nominal diameter, mm.
    pub diameter_mm: u32,
    /// Campaigns of which the readings are.
    pub campaigns: Vec<String>,
    /// Specimens that took part; of a pool with the id of their campaign.
    pub specimens: Vec<String>,
    /// Resting and contracted length of each, m.
    pub lengths_m: Vec<[f64; 2]>,
    /// Mean of the contractions at 620 kPa that were noted, where nobody declares how well contracted lengths are known; none where all are declared or noted
    /// alike.
    pub noted_contraction: Option<f64>,
    /// Number of sessions that took part.
    pub sessions: usize,
    /// Number of readings that took part.
    pub readings: usize,
    /// Root mean square error on specimens that took no part, N; none where nothing was held out.
    pub unseen_n: Option<f64>,
    /// l_0, m.
    pub cap_length_m: f64,
    /// c0, c1 and c2 of the law that tells where an actuator is slack.
    pub shape: [f64; 3],
    /// b1, 1/b2, c0, c1, c2.
    pub coefficients: Vec<f64>,
    /// The effects and columns in the model, in their order.
    pub terms: Vec<Held>,
    /// What conditions are counted from.
    pub origins: Origins,
    /// Largest force, N.
    pub largest_n: f64,
    /// Floor of the scale of the misfit, N.
    pub floor_n: f64,
    /// What the common misfit is beside.
    pub beside: Beside,
    /// The parameters, behind the columns that all readings share.
    pub free: Vec<Slot>,
    /// Mean of the columns that all readings share: cosines of the common misfit, the share of noted contractions that is error, then gains and zeros of
    /// the campaigns.
    pub common_mean: Vec<f64>,
    /// Lower triangle, row by row, of a square root of the joint covariance of these columns and the parameters.
    pub root: Vec<f64>,
    /// How groups and readings scatter.
    pub sd: Sizes,
}

/// A parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Slot {
    /// A coefficient of the law.
    Coefficient(usize),
    /// A value of a term: its place in the model, its number.
    Value(usize, usize),
}

/// The law by whose freedom the common misfit is restricted: what other coefficients would do is no misfit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Beside {
    /// All coefficients at which the scale of the misfit is taken.
    pub coefficients: Vec<f64>,
    /// Places of those that are free.
    pub free: Vec<usize>,
    /// For every cosine, by how much each free coefficient would move to do the same.
    pub weights: Vec<Vec<f64>>,
}

/// How groups and readings scatter: standard deviations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sizes {
    /// Gain of a specimen, relative.
    pub gain: f64,
    /// Resting length of a specimen, mm.
    pub rest_length_mm: f64,
    /// Contracted length of a specimen, mm: as declared, or of its rounding.
    pub contracted_length_mm: f64,
    /// The same beside that, where it is not declared, share of the resting length.
    pub contraction: f64,
    /// Set length of a session, mm.
    pub set_length_mm: f64,
    /// Whether that is declared, not estimated.
    pub set_length_declared: bool,
    /// By what declared standard deviations of set lengths are multiplied: 1, or what was estimated where readings contradict them.
    pub declared_factor: f64,
    /// Zero of the force of a session, N.
    pub zero_n: f64,
    /// Misfit of a session along the pressure, share of the force.
    pub session_misfit: f64,
    /// The same of a stroke; none where strokes have none of their own.
    pub stroke_misfit: Option<f64>,
    /// Gain of a campaign of a pool, relative.
    pub campaign_gain: f64,
    /// Zero of the force of a campaign of a pool, N.
    pub campaign_zero_n: f64,
    /// Noise of the readings of each campaign, N.
    pub noise_n: Vec<f64>,
    /// Mean and standard deviation of what readings in each part of the corner to slackness show beside the law with a rounded corner, N.
    pub corner_n: Vec<(f64, f64)>,
}

/// An effect or column in the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Held {
    /// What it is.
    pub what: What,
    /// Effects that these readings cannot tell from it, itself included; empty of a column.
    pub class: Vec<String>,
    /// Amplitudes, then the shape if there is one.
    pub values: Vec<f64>,
    /// On which sessions it acts.
    pub acts: Acts,
}

/// What a term is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum What {
    /// A form of an effect, by their names.
    Effect {
        /// Id.
        id: String,
        /// Name of the form.
        form: String,
    },
    /// A dependence on a column of the logs, less its mean and over its standard deviation.
    Column {
        /// Name.
        name: String,
        /// As a share of the force, or else in N.
        is_gain: bool,
        /// Mean and standard deviation.
        scale: (f64, f64),
    },
    /// The force channel is not straight.
    Force,
    /// The pressure channel is not straight.
    Pressure,
}

/// On which sessions a term acts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Acts {
    /// All.
    All,
    /// Some, with the number of the amplitude of each; and on sessions to come, where it is from a session on.
    Sessions {
        /// By session of the law; none where it does not act.
        amplitude: BTreeMap<String, Option<usize>>,
        /// On sessions to come.
        later: bool,
    },
}

impl Held {
    /// Whether it goes with the muscle to another machine.
    pub fn is_of_actuator(&self) -> bool {
        match &self.what {
            What::Effect { id, .. } => of_actuator(id),
            _ => false,
        }
    }

    /// Id of the effect, or name of the column.
    pub fn name(&self) -> &str {
        match &self.what {
            What::Effect { id, .. } => id,
            What::Column { name, .. } => name,
            What::Force => "force_n",
            What::Pressure => "pressure_kpa",
        }
    }

    /// Whether this version of the program has it, with so many values.
    fn is_known(&self) -> bool {
        let values = self.values.len();
        match &self.what {
            What::Effect { id, form } => view::registered(id, form).is_some_and(|(e, f)| {
                let has_shape = pipeline_effects::all()[e].forms()[f].shape.is_some();
                let amplitudes = values.saturating_sub(usize::from(has_shape));
                amplitudes == 1 || (amplitudes > 1 && self.acts != Acts::All)
            }),
            _ => values > 1,
        }
    }

    /// The amplitude that acts on a session; none of one that it does not act on, or of which nobody knows.
    fn amplitude(&self, session: Option<&str>) -> Option<usize> {
        match &self.acts {
            Acts::All => Some(0),
            Acts::Sessions { amplitude, later } => match session.and_then(|s| amplitude.get(s)) {
                Some(place) => *place,
                None => later.then_some(0),
            },
        }
    }
}

/// Lengths that differ by less are one, noted twice, m.
pub const SAME_LENGTH_M: f64 = 1e-6;

/// Number of coefficients of the law.
const LAW: usize = 5;

/// An effect that is not in the registry is of the rig.
fn of_actuator(id: &str) -> bool {
    let all = pipeline_effects::all();
    pipeline_effects::index(id).is_some_and(|k| all[k].subject() == Subject::Actuator)
}

impl MixedLaw {
    /// The law for evaluation.
    fn base(&self) -> Base {
        Base::evaluated(self.diameter_mm, self.cap_length_m, Shape(self.shape))
    }

    /// Number of the columns that all readings share.
    fn common(&self) -> usize {
        self.common_mean.len()
    }

    /// Number of all parameters: these columns and the free ones.
    fn parameters(&self) -> usize {
        self.common() + self.free.len()
    }

    /// Whether a specimen of this id and these lengths, m, is one of its own.
    pub(crate) fn is_of(&self, id: &str, lengths_m: [f64; 2]) -> bool {
        let place = self.specimens.iter().position(|s| s == id);
        let own = place.and_then(|k| self.lengths_m.get(k));
        let is_same = |(a, b): (&f64, &f64)| (a - b).abs() < SAME_LENGTH_M;
        own.is_some_and(|own| own.iter().zip(&lengths_m).all(is_same))
    }

    /// Whether it is one that this version of the program writes: its lists fit to one another.
    pub fn is_sound(&self) -> bool {
        let cosines = common_pairs().count();
        let of_campaigns = if self.is_pooled() {
            2 * self.campaigns.len()
        } else {
            0
        };
        let (beside, all) = (&self.beside, self.parameters());
        let is_law = |c: &[f64]| c.len() == LAW && c.iter().all(|x| x.is_finite());
        let is_free = |slot: &Slot| match slot {
            Slot::Coefficient(k) => *k < LAW,
            Slot::Value(t, v) => self.terms.get(*t).is_some_and(|h| *v < h.values.len()),
        };
        let fits = |w: &Vec<f64>| w.len() == beside.free.len();
        let sd = &self.sd;
        let sizes = [
            sd.gain,
            sd.rest_length_mm,
            sd.contracted_length_mm,
            sd.contraction,
            sd.set_length_mm,
            sd.declared_factor,
            sd.zero_n,
            sd.session_misfit,
            sd.stroke_misfit.unwrap_or(0.0),
            sd.campaign_gain,
            sd.campaign_zero_n,
        ];
        is_law(&self.coefficients)
            && is_law(&beside.coefficients)
            && beside.free.iter().all(|k| *k < LAW)
            && beside.weights.len() == cosines
            && beside.weights.iter().all(fits)
            && self.common_mean.len() == cosines + 1 + of_campaigns
            && self.noted_contraction.is_none_or(f64::is_finite)
            && self.root.len() == all * (all + 1) / 2
            && self.free.iter().all(is_free)
            && self.terms.iter().all(Held::is_known)
            && self.lengths_m.len() == self.specimens.len()
            && !self.specimens.is_empty()
            && sizes.iter().all(|x| x.is_finite() && *x >= 0.0)
            && !self.campaigns.is_empty()
            && sd.noise_n.len() == self.campaigns.len()
            && sd.noise_n.iter().all(|x| *x > 0.0)
            && sd.corner_n.len() == slack::BANDS
            && sd.corner_n.iter().all(|(_, sd)| *sd > 0.0)
            && self.terms.len() <= MOST_TERMS
            && self.largest_n > 0.0
    }

    /// The contraction at 620 kPa that a muscle is expected to have, of which so much is noted and not declared.
    pub fn expected_contraction(&self, noted: f64) -> f64 {
        let mean = self.noted_contraction.unwrap_or(noted);
        noted - self.noting_error() * (noted - mean)
    }

    /// Whether coefficients of its law are fitted, not taken as published.
    pub fn has_fitted_law(&self) -> bool {
        self.free.iter().any(|s| matches!(s, Slot::Coefficient(_)))
    }

    /// Whether it is of a pool.
    pub(crate) fn is_pooled(&self) -> bool {
        self.campaigns.len() > 1
    }

    /// Standard deviation of the noise of a reading of a campaign, of all together where it is none of them, N.
    fn noise_n(&self, campaign: Option<usize>) -> f64 {
        let all = &self.sd.noise_n;
        campaign
            .and_then(|c| all.get(c).copied())
            .unwrap_or_else(|| {
                let squares: f64 = all.iter().map(|sd| sd * sd).sum();
                (squares / all.len().max(1) as f64).sqrt()
            })
    }
}
