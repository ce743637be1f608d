//! The sole home of column names, with the unit of each.
//!
//! A quantity has one name in `session.toml` (`pressure`) and one column inside, with its unit in the name (`pressure_kpa`). Any other
//! name that a user gives is an extra column: it keeps its name, its unit and its values, numbers or words (labels), and travels through
//! every stage.

use crate::units::Quantity;

/// A quantity that `session.toml` may name, and the column that holds it inside.
#[derive(Clone, Copy, Debug)]
pub struct KnownColumn {
    /// Name in `[columns]` of `session.toml`.
    pub quantity_name: &'static str,
    /// Name inside, in `derived/` and in tables.
    pub column: &'static str,
    /// Dimension; none for the phase, which is a state.
    pub quantity: Option<Quantity>,
}

/// Time since the start of the log, s.
pub const TIME: &str = "time_s";
/// Axial force, N.
pub const FORCE: &str = "force_n";
/// Torque about the joint, N.m.
pub const TORQUE: &str = "torque_nm";
/// Gauge pressure, kPa.
pub const PRESSURE: &str = "pressure_kpa";
/// Actuator length held, m.
pub const LENGTH: &str = "length_m";
/// Actuator length measured on the knee stand, m.
pub const MUSCLE_LENGTH: &str = "muscle_length_m";
/// Moment arm measured on the knee stand, m.
pub const MOMENT_ARM: &str = "moment_arm_m";
/// Joint angle, rad.
pub const ANGLE: &str = "angle_rad";
/// Whether the actuator was being filled or vented.
pub const PHASE: &str = "phase";
/// Temperature, degrees Celsius.
pub const TEMPERATURE: &str = "temperature_c";

/// Columns that later stages add.
pub mod derived {
    /// Session id.
    pub const SESSION: &str = "session";
    /// Campaign id.
    pub const CAMPAIGN: &str = "campaign";
    /// Specimen id.
    pub const SPECIMEN: &str = "specimen";
    /// Log file within the session.
    pub const LOG: &str = "log";
    /// Run number, as declared.
    pub const RUN: &str = "run";
    /// First line of the log that entered a reading, counted from 1.
    pub const ROW: &str = "row";
    /// Last line of the log that entered a reading.
    pub const LAST_ROW: &str = "last_row";
    /// Samples averaged.
    pub const SAMPLES: &str = "n_samples";
    /// Standard deviation of the samples' force about its mean, N.
    pub const SD_FORCE: &str = "sd_force_n";
    /// Standard deviation of the samples' pressure about its mean, kPa.
    pub const SD_PRESSURE: &str = "sd_pressure_kpa";
    /// Zero of the force channel that was taken off, N.
    pub const ZERO_FORCE: &str = "zero_force_n";
    /// Pressure that the session's zero log shows, kPa.
    pub const ZERO_PRESSURE: &str = "zero_pressure_kpa";
    /// Uninflated inner diameter, mm.
    pub const DIAMETER: &str = "diameter_mm";
    /// Resting length, m.
    pub const REST_LENGTH: &str = "rest_length_m";
    /// Free length at 620 kPa, m.
    pub const CONTRACTED_LENGTH: &str = "contracted_length_m";
    /// Declared standard deviation of the resting length, m.
    pub const REST_LENGTH_SD: &str = "rest_length_sd_m";
    /// Declared standard deviation of the free length at 620 kPa, m.
    pub const CONTRACTED_LENGTH_SD: &str = "contracted_length_sd_m";
    /// Declared standard deviation of the length that was held, m.
    pub const LENGTH_SD: &str = "length_sd_m";
    /// Declared standard deviation of a length measured by hand on the knee stand, m.
    pub const MUSCLE_LENGTH_SD: &str = "muscle_length_sd_m";
    /// Declared standard deviation of a moment arm measured by hand, m.
    pub const MOMENT_ARM_SD: &str = "moment_arm_sd_m";
    /// eps = (l_rest - l) / l_rest.
    pub const CONTRACTION: &str = "contraction";
    /// eps* = eps / eps_620.
    pub const CONTRACTION_REL: &str = "contraction_rel";
    /// P* = P / 620 kPa.
    pub const PRESSURE_REL: &str = "pressure_rel";
}

