//! The pages of `knee.pdf`: torque about a knee, the geometry behind it, and the human muscles beside it.

use crate::figures::Drawn;
use crate::input::ReportInput;
use crate::number::Rounding;
use crate::pages::{PageData, Picture};
use crate::tables::knee as tables;
use crate::typeset::Pdf;
use crate::wording::name;
use crate::wording::number::{error_or_none, error_with_unit};
use crate::wording::sentence::{answer_in_short, sentences};
use pipeline_base::error::Result;
use pipeline_base::names::file_name;
use pipeline_findings::CampaignFindings;
use pipeline_torque::diagnose::fittings::{FittingFit, LAWS, Origin};
use pipeline_torque::errors::Size;
use pipeline_torque::{CampaignTorque, Configuration, Test};
use serde::Serialize;

const TEMPLATE: &str = include_str!("templates/knee.typ");
/// Configurations whose figures the pages of a campaign show; the supplement has the others.
const MOST_CONFIGURATIONS: usize = 1;

/// The figures that the pages show.
pub struct Figures<'a> {
    /// By campaign, in the order of the input; in each the configurations, then the joints, none where a figure was left out.
    pub campaigns: &'a [Vec<Option<Drawn>>],
    /// The legs.
    pub legs: &'a [Option<Drawn>],
    /// The laws of force, the human muscles, the design.
    pub once: &'a [Option<Drawn>],
}

/// The data of the template.
#[derive(Serialize)]
struct Own {
    /// The joints on the first page.
    opening: Vec<Opening>,
    campaigns: Vec<Campaign>,
    once: Vec<Picture>,
}

#[derive(Serialize)]
struct Campaign {
    id: String,
    slug: String,
    simulated: bool,
    tests: usize,
    configurations: usize,
    readings: usize,
    beyond: usize,
    /// Tests that are left out: session, why, and where one is fitted all the same; empty if nowhere.
    excluded: Vec<[String; 3]>,
    /// Whether doubtful tests are fitted where a joint has no others.
    doubtful_alone: bool,
    fits: Vec<Fit>,
    joints: Vec<Joint>,
    by_hand: bool,
    /// Configurations whose figures are in the supplement.
    further: usize,
    figures: Vec<Picture>,
}

/// One joint on the first page.
#[derive(Serialize)]
struct Opening {
    name: String,
    simulated: bool,
    tests: usize,
    /// Errors of the rigid leg and with what was found, on the tests themselves; on unseen actuators.
    errors: [String; 4],
    /// What was found and what would help, in sentences.
    answer: Vec<String>,
}

/// What the loop says of one joint; `residual.pdf` has the evidence.
#[derive(Serialize)]
struct Joint {
    title: String,
    sentences: Vec<String>,
    figure: Option<Picture>,
}

/// The fit to the configuration with most readings, beside the stated length.
#[derive(Serialize)]
struct Fit {
    muscle: String,
    diameter_mm: u32,
    specimen: String,
    stated: String,
    fitted: String,
    interval: Option<[String; 2]>,
    interval_by: String,
    before: Errors,
    after: Errors,
    held_out_before: Option<Errors>,
    held_out_after: Option<Errors>,
}

#[derive(Serialize)]
struct Errors {
    n: usize,
    sse: String,
    rmse: String,
}

/// Typesets `knee.pdf`; none where nobody measured torque.
///
/// # Errors
/// A template that does not compile.
pub fn knee_pdf(
    input: &ReportInput,
    figures: &Figures,
    date: Option<(i32, u8, u8)>,
) -> Result<Option<Pdf>> {
    if input.knee.is_none() {
        return Ok(None);
    }
    let campaigns = input.torque();
    let pairs = campaigns.iter().zip(figures.campaigns);
    let own = Own {
        opening: campaigns.iter().flat_map(openings).collect(),
        campaigns: pairs.map(|(c, f)| campaign(c, f)).collect(),
        once: figures.once.iter().flatten().map(Picture::new).collect(),
    };
    let simulated = campaigns.iter().map(|c| c.simulated);
    let of_campaigns = campaigns.iter().flat_map(tables::of_campaign);
    let drawn = figures.campaigns.iter().flatten();
    let document = PageData::new(&input.input_digest, simulated, own)
        .document(TEMPLATE, date)?
        .with_tables(of_campaigns.chain(tables::once(input)))
        .with_figures(drawn.chain(figures.once).flatten());
    document.compile().map(Some)
}

