//! The moment of a reading: everything beside the length and a logged column that an effect may look at.

use pipeline_base::session::Phase;

/// What changes within a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Time since the log began, s; 0 for readings without a clock.
    pub time_s: f64,
    /// Part of the log that is over: 0 at its first reading, 1 at its last.
    pub share: f64,
    /// Time since the last step in pressure, s.
    pub since_step_s: f64,
    /// dP/dt, kPa/s.
    pub rate_kpa_per_s: f64,
    /// Filling or venting.
    pub phase: Phase,
    /// True gauge pressure in the actuator, kPa.
    pub pressure_kpa: f64,
    /// Highest pressure of the log so far, kPa.
    pub peak_kpa: f64,
}

/// An instant of one log, with what is the same throughout the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Sessions of the campaign before this one, in the order in which they were measured.
    pub place: f64,
    /// Pressure cycles that the specimen has been through before this log.
    pub cycle: f64,
    /// Cycles since the length of the session was set.
    pub own_cycle: f64,
    /// l_rest, m.
    pub rest_length_m: f64,
    /// eps* of the length held.
    pub contraction_rel: f64,
    /// F_620 of the specimen, N.
    pub f620_n: f64,
    /// Axial force that pulls at the frame, N; 0 until it is known.
    pub axial_force_n: f64,
    /// What changes within the log.
    pub at: Instant,
}

impl Instant {
    /// An empty actuator at rest.
    pub const START: Instant = Instant {
        time_s: 0.0,
        share: 0.0,
        since_step_s: 0.0,
        rate_kpa_per_s: 0.0,
        phase: Phase::Pressurizing,
        pressure_kpa: 0.0,
        peak_kpa: 0.0,
    };

    /// -1 while filling, +1 while venting: the braid's friction holds the force back in both directions.
    pub fn direction(&self) -> f64 {
        match self.phase {
            Phase::Pressurizing => -1.0,
            Phase::Depressurizing => 1.0,
        }
    }
}
