//! The figures, one file each. A figure of a group is one new file and one line in [`OF_GROUP`].

mod error_by_model;
mod isobars;
mod maximum_force;
mod plateaus;
mod predicted;

use crate::base::error::Result;
use crate::config::Config;
use crate::report::input::{GroupInput, ReportInput};
use crate::report::plot::Figure;
use crate::base::names::file_name;

/// A figure with the name of its files and its caption (in Typst markup).
#[derive(Clone, Debug)]
pub struct Named {
    /// Name of the files, without extension.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// The figure.
    pub figure: Figure,
}

type OfGroup = fn(&GroupInput, &Config) -> Option<(&'static str, String, Figure)>;

/// Every figure that a group of rows may have, in the order of the report.
const OF_GROUP: &[OfGroup] = &[
    maximum_force::figure,
    isobars::figure,
    predicted::figure,
    error_by_model::figure,
];

/// The figures of one group; those for which it has the data.
pub fn of_group(group: &GroupInput, config: &Config) -> Vec<Named> {
    OF_GROUP
        .iter()
        .filter_map(|make| make(group, config))
        .map(|(name, caption, figure)| Named {
            name: format!("{name}-{}", slug(group)),
            caption,
            figure,
        })
        .collect()
}

/// The logs with their plateaus, one figure a campaign.
pub fn plateaus(input: &ReportInput) -> Vec<Named> {
    plateaus::figures(input)
}

/// The name of a group in file names.
pub fn slug(group: &GroupInput) -> String {
    let g = &group.fit.group;
    let suffix = format!("{}mm", g.diameter_mm);
    let name = file_name(&g.campaign);
    if name.ends_with(&suffix) { name } else { format!("{name}-{suffix}") }
}

/// SVG, PDF and PNG of a figure, by file name.
///
/// # Errors
/// A figure too small for its contents.
pub fn files(named: &Named, png_dpi: f64) -> Result<Vec<(String, Vec<u8>)>> {
    let svg = named.figure.to_svg()?;
    let pdf = crate::report::typeset::svg_to_pdf(&svg, &named.figure.title)?;
    let png = crate::report::raster::svg_to_png(&svg, png_dpi)?;
    Ok(vec![
        (format!("{}.svg", named.name), svg.into_bytes()),
        (format!("{}.pdf", named.name), pdf),
        (format!("{}.png", named.name), png),
    ])
}
