//! `[specimen]` of a `session.toml`: the actuator, with lengths that one can have.

use super::session_sd;
use super::session_toml::identifier;
use pipeline_base::session::Specimen;
use pipeline_base::toml_reader::{Entry, Section};

/// Lengths of actuators, mm: outside, the number is in another unit.
const SHORTEST_MM: f64 = 5.0;
const LONGEST_MM: f64 = 20_000.0;
/// Uninflated inner diameters, mm: of these the new model is fitted; published models cover some (10, 20 and 40).
const DIAMETERS_MM: std::ops::RangeInclusive<f64> = 1.0..=100.0;
const DIAMETER: &str = "a whole number of mm, 1 to 100";

/// The table; mistakes go to its reader.
pub fn specimen(table: &Section) -> Option<Specimen> {
    let id = identifier(table, "id", "the name of the physical actuator");
    let diameter = table
        .require(
            "diameter_mm",
            DIAMETER,
            "write the uninflated inner diameter",
        )
        .and_then(|e| {
            let mm = e.number()?;
            if DIAMETERS_MM.contains(&mm) && mm.fract() == 0.0 {
                return Some(mm);
            }
            e.reject(DIAMETER, "write the uninflated inner diameter");
            None
        });
    let rest = table
        .require(
            "rest_length_mm",
            "l_rest in mm",
            "write the distance between the hose clamps",
        )
        .and_then(|e| actuator_length(&e, "write the distance between the hose clamps"));
    let contracted = table.require(
        "contracted_length_mm",
        "l_620 in mm",
        "write the free length at 620 kPa without load",
    );
    let contracted = contracted.and_then(|e| {
        let mm = actuator_length(&e, "write the free length at 620 kPa without load")?;
        if rest.is_some_and(|l| mm >= l) {
            e.reject(
                "a length below rest_length_mm: an actuator contracts under pressure",
                "check whether the two lengths are swapped",
            );
            return None;
        }
        Some(mm)
    });
    let rest_length_sd_m = session_sd::declared(table, session_sd::REST_LENGTH);
    let contracted_length_sd_m = session_sd::declared(table, session_sd::CONTRACTED_LENGTH);
    table.close();
    Some(Specimen {
        id: id?,
        diameter_mm: diameter?,
        rest_length_m: rest? * 1e-3,
        contracted_length_m: contracted? * 1e-3,
        rest_length_sd_m,
        contracted_length_sd_m,
    })
}

/// A length in mm that an actuator may have; a smaller one is a length in metres.
fn actuator_length(entry: &Entry, hint: &str) -> Option<f64> {
    let mm = entry.positive("mm", hint)?;
    if (SHORTEST_MM..=LONGEST_MM).contains(&mm) {
        return Some(mm);
    }
    let hint = if mm < SHORTEST_MM {
        format!("write mm: {} m is `{} = {}`", mm, entry.key(), 1e3 * mm)
    } else {
        hint.to_owned()
    };
    entry.reject(
        &format!("a length of an actuator in mm, {SHORTEST_MM} to {LONGEST_MM}"),
        &hint,
    );
    None
}
