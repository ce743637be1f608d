//! Force at resting length along isobars, and eps_620, against resting length (force paper, Fig. 3).

use crate::figures::formatting::number;
use crate::figures::laws::{self, misleading, places};
use crate::figures::looks::of_isobar;
use crate::figures::readings::{first_isobars, near};
use crate::input::GroupInput;
use crate::plot::{Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Mark, Panel, Series, Shape, Stroke};
use pipeline_base::row::Row;
use pipeline_config::Config;
use pipeline_fit::engine::EquationFit;
use pipeline_fit::equations::{CONTRACTION, FORCE_AT_REST, cap_length_m};
use pipeline_mechanics::models::new;

/// The figure, for groups with at least two specimens.
pub fn figure(group: &GroupInput, config: &Config) -> Option<(String, Figure)> {
    if group.fit.specimens.len() < 2 {
        return None;
    }
    let isoclines = Isoclines::new(group, config);
    let title = format!(
        "Force at resting length and contraction at 620 kPa, {}",
        group.fit.group.campaign
    );
    let mut figure = Figure::new(&title, DOUBLE_MM, 58.0).grid(2).shared_legend();
    let (mut letter, mut caption) = ("", String::new());
    if let Some(isoclines) = &isoclines {
        figure = figure.with(isoclines.panel());
        caption = format!("(A) {} ", isoclines.caption());
        letter = "(B) ";
    } else {
        figure.width_mm = 0.5 * DOUBLE_MM;
        figure = figure.grid(1);
        figure.lettered = false;
    }
    figure = figure.with(contraction_panel(group, config));
    caption += &format!("{letter}{}", contraction_caption(group, config));
    Some((caption, figure))
}

/// F_max(l_rest, P) along the isobars that have readings at resting length.
struct Isoclines<'a> {
    group: &'a GroupInput,
    at_rest: f64,
    pressures: Vec<f64>,
    /// Eq. 7 as fitted, where its curve does not mislead.
    fit: Option<&'a EquationFit>,
    /// Why it is not drawn.
    why_not: Option<String>,
    /// a1, a2 as published.
    published: Option<[f64; 2]>,
    /// l_0 of Eq. 7, m.
    offset: f64,
}

impl<'a> Isoclines<'a> {
    fn new(group: &'a GroupInput, config: &Config) -> Option<Self> {
        let diameter = group.fit.group.diameter_mm;
        let at_rest = config.fit.at_rest;
        let pressures = first_isobars(group, |r| r.contraction_rel.abs() <= at_rest);
        if pressures.is_empty() {
            return None;
        }
        let fit = group.fit.equation(FORCE_AT_REST);
        let offset = new::published(diameter, ["l_0 (Eq. 7)"]).map(|[l_0]| l_0);
        Some(Self {
            group,
            at_rest,
            pressures,
            fit: fit.filter(|f| misleading(f).is_none()),
            why_not: fit.and_then(misleading),
            published: new::published(diameter, ["a1", "a2"]),
            offset: offset.unwrap_or_else(|| cap_length_m(diameter, &config.fit)),
        })
    }

    /// Largest resting length of the group, mm.
    fn longest(&self) -> f64 {
        1e3 * self.group.fit.ranges.rest_length_m.1
    }

    fn curve(&self, a: &[f64], pressure_kpa: f64) -> Vec<(f64, f64)> {
        places(1e3 * self.offset, 1.1 * self.longest(), 120)
            .into_iter()
            .map(|mm| {
                let force = new::fmax(a[0], a[1], self.offset, 1e-3 * mm, pressure_kpa);
                (mm, force)
            })
            .collect()
    }

    fn readings(&self, pressure_kpa: f64) -> Vec<(f64, f64)> {
        let at_rest = |r: &&Row| r.contraction_rel.abs() <= self.at_rest;
        near(&self.group.predictions.rows, pressure_kpa)
            .filter(at_rest)
            .map(|r| (1e3 * r.rest_length_m, r.force_n))
            .collect()
    }

