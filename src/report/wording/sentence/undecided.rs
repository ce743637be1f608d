//! What fits as well without a part of the law, or with another in its place.

use crate::wording::number::{error, error_with_unit, size};
use crate::wording::{ALIKE, CLEARLY_LOWER, name};
use pipeline_effects as effects;
use pipeline_findings::{Alternative, CampaignFindings, LENGTH_LAW, Parameter};

/// `beside the compliance in series with the actuator that was found, the law's dependence on the resting length is not needed: without it the readings
/// fit as well, with 11.7 instead of 13.9 N on unseen specimens (...); predictions have both`, or, where the search left it out, `predictions do not have
/// it; to make sure: ...`.
pub(super) fn not_needed(found: &CampaignFindings) -> Option<String> {
    let is_left_out = found.coefficients.iter().any(|c| c.left_out);
    let all = found.alternatives.iter();
    let with_law = |part: &str| {
        let has_both = |a: &&Alternative| a.parts == [LENGTH_LAW, part];
        all.clone().find(has_both)
    };
    let of_part = all.clone().find_map(|a| {
        let [part] = &a.parts[..] else { return None };
        let is_found = found.effects.iter().any(|e| e.id == *part);
        Some((a, with_law(part)?, part)).filter(|_| is_found)
    });
    let with_errors = of_part.filter(|(a, b, _)| a.rmse_heldout.and(b.rmse_heldout).is_some());
    let Some((alone, both, part)) = with_errors else {
        return is_left_out.then(|| {
            format!(
                "beside what was found, the law's {} is not needed: without it the readings fit as well; predictions do not have it",
                name::part(LENGTH_LAW)
            )
        });
    };
    let (of_alone, of_both) = (alone.rmse_heldout?, both.rmse_heldout?);
    let is_better = alone.log_likelihood > both.log_likelihood - ALIKE;
    (is_left_out || is_better && of_alone < CLEARLY_LOWER * of_both).then(|| {
        let have = if is_left_out {
            let measurement = effects::index(part).map(|e| effects::all()[e].measurement());
            format!(
                "predictions do not have it; to make sure: {}",
                measurement.unwrap_or_default()
            )
        } else {
            "predictions have both".to_owned()
        };
        format!(
            "beside the {} that was found, the law's {} is not needed: without it the readings fit as well, with {} instead of {} on {}{}; \
             {have}",
            name::part(part),
            name::part(LENGTH_LAW),
            error(of_alone, &found.unit),
            error_with_unit(of_both, &found.unit),
            name::held_out(found),
            how_compared(found),
        )
    })
}

/// `compliance in series with the actuator (C = 14 um/N) in place of the law's dependence on the resting length fits the readings as well, with 12.1
/// instead of 14.6 N on unseen specimens (...); predictions have the dependence; to tell which: ...`, where
/// other parts do as well or better and predict unseen units clearly better.
pub(super) fn undecided(found: &CampaignFindings) -> Option<String> {
    if found.coefficients.iter().any(|c| c.left_out) {
        return None;
    }
    let is_found = |part: &str| found.effects.iter().any(|e| e.id == part);
    let only = |a: &&Alternative, id: &str| a.parts == [id];
    let law = found.alternatives.iter().find(|a| only(a, LENGTH_LAW))?;
    let of_law = law.rmse_heldout?;
    let is_better = |a: &&Alternative| {
        let error = a.rmse_heldout.unwrap_or(f64::INFINITY);
        a.log_likelihood > law.log_likelihood - ALIKE && error < CLEARLY_LOWER * of_law
    };
    let has_size = |p: &Parameter| p.ci_low.is_some() || p.ci_high.is_some();
    let better = found.alternatives.iter().filter(is_better);
    let better = better.filter(|a| a.numbers.iter().all(has_size));
    let others: Vec<(&Alternative, &str)> = better
        .filter_map(|a| match &a.parts[..] {
            // What was found beside the law stands in every row that does not name it, so that rows without it are no answer.
            [part] if !is_found(part) => Some((a, part.as_str())),
            _ => None,
        })
        .collect();
    if others.is_empty() {
        return None;
    }
    let of_others = |words: &dyn Fn(&Alternative, &str) -> String| {
        let words: Vec<String> = others.iter().map(|(a, part)| words(a, part)).collect();
        words.join(" or ")
    };
    let with_sizes = |a: &Alternative, part: &str| {
        let sizes: Vec<String> = a.numbers.iter().map(size).collect();
        format!("{} ({})", name::part(part), sizes.join(", "))
    };
    let errors = |a: &Alternative, _: &str| {
        let error_of_one = a.rmse_heldout.map(|e| error(e, &found.unit));
        error_of_one.unwrap_or_default()
    };
    let fits_better = |(a, _): &(&Alternative, &str)| a.log_likelihood > law.log_likelihood + ALIKE;
    let indices = others.iter().filter_map(|(_, part)| effects::index(part));
    let measurements: Vec<&str> = indices.map(|e| effects::all()[e].measurement()).collect();
    Some(format!(
        "{} in place of the law's {} fits the readings {}, with {} instead of {} on {}{}; predictions have the dependence; to tell which: {}",
        of_others(&with_sizes),
        name::part(LENGTH_LAW),
        if others.iter().all(fits_better) {
            "better"
        } else {
            "as well"
        },
        of_others(&errors),
        error_with_unit(of_law, &found.unit),
        name::held_out(found),
        how_compared(found),
        measurements.join("; "),
    ))
}

