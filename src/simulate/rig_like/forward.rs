//! The force of a reading, given how its specimen and session depart from what is recorded.

use super::draw::{COLUMNS, Drawn};
use super::{DIAMETER_MM, Put, Settings};
use crate::chain::{Acting, Actuator, Chain};
use crate::coefficients::Coefficients;
use crate::effects::{self, Column, MOST_PARAMETERS};
use crate::logged_columns::LogColumns;
use crate::moment::{Instant, Moment};
use pipeline_mechanics::models::P_620_KPA;

/// How a reading departs from what a stranger expects of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Departure {
    /// Factor on the force of the specimen, less 1.
    pub gain: f64,
    /// l_rest less that recorded, mm.
    pub rest_mm: f64,
    /// l_620 less that recorded, mm.
    pub contracted_mm: f64,
    /// Length set less that recorded, mm.
    pub length_mm: f64,
    /// Zero of the force, N.
    pub zero_n: f64,
    /// Misfit of the session at this pressure, as a share of the force.
    pub misfit: f64,
}

/// Of which reading the force is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Place of the session.
    pub setup: usize,
    /// Run, counted from 0.
    pub run: usize,
    /// When, and the true pressure.
    pub at: Instant,
}

/// The chain of a campaign.
pub struct Forward<'a> {
    settings: &'a Settings,
    drawn: &'a Drawn,
    law: Coefficients,
    acting: Vec<Acting>,
    from: Vec<usize>,
}

impl<'a> Forward<'a> {
    /// The chain with these effects.
    ///
    /// # Panics
    /// If an effect or form is not in the list of effects.
    pub fn new(settings: &'a Settings, drawn: &'a Drawn, effects: &[Put]) -> Self {
        let sessions = drawn.setups.len() as f64;
        Self {
            settings,
            drawn,
            law: drawn.law,
            acting: effects.iter().map(acting).collect(),
            from: effects
                .iter()
                .map(|e| (e.from * sessions).ceil() as usize)
                .collect(),
        }
    }

    /// The same chain with other coefficients.
    pub fn with_law(mut self, law: Coefficients) -> Self {
        self.law = law;
        self
    }

    /// What the force sensor shows, noise aside, N.
    pub fn force(&self, place: &Place, departure: &Departure) -> f64 {
        let setup = &self.drawn.setups[place.setup];
        let muscle = &self.drawn.muscles[setup.muscle];
        let rest_length_m = 1e-3 * (muscle.rest_mm + departure.rest_mm);
        let f620_n = self.law.f620(rest_length_m);
        let pressure_rel = place.at.pressure_kpa / P_620_KPA;
        let common = self
            .drawn
            .misfit
            .common(setup.contraction_rel, pressure_rel);
        let misfit = self.drawn.sizes.common * common + departure.misfit;
        // A factor on F_620 is a factor on the force: none where the actuator is slack.
        let actuator = Actuator {
            surface: self.law.c,
            f620_n: f620_n * (1.0 + departure.gain) * (1.0 + misfit),
            diameter_mm: f64::from(DIAMETER_MM),
            rest_length_m,
            contracted_length_m: 1e-3 * (muscle.contracted_mm + departure.contracted_mm),
        };
        let length_m = 1e-3 * (setup.length_mm + departure.length_mm);
        let moment = self.moment(place, f620_n);
        let columns = self.columns(place.setup);
        self.chain(place.setup, actuator)
            .force(length_m, &moment, &columns)
            + departure.zero_n
    }

    /// What the pressure sensor makes of a pressure, kPa.
    pub fn sensed_pressure(&self, place: &Place, pressure_kpa: f64) -> f64 {
        let nothing = Actuator {
            surface: self.law.c,
            f620_n: 0.0,
            diameter_mm: f64::from(DIAMETER_MM),
            rest_length_m: 1.0,
            contracted_length_m: 0.8,
        };
        let columns = self.columns(place.setup);
        let moment = self.moment(place, 0.0);
        self.chain(place.setup, nothing)
            .sensed_pressure(pressure_kpa, &moment, &columns)
    }

    fn chain(&self, setup: usize, actuator: Actuator) -> Chain {
        let place = self.drawn.setups[setup].place;
        let acting = self.acting.iter().zip(&self.from);
        let acting = acting.filter(|(_, from)| place >= **from);
        Chain::new(actuator, acting.map(|(a, _)| *a).collect())
    }

    fn moment(&self, place: &Place, f620_n: f64) -> Moment {
        let setup = &self.drawn.setups[place.setup];
        Moment {
            place: setup.place as f64,
            cycle: (setup.own_place * self.settings.pace.runs() + place.run) as f64,
            own_cycle: place.run as f64,
            rest_length_m: 1e-3 * self.drawn.muscles[setup.muscle].rest_mm,
            contraction_rel: setup.contraction_rel,
            f620_n,
            axial_force_n: 0.0,
            at: place.at,
        }
    }

    /// The logged columns of a session.
    pub fn columns(&self, setup: usize) -> LogColumns {
        let levels = self.drawn.setups[setup].levels;
        let lines = levels.into_iter().zip(COLUMNS);
        LogColumns {
            lines: lines.map(|(level, (_, drift))| (level, drift)).collect(),
        }
    }
}

fn acting(put: &Put) -> Acting {
    let effect = effects::by_id(put.id).expect("an effect of the simulator");
    let named = effect.forms.iter().find(|f| f.name == put.form);
    let form = match put.form {
        "" => &effect.forms[0],
        name => named.unwrap_or_else(|| panic!("{} has no form {name}", put.id)),
    };
    let mut p = [0.0; MOST_PARAMETERS];
    for (value, parameter) in p.iter_mut().zip(form.parameters) {
        *value = parameter.default.unwrap_or(parameter.neutral);
    }
    p[0] = put.size;
    for (value, other) in p[1..].iter_mut().zip(put.others) {
        *value = *other;
    }
    let column = match effect.column {
        Column::Named(name) => COLUMNS.iter().position(|(c, _)| *c == name),
        Column::None | Column::Chosen => None,
    };
    Acting { form, p, column }
}
