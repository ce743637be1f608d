//! The numbers that decide what is answered, each with its reason: all of them, for forces and torques alike, and nowhere else. `docs/closed-loop.md`
//! has them as a table.
//!
//! Others of the loop are no decisions: priors and physical bounds say what is plausible of a law, a rig or an actuator (`settings` of the stages,
//! bounds of the effects in the registry); those of numerics, beside the code that they are of, say how far an iteration goes and how much is tried.

/// Family-wise level at which something comes into a model. A search makes one such test more than it finds effects, and where a law is wrong in ways
/// that its misfit does not have, a test errs more often than it says: with laws of others, in 4 of 20 campaigns with nothing in them at 0.05, in 1 at
/// 0.02. In simulated joints an effect at four times its limit stood alone in 148 of 172 at 0.05, in 155 of 166 at 0.02.
pub const COMES_IN: f64 = 0.02;

/// Family-wise level of every other test: convention.
pub const LEVEL: f64 = 0.05;

/// Models whose log-likelihoods differ by less are indistinguishable: a ratio of likelihoods of 7.
pub const ALIKE: f64 = 2.0;

/// Least share of a whitened sensitivity that the fixed effects must leave for a direction to be tested: below it standard errors are ten times
/// those of the effect alone.
pub const IDENTIFIABLE: f64 = 0.01;

/// Cosine from which two sensitivities are reported as nearly one, or a column is the angle by another name: the one then explains four fifths of what
/// the other does.
pub const PARALLEL: f64 = 0.9;

/// Normal deviate of the power with which a detection limit is found, 80%: convention.
pub const POWER_80: f64 = 0.841_621_233_572_914;

/// Two-sided 95% point of the normal distribution: every interval is of 95%, by convention.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;
/// Half of its square: by so much the log-likelihood falls at the ends of an interval.
pub const FALL_95: f64 = 1.920_729_410_347_062;

/// Fewest readings that are searched where the law is fitted to them: below, the model has hardly a reading to spare for each of its coefficients
/// and groups.
pub const FEWEST_READINGS: usize = 20;
/// The same where the law is known: about a knee, which has nothing but the sizes of effects to estimate.
pub const FEWEST_READINGS_OF_KNOWN_LAW: usize = 8;

/// Fewest specimens that are searched, and on either side of a change that no specimen was measured on both sides of: what is said of one alone is
/// its own value.
pub const FEWEST_SPECIMENS: usize = 2;

/// Fewest of anything that says something of its own: sessions on either side of a change point, sessions for each group that a column names,
/// readings after the joint turned either way, tests beside one that is told to be off, values along which a size bends. With two any line
/// goes through, and a value of single sessions is scatter or a recording error.
pub const FEWEST: usize = 3;

/// Most levels of a column of whole numbers that names groups: with more it is a quantity.
pub const MOST_LEVELS: usize = 4;

/// A value that differs from the median of the others by so many robust standard deviations is none of theirs: beyond what a normal
/// distribution has in any campaign.
pub const STANDS_OUT: f64 = 5.0;

/// Most sessions and specimens that are set aside as recording errors: where more look mistaken, the law does.
pub const MOST_MISTAKEN: usize = 3;
/// Largest share of the sessions and of the specimens that can be mistaken: the others are who says what is right.
pub const MOST_MISTAKEN_SHARE: (f64, f64) = (1.0 / 3.0, 1.0 / 2.0);
/// Most tests of a joint that are set aside: a joint has few.
pub const MOST_MISTAKEN_TESTS: usize = 2;

/// A mistake explains a group if what it leaves is within so many times what the others have: two standard deviations.
pub const EXPLAINS: f64 = 2.0;

#[cfg(test)]
mod tests {
    use super::*;
    use pipeline_numerics::distributions::normal_quantile;

    #[test]
    fn deviates_are_those_of_their_probabilities() {
        let is = |a: f64, b: f64| (a - b).abs() < 1e-9;
        assert!(is(normal_quantile(0.8), POWER_80));
        assert!(is(normal_quantile(1.0 - 0.5 * LEVEL), NORMAL_95));
        assert!(is(0.5 * NORMAL_95 * NORMAL_95, FALL_95));
    }
}