/// The column of the forces that are predicted by somebody, N: a model by its id, its fits without the reading's specimen, the residual search.
pub fn predicted(by: &str) -> String {
    format!("{PREDICTED}{by}_n")
}

/// How the columns of predictions begin.
const PREDICTED: &str = "predicted_";

/// Whether a column holds what somebody expects of a reading.
pub fn is_prediction(column: &str) -> bool {
    column.starts_with(PREDICTED)
}

/// Every quantity that has a meaning of its own.
pub const KNOWN: &[KnownColumn] = &[
    known("time", TIME, Some(Quantity::Time)),
    known("force", FORCE, Some(Quantity::Force)),
    known("torque", TORQUE, Some(Quantity::Torque)),
    known("pressure", PRESSURE, Some(Quantity::Pressure)),
    known("length", LENGTH, Some(Quantity::Length)),
    known("muscle_length", MUSCLE_LENGTH, Some(Quantity::Length)),
    known("moment_arm", MOMENT_ARM, Some(Quantity::Length)),
    known("angle", ANGLE, Some(Quantity::Angle)),
    known("phase", PHASE, None),
    known("temperature", TEMPERATURE, Some(Quantity::Temperature)),
];

const fn known(
    quantity_name: &'static str,
    column: &'static str,
    quantity: Option<Quantity>,
) -> KnownColumn {
    KnownColumn {
        quantity_name,
        column,
        quantity,
    }
}

/// The known quantity of that name in `session.toml`, if it is one.
pub fn by_quantity_name(name: &str) -> Option<&'static KnownColumn> {
    KNOWN.iter().find(|k| k.quantity_name == name)
}

/// Unit of a column that the pipeline itself names, which is the last part of its name; "1" for a share. None for texts, numbers of rows
/// and the like. An extra column may have any name, and has the unit that `session.toml` gives it.
pub fn unit_in(name: &str) -> Option<&'static str> {
    let last = name.rsplit('_').next().unwrap_or(name);
    let (_, unit) = UNITS_IN_NAMES.iter().find(|(part, _)| *part == last)?;
    Some(unit)
}

const UNITS_IN_NAMES: &[(&str, &str)] = &[
    ("n", "N"),
    ("nm", "N.m"),
    ("kpa", "kPa"),
    ("m", "m"),
    ("mm", "mm"),
    ("rad", "rad"),
    ("s", "s"),
    ("c", "C"),
    ("contraction", "1"),
    ("rel", "1"),
];

/// Whether a column name is one that the pipeline itself writes, so that no extra column may take it.
pub fn is_reserved(name: &str) -> bool {
    use derived::*;
    KNOWN.iter().any(|k| k.column == name)
        || (name.starts_with(PREDICTED) && name.ends_with("_n"))
        || [
            SESSION,
            CAMPAIGN,
            SPECIMEN,
            LOG,
            RUN,
            ROW,
            LAST_ROW,
            SAMPLES,
            SD_FORCE,
            SD_PRESSURE,
            DIAMETER,
            REST_LENGTH,
            CONTRACTED_LENGTH,
            REST_LENGTH_SD,
            CONTRACTED_LENGTH_SD,
            LENGTH_SD,
            MUSCLE_LENGTH_SD,
            MOMENT_ARM_SD,
            CONTRACTION,
            CONTRACTION_REL,
            PRESSURE_REL,
            ZERO_FORCE,
            ZERO_PRESSURE,
            "role",
            "date",
            "kind",
            "exclude",
            "excluded",
            "simulated",
        ]
        .contains(&name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::UNITS;

    #[test]
    fn the_unit_in_a_known_columns_name_is_the_one_used_inside() {
        for known in KNOWN {
            let inside = known
                .quantity
                .and_then(|q| UNITS.iter().find(|u| u.quantity == q));
            assert_eq!(unit_in(known.column), inside.map(|u| u.symbol), "{known:?}");
        }
        assert_eq!(unit_in("hunt2017_by_hand_torque_nm"), Some("N.m"));
        assert_eq!(unit_in(derived::CONTRACTION_REL), Some("1"));
        assert_eq!(unit_in(derived::LAST_ROW), None);
        assert_eq!(unit_in(&predicted("new_unseen")), Some("N"));
        assert!(is_reserved(&predicted("new_unseen")) && !is_reserved("predicted_weather"));
    }
}
