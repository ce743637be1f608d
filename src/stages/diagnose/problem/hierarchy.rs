//! The groups of the readings as a tree: specimens, sessions, strokes. What the campaigns of a pool have of their own stands at the root: an unseen
//! specimen is one of a campaign whose other specimens tell its gain and its zero.

use super::OfStrokes;
use super::component;
use super::misfit::{SESSION_COSINES, STROKE_COSINES, WANDER_COSINES, common_pairs};
use crate::data::Data;
use pipeline_inference::tree::{Block, Tree};
use std::collections::BTreeMap;

/// The groups of some readings as nodes of a tree, and the node of each reading.
pub(super) struct Hierarchy {
    pub(super) tree: Tree,
    pub(super) node: Vec<usize>,
    pub(super) specimens: Vec<usize>,
    pub(super) sessions: Vec<usize>,
    /// Number of strokes that are nodes.
    pub(super) strokes: usize,
}

impl Hierarchy {
    /// A specimen that was measured in two campaigns is one specimen in each.
    pub(super) fn of(data: &Data, of_strokes: OfStrokes) -> Self {
        let mut root = vec![
            block(component::COMMON_MISFIT, common_pairs().count()),
            block(component::NOTING_ERROR, 1),
        ];
        let campaigns = data.campaigns.len();
        if campaigns > 1 {
            root.push(block(component::CAMPAIGN_GAIN, campaigns));
            root.push(block(component::CAMPAIGN_ZERO, campaigns));
        }
        let mut all = Self {
            tree: Tree::new(root),
            node: Vec::with_capacity(data.len()),
            specimens: vec![usize::MAX; data.specimens.len()],
            sessions: vec![usize::MAX; data.sessions.len()],
            strokes: 0,
        };
        let mut nodes = BTreeMap::new();
        for (i, stroke) in data.strokes().into_iter().enumerate() {
            let session = all.session_of(data, i);
            let blocks = of_strokes.blocks();
            let node = if blocks.is_empty() {
                session
            } else {
                let add = || all.tree.add(session, blocks);
                *nodes.entry(stroke).or_insert_with(add)
            };
            all.node.push(node);
        }
        all.strokes = nodes.len();
        all
    }

    /// The node of the session of reading `i`, which is added with its specimen where it is new.
    fn session_of(&mut self, data: &Data, i: usize) -> usize {
        let (k, s) = (data.specimen[i], data.session[i]);
        if self.specimens[k] == usize::MAX {
            let mut blocks = vec![
                block(component::GAIN, 1),
                block(component::REST_LENGTH, 1),
                block(component::CONTRACTED_LENGTH, 1),
            ];
            if !data.contracted_is_declared(k) {
                blocks.push(block(component::CONTRACTION, 1));
            }
            self.specimens[k] = self.tree.add(0, blocks);
        }
        if self.sessions[s] == usize::MAX {
            let length = if data.set_length_sd_mm[s].is_finite() {
                component::DECLARED_LENGTH
            } else {
                component::SET_LENGTH
            };
            let blocks = vec![
                block(length, 1),
                block(component::ZERO, 1),
                block(component::SESSION_MISFIT, SESSION_COSINES),
            ];
            self.sessions[s] = self.tree.add(self.specimens[k], blocks);
        }
        self.sessions[s]
    }
}

impl OfStrokes {
    fn blocks(self) -> Vec<Block> {
        let misfit = (self.misfit, component::STROKE_MISFIT, STROKE_COSINES);
        let wander = (self.wander, component::WANDER, WANDER_COSINES);
        let own = [misfit, wander].into_iter().filter(|(is_own, ..)| *is_own);
        own.map(|(_, component, columns)| block(component, columns))
            .collect()
    }
}

fn block(component: usize, columns: usize) -> Block {
    Block { component, columns }
}
