//! The columns of `rows.parquet` that hold what somebody expects of a reading: every model, and the residual search.
//!
//! Named by [`pipeline_base::columns::predicted`]. A reading that somebody has no answer for is NaN here and null there. Pools are fits of
//! their own: what they say stands under `pooled_`.

use pipeline_base::columns::predicted;
use pipeline_base::row::Row;
use pipeline_compare::{NEW, NEW_LOSO};
use pipeline_findings::Residuals;
use std::collections::BTreeMap;

/// Predictions of all readings, by column.
pub struct Columns<'a> {
    rows: &'a [Row],
    places: BTreeMap<(&'a str, &'a str, i64), usize>,
    columns: BTreeMap<String, Vec<f64>>,
}

/// Columns of predictions by name, one value a row, N; NaN where there is none.
pub type Predicted = BTreeMap<String, Vec<f64>>;

impl<'a> Columns<'a> {
    /// No predictions of these rows yet.
    pub fn new(rows: &'a [Row]) -> Self {
        let key = |r: &'a Row| (r.session.as_str(), r.log.as_str(), r.first_row);
        let places = rows.iter().enumerate().map(|(k, r)| (key(r), k));
        Self {
            rows,
            places: places.collect(),
            columns: BTreeMap::new(),
        }
    }

    /// Where a reading stands among the rows.
    pub fn place(&self, session: &str, log: &str, row: i64) -> Option<usize> {
        self.places.get(&(session, log, row)).copied()
    }

    /// What a model predicts of the readings at some places, N. Of a pool only what was fitted to it.
    pub fn put_model(
        &mut self,
        is_pool: bool,
        model: &str,
        places: &[Option<usize>],
        forces: &[f64],
    ) {
        let name = match model {
            NEW_LOSO => "new_unseen",
            other => other,
        };
        if !is_pool || model == NEW || model == NEW_LOSO {
            self.put(is_pool, name, places, forces.iter().copied());
        }
    }

    /// What the residual search expects of its readings: without effects, with them, after each in turn, with the values of specimen and session, and
    /// where the specimen took no part.
    pub fn put_search(&mut self, is_pool: bool, residuals: &Residuals) {
        let keys = residuals
            .session
            .iter()
            .zip(&residuals.log)
            .zip(&residuals.row);
        let places: Vec<Option<usize>> = keys
            .map(|((session, log), row)| self.place(session, log, *row))
            .collect();
        let mut put = |name: &str, left: &[f64]| {
            let rows = self.rows;
            let expected = places.iter().zip(left).map(|(place, left)| {
                let force = place.map_or(f64::NAN, |k| rows[k].force_n);
                force - left
            });
            self.put(is_pool, &format!("loop_{name}"), &places, expected);
        };
        put("before", &residuals.before);
        put("after", &residuals.after);
        put("conditional", &residuals.conditional);
        if residuals.unseen.iter().any(|left| left.is_finite()) {
            put("unseen_before", &residuals.unseen_before);
            put("unseen", &residuals.unseen);
        }
        for (k, (_, left)) in residuals.steps.iter().enumerate() {
            put(&format!("after_{}", k + 1), left);
        }
    }

    /// The columns.
    pub fn finish(self) -> Predicted {
        self.columns
    }

    fn put(
        &mut self,
        is_pool: bool,
        by: &str,
        places: &[Option<usize>],
        forces: impl Iterator<Item = f64>,
    ) {
        let pool = if is_pool { "pooled_" } else { "" };
        let blank = || vec![f64::NAN; self.rows.len()];
        let column = self
            .columns
            .entry(predicted(&format!("{pool}{by}")))
            .or_insert_with(blank);
        for (place, force) in places.iter().zip(forces) {
            if let Some(k) = place {
                column[*k] = force;
            }
        }
    }
}
