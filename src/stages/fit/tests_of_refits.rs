//! Refits by steps from the full fit against refits in full.

use crate::bootstrap::{self, Resampled};
use crate::engine::{Equation, Model, Solution, Symbol};
use crate::leave_out::{Refit, refits, steps, without};
use crate::specimens::Specimens;
use pipeline_base::random::Stream;
use pipeline_base::row::Row;
use pipeline_mechanics::models::new;
use pipeline_numerics::loss::Loss;
use pipeline_numerics::real::{Dual, Real};

const HUBER: Loss = Loss::Huber { k: 3.0 };

fn equation<const N: usize>(start: [f64; N], model: Model<'_, N>) -> Equation<'_, N> {
    let free = Symbol {
        name: "c",
        unit: "1",
        bounds: (-1e6, 1e6),
        published: None,
    };
    Equation {
        id: "test",
        title: "test",
        unit: "1",
        symbols: [free; N],
        starts: vec![start],
        held: &|_| [None; N],
        observed: &|r| r.force_n,
        model,
    }
}

/// A straight line through readings whose specimens have zeros of their own.
fn lines(specimens: usize, readings: usize) -> Vec<Row> {
    let mut stream = Stream::new(1, &["lines"]);
    let mut rows = Vec::new();
    for g in 0..specimens {
        let zero = stream.normal();
        for _ in 0..readings {
            let mut row = Row::blank();
            row.specimen = format!("s{g:03}");
            row.pressure_kpa = 10.0 * stream.uniform();
            row.force_n = 5.0 + 2.0 * row.pressure_kpa + zero + 0.1 * stream.normal();
            rows.push(row);
        }
    }
    rows
}

fn line(r: &Row, c: &[Dual<2>; 2]) -> Dual<2> {
    c[0] + c[1] * r.pressure_kpa
}

/// Specimens of different lengths and gains, one reading in fifty grossly wrong, all where the law is smooth: on the kink where its force is
/// cut at zero an objective may have several minima.
fn muscles(specimens: usize, readings: usize) -> Vec<Row> {
    let mut stream = Stream::new(2, &["muscles"]);
    let mut rows = Vec::new();
    for g in 0..specimens {
        let gain = 1.0 + 0.02 * stream.normal();
        let length = 0.1 + 0.3 * stream.uniform();
        for _ in 0..readings {
            let mut row = Row::blank();
            row.specimen = format!("s{g:03}");
            row.rest_length_m = length;
            row.contraction_rel = 0.5 * stream.uniform();
            row.pressure_rel = 0.5 + 0.5 * stream.uniform();
            let f620 = new::f620(303.5, 19.03, 0.0075, length);
            let surface = [0.5682, 4.254, 0.5597];
            let law = new::force(surface, f620, row.contraction_rel, row.pressure_rel);
            let gross = if stream.below(50) == 0 { 60.0 } else { 0.0 };
            row.force_n = gain * law + stream.normal() + gross;
            rows.push(row);
        }
    }
    rows
}

fn muscle(r: &Row, c: &[Dual<5>; 5]) -> Dual<5> {
    let constant = Dual::constant;
    let f620 = new::f620(c[0], c[1], constant(0.0075), constant(r.rest_length_m));
    let (contraction, pressure) = (constant(r.contraction_rel), constant(r.pressure_rel));
    new::force([c[2], c[3], c[4]], f620, contraction, pressure)
}

const MUSCLE: [f64; 5] = [303.5, 19.03, 0.5682, 4.254, 0.5597];

/// Root mean square of what the full refits move each coefficient.
fn scatter<const N: usize>(full: &[f64; N], refits: &[[f64; N]]) -> [f64; N] {
    std::array::from_fn(|k| {
        let squares = refits.iter().map(|r| (r[k] - full[k]) * (r[k] - full[k]));
        (squares.sum::<f64>() / refits.len() as f64).sqrt()
    })
}

/// The largest difference between steps and full refits in units of the scatter of the refits, and how many steps were of use.
fn compared<const N: usize>(
    full: &Solution<N>,
    steps: &[Option<[f64; N]>],
    refits: &[[f64; N]],
) -> (f64, usize) {
    let scatter = scatter(&full.values, refits);
    let mut largest: f64 = 0.0;
    for (step, refit) in steps.iter().zip(refits) {
        for k in 0..N {
            let off = step.map_or(0.0, |s| (s[k] - refit[k]).abs() / scatter[k]);
            largest = largest.max(off);
        }
    }
    (largest, steps.iter().flatten().count())
}

fn left_out<const N: usize>(equation: &Equation<N>, rows: &[Row], loss: Loss) -> (f64, usize) {
    let rows: Vec<&Row> = rows.iter().collect();
    let specimens = Specimens::new(&rows);
    let full = equation.solve(&rows, &equation.starts, loss).unwrap();
    let steps = steps(equation, &rows, &specimens, &full, loss).unwrap();
    let refits: Vec<[f64; N]> = (0..specimens.count())
        .map(|g| without(equation, &rows, &specimens, &full, loss, g))
        .map(|r| r.unwrap().values)
        .collect();
    compared(&full, &steps, &refits)
}

fn drawn<const N: usize>(
    equation: &Equation<N>,
    rows: &[Row],
    loss: Loss,
    draws: usize,
) -> (f64, usize) {
    let rows: Vec<&Row> = rows.iter().collect();
    let specimens = Specimens::new(&rows);
    let full = equation.solve(&rows, &equation.starts, loss).unwrap();
    let draws = bootstrap::draws("test", 1, specimens.count(), draws);
    let resampled = Resampled::new(equation, &rows, &specimens, &full).unwrap();
    let refits: Vec<[f64; N]> = draws
        .iter()
        .map(|(copies, _)| bootstrap::in_full(equation, &rows, &specimens, &full, copies))
        .collect();
    compared(&full, &resampled.steps(&draws), &refits)
}

/// Influences of a linear model are linear: one step is the refit, whatever is left out or drawn.
#[test]
fn of_a_straight_line_steps_are_refits() {
    let rows = lines(12, 7);
    let equation = equation([1.0, 1.0], &line);
    let (off, stepped) = left_out(&equation, &rows, Loss::LeastSquares);
    assert!(off < 1e-9 && stepped == 12, "{off} {stepped}");
    let (off, stepped) = drawn(&equation, &rows, Loss::LeastSquares, 50);
    assert!(off < 1e-6 && stepped == 50, "{off} {stepped}");
}

/// Curvature, a bend that moves with what is left out, and readings on either side of it.
#[test]
fn of_a_robust_surface_steps_agree_with_refits() {
    let rows = muscles(30, 25);
    let equation = equation(MUSCLE, &muscle);
    let (off, stepped) = left_out(&equation, &rows, HUBER);
    assert!(off < 0.01 && stepped >= 25, "{off} {stepped}");
    let (off, stepped) = drawn(&equation, &rows, HUBER, 60);
    assert!(off < 0.02 && stepped >= 40, "{off} {stepped}");
}

/// Only one specimen lies where an exponential has levelled off: without it the level is another matter, and the refit far away.
#[test]
fn without_an_influential_specimen_the_refit_is_the_full_one() {
    let level = |r: &Row, c: &[Dual<2>; 2]| c[0] * (-((-(c[1] * r.pressure_kpa)).exp() - 1.0));
    let mut stream = Stream::new(3, &["levels"]);
    let mut rows = Vec::new();
    for g in 0..14 {
        for k in 0..8 {
            let mut row = Row::blank();
            row.specimen = format!("s{g:03}");
            row.pressure_kpa = if g == 5 { 6.0 } else { 0.1 + 0.1 * k as f64 };
            let law = 10.0 * (1.0 - libm::exp(-0.5 * row.pressure_kpa));
            row.force_n = law + 0.05 * stream.normal();
            rows.push(row);
        }
    }
    let equation = equation([8.0, 0.4], &level);
    let (off, _) = left_out(&equation, &rows, Loss::LeastSquares);
    assert!(off < 0.01, "{off}");
}

/// Without the one specimen of another length the slope is held, which no step from the full fit can know.
#[test]
fn where_the_others_determine_less_the_refit_is_made_in_full() {
    let mut rows = lines(12, 7);
    for (k, row) in rows.iter_mut().enumerate() {
        row.rest_length_m = if row.specimen == "s004" { 0.3 } else { 0.2 };
        row.force_n = 5.0 + row.rest_length_m + 0.1 * libm::sin(k as f64);
    }
    let along = |r: &Row, c: &[Dual<2>; 2]| c[0] + c[1] * r.rest_length_m;
    let slope = |lengths: usize| [None, (lengths < 2).then_some(0.5)];
    let equation = Equation {
        held: &slope,
        ..equation([1.0, 1.0], &along)
    };
    let rows: Vec<&Row> = rows.iter().collect();
    let specimens = Specimens::new(&rows);
    let full = equation.solve(&rows, &equation.starts, HUBER).unwrap();
    let found = refits(&equation, &rows, &specimens, &full, HUBER);
    let found: Vec<(&str, &Refit<2>)> = found
        .iter()
        .map(|(id, r)| (*id, r.as_ref().unwrap()))
        .collect();
    let in_full = found.iter().filter(|(_, r)| r.in_full).map(|(id, _)| *id);
    assert_eq!(in_full.collect::<Vec<_>>(), ["s004"]);
    assert!(found[4].1.held[1] && found[4].1.values[1] == 0.5);
}

/// The scale of these losses is a median, of which sums know nothing; and few specimens are refitted anyway.
#[test]
fn other_losses_and_few_specimens_are_refitted_in_full() {
    let equation = equation([1.0, 1.0], &line);
    let of = |rows: &[Row], loss: Loss| {
        let rows: Vec<&Row> = rows.iter().collect();
        let specimens = Specimens::new(&rows);
        let full = equation.solve(&rows, &equation.starts, loss).unwrap();
        steps(&equation, &rows, &specimens, &full, loss).is_none()
    };
    assert!(of(&lines(12, 7), Loss::Cauchy { k: 2.4 }));
    assert!(of(&lines(9, 7), Loss::LeastSquares));
}
