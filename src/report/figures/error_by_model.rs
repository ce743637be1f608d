//! The error of every model on common readings, at a glance.

use crate::input::GroupInput;
use crate::plot::{
    Anchor, Axis, Dash, Figure, Ink, Layer, Legend, Level, Mark, Panel, Place, SINGLE_MM, Series,
    Shape, Side, Stroke,
};
use crate::wording::name::model_name;
use pipeline_compare::{COMMON, Comparison};
use pipeline_config::Config;

/// Height of one model's line, mm.
const PITCH_MM: f64 = 5.0;

/// The figure: RMSE by model, for specimens that the model has not seen; with one specimen the fit itself stands beside the others.
pub fn figure(group: &GroupInput, _config: &Config) -> Option<(String, Figure)> {
    let mut lines: Vec<(&Comparison, f64)> = lines(group)
        .into_iter()
        .filter_map(|c| Some((c, c.rmse?)))
        .collect();
    if lines.len() < 2 {
        return None;
    }
    lines.sort_by(|a, b| b.1.total_cmp(&a.1));
    let title = format!("Error of every model, {}", group.fit.group.campaign);
    let height = 15.0 + PITCH_MM * lines.len() as f64;
    let figure = Figure::new(&title, SINGLE_MM, height).with(panel(&lines));
    Some((caption(&lines), figure))
}

/// One line for each model: on common readings, or for a fit that has not been tried on others on the readings that it was fitted to.
fn lines(group: &GroupInput) -> Vec<&Comparison> {
    let all = &group.comparison.comparisons;
    let unseen = |model: &str| all.iter().any(|c| c.model == model && c.split == COMMON);
    all.iter()
        .filter(|c| c.split == COMMON || (c.split == "train" && !unseen(&c.model)))
        .collect()
}

fn is_seen(line: &Comparison) -> bool {
    line.split == "train"
}

/// Name and mark of a kind of line, and whether a line is of it.
type Kind = (&'static str, Mark, fn(&Comparison) -> bool);

fn panel(lines: &[(&Comparison, f64)]) -> Panel {
    let most = lines.iter().map(|l| l.1).fold(0.0, f64::max);
    let names = lines
        .iter()
        .map(|(line, _)| model_name(&line.model, &line.title));
    let y = Axis::categories("", &names.collect::<Vec<_>>());
    let mut panel =
        Panel::new(Axis::new("RMSE (N)").fixed(0.0, 1.25 * most), y).legend(Legend::Above);
    for (k, (_, rmse)) in lines.iter().enumerate() {
        let place = k as f64;
        let stalk = Stroke::hair(Ink::Grey, Dash::Solid);
        panel = panel
            .with(Series::line("", vec![(0.0, place), (*rmse, place)], stalk))
            .with(text(&format!("{rmse:.1}"), (rmse + 0.04 * most, place)));
    }
    let kinds: [Kind; 3] = [
        (
            "all common readings",
            Mark::filled(Shape::Circle, Ink::Blue),
            |c| c.n_excluded == 0 && !is_seen(c),
        ),
        (
            "those that it covers",
            Mark::open(Shape::Circle, Ink::Vermilion),
            |c| c.n_excluded > 0 && !is_seen(c),
        ),
        (
            "fitted to these readings",
            Mark::open(Shape::Square, Ink::Black),
            is_seen,
        ),
    ];
    for (name, mark, belongs) in kinds {
        let of = lines.iter().enumerate().filter(|(_, l)| belongs(l.0));
        let points: Vec<(f64, f64)> = of.map(|(k, l)| (l.1, k as f64)).collect();
        if !points.is_empty() {
            panel = panel.with(Series::marks(name, points, mark.wide(1.8)));
        }
    }
    panel
}

fn text(text: &str, (x, y): (f64, f64)) -> Layer {
    Layer::Text {
        text: text.to_owned(),
        place: Place::Data(x, y),
        anchor: Anchor::new(Side::Left, Level::Center),
    }
}

fn caption(lines: &[(&Comparison, f64)]) -> String {
    let is_common = |l: &&(&Comparison, f64)| l.0.split == COMMON;
    let readings = lines
        .iter()
        .filter(is_common)
        .map(|l| l.0.n + l.0.n_excluded);
    let readings = readings.max().unwrap_or(0);
    let fitted = if lines.iter().any(|l| is_seen(l.0)) {
        "; for the new model no specimen could be left out, and its error is on the readings to which it was fitted"
    } else if lines.iter().any(|l| l.0.fitted_here) {
        ", the new model fitted to the other specimens"
    } else {
        ""
    };
    let partial = if lines.iter().any(|l| l.0.n_excluded > 0) {
        " Open circles: models that do not cover all of these readings."
    } else {
        ""
    };
    let refitted = if lines.iter().any(|l| l.0.model == "martens2017") {
        " (that of Martens and Boblan with its geometry refitted to their own maps)"
    } else {
        ""
    };
    let ranked = if lines.iter().any(|l| l.0.model == "hunt2017") {
        "the new model, Hunt 2017 and the Festo tool all cover"
    } else {
        "the new model and the Festo tool both cover (Hunt 2017 has no coefficients for this diameter)"
    };
    format!(
        "Root-mean-square error of every model on the {readings} readings that {ranked}: published models as \
         published{refitted}{fitted}.{partial}"
    )
}
