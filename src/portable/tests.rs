//! The exported function inside the box, at its edges and beyond.

use crate::domain::{Answer, Domain, Fitted, State};
use crate::golden;
use crate::languages::LANGUAGES;
use crate::model::Model;
use crate::source::{self, PUBLISHED};
use pipeline_base::random::Stream;
use pipeline_mechanics::models::{Direction, ForceModel, knee_paper::KneePaper, new::NewPublished};
use std::collections::BTreeMap;

fn published() -> Vec<Model> {
    let all = PUBLISHED
        .iter()
        .flat_map(|name| [10, 20, 40].map(|d| (name, d)));
    all.map(|(name, d)| source::of_published(name, d).unwrap())
        .collect()
}

/// The published models, and laws that a fit to few readings can end with: one that rises again with contraction, one that hardly falls, one with a
/// threshold of the bladder, one that shrinks with the resting length.
fn models() -> Vec<Model> {
    let mut all = published();
    let changed = |change: fn(&mut Model)| {
        let mut model = source::of_published("new", 10).unwrap();
        let narrow = Fitted {
            rest_length_m: (0.15, 0.3),
            contraction_620: (0.16, 0.18),
            contraction_rel: (0.05, 0.75),
            pressure_kpa: (65.0, 610.0),
        };
        change(&mut model);
        model.domain = Domain::new(&model.law, narrow);
        model
    };
    all.push(changed(|m| m.law.surface[5] = -0.8));
    all.push(changed(|m| {
        m.law.surface[..3].copy_from_slice(&[-0.01, 0.01, 0.05])
    }));
    all.push(changed(|m| m.law.threshold_sharp_kpa = 40.0));
    all.push(changed(|m| m.law.threshold_gradual_kpa = 70.0));
    all.push(changed(|m| {
        m.law.length_linear_per_m = -5.0;
        m.law.middle_length_m = 0.2;
    }));
    all
}

/// A state in the box and far around it.
fn anywhere(model: &Model, random: &mut Stream) -> State {
    let fitted = model.fitted();
    let mut within = |(low, high): (f64, f64), below: f64, above: f64| {
        let width = (high - low).max(0.1 * high);
        low - below * width + random.uniform() * (1.0 + below + above) * width
    };
    let rest_length_m = within(fitted.rest_length_m, 0.9, 2.0).max(1e-3);
    let free = within(fitted.contraction_620, 0.5, 1.0).clamp(0.02, 0.6);
    let contracted_length_m = rest_length_m * (1.0 - free);
    let stroke = model.law.stroke_m(rest_length_m, contracted_length_m);
    State {
        rest_length_m,
        contracted_length_m,
        length_m: rest_length_m - within(fitted.contraction_rel, 2.0, 3.0) * stroke,
        pressure_kpa: within(fitted.pressure_kpa, 0.5, 2.0),
    }
}

fn largest_in_box(model: &Model) -> f64 {
    let fitted = model.fitted();
    let share = |(low, high): (f64, f64), k: i32| low + (high - low) * f64::from(k) / 20.0;
    let mut largest = 0.0_f64;
    for k in 0..21_i32.pow(3) {
        let rest_length_m = share(fitted.rest_length_m, k % 21);
        let contracted_length_m = rest_length_m * (1.0 - model.usual_contraction_620);
        let stroke = model.law.stroke_m(rest_length_m, contracted_length_m);
        let at = model.force(&State {
            rest_length_m,
            contracted_length_m,
            length_m: rest_length_m - share(fitted.contraction_rel, k / 21 % 21) * stroke,
            pressure_kpa: share(fitted.pressure_kpa, k / 441),
        });
        largest = largest.max(at.force_n);
    }
    largest
}

#[test]
fn no_state_pulls_harder_than_the_box() {
    for model in models() {
        // A law that is largest between two points of the grid is so by less than this.
        let largest = largest_in_box(&model) * (1.0 + 1e-6);
        let mut random = Stream::new(7, &["portable"]);
        for _ in 0..20_000 {
            let state = anywhere(&model, &mut random);
            let Answer { force_n, .. } = model.force(&state);
            assert!(
                (0.0..=largest).contains(&force_n),
                "{}: {force_n} > {largest} at {state:?}",
                model.title
            );
        }
    }
}

#[test]
fn a_muscle_goes_slack_when_it_is_contracted_and_when_it_is_vented() {
    for model in models() {
        let fitted = *model.fitted();
        let rest_length_m = fitted.rest_length_m.1;
        let contracted_length_m = rest_length_m * (1.0 - model.usual_contraction_620);
        let stroke = model.law.stroke_m(rest_length_m, contracted_length_m);
        let at = |u: f64, pressure_kpa| {
            let length_m = rest_length_m - u * stroke;
            model
                .force(&State {
                    rest_length_m,
                    contracted_length_m,
                    length_m,
                    pressure_kpa,
                })
                .force_n
        };
        assert!(at(fitted.contraction_rel.0, fitted.pressure_kpa.1) > 0.0);
        assert_eq!(at(3.5, fitted.pressure_kpa.1), 0.0, "{}", model.title);
        // Eq. 12 of the knee paper leaves 15 N in a vented muscle of 40 mm at its resting length.
        assert_eq!(at(0.3, 0.0), 0.0, "{}", model.title);
        assert_eq!(at(0.3, -50.0), 0.0, "{}", model.title);
    }
}

