//! Which knee and which route a session means by the words of its `[joint]`.
//!
//! | `knee` | `muscle` | route |
//! |---|---|---|
//! | `pinned` | `flexor`, `extensor` | that of this name |
//! | `biomimetic` | `flexor` | `flexor_10mm`, or `flexor_20mm` for the larger actuators |
//! | `biomimetic` | `extensor` | `extensor_10mm`: Table 1 has the 40 mm actuator's insertion a millimetre further forward, and no via points of its own |
//! | `described` | either | that of the muscle's name, or the only one |
//!
//! `route` names another one.

use super::description::{Knee, shipped};
use pipeline_base::diagnostics::{Diagnostic, nearest};
use pipeline_base::session::Joint;

/// A knee with one of its routes.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// The knee.
    pub knee: Knee,
    /// Name of the route.
    pub route: String,
    /// What a reader must know of the choice; empty where it is the paper's own.
    pub remark: &'static str,
}

const OF_10MM: &str = "the route is that of the 10 mm actuator";
const OF_20MM: &str = "the route is that of the 20 mm actuator";

/// The knee and route of a joint; messages call the session's folder `relative` and its file `session_file`.
///
/// # Errors
/// Every mistake of the session's own description, or a route that the knee does not have.
pub fn choose(
    joint: &Joint,
    diameter_mm: f64,
    relative: &str,
    session_file: &str,
) -> Result<Chosen, Vec<Diagnostic>> {
    let knee = match &joint.description {
        Some(own) => Knee::parse(&joint.knee, &format!("{relative}/{}", own.file), &own.text)?,
        None => named(&joint.knee).ok_or_else(Vec::new)?,
    };
    let (usual, remark) = usual(joint, &knee, diameter_mm);
    let (route, remark) = match &joint.route {
        Some(route) => (route.clone(), ""),
        None => (usual, remark),
    };
    if knee.leg(&route).is_some() {
        return Ok(Chosen {
            knee,
            route,
            remark,
        });
    }
    let names: Vec<&str> = knee.routes.iter().map(|r| r.name.as_str()).collect();
    let hint = nearest(&route, names.iter().copied()).map_or_else(
        || "name one of them as `route`".to_owned(),
        |near| format!("did you mean `{near}`?"),
    );
    let expected = format!("a route of the knee {}: {}", knee.name, names.join(", "));
    let file = format!("{relative}/{session_file}");
    Err(vec![
        Diagnostic::error(file, format!("\"{route}\""), expected, hint).in_column("joint.route"),
    ])
}

/// A shipped knee by its name.
pub fn named(name: &str) -> Option<Knee> {
    shipped().ok()?.into_iter().find(|k| k.name == name)
}

/// The route that a joint means where it names none.
fn usual(joint: &Joint, knee: &Knee, diameter_mm: f64) -> (String, &'static str) {
    let small = diameter_mm < 15.0;
    let (route, remark) = match (joint.knee.as_str(), joint.muscle.as_str()) {
        ("biomimetic", "flexor") if small => ("flexor_10mm", ""),
        ("biomimetic", "flexor") if diameter_mm < 30.0 => ("flexor_20mm", ""),
        ("biomimetic", "flexor") => ("flexor_20mm", OF_20MM),
        ("biomimetic", _) => ("extensor_10mm", if small { "" } else { OF_10MM }),
        ("described", _) if knee.routes.len() == 1 => (knee.routes[0].name.as_str(), ""),
        (_, muscle) => (muscle, ""),
    };
    (route.to_owned(), remark)
}
