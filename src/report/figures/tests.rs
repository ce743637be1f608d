//! What holds for the figures of every group: they draw, they are fit for print, they repeat themselves, and their captions are true.

use super::*;
use crate::plot::units::pt;
use crate::wording::tests::example;
use pipeline_base::row::Row;
use pipeline_base::session::Phase;
use pipeline_compare::compare;
use pipeline_diagnose::Diagnosis;
use pipeline_findings::{CampaignFindings, Residuals};
use pipeline_fit::engine::CoefficientState;
use pipeline_fit::{Group, fit_group};
use pipeline_mechanics::models::new;
use std::collections::BTreeMap;

/// Groups as they come: campaigns of one, two and five specimens, at one pressure only, and of a diameter without a law of length.
pub(crate) fn groups() -> Vec<GroupInput> {
    let all = [80.0, 100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 618.0, 622.0];
    let one = [617.0, 620.0, 622.0];
    let five = [0.083, 0.182, 0.233, 0.382, 0.455];
    vec![
        group("five", 10, &five, &all),
        group("long", 10, &[0.415, 0.455, 0.49, 0.518], &one),
        group("two", 20, &[0.228, 0.397], &all),
        group("map_1*", 20, &[0.3], &[100.0, 350.0, 600.0]),
        group("large", 40, &[0.3, 0.5, 0.6], &all),
    ]
}

fn group(campaign: &str, diameter_mm: u32, lengths_m: &[f64], pressures: &[f64]) -> GroupInput {
    let mut rows = Vec::new();
    for (s, length) in lengths_m.iter().enumerate() {
        for quarter in 0..4 {
            for (k, pressure) in pressures.iter().enumerate() {
                let place = (s, quarter, k);
                rows.push(row(campaign, diameter_mm, *length, *pressure, place));
            }
        }
    }
    let group = Group {
        campaign: campaign.to_owned(),
        diameter_mm,
        members: vec![campaign.to_owned()],
        simulated: campaign == "five",
    };
    let config = Config::default();
    let fit = fit_group(&group, &rows, &config.fit);
    let (comparison, predictions) = compare(&fit, &rows, &config.compare, &config.fit);
    GroupInput {
        fit,
        comparison,
        predictions,
        diagnosis: None,
    }
}

/// A reading of an actuator that follows the force paper but for its own gain and a little scatter.
fn row(
    campaign: &str,
    diameter_mm: u32,
    length: f64,
    pressure: f64,
    (s, quarter, k): (usize, usize, usize),
) -> Row {
    let (contraction_620, relative) = (0.16 + 0.004 * s as f64, 0.25 * quarter as f64);
    let gain = 1.0 + 0.03 * [0.0, 1.0, -1.0, 0.5, -0.4][s];
    let scatter = 3.0 * (((7 * s + 5 * quarter + 3 * k) % 11) as f64 / 5.0 - 1.0);
    let f620 = f64::from(3 * diameter_mm * diameter_mm) * libm::atan(19.0 * (length - 0.0075));
    let force = new::force([0.57, 4.25, 0.56], f620, relative, pressure / 620.0);
    Row {
        session: format!("{campaign}-{s}-{quarter}"),
        campaign: campaign.to_owned(),
        specimen: format!("l{:.0}", 1e3 * length),
        phase: [Some(Phase::Pressurizing), Some(Phase::Depressurizing)][k % 2],
        diameter_mm: f64::from(diameter_mm),
        rest_length_m: length,
        contracted_length_m: length * (1.0 - contraction_620),
        length_m: length * (1.0 - relative * contraction_620),
        contraction: relative * contraction_620,
        contraction_rel: relative,
        pressure_kpa: pressure,
        pressure_rel: pressure / 620.0,
        time_s: k as f64,
        force_n: gain * force + scatter,
        extras: BTreeMap::from([("humidity_#1".to_owned(), (k + 3 * s) as f64)]),
        ..Row::blank()
    }
}

/// The figures of a group, all of which can be composed.
pub(super) fn composed(group: &GroupInput) -> Vec<Named> {
    let all = of_group(group, &Config::default());
    all.into_iter()
        .collect::<std::result::Result<_, _>>()
        .unwrap()
}

/// The same of its diagnosis.
pub(super) fn composed_of_diagnosis(group: &GroupInput) -> Vec<Named> {
    let all = of_diagnosis(group).into_iter();
    all.map(|(_, composed)| composed.unwrap()).collect()
}

