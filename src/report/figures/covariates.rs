//! What the residuals may depend on: everything that is known of every reading.

use crate::figures::formatting::{plain, verbatim};
use crate::plot::Axis;
use crate::plot::axis::Ticks;
use pipeline_base::columns::TEMPERATURE;
use pipeline_base::row::Row;
use pipeline_base::session::Phase;
use std::collections::BTreeSet;

/// Panels of extra columns; a caption names the columns beyond.
const MOST_EXTRAS: usize = 5;

/// Something that the residuals may depend on.
pub struct Covariate {
    /// In the caption, in Typst markup.
    pub words: String,
    axis: Axis,
    /// Its value at every reading.
    pub values: Vec<f64>,
    /// Few places, at which the readings are spread sideways.
    pub spread: bool,
}

impl Covariate {
    fn new(words: &str, label: &str, values: Vec<f64>) -> Self {
        Self {
            words: words.to_owned(),
            axis: Axis::new(label),
            values,
            spread: false,
        }
    }

    fn of(words: &str, label: &str, rows: &[(&Row, f64)], value: fn(&Row) -> f64) -> Self {
        Self::new(words, label, rows.iter().map(|(r, _)| value(r)).collect())
    }

    /// Whether there is anything to see: a value for all rows, and more than one.
    fn says_something(&self) -> bool {
        self.values.iter().all(|v| v.is_finite()) && self.extent() > 0.0
    }

    fn range(&self) -> (f64, f64) {
        let all = self.values.iter().copied();
        let low = all.clone().fold(f64::INFINITY, f64::min);
        (low, all.fold(f64::NEG_INFINITY, f64::max))
    }

    /// Largest minus smallest value.
    pub fn extent(&self) -> f64 {
        let (low, high) = self.range();
        high - low
    }

    /// The axis, with a margin at both ends: many values begin at zero, where the other axis stands.
    pub fn axis(&self) -> Axis {
        if self.spread {
            return self.axis.clone();
        }
        let ((low, high), margin) = (self.range(), 0.04 * self.extent());
        self.axis.clone().fixed(low - margin, high + margin)
    }
}

/// Everything that all readings have and that varies, each reading given with its prediction; and the names, in Typst markup, of extra
/// columns beyond the first few.
pub fn covariates(rows: &[(&Row, f64)]) -> (Vec<Covariate>, Vec<String>) {
    let (extras, untold) = extras(rows);
    let all = measured(rows).into_iter();
    let all = all.chain([phases(rows), sessions(rows)]).chain(extras);
    (all.filter(Covariate::says_something).collect(), untold)
}

/// The quantities that every reading has.
fn measured(rows: &[(&Row, f64)]) -> Vec<Covariate> {
    let of =
        |words: &str, label: &str, value: fn(&Row) -> f64| Covariate::of(words, label, rows, value);
    let predicted = rows.iter().map(|(_, p)| *p).collect();
    vec![
        of("gauge pressure", "Pressure (kPa)", |r| r.pressure_kpa),
        of("relative contraction", "ε* (–)", |r| r.contraction_rel),
        of("resting length", "l_{rest} (mm)", |r| 1e3 * r.rest_length_m),
        Covariate::new("predicted force", "Predicted force (N)", predicted),
        of("time in the log", "Time in the log (s)", |r| r.time_s),
    ]
}

fn phases(rows: &[(&Row, f64)]) -> Covariate {
    let place = |phase: Option<Phase>| match phase {
        Some(Phase::Pressurizing) => 0.0,
        Some(Phase::Depressurizing) => 1.0,
        None => 2.0,
    };
    let values: Vec<f64> = rows.iter().map(|(r, _)| place(r.phase)).collect();
    let names: &[&str] = if values.contains(&2.0) {
        &["filling", "venting", "unknown"]
    } else {
        &["filling", "venting"]
    };
    Covariate {
        axis: Axis::categories("Phase", names),
        spread: true,
        ..Covariate::new("phase", "", values)
    }
}

/// Sessions by name; where names begin with a date or a number that is their order in time.
fn sessions(rows: &[(&Row, f64)]) -> Covariate {
    let names: BTreeSet<&str> = rows.iter().map(|(r, _)| r.session.as_str()).collect();
    let names: Vec<&str> = names.into_iter().collect();
    let place = |r: &Row| names.partition_point(|n| *n < r.session.as_str()) as f64 + 1.0;
    let values = rows.iter().map(|(r, _)| place(r)).collect();
    let mut axis = Axis::new("Session, by name").fixed(0.4, names.len() as f64 + 0.6);
    let step = names.len().div_ceil(6);
    let ticks = (1..=names.len()).filter(|n| n.is_multiple_of(step));
    axis.ticks = Ticks::Named(ticks.map(|n| (n as f64, n.to_string())).collect());
    Covariate {
        axis,
        spread: true,
        ..Covariate::new("session in the order of names", "", values)
    }
}

/// The extra columns that all rows have and that vary; and the names of those for which there is no room.
fn extras(rows: &[(&Row, f64)]) -> (Vec<Covariate>, Vec<String>) {
    let names: BTreeSet<&String> = rows.iter().flat_map(|(r, _)| r.extras.keys()).collect();
    let value = |r: &Row, name: &str| r.extras.get(name).copied().unwrap_or(f64::NAN);
    let covariate = |name: &&String| {
        let (words, label) = if name.as_str() == TEMPERATURE {
            ("temperature".to_owned(), "Temperature (°C)".to_owned())
        } else {
            (verbatim(name), plain(name))
        };
        let values = rows.iter().map(|(r, _)| value(r, name)).collect();
        Covariate::new(&words, &label, values)
    };
    let mut found: Vec<Covariate> = names.iter().map(covariate).collect();
    found.retain(Covariate::says_something);
    let untold = found.split_off(found.len().min(MOST_EXTRAS));
    (found, untold.into_iter().map(|c| c.words).collect())
}
