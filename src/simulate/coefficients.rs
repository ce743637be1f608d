//! The coefficients of a simulated campaign: published, or written out in the truth file.

use super::rig_settings::within;
use pipeline_base::toml_reader::{Entry, Section};
use pipeline_mechanics::models::new::{PUBLISHED_10, PUBLISHED_20, f620};
use pipeline_mechanics::models::values;
use serde::Serialize;

/// Coefficients of the new model (force paper, Eqs. 5, 6 and 8).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Coefficients {
    /// N.
    pub b1: f64,
    /// 1/m.
    pub b2: f64,
    /// m.
    pub l_0: f64,
    /// c0, c1 and c2 of the dimensionless surface.
    pub c: [f64; 3],
}

impl Coefficients {
    /// The published coefficients, where F_620 depends on the resting length.
    pub fn published(diameter_mm: u32) -> Option<Self> {
        let list = match diameter_mm {
            10 => &PUBLISHED_10,
            20 => &PUBLISHED_20,
            _ => return None,
        };
        let [b1, b2, l_0, _, _, _, c0, c1, c2] = values(list);
        let c = [c0, c1, c2];
        Some(Self { b1, b2, l_0, c })
    }

    /// F_620 in N of an actuator of this resting length in m.
    pub fn f620(&self, rest_length_m: f64) -> f64 {
        f620(self.b1, self.b2, self.l_0, rest_length_m)
    }
}

/// The key `coefficients`: the word "published", or all six numbers. Without a good diameter the word cannot be checked further.
pub fn read_coefficients(entry: &Entry, diameter_mm: Option<u32>) -> Option<Coefficients> {
    const SIX: &str = "write { b1 = .., b2 = .., l_0 = .., c0 = .., c1 = .., c2 = .. }";
    if entry.as_string().is_none() {
        return explicit(&entry.table()?);
    }
    entry.choice(&[("published", ())])?;
    let published = Coefficients::published(diameter_mm?);
    if published.is_none() {
        entry.reject(
            "explicit coefficients: for this diameter F_620(l_rest) is not published",
            SIX,
        );
    }
    published
}

fn explicit(table: &Section) -> Option<Coefficients> {
    let hint = "all six coefficients of the new model are needed";
    let read = |key, low, high, unit| {
        let entry = table.require(key, &format!("a number ({unit})"), hint)?;
        within(&entry, low, high, unit, "see the published values")
    };
    let b1 = read("b1", 1.0, 1e5, "N");
    let b2 = read("b2", 0.01, 1e6, "1/m");
    let l_0 = read("l_0", 0.0, 0.2, "m");
    let c = [("c0", 5.0), ("c1", 50.0), ("c2", 50.0)].map(|(key, top)| read(key, 0.0, top, "1"));
    table.close();
    let c = [c[0]?, c[1]?, c[2]?];
    Some(Coefficients {
        b1: b1?,
        b2: b2?,
        l_0: l_0?,
        c,
    })
}
