//! The pages of `residual.pdf`: what the residual of every campaign still holds, for somebody who has to decide whether to believe it.

use crate::base::error::Result;
use crate::report::answers::{
    SIGNIFICANT, p_words, rounded, size, title, unit_words, verdict, verdict_words,
};
use crate::report::figures::Drawn;
use crate::report::input::{GroupInput, ReportInput};
use crate::report::number::Rounding;
use crate::report::typeset::{Document, Pdf};
use crate::stages::diagnose::findings::{
    Alias, CampaignFindings, CoefficientChange, EffectFinding, FoldErrors, NotMeasurable, Reading,
    Rejected, Unexplained,
};
use serde::Serialize;
use std::collections::BTreeSet;

const TEMPLATE: &str = include_str!("templates/residual.typ");
/// Most rejected candidates in print; `findings.json` has all.
const REJECTED: usize = 8;

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
    summary: String,
    /// Effects were found, and yet the held-out error is not smaller with them.
    no_better: bool,
    base: String,
    counts: [usize; 4],
    held_out_by: String,
    before: [String; 4],
    after: [String; 4],
    as_chosen: Option<[String; 4]>,
    empirical: Option<[String; 4]>,
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
    aliases: Vec<(String, String, String)>,
    next: Vec<Next>,
    notes: Vec<String>,
    figures: Vec<Picture>,
}

#[derive(Serialize)]
struct Effect {
    id: String,
    title: String,
    equation: String,
    acts_on: String,
    sizes: Vec<String>,
    others: Vec<String>,
    facts: Vec<(&'static str, String)>,
    source: String,
    measurement: String,
}

#[derive(Serialize)]
struct Asked {
    cells: [String; 5],
    significant: bool,
}

#[derive(Serialize)]
struct Next {
    separates: Vec<String>,
    /// For which effect, empty where there is one action for all; and what to do.
    actions: Vec<(String, String)>,
    difference: Option<String>,
}

#[derive(Serialize)]
struct Picture {
    kind: String,
    file: String,
    caption: String,
    alt: String,
}

/// Typesets `residual.pdf`; `figures` are those of each group's diagnosis. None where nothing was diagnosed.
///
/// # Errors
/// A template that does not compile.
pub fn residual_pdf(
    input: &ReportInput,
    figures: &[Vec<Drawn>],
    date: Option<(i32, u8, u8)>,
) -> Result<Option<Pdf>> {
    let of_group =
        |(g, f): (&GroupInput, &Vec<Drawn>)| Some(campaign(&g.diagnosis.as_ref()?.findings, f));
    let campaigns: Vec<Campaign> = input
        .groups
        .iter()
        .zip(figures)
        .filter_map(of_group)
        .collect();
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
    for drawn in figures.iter().flatten() {
        document = document.file(&format!("figures/{}.svg", drawn.name), &drawn.svg);
    }
    document.compile().map(Some)
}

/// A force in print, N.
fn newtons(value: f64) -> String {
    rounded(
        value,
        Rounding::Decimals(if value.abs() < 1.0 { 2 } else { 1 }),
    )
}

fn perhaps(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), newtons)
}

fn percent(share: f64) -> String {
    rounded(share, Rounding::Percent(0)) + "%"
}

fn errors(e: &crate::stages::diagnose::findings::Errors) -> [String; 4] {
    let all = [
        e.rmse_train,
        e.rmse_heldout,
        e.rmse_heldout_own_strength,
        e.max_abs_error_heldout,
    ];
    all.map(newtons)
}