fn campaign(c: &CampaignTorque, figures: &[Option<Drawn>]) -> Campaign {
    let tests = || c.configurations.iter().flat_map(|c| &c.tests);
    let points = || tests().flat_map(|t| &t.points);
    let alone = c
        .diagnoses
        .iter()
        .filter(|j| j.findings.design.doubtful_only);
    let fitted = alone.flat_map(|j| j.tests.iter().filter(|t| t.fitted));
    let fitted: Vec<&str> = fitted.map(|t| t.session.as_str()).collect();
    let left_out = |t: &Test| {
        let but = if fitted.contains(&t.session.as_str()) {
            " except the search of its joint, which has no other test"
        } else {
            ""
        };
        Some([t.session.clone(), t.left_out_because()?, but.to_owned()])
    };
    Campaign {
        id: c.campaign.clone(),
        slug: file_name(&c.campaign),
        simulated: c.simulated,
        tests: tests().count(),
        configurations: c.configurations.len(),
        readings: points().count(),
        beyond: points().filter(|p| p.beyond.is_some()).count(),
        excluded: tests().filter_map(left_out).collect(),
        doubtful_alone: c.diagnoses.iter().any(|j| j.findings.design.doubtful_only),
        fits: c.fits.iter().filter_map(|f| fit(c, f)).collect(),
        joints: joints(c, figures),
        by_hand: c.diagnoses.iter().any(|j| !j.by_hand.is_empty()),
        further: further_configurations(c, figures).count(),
        figures: of_configurations(c, figures)
            .take(MOST_CONFIGURATIONS)
            .map(Picture::new)
            .collect(),
    }
}

/// The figures of the configurations, those with most readings first.
fn of_configurations<'a>(
    c: &'a CampaignTorque,
    figures: &'a [Option<Drawn>],
) -> impl Iterator<Item = &'a Drawn> {
    let mut order: Vec<usize> = (0..c.configurations.len()).collect();
    let readings = |k: &usize| {
        let tests = c.configurations[*k].tests.iter();
        tests.map(|t| t.points.len()).sum::<usize>()
    };
    order.sort_by_key(|k| std::cmp::Reverse(readings(k)));
    order.into_iter().filter_map(|k| figures[k].as_ref())
}

/// Those of them for which the pages have no room: the supplement shows them.
pub(crate) fn further_configurations<'a>(
    c: &'a CampaignTorque,
    figures: &'a [Option<Drawn>],
) -> impl Iterator<Item = &'a Drawn> {
    of_configurations(c, figures).skip(MOST_CONFIGURATIONS)
}

fn openings(c: &CampaignTorque) -> impl Iterator<Item = Opening> {
    c.diagnoses.iter().map(|joint| {
        let found = &joint.findings;
        let error = |e: Option<f64>| error_or_none(e, &found.unit);
        Opening {
            name: name::campaign(found),
            simulated: found.simulated,
            tests: found.design.sessions,
            errors: [
                error(found.before.rmse_train),
                error(found.after.rmse_train),
                error(found.before.rmse_heldout),
                error(found.after.rmse_heldout),
            ],
            answer: answer_in_short(found),
        }
    })
}

/// The joints with their figures, which come after those of the configurations.
fn joints(c: &CampaignTorque, figures: &[Option<Drawn>]) -> Vec<Joint> {
    let of_joints = &figures[c.configurations.len()..];
    let with_figures = c.diagnoses.iter().zip(of_joints);
    with_figures
        .map(|(j, figure)| Joint {
            figure: figure.as_ref().map(Picture::new),
            ..joint(c, &j.findings)
        })
        .collect()
}

