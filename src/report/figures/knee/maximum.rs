//! Maximum force of 10 mm actuators over resting length and pressure, and their contraction at 620 kPa (the knee paper's Fig. 8).

use crate::figures::Named;
use crate::figures::laws::places;
use crate::input::ReportInput;
use crate::plot::{
    Axis, DOUBLE_MM, Dash, Figure, Ink, Legend, Mark, Panel, Series, Shape, Stroke, look,
};
use pipeline_mechanics::models::{ForceModel, knee_paper::KneePaper, new};
use std::collections::BTreeMap;

/// Name of its files.
pub const NAME: &str = "knee-maximum-force";
const HEIGHT_MM: f64 = 62.0;
/// Isobars, kPa.
const ISOBARS_KPA: [f64; 4] = [620.0, 450.0, 300.0, 150.0];
/// Longest resting length drawn, mm.
const LONGEST_MM: f64 = 550.0;

/// The figure.
pub fn figure(input: &ReportInput) -> Named {
    let title = "Maximum force and contraction of 10 mm actuators";
    let figure = Figure::new(title, DOUBLE_MM, HEIGHT_MM)
        .with(force(input))
        .with(contraction(input))
        .grid(2);
    Named {
        name: NAME.to_owned(),
        caption: "10 mm actuators. (A) Maximum force over resting length by Eq. 6 of the knee paper at four pressures and by Eq. 7 at 620 kPa, with the measured maxima of isometric sessions where there are any. (B) Contraction at 620 kPa without load of every specimen: no law of length follows from it.".to_owned(),
        figure,
    }
}

fn force(input: &ReportInput) -> Panel {
    let list = KneePaper.coefficients(10);
    let of = |symbol: &str| {
        let found = list.iter().find(|c| c.symbol == symbol);
        found.map_or(f64::NAN, |c| c.value)
    };
    let offset = of("l_0");
    let lengths = places(1e3 * offset, LONGEST_MM, 120);
    let line = |f: &dyn Fn(f64) -> f64| lengths.iter().map(|l| (*l, f(1e-3 * l))).collect();
    let mut panel = Panel::new(
        Axis::new("l_{rest} (mm)").including(0.0),
        Axis::new("Maximum force (N)").including(0.0),
    )
    .legend(Legend::Above);
    let eq7 = line(&|l| new::f620(of("F_inf 2/pi"), of("b2"), offset, l));
    let stroke = Stroke::new(Ink::Black, Dash::Dotted);
    panel = panel.with(Series::line("paper Eq. 7, 620 kPa", eq7, stroke));
    for (n, pressure) in ISOBARS_KPA.into_iter().enumerate() {
        let (ink, _, dash) = look(n);
        let curve = line(&|l| new::fmax(of("a1"), of("a2"), offset, l, pressure));
        let name = format!("{pressure:.0} kPa");
        panel = panel.with(Series::line(&name, curve, Stroke::new(ink, dash)));
    }
    let groups = input.groups.iter();
    let groups = groups.filter(|g| g.fit.group.diameter_mm == 10 && g.fit.group.members.len() == 1);
    for (simulated, name) in [(false, "measured, 620 kPa"), (true, "simulated, 620 kPa")] {
        let of_kind = groups
            .clone()
            .filter(|g| g.fit.group.simulated == simulated);
        let maxima = of_kind.flat_map(|g| &g.fit.specimens);
        let maxima = maxima.filter_map(|s| s.maximum.as_ref());
        let points: Vec<(f64, f64)> = maxima.map(|m| (1e3 * m.rest_length_m, m.force_n)).collect();
        if !points.is_empty() {
            panel = panel.with(Series::marks(name, points, mark(simulated)));
        }
    }
    panel
}

fn mark(simulated: bool) -> Mark {
    if simulated {
        Mark::open(Shape::Diamond, Ink::Grey)
    } else {
        Mark::filled(Shape::Circle, Ink::Black)
    }
}

fn contraction(input: &ReportInput) -> Panel {
    // Specimens, each once.
    let mut specimens: BTreeMap<&str, (f64, f64, bool)> = BTreeMap::new();
    let sessions = input.sessions.iter().map(|s| &s.ingest.session);
    for session in sessions.filter(|s| s.specimen.diameter_mm == 10.0) {
        let s = &session.specimen;
        let contraction = 100.0 * (s.rest_length_m - s.contracted_length_m) / s.rest_length_m;
        let entry = (1e3 * s.rest_length_m, contraction, session.is_simulated());
        specimens.entry(&s.id).or_insert(entry);
    }
    let panel = Panel::new(
        Axis::new("l_{rest} (mm)").including(0.0),
        Axis::new("Contraction at 620 kPa ε_{620} (%)").including(0.0),
    )
    .legend(Legend::Above);
    let kinds = [(false, "measured"), (true, "simulated")];
    kinds.into_iter().fold(panel, |panel, (simulated, name)| {
        let of_kind = specimens.values().filter(|s| s.2 == simulated);
        let points: Vec<(f64, f64)> = of_kind.map(|s| (s.0, s.1)).collect();
        if points.is_empty() {
            panel
        } else {
            panel.with(Series::marks(name, points, mark(simulated)))
        }
    })
}
