//! Normalised force of 10, 20 and 40 mm actuators by the knee paper's Eqs. 9, 11 and 12 (its Fig. 9).

use crate::figures::Named;
use crate::figures::laws::places;
use crate::figures::readings::near;
use crate::input::ReportInput;
use crate::plot::{Axis, DOUBLE_MM, Figure, Legend, Mark, Panel, Series, Stroke, look};
use pipeline_base::row::Row;
use pipeline_fit::{Group, is_usable};
use pipeline_mechanics::models::{ForceModel, State, festo_tool::FestoTool, knee_paper::KneePaper};

/// Name of its files.
pub const NAME: &str = "knee-surfaces";
const HEIGHT_MM: f64 = 62.0;
/// Isobars, kPa.
const ISOBARS_KPA: [f64; 4] = [600.0, 400.0, 300.0, 200.0];
/// Contraction at 620 kPa of the manufacturer's larger actuators.
const EPS_MAX: f64 = 0.25;
/// A resting length at which the law of 10 mm is normalised, m: F* does not depend on it.
const REST_M: f64 = 0.3;

/// The figure.
pub fn figure(input: &ReportInput) -> Named {
    let title = "Normalised force of 10, 20 and 40 mm actuators";
    let panels = [10, 20, 40].map(|d| panel(input, d));
    let figure = Figure::new(title, DOUBLE_MM, HEIGHT_MM);
    Named {
        name: NAME.to_owned(),
        caption: "Force over its maximum against relative contraction at four pressures, by the knee paper's Eqs. 9 (10 mm), 11 (20 mm) and 12 (40 mm), each with its second and fifth coefficient in the exponent. Marks: the manufacturer's tool (20 and 40 mm), and readings of isometric sessions within 10 kPa (10 mm; simulated ones where there are no others).".to_owned(),
        figure: panels.into_iter().fold(figure, Figure::with).grid(3).shared_legend(),
    }
}

fn panel(input: &ReportInput, diameter_mm: u32) -> Panel {
    let eps_620 = if diameter_mm == 10 { 0.17 } else { EPS_MAX };
    let state =
        |relative: f64, kpa: f64| State::relative(diameter_mm, REST_M, eps_620, relative, kpa);
    let largest = match diameter_mm {
        10 => KneePaper.predict(&state(0.0, 620.0)).force_n(),
        20 => Some(1500.0),
        _ => Some(6000.0),
    };
    let largest = largest.unwrap_or(f64::NAN);
    let mut panel = Panel::new(
        Axis::new("Relative contraction ε*").fixed(0.0, 1.0),
        Axis::new("\\v{F}/F_{max}").fixed(0.0, 1.1),
    )
    .title(&format!("{diameter_mm} mm"))
    .legend(Legend::None);
    for (n, pressure) in ISOBARS_KPA.into_iter().enumerate() {
        let (ink, shape, dash) = look(n);
        let relative = |model: &dyn ForceModel, r: f64| {
            let force = model.predict(&state(r, pressure)).force_n();
            (r, force.unwrap_or(f64::NAN) / largest)
        };
        let curve = places(0.0, 1.0, 100)
            .into_iter()
            .map(|r| relative(&KneePaper, r));
        let name = format!("{pressure:.0} kPa");
        panel = panel.with(Series::line(&name, curve.collect(), Stroke::new(ink, dash)));
        let marks: Vec<(f64, f64)> = if diameter_mm == 10 {
            measured(input, pressure)
        } else {
            let at = places(0.0, 1.0, 10).into_iter();
            at.map(|r| relative(&FestoTool, r)).collect()
        };
        let mark = Mark::open(shape, ink).wide(1.1);
        panel = panel.with(Series::marks("", marks, mark));
    }
    panel
}

/// The readings of 10 mm isometric sessions near a pressure, over the maximum force of their resting length.
fn measured(input: &ReportInput, pressure_kpa: f64) -> Vec<(f64, f64)> {
    let groups = input.groups.iter().map(|g| &g.fit.group);
    let groups = groups.filter(|g| g.diameter_mm == 10 && g.members.len() == 1);
    let any_measured = groups.clone().any(|g| !g.simulated);
    let shown = groups.filter(|g| g.simulated != any_measured);
    let of = |row: &&Row, group: &Group| {
        is_usable(row) && row.campaign == group.campaign && row.diameter_mm as u32 == 10
    };
    let rows = shown.flat_map(|group| {
        let rows = near(&input.rows, pressure_kpa);
        rows.filter(move |row| of(row, group))
    });
    rows.filter_map(|row| {
        let state = State::relative(10, row.rest_length_m, 0.17, 0.0, 620.0);
        let largest = KneePaper.predict(&state).force_n()?;
        Some((row.contraction_rel, row.force_n / largest))
    })
    .collect()
}
