//! The usual mistakes of recording, each taken back: which of them explains how far off a group is.

use super::READINGS;
use super::judged::Usual;
use super::least::least;
use super::seen::Seen;
use pipeline_effects::Conditions;
use pipeline_findings::{ErrorKind, Level};
use pipeline_inference::decisions::EXPLAINS;
use pipeline_numerics::statistics::{mean, standard_deviation};

/// Units that are taken for one another (lbf, kgf, psi, bar, and powers of ten), as factors; their inverses too.
pub(super) const UNITS: [f64; 6] = [4.448, 9.807, 6.895, 10.0, 100.0, 1000.0];

/// A change that takes a mistake back: of the conditions and of the measured force, by a number.
pub(super) type Change = fn(&mut Conditions, &mut f64, f64);

/// A mistake taken back.
#[derive(Clone, Copy)]
pub(super) struct Taken {
    pub(super) kind: ErrorKind,
    pub(super) quantity: Option<&'static str>,
    pub(super) unit: &'static str,
    pub(super) change: Change,
    pub(super) value: Option<f64>,
    /// How far off the group then is.
    off: f64,
    /// Log-likelihood, as of one reading.
    likelihood: f64,
}

impl Seen<'_> {
    /// The usual mistakes, each taken back.
    fn mistakes(&self) -> Vec<Taken> {
        match self.level {
            Level::Specimen => self.specimen_mistakes(),
            _ => self.session_mistakes(),
        }
    }

    /// How far off it is with the mistake taken back that leaves least.
    pub(super) fn least_off(&self) -> f64 {
        let all = self.mistakes().into_iter();
        all.map(|t| t.off).fold(f64::INFINITY, f64::min)
    }

    /// The likeliest of the mistakes that leave no more than is usual.
    pub(super) fn explanation(&self, usual: &Usual) -> Option<Taken> {
        let all = self.mistakes().into_iter();
        let most = EXPLAINS * usual.scale;
        all.filter(|t| t.off <= most)
            .max_by(|a, b| a.likelihood.total_cmp(&b.likelihood))
    }

    fn specimen_mistakes(&self) -> Vec<Taken> {
        let stroke = self.stroke_mm(&self.sessions[0].1);
        let rest: Change = |at, _, mm| at.rest_length_m += 1e-3 * mm;
        let contracted: Change = |at, _, mm| at.contracted_length_m += 1e-3 * mm;
        let both = [("rest_length", rest), ("contracted_length", contracted)];
        let lengths = both.map(|(quantity, change)| {
            self.number(ErrorKind::Length, quantity, "mm", change, stroke)
        });
        let mut all = lengths.to_vec();
        all.extend(self.of_columns());
        all
    }

    /// Another sign of the force, and other units of force and pressure.
    fn of_columns(&self) -> Vec<Taken> {
        let on_force: Change = |_, f, times| *f *= times;
        let on_pressure: Change = |at, _, times| at.pressure_kpa *= times;
        let given = |kind, quantity, change: Change, value: Option<f64>| {
            let x = value.unwrap_or(-1.0);
            let off = self.off_by(&|at, f| change(at, f, x), None);
            self.taken(kind, Some(quantity), "1", change, value, off)
        };
        let mut all = vec![given(ErrorKind::Sign, "force", on_force, None)];
        for times in UNITS.iter().flat_map(|u| [*u, 1.0 / u]) {
            let value = Some(times);
            all.push(given(ErrorKind::Unit, "force", on_force, value));
            all.push(given(ErrorKind::Unit, "pressure", on_pressure, value));
        }
        all
    }

    fn session_mistakes(&self) -> Vec<Taken> {
        let readings = &self.sessions[0].1;
        let largest = readings
            .iter()
            .map(|i| self.data.force[*i].abs())
            .fold(0.0, f64::max);
        let length: Change = |at, _, mm| at.length_m += 1e-3 * mm;
        let zero: Change = |_, f, n| *f += n;
        // What a session took off as the zero of its force was then that of its pressure.
        let swap: Change = |at, f, n| {
            std::mem::swap(&mut at.pressure_kpa, f);
            *f += n;
        };
        let (value, square) = self.at_best_length(readings, &|_, _| {}, self.factor, true);
        let mut all = vec![
            Taken {
                quantity: None,
                ..self.number(ErrorKind::SwappedColumns, "force", "N", swap, largest)
            },
            self.number(ErrorKind::Zero, "force", "N", zero, largest),
            self.taken(
                ErrorKind::Length,
                Some("length"),
                "mm",
                length,
                Some(value),
                square.sqrt(),
            ),
        ];
        all.extend(self.of_columns());
        all
    }

    /// A mistake of a number, at its best value within `most` of 0.
    fn number(
        &self,
        kind: ErrorKind,
        quantity: &'static str,
        unit: &'static str,
        change: Change,
        most: f64,
    ) -> Taken {
        let (value, off) = least((-most, most), READINGS, |x| {
            self.off_by(&|at, f| change(at, f, x), None)
        });
        self.taken(kind, Some(quantity), unit, change, Some(value), off)
    }

    /// A mistake with its likelihood: of the readings as they were recorded, so that a unit that makes all forces small gains nothing by
    /// it.
    fn taken(
        &self,
        kind: ErrorKind,
        quantity: Option<&'static str>,
        unit: &'static str,
        change: Change,
        value: Option<f64>,
        off: f64,
    ) -> Taken {
        let (mut recorded, mut corrected, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
        for i in self.sessions.iter().flat_map(|(_, readings)| readings) {
            let (mut at, mut force) = (self.data.conditions[*i], self.data.force[*i]);
            recorded.push(force);
            change(&mut at, &mut force, value.unwrap_or(-1.0));
            corrected.push(force);
            sizes.push(libm::log(self.usual_miss(force)));
        }
        let stretch = standard_deviation(&corrected) / standard_deviation(&recorded);
        Taken {
            kind,
            quantity,
            unit,
            change,
            value,
            off,
            likelihood: libm::log(stretch) - mean(&sizes) - 0.5 * off * off,
        }
    }
}
