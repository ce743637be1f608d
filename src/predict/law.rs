//! Which law answers: a fit of an earlier run, or a published model.

use pipeline_base::diagnostics::nearest;
use pipeline_base::error::{Error, Result};
use pipeline_compare::NEW;
use pipeline_diagnose::mixed_law::MixedLaw;
use pipeline_fit::GroupFit;
use pipeline_fit::engine::EquationFit;
use pipeline_fit::equations::JOINT;
use pipeline_mechanics::models::new::NewPublished;
use pipeline_mechanics::models::{ForceModel, published};

/// The id under which the new model by least squares, as the papers' tables have it, is asked for.
pub const LEAST_SQUARES: &str = "new_least_squares";

/// What an earlier run has: fits, and the laws of mixed models.
#[derive(Clone, Debug, Default)]
pub struct Laws {
    /// One for every campaign and pool.
    pub fits: Vec<GroupFit>,
    /// One for those that were assessed; none where the run is of a version that had none, or somebody has deleted them.
    pub mixed: Option<Vec<MixedLaw>>,
}

/// The new model with the coefficients of an earlier run.
#[derive(Clone, Copy)]
pub struct Fitted<'a> {
    /// What was fitted to which readings.
    pub fit: &'a GroupFit,
    /// Eq. 9 by least squares.
    pub joint: &'a EquationFit,
    /// The law of the mixed model, which answers where there is one.
    pub mixed: Option<&'a MixedLaw>,
}

/// A law of force.
#[derive(Clone, Copy)]
pub enum Law<'a> {
    /// The new model with the coefficients of an earlier run.
    Fitted(Fitted<'a>),
    /// A published model.
    Published(&'static dyn ForceModel),
}

impl Laws {
    /// The law of the mixed model of a group.
    pub fn mixed_of(&self, fit: &GroupFit) -> Option<&MixedLaw> {
        let group = &fit.group;
        let of = |m: &&MixedLaw| m.campaign == group.campaign && m.diameter_mm == group.diameter_mm;
        self.mixed.iter().flatten().find(of)
    }
}

impl Law<'_> {
    /// Id of the model.
    pub fn id(&self) -> &'static str {
        match self {
            Law::Fitted(Fitted { mixed: Some(_), .. }) => NEW,
            Law::Fitted(_) => LEAST_SQUARES,
            Law::Published(model) => model.id(),
        }
    }

    /// The model, for people; says so if the data that it was fitted to are simulated.
    pub fn title(&self) -> String {
        match self {
            Law::Fitted(Fitted { fit, mixed, .. }) => {
                let simulated = if fit.group.simulated {
                    " (simulated data)"
                } else {
                    ""
                };
                let how = match mixed {
                    Some(mixed) if mixed.has_fitted_law() => "new model, mixed-model fit to",
                    Some(_) => "published coefficients with the mixed model of",
                    None => "new model, least-squares fit to",
                };
                format!("{how} {}{simulated}", fit.group.campaign)
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
    /// Whether least squares was asked for.
    pub is_least_squares: bool,
    /// Whether the run left laws of mixed models; false of a published model that was asked for.
    pub has_mixed: bool,
}

/// The law of a model id and a nominal diameter; `campaign` picks among the fits.
///
/// # Errors
/// A model or campaign that there is not, a diameter that nothing is known of.
pub fn choose<'a>(
    laws: &'a Laws,
    model: &str,
    campaign: Option<&str>,
    diameter_mm: u32,
) -> Result<Choice<'a>> {
    if model != NEW && model != LEAST_SQUARES {
        if let Some(campaign) = campaign {
            return usage(format!(
                "--campaign {campaign} picks a fit of the model {NEW}, and {model} is a published model; leave one of them out"
            ));
        }
        return by_id(model, diameter_mm);
    }
    let fitted = |fit: &'a GroupFit| {
        let mixed = laws.mixed_of(fit).filter(|_| model == NEW);
        let joint = fit.equation(JOINT)?;
        Some(Fitted { fit, joint, mixed })
    };
    let of_diameter = laws.fits.iter();
    let of_diameter = of_diameter.filter(|f| f.group.diameter_mm == diameter_mm);
    let usable: Vec<Fitted> = of_diameter.filter_map(fitted).collect();
    let choice = match campaign {
        Some(campaign) => named(&usable, campaign, diameter_mm)?,
        None => usual(&usable, diameter_mm)?,
    };
    Ok(Choice {
        is_least_squares: model == LEAST_SQUARES,
        has_mixed: laws.mixed.is_some(),
        ..choice
    })
}

/// The pool, or else the campaign with most specimens, of those with a mixed model if there are any: a large pool is not assessed, and without a mixed
/// model nobody knows how muscles differ.
fn usual<'a>(usable: &[Fitted<'a>], diameter_mm: u32) -> Result<Choice<'a>> {
    let assessed: Vec<Fitted> = usable
        .iter()
        .filter(|f| f.mixed.is_some())
        .copied()
        .collect();
    let among = if assessed.is_empty() {
        usable
    } else {
        &assessed
    };
    let pooled = among.iter().find(|f| f.fit.group.members.len() > 1);
    let largest = among.iter().rev().max_by_key(|f| f.fit.specimens.len());
    match (pooled, largest) {
        (Some(fitted), _) => Ok(Choice::of(
            Law::Fitted(*fitted),
            format!(
                "{} pools all measured campaigns of {diameter_mm} mm; --campaign picks another",
                fitted.fit.group.campaign
            ),
        )),
        (None, Some(fitted)) => {
            let why = largest_of(fitted.fit, usable, among.len());
            Ok(Choice::of(Law::Fitted(*fitted), why))
        }
        (None, None) => fallback(diameter_mm),
    }
}

impl<'a> Choice<'a> {
    fn of(law: Law<'a>, why: String) -> Self {
        Self {
            law,
            why,
            is_least_squares: false,
            has_mixed: false,
        }
    }
}

/// That a fit has the most specimens of so many among which it was chosen.
fn largest_of(fit: &GroupFit, usable: &[Fitted], among: usize) -> String {
    let (campaign, diameter_mm) = (&fit.group.campaign, fit.group.diameter_mm);
    if usable.len() == 1 {
        return format!("{campaign} is the only fit for {diameter_mm} mm");
    }
    let fits = format!("fits for {diameter_mm} mm");
    let which = match among {
        1 => format!(
            "is the only one of {} {fits} with a mixed model",
            usable.len()
        ),
        among if among < usable.len() => {
            format!("has the most specimens of the {among} {fits} with a mixed model")
        }
        among => format!("has the most specimens of the {among} {fits}"),
    };
    format!(
        "{campaign} {which}; --campaign picks another ({})",
        campaigns(usable)
    )
}

fn campaigns(usable: &[Fitted]) -> String {
    let names: Vec<&str> = usable
        .iter()
        .map(|f| f.fit.group.campaign.as_str())
        .collect();
    names.join(", ")
}

fn named<'a>(usable: &[Fitted<'a>], campaign: &str, diameter_mm: u32) -> Result<Choice<'a>> {
    let found = usable.iter().find(|f| f.fit.group.campaign == campaign);
    match found {
        Some(fitted) => Ok(Choice::of(Law::Fitted(*fitted), String::new())),
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
        let ids: Vec<&str> = [NEW, LEAST_SQUARES]
            .into_iter()
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
    Ok(Choice::of(Law::Published(*model), String::new()))
}

fn usage<T>(message: String) -> Result<T> {
    Err(Error::Usage(message))
}
