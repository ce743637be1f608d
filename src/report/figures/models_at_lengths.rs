//! Force against contraction of a short, a middle and a long specimen at two pressures: readings and every compared model.

use crate::figures::formatting::{listed, millimetres, specimen_names};
use crate::figures::laws::places;
use crate::figures::model_curves::{Curve, Model, models};
use crate::figures::readings::near;
use crate::input::GroupInput;
use crate::plot::style::HAIR_PT;
use crate::plot::{Axis, DOUBLE_MM, Figure, Ink, Mark, Panel, Series, Shape, Stroke};
use pipeline_config::Config;
use pipeline_fit::SpecimenSummary;
use pipeline_mechanics::models::Prediction;
use std::collections::BTreeSet;

/// Pressures of the upper and of the lower row, kPa: the first of each that has readings.
const ROWS_KPA: [&[f64]; 2] = [&[620.0, 600.0, 500.0], &[300.0, 350.0, 250.0, 400.0]];
/// Room above the largest force shown, as a factor: curves beyond are cut off.
const HEADROOM: f64 = 1.3;

/// The figure, for groups with readings near one of the pressures.
pub fn figure(group: &GroupInput, config: &Config) -> Option<(String, Figure)> {
    let sheet = Sheet::new(group, config)?;
    let title = format!(
        "All models at several resting lengths, {}",
        group.fit.group.campaign
    );
    let names = sheet.names();
    let (columns, rows) = (sheet.specimens.len(), sheet.pressures.len());
    let width = DOUBLE_MM.min(70.0 + 52.5 * columns as f64);
    let mut figure = Figure::new(&title, width, 24.0 + 52.0 * rows as f64)
        .grid(columns)
        .shared_legend();
    for (r, pressure) in sheet.pressures.iter().enumerate() {
        for (c, (specimen, name)) in sheet.specimens.iter().zip(&names).enumerate() {
            let mut panel = sheet.panel(specimen, *pressure);
            panel.title = format!("{name}, {pressure:.0} kPa");
            if c > 0 {
                panel.y = panel.y.bare();
            }
            if r + 1 < rows {
                panel.x = panel.x.bare();
            }
            figure = figure.with(panel);
        }
    }
    Some((sheet.caption(), figure))
}

struct Sheet<'a> {
    group: &'a GroupInput,
    specimens: Vec<&'a SpecimenSummary>,
    pressures: Vec<f64>,
    models: Vec<Model<'a>>,
}

impl<'a> Sheet<'a> {
    fn new(group: &'a GroupInput, config: &'a Config) -> Option<Self> {
        let has = |p: &&f64| near(&group.predictions.rows, **p).next().is_some();
        let pressures: Vec<f64> = ROWS_KPA
            .iter()
            .filter_map(|candidates| candidates.iter().find(has).copied())
            .collect();
        let specimens = specimens(group, &pressures);
        let some = !pressures.is_empty() && !specimens.is_empty();
        some.then(|| Self {
            group,
            specimens,
            pressures,
            models: models(group, config),
        })
    }

    /// The names of the specimens that are shown, among all.
    fn names(&self) -> Vec<String> {
        let all = &self.group.fit.specimens;
        let lengths: Vec<(&str, f64)> = all
            .iter()
            .map(|s| (s.id.as_str(), s.rest_length_m))
            .collect();
        let names = all.iter().zip(specimen_names(&lengths));
        let shown = |s: &SpecimenSummary| self.specimens.iter().any(|other| other.id == s.id);
        let named = names.filter(|(s, _)| shown(s));
        named.map(|(_, name)| name).collect()
    }

    /// Contractions of the curves, as fractions: from resting length to a little beyond the free length.
    fn contractions(&self) -> Vec<f64> {
        let free = self.specimens.iter().map(|s| s.contraction_620);
        places(0.0, 1.1 * free.fold(0.0, f64::max), 90)
    }

    fn curve(&self, model: &Model, specimen: &SpecimenSummary, pressure_kpa: f64) -> Curve {
        let answers: Vec<(f64, Prediction)> = self
            .contractions()
            .into_iter()
            .map(|e| (e, (model.answer)(specimen, e, pressure_kpa)))
            .collect();
        Curve::new(&answers)
    }

