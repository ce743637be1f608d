//! One configuration: torque, relative contraction and moment arm over the knee angle, measured and expected (the knee paper's Figs. 10 to 13).

use super::{angle_axis, over_angle};
use crate::figures::Named;
use crate::figures::formatting::plain;
use crate::plot::{Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Mark, Panel, Series, Shape, Stroke};
use pipeline_base::names::file_name;
use pipeline_torque::diagnose::fittings::LAWS;
use pipeline_torque::point::Point;
use pipeline_torque::{CampaignTorque, Configuration, Test};

const HEIGHT_MM: f64 = 100.0;
/// Dashes of the pressures, where there are several: as stated, and as fitted.
const BY_PRESSURE: [(Dash, Dash); 3] = [
    (Dash::Dashed, Dash::Solid),
    (Dash::DashDot, Dash::Long),
    (Dash::Dotted, Dash::Short),
];
/// Marks of the tests, in their order, filled and then open; those that are left out are grey crosses, those beyond are grey dots.
const TESTS: [(Shape, Ink); 6] = [
    (Shape::Circle, Ink::Blue),
    (Shape::Square, Ink::Vermilion),
    (Shape::Triangle, Ink::Green),
    (Shape::Diamond, Ink::Purple),
    (Shape::Wedge, Ink::Orange),
    (Shape::Plus, Ink::Black),
];
/// So many tests have a mark of their own: the last one is a cross of lines, which is neither filled nor open.
const MOST_TESTS: usize = 2 * TESTS.len() - 1;

/// The name of a configuration's figure.
pub fn name(campaign: &CampaignTorque, c: &Configuration) -> String {
    format!("knee-{}-{}", file_name(&campaign.campaign), c.id)
}

/// The figure.
pub fn figure(campaign: &CampaignTorque, c: &Configuration) -> Named {
    let plot = Plot { campaign, c };
    let title = format!("Torque: {}", c.title());
    let figure = Figure::new(&title, DOUBLE_MM, HEIGHT_MM)
        .with(plot.torque())
        .with(plot.differences())
        .with(plot.contraction())
        .with(plot.arm())
        .grid(2)
        .shared_legend();
    Named {
        name: name(campaign, c),
        caption: plot.caption(),
        figure,
    }
}

struct Plot<'a> {
    campaign: &'a CampaignTorque,
    c: &'a Configuration,
}

