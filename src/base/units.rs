//! Units on input, and the one unit per quantity inside.
//!
//! Inside the pipeline a force is in N, a gauge pressure in kPa, a length in m, an angle in rad, a time in s, a torque in N.m and a
//! temperature in degrees Celsius; everything that enters is converted on reading, once, here. The factors are exact by definition
//! (international yard and pound 1959; standard gravity 9.80665 m/s2, CGPM 1901).

/// A physical quantity with one unit inside the pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Inside: N.
    Force,
    /// Inside: kPa, gauge.
    Pressure,
    /// Inside: m.
    Length,
    /// Inside: rad.
    Angle,
    /// Inside: s.
    Time,
    /// Inside: N.m.
    Torque,
    /// Inside: degrees Celsius.
    Temperature,
}

/// A unit that may stand in a `session.toml`: inside = `factor * value + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// As it is written in `session.toml`.
    pub symbol: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    factor: f64,
    offset: f64,
}

const POUND_FORCE: f64 = 0.453_592_37 * 9.806_65;
const INCH: f64 = 0.0254;

const fn unit(symbol: &'static str, quantity: Quantity, factor: f64, offset: f64) -> Unit {
    Unit {
        symbol,
        quantity,
        factor,
        offset,
    }
}

/// Every unit that is understood, grouped by quantity; the first of a group is the one used inside.
pub const UNITS: &[Unit] = &[
    unit("N", Quantity::Force, 1.0, 0.0),
    unit("kN", Quantity::Force, 1000.0, 0.0),
    unit("lbf", Quantity::Force, POUND_FORCE, 0.0),
    unit("kgf", Quantity::Force, 9.806_65, 0.0),
    unit("kPa", Quantity::Pressure, 1.0, 0.0),
    unit("Pa", Quantity::Pressure, 1e-3, 0.0),
    unit("MPa", Quantity::Pressure, 1000.0, 0.0),
    unit("bar", Quantity::Pressure, 100.0, 0.0),
    unit(
        "psi",
        Quantity::Pressure,
        POUND_FORCE / (INCH * INCH) / 1000.0,
        0.0,
    ),
    unit("m", Quantity::Length, 1.0, 0.0),
    unit("cm", Quantity::Length, 0.01, 0.0),
    unit("mm", Quantity::Length, 0.001, 0.0),
    unit("in", Quantity::Length, INCH, 0.0),
    unit("rad", Quantity::Angle, 1.0, 0.0),
    unit("deg", Quantity::Angle, std::f64::consts::PI / 180.0, 0.0),
    unit("s", Quantity::Time, 1.0, 0.0),
    unit("ms", Quantity::Time, 0.001, 0.0),
    unit("min", Quantity::Time, 60.0, 0.0),
    unit("N.m", Quantity::Torque, 1.0, 0.0),
    unit("lbf.in", Quantity::Torque, POUND_FORCE * INCH, 0.0),
    unit("lbf.ft", Quantity::Torque, POUND_FORCE * INCH * 12.0, 0.0),
    unit("C", Quantity::Temperature, 1.0, 0.0),
    unit("F", Quantity::Temperature, 5.0 / 9.0, -32.0 * 5.0 / 9.0),
    unit("K", Quantity::Temperature, 1.0, -273.15),
];

impl Unit {
    /// The value in the unit used inside.
    ///
    /// Written so that a unit with no offset multiplies only: 182 mm becomes exactly 182 * 0.001 m.
    pub fn to_inside(self, value: f64) -> f64 {
        if self.offset == 0.0 {
            value * self.factor
        } else {
            value * self.factor + self.offset
        }
    }

    /// A value inside, written in this unit: the inverse of [`Unit::to_inside`].
    pub fn from_inside(self, value: f64) -> f64 {
        (value - self.offset) / self.factor
    }
}

impl Quantity {
    /// The quantity's units, the one used inside first.
    pub fn units(self) -> impl Iterator<Item = Unit> {
        UNITS.iter().copied().filter(move |u| u.quantity == self)
    }

    /// The unit of this quantity that is written `symbol`, if there is one.
    pub fn unit(self, symbol: &str) -> Option<Unit> {
        self.units().find(|u| u.symbol == symbol)
    }

    /// The unit in which people usually type it.
    pub fn usual(self) -> &'static str {
        match self {
            Self::Force => "N",
            Self::Pressure => "kPa",
            Self::Length => "mm",
            Self::Angle => "deg",
            Self::Time => "s",
            Self::Torque => "N.m",
            Self::Temperature => "C",
        }
    }

    /// The units of this quantity as a list for a message: "N, kN, lbf, kgf".
    pub fn list_of_units(self) -> String {
        let symbols: Vec<&str> = self.units().map(|u| u.symbol).collect();
        symbols.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inside(quantity: Quantity, symbol: &str, value: f64) -> f64 {
        quantity.unit(symbol).expect(symbol).to_inside(value)
    }

    #[test]
    fn factors_are_the_defined_ones() {
        let near = |a: f64, b: f64| assert!((a - b).abs() <= 1e-12 * b.abs(), "{a} {b}");
        near(inside(Quantity::Force, "lbf", 1.0), 4.448_221_615_260_5);
        near(
            inside(Quantity::Pressure, "psi", 1.0),
            6.894_757_293_168_361,
        );
        near(inside(Quantity::Pressure, "bar", 6.2), 620.0);
        near(
            inside(Quantity::Torque, "lbf.ft", 1.0),
            1.355_817_948_331_400_4,
        );
        near(inside(Quantity::Temperature, "F", 68.0), 20.0);
        near(inside(Quantity::Temperature, "K", 294.15), 21.0);
        near(inside(Quantity::Angle, "deg", 180.0), std::f64::consts::PI);
    }

    #[test]
    fn every_unit_inverts_and_belongs_to_one_quantity() {
        for u in UNITS {
            let back = u.from_inside(u.to_inside(12.5));
            assert!((back - 12.5).abs() < 1e-12, "{}", u.symbol);
            let owners = UNITS.iter().filter(|v| v.symbol == u.symbol).count();
            assert_eq!(owners, 1, "{} stands twice", u.symbol);
        }
    }
}
