//! Derivatives of the log-likelihood by the standard deviations, from expected products of random effects, fixed effects and response.

use super::kernels::{add_combination, add_products, add_times, dot};
use super::triangular::inverse_of;
use super::{Factor, Likelihood, scales};
use crate::gram::{Part, Square};
use crate::tree::{Block, Tree};
use multiversion::multiversion;

impl Factor<'_> {
    /// Derivatives of the log-likelihood by the logarithms of the standard deviations: components, then noise.
    ///
    /// With e = (random effects of the path, fixed effects, -1 for the response) of a node and its expected product E = E\[e e'\] given the
    /// readings, every derivative is a scalar product with E. The own effects of a node are -A e of its parent plus what its own readings leave
    /// open, so that a node without further ones below it needs no E of its own: the matrices that are to be multiplied with that of
    /// its parent are summed over all such nodes first.
    pub fn gradient(&self, likelihood: Likelihood) -> (Vec<f64>, Vec<f64>) {
        let tree = self.tree;
        let fixed = self.fixed();
        let at_root = self.expected_above_root(&fixed, likelihood);
        let mut by_components = vec![0.0; self.variances.components.len()];
        // The first class of noise is what is left of all: only the readings of the others are looked at themselves.
        let mut by_noise: Vec<f64> = self.gram.counts.iter().map(|_| 0.0).collect();
        let others = self.parts_of_other_classes();
        let is_parent = parents(tree);
        let mut expected: Vec<Option<Square>> = Vec::with_capacity(tree.len());
        let mut sums: Vec<Option<Below>> = Vec::with_capacity(tree.len());
        for node in 0..tree.len() {
            if self.nodes[node].idle && node > 0 && !is_parent[node] && others[node].is_empty() {
                expected.push(None);
                sums.push(None);
                continue;
            }
            let own = self.own_effects(node);
            let first = tree.above(node);
            let above = expected_of(&expected, tree, node).unwrap_or(&at_root);
            if node == 0 || is_parent[node] {
                for part in &others[node] {
                    let rows = self.scaled_rows(part);
                    by_noise[part.class] += own.expected_squares(&rows, first, |rest| {
                        rest.chunks_exact(own.n)
                            .map(|row| quadratic_form(row, above))
                            .sum()
                    });
                    by_noise[part.class] -= part.readings.len() as f64;
                }
                let here = own.expected(above, first);
                for (k, c) in tree.components_of(node).enumerate() {
                    by_components[c] += here.at(first + k, first + k) - 1.0;
                }
                sums.push(Some(Below::new(
                    here.n,
                    by_components.len(),
                    by_noise.len(),
                )));
                expected.push(Some(here));
                continue;
            }
            for (k, c) in tree.components_of(node).enumerate() {
                by_components[c] += own.open.at(k, k) - 1.0;
            }
            expected.push(None);
            sums.push(None);
            let Some(below) = &mut sums[tree.parent(node)] else {
                continue;
            };
            below.take(&own, tree.blocks(node));
            for part in &others[node] {
                let rows = self.scaled_rows(part);
                by_noise[part.class] += own.expected_squares(&rows, first, |rest| {
                    add_products(below.noise(part.class), rest, part.readings.len());
                    0.0
                });
                by_noise[part.class] -= part.readings.len() as f64;
            }
        }
        for (below, here) in sums.iter().zip(&expected) {
            if let (Some(below), Some(here)) = (below, here) {
                add_to(&mut by_components, &below.components, here);
                add_to(&mut by_noise, &below.noise, here);
            }
        }
        // All readings together: y'P y less the squares of the random effects, and the trace of (covariance times products) = columns - what is
        // left open.
        let all = self.quadratic - by_components.iter().sum::<f64>()
            + self.estimated(likelihood) as f64
            - self.gram.count() as f64;
        by_noise[0] = all - by_noise.iter().sum::<f64>();
        (by_components, by_noise)
    }

    /// By node, the parts of all classes of noise but the first.
    fn parts_of_other_classes(&self) -> Vec<Vec<&Part>> {
        let mut others: Vec<Vec<&Part>> = vec![Vec::new(); self.tree.len()];
        for part in self.gram.parts.iter().filter(|p| p.class > 0) {
            others[part.node].push(part);
        }
        others
    }

    /// The rows of a part, each column in units of its standard deviation, all divided by the noise.
    fn scaled_rows(&self, part: &Part) -> Vec<f64> {
        let scales = scales(self.tree, self.variances, part, self.gram.fixed);
        let mut rows = part.rows.clone();
        for row in rows.chunks_exact_mut(scales.len()) {
            for (x, s) in row.iter_mut().zip(&scales) {
                *x *= s;
            }
        }
        rows
    }

    /// How many fixed effects the likelihood counts as estimated.
    fn estimated(&self, likelihood: Likelihood) -> usize {
        match likelihood {
            Likelihood::Full => 0,
            Likelihood::Restricted => {
                let pivots = (0..self.gram.fixed).filter(|k| self.fixed_lower.at(*k, *k) > 0.0);
                pivots.count()
            }
        }
    }

    /// E of the fixed effects and the response.
    fn expected_above_root(&self, fixed: &[f64], likelihood: Likelihood) -> Square {
        let n = fixed.len() + 1;
        let mut e = Square::zeros(n);
        let v: Vec<f64> = fixed.iter().copied().chain([-1.0]).collect();
        for i in 0..n {
            for j in 0..n {
                *e.at_mut(i, j) = v[i] * v[j];
            }
        }
        if likelihood == Likelihood::Restricted {
            let covariance = self.fixed_covariance();
            for i in 0..n - 1 {
                for j in 0..n - 1 {
                    *e.at_mut(i, j) += covariance.at(i, j);
                }
            }
        }
        e
    }

    /// What a node's own random effects are of e of its parent, and what is left open of them.
    pub(super) fn own_effects(&self, node: usize) -> OwnEffects {
        let eliminated = &self.nodes[node];
        let width = self.tree.width(node);
        let n = self.tree.above(node) + self.gram.fixed + 1;
        OwnEffects {
            width,
            n,
            a: self.solved(node, n),
            open: if eliminated.idle {
                Square::identity(width)
            } else {
                inverse_of(&eliminated.lower)
            },
        }
    }
}

