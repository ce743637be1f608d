//! A knee in TOML: the joint, the routes over it, and the muscles that run along them. Shipped knees and a laboratory's own have one format.
//!
//! ```toml
//! [joint]
//! kind = "pinned"              # or translating, centre, four_bar
//! range_deg = [-120, 10]       # flexion negative
//! centre_m = [0.0045, -0.3958] # in the femur's frame
//!
//! [[route]]
//! name = "flexor"
//! point = [
//!   { femur_m = [-0.075, 0.1, 0.0328] },
//!   { femur_m = [-0.04, -0.35, 0.03], below_deg = -60 }, # takes part only in deep flexion
//!   { tibia_m = [-0.05, -0.045, 0.0326] },
//! ]
//! ```
//! | joint | keys |
//! |---|---|
//! | `pinned` | `centre_m` |
//! | `translating` | tables `x` and `y` with `angle_rad` and `position_m`: the tibia's origin in the femur's frame; `ends` |
//! | `centre` | `angle_rad`, `femur_x_m`, `femur_y_m`, `tibia_x_m`, `tibia_y_m`: the instantaneous centre in both frames; `ends` |
//! | `four_bar` | `femur_pins_m`, `tibia_pins_m` (two points each, first and second link), `links_m`, `near_m` ([`crate::knee::four_bar`]) |
//!
//! `ends` of the splines is `natural`, `not_a_knot` or `forsythe`. A point takes part from `from_deg` on and below `below_deg`, both
//! optional. A table `patella` (tables `x`, `y` as above, `rotation` with `angle_rad` and `rotation_rad`) allows points `patella_m`. A table
//! `muscle` gives Hill parameters to routes of the same name: `f_max_n`, `optimal_fibre_m`, `tendon_slack_m`, `pennation_rad`.

mod joint;
mod route;

use super::hill::Muscle;
use super::joint::Joint;
use super::path::Leg;
use super::route::Route;
use pipeline_base::diagnostics::{Diagnostic, nearest};
use pipeline_base::toml_reader::{Entry, Reader, Section, parse};

/// A joint with its routes and muscles.
#[derive(Clone, Debug, PartialEq)]
pub struct Knee {
    /// Name.
    pub name: String,
    /// The joint.
    pub joint: Joint,
    /// The routes, in the order of the file; names are unique.
    pub routes: Vec<Route>,
    /// Muscles, with the routes that they run along.
    pub muscles: Vec<(String, Muscle)>,
}

const SHIPPED: &[(&str, &str)] = &[
    ("pinned", include_str!("../data/pinned.toml")),
    ("gait2392", include_str!("../data/gait2392.toml")),
    ("biomimetic", include_str!("../data/biomimetic.toml")),
    (
        "biomimetic_linkage",
        include_str!("../data/biomimetic_linkage.toml"),
    ),
];

/// The knees of the knee paper: `pinned`, `gait2392`, `biomimetic` (tabulated centre) and `biomimetic_linkage` (the same as a four-bar linkage,
/// without routes of its own).
///
/// # Errors
/// Every mistake of the first embedded file that has one.
pub fn shipped() -> Result<Vec<Knee>, Vec<Diagnostic>> {
    let parsed = |(name, text): &(&str, &str)| Knee::parse(name, &format!("{name}.toml"), text);
    SHIPPED.iter().map(parsed).collect()
}

impl Knee {
    /// Reads a knee; `file` is what messages call the text.
    ///
    /// # Errors
    /// Every mistake of the file, with its line, what was found, what was expected, and what to do.
    pub fn parse(name: &str, file: &str, text: &str) -> Result<Self, Vec<Diagnostic>> {
        let entries = parse(file, text).map_err(|d| vec![d])?;
        let reader = Reader::new(file, text);
        let knee = read(&reader.root(&entries), name);
        let mistakes = reader.finish();
        knee.filter(|_| mistakes.is_empty()).ok_or(mistakes)
    }

    /// The joint with one of its routes.
    pub fn leg(&self, route: &str) -> Option<Leg<'_>> {
        let route = self.routes.iter().find(|r| r.name == route)?;
        let joint = &self.joint;
        Some(Leg { joint, route })
    }

    /// The muscle that runs along a route.
    pub fn muscle(&self, route: &str) -> Option<&Muscle> {
        let found = self.muscles.iter().find(|(name, _)| name == route);
        found.map(|(_, muscle)| muscle)
    }
}