fn campaign(found: &CampaignFindings, figures: &[Drawn]) -> Campaign {
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
        summary: found.summary.clone(),
        no_better: !found.effects.is_empty()
            && found.after.rmse_heldout >= found.before.rmse_heldout,
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
        noise: perhaps(found.noise_floor),
        black_box: perhaps(found.black_box_rmse_heldout),
        black_box_after: perhaps(found.black_box_after_rmse_heldout),
        short: found.effects.iter().map(first).collect(),
        effects: found.effects.iter().map(effect).collect(),
        rejected: rejected(found),
        questions: questions(found),
        unexplained: found.unexplained.iter().map(unexplained).collect(),
        units: found.by_specimen.iter().map(unit).collect(),
        readings_of_the_base: found.readings_of_the_base.iter().map(reading).collect(),
        coefficients: found.coefficients.iter().map(coefficient).collect(),
        limits: limits(found),
        not_measurable: by_reason(&found.not_measurable),
        wanting: found.not_measurable.iter().filter_map(wanting).collect(),
        aliases: found.aliases.iter().map(alias).collect(),
        next: next(found),
        notes: found.notes.clone(),
        figures: figures.iter().map(picture).collect(),
    }
}

/// What speaks for an effect. Strengths are part of every model and were not searched, so that some of it says nothing of them.
fn facts(e: &EffectFinding) -> Vec<(&'static str, String)> {
    let arrow = |a: f64, b: f64| format!("{} → {} N", newtons(a), newtons(b));
    let p = p_words(e.p_adjusted);
    let mut facts = vec![("p, corrected", p.trim_start_matches("= ").to_owned())];
    if e.criterion_gain != 0.0 {
        let gain = rounded(e.criterion_gain, Rounding::Decimals(1));
        let again = format!("{} of the resamples", percent(e.selected_in_folds));
        let helps = format!("in {} of the folds", percent(e.helps_in_folds));
        facts.push(("gain in the criterion", gain));
        facts.push(("chosen again", again));
        facts.push(("helps", helps));
    }
    let held_out = arrow(e.rmse_heldout_before, e.rmse_heldout_after);
    facts.push(("held out, own strength", held_out));
    facts.push(("training", arrow(e.rmse_before, e.rmse_after)));
    facts
}

fn effect(e: &EffectFinding) -> Effect {
    Effect {
        id: e.id.clone(),
        title: e.title.clone(),
        equation: e.equation.clone(),
        acts_on: e.acts_on.clone(),
        sizes: e.parameters.iter().map(size).collect(),
        others: e
            .class
            .iter()
            .filter(|id| **id != e.id)
            .map(|id| title(id))
            .collect(),
        facts: facts(e),
        source: e.source.clone(),
        measurement: e.measurement.clone(),
    }
}

fn questions(found: &CampaignFindings) -> Vec<Asked> {
    let mut list: Vec<&_> = found.questions.iter().collect();
    list.sort_by(|a, b| {
        a.p_adjusted
            .total_cmp(&b.p_adjusted)
            .then(b.share.total_cmp(&a.share))
    });
    let asked = |q: &&crate::stages::diagnose::findings::Question| Asked {
        cells: [
            q.column.clone(),
            q.blocks.clone(),
            percent(q.share),
            p_words(q.p).trim_start_matches("= ").to_owned(),
            p_words(q.p_adjusted).trim_start_matches("= ").to_owned(),
        ],
        significant: q.p_adjusted < SIGNIFICANT,
    };
    list.iter().map(asked).collect()
}

fn rejected(found: &CampaignFindings) -> Vec<[String; 4]> {
    // A candidate that was chosen first and then failed also stands among those that were not chosen: its first reason says more.
    let mut seen = BTreeSet::new();
    let once = |r: &&Rejected| seen.insert((r.id.clone(), r.acts_on.clone()));
    let row = |r: &Rejected| {
        [
            title(&r.id),
            r.acts_on.clone(),
            percent(r.share),
            r.why.clone(),
        ]
    };
    let first = found.rejected.iter().filter(once).take(REJECTED);
    first.map(row).collect()
}

fn unexplained(u: &Unexplained) -> [String; 6] {
    [
        u.column.clone(),
        u.shape.clone(),
        percent(u.share_of_residual),
        p_words(u.p_adjusted).trim_start_matches("= ").to_owned(),
        perhaps(u.rmse_heldout_before),
        perhaps(u.rmse_heldout_after),
    ]
}

