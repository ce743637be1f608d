//! What a planned campaign could show: the residual search on draws of it.

use crate::design::Plan;
use crate::draw::{CAMPAIGN, rows};
use pipeline_config::{DiagnoseOptions, FitOptions};
use pipeline_diagnose::diagnose;
use pipeline_diagnose::settings::CALIPER_MM;
use pipeline_findings::{Alias, CampaignFindings, NextMeasurement, NotMeasurable, Verdict};
use pipeline_fit::Group;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// Draws of every design.
pub const DRAWS: u64 = 3;

/// The smallest size of an effect that shows in 80 of 100 campaigns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Limit {
    /// Id.
    pub id: String,
    /// Form.
    pub form: String,
    /// Median over the draws.
    pub smallest: f64,
    /// Its unit.
    pub unit: String,
}

/// A design with one thing more.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum More {
    /// A specimen, of this resting length, mm.
    Specimen(f64),
    /// Set lengths that are known to this, mm.
    LengthsKnown(f64),
    /// Contracted lengths that are known to this, mm.
    ContractedKnown(f64),
    /// A relative contraction.
    Contraction(f64),
    /// A log of every session.
    Run,
}

/// What one thing more is worth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Worth {
    /// What.
    pub more: More,
    /// Expected error with it, N.
    pub expected_rmse_n: f64,
    /// By how much that is less, N; draws leave it uncertain by about as much as `spread_n`.
    pub less_n: f64,
    /// Standard error of `less_n` over the draws.
    pub spread_n: f64,
}

/// What a planned campaign could show.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Foreseen {
    /// Draws, and those in which something was found although nothing was put in.
    pub draws: (usize, usize),
    /// Expected error on an unseen specimen, N.
    pub expected_rmse_n: Option<f64>,
    /// What it is made of: source, N.
    pub budget: Vec<(String, f64)>,
    /// The same with the gain and the lengths of the specimen known, N.
    pub calibrated_rmse_n: Option<f64>,
    /// Detection limits.
    pub limits: Vec<Limit>,
    /// Effects that most draws could not have shown.
    pub not_measurable: Vec<NotMeasurable>,
    /// Effects that look alike in this design.
    pub aliases: Vec<Alias>,
    /// Best next set points and what else the search of the first draw would measure next.
    pub next: Vec<NextMeasurement>,
    /// What one thing more is worth, most first.
    pub worth: Vec<Worth>,
}

/// Foresees a campaign. `done` is told of every draw that is searched, with the number of all. None where the search has no answer in any draw.
pub fn foresee(plan: &Plan, done: &(dyn Fn(usize, usize) + Sync)) -> Option<Foreseen> {
    let more = more(plan);
    let designs: Vec<Plan> = std::iter::once(plan.clone())
        .chain(more.iter().map(|m| with(plan, *m)))
        .collect();
    let jobs: Vec<(usize, u64)> = (0..designs.len())
        .flat_map(|d| (1..=DRAWS).map(move |seed| (d, seed)))
        .collect();
    let counter = std::sync::atomic::AtomicUsize::new(0);
    let answers: Vec<Option<CampaignFindings>> = jobs
        .par_iter()
        .map(|(design, seed)| {
            let found = searched(&designs[*design], *seed);
            let so_far = 1 + counter.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            done(so_far, jobs.len());
            found
        })
        .collect();
    let mut of_designs = answers.chunks(DRAWS as usize);
    let own: Vec<&CampaignFindings> = of_designs.next()?.iter().flatten().collect();
    let first = *own.first()?;
    let expected = |all: &[Option<CampaignFindings>]| -> Vec<Option<f64>> {
        let of = |f: &Option<CampaignFindings>| f.as_ref()?.expected_rmse_heldout;
        all.iter().map(of).collect()
    };
    let base = expected(&answers[..DRAWS as usize]);
    let mut worth: Vec<Worth> = more
        .iter()
        .zip(of_designs)
        .filter_map(|(m, all)| worth(*m, &base, &expected(all)))
        .collect();
    worth.sort_by(|a, b| b.less_n.total_cmp(&a.less_n));
    let of_all = |of: fn(&CampaignFindings) -> Option<f64>| {
        median(own.iter().filter_map(|f| of(f)).collect())
    };
    Some(Foreseen {
        draws: (
            own.len(),
            own.iter().filter(|f| f.verdict != Verdict::None).count(),
        ),
        expected_rmse_n: of_all(|f| f.expected_rmse_heldout),
        calibrated_rmse_n: of_all(|f| f.before.rmse_heldout_calibrated),
        budget: budget(&own),
        limits: limits(&own),
        not_measurable: not_measurable(&own),
        aliases: first.aliases.clone(),
        next: first.next_measurement.clone(),
        worth,
    })
}

