//! Mistakes of recording: one test far off while the others agree, or torques of the sign that the route does not give.

use super::answer::{Answered, rms};
use super::refit::{Reading, Sizes};
use super::tests::TestErrors;
use crate::findings::{ErrorKind, Level, RecordingError, Unexplained};
use crate::numerics::distributions::f_upper_tail;
use crate::numerics::statistics::median;
use crate::stages::torque::errors::Size;

/// A test is odd if its error is so many times that of the others in the median.
const TIMES: f64 = 4.0;
/// Fewest tests of which one can be odd.
const FEWEST: usize = 3;

impl Answered<'_, '_> {
    /// What should be looked at first.
    pub(super) fn odd(&self) -> Vec<RecordingError> {
        let mut all = self.wrong_sign();
        let fitted: Vec<&TestErrors> = self.tests.iter().filter(|t| t.fitted).collect();
        if fitted.len() < FEWEST {
            return all;
        }
        for test in &fitted {
            let others = fitted.iter().filter(|t| t.session != test.session);
            let others: Vec<f64> = others.map(|t| rmse(t)).collect();
            let usual = median(&others);
            if rmse(test) > TIMES * usual {
                all.push(self.far_off(test, usual));
            }
        }
        all
    }

    /// A test that is far off: mounted at another length than recorded (a wrong tendon, fitting or resting length) where that would bring it near
    /// to the others.
    fn far_off(&self, test: &TestErrors, usual: f64) -> RecordingError {
        let with_own = test.with_own_offset.map(|s| s.rmse);
        let corrected = with_own.filter(|rmse| *rmse <= TIMES * usual);
        RecordingError {
            group: test.session.clone(),
            level: Level::Test,
            kind: match corrected {
                Some(_) => ErrorKind::Length,
                None => ErrorKind::Outlier,
            },
            quantity: corrected.map(|_| "mounting_length".to_owned()),
            value: corrected.map(|_| test.own_offset_mm),
            unit: "mm".to_owned(),
            p: test.after.map(|own| self.chance(&own)),
            rms: rmse(test),
            rms_corrected: corrected,
            set_aside: false,
        }
    }

    /// Where most torques have the sign that the route does not give: the tests of which most do. Flexion is negative; `muscle` may be wrong.
    fn wrong_sign(&self) -> Vec<RecordingError> {
        let rigid = Sizes::rigid(self.readings(), &self.whole.spreads);
        let is_other = |r: &&Reading| r.torque_nm * rigid.predict(r).0 < 0.0;
        let others = self.readings().iter().filter(is_other).count();
        if 2 * others <= self.readings().len() {
            return Vec::new();
        }
        let one = |(number, session): (usize, &&str)| {
            let own = || self.readings().iter().filter(|r| r.test == number);
            let off = |sign: f64| -> Vec<f64> {
                own()
                    .map(|r| sign * r.torque_nm - rigid.predict(r).0)
                    .collect()
            };
            (2 * own().filter(is_other).count() > own().count()).then(|| RecordingError {
                group: (*session).to_owned(),
                level: Level::Test,
                kind: ErrorKind::Sign,
                quantity: Some("torque_nm".to_owned()),
                value: None,
                unit: "N.m".to_owned(),
                p: None,
                rms: rms(&off(1.0)),
                rms_corrected: Some(rms(&off(-1.0))),
                set_aside: false,
            })
        };
        let sessions = self.group.sessions.iter().enumerate();
        sessions.filter_map(one).collect()
    }

    /// Probability that the scatter of a test is as far above that of the others (F test, times the number of tests).
    fn chance(&self, of: &Size) -> f64 {
        let sizes = self.fitted_sizes();
        let sum = |of: fn(&Size) -> f64| sizes.iter().map(of).sum::<f64>();
        let (n, sse) = (sum(|s| s.n as f64), sum(|s| s.sse));
        let (own, others) = (of.n as f64, n - of.n as f64);
        let ratio = (of.sse / own) / ((sse - of.sse) / others);
        (f_upper_tail(ratio, own, others) * sizes.len() as f64).min(1.0)
    }

    /// Share of the sum of squares that a length of its own for each test takes off.
    fn share_of_own_lengths(&self) -> f64 {
        let fitted = || self.tests.iter().filter(|t| t.fitted);
        let sum = |of: fn(&TestErrors) -> Option<Size>| -> f64 {
            fitted().filter_map(of).map(|s| s.sse).sum()
        };
        1.0 - sum(|t| t.with_own_offset) / sum(|t| t.after)
    }

    fn fitted_sizes(&self) -> Vec<Size> {
        let fitted = self.tests.iter().filter(|t| t.fitted);
        fitted.filter_map(|t| t.after).collect()
    }

    /// The answer where nothing is found and yet tests are odd.
    pub(super) fn between_tests(&self) -> Unexplained {
        let sizes = self.fitted_sizes();
        let chances = sizes.iter().map(|s| self.chance(s));
        Unexplained {
            column: "session".to_owned(),
            shape: "offset".to_owned(),
            p_familywise: chances.fold(1.0, f64::min),
            log_likelihood_gain: None,
            share_of_variance: self.share_of_own_lengths(),
            curve: Vec::new(),
        }
    }
}

fn rmse(test: &TestErrors) -> f64 {
    test.after.map_or(0.0, |s| s.rmse)
}
