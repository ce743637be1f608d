//! Sums over groups of rows as quadratic polynomials of a few coordinates: estimating equations of any weighting of the groups without
//! another look at the rows.
//!
//! An M-estimate is a root of `sum over groups of f_g(u)`, `f_g` being the sum of the influences of a group's rows. Leaving a group out, or
//! taking it several times, changes only the weights of the groups. Each `f_g` is evaluated on a small design around `u = 0` and replaced by the
//! quadratic polynomial through it; the root of a weighted sum of polynomials then costs nothing that grows with the rows. For a model that
//! is linear in its coefficients `f_g` is linear, and the root exact. What a root is worth is for the caller to check on the rows.

use super::matrix::{Matrix, norm};
use super::qr::PivotedQr;

/// The points at which groups are evaluated: the origin, both ends of every axis, and for every pair of axes the two points at which both
/// coordinates are 1 or both are -1, so that cubic terms do not enter the mixed ones.
pub fn design(coordinates: usize) -> Vec<Vec<f64>> {
    let point = |entries: &[(usize, f64)]| {
        let mut point = vec![0.0; coordinates];
        for (axis, value) in entries {
            point[*axis] = *value;
        }
        point
    };
    let mut points = vec![point(&[])];
    for j in 0..coordinates {
        points.extend([1.0, -1.0].map(|x| point(&[(j, x)])));
    }
    for (j, k) in pairs(coordinates) {
        points.extend([1.0, -1.0].map(|x| point(&[(j, x), (k, x)])));
    }
    points
}

/// Every pair of different axes once.
fn pairs(coordinates: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..coordinates).flat_map(move |j| (j + 1..coordinates).map(move |k| (j, k)))
}

/// One polynomial a group, with several values each.
#[derive(Clone, Debug)]
pub struct GroupPolynomials {
    groups: Vec<Polynomial>,
    total: Polynomial,
}

impl GroupPolynomials {
    /// The polynomials through `values[point][group]` at the points of [`design`].
    ///
    /// # Panics
    /// If there is not one entry a point, or groups differ in number.
    pub fn new(coordinates: usize, values: &[Vec<Vec<f64>>]) -> Self {
        assert_eq!(
            values.len(),
            design(coordinates).len(),
            "one entry a point of the design"
        );
        let through = |g: usize| {
            let of_group: Vec<&[f64]> = values.iter().map(|v| v[g].as_slice()).collect();
            Polynomial::through(coordinates, &of_group)
        };
        let groups: Vec<Polynomial> = (0..values[0].len()).map(through).collect();
        let outputs = groups.first().map_or(0, Polynomial::outputs);
        let mut total = Polynomial::zero(coordinates, outputs);
        for group in &groups {
            total.add(1.0, group);
        }
        Self { groups, total }
    }

    /// The sum over all groups but one.
    ///
    /// # Panics
    /// If there is no such group.
    pub fn without(&self, group: usize) -> Polynomial {
        let mut sum = self.total.clone();
        sum.add(-1.0, &self.groups[group]);
        sum
    }

    /// The sum over groups, each counted so many times.
    pub fn weighted(&self, copies: &[f64]) -> Polynomial {
        let mut sum = Polynomial::zero(self.total.coordinates, self.total.outputs());
        for (group, copies) in self.groups.iter().zip(copies) {
            if *copies != 0.0 {
                sum.add(*copies, group);
            }
        }
        sum
    }
}

/// A quadratic polynomial of a point, with several values.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial {
    coordinates: usize,
    /// Term by term (constant, linear, squares, products of pairs), every value of a term beside each other.
    terms: Vec<Vec<f64>>,
}

/// Newton steps for a root; from a start as good as these a handful suffices.
const NEWTON_STEPS: usize = 30;
/// Length of the last step, in units of the design.
const ROOT_TOLERANCE: f64 = 1e-11;
/// A root further away than this has nothing to do with the design any more.
const FARTHEST: f64 = 1e3;

impl Polynomial {
    fn zero(coordinates: usize, outputs: usize) -> Self {
        let terms = 1 + 2 * coordinates + pairs(coordinates).count();
        Self {
            coordinates,
            terms: vec![vec![0.0; outputs]; terms],
        }
    }

    fn outputs(&self) -> usize {
        self.terms[0].len()
    }

    fn through(coordinates: usize, values: &[&[f64]]) -> Self {
        let outputs = values[0].len();
        let mut found = Self::zero(coordinates, outputs);
        for (m, _) in values[0].iter().enumerate() {
            let at = |point: usize| values[point][m];
            found.terms[0][m] = at(0);
            for j in 0..coordinates {
                let (up, down) = (at(1 + 2 * j), at(2 + 2 * j));
                found.terms[1 + j][m] = 0.5 * (up - down);
                found.terms[1 + coordinates + j][m] = 0.5 * (up + down) - at(0);
            }
            for (pair, (j, k)) in pairs(coordinates).enumerate() {
                let first = 1 + 2 * coordinates + 2 * pair;
                let squares =
                    found.terms[1 + coordinates + j][m] + found.terms[1 + coordinates + k][m];
                found.terms[1 + 2 * coordinates + pair][m] =
                    0.5 * (at(first) + at(first + 1)) - at(0) - squares;
            }
        }
        found
    }

