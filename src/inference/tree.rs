//! The hierarchy of groups: which columns of random effects act on a reading.
//!
//! A node is a group (a specimen, a session, a log, …); the root stands for all readings. Every node carries *blocks*, each of so many
//! columns of one component. A reading belongs to one node, and the columns of all nodes from the root to that node act on it: its *path*.

/// Columns of one component in one group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// Number of the component.
    pub component: usize,
    /// Number of columns.
    pub columns: usize,
}

/// The groups of a problem; a parent stands before its children, the root first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tree {
    parents: Vec<usize>,
    blocks: Vec<Vec<Block>>,
    /// Columns of the path above a node.
    above: Vec<usize>,
    /// Columns of a node.
    widths: Vec<usize>,
    /// Number of a node's first column among all.
    first: Vec<usize>,
    /// For each column of the path of a node: its component.
    components: Vec<Vec<usize>>,
}

impl Tree {
    /// A tree of the root alone.
    pub fn new(root: Vec<Block>) -> Self {
        let mut tree = Self::default();
        tree.push(0, 0, root);
        tree
    }

    /// Adds a group below another; its number.
    ///
    /// # Panics
    /// If there is no such parent.
    pub fn add(&mut self, parent: usize, blocks: Vec<Block>) -> usize {
        assert!(parent < self.len(), "a parent stands before its children");
        self.push(parent, self.path_columns(parent), blocks);
        self.len() - 1
    }

    fn push(&mut self, parent: usize, above: usize, blocks: Vec<Block>) {
        let width = blocks.iter().map(|b| b.columns).sum();
        let own = blocks
            .iter()
            .flat_map(|b| std::iter::repeat_n(b.component, b.columns));
        let path = self.components.get(parent).cloned().unwrap_or_default();
        self.components.push(path.into_iter().chain(own).collect());
        self.first.push(self.columns());
        self.parents.push(parent);
        self.blocks.push(blocks);
        self.above.push(above);
        self.widths.push(width);
    }

    /// The same groups with further columns at the root, behind its own.
    pub fn with_at_root(&self, block: Block) -> Self {
        let mut blocks = self.blocks.iter().cloned();
        let root = blocks.next().into_iter().flatten();
        let mut tree = Self::new(root.chain([block]).collect());
        for (parent, blocks) in self.parents.iter().skip(1).zip(blocks) {
            tree.add(*parent, blocks);
        }
        tree
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.parents.len()
    }

    /// Whether there is not even a root.
    pub fn is_empty(&self) -> bool {
        self.parents.is_empty()
    }

    /// The parent of a node; of the root, the root.
    pub fn parent(&self, node: usize) -> usize {
        self.parents[node]
    }

    /// Columns of the groups above a node.
    pub fn above(&self, node: usize) -> usize {
        self.above[node]
    }

    /// Columns of a node itself.
    pub fn width(&self, node: usize) -> usize {
        self.widths[node]
    }

    /// Columns that act on the readings of a node.
    pub fn path_columns(&self, node: usize) -> usize {
        self.above[node] + self.widths[node]
    }

    /// Columns of all nodes.
    pub fn columns(&self) -> usize {
        self.widths.iter().sum()
    }

    /// Number of a node's first column among all columns.
    pub fn first_column(&self, node: usize) -> usize {
        self.first[node]
    }

    /// The blocks of a node.
    pub fn blocks(&self, node: usize) -> &[Block] {
        &self.blocks[node]
    }

    /// The nodes from the root to a node.
    pub fn path(&self, node: usize) -> Vec<usize> {
        let mut path = vec![node];
        let mut at = node;
        while at != 0 {
            at = self.parents[at];
            path.push(at);
        }
        path.reverse();
        path
    }

    /// For each column of the path of a node: its number among all columns.
    pub fn path_numbers(&self, node: usize) -> Vec<usize> {
        let of = |n: usize| self.first[n]..self.first[n] + self.widths[n];
        self.path(node).into_iter().flat_map(of).collect()
    }

    /// For each of a node's own columns: its component.
    pub fn components_of(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        self.components[node][self.above[node]..].iter().copied()
    }

    /// For each column of the path of a node: its component.
    pub fn path_components(&self, node: usize) -> &[usize] {
        &self.components[node]
    }

    /// The number of a node's first column of a component among all columns, and how many there are.
    pub fn columns_of(&self, node: usize, component: usize) -> Option<(usize, usize)> {
        let mut first = self.first[node];
        for block in &self.blocks[node] {
            if block.component == component {
                return Some((first, block.columns));
            }
            first += block.columns;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_run_from_the_root_and_columns_are_numbered_by_node() {
        let block = |component, columns| Block { component, columns };
        let mut tree = Tree::new(vec![block(0, 2)]);
        let a = tree.add(0, vec![block(1, 1)]);
        let b = tree.add(a, vec![block(2, 1), block(3, 3)]);
        let c = tree.add(0, vec![block(1, 1)]);
        assert_eq!(tree.path(b), [0, a, b]);
        assert_eq!(
            (tree.above(b), tree.width(b), tree.path_columns(b)),
            (3, 4, 7)
        );
        assert_eq!(tree.path_numbers(b), [0, 1, 2, 3, 4, 5, 6]);
        assert_eq!(tree.path_numbers(c), [0, 1, 7]);
        assert_eq!(tree.columns_of(b, 3), Some((4, 3)));
        assert_eq!(tree.columns_of(c, 3), None);
        assert_eq!(tree.components_of(b).collect::<Vec<_>>(), [2, 3, 3, 3]);
        let wider = tree.with_at_root(block(4, 2));
        assert_eq!(wider.path_numbers(b), [0, 1, 2, 3, 4, 5, 6, 7, 8]);
        assert_eq!(wider.columns_of(0, 4), Some((2, 2)));
        assert_eq!(wider.parent(b), a);
    }
}
