//! How long a thousand bootstrap refits of a surface of 300 readings of twelve specimens take.
//!
//! ```text
//! cargo run --release --example bootstrap
//! ```
//! The median of five, with all cores and the intervals of the other methods included.

use pipeline::base::random::Stream;
use pipeline::base::row::Row;
use pipeline::config::FitOptions;
use pipeline::models::new;
use pipeline::numerics::real::{Dual, Real};
use pipeline::stages::fit::engine::{Equation, Symbol};
use std::time::Instant;

const TRUTH: [f64; 3] = [0.5682, 4.254, 0.5597];

fn main() {
    let mut stream = Stream::new(1, &["bootstrap example"]);
    let rows: Vec<Row> = (0..300)
        .map(|k| {
            let mut row = Row::blank();
            row.specimen = format!("s{}", k % 12);
            row.contraction_rel = stream.uniform();
            row.pressure_rel = stream.uniform();
            let noise = 0.02 * stream.normal();
            row.force_n = new::surface(TRUTH, row.contraction_rel, row.pressure_rel) + noise;
            row
        })
        .collect();
    let rows: Vec<&Row> = rows.iter().collect();
    let symbol = |name| Symbol {
        name,
        unit: "1",
        bounds: (-100.0, 100.0),
        published: None,
    };
    let equation = Equation::<3> {
        id: "F*(eps*, P*)",
        title: "surface",
        unit: "1",
        symbols: [symbol("c0"), symbol("c1"), symbol("c2")],
        starts: vec![TRUTH],
        held: &|_| [None; 3],
        observed: &|r| r.force_n,
        model: &|r, c| {
            let (eps, p) = (r.contraction_rel, r.pressure_rel);
            new::surface(*c, Dual::constant(eps), Dual::constant(p))
        },
    };
    for refits in [0, 1000] {
        let options = FitOptions {
            bootstrap_refits: refits,
            ..FitOptions::default()
        };
        let mut seconds: Vec<f64> = (0..5)
            .map(|_| {
                let started = Instant::now();
                let fit = equation.fit(&rows, &options);
                assert!(fit.is_some());
                started.elapsed().as_secs_f64()
            })
            .collect();
        seconds.sort_by(f64::total_cmp);
        println!("{refits} bootstrap refits: {:.3} s", seconds[2]);
    }
}
