//! Each effect's likelihood profile, each specimen's own estimate of it, and its free form where one was tested.

use super::{HALF_MM, Shown, TEXT_MM, axis_label, group_names};
use crate::plot::axis::Span;
use crate::plot::{Axis, Dash, Figure, Ink, Layer, Legend, Mark, Panel, Series, Shape, Stroke};
use crate::wording::name::{self, nouns};
use crate::wording::number::equals_probability;
use crate::wording::sentence::called;
use pipeline_findings::{EffectFinding, Estimate};

/// Most effects with a row of panels, and most specimens in one, so that the figure fits on a page with its caption.
const MOST_EFFECTS: usize = 6;
const MOST_SPECIMENS: usize = 20;
const PAGE_MM: f64 = 200.0;
/// Height of a row without specimens, and of a specimen, mm.
const ROW_MM: f64 = 29.0;
const SPECIMEN_MM: f64 = 3.4;
const AROUND_MM: f64 = 14.0;
/// How far down a profile is drawn.
const DEEPEST: f64 = -6.0;
/// Normal quantile of a 95% interval.
const Z: f64 = 1.96;

/// The figure; none where no effect has a profile or estimates of its specimens.
pub fn figure(shown: &Shown) -> Option<(String, Figure)> {
    let effects: Vec<&EffectFinding> = shown.found.effects.iter().take(MOST_EFFECTS).collect();
    let unit = nouns(shown.found).unit;
    let rows: Vec<Vec<Panel>> = effects
        .iter()
        .map(|e| panels(e, unit))
        .filter(|row| !row.is_empty())
        .collect();
    let columns = rows.iter().map(Vec::len).max()?;
    let most = effects.iter().map(|e| e.by_specimen.len()).max()?;
    let height = ROW_MM.max(AROUND_MM + SPECIMEN_MM * most.min(MOST_SPECIMENS) as f64);
    let fit = ((PAGE_MM / height) as usize).max(1);
    let title = format!("Evidence for the effects, {}", shown.found.campaign);
    let width = if columns > 1 { TEXT_MM } else { HALF_MM };
    let mut figure = Figure::new(&title, width, 0.0).grid(columns);
    let shown_rows = rows.len().min(fit);
    for panel in rows.into_iter().take(fit).flatten() {
        figure = figure.with(panel);
    }
    // Below the rows, as many as the page holds, those whose size changes first.
    let is_asked = |differs: bool| {
        let asked = effects.iter().copied();
        asked.filter(move |e| e.free_form.as_ref().is_some_and(|f| f.differs == differs))
    };
    let free = is_asked(true).chain(is_asked(false)).filter_map(free_form);
    let free: Vec<Panel> = free.take(columns * (fit - shown_rows)).collect();
    let drawn = free.len();
    for panel in free {
        figure = figure.with(panel);
    }
    figure.height_mm = 2.0 + height * figure.panels.len().div_ceil(columns) as f64;
    Some((caption(shown, fit, drawn), figure))
}

fn panels(effect: &EffectFinding, unit: &str) -> Vec<Panel> {
    [profile(effect), own_estimates(effect, unit)]
        .into_iter()
        .flatten()
        .collect()
}

/// Symbol and unit of the amplitude.
fn amplitude(effect: &EffectFinding) -> String {
    let first = effect.parameters.first();
    first.map_or_else(String::new, |p| axis_label(letter(&p.name), &p.unit))
}

/// A symbol whose name is that of a Greek letter, as this letter.
fn letter(symbol: &str) -> &str {
    match symbol {
        "chi" => "χ",
        "tau" => "τ",
        other => other,
    }
}

/// The interval of the amplitude, an unbounded end far outside.
fn interval(effect: &EffectFinding) -> Option<Layer> {
    let p = effect.parameters.first()?;
    let far = 1e3 * p.value.abs().max(1.0);
    let span = (p.ci_low.unwrap_or(-far), p.ci_high.unwrap_or(far));
    (p.ci_low.is_some() || p.ci_high.is_some()).then(|| Layer::windows("95% interval", vec![span]))
}

fn estimate(effect: &EffectFinding) -> Option<Layer> {
    let value = effect.parameters.first()?.value;
    let stroke = Stroke::hair(Ink::Black, Dash::Dashed);
    Some(Layer::Steps {
        name: "estimate".to_owned(),
        at: vec![value],
        stroke,
    })
}

