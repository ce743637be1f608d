//! The gate of the fitter: the 27 nonlinear regression problems of the NIST Statistical Reference Datasets, from both starts.
//!
//! LRE is the log relative error against the certified value, the number of correct digits, capped at the 11 that are certified.

use std::fs;
use std::path::Path;

use pipeline::numerics::dual_problem::DualProblem;
use pipeline::numerics::fit::{Fit, Options, Status, fit};
use pipeline::numerics::real::Dual;

use super::nist_models as models;

const CERTIFIED_DIGITS: f64 = 11.0;

/// One problem with its certified solution.
struct Problem {
    starts: [Vec<f64>; 2],
    parameters: Vec<f64>,
    standard_deviations: Vec<f64>,
    sse: f64,
    residual_standard_deviation: f64,
    degrees_of_freedom: f64,
    y: Vec<f64>,
    x: Vec<Vec<f64>>,
}

impl Problem {
    fn read(name: &str) -> Self {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/data/nist/{name}.csv"));
        let text = fs::read_to_string(path).unwrap();
        let numbers = |line: &str, skip: usize| -> Vec<f64> {
            let fields = line.split(',').skip(skip);
            fields.map(|field| field.parse().unwrap()).collect()
        };
        let records = |kind: &str, skip: usize| -> Vec<Vec<f64>> {
            let prefix = format!("{kind},");
            let lines = text.lines().filter(|line| line.starts_with(&prefix));
            lines.map(|line| numbers(line, skip)).collect()
        };
        let column = |rows: &[Vec<f64>], k: usize| rows.iter().map(|row| row[k]).collect();
        let scalar = |kind: &str| records(kind, 1)[0][0];
        let parameters = records("parameter", 2);
        let rows = records("observation", 1);
        let mut y: Vec<f64> = column(&rows, 0);
        if name == "Nelson" {
            y = y.into_iter().map(libm::log).collect();
        }
        Self {
            starts: [column(&parameters, 0), column(&parameters, 1)],
            parameters: column(&parameters, 2),
            standard_deviations: column(&parameters, 3),
            sse: scalar("residual_sum_of_squares"),
            residual_standard_deviation: scalar("residual_standard_deviation"),
            degrees_of_freedom: scalar("degrees_of_freedom"),
            x: rows.iter().map(|row| row[1..].to_vec()).collect(),
            y,
        }
    }

    fn fit<const N: usize>(&self, start: &[f64], model: DualModel<N>) -> Fit {
        let f = |row: usize, b: &[Dual<N>; N]| model(b, &self.x[row]);
        fit(&DualProblem::new(&self.y, f), start, &Options::default())
    }

    /// Sum of squares at the certified parameters.
    fn certified_sse<const N: usize>(&self, model: PlainModel<N>) -> f64 {
        let b: [f64; N] = self.parameters.clone().try_into().unwrap();
        let rows = self.x.iter().zip(&self.y);
        rows.map(|(x, y)| (y - model(&b, x)) * (y - model(&b, x)))
            .sum()
    }
}

type DualModel<const N: usize> = fn(&[Dual<N>; N], &[f64]) -> Dual<N>;
type PlainModel<const N: usize> = fn(&[f64; N], &[f64]) -> f64;

/// A name, the fit from a start, and the sum of squares at the certified parameters.
type Entry = (
    &'static str,
    fn(&Problem, &[f64]) -> Fit,
    fn(&Problem) -> f64,
);

macro_rules! entries {
    ($($name:literal $model:ident),* $(,)?) => {
        [$(($name, |p, start| p.fit(start, models::$model), |p| p.certified_sse(models::$model))),*]
    };
}

const PROBLEMS: [Entry; 27] = entries![
    "Misra1a" saturating_exponential,
    "Chwirut2" chwirut,
    "Chwirut1" chwirut,
    "Lanczos3" lanczos,
    "Gauss1" gauss,
    "Gauss2" gauss,
    "DanWood" dan_wood,
    "Misra1b" misra1b,
    "Kirby2" kirby2,
    "Hahn1" cubic_over_cubic,
    "Nelson" nelson,
    "MGH17" mgh17,
    "Lanczos1" lanczos,
    "Lanczos2" lanczos,
    "Gauss3" gauss,
    "Misra1c" misra1c,
    "Misra1d" misra1d,
    "Roszman1" roszman1,
    "ENSO" enso,
    "MGH09" mgh09,
    "Thurber" cubic_over_cubic,
    "BoxBOD" saturating_exponential,
    "Rat42" rat42,
    "MGH10" mgh10,
    "Eckerle4" eckerle4,
    "Rat43" rat43,
    "Bennett5" bennett5,
];

