//! A shuffled copy of a column, which the search must never choose.

use super::{Data, Extra};
use pipeline_base::random::Stream;
use pipeline_numerics::statistics::mean;

/// Name of the shuffled copy of a column, which must never be chosen.
pub const PLACEBO: &str = "placebo";
impl Data {
    /// The same with a shuffled copy of a column, which must never be chosen: the first extra column (the pressure where there is none). What
    /// differs mostly between sessions is permuted among them, what differs mostly within them within the logs.
    pub fn with_placebo(mut self, seed: u64) -> Self {
        let mut stream = Stream::new(seed, &["placebo"]);
        let copied = self.extras.iter().find(|e| !e.names_groups).cloned();
        let mut extra = copied.unwrap_or_else(|| Extra {
            name: String::new(),
            values: standardised(self.conditions.iter().map(|c| c.pressure_kpa).collect()),
            scale: (0.0, 1.0),
            constant_in_sessions: false,
            names_groups: false,
            words: Vec::new(),
        });
        extra.name = PLACEBO.to_owned();
        let by_session = members(&self.session, self.sessions.len());
        extra.values = if between_share(&extra.values, &by_session) > 0.5 {
            permuted(&extra.values, &by_session, &mut stream)
        } else {
            let logs = self.log.iter().copied().max().map_or(0, |k| k + 1);
            let mut values = extra.values;
            for places in members(&self.log, logs) {
                let mut of: Vec<f64> = places.iter().map(|i| values[*i]).collect();
                shuffle(&mut of, &mut stream);
                for (i, x) in places.into_iter().zip(of) {
                    values[i] = x;
                }
            }
            values
        };
        self.extras.push(extra);
        self
    }
}

/// The places of each group.
fn members(group: &[usize], groups: usize) -> Vec<Vec<usize>> {
    let mut members = vec![Vec::new(); groups];
    for (i, g) in group.iter().enumerate() {
        members[*g].push(i);
    }
    members
}

/// Share of the variance of standardised values that is between groups.
fn between_share(values: &[f64], groups: &[Vec<usize>]) -> f64 {
    let square = |places: &Vec<usize>| {
        let sum: f64 = places.iter().map(|i| values[*i]).sum();
        sum * sum / places.len().max(1) as f64
    };
    groups.iter().map(square).sum::<f64>() / values.len().max(1) as f64
}

/// Every group with the values of another, one after the other and again from the first.
fn permuted(values: &[f64], groups: &[Vec<usize>], stream: &mut Stream) -> Vec<f64> {
    let present: Vec<&Vec<usize>> = groups.iter().filter(|g| !g.is_empty()).collect();
    let mut order: Vec<usize> = (0..present.len()).collect();
    for k in (1..order.len()).rev() {
        let other = stream.below(k + 1);
        order.swap(k, other);
    }
    let mut out = values.to_vec();
    for (to, from) in present.iter().zip(&order) {
        let source = present[*from];
        for (k, i) in to.iter().enumerate() {
            out[*i] = values[source[k % source.len()]];
        }
    }
    out
}

fn shuffle(values: &mut [f64], stream: &mut Stream) {
    for k in (1..values.len()).rev() {
        let other = stream.below(k + 1);
        values.swap(k, other);
    }
}

/// Less the mean, by the standard deviation.
fn standardised(mut values: Vec<f64>) -> Vec<f64> {
    let middle = mean(&values);
    let n = values.len() as f64;
    let variance = values
        .iter()
        .map(|x| (x - middle) * (x - middle))
        .sum::<f64>()
        / n;
    let sd = variance.sqrt().max(f64::MIN_POSITIVE);
    for x in &mut values {
        *x = (*x - middle) / sd;
    }
    values
}
