//! The prediction of a group of which nothing is known: errors, standard deviations, joint density, variance by source.

use super::{Asked, Unseen};
use crate::system::{Factor, Likelihood};

/// The readings of one unseen group.
#[derive(Clone, Debug)]
pub struct Predicted {
    /// Their places among all readings.
    pub places: Vec<usize>,
    /// Measured less expected.
    pub errors: Vec<f64>,
    /// Standard deviation of each.
    pub sd: Vec<f64>,
    /// Joint log density of all of them.
    pub log_density: f64,
    /// Mean variance by source: one entry a component, then estimation (fixed effects and the root), then noise.
    pub sources: Vec<f64>,
}

impl Unseen<'_> {
    /// The prediction of some of the readings below a node that took no part: those of one quantity, where a problem has several. Errors and their
    /// standard deviations are those of somebody who knows nothing of the group; the joint density is Gaussian about the mode of its random effects,
    /// as the fit has it of the groups that take part: at 0 the model of a short group whose length is far off says little of it.
    pub fn predict_where(&self, node: usize, keep: impl Fn(usize) -> bool) -> Predicted {
        let places = self.readings(node, keep);
        let errors: Vec<f64> = places.iter().map(|&i| self.error(i)).collect();
        let variances = self.as_shown();
        let all: Vec<usize> = (0..places.len()).collect();
        let asked = Asked {
            places: &places,
            known: &all,
            variances: &variances,
        };
        let design = self.mode(&asked).1;
        let gram = design.gram();
        let log_density =
            Factor::new(&design.tree, &gram, &variances).log_likelihood(Likelihood::Full);
        let design = self.design(&places, &errors, |k| &self.model.design.z[places[k]]);
        let count = variances.components.len();
        let mut sources = vec![0.0; count + 1];
        let mut sd = Vec::with_capacity(places.len());
        for (row, &i) in design.z.iter().zip(&places) {
            let node = design.node[sd.len()];
            let components = design.tree.path_components(node);
            let noise = variances.noise[self.model.design.class[i]];
            let mut total = noise * noise;
            sources[count] += noise * noise;
            for (z, &c) in row.iter().zip(components) {
                let variance = z * z * variances.components[c] * variances.components[c];
                sources[c] += variance;
                total += variance;
            }
            sd.push(total.sqrt());
        }
        for s in &mut sources {
            *s /= places.len().max(1) as f64;
        }
        Predicted {
            places,
            errors,
            sd,
            log_density,
            sources,
        }
    }

    /// Variance of a reading in groups that were never seen: noise and all random effects below the root.
    pub fn variance_in_new_groups(&self, i: usize) -> f64 {
        let design = &self.model.design;
        let tree = &design.tree;
        let noise = self.shown.noise[design.class[i]];
        let components = tree.path_components(design.node[i]).iter();
        let below = components.zip(&design.z[i]).skip(tree.width(0));
        let below = below.map(|(c, z)| z * self.variances.components[*c]);
        noise * noise + below.map(|x| x * x).sum::<f64>()
    }
}
