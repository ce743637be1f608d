//! `pipeline diff`: two campaigns, two runs or two versions side by side.

use crate::args::ResultArgs;
use crate::columns::{Align, aligned, plain};
use crate::diff_tables::sections;
use crate::print::{counted, line, print_json};
use crate::summary::{GroupModels, models_of_run};
use crate::{DONE, laws};
use pipeline_base::error::{Error, Result};
use pipeline_config::Config;
use pipeline_findings::{CampaignFindings, Findings};
use pipeline_fit::GroupFit;
use pipeline_fit::engine::CoefficientFit;
use pipeline_fit::equations::JOINT;
use pipeline_predict::difference::{Difference, Measured, NotCompared, Outcome, Point, difference};
use pipeline_predict::muscle::mm;
use pipeline_report::wording::number::percent;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Arguments of `diff`.
#[derive(Debug, clap::Args)]
pub struct DiffArgs {
    /// A campaign of this project, the folder of another project, or FOLDER:CAMPAIGN
    #[arg(value_name = "A")]
    pub first: String,
    /// What to compare it with, in the same form
    #[arg(value_name = "B")]
    pub second: String,
    /// Margin of equivalence, as a share of the force at resting length and 620 kPa; Festo states 10% for actuators of one type
    #[arg(long, value_name = "SHARE", default_value = "10%")]
    pub margin: String,
    /// Only this diameter, mm
    #[arg(long, value_name = "MM")]
    pub diameter: Option<u32>,
    /// Print tables in Markdown, for a pull request
    #[arg(long, conflicts_with = "json")]
    pub markdown: bool,
    /// Print everything as JSON
    #[arg(long)]
    pub json: bool,
    /// Where results of this project are
    #[command(flatten)]
    pub results: ResultArgs,
}

/// Exit code where forces differ, or where it is not shown that they do not.
const NOT_ALIKE: u8 = 1;

/// What a run left.
struct Run {
    /// As it was named.
    name: String,
    fits: Vec<GroupFit>,
    findings: Vec<CampaignFindings>,
    models: Vec<GroupModels>,
    /// The campaign that is meant; all where none was named.
    campaign: Option<String>,
}

/// One side of a comparison.
pub(super) struct Side<'r> {
    pub name: String,
    pub fit: &'r GroupFit,
    pub found: Option<&'r CampaignFindings>,
    pub models: Option<&'r GroupModels>,
}

/// Compares, and prints.
pub fn command(args: &DiffArgs) -> Result<u8> {
    let margin = crate::values::fraction("--margin", &args.margin)?;
    if !(margin > 0.0 && margin < 1.0) {
        return Err(Error::Usage(format!(
            "--margin {}: a share above 0 and below 1; write 10% or 0.1",
            args.margin
        )));
    }
    let runs = [run(args, &args.first)?, run(args, &args.second)?];
    let pairs = pairs(args, &runs)?;
    let mut all_alike = true;
    let mut values = Vec::new();
    for [first, second] in &pairs {
        let force = difference(first.fit, second.fit, margin);
        all_alike &= force
            .as_ref()
            .is_ok_and(|d| d.outcome == Outcome::Equivalent);
        if args.json {
            values.push(as_json(first, second, force));
        } else {
            print(args, [first, second], force, margin);
        }
    }
    if args.json {
        print_json(&Value::Array(values))?;
    }
    let lost = unmatched(&runs);
    all_alike &= lost.is_empty();
    for text in lost {
        eprintln!("warning: {text}");
    }
    Ok(if all_alike { DONE } else { NOT_ALIKE })
}

