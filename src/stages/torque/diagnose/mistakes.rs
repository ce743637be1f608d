//! The usual mistakes of a test, each taken back: which of them explains how far off it is.

use super::by_test::{narrowed, own_offset, shifted, size};
use super::data::Reading;
use super::operator::Joint;
use super::settings;
use super::terms::SIZES;
use pipeline_findings::ErrorKind;
use pipeline_inference::decisions::EXPLAINS;

/// Units of the torque that are taken for one another (lbf ft, lbf in, kgf m, N cm, N mm), as factors; their inverses too.
const UNITS_OF_TORQUE: [f64; 5] = [1.356, 8.851, 9.807, 100.0, 1000.0];

/// Units of the pressure that are taken for one another (psi, bar, other powers of ten), as factors; their inverses too.
const UNITS_OF_PRESSURE: [f64; 4] = [6.895, 10.0, 100.0, 1000.0];

/// Changes of a resting length that are tried, mm.
const REACH_MM: f64 = 60.0;

/// A mistake taken back.
#[derive(Clone, Debug, PartialEq)]
pub struct Taken {
    /// What kind of mistake.
    pub kind: ErrorKind,
    /// The quantity.
    pub quantity: &'static str,
    /// True less recorded, or the factor of a unit.
    pub value: f64,
    /// Unit of `value`.
    pub unit: &'static str,
    /// Root mean square of the errors that it leaves, N.m.
    pub rms: f64,
    /// Minus twice the log-likelihood of the readings as they were recorded, up to a constant.
    deviance: f64,
}

/// The likeliest of the mistakes that leave no more than is usual in a test of its own mounting, `usual` N.m. A unit and a resting length leave the
/// test a mounting like those of others; a wrong length of the mounting, which is one of fittings or tendon as well, is mounting and nothing else. None
/// where a noise of its own is likelier than any.
pub fn explanation(readings: &[Reading], sizes: &[f64; SIZES], usual: f64) -> Option<Taken> {
    let all = [mounting(readings, sizes, usual)]
        .into_iter()
        .chain([resting(readings, sizes, usual)])
        .chain(factors(&UNITS_OF_TORQUE).map(|f| torque_unit(readings, sizes, usual, f)))
        .chain(factors(&UNITS_OF_PRESSURE).map(|f| pressure_unit(readings, sizes, usual, f)));
    let noisy = size(readings, sizes).map_or(f64::INFINITY, |own| {
        readings.len() as f64 * (1.0 + 2.0 * libm::log((own.rmse / usual).max(1.0)))
    });
    all.flatten()
        .filter(|t| t.rms <= EXPLAINS * usual && t.deviance < noisy)
        .min_by(|a, b| a.deviance.total_cmp(&b.deviance))
}

fn factors(units: &[f64]) -> impl Iterator<Item = f64> {
    units.iter().flat_map(|u| [*u, 1.0 / u])
}

/// What readings leave with an offset of their own, N.m, and that offset, mm.
fn left(readings: &[Reading], sizes: &[f64; SIZES]) -> Option<(f64, f64)> {
    let offset = own_offset(sizes, readings);
    Some((size(readings, &shifted(sizes, offset))?.rmse, offset))
}

/// Minus twice the log-likelihood of what is left.
fn deviance(count: usize, rms: f64, usual: f64) -> f64 {
    count as f64 * (rms / usual) * (rms / usual)
}

/// The same with a mounting that is nothing but scatter.
fn deviance_mounted(count: usize, (rms, offset): (f64, f64), usual: f64) -> f64 {
    let share = offset / settings::LARGEST_MOUNTING_MM;
    deviance(count, rms, usual) + share * share
}

fn mounting(readings: &[Reading], sizes: &[f64; SIZES], usual: f64) -> Option<Taken> {
    let (rms, offset) = left(readings, sizes)?;
    Some(Taken {
        kind: ErrorKind::Length,
        quantity: "mounting_length",
        value: offset,
        unit: "mm",
        rms,
        deviance: deviance(readings.len(), rms, usual),
    })
}

fn resting(readings: &[Reading], sizes: &[f64; SIZES], usual: f64) -> Option<Taken> {
    let first = readings.first()?.joint;
    let with = |longer_mm: f64| {
        let mut build = first.build().clone();
        build.setup.rest_length_m += 1e-3 * longer_mm;
        let possible = build.setup.rest_length_m > build.setup.contracted_length_m;
        let joint = Joint::new(&build, first.law());
        let longer = readings.iter().map(|r| Reading { joint, ..*r });
        let longer: Vec<Reading> = longer.collect();
        let mounted = possible.then(|| left(&longer, sizes)).flatten()?;
        Some((mounted, deviance_mounted(readings.len(), mounted, usual)))
    };
    let worst = f64::INFINITY;
    let value = narrowed(REACH_MM, |mm| {
        with(mm).map_or(worst, |(_, deviance)| deviance)
    });
    let ((rms, _), deviance) = with(value)?;
    Some(Taken {
        kind: ErrorKind::Length,
        quantity: "rest_length",
        value,
        unit: "mm",
        rms,
        deviance,
    })
}

fn torque_unit(
    readings: &[Reading],
    sizes: &[f64; SIZES],
    usual: f64,
    factor: f64,
) -> Option<Taken> {
    let changed = readings.iter().map(|r| Reading {
        torque_nm: r.torque_nm * factor,
        ..*r
    });
    let mut taken = unit(
        &changed.collect::<Vec<_>>(),
        sizes,
        usual,
        ("torque", factor),
    )?;
    // Of the readings as they were recorded: a unit that makes all torques small gains nothing by it.
    taken.deviance -= 2.0 * readings.len() as f64 * libm::log(factor);
    Some(taken)
}

fn pressure_unit(
    readings: &[Reading],
    sizes: &[f64; SIZES],
    usual: f64,
    factor: f64,
) -> Option<Taken> {
    let changed = readings.iter().map(|r| {
        let mut changed = *r;
        changed.at.pressure_kpa *= factor;
        changed
    });
    unit(
        &changed.collect::<Vec<_>>(),
        sizes,
        usual,
        ("pressure", factor),
    )
}

fn unit(
    changed: &[Reading],
    sizes: &[f64; SIZES],
    usual: f64,
    (quantity, factor): (&'static str, f64),
) -> Option<Taken> {
    let mounted = left(changed, sizes)?;
    Some(Taken {
        kind: ErrorKind::Unit,
        quantity,
        value: factor,
        unit: "1",
        rms: mounted.0,
        deviance: deviance_mounted(changed.len(), mounted, usual),
    })
}