fn figures_of(campaign: &str) -> BTreeMap<String, Named> {
    let groups = groups();
    let group = groups.iter().find(|g| g.fit.group.campaign == campaign);
    let named = composed(group.unwrap());
    let slug = slug(group.unwrap());
    let kind = |n: &Named| n.name.trim_end_matches(&format!("-{slug}")).to_owned();
    named.into_iter().map(|n| (kind(&n), n)).collect()
}

#[test]
fn every_figure_of_every_group_is_fit_for_print_and_repeats_itself() {
    for group in groups() {
        for named in composed(&group) {
            let svg = named.draw().unwrap().svg;
            assert!(
                !svg.contains("NaN") && !svg.contains("inf"),
                "{}",
                named.name
            );
            assert!(svg.len() < 400_000, "{}: {} bytes", named.name, svg.len());
            assert!(smallest(&svg, "data-pt") >= 5.0, "{}", named.name);
            assert!(smallest(&svg, "stroke-width") >= pt(0.5), "{}", named.name);
            assert!(named.figure.width_mm <= crate::plot::DOUBLE_MM);
            assert_eq!(svg, named.draw().unwrap().svg);
        }
    }
}

fn smallest(svg: &str, attribute: &str) -> f64 {
    let attribute = format!("{attribute}=\"");
    let parts = svg.split(&attribute).skip(1);
    let numbers = parts.map(|p| p.split('"').next().unwrap().parse::<f64>().unwrap());
    numbers.reduce(f64::min).unwrap()
}

#[test]
fn captions_are_markup_that_compiles() {
    for group in groups() {
        for named in composed(&group) {
            let source = format!("#set page(width: 200mm)\n{}", named.caption);
            let pdf = crate::typeset::Document::new(&source).compile();
            assert!(pdf.is_ok(), "{}: {}", named.name, named.caption);
        }
    }
}

#[test]
fn figures_without_data_are_not_made() {
    let kinds = |campaign| figures_of(campaign).into_keys().collect::<Vec<_>>();
    let single = kinds("map_1*");
    for kind in ["curves", "isobars", "models", "predicted", "residuals"] {
        assert!(single.iter().any(|k| k == kind), "{kind}: {single:?}");
    }
    // Of one specimen there is no law of lengths, and none is left out.
    for kind in ["f620", "rest", "specimen-errors"] {
        assert!(!single.iter().any(|k| k == kind), "{kind}: {single:?}");
    }
    assert_eq!(kinds("five").len(), OF_GROUP.len());
}

#[test]
fn captions_say_what_is_there() {
    let five = figures_of("five");
    assert!(five.values().all(|n| n.caption.starts_with("Simulated. ")));
    assert!(five["f620"].caption.contains("95% band"));
    assert!(
        five["curves"]
            .caption
            .contains("a short, a middle and a long")
    );
    assert!(
        five["residuals"]
            .caption
            .contains("the fit without the specimen")
    );
    assert!(five["residuals"].caption.contains("#\"humidity_#1\""));
    let two = figures_of("two");
    assert!(!two["f620"].caption.contains("95%"));
    assert!(
        two["f620"]
            .caption
            .contains("With two specimens there is no band")
    );
    assert!(two["rest"].caption.contains("Too few specimens"));
    let single = figures_of("map_1*");
    assert!(
        single["models"]
            .caption
            .contains("no specimen could be left out")
    );
    assert!(single["residuals"].caption.contains("of the fit itself"));
    assert!(single["curves"].caption.contains("of the specimen:"));
    assert!(single["curves"].figure.panels.len() == 2);
}

#[test]
fn a_law_at_a_bound_is_named_and_not_drawn() {
    let mut group = groups().remove(0);
    let drawn = |group: &GroupInput| {
        let (caption, figure) = maximum_force::figure(group, &Config::default()).unwrap();
        (
            caption,
            figure
                .to_svg()
                .unwrap()
                .contains("aria-label=\"fitted to the maxima\""),
        )
    };
    assert!(drawn(&group).1);
    let law = group
        .fit
        .equations
        .iter_mut()
        .find(|e| e.id == "F_620(l_rest)");
    law.unwrap().coefficients[1].state = CoefficientState::AtUpperBound;
    let (caption, is_drawn) = drawn(&group);
    assert!(!is_drawn);
    assert!(
        caption.contains("_b_#sub[2] is at its upper bound"),
        "{caption}"
    );
}

