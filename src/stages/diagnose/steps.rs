//! What is left of the readings as the effects come in one after the other.

use super::answer::Work;
use super::library::What;
use pipeline_inference::search::Accepted;

impl Work<'_> {
    /// The model with the first effect, with the first two, and so on, each fitted again: name of what came in last, and what is left of every reading
    /// as on unseen specimens, N. The effects come in the order of the findings, then the columns that explain what no effect does.
    pub fn steps(&self) -> Vec<(String, Vec<f64>)> {
        let order = self.order();
        let model = &self.found.model;
        let step = |k: usize| {
            let name = self.name(order[k]);
            if k + 1 == order.len() {
                return (name, self.left_as_unseen(model));
            }
            let mut from = model.point.clone();
            from.terms.retain(|(t, _)| order[..=k].contains(t));
            let fitted = self
                .setting
                .fit(&from, std::slice::from_ref(&model.variances));
            (name, self.left_as_unseen(&fitted))
        };
        (0..order.len()).map(step).collect()
    }

    /// The accepted terms in the order of the findings. A constant beside an offset that goes with a column is part of that dependence, and comes in
    /// with the last step.
    fn order(&self) -> Vec<usize> {
        let all: Vec<usize> = self.found.accepted.iter().map(|a| a.term).collect();
        let accepted = self.found.accepted.iter();
        let named = accepted.filter(|a| !self.problem.is_origin(a.term, &all));
        let is_effect = |a: &&Accepted| matches!(self.term(a.term).what, What::Effect { .. });
        let (mut effects, columns): (Vec<&Accepted>, Vec<&Accepted>) = named.partition(is_effect);
        effects.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        effects.into_iter().chain(columns).map(|a| a.term).collect()
    }
}
