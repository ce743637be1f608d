//! One log about to be taken: the chain, the length held, the columns, and what does not change within the log.

use super::chain::{Acting, Chain};
use super::draw::{DrawnSession, DrawnTruth};
use super::logged_columns::LogColumns;
use super::moment::{Instant, Moment};

/// The column that conditioning follows where it is declared.
const CYCLE: &str = "cycle";

/// Whose force is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whose {
    /// That of the session's own actuator, everything that was drawn included.
    Own,
    /// That of an actuator of mean gain, with every drawn size at its mean: the best that can be said of a specimen or session
    /// that has not been seen yet.
    Expected,
}

/// One log about to be taken.
pub struct Setting {
    chain: Chain,
    length_m: f64,
    moment: Moment,
    /// The columns of the log.
    pub columns: LogColumns,
}

impl Setting {
    /// The setting of a session's run, `run` being its place in the truth file.
    pub fn new(drawn: &DrawnTruth, session: &DrawnSession, run: usize, whose: Whose) -> Self {
        let truth = &drawn.truth;
        let columns = LogColumns::new(drawn, session, run);
        let place_of = |name: &str| truth.columns.iter().position(|c| c.name == name);
        let mut actuator = drawn.actuator(session);
        if whose == Whose::Expected {
            actuator.f620_n /= session.gain;
        }
        let acting = truth.effects.iter().zip(&drawn.effects);
        let acting = acting.filter_map(|(effect, sizes)| {
            let size = sizes.values[session.number][run]?;
            let mut p = effect.numbers();
            if whose == Whose::Own {
                p[0] = size;
            }
            Some(Acting {
                form: effect.form(),
                p,
                column: effect.column.as_deref().and_then(place_of),
            })
        });
        let chain = Chain::new(actuator, acting.collect());
        let counted = (session.own_place * truth.runs.len() + run) as f64;
        let cycle = place_of(CYCLE).map_or(counted, |k| columns.value(k, 0.0));
        let moment = Moment {
            place: session.place as f64,
            cycle,
            own_cycle: run as f64,
            rest_length_m: actuator.rest_length_m,
            contraction_rel: session.contraction_rel,
            f620_n: actuator.f620_n,
            axial_force_n: 0.0,
            at: Instant::START,
        };
        Self {
            chain,
            length_m: session.length_mm * 1e-3,
            moment,
            columns,
        }
    }

    /// The force that the sensor receives, N.
    pub fn force(&self, at: Instant) -> f64 {
        let moment = Moment { at, ..self.moment };
        self.chain.force(self.length_m, &moment, &self.columns)
    }

    /// What the pressure sensor makes of a pressure in kPa.
    pub fn sensed_pressure(&self, at: Instant, pressure_kpa: f64) -> f64 {
        let moment = Moment { at, ..self.moment };
        self.chain
            .sensed_pressure(pressure_kpa, &moment, &self.columns)
    }
}
