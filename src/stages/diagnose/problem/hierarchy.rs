//! The groups of the readings as a tree: campaigns of a pool, specimens, sessions, strokes.

use super::component;
use super::misfit::{SESSION_COSINES, STROKE_COSINES, common_pairs};
use crate::data::Data;
use pipeline_inference::tree::{Block, Tree};
use std::collections::BTreeMap;

/// The groups of some readings as nodes of a tree, and the node of each reading.
pub(super) struct Hierarchy {
    pub(super) tree: Tree,
    pub(super) node: Vec<usize>,
    pub(super) specimens: Vec<usize>,
    pub(super) sessions: Vec<usize>,
    /// Of a pool.
    pub(super) campaigns: Vec<usize>,
    /// Number of strokes that are nodes.
    pub(super) strokes: usize,
}

impl Hierarchy {
    /// A specimen that was measured in two campaigns is one specimen in each.
    pub(super) fn of(data: &Data, by_stroke: bool) -> Self {
        let root = vec![block(component::COMMON_MISFIT, common_pairs().count())];
        let mut all = Self {
            tree: Tree::new(root),
            node: Vec::with_capacity(data.len()),
            specimens: vec![usize::MAX; data.specimens.len()],
            sessions: vec![usize::MAX; data.sessions.len()],
            campaigns: Vec::new(),
            strokes: 0,
        };
        if data.campaigns.len() > 1 {
            let of = |_| {
                let gain = block(component::CAMPAIGN_GAIN, 1);
                let zero = block(component::CAMPAIGN_ZERO, 1);
                all.tree.add(0, vec![gain, zero])
            };
            all.campaigns = (0..data.campaigns.len()).map(of).collect();
        }
        let mut nodes = BTreeMap::new();
        for (i, stroke) in data.strokes().into_iter().enumerate() {
            let session = all.session_of(data, i);
            let node = if by_stroke {
                let blocks = || vec![block(component::STROKE_MISFIT, STROKE_COSINES)];
                let add = || all.tree.add(session, blocks());
                *nodes.entry(stroke).or_insert_with(add)
            } else {
                session
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
            let campaign = self.campaigns.get(data.campaign[i]);
            let blocks = vec![
                block(component::GAIN, 1),
                block(component::REST_LENGTH, 1),
                block(component::CONTRACTED_LENGTH, 1),
            ];
            self.specimens[k] = self.tree.add(campaign.copied().unwrap_or(0), blocks);
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

fn block(component: usize, columns: usize) -> Block {
    Block { component, columns }
}