impl Plot<'_> {
    /// Where a model stands in the lists by model.
    fn place(&self, law: &str) -> Option<usize> {
        self.campaign.models.iter().position(|m| m == law)
    }

    fn points(&self) -> impl Iterator<Item = &Point> {
        self.c.tests.iter().flat_map(|t| &t.points)
    }

    /// A quantity of every test's points over the angle, one series a test.
    fn marks(&self, of: impl Fn(&Point) -> Option<f64>) -> Vec<Series> {
        let series = |(k, test): (usize, &Test)| {
            let points: Vec<(f64, f64)> = test
                .points
                .iter()
                .filter_map(|p| Some((p.angle_rad.to_degrees(), of(p)?)))
                .collect();
            let name = match (&test.excluded, &test.doubtful) {
                (Some(_), _) => format!("{} (excluded)", plain(&test.session)),
                (None, Some(_)) => format!("{} (doubtful)", plain(&test.session)),
                (None, None) if k >= MOST_TESTS => "further tests".to_owned(),
                (None, None) => plain(&test.session),
            };
            (!points.is_empty()).then(|| Series::marks(&name, points, mark(k, test)))
        };
        self.c.tests.iter().enumerate().filter_map(series).collect()
    }

    /// From length and arm measured by hand, with the first law.
    fn back_calculated(&self, of: impl Fn(&Point, f64) -> f64) -> Option<Series> {
        let k = self.place(LAWS[0])?;
        let point = |p: &Point| {
            let torque = p.back_calculated[k]?;
            Some((p.angle_rad.to_degrees(), of(p, torque)))
        };
        let points: Vec<(f64, f64)> = self.points().filter_map(point).collect();
        let mark = Mark::open(Shape::Circle, Ink::Grey).wide(1.0);
        (!points.is_empty()).then(|| Series::marks("from length and arm by hand", points, mark))
    }

    fn range(&self) -> (f64, f64) {
        let angles = &self.c.curve.angles_rad;
        let ends = angles.first().zip(angles.last());
        ends.map_or((-120.0, 10.0), |(a, b)| (a.to_degrees(), b.to_degrees()))
    }

    fn x(&self) -> Axis {
        let (low, high) = self.range();
        angle_axis().fixed(low - 2.0, high + 2.0)
    }

    /// The torque axis: what was measured and what is expected there; curves beyond are cut off.
    fn y(&self) -> Axis {
        let laws: Vec<usize> = LAWS.iter().filter_map(|l| self.place(l)).collect();
        let shown = self.points().flat_map(|p| {
            let expected = laws.iter().filter_map(|k| p.predicted[*k].torque_nm);
            expected.chain([p.torque_nm])
        });
        let (low, high) = shown.fold((0.0, 0.0), |(low, high): (f64, f64), x| {
            (low.min(x), high.max(x))
        });
        let margin = 0.06 * (high - low);
        Axis::new("Torque (N m)").fixed(low - margin, high + margin)
    }

    fn torque(&self) -> Panel {
        let mut panel = Panel::new(self.x(), self.y()).title("Torque");
        let curve = &self.c.curve;
        let several = curve.torques.len() > 1;
        let line = |values: &[Option<f64>]| {
            let all = values.iter().map(|t| t.unwrap_or(f64::NAN));
            over_angle(&curve.angles_rad, all)
        };
        for (at, (stated, fitted)) in curve.torques.iter().zip(BY_PRESSURE.iter().cycle()) {
            let name = |law: &str, fitting_m: f64| {
                let name = format!("{}, l_{{fit}} {}", text(law), mm(fitting_m));
                if several {
                    format!("{name}, {:.0} kPa", at.pressure_kpa)
                } else {
                    name
                }
            };
            let mut draw = |law: &str, fitting_m, values: Option<&Vec<_>>, ink, dash| {
                let lines = values.map(|v| line(v));
                let stroke = Stroke::new(ink, dash);
                let series = lines.map(|l| Series::line(&name(law, fitting_m), l, stroke));
                panel = series.into_iter().fold(panel.clone(), Panel::with);
            };
            let (first, own) = (LAWS[0], self.c.fitting_m);
            draw(first, own, at.stated.first(), Ink::Black, *stated);
            if !several {
                let dash = Dash::LongShort;
                draw(LAWS[1], own, at.stated.get(1), Ink::Grey, dash);
            }
            if let Some(length) = curve.fitted_m.first() {
                draw(first, *length, at.fitted.first(), Ink::Sky, *fitted);
            }
        }
        let back = self.back_calculated(|_, torque| torque);
        let all = back.into_iter().chain(self.marks(|p| Some(p.torque_nm)));
        all.fold(panel.with(Layer::zero()), Panel::with)
    }

    fn differences(&self) -> Panel {
        let axis = Axis::new("Error (N m)");
        let mut panel = Panel::new(self.x(), axis)
            .title(&format!("Measured minus predicted, {}", text(LAWS[0])))
            .with(Layer::zero());
        let back = self.back_calculated(|p, torque| p.torque_nm - torque);
        panel = back.into_iter().fold(panel, Panel::with);
        let Some(k) = self.place(LAWS[0]) else {
            return panel;
        };
        let error = |p: &Point| Some(p.torque_nm - p.predicted[k].torque_nm?);
        self.marks(error).into_iter().fold(panel, Panel::with)
    }

    fn contraction(&self) -> Panel {
        let curve = &self.c.curve;
        let axis = Axis::new("Relative contraction ε*");
        let mut panel = Panel::new(self.x(), axis).title("Relative contraction");
        let stated = curve.expected.iter().map(|e| e.contraction_rel);
        let line = over_angle(&curve.angles_rad, stated);
        let stroke = Stroke::new(Ink::Black, Dash::Dashed);
        panel = panel.with(Series::line("", line, stroke));
        if !curve.fitted_contraction_rel.is_empty() {
            let fitted = curve.fitted_contraction_rel.iter().copied();
            let line = over_angle(&curve.angles_rad, fitted);
            let stroke = Stroke::new(Ink::Sky, Dash::Solid);
            panel = panel.with(Series::line("", line, stroke));
        }
        let hand = self.marks(|p| p.by_hand.contraction_rel);
        hand.into_iter().fold(panel, Panel::with)
    }

    fn arm(&self) -> Panel {
        let curve = &self.c.curve;
        let expected = &curve.expected;
        let axis = Axis::new("Moment arm \\v{r} (mm)");
        let mut panel = Panel::new(self.x(), axis).title("Moment arm");
        let slope = over_angle(&curve.angles_rad, expected.iter().map(|e| 1e3 * e.arm_m));
        let projected = expected.iter().map(|e| 1e3 * e.projected_arm_m);
        let projected = over_angle(&curve.angles_rad, projected);
        let solid = Stroke::new(Ink::Black, Dash::Solid);
        let dotted = Stroke::new(Ink::Orange, Dash::Dotted);
        panel = panel
            .with(Series::line("arm, virtual work", slope, solid))
            .with(Series::line("arm, projection", projected, dotted));
        let hand = self.marks(|p| p.by_hand.arm_m.map(|r| 1e3 * r));
        hand.into_iter().fold(panel, Panel::with)
    }

    /// Which figure of the knee paper shows such an actuator on that knee.
    fn paper_figure(&self) -> Option<&'static str> {
        let length_mm = (1e3 * self.c.rest_length_m).round() as i64;
        match (
            &self.c.knee[..],
            &self.c.muscle[..],
            self.c.diameter_mm,
            length_mm,
        ) {
            _ if self.campaign.simulated => None,
            ("pinned", "flexor", 10, 485) => Some("10 (A to C)"),
            ("pinned", "flexor", 10, 457) => Some("10 (D)"),
            ("pinned", "extensor", 10, 480 | 485 | 457 | 455 | 415) => Some("11"),
            ("biomimetic", "flexor", 10, 415) => Some("12"),
            ("biomimetic", "extensor", 10, 518) => Some("13"),
            _ => None,
        }
    }

    fn caption(&self) -> String {
        let mut caption = capitalised(&self.c.title()) + ".";
        if let Some(figure) = self.paper_figure() {
            caption += &format!(" The knee paper's Fig. {figure}.");
        }
        for remark in &self.c.remarks {
            caption += &format!(" {}.", capitalised(remark));
        }
        if self.campaign.simulated {
            format!("Simulated. {caption}")
        } else {
            caption
        }
    }
}

/// The mark of a test.
pub(super) fn mark(k: usize, test: &Test) -> Mark {
    let (shape, ink) = TESTS[k % TESTS.len()];
    let mark = match (test.is_left_out(), shape) {
        (true, _) => Mark::open(Shape::Cross, Ink::Grey),
        _ if k >= MOST_TESTS => Mark::filled(Shape::Circle, Ink::Grey),
        (false, Shape::Plus) => Mark::open(shape, ink),
        _ if k >= TESTS.len() => Mark::open(shape, ink),
        _ => Mark::filled(shape, ink),
    };
    mark.wide(1.3)
}

fn text(law: &str) -> &'static str {
    match law {
        "knee_paper" => "knee paper",
        _ => "force paper",
    }
}

fn mm(length_m: f64) -> String {
    format!("{:.1} mm", 1e3 * length_m)
}

pub(super) fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}
