//! What the new model leaves over, against everything that was recorded beside it, with running medians, and a normal quantile plot.

use crate::figures::covariates::{Covariate, covariates};
use crate::figures::formatting::listed;
use crate::figures::trend::{columns, spread, trend};
use crate::input::GroupInput;
use crate::plot::{Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Mark, Panel, Series, Shape, Stroke};
use pipeline_base::row::Row;
use pipeline_compare::{NEW, NEW_LOSO};
use pipeline_config::Config;
use pipeline_fit::is_fitted;
use pipeline_numerics::running::normal_plot;

/// Fewest readings for a figure.
const FEWEST: usize = 12;
/// The figure: of leave-one-specimen-out predictions, or of the fit where no specimen can be left out.
pub fn figure(group: &GroupInput, _config: &Config) -> Option<(String, Figure)> {
    let by_model = &group.predictions.by_model;
    let unseen = by_model.get(NEW_LOSO);
    let predicted = unseen.or_else(|| by_model.get(NEW))?;
    // What its owner holds out takes part in no choice, and a look at residuals is the beginning of one.
    let rows = group.predictions.rows.iter().zip(predicted);
    let rows: Vec<(&Row, f64)> = rows
        .filter(|(r, p)| is_fitted(r) && p.is_finite())
        .map(|(r, p)| (r, *p))
        .collect();
    if rows.len() < FEWEST {
        return None;
    }
    let sheet = Sheet::new(rows);
    let title = format!("Residuals, {}", group.fit.group.campaign);
    let quantiles = sheet.quantiles();
    let panels = sheet.covariates.len() + usize::from(quantiles.is_some());
    let columns = columns(panels);
    let mut figure = Figure::new(&title, DOUBLE_MM, 0.0)
        .grid(columns)
        .shared_legend();
    let all = sheet.covariates.iter().map(|c| sheet.panel(c));
    for (k, mut panel) in all.chain(quantiles).enumerate() {
        if k % columns > 0 {
            panel.y = panel.y.bare();
        }
        figure = figure.with(panel);
    }
    figure.height_mm = 6.0 + 44.0 * panels.div_ceil(columns) as f64;
    let caption = sheet.caption(unseen.is_some(), panels);
    Some((caption, figure))
}

struct Sheet {
    residuals: Vec<f64>,
    covariates: Vec<Covariate>,
    /// Extra columns for which there was no panel.
    untold: Vec<String>,
    /// Range of the residuals, N.
    range: (f64, f64),
}

impl Sheet {
    fn new(rows: Vec<(&Row, f64)>) -> Self {
        let residuals: Vec<f64> = rows.iter().map(|(r, p)| r.force_n - p).collect();
        let (covariates, untold) = covariates(&rows);
        let low = residuals.iter().copied().fold(0.0, f64::min);
        let high = residuals.iter().copied().fold(0.0, f64::max);
        let margin = 0.04 * (high - low);
        Self {
            residuals,
            covariates,
            untold,
            range: (low - margin, high + margin),
        }
    }

    fn y_axis(&self) -> Axis {
        Axis::new("Residual (N)").fixed(self.range.0, self.range.1)
    }

    fn panel(&self, against: &Covariate) -> Panel {
        let places = if against.spread {
            spread(&against.values)
        } else {
            against.values.clone()
        };
        let residuals = self.residuals.iter().copied();
        let points = places.into_iter().zip(residuals).collect();
        let dot = Mark::filled(Shape::Dot, Ink::Grey);
        Panel::new(against.axis(), self.y_axis())
            .with(Layer::zero())
            .with(Series::marks("reading", points, dot))
            .with(trend(&against.values, &self.residuals, against.spread))
    }

    fn quantiles(&self) -> Option<Panel> {
        let plot = normal_plot(&self.residuals)?;
        let end = plot.points.last()?.0;
        let line = [-end, end].map(|q| (q, plot.intercept + plot.slope * q));
        let dot = Mark::filled(Shape::Dot, Ink::Grey);
        let stroke = Stroke::new(Ink::Black, Dash::Dashed);
        Some(
            Panel::new(Axis::new("Normal quantile (–)"), self.y_axis())
                .with(Layer::zero())
                .with(Series::marks("reading", plot.points, dot))
                .with(Series::line("through the quartiles", line.to_vec(), stroke)),
        )
    }

    fn caption(&self, unseen: bool, panels: usize) -> String {
        let letter = |k: usize| char::from(b'A' + (k as u8).min(25));
        let against: Vec<String> = self
            .covariates
            .iter()
            .enumerate()
            .map(|(k, c)| format!("{} ({})", c.words, letter(k)))
            .collect();
        let predicted = if unseen {
            "the prediction of the fit without the specimen"
        } else {
            "the prediction of the fit itself"
        };
        let quantiles = if panels > self.covariates.len() {
            format!(
                ", and against normal quantiles ({})",
                letter(self.covariates.len())
            )
        } else {
            String::new()
        };
        let sideways = if self.covariates.iter().any(|c| c.spread) {
            " Readings of one phase or session are spread sideways."
        } else {
            ""
        };
        let untold = if self.untold.is_empty() {
            String::new()
        } else {
            format!(" Not shown: {}.", listed(&self.untold))
        };
        format!(
            "Residuals of {} readings, measured force minus {predicted}, against {}{quantiles}.{sideways}{untold}",
            self.residuals.len(),
            listed(&against)
        )
    }
}
