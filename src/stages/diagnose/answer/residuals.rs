//! What is left of every reading, with the columns that were looked at, for the figures.

use super::Work;
use crate::data::{Data, PLACEBO};
use pipeline_effects as effects;
use pipeline_findings::Residuals;
use pipeline_inference::query;

impl Work<'_> {
    /// Residuals for the figures.
    pub fn residuals(&self) -> Residuals {
        let data = self.data();
        let mut conditional = query::conditional(&self.found.model);
        conditional.truncate(data.len());
        Residuals {
            session: data
                .session
                .iter()
                .map(|s| data.sessions[*s].clone())
                .collect(),
            specimen: data
                .specimen
                .iter()
                .map(|k| data.specimens[*k].clone())
                .collect(),
            before: self.left_as_unseen(self.null),
            after: self.left_as_unseen(&self.found.model),
            conditional,
            unseen_before: self.held.left[0].clone(),
            unseen: self.held.left[1].clone(),
            predicted: self.unconditional(&self.null.point, None),
            columns: columns(data),
            steps: self.steps(),
            ..Residuals::default()
        }
    }
}

/// eps*: the contraction as a share of the largest.
pub fn relative_contraction(at: &effects::Conditions) -> f64 {
    (at.rest_length_m - at.length_m) / (at.rest_length_m - at.contracted_length_m)
}

/// The columns that were looked at, one value a reading.
fn columns(data: &Data) -> Vec<(String, Vec<f64>)> {
    let of = |f: &dyn Fn(&effects::Conditions) -> f64| -> Vec<f64> {
        data.conditions.iter().map(f).collect()
    };
    let mut columns = vec![
        ("pressure_kpa".to_owned(), of(&|c| c.pressure_kpa)),
        ("contraction_rel".to_owned(), of(&relative_contraction)),
        ("rest_length_m".to_owned(), of(&|c| c.rest_length_m)),
        ("direction".to_owned(), of(&|c| c.direction)),
        ("time_s".to_owned(), of(&|c| c.log_time_s)),
        ("since_step_s".to_owned(), of(&|c| c.since_step_s)),
        ("pressure_rate".to_owned(), of(&|c| c.rate_kpa_per_s)),
        ("temperature_c".to_owned(), of(&|c| c.temperature_c)),
        ("cycles".to_owned(), of(&|c| c.cycles)),
    ];
    let extras = || data.extras.iter().filter(|e| e.name != PLACEBO);
    // The temperature, as it was logged.
    columns.retain(|(name, _)| extras().all(|e| e.name != *name));
    columns.extend(extras().map(|e| {
        let values = e.values.iter().map(|x| e.scale.0 + e.scale.1 * x);
        (e.name.clone(), values.collect())
    }));
    columns.retain(|(_, v)| v.iter().any(|x| (x - v[0]).abs() > 1e-9));
    columns
}
