//! The pages of `residual.pdf`: what the residual of every campaign still holds, for somebody who has to decide whether to believe it.

mod asked;
mod effects;
mod errors;
mod limits;
mod suspects;
mod words;

use crate::base::error::Result;
use crate::report::answers::{size, verdict, verdict_words};
use crate::report::figures::Drawn;
use crate::report::input::{GroupFigures, GroupInput, ReportInput};
use crate::report::typeset::{Document, Pdf};
use crate::stages::diagnose::findings::{CampaignFindings, EffectFinding};
use asked::{Asked, questions, unexplained};
use effects::{Effect, effect, rejected};
use errors::{coefficient, errors, reading, unit};
use limits::{Next, alike, by_reason, limits, next, wanting};
use serde::Serialize;
use suspects::{Suspect, summary, suspects};
use words::perhaps;

const TEMPLATE: &str = include_str!("../templates/residual.typ");

/// What the template is told.
#[derive(Serialize)]
struct Data {
    only_simulated: bool,
    campaigns: Vec<Campaign>,
    version: &'static str,
    input: String,
}

#[derive(Serialize)]
struct Campaign {
    name: String,
    diameter_mm: u32,
    simulated: bool,
    verdict: &'static str,
    verdict_words: &'static str,
    /// Mistakes of recording, before everything else.
    suspects: Vec<Suspect>,
    summary: String,
    base: String,
    counts: [usize; 4],
    held_out_by: String,
    before: [String; 4],
    after: [String; 4],
    as_chosen: Option<[String; 4]>,
    empirical: Option<[String; 4]>,
    /// Whether the empirical corrections lower the held-out error.
    empirical_helps: bool,
    noise: String,
    black_box: String,
    black_box_after: String,
    /// Titles of the effects with their first parameter.
    short: Vec<String>,
    effects: Vec<Effect>,
    rejected: Vec<[String; 4]>,
    questions: Vec<Asked>,
    unexplained: Vec<[String; 6]>,
    units: Vec<[String; 6]>,
    readings_of_the_base: Vec<[String; 5]>,
    coefficients: Vec<[String; 6]>,
    limits: Vec<[String; 4]>,
    /// Why, and which effects.
    not_measurable: Vec<(String, Vec<String>)>,
    /// Effects for which the campaign lacks something, and what.
    wanting: Vec<(String, String)>,
    /// Effects that cannot be told apart, and the smallest cosine between two of them.
    aliases: Vec<(Vec<String>, String)>,
    next: Vec<Next>,
    notes: Vec<String>,
    /// Whether it has a section of its own.
    section: bool,
    figures: Vec<Picture>,
}

#[derive(Serialize)]
struct Picture {
    kind: String,
    file: String,
    caption: String,
    alt: String,
}

/// Typesets `residual.pdf`. None where nothing was diagnosed.
///
/// # Errors
/// A template that does not compile.
pub fn residual_pdf(input: &ReportInput, date: Option<(i32, u8, u8)>) -> Result<Option<Pdf>> {
    let both = input.groups.iter().zip(&input.figures);
    let of_group = |(g, f): (&GroupInput, &Option<GroupFigures>)| {
        Some(campaign(&g.diagnosis.as_ref()?.findings, f.as_ref()))
    };
    let campaigns: Vec<Campaign> = both.filter_map(of_group).collect();
    if campaigns.is_empty() {
        return Ok(None);
    }
    let data = Data {
        only_simulated: campaigns.iter().all(|c| c.simulated),
        campaigns,
        version: env!("CARGO_PKG_VERSION"),
        input: input.input_digest.clone(),
    };
    let mut document = Document::new(TEMPLATE)
        .data("data.json", &data)?
        .dated(date);
    for drawn in input.with_section().flat_map(|(_, f)| &f.diagnosis) {
        document = document.file(&format!("figures/{}.svg", drawn.name), &drawn.svg);
    }
    document.compile().map(Some)
}

fn campaign(found: &CampaignFindings, figures: Option<&GroupFigures>) -> Campaign {
    let refitted = if found.base_refitted {
        "its coefficients fitted here"
    } else {
        "its coefficients as published"
    };
    let first = |e: &EffectFinding| {
        let size = e.parameters.first().map(size).unwrap_or_default();
        format!("{}: {size}", e.title)
    };
    Campaign {
        name: found.campaign.clone(),
        diameter_mm: found.diameter_mm,
        simulated: found.simulated,
        verdict: verdict(found.verdict),
        verdict_words: verdict_words(found.verdict),
        suspects: suspects(found),
        summary: summary(found),
        base: format!("{}, {refitted}", found.base_model),
        counts: [
            found.readings,
            found.sessions,
            found.specimens,
            found.readings_held_out,
        ],
        held_out_by: found.held_out_by.clone(),
        before: errors(&found.before),
        after: errors(&found.after),
        as_chosen: found.after_as_chosen.as_ref().map(errors),
        empirical: found.after_empirical.as_ref().map(errors),
        empirical_helps: found
            .after_empirical
            .is_some_and(|e| e.rmse_heldout < found.after.rmse_heldout),
        noise: perhaps(found.noise_floor),
        black_box: perhaps(found.black_box_rmse_heldout),
        black_box_after: perhaps(found.black_box_after_rmse_heldout),
        short: found.effects.iter().map(first).collect(),
        effects: found.effects.iter().map(effect).collect(),
        rejected: rejected(found),
        questions: questions(found),
        unexplained: unexplained(found),
        units: found.by_specimen.iter().map(unit).collect(),
        readings_of_the_base: found.readings_of_the_base.iter().map(reading).collect(),
        coefficients: found.coefficients.iter().map(coefficient).collect(),
        limits: limits(found),
        not_measurable: by_reason(found),
        wanting: found.not_measurable.iter().filter_map(wanting).collect(),
        aliases: alike(&found.aliases),
        next: next(found),
        notes: found.notes.clone(),
        section: figures.is_some(),
        figures: figures.map_or_else(Vec::new, |f| f.diagnosis.iter().map(picture).collect()),
    }
}

fn picture(drawn: &Drawn) -> Picture {
    let kinds = ["residual-before", "residual-after", "heldout", "empirical"];
    let kind = kinds
        .into_iter()
        .find(|k| drawn.name.starts_with(k))
        .unwrap_or_default();
    Picture {
        kind: kind.to_owned(),
        file: format!("figures/{}.svg", drawn.name),
        caption: drawn.caption.clone(),
        alt: drawn.title.clone(),
    }
}
