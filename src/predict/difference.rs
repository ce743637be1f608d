//! Whether two fits of the new model say the same force: an equivalence test at a stated margin.
//!
//! The difference of the predicted forces is taken on a grid over the lengths, contractions and pressures that both fits have seen, as a share of
//! the force at resting length and 620 kPa (the mean of the two). Its standard error is that of the jackknife over specimens (Tukey 1958): a specimen
//! of one fit moves the difference by what it does to that fit, one of both (the same id and lengths) by what it does to the second less what it
//! does to the first.
//!
//! *Equivalent*: at every point the 90% interval lies within the margin (two one-sided tests at 5%, Schuirmann, J. Pharmacokinet. Biopharm. 15 (1987) 657;
//! over all points an intersection-union test, which needs no correction). *Different*: at some point the interval, widened for the number of points
//! (Bonferroni, 5% over all), lies wholly beyond it. Else neither is shown.

use pipeline_fit::GroupFit;
use pipeline_fit::engine::EquationFit;
use pipeline_fit::equations::JOINT;
use pipeline_mechanics::models::{P_620_KPA, new};
use pipeline_numerics::distributions::student_t_quantile;
use pipeline_numerics::statistics::sum_of_squares;
use serde::Serialize;

/// Points of the grid along the resting length, eps* and the pressure.
const POINTS: [usize; 3] = [4, 5, 5];
/// Level of each one-sided test, and of the search for a difference over all points.
const LEVEL: f64 = 0.05;

/// What the comparison came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Within the margin everywhere.
    Equivalent,
    /// Beyond it somewhere.
    Different,
    /// Neither is shown.
    Undecided,
}

/// A state, and what two laws say of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Point {
    /// l_rest, m.
    pub rest_length_m: f64,
    /// eps*.
    pub contraction_rel: f64,
    /// Gauge pressure, kPa.
    pub pressure_kpa: f64,
    /// Force by the first, N.
    pub first_n: f64,
    /// Force by the second, N.
    pub second_n: f64,
    /// Second less first, as a share of the force at resting length and 620 kPa.
    pub share: f64,
    /// Its standard error; none where a fit has fewer than two refits.
    pub standard_error: Option<f64>,
    /// Its 90% interval.
    pub interval: Option<(f64, f64)>,
}

/// The comparison of two laws.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// What it came to.
    pub outcome: Outcome,
    /// The margin, a share.
    pub margin: f64,
    /// Specimens that both are fits to.
    pub shared: usize,
    /// Degrees of freedom of Student's t; none where there is no test.
    pub freedom: Option<usize>,
    /// Root mean square of the shares.
    pub rms_share: f64,
    /// The point with the largest share.
    pub largest: Point,
    /// The point whose interval reaches furthest out.
    pub furthest: Point,
    /// Number of points.
    pub points: usize,
}

/// Why two fits say nothing of each other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "why", rename_all = "snake_case")]
pub enum NotCompared {
    /// A fit has no joint law.
    NoLaw {
        /// Which: 0 is the first.
        side: usize,
    },
    /// The ranges that were measured do not overlap.
    Apart {
        /// In what.
        quantity: Measured,
        /// Range of the first: m, 1 or kPa.
        first: (f64, f64),
        /// Range of the second.
        second: (f64, f64),
    },
}

/// What was measured over a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measured {
    /// l_rest, m.
    RestLength,
    /// eps*.
    ContractionRel,
    /// Gauge pressure, kPa.
    Pressure,
}

/// A law at a state, for its coefficients b1, b2, c0, c1, c2.
fn force(fit: &GroupFit, c: &[f64], [rest, contraction_rel, pressure]: [f64; 3]) -> f64 {
    let f620 = new::f620(c[0], c[1], fit.cap_length_m, rest);
    new::force(
        [c[2], c[3], c[4]],
        f620,
        contraction_rel,
        pressure / P_620_KPA,
    )
}

/// The force at resting length and 620 kPa.
fn scale(fit: &GroupFit, joint: &EquationFit, rest: f64) -> f64 {
    force(fit, &joint.values(), [rest, 0.0, P_620_KPA])
}

