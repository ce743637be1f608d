//! The figures, one file each. A figure of a group is one new file and one line in [`OF_GROUP`], or in
//! [`found`] if it shows what was found in the residual.

mod covariates;
mod error_by_model;
mod error_by_specimen;
mod formatting;
pub mod found;
mod isobars;
pub mod knee;
mod laws;
pub mod leg_prediction;
pub mod log;
mod looks;
mod maximum_force;
mod model_curves;
mod models_at_lengths;
mod plateaus;
mod predicted;
pub mod prediction;
mod readings;
mod residuals;
mod rest;
mod trend;

use crate::base::error::Result;
use crate::base::names::file_name;
use crate::config::Config;
use crate::report::input::{GroupInput, ReportInput};
use crate::report::plot::Figure;
use crate::stages::torque::diagnose::JointDiagnosis;
use serde::{Deserialize, Serialize};

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

/// A figure as drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// Name of the files, without extension.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// The figure's own title.
    pub title: String,
    /// Width and height, mm.
    pub size_mm: (f64, f64),
    /// The drawing.
    pub svg: String,
}

impl Named {
    /// Draws the figure.
    ///
    /// # Errors
    /// A figure too small for its contents.
    pub fn draw(&self) -> Result<Drawn> {
        Ok(Drawn {
            name: self.name.clone(),
            caption: self.caption.clone(),
            title: self.figure.title.clone(),
            size_mm: (self.figure.width_mm, self.figure.height_mm),
            svg: self.figure.to_svg()?,
        })
    }
}

type OfGroup = fn(&GroupInput, &Config) -> Option<(&'static str, String, Figure)>;

/// Every figure that a group of rows may have, in the order of the report: those of the paper, then those that look for what is left over.
const OF_GROUP: &[OfGroup] = &[
    maximum_force::figure,
    rest::figure,
    isobars::figure,
    models_at_lengths::figure,
    error_by_model::figure,
    predicted::figure,
    error_by_specimen::figure,
    residuals::figure,
];

/// The figures of one group; those for which it has the data.
pub fn of_group(group: &GroupInput, config: &Config) -> Vec<Named> {
    named(OF_GROUP, group, config)
}

/// The figures of what was found in the residual of one group; none for groups that were not diagnosed.
pub fn of_diagnosis(group: &GroupInput) -> Vec<(found::Kind, Named)> {
    let Some(diagnosis) = &group.diagnosis else {
        return Vec::new();
    };
    found::figures(&found::Shown {
        found: &diagnosis.findings,
        residuals: &diagnosis.residuals,
        rows: &group.predictions.rows,
        slug: slug(group),
    })
}

/// The figures of what was found of one joint.
pub fn of_joint(joint: &JointDiagnosis) -> Vec<(found::Kind, Named)> {
    let found = &joint.findings;
    let part = found.part.as_deref().unwrap_or_default();
    found::figures(&found::Shown {
        found,
        residuals: &joint.residuals,
        rows: &[],
        slug: file_name(&format!(
            "{}-{part}-{}mm",
            found.campaign, found.diameter_mm
        )),
    })
}

fn named(figures: &[OfGroup], group: &GroupInput, config: &Config) -> Vec<Named> {
    figures
        .iter()
        .filter_map(|make| make(group, config))
        .map(|(name, caption, figure)| Named {
            name: format!("{name}-{}", slug(group)),
            caption: if group.fit.group.simulated {
                format!("Simulated. {caption}")
            } else {
                caption
            },
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
    if name.ends_with(&suffix) {
        name
    } else {
        format!("{name}-{suffix}")
    }
}

/// SVG, PDF and PNG of a figure, by file name.
///
/// # Errors
/// A drawing that is no SVG.
pub fn files(drawn: &Drawn, png_dpi: f64) -> Result<Vec<(String, Vec<u8>)>> {
    let pdf = crate::report::typeset::svg_to_pdf(&drawn.svg, &drawn.title, drawn.size_mm)?;
    let png = crate::report::raster::svg_to_png(&drawn.svg, png_dpi)?;
    Ok(vec![
        (
            format!("{}.svg", drawn.name),
            drawn.svg.clone().into_bytes(),
        ),
        (format!("{}.pdf", drawn.name), pdf),
        (format!("{}.png", drawn.name), png),
    ])
}

#[cfg(test)]
mod tests;
