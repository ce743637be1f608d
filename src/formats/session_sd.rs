//! Declared uncertainties of a `session.toml`: how well the lengths of a session are known, one standard deviation each.
//!
//! | key | table | of | where it is left out |
//! |---|---|---|---|
//! | `rest_length_sd_mm` | `[specimen]` | `rest_length_mm` | 0.29 mm: rounded to 1 mm |
//! | `contracted_length_sd_mm` | `[specimen]` | `contracted_length_mm` | 0.29 mm: rounded to 1 mm |
//! | `length_sd_mm` | `[setup]` | the length that was held, as `length_mm` or in a column | estimated from the readings |
//! | `muscle_length_sd_mm` | `[joint]` | the column `muscle_length`, measured by hand | estimated; 5 mm where there are few |
//! | `moment_arm_sd_mm` | `[joint]` | the column `moment_arm`, measured by hand | estimated; 7 mm where there are few |
//!
//! All are optional. They are carried to the rows, and the residual search takes them for the standard deviations of the random effects, and of the
//! noise of what was measured by hand. 0 is refused: no length is measured exactly, and a model that believes one to be
//! would put its error down to something else.

use crate::session_toml::split_unit;
use pipeline_base::columns;
use pipeline_base::session::Kind;
use pipeline_base::toml_reader::{Entry, Section};

/// Key of the resting length's, in `[specimen]`.
pub const REST_LENGTH: &str = "rest_length_sd_mm";
/// Key of the free length's at 620 kPa, in `[specimen]`.
pub const CONTRACTED_LENGTH: &str = "contracted_length_sd_mm";
/// Key of the held length's, in `[setup]`.
pub const HELD_LENGTH: &str = "length_sd_mm";
/// Key of the length's measured by hand, in `[joint]`.
pub const MUSCLE_LENGTH: &str = "muscle_length_sd_mm";
/// Key of the moment arm's measured by hand, in `[joint]`.
pub const MOMENT_ARM: &str = "moment_arm_sd_mm";

/// Every key with its table.
const KEYS: [(&str, &str); 5] = [
    (REST_LENGTH, "specimen"),
    (CONTRACTED_LENGTH, "specimen"),
    (HELD_LENGTH, "setup"),
    (MUSCLE_LENGTH, "joint"),
    (MOMENT_ARM, "joint"),
];

/// The largest standard deviation of a length, mm: with more the length is not known, and the number rather is one in another unit.
const LARGEST_MM: f64 = 50.0;

/// So many letters may differ for a key of `[setup]` to be taken for a slip. Any other name is a constant of the user's own, so
/// this is less than where names are fixed: `height_sd_mm` may be meant.
const SLIP: usize = 2;

/// The standard deviation of that key in m, if it is declared; mistakes go to the table's reader.
pub fn declared(table: &Section, key: &'static str) -> Option<f64> {
    table.get(key).and_then(|entry| millimetres(&entry))
}

/// That of the length that was held, which a torque session has not.
pub fn of_held_length(setup: &Section, kind: Option<Kind>) -> Option<f64> {
    let entry = setup.get(HELD_LENGTH)?;
    if kind == Some(Kind::KneeTorque) {
        entry.reject(
            "`length_sd_mm` in an isometric session only: a knee has no set length",
            "remove it; of lengths measured by hand write muscle_length_sd_mm in [joint]",
        );
        return None;
    }
    millimetres(&entry)
}

fn millimetres(entry: &Entry) -> Option<f64> {
    let mm = entry.number()?;
    if mm > 0.0 && mm <= LARGEST_MM {
        return Some(mm * 1e-3);
    }
    entry.reject(
        &format!("one standard deviation in mm, above 0 and at most {LARGEST_MM}"),
        "write the scatter of a repeated measurement, or leave it out if it is not known",
    );
    None
}

/// Letters of the name of a quantity from which two of them may differ; of a shorter one only one, because other words are near it.
const LONG_NAME: usize = 6;

/// The key of `[setup]` of a known quantity that is meant by one like `lenght_mm`; a name with something added, as `length_below_mm`, is another name.
fn slip_of_quantity(key: &str) -> Option<String> {
    let (stem, unit) = key.rsplit_once('_')?;
    columns::KNOWN.iter().find_map(|known| {
        let name = known.quantity_name;
        let slip = if name.len() < LONG_NAME { 1 } else { SLIP };
        let meant = format!("{name}_{unit}");
        let is_added_to = stem.starts_with(name) || stem.ends_with(name);
        let is_near = !is_added_to && strsim::damerau_levenshtein(stem, name) <= slip;
        (is_near && split_unit(&meant).is_some()).then_some(meant)
    })
}

/// Expected and hint for a key of `[setup]` that is meant as one of these and would otherwise pass for a constant of the user's own.
pub fn slip_in_setup(key: &str) -> Option<(String, String)> {
    let near = |(known, _): &&(&str, &str)| strsim::damerau_levenshtein(key, known) <= SLIP;
    let other_unit = || {
        key.starts_with("length_sd")
            .then_some(&(HELD_LENGTH, "setup"))
    };
    let Some((known, table)) = KEYS.iter().find(near).or_else(other_unit) else {
        let meant = slip_of_quantity(key)?;
        return Some((
            format!("`{meant}`, or a constant of the set-up with a name of its own"),
            format!("did you mean `{meant}`?"),
        ));
    };
    Some(match (*table, *known == key) {
        ("setup", _) => (
            format!("`{known}`, or a constant of the set-up with a name of its own"),
            format!("did you mean `{known}`?"),
        ),
        (table, true) => (
            format!("`{known}` in [{table}]"),
            format!("move it to [{table}]"),
        ),
        (table, false) => (
            format!("`{known}` in [{table}], or a constant of the set-up with a name of its own"),
            format!("did you mean `{known}` of [{table}]?"),
        ),
    })
}