#[test]
fn rows_that_are_held_out_stay_out_of_the_residuals() {
    let mut group = groups().remove(0);
    let count = |group: &GroupInput| {
        let (caption, _) = residuals::figure(group, &Config::default()).unwrap();
        let words: Vec<&str> = caption.split_whitespace().collect();
        words[2].parse::<usize>().unwrap()
    };
    let all = count(&group);
    assert_eq!(all, group.predictions.rows.len());
    group.predictions.rows[0].role = Some(pipeline_base::session::Role::Holdout);
    assert_eq!(count(&group), all - 1);
}

#[test]
fn figures_of_a_diagnosis_are_fit_for_print() {
    let mut group = groups().remove(0);
    assert!(of_diagnosis(&group).is_empty(), "not diagnosed");
    let readings = group.predictions.rows.len();
    let wave = |k: usize| libm::sin(k as f64);
    group.diagnosis = Some(Diagnosis {
        findings: CampaignFindings {
            simulated: true,
            ..example()
        },
        residuals: Residuals {
            session: vec!["s".to_owned(); readings],
            specimen: (0..readings)
                .map(|k| format!("specimen-{}", k % 4))
                .collect(),
            before: (0..readings).map(|k| 4.0 * wave(k)).collect(),
            after: (0..readings).map(|k| 2.0 * wave(k)).collect(),
            conditional: (0..readings).map(wave).collect(),
            predicted: (0..readings).map(|k| k as f64).collect(),
            columns: ["humidity", "pressure_kpa", "session"]
                .map(|name| {
                    (
                        name.to_owned(),
                        (0..readings).map(|k| (k % 7) as f64).collect(),
                    )
                })
                .to_vec(),
            ..Residuals::default()
        },
        mixed_law: None,
    });
    let figures = composed_of_diagnosis(&group);
    let names: Vec<&str> = figures.iter().map(|n| n.name.as_str()).collect();
    let stems = [
        "residual-tested",
        "effects",
        "scatter",
        "held-out",
        "calibration",
        "unexplained",
    ];
    assert_eq!(names, stems.map(|stem| format!("{stem}-five-10mm")));
    for named in &figures {
        let svg = named.draw().unwrap().svg;
        assert!(
            !svg.contains("NaN") && !svg.contains("inf"),
            "{}",
            named.name
        );
        assert!(svg.len() < 400_000, "{}: {} bytes", named.name, svg.len());
        assert!(
            named.figure.width_mm <= 175.0,
            "{} hangs over the margins",
            named.name
        );
        assert!(named.caption.starts_with("Simulated. "));
        let source = format!("#set page(width: 200mm)\n{}", named.caption);
        let pdf = crate::typeset::Document::new(&source).compile();
        assert!(pdf.is_ok(), "{}", named.caption);
    }
}

#[test]
fn a_pool_of_many_specimens_and_sessions_has_its_figures() {
    let mut many = example();
    for scatter in &mut many.scatter {
        scatter.values = (0..1000)
            .map(|k| (format!("s{k}"), libm::sin(f64::from(k))))
            .collect();
    }
    let unit = many.by_unit[0].clone();
    many.by_unit = vec![unit; 1000];
    let estimate = many.effects[0]
        .by_specimen
        .values()
        .next()
        .copied()
        .unwrap();
    many.effects[0].by_specimen = (0..1000).map(|k| (format!("l{k}"), estimate)).collect();
    let shown = found::Shown {
        found: &many,
        residuals: &Residuals::default(),
        rows: &[],
        slug: "many".to_owned(),
    };
    let figures = found::figures(&shown);
    assert!(figures.len() >= 4);
    for (_, composed) in figures {
        let named = composed.unwrap();
        assert!(named.draw().is_ok(), "{}", named.name);
        assert!(
            named.figure.height_mm <= 205.0,
            "{} fits on no page",
            named.name
        );
    }
}

#[test]
fn a_budget_of_many_campaigns_is_one_figure() {
    let (one, mut other) = (example(), example());
    other.budget[0].source = "mounting".into();
    let named = found::budget(&[&one, &other, &one]).unwrap();
    assert!(named.draw().is_ok());
    other.budget.clear();
    assert!(found::budget(&[&other]).is_none());
}
