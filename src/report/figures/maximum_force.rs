//! Maximum force at 620 kPa against resting length: measured, fitted with its band, published, Festo (force paper, Fig. 2).

use crate::figures::formatting::listed;
use crate::figures::laws::{self, Band, festo, misleading, places};
use crate::input::GroupInput;
use crate::plot::{Axis, Dash, Figure, Ink, Layer, Mark, Panel, SINGLE_MM, Series, Shape, Stroke};
use pipeline_config::Config;
use pipeline_fit::engine::EquationFit;
use pipeline_fit::equations::{JOINT, MAXIMUM_FORCE, cap_length_m};
use pipeline_fit::maxima::Maximum;
use pipeline_mechanics::models::{P_620_KPA, new};

/// The figure, for groups with at least two resting lengths.
pub fn figure(group: &GroupInput, config: &Config) -> Option<(String, Figure)> {
    let specimens = group.fit.specimens.iter();
    let maxima: Vec<&Maximum> = specimens.filter_map(|s| s.maximum.as_ref()).collect();
    if maxima.len() < 2 {
        return None;
    }
    let plot = Plot::new(group, config, maxima);
    let title = format!(
        "Maximum force against resting length, {}",
        group.fit.group.campaign
    );
    let figure = Figure::new(&title, SINGLE_MM, 60.0).with(plot.panel());
    Some((plot.caption(), figure))
}

/// One fit of the law of length.
struct Law<'a> {
    fit: &'a EquationFit,
    name: &'static str,
    /// In the caption.
    words: &'static str,
    dash: Dash,
}

struct Plot<'a> {
    diameter_mm: u32,
    /// The length at which the end caps touch, m.
    offset: f64,
    confidence: f64,
    maxima: Vec<&'a Maximum>,
    /// Specimens of the group, with or without a maximum.
    specimens: usize,
    laws: Vec<Law<'a>>,
    /// Resting lengths of the curves, mm.
    lengths: Vec<f64>,
}

impl<'a> Plot<'a> {
    fn new(group: &'a GroupInput, config: &Config, maxima: Vec<&'a Maximum>) -> Self {
        let diameter_mm = group.fit.group.diameter_mm;
        let offset = cap_length_m(diameter_mm, &config.fit);
        let longest = maxima.iter().map(|m| m.rest_length_m).fold(0.0, f64::max);
        let of = |id: &str, name, words, dash| {
            let fit = group.fit.equation(id)?;
            Some(Law {
                fit,
                name,
                words,
                dash,
            })
        };
        let laws = [
            of(
                MAXIMUM_FORCE,
                "fitted to the maxima",
                "the fit to the maxima",
                Dash::Solid,
            ),
            of(JOINT, "fitted jointly", "the joint fit", Dash::Long),
        ];
        Self {
            diameter_mm,
            offset,
            confidence: config.fit.confidence,
            maxima,
            specimens: group.fit.specimens.len(),
            laws: laws.into_iter().flatten().collect(),
            lengths: places(1e3 * offset, 1.1e3 * longest, 150),
        }
    }

