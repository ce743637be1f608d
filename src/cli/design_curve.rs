//! The curve that a design has to meet, as a CSV file.

use pipeline_base::error::{Error, Result};
use pipeline_predict::design::Point;
use pipeline_report::table::Unit;
use std::path::Path;

/// What stands in a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantities {
    /// Force, N, against contraction.
    Contraction,
    /// Force, N, against the shortening from the resting length, m (mm in the file).
    Travel,
    /// Torque, N.m, against the angle, degrees.
    Angle,
}

/// Headers of a curve, and the factor of their first column.
const HEADERS: [(&str, Quantities, f64); 3] = [
    ("contraction,force_n", Quantities::Contraction, 1.0),
    ("travel_mm,force_n", Quantities::Travel, 1e-3),
    ("angle_deg,torque_nm", Quantities::Angle, 1.0),
];

/// A curve.
pub struct Read {
    /// What it is of.
    pub quantities: Quantities,
    /// Its points, in the order of the file.
    pub points: Vec<Point>,
}

impl Read {
    /// Unit of what is needed.
    pub fn unit(&self) -> &'static str {
        match self.quantities {
            Quantities::Angle => "N.m",
            _ => "N",
        }
    }

    /// The abscissa for people.
    pub fn label(&self) -> String {
        match self.quantities {
            Quantities::Contraction => "contraction (%)",
            Quantities::Travel => "travel (mm)",
            Quantities::Angle => "angle (deg)",
        }
        .to_owned()
    }

    /// The factor from the inside unit to that of [`Self::label`].
    pub fn scale(&self) -> f64 {
        match self.quantities {
            Quantities::Contraction => 100.0,
            Quantities::Travel => 1e3,
            Quantities::Angle => 1.0,
        }
    }

    /// The column of the abscissa in a table: name, unit, and factor from the inside unit.
    pub fn column(&self) -> (&'static str, Unit, f64) {
        match self.quantities {
            Quantities::Contraction => ("contraction", Unit::One, 1.0),
            Quantities::Travel => ("travel_mm", Unit::Mm, 1e3),
            Quantities::Angle => ("angle_deg", Unit::Degree, 1.0),
        }
    }

    /// The unit of what is needed in a table.
    pub fn needed(&self) -> Unit {
        match self.quantities {
            Quantities::Angle => Unit::Nm,
            _ => Unit::N,
        }
    }

    /// A value of the abscissa for people.
    pub fn shown(&self, at: f64) -> String {
        format!("{:.1}", self.scale() * at)
    }
}

/// Reads a curve.
///
/// # Errors
/// A file that cannot be read, another header, a row that is no pair of numbers, forces that are no demand.
pub fn read(file: &Path) -> Result<Read> {
    let text = std::fs::read_to_string(file).map_err(Error::io("read", file))?;
    let mut lines = text
        .lines()
        .enumerate()
        .filter(|(_, l)| !l.trim().is_empty());
    let (_, head) = lines.next().unwrap_or((0, ""));
    let head: String = head.chars().filter(|c| !c.is_whitespace()).collect();
    let known = HEADERS.iter().find(|(header, ..)| *header == head);
    let Some((_, quantities, factor)) = known else {
        let headers = HEADERS.map(|(header, ..)| format!("\"{header}\""));
        return Err(Error::Usage(format!(
            "{}:1: the header is \"{head}\"; it must be one of {}",
            file.display(),
            headers.join(", ")
        )));
    };
    let points: Vec<Point> = lines
        .map(|(k, line)| point(file, k + 1, line, (*quantities, *factor)))
        .collect::<Result<_>>()?;
    if points.iter().all(|p| p.needed == 0.0) {
        return Err(Error::Usage(format!(
            "{} requires nothing: at least one row needs a force or torque other than zero",
            file.display()
        )));
    }
    Ok(Read {
        quantities: *quantities,
        points,
    })
}

fn point(file: &Path, line: usize, text: &str, (of, factor): (Quantities, f64)) -> Result<Point> {
    let numbers: Vec<Option<f64>> = text
        .split(',')
        .map(|cell| cell.trim().parse().ok().filter(|x: &f64| x.is_finite()))
        .collect();
    match numbers[..] {
        [Some(_), Some(needed)] if needed < 0.0 && of != Quantities::Angle => {
            Err(Error::Usage(format!(
                "{}:{line}: found a force of {needed} N, but a muscle cannot push: give the tension, 0 or more",
                file.display()
            )))
        }
        [Some(at), Some(needed)] => Ok(Point {
            at: factor * at,
            needed,
        }),
        _ => Err(Error::Usage(format!(
            "{}:{line}: found \"{text}\", expected two numbers with a comma between them",
            file.display()
        ))),
    }
}
