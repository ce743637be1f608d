//! The tables `[joint]` and `[patella]`.

use super::{column, metres, numbers, required};
use crate::knee::four_bar::FourBar;
use crate::knee::joint::{Joint, Motion};
use crate::knee::route::Patella;
use pipeline_base::toml_reader::Section;
use pipeline_numerics::cubic_spline::{CubicSpline, Ends};

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

/// The joint, if it is well described and has a pose in its whole range; else the mistakes are recorded.
pub(super) fn joint(section: &Section) -> Option<Joint> {
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
        [first, second] => Some([metres(first)?, metres(second)?]),
        _ => {
            entry.reject("two points [x, y]", "a linkage has one pin a link and body");
            None
        }
    }
}

/// The patella; the mistakes of a bad one are recorded.
pub(super) fn patella(section: &Section) -> Option<Patella> {
    let ends = ends(section)?;
    let origin = plane_curves(section, ends);
    let rotation = curve(section, "rotation", "rotation_rad", ends);
    section.close();
    Some(Patella {
        origin: origin?,
        rotation: rotation?,
    })
}
