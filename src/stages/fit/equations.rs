//! The equations of the force paper, ready to be fitted to a group.

use crate::contraction_620;
use crate::engine::{Equation, EquationFit, Symbol};
use crate::maxima::{self, Maximum};
use crate::specimens::lengths;
use crate::split::{self, Part};
use pipeline_base::row::Row;
use pipeline_config::FitOptions;
use pipeline_mechanics::models::{Coefficient, new};
use pipeline_numerics::real::{Dual, Real};
use std::collections::BTreeMap;

/// Id of the fit of F_620(l_rest): Eq. 5 (10 mm) or Eq. 6 (20 mm).
pub const MAXIMUM_FORCE: &str = "F_620(l_rest)";
/// Id of the fit of F_max(l_rest, P): Eq. 7.
pub const FORCE_AT_REST: &str = "F_max(l_rest, P)";
/// Id of the same fit with the offset of Eq. 6 where Eq. 7 is printed with another one (20 mm: 0.013 m instead of 0.0075 m).
pub const FORCE_AT_REST_CAPS: &str = "F_max(l_rest, P), l_0 of Eq. 6";
/// Id of the fit of F*(eps*, P*): Eq. 8.
pub const SURFACE: &str = "F*(eps*, P*)";
/// Id of the fit of all coefficients jointly: Eq. 9.
pub const JOINT: &str = "F(eps*, P*, l_rest)";
/// Id of the straight line through eps_620 against l_rest.
pub const CONTRACTION: &str = "eps_620(l_rest)";

/// What stands for an actuator whose diameter has no published law of length: a nearly constant F_620.
const NO_LENGTH_LAW: f64 = 1e4;
/// Where b2 begins for a diameter of which nothing is published, 1/m: between those of 10 and 20 mm.
const LIKE_OTHERS: f64 = 17.0;

/// Where a fit of b2 begins, 1/m; none of a diameter whose F_620 is constant as published (40 mm): of one of which nothing is published the readings
/// say it.
pub fn length_law(diameter_mm: u32) -> Option<f64> {
    let constant = published(diameter_mm, "F_620");
    constant
        .is_none()
        .then(|| start(diameter_mm, "b2", LIKE_OTHERS))
}

/// The published coefficients of a diameter, by symbol.
fn published(diameter_mm: u32, symbol: &str) -> Option<&'static Coefficient> {
    let list: &'static [Coefficient] = match diameter_mm {
        10 => &new::PUBLISHED_10,
        20 => &new::PUBLISHED_20,
        40 => &new::PUBLISHED_40,
        _ => &[],
    };
    list.iter().find(|c| c.symbol == symbol)
}

/// The length at which the end caps touch, m: a constant of the construction, not fitted.
pub fn cap_length_m(diameter_mm: u32, options: &FitOptions) -> f64 {
    match diameter_mm {
        10 => options.l_0_10mm_m,
        20 => options.l_0_20mm_m,
        _ => 0.0,
    }
}

/// The offset l_0 with which Eq. 7 is printed, m; the length at which the caps touch where it is not printed.
pub fn force_at_rest_offset_m(diameter_mm: u32, options: &FitOptions) -> f64 {
    let caps = cap_length_m(diameter_mm, options);
    published(diameter_mm, "l_0 (Eq. 7)").map_or(caps, |c| c.value)
}

fn symbol(diameter_mm: u32, name: &'static str, unit: &'static str, bounds: (f64, f64)) -> Symbol {
    Symbol {
        name,
        unit,
        bounds,
        published: published(diameter_mm, name).map(|c| (c.value, c.interval_95)),
    }
}

fn start(diameter_mm: u32, name: &str, otherwise: f64) -> f64 {
    published(diameter_mm, name).map_or(otherwise, |c| c.value)
}

