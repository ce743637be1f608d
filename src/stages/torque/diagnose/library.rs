//! The terms of a joint: every form of every effect that means anything for it, and smooth functions of every column. A function of the torque
//! itself is not among them: at one pressure it is a function of the angle once more, and mimics whatever yields.

use super::data::{Data, PLACEBO};
use super::terms::{ALL, SIZES, Term as Form};
use pipeline_effects::JointNeed;
use pipeline_inference::problem;
use pipeline_numerics::real::Real;

/// What is added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// A form of an effect, by its place in [`ALL`].
    Effect(usize),
    /// M (1 + a x + b x^2), x a column by its place in the data; without b where its square is no other than the angle.
    Gain(usize),
    /// M + S (a x + b x^2), S the largest torque.
    Offset(usize),
}

/// A correction is small beside the law: else it would be the law.
const LARGEST_CORRECTION: f64 = 0.5;

/// The terms that the search tries: their number follows from the design alone.
pub fn terms(data: &Data) -> Vec<What> {
    let has = |form: &Form| match form.needs {
        None => true,
        Some(JointNeed::BothSenses) => data.turns_both_ways(),
        Some(part) => data.readings.iter().all(|r| r.joint.has(part)),
    };
    let forms = ALL.iter().enumerate().filter(|(_, f)| has(f));
    let mut terms: Vec<What> = forms.map(|(k, _)| What::Effect(k)).collect();
    for (k, column) in data.columns.iter().enumerate() {
        terms.push(What::Gain(k));
        if !column.of_the_law {
            terms.push(What::Offset(k));
        }
    }
    terms
}

impl What {
    /// The form, of an effect.
    pub fn form(self) -> Option<&'static Form> {
        match self {
            What::Effect(k) => Some(&ALL[k]),
            What::Gain(_) | What::Offset(_) => None,
        }
    }

    /// Number of values, all of them amplitudes.
    pub fn values(self, data: &Data) -> usize {
        match self {
            What::Effect(k) => ALL[k].symbols.len(),
            What::Gain(k) | What::Offset(k) => 1 + usize::from(data.columns[k].curved),
        }
    }

    /// Id of the effect, or name of the column.
    pub fn name<'d>(self, data: &'d Data) -> &'d str {
        match self {
            What::Effect(k) => ALL[k].id,
            What::Gain(k) | What::Offset(k) => &data.columns[k].name,
        }
    }

    /// The term as the engine sees it: forms of one effect, and what depends on one column, are alternatives.
    pub fn for_engine(self, data: &Data) -> problem::Term {
        let kind = match self {
            What::Effect(k) => ALL.iter().position(|f| f.id == ALL[k].id).unwrap_or(k),
            What::Gain(k) | What::Offset(k) => ALL.len() + k,
        };
        let correction = (-LARGEST_CORRECTION, LARGEST_CORRECTION);
        problem::Term {
            kind,
            named: self.form().is_some(),
            whole: true,
            decoy: self.name(data) == PLACEBO,
            bounds: vec![self.form().map_or(correction, |f| f.bounds); self.values(data)],
            amplitudes: self.values(data),
            usual: self.form().map_or(f64::INFINITY, |f| f.usual),
        }
    }

    /// Adds the values of an effect to all sizes.
    pub fn add<R: Real>(self, values: [R; 2], sizes: &mut [R; SIZES]) {
        if let Some(form) = self.form() {
            for (k, value) in values.iter().take(form.symbols.len()).enumerate() {
                sizes[form.first + k] = sizes[form.first + k] + *value;
            }
        }
    }

    /// The torque of row `r` with a dependence on a column.
    pub fn apply<R: Real>(self, torque: R, [a, b]: [R; 2], data: &Data, r: usize) -> R {
        let shape = |x: f64| (b * x + a) * x;
        match self {
            What::Effect(_) => torque,
            What::Gain(k) => torque * (shape(data.columns[k].values[r]) + 1.0),
            What::Offset(k) => torque + shape(data.columns[k].values[r]) * data.largest_nm,
        }
    }

    /// A dependence over the range of its column: value of the column, share of the torque or N.m.
    pub fn curve(self, data: &Data, values: &[f64]) -> Vec<(f64, f64)> {
        let (column, unit) = match self {
            What::Effect(_) => return Vec::new(),
            What::Gain(k) => (&data.columns[k], 1.0),
            What::Offset(k) => (&data.columns[k], data.largest_nm),
        };
        let shape = |x: f64| values.iter().rev().fold(0.0, |sum, a| (sum + a) * x);
        let low = column.values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = column
            .values
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        (0..=20)
            .map(|k| low + f64::from(k) / 20.0 * (high - low))
            .map(|x| (column.middle + column.sd * x, unit * shape(x)))
            .collect()
    }
}
