//! `plateaus`: one line a steady reading.

use crate::described::*;
use crate::input::ReportInput;
use pipeline_base::row::{Row, label_names};
use pipeline_base::session::Kind;
use std::collections::BTreeSet;

/// The table; extra columns follow the fixed ones by name, then labels. Torque sessions have theirs among the extra ones.
#[rustfmt::skip]
pub fn plateaus(input: &ReportInput) -> Table {
    let labels = label_names(&input.rows);
    let names = input.rows.iter().flat_map(|r| r.extras.keys());
    let extras: BTreeSet<&String> = names.filter(|n| !labels.contains(*n)).collect();
    let mut table = Described::<&Row>::new("plateaus", "Steady readings")
        .text("session", "Session", |r| &r.session)
        .text("specimen", "Specimen", |r| &r.specimen)
        .text("log", "Log", |r| &r.log)
        .count("run", "Run", One, |r| r.run)
        .number("t_s", "\\v{t}", S, Decimals(3), |r| finite(r.time_s))
        .text("phase", "Phase", |r| r.phase.map(|p| p.name()))
        .number("pressure_kpa", "\\v{P}", KPa, Decimals(2), |r| finite(r.pressure_kpa))
        .number("force_n", "\\v{F}", N, Decimals(2), |r| finite(r.force_n).filter(|_| r.kind == Kind::Isometric))
        .number("length_mm", "\\v{l}", Mm, Decimals(1), |r| finite(1e3 * r.length_m))
        .number("contraction", "ε", One, Decimals(4), |r| finite(r.contraction))
        .number("contraction_rel", "ε*", One, Decimals(4), |r| finite(r.contraction_rel))
        .count("n_samples", "Samples", One, |r| r.samples)
        .number("sd_force_n", "s.d. of \\v{F}", N, Decimals(2), |r| finite(r.sd_force_n))
        .text("campaign", "Campaign", |r| &r.campaign);
    let heading = |name: &str| name.replace('_', "\\_");
    for name in extras {
        table = table.number(name, &heading(name), One, Digits(6), |r| r.extras.get(name).copied());
    }
    for name in &labels {
        table = table.text(name, &heading(name), |r| r.label(name));
    }
    table.rows(&input.rows)
}
