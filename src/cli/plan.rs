//! `pipeline plan`: a campaign that has not been measured yet.

use crate::args::ResultArgs;
use crate::print::{line, print_json};
use crate::{DONE, check_session, plan_print, predict};
use indicatif::{ProgressBar, ProgressStyle};
use pipeline_base::error::{Error, Result};
use pipeline_findings::CampaignFindings;
use pipeline_plan::design::{self, Plan, Scatter};
use pipeline_plan::foresee::{Foreseen, Limit, More, foresee};
use pipeline_report::figures::Named;
use pipeline_report::figures::campaign_plan::{self, Expected};
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `plan`.
#[derive(Debug, clap::Args)]
pub struct PlanArgs {
    /// The plan
    #[arg(value_name = "PLAN.toml", required_unless_present = "example")]
    pub plan: Option<PathBuf>,
    /// Print a plan to start from
    #[arg(long)]
    pub example: bool,
    /// Write the detection limits as CSV
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Draw the errors to expect and the set points (.svg, .pdf or .png)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
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
    places.check_outside_raw(args.plot.as_deref(), "--plot")?;
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|e| Error::Usage(format!("cannot read the plan {file}: {e}")))?;
    let mut plan = design::read(&file, &text).map_err(Error::Config)?;
    if let Some(campaign) = plan.scatter_of.clone() {
        plan.scatter = scatter_of(args, &campaign, &plan)?;
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
    if let Some(file) = &args.plot {
        predict::draw(file, drawing(&plan, &foreseen))?;
    }
    if args.json {
        print_json(&json!({ "plan": plan, "foreseen": foreseen }))?;
    } else {
        plan_print::print(&plan, &foreseen);
    }
    Ok(DONE)
}

/// The scatter that a campaign of the last run has.
fn scatter_of(args: &PlanArgs, campaign: &str, plan: &Plan) -> Result<Scatter> {
    let diameter_mm = plan.diameter_mm;
    let rest_mm = plan.middle_rest_length_mm();
    let places = args.results.places()?;
    let known = check_session::known(&places.derived, &places.reports, &places.config)?;
    let all = known.findings.map_or(Vec::new(), |f| f.campaigns);
    let is = |c: &&CampaignFindings| {
        c.campaign == campaign && c.diameter_mm == diameter_mm && c.part.is_none()
    };
    let found = all.iter().find(is).and_then(|c| scatter(c, rest_mm));
    found.ok_or_else(|| {
        let usable = all.iter().filter(|c| scatter(c, rest_mm).is_some() && c.part.is_none());
        let names: Vec<String> = usable
            .map(|c| format!("{} ({} mm)", c.campaign, c.diameter_mm))
            .collect();
        Error::Usage(format!(
            "scatter_of = \"{campaign}\": the last run searched no such campaign of {diameter_mm} mm; it has {}",
            if names.is_empty() { "none".to_owned() } else { names.join(", ") }
        ))
    })
}

/// Scatter as it was found; that of contracted lengths for an actuator of this resting length, mm.
fn scatter(found: &CampaignFindings, rest_mm: f64) -> Option<Scatter> {
    let misfit = found.misfit.as_ref()?;
    Some(Scatter {
        gain: found.scatter_sd("specimen_variation")?,
        length_mm: found.scatter_sd("length_offset")?,
        contracted: found.contracted_sd_mm(rest_mm) / rest_mm,
        zero_n: found.scatter_sd("force_zero_offset")?,
        common_misfit: misfit.common,
        session_misfit: misfit.session,
        noise_n: found.noise?,
    })
}

fn csv_of(limits: &[Limit]) -> String {
    let lines = limits
        .iter()
        .map(|l| format!("{},{:?},{},{}\n", l.id, l.form, l.smallest, l.unit));
    std::iter::once("effect,form,smallest,unit\n".to_owned())
        .chain(lines)
        .collect()
}

/// One thing more, as short as an axis wants it.
fn short(more: More) -> String {
    match more {
        More::Specimen(mm) => format!("+ actuator of {mm} mm"),
        More::LengthsKnown(mm) => format!("+ set lengths to {mm} mm"),
        More::ContractedKnown(mm) => format!("+ contracted to {mm} mm"),
        More::Contraction(c) => format!("+ sessions at {c:.2}"),
        More::Run => "+ log per session".to_owned(),
    }
}

/// The errors to expect and the set points, as a figure.
fn drawing(plan: &Plan, foreseen: &Foreseen) -> Named {
    let as_planned = foreseen.expected_rmse_n.map(|error_n| Expected {
        what: "as planned".to_owned(),
        error_n,
        spread_n: None,
    });
    let more = foreseen.worth.iter().map(|w| Expected {
        what: short(w.more),
        error_n: w.expected_rmse_n,
        spread_n: Some(w.spread_n),
    });
    let expected: Vec<Expected> = as_planned.into_iter().chain(more).collect();
    let pressures = || plan.pressures_kpa.iter().copied();
    let planned = plan.contractions.iter().copied();
    let planned = planned.flat_map(|c| pressures().map(move |p| (c, p)));
    let best = plan_print::best_points(foreseen).filter_map(|n| {
        let of = |key: &str| n.at.get(key).copied();
        of("contraction_rel").zip(of("pressure_kpa"))
    });
    let title = format!(
        "Plan of {} readings of {} actuators, {} mm",
        plan.readings(),
        plan.rest_lengths_mm.len(),
        plan.diameter_mm
    );
    campaign_plan::figure(&title, &expected, planned.collect(), best.collect())
}