fn searched(plan: &Plan, seed: u64) -> Option<CampaignFindings> {
    let group = Group {
        campaign: CAMPAIGN.to_owned(),
        diameter_mm: plan.diameter_mm,
        members: vec![CAMPAIGN.to_owned()],
        simulated: true,
    };
    let rows = rows(plan, seed);
    let options = DiagnoseOptions::default();
    diagnose(&group, &rows, &FitOptions::default(), &options).map(|d| d.findings)
}

/// What could be had more.
fn more(plan: &Plan) -> Vec<More> {
    let mut all = vec![
        More::Specimen(
            in_largest_gap(&plan.rest_lengths_mm)
                .unwrap_or(250.0)
                .round(),
        ),
        More::LengthsKnown(CALIPER_MM),
        More::ContractedKnown(CALIPER_MM),
        More::Run,
    ];
    all.extend(in_largest_gap(&plan.contractions).map(More::Contraction));
    all
}

/// The middle of the largest gap of a rising list.
fn in_largest_gap(values: &[f64]) -> Option<f64> {
    let gaps = values.windows(2);
    let largest = gaps.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
    Some(0.5 * (largest[0] + largest[1]))
}

fn with(plan: &Plan, more: More) -> Plan {
    let mut with = plan.clone();
    match more {
        More::Specimen(rest_mm) => with.rest_lengths_mm.push(rest_mm),
        More::LengthsKnown(sd_mm) => {
            with.scatter.length_mm = plan.scatter.length_mm.min(sd_mm);
            with.declared_length_mm = Some(sd_mm);
        }
        More::ContractedKnown(sd_mm) => with.declared_contracted_mm = Some(sd_mm),
        More::Contraction(contraction) => with.contractions.push(contraction),
        More::Run => with.runs += 1,
    }
    with
}

/// Draw by draw, so that what a draw has is the same with and without.
fn worth(more: More, base: &[Option<f64>], with: &[Option<f64>]) -> Option<Worth> {
    let less: Vec<f64> = base
        .iter()
        .zip(with)
        .filter_map(|(a, b)| Some((*a)? - (*b)?))
        .collect();
    let n = less.len() as f64;
    let mean = less.iter().sum::<f64>() / n;
    let squares: f64 = less.iter().map(|x| (x - mean) * (x - mean)).sum();
    (less.len() > 1).then_some(())?;
    Some(Worth {
        more,
        expected_rmse_n: median(with.iter().flatten().copied().collect())?,
        less_n: mean,
        spread_n: (squares / (n * (n - 1.0))).sqrt(),
    })
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    (n > 0).then(|| 0.5 * (values[(n - 1) / 2] + values[n / 2]))
}

fn budget(own: &[&CampaignFindings]) -> Vec<(String, f64)> {
    let mut by_source: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for entry in own.iter().flat_map(|f| &f.budget) {
        by_source.entry(&entry.source).or_default().push(entry.rmse);
    }
    let parts = by_source.into_iter();
    let mut parts: Vec<(String, f64)> = parts
        .filter_map(|(source, all)| Some((source.to_owned(), median(all)?)))
        .filter(|(_, n)| *n > 0.0)
        .collect();
    parts.sort_by(|a, b| b.1.total_cmp(&a.1));
    parts
}

/// The limits that more than half of the draws have.
fn limits(own: &[&CampaignFindings]) -> Vec<Limit> {
    let mut all: BTreeMap<(&str, &str, &str), Vec<f64>> = BTreeMap::new();
    for l in own.iter().flat_map(|f| &f.detection_limits) {
        all.entry((&l.id, &l.form, &l.unit))
            .or_default()
            .push(l.smallest);
    }
    all.into_iter()
        .filter(|(_, sizes)| 2 * sizes.len() > own.len())
        .filter_map(|((id, form, unit), sizes)| {
            Some(Limit {
                id: id.to_owned(),
                form: form.to_owned(),
                unit: unit.to_owned(),
                smallest: median(sizes)?,
            })
        })
        .collect()
}

/// What more than half of the draws could not have shown.
fn not_measurable(own: &[&CampaignFindings]) -> Vec<NotMeasurable> {
    let Some(first) = own.first() else {
        return Vec::new();
    };
    let often = |none: &&NotMeasurable| {
        let has = |f: &&&CampaignFindings| {
            let mut all = f.not_measurable.iter();
            all.any(|n| n.id == none.id && n.form == none.form)
        };
        2 * own.iter().filter(has).count() > own.len()
    };
    first.not_measurable.iter().filter(often).cloned().collect()
}
