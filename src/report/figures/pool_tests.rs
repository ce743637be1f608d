//! Pools of many specimens: every figure is drawn, fits on a page, tells what it leaves out; and a figure that fails takes no other with it.

use super::tests::{composed, composed_of_diagnosis, groups};
use super::*;
use crate::plot::{Axis, DOUBLE_MM, Panel, SINGLE_MM};
use pipeline_config::{FigureWidths, ReportOptions};
use pipeline_diagnose::diagnose;
use pipeline_findings::{Errors, UnitErrors};

const SIZES: [usize; 3] = [5, 120, 1000];
/// What a page of the report holds above a caption, mm.
const PAGE_MM: f64 = 205.0;
/// Readings of one specimen in a pool, of the 36 of a group.
const EVERY: usize = 4;

/// The fitted group of five specimens with its diagnosis, from which pools are made: to fit a thousand takes longer than a test may.
fn five() -> GroupInput {
    let config = Config::default();
    let mut group = groups().swap_remove(0);
    let of = group.fit.group.clone();
    group.diagnosis = diagnose(&of, &group.predictions.rows, &config.fit, &config.diagnose);
    group
}

fn at_dpi(png_dpi: f64) -> ReportOptions {
    ReportOptions {
        png_dpi,
        ..ReportOptions::default()
    }
}

/// The id of a specimen of a pool, and its resting length, m: one for all, or all different.
fn specimen(k: usize, count: usize, equal: bool) -> (String, f64) {
    let length = if equal {
        0.2
    } else {
        0.1 + 0.4 * k as f64 / count as f64
    };
    (format!("pooled_{k:04}"), length)
}

/// A pool of so many specimens, each a copy of one of five with another id, length and gain.
fn pool(five: &GroupInput, count: usize, equal: bool) -> GroupInput {
    let mut group = five.clone();
    group.fit.specimens.clear();
    group.comparison.by_specimen.clear();
    group.predictions.rows.clear();
    group.predictions.by_model.values_mut().for_each(Vec::clear);
    for k in 0..count {
        let (id, length) = specimen(k, count, equal);
        let original = &five.fit.specimens[k % five.fit.specimens.len()];
        let mut summary = original.clone();
        (summary.id, summary.rest_length_m) = (id.clone(), length);
        group.fit.specimens.push(summary);
        let copied = five.comparison.by_specimen.iter();
        for of_model in copied.filter(|s| s.specimen == original.id) {
            let mut copy = of_model.clone();
            (copy.specimen, copy.rest_length_m) = (id.clone(), length);
            copy.comparison.rmse = copy.comparison.rmse.map(|r| r + (k % 7) as f64);
            group.comparison.by_specimen.push(copy);
        }
        add_readings(
            &mut group,
            five,
            &original.id,
            (&id, length, (k % 7) as f64),
        );
    }
    if let Some(diagnosis) = &mut group.diagnosis {
        let errors = |rmse: f64| Errors {
            rmse_heldout: Some(rmse),
            ..Errors::default()
        };
        let unit = |k: usize| UnitErrors {
            unit: specimen(k, count, equal).0,
            readings: 9,
            before: errors(3.0 + (k % 11) as f64),
            after: errors(2.0),
            realised_over_expected: Some(1.0),
            inside_95: Some(0.95),
            found: Vec::new(),
        };
        diagnosis.findings.by_unit = (0..count).map(unit).collect();
        let specimens = diagnosis.residuals.specimen.iter_mut().enumerate();
        specimens.for_each(|(k, s)| *s = specimen(k % count, count, equal).0);
        let halves = diagnosis.residuals.before.iter().map(|r| 0.5 * r);
        diagnosis.residuals.after = halves.collect();
    }
    group
}