/// Fits every equation that the rows allow; `notes` say which they do not, and why.
pub fn fit_all(
    diameter_mm: u32,
    rows: &[&Row],
    maxima: &[Maximum],
    options: &FitOptions,
    notes: &mut Vec<String>,
) -> Vec<EquationFit> {
    let by_length = maximum_force(diameter_mm, maxima, options);
    // A law that ran to a bound is none: it would scale every force by a constant.
    let f620 = by_length
        .as_ref()
        .filter(|fit| !fit.coefficients.iter().any(|c| c.state.is_at_bound()))
        .map(|fit| fit.values());
    let cap = cap_length_m(diameter_mm, options);
    let printed = force_at_rest_offset_m(diameter_mm, options);
    let other = (printed != cap).then_some(cap);
    let fits = [
        (
            MAXIMUM_FORCE,
            by_length,
            "needs a measured maximum of at least three specimens",
        ),
        (
            FORCE_AT_REST,
            force_at_rest(FORCE_AT_REST, diameter_mm, rows, printed, options),
            "needs rows at resting length of at least two specimens",
        ),
        (
            FORCE_AT_REST_CAPS,
            other
                .and_then(|l_0| force_at_rest(FORCE_AT_REST_CAPS, diameter_mm, rows, l_0, options)),
            "",
        ),
        (
            SURFACE,
            surface(diameter_mm, rows, maxima, f620.as_deref(), options),
            "needs the measured maximum of its specimens",
        ),
        (
            JOINT,
            joint(diameter_mm, rows, options),
            "needs more rows than coefficients",
        ),
        (
            CONTRACTION,
            contraction(rows, options),
            "needs at least three specimens",
        ),
    ];
    fits.into_iter()
        .filter_map(|(id, fit, needs)| {
            if fit.is_none() && !needs.is_empty() {
                notes.push(format!("{id} was not fitted: it {needs}"));
            }
            fit
        })
        .collect()
}

/// Eqs. 5 and 6, with one row a specimen; `None` below three resting lengths.
fn with_maximum_force<R>(
    diameter_mm: u32,
    maxima: &[Maximum],
    options: &FitOptions,
    then: impl FnOnce(&Equation<2>, &[&Row]) -> Option<R>,
) -> Option<R> {
    let rows: Vec<Row> = maxima
        .iter()
        .map(|m| {
            let mut row = Row::blank();
            (row.specimen, row.rest_length_m, row.force_n) =
                (m.specimen.clone(), m.rest_length_m, m.force_n);
            row
        })
        .collect();
    let rows: Vec<&Row> = rows.iter().collect();
    if lengths(&rows) < 3 {
        return None;
    }
    let offset = cap_length_m(diameter_mm, options);
    let (b1, b2) = (
        start(diameter_mm, "b1", 1000.0),
        start(diameter_mm, "b2", 15.0),
    );
    let equation = Equation::<2> {
        id: MAXIMUM_FORCE,
        title: "maximum force at 620 kPa against resting length",
        unit: "N",
        symbols: [
            symbol(diameter_mm, "b1", "N", (1e-3, 1e5)),
            symbol(diameter_mm, "b2", "1/m", (1e-2, 1e4)),
        ],
        starts: vec![[b1, b2], [b1, 0.3 * b2], [b1, 3.0 * b2]],
        held: &|_| [None; 2],
        observed: &|r| r.force_n,
        model: &|r, c| {
            new::f620(
                c[0],
                c[1],
                Dual::constant(offset),
                Dual::constant(r.rest_length_m),
            )
        },
    };
    then(&equation, &rows)
}

fn maximum_force(
    diameter_mm: u32,
    maxima: &[Maximum],
    options: &FitOptions,
) -> Option<EquationFit> {
    with_maximum_force(diameter_mm, maxima, options, |e, rows| e.fit(rows, options))
}

/// Only the coefficients of it.
fn maximum_force_law(
    diameter_mm: u32,
    maxima: &[Maximum],
    options: &FitOptions,
) -> Option<[f64; 2]> {
    with_maximum_force(diameter_mm, maxima, options, |e, rows| {
        e.values(rows, options)
    })
}

/// Eq. 7 with a given offset l_0, m.
fn with_force_at_rest<R>(
    id: &'static str,
    diameter_mm: u32,
    offset: f64,
    then: impl FnOnce(&Equation<2>) -> R,
) -> R {
    let (a1, a2) = (
        start(diameter_mm, "a1", 1.0),
        start(diameter_mm, "a2", 0.03),
    );
    then(&Equation::<2> {
        id,
        title: "force at resting length against resting length and pressure",
        unit: "N",
        symbols: [
            symbol(diameter_mm, "a1", "N/kPa", (1e-6, 1e3)),
            symbol(diameter_mm, "a2", "1/(kPa m)", (1e-6, 1e3)),
        ],
        starts: vec![[a1, a2], [a1, 0.3 * a2], [a1, 3.0 * a2]],
        held: &|lengths| [None, (lengths < 2).then_some(a2)],
        observed: &|r| r.force_n,
        model: &|r, c| {
            let (length, pressure) = (
                Dual::constant(r.rest_length_m),
                Dual::constant(r.pressure_kpa),
            );
            new::fmax(c[0], c[1], Dual::constant(offset), length, pressure)
        },
    })
}

fn at_rest<'a>(rows: &[&'a Row], options: &FitOptions) -> Vec<&'a Row> {
    let at_rest = |r: &&Row| r.contraction_rel.abs() <= options.at_rest;
    rows.iter().copied().filter(at_rest).collect()
}