/// The own random effects of a node, -A e of its parent plus what is left open.
pub(super) struct OwnEffects {
    width: usize,
    /// Columns of A.
    n: usize,
    /// A, row after row.
    a: Vec<f64>,
    /// Covariance of what is left open.
    open: Square,
}

impl OwnEffects {
    /// A times a symmetric matrix.
    fn times(&self, matrix: &Square) -> Vec<f64> {
        let mut product = vec![0.0; self.a.len()];
        let rows = self.a.chunks_exact(self.n);
        for (row, to) in rows.zip(product.chunks_exact_mut(self.n)) {
            add_combination(to, row, &matrix.a);
        }
        product
    }

    /// E of the node from that of its parent; the own columns stand at `first`.
    pub(super) fn expected(&self, above: &Square, first: usize) -> Square {
        let (n, width) = (self.n, self.width);
        let place = |j: usize| if j < first { j } else { j + width };
        let mut e = Square::zeros(n + width);
        for i in 0..n {
            let (from, to) = (i * n, place(i) * e.n);
            e.a[to..to + first].copy_from_slice(&above.a[from..from + first]);
            e.a[to + first + width..to + n + width]
                .copy_from_slice(&above.a[from + first..from + n]);
        }
        let product = self.times(above);
        for k in 0..width {
            let row = &product[k * n..(k + 1) * n];
            for (j, x) in row.iter().enumerate() {
                *e.at_mut(first + k, place(j)) = -x;
                *e.at_mut(place(j), first + k) = -x;
            }
            for l in 0..=k {
                let value = self.open.at(k, l) + dot(row, &self.a[l * n..(l + 1) * n]);
                *e.at_mut(first + k, first + l) = value;
                *e.at_mut(first + l, first + k) = value;
            }
        }
        e
    }

