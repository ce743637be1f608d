//! `knee_arms`: both methods for the moment arm along the shipped routes, and why they part.

use super::{decimals, mm};
use crate::input::ReportInput;
use crate::table::{Cell, Column, Table};

/// The table.
pub fn table(input: &ReportInput) -> Table {
    let columns = vec![
        Column::text("knee", "Knee"),
        Column::text("route", "Route"),
        Column::number("apart_mm", "As printed", "mm"),
        Column::number("apart_at_deg", "at", "°"),
        Column::number("apart_in_plane_mm", "In the plane", "mm"),
        Column::number("apart_in_plane_at_deg", "at", "°"),
        Column::number("apart_about_origin_mm", "About p_k", "mm"),
        Column::number("apart_about_origin_at_deg", "at", "°"),
        Column::text("why", "Why"),
    ];
    let mut table = Table::new(
        "knee_arms",
        "Where the projection (Eq. 3) and the slope of the length (Eq. 2) give different moment arms: the largest difference, and its knee angle",
        columns,
    )
    .note("As printed: about the instantaneous centre. In the plane: the same times the share of the segment in the plane, which belongs with the whole force. About p_k: the same about the origin of the tibia's frame.");
    let shipped = input.knee.iter().flat_map(|k| &k.reference.arms);
    let configurations = input.torque().flat_map(|c| &c.configurations);
    let own = configurations.filter(|c| c.knee == "described");
    for a in shipped.chain(own.map(|c| &c.arms)) {
        table.push(vec![
            Cell::text(&a.knee),
            Cell::text(&a.route),
            mm(a.apart.0, 2),
            decimals(a.apart.1, 0),
            mm(a.apart_in_plane.0, 2),
            decimals(a.apart_in_plane.1, 0),
            mm(a.apart_about_origin.0, 2),
            decimals(a.apart_about_origin.1, 0),
            Cell::text(&a.why),
        ]);
    }
    table
}
