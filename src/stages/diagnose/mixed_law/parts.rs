//! The variance of a reading by its sources, and the degrees of freedom of it.

use super::MixedLaw;
use super::view::View;
use pipeline_numerics::matrix::norm;
use pipeline_numerics::statistics::sum_of_squares;
use serde::Serialize;

/// Degrees of freedom beyond which Student's t is normal to four digits.
const MOST_FREEDOM: f64 = 1e5;

/// The force of a reading that nobody has made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// What the law has, N: below zero where it is slack.
    pub law_n: f64,
    /// Mean and standard deviation of what is read of a slack muscle, N: no force of the muscle itself.
    pub slack_n: (f64, f64),
    /// Where its variance is from.
    pub parts: Parts,
    /// Degrees of freedom of its standard deviation.
    pub freedom: f64,
}

impl Forecast {
    /// The force, N: a muscle does not push.
    pub fn mean_n(&self) -> f64 {
        self.law_n.max(self.slack_n.0)
    }

    /// The ends of what lies within so many standard deviations, N. The force is the larger one of the law's and a slack muscle's, and so is each end.
    pub fn within(&self, deviations: f64, further_n: f64) -> (f64, f64) {
        let half = deviations * (self.parts.variance() + further_n * further_n).sqrt();
        let (slack, sd) = self.slack_n;
        let of_slack = deviations * sd;
        (
            (self.law_n - half).max(slack - of_slack),
            (self.law_n + half).max(slack + of_slack),
        )
    }
}

/// Standard deviations of a reading by source, N: their squares add. Of a muscle with readings, what is not known of it and of the law is one number,
/// `estimation_n`, and `gain_n` and `lengths_n` are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Parts {
    /// Coefficients, effects and common misfit.
    pub estimation_n: f64,
    /// Gain and zero of a campaign that is not in the pool.
    pub campaign_n: f64,
    /// Gain of the muscle.
    pub gain_n: f64,
    /// Resting and contracted length of the muscle.
    pub lengths_n: f64,
    /// Set length.
    pub set_length_n: f64,
    /// Zero of the force.
    pub zero_n: f64,
    /// Misfit of the session and of the stroke.
    pub misfit_n: f64,
    /// Noise of the reading.
    pub noise_n: f64,
}

impl Parts {
    /// All of them, N^2.
    pub fn variance(&self) -> f64 {
        sum_of_squares(&[
            self.estimation_n,
            self.campaign_n,
            self.gain_n,
            self.lengths_n,
            self.set_length_n,
            self.zero_n,
            self.misfit_n,
            self.noise_n,
        ])
    }

    /// Those of one more session of a state: its own set length, zero and misfit, and the noise.
    pub(super) fn of_session(view: &View) -> Self {
        let misfit = [&view.session[2..], &view.stroke].concat();
        Self {
            set_length_n: view.session[0].abs(),
            zero_n: view.session[1].abs(),
            misfit_n: norm(&misfit),
            noise_n: view.noise_n,
            ..Self::default()
        }
    }

    /// Of these, what is of the law and of the muscle.
    pub(super) fn of_muscle(&self) -> Self {
        Self {
            estimation_n: self.estimation_n,
            campaign_n: self.campaign_n,
            gain_n: self.gain_n,
            lengths_n: self.lengths_n,
            ..Self::default()
        }
    }

    /// Those of a muscle of which nothing is known, too.
    pub(super) fn of_unread(view: &View) -> Self {
        Self {
            estimation_n: norm(&view.parameters),
            campaign_n: norm(&view.campaign),
            gain_n: view.specimen[0].abs(),
            lengths_n: norm(&view.specimen[1..]),
            ..Self::of_session(view)
        }
    }
}

impl MixedLaw {
    /// Degrees of freedom of a standard deviation that is made of estimated parts (Satterthwaite, *Biometrics Bulletin* 2 (1946) 110): each part has those
    /// of the groups that it was estimated from, less one. What is declared, or known as rounding, has no error.
    /// That of the estimation is `of_estimation`, if it holds more than the law. How well its lengths are known is estimated, from the specimens, or not.
    pub(super) fn freedom(
        &self,
        parts: &Parts,
        of_estimation: Option<f64>,
        lengths_are_estimated: bool,
        length_is_known: bool,
    ) -> f64 {
        let less = |groups: usize, by: usize| groups.saturating_sub(by).max(1) as f64;
        let specimens = less(self.specimens.len(), 1);
        let sessions = less(self.sessions, 1);
        let declared = self.sd.set_length_declared || length_is_known;
        let all = [
            (parts.estimation_n, of_estimation.unwrap_or(specimens)),
            (parts.campaign_n, less(self.campaigns.len(), 1)),
            (parts.gain_n, specimens),
            (
                parts.lengths_n,
                if lengths_are_estimated {
                    specimens
                } else {
                    f64::INFINITY
                },
            ),
            (
                parts.set_length_n,
                if declared { f64::INFINITY } else { sessions },
            ),
            (parts.zero_n, sessions),
            (parts.misfit_n, sessions),
            (parts.noise_n, less(self.readings, self.sessions)),
        ];
        let squares: f64 = all
            .iter()
            .map(|(sd, freedom)| {
                let variance = sd * sd;
                variance * variance / freedom
            })
            .sum();
        let variance = parts.variance();
        if squares > 0.0 {
            (variance * variance / squares).min(MOST_FREEDOM)
        } else {
            MOST_FREEDOM
        }
    }
}
