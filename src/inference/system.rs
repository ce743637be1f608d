//! The marginal likelihood of a linear mixed model, and what follows from its factor.
//!
//! With b = T u, u ~ N(0, 1), T the standard deviations of the components, the joint precision of u and the readings is
//! M = I + T Z' S^-1 Z T, S the variances of the noise. M has the shape of the tree, so that its Cholesky factor is found node by node,
//! children first, each node leaving a Schur complement to its parent (multifrontal elimination; Duff and Reid, ACM TOMS 9 (1983) 302).
//! The fixed effects and the response come last: what is left of them at the root is X'V^-1 X, X'V^-1 y and y'V^-1 y, and
//! log|V| = log|M| + log|S| (Sylvester). Cost goes with the number of groups, not with the number of readings.

use crate::gram::{Gram, Part, Square};
use crate::tree::Tree;
use std::f64::consts::TAU;

/// Standard deviations of components and classes of noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Variances {
    /// One a component.
    pub components: Vec<f64>,
    /// One a class of noise.
    pub noise: Vec<f64>,
}

/// Which likelihood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Likelihood {
    /// Of the response: to compare models with other fixed effects.
    Full,
    /// Of what is left of the response after the fixed effects: for variances and predictions (Patterson and Thompson, Biometrika 58
    /// (1971) 545).
    Restricted,
}

/// A pivot below this part of its diagonal is none: the column is spanned by those before it.
const NO_PIVOT: f64 = 1e-11;

/// The factor of one node: L of its own columns, and L^-1 times the columns below which they stand.
struct Eliminated {
    lower: Square,
    /// Own rows by the rest: columns above, fixed effects, response.
    rest: Vec<f64>,
}

/// The factor of a system at some variances.
pub struct Factor<'a> {
    tree: &'a Tree,
    gram: &'a Gram,
    variances: &'a Variances,
    nodes: Vec<Eliminated>,
    /// Cholesky factor of X'V^-1 X; a zero pivot where a column is spanned by others.
    fixed_lower: Square,
    /// L^-1 X'V^-1 y.
    fixed_response: Vec<f64>,
    log_det: f64,
    /// y'P y.
    quadratic: f64,
}

/// Means of fixed and random effects given the readings.
#[derive(Clone, Debug)]
pub struct Estimates {
    /// Fixed effects.
    pub fixed: Vec<f64>,
    /// Random effects, all columns, in units of their component (not scaled).
    pub random: Vec<f64>,
}

/// Scales of the columns of a part: standard deviations of the path, 1 for the rest; all divided by the noise.
fn scales(tree: &Tree, variances: &Variances, part: &Part, fixed: usize) -> Vec<f64> {
    let noise = variances.noise[part.class];
    let of = tree.path_components(part.node).iter();
    let random = of.map(|c| variances.components[*c] / noise);
    random
        .chain(std::iter::repeat_n(1.0 / noise, fixed + 1))
        .collect()
}

impl<'a> Factor<'a> {
    /// Factors the system.
    pub fn new(tree: &'a Tree, gram: &'a Gram, variances: &'a Variances) -> Self {
        let mut log_det = 0.0;
        let mut nodes: Vec<Eliminated> = Vec::with_capacity(tree.len());
        // What the groups below take off a node's sums, upper triangles.
        let mut taken: Vec<Option<Square>> = vec![None; tree.len()];
        for node in (0..tree.len()).rev() {
            let off = taken[node].take();
            let own = own_rows(tree, gram, variances, node, off.as_ref());
            let (above, width) = (tree.above(node), tree.width(node));
            let eliminated = eliminate(&own, above, width);
            log_det += (0..width)
                .map(|k| 2.0 * libm::log(eliminated.lower.at(k, k)))
                .sum::<f64>();
            let rest = above + gram.fixed + 1;
            let here = if node == 0 { 0 } else { tree.parent(node) };
            let mut parent = taken[here].take().unwrap_or_else(|| Square::zeros(rest));
            add_without_own(&mut parent, off.as_ref(), above, width);
            add_products(&mut parent, &eliminated.rest, width);
            taken[here] = Some(parent);
            nodes.push(eliminated);
        }
        nodes.reverse();
        let left = left_of_fixed(tree, gram, variances, taken[0].as_ref());
        let (fixed_lower, fixed_response, quadratic) = finish(&left, gram.fixed);
        Self {
            tree,
            gram,
            variances,
            nodes,
            fixed_lower,
            fixed_response,
            log_det,
            quadratic,
        }
    }

