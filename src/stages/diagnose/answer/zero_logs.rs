//! What the zero logs say of a zero of the pressure channel: a measurement that the search did not use, and that can decide for it.

use super::super::findings::{EffectFinding, ParameterFinding};

/// What a zero log shows if the first is so, and does not if the second is.
const ZERO_OR_THRESHOLD: [&str; 2] = ["pressure_zero_offset", "bladder_threshold"];

/// A sentence on an effect that is a zero of the pressure channel or the bladder's threshold; none where none of the two was found, or no
/// zero log shows the pressure. `zero_logs`: one value a session, rising, kPa.
pub(super) fn zero_logs_say(effects: &[EffectFinding], zero_logs: &[f64]) -> Option<String> {
    let (low, high) = (*zero_logs.first()?, *zero_logs.last()?);
    let is_meant =
        |e: &&EffectFinding| ZERO_OR_THRESHOLD.contains(&e.id.as_str()) && e.scope == "global";
    let found = effects.iter().find(is_meant)?;
    let size = found.parameters.first()?;
    let shown = format!(
        "The zero logs of {} sessions show the pressure channel at {low:.1} to {high:.1} kPa without pressure",
        zero_logs.len()
    );
    Some(format!("{shown}: {}.", reading(size, low, high)))
}

fn reading(size: &ParameterFinding, low: f64, high: f64) -> String {
    let value = size.value;
    if size.ci_low <= high && size.ci_high >= low {
        format!("a zero of the sensor of {value:.0} kPa is compatible with that")
    } else if value > high {
        let rest = value - 0.5 * (low + high);
        format!(
            "a zero of the sensor of {value:.0} kPa would show there, so that most of it ({rest:.0} kPa) is the bladder's threshold or something \
             that looks like it"
        )
    } else {
        format!("a zero of the sensor of {value:.0} kPa would show there, and does not")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn zero(value: f64, half: f64) -> ParameterFinding {
        ParameterFinding {
            name: "p".to_owned(),
            value,
            ci_low: value - half,
            ci_high: value + half,
            unit: "kPa".to_owned(),
        }
    }

    #[test]
    fn a_zero_that_the_zero_logs_do_not_show_is_a_threshold() {
        assert!(
            reading(&zero(60.0, 30.0), 8.9, 9.7).contains("(51 kPa) is the bladder's threshold")
        );
        assert!(reading(&zero(12.0, 5.0), 8.9, 9.7).contains("compatible"));
        assert!(reading(&zero(-20.0, 5.0), 8.9, 9.7).contains("does not"));
    }
}