fn add_readings(
    group: &mut GroupInput,
    five: &GroupInput,
    original: &str,
    (id, length, stronger_n): (&str, f64, f64),
) {
    let rows = five.predictions.rows.iter().enumerate();
    let of_original = rows.filter(|(_, r)| r.specimen == original);
    for (at, row) in of_original.step_by(EVERY) {
        let mut row = row.clone();
        row.specimen = id.to_owned();
        row.session = format!("{}-{id}", row.session);
        row.rest_length_m = length;
        row.force_n += stronger_n;
        group.predictions.rows.push(row);
        for (model, forces) in &mut group.predictions.by_model {
            forces.push(five.predictions.by_model[model][at]);
        }
    }
}

fn pools() -> Vec<(usize, bool, GroupInput)> {
    let five = five();
    let kinds = SIZES.into_iter().flat_map(|n| [(n, false), (n, true)]);
    kinds
        .map(|(n, equal)| (n, equal, pool(&five, n, equal)))
        .collect()
}

fn named<'a>(figures: &'a [Named], kind: &str) -> &'a Named {
    figures.iter().find(|n| n.name.starts_with(kind)).unwrap()
}

#[test]
fn figures_of_five_and_of_a_thousand_specimens_fit_on_a_page() {
    let names = |figures: &[Named]| -> Vec<String> {
        figures.iter().map(|figure| figure.name.clone()).collect()
    };
    let all = names(&composed(&pool(&five(), SIZES[0], false)));
    assert!(all.len() >= 8, "{all:?}");
    for (count, equal, group) in pools() {
        let mut figures = composed(&group);
        assert_eq!(names(&figures), all, "{count}, {equal}");
        let of_diagnosis = composed_of_diagnosis(&group);
        assert!(of_diagnosis.len() >= 3, "{count}, {equal}");
        figures.extend(of_diagnosis);
        figures.par_iter().for_each(|figure| {
            let which = format!("{} of {count}, equal {equal}", figure.name);
            let svg = figure.draw().unwrap_or_else(|e| panic!("{which}: {e}")).svg;
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{which}");
            assert!(svg.len() < 1_000_000, "{which}: {} bytes", svg.len());
            assert!(figure.figure.height_mm <= PAGE_MM, "{which}");
            let source = format!("#set page(width: 200mm)\n{}", figure.caption);
            let pdf = crate::typeset::Document::new(&source).compile();
            assert!(pdf.is_ok(), "{which}: {}", figure.caption);
        });
    }
}

#[test]
fn what_a_figure_of_many_specimens_leaves_out_is_counted() {
    for (count, equal, group) in pools() {
        let figures = composed(&group);
        let predicted = named(&figures, "predicted");
        let svg = predicted.draw().unwrap().svg;
        let more = format!("aria-label=\"and {} more\"", count.saturating_sub(12));
        assert_eq!(svg.contains(&more), count > 12, "{count}, {equal}");
        let ids = svg.matches("(pooled_").count();
        let named_ones = count.min(12);
        assert!(if equal {
            ids == named_ones
        } else {
            ids <= named_ones
        });
        let told = format!("Of {count} specimens the 12 with the largest error are named");
        assert_eq!(predicted.caption.contains(&told), count > 12);
        let errors = &named(&figures, "specimen-errors").caption;
        let told = format!("Shown are the 22 of {count} specimens");
        assert_eq!(errors.contains(&told), count > 22, "{errors}");
        let held_out = composed_of_diagnosis(&group);
        let held_out = &named(&held_out, "held-out").caption;
        let told = format!("Shown are the 26 of {count} units");
        assert_eq!(held_out.contains(&told), count > 26, "{held_out}");
        let curves = &named(&figures, "curves").caption;
        let words = [
            "a short, a middle and a long specimen",
            "of three specimens",
        ];
        assert!(curves.contains(words[usize::from(equal)]), "{curves}");
    }
}

#[test]
fn the_same_figures_of_a_pool_are_drawn_every_time() {
    let (one, other) = (pool(&five(), 120, true), pool(&five(), 120, true));
    for (a, b) in composed(&one).iter().zip(composed(&other)) {
        assert_eq!(a.draw().unwrap(), b.draw().unwrap());
    }
}

