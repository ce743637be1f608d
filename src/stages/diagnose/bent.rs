//! A size that is not one number: how the predictions change where the size of an effect bends along the effect's own argument
//! ([`pipeline_effects::Argument`]).
//!
//! The effect changes reading i by s_i = phi dh_i/dphi. Where its size is phi (1 + g(x_i)), x the argument over the range of the readings on which
//! the effect acts and g a smooth function, it changes it by s_i (1 + g(x_i)) as well: columns s_i cos_k(x_i).

use super::library::Term;
use super::settings;
use super::smooth::cosines;
use pipeline_effects as effects;
use pipeline_effects::{Argument, Conditions};
use pipeline_inference::decisions::FEWEST;

/// Cosines of g, the constant among them.
pub const COSINES: usize = 5;

/// The columns of one effect.
pub struct Bent {
    /// Along what the size may bend.
    pub argument: Argument,
    /// Ends of the scaled argument.
    pub range: (f64, f64),
    /// One entry a reading; the constant is left out, because phi is free beside g.
    pub columns: Vec<Vec<f64>>,
}

impl Bent {
    /// Of an effect with these amplitudes, each with the derivatives of all predictions by it, over the readings that take part. None where the
    /// effect has no argument, or the readings have hardly a value of it.
    pub fn new(
        term: &Term,
        conditions: &[Conditions],
        by_amplitudes: &[(f64, &[f64])],
        predicted: &[f64],
        takes_part: impl Fn(usize) -> bool,
    ) -> Option<Self> {
        let (effect, form) = term.effect()?;
        let argument = effects::all()[effect].argument(form)?;
        let change = |i: usize| -> f64 { by_amplitudes.iter().map(|(a, x)| a * x[i]).sum() };
        let change: Vec<f64> = (0..conditions.len()).map(change).collect();
        let of = |i: usize| argument.scaled(argument.of(&conditions[i], predicted[i]));
        let acts = |i: &usize| change[*i] != 0.0 && takes_part(*i);
        let mut along: Vec<f64> = (0..change.len()).filter(acts).map(of).collect();
        along.sort_by(f64::total_cmp);
        let range = (*along.first()?, *along.last()?);
        along.dedup();
        if along.len() < FEWEST || !(range.1 - range.0).is_finite() {
            return None;
        }
        let mut bent = Self {
            argument,
            range,
            columns: vec![vec![0.0; predicted.len()]; COSINES - 1],
        };
        for (i, s) in change.iter().enumerate().filter(|(_, s)| **s != 0.0) {
            let basis = bent.basis(of(i));
            for (column, c) in bent.columns.iter_mut().zip(basis) {
                column[i] = s * c;
            }
        }
        Some(bent)
    }

    /// The cosines at a scaled argument, without the constant.
    pub fn basis(&self, x: f64) -> Vec<f64> {
        let share = ((x - self.range.0) / (self.range.1 - self.range.0)).clamp(0.0, 1.0);
        cosines(COSINES, share, settings::FORM_LENGTH).split_off(1)
    }
}
