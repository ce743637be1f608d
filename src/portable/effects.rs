//! A model from the loop's answer: the coefficients of the mixed model, with the effects of the actuator that a static function can hold.
//!
//! The coefficients go with all effects, those of the rig included: an effect of the rig that the readings contain is taken out of the
//! coefficients by being in the mixed model, and out of the exported function by being left out there.

use crate::domain::Domain;
use crate::law::Law;
use crate::model::{Model, Named};
use crate::source;
use pipeline_base::error::{Error, Result};
use pipeline_effects as effects;
use pipeline_effects::{Effect, Subject};
use pipeline_findings::{ActsOn, CampaignFindings, CoefficientChange, EffectFinding};
use pipeline_fit::GroupFit;

/// Of a 95% interval from a standard error.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// The joint law with the coefficients and effects of the loop. `named`: which member of an alias set it is, where a set holds effects of the
/// actuator and of the rig.
///
/// # Errors
/// The loop has no coefficients of the new model for this campaign; an alias set of both kinds of which no member is named.
pub fn of_findings(
    fit: &GroupFit,
    found: &CampaignFindings,
    named: &[String],
    inputs: &str,
) -> Result<Model> {
    let mut model = source::of_fit(fit, inputs)?;
    let c = coefficients(found)?;
    let mut law = source::new_law(c, fit.cap_length_m);
    let (shortest, longest) = fit.ranges.rest_length_m;
    law.middle_length_m = 0.5 * (shortest + longest);
    known(named, found)?;
    let negligible = found.effects.iter().filter(|e| e.negligible).count();
    let of_which = match negligible {
        0 => String::new(),
        n => format!(" ({n} of them smaller than the smallest effect of interest)"),
    };
    let mut said = vec![format!(
        "Effects: the coefficients are those of the loop's mixed model with all {} effects that it accepted{of_which}; of these the function has",
        found.effects.len()
    )];
    for e in &found.effects {
        said.push(format!("  {}", put(&mut law, e, named, fit)?));
    }
    if found.effects.is_empty() {
        said = vec![
            "Effects: the loop accepted none; the coefficients are those of its mixed model."
                .to_owned(),
        ];
    }
    said.extend(found.noted_contractions.map(|noted| {
        format!(
            "Contractions at 620 kPa: of the differences between those noted of {} specimens {:.0}% -/+ {:.0}% is error; the coefficients go with l_620 = l_rest (1 - e), e = {:.4} + ({:.3}) (noted - {:.4}), unless l_620 is known better.",
            noted.specimens,
            100.0 * noted.error.clamp(0.0, 1.0),
            100.0 * noted.error_sd,
            noted.mean,
            1.0 - noted.error,
            noted.mean
        )
    }));
    if found.coefficients.iter().any(|c| c.left_out) {
        said.push(
            "Resting length: the effects took the place of the law's dependence on it; b2 is fixed at a value at which F_620 is the same for all lengths."
                .to_owned(),
        );
    }
    model.title = format!("new model, mixed-model fit to {}", source::campaign(fit));
    model.spread = None;
    model.coefficients = found.coefficients.iter().map(of_change).collect();
    model.coefficients.push(source::cap_length(fit));
    model.provenance[0] = format!(
        "{} readings of {} specimens in the loop; intervals: value -/+ 1.96 standard errors, that of b2 from 1/b2; what the mixed model has of a smooth misfit beside the law is not in the function: `pipeline predict` has it",
        found.design.readings, found.design.specimens
    );
    model.effects = said;
    model.domain = Domain::new(&law, *model.fitted());
    model.law = law;
    Ok(model)
}

/// b1, b2, c0, c1, c2 with the effects.
fn coefficients(found: &CampaignFindings) -> Result<[f64; 5]> {
    let of = |name: &str| {
        found
            .coefficients
            .iter()
            .find(|c| c.name == name)
            .map(|c| c.after)
    };
    let all = || {
        Some([
            of("b1")?,
            1.0 / of("1/b2")?,
            of("c0")?,
            of("c1")?,
            of("c2")?,
        ])
    };
    all().ok_or_else(|| {
        Error::Usage(format!(
            "{} ({} mm): the search has fitted no coefficients of the new model, but has {} as its base model; --least-squares exports the plain fit, or run \
             with diagnose.base_model = \"new\"",
            found.campaign, found.diameter_mm, found.base_model
        ))
    })
}

/// Names that are in no alias set of both kinds are a mistake.
fn known(named: &[String], found: &CampaignFindings) -> Result<()> {
    let mixed: Vec<&EffectFinding> = found.effects.iter().filter(|e| is_mixed(e)).collect();
    let asked = |name: &&String| !mixed.iter().any(|e| e.class.contains(name));
    let Some(name) = named.iter().find(asked) else {
        return Ok(());
    };
    let sets: Vec<String> = mixed.iter().map(|e| e.class.join(" or ")).collect();
    let sets = if sets.is_empty() {
        "there is no such set".to_owned()
    } else {
        format!("the sets are {}", sets.join("; "))
    };
    Err(Error::Usage(format!(
        "--alias {name}: it is in no alias set of {} that holds effects of the actuator and of the rig; {sets}",
        found.campaign
    )))
}

fn of_id(id: &str) -> Option<&'static dyn Effect> {
    Some(effects::all()[effects::index(id)?])
}