fn read(root: &Section, name: &str) -> Option<Knee> {
    let joint = root
        .require(
            "joint",
            "a table `[joint]`",
            "say how the tibia moves on the femur",
        )
        .and_then(|e| e.table())
        .and_then(|s| joint::joint(&s));
    let patella = root
        .get("patella")
        .and_then(|e| e.table())
        .and_then(|s| joint::patella(&s));
    let routes = match root.get("route").and_then(|e| e.list()) {
        Some(list) => route::routes(&list, patella.as_ref(), joint.as_ref()),
        None => Vec::new(),
    };
    let muscles = match root.get("muscle").and_then(|e| e.table()) {
        Some(section) => muscles(&section, &routes),
        None => Vec::new(),
    };
    root.close();
    Some(Knee {
        name: name.to_owned(),
        joint: joint?,
        routes,
        muscles,
    })
}

/// The muscles; each needs a route of its name.
fn muscles(section: &Section, routes: &[Route]) -> Vec<(String, Muscle)> {
    let mut muscles = Vec::new();
    for (name, entry) in section.entries() {
        let known = routes.iter().map(|r| r.name.as_str());
        if !routes.iter().any(|r| r.name == name) {
            let hint = nearest(&name, known).map_or("describe its route".to_owned(), |near| {
                format!("did you mean `{near}`?")
            });
            entry.reject("a muscle with the name of a route", &hint);
        }
        if let Some(muscle) = entry.table().and_then(|s| muscle(&s)) {
            muscles.push((name, muscle));
        }
    }
    muscles
}

fn muscle(section: &Section) -> Option<Muscle> {
    let positive = |key, unit| {
        section
            .require(
                key,
                "a positive number",
                "see the model that the muscle is from",
            )
            .and_then(|e| e.positive(unit, "check the muscle's parameters"))
    };
    let f_max_n = positive("f_max_n", "N");
    let optimal_fibre_m = positive("optimal_fibre_m", "m");
    let tendon_slack_m = positive("tendon_slack_m", "m");
    let pennation = section.require("pennation_rad", "an angle in rad", "0 for parallel fibres");
    let pennation_rad = pennation.and_then(|e| {
        let angle = e.number()?;
        if (0.0..1.5).contains(&angle) {
            return Some(angle);
        }
        e.reject("an angle from 0 to 1.5 rad", "write rad, not degrees");
        None
    });
    section.close();
    Some(Muscle {
        f_max_n: f_max_n?,
        optimal_fibre_m: optimal_fibre_m?,
        tendon_slack_m: tendon_slack_m?,
        pennation_rad: pennation_rad?,
    })
}

/// No point of a leg is farther from its joint, m.
const FARTHEST_M: f64 = 3.0;

fn required<const N: usize>(section: &Section, key: &'static str) -> Option<[f64; N]> {
    let expected = format!("{N} numbers");
    metres(&section.require(key, &expected, "write them in m, in brackets")?)
}

/// A list of `N` coordinates or lengths in m, or a recorded mistake.
fn metres<const N: usize>(entry: &Entry) -> Option<[f64; N]> {
    let values = numbers(entry)?;
    if values.iter().any(|x| x.abs() > FARTHEST_M) {
        let expected = format!("lengths in m, none beyond {FARTHEST_M} m");
        entry.reject(&expected, "these look like mm: divide them by 1000");
        return None;
    }
    Some(values)
}

/// A list of `N` numbers, or a recorded mistake.
fn numbers<const N: usize>(entry: &Entry) -> Option<[f64; N]> {
    let values = all_numbers(entry)?;
    let found = <[f64; N]>::try_from(values);
    if found.is_err() {
        entry.reject(
            &format!("{N} numbers"),
            "write them in brackets, parted by commas",
        );
    }
    found.ok()
}

fn column(section: &Section, key: &'static str) -> Option<Vec<f64>> {
    all_numbers(&section.require(key, "a list of numbers", "one number a knot")?)
}

fn all_numbers(entry: &Entry) -> Option<Vec<f64>> {
    let numbers: Vec<Option<f64>> = entry.list()?.iter().map(Entry::number).collect();
    numbers.into_iter().collect()
}
