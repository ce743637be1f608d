//! Columns that explain what no effect does.

use super::{Work, rms};
use crate::library::What;
use pipeline_findings::Unexplained;

impl Work<'_> {
    /// Columns that explain what no effect does.
    pub fn unexplained(&self) -> Vec<Unexplained> {
        let point = &self.found.model.point;
        let before: Vec<f64> = self
            .unconditional(&self.null.point, None)
            .iter()
            .zip(&self.data().force)
            .map(|(p, y)| y - p)
            .collect();
        let all = self.accepted();
        let origin = all.iter().filter(|t| self.problem.is_origin(**t, &all));
        // Of two offsets the first to come in has it: which one nobody can know.
        let mut constant = origin
            .filter_map(|t| self.found.model.values(*t)?.first().copied())
            .next();
        let accepted = self.found.accepted.iter();
        accepted
            .filter_map(|a| {
                let What::Column(column) = self.term(a.term).what else {
                    return None;
                };
                let values = point.terms.iter().find(|(t, _)| *t == a.term)?.1.clone();
                let share = rms(&self.change(a.term)) / rms(&before).max(f64::MIN_POSITIVE);
                let mut curve = column.curve(self.data(), [values[0], values[1]]);
                if !column.is_gain() {
                    let constant = constant.take().unwrap_or(0.0);
                    curve.iter_mut().for_each(|(_, y)| *y += constant);
                }
                Some(Unexplained {
                    column: column.name(self.data()),
                    shape: if column.is_gain() { "gain" } else { "offset" }.to_owned(),
                    p_familywise: a.p,
                    log_likelihood_gain: Some(a.gain),
                    share_of_variance: (share * share).min(1.0),
                    explained_as_well_by: a.names_instead(|term| Some(self.name(term))),
                    curve,
                })
            })
            .collect()
    }
}
