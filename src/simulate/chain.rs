//! The measurement chain: length and pressure make a force, and the sensors show what they show of it.
//!
//! 1. The length held and the true pressure in the actuator (see [`super::staircase`]).
//! 2. The force of the new model at these, times the specimen's gain: F = u F_620 F*(eps*, P*) (force paper, Eqs. 5 to 9).
//! 3. What the force sensor receives.
//! 4. The sensor: zero, noise, steps of the converter, its two ends ([`Channel`]).
//!
//! All three ways of measuring (logs over time, steady readings, [`super::steady`]) go through [`Chain::force`] and nothing else
//! computes a force. An effect is an operator at one [`Link`]: on the length or the pressure before [`Actuator::force`], on its
//! result, or on what a sensor receives; those of one link work in the order of the truth file. A frame that yields makes force and
//! length depend on each other: F is solved from F = f(l(F)).

use super::effects::{Form, Given, Link, MOST_PARAMETERS};
use super::logged_columns::LogColumns;
use super::moment::Moment;
use pipeline_base::random::Stream;
use pipeline_mechanics::models::new;
use pipeline_mechanics::models::{Direction, State};

/// One specimen, as far as its static force is concerned.
#[derive(Clone, Copy, Debug)]
pub struct Actuator {
    /// c0, c1 and c2.
    pub surface: [f64; 3],
    /// F_620 of the resting length times the specimen's gain, N.
    pub f620_n: f64,
    /// Uninflated inner diameter, mm.
    pub diameter_mm: f64,
    /// l_rest, m.
    pub rest_length_m: f64,
    /// l_620, m.
    pub contracted_length_m: f64,
}

impl Actuator {
    /// True force in N at a length in m and a gauge pressure in kPa.
    pub fn force(&self, length_m: f64, pressure_kpa: f64) -> f64 {
        let state = State {
            diameter_mm: self.diameter_mm,
            rest_length_m: self.rest_length_m,
            contracted_length_m: self.contracted_length_m,
            length_m,
            pressure_kpa,
            direction: Direction::Isometric,
        };
        let (contraction, pressure) = (state.contraction_rel(), state.pressure_rel());
        new::force(self.surface, self.f620_n, contraction, pressure)
    }
}

/// An effect that acts during a log.
#[derive(Clone, Copy, Debug)]
pub struct Acting {
    /// The operator.
    pub form: &'static Form,
    /// Its numbers, the size as drawn.
    pub p: [f64; MOST_PARAMETERS],
    /// Place of the column that it follows.
    pub column: Option<usize>,
}

/// An actuator and the effects between it and the sensors.
#[derive(Clone, Debug)]
pub struct Chain {
    actuator: Actuator,
    acting: Vec<Acting>,
    yields: bool,
}

/// Forces are solved to this, N.
const SOLVED_N: f64 = 1e-9;
/// Most steps of the solution; Illinois steps need about eight.
const MOST_STEPS: usize = 100;

impl Chain {
    /// A chain with the effects that act.
    pub fn new(actuator: Actuator, acting: Vec<Acting>) -> Self {
        let yields = acting.iter().any(|a| a.form.link == Link::Frame);
        Self {
            actuator,
            acting,
            yields,
        }
    }

    /// The force that the sensor receives, N, at a nominal length in m.
    pub fn force(&self, length_m: f64, at: &Moment, columns: &LogColumns) -> f64 {
        let pressure = self.through(Link::Pressure, at.at.pressure_kpa, at, columns);
        let length = self.through(Link::Length, length_m, at, columns);
        let pull = |length: f64| self.pull(length, pressure, at, columns);
        let free = pull(length);
        let axial = if self.yields && free > 0.0 {
            let yielding = |axial_force_n: f64| Moment {
                axial_force_n,
                ..*at
            };
            balance(free, |f| {
                pull(self.through(Link::Frame, length, &yielding(f), columns))
            })
        } else {
            free
        };
        self.through(Link::ForceSensor, axial, at, columns)
    }

    /// What the pressure sensor makes of a pressure in kPa.
    pub fn sensed_pressure(&self, pressure_kpa: f64, at: &Moment, columns: &LogColumns) -> f64 {
        self.through(Link::PressureSensor, pressure_kpa, at, columns)
    }

    /// Force of the actuator, N: an actuator that is slack stays slack, and none pushes.
    fn pull(&self, length_m: f64, pressure: f64, at: &Moment, columns: &LogColumns) -> f64 {
        let force = self.actuator.force(length_m, pressure);
        if force > 0.0 {
            self.through(Link::Actuator, force, at, columns).max(0.0)
        } else {
            force
        }
    }