    /// y'P y: the squared length of the whitened response after the fixed effects.
    pub fn quadratic(&self) -> f64 {
        self.quadratic
    }

    /// The logarithm of the likelihood.
    pub fn log_likelihood(&self, likelihood: Likelihood) -> f64 {
        let counts = self.gram.counts.iter().zip(&self.variances.noise);
        let noise: f64 = counts
            .map(|(n, s)| *n as f64 * libm::log(TAU * s * s))
            .sum();
        let full = -0.5 * (noise + self.log_det + self.quadratic);
        match likelihood {
            Likelihood::Full => full,
            Likelihood::Restricted => {
                let pivots = (0..self.gram.fixed).map(|k| self.fixed_lower.at(k, k));
                let known: Vec<f64> = pivots.filter(|l| *l > 0.0).collect();
                let log_det: f64 = known.iter().map(|l| 2.0 * libm::log(*l)).sum();
                full - 0.5 * (log_det - known.len() as f64 * libm::log(TAU))
            }
        }
    }

    /// The fixed effects by generalised least squares; 0 where a column is spanned by others.
    pub fn fixed(&self) -> Vec<f64> {
        back_substitute(&self.fixed_lower, &self.fixed_response)
    }

    /// (X'V^-1 X)^-1.
    pub fn fixed_covariance(&self) -> Square {
        let n = self.gram.fixed;
        let mut inverse = Square::zeros(n);
        for j in 0..n {
            if self.fixed_lower.at(j, j) == 0.0 {
                continue;
            }
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            let half = forward(&self.fixed_lower, &unit);
            for (i, v) in back_substitute(&self.fixed_lower, &half)
                .into_iter()
                .enumerate()
            {
                *inverse.at_mut(i, j) = v;
            }
        }
        inverse
    }

    /// Means alone, given the variances.
    pub fn estimates(&self) -> Estimates {
        let tree = self.tree;
        let fixed = self.fixed();
        let mut random = vec![0.0; tree.columns()];
        // For each node e of its path, see [`Self::gradient`].
        let mut known: Vec<Vec<f64>> = Vec::with_capacity(tree.len());
        let at_root: Vec<f64> = fixed.iter().copied().chain([-1.0]).collect();
        for node in 0..tree.len() {
            let above = if node == 0 {
                &at_root
            } else {
                &known[tree.parent(node)]
            };
            let rows = self.solved(node, above.len());
            let own = rows.chunks_exact(above.len()).map(|row| -dot(row, above));
            let first = tree.above(node);
            let here: Vec<f64> = above[..first].iter().copied().chain(own).collect();
            for (k, c) in tree.components_of(node).enumerate() {
                random[tree.first_column(node) + k] =
                    here[first + k] * self.variances.components[c];
            }
            let here = here.into_iter().chain(above[first..].iter().copied());
            known.push(here.collect());
        }
        Estimates { fixed, random }
    }

