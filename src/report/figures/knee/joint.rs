//! One joint before and after the loop: measured torque, the rigid leg, the leg with what was found, one panel a configuration.

use super::{angle_axis, configuration, over_angle};
use crate::figures::formatting::{largest, listed};
use crate::figures::{Named, part_in_names};
use crate::plot::{
    Axis, DOUBLE_MM, Dash, Figure, Ink, Layer, Mark, Panel, SINGLE_MM, Series, Stroke,
};
use pipeline_base::names::file_name;
use pipeline_torque::diagnose::JointDiagnosis;
use pipeline_torque::diagnose::curves::BeforeAfter;
use pipeline_torque::{CampaignTorque, Configuration};
use std::collections::BTreeSet;

const ROW_MM: f64 = 46.0;
const LEGEND_MM: f64 = 12.0;

/// Panels beyond these are left out, so that the figure fits on a page with its caption.
const MOST_PANELS: usize = 8;

/// The name of a joint's figure.
pub fn name(campaign: &CampaignTorque, joint: &JointDiagnosis) -> String {
    let found = &joint.findings;
    let part = part_in_names(found);
    file_name(&format!(
        "knee-loop-{}-{part}-{}",
        campaign.campaign, found.diameter_mm
    ))
}

/// The configurations of a joint with most readings, and how many there are.
fn shown<'a>(
    campaign: &'a CampaignTorque,
    joint: &JointDiagnosis,
) -> (Vec<&'a Configuration>, usize) {
    let of_joint = |c: &&Configuration| joint.curves.iter().any(|b| b.configuration == c.id);
    let all: Vec<&Configuration> = campaign.configurations.iter().filter(of_joint).collect();
    let readings = |c: &Configuration| c.tests.iter().map(|t| t.points.len()).sum::<usize>();
    let readings: Vec<f64> = all.iter().map(|c| readings(c) as f64).collect();
    let most = largest(&readings, MOST_PANELS);
    (most.into_iter().map(|k| all[k]).collect(), all.len())
}

/// The figure; none where so few readings are usable that the joint has no curve.
pub fn figure(campaign: &CampaignTorque, joint: &JointDiagnosis) -> Option<Named> {
    let found = &joint.findings;
    let part = found.part.as_deref().unwrap_or_default();
    let title = format!(
        "Torque before and after the loop: {part}, {} mm",
        found.diameter_mm
    );
    let (shown, all) = shown(campaign, joint);
    if shown.is_empty() {
        return None;
    }
    let others = if shown.len() < all {
        format!(
            " Shown are the {} of {all} configurations with the most readings.",
            shown.len()
        )
    } else {
        String::new()
    };
    let held_out = if joint.curves.iter().any(|b| !b.held_out.is_empty()) {
        ", also with the effects found without the actuator"
    } else {
        ""
    };
    let columns = match shown.len() {
        1 => 1,
        2..=4 => 2,
        5 | 6 => 3,
        _ => 4,
    };
    let rows = shown.len().div_ceil(columns);
    let height = ROW_MM * rows as f64 + LEGEND_MM;
    let panels = shown.iter().map(|c| panel(joint, c));
    // A single panel stands beside the text.
    let width = if columns == 1 { SINGLE_MM } else { DOUBLE_MM };
    let empty = Figure::new(&title, width, height);
    let figure = panels.fold(empty, Figure::with);
    let mut figure = figure.grid(columns).shared_legend();
    figure.lettered = shown.len() > 1;
    let simulated = if campaign.simulated {
        "Simulated. "
    } else {
        ""
    };
    let crosses = if found.design.doubtful_only {
        "crosses are doubtful, and as there are no others they are fitted here"
    } else {
        "crosses are not fitted"
    };
    Some(Named {
        name: name(campaign, joint),
        caption: format!(
            "{simulated}{}, {} mm: measured torque (marks, one type per test; {crosses}), the rigid leg with the published \
             law, and the leg with the effects found{held_out}. {}{others}",
            configuration::capitalised(part),
            found.diameter_mm,
            pressures(joint)
        ),
        figure,
    })
}

/// At which gauge pressures the curves are.
fn pressures(joint: &JointDiagnosis) -> String {
    let all = joint.curves.iter().map(|b| b.pressure_kpa.round() as i64);
    let all: BTreeSet<i64> = all.collect();
    let per_configuration = joint.curves.iter().map(|b| {
        let same = |o: &&BeforeAfter| o.configuration == b.configuration;
        joint.curves.iter().filter(same).count()
    });
    let words: Vec<String> = all.iter().map(i64::to_string).collect();
    match (&words[..], per_configuration.max()) {
        ([], _) => String::new(),
        ([only], _) => format!("Curves: {only} kPa gauge."),
        ([low, .., high], None | Some(0 | 1)) => {
            format!("Curves: at the pressure of the tests, {low} to {high} kPa gauge.")
        }
        (several, _) => format!(
            "Where there are several gauge pressures ({} kPa), each has a colour: the rigid leg dashed, with the effects found solid, found without the \
             actuator dotted.",
            listed(several)
        ),
    }
}

