//! `knee_arms`, `knee_switches`, `knee_centres`: both methods for the moment arm along the shipped routes and why they part; what happens to a path
//! where a point comes in; the instantaneous centre of the biomimetic knee from its table, from the linkage, and from the motion.

use super::mm;
use crate::described::*;
use crate::input::ReportInput;
use crate::wording::name::{knee, route};
use pipeline_torque::reference::arms::{Arms, At};
use pipeline_torque::reference::centres::Centres;

/// One row a route, those of legs of one's own included.
#[rustfmt::skip]
pub fn arms(input: &ReportInput) -> Table {
    let shipped = input.knee.iter().flat_map(|k| &k.reference.arms);
    let configurations = input.torque().iter().flat_map(|c| &c.configurations);
    let own = configurations.filter(|c| c.knee == "described").map(|c| &c.arms);
    Described::<&Arms>::new("knee_arms", "Where the projection (paper Eq. 3) and the slope of the length (paper Eq. 2) give different moment arms: the largest difference, and its knee angle")
        .text("knee", "Knee", |a| &a.knee).machines()
        .text("knee_words", "Knee", |a| knee(&a.knee)).people()
        .text("route", "Route", |a| &a.route).machines()
        .text("route_words", "Route", |a| route(&a.route)).people()
        .number("apart_mm", "As printed", Mm, Decimals(2), |a| mm(a.apart.0))
        .number("apart_at_deg", "at", Degree, Decimals(0), |a| a.apart.1)
        .number("apart_in_plane_mm", "In the plane", Mm, Decimals(2), |a| mm(a.apart_in_plane.0))
        .number("apart_in_plane_at_deg", "at", Degree, Decimals(0), |a| a.apart_in_plane.1)
        .number("apart_about_origin_mm", "About p_k", Mm, Decimals(2), |a| mm(a.apart_about_origin.0))
        .number("apart_about_origin_at_deg", "at", Degree, Decimals(0), |a| a.apart_about_origin.1)
        .text("why", "Why", |a| &a.why)
        .note("As printed: about the instantaneous centre. In the plane: the same times the share of the segment in the plane, which belongs with the whole force. About p_k: the same about the origin of the tibia's frame.")
        .rows(shipped.chain(own))
}

/// One row a point that begins or ceases to take part.
#[rustfmt::skip]
pub fn switches(input: &ReportInput) -> Table {
    let shipped = input.knee.iter().flat_map(|k| &k.reference.arms);
    Described::<(&Arms, &At)>::new("knee_switches", "Points of a route that become active or inactive: the jump of length and moment arm, just \
         above the angle minus just below it")
        .text("knee", "Knee", |(a, _)| &a.knee).machines()
        .text("knee_words", "Knee", |(a, _)| knee(&a.knee)).people()
        .text("route", "Route", |(a, _)| &a.route).machines()
        .text("route_words", "Route", |(a, _)| route(&a.route)).people()
        .number("angle_deg", "Angle", Degree, Decimals(1), |(_, s)| s.angle_rad.to_degrees())
        .number("length_jump_mm", "Length", Mm, Decimals(3), |(_, s)| mm(s.length_jump_m))
        .number("arm_jump_mm", "Arm", Mm, Decimals(2), |(_, s)| mm(s.arm_jump_m))
        .note("A jump of length is a flaw of the route: the point does not lie on the line that it bends. A jump of the arm alone is a path that folds over an edge.")
        .rows(shipped.flat_map(|a| a.switches.iter().map(move |s| (a, s))))
}

/// One row a way to the centre.
#[rustfmt::skip]
pub fn centres(input: &ReportInput) -> Table {
    Described::<&Centres>::new("knee_centres", "The instantaneous centre of the biomimetic knee: distance from the tabulated one")
        .text("other", "Beside the tabulated centre", |c| &c.other)
        .count("n", "Angles", One, |c| c.n)
        .number("rms_mm", "rms", Mm, Decimals(3), |c| mm(c.rms_m))
        .number("max_mm", "Largest", Mm, Decimals(3), |c| mm(c.max_m))
        .number("at_deg", "at", Degree, Decimals(0), |c| c.at_deg)
        .rows(input.knee.iter().flat_map(|k| &k.reference.centres))
}