    /// Sum of the expected squares of rows of the path's columns, fixed effects and response times e of the node: what is left open of its own
    /// effects, and what the rows are of e of its parent, `of_parent`.
    fn expected_squares(
        &self,
        rows: &[f64],
        first: usize,
        of_parent: impl FnOnce(&[f64]) -> f64,
    ) -> f64 {
        let (n, width) = (self.n, self.width);
        let rows = rows.chunks_exact(n + width);
        let mut rest = Vec::with_capacity(rows.len() * n);
        let mut open = 0.0;
        for row in rows {
            let own = &row[first..first + width];
            let begin = rest.len();
            rest.extend_from_slice(&row[..first]);
            rest.extend_from_slice(&row[first + width..]);
            for (x, a) in own.iter().zip(self.a.chunks_exact(n)) {
                add_times(&mut rest[begin..], -x, a);
            }
            open += quadratic_form(own, &self.open);
        }
        open + of_parent(&rest)
    }
}

/// Matrices, upper triangles, that are to be multiplied with E of a node: from the nodes below it that have none below them.
struct Below {
    n: usize,
    components: Vec<Option<Square>>,
    noise: Vec<Option<Square>>,
}

impl Below {
    fn new(n: usize, components: usize, classes: usize) -> Self {
        Self {
            n,
            components: vec![None; components],
            noise: vec![None; classes],
        }
    }

    fn component(&mut self, component: usize) -> &mut Square {
        self.components[component].get_or_insert_with(|| Square::zeros(self.n))
    }

    fn noise(&mut self, class: usize) -> &mut Square {
        self.noise[class].get_or_insert_with(|| Square::zeros(self.n))
    }

    /// Adds what the own effects of a node are to be multiplied with.
    fn take(&mut self, own: &OwnEffects, blocks: &[Block]) {
        let mut from = 0;
        for block in blocks {
            let rows = &own.a[from * own.n..(from + block.columns) * own.n];
            add_products(self.component(block.component), rows, block.columns);
            from += block.columns;
        }
    }
}

/// Adds the products of matrices with E to sums.
fn add_to(sums: &mut [f64], matrices: &[Option<Square>], expected: &Square) {
    for (matrix, sum) in matrices.iter().zip(sums) {
        *sum += matrix
            .as_ref()
            .map_or(0.0, |m| product_of_upper(m, expected));
    }
}

/// For each node whether there are others below it.
fn parents(tree: &Tree) -> Vec<bool> {
    let mut is_parent = vec![false; tree.len()];
    for node in 1..tree.len() {
        is_parent[tree.parent(node)] = true;
    }
    is_parent
}

/// E of the parent of a node; none of the root's.
fn expected_of<'e>(expected: &'e [Option<Square>], tree: &Tree, node: usize) -> Option<&'e Square> {
    (node > 0).then(|| expected[tree.parent(node)].as_ref())?
}

/// x'A x.
#[multiversion(targets("x86_64+avx2"))]
fn quadratic_form(x: &[f64], a: &Square) -> f64 {
    let rows = a.a.chunks_exact(a.n).zip(x);
    rows.map(|(row, factor)| factor * dot(row, x)).sum()
}

/// Sum of the products of all entries of two symmetric matrices, of the first of which the upper triangle counts.
#[multiversion(targets("x86_64+avx2"))]
fn product_of_upper(upper: &Square, b: &Square) -> f64 {
    let n = upper.n;
    let rows = (0..n).map(|i| {
        let (a, b) = (
            &upper.a[i * n + i..(i + 1) * n],
            &b.a[i * n + i..(i + 1) * n],
        );
        2.0 * dot(a, b) - a[0] * b[0]
    });
    rows.sum()
}
