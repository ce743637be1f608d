//! The settings of the simulated rig: table `[rig]` of a truth file, every key optional.
//!
//! The defaults are what was read off the real logs (`isometric-10mm-2022-11`, `isometric-20mm-2022-01`): one set for each of the
//! two rigs. No 40 mm rig has been seen; it gets the 20 mm rig with a coarser force channel.

use pipeline_base::toml_reader::{Entry, Section};
use serde::Serialize;

/// In which unit the logs hold force and pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LogUnit {
    /// N and kPa, five digits.
    Physical,
    /// Counts of the 10-bit converter; gain and offset stand in `session.toml`.
    Counts,
}

/// Everything about the rig that is not the actuator.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rig {
    /// In which unit the logs hold force and pressure.
    pub log_unit: LogUnit,
    /// Rows of a measuring log.
    pub rows: usize,
    /// Rows of the zero log.
    pub zero_rows: usize,
    /// Mean sampling interval, ms (of a row whose numbers have ten digits together).
    pub interval_ms: f64,
    /// Share of the rows before the venting begins.
    pub filling: f64,
    /// Pressure that filling approaches, kPa, and its standard deviation from session to session.
    pub supply_kpa: f64,
    /// See `supply_kpa`.
    pub supply_sd_kpa: f64,
    /// Pressure that venting approaches, kPa, and its standard deviation from session to session.
    pub floor_kpa: f64,
    /// See `floor_kpa`.
    pub floor_sd_kpa: f64,
    /// Share of the distance to the supply that one opening of the valve covers, at zero pressure and run speed 1.
    pub fill_share: f64,
    /// Share of the distance to the floor that one opening of the valve covers.
    pub vent_share: f64,
    /// Relative standard deviation of what an opening lets through.
    pub valve_jitter: f64,
    /// Largest overshoot of the pressure sensor at a step, kPa.
    pub overshoot_kpa: f64,
    /// Share of a step that is lost again while the air takes the wall's temperature.
    pub relaxation: f64,
    /// Time constant of that, s.
    pub relaxation_s: f64,
    /// Relative loss of pressure through leaks, 1/s.
    pub leak_per_s: f64,
    /// Step of the force converter, N.
    pub force_quantum_n: f64,
    /// Force at 0 counts, at which the amplifier clips, N.
    pub force_clip_n: f64,
    /// Step of the pressure converter, kPa.
    pub pressure_quantum_kpa: f64,
    /// Pressure at 0 counts, kPa.
    pub pressure_clip_kpa: f64,
    /// Standard deviation of a single force sample, N.
    pub force_noise_n: f64,
    /// Standard deviation of a single pressure sample, kPa.
    pub pressure_noise_kpa: f64,
    /// Mean of the force channel's zero, N, and its standard deviation from session to session.
    pub zero_mean_n: f64,
    /// See `zero_mean_n`.
    pub zero_sd_n: f64,
    /// What the pressure sensor shows without pressure, kPa. Other than 0 it is an error that no file declares.
    pub pressure_zero_kpa: f64,
    /// Relative standard deviation of a specimen's gain.
    pub specimen_scatter: f64,
}

/// A number of the table, under the name of its field.
macro_rules! number {
    ($rig:ident, $key:ident, $low:expr, $high:expr, $unit:expr) => {
        (stringify!($key), &mut $rig.$key, ($low, $high), $unit)
    };
}

impl Rig {
    /// The rig that measured actuators of this diameter.
    pub fn for_diameter(diameter_mm: u32) -> Self {
        match diameter_mm {
            10 => Self::rig_10mm(),
            20 => Self::rig_20mm(),
            _ => Self {
                force_quantum_n: 7.0,
                force_clip_n: -70.0,
                force_noise_n: 9.0,
                zero_sd_n: 24.0,
                ..Self::rig_20mm()
            },
        }
    }

    fn rig_10mm() -> Self {
        Self {
            log_unit: LogUnit::Physical,
            rows: 15_000,
            zero_rows: 15_000,
            interval_ms: 1.87,
            filling: 0.5165,
            supply_kpa: 624.0,
            supply_sd_kpa: 1.5,
            floor_kpa: 73.0,
            floor_sd_kpa: 1.0,
            fill_share: 0.137,
            vent_share: 0.275,
            valve_jitter: 0.12,
            overshoot_kpa: 33.0,
            relaxation: 0.03,
            relaxation_s: 0.3,
            leak_per_s: 0.0,
            force_quantum_n: 0.6831,
            force_clip_n: -8.7354,
            pressure_quantum_kpa: 0.7654,
            pressure_clip_kpa: -18.609,
            force_noise_n: 0.9,
            pressure_noise_kpa: 0.22,
            zero_mean_n: 4.0,
            zero_sd_n: 6.0,
            pressure_zero_kpa: 0.0,
            specimen_scatter: 0.02,
        }
    }

