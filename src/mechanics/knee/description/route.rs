//! The list `[[route]]`.

use super::metres;
use crate::knee::joint::Joint;
use crate::knee::path::Leg;
use crate::knee::route::{Patella, Place, Route, RoutePoint};
use pipeline_base::toml_reader::{Entry, Section};

/// The routes that are well described; the mistakes of the others are recorded.
pub(super) fn routes(
    list: &[Entry],
    patella: Option<&Patella>,
    joint: Option<&Joint>,
) -> Vec<Route> {
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
    let at = |key| section.get(key).map(|e| (metres::<3>(&e), e));
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
