//! The figures, one file each. A figure of a group is one new file and one line in the list below, or in
//! [`found`] if it shows what was found in the residual.
//!
//! A figure that cannot be built is left out and named ([`LeftOut`]); it takes no other with it.

pub mod campaign_plan;
pub mod common_readings;
mod covariates;
mod data;
pub mod design;
mod formatting;
pub mod found;
pub mod inspection;
pub mod knee;
mod laws;
pub mod leg_prediction;
pub mod log;
mod looks;
mod model_curves;
mod plateaus;
pub mod prediction;
mod readings;
mod trend;

use crate::input::{GroupInput, ReportInput};
use crate::left_out::{LeftOut, Part, Task, attempt};
use crate::plot::{DOUBLE_MM, Figure, SINGLE_MM};
use pipeline_base::error::Result;
use pipeline_base::group::Group;
use pipeline_base::names::file_name;
use pipeline_config::{Config, FigureWidths, ReportOptions};
use pipeline_findings::CampaignFindings;
use pipeline_torque::diagnose::JointDiagnosis;
use rayon::prelude::*;
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
    /// The same figure for the columns of a journal: one of one column, one of two, or of a share of these.
    fn widened(mut self, widths: FigureWidths) -> Self {
        let [single, double] = widths.columns_mm();
        let width = self.figure.width_mm;
        self.figure.width_mm = if width <= SINGLE_MM {
            width * single / SINGLE_MM
        } else {
            width * double / DOUBLE_MM
        };
        self
    }

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

/// Makes a figure of a group with its caption; none for groups that lack the data.
type OfGroup = fn(&GroupInput, &Config) -> Option<(String, Figure)>;

/// Declares the files of the figures of a group and lists these, so that both stand in one line a figure.
macro_rules! figures_of_group {
    ($($name:literal: $file:ident,)+) => {
        $(mod $file;)+

        /// Every figure that a group of rows may have, by the name of its files, in the order of the report: those of the paper, then those that
        /// look for what is left over.
        const OF_GROUP: &[(&str, OfGroup)] = &[$(($name, $file::figure)),+];
    };
}

// rustfmt does not follow modules declared by a macro: check them with `rustfmt --edition 2024 --check src/report/figures/*.rs`.
figures_of_group! {
    "f620": maximum_force,
    "rest": rest,
    "isobars": isobars,
    "curves": models_at_lengths,
    "models": error_by_model,
    "predicted": predicted,
    "specimen-errors": error_by_specimen,
    "residuals": residuals,
}

/// Those of them that stand in the supplement.
const SUPPLEMENTARY: [&str; 3] = ["curves", "specimen-errors", "residuals"];

/// Whether a figure of the group of that name in files stands in the supplement.
pub(crate) fn is_supplementary(drawn: &Drawn, slug: &str) -> bool {
    let mut names = SUPPLEMENTARY.iter();
    names.any(|kind| drawn.name == of_group_named(kind, slug))
}

fn of_group_named(kind: &str, slug: &str) -> String {
    format!("{kind}-{slug}")
}

/// A figure, or the one that could not be composed.
pub type Composed = std::result::Result<Named, LeftOut>;

/// The figures of one group; those for which it has the data.
pub fn of_group(group: &GroupInput, config: &Config) -> Vec<Composed> {
    named(OF_GROUP, group, config)
}

/// The figures of what was found in the residual of one group; none for groups that were not diagnosed.
pub fn of_diagnosis(group: &GroupInput) -> Vec<(found::Kind, Composed)> {
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

/// The part of a campaign, such as `pinned-knee-flexor`, as names of files have it.
pub(crate) fn part_in_names(found: &CampaignFindings) -> String {
    let part = found.part.as_deref().unwrap_or_default();
    part.replace(", ", "-").replace(' ', "-")
}

/// The figures of what was found of one joint.
pub fn of_joint(joint: &JointDiagnosis) -> Vec<(found::Kind, Composed)> {
    let found = &joint.findings;
    let part = part_in_names(found);
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

fn named(figures: &[(&str, OfGroup)], group: &GroupInput, config: &Config) -> Vec<Composed> {
    let one = |(kind, make): &(&str, OfGroup)| {
        let name = of_group_named(kind, &slug(group));
        compose(&name, || {
            let (caption, figure) = make(group, config)?;
            Some(Named {
                name: name.clone(),
                caption: captioned(&group.fit.group, &caption),
                figure,
            })
        })
    };
    figures.iter().filter_map(one).collect()
}

/// A caption that says of what the figure is, and where its data come from if not from a rig.
fn captioned(of: &Group, caption: &str) -> String {
    let simulated = if of.simulated { "Simulated. " } else { "" };
    let name = formatting::verbatim(&format!("{}, {} mm", of.campaign, of.diameter_mm));
    format!("{simulated}{name}. {caption}")
}

/// What `make` gives; where it panics, the figure of that name is left out.
pub fn compose(name: &str, make: impl FnOnce() -> Option<Named>) -> Option<Composed> {
    attempt(Part::Figure, name, Task::Composing, || Ok(make())).transpose()
}

/// Figures as built.
#[derive(Debug, Default)]
pub struct Built {
    /// The drawings in the places of their figures; none where one has no data or was left out.
    pub drawn: Vec<Option<Drawn>>,
    /// Files by name.
    pub files: Vec<(String, Vec<u8>)>,
    /// Those that could not be built.
    pub left_out: Vec<LeftOut>,
}

/// Draws figures and writes them in all formats. One that fails in any of them is left out in all.
pub fn build(composed: Vec<Option<Composed>>, options: &ReportOptions) -> Built {
    let one = |composed: Option<Composed>| {
        composed.map(|c| drawn_with_files(c?.widened(options.figure_widths), options.png_dpi))
    };
    let all: Vec<_> = composed.into_par_iter().map(one).collect();
    let mut built = Built::default();
    for figure in all {
        let figure = match figure {
            Some(Err(left_out)) => {
                built.left_out.push(left_out);
                None
            }
            Some(Ok(figure)) => Some(figure),
            None => None,
        };
        built.drawn.push(figure.map(|(drawn, files)| {
            built.files.extend(files);
            drawn
        }));
    }
    built
}

type Files = Vec<(String, Vec<u8>)>;

fn drawn_with_files(named: Named, png_dpi: f64) -> std::result::Result<(Drawn, Files), LeftOut> {
    let drawn = attempt(Part::Figure, &named.name, Task::Drawing, || named.draw())?;
    let written = || files(&drawn, png_dpi);
    let mut files = attempt(Part::Figure, &named.name, Task::Converting, written)?;
    let data = data::csv(&named.figure).into_bytes();
    files.push((format!("{}.csv", drawn.name), data));
    Ok((drawn, files))
}

/// The logs with their plateaus, one figure a trace, none for a trace that lacks the data.
pub fn plateaus(input: &ReportInput) -> Vec<Option<Composed>> {
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
    let pdf = crate::typeset::svg_to_pdf(&drawn.svg, &drawn.title, drawn.size_mm)?;
    let png = crate::raster::svg_to_png(&drawn.svg, png_dpi)?;
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
mod pool_tests;
#[cfg(test)]
pub(crate) mod tests;
