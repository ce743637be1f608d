//! A model that is handed over: law, domain, and what has to be said of it.

use crate::domain::{Answer, Domain, Fitted, State};
use crate::law::Law;
use pipeline_numerics::distributions::student_t_quantile;

/// A coefficient under the name that papers give it.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// Symbol.
    pub symbol: String,
    /// Value.
    pub value: f64,
    /// Unit; "1" for a pure number.
    pub unit: String,
    /// 95% interval, where there is one.
    pub interval: Option<(f64, f64)>,
}

/// How a reading of a muscle that was not measured scatters about the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Standard deviation of the gains of specimens, as a fraction of the force.
    pub between: f64,
    /// Standard deviation of everything else of a reading, N.
    pub within_n: f64,
    /// What that is.
    pub within_of: &'static str,
    /// Student's t of a 95% interval.
    pub t: f64,
    /// Degrees of freedom of it.
    pub freedom: f64,
}

impl Spread {
    /// The scatter with so many degrees of freedom.
    pub fn new(between: f64, within_n: f64, within_of: &'static str, freedom: f64) -> Self {
        Self {
            between,
            within_n,
            within_of,
            t: student_t_quantile(0.975, freedom),
            freedom,
        }
    }
}

/// Whose the box of a model is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxOf {
    /// The readings to which it was fitted here.
    Readings,
    /// That for which its source publishes the coefficients: nothing was fitted here.
    Source,
}

/// A model.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Name for people.
    pub title: String,
    /// Nominal diameter, mm.
    pub diameter_mm: u32,
    /// The law.
    pub law: Law,
    /// Its box, and the continuation.
    pub domain: Domain,
    /// Whose box that is.
    pub box_of: BoxOf,
    /// An eps_620 for examples: the middle of the box.
    pub usual_contraction_620: f64,
    /// The law as the paper writes it, a line each.
    pub equations: Vec<&'static str>,
    /// Coefficients.
    pub coefficients: Vec<Named>,
    /// Scatter of muscles; none for a published model, or where there were too few specimens.
    pub spread: Option<Spread>,
    /// Where it comes from: sentences.
    pub provenance: Vec<String>,
    /// Which effects of the loop it has, and which it leaves out and why: sentences.
    pub effects: Vec<String>,
}

impl Model {
    /// The function that every language has.
    pub fn force(&self, at: &State) -> Answer {
        self.domain.force(&self.law, at)
    }

    /// The box.
    pub fn fitted(&self) -> &Fitted {
        &self.domain.fitted
    }
}