fn force_at_rest(
    id: &'static str,
    diameter_mm: u32,
    rows: &[&Row],
    offset: f64,
    options: &FitOptions,
) -> Option<EquationFit> {
    let rows = at_rest(rows, options);
    if lengths(&rows) < 2 {
        return None;
    }
    with_force_at_rest(id, diameter_mm, offset, |e| e.fit(&rows, options))
}

const SURFACE_BOUNDS: [(f64, f64); 3] = [(0.0, 5.0), (1e-3, 100.0), (-2.0, 50.0)];

fn surface_symbols(diameter_mm: u32) -> [Symbol; 3] {
    [
        symbol(diameter_mm, "c0", "1", SURFACE_BOUNDS[0]),
        symbol(diameter_mm, "c1", "1", SURFACE_BOUNDS[1]),
        symbol(diameter_mm, "c2", "1", SURFACE_BOUNDS[2]),
    ]
}

fn surface_start(diameter_mm: u32) -> [f64; 3] {
    [
        start(diameter_mm, "c0", 0.4),
        start(diameter_mm, "c1", 5.0),
        start(diameter_mm, "c2", 1.0),
    ]
}

/// c0 and c1 trade against each other where little was measured near rest, so that a descent may end in either of two valleys.
fn surface_starts(diameter_mm: u32) -> Vec<[f64; 3]> {
    let [c0, c1, c2] = surface_start(diameter_mm);
    vec![
        [c0, c1, c2],
        [0.5 * c0, 3.0 * c1, c2],
        [2.0 * c0, 0.3 * c1, 0.3 * c2],
    ]
}

/// Eq. 8: forces divided by the fitted F_620 of their resting length, or by the specimen's own maximum where no law of length could be
/// fitted; what is fitted is not a number for rows that have neither.
fn with_surface<R>(
    diameter_mm: u32,
    maxima: &[Maximum],
    f620: Option<&[f64]>,
    options: &FitOptions,
    then: impl FnOnce(&Equation<3>) -> R,
) -> R {
    let offset = cap_length_m(diameter_mm, options);
    let own = maxima.iter().map(|m| (m.specimen.as_str(), m.force_n));
    let own: BTreeMap<&str, f64> = own.collect();
    let scale = |r: &Row| match f620 {
        Some(b) => new::f620(b[0], b[1], offset, r.rest_length_m),
        None => own.get(r.specimen.as_str()).copied().unwrap_or(f64::NAN),
    };
    then(&Equation::<3> {
        id: SURFACE,
        title: "relative force against relative contraction and relative pressure",
        unit: "1",
        symbols: surface_symbols(diameter_mm),
        starts: surface_starts(diameter_mm),
        held: &|_| [None; 3],
        observed: &|r| r.force_n / scale(r),
        model: &|r, c| {
            new::surface(
                *c,
                Dual::constant(r.contraction_rel),
                Dual::constant(r.pressure_rel),
            )
        },
    })
}

/// The rows that an equation can be fitted to.
fn defined<'a, const N: usize>(equation: &Equation<N>, rows: &[&'a Row]) -> Vec<&'a Row> {
    let defined = |r: &&Row| (equation.observed)(r).is_finite();
    rows.iter().copied().filter(defined).collect()
}

fn surface(
    diameter_mm: u32,
    rows: &[&Row],
    maxima: &[Maximum],
    f620: Option<&[f64]>,
    options: &FitOptions,
) -> Option<EquationFit> {
    with_surface(diameter_mm, maxima, f620, options, |e| {
        e.fit(&defined(e, rows), options)
    })
}

