//! What new readings show of themselves beside a fitted model: those of a class of noise that is held while models are fitted scatter as they do.

use super::{Fitted, Setting};
use crate::system::{Factor, Likelihood, Variances};
use crate::variance::{Effort, Maximiser, Prior, Scale};
use std::collections::BTreeSet;

/// What new readings show of themselves, by class of noise.
pub struct Shown {
    /// Mean beside the prediction.
    pub means: Vec<f64>,
    /// Standard deviation about it, with that of an estimated mean.
    pub noise: Vec<f64>,
}

impl Fitted {
    /// What new readings show beside variances of the model: those of a class that is held ([`Prior::Held`]) what such readings do, all others their noise
    /// and no more.
    pub fn shown(&self, setting: &Setting, variances: &Variances) -> Shown {
        let classes = setting.problem.noise();
        let is_held = |class: usize| matches!(classes[class].prior, Prior::Held(_));
        let mut means = vec![0.0; classes.len()];
        if !(0..classes.len()).any(is_held) {
            let noise = variances.noise.clone();
            return Shown { means, noise };
        }
        let left = self.left(variances);
        let mut of_mean = vec![1.0; classes.len()];
        for (class, mean) in means.iter_mut().enumerate().filter(|(c, _)| is_held(*c)) {
            let of =
                |i: &usize| self.design.class[*i] == class && setting.active[self.design.node[*i]];
            let of: Vec<usize> = (0..self.design.len()).filter(of).collect();
            // Readings of one group are alike: as many means as there are groups were averaged.
            let groups: BTreeSet<usize> = of.iter().map(|i| self.design.node[*i]).collect();
            let count = groups.len() as f64;
            if count > 1.0 {
                *mean = of.iter().map(|i| left[*i]).sum::<f64>() / of.len() as f64;
                of_mean[class] = ((count + 1.0) / (count - 1.0)).sqrt();
            }
        }
        let readings = self.design.y.iter().zip(&self.design.class);
        let about: Vec<f64> = readings.map(|(y, class)| y - means[*class]).collect();
        let gram = self.design.with_response_of(&self.gram, &[], &about);
        let at = |scale: Scale, sd: &f64| Scale {
            prior: match scale.prior {
                Prior::Held(sd) => Prior::Away(sd),
                _ => Prior::Fixed(*sd),
            },
            ..scale
        };
        let components = setting.scales().into_iter().zip(&variances.components);
        let components: Vec<Scale> = components.map(|(scale, sd)| at(scale, sd)).collect();
        let of_classes = classes.iter().zip(&variances.noise);
        let noise: Vec<Scale> = of_classes.map(|(scale, sd)| at(*scale, sd)).collect();
        let maximiser = Maximiser {
            noise: &noise,
            ..setting.maximiser(&components, Likelihood::Restricted)
        };
        let starts = std::slice::from_ref(variances);
        let best = maximiser.best(&gram, starts, Effort::FULL);
        let noise = best.variances.noise.iter().zip(&of_mean);
        Shown {
            means,
            noise: noise.map(|(sd, more)| sd * more).collect(),
        }
    }

    /// What fixed and random effects leave of every reading at some variances; groups that take no part have none of their own.
    fn left(&self, variances: &Variances) -> Vec<f64> {
        let tree = &self.design.tree;
        let estimates = Factor::new(tree, &self.gram, variances).estimates();
        let paths: Vec<Vec<usize>> = (0..tree.len()).map(|n| tree.path_numbers(n)).collect();
        let of = |i: usize| {
            let path = &paths[self.design.node[i]];
            let random = path.iter().zip(&self.design.z[i]);
            let random: f64 = random.map(|(k, z)| z * estimates.random[*k]).sum();
            let fixed = self.design.x.iter().zip(&estimates.fixed);
            let fixed: f64 = fixed.map(|(x, b)| x[i] * b).sum();
            self.design.y[i] - random - fixed
        };
        (0..self.design.len()).map(of).collect()
    }
}