fn unit(f: &FoldErrors) -> [String; 6] {
    [
        f.unit.clone(),
        f.readings.to_string(),
        newtons(f.before),
        newtons(f.after),
        perhaps(f.black_box),
        if f.chosen.is_empty() {
            "nothing".to_owned()
        } else {
            f.chosen.join(", ")
        },
    ]
}

fn reading(r: &Reading) -> [String; 5] {
    [
        r.model.clone(),
        r.parameters.to_string(),
        newtons(r.errors.rmse_train),
        newtons(r.errors.rmse_heldout),
        r.numbers.join("; ").replace("um", "µm"),
    ]
}

fn coefficient(c: &CoefficientChange) -> [String; 6] {
    let rounding = Rounding::ByInterval {
        low: c.ci_low,
        high: c.ci_high,
    };
    let unit = unit_words(&c.unit);
    let name = if unit.is_empty() {
        c.name.clone()
    } else {
        format!("{} ({unit})", c.name)
    };
    [
        name,
        c.published
            .map_or_else(|| "–".to_owned(), |p| rounded(p, Rounding::Digits(4))),
        rounded(c.before, Rounding::Digits(4)),
        rounded(c.after, rounding),
        if c.ci_low < c.ci_high {
            let ends = [c.ci_low, c.ci_high].map(|x| rounded(x, rounding));
            format!("[{}, {}]", ends[0], ends[1])
        } else {
            "–".to_owned()
        },
        c.remark.clone(),
    ]
}

fn limits(found: &CampaignFindings) -> Vec<[String; 4]> {
    let limit = |l: &crate::stages::diagnose::findings::DetectionLimit| {
        let smallest = rounded(l.smallest, Rounding::Digits(2));
        let unit = unit_words(&l.unit);
        let size = if unit.is_empty() {
            smallest
        } else {
            format!("{smallest} {unit}")
        };
        [title(&l.id), l.form.clone(), size, percent(l.visible)]
    };
    found.detection_limits.iter().map(limit).collect()
}

/// Effects that cannot be shown, those of one reason together.
fn by_reason(list: &[NotMeasurable]) -> Vec<(String, Vec<String>)> {
    let mut reasons: Vec<(String, Vec<String>)> = Vec::new();
    for one in list.iter().filter(|n| wanting(n).is_none()) {
        match reasons.iter_mut().find(|(why, _)| *why == one.why) {
            Some((_, ids)) => ids.push(title(&one.id)),
            None => reasons.push((one.why.clone(), vec![title(&one.id)])),
        }
    }
    reasons
}

/// What a campaign lacks for an effect to be shown, where that is why it cannot.
fn wanting(one: &NotMeasurable) -> Option<(String, String)> {
    let what = one.why.strip_prefix("the campaign lacks ")?;
    Some((title(&one.id), what.to_owned()))
}

fn alias(a: &Alias) -> (String, String, String) {
    let cosine = rounded(a.cosine, Rounding::Decimals(2));
    (title(&a.ids[0]), title(&a.ids[1]), cosine)
}

fn next(found: &CampaignFindings) -> Vec<Next> {
    let one = |n: &crate::stages::diagnose::findings::NextMeasurement| Next {
        separates: n.separates.iter().map(|s| words(s)).collect(),
        actions: n.action.split("; ").map(action).collect(),
        difference: n.difference_n.map(newtons),
    };
    found.next_measurement.iter().map(one).collect()
}

/// `id: what to do`, or what to do.
fn action(text: &str) -> (String, String) {
    match text.split_once(": ") {
        Some((id, what)) if crate::effects::index(id).is_some() => (title(id), what.to_owned()),
        _ => (String::new(), text.to_owned()),
    }
}

/// The title of an effect; a reading of the data as it stands.
fn words(id: &str) -> String {
    if crate::effects::index(id).is_some() {
        title(id)
    } else {
        id.to_owned()
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
