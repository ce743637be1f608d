//! Small questions to a fitted model, whatever the problem is about.

use crate::decisions::FALL_95;
use crate::fit::{Fitted, Setting};
use crate::search::Found;
use crate::statistic::deviate;
use crate::system::{Factor, Likelihood, Variances};
use crate::variance::{Effort, Prior};

/// Step of the standard deviation by which the ends are looked for, as a factor.
const STEP: f64 = 1.05;
/// Standard deviations below this share of their usual size are none, and beyond this multiple unbounded.
const RANGE: (f64, f64) = (1e-3, 100.0);

/// Multiples of a known standard deviation that are tried in its place.
const LARGER: [f64; 6] = [1.5, 2.0, 3.0, 5.0, 10.0, 20.0];

/// An estimate with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Value.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
}

/// Where the restricted likelihood has fallen to the ends of an interval on either side of a component's standard deviation, the other variances
/// as they are; no upper end where it does not fall.
pub fn interval(
    setting: &Setting,
    model: &Fitted,
    variances: &Variances,
    component: usize,
) -> (f64, Option<f64>) {
    let scales = setting.scales();
    let maximiser = setting.maximiser(&scales, Likelihood::Restricted);
    let at = |sd: f64| {
        let mut v = variances.clone();
        v.components[component] = sd;
        maximiser.value(&model.gram, &v)
    };
    let (sd, usual) = (variances.components[component], scales[component].usual);
    let (least, most) = (RANGE.0 * usual, RANGE.1 * usual);
    let best = at(sd);
    let mut high = sd.max(least);
    while at(high) > best - FALL_95 && high < most {
        high *= STEP;
    }
    let mut low = sd;
    while low > least && at(low) > best - FALL_95 {
        low /= STEP;
    }
    (
        if low > least { low } else { 0.0 },
        (high < most).then_some(high),
    )
}

/// Whether a standard deviation that is taken as known is too small: the restricted likelihood rises by [`FALL_95`] for a larger one.
pub fn is_too_small(
    setting: &Setting,
    model: &Fitted,
    variances: &Variances,
    component: usize,
) -> bool {
    let scales = setting.scales();
    let maximiser = setting.maximiser(&scales, Likelihood::Restricted);
    let at = |factor: f64| {
        let mut v = variances.clone();
        v.components[component] *= factor;
        maximiser.value(&model.gram, &v)
    };
    let known = at(1.0);
    LARGER.iter().any(|f| at(*f) > known + FALL_95)
}

/// Gain in restricted log-likelihood over a model without a component, the other variances estimated again.
pub fn gain_of(setting: &Setting, model: &Fitted, component: usize) -> f64 {
    let mut scales = setting.scales();
    // A component that has faded to nothing in the full likelihood does not grow by itself.
    let starts = [model.variances.clone(), setting.widened(&model.variances)];
    let with = setting.maximiser(&scales, Likelihood::Restricted);
    let best = with.best(&model.gram, &starts, Effort::FULL).log_likelihood;
    scales[component].prior = Prior::Fixed(0.0);
    let starts = starts.map(|mut from| {
        from.components[component] = 0.0;
        from
    });
    let without = setting.maximiser(&scales, Likelihood::Restricted);
    let rest = without.best(&model.gram, &starts, Effort::FULL);
    (best - rest.log_likelihood).max(0.0)
}

/// Accepted terms that would not stand with the prior of the misfit halved or doubled.
pub fn sensitive(setting: &Setting, found: &Found) -> Vec<usize> {
    let mut sensitive = Vec::new();
    for factor in [0.5, 2.0] {
        let other = Setting {
            misfit_factor: factor,
            ..setting.clone()
        };
        let starts = [found.model.variances.clone()];
        let model = other.fit(&found.model.point, &starts);
        for a in &found.accepted {
            let mut from = model.point.clone();
            from.terms.retain(|(t, _)| *t != a.term);
            let without = other.fit(&from, &starts);
            let ratio = 2.0 * (model.log_likelihood - without.log_likelihood);
            let amplitudes = setting.problem.terms()[a.term].amplitudes;
            if deviate(ratio, amplitudes) < a.critical && !sensitive.contains(&a.term) {
                sensitive.push(a.term);
            }
        }
    }
    sensitive
}

/// Each group's own estimate of a term's value, its shape and the variances as found: `group` numbers the groups of the readings from 0; readings
/// behind its end are of none.
/// None of a group whose readings do not show it, or show it so little that it comes out beyond what is possible.
pub fn by_group(
    setting: &Setting,
    model: &Fitted,
    term: usize,
    value: usize,
    group: &[usize],
) -> Vec<Option<Estimate>> {
    let groups = group.iter().max().map_or(0, |g| g + 1);
    let mut all = vec![None; groups];
    let (Some(place), Some(values)) = (model.place(term, value), model.values(term)) else {
        return all;
    };
    let (low, high) = setting.problem.terms()[term].bounds[value];
    let mut design = model.design.clone();
    let column = design.x[place].clone();
    // The groups share the shape as found: else its error would be in the size of each.
    let shapes = setting.problem.terms()[term].amplitudes..values.len();
    let shapes: Vec<usize> = shapes.filter_map(|k| model.place(term, k)).collect();
    let kept = model.design.x.iter().enumerate();
    let kept = kept.filter(|(k, _)| *k != place && !shapes.contains(k));
    design.x = kept.map(|(_, x)| x.clone()).collect();
    let others = design.x.len();
    let mut shown = Vec::new();
    for g in 0..groups {
        let masked = column.iter().enumerate();
        let masked = masked.map(|(i, x)| if group.get(i) == Some(&g) { *x } else { 0.0 });
        let masked: Vec<f64> = masked.collect();
        if masked.iter().any(|x| *x != 0.0) {
            design.x.push(masked);
            shown.push(g);
        }
    }
    let gram = setting.sums(&design);
    let factor = Factor::new(&design.tree, &gram, &model.variances);
    let (fixed, covariance) = (factor.fixed(), factor.fixed_covariance());
    for (k, g) in shown.into_iter().enumerate() {
        let standard_error = covariance.at(others + k, others + k).max(0.0).sqrt();
        let estimate = Estimate {
            value: values[value] + fixed[others + k],
            standard_error,
        };
        let possible = estimate.value >= low && estimate.value <= high;
        let known = standard_error > 0.0 && standard_error.is_finite();
        all[g] = (known && possible).then_some(estimate);
    }
    all
}

/// Measured less predicted with the predicted random effects.
pub fn conditional(model: &Fitted) -> Vec<f64> {
    let tree = &model.design.tree;
    let paths: Vec<Vec<usize>> = (0..tree.len()).map(|n| tree.path_numbers(n)).collect();
    let rows = model.design.z.iter().zip(&model.design.node);
    rows.zip(&model.design.y)
        .map(|((z, node), y)| {
            let own = paths[*node].iter().zip(z);
            y - own.map(|(c, z)| z * model.point.random[*c]).sum::<f64>()
        })
        .collect()
}