/// Colours of pressures.
const OF_PRESSURES: [Ink; 6] = [
    Ink::Sky,
    Ink::Vermilion,
    Ink::Green,
    Ink::Purple,
    Ink::Orange,
    Ink::Blue,
];

fn of_pressure(k: usize) -> Ink {
    OF_PRESSURES[k % OF_PRESSURES.len()]
}

fn panel(joint: &JointDiagnosis, c: &Configuration) -> Panel {
    let of = |b: &&BeforeAfter| b.configuration == c.id;
    let curves: Vec<&BeforeAfter> = joint.curves.iter().filter(of).collect();
    let measured = c.tests.iter().flat_map(|t| &t.points).map(|p| p.torque_nm);
    let shown = measured.chain(
        curves
            .iter()
            .flat_map(|b| b.after.iter().flatten().copied()),
    );
    let (low, high) = shown.fold((0.0, 0.0), |(low, high): (f64, f64), x| {
        (low.min(x), high.max(x))
    });
    // The rigid leg may be off by as much again; beyond that it is cut off.
    let margin = 0.3 * (high - low);
    let y = Axis::new("Torque (N m)").fixed(
        if low < 0.0 {
            low - margin
        } else {
            -0.1 * margin
        },
        if high > 0.0 {
            high + margin
        } else {
            0.1 * margin
        },
    );
    let title = format!("{:.0} mm{}", 1e3 * c.rest_length_m, tendon(c));
    let panel = Panel::new(angle_axis(), y)
        .title(&title)
        .with(Layer::zero());
    with_marks(with_curves(panel, &curves), &curves, c)
}

/// The curves of one configuration: one colour a model, or where there are several pressures one a pressure.
fn with_curves(mut panel: Panel, curves: &[&BeforeAfter]) -> Panel {
    for (k, b) in curves.iter().enumerate() {
        for (name, short, torques, ink, dash) in [
            (
                "rigid leg, published law",
                "rigid",
                &b.rigid,
                Ink::Black,
                Dash::Dashed,
            ),
            (
                "with the effects found",
                "effects",
                &b.after,
                Ink::Sky,
                Dash::Solid,
            ),
            (
                "found without the actuator",
                "unseen",
                &b.held_out,
                Ink::Vermilion,
                Dash::Dotted,
            ),
        ] {
            let values = torques.iter().map(|t| t.unwrap_or(f64::NAN));
            let line = over_angle(&b.angles_rad, values);
            let (name, ink) = if curves.len() > 1 {
                let name = format!("{short}, {} kPa", b.pressure_kpa.round());
                (name, of_pressure(k))
            } else {
                (name.to_owned(), ink)
            };
            if !torques.is_empty() {
                panel = panel.with(Series::line(&name, line, Stroke::new(ink, dash)));
            }
        }
    }
    panel
}

/// The readings of one configuration, test by test; where there are several pressures in the colour of the nearest.
fn with_marks(mut panel: Panel, curves: &[&BeforeAfter], c: &Configuration) -> Panel {
    let nearest = |kpa: f64| {
        let far = |b: &BeforeAfter| (b.pressure_kpa - kpa).abs();
        let all = curves.iter().enumerate();
        let nearest = all.min_by(|a, b| far(a.1).total_cmp(&far(b.1)));
        nearest.map_or(0, |(k, _)| k)
    };
    for (k, test) in c.tests.iter().enumerate() {
        let mark = configuration::mark(k, test);
        for pressure in 0..curves.len().max(1) {
            let points = test.points.iter();
            let points = points.filter(|p| nearest(p.pressure_kpa) == pressure);
            let points = points.map(|p| (p.angle_rad.to_degrees(), p.torque_nm));
            let ink = if curves.len() > 1 {
                of_pressure(pressure)
            } else {
                mark.ink
            };
            panel = panel.with(Series::marks("", points.collect(), Mark { ink, ..mark }));
        }
    }
    panel
}

fn tendon(c: &Configuration) -> String {
    match c.tendon_m {
        Some(tendon) if tendon > 0.0 => format!(", tendon {:.0} mm", 1e3 * tendon),
        _ => String::new(),
    }
}