/// Correct digits of a value, between 0 and the number certified.
fn lre(found: f64, certified: f64) -> f64 {
    if found == certified {
        return CERTIFIED_DIGITS;
    }
    let digits = -libm::log10((found - certified).abs() / certified.abs());
    if digits.is_nan() {
        0.0
    } else {
        digits.clamp(0.0, CERTIFIED_DIGITS)
    }
}

fn lres(found: &[f64], certified: &[f64]) -> Vec<f64> {
    found
        .iter()
        .zip(certified)
        .map(|(f, c)| lre(*f, *c))
        .collect()
}

fn lowest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// All digits found so far, and the runs that failed.
#[derive(Default)]
struct Tally {
    coefficients: Vec<f64>,
    standard_errors: Vec<f64>,
    failures: Vec<String>,
}

impl Tally {
    fn add(&mut self, name: &str, start: usize, problem: &Problem, fit: &Fit) {
        let coefficients = lres(&fit.parameters, &problem.parameters);
        let errors = lres(&fit.standard_errors(), &problem.standard_deviations);
        let scale = lre(fit.scale, problem.residual_standard_deviation);
        let sse = lre(fit.sse, problem.sse);
        println!(
            "{name:9} {start}  {:5.2} {:5.2}  {:5.2} {:5.2}  {scale:5.2} {sse:5.2}  {:5}  {}",
            mean(&coefficients),
            lowest(&coefficients),
            mean(&errors),
            lowest(&errors),
            fit.iterations,
            fit.status
        );
        // Residuals of Lanczos1 are 1e-13 of responses near 1, so that rounding the model leaves them fewer than three digits.
        let digits_of_spread = if name == "Lanczos1" { 2.5 } else { 9.0 };
        let certified = lowest(&coefficients) >= 9.0
            && lowest(&errors) >= digits_of_spread
            && scale >= digits_of_spread;
        if fit.status != Status::Converged || !certified {
            self.failures.push(format!("{name} from start {start}"));
        }
        self.coefficients.extend(coefficients);
        self.standard_errors.extend(errors);
    }
}

#[test]
fn all_54_runs_converge_to_the_certified_values() {
    let mut tally = Tally::default();
    println!("problem  run  coefficients  std. errors   resid. sd, SSE  trials");
    for (name, fit, _) in PROBLEMS {
        let problem = Problem::read(name);
        for (k, start) in problem.starts.iter().enumerate() {
            tally.add(name, k + 1, &problem, &fit(&problem, start));
        }
    }
    let means = (mean(&tally.coefficients), mean(&tally.standard_errors));
    println!(
        "mean LRE: coefficients {:.3}, standard errors {:.3}",
        means.0, means.1
    );
    println!(
        "worst LRE: coefficients {:.3}, standard errors {:.3}",
        lowest(&tally.coefficients),
        lowest(&tally.standard_errors)
    );
    assert!(
        tally.failures.is_empty(),
        "not at the certified values: {:?}",
        tally.failures
    );
    assert!(means.0 >= 9.0 && means.1 >= 9.0, "{means:?}");
}

/// The models are those of NIST: at the certified parameters they leave the certified residuals.
#[test]
fn models_have_the_certified_sum_of_squares() {
    for (name, _, certified_sse) in PROBLEMS {
        let problem = Problem::read(name);
        let rows = problem.y.len() - problem.parameters.len();
        // NIST prints 9 for Rat43, but its residual standard deviation is that of 11, as are the rows in the file.
        let printed = if name == "Rat43" { 9.0 } else { rows as f64 };
        assert_eq!(problem.degrees_of_freedom, printed, "{name}");
        // The sum of squares of Lanczos1 is smaller than the rounding of its certified parameters.
        if name != "Lanczos1" {
            assert!(lre(certified_sse(&problem), problem.sse) > 8.0, "{name}");
        }
    }
}
