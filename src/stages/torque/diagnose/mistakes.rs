//! The usual mistakes of a test, each taken back: which of them explains how far off it is.

use super::by_test::{narrowed, size, with_own_offset};
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
    let judge = Judge { sizes, usual };
    let lengths = [judge.mounting(readings), judge.resting(readings)];
    let torques = factors(&UNITS_OF_TORQUE).map(|factor| {
        let mut taken = judge.unit(readings, ("torque", factor), |r| r.torque_nm *= factor)?;
        // Of the readings as they were recorded: a unit that makes all torques small gains nothing by it.
        taken.deviance -= 2.0 * readings.len() as f64 * libm::log(factor);
        Some(taken)
    });
    let pressures = factors(&UNITS_OF_PRESSURE).map(|factor| {
        judge.unit(readings, ("pressure", factor), |r| {
            r.at.pressure_kpa *= factor
        })
    });
    let noisy = size(readings, sizes).map_or(f64::INFINITY, |own| {
        readings.len() as f64 * (1.0 + 2.0 * libm::log((own.rmse / usual).max(1.0)))
    });
    let all = lengths.into_iter().chain(torques).chain(pressures);
    all.flatten()
        .filter(|t| t.rms <= EXPLAINS * usual && t.deviance < noisy)
        .min_by(|a, b| a.deviance.total_cmp(&b.deviance))
}

fn factors(units: &[f64]) -> impl Iterator<Item = f64> {
    units.iter().flat_map(|u| [*u, 1.0 / u])
}

/// How the errors of a test are judged: the sizes of the effects, and what other tests leave, N.m.
struct Judge<'s> {
    sizes: &'s [f64; SIZES],
    usual: f64,
}

impl Judge<'_> {
    /// What readings leave with a mounting of their own, N.m, minus twice its log-likelihood, and the mounting, mm.
    fn left(&self, readings: &[Reading]) -> Option<(f64, f64, f64)> {
        let (offset, size) = with_own_offset(self.sizes, readings);
        let rms = size?.rmse;
        let share = rms / self.usual;
        Some((rms, readings.len() as f64 * share * share, offset))
    }

    /// The same where the mounting is nothing but scatter.
    fn mounted(&self, readings: &[Reading]) -> Option<(f64, f64)> {
        let (rms, deviance, offset) = self.left(readings)?;
        let share = offset / settings::LARGEST_MOUNTING_MM;
        Some((rms, deviance + share * share))
    }

    fn mounting(&self, readings: &[Reading]) -> Option<Taken> {
        let (rms, deviance, value) = self.left(readings)?;
        Some(Taken {
            kind: ErrorKind::Length,
            quantity: "mounting_length",
            value,
            unit: "mm",
            rms,
            deviance,
        })
    }

    fn resting(&self, readings: &[Reading]) -> Option<Taken> {
        let first = readings.first()?.joint;
        let with = |longer_mm: f64| {
            let mut build = first.build().clone();
            build.setup.rest_length_m += 1e-3 * longer_mm;
            let possible = build.setup.rest_length_m > build.setup.contracted_length_m;
            let joint = Joint::new(&build, first.law());
            let longer = readings.iter().map(|r| Reading { joint, ..*r });
            let longer: Vec<Reading> = longer.collect();
            possible.then(|| self.mounted(&longer)).flatten()
        };
        let value = narrowed(REACH_MM, |mm| {
            with(mm).map_or(f64::INFINITY, |(_, deviance)| deviance)
        });
        let (rms, deviance) = with(value)?;
        Some(Taken {
            kind: ErrorKind::Length,
            quantity: "rest_length",
            value,
            unit: "mm",
            rms,
            deviance,
        })
    }

    /// A unit by which every reading is changed.
    fn unit(
        &self,
        readings: &[Reading],
        (quantity, value): (&'static str, f64),
        change: impl Fn(&mut Reading),
    ) -> Option<Taken> {
        let mut changed = readings.to_vec();
        changed.iter_mut().for_each(change);
        let (rms, deviance) = self.mounted(&changed)?;
        Some(Taken {
            kind: ErrorKind::Unit,
            quantity,
            value,
            unit: "1",
            rms,
            deviance,
        })
    }
}
