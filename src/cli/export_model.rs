//! `pipeline export model`: a model as source code of other languages.

use crate::args::ResultArgs;
use crate::check_session::known;
use crate::places::Places;
use crate::print::{line, print_json};
use crate::{DONE, laws, values};
use clap::builder::PossibleValuesParser;
use pipeline_base::error::{Error, Result};
use pipeline_base::json;
use pipeline_base::row::Row;
use pipeline_diagnose::mixed_law::{MixedLaw, Muscle, Whose};
use pipeline_findings::{CampaignFindings, Findings};
use pipeline_fit::{GroupFit, is_fitted};
use pipeline_portable::domain::State;
use pipeline_portable::languages::File;
use pipeline_portable::model::Spread;
use pipeline_portable::{LANGUAGES, Model, effects, header, source};
use pipeline_predict::interval::free_contraction;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// Arguments of `export model`.
#[derive(Debug, clap::Args)]
#[command(group(clap::ArgGroup::new("source").args(["campaign", "published"]).required(true)))]
pub struct ModelArgs {
    /// The mixed model of this campaign (a pool of them: "pooled-10mm"), with the actuator's effects and without the rig's
    #[arg(long, value_name = "ID")]
    pub campaign: Option<String>,
    /// The published coefficients of a model
    #[arg(long, value_name = "MODEL", value_parser = PossibleValuesParser::new(source::PUBLISHED))]
    pub published: Option<String>,
    /// Nominal diameter, mm [default: that of the campaign, where it has one only]
    #[arg(long, value_name = "MM")]
    pub diameter: Option<String>,
    /// The folder for the files
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// The plain fit by least squares, as in the papers' tables, without effects
    #[arg(long, conflicts_with = "published")]
    pub least_squares: bool,
    /// Which of several effects it is that the readings cannot tell apart, where one is of the actuator and one of the rig
    #[arg(long, value_name = "EFFECT", conflicts_with_all = ["published", "least_squares"])]
    pub alias: Vec<String>,
    /// Replace files of another model that are there already
    #[arg(long)]
    pub replace: bool,
    /// Print the outcome as JSON
    #[arg(long)]
    pub json: bool,
    /// Where an earlier run left its results
    #[command(flatten)]
    pub results: ResultArgs,
}

/// Writes the files, and says what the model is.
pub fn command(args: &ModelArgs) -> Result<u8> {
    let places = args.results.places()?;
    places.check_outside_raw(Some(&args.out), "--out")?;
    let model = model(args)?;
    let files: Vec<File> = LANGUAGES.iter().flat_map(|l| (l.files)(&model)).collect();
    if !args.replace {
        refuse_others(&files, &args.out)?;
    }
    write(&files, &args.out)?;
    if args.json {
        let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
        let said = serde_json::json!({
            "model": model.title,
            "diameter_mm": model.diameter_mm,
            "out": args.out,
            "files": names,
            "effects": model.effects,
        });
        print_json(&said)?;
        return Ok(DONE);
    }
    for text in header::lines(&model) {
        line(text);
    }
    line("");
    for language in LANGUAGES {
        let files = (language.files)(&model);
        let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
        line(format!("{:<18} {}", language.name, names.join(", ")));
    }
    line(format!("{} files in {}", files.len(), args.out.display()));
    Ok(DONE)
}

fn model(args: &ModelArgs) -> Result<Model> {
    let diameter = args.diameter.as_deref();
    let diameter = diameter.map(values::diameter_mm).transpose()?;
    let diameter_mm = diameter.map(|d| d.round() as u32);
    if let Some(published) = &args.published {
        let diameter_mm = diameter_mm.ok_or_else(|| {
            Error::Usage("--published needs --diameter: 10, 20 or 40 mm".to_owned())
        })?;
        return source::of_published(published, diameter_mm);
    }
    let places = args.results.places()?;
    let laws = laws::of_run(&places.derived)?;
    let campaign = args.campaign.as_deref().unwrap_or_default();
    let fit = fit(&laws.fits, campaign, diameter_mm, &places.derived)?;
    let inputs = inputs(&places.reports);
    if args.least_squares {
        return source::of_fit(fit, &inputs);
    }
    let findings = findings(&places.reports)?;
    let Some(found) = assessed(&findings, fit) else {
        let mut model = source::of_fit(fit, &inputs)?;
        model.effects = vec![format!(
            "Effects: not known. These are coefficients of least squares, because there is no mixed model of {}: too few readings or specimens, or a pool \
             that is too large to be searched.",
            fit.group.campaign
        )];
        return Ok(model);
    };
    let of_loop = with_effects(fit, found, &places, &args.alias, &inputs)?;
    let is_worse = of_loop.is_worse();
    let WithEffects {
        mut model, errors, ..
    } = of_loop;
    let law = laws.mixed_of(fit);
    model.spread = law.and_then(|law| spread(law, fit, &model));
    if let Some([with, without]) = errors {
        model.provenance.insert(
            1,
            format!(
                "On the {} readings of the fit, at the lengths and pressures recorded: {}; least squares without effects has {}",
                with.readings,
                with.words(),
                without.words()
            ),
        );
        if is_worse {
            model.provenance.insert(
                2,
                "WARNING: larger than that of least squares: the coefficients assume effects of the rig that the function leaves out. If these effects are not \
                     believed, --least-squares has the plain fit"
                    .to_owned(),
            );
        }
    }
    Ok(model)
}