/// Campaigns of two whole projects that only one of them has.
fn unmatched([first, second]: &[Run; 2]) -> Vec<String> {
    if first.campaign.is_some() || second.campaign.is_some() {
        return Vec::new();
    }
    let only = |own: &Run, other: &Run| -> Vec<String> {
        let has = |f: &GroupFit| other.fits.iter().any(|o| o.group == f.group);
        let lost = own.fits.iter().filter(|f| !has(f));
        lost.map(|f| {
            format!(
                "only in {}: {}, {} mm",
                own.name, f.group.campaign, f.group.diameter_mm
            )
        })
        .collect()
    };
    [only(first, second), only(second, first)].concat()
}

/// What a run left, by its name on the command line.
fn run(args: &DiffArgs, named: &str) -> Result<Run> {
    let (folder, campaign) = parted(named);
    let (derived, reports) = match &folder {
        None => {
            let places = args.results.places()?;
            (places.derived, places.reports)
        }
        Some(folder) => places_of(folder)?,
    };
    let fits = laws::fits(&derived)?;
    if fits.is_empty() {
        return Err(Error::Usage(format!(
            "there are no fits in {}: `pipeline run` makes them from sessions",
            derived.display()
        )));
    }
    let file = reports.join("findings.json");
    let findings = std::fs::read(&file).map_err(Error::io("read", &file))?;
    let findings: Findings = pipeline_base::json::from_slice(&findings).map_err(|_| {
        Error::Usage(format!(
            "{} is not in the format of this version; `pipeline run` rewrites it",
            file.display()
        ))
    })?;
    Ok(Run {
        name: named.to_owned(),
        fits,
        findings: findings.campaigns,
        models: models_of_run(&reports),
        campaign,
    })
}

/// The folder and the campaign of a name: a folder that is there, one with a campaign behind a colon, or a campaign.
fn parted(named: &str) -> (Option<PathBuf>, Option<String>) {
    let whole = PathBuf::from(named);
    if whole.is_dir() {
        return (Some(whole), None);
    }
    match named.rsplit_once(':') {
        Some((folder, campaign)) if Path::new(folder).is_dir() => {
            (Some(folder.into()), Some(campaign.to_owned()))
        }
        _ => (None, Some(named.to_owned())),
    }
}

/// Where a project keeps its results.
fn places_of(folder: &Path) -> Result<(PathBuf, PathBuf)> {
    let file = folder.join("pipeline.toml");
    let config = Config::load(file.is_file().then_some(file.as_path()))?;
    let below = |path: &Path| {
        if path.is_absolute() || path.starts_with(folder) {
            path.to_owned()
        } else {
            folder.join(path)
        }
    };
    Ok((below(&config.paths.derived), below(&config.paths.reports)))
}

/// What is compared with what: fits of one diameter, of the campaigns that were named, or of those that both runs have.
fn pairs<'r>(args: &DiffArgs, [first, second]: &'r [Run; 2]) -> Result<Vec<[Side<'r>; 2]>> {
    let of = |run: &'r Run| -> Result<Vec<Side<'r>>> {
        let is = |f: &&GroupFit| {
            let campaign = run.campaign.as_ref();
            let diameter = args.diameter.is_none_or(|d| d == f.group.diameter_mm);
            campaign.is_none_or(|c| *c == f.group.campaign) && diameter
        };
        let sides: Vec<Side> = run
            .fits
            .iter()
            .filter(is)
            .map(|f| Side::of(run, f))
            .collect();
        if sides.is_empty() {
            let known: Vec<&str> = run.fits.iter().map(|f| f.group.campaign.as_str()).collect();
            return Err(Error::Usage(format!(
                "{} is not a campaign with a force fit{}; there are {}",
                run.name,
                args.diameter
                    .map_or_else(String::new, |d| format!(" for {d} mm")),
                known.join(", ")
            )));
        }
        Ok(sides)
    };
    let others = of(second)?;
    let by_name = first.campaign.is_some() && second.campaign.is_some();
    let mut pairs = Vec::new();
    for side in of(first)? {
        let own = &side.fit.group;
        let alike = |o: &&Side| {
            let other = &o.fit.group;
            own.diameter_mm == other.diameter_mm && (by_name || own.campaign == other.campaign)
        };
        if let Some(other) = others.iter().find(alike) {
            pairs.push([side, other.clone()]);
        }
    }
    if pairs.is_empty() {
        return Err(Error::Usage(format!(
            "{} and {} have no fit of the same diameter{} in common",
            first.name,
            second.name,
            if by_name { "" } else { " and campaign" }
        )));
    }
    Ok(pairs)
}

