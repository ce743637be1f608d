//! Sums of products: all that the likelihood needs of the readings while sensitivities are frozen.
//!
//! For every node with readings, the products of D = [z | x | y] with one another, z the columns of its path, x the fixed effects, y the response, one
//! set for each class of noise. Whatever the variances, marginal likelihood, its gradient, estimates and predictions follow from
//! these alone ([`crate::system`]). What y takes part in stands apart: a draw of a bootstrap costs a vector a node, and shares the rest.

use crate::system::add_times;
use crate::tree::Tree;
use rayon::prelude::*;
use std::sync::Arc;

/// A square matrix by rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Square {
    /// Rows, and columns.
    pub n: usize,
    /// Entries, row after row.
    pub a: Vec<f64>,
}

impl Square {
    /// Zeros.
    pub fn zeros(n: usize) -> Self {
        Self {
            n,
            a: vec![0.0; n * n],
        }
    }

    /// Ones on the diagonal.
    pub fn identity(n: usize) -> Self {
        let mut one = Self::zeros(n);
        for k in 0..n {
            one.a[k * n + k] = 1.0;
        }
        one
    }

    /// An entry.
    #[inline]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.a[i * self.n + j]
    }

    /// Adds a matrix without its rows and columns `first..first + width`.
    fn add_without(&mut self, other: &Square, first: usize, width: usize) {
        for i in 0..self.n {
            let from = if i < first { i } else { i + width };
            let line = &other.a[from * other.n..(from + 1) * other.n];
            let to = &mut self.a[i * self.n..(i + 1) * self.n];
            let kept = line[..first].iter().chain(&line[first + width..]);
            for (slot, x) in to.iter_mut().zip(kept) {
                *slot += x;
            }
        }
    }

    /// An entry for writing.
    #[inline]
    pub fn at_mut(&mut self, i: usize, j: usize) -> &mut f64 {
        &mut self.a[i * self.n + j]
    }
}

/// The linear mixed model of an outer iteration: response, fixed effects and random effects of every reading.
#[derive(Clone, Debug)]
pub struct Design {
    /// The groups.
    pub tree: Tree,
    /// Node of each reading.
    pub node: Vec<usize>,
    /// Class of noise of each reading.
    pub class: Vec<usize>,
    /// Number of classes.
    pub classes: usize,
    /// Columns of random effects: for each reading those of its path. Designs with other fixed effects share them.
    pub z: Arc<Vec<Vec<f64>>>,
    /// Fixed effects, one list of all readings a column.
    pub x: Vec<Vec<f64>>,
    /// Response.
    pub y: Vec<f64>,
}

/// The sums of one node and one class.
#[derive(Clone, Debug)]
pub struct Part {
    /// Node.
    pub node: usize,
    /// Class of noise.
    pub class: usize,
    /// The readings.
    pub readings: Arc<Vec<usize>>,
    /// C'C, C the path's columns first, then the fixed effects: shared by all responses.
    pub products: Arc<Square>,
    /// Products of C, and then of the columns that stand apart, with these: row after row. At least the response stands apart.
    pub beside: Vec<f64>,
    /// The rows of D, of the classes of noise after the first: their gradient is cheaper by rows.
    pub rows: Vec<f64>,
}

/// The sums of a design.
#[derive(Clone, Debug)]
pub struct Gram {
    /// Number of fixed effects.
    pub fixed: usize,
    /// How many columns stand apart: fixed effects that were added, and the response as the last one.
    pub apart: usize,
    /// Readings in each class.
    pub counts: Vec<usize>,
    /// One entry a node and class with readings, by node.
    pub parts: Vec<Part>,
    /// For each node and class the sums over the readings of the node and of all below it.
    totals: Vec<Total>,
}

/// Where the sums over the readings of a node and all below it are.
#[derive(Clone, Debug)]
enum Total {
    /// There are no readings.
    None,
    /// In this part.
    Part(usize),
    /// Here: as in a part.
    Sum(Arc<Square>, Vec<f64>),
}

impl Design {
    /// Number of readings.
    pub fn len(&self) -> usize {
        self.y.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.y.is_empty()
    }

    /// The readings of each node and class, by node.
    pub fn members(&self) -> Vec<(usize, usize, Vec<usize>)> {
        let mut lists = vec![Vec::new(); self.tree.len() * self.classes];
        for (i, (node, class)) in self.node.iter().zip(&self.class).enumerate() {
            lists[node * self.classes + class].push(i);
        }
        let named = lists.into_iter().enumerate();
        named
            .filter(|(_, list)| !list.is_empty())
            .map(|(k, list)| (k / self.classes, k % self.classes, list))
            .collect()
    }

