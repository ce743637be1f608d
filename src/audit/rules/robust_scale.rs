//! What a printed RMSE of a fit with least-absolute-residual weights stands for: the inside-out effect.
//!
//! Such fits print `s = sqrt((s_ols^2 p^2 + s_rob^2 n)/(p^2 + n))`, and with sign weights Street's scale `s_rob` is nearly 0, so that
//! `s = s_ols p/sqrt(p^2 + n)` ([`pipeline_numerics::lar::printed_scale`]). Turned inside out, a printed RMSE stands for an `s_ols` that is larger by
//! `sqrt(p^2 + n)/p`. Whether a given number was printed so is not assumed but tested, against the validation RMSE.

use super::train_and_validation::Test;
use super::{UNLIKELY, either_direction, probability, show};
use crate::claims::{ClaimList, Fit};
use crate::findings::{Case, Rule, Verdict};
use pipeline_numerics::lar::printed_scale;

pub(super) const RULE: Rule = Rule {
    id: "robust_scale",
    title: "What the printed RMSE of a robust fit stands for (the inside-out effect)",
    idea: "A fit with least-absolute-residual weights prints not the RMSE of its residuals but a mixed scale that can be as small as s_ols p/√(p² + n), with p coefficients and n rows. Where the printed training RMSE contradicts the validation RMSE and the s_ols that it stands for does not, the printed one is such a number. Where the printed one agrees with the validation as it stands, it is not.",
    cases,
};

fn cases(list: &ClaimList) -> Vec<Case> {
    let robust = list.fits().filter(|f| f.lar);
    robust
        .filter_map(|fit| Some(case(fit, &Test::new(list, fit)?)))
        .collect()
}

fn case(fit: &Fit, test: &Test) -> Case {
    let p = fit.coefficients;
    let (n, m) = test.rows;
    let shrinks = printed_scale(1.0, 0.0, n as usize, p);
    let stands_for = test.train / shrinks;
    let ratio = test.validation / stands_for;
    let chance = either_direction(ratio * ratio, m, n - p as f64);
    let explains = chance >= UNLIKELY;
    let what = format!(
        "With p = {p} and n = {n} a printed {} can stand for residuals of up to {}, which against the validation RMSE {} is a probability of {}.",
        show(test.train, 4),
        show(stands_for, 3),
        show(test.validation, 4),
        probability(chance),
    );
    let (verdict, so) = match (test.contradicts(), explains) {
        (true, true) => (Verdict::Inconsistent, format!("As printed the two contradict each other; so read they agree. The printed RMSE is the scale of the robust fit, not the error of the model, and the printed intervals, made from the same scale, are narrower than least squares' by the factor {}.", show(1.0 / shrinks, 3))),
        (true, false) => (Verdict::Inconsistent, "The two contradict each other as printed, and this reading does not reconcile them.".to_owned()),
        (false, true) => (Verdict::Consistent, "Both readings agree with the validation.".to_owned()),
        (false, false) => (Verdict::Consistent, "As printed it agrees with the validation, and so read it does not: there is no inside-out effect here.".to_owned()),
    };
    Case {
        subject: fit.title.clone(),
        of: vec![fit.id.clone()],
        verdict,
        left: Some(test.train),
        right: Some(stands_for),
        unit: String::new(),
        reasoning: format!("{what} {so}"),
    }
}
