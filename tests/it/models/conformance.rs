//! What holds for every model of the list.

use std::collections::BTreeSet;

use super::state;
use pipeline::models::{Direction, Prediction, State, published};

/// A grid of states in, at and beyond the domains.
fn grid() -> Vec<State> {
    let mut states = Vec::new();
    for diameter in [10.0, 20.0, 40.0, 16.0] {
        for rest in [0.005, 0.054, 0.112, 0.25, 0.3, 0.45, 0.8] {
            for i in 0..=24 {
                for pressure in [0.0, 20.0, 150.0, 300.0, 455.0, 620.0, 700.0, 900.0] {
                    let eps = f64::from(i) * 0.02 - 0.12;
                    for direction in [Direction::Shortening, Direction::Isometric] {
                        let at = state(diameter, rest, 0.17, eps, pressure);
                        states.push(State { direction, ..at });
                    }
                }
            }
        }
    }
    states
}

#[test]
fn forces_are_finite_and_never_negative() {
    for model in published() {
        let mut answered = 0;
        for state in grid() {
            if let Some(force) = model.predict(&state).force_n() {
                assert!(
                    force.is_finite() && force >= 0.0,
                    "{}: {state:?} {force}",
                    model.id()
                );
                answered += 1;
            }
        }
        assert!(answered > 1000, "{}: {answered}", model.id());
    }
}

#[test]
fn force_never_falls_with_pressure() {
    for model in published() {
        for &diameter in model.diameters() {
            for i in 0..=26 {
                let eps = f64::from(i) * 0.01;
                let forces: Vec<f64> = (0..=62)
                    .map(|k| state(f64::from(diameter), 0.3, 0.17, eps, f64::from(k) * 10.0))
                    .filter_map(|state| model.predict(&state).force_n())
                    .collect();
                let rising = forces.windows(2).all(|w| w[1] >= w[0] - 1e-9);
                assert!(rising, "{} {diameter} mm at {eps}: {forces:?}", model.id());
            }
        }
    }
}

#[test]
fn force_is_zero_well_beyond_the_free_length() {
    // At eps* = 1 and 620 kPa the new surface leaves 0.9 to 1.1% of F_620; from 1.05 on nothing is left.
    for (id, diameters) in [
        ("new_published", [10.0, 20.0, 40.0].as_slice()),
        ("knee_paper", &[10.0]),
        ("tondu_lopez", &[10.0, 20.0]),
    ] {
        for &diameter in diameters {
            for relative in [1.05, 1.2, 1.5] {
                let at = state(diameter, 0.4, 0.17, relative * 0.17, 620.0);
                assert_eq!(
                    super::model(id).predict(&at),
                    Prediction::Force(0.0),
                    "{id} {at:?}"
                );
            }
        }
    }
}

#[test]
fn every_model_names_itself_and_its_source() {
    let mut ids = BTreeSet::new();
    for model in published() {
        assert!(ids.insert(model.id()), "{} twice", model.id());
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        assert!(model.id().chars().all(plain));
        let source = model.source();
        for text in [
            model.title(),
            source.short,
            source.full,
            source.equations,
            model.domain(),
        ] {
            assert!(!text.is_empty(), "{}", model.id());
        }
        assert!(!model.diameters().is_empty());
        assert!(model.diameters().is_sorted());
    }
}

#[test]
fn coefficients_have_symbols_units_and_intervals_around_them() {
    for model in published() {
        assert!(model.coefficients(16).is_empty());
        for &diameter in model.diameters() {
            let list = model.coefficients(diameter);
            let symbols: BTreeSet<&str> = list.iter().map(|c| c.symbol).collect();
            assert_eq!(symbols.len(), list.len(), "{}", model.id());
            for c in list {
                assert!(c.value.is_finite() && !c.symbol.is_empty() && !c.unit.is_empty());
                if let Some((low, high)) = c.interval_95 {
                    assert!(
                        low <= c.value && c.value <= high,
                        "{} {}",
                        model.id(),
                        c.symbol
                    );
                }
            }
        }
    }
}

#[test]
fn states_that_are_none_get_a_reason() {
    let good = state(10.0, 0.3, 0.17, 0.05, 400.0);
    let bad = [
        State {
            pressure_kpa: -1.0,
            ..good
        },
        State {
            pressure_kpa: f64::NAN,
            ..good
        },
        State {
            length_m: 0.0,
            ..good
        },
        State {
            rest_length_m: f64::INFINITY,
            ..good
        },
        State {
            diameter_mm: 15.0,
            ..good
        },
    ];
    for model in published() {
        for state in &bad {
            let answer = model.predict(state);
            assert!(answer.force_n().is_none(), "{}: {state:?}", model.id());
            assert!(!answer.reason().unwrap().to_string().is_empty());
        }
        // An unknown free length is an answer or a reason, never a NaN.
        let unknown = State {
            contracted_length_m: f64::NAN,
            ..good
        };
        assert!(model.predict(&unknown).force_n().is_none_or(f64::is_finite));
    }
}
