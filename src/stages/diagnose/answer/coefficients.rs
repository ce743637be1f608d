//! The coefficients of the law without and with the effects, beside the published ones.

use super::Work;
use pipeline_findings::CoefficientChange;
use pipeline_inference::fit::Free;
use pipeline_mechanics::models::{ForceModel, new};

impl Work<'_> {
    /// Coefficients of the law without and with the effects.
    pub fn coefficients(&self) -> Vec<CoefficientChange> {
        let model = &self.found.model;
        // A handful of specimens often has the likelihood's maximum where they do not differ: no coefficient is that sure.
        let covariance = model.covariance(&model.predictive(self.setting));
        let published = new::NewPublished.coefficients(self.diameter_mm);
        let list = self.base.coefficients.iter().enumerate();
        list.filter(|(_, c)| c.free)
            .map(|(k, c)| {
                let place = model.free.iter().position(|f| *f == Free::Coefficient(k));
                let error = place.map_or(0.0, |p| covariance.at(p, p).max(0.0).sqrt());
                let known = |symbol: &str| {
                    let found = published.iter().find(|p| p.symbol == symbol);
                    found.map(|p| p.value)
                };
                CoefficientChange {
                    name: c.name.clone(),
                    unit: c.unit.clone(),
                    before: self.null.point.coefficients[k],
                    after: model.point.coefficients[k],
                    standard_error: error,
                    published: match c.reciprocal_of {
                        Some(symbol) => known(symbol).map(|x| 1.0 / x),
                        None => known(&c.name),
                    },
                    at_bound: model.at_bound[k],
                    before_at_bound: self.null.at_bound[k],
                    left_out: !self.problem.base.coefficients[k].free,
                }
            })
            .collect()
    }
}