    /// Covariance of the random effects of the root, in units of their component, and of the fixed effects, given the readings.
    pub fn covariance_at_root(&self) -> Square {
        let fixed = self.fixed_covariance();
        let (n, width) = (fixed.n, self.tree.width(0));
        // Nothing is open of the response.
        let mut above = Square::zeros(n + 1);
        for i in 0..n {
            above.a[i * (n + 1)..i * (n + 1) + n].copy_from_slice(&fixed.a[i * n..(i + 1) * n]);
        }
        let open = self.own_effects(0).expected(&above, 0);
        let components = self.tree.components_of(0);
        let mut scales: Vec<f64> = components.map(|c| self.variances.components[c]).collect();
        scales.resize(width + n, 1.0);
        let mut covariance = Square::zeros(width + n);
        for i in 0..width + n {
            for j in 0..width + n {
                *covariance.at_mut(i, j) = scales[i] * scales[j] * open.at(i, j);
            }
        }
        covariance
    }

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
        let mut others: Vec<Vec<&Part>> = vec![Vec::new(); tree.len()];
        for part in self.gram.parts.iter().filter(|p| p.class > 0) {
            others[part.node].push(part);
        }
        let mut is_parent = vec![false; tree.len()];
        for node in 1..tree.len() {
            is_parent[tree.parent(node)] = true;
        }
        let mut expected: Vec<Option<Square>> = Vec::with_capacity(tree.len());
        let mut sums: Vec<Option<Below>> = Vec::with_capacity(tree.len());
        for node in 0..tree.len() {
            let own = self.own_effects(node);
            let first = tree.above(node);
            let above = expected_of(&expected, tree, node).unwrap_or(&at_root);
            for part in &others[node] {
                let scales = scales(tree, self.variances, part, self.gram.fixed);
                let rows = part.rows.chunks_exact(scales.len());
                by_noise[part.class] += rows
                    .map(|row| {
                        let row: Vec<f64> = row.iter().zip(&scales).map(|(x, s)| x * s).collect();
                        own.expected_square(&row, above, first) - 1.0
                    })
                    .sum::<f64>();
            }
            if node == 0 || is_parent[node] {
                let here = own.expected(above, first);
                for (k, c) in tree.components_of(node).enumerate() {
                    by_components[c] += here.at(first + k, first + k) - 1.0;
                }
                sums.push(Some(Below::new(here.n, by_components.len())));
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
            let mut from = 0;
            for block in tree.blocks(node) {
                let rows = &own.a[from * own.n..(from + block.columns) * own.n];
                add_products(below.component(block.component), rows, block.columns);
                from += block.columns;
            }
        }
        for (below, here) in sums.iter().zip(&expected) {
            if let (Some(below), Some(here)) = (below, here) {
                below.add_to(here, &mut by_components);
            }
        }
        let estimated = match likelihood {
            Likelihood::Full => 0,
            Likelihood::Restricted => {
                let pivots = (0..fixed.len()).filter(|k| self.fixed_lower.at(*k, *k) > 0.0);
                pivots.count()
            }
        };
        // All readings together: y'P y less the squares of the random effects, and the trace of (covariance times products) = columns - what is
        // left open.
        let all = self.quadratic - by_components.iter().sum::<f64>() + estimated as f64
            - self.gram.count() as f64;
        by_noise[0] = all - by_noise.iter().sum::<f64>();
        (by_components, by_noise)
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
    fn own_effects(&self, node: usize) -> OwnEffects {
        let eliminated = &self.nodes[node];
        let width = self.tree.width(node);
        let n = self.tree.above(node) + self.gram.fixed + 1;
        OwnEffects {
            width,
            n,
            a: self.solved(node, n),
            open: inverse_of(&eliminated.lower),
        }
    }

    /// L^-T times what a node's rows hold beside it: columns above, fixed effects, response.
    fn solved(&self, node: usize, stride: usize) -> Vec<f64> {
        let eliminated = &self.nodes[node];
        let width = self.tree.width(node);
        let mut a = eliminated.rest.clone();
        for k in (0..width).rev() {
            let (head, below) = a.split_at_mut((k + 1) * stride);
            let row = &mut head[k * stride..];
            for l in k + 1..width {
                let known = &below[(l - k - 1) * stride..(l - k) * stride];
                add_times(row, -eliminated.lower.at(l, k), known);
            }
            let pivot = 1.0 / eliminated.lower.at(k, k);
            for v in row {
                *v *= pivot;
            }
        }
        a
    }

    /// What is left of further columns c after whitening and projecting off the fixed effects: c'P c and c'P y.
    pub fn project(&self, panel: &Panel) -> Projected {
        let width = panel.columns;
        let tail = self.gram.fixed + 1;
        let mut fronts: Vec<Vec<f64>> = (0..self.tree.len())
            .map(|n| vec![0.0; (self.tree.path_columns(n) + tail) * width])
            .collect();
        let mut squares = vec![0.0; width];
        for (part, sums) in self.gram.parts.iter().zip(&panel.parts) {
            let s = scales(self.tree, self.variances, part, self.gram.fixed);
            let noise = 1.0 / self.variances.noise[part.class];
            let front = &mut fronts[part.node];
            for (i, scale) in s.iter().enumerate() {
                let factor = scale * noise;
                let to = &mut front[i * width..(i + 1) * width];
                add_times(to, factor, &sums.products[i * width..(i + 1) * width]);
            }
            add_times(&mut squares, noise * noise, &sums.squares);
        }
        for node in (0..self.tree.len()).rev() {
            let mut front = std::mem::take(&mut fronts[node]);
            let (above, own) = (self.tree.above(node), self.tree.width(node));
            self.pass(node, &mut front, width, &mut squares);
            let rest = above + tail;
            let parent = if node == 0 { 0 } else { self.tree.parent(node) };
            if node == 0 {
                front.drain(above * width..(above + own) * width);
                fronts[0] = front;
            } else {
                let to = &mut fronts[parent];
                for j in 0..rest {
                    let from = if j < above { j } else { j + own };
                    add_times(
                        &mut to[j * width..(j + 1) * width],
                        1.0,
                        &front[from * width..(from + 1) * width],
                    );
                }
            }
        }
        self.finish_projection(&fronts[0], squares)
    }

    /// Eliminates a node's own rows of a panel.
    fn pass(&self, node: usize, front: &mut [f64], width: usize, squares: &mut [f64]) {
        let (above, own) = (self.tree.above(node), self.tree.width(node));
        let eliminated = &self.nodes[node];
        for k in 0..own {
            let (done, rest) = front.split_at_mut((above + k) * width);
            let row = &mut rest[..width];
            for l in 0..k {
                let known = &done[(above + l) * width..(above + l + 1) * width];
                add_times(row, -eliminated.lower.at(k, l), known);
            }
            let pivot = 1.0 / eliminated.lower.at(k, k);
            for (v, s) in row.iter_mut().zip(squares.iter_mut()) {
                *v *= pivot;
                *s -= *v * *v;
            }
        }
        let stride = above + self.gram.fixed + 1;
        for k in 0..own {
            let row: Vec<f64> = front[(above + k) * width..(above + k + 1) * width].to_vec();
            for j in 0..stride {
                let to = if j < above { j } else { j + own };
                let factor = eliminated.rest[k * stride + j];
                add_times(&mut front[to * width..(to + 1) * width], -factor, &row);
            }
        }
    }

    fn finish_projection(&self, front: &[f64], mut squares: Vec<f64>) -> Projected {
        let width = squares.len();
        let p = self.gram.fixed;
        let mut scores = front[p * width..(p + 1) * width].to_vec();
        let before = squares.clone();
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(p);
        for k in 0..p {
            let mut row = front[k * width..(k + 1) * width].to_vec();
            for (l, known) in rows.iter().enumerate() {
                add_times(&mut row, -self.fixed_lower.at(k, l), known);
            }
            let pivot = self.fixed_lower.at(k, k);
            let inverse = if pivot > 0.0 { 1.0 / pivot } else { 0.0 };
            for (j, v) in row.iter_mut().enumerate() {
                *v *= inverse;
                squares[j] -= *v * *v;
                scores[j] -= *v * self.fixed_response[k];
            }
            rows.push(row);
        }
        Projected {
            unprojected: before,
            squares,
            scores,
        }
    }
}

/// The own random effects of a node, -A e of its parent plus what is left open.
struct OwnEffects {
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
    fn expected(&self, above: &Square, first: usize) -> Square {
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

    /// Expected square of a row of the path's columns, fixed effects and response times e of the node, from E of its parent.
    fn expected_square(&self, row: &[f64], above: &Square, first: usize) -> f64 {
        let (own, width) = (&row[first..first + self.width], self.width);
        let mut rest: Vec<f64> = row[..first]
            .iter()
            .chain(&row[first + width..])
            .copied()
            .collect();
        for (x, a) in own.iter().zip(self.a.chunks_exact(self.n)) {
            add_times(&mut rest, -x, a);
        }
        quadratic_form(&rest, above) + quadratic_form(own, &self.open)
    }
}

/// Matrices, upper triangles, that are to be multiplied with E of a node: from the nodes below it that have none below them.
struct Below {
    n: usize,
    components: Vec<Option<Square>>,
}

impl Below {
    fn new(n: usize, components: usize) -> Self {
        Self {
            n,
            components: vec![None; components],
        }
    }