/// The case of the laboratory that ported the published model by hand and got 13,096 N.
#[test]
fn a_stretched_muscle_keeps_the_force_of_the_edge() {
    for model in published() {
        let rest_length_m = 0.4;
        let at = |strain: f64| State {
            rest_length_m,
            contracted_length_m: rest_length_m * (1.0 - model.usual_contraction_620),
            length_m: rest_length_m * (1.0 + strain),
            pressure_kpa: 600.0,
        };
        let edge = model.force(&at(0.0)).force_n;
        for strain in [1e-6, 0.05, 0.5, 3.0] {
            let stretched = model.force(&at(strain));
            assert_eq!(stretched.force_n, edge);
            assert_eq!((stretched.by_length, stretched.inside), (0.0, false));
        }
    }
}

#[test]
fn inside_it_is_the_published_model() {
    for (model, published) in published().into_iter().zip([0, 0, 0, 1, 1, 1]) {
        let published: &dyn ForceModel = if published == 0 {
            &NewPublished
        } else {
            &KneePaper
        };
        let mut compared = 0;
        for (at, answer) in golden::points(&model).iter().filter(|(_, a)| a.inside) {
            let state = pipeline_mechanics::models::State {
                diameter_mm: f64::from(model.diameter_mm),
                rest_length_m: at.rest_length_m,
                contracted_length_m: at.contracted_length_m,
                length_m: at.length_m,
                pressure_kpa: at.pressure_kpa,
                direction: Direction::Isometric,
            };
            let expected = published.predict(&state).force_n().unwrap();
            assert!(
                (answer.force_n - expected).abs() < 1e-10 * expected.max(1.0),
                "{at:?}"
            );
            compared += 1;
        }
        assert!(compared > 150, "{compared} points inside");
    }
}

#[test]
fn derivatives_are_those_of_the_force() {
    for model in models() {
        for (at, answer) in golden::points(&model) {
            if !answer.force_n.is_finite() {
                continue;
            }
            let force = |dl: f64, dp: f64| {
                let moved = State {
                    length_m: at.length_m + dl,
                    pressure_kpa: at.pressure_kpa + dp,
                    ..at
                };
                model.force(&moved).force_n
            };
            // Small beside the stroke, over which the force goes.
            let stroke = model.law.stroke_m(at.rest_length_m, at.contracted_length_m);
            let (dl, dp) = (1e-6 * stroke, 1e-4);
            // On a kink the derivative is that of one of its sides.
            let agrees = |found: f64, before: f64, after: f64, scale: f64| {
                let near = |x: f64| (x - found).abs() < 1e-4 * (found.abs() + scale);
                near(before) || near(after) || near(0.5 * (before + after))
            };
            let here = answer.force_n;
            let by_length = ((here - force(-dl, 0.0)) / dl, (force(dl, 0.0) - here) / dl);
            let by_pressure = ((here - force(0.0, -dp)) / dp, (force(0.0, dp) - here) / dp);
            assert!(
                agrees(answer.by_length, by_length.0, by_length.1, 10.0),
                "{at:?} {answer:?} {by_length:?}"
            );
            assert!(
                agrees(answer.by_pressure, by_pressure.0, by_pressure.1, 0.1),
                "{at:?} {answer:?} {by_pressure:?}"
            );
        }
    }
}

#[test]
fn the_force_never_jumps() {
    for model in models() {
        let mut random = Stream::new(11, &["portable"]);
        for _ in 0..60 {
            let (a, b) = (anywhere(&model, &mut random), anywhere(&model, &mut random));
            let stroke = |s: &State| model.law.stroke_m(s.rest_length_m, s.contracted_length_m);
            let contraction = |s: &State| (s.rest_length_m - s.length_m) / stroke(s);
            let at = |share: f64| {
                let between = |x: f64, y: f64| x + (y - x) * share;
                let u = between(contraction(&a), contraction(&b));
                let state = State {
                    length_m: a.rest_length_m - u * stroke(&a),
                    pressure_kpa: between(a.pressure_kpa, b.pressure_kpa),
                    ..a
                };
                model.force(&state).force_n
            };
            let largest = largest_in_box(&model);
            for k in 0..2000 {
                let (here, next) = (at(f64::from(k) / 2000.0), at(f64::from(k + 1) / 2000.0));
                assert!(
                    (next - here).abs() < 0.05 * largest,
                    "{}: {here} {next}",
                    model.title
                );
            }
        }
    }
}

#[test]
fn points_are_as_many_as_promised_and_on_both_sides_of_every_edge() {
    for model in models() {
        let points = golden::points(&model);
        assert_eq!(points.len(), golden::POINTS);
        let inside = points.iter().filter(|(_, a)| a.inside).count();
        assert!((150..350).contains(&inside), "{inside}");
        let slack = points.iter().filter(|(_, a)| a.force_n == 0.0).count();
        assert!((30..300).contains(&slack), "{slack}");
    }
}

#[test]
fn templates_are_filled_in_and_files_have_names_of_their_own() {
    for model in models() {
        let files = LANGUAGES.iter().flat_map(|l| (l.files)(&model));
        let mut seen = BTreeMap::new();
        for (name, text) in files {
            let place = text.split('@').nth(1);
            let unfilled = place.is_some_and(|p| {
                p.chars()
                    .all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_')
            });
            assert!(!unfilled, "{name}: {place:?}");
            assert!(seen.insert(name, text).is_none(), "{name}");
        }
    }
}