/// Compares two fits.
///
/// # Errors
/// One has no joint fit, or no state was seen by both.
pub fn difference(
    first: &GroupFit,
    second: &GroupFit,
    margin: f64,
) -> Result<Difference, NotCompared> {
    let fits = [first, second];
    let law = |side: usize| {
        let law = fits[side].equation(JOINT);
        law.ok_or(NotCompared::NoLaw { side })
    };
    let joints = [law(0)?, law(1)?];
    let common = |quantity, of: fn(&GroupFit) -> (f64, f64)| {
        let [first, second] = fits.map(of);
        let (low, high) = (first.0.max(second.0), first.1.min(second.1));
        let apart = NotCompared::Apart {
            quantity,
            first,
            second,
        };
        (low <= high).then_some((low, high)).ok_or(apart)
    };
    let ranges = [
        common(Measured::RestLength, |f| f.ranges.rest_length_m)?,
        common(Measured::ContractionRel, |f| f.ranges.contraction_rel)?,
        common(Measured::Pressure, |f| f.ranges.pressure_kpa)?,
    ];
    let folds = joints.map(|j| j.folds.len());
    let both = shared([0, 1].map(|k| specimens(fits[k], joints[k])));
    let freedom = (folds[0].min(folds[1]) > 1).then(|| folds[0].min(folds[1]) - 1);
    let mut points = Vec::new();
    for rest in steps(ranges[0], POINTS[0]) {
        let size = 0.5 * (scale(first, joints[0], rest) + scale(second, joints[1], rest));
        for contraction_rel in steps(ranges[1], POINTS[1]) {
            for pressure_kpa in steps(ranges[2], POINTS[2]) {
                let at = [rest, contraction_rel, pressure_kpa];
                let forces = [0, 1].map(|k| force(fits[k], &joints[k].values(), at));
                let without = [0, 1].map(|k| {
                    let each = joints[k].folds.iter();
                    each.map(|f| force(fits[k], &f.coefficients, at) - forces[k])
                        .collect::<Vec<f64>>()
                });
                let share = (forces[1] - forces[0]) / size;
                let standard_error = freedom.map(|_| jackknife(&without, &both) / size);
                let interval = freedom.zip(standard_error).map(|(df, error)| {
                    let half = student_t_quantile(1.0 - LEVEL, df as f64) * error;
                    (share - half, share + half)
                });
                points.push(Point {
                    rest_length_m: rest,
                    contraction_rel,
                    pressure_kpa,
                    first_n: forces[0],
                    second_n: forces[1],
                    share,
                    standard_error,
                    interval,
                });
            }
        }
    }
    Ok(judged(points, margin, both.len(), freedom))
}

/// The specimens that are left out in turn, with their resting length and contraction at 620 kPa: ids alone may be those of other actuators elsewhere.
fn specimens<'f>(fit: &'f GroupFit, joint: &'f EquationFit) -> Vec<(&'f str, Option<[u64; 2]>)> {
    let known = |id: &str| {
        let found = fit.specimens.iter().find(|s| s.id == id)?;
        Some([found.rest_length_m, found.contraction_620].map(f64::to_bits))
    };
    let folds = joint.folds.iter().map(|f| f.left_out.as_str());
    folds.map(|id| (id, known(id))).collect()
}

/// The places of what is in both lists.
fn shared<T: PartialEq>([first, second]: [Vec<T>; 2]) -> Vec<[usize; 2]> {
    let place = |of: &T| second.iter().position(|o| o == of);
    let places = first.iter().enumerate();
    places.filter_map(|(k, of)| Some([k, place(of)?])).collect()
}

/// Standard error of a difference from what each is without each specimen, less what it is with all; `shared` are the places of the specimens of
/// both.
fn jackknife(without: &[Vec<f64>; 2], shared: &[[usize; 2]]) -> f64 {
    // What each specimen moves, so that the squares add up to the variance.
    let [first, second] = without.each_ref().map(|w| {
        let count = w.len() as f64;
        let factor = ((count - 1.0) / count).sqrt();
        w.iter().map(|x| factor * x).collect::<Vec<f64>>()
    });
    let apart = sum_of_squares(&first) + sum_of_squares(&second);
    let together = shared.iter().map(|[a, b]| first[*a] * second[*b]);
    (apart - 2.0 * together.sum::<f64>()).max(0.0).sqrt()
}

