//! Relative force against relative contraction along isobars, with the readings near them and the Festo tool (force paper, Fig. 4).

use crate::figures::formatting::{millimetres, number};
use crate::figures::laws::{festo, places};
use crate::figures::looks::of_isobar;
use crate::figures::readings::{isobars, near};
use crate::input::GroupInput;
use crate::plot::{Axis, DOUBLE_MM, Dash, Figure, Ink, Mark, Panel, Series, Stroke};
use pipeline_config::Config;
use pipeline_fit::SpecimenSummary;
use pipeline_fit::equations::{JOINT, cap_length_m};
use pipeline_mechanics::models::{P_620_KPA, new};

/// The figure: the joint fit beside the published surface, with the same readings.
pub fn figure(group: &GroupInput, config: &Config) -> Option<(String, Figure)> {
    let diameter = group.fit.group.diameter_mm;
    let c = group.fit.equation(JOINT)?.values();
    let pressures = isobars(group);
    let specimen = middle(group)?;
    if pressures.is_empty() {
        return None;
    }
    let offset = cap_length_m(diameter, &config.fit);
    let sheet = Sheet {
        group,
        pressures,
        specimen,
    };
    let fitted = sheet.panel([c[2], c[3], c[4]], |l| new::f620(c[0], c[1], offset, l));
    let title = format!("Relative force along isobars, {}", group.fit.group.campaign);
    let mut figure = Figure::new(&title, DOUBLE_MM, 60.0)
        .grid(2)
        .shared_legend()
        .with(fitted.title("Fitted here"));
    if let Some([b1, b2, c0, c1, c2]) = new::published(diameter, new::SYMBOLS) {
        let panel = sheet.panel([c0, c1, c2], |l| new::f620(b1, b2, offset, l));
        figure = figure.with(panel.title("Published coefficients"));
    }
    Some((sheet.caption(figure.panels.len() > 1), figure))
}

/// The specimen of middle resting length.
fn middle(group: &GroupInput) -> Option<&SpecimenSummary> {
    let specimens = &group.fit.specimens;
    specimens.get(specimens.len().saturating_sub(1) / 2)
}

struct Sheet<'a> {
    group: &'a GroupInput,
    pressures: Vec<f64>,
    /// Whose eps_620 and F_620 bring the Festo tool to relative numbers.
    specimen: &'a SpecimenSummary,
}

impl Sheet<'_> {
    /// One panel: a surface with its law of length, by which the readings and the tool are divided.
    fn panel(&self, c: [f64; 3], f620: impl Fn(f64) -> f64) -> Panel {
        let rows = &self.group.predictions.rows;
        let contractions = rows.iter().map(|r| r.contraction_rel);
        let least = contractions.clone().fold(0.0, f64::min).max(-0.2) - 0.02;
        let most = contractions.fold(0.0, f64::max).clamp(1.0, 1.3) + 0.02;
        let at = places(least, most, 120);
        let diameter = self.group.fit.group.diameter_mm;
        let (own_620, own_f620) = (
            self.specimen.contraction_620,
            f620(self.specimen.rest_length_m),
        );
        let mut panel = Panel::new(
            Axis::new("ε* = ε/ε_{620}").fixed(least, most),
            Axis::new("F* = \\v{F}/F_{620}")
                .including(0.0)
                .including(1.05),
        );
        for pressure in self.pressures.iter().rev() {
            let (ink, shape, _) = of_isobar(*pressure);
            let mark = Mark::open(shape, ink).wide(1.2);
            let model = |e: &f64| (*e, new::surface(c, *e, pressure / P_620_KPA));
            let tool = |e: &f64| (*e, festo(diameter, e * own_620, *pressure) / own_f620);
            let near = near(rows, *pressure)
                .map(|r| (r.contraction_rel, r.force_n / f620(r.rest_length_m)))
                .collect();
            let (solid, dashed) = (
                Stroke::new(ink, Dash::Solid),
                Stroke {
                    width_pt: 0.7,
                    ..Stroke::new(ink, Dash::Dashed)
                },
            );
            let name = format!("{pressure:.0} kPa");
            panel = panel
                .with(Series::line("", at.iter().map(tool).collect(), dashed))
                .with(Series::line("", at.iter().map(model).collect(), solid))
                .with(Series::marks("", near, mark))
                .with(Series::line(&name, Vec::new(), solid).with_marks(mark));
        }
        let sample = Stroke::new(Ink::Black, Dash::Dashed);
        panel.with(Series::line("Festo tool", Vec::new(), sample))
    }

    fn caption(&self, both: bool) -> String {
        let whose = if both {
            " from the coefficients of the panel"
        } else {
            ""
        };
        format!(
            "Relative force against relative contraction. Solid: isobars of the surface. Marks: readings within 10 kPa of them, divided by \
             _F_#sub[620] of their resting length{whose}. Dashed: the Festo tool, divided by _F_#sub[620] of the specimen of {} with its \
             _ε_#sub[620] of {}%.",
            millimetres(self.specimen.rest_length_m),
            number(100.0 * self.specimen.contraction_620, 1)
        )
    }
}