fn joint(c: &CampaignTorque, found: &CampaignFindings) -> Joint {
    let part = found.part.as_deref().unwrap_or_default();
    let one_length = found.after.rmse_heldout.and(one_length(c, found));
    let beside = one_length.map(|error| {
        format!(
            "For comparison: one length of the end fittings alone, fitted without the actuator, has {} on the same unseen actuators.",
            error_with_unit(error, &found.unit)
        )
    });
    Joint {
        title: name::capitalised(&format!("{part}, {} mm", found.diameter_mm)),
        sentences: sentences(found).into_iter().chain(beside).collect(),
        figure: None,
    }
}

/// The root mean square error on the actuators of a joint, each with one length of the fittings that was fitted to all others, by the law of the loop; none
/// where nothing was held out.
pub(crate) fn one_length(c: &CampaignTorque, found: &CampaignFindings) -> Option<f64> {
    let is_of_joint = |id: &str| {
        let of = c.configurations.iter().find(|c| c.id == id);
        of.is_some_and(|c| c.diameter_mm == found.diameter_mm && Some(c.joint()) == found.part)
    };
    let without = c.fits.iter().filter(|f| {
        f.origin == Origin::Without
            && f.diameter_mm == found.diameter_mm
            && f.law == found.base_model
    });
    let held_out = without.flat_map(|f| &f.on).filter(|o| !o.fitted);
    let held_out = held_out.filter(|o| is_of_joint(&o.configuration));
    let (n, sse) = held_out.fold((0, 0.0), |(n, sse), o| (n + o.size.n, sse + o.size.sse));
    (n > 0).then(|| (sse / n as f64).sqrt())
}

/// What a fit to the largest configuration, with the first law, has changed.
fn fit(c: &CampaignTorque, fit: &FittingFit) -> Option<Fit> {
    if fit.origin != Origin::Largest || fit.law != LAWS[0] {
        return None;
    }
    let same = |f: &&FittingFit| {
        f.origin == Origin::Stated
            && (f.diameter_mm, &f.muscle, &f.law) == (fit.diameter_mm, &fit.muscle, &fit.law)
    };
    let stated = c.fits.iter().find(same)?;
    let fitted_on = fit.on.iter().find(|o| o.fitted)?;
    let before = stated
        .on
        .iter()
        .find(|o| o.configuration == fitted_on.configuration)?;
    let others = |f: &FittingFit| -> Option<Errors> {
        let all = f.on.iter();
        let others = all.filter(|o| o.configuration != fitted_on.configuration);
        let (n, sse) = others.fold((0, 0.0), |(n, sse), o| (n + o.size.n, sse + o.size.sse));
        (n > 0).then(|| Errors {
            n,
            sse: decimals(sse, 1),
            rmse: decimals((sse / n as f64).sqrt(), 2),
        })
    };
    let configuration = |id: &str| {
        c.configurations
            .iter()
            .find(|c: &&Configuration| c.id == id)
    };
    Some(Fit {
        muscle: fit.muscle.clone(),
        diameter_mm: fit.diameter_mm,
        specimen: fit.specimen.clone(),
        stated: decimals(1e3 * configuration(&fitted_on.configuration)?.fitting_m, 1),
        fitted: decimals(1e3 * fit.fitting_m, 1),
        interval: fit
            .interval_m
            .map(|(low, high)| [low, high].map(|x| decimals(1e3 * x, 1))),
        interval_by: fit.interval_by.clone(),
        before: errors(&before.size),
        after: errors(&fitted_on.size),
        held_out_before: others(stated),
        held_out_after: others(fit),
    })
}

fn errors(size: &Size) -> Errors {
    Errors {
        n: size.n,
        sse: decimals(size.sse, 1),
        rmse: decimals(size.rmse, 2),
    }
}

fn decimals(value: f64, decimals: usize) -> String {
    let rounded = Rounding::Decimals(decimals).round(value);
    rounded.map_or_else(|| "–".to_owned(), |n| n.typeset())
}