/// The model of the loop with the effects of the actuator.
struct WithEffects {
    model: Model,
    /// Whether the loop found any effect.
    has_effects: bool,
    /// Its errors and those of the fit on the readings of the fit, where these are known.
    errors: Option<[OnReadings; 2]>,
}

/// The least squares fit has the smallest error that the law can have on its readings; a model with further terms is worse if its own is larger by this
/// factor.
const WORSE: f64 = 1.1;

impl WithEffects {
    /// Whether it does worse than the fit: where effects of the rig are left out of the function that its coefficients assume.
    fn is_worse(&self) -> bool {
        let errors = self.errors.as_ref().filter(|_| self.has_effects);
        errors.is_some_and(|[with, without]| with.rmse_n > WORSE * without.rmse_n)
    }
}

/// The model of the loop for a fit, with its errors.
///
/// # Errors
/// The findings cannot be exported without a choice (`alias`).
fn with_effects(
    fit: &GroupFit,
    found: &CampaignFindings,
    places: &Places,
    alias: &[String],
    inputs: &str,
) -> Result<WithEffects> {
    let model = effects::of_findings(fit, found, alias, inputs)?;
    let rows = known(&places.derived, &places.reports, &places.config)?.rows;
    let plain = source::of_fit(fit, inputs)?;
    let errors = on_readings(&model, &rows, fit).zip(on_readings(&plain, &rows, fit));
    Ok(WithEffects {
        model,
        has_effects: !found.effects.is_empty(),
        errors: errors.map(|(with, without)| [with, without]),
    })
}

/// How a model does on the readings of a fit.
struct OnReadings {
    readings: usize,
    rmse_n: f64,
    /// Mean of measured minus predicted.
    mean_n: f64,
}

impl OnReadings {
    fn words(&self) -> String {
        format!(
            "RMSE {:.2} N, mean error (measured minus predicted) {:+.2} N",
            self.rmse_n, self.mean_n
        )
    }
}

/// The errors on the readings that the fit is of; none where there are none.
fn on_readings(model: &Model, rows: &[Row], fit: &GroupFit) -> Option<OnReadings> {
    let group = &fit.group;
    let is_of_fit = |r: &&Row| group.takes_in(&r.campaign, r.diameter_mm) && is_fitted(r);
    let errors: Vec<f64> = rows
        .iter()
        .filter(is_of_fit)
        .map(|r| {
            let at = State {
                rest_length_m: r.rest_length_m,
                contracted_length_m: r.contracted_length_m,
                length_m: r.length_m,
                pressure_kpa: r.pressure_kpa,
            };
            r.force_n - model.force(&at).force_n
        })
        .filter(|e| e.is_finite())
        .collect();
    let n = errors.len() as f64;
    let squares: f64 = errors.iter().map(|e| e * e).sum();
    (!errors.is_empty()).then(|| OnReadings {
        readings: errors.len(),
        rmse_n: (squares / n).sqrt(),
        mean_n: errors.iter().sum::<f64>() / n,
    })
}

/// The fit of a campaign and diameter.
fn fit<'a>(
    fits: &'a [GroupFit],
    campaign: &str,
    diameter_mm: Option<u32>,
    derived: &Path,
) -> Result<&'a GroupFit> {
    let of = |f: &&GroupFit| {
        f.group.campaign == campaign && diameter_mm.is_none_or(|d| d == f.group.diameter_mm)
    };
    let all: Vec<&GroupFit> = fits.iter().filter(of).collect();
    match all[..] {
        [fit] => Ok(fit),
        [] => {
            let there = fits
                .iter()
                .map(|f| format!("{} ({} mm)", f.group.campaign, f.group.diameter_mm));
            let there: Vec<String> = there.collect();
            Err(Error::Usage(if there.is_empty() {
                format!(
                    "there are no fits in {}: `pipeline run` makes them from sessions; --published new takes the published coefficients",
                    derived.display()
                )
            } else {
                format!(
                    "{} has no fit of a campaign {campaign}{}; there are {}",
                    derived.join("fits.json").display(),
                    diameter_mm.map_or_else(String::new, |d| format!(" and {d} mm")),
                    there.join(", ")
                )
            }))
        }
        _ => {
            let diameters: Vec<String> = all
                .iter()
                .map(|f| f.group.diameter_mm.to_string())
                .collect();
            Err(Error::Usage(format!(
                "{campaign} has fits of {} mm: --diameter picks one",
                diameters.join(" and ")
            )))
        }
    }
}

