//! Which law answers: a fit of an earlier run, or a published model.

use pipeline_base::diagnostics::nearest;
use pipeline_base::error::{Error, Result};
use pipeline_compare::NEW;
use pipeline_fit::GroupFit;
use pipeline_fit::engine::EquationFit;
use pipeline_fit::equations::JOINT;
use pipeline_mechanics::models::new::NewPublished;
use pipeline_mechanics::models::{ForceModel, published};

/// A law of force.
#[derive(Clone, Copy)]
pub enum Law<'a> {
    /// The new model with the coefficients of an earlier run.
    Fitted(&'a GroupFit, &'a EquationFit),
    /// A published model.
    Published(&'static dyn ForceModel),
}

impl Law<'_> {
    /// Id of the model.
    pub fn id(&self) -> &'static str {
        match self {
            Law::Fitted(..) => NEW,
            Law::Published(model) => model.id(),
        }
    }

    /// The model, for people; says so if the data that it was fitted to are simulated.
    pub fn title(&self) -> String {
        match self {
            Law::Fitted(fit, _) => {
                let simulated = if fit.group.simulated {
                    " (simulated data)"
                } else {
                    ""
                };
                format!("new model, fitted to {}{simulated}", fit.group.campaign)
            }
            Law::Published(model) => model.title().to_owned(),
        }
    }
}

/// The law that was chosen, and why.
#[derive(Clone)]
pub struct Choice<'a> {
    /// The law.
    pub law: Law<'a>,
    /// Why this one, as a sentence; empty where it was asked for by name.
    pub why: String,
}

/// The law of a model id and a nominal diameter; `campaign` picks among the fits.
///
/// # Errors
/// A model or campaign that there is not, a diameter that nothing is known of.
pub fn choose<'a>(
    fits: &'a [GroupFit],
    model: &str,
    campaign: Option<&str>,
    diameter_mm: u32,
) -> Result<Choice<'a>> {
    if model != NEW {
        if let Some(campaign) = campaign {
            return usage(format!(
                "--campaign {campaign} picks a fit of the model {NEW}, and {model} is a published model; leave one of them out"
            ));
        }
        return by_id(model, diameter_mm);
    }
    let usable: Vec<(&GroupFit, &EquationFit)> = fits
        .iter()
        .filter(|f| f.group.diameter_mm == diameter_mm)
        .filter_map(|f| Some((f, f.equation(JOINT)?)))
        .collect();
    if let Some(campaign) = campaign {
        return named(&usable, campaign, diameter_mm);
    }
    let pooled = usable.iter().find(|(f, _)| f.group.members.len() > 1);
    let largest = usable.iter().rev().max_by_key(|(f, _)| f.specimens.len());
    match (pooled, largest) {
        (Some((fit, joint)), _) => Ok(Choice {
            law: Law::Fitted(fit, joint),
            why: format!(
                "{} pools all measured campaigns of {diameter_mm} mm; --campaign picks another",
                fit.group.campaign
            ),
        }),
        (None, Some((fit, joint))) => Ok(Choice {
            law: Law::Fitted(fit, joint),
            why: largest_of(fit, &usable),
        }),
        (None, None) => fallback(diameter_mm),
    }
}

fn largest_of(fit: &GroupFit, usable: &[(&GroupFit, &EquationFit)]) -> String {
    match usable.len() {
        1 => format!(
            "{} is the only fit for {} mm",
            fit.group.campaign, fit.group.diameter_mm
        ),
        n => format!(
            "{} has the most specimens of the {n} fits for {} mm; --campaign picks another ({})",
            fit.group.campaign,
            fit.group.diameter_mm,
            campaigns(usable)
        ),
    }
}

fn campaigns(usable: &[(&GroupFit, &EquationFit)]) -> String {
    let names: Vec<&str> = usable
        .iter()
        .map(|(f, _)| f.group.campaign.as_str())
        .collect();
    names.join(", ")
}

fn named<'a>(
    usable: &[(&'a GroupFit, &'a EquationFit)],
    campaign: &str,
    diameter_mm: u32,
) -> Result<Choice<'a>> {
    let found = usable.iter().find(|(f, _)| f.group.campaign == campaign);
    match found {
        Some((fit, joint)) => Ok(Choice {
            law: Law::Fitted(fit, joint),
            why: String::new(),
        }),
        None if usable.is_empty() => usage(format!(
            "there is no fit for {diameter_mm} mm in any campaign; `pipeline run` makes fits from sessions"
        )),
        None => usage(format!(
            "there is no fit of a campaign {campaign} for {diameter_mm} mm; there are {}",
            campaigns(usable)
        )),
    }
}

fn fallback<'a>(diameter_mm: u32) -> Result<Choice<'a>> {
    if !NewPublished.diameters().contains(&diameter_mm) {
        return usage(format!(
            "there is no fit for {diameter_mm} mm, and no published coefficients of the new model for it; `pipeline run` on sessions of this diameter \
             makes a fit"
        ));
    }
    let choice = by_id(NewPublished.id(), diameter_mm)?;
    Ok(Choice {
        why: format!(
            "there is no fit for {diameter_mm} mm (`pipeline run` makes them from sessions), so the published coefficients answer"
        ),
        ..choice
    })
}

fn by_id<'a>(id: &str, diameter_mm: u32) -> Result<Choice<'a>> {
    let all = published();
    let Some(model) = all.iter().find(|m| m.id() == id) else {
        let ids: Vec<&str> = std::iter::once(NEW)
            .chain(all.iter().map(|m| m.id()))
            .collect();
        let hint = nearest(id, ids.iter().copied())
            .map_or_else(String::new, |near| format!("; did you mean {near}?"));
        return usage(format!(
            "no model is called \"{id}\"; the models are {}{hint}",
            ids.join(", ")
        ));
    };
    if !model.diameters().contains(&diameter_mm) {
        let covered: Vec<String> = model
            .diameters()
            .iter()
            .map(|d| format!("{d} mm"))
            .collect();
        return usage(format!(
            "{id} has no coefficients for {diameter_mm} mm, only for {}",
            covered.join(", ")
        ));
    }
    Ok(Choice {
        law: Law::Published(*model),
        why: String::new(),
    })
}

fn usage<T>(message: String) -> Result<T> {
    Err(Error::Usage(message))
}