    /// The sums of products.
    pub fn gram(&self) -> Gram {
        self.gram_of(|_| true)
    }

    /// The sums of products over the readings of some nodes.
    pub fn gram_of(&self, active: impl Fn(usize) -> bool) -> Gram {
        let mut members = self.members();
        members.retain(|(node, ..)| active(*node));
        let part = |(node, class, list): (usize, usize, Vec<usize>)| {
            let path = self.tree.path_columns(node);
            let n = path + self.x.len() + 1;
            let mut products = Square::zeros(n - 1);
            let mut response = vec![0.0; n];
            let mut row = vec![0.0; n];
            let mut rows = Vec::new();
            for &i in &list {
                self.row(i, &mut row);
                add_outer(&mut products, &row[..n - 1]);
                add_times(&mut response, self.y[i], &row);
                if class > 0 {
                    rows.extend_from_slice(&row);
                }
            }
            mirror(&mut products);
            Part {
                node,
                class,
                readings: Arc::new(list),
                products: Arc::new(products),
                beside: response,
                rows,
            }
        };
        let parts: Vec<Part> = members.into_par_iter().map(part).collect();
        let mut counts = vec![0; self.classes];
        for part in &parts {
            counts[part.class] += part.readings.len();
        }
        Gram::new(&self.tree, self.x.len(), counts, parts)
    }

    /// The sums of products with further fixed effects behind those that sums are known of: they stand apart with the response, and the rest is
    /// shared.
    pub fn gram_with(&self, gram: &Gram, extra: &[&[f64]]) -> Gram {
        let apart = extra.len() + 1;
        let with = |part: &Part| {
            let n = part.products.n;
            let mut beside = vec![0.0; (n + apart) * apart];
            let mut row = vec![0.0; n + apart];
            let mut rows = Vec::new();
            for &i in part.readings.iter() {
                self.row(i, &mut row[..=n]);
                let columns = extra.iter().map(|column| column[i]).chain([self.y[i]]);
                row.truncate(n);
                row.extend(columns);
                for (to, x) in beside.chunks_exact_mut(apart).zip(&row) {
                    add_times(to, *x, &row[n..]);
                }
                if part.class > 0 {
                    rows.extend_from_slice(&row);
                }
            }
            Part {
                readings: part.readings.clone(),
                products: part.products.clone(),
                beside,
                rows,
                ..*part
            }
        };
        let parts = gram.parts.iter().map(with).collect();
        let sum = |total: &Total| match total {
            Total::Sum(sum, _) => Total::Sum(sum.clone(), vec![0.0; (sum.n + apart) * apart]),
            Total::None | Total::Part(_) => total.clone(),
        };
        let mut wide = Gram {
            fixed: gram.fixed + extra.len(),
            apart,
            counts: gram.counts.clone(),
            parts,
            totals: gram.totals.iter().map(sum).collect(),
        };
        wide.add_up_beside(&self.tree);
        wide
    }

    /// Columns of the path, fixed effects and response of reading `i`.
    pub(crate) fn row(&self, i: usize, row: &mut [f64]) {
        let path = self.z[i].len();
        row[..path].copy_from_slice(&self.z[i]);
        for (slot, column) in row[path..].iter_mut().zip(&self.x) {
            *slot = column[i];
        }
        row[path + self.x.len()] = self.y[i];
    }

    /// Sums of some or all of this design's nodes, with further fixed effects behind its own and another response.
    pub fn with_response_of(&self, gram: &Gram, extra: &[&[f64]], y: &[f64]) -> Gram {
        let mut answer = gram.clone();
        let apart = gram.apart;
        for part in &mut answer.parts {
            let n = part.products.n;
            let path = n - (gram.fixed + 1 - apart);
            let last = n + apart - 1;
            let mut response = vec![0.0; n + apart];
            for &i in part.readings.iter() {
                let (of_path, others) = response.split_at_mut(path);
                add_times(of_path, y[i], &self.z[i]);
                let columns = self.x.iter().map(Vec::as_slice);
                for (s, column) in others.iter_mut().zip(columns.chain(extra.iter().copied())) {
                    *s += column[i] * y[i];
                }
                response[last] += y[i] * y[i];
            }
            for (to, product) in part.beside.chunks_exact_mut(apart).zip(&response) {
                to[apart - 1] = *product;
            }
            part.beside[last * apart..].copy_from_slice(&response[n..]);
            let rows = part.rows.chunks_exact_mut(last + 1);
            for (row, &i) in rows.zip(part.readings.iter()) {
                row[last] = y[i];
            }
        }
        answer.add_up_beside(&self.tree);
        answer
    }
}