    fn panel(&self) -> Panel {
        let mut panel = Panel::new(
            Axis::new("l_{rest} (mm)").including(0.0),
            Axis::new("Force at resting length (N)").including(0.0),
        );
        for pressure in self.pressures.iter().rev() {
            let (ink, shape, _) = of_isobar(*pressure);
            let mark = Mark::open(shape, ink).wide(1.3);
            let marks = Series::marks(
                &format!("{pressure:.0} kPa"),
                self.readings(*pressure),
                mark,
            );
            let curves = [
                (self.fit.map(EquationFit::values), Dash::Solid),
                (self.published.map(Vec::from), Dash::Dashed),
            ];
            for (a, dash) in curves {
                if let Some(a) = a {
                    let curve = self.curve(&a, *pressure);
                    panel = panel.with(Series::line("", curve, Stroke::new(ink, dash)));
                }
            }
            panel = panel.with(marks);
        }
        let kinds = [
            (self.fit.is_some(), "fitted", Dash::Solid),
            (self.published.is_some(), "published", Dash::Dashed),
        ];
        kinds
            .into_iter()
            .filter(|k| k.0)
            .map(|(_, name, dash)| Series::line(name, Vec::new(), Stroke::new(Ink::Black, dash)))
            .fold(panel, Panel::with)
    }

    fn caption(&self) -> String {
        let lines = match (self.fit.is_some(), self.published.is_some()) {
            (true, true) => " Solid: _F_#sub[max] as fitted here; dashed: as published.",
            (true, false) => " Solid: _F_#sub[max] as fitted here.",
            (false, true) => " Dashed: _F_#sub[max] as published.",
            (false, false) => "",
        };
        let missing = self.why_not.as_ref().map_or_else(String::new, |why| {
            format!(" The fit of _F_#sub[max] is not drawn, because {why}.")
        });
        format!(
            "Force at resting length: readings within 10 kPa of the isobars and |_ε_#super[\\*]| at most {}.{lines}{missing}",
            number(self.at_rest, 2)
        )
    }
}

fn contraction_panel(group: &GroupInput, config: &Config) -> Panel {
    let specimens = &group.fit.specimens;
    let points: Vec<(f64, f64)> = specimens
        .iter()
        .map(|s| (1e3 * s.rest_length_m, 100.0 * s.contraction_620))
        .collect();
    let most = points.iter().map(|p| p.1).fold(0.0, f64::max);
    let mut panel = Panel::new(
        Axis::new("l_{rest} (mm)").including(0.0),
        Axis::new("ε_{620} (%)").fixed(0.0, 1.3 * most),
    );
    if let Some(fit) = group.fit.equation(CONTRACTION) {
        let (low, high) = group.fit.ranges.rest_length_m;
        let lengths = places(1e3 * low, 1e3 * high, 40);
        let line = |c: &[f64], mm: f64| 100.0 * (c[0] + c[1] * 1e-3 * mm);
        let confidence = config.fit.confidence;
        let band = laws::band(fit, &lengths, confidence, line);
        if !band.is_empty() {
            let name = format!("{:.0}% band", 100.0 * confidence);
            panel = panel.with(Layer::band(&name, band, Ink::Blue));
        }
        let values = fit.values();
        let curve = lengths.iter().map(|l| (*l, line(&values, *l))).collect();
        let stroke = Stroke::new(Ink::Blue, Dash::Solid);
        panel = panel.with(Series::line("straight line", curve, stroke));
    }
    let mark = Mark::filled(Shape::Circle, Ink::Black);
    panel.with(Series::marks("specimen", points, mark))
}

/// What the straight line says: its adjusted R2 and whether the interval of its slope excludes zero.
fn contraction_caption(group: &GroupInput, config: &Config) -> String {
    let head = "Contraction at 620 kPa without load, one mark a specimen.";
    let Some(fit) = group.fit.equation(CONTRACTION) else {
        return format!("{head} Too few specimens for a straight line.");
    };
    let band = if laws::has_band(fit) {
        " with its jackknife band"
    } else {
        ""
    };
    let r2 = number(fit.adjusted_r2, 2);
    let per = "% per 100 mm";
    let slope = fit.coefficients.iter().find(|c| c.symbol == "slope");
    let interval = slope.and_then(|s| s.ci_low.zip(s.ci_high));
    let verdict = match interval {
        None => "it has no interval, so nothing can be said about a relation".to_owned(),
        Some((low, high)) => {
            let ends = format!(
                "its slope of {}{per} has the {:.0}% interval {} to {}{per}",
                number(10.0 * slope.map_or(f64::NAN, |s| s.value), 2),
                100.0 * config.fit.confidence,
                number(10.0 * low, 2),
                number(10.0 * high, 2)
            );
            if low <= 0.0 && high >= 0.0 {
                format!("{ends}, which contains zero: no usable relation")
            } else {
                format!("{ends}, which excludes zero")
            }
        }
    };
    format!("{head} The straight line{band} has an adjusted _R_#super[2] of {r2}; {verdict}.")
}