    fn component(&mut self, component: usize) -> &mut Square {
        self.components[component].get_or_insert_with(|| Square::zeros(self.n))
    }

    fn add_to(&self, expected: &Square, by_components: &mut [f64]) {
        for (matrix, sum) in self.components.iter().zip(by_components) {
            *sum += matrix
                .as_ref()
                .map_or(0.0, |m| product_of_upper(m, expected));
        }
    }
}

/// E of the parent of a node; none of the root's.
fn expected_of<'e>(expected: &'e [Option<Square>], tree: &Tree, node: usize) -> Option<&'e Square> {
    (node > 0).then(|| expected[tree.parent(node)].as_ref())?
}

/// x'A x.
fn quadratic_form(x: &[f64], a: &Square) -> f64 {
    let rows = a.a.chunks_exact(a.n).zip(x);
    rows.map(|(row, factor)| factor * dot(row, x)).sum()
}

/// Sum of the products of all entries of two symmetric matrices, of the first of which the upper triangle counts.
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

/// Products of further columns with those of a design.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Number of columns.
    pub columns: usize,
    /// One entry for each part of the Gram.
    pub parts: Vec<PanelPart>,
}

/// Products in one part.
#[derive(Clone, Debug)]
pub struct PanelPart {
    /// Rows: path, fixed effects, response; by columns of the panel.
    pub products: Vec<f64>,
    /// Squares of the columns.
    pub squares: Vec<f64>,
}

