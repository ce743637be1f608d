//! The rows of one fit by specimen, looked up once.

use pipeline_base::row::Row;
use std::collections::{BTreeMap, BTreeSet};

/// Which rows belong to which specimen.
pub(super) struct Specimens<'a> {
    /// Their ids, sorted.
    pub(super) ids: Vec<&'a str>,
    /// The place of each row's specimen among them.
    pub(super) of_row: Vec<usize>,
    /// How many rows each has.
    pub(super) rows: Vec<usize>,
    /// The resting lengths among the rows of each, as bits.
    lengths: Vec<BTreeSet<u64>>,
}

impl<'a> Specimens<'a> {
    pub(super) fn new(rows: &[&'a Row]) -> Self {
        let ids: BTreeSet<&str> = rows.iter().map(|r| r.specimen.as_str()).collect();
        let places: BTreeMap<&str, usize> =
            ids.iter().enumerate().map(|(g, id)| (*id, g)).collect();
        let mut found = Self {
            of_row: rows.iter().map(|r| places[r.specimen.as_str()]).collect(),
            rows: vec![0; ids.len()],
            lengths: vec![BTreeSet::new(); ids.len()],
            ids: ids.into_iter().collect(),
        };
        for (row, g) in rows.iter().zip(&found.of_row) {
            found.rows[*g] += 1;
            found.lengths[*g].insert(row.rest_length_m.to_bits());
        }
        found
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.ids.len()
    }

    /// How many resting lengths and rows the specimens have that are taken.
    pub(super) fn extent(&self, taken: impl Fn(usize) -> bool) -> Extent {
        let taken = (0..self.count()).filter(|g| taken(*g));
        let mut lengths: BTreeSet<u64> = BTreeSet::new();
        let mut rows = 0;
        for g in taken {
            lengths.extend(&self.lengths[g]);
            rows += self.rows[g];
        }
        Extent {
            lengths: lengths.len(),
            rows,
        }
    }
}

/// What some of the specimens amount to.
pub(super) struct Extent {
    /// Different resting lengths.
    pub(super) lengths: usize,
    /// Rows.
    pub(super) rows: usize,
}

/// How many resting lengths are among the rows.
pub(super) fn lengths(rows: &[&Row]) -> usize {
    let distinct: BTreeSet<u64> = rows.iter().map(|r| r.rest_length_m.to_bits()).collect();
    distinct.len()
}
