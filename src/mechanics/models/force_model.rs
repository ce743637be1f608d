//! The interface of a force model: who it is, where it holds, what its coefficients are, what force it predicts.

use super::gate::Reference;
use super::{Prediction, Reason, State};

/// Where a model was published.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Citation {
    /// Authors and year, as a table row prints them.
    pub short: &'static str,
    /// Title, journal or manufacturer's document.
    pub full: &'static str,
    /// Numbers of the equations or tables used.
    pub equations: &'static str,
}

/// A published coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficient {
    /// Symbol in the paper.
    pub symbol: &'static str,
    /// Value in `unit`.
    pub value: f64,
    /// Unit; `"1"` for a pure number.
    pub unit: &'static str,
    /// Published 95% confidence interval (low, high), where there is one.
    pub interval_95: Option<(f64, f64)>,
}

impl Coefficient {
    /// A coefficient published without an interval.
    pub const fn new(symbol: &'static str, value: f64, unit: &'static str) -> Self {
        Self {
            symbol,
            value,
            unit,
            interval_95: None,
        }
    }

    /// The same coefficient with its published 95% confidence interval.
    pub const fn with_interval(mut self, low: f64, high: f64) -> Self {
        self.interval_95 = Some((low, high));
        self
    }
}

/// The values of a list of coefficients, in its order.
pub fn values<const N: usize>(list: &[Coefficient; N]) -> [f64; N] {
    list.map(|coefficient| coefficient.value)
}

/// A published model of the static force of a braided pneumatic actuator.
pub trait ForceModel: Send + Sync {
    /// Unique name in tables, file names and configuration; never changes.
    fn id(&self) -> &'static str;
    /// Name for a reader.
    fn title(&self) -> &'static str;
    /// Where it was published.
    fn source(&self) -> Citation;
    /// Nominal diameters with published coefficients, mm.
    fn diameters(&self) -> &'static [u32];
    /// Where the model holds, in words.
    fn domain(&self) -> &'static str;
    /// The published coefficients for a nominal diameter in mm; empty for a diameter that is not covered.
    fn coefficients(&self, diameter_mm: u32) -> &'static [Coefficient];
    /// What its authors published and it has to reproduce ([`super::gate`]); empty where they published no force.
    fn references(&self) -> Vec<Reference> {
        Vec::new()
    }
    /// The force at a state without defect whose nominal diameter, given in mm, is covered. Callers use
    /// [`ForceModel::predict`], which sees to both.
    fn evaluate(&self, diameter_mm: u32, state: &State) -> Prediction;

    /// The force at any state: never negative, never NaN, never a panic; what cannot be answered comes with its reason.
    fn predict(&self, state: &State) -> Prediction {
        if let Some(defect) = state.defect() {
            return Prediction::outside(Reason::NotAState(defect));
        }
        let covered = self.diameters();
        let same = |&&d: &&u32| (f64::from(d) - state.diameter_mm).abs() < 0.5;
        match covered.iter().find(same) {
            Some(&diameter) => self.evaluate(diameter, state),
            None => Prediction::outside(Reason::DiameterNotCovered {
                diameter_mm: state.diameter_mm,
                covered,
            }),
        }
    }
}