/// What is left of a panel's columns.
#[derive(Clone, Debug)]
pub struct Projected {
    /// c'V^-1 c.
    pub unprojected: Vec<f64>,
    /// c'P c.
    pub squares: Vec<f64>,
    /// c'P y.
    pub scores: Vec<f64>,
}

impl Panel {
    /// The products of columns, one list of all readings each, with a design.
    pub fn new(design: &crate::gram::Design, columns: &[Vec<f64>]) -> Self {
        let width = columns.len();
        let parts = design
            .members()
            .into_iter()
            .map(|(node, _, list)| {
                let rows = design.tree.path_columns(node) + design.x.len() + 1;
                // Column after column here, row after row in the end.
                let mut by_column = vec![0.0; rows * width];
                let mut squares = vec![0.0; width];
                let mut row = vec![0.0; rows];
                for &i in &list {
                    design.row(i, &mut row);
                    let own = by_column.chunks_exact_mut(rows).zip(columns);
                    for ((products, column), square) in own.zip(&mut squares) {
                        let value = column[i];
                        *square += value * value;
                        add_times(products, value, &row);
                    }
                }
                let mut products = vec![0.0; rows * width];
                for (j, column) in by_column.chunks_exact(rows).enumerate() {
                    for (k, x) in column.iter().enumerate() {
                        products[k * width + j] = *x;
                    }
                }
                PanelPart { products, squares }
            })
            .collect();
        Self {
            columns: width,
            parts,
        }
    }

    /// The products with the readings of some nodes only.
    pub fn of_active(
        design: &crate::gram::Design,
        columns: &[Vec<f64>],
        active: impl Fn(usize) -> bool,
    ) -> Self {
        let mut panel = Self::new(design, columns);
        let kept = design.members().into_iter().zip(panel.parts);
        panel.parts = kept
            .filter(|((node, _, _), _)| active(*node))
            .map(|(_, part)| part)
            .collect();
        panel
    }
}

/// Rows of a node's own columns in the system: scaled sums less what the groups below take off. Columns of the path, fixed effects, response.
fn own_rows(
    tree: &Tree,
    gram: &Gram,
    variances: &Variances,
    node: usize,
    off: Option<&Square>,
) -> Square {
    let (above, width) = (tree.above(node), tree.width(node));
    let n = above + width + gram.fixed + 1;
    let mut rows = Square {
        n,
        a: vec![0.0; width * n],
    };
    for (class, noise) in variances.noise.iter().enumerate() {
        if let Some((sums, response)) = gram.total(node, class) {
            let factor = 1.0 / (noise * noise);
            for (k, row) in rows.a.chunks_exact_mut(n).enumerate() {
                let from = &sums.a[(above + k) * (n - 1)..(above + k + 1) * (n - 1)];
                add_times(&mut row[..n - 1], factor, from);
                row[n - 1] += factor * response[above + k];
            }
        }
    }
    let of = tree.path_components(node).iter();
    let mut scale: Vec<f64> = of.map(|c| variances.components[*c]).collect();
    scale.resize(n, 1.0);
    for k in 0..width {
        let row = &mut rows.a[k * n..(k + 1) * n];
        for (x, s) in row.iter_mut().zip(&scale) {
            *x *= scale[above + k] * s;
        }
        if let Some(off) = off {
            let (before, behind) = row.split_at_mut(above + k);
            for (j, x) in before.iter_mut().enumerate() {
                *x -= off.at(j, above + k);
            }
            let line = &off.a[(above + k) * n + above + k..(above + k + 1) * n];
            for (x, y) in behind.iter_mut().zip(line) {
                *x -= y;
            }
        }
    }
    rows
}

