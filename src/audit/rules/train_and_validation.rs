//! Training against validation RMSE of one fit: an F test of the two variances.

use super::{UNLIKELY, probability, rows, show, validation};
use crate::claims::{ClaimList, Fit, Kind, Split};
use crate::findings::{Case, Rule, Verdict};
use pipeline_numerics::distributions::f_upper_tail;

pub(super) const RULE: Rule = Rule {
    id: "train_and_validation",
    title: "Training against validation error",
    idea: "Training and validation rows were drawn at random from the same data, so that the squares of their RMSE differ only as two variances of one population do (F test, one in a hundred).",
    cases,
};

/// What the F test of a fit found.
pub(super) struct Test {
    /// RMSE of the training rows.
    pub train: f64,
    /// RMSE of the validation rows.
    pub validation: f64,
    /// Rows fitted and kept back.
    pub rows: (f64, f64),
    /// Probability of so different an RMSE.
    pub p: f64,
}

impl Test {
    /// Of a fit that prints both, and whose rows are known.
    pub fn new(list: &ClaimList, fit: &Fit) -> Option<Self> {
        let (Some(n), Some(m)) = rows(list, fit) else {
            return None;
        };
        let train = &list.statistic(&fit.id, Split::Model, Kind::Rmse)?.printed;
        let validation = &validation(list, fit, Kind::Rmse)?.printed;
        let freedom = n - fit.coefficients as f64;
        // The ends of the rounding that are nearest to each other.
        let nearest = |(_, high): (f64, f64), (low, _): (f64, f64)| low / high;
        let up = nearest(train.ends(), validation.ends()).max(1.0);
        let down = nearest(validation.ends(), train.ends()).max(1.0);
        let tail = f_upper_tail(up * up, m, freedom).min(f_upper_tail(down * down, freedom, m));
        Some(Self {
            train: train.value,
            validation: validation.value,
            rows: (n, m),
            p: (2.0 * tail).min(1.0),
        })
    }

    /// Whether the two contradict each other.
    pub fn contradicts(&self) -> bool {
        self.p < UNLIKELY
    }
}

fn cases(list: &ClaimList) -> Vec<Case> {
    let tested = list
        .fits()
        .filter_map(|fit| Some((fit, Test::new(list, fit)?)));
    tested.map(|(fit, test)| case(fit, &test)).collect()
}

fn case(fit: &Fit, test: &Test) -> Case {
    let ratio = test.validation / test.train;
    let (n, m) = test.rows;
    let numbers = format!(
        "The validation RMSE {} ({m} rows) is {} times the training RMSE {} ({n} rows): F = {}, probability {}.",
        show(test.validation, 4),
        show(ratio, 3),
        show(test.train, 4),
        show(ratio * ratio, 3),
        probability(test.p),
    );
    Case {
        subject: fit.title.clone(),
        of: vec![fit.id.clone()],
        verdict: if test.contradicts() {
            Verdict::Inconsistent
        } else {
            Verdict::Consistent
        },
        left: Some(test.train),
        right: Some(test.validation),
        unit: String::new(),
        reasoning: match test.contradicts() {
            true => format!(
                "{numbers} The two cannot both be root mean squares of residuals of one population."
            ),
            false => format!("{numbers} This is what chance gives."),
        },
    }
}