/// ` (each with the effects found here and without what is published of the dependence; the answer above has 19.3 N)`: why the errors of parts are others
/// than those of the answer.
fn how_compared(found: &CampaignFindings) -> String {
    let own = found.rmse_of_answer().map_or_else(String::new, |own| {
        format!(
            "; the answer itself has {}",
            error_with_unit(own, &found.unit)
        )
    });
    format!(
        " (each with the effects found here and without what is published of the dependence{own})"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wording::tests::example;
    use pipeline_findings::CoefficientChange;

    fn alternative(parts: &[&str], log_likelihood: f64, error: f64) -> Alternative {
        Alternative {
            parts: parts.iter().map(|p| (*p).to_owned()).collect(),
            parameters: 0,
            log_likelihood,
            rmse_heldout: Some(error),
            log_density_heldout: None,
            numbers: vec![Parameter {
                name: "C".to_owned(),
                value: 14.2,
                ci_low: Some(11.6),
                ci_high: Some(16.8),
                unit: "um/N".to_owned(),
                of_level: None,
            }],
        }
    }

    fn said(frame: Alternative, offset: Alternative) -> Option<String> {
        let mut found = example();
        found.alternatives = vec![
            alternative(&[], 0.0, 26.0),
            alternative(&[LENGTH_LAW], 13.0, 14.6),
            frame,
            alternative(&[LENGTH_LAW, "series_compliance"], 14.0, 12.0),
            offset,
        ];
        undecided(&found)
    }

    #[test]
    fn what_does_as_well_in_the_place_of_the_length_law_is_said_if_it_predicts_better() {
        let frame = |gain: f64, error: f64| alternative(&["series_compliance"], gain, error);
        let offset = |gain: f64| alternative(&["length_offset"], gain, 12.0);
        let words = said(frame(11.1, 12.1), offset(1.0)).unwrap();
        let words = words.replace('\u{a0}', " ");
        for part in [
            "(C = 14.2 [11.6, 16.8] µm/N) in place of the law's dependence on the resting length fits",
            "with 12.1 instead of 14.6 N on unseen specimens",
            "; to tell which: put a dial gauge",
        ] {
            assert!(words.contains(part), "{words}");
        }
        // Another that does as well is named with it.
        let both = said(frame(14.0, 12.1), offset(12.0)).unwrap();
        let both = both.replace('\u{a0}', " ");
        for part in [
            "(C = 14.2 [11.6, 16.8] µm/N) or offset of the length (C",
            "fits the readings as well, with 12.1 or 12.0 instead of 14.6 N",
        ] {
            assert!(both.contains(part), "{both}");
        }
        // One that fits worse, or does no better.
        assert_eq!(said(frame(10.9, 12.1), offset(1.0)), None);
        assert_eq!(said(frame(14.0, 14.5), offset(1.0)), None);
        let mut found = example();
        found.effects[0].id = "series_compliance".to_owned();
        found.alternatives = vec![alternative(&[LENGTH_LAW], 13.0, 14.6), frame(14.0, 12.1)];
        assert_eq!((undecided(&found), not_needed(&found)), (None, None));
        let beside = alternative(&[LENGTH_LAW, "series_compliance"], 14.9, 13.9);
        found.alternatives.push(beside.clone());
        let words = not_needed(&found).unwrap().replace('\u{a0}', " ");
        let is_said = "is not needed: without it the readings fit as well, with 12.1 instead of 13.9 N on unseen specimens";
        assert!(words.contains(is_said), "{words}");
        found.coefficients = vec![CoefficientChange {
            name: "1/b2".to_owned(),
            unit: "m".to_owned(),
            before: 0.03,
            after: 1e-4,
            standard_error: 0.0,
            published: Some(0.03),
            at_bound: false,
            before_at_bound: false,
            left_out: true,
        }];
        let words = not_needed(&found).unwrap().replace('\u{a0}', " ");
        assert!(
            words.contains("predictions do not have it; to make sure: put a dial gauge"),
            "{words}"
        );
        found.coefficients.clear();
        found.alternatives[2].log_likelihood = 16.1;
        assert_eq!(not_needed(&found), None);
        let mut unbounded = frame(14.0, 12.1);
        (unbounded.numbers[0].ci_low, unbounded.numbers[0].ci_high) = (None, None);
        assert_eq!(said(unbounded, offset(1.0)), None);
    }
}
