//! How far a fit is taken: to estimates, to a comparison, or at a glance.

/// Iterations in which a fit may do anything.
const FIRST_STEPS: usize = 4;

/// How far a fit is taken.
#[derive(Clone, Copy)]
pub(super) struct Goal {
    /// Most outer iterations.
    pub(super) iterations: usize,
    /// Estimates are at rest where a whole step would gain less log-likelihood than this at the variances as they are (half the squared Newton
    /// decrement).
    pub(super) rest: f64,
    /// The likelihood is settled where it changes by less than this from one iteration to the next.
    pub(super) settled: f64,
    /// Log-likelihood below which the fit is of no use.
    least: f64,
    /// Whether it is of no use either where an amplitude of the last term stands at its bound: at the edge of what is possible there is no estimate.
    pub(super) inside: bool,
}

impl Goal {
    /// Estimates, and what is reported of them: within a twentieth of their standard errors.
    pub(super) const ESTIMATED: Self = Self {
        iterations: 24,
        rest: 1e-3,
        settled: 0.02,
        least: f64::NEG_INFINITY,
        inside: false,
    };

    /// As far as it takes to choose among fits, or to begin another.
    pub(super) const APPROACHED: Self = Self {
        rest: 0.02,
        settled: 0.05,
        ..Self::ESTIMATED
    };

    /// A log-likelihood that is compared with others, with estimates of the last term.
    pub(super) const fn compared(least: f64) -> Self {
        Self {
            least,
            inside: true,
            ..Self::APPROACHED
        }
    }

    /// What a fit comes to at once.
    pub(super) const GLANCED: Self = Self {
        iterations: 2,
        ..Self::ESTIMATED
    };

    /// Whether a fit that has come so far will not reach what is of use: even ten times what it gains now would not take it there.
    pub(super) fn is_out_of_reach(self, iteration: usize, log_likelihood: f64, gains: f64) -> bool {
        iteration >= FIRST_STEPS && log_likelihood + 10.0 * gains < self.least
    }
}
