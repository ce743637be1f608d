//! A reading with what is known of its specimen, and the dimensionless numbers of the force paper.
//!
//! eps = (l_rest - l)/l_rest (Eq. 2), eps_620 the same of l_620 (Eq. 3), eps* = eps/eps_620 (Eq. 4), P* = P/620 kPa. The stage
//! normalize makes its rows here, and so does the software rig that skips the files: both have the same arithmetic.

use crate::columns::{self, FORCE, LENGTH, MUSCLE_LENGTH, PRESSURE, TIME};
use crate::reading::Reading;
use crate::row::Row;
use crate::session::{Constant, Kind, Session};

/// Gauge pressure that pressures are normalised by, kPa (90 psi, the supply of the force paper's rig).
pub const P_620_KPA: f64 = 620.0;

/// Contractions outside are no contractions of a braided actuator, but a wrong length or unit.
pub const CONTRACTION_RANGE: (f64, f64) = (-0.3, 0.6);

/// The row of a reading.
pub fn row(session: &Session, reading: &Reading) -> Row {
    let specimen = &session.specimen;
    let quantity = |column: &str| {
        let logged = reading.value(column);
        if logged.is_nan() {
            session.setup_number(column).unwrap_or(f64::NAN)
        } else {
            logged
        }
    };
    let length_m = match session.kind {
        Kind::Isometric => quantity(LENGTH),
        Kind::KneeTorque => quantity(MUSCLE_LENGTH),
    };
    let contraction = (specimen.rest_length_m - length_m) / specimen.rest_length_m;
    let contraction_620 =
        (specimen.rest_length_m - specimen.contracted_length_m) / specimen.rest_length_m;
    let pressure_kpa = quantity(PRESSURE);
    let joint = session.joint.as_ref();
    let declared = |sd: Option<f64>| sd.unwrap_or(f64::NAN);
    Row {
        session: session.id.clone(),
        campaign: session.campaign.clone(),
        specimen: specimen.id.clone(),
        kind: session.kind,
        date: session.date.clone(),
        role: session.role,
        excluded: session.exclude.is_some(),
        simulated: session.is_simulated(),
        log: reading.log.clone(),
        run: reading.run,
        first_row: reading.first_row,
        last_row: reading.last_row,
        phase: reading.phase,
        samples: reading.samples,
        sd_force_n: reading.sd_force_n,
        zero_force_n: reading.zero_force_n,
        zero_pressure_kpa: reading.zero_pressure_kpa,
        diameter_mm: specimen.diameter_mm,
        rest_length_m: specimen.rest_length_m,
        contracted_length_m: specimen.contracted_length_m,
        rest_length_sd_m: declared(specimen.rest_length_sd_m),
        contracted_length_sd_m: declared(specimen.contracted_length_sd_m),
        length_sd_m: declared(session.length_sd_m),
        muscle_length_sd_m: declared(joint.and_then(|j| j.muscle_length_sd_m)),
        moment_arm_sd_m: declared(joint.and_then(|j| j.moment_arm_sd_m)),
        time_s: reading.value(TIME),
        pressure_kpa,
        force_n: quantity(FORCE),
        length_m,
        contraction,
        contraction_rel: contraction / contraction_620,
        pressure_rel: pressure_kpa / P_620_KPA,
        extras: extras(session, reading),
        labels: labels(session, reading),
    }
}

/// Every column of words, and every text of the set-up that no column of the log replaces.
fn labels(session: &Session, reading: &Reading) -> std::collections::BTreeMap<String, String> {
    let constants = session
        .setup
        .iter()
        .filter_map(|(name, constant)| match constant {
            Constant::Text(text) if !reading.values.contains_key(name) => {
                Some((name.clone(), text.trim().to_owned()))
            }
            _ => None,
        })
        .filter(|(_, text)| !text.is_empty());
    let logged = reading.labels.iter().map(|(n, w)| (n.clone(), w.clone()));
    constants.chain(logged).collect()
}

/// Every column without a field of its own, constants of the set-up and the tendon included.
fn extras(session: &Session, reading: &Reading) -> std::collections::BTreeMap<String, f64> {
    let fields = [TIME, PRESSURE, FORCE, LENGTH];
    let constants = session
        .setup
        .iter()
        .filter_map(|(name, constant)| match constant {
            Constant::Number(x) if !reading.labels.contains_key(name) => Some((name.clone(), *x)),
            _ => None,
        });
    let mut extras: std::collections::BTreeMap<String, f64> = constants
        .chain(reading.values.iter().map(|(name, x)| (name.clone(), *x)))
        .filter(|(name, _)| !fields.contains(&name.as_str()))
        .collect();
    if let Some(tendon) = session.joint.as_ref().and_then(|j| j.tendon_m) {
        extras.insert("tendon_m".to_owned(), tendon);
    }
    debug_assert!(!extras.contains_key(columns::PHASE));
    extras
}
