//! `[joint]` of a `session.toml`: the knee of a torque session, and how the actuator is built into it.

use super::session_sd;
use super::session_toml::path_below;
use pipeline_base::session::{Description, Joint, Kind};
use pipeline_base::toml_reader::{Entry, Section};

/// The table, which a torque session needs and no other may have; mistakes go to the reader.
pub fn joint(root: &Section, kind: Option<Kind>, entry: Option<Entry>) -> Option<Joint> {
    match (kind, entry) {
        (Some(Kind::KneeTorque), Some(entry)) => joint_table(&entry.table()?),
        (Some(Kind::KneeTorque), None) => {
            root.require(
                "joint",
                "a table [joint]",
                "a knee-torque session needs knee and muscle",
            );
            None
        }
        (Some(Kind::Isometric), Some(entry)) => {
            entry.reject_for(
                "a [joint]",
                "no [joint] in an isometric session",
                "remove it, or correct `kind`",
            );
            None
        }
        _ => None,
    }
}

const KNEES: &[(&str, &str)] = &[
    ("pinned", "pinned"),
    ("biomimetic", "biomimetic"),
    ("described", "described"),
];

fn joint_table(table: &Section) -> Option<Joint> {
    let knee = table
        .require(
            "knee",
            "pinned, biomimetic, or described",
            "name the knee, or write described and name the `file`",
        )
        .and_then(|e| e.choice(KNEES));
    let muscle = table
        .require("muscle", "flexor or extensor", "name the muscle")
        .and_then(|e| e.choice(&[("flexor", "flexor"), ("extensor", "extensor")]));
    let tendon_m = table.get("tendon_mm").and_then(|e| millimetres(&e));
    let fitting_m = table.get("fitting_mm").and_then(|e| millimetres(&e));
    let muscle_length_sd_m = session_sd::declared(table, session_sd::MUSCLE_LENGTH);
    let moment_arm_sd_m = session_sd::declared(table, session_sd::MOMENT_ARM);
    let route = table.get("route").and_then(|e| e.string());
    let file = match (knee, table.get("file")) {
        (Some("described"), None) => {
            table.require(
                "file",
                "the file that describes the leg",
                "put it beside session.toml, and name it",
            );
            None
        }
        (Some("pinned" | "biomimetic"), Some(entry)) => {
            entry.reject(
                "no `file` for a built-in knee",
                "remove it, or write knee = \"described\"",
            );
            None
        }
        (_, entry) => entry.and_then(|e| path_below(&e)),
    };
    table.close();
    Some(Joint {
        knee: knee?.to_owned(),
        muscle: muscle?.to_owned(),
        tendon_m,
        fitting_m,
        muscle_length_sd_m,
        moment_arm_sd_m,
        route,
        description: file.map(|file| Description {
            file,
            text: String::new(),
        }),
    })
}

/// A length of a fitting or tendon, m.
fn millimetres(entry: &Entry) -> Option<f64> {
    let mm = entry.number()?;
    if mm < 0.0 {
        entry.reject(
            "a length of at least 0 mm",
            "leave it out where it was not recorded",
        );
        return None;
    }
    Some(mm * 1e-3)
}