/// Figures as a defect may leave them: one panics, one has no room, one has no panel, and two are sound.
const SOME_BROKEN: &[(&str, OfGroup)] = &[
    ("f620", maximum_force::figure),
    ("panics", |group, _| {
        let none = &group.fit.specimens[..0];
        Some((none[none.len()].id.clone(), Figure::new("", 10.0, 10.0)))
    }),
    ("narrow", |_, _| {
        let panel = Panel::new(Axis::new("x"), Axis::new("y"));
        let figure = Figure::new("Narrow", SINGLE_MM, 12.0).with(panel);
        Some((String::new(), figure))
    }),
    ("empty", |_, _| {
        Some((String::new(), Figure::new("Empty", SINGLE_MM, 60.0)))
    }),
    ("rest", rest::figure),
];

#[test]
fn a_figure_that_fails_takes_no_other_with_it() {
    let group = groups().swap_remove(0);
    let composed = super::named(SOME_BROKEN, &group, &Config::default());
    let built = build(composed.into_iter().map(Some).collect(), &at_dpi(30.0));
    let names: Vec<Option<&str>> = built
        .drawn
        .iter()
        .map(|d| d.as_ref().map(|d| d.name.as_str()))
        .collect();
    let sound = [
        Some("f620-five-10mm"),
        None,
        None,
        None,
        Some("rest-five-10mm"),
    ];
    assert_eq!(names, sound);
    assert_eq!(built.files.len(), 2 * 4, "SVG, PDF, PNG and CSV of each");
    let failed: Vec<(&str, Task)> = built
        .left_out
        .iter()
        .map(|l| (l.name.as_str(), l.task))
        .collect();
    let expected = [
        ("panics-five-10mm", Task::Composing),
        ("narrow-five-10mm", Task::Drawing),
        ("empty-five-10mm", Task::Drawing),
    ];
    assert_eq!(failed, expected);
    assert!(built.left_out[0].why.contains("index out of bounds"));
}

#[test]
fn a_figure_that_cannot_be_converted_is_left_out_in_all_formats() {
    let group = groups().swap_remove(0);
    let composed = super::named(&SOME_BROKEN[..1], &group, &Config::default());
    let built = build(composed.into_iter().map(Some).collect(), &at_dpi(1e9));
    assert!(built.files.is_empty() && built.drawn == [None]);
    assert_eq!(built.left_out[0].task, Task::Converting);
}

#[test]
fn figures_have_the_widths_of_the_journal_that_is_asked_for() {
    let named = |width_mm: f64| {
        let panel = Panel::new(
            Axis::new("x").fixed(0.0, 1.0),
            Axis::new("y").fixed(0.0, 1.0),
        );
        let figure = Figure::new("", width_mm, 60.0).with(panel);
        Some(Ok(Named {
            name: format!("f{width_mm}"),
            caption: String::new(),
            figure,
        }))
    };
    for (widths, expected) in [
        (FigureWidths::House, [85.0, 175.0]),
        (FigureWidths::Ieee, [88.0, 181.0]),
        (FigureWidths::Elsevier, [90.0, 190.0]),
    ] {
        let options = ReportOptions {
            figure_widths: widths,
            ..at_dpi(30.0)
        };
        let built = build(vec![named(SINGLE_MM), named(DOUBLE_MM)], &options);
        let drawn: Vec<f64> = built.drawn.iter().flatten().map(|d| d.size_mm.0).collect();
        assert_eq!(drawn, expected);
        assert!(
            built
                .drawn
                .iter()
                .flatten()
                .all(|d| d.svg.contains(&format!("width=\"{}mm\"", d.size_mm.0)))
        );
        let with_data = built
            .files
            .iter()
            .filter(|(name, _)| name.ends_with(".csv"));
        assert_eq!(with_data.count(), 2);
    }
}
