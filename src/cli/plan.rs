//! `pipeline plan`: a campaign that has not been measured yet.

use crate::args::ResultArgs;
use crate::columns::{Align, aligned};
use crate::print::{line, print_json};
use crate::{DONE, check_session};
use indicatif::{ProgressBar, ProgressStyle};
use pipeline_base::error::{Error, Result};
use pipeline_findings::{CampaignFindings, NextKind};
use pipeline_plan::design::{self, Plan, Scatter};
use pipeline_plan::foresee::{Foreseen, Limit, More, Worth, foresee};
use pipeline_report::number::Rounding;
use pipeline_report::wording::name;
use pipeline_report::wording::number::{percent, rounded, with_unit};
use pipeline_report::wording::sentence::conditions;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `plan`.
#[derive(Debug, clap::Args)]
pub struct PlanArgs {
    /// The plan
    #[arg(value_name = "PLAN.toml", required_unless_present = "example")]
    pub plan: Option<PathBuf>,
    /// Print a plan to begin with
    #[arg(long)]
    pub example: bool,
    /// Write the detection limits as CSV
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Print everything as JSON
    #[arg(long)]
    pub json: bool,
    /// Where an earlier run left findings.json
    #[command(flatten)]
    pub results: ResultArgs,
}

/// Foresees, and prints.
pub fn command(args: &PlanArgs) -> Result<u8> {
    let Some(path) = args.plan.as_ref().filter(|_| !args.example) else {
        line(design::EXAMPLE.trim_end());
        return Ok(DONE);
    };
    let places = args.results.places()?;
    places.check_outside_raw(args.csv.as_deref(), "--csv")?;
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|e| Error::Usage(format!("cannot read the plan {file}: {e}")))?;
    let mut plan = design::read(&file, &text).map_err(Error::Config)?;
    if let Some(campaign) = plan.scatter_of.clone() {
        plan.scatter = scatter_of(args, &campaign, plan.diameter_mm)?;
    }
    let style = ProgressStyle::with_template("{bar:20} {pos} of {len} draws searched");
    let bar = ProgressBar::new(0);
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let done = |so_far: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(so_far as u64);
    };
    let foreseen = foresee(&plan, &done);
    bar.finish_and_clear();
    let foreseen = foreseen.ok_or_else(|| {
        Error::Usage(format!(
            "{file}: {} readings of {} actuators are too few for a search",
            plan.readings(),
            plan.rest_lengths_mm.len()
        ))
    })?;
    if let Some(csv) = &args.csv {
        let text = csv_of(&foreseen.limits);
        std::fs::write(csv, text).map_err(Error::io("write", csv))?;
    }
    if args.json {
        print_json(&json!({ "plan": plan, "foreseen": foreseen }))?;
    } else {
        print(&plan, &foreseen);
    }
    Ok(DONE)
}

/// The scatter that a campaign of the last run has.
fn scatter_of(args: &PlanArgs, campaign: &str, diameter_mm: u32) -> Result<Scatter> {
    let places = args.results.places()?;
    let known = check_session::known(&places.derived, &places.reports, &places.config)?;
    let all = known.findings.map_or(Vec::new(), |f| f.campaigns);
    let is = |c: &&CampaignFindings| {
        c.campaign == campaign && c.diameter_mm == diameter_mm && c.part.is_none()
    };
    let found = all.iter().find(is).and_then(scatter);
    found.ok_or_else(|| {
        let usable = all.iter().filter(|c| scatter(c).is_some() && c.part.is_none());
        let names: Vec<String> = usable
            .map(|c| format!("{} ({} mm)", c.campaign, c.diameter_mm))
            .collect();
        Error::Usage(format!(
            "scatter_of = \"{campaign}\": the last run searched no such campaign of {diameter_mm} mm; it has {}",
            if names.is_empty() { "none".to_owned() } else { names.join(", ") }
        ))
    })
}

fn scatter(found: &CampaignFindings) -> Option<Scatter> {
    let misfit = found.misfit.as_ref()?;
    Some(Scatter {
        gain: found.scatter_sd("specimen_variation")?,
        length_mm: found.scatter_sd("length_offset")?,
        zero_n: found.scatter_sd("force_zero_offset")?,
        common_misfit: misfit.common,
        session_misfit: misfit.session,
        noise_n: found.noise?,
    })
}

fn newtons(value: f64) -> String {
    format!("{} N", rounded(value, Rounding::Digits(2)))
}

fn size(limit: &Limit) -> String {
    with_unit(&rounded(limit.smallest, Rounding::Digits(2)), &limit.unit)
}