impl Gram {
    fn new(tree: &Tree, fixed: usize, counts: Vec<usize>, parts: Vec<Part>) -> Self {
        let mut gram = Self {
            fixed,
            apart: 1,
            counts,
            parts,
            totals: Vec::new(),
        };
        gram.add_up(tree);
        gram
    }

    fn add_up(&mut self, tree: &Tree) {
        let classes = self.counts.len();
        self.totals = vec![Total::None; tree.len() * classes];
        for (k, part) in self.parts.iter().enumerate() {
            self.totals[part.node * classes + part.class] = Total::Part(k);
        }
        for node in (1..tree.len()).rev() {
            let (above, width) = (tree.above(node), tree.width(node));
            for class in 0..classes {
                let place = tree.parent(node) * classes + class;
                if matches!(self.totals[node * classes + class], Total::None) {
                    continue;
                }
                let of_parent = std::mem::replace(&mut self.totals[place], Total::None);
                let (mut sum, beside) = match of_parent {
                    Total::Sum(sum, beside) => (sum, beside),
                    Total::Part(k) => {
                        let part = &self.parts[k];
                        (part.products.clone(), part.beside.clone())
                    }
                    Total::None => {
                        let n = above + self.fixed;
                        (Arc::new(Square::zeros(n)), vec![0.0; n + 1])
                    }
                };
                if let Some((below, _)) = self.total(node, class) {
                    Arc::make_mut(&mut sum).add_without(below, above, width);
                }
                self.totals[place] = Total::Sum(sum, beside);
            }
        }
        self.add_up_beside(tree);
    }

    /// The sums of what stands apart, of all nodes, from those of the parts.
    fn add_up_beside(&mut self, tree: &Tree) {
        let (classes, apart) = (self.counts.len(), self.apart);
        for total in &mut self.totals {
            if let Total::Sum(_, beside) = total {
                beside.fill(0.0);
            }
        }
        for part in &self.parts {
            if let Total::Sum(_, beside) = &mut self.totals[part.node * classes + part.class] {
                add_times(beside, 1.0, &part.beside);
            }
        }
        for node in (1..tree.len()).rev() {
            let first = tree.above(node) * apart;
            let behind_own = first + tree.width(node) * apart;
            for class in 0..classes {
                let (before, behind) = self.totals.split_at_mut(node * classes);
                let below = match &behind[class] {
                    Total::None => continue,
                    Total::Part(k) => &self.parts[*k].beside,
                    Total::Sum(_, beside) => beside,
                };
                if let Total::Sum(_, to) = &mut before[tree.parent(node) * classes + class] {
                    add_times(&mut to[..first], 1.0, &below[..first]);
                    add_times(&mut to[first..], 1.0, &below[behind_own..]);
                }
            }
        }
    }

    /// The sums over the readings of a node and all below it, of one class of noise: C'C, and the products of what stands apart as in a part.
    pub(crate) fn total(&self, node: usize, class: usize) -> Option<(&Square, &[f64])> {
        match &self.totals[node * self.counts.len() + class] {
            Total::None => None,
            Total::Part(k) => Some((&self.parts[*k].products, &self.parts[*k].beside)),
            Total::Sum(sum, beside) => Some((sum, beside)),
        }
    }

    /// Readings.
    pub fn count(&self) -> usize {
        self.counts.iter().sum()
    }
}

/// Adds the upper triangle of `row row'`.
fn add_outer(products: &mut Square, row: &[f64]) {
    let n = products.n;
    for (i, a) in row.iter().enumerate() {
        if *a == 0.0 {
            continue;
        }
        let line = &mut products.a[i * n + i..(i + 1) * n];
        for (slot, b) in line.iter_mut().zip(&row[i..]) {
            *slot += a * b;
        }
    }
}

fn mirror(products: &mut Square) {
    for i in 0..products.n {
        for j in 0..i {
            *products.at_mut(i, j) = products.at(j, i);
        }
    }
}