    fn add(&mut self, factor: f64, other: &Self) {
        let pairs = self.terms.iter_mut().flatten();
        for (sum, value) in pairs.zip(other.terms.iter().flatten()) {
            *sum += factor * value;
        }
    }

    /// The values at a point.
    ///
    /// # Panics
    /// If the point has not one entry a coordinate.
    pub fn value(&self, point: &[f64]) -> Vec<f64> {
        let n = self.coordinates;
        assert_eq!(point.len(), n, "one entry a coordinate");
        let mut value = self.terms[0].clone();
        let linear = (0..n).flat_map(|j| [(1 + j, point[j]), (1 + n + j, point[j] * point[j])]);
        let mixed = pairs(n)
            .enumerate()
            .map(|(pair, (j, k))| (1 + 2 * n + pair, point[j] * point[k]));
        for (term, factor) in linear.chain(mixed) {
            for (sum, coefficient) in value.iter_mut().zip(&self.terms[term]) {
                *sum += factor * coefficient;
            }
        }
        value
    }

    /// The derivatives of the first `m` values by the first `m` coordinates at a point.
    fn slopes(&self, m: usize, point: &[f64]) -> Matrix {
        let n = self.coordinates;
        let mut slopes = Matrix::zeros(m, m);
        for i in 0..m {
            for j in 0..m {
                slopes[(i, j)] = self.terms[1 + j][i] + 2.0 * point[j] * self.terms[1 + n + j][i];
            }
            for (pair, (j, k)) in pairs(n).enumerate() {
                let mixed = self.terms[1 + 2 * n + pair][i];
                for (of, by) in [(j, k), (k, j)] {
                    if of < m {
                        slopes[(i, of)] += mixed * point[by];
                    }
                }
            }
        }
        slopes
    }

    /// The point near the origin at which the first values are zero, as many as there are coordinates less the `known` last ones; `None`
    /// where Newton's method does not arrive at one.
    pub fn root(&self, known: &[f64]) -> Option<Vec<f64>> {
        let m = self.coordinates - known.len();
        let mut point = vec![0.0; m];
        point.extend_from_slice(known);
        for _ in 0..NEWTON_STEPS {
            let value = self.value(&point);
            let qr = PivotedQr::new(self.slopes(m, &point));
            if qr.rank(qr.default_tolerance()) < m {
                return None;
            }
            let step = qr.solve_least_squares(&value[..m], m);
            for (x, s) in point.iter_mut().zip(&step) {
                *x -= s;
            }
            let (moved, distance) = (norm(&step), norm(&point[..m]));
            if distance.is_nan() || distance > FARTHEST {
                return None;
            }
            if moved <= ROOT_TOLERANCE * distance.max(1e-3) {
                return Some(point);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two values of three coordinates, quadratic.
    fn quadratic(u: &[f64]) -> Vec<f64> {
        vec![
            0.1 + u[0] - 0.5 * u[1] + 0.2 * u[2] + 0.3 * u[0] * u[0] - 0.1 * u[0] * u[1],
            -0.2 + 2.0 * u[1] + 0.4 * u[1] * u[1] + 0.1 * u[1] * u[2] - 0.3 * u[2] * u[2],
        ]
    }

    fn scaled(factor: f64, values: Vec<f64>) -> Vec<f64> {
        values.into_iter().map(|v| factor * v).collect()
    }

    fn polynomials() -> GroupPolynomials {
        let at = |u: &Vec<f64>| {
            vec![
                quadratic(u),
                scaled(3.0, quadratic(u)),
                vec![u[0] * u[2], 1.0],
            ]
        };
        let values: Vec<Vec<Vec<f64>>> = design(3).iter().map(at).collect();
        GroupPolynomials::new(3, &values)
    }

    #[test]
    fn quadratic_sums_are_found_again_for_any_weights() {
        let polynomials = polynomials();
        let u = [0.7, -1.3, 0.4];
        let close = |found: Vec<f64>, expected: Vec<f64>| {
            for (a, b) in found.iter().zip(&expected) {
                assert!((a - b).abs() < 1e-14, "{found:?} {expected:?}");
            }
        };
        close(polynomials.without(2).value(&u), scaled(4.0, quadratic(&u)));
        let weighted = polynomials.weighted(&[0.5, 0.5, 0.0]);
        close(weighted.value(&u), scaled(2.0, quadratic(&u)));
    }

    #[test]
    fn a_root_with_a_known_last_coordinate() {
        let root = polynomials().without(2).root(&[0.6]).unwrap();
        assert_eq!(root[2], 0.6);
        assert!(norm(&quadratic(&root)) < 1e-13, "{root:?}");
    }

    #[test]
    fn no_root_is_said_so() {
        let values: Vec<Vec<Vec<f64>>> = design(1)
            .iter()
            .map(|u| vec![vec![1.0 + u[0] * u[0]]])
            .collect();
        assert_eq!(
            GroupPolynomials::new(1, &values).weighted(&[1.0]).root(&[]),
            None
        );
    }
}