impl Clone for Side<'_> {
    fn clone(&self) -> Self {
        Self {
            name: self.name.clone(),
            ..*self
        }
    }
}

impl<'r> Side<'r> {
    fn of(run: &'r Run, fit: &'r GroupFit) -> Self {
        let group = &fit.group;
        let is = |campaign: &str, diameter: u32| {
            campaign == group.campaign && diameter == group.diameter_mm
        };
        let mut findings = run.findings.iter();
        let mut models = run.models.iter();
        let name = match run.campaign {
            Some(_) => run.name.clone(),
            None => format!("{}:{}", run.name, group.campaign),
        };
        Self {
            name,
            fit,
            found: findings.find(|f| f.part.is_none() && is(&f.campaign, f.diameter_mm)),
            models: models.find(|m| is(&m.campaign, m.diameter_mm)),
        }
    }

    pub fn coefficients(&self) -> &[CoefficientFit] {
        let joint = self.fit.equation(JOINT);
        joint.map_or(&[], |e| e.coefficients.as_slice())
    }
}

/// The comparison of the forces, or why there is none.
type Force = std::result::Result<Difference, NotCompared>;

fn print(args: &DiffArgs, sides: [&Side; 2], force: Force, margin: f64) {
    let [first, second] = sides;
    let mark = if args.markdown { "## " } else { "" };
    line(format!(
        "{mark}{} against {}, {} mm\n",
        second.name, first.name, first.fit.group.diameter_mm
    ));
    line(match &force {
        Ok(difference) => conclusion(difference, sides, margin),
        Err(why) => not_compared(why, sides),
    });
    for section in sections(sides) {
        if args.markdown {
            line(format!("\n### {}\n", section.title));
            markdown(&section.rows).into_iter().for_each(line);
        } else {
            line(format!("\n{}", section.title));
            let width = section.rows.first().map_or(0, Vec::len);
            let mut columns = vec![Align::Right; width];
            columns[0] = Align::Left;
            for text in aligned(&section.rows, &columns) {
                line(format!("  {text}"));
            }
        }
    }
    line("");
}

/// A table of Markdown; the first row is its head.
fn markdown(rows: &[Vec<String>]) -> Vec<String> {
    let of = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|c| plain(c).replace('|', "\\|")).collect();
        format!("| {} |", cells.join(" | "))
    };
    let mut lines: Vec<String> = rows.iter().map(|r| of(r)).collect();
    let width = rows.first().map_or(0, Vec::len);
    lines.insert(
        1,
        format!("|---|{}", "---:|".repeat(width.saturating_sub(1))),
    );
    lines
}

/// Whether the forces are alike, in a sentence or two.
fn conclusion(d: &Difference, sides: [&Side; 2], margin: f64) -> String {
    let margin_text = percent(margin);
    let Point {
        rest_length_m,
        contraction_rel,
        pressure_kpa,
        first_n,
        second_n,
        share,
        ..
    } = d.largest;
    let place = format!(
        "The largest difference of the fitted forces is {:+.1}% of the force at resting length and 620 kPa, at {}, relative contraction {contraction_rel:.2} and \
         {pressure_kpa:.0} kPa ({} {first_n:.1} N, {} {second_n:.1} N); root mean square {}.",
        100.0 * share,
        mm(rest_length_m),
        sides[0].name,
        sides[1].name,
        percent(d.rms_share)
    );
    let reach = d.furthest.interval.map_or_else(String::new, |(low, high)| {
        format!(
            " 90% intervals reach {:+.1}%.",
            100.0 * if low.abs() > high.abs() { low } else { high }
        )
    });
    let verdict = match d.outcome {
        Outcome::Equivalent => format!("Equivalent at a margin of {margin_text}."),
        Outcome::Different => format!("Different by more than the margin of {margin_text}."),
        Outcome::Undecided => {
            format!("Neither equivalence nor a difference is shown at a margin of {margin_text}.")
        }
    };
    let shared = match d.shared {
        0 => "",
        1 => " One specimen is in both fits.",
        _ => " Specimens that are in both fits are paired.",
    };
    let untested = without_interval(sides).filter(|_| d.freedom.is_none());
    format!(
        "{verdict}{} {place}{reach}{shared}",
        untested.unwrap_or_default()
    )
}