/// Eq. 9 with all coefficients free: b1, b2, c0, c1, c2, in N. With one resting length b2 cannot be told from b1 and is held.
fn with_joint<R>(
    diameter_mm: u32,
    options: &FitOptions,
    then: impl FnOnce(&Equation<5>) -> R,
) -> R {
    let offset = cap_length_m(diameter_mm, options);
    let constant = start(diameter_mm, "F_620", 1000.0) / std::f64::consts::FRAC_PI_2;
    let law = length_law(diameter_mm);
    let (b1, b2) = (
        start(diameter_mm, "b1", constant),
        law.unwrap_or(NO_LENGTH_LAW),
    );
    let [c0, c1, c2] = surface_start(diameter_mm);
    let symbols = surface_symbols(diameter_mm);
    then(&Equation::<5> {
        id: JOINT,
        title: "force against resting length, contraction and pressure, all coefficients jointly",
        unit: "N",
        symbols: [
            symbol(diameter_mm, "b1", "N", (1e-3, 1e5)),
            symbol(diameter_mm, "b2", "1/m", (1e-2, 1e4)),
            symbols[0],
            symbols[1],
            symbols[2],
        ],
        starts: [1.0, 0.3, 3.0]
            .iter()
            .map(|k| [b1, k * b2, c0, c1, c2])
            .chain(
                surface_starts(diameter_mm)[1..]
                    .iter()
                    .map(|[c0, c1, c2]| [b1, b2, *c0, *c1, *c2]),
            )
            .collect(),
        held: &|lengths| {
            [
                None,
                (law.is_none() || lengths < 2).then_some(b2),
                None,
                None,
                None,
            ]
        },
        observed: &|r| r.force_n,
        model: &|r, c| {
            let f620 = new::f620(
                c[0],
                c[1],
                Dual::constant(offset),
                Dual::constant(r.rest_length_m),
            );
            let (contraction, pressure) = (
                Dual::constant(r.contraction_rel),
                Dual::constant(r.pressure_rel),
            );
            new::force([c[2], c[3], c[4]], f620, contraction, pressure)
        },
    })
}

/// The fit of Eq. 9; `None` without more rows than coefficients.
pub fn joint(diameter_mm: u32, rows: &[&Row], options: &FitOptions) -> Option<EquationFit> {
    with_joint(diameter_mm, options, |e| e.fit(rows, options))
}

/// The coefficients of Eq. 9 that predict the rows best: b1, b2, c0, c1, c2.
pub fn joint_estimates(diameter_mm: u32, rows: &[&Row], options: &FitOptions) -> Option<[f64; 5]> {
    with_joint(diameter_mm, options, |e| e.estimates(rows, options))
}

/// The split by row of every equation that is fitted to rows, the law of length by which Eq. 8 divides included.
pub fn judge_by_rows(
    diameter_mm: u32,
    fits: &mut [EquationFit],
    rows: &[&Row],
    options: &FitOptions,
) {
    let parts = split::by_row(rows, options);
    let train = split::part(rows, &parts, Part::Train);
    let validation = split::part(rows, &parts, Part::Validation);
    let printed = force_at_rest_offset_m(diameter_mm, options);
    for fit in fits {
        fit.by_rows = match fit.id.as_str() {
            FORCE_AT_REST => with_force_at_rest(FORCE_AT_REST, diameter_mm, printed, |e| {
                e.split(
                    &at_rest(&train, options),
                    &at_rest(&validation, options),
                    options,
                )
            }),
            SURFACE => {
                let maxima = maxima::maxima(&train, options);
                let law = maximum_force_law(diameter_mm, &maxima, options);
                with_surface(
                    diameter_mm,
                    &maxima,
                    law.as_ref().map(<[f64; 2]>::as_slice),
                    options,
                    |e| e.split(&defined(e, &train), &defined(e, &validation), options),
                )
            }
            JOINT => with_joint(diameter_mm, options, |e| {
                e.split(&train, &validation, options)
            }),
            _ => None,
        };
    }
}

/// The force of Eq. 9 with jointly fitted coefficients, N.
pub fn joint_force(coefficients: &[f64], diameter_mm: u32, row: &Row, options: &FitOptions) -> f64 {
    let c = coefficients;
    let f620 = new::f620(
        c[0],
        c[1],
        cap_length_m(diameter_mm, options),
        row.rest_length_m,
    );
    new::force(
        [c[2], c[3], c[4]],
        f620,
        row.contraction_rel,
        row.pressure_rel,
    )
}

/// eps_620 in percent against l_rest in m, one point a specimen (force paper, Fig. 3B).
fn contraction(rows: &[&Row], options: &FitOptions) -> Option<EquationFit> {
    let specimens: std::collections::BTreeMap<&str, &Row> =
        rows.iter().map(|r| (r.specimen.as_str(), *r)).collect();
    let rows: Vec<&Row> = specimens.into_values().collect();
    if lengths(&rows) < 3 {
        return None;
    }
    let free = |name, unit| Symbol {
        name,
        unit,
        bounds: (f64::NEG_INFINITY, f64::INFINITY),
        published: None,
    };
    let equation = Equation::<2> {
        id: CONTRACTION,
        title: "contraction at 620 kPa without load against resting length",
        unit: "1",
        symbols: [free("intercept", "1"), free("slope", "1/m")],
        starts: vec![[0.16, 0.0]],
        held: &|_| [None; 2],
        observed: &contraction_620,
        model: &|r, c| c[0] + c[1] * r.rest_length_m,
    };
    equation.fit(&rows, options)
}
