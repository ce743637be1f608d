//! Distributions against the table that `tests/scripts/distributions.py` makes with SciPy.

use std::fs;
use std::path::Path;

use pipeline::numerics::distributions::{
    chi_square_upper_tail, f_upper_tail, normal_cdf, normal_quantile, student_t_cdf,
    student_t_quantile,
};

fn evaluate(kind: &str, a: &[f64]) -> f64 {
    match kind {
        "normal_cdf" => normal_cdf(a[0]),
        "normal_quantile" => normal_quantile(a[0]),
        "student_t_cdf" => student_t_cdf(a[0], a[1]),
        "student_t_quantile" => student_t_quantile(a[0], a[1]),
        "chi_square_upper_tail" => chi_square_upper_tail(a[0], a[1]),
        "f_upper_tail" => f_upper_tail(a[0], a[1], a[2]),
        other => panic!("no distribution `{other}`"),
    }
}

#[test]
fn values_agree_with_scipy() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/distributions.csv");
    let text = fs::read_to_string(path).unwrap();
    let mut wrong = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let mut fields = line.split(',');
        let kind = fields.next().unwrap();
        let numbers: Vec<f64> = fields.map(|field| field.parse().unwrap()).collect();
        let (value, arguments) = numbers.split_last().unwrap();
        let found = evaluate(kind, arguments);
        if (found - value).abs() > 1e-10 * value.abs() {
            wrong.push(format!("{line} but found {found:e}"));
        }
    }
    assert!(
        wrong.is_empty(),
        "{} values:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}