fn profile(effect: &EffectFinding) -> Option<Panel> {
    if effect.profile.len() < 3 {
        return None;
    }
    let near: Vec<(f64, f64)> = effect
        .profile
        .iter()
        .copied()
        .filter(|(_, l)| *l >= DEEPEST)
        .collect();
    let mut panel = Panel::new(
        Axis::new(&amplitude(effect)),
        Axis::new("Δ log \\v{L}").fixed(DEEPEST, 0.4),
    )
    .title(&name::capitalised(&called(effect)))
    .legend(Legend::None);
    for layer in interval(effect).into_iter().chain(estimate(effect)) {
        panel = panel.with(layer);
    }
    Some(panel.with(Series::line("", near, Stroke::new(Ink::Blue, Dash::Solid))))
}

fn own_estimates(effect: &EffectFinding, unit: &str) -> Option<Panel> {
    if effect.by_specimen.len() < 2 {
        return None;
    }
    // The axis counts from below; the first specimen stands above, as in a table.
    let own: Vec<(&String, &Estimate)> = effect.by_specimen.iter().take(MOST_SPECIMENS).collect();
    let names = group_names(own.iter().rev().map(|(id, _)| *id));
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let estimates = || own.iter().rev().map(|(_, e)| *e);
    let points = estimates()
        .enumerate()
        .map(|(k, e)| (e.value, k as f64))
        .collect();
    let ends = estimates()
        .map(|e| {
            (
                e.value - Z * e.standard_error,
                e.value + Z * e.standard_error,
            )
        })
        .collect();
    let mut panel = Panel::new(Axis::new(&amplitude(effect)), Axis::categories("", &names))
        .title(&format!("Each {unit} alone"))
        .legend(Legend::None);
    for layer in interval(effect).into_iter().chain(estimate(effect)) {
        panel = panel.with(layer);
    }
    let mark = Mark::filled(Shape::Square, Ink::Blue);
    Some(panel.with(Series::marks("", points, mark).with_x_errors(ends)))
}

/// The size of an effect along its own argument, beside the constant.
fn free_form(effect: &EffectFinding) -> Option<Panel> {
    let free = effect.free_form.as_ref()?;
    let label = name::capitalised(&name::column(&free.argument));
    let plain = effect.parameters.first()?.value;
    let mut y = Axis::new(&amplitude(effect));
    y.span = Span::Around(vec![plain]);
    let curve = free.curve.iter();
    let panel = Panel::new(Axis::new(&axis_label(&label, &free.unit)), y)
        .title(&format!(
            "{}, \\v{{p}} {}",
            name::capitalised(&name::effect(&effect.id)),
            equals_probability(free.p)
        ))
        .legend(Legend::None)
        .with(Layer::band(
            "",
            curve.clone().map(|c| (c.at, c.low, c.high)).collect(),
            Ink::Vermilion,
        ))
        .with(Layer::Level {
            name: String::new(),
            at: plain,
            stroke: Stroke::hair(Ink::Black, Dash::Dashed),
        });
    let line = curve.map(|c| (c.at, c.amplitude)).collect();
    Some(panel.with(Series::line(
        "",
        line,
        Stroke::new(Ink::Vermilion, Dash::Solid),
    )))
}

fn caption(shown: &Shown, fit: usize, drawn: usize) -> String {
    let nouns = nouns(shown.found);
    let effects = &shown.found.effects;
    let asked = effects.iter().filter(|e| e.free_form.is_some()).count();
    let free = match drawn {
        0 => String::new(),
        _ => {
            let which = if drawn < asked {
                format!(", {drawn} of {asked}")
            } else {
                String::new()
            };
            format!(
                " Below{which}: the size as a smooth function of the effect's own argument, with its 95% band, and the probability of such a \
                 change if one size is enough. Everything else is refitted, so that it need not agree with the single size (dashed)."
            )
        }
    };
    let most = effects
        .iter()
        .map(|e| e.by_specimen.len())
        .max()
        .unwrap_or(0);
    let cut = if most > MOST_SPECIMENS {
        format!(
            " The first {MOST_SPECIMENS} of {most} {} are drawn.",
            nouns.units
        )
    } else {
        String::new()
    };
    let effects_cut = if effects.len() > fit {
        format!(" The first {fit} of {} effects are drawn.", effects.len())
    } else {
        String::new()
    };
    let own = match most {
        0 | 1 => String::new(),
        _ => format!(
            ", and the estimate from each {} alone (with 95% intervals; descriptive, not a test)",
            nouns.unit
        ),
    };
    format!(
        "Profile of the marginal likelihood L of each effect, everything else refitted{own}. Dashed: the estimate from all; shaded: its 95% \
         interval.{free}{cut}{effects_cut}"
    )
}
