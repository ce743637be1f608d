//! Pressure over time: a staircase of valve openings, at the actuator and as the sensor near the inlet sees it.
//!
//! Every [`STEP_S`] the valve opens for some tens of milliseconds: the inlet valve while the rig fills, the outlet valve while it
//! vents. In a step that begins at t_0, with u = t - t_0 and flow from u_1 to u_2 (constants below):
//!
//! - Bulk pressure: P(u) = (P_0 + D g(u) (1 + rho c(u))) exp(-lambda u), where g rises linearly from 0 at u_1 to 1 at u_2, c is 1
//!   up to u_2 and exp(-(u - u_2)/tau) after it, and D is the step's height. The bracket with rho is air that was warmed or cooled
//!   by the step and takes the wall's temperature, less so while venting; lambda is the leak. Every step starts from the pressure
//!   at which the one before ended.
//! - Height, filling: D = min(0.95, f s j (1 + 1.7 x^2)) (P_supply - P_0), x = P_0/P_supply, with share f, run speed s and jitter
//!   j. The parabola was read off the 10 mm logs, where an opening covers 14% of the distance at first and 37% near the supply.
//! - Height, venting: D = -min(0.95, f j) (P_0 - P_floor): the outlet stops before the actuator is empty.
//! - Strength of the pressure wave: A = A_0 (1 - exp(-|D|/D_0)), with the sign of the step.
//! - Sensor: P(u) + A (1 - exp(-(u - u_1)/2 ms)) while air flows, P(u) - 0.4 A exp(-v/T_d) cos(2 pi v/T) after it, v = u - u_2.
//! - Actuator: rise and wave arrive [`WAVE_DELAY_S`] later, the wave in antiphase, as force does in the logs: P with g(u') in place
//!   of g(u), plus 0.55 A g(u') while air flows and 0.55 A exp(-v'/T_d) cos(2 pi v'/T) after it, with u' = u - [`WAVE_DELAY_S`].
//!   Relaxation and leak are not delayed: on a plateau sensor and actuator agree.
//!
//! The wave decays within T_d = 50 ms sqrt(P/500 kPa), P the pressure at the end of the step, at least 10 ms: thin air rings less.
//! Before the next step it is down to 1e-3 of its height.

use super::moment::Instant;
use super::rig_settings::Rig;
use pipeline_base::random::Stream;
use pipeline_base::session::Phase;
use std::f64::consts::TAU;

/// Time from one opening of the valve to the next, s.
pub const STEP_S: f64 = 0.5;
/// Time by which the pressure wave reaches the actuator later than the sensor, s.
pub const WAVE_DELAY_S: f64 = 0.009;
/// From the step's beginning until air flows, s.
const LATENCY_S: f64 = 0.013;
/// Rise time of the sensor's overshoot, s.
const SENSOR_RISE_S: f64 = 0.002;
/// Period T of the wave in the tube, s.
const WAVE_PERIOD_S: f64 = 0.029;
/// Decay time T_d of the wave at `WAVE_LEVEL_KPA`, s.
const WAVE_DECAY_S: f64 = 0.05;
/// See `WAVE_DECAY_S`.
const WAVE_LEVEL_KPA: f64 = 500.0;
/// Decay time of the wave in thin air, s.
const LEAST_DECAY_S: f64 = 0.01;
/// Growth of the filling share with the square of the pressure.
const FILL_CURVATURE: f64 = 1.7;
/// Largest share of the distance that one opening covers.
const LARGEST_SHARE: f64 = 0.95;

/// Openings that move the pressure by less are no steps: near the supply and the floor the valves still open, kPa.
const LEAST_STEP_KPA: f64 = 1.0;
/// Half the time over which a rate is taken, s.
const RATE_S: f64 = 0.005;

/// What differs between the valve that fills and the one that vents.
struct Valve {
    /// How long air flows, u_2 - u_1, s.
    flow_s: f64,
    /// Step height D_0 at which the wave comes near its full strength, kPa.
    wave_height_kpa: f64,
    /// Factor on the rig's relaxation.
    relaxation: f64,
    /// Factor on the rig's jitter.
    jitter: f64,
}

const INLET: Valve = Valve {
    flow_s: 0.017,
    wave_height_kpa: 11.0,
    relaxation: 1.0,
    jitter: 1.0,
};

