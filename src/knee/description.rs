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
//! | `four_bar` | `femur_pins_m`, `tibia_pins_m` (two points each, first and second link), `links_m`, `near_m` ([`super::four_bar`]) |
//!
//! `ends` of the splines is `natural`, `not_a_knot` or `forsythe`. A point takes part from `from_deg` on and below `below_deg`, both
//! optional. A table `patella` (tables `x`, `y` as above, `rotation` with `angle_rad` and `rotation_rad`) allows points `patella_m`. A table
//! `muscle` gives Hill parameters to routes of the same name: `f_max_n`, `optimal_fibre_m`, `tendon_slack_m`, `pennation_rad`.

use super::four_bar::FourBar;
use super::hill::Muscle;
use super::joint::{Joint, Motion};
use super::path::Leg;
use super::route::{Patella, Place, Route, RoutePoint};
use crate::base::diagnostics::{Diagnostic, nearest};
use crate::base::toml_reader::{Entry, Reader, Section, parse};
use crate::numerics::cubic_spline::{CubicSpline, Ends};

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
    ("pinned", include_str!("data/pinned.toml")),
    ("gait2392", include_str!("data/gait2392.toml")),
    ("biomimetic", include_str!("data/biomimetic.toml")),
    (
        "biomimetic_linkage",
        include_str!("data/biomimetic_linkage.toml"),
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
        .and_then(|s| joint(&s));
    let patella = root
        .get("patella")
        .and_then(|e| e.table())
        .and_then(|s| patella(&s));
    let routes = match root.get("route").and_then(|e| e.list()) {
        Some(list) => routes(&list, patella.as_ref(), joint.as_ref()),
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

#[derive(Clone, Copy)]
enum Kind {
    Pinned,
    Translating,
    Centre,
    FourBar,
}

const KINDS: &[(&str, Kind)] = &[
    ("pinned", Kind::Pinned),
    ("translating", Kind::Translating),
    ("centre", Kind::Centre),
    ("four_bar", Kind::FourBar),
];

const ENDS: &[(&str, Ends)] = &[
    ("natural", Ends::Natural),
    ("not_a_knot", Ends::NotAKnot),
    ("forsythe", Ends::Forsythe),
];

fn joint(section: &Section) -> Option<Joint> {
    let range = section
        .require(
            "range_deg",
            "two angles",
            "write the range as [most flexed, most extended], flexion negative",
        )
        .and_then(|e| numbers::<2>(&e))
        .map(|[low, high]| (low.to_radians(), high.to_radians()));
    let kind = section
        .require(
            "kind",
            "the kind of joint",
            "write pinned, translating, centre or four_bar",
        )?
        .choice(KINDS)?;
    let motion = match kind {
        Kind::Pinned => required::<2>(section, "centre_m").map(Motion::Pinned),
        Kind::Translating => {
            let ends = ends(section);
            plane_curves(section, ends?).map(Motion::Translating)
        }
        Kind::Centre => centre(section),
        Kind::FourBar => four_bar(section),
    };
    section.close();
    let joint = Joint {
        motion: motion?,
        range: range?,
    };
    usable(section, &joint).then_some(joint)
}

/// Whether the range rises and the joint has a pose everywhere in it; a mistake is recorded.
fn usable(section: &Section, joint: &Joint) -> bool {
    let (low, high) = joint.range;
    let report = |found: String, expected, hint| {
        let key = section.path_of("range_deg");
        section
            .reader()
            .report(section.line(), &key, found, expected, hint);
        false
    };
    if low.partial_cmp(&high) != Some(std::cmp::Ordering::Less) {
        let found = format!("[{}, {}]", low.to_degrees(), high.to_degrees());
        return report(
            found,
            "a smaller and a larger angle",
            "write the most flexed angle first; flexion is negative",
        );
    }
    const PIECES: u32 = 200;
    let angles = (0..=PIECES).map(|k| {
        let share = f64::from(k) / f64::from(PIECES);
        (1.0 - share) * low + share * high
    });
    match angles.into_iter().find(|a| joint.pose(*a).is_err()) {
        None => true,
        Some(angle) => report(
            format!("no position of the tibia at {:.2} deg", angle.to_degrees()),
            "a joint that has one in its whole range",
            "narrow the range, extend the table, or check pins and lengths of links",
        ),
    }
}

fn ends(section: &Section) -> Option<Ends> {
    section
        .require(
            "ends",
            "the end condition of the splines",
            "write natural, not_a_knot or forsythe",
        )?
        .choice(ENDS)
}

/// The tables `x` and `y`.
fn plane_curves(section: &Section, ends: Ends) -> Option<[CubicSpline; 2]> {
    let x = curve(section, "x", "position_m", ends);
    let y = curve(section, "y", "position_m", ends);
    Some([x?, y?])
}

/// A table with knots.
fn curve(
    section: &Section,
    key: &'static str,
    value: &'static str,
    ends: Ends,
) -> Option<CubicSpline> {
    let table = section
        .require(key, "a table of knots", "write its angles and values")?
        .table()?;
    let (angles, values) = (column(&table, "angle_rad"), column(&table, value));
    table.close();
    spline(&table, &angles?, &values?, ends)
}

fn spline(section: &Section, x: &[f64], y: &[f64], ends: Ends) -> Option<CubicSpline> {
    let spline = CubicSpline::new(x, y, ends);
    if let Err(error) = &spline {
        section.reader().report(
            section.line(),
            &section.path_of("angle_rad"),
            error.to_string(),
            "knots in the order of the angle, from flexion to extension",
            "sort them, and give each angle one value",
        );
    }
    spline.ok()
}

fn centre(section: &Section) -> Option<Motion> {
    let ends = ends(section);
    let angles = column(section, "angle_rad");
    let mut curves = Vec::new();
    for key in ["femur_x_m", "femur_y_m", "tibia_x_m", "tibia_y_m"] {
        let values = column(section, key);
        if let (Some(ends), Some(angles), Some(values)) = (ends, &angles, values) {
            curves.extend(spline(section, angles, &values, ends));
        }
    }
    let [a, b, c, d] = <[CubicSpline; 4]>::try_from(curves).ok()?;
    Some(Motion::Centre {
        femur: [a, b],
        tibia: [c, d],
    })
}

fn four_bar(section: &Section) -> Option<Motion> {
    let (femur, tibia) = (pins(section, "femur_pins_m"), pins(section, "tibia_pins_m"));
    let links = required::<2>(section, "links_m");
    let near = required::<2>(section, "near_m");
    let linkage = FourBar::new(femur?, tibia?, links?, near?);
    if linkage.is_none() {
        section.reader().report(
            section.line(),
            &section.path_of("links_m"),
            "links that do not meet with the leg straight",
            "lengths with which the linkage closes at 0 deg and is no parallelogram, which would not turn",
            "measure pins and links again, the first link first in all three lists",
        );
    }
    linkage.map(Motion::FourBar)
}

fn pins(section: &Section, key: &'static str) -> Option<[[f64; 2]; 2]> {
    let entry = section.require(key, "two points [x, y]", "write the first link's pin first")?;
    let list = entry.list()?;
    match list.as_slice() {
        [first, second] => Some([numbers(first)?, numbers(second)?]),
        _ => {
            entry.reject("two points [x, y]", "a linkage has one pin a link and body");
            None
        }
    }
}

fn patella(section: &Section) -> Option<Patella> {
    let ends = ends(section)?;
    let origin = plane_curves(section, ends);
    let rotation = curve(section, "rotation", "rotation_rad", ends);
    section.close();
    Some(Patella {
        origin: origin?,
        rotation: rotation?,
    })
}

/// The routes that are well described; the mistakes of the others are recorded.
fn routes(list: &[Entry], patella: Option<&Patella>, joint: Option<&Joint>) -> Vec<Route> {
    let mut routes: Vec<Route> = Vec::new();
    for entry in list {
        let Some(section) = entry.table() else {
            continue;
        };
        let Some(route) = route(&section, patella) else {
            continue;
        };
        if routes.iter().any(|r| r.name == route.name) {
            section.reader().report(
                section.line(),
                &section.path_of("name"),
                format!("\"{}\" a second time", route.name),
                "one route a name",
                "rename one of them",
            );
        } else if joint.is_none_or(|joint| complete(&section, &route, joint)) {
            routes.push(route);
        }
    }
    routes
}

fn route(section: &Section, patella: Option<&Patella>) -> Option<Route> {
    let name = section
        .require("name", "a name", "name the route after its muscle")
        .and_then(|e| e.string());
    let points = section
        .require(
            "point",
            "a list of points",
            "write origin, via points, insertion",
        )
        .and_then(|e| e.list());
    section.close();
    let points: Vec<Option<RoutePoint>> = points?
        .iter()
        .map(|p| point(&p.table()?, patella.is_some()))
        .collect();
    let points: Vec<RoutePoint> = points.into_iter().collect::<Option<_>>()?;
    let moving = points.iter().any(|p| matches!(p.place, Place::Patella(_)));
    Some(Route {
        name: name?,
        points,
        patella: patella.filter(|_| moving).cloned(),
    })
}

fn point(section: &Section, has_patella: bool) -> Option<RoutePoint> {
    let at = |key| section.get(key).map(|e| (numbers::<3>(&e), e));
    let (femur, tibia, patella) = (at("femur_m"), at("tibia_m"), at("patella_m"));
    let angle = |key, absent: f64| match section.get(key) {
        Some(entry) => entry.number().map(f64::to_radians),
        None => Some(absent),
    };
    let from = angle("from_deg", f64::NEG_INFINITY);
    let below = angle("below_deg", f64::INFINITY);
    section.close();
    let place = match (femur, tibia, patella) {
        (Some((p, _)), None, None) => p.map(Place::Femur),
        (None, Some((p, _)), None) => p.map(Place::Tibia),
        (None, None, Some((p, _))) if has_patella => p.map(Place::Patella),
        (None, None, Some((_, entry))) => {
            entry.reject(
                "a point of femur or tibia",
                "describe the patella in a table `[patella]`",
            );
            None
        }
        _ => {
            section.reader().report(
                section.line(),
                &section.path_of("femur_m"),
                "a point of no body, or of more than one",
                "one of femur_m, tibia_m, patella_m",
                "write { femur_m = [x, y, z] }, in m",
            );
            None
        }
    };
    Some(RoutePoint {
        place: place?,
        from: from?,
        below: below?,
    })
}

/// Whether the route runs from femur to tibia at every angle of the joint; a mistake is recorded.
fn complete(section: &Section, route: &Route, joint: &Joint) -> bool {
    let report = |found: String, expected, hint| {
        let key = section.path_of("point");
        section
            .reader()
            .report(section.line(), &key, found, expected, hint);
        false
    };
    let on_femur = |p: &RoutePoint| matches!(p.place, Place::Femur(_));
    if !route.points.is_sorted_by_key(|p| !on_femur(p)) {
        return report(
            "a point of the femur after one of the tibia".to_owned(),
            "all points of the femur before those of the tibia",
            "order them from the origin to the insertion",
        );
    }
    let (low, high) = joint.range;
    let mut looked_at = vec![low, high];
    let between = |a: &f64| (low..high).contains(a);
    looked_at.extend(route.switches().into_iter().filter(between));
    looked_at.sort_by(f64::total_cmp);
    let middles: Vec<f64> = looked_at.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
    looked_at.extend(middles);
    for angle in looked_at {
        let taking_part = |femur| {
            let mut points = route.points.iter();
            points.any(|p| p.takes_part(angle) && on_femur(p) == femur)
        };
        if !(taking_part(true) && taking_part(false)) {
            return report(
                format!(
                    "no point on femur or tibia at {:.2} deg",
                    angle.to_degrees()
                ),
                "an origin and an insertion at every angle of the joint",
                "check from_deg and below_deg of the points",
            );
        }
        let length = Leg { joint, route }.length(angle);
        let arm = Leg { joint, route }.arm(angle);
        if !(length.is_ok() && arm.is_ok_and(f64::is_finite)) {
            return report(
                format!("no path at {:.2} deg", angle.to_degrees()),
                "points apart from each other, and a patella that is known over the whole range",
                "remove points that stand twice, or narrow the joint's range",
            );
        }
    }
    true
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

fn required<const N: usize>(section: &Section, key: &'static str) -> Option<[f64; N]> {
    let expected = format!("{N} numbers");
    numbers(&section.require(key, &expected, "write them in m, in brackets")?)
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
