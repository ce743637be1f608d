//! A digitised force table as a surface: monotone along each isobar, linear across isobars, nothing beyond its hull.
//!
//! Along an isobar the force is a monotone cubic in contraction ([`MonotoneCubic`]); between two isobars it is linear in
//! pressure at equal contraction, which is how braided actuators behave (force paper, text before Eq. 8).
//!
//! The isobars of a table end at different contractions, because the curves were read until the force ran out. The hull between
//! two neighbouring isobars is the quadrilateral of their ends: its sides are the straight lines, in the plane of contraction and
//! pressure, that join the two starts and the two ends, and along a side the force is linear between the end points' forces. At a
//! contraction beyond the end of the lower isobar but inside the upper one, the hull is entered where that line crosses the
//! contraction, at some pressure in between: above it the force is linear in pressure from the side's force to the upper
//! isobar's; below it there is no answer, because the manufacturer's curve has run out and its zero is not tabulated. The
//! surface is continuous, and passes through every point of the table.

use pipeline_numerics::interpolate::MonotoneCubic;

/// A pair (contraction, gauge pressure in kPa) at the very rim of the table may miss it by rounding, and is then taken as on it.
const ROUNDING: f64 = 1e-9;

/// Force against contraction at one gauge pressure.
#[derive(Clone, Debug)]
struct Isobar {
    pressure_kpa: f64,
    curve: MonotoneCubic,
}

/// A point of the table's plane at a given contraction.
#[derive(Clone, Copy, Debug)]
struct Point {
    pressure_kpa: f64,
    force_n: f64,
}

/// What a table says about a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lookup {
    /// The force, N; negative where the curve is one of pushing.
    Force(f64),
    /// The contraction lies outside the hull at this pressure.
    BeyondContraction {
        /// Smallest contraction at this pressure.
        low: f64,
        /// Largest contraction at this pressure.
        high: f64,
    },
    /// The pressure lies outside the table.
    BeyondPressure {
        /// Lowest pressure, kPa.
        low: f64,
        /// Highest pressure, kPa.
        high: f64,
    },
}

/// A table of isobars in order of pressure.
#[derive(Clone, Debug)]
pub(super) struct FestoTable {
    isobars: Vec<Isobar>,
}

impl FestoTable {
    /// The table in CSV text with the columns contraction, pressure_kpa, force_n, sorted by pressure, then contraction. Lines
    /// that are not three numbers (the header) and isobars that are no curve are left out.
    pub(super) fn parse(csv: &str) -> Self {
        let rows: Vec<[f64; 3]> = csv.lines().filter_map(row).collect();
        let isobars = rows
            .chunk_by(|a, b| a[1] == b[1])
            .filter_map(|rows| {
                let contraction: Vec<f64> = rows.iter().map(|r| r[0]).collect();
                let force: Vec<f64> = rows.iter().map(|r| r[2]).collect();
                Some(Isobar {
                    pressure_kpa: rows[0][1],
                    curve: MonotoneCubic::new(&contraction, &force).ok()?,
                })
            })
            .collect();
        Self { isobars }
    }

    /// The force at a contraction (fraction) and gauge pressure in kPa.
    pub(super) fn force(&self, contraction: f64, pressure_kpa: f64) -> Lookup {
        let (Some(first), Some(last)) = (self.isobars.first(), self.isobars.last()) else {
            return Lookup::BeyondPressure {
                low: 0.0,
                high: 0.0,
            };
        };
        let (low, high) = (first.pressure_kpa, last.pressure_kpa);
        if !(low - ROUNDING..=high + ROUNDING).contains(&pressure_kpa) {
            return Lookup::BeyondPressure { low, high };
        }
        let pressure = pressure_kpa.clamp(low, high);
        let above = self.isobars.partition_point(|i| i.pressure_kpa <= pressure);
        let above = above.min(self.isobars.len() - 1);
        let upper = &self.isobars[above];
        let lower = &self.isobars[above.saturating_sub(1)];
        between(lower, upper, contraction, pressure)
    }
}

/// Three numbers of a line.
fn row(line: &str) -> Option<[f64; 3]> {
    let mut fields = line
        .split(',')
        .map(|field| field.trim().parse::<f64>().ok());
    Some([fields.next()??, fields.next()??, fields.next()??])
}

/// `a` at fraction 0, `b` at fraction 1.
fn blend(a: f64, b: f64, fraction: f64) -> f64 {
    (1.0 - fraction) * a + fraction * b
}

