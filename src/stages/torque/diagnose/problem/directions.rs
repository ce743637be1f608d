//! What each term of the library would change, at small amplitudes and at large ones.

use super::TorqueProblem;
use pipeline_diagnose::problem::{LARGE_CHANGES, SAME_DIRECTION, cosine};
use pipeline_inference::problem::{Direction, Point, Problem};

impl TorqueProblem<'_> {
    /// Changes of all readings by a term, per unit of its amplitudes: at small amplitudes; for a term with one, also at amplitudes that change
    /// the torque visibly, where these have another form.
    pub(super) fn shown_by(&self, point: &Point, base: &[f64], t: usize) -> Vec<Direction> {
        let engine = &self.terms[t];
        let (low, high) = engine.bounds[0];
        let small = 1e-4 * high;
        let count = engine.amplitudes;
        let direction = |columns| Direction {
            term: t,
            start: vec![1.0; count],
            columns,
        };
        let change = |k: usize, amplitude: f64| {
            let mut values = vec![0.0; count];
            values[k] = amplitude;
            self.change(point, base, t, values, amplitude)
        };
        if count > 1 {
            return vec![direction((0..count).map(|k| change(k, small)).collect())];
        }
        let near = change(0, small);
        let size = self.rms_of_torques(&near);
        let mut directions = vec![direction(vec![near])];
        if size > 0.0 && size.is_finite() {
            let target = LARGE_CHANGES[0] * self.rms_of_torques(base);
            let large = (target / size).min(0.5 * high);
            let mut far = vec![large];
            if low < 0.0 {
                far.push((-large).max(0.5 * low));
            }
            for amplitude in far {
                let column = change(0, amplitude);
                let alike = |d: &Direction| cosine(&d.columns[0], &column) >= SAME_DIRECTION;
                if !directions.iter().any(alike) {
                    directions.push(direction(vec![column]));
                }
            }
        }
        directions
    }

    fn change(
        &self,
        point: &Point,
        base: &[f64],
        t: usize,
        values: Vec<f64>,
        unit: f64,
    ) -> Vec<f64> {
        let mut with = point.clone();
        with.terms.push((t, values));
        let predicted = self.predict(&with);
        let pairs = predicted.iter().zip(base);
        pairs.map(|(a, b)| (a - b) / unit).collect()
    }

    fn rms_of_torques(&self, values: &[f64]) -> f64 {
        let torques = (0..values.len()).filter(|i| self.is_torque(*i));
        let squares: Vec<f64> = torques.map(|i| values[i] * values[i]).collect();
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
    }
}