const OUTLET: Valve = Valve {
    flow_s: 0.035,
    wave_height_kpa: 60.0,
    relaxation: 0.15,
    jitter: 0.2,
};

/// One opening of the valve.
#[derive(Clone, Copy, Debug)]
struct Step {
    start_s: f64,
    from_kpa: f64,
    height_kpa: f64,
    wave_kpa: f64,
    decay_s: f64,
    flow_s: f64,
    relaxation: f64,
    /// When the pressure was last moved, s.
    moved_s: f64,
    /// Highest level of the history up to the end of this step, kPa.
    peak_kpa: f64,
}

/// The pressures between which one session's air moves.
#[derive(Clone, Copy, Debug)]
pub struct Air {
    /// Filling approaches this, kPa.
    pub supply_kpa: f64,
    /// Venting approaches this, kPa.
    pub floor_kpa: f64,
    /// Factor on the share that one opening covers while filling.
    pub speed: f64,
}

/// The pressure history of one run, from an empty actuator at time 0.
pub struct Staircase<'a> {
    rig: &'a Rig,
    air: Air,
    valve: Stream,
    steps: Vec<Step>,
}

impl<'a> Staircase<'a> {
    /// A history without steps yet. `valve` gives each opening its own jitter.
    pub fn new(rig: &'a Rig, air: Air, valve: Stream) -> Self {
        Self {
            rig,
            air,
            valve,
            steps: Vec::new(),
        }
    }

    /// Adds the steps that begin at or before `time_s`; they fill or vent as `phase` says. Times must not decrease.
    pub fn advance(&mut self, time_s: f64, phase: Phase) {
        while self.steps.len() as f64 * STEP_S <= time_s {
            let start_s = self.steps.len() as f64 * STEP_S;
            let from = self.steps.last().map_or(0.0, |s| s.bulk(start_s, self.rig));
            let step = self.step(start_s, from, phase);
            self.steps.push(step);
        }
    }

    fn step(&mut self, start_s: f64, from_kpa: f64, phase: Phase) -> Step {
        let (rig, air) = (self.rig, self.air);
        let (valve, share, room) = if phase == Phase::Pressurizing {
            let x = from_kpa / air.supply_kpa;
            let share = rig.fill_share * air.speed * (1.0 + FILL_CURVATURE * x * x);
            (&INLET, share, (air.supply_kpa - from_kpa).max(0.0))
        } else {
            (&OUTLET, rig.vent_share, (air.floor_kpa - from_kpa).min(0.0))
        };
        let jitter = 1.0 + valve.jitter * rig.valve_jitter * self.valve.normal();
        let height_kpa = (share * jitter.clamp(0.3, 2.0)).min(LARGEST_SHARE) * room;
        let strength = 1.0 - libm::exp(-height_kpa.abs() / valve.wave_height_kpa);
        let moved = height_kpa.abs() >= LEAST_STEP_KPA;
        let before = self.steps.last();
        let moved_s = before.filter(|_| !moved).map_or(start_s, |s| s.moved_s);
        let peak = before.map_or(0.0, |s| s.peak_kpa);
        let density = ((from_kpa + height_kpa) / WAVE_LEVEL_KPA).max(0.0);
        Step {
            start_s,
            from_kpa,
            height_kpa,
            wave_kpa: (rig.overshoot_kpa * strength).copysign(height_kpa),
            decay_s: (WAVE_DECAY_S * density.sqrt()).max(LEAST_DECAY_S),
            flow_s: valve.flow_s,
            relaxation: valve.relaxation * rig.relaxation,
            moved_s,
            peak_kpa: peak.max(from_kpa).max(from_kpa + height_kpa),
        }
    }

    fn step_at(&self, time_s: f64) -> Option<&Step> {
        let after = self.steps.partition_point(|s| s.start_s <= time_s);
        self.steps.get(after.saturating_sub(1))
    }

