//! The engine against a dense covariance: likelihood, gradient, estimates, predictions and projections of a small nested problem.

use crate::gram::{Design, Square};
use crate::system::{Factor, Likelihood, Panel, Variances};
use crate::tree::{Block, Tree};
use crate::variance::{Effort, Maximiser, Prior, Scale};
use std::sync::Arc;

/// Deterministic numbers that look like a normal sample.
fn noise(k: &mut u64) -> f64 {
    let mut sum = -6.0;
    for _ in 0..12 {
        *k = k
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        sum += (*k >> 11) as f64 / (1_u64 << 53) as f64;
    }
    sum
}

/// Two specimens of two sessions of nine readings, a common component of two columns; and three readings of every specimen itself. Three classes of
/// noise, the last of readings on which neither fixed effects nor what is common act.
fn design() -> Design {
    let block = |component, columns| Block { component, columns };
    let mut tree = Tree::new(vec![block(0, 2)]);
    let mut nodes = Vec::new();
    for _ in 0..2 {
        let specimen = tree.add(0, vec![block(1, 1)]);
        nodes.push((specimen, 3));
        for _ in 0..2 {
            nodes.push((tree.add(specimen, vec![block(2, 1), block(3, 2)]), 9));
        }
    }
    let mut k = 1;
    let mut design = Design {
        tree,
        node: Vec::new(),
        class: Vec::new(),
        classes: 3,
        z: Arc::default(),
        x: vec![Vec::new(), Vec::new()],
        y: Vec::new(),
    };
    let mut rows = Vec::new();
    for (node, readings) in nodes {
        for i in 0..readings {
            design.node.push(node);
            design.class.push(i % 3);
            let columns = design.tree.path_columns(node);
            let mut z: Vec<f64> = (0..columns).map(|_| noise(&mut k)).collect();
            let mut x = [1.0, noise(&mut k)];
            if i % 3 == 2 {
                z[..2].fill(0.0);
                x.fill(0.0);
            }
            rows.push(z);
            for (column, x) in design.x.iter_mut().zip(x) {
                column.push(x);
            }
            design.y.push(3.0 * noise(&mut k) + node as f64);
        }
    }
    design.z = Arc::new(rows);
    design
}

fn variances() -> Variances {
    Variances {
        components: vec![0.4, 1.3, 0.8, 0.5],
        noise: vec![0.9, 1.4, 0.7],
    }
}

/// V, by rows.
fn dense(design: &Design, variances: &Variances) -> Square {
    let n = design.len();
    let mut v = Square::zeros(n);
    for i in 0..n {
        for j in 0..n {
            let (a, b) = (
                design.tree.path_numbers(design.node[i]),
                design.tree.path_numbers(design.node[j]),
            );
            let component = |number: usize| {
                let node = (0..design.tree.len())
                    .rev()
                    .find(|n| design.tree.first_column(*n) <= number && design.tree.width(*n) > 0)
                    .unwrap_or(0);
                let k = number - design.tree.first_column(node);
                design.tree.components_of(node).nth(k).unwrap_or(0)
            };
            let mut sum = 0.0;
            for (p, x) in a.iter().zip(&design.z[i]) {
                for (q, y) in b.iter().zip(&design.z[j]) {
                    if p == q {
                        let sd = variances.components[component(*p)];
                        sum += x * y * sd * sd;
                    }
                }
            }
            if i == j {
                let sd = variances.noise[design.class[i]];
                sum += sd * sd;
            }
            *v.at_mut(i, j) = sum;
        }
    }
    v
}

/// Inverse and log-determinant by Gauss-Jordan.
fn inverse(matrix: &Square) -> (Square, f64) {
    let n = matrix.n;
    let mut a = matrix.clone();
    let mut b = Square::zeros(n);
    for i in 0..n {
        *b.at_mut(i, i) = 1.0;
    }
    let mut log_det = 0.0;
    for k in 0..n {
        let pivot = a.at(k, k);
        log_det += libm::log(pivot);
        for j in 0..n {
            *a.at_mut(k, j) /= pivot;
            *b.at_mut(k, j) /= pivot;
        }
        for i in 0..n {
            if i != k {
                let factor = a.at(i, k);
                for j in 0..n {
                    let (x, y) = (a.at(k, j), b.at(k, j));
                    *a.at_mut(i, j) -= factor * x;
                    *b.at_mut(i, j) -= factor * y;
                }
            }
        }
    }
    (b, log_det)
}

