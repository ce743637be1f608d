//! Mistakes of recording: one test far off while the others agree, or torques of the sign that the route does not give.

use super::answer::{Answered, rms};
use super::refit::Sizes;
use super::tests::TestErrors;
use crate::numerics::distributions::f_upper_tail;
use crate::numerics::statistics::median;
use crate::stages::diagnose::findings::Unexplained;
use crate::stages::torque::errors::Size;

/// A test is odd if its error is so many times that of the others in the median.
const TIMES: f64 = 4.0;
/// Fewest tests of which one can be odd.
const FEWEST: usize = 3;

impl Answered<'_, '_> {
    /// What should be looked at first, in words.
    pub(super) fn odd(&self) -> Vec<String> {
        let mut all: Vec<String> = self.wrong_sign().into_iter().collect();
        let fitted: Vec<&TestErrors> = self.tests.iter().filter(|t| t.fitted).collect();
        if fitted.len() < FEWEST {
            return all;
        }
        let rmse = |t: &TestErrors| t.after.map_or(0.0, |s| s.rmse);
        for test in &fitted {
            let others = fitted.iter().filter(|t| t.session != test.session);
            let others: Vec<f64> = others.map(|t| rmse(t)).collect();
            let usual = median(&others);
            if rmse(test) <= TIMES * usual {
                continue;
            }
            let own = test.with_own_offset.map_or(f64::NAN, |s| s.rmse);
            all.push(format!(
                "look at {} first: off by {:.1} N.m, the others by {usual:.1} in the median; with an offset of the length of {:.0} mm of its own it would be off by {own:.1} (a wrong tendon, fitting or resting length?)",
                test.session,
                rmse(test),
                test.own_offset_mm
            ));
        }
        all
    }

    /// Whether most torques have the sign that the route does not give.
    fn wrong_sign(&self) -> Option<String> {
        let rigid = Sizes::rigid(self.readings(), &self.whole.spreads);
        let readings = self.readings().iter();
        let other = readings.filter(|r| r.torque_nm * rigid.predict(r).0 < 0.0);
        (2 * other.count() > self.readings().len()).then(|| {
            "look at the sign first: most torques have the other sign than the route gives (flexion is negative; is `muscle` right?)".to_owned()
        })
    }

    /// Probability that the scatter of one of the tests is as far above that of the others (F test, times the number of tests).
    fn chance_of_the_worst(&self) -> f64 {
        let fitted = self.tests.iter().filter(|t| t.fitted);
        let sizes: Vec<Size> = fitted.filter_map(|t| t.after).collect();
        let sum = |of: fn(&Size) -> f64| sizes.iter().map(of).sum::<f64>();
        let (n, sse) = (sum(|s| s.n as f64), sum(|s| s.sse));
        let chance = |s: &Size| {
            let (own, others) = (s.n as f64, n - s.n as f64);
            let ratio = (s.sse / own) / ((sse - s.sse) / others);
            f_upper_tail(ratio, own, others)
        };
        let least = sizes.iter().map(chance).fold(1.0, f64::min);
        (least * sizes.len() as f64).min(1.0)
    }

    /// The answer where nothing is found and yet tests are odd.
    pub(super) fn between_tests(&self, held_out: &[f64]) -> Unexplained {
        Unexplained {
            column: "session".to_owned(),
            shape: "offset".to_owned(),
            p_adjusted: self.chance_of_the_worst(),
            share_of_residual: 1.0,
            rmse_heldout_before: Some(rms(held_out)),
            rmse_heldout_after: None,
            curve: Vec::new(),
        }
    }
}
