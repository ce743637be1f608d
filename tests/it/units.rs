//! Properties of units and calibrations over many drawn values: what goes in comes out, in order, and evenly.

use crate::fuzz::mutate::Draw;
use pipeline::base::columns::KNOWN;
use pipeline::base::session::{ColumnSpec, Session};
use pipeline::base::units::{Quantity, UNITS, Unit};
use pipeline::formats::session_toml;

const DRAWS: u64 = 2000;

/// Numbers over the magnitudes that logs hold, of both signs.
fn value(draw: &mut Draw) -> f64 {
    let mantissa = draw.below(2_000_001) as f64 / 1e6 - 1.0;
    mantissa * libm::pow(10.0, draw.below(13) as f64 - 4.0)
}

fn each_unit(check: impl Fn(Unit, f64, f64)) {
    for (k, unit) in UNITS.iter().enumerate() {
        for case in 0..DRAWS {
            let mut draw = Draw::of_case(k as u64, case);
            check(*unit, value(&mut draw), value(&mut draw));
        }
    }
}

/// Rounding of a few operations, relative to the largest number that takes part.
fn near(a: f64, b: f64, largest: f64) -> bool {
    (a - b).abs() <= 8.0 * f64::EPSILON * largest.abs().max(b.abs())
}

#[test]
fn every_unit_converts_to_the_inside_and_back() {
    each_unit(|unit, x, _| {
        let offset = unit.from_inside(0.0).abs();
        let back = unit.from_inside(unit.to_inside(x));
        assert!(
            near(back, x, x.abs() + offset),
            "{} {x} {back}",
            unit.symbol
        );
    });
}

#[test]
fn every_unit_keeps_order_and_steps() {
    each_unit(|unit, x, y| {
        let (a, b) = (unit.to_inside(x), unit.to_inside(y));
        assert_eq!(x < y, a < b, "{} {x} {y}", unit.symbol);
        let zero = unit.to_inside(0.0);
        let sum = unit.to_inside(x + y);
        let largest = a.abs() + b.abs() + zero.abs();
        assert!(
            near(a - zero + (b - zero), sum - zero, largest),
            "{} {x} {y}",
            unit.symbol
        );
    });
}

#[test]
fn only_temperatures_have_an_offset_and_their_fixed_points_agree() {
    for unit in UNITS {
        let is_plain = unit.to_inside(0.0) == 0.0;
        let expected = unit.quantity != Quantity::Temperature || unit.symbol == "C";
        assert_eq!(is_plain, expected, "{}", unit.symbol);
    }
    for (symbol, ice, steam, zero) in [
        ("C", 0.0, 100.0, -273.15),
        ("K", 273.15, 373.15, 0.0),
        ("F", 32.0, 212.0, -459.67),
    ] {
        let unit = Quantity::Temperature.unit(symbol).unwrap();
        for (x, celsius) in [(ice, 0.0), (steam, 100.0), (zero, -273.15)] {
            assert!((unit.to_inside(x) - celsius).abs() < 1e-10, "{symbol} {x}");
        }
    }
}

#[test]
fn the_unit_used_inside_is_the_first_of_its_quantity_and_changes_nothing() {
    for known in KNOWN {
        let Some(quantity) = known.quantity else {
            continue;
        };
        let inside = quantity.units().next().unwrap();
        for case in 0..DRAWS {
            let x = value(&mut Draw::of_case(7, case));
            assert_eq!(
                (inside.to_inside(x), inside.from_inside(x)),
                (x, x),
                "{}",
                inside.symbol
            );
        }
    }
}

/// The column of a session whose force has this calibration.
fn calibrated(unit: &str, gain: f64, offset: f64) -> ColumnSpec {
    let text = format!(
        r#"schema = "bpa-session/1"
id = "calibration"
kind = "isometric"
sampling = "points"
campaign = "c"
[specimen]
id = "s"
diameter_mm = 10
rest_length_mm = 182
contracted_length_mm = 152
[setup]
length_mm = 180
[columns]
force = {{ index = 0, unit = "{unit}", gain = {gain:?}, offset = {offset:?}, saturation_low = {offset:?} }}
pressure = {{ index = 1, unit = "kPa" }}
[[log]]
file = "a.csv"
"#
    );
    let session: Session =
        session_toml::read("session.toml", &text).unwrap_or_else(|d| panic!("{d:?}"));
    session.column("force_n").unwrap().clone()
}

#[test]
fn a_calibration_is_gain_and_offset_in_the_unit_and_can_be_undone() {
    for unit in Quantity::Force.units() {
        for case in 0..DRAWS / 20 {
            let mut draw = Draw::of_case(11, case);
            let (gain, offset, counts) =
                (value(&mut draw), value(&mut draw), draw.below(4096) as f64);
            if gain == 0.0 {
                continue;
            }
            let column = calibrated(unit.symbol, gain, offset);
            let inside = column.factor * counts + column.constant;
            let expected = unit.to_inside(gain * counts + offset);
            let largest = unit.to_inside((gain * counts).abs() + offset.abs());
            assert!(
                near(inside, expected, largest),
                "{} {gain} {offset} {counts}",
                unit.symbol
            );
            let undone = (inside - column.constant) / column.factor;
            let lost = largest / column.factor.abs();
            assert!(
                near(undone, counts, lost),
                "{} {gain} {offset} {counts} {undone}",
                unit.symbol
            );
            let more = column.factor * (counts + 1.0) + column.constant;
            let rises = (more - inside).abs() <= 4.0 * f64::EPSILON * largest
                || (more > inside) == (gain > 0.0);
            assert!(rises, "monotone in the sign of the gain: {gain} {offset}");
            let limit = column.saturation_low.unwrap();
            assert!(
                near(limit, unit.to_inside(offset), limit),
                "0 counts are the limit"
            );
        }
    }
}