    fn rig_20mm() -> Self {
        Self {
            log_unit: LogUnit::Counts,
            rows: 29_000,
            zero_rows: 29_000,
            filling: 0.5585,
            supply_kpa: 640.0,
            supply_sd_kpa: 3.0,
            floor_kpa: 82.0,
            fill_share: 0.04,
            vent_share: 0.13,
            valve_jitter: 0.2,
            overshoot_kpa: 5.0,
            relaxation: 0.3,
            relaxation_s: 0.35,
            leak_per_s: 0.0005,
            force_quantum_n: 1.7444,
            force_clip_n: -18.59477,
            force_noise_n: 2.0,
            zero_mean_n: 5.0,
            zero_sd_n: 8.0,
            ..Self::rig_10mm()
        }
    }

    /// The table `[rig]` over the defaults of the diameter; mistakes are recorded in the section's reader.
    pub fn read(table: &Section, diameter_mm: u32) -> Self {
        let mut rig = Self::for_diameter(diameter_mm);
        let units = [("physical", LogUnit::Physical), ("counts", LogUnit::Counts)];
        if let Some(unit) = table.get("log_unit").and_then(|e| e.choice(&units)) {
            rig.log_unit = unit;
        }
        for (key, slot) in [("rows", &mut rig.rows), ("zero_rows", &mut rig.zero_rows)] {
            let hint = "a real log has 15000 or 29000";
            let rows = table
                .get(key)
                .filter(|e| e.integer().is_some())
                .and_then(|e| within(&e, 100.0, 200_000.0, "rows", hint));
            *slot = rows.map_or(*slot, |rows| rows as usize);
        }
        for (key, slot, (low, high), unit) in rig.numbers() {
            let number = table
                .get(key)
                .and_then(|e| within(&e, low, high, unit, "leave it out for the rig's own value"));
            *slot = number.unwrap_or(*slot);
        }
        table.close();
        rig
    }

    /// Every number of the table as it may be written: key, smallest and largest value, unit.
    pub fn ranges() -> Vec<(&'static str, (f64, f64), &'static str)> {
        let mut rig = Self::rig_10mm();
        let all = rig.numbers().into_iter();
        all.map(|(key, _, range, unit)| (key, range, unit))
            .collect()
    }

    /// Every number of the table: key, place, smallest and largest value, unit.
    fn numbers(&mut self) -> [(&'static str, &mut f64, (f64, f64), &'static str); 23] {
        [
            number!(self, interval_ms, 1.0, 10.0, "ms"),
            number!(self, filling, 0.05, 1.0, "1"),
            number!(self, supply_kpa, 50.0, 740.0, "kPa"),
            number!(self, supply_sd_kpa, 0.0, 10.0, "kPa"),
            number!(self, floor_kpa, 0.0, 300.0, "kPa"),
            number!(self, floor_sd_kpa, 0.0, 10.0, "kPa"),
            number!(self, fill_share, 0.001, 0.9, "1"),
            number!(self, vent_share, 0.001, 0.9, "1"),
            number!(self, valve_jitter, 0.0, 0.5, "1"),
            number!(self, overshoot_kpa, 0.0, 100.0, "kPa"),
            number!(self, relaxation, 0.0, 0.6, "1"),
            number!(self, relaxation_s, 0.01, 10.0, "s"),
            number!(self, leak_per_s, 0.0, 0.2, "1/s"),
            number!(self, force_quantum_n, 1e-6, 50.0, "N"),
            number!(self, force_clip_n, -2000.0, 0.0, "N"),
            number!(self, pressure_quantum_kpa, 0.01, 10.0, "kPa"),
            number!(self, pressure_clip_kpa, -200.0, 0.0, "kPa"),
            number!(self, force_noise_n, 0.0, 200.0, "N"),
            number!(self, pressure_noise_kpa, 0.0, 50.0, "kPa"),
            number!(self, zero_mean_n, -200.0, 200.0, "N"),
            number!(self, zero_sd_n, 0.0, 200.0, "N"),
            number!(self, pressure_zero_kpa, -50.0, 50.0, "kPa"),
            number!(self, specimen_scatter, 0.0, 0.3, "1"),
        ]
    }
}

/// The number if it lies in a closed range, or a recorded mistake.
pub fn within(entry: &Entry, low: f64, high: f64, unit: &str, hint: &str) -> Option<f64> {
    let number = entry.number()?;
    if (low..=high).contains(&number) {
        return Some(number);
    }
    entry.reject(&format!("a number from {low} to {high} ({unit})"), hint);
    None
}
