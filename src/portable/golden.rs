//! Points that hold every language to the law: `golden_vectors.csv`.
//!
//! Corners and edges of the box, states beyond every side of it, vented, slack and stretched muscles, arguments that are no muscle, and
//! points spread evenly through the box and around it (Halton sequence). None lies on a kink but those that lie on an edge, where the
//! derivative is the one inside.

use crate::domain::{Answer, Range, State};
use crate::model::Model;

/// Number of points.
pub const POINTS: usize = 500;
/// Of these beyond the box, evenly spread.
const AROUND: u32 = 160;

/// A state by what the box is made of: shares of its sides, 0 to 1 inside.
#[derive(Clone, Copy)]
struct Shares {
    rest: f64,
    free: f64,
    contraction: f64,
    pressure: f64,
}

/// The points with their answers.
pub fn points(model: &Model) -> Vec<(State, Answer)> {
    let mut states: Vec<State> = no_muscles(model);
    states.extend(on_edges().map(|s| state(model, s)));
    states.extend(beyond().map(|s| state(model, s)));
    states.extend(vented(model));
    let around = (1..=AROUND).map(|k| {
        let wide = |base, low, high| low + (high - low) * halton(k, base);
        Shares {
            rest: wide(2, -0.4, 1.5),
            free: wide(3, -0.5, 1.5),
            contraction: wide(5, -1.0, 2.5),
            pressure: wide(7, -0.3, 1.6),
        }
    });
    states.extend(around.map(|s| state(model, s)));
    let inside = (1..).map(|k| Shares {
        rest: halton(k, 2),
        free: halton(k, 3),
        contraction: halton(k, 5),
        pressure: halton(k, 7),
    });
    let missing = POINTS.saturating_sub(states.len());
    states.extend(inside.take(missing).map(|s| state(model, s)));
    let answered = states.into_iter().map(|s| (s, model.force(&s)));
    answered.collect()
}

/// `golden_vectors.csv`.
pub fn csv(model: &Model) -> String {
    let mut text = String::from(
        "rest_length_m,contracted_length_m,length_m,pressure_kpa,force_n,dforce_dlength_n_per_m,dforce_dpressure_n_per_kpa,inside\n",
    );
    for (s, a) in points(model) {
        let arguments = [
            s.rest_length_m,
            s.contracted_length_m,
            s.length_m,
            s.pressure_kpa,
        ];
        let answers = [a.force_n, a.by_length, a.by_pressure];
        for number in arguments.iter().chain(&answers) {
            text.push_str(&format!("{},", *number + 0.0));
        }
        text.push_str(if a.inside { "1\n" } else { "0\n" });
    }
    text
}

/// The arguments at shares of the box.
fn state(model: &Model, at: Shares) -> State {
    let of = |(low, high): Range, share: f64| {
        // The ends as they are, for rounding would put them outside.
        if share == 1.0 {
            high
        } else {
            low + (high - low) * share
        }
    };
    let fitted = model.fitted();
    // A box without a width in one quantity still has states beside it.
    let beside = |(low, high): Range, width: f64| {
        if high > low {
            (low, high)
        } else {
            (low, low + width)
        }
    };
    let inside = |share: f64| (0.0..=1.0).contains(&share);
    let rest_length_m = if inside(at.rest) {
        of(fitted.rest_length_m, at.rest)
    } else {
        of(beside(fitted.rest_length_m, 0.1), at.rest).max(0.2 * fitted.rest_length_m.0)
    };
    let free = if inside(at.free) {
        of(fitted.contraction_620, at.free)
    } else {
        of(beside(fitted.contraction_620, 0.02), at.free)
    };
    let contracted_length_m = rest_length_m * (1.0 - free.clamp(0.02, 0.6));
    let stroke = model.law.stroke_m(rest_length_m, contracted_length_m);
    State {
        rest_length_m,
        contracted_length_m,
        length_m: rest_length_m - of(fitted.contraction_rel, at.contraction) * stroke,
        pressure_kpa: of(fitted.pressure_kpa, at.pressure),
    }
}

/// Corners and middles of the box's sides.
fn on_edges() -> impl Iterator<Item = Shares> {
    (0..81).map(|k| {
        let share = |place: u32| f64::from(k / 3_u32.pow(place) % 3) * 0.5;
        Shares {
            rest: share(0),
            free: share(1),
            contraction: share(2),
            pressure: share(3),
        }
    })
}

/// Beyond one side or two, near and far.
fn beyond() -> impl Iterator<Item = Shares> {
    const DISTANCES: [f64; 7] = [-3.0, -0.2, -1e-4, 0.4, 1.0 + 1e-4, 1.2, 4.0];
    let pairs = (0..49).map(|k| (DISTANCES[k / 7], DISTANCES[k % 7]));
    pairs.flat_map(|(a, b)| {
        let of = |rest, contraction, pressure| Shares {
            rest,
            free: 0.5,
            contraction,
            pressure,
        };
        [of(0.5, a, b), of(a, b, 0.7)]
    })
}

/// No pressure, or less, at several lengths; and a muscle stretched to twice its length, or pushed to no length at all.
fn vented(model: &Model) -> Vec<State> {
    let middle = state(
        model,
        Shares {
            rest: 0.5,
            free: 0.5,
            contraction: 0.0,
            pressure: 1.0,
        },
    );
    let lengths = [0.9, 0.97, 0.999, 1.001, 1.03, 1.1];
    let mut all: Vec<State> = lengths
        .iter()
        .flat_map(|share| {
            [-25.0, 0.0, 5.0].map(|pressure_kpa| State {
                length_m: middle.rest_length_m * share,
                pressure_kpa,
                ..middle
            })
        })
        .collect();
    all.extend([2.0, 0.5, 0.0].map(|share| State {
        length_m: middle.rest_length_m * share,
        ..middle
    }));
    all
}

/// Arguments that describe no muscle.
fn no_muscles(model: &Model) -> Vec<State> {
    let muscle = state(
        model,
        Shares {
            rest: 0.5,
            free: 0.5,
            contraction: 0.3,
            pressure: 0.6,
        },
    );
    vec![
        State {
            rest_length_m: 0.0,
            ..muscle
        },
        State {
            contracted_length_m: -0.1,
            ..muscle
        },
        State {
            length_m: f64::NAN,
            ..muscle
        },
        State {
            pressure_kpa: f64::NAN,
            ..muscle
        },
    ]
}

/// The point number `k` of the Halton sequence of a base, in 0 to 1.
fn halton(mut k: u32, base: u32) -> f64 {
    let (mut share, mut value) = (1.0, 0.0);
    while k > 0 {
        share /= f64::from(base);
        value += share * f64::from(k % base);
        k /= base;
    }
    value
}