/// Eliminates a node's own columns, to which 1 is added on the diagonal (the prior precision).
fn eliminate(own: &Square, first: usize, width: usize) -> Eliminated {
    let n = own.n;
    let stride = n - width;
    let mut lower = Square::zeros(width);
    let mut rest = vec![0.0; width * stride];
    for k in 0..width {
        let mut pivot = own.at(k, first + k) + 1.0;
        for l in 0..k {
            pivot -= lower.at(k, l) * lower.at(k, l);
        }
        let root = pivot.max(f64::MIN_POSITIVE).sqrt();
        *lower.at_mut(k, k) = root;
        for m in k + 1..width {
            let mut x = own.at(k, first + m);
            for l in 0..k {
                x -= lower.at(m, l) * lower.at(k, l);
            }
            *lower.at_mut(m, k) = x / root;
        }
        let (done, row) = rest.split_at_mut(k * stride);
        let row = &mut row[..stride];
        row[..first].copy_from_slice(&own.a[k * n..k * n + first]);
        row[first..].copy_from_slice(&own.a[k * n + first + width..(k + 1) * n]);
        for l in 0..k {
            add_times(row, -lower.at(k, l), &done[l * stride..(l + 1) * stride]);
        }
        let inverse = 1.0 / root;
        for slot in row {
            *slot *= inverse;
        }
    }
    Eliminated { lower, rest }
}

/// Adds R'R, upper triangle, R of so many rows.
fn add_products(to: &mut Square, r: &[f64], rows: usize) {
    let n = to.n;
    let blocks = rows / 4;
    for i in 0..n {
        let line = &mut to.a[i * n + i..(i + 1) * n];
        for block in 0..blocks {
            let row = |k: usize| &r[(4 * block + k) * n + i..(4 * block + k + 1) * n];
            add_four(line, [row(0), row(1), row(2), row(3)]);
        }
        for k in 4 * blocks..rows {
            let row = &r[k * n + i..(k + 1) * n];
            add_times(line, row[0], row);
        }
    }
}

/// Adds four rows, each times its first entry.
#[inline]
fn add_four(to: &mut [f64], rows: [&[f64]; 4]) {
    let factors = rows.map(|r| r[0]);
    let [a, b, c, d] = rows;
    for ((((t, a), b), c), d) in to.iter_mut().zip(a).zip(b).zip(c).zip(d) {
        *t += factors[0] * a + factors[1] * b + (factors[2] * c + factors[3] * d);
    }
}

/// Adds the rows of a matrix, each times a factor.
fn add_combination(to: &mut [f64], factors: &[f64], rows: &[f64]) {
    let n = to.len();
    let (factors4, rows4) = (factors.chunks_exact(4), rows.chunks_exact(4 * n));
    let tail = factors4.remainder().iter();
    for (factor, row) in tail.zip(rows4.remainder().chunks_exact(n)) {
        add_times(to, *factor, row);
    }
    for (f, four) in factors4.zip(rows4) {
        let (a, rest) = four.split_at(n);
        let (b, rest) = rest.split_at(n);
        let (c, d) = rest.split_at(n);
        for ((((t, a), b), c), d) in to.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            *t += f[0] * a + f[1] * b + (f[2] * c + f[3] * d);
        }
    }
}

/// Adds a matrix of which the upper triangle counts, without a node's own rows and columns.
fn add_without_own(to: &mut Square, from: Option<&Square>, first: usize, width: usize) {
    let Some(from) = from else { return };
    for i in 0..to.n {
        let row = if i < first { i } else { i + width };
        let line = &from.a[row * from.n..(row + 1) * from.n];
        let slots = &mut to.a[i * to.n..(i + 1) * to.n];
        if i < first {
            add_times(&mut slots[i..first], 1.0, &line[i..first]);
            add_times(&mut slots[first..], 1.0, &line[first + width..]);
        } else {
            add_times(&mut slots[i..], 1.0, &line[row..]);
        }
    }
}