    fn readings(&self, specimen: &SpecimenSummary, pressure_kpa: f64) -> Vec<(f64, f64)> {
        near(&self.group.predictions.rows, pressure_kpa)
            .filter(|r| r.specimen == specimen.id)
            .map(|r| (100.0 * r.contraction, r.force_n))
            .collect()
    }

    /// The largest force to be shown at a pressure, N: of the readings, or of the fit where there are none.
    fn top(&self, pressure_kpa: f64) -> f64 {
        let readings = self
            .specimens
            .iter()
            .flat_map(|s| self.readings(s, pressure_kpa));
        HEADROOM * readings.map(|r| r.1).fold(1.0, f64::max)
    }

    fn panel(&self, specimen: &SpecimenSummary, pressure_kpa: f64) -> Panel {
        let last = self.contractions().last().copied().unwrap_or(1.0);
        let mut panel = Panel::new(
            Axis::new("ε (%)").fixed(-1.0, 100.0 * last),
            Axis::new("Force (N)").fixed(0.0, self.top(pressure_kpa)),
        );
        // The legend names them in the order of the comparison; the fitted model is drawn last.
        for model in &self.models {
            panel = panel.with(Series::line(
                &model.look.name,
                Vec::new(),
                model.look.stroke,
            ));
        }
        for model in self.models.iter().rev() {
            let curve = self.curve(model, specimen, pressure_kpa);
            if !curve.is_empty() {
                let thin = Stroke {
                    width_pt: HAIR_PT,
                    ..model.look.stroke
                };
                panel = panel
                    .with(Series::line("", curve.inside, model.look.stroke))
                    .with(Series::line("", curve.beyond, thin));
            }
        }
        let mark = Mark::open(Shape::Circle, Ink::Black).wide(1.2);
        let readings = self.readings(specimen, pressure_kpa);
        panel.with(Series::marks("reading", readings, mark))
    }

    /// The names of models that have no answer in a panel, with the panels; all of them together where it is everywhere.
    fn silent(&self) -> Vec<String> {
        let panels: Vec<(&SpecimenSummary, f64)> = self
            .pressures
            .iter()
            .flat_map(|p| self.specimens.iter().map(|s| (*s, *p)))
            .collect();
        let of = |model: &Model| {
            let empty = panels
                .iter()
                .enumerate()
                .filter(|(_, (s, p))| self.curve(model, s, *p).is_empty());
            let letters: Vec<String> = empty
                .map(|(k, _)| char::from(b'A' + k as u8).to_string())
                .collect();
            if letters.is_empty() {
                None
            } else if letters.len() == panels.len() {
                Some(model.look.name.clone())
            } else {
                Some(format!("{} ({})", model.look.name, letters.join(", ")))
            }
        };
        self.models.iter().filter_map(of).collect()
    }

    fn caption(&self) -> String {
        let silent = self.silent();
        let left_out = if silent.is_empty() {
            String::new()
        } else {
            format!(" Not covered at these states: {}.", listed(&silent))
        };
        let lengths = self.specimens.iter().map(|s| millimetres(s.rest_length_m));
        let lengths: BTreeSet<String> = lengths.collect();
        let which = match (self.specimens.len(), lengths.len()) {
            (1, _) => "the specimen",
            (2, 2) => "the shorter and the longer specimen",
            (2, _) => "two specimens",
            (_, 3) => "a short, a middle and a long specimen",
            _ => "three specimens",
        };
        format!(
            "Force against contraction of {which}: readings within 10 kPa of the pressure and every compared model. Curves are thin where a model \
             extrapolates beyond its data, and end where it gives no force or at the upper edge.{left_out}"
        )
    }
}

/// The shortest, the middle and the longest of the specimens that have readings near all pressures, or of all where none has.
fn specimens<'a>(group: &'a GroupInput, pressures: &[f64]) -> Vec<&'a SpecimenSummary> {
    let has =
        |s: &SpecimenSummary, p: f64| near(&group.predictions.rows, p).any(|r| r.specimen == s.id);
    let complete = |s: &&SpecimenSummary| pressures.iter().all(|p| has(s, *p));
    let all = &group.fit.specimens;
    let mut chosen: Vec<&SpecimenSummary> = all.iter().filter(complete).collect();
    if chosen.is_empty() {
        chosen = all.iter().collect();
    }
    if chosen.len() > 3 {
        let last = chosen.len() - 1;
        chosen = vec![chosen[0], chosen[last / 2], chosen[last]];
    }
    chosen
}