/// An effect that is not in the library is one of a joint: of the rig.
fn subject(id: &str) -> Subject {
    of_id(id).map_or(Subject::Rig, |e| e.subject())
}

fn is_mixed(e: &EffectFinding) -> bool {
    let of_actuator = |id: &String| subject(id) == Subject::Actuator;
    e.class.iter().any(of_actuator) && !e.class.iter().all(of_actuator)
}

/// Which member of its alias set an effect is taken for.
fn meant<'a>(e: &'a EffectFinding, named: &'a [String]) -> Result<&'a str> {
    // Where the function holds no member of the set, it is the same whatever the effect is.
    let matters = e.class.iter().any(|id| may_be_held(e, id));
    if !is_mixed(e) || !matters {
        return Ok(&e.id);
    }
    let of_set = e.class.iter().find(|id| named.contains(id));
    of_set.map(String::as_str).ok_or_else(|| {
        let choices = e.class.iter().map(|id| match subject(id) {
            Subject::Actuator => {
                format!("--alias {id} puts it into the function, for it is of the actuator")
            }
            Subject::Rig => format!("--alias {id} leaves it out, for it is of the rig"),
        });
        let choices: Vec<String> = choices.collect();
        Error::Usage(format!(
            "these readings cannot tell {} apart: {}. What would: {}",
            e.class.join(" and "),
            choices.join("; "),
            e.measurement
        ))
    })
}

/// Effects, their forms, and where the law has the size of each.
type Place = (&'static str, &'static str, fn(&mut Law) -> &mut f64);
const PLACES: [Place; 4] = [
    ("bladder_threshold", "sharp", |l| &mut l.threshold_sharp_kpa),
    ("bladder_threshold", "gradual", |l| {
        &mut l.threshold_gradual_kpa
    }),
    ("rest_length_scaling", "linear", |l| {
        &mut l.length_linear_per_m
    }),
    ("rest_length_scaling", "saturating", |l| {
        &mut l.length_saturating_per_m
    }),
];

/// Whether the function may have a term for an effect, were it this member of its alias set.
fn may_be_held(e: &EffectFinding, id: &str) -> bool {
    e.acts_on == ActsOn::All && PLACES.iter().any(|(of, ..)| *of == id)
}

/// Puts an effect into a law, if it belongs there; a sentence about what was done.
fn put(law: &mut Law, e: &EffectFinding, named: &[String], fit: &GroupFit) -> Result<String> {
    let id = meant(e, named)?;
    let size = e.parameters.first().map_or(f64::NAN, |p| p.value);
    let unit = e.parameters.first().map_or("", |p| p.unit.as_str());
    let title = of_id(id).map_or(id, |e| e.title());
    if subject(id) == Subject::Rig {
        return Ok(format!("not: {title} ({id}), which is of the rig"));
    }
    if e.acts_on != ActsOn::All {
        return Ok(format!(
            "not: {title} ({id}), which acts on a part of the readings only"
        ));
    }
    let form = form_of(e, id)?;
    let forms = of_id(id).map_or(&[][..], |e| e.forms());
    if !forms.iter().any(|f| f.name == form && f.is_static()) {
        return Ok(format!(
            "not: {title} ({id}), which depends on more than lengths and pressure: a static function cannot hold it"
        ));
    }
    let is_place = |(of, at, _): &&Place| (*of, *at) == (id, form);
    let Some((.., place)) = PLACES.iter().find(is_place) else {
        return Ok(format!(
            "not: {title} ({id}), which is the scatter of muscles of {} and not a term of their mean",
            fit.group.campaign
        ));
    };
    *place(law) = size;
    let equation = if id == e.id {
        e.equation.as_str()
    } else {
        "P = max(0, P_meas - P_th)"
    };
    Ok(format!("{title} ({id}): {size} {unit} in {equation}"))
}

/// The form of an effect that was accepted, or of the one that is meant in its place. The findings have the size of the accepted one only; a zero of the
/// pressure and a sharp threshold of the bladder are one equation above the threshold.
fn form_of<'a>(e: &'a EffectFinding, id: &str) -> Result<&'a str> {
    if id == e.id {
        return Ok(&e.form);
    }
    let positive = e.parameters.first().is_some_and(|p| p.value > 0.0);
    if (e.id.as_str(), id) == ("pressure_zero_offset", "bladder_threshold") && positive {
        return Ok("sharp");
    }
    Err(Error::Usage(format!(
        "--alias {id}: the findings hold the size of {} alone, and no size of {id} follows from it; --alias {} leaves it out of the function",
        e.id, e.id
    )))
}

/// A coefficient with its interval; 1/b2 as b2.
fn of_change(c: &CoefficientChange) -> Named {
    let half = NORMAL_95 * c.standard_error;
    let ends = (c.after - half, c.after + half);
    let interval = Some(ends).filter(|_| half > 0.0 && half.is_finite());
    if c.name != "1/b2" {
        return Named {
            symbol: c.name.clone(),
            value: c.after,
            unit: c.unit.clone(),
            interval,
        };
    }
    Named {
        symbol: "b2".to_owned(),
        value: 1.0 / c.after,
        unit: "1/m".to_owned(),
        interval: interval
            .filter(|(low, _)| *low > 0.0)
            .map(|(low, high)| (1.0 / high, 1.0 / low)),
    }
}