/// The sums of fixed effects and response, less what the random effects take off.
fn left_of_fixed(tree: &Tree, gram: &Gram, variances: &Variances, off: Option<&Square>) -> Square {
    let n = gram.fixed + 1;
    let first = tree.width(0);
    let mut left = Square::zeros(n);
    for i in 0..n {
        for j in i..n {
            let noise = variances.noise.iter().enumerate();
            let sum: f64 = noise
                .filter_map(|(class, s)| Some((gram.total(0, class)?, s)))
                .map(|((sums, response), s)| {
                    let product = if j + 1 < n {
                        sums.at(first + i, first + j)
                    } else {
                        response[first + i]
                    };
                    product / (s * s)
                })
                .sum();
            let value = sum - off.map_or(0.0, |o| o.at(i, j));
            *left.at_mut(i, j) = value;
            *left.at_mut(j, i) = value;
        }
    }
    left
}

/// Factor of X'V^-1 X, L^-1 X'V^-1 y and y'P y, from what is left at the root.
fn finish(front: &Square, p: usize) -> (Square, Vec<f64>, f64) {
    let mut lower = Square::zeros(p);
    for j in 0..p {
        let mut pivot = front.at(j, j);
        for k in 0..j {
            pivot -= lower.at(j, k) * lower.at(j, k);
        }
        if pivot <= NO_PIVOT * front.at(j, j) || pivot <= 0.0 {
            continue;
        }
        let root = pivot.sqrt();
        *lower.at_mut(j, j) = root;
        for i in j + 1..p {
            let mut x = front.at(i, j);
            for k in 0..j {
                x -= lower.at(i, k) * lower.at(j, k);
            }
            *lower.at_mut(i, j) = x / root;
        }
    }
    let right: Vec<f64> = (0..p).map(|i| front.at(i, p)).collect();
    let half = forward(&lower, &right);
    let quadratic = front.at(p, p) - dot(&half, &half);
    (lower, half, quadratic)
}

/// L^-1 b; 0 where there is no pivot.
pub(crate) fn forward(lower: &Square, b: &[f64]) -> Vec<f64> {
    let mut x = vec![0.0; b.len()];
    for i in 0..b.len() {
        let pivot = lower.at(i, i);
        if pivot > 0.0 {
            let known = dot(&lower.a[i * lower.n..i * lower.n + i], &x[..i]);
            x[i] = (b[i] - known) / pivot;
        }
    }
    x
}

/// L^-T b; 0 where there is no pivot.
pub(crate) fn back_substitute(lower: &Square, b: &[f64]) -> Vec<f64> {
    let n = b.len();
    let mut x = vec![0.0; n];
    for i in (0..n).rev() {
        let pivot = lower.at(i, i);
        if pivot > 0.0 {
            let known: f64 = (i + 1..n).map(|k| lower.at(k, i) * x[k]).sum();
            x[i] = (b[i] - known) / pivot;
        }
    }
    x
}

/// (L L')^-1 of a factor without missing pivots.
fn inverse_of(lower: &Square) -> Square {
    let n = lower.n;
    // L^-1, by columns: row j of `inverse` is its column j.
    let mut inverse = Square::zeros(n);
    for j in 0..n {
        let column = &mut inverse.a[j * n..(j + 1) * n];
        column[j] = 1.0 / lower.at(j, j);
        for i in j + 1..n {
            let known: f64 = (j..i).map(|k| lower.at(i, k) * column[k]).sum();
            column[i] = -known / lower.at(i, i);
        }
    }
    let mut product = Square::zeros(n);
    for i in 0..n {
        for j in 0..=i {
            let columns = [i, j].map(|k| &inverse.a[k * n + i..(k + 1) * n]);
            let value = dot(columns[0], columns[1]);
            *product.at_mut(i, j) = value;
            *product.at_mut(j, i) = value;
        }
    }
    product
}

/// Scalar product in four partial sums, in a fixed order.
#[inline]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let tail: f64 = a4
        .remainder()
        .iter()
        .zip(b4.remainder())
        .map(|(x, y)| x * y)
        .sum();
    for (x, y) in a4.zip(b4) {
        for (s, (x, y)) in sums.iter_mut().zip(x.iter().zip(y)) {
            *s += x * y;
        }
    }
    sums.iter().sum::<f64>() + tail
}

#[inline]
pub(crate) fn add_times(to: &mut [f64], factor: f64, from: &[f64]) {
    for (t, f) in to.iter_mut().zip(from) {
        *t += factor * f;
    }
}
