//! The human muscles over the knee, one by one and as the groups that actuators stand for.

use super::description::Knee;

/// The three heads of vasti that cross the knee alone.
pub const VASTI: [&str; 3] = ["vas_int", "vas_lat", "vas_med"];

/// The names that [`heads`] knows.
pub const NAMES: [&str; 5] = ["bifemsh", "vasti", "vas_int", "vas_lat", "vas_med"];

/// The routes of Gait2392 that a name stands for; none for a name that it does not have.
pub fn heads(name: &str) -> Option<&'static [&'static str]> {
    match name {
        "vasti" => Some(&VASTI),
        "bifemsh" => Some(&["bifemsh"]),
        _ => VASTI.iter().position(|m| *m == name).map(|k| &VASTI[k..=k]),
    }
}

/// The torque of human muscles at full activation at an angle in rad, N.m, positive in extension; none beyond the knee's range, or of a
/// muscle that the knee does not have.
pub fn torque(knee: &Knee, heads: &[&str], angle: f64) -> Option<f64> {
    let one = |muscle: &&str| {
        let (leg, hill) = (knee.leg(muscle)?, knee.muscle(muscle)?);
        leg.muscle_torque(hill, angle).ok()
    };
    heads.iter().map(one).sum()
}

/// Whether a torque has the sign of the human's and at least its size.
pub fn meets(torque: f64, human: f64) -> bool {
    torque * human.signum() >= human.abs()
}

/// The stretches of angle in which a torque meets the human's, as first and last angle in the unit of the angles; a torque that is not known
/// meets nothing.
pub fn met(angles: &[f64], human: &[f64], torques: &[Option<f64>]) -> Vec<(f64, f64)> {
    let mut stretches: Vec<(f64, f64)> = Vec::new();
    let mut open = false;
    for ((angle, human), torque) in angles.iter().zip(human).zip(torques) {
        let enough = torque.is_some_and(|t| meets(t, *human));
        match (enough, stretches.last_mut()) {
            (true, Some(last)) if open => last.1 = *angle,
            (true, _) => stretches.push((*angle, *angle)),
            (false, _) => {}
        }
        open = enough;
    }
    stretches
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_end_where_the_torque_falls_short_or_is_unknown() {
        let human = [-1.0, -2.0, -3.0, -4.0, -5.0];
        let torques = [Some(-1.0), Some(-2.5), Some(3.0), None, Some(-6.0)];
        let found = met(&[0.0, 1.0, 2.0, 3.0, 4.0], &human, &torques);
        assert_eq!(found, [(0.0, 1.0), (4.0, 4.0)]);
    }
}
