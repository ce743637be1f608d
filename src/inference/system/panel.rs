//! Further columns beside a design: their products with it, and what is left of them after whitening and projecting off the fixed effects.

use super::kernels::add_times;
use super::{Factor, scales};
use crate::gram::{Design, Gram};

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
    /// The products of columns, one list of all readings each, with a design, over the readings of its sums.
    pub fn new(design: &Design, gram: &Gram, columns: &[Vec<f64>]) -> Self {
        let width = columns.len();
        let parts = gram
            .parts
            .iter()
            .map(|part| {
                let rows = design.tree.path_columns(part.node) + design.x.len() + 1;
                // Column after column here, row after row in the end.
                let mut by_column = vec![0.0; rows * width];
                let mut squares = vec![0.0; width];
                let mut row = vec![0.0; rows];
                for &i in part.readings.iter() {
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
}

impl Factor<'_> {
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
        if eliminated.idle {
            return;
        }
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