    /// The laws whose curve does not mislead.
    fn sound(&self) -> impl Iterator<Item = &Law<'a>> {
        self.laws.iter().filter(|l| misleading(l.fit).is_none())
    }

    fn force(&self, b: &[f64], length_mm: f64) -> f64 {
        new::f620(b[0], b[1], self.offset, 1e-3 * length_mm)
    }

    fn curve(&self, b: &[f64]) -> Vec<(f64, f64)> {
        self.lengths
            .iter()
            .map(|l| (*l, self.force(b, *l)))
            .collect()
    }

    /// The band of the first law that has one, with its words.
    fn band(&self) -> Option<(&'static str, Band)> {
        self.sound()
            .map(|law| {
                let band = laws::band(law.fit, &self.lengths, self.confidence, |b, l| {
                    self.force(b, l)
                });
                (law.words, band)
            })
            .find(|(_, band)| !band.is_empty())
    }

    fn panel(&self) -> Panel {
        let mut lines: Vec<Series> = self
            .sound()
            .map(|law| {
                let curve = self.curve(&law.fit.values());
                Series::line(law.name, curve, Stroke::new(Ink::Blue, law.dash))
            })
            .collect();
        if let Some(b) = new::published(self.diameter_mm, ["b1", "b2"]) {
            let stroke = Stroke::new(Ink::Vermilion, Dash::DashDot);
            lines.push(Series::line("published", self.curve(&b), stroke));
        }
        let tool = festo(self.diameter_mm, 0.0, P_620_KPA);
        if let (true, Some(last)) = (tool.is_finite(), self.lengths.last()) {
            let line = vec![(0.0, tool), (*last, tool)];
            let stroke = Stroke::new(Ink::Black, Dash::Dashed);
            lines.push(Series::line("Festo tool", line, stroke));
        }
        let drawn = lines.iter().flat_map(|l| &l.points).map(|p| p.1);
        let measured = self.maxima.iter().map(|m| m.force_n);
        let top = drawn.chain(measured).fold(0.0, f64::max);
        let mut panel = Panel::new(
            Axis::new("l_{rest} (mm)").including(0.0),
            Axis::new("F_{620} (N)").fixed(0.0, 1.08 * top),
        );
        if let Some((_, band)) = self.band() {
            let name = format!("{:.0}% band", 100.0 * self.confidence);
            panel = panel.with(Layer::band(&name, band, Ink::Blue));
        }
        lines.extend(self.marks());
        lines.into_iter().fold(panel, Panel::with)
    }

    /// The maxima: filled where readings at resting length gave them, open where they were brought there.
    fn marks(&self) -> Vec<Series> {
        let of = |far: bool| -> Vec<(f64, f64)> {
            let maxima = self.maxima.iter().filter(|m| is_extrapolated(m) == far);
            maxima.map(|m| (1e3 * m.rest_length_m, m.force_n)).collect()
        };
        let filled = Mark::filled(Shape::Circle, Ink::Black);
        let open = Mark::open(Shape::Circle, Ink::Black);
        let kinds = [
            ("measured", of(false), filled),
            ("extrapolated", of(true), open),
        ];
        kinds
            .into_iter()
            .filter(|k| !k.1.is_empty())
            .map(|(name, points, mark)| Series::marks(name, points, mark))
            .collect()
    }

    fn caption(&self) -> String {
        let mut shown: Vec<String> = self.sound().map(|l| l.words.to_owned()).collect();
        if new::published(self.diameter_mm, ["b1", "b2"]).is_some() {
            shown.push("the published law".to_owned());
        }
        if festo(self.diameter_mm, 0.0, P_620_KPA).is_finite() {
            shown.push("the manufacturer's tool, one value for all lengths".to_owned());
        }
        let mut caption =
            "Maximum force at 620 kPa and resting length against resting length: one mark for each specimen with readings there"
                .to_owned();
        if self.maxima.iter().any(|m| is_extrapolated(m)) {
            caption +=
                " or nearby (open: a parabola in contraction, extended to the resting length)";
        }
        if !shown.is_empty() {
            caption += &format!("; {}", listed(&shown));
        }
        caption += ".";
        for law in &self.laws {
            if let Some(why) = misleading(law.fit) {
                caption += &format!(" Not drawn: {}, because {why}.", law.words);
            }
        }
        caption + &self.about_the_band()
    }

    fn about_the_band(&self) -> String {
        let percent = 100.0 * self.confidence;
        match self.band() {
            Some((words, _)) => format!(
                " The {percent:.0}% band is that of {words}, from its refits without each specimen (jackknife, Student's _t_)."
            ),
            None if self.sound().next().is_none() => String::new(),
            None if self.specimens == 2 => {
                " With two specimens there is no band.".to_owned()
            }
            None => {
                " There is no band: not every refit without one specimen determines the coefficients."
                    .to_owned()
            }
        }
    }
}

/// Whether a maximum comes from readings at other lengths.
fn is_extrapolated(maximum: &Maximum) -> bool {
    maximum.method == pipeline_fit::maxima::ALONG_LENGTH
}