/// The digest of the raw files of the last run.
fn inputs(reports: &Path) -> String {
    let text = fs::read(reports.join("summary.json")).ok();
    let summary: Option<Value> = text.and_then(|t| serde_json::from_slice(&t).ok());
    let digest = summary.and_then(|s| Some(s.get("input")?.as_str()?.to_owned()));
    digest.unwrap_or_else(|| "not known, because there is no summary.json".to_owned())
}

fn findings(reports: &Path) -> Result<Findings> {
    let path = reports.join("findings.json");
    let text = fs::read(&path).map_err(|e| {
        Error::Usage(format!(
            "cannot read {} ({e}): the mixed model is in it, and `pipeline run` writes it; --least-squares exports the plain fit",
            path.display()
        ))
    })?;
    json::from_slice(&text).map_err(|_| {
        Error::Usage(format!(
            "{} cannot be read: it was written by another version; `pipeline run` rewrites it",
            path.display()
        ))
    })
}

/// Steps of each quantity of the box at which the scatter of muscles is looked at.
const STEPS: usize = 5;

/// How a muscle that was not measured scatters about the function, which lacks the mean of the smooth misfit: its gain, and everything else as its root
/// mean square over the box, where it pulls.
fn spread(law: &MixedLaw, fit: &GroupFit, model: &Model) -> Option<Spread> {
    let muscle = Muscle::unread(law);
    let steps = |(low, high): (f64, f64)| {
        (0..STEPS).map(move |k| low + (high - low) * k as f64 / (STEPS - 1) as f64)
    };
    let (free, _) = free_contraction(fit);
    let (mut freedoms, mut others) = (Vec::new(), Vec::new());
    for rest in steps(fit.ranges.rest_length_m) {
        for rel in steps(fit.ranges.contraction_rel) {
            for kpa in steps(fit.ranges.pressure_kpa) {
                let state = State {
                    rest_length_m: rest,
                    contracted_length_m: rest * (1.0 - free),
                    length_m: rest * (1.0 - rel * free),
                    pressure_kpa: kpa,
                };
                let lengths = [rest, state.contracted_length_m, state.length_m, kpa];
                let forecast = muscle.at(lengths, Whose::Actuator);
                if forecast.law_n > 0.0 {
                    let (gain_n, lacks_n) = (
                        forecast.parts.gain_n,
                        forecast.law_n - model.force(&state).force_n,
                    );
                    freedoms.push(forecast.freedom);
                    others.push(forecast.parts.variance() - gain_n * gain_n + lacks_n * lacks_n);
                }
            }
        }
    }
    freedoms.sort_by(f64::total_cmp);
    let freedom = *freedoms.get(freedoms.len() / 2)?;
    let within_n = (others.iter().sum::<f64>() / others.len() as f64).sqrt();
    let of = "lengths, misfit and the fit itself, root mean square over the box";
    Some(Spread::new(law.sd.gain, within_n, of, freedom))
}

/// What the search says of a fit; none where it has no mixed model of it.
fn assessed<'a>(findings: &'a Findings, fit: &GroupFit) -> Option<&'a CampaignFindings> {
    let group = &fit.group;
    let same = |c: &&CampaignFindings| {
        c.campaign == group.campaign && c.diameter_mm == group.diameter_mm && c.part.is_none()
    };
    let found = findings.campaigns.iter().find(same);
    found.filter(|c| c.not_assessed.is_none())
}

/// Files of another model, which nobody asked to be replaced.
fn refuse_others(files: &[File], out: &Path) -> Result<()> {
    let differs =
        |(name, text): &&File| fs::read(out.join(name)).is_ok_and(|there| there != text.as_bytes());
    match files.iter().find(differs) {
        None => Ok(()),
        Some((name, _)) => Err(Error::Usage(format!(
            "{} already exists and holds something else: name another folder, or give --replace",
            out.join(name).display()
        ))),
    }
}

fn write(files: &[File], out: &Path) -> Result<()> {
    fs::create_dir_all(out).map_err(Error::io("create the folder", out))?;
    for (name, text) in files {
        let path = out.join(name);
        fs::write(&path, text).map_err(Error::io("write", &path))?;
    }
    Ok(())
}