/// The force between two neighbouring isobars.
fn between(lower: &Isobar, upper: &Isobar, contraction: f64, pressure: f64) -> Lookup {
    let span = upper.pressure_kpa - lower.pressure_kpa;
    let fraction = if span > 0.0 {
        (pressure - lower.pressure_kpa) / span
    } else {
        0.0
    };
    let low = blend(lower.curve.first().0, upper.curve.first().0, fraction);
    let high = blend(lower.curve.last().0, upper.curve.last().0, fraction);
    if !(low - ROUNDING..=high + ROUNDING).contains(&contraction) {
        return Lookup::BeyondContraction { low, high };
    }
    let contraction = contraction.clamp(low, high);
    let below = on(lower, contraction).or_else(|| side(lower, upper, contraction));
    let above = on(upper, contraction).or_else(|| side(lower, upper, contraction));
    match (below, above) {
        (Some(a), Some(b)) => Lookup::Force(along(a, b, pressure)),
        _ => Lookup::BeyondContraction { low, high },
    }
}

/// The point of an isobar at a contraction.
fn on(isobar: &Isobar, contraction: f64) -> Option<Point> {
    let force_n = isobar.curve.value(contraction)?;
    Some(Point {
        pressure_kpa: isobar.pressure_kpa,
        force_n,
    })
}

/// Where the hull's side crosses a contraction that only one of the two isobars reaches.
fn side(lower: &Isobar, upper: &Isobar, contraction: f64) -> Option<Point> {
    let (l, u) = (&lower.curve, &upper.curve);
    let starts = (l.first().0, u.first().0, l.first().1, u.first().1);
    let ends = (l.last().0, u.last().0, l.last().1, u.last().1);
    [starts, ends]
        .into_iter()
        .find_map(|(from, to, force_from, force_to)| {
            let fraction = (contraction - from) / (to - from);
            (0.0..=1.0).contains(&fraction).then(|| Point {
                pressure_kpa: blend(lower.pressure_kpa, upper.pressure_kpa, fraction),
                force_n: blend(force_from, force_to, fraction),
            })
        })
}

/// Linear in pressure between two points of equal contraction.
fn along(a: Point, b: Point, pressure: f64) -> f64 {
    let span = b.pressure_kpa - a.pressure_kpa;
    let fraction = if span > 0.0 {
        (pressure - a.pressure_kpa) / span
    } else {
        0.0
    };
    blend(a.force_n, b.force_n, fraction.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two isobars that are straight lines; the lower one runs out at 0.1.
    const SMALL: &str = "contraction,pressure_kpa,force_n\n0,100,100\n0.1,100,0\n0,200,200\n0.1,200,100\n0.2,200,0\n";

    #[test]
    fn linear_tables_are_reproduced_inside_both_isobars() {
        let table = FestoTable::parse(SMALL);
        for (contraction, pressure, force) in
            [(0.05, 150.0, 100.0), (0.0, 100.0, 100.0), (0.2, 200.0, 0.0)]
        {
            match table.force(contraction, pressure) {
                Lookup::Force(found) => assert!((found - force).abs() < 1e-9),
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn beyond_the_lower_isobar_the_hull_ends_on_the_line_between_the_ends() {
        let table = FestoTable::parse(SMALL);
        // The side crosses a contraction of 0.15 at 150 kPa, where both end forces are zero; the upper isobar has 50 N there.
        assert_eq!(table.force(0.15, 150.0), Lookup::Force(0.0));
        let Lookup::Force(half) = table.force(0.15, 175.0) else {
            panic!()
        };
        assert!((half - 25.0).abs() < 1e-9);
        let Lookup::BeyondContraction { low, high } = table.force(0.15, 140.0) else {
            panic!()
        };
        assert!(low == 0.0 && (high - 0.14).abs() < 1e-12);
    }

    #[test]
    fn pressures_outside_the_table_are_refused() {
        let table = FestoTable::parse(SMALL);
        let beyond = Lookup::BeyondPressure {
            low: 100.0,
            high: 200.0,
        };
        assert_eq!(table.force(0.0, 99.0), beyond);
        assert_eq!(table.force(0.0, 201.0), beyond);
        assert_eq!(table.force(0.0, f64::NAN), beyond);
        let empty = FestoTable::parse("nothing");
        assert!(matches!(
            empty.force(0.0, 0.0),
            Lookup::BeyondPressure { .. }
        ));
    }
}