    /// What an effect may know at a time up to which the history has been advanced; `pressure_kpa` is the actuator's pressure then,
    /// `share` the part of the log that is over.
    pub fn instant(&self, time_s: f64, phase: Phase, pressure_kpa: f64, share: f64) -> Instant {
        let step = self.step_at(time_s);
        let rise = self.bulk(time_s + RATE_S) - self.bulk((time_s - RATE_S).max(0.0));
        Instant {
            time_s,
            share,
            since_step_s: step.map_or(0.0, |s| (time_s - s.moved_s - LATENCY_S).max(0.0)),
            rate_kpa_per_s: rise / (2.0 * RATE_S),
            phase,
            pressure_kpa,
            peak_kpa: step.map_or(0.0, |s| s.peak_kpa),
        }
    }

    /// Pressure without waves, kPa, at a time up to which the history has been advanced.
    pub fn bulk(&self, time_s: f64) -> f64 {
        self.step_at(time_s)
            .map_or(0.0, |s| s.bulk(time_s, self.rig))
    }

    /// True gauge pressure in the actuator, kPa.
    pub fn actuator(&self, time_s: f64) -> f64 {
        let before_s = time_s - WAVE_DELAY_S;
        let at =
            |s: &Step| s.settled(time_s, s.risen(before_s), self.rig) + s.actuator_wave(before_s);
        self.step_at(time_s).map_or(0.0, at).max(0.0)
    }

    /// Gauge pressure at the sensor near the inlet, kPa.
    pub fn sensor(&self, time_s: f64) -> f64 {
        let at = |s: &Step| s.bulk(time_s, self.rig) + s.sensor_wave(time_s);
        self.step_at(time_s).map_or(0.0, at).max(0.0)
    }
}

impl Step {
    /// Time since the air began to flow, s; negative before.
    fn since_flow(&self, time_s: f64) -> f64 {
        time_s - self.start_s - LATENCY_S
    }

    /// g: the part of the step that has come through.
    fn risen(&self, time_s: f64) -> f64 {
        (self.since_flow(time_s) / self.flow_s).clamp(0.0, 1.0)
    }

    fn bulk(&self, time_s: f64, rig: &Rig) -> f64 {
        self.settled(time_s, self.risen(time_s), rig)
    }

    /// The bulk pressure where the part `risen` of the step has arrived.
    fn settled(&self, time_s: f64, risen: f64, rig: &Rig) -> f64 {
        let since_closed = (self.since_flow(time_s) - self.flow_s).max(0.0);
        let warm = 1.0 + self.relaxation * libm::exp(-since_closed / rig.relaxation_s);
        let leak = libm::exp(-rig.leak_per_s * (time_s - self.start_s));
        (self.from_kpa + self.height_kpa * risen * warm) * leak
    }

    /// The wave after the flow has ended, relative to its strength; `None` while air flows or has not begun to.
    fn ringing(&self, time_s: f64) -> Option<f64> {
        let v = self.since_flow(time_s) - self.flow_s;
        (v >= 0.0).then(|| libm::exp(-v / self.decay_s) * libm::cos(TAU * v / WAVE_PERIOD_S))
    }

    fn sensor_wave(&self, time_s: f64) -> f64 {
        let flowing = 1.0 - libm::exp(-self.since_flow(time_s).max(0.0) / SENSOR_RISE_S);
        self.wave_kpa * self.ringing(time_s).map_or(flowing, |ring| -0.4 * ring)
    }

    fn actuator_wave(&self, time_s: f64) -> f64 {
        let arrived = self.ringing(time_s).unwrap_or(self.risen(time_s));
        0.55 * self.wave_kpa * arrived
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wave_is_seen_at_the_step_and_gone_before_the_next() {
        let rig = Rig::for_diameter(10);
        let air = Air {
            supply_kpa: 624.0,
            floor_kpa: 73.0,
            speed: 1.0,
        };
        let mut staircase = Staircase::new(&rig, air, Stream::new(1, &[]));
        let mut reached = 0.0;
        for step in 0..10 {
            let start_s = f64::from(step) * STEP_S;
            staircase.advance(start_s, Phase::Pressurizing);
            let end_s = start_s + 0.99 * STEP_S;
            let level = staircase.bulk(end_s);
            assert!(level > reached && level < 624.0, "step {step}: {level} kPa");
            assert!((staircase.sensor(end_s) - staircase.actuator(end_s)).abs() < 0.05);
            assert!(staircase.sensor(start_s + 0.029) > level + 5.0);
            reached = level;
        }
    }
}