fn csv_of(limits: &[Limit]) -> String {
    let lines = limits
        .iter()
        .map(|l| format!("{},{:?},{},{}\n", l.id, l.form, l.smallest, l.unit));
    std::iter::once("effect,form,smallest,unit\n".to_owned())
        .chain(lines)
        .collect()
}

fn print(plan: &Plan, foreseen: &Foreseen) {
    let s = &plan.scatter;
    line(format!(
        "plan      {} readings in {} sessions of {} actuators, {} mm",
        plan.readings(),
        plan.rest_lengths_mm.len() * plan.contractions.len(),
        plan.rest_lengths_mm.len(),
        plan.diameter_mm
    ));
    line(format!(
        "scatter   {}strength {}, set lengths {:.2} mm, zero {}, misfit of the law {} and of a session {}, noise {}",
        plan.scatter_of
            .as_ref()
            .map_or_else(String::new, |c| format!("as in {c}: ")),
        percent(s.gain),
        s.length_mm,
        newtons(s.zero_n),
        percent(s.common_misfit),
        percent(s.session_misfit),
        newtons(s.noise_n)
    ));
    let (draws, answered) = foreseen.draws;
    line(format!(
        "draws     {draws}, without any effect; something was found in {answered}"
    ));
    line("");
    if let Some(error) = foreseen.expected_rmse_n {
        line(format!(
            "error     {} expected on an unseen actuator{}",
            newtons(error),
            foreseen
                .calibrated_rmse_n
                .map_or_else(String::new, |e| format!(
                    ", {} with its own strength and lengths known",
                    newtons(e)
                ))
        ));
        let parts = foreseen.budget.iter().take(5);
        let parts: Vec<String> = parts
            .map(|(source, n)| format!("{} {}", name::source(source), newtons(*n)))
            .collect();
        line(format!("          of that {}", parts.join(", ")));
    }
    line("");
    line("one thing more, and the error that is expected then");
    let rows: Vec<Vec<String>> = foreseen.worth.iter().map(worth_row).collect();
    for text in aligned(&rows, &[Align::Left, Align::Right, Align::Left]) {
        line(format!("  {text}"));
    }
    set_points(foreseen);
    line("");
    line("smallest sizes that show in 80 of 100 such campaigns");
    let rows: Vec<Vec<String>> = foreseen
        .limits
        .iter()
        .map(|l| vec![name::effect(&l.id), l.form.clone(), size(l)])
        .collect();
    for text in aligned(&rows, &[Align::Left, Align::Left, Align::Right]) {
        line(format!("  {text}"));
    }
    if !foreseen.not_measurable.is_empty() {
        line("");
        line("what this design cannot show");
        let of = |n: &pipeline_findings::NotMeasurable| {
            let form = n
                .form
                .as_ref()
                .map_or_else(String::new, |f| format!(", {f}"));
            vec![
                format!("{}{form}", name::effect(&n.id)),
                name::why_not_of_law(n),
            ]
        };
        let rows: Vec<Vec<String>> = foreseen.not_measurable.iter().map(of).collect();
        for text in aligned(&rows, &[Align::Left, Align::Left]) {
            line(format!("  {text}"));
        }
    }
    if !foreseen.aliases.is_empty() {
        line("");
        line("what looks alike in this design");
        for alias in &foreseen.aliases {
            let [a, b] = &alias.ids;
            line(format!(
                "  {} and {} (cosine {:.3})",
                name::effect(a),
                name::effect(b),
                alias.cosine
            ));
        }
    }
}

/// The set points that the search of a draw would read next.
fn set_points(foreseen: &Foreseen) {
    let points: Vec<String> = foreseen
        .next
        .iter()
        .filter(|n| n.kind == NextKind::SetPoints && !n.at.contains_key("set_points"))
        .map(|n| format!("  {}", conditions(n)))
        .collect();
    if !points.is_empty() {
        line("");
        line("best further set points");
        points.into_iter().for_each(line);
    }
}

fn worth_row(worth: &Worth) -> Vec<String> {
    let what = match worth.more {
        More::Specimen(mm) => format!("an actuator of {mm} mm"),
        More::LengthsKnown(mm) => format!("set lengths known to {mm} mm"),
        More::Contraction(c) => format!("sessions at a relative contraction of {c:.2}"),
        More::Run => "one more log a session".to_owned(),
    };
    vec![
        what,
        newtons(worth.expected_rmse_n),
        format!("{:+.1} ± {:.1} N", -worth.less_n, worth.spread_n),
    ]
}