/// Why there is no interval about a difference: the refits without each specimen make it.
fn without_interval(sides: [&Side; 2]) -> Option<String> {
    let side = sides.into_iter().min_by_key(|s| s.fit.specimens.len())?;
    Some(format!(
        " There is no test, because {} has {}: how far actuators differ is seen from two or more in each.",
        side.name,
        counted(side.fit.specimens.len(), "specimen", "specimens")
    ))
}

/// Why the forces are not compared, and what would help.
fn not_compared(why: &NotCompared, sides: [&Side; 2]) -> String {
    let names = sides.map(|side| side.name.as_str());
    match why {
        NotCompared::NoLaw { side } => format!(
            "The forces are not compared: {} has no jointly fitted law; it has {} of {}.",
            names[*side],
            counted(sides[*side].fit.rows, "reading", "readings"),
            counted(sides[*side].fit.specimens.len(), "specimen", "specimens")
        ),
        NotCompared::Apart {
            quantity,
            first,
            second,
        } => {
            let (name, scale, decimals, unit) = match quantity {
                Measured::RestLength => ("resting lengths", 1e3, 1, " mm"),
                Measured::ContractionRel => ("relative contractions", 1.0, 2, ""),
                Measured::Pressure => ("pressures", 1.0, 0, " kPa"),
            };
            let of = |(low, high): &(f64, f64)| {
                let [low, high] = [low, high].map(|x| format!("{:.decimals$}", scale * x));
                if low == high {
                    format!("{low}{unit}")
                } else {
                    format!("{low} to {high}{unit}")
                }
            };
            format!(
                "The forces are not compared: the {name} that were measured do not overlap, {} in {} and {} in {}. Laws are compared only where both \
                 were measured; a specimen within the range of the other, or several on both sides of it, would make that possible.",
                of(first),
                names[0],
                of(second),
                names[1]
            )
        }
    }
}

/// A side as values.
fn side_as_json(side: &Side) -> Value {
    let models = side.models.into_iter().flat_map(|m| {
        let of = |id| Some((id, m.rmse(id)?));
        m.ids().filter_map(of)
    });
    json!({
        "name": side.name,
        "campaign": side.fit.group.campaign,
        "specimens": side.fit.specimens.len(),
        "sessions": side.fit.specimens.iter().map(|s| s.sessions).sum::<usize>(),
        "readings": side.fit.rows,
        "coefficients": side.coefficients(),
        "rmse_unseen_n": models.collect::<BTreeMap<&str, f64>>(),
        "verdict": side.found.map(|f| f.verdict),
        "before": side.found.map(|f| &f.before),
        "after": side.found.map(|f| &f.after),
        "effects": side.found.map(|f| &f.effects),
        "unexplained": side.found.map(|f| &f.unexplained),
    })
}

fn as_json(first: &Side, second: &Side, force: Force) -> Value {
    json!({
        "diameter_mm": first.fit.group.diameter_mm,
        "not_compared": force.as_ref().err(),
        "force": force.ok(),
        "first": side_as_json(first),
        "second": side_as_json(second),
    })
}