fn judged(points: Vec<Point>, margin: f64, shared: usize, freedom: Option<usize>) -> Difference {
    let reach = |p: &Point| {
        let (low, high) = p.interval.unwrap_or((p.share, p.share));
        low.abs().max(high.abs())
    };
    let most = |of: &dyn Fn(&Point) -> f64| {
        let all = points.iter().copied();
        let most = all.max_by(|a, b| of(a).total_cmp(&of(b)));
        most.expect("a grid has points")
    };
    let furthest = most(&reach);
    let largest = most(&|p: &Point| p.share.abs());
    let beyond = |p: &Point| {
        let test = freedom.zip(p.standard_error);
        test.is_some_and(|(df, error)| {
            let each = 0.5 * LEVEL / points.len() as f64;
            let half = student_t_quantile(1.0 - each, df as f64) * error;
            p.share.abs() - half > margin
        })
    };
    let outcome = if points.iter().any(beyond) {
        Outcome::Different
    } else if freedom.is_some() && reach(&furthest) < margin {
        Outcome::Equivalent
    } else {
        Outcome::Undecided
    };
    let shares: Vec<f64> = points.iter().map(|p| p.share).collect();
    Difference {
        outcome,
        margin,
        shared,
        freedom,
        rms_share: (sum_of_squares(&shares) / shares.len() as f64).sqrt(),
        largest,
        furthest,
        points: points.len(),
    }
}

/// Points from end to end; one where both are the same.
fn steps((low, high): (f64, f64), count: usize) -> Vec<f64> {
    if low == high {
        return vec![low];
    }
    let step = (high - low) / (count - 1) as f64;
    (0..count).map(|k| low + step * k as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(share: f64, standard_error: f64, freedom: usize) -> Point {
        let half = student_t_quantile(0.95, freedom as f64) * standard_error;
        Point {
            rest_length_m: 0.3,
            contraction_rel: 0.5,
            pressure_kpa: 400.0,
            first_n: 100.0,
            second_n: 100.0 + 400.0 * share,
            share,
            standard_error: Some(standard_error),
            interval: Some((share - half, share + half)),
        }
    }

    fn outcome(points: &[(f64, f64)]) -> Outcome {
        let points = points.iter().map(|(s, e)| point(*s, *e, 8)).collect();
        judged(points, 0.1, 0, Some(8)).outcome
    }

    /// t(0.95; 8) = 1.8595, t(1 - 0.025/2; 8) = 2.7515.
    #[test]
    fn equivalence_needs_every_interval_within_the_margin() {
        assert_eq!(outcome(&[(0.0, 0.01), (0.05, 0.0268)]), Outcome::Equivalent);
        assert_eq!(outcome(&[(0.0, 0.01), (0.05, 0.0270)]), Outcome::Undecided);
        assert_eq!(outcome(&[(0.0, 0.01), (-0.2, 0.0364)]), Outcome::Undecided);
        assert_eq!(outcome(&[(0.0, 0.01), (-0.2, 0.0362)]), Outcome::Different);
    }

    #[test]
    fn the_jackknife_adds_what_is_apart_and_takes_differences_of_what_is_shared() {
        let without = [vec![1.0, -1.0, 2.0], vec![1.0, -1.0, 2.0]];
        let all = [[0, 0], [1, 1], [2, 2]];
        assert_eq!(jackknife(&without, &all), 0.0);
        let one = 2.0 / 3.0 * 6.0_f64;
        assert!((jackknife(&without, &[]) - (2.0 * one).sqrt()).abs() < 1e-12);
        // One of both: the others add, of it the difference counts, which is nothing.
        let others = 2.0 / 3.0 * 2.0 * (1.0 + 1.0_f64);
        assert!((jackknife(&without, &[[2, 2]]) - others.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn specimens_are_the_same_where_all_that_is_known_of_them_is() {
        let first = vec![("a", 182), ("b", 233), ("c", 300)];
        let second = vec![("c", 300), ("a", 182), ("b", 234)];
        assert_eq!(shared([first, second]), [[0, 1], [2, 0]]);
    }
}
