//! Predicted forces and torques, one row a state or an angle. Not among the tables of a run.

use crate::described::*;
use pipeline_predict::Answer;
use pipeline_predict::design::{AtPoint, Design, Surety};
use pipeline_predict::torque::AtAngle;

/// Predicted force: a sweep or the designer's table, one row an answer.
#[rustfmt::skip]
pub fn force<'a>(answers: impl IntoIterator<Item = &'a Answer>) -> Table {
    Described::<&Answer>::new("prediction", "Predicted force")
        .count("diameter_mm", "⌀", Mm, |a| a.muscle.diameter_mm)
        .number("rest_length_mm", "l_{rest}", Mm, Decimals(1), |a| 1e3 * a.muscle.rest_length_m)
        .number("contraction_620", "ε_{620}", One, Decimals(3), |a| a.muscle.contraction_620)
        .number("pressure_kpa", "\\v{P}", KPa, Decimals(1), |a| a.pressure_kpa)
        .number("length_mm", "\\v{l}", Mm, Decimals(1), |a| 1e3 * a.length_m)
        .number("contraction", "ε", One, Decimals(4), |a| a.contraction)
        .number("contraction_rel", "ε*", One, Decimals(3), |a| a.contraction_rel)
        .value("force_n", "\\v{F}", N, estimate)
        .interval("interval_n", "95% interval", N, estimate)
        .text("warnings", "Outside", |a| a.warnings.join("; "))
        .rows(answers)
}

fn estimate(answer: &Answer) -> [Cell; 2] {
    match (answer.force_n, &answer.interval) {
        (Some(force), Some(i)) => Cell::with_interval(force, i.low_n, i.high_n),
        (force, _) => [Cell::number(force, Digits(4)), Cell::Empty],
    }
}

/// Predicted torque over the range of a knee, one row an angle.
#[rustfmt::skip]
pub fn torque(found: &[AtAngle]) -> Table {
    Described::<&AtAngle>::new("torque", "Predicted torque")
        .number("angle_deg", "Knee angle", Degree, Decimals(1), |a| a.angle_deg)
        .number("length_mm", "l_m", Mm, Decimals(1), |a| 1e3 * a.length_m)
        .number("contraction_rel", "ε*", One, Decimals(3), |a| a.contraction_rel)
        .number("arm_mm", "\\v{r}", Mm, Decimals(1), |a| 1e3 * a.arm_m)
        .number("force_n", "\\v{F}", N, Decimals(1), |a| a.force_n)
        .value("torque_nm", "\\v{M}", Nm, moment)
        .interval("interval_nm", "95% interval", Nm, moment)
        .number("human_nm", "Human", Nm, Decimals(2), |a| a.human_nm)
        .flag("meets", "Meets it", |a| a.meets)
        .text("warnings", "Outside", |a| a.warnings.join("; "))
        .rows(found)
}

fn moment(at: &AtAngle) -> [Cell; 2] {
    let rounding = Decimals(2);
    let interval = |(low, high)| Cell::Interval {
        low,
        high,
        rounding,
    };
    [
        Cell::number(at.torque_nm, rounding),
        at.interval_nm.map_or(Cell::Empty, interval),
    ]
}

/// Muscles of a design at every point of its curve, one row a diameter and point; `at`: name, unit and scale of the abscissa.
#[rustfmt::skip]
pub fn design(found: &[Design], (key, unit, scale): (&str, Unit, f64), of_curve: Unit, surety: Surety) -> Table {
    let rows = found.iter().flat_map(|d| d.points.iter().map(move |p| (d, p)));
    Described::<(&Design, &AtPoint)>::new("design", "Muscles that meet a curve")
        .count("diameter_mm", "⌀", Mm, |(d, _)| d.diameter_mm)
        .number("rest_length_mm", "l_{rest}", Mm, Decimals(1), |(d, _)| 1e3 * d.rest_length_m)
        .flag("meets", "Meets it", |(d, _)| d.meets)
        .number(key, "At", unit, Decimals(4), move |(_, p)| scale * p.point.at)
        .number("needed", "Needed", of_curve, Digits(4), |(_, p)| p.point.needed)
        .number("length_mm", "\\v{l}", Mm, Decimals(1), |(_, p)| 1e3 * p.length_m)
        .number("available", "Muscle", of_curve, Digits(4), |(_, p)| p.available)
        .number("low", "Lower end", of_curve, Digits(4), |(_, p)| p.low)
        .number("high", "Upper end", of_curve, Digits(4), |(_, p)| p.high)
        .number("margin", "Margin", of_curve, Digits(4), move |(_, p)| p.margin(surety))
        .text("warnings", "Outside", |(_, p)| p.warnings.join("; "))
        .rows(rows)
}