    fn through(&self, link: Link, x: f64, at: &Moment, columns: &LogColumns) -> f64 {
        let acting = self.acting.iter().filter(|a| a.form.link == link);
        acting.fold(x, |x, effect| {
            let value = |k| columns.value(k, at.at.share);
            let given = Given {
                p: effect.p,
                column: effect.column.map_or(0.0, value),
            };
            (effect.form.act)(&given, at, x)
        })
    }
}

/// The force F in [0, `free`] with F = f(F), where f falls from f(0) = `free`: regula falsi with the Illinois step
/// (M. Dowell and P. Jarratt, BIT 11 (1971) 168).
fn balance(free: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, free);
    let (mut over, mut under) = (free, f(free) - free);
    let mut same = 0;
    for _ in 0..MOST_STEPS {
        if under >= 0.0 {
            return high;
        }
        let force = (low * under - high * over) / (under - over);
        let rest = f(force) - force;
        if rest.abs() < SOLVED_N || (high - low).abs() < SOLVED_N {
            return force;
        }
        let side = if rest > 0.0 { 1 } else { -1 };
        if rest > 0.0 {
            (low, over) = (force, rest);
            under *= if same == side { 0.5 } else { 1.0 };
        } else {
            (high, under) = (force, rest);
            over *= if same == side { 0.5 } else { 1.0 };
        }
        same = side;
    }
    0.5 * (low + high)
}

/// A sensor with its amplifier and converter.
#[derive(Clone, Copy, Debug)]
pub struct Channel {
    /// What it shows of nothing.
    pub zero: f64,
    /// Standard deviation of one sample.
    pub noise_sd: f64,
    /// Step of the converter.
    pub quantum: f64,
    /// Value at 0 counts.
    pub clip: f64,
}

/// Counts at which the 10-bit converter ends.
pub const TOP_COUNT: f64 = 1023.0;

/// Share of the samples that a disturbance reaches, and how much wider than the others they scatter: in the real logs most samples
/// stand on one count or its neighbour, and a few lie up to six counts away.
const DISTURBED: (f64, f64) = (0.12, 4.5);

impl Channel {
    /// One sample in counts, from 0 to the converter's end: round((value + zero + noise - clip)/quantum).
    pub fn sample(&self, value: f64, noise: &mut Stream) -> f64 {
        let shown = value + self.zero + self.noise_sd * disturbance(noise);
        ((shown - self.clip) / self.quantum)
            .round()
            .clamp(0.0, TOP_COUNT)
    }

    /// The value that stands for a number of counts.
    pub fn value(&self, counts: f64) -> f64 {
        self.clip + self.quantum * counts
    }
}

/// A mixture of two normal distributions with mean 0 and standard deviation 1.
fn disturbance(noise: &mut Stream) -> f64 {
    let (share, wide) = DISTURBED;
    let core = 1.0 / (1.0 - share + share * wide * wide).sqrt();
    let width = if noise.uniform() < share { wide } else { 1.0 };
    core * width * noise.normal()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_force_is_that_of_the_specification() {
        let actuator = Actuator {
            surface: [0.5682, 4.254, 0.5597],
            f620_n: new::f620(303.5, 19.03, 0.0075, 0.182),
            diameter_mm: 10.0,
            rest_length_m: 0.182,
            contracted_length_m: 0.152,
        };
        assert!((actuator.force(0.167, 620.0) - 143.139).abs() < 1e-3);
        assert!((actuator.force(0.1745, 300.0) - 36.936).abs() < 1e-3);
    }

    #[test]
    fn a_channel_rounds_to_counts_and_clips_at_both_ends() {
        let channel = Channel {
            zero: 1.0,
            noise_sd: 0.0,
            quantum: 0.5,
            clip: -8.0,
        };
        let mut noise = Stream::new(0, &[]);
        assert_eq!(channel.sample(2.1, &mut noise), 22.0);
        assert_eq!(channel.value(22.0), 3.0);
        assert_eq!(channel.sample(-20.0, &mut noise), 0.0);
        assert_eq!(channel.sample(1e6, &mut noise), TOP_COUNT);
    }

    #[test]
    fn the_disturbance_has_unit_variance_and_heavy_tails() {
        let mut noise = Stream::new(3, &["noise"]);
        let x: Vec<f64> = (0..40_000).map(|_| disturbance(&mut noise)).collect();
        let mean = |f: fn(f64) -> f64| x.iter().map(|v| f(*v)).sum::<f64>() / x.len() as f64;
        assert!((mean(|v| v * v) - 1.0).abs() < 0.05);
        assert!(mean(|v| v * v * v * v) > 6.0);
    }
}