fn times(a: &Square, x: &[f64]) -> Vec<f64> {
    (0..a.n)
        .map(|i| (0..a.n).map(|j| a.at(i, j) * x[j]).sum())
        .collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// P y, and log|X'V^-1 X|.
fn projected(design: &Design, w: &Square, y: &[f64]) -> (Vec<f64>, f64, Vec<f64>) {
    let wx: Vec<Vec<f64>> = design.x.iter().map(|x| times(w, x)).collect();
    let mut s = Square::zeros(2);
    for (i, a) in design.x.iter().enumerate() {
        for (j, b) in wx.iter().enumerate() {
            *s.at_mut(i, j) = dot(a, b);
        }
    }
    let (si, log_det) = inverse(&s);
    let right: Vec<f64> = wx.iter().map(|x| dot(x, y)).collect();
    let theta = times(&si, &right);
    let residual: Vec<f64> = (0..y.len())
        .map(|i| y[i] - theta[0] * design.x[0][i] - theta[1] * design.x[1][i])
        .collect();
    (times(w, &residual), log_det, theta)
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!(
        (a - b).abs() <= tolerance * (1.0 + b.abs()),
        "{a} against {b}"
    );
}

#[test]
fn likelihoods_estimates_and_predictions_are_those_of_the_dense_covariance() {
    let (design, variances) = (design(), variances());
    let v = dense(&design, &variances);
    let (w, log_det) = inverse(&v);
    let (py, log_det_x, theta) = projected(&design, &w, &design.y);
    let n = design.len() as f64;
    let full = -0.5 * (n * libm::log(std::f64::consts::TAU) + log_det + dot(&design.y, &py));
    let gram = design.gram();
    let factor = Factor::new(&design.tree, &gram, &variances);
    close(factor.log_likelihood(Likelihood::Full), full, 1e-12);
    let restricted = full - 0.5 * (log_det_x - 2.0 * libm::log(std::f64::consts::TAU));
    close(
        factor.log_likelihood(Likelihood::Restricted),
        restricted,
        1e-12,
    );
    for (a, b) in factor.fixed().iter().zip(&theta) {
        close(*a, *b, 1e-10);
    }
    // The mean of b is D Z' P y.
    let estimates = factor.estimates();
    for node in 0..design.tree.len() {
        let components: Vec<usize> = design.tree.components_of(node).collect();
        for (k, c) in components.into_iter().enumerate() {
            let number = design.tree.first_column(node) + k;
            let mut sum = 0.0;
            for i in 0..design.len() {
                let path = design.tree.path_numbers(design.node[i]);
                if let Some(place) = path.iter().position(|p| *p == number) {
                    sum += design.z[i][place] * py[i];
                }
            }
            let sd = variances.components[c];
            close(estimates.random[number], sd * sd * sum, 1e-10);
        }
    }
}

#[test]
fn the_covariance_at_the_root_is_that_of_the_dense_covariance() {
    // What is open of b is D - D Z'P Z D, of the fixed effects (X'W X)^-1, of both together -(X'W X)^-1 X'W Z D.
    let (design, variances) = (design(), variances());
    let (w, _) = inverse(&dense(&design, &variances));
    let gram = design.gram();
    let factor = Factor::new(&design.tree, &gram, &variances);
    let found = factor.covariance_at_root();
    let components: Vec<usize> = design.tree.components_of(0).collect();
    let width = components.len();
    let of_column = |k: usize| -> Vec<f64> { design.z.iter().map(|z| z[k]).collect() };
    let square =
        |k: usize| variances.components[components[k]] * variances.components[components[k]];
    for k in 0..width {
        let (left, _, theta) = projected(&design, &w, &of_column(k));
        for l in 0..width {
            let own = if k == l { square(k) } else { 0.0 };
            let expected = own - square(k) * square(l) * dot(&of_column(l), &left);
            close(found.at(k, l), expected, 1e-9);
        }
        for (j, t) in theta.iter().enumerate() {
            close(found.at(k, width + j), -t * square(k), 1e-9);
            close(found.at(width + j, k), -t * square(k), 1e-9);
        }
    }
    let fixed = factor.fixed_covariance();
    for i in 0..fixed.n {
        for j in 0..fixed.n {
            close(found.at(width + i, width + j), fixed.at(i, j), 1e-12);
        }
    }
}

#[test]
fn projections_of_further_columns_are_those_of_the_dense_covariance() {
    let (mut design, variances) = (design(), variances());
    let mut k = 99;
    let columns: Vec<Vec<f64>> = (0..3)
        .map(|_| (0..design.len()).map(|_| noise(&mut k)).collect())
        .collect();
    let (w, _) = inverse(&dense(&design, &variances));
    for round in 0..2 {
        let gram = design.gram();
        let factor = Factor::new(&design.tree, &gram, &variances);
        let panel = Panel::new(&design, &gram, &columns);
        let found = factor.project(&panel);
        for (j, c) in columns.iter().enumerate() {
            close(
                found.scores[j],
                dot(c, &projected(&design, &w, &design.y).0),
                1e-9,
            );
            close(found.squares[j], dot(c, &projected(&design, &w, c).0), 1e-9);
            close(found.unprojected[j], dot(c, &times(&w, c)), 1e-9);
        }
        if round == 0 {
            design.y = (0..design.len()).map(|_| noise(&mut k)).collect();
        }
    }
}

#[test]
fn the_gradient_is_that_of_differences() {
    let (design, at) = (design(), variances());
    let gram = design.gram();
    for likelihood in [Likelihood::Full, Likelihood::Restricted] {
        let value = |v: &Variances| Factor::new(&design.tree, &gram, v).log_likelihood(likelihood);
        let factor = Factor::new(&design.tree, &gram, &at);
        let (by_components, by_noise) = factor.gradient(likelihood);
        let h = 1e-5;
        for c in 0..4 {
            let (mut up, mut down) = (at.clone(), at.clone());
            up.components[c] *= 1.0 + h;
            down.components[c] *= 1.0 - h;
            close(
                by_components[c],
                (value(&up) - value(&down)) / (2.0 * h),
                1e-6,
            );
        }
        for c in 0..3 {
            let (mut up, mut down) = (at.clone(), at.clone());
            up.noise[c] *= 1.0 + h;
            down.noise[c] *= 1.0 - h;
            close(by_noise[c], (value(&up) - value(&down)) / (2.0 * h), 1e-6);
        }
    }
}

#[test]
fn a_node_that_has_faded_is_passed_over_and_changes_nothing() {
    let design = design();
    let gram = design.gram();
    // Both components of a session, or that of a specimen, which has sessions below it.
    for faded in [&[2, 3][..], &[1]] {
        let with = |sd: f64| {
            let mut at = variances();
            faded.iter().for_each(|c| at.components[*c] = sd);
            at
        };
        // The readings of a node add about ten times its variance to the prior precision: on either side of what counts as faded, and nothing.
        let [above, below, none] = [1e-3, 1e-5, 0.0].map(with);
        let nodes = |at: &Variances| Factor::new(&design.tree, &gram, at).idle_nodes();
        assert_eq!(nodes(&above), 0);
        assert_eq!(nodes(&below), if faded.len() == 2 { 4 } else { 2 });
        for likelihood in [Likelihood::Full, Likelihood::Restricted] {
            let all = [&above, &below, &none].map(|at| {
                let factor = Factor::new(&design.tree, &gram, at);
                let (mut slopes, by_noise) = factor.gradient(likelihood);
                slopes.extend(by_noise);
                let estimates = factor.estimates();
                let panel = Panel::new(&design, &gram, &[design.y.iter().rev().copied().collect()]);
                let projected = factor.project(&panel);
                let mut values = slopes;
                values.push(factor.log_likelihood(likelihood));
                values.extend(estimates.fixed);
                values.extend(estimates.random);
                values.extend(projected.squares);
                values
            });
            let [above, below, none] = all;
            for ((a, b), n) in above.iter().zip(&below).zip(&none) {
                close(*a, *n, 0.01);
                close(*b, *n, 1e-7);
            }
        }
    }
}

#[test]
fn sums_with_further_columns_are_those_of_the_longer_design() {
    let design = design();
    let mut k = 7;
    let columns: Vec<Vec<f64>> = (0..2)
        .map(|_| (0..design.len()).map(|_| noise(&mut k)).collect())
        .collect();
    let mut longer = design.clone();
    longer.x.extend(columns.iter().cloned());
    let extra: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let at = variances();
    let other: Vec<f64> = design.y.iter().rev().copied().collect();
    let wide = design.gram_with(&design.gram(), &extra);
    let drawn = design.with_response_of(&wide, &extra, &other);
    let plain = longer.gram();
    longer.y.clone_from(&other);
    let pairs = [(&wide, &plain), (&drawn, &longer.gram())];
    let likelihoods = [Likelihood::Full, Likelihood::Restricted];
    for ((quick, plain), likelihood) in pairs.into_iter().zip(likelihoods) {
        let [quick, plain] = [quick, plain].map(|gram| {
            let factor = Factor::new(&design.tree, gram, &at);
            let (mut values, by_noise) = factor.gradient(likelihood);
            values.extend(by_noise);
            values.push(factor.log_likelihood(likelihood));
            values.extend(factor.fixed());
            values
        });
        for (a, b) in quick.iter().zip(&plain) {
            close(*a, *b, 1e-10);
        }
    }
}

#[test]
fn the_ascent_ends_where_the_gradient_is_zero() {
    let design = design();
    let gram = design.gram();
    let scale = |prior, usual| Scale {
        prior,
        usual,
        groups: 2,
    };
    let components = [
        scale(Prior::HalfNormal(0.5), 0.5),
        scale(Prior::Free, 1.0),
        scale(Prior::Free, 1.0),
        scale(Prior::Fixed(0.5), 0.5),
    ];
    let noise = [scale(Prior::Free, 1.0); 3];
    let maximiser = Maximiser {
        tree: &design.tree,
        components: &components,
        noise: &noise,
        likelihood: Likelihood::Restricted,
    };
    let found = maximiser.maximise(&gram, &maximiser.start(1.0), Effort::FULL);
    assert_eq!(found.variances.components[3], 0.5);
    for c in 0..3 {
        for factor in [0.97, 1.03] {
            let mut beside = found.variances.clone();
            beside.components[c] *= factor;
            assert!(maximiser.value(&gram, &beside) <= found.log_likelihood + 1e-6);
        }
    }
}
