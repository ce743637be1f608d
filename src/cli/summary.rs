//! `pipeline summary`, which is also the end of `run`: models, verdicts, errors and what to measure next, campaign by campaign, from what the
//! last run left below `reports/`.

use crate::answers;
use crate::args::SummaryArgs;
use crate::columns::{Align, aligned};
use crate::places::Places;
use crate::print::{self, counted, line, print_json};
use crate::{DONE, doubts, options, progress};
use pipeline_base::diagnostics::nearest;
use pipeline_base::error::{Error, Result};
use pipeline_compare::NEW;
use pipeline_findings::{CampaignFindings, Findings};
use pipeline_fit::Group;
use pipeline_report::number::Rounding;
use pipeline_report::wording::name::{self, model_name};
use pipeline_report::wording::number::{error, rounded};
use pipeline_report::wording::sentence::LawAlone;
use pipeline_run as run;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Campaigns that are shown before the rest is counted.
const SHOWN: usize = 20;

/// The new model with its published coefficients.
const PUBLISHED: &str = "new_published";

/// How much is said.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Detail {
    /// Three lines of each campaign.
    InShort,
    /// Everything.
    Full,
}

/// What the last run found, and how the models did.
pub(super) struct Answers {
    findings: Findings,
    summary: Summary,
    reports: PathBuf,
}

/// The part of `summary.json` that is printed.
#[derive(Deserialize)]
struct Summary {
    sessions_used: Vec<Session>,
    sessions_rejected: Vec<Value>,
    logs_rejected: Vec<Value>,
    readings: usize,
    models: Vec<GroupModels>,
}

#[derive(Deserialize)]
struct Session {
    exclude: Option<String>,
    /// The part of its notes that keeps it apart.
    #[serde(default)]
    doubtful: Option<String>,
    /// The zero of the force that was taken, N, where its own zero log holds a pull of the actuator.
    #[serde(default)]
    usual_zero_n: Option<f64>,
}

/// The models of one campaign and diameter, on the readings that all of them answer.
#[derive(Deserialize)]
pub(super) struct GroupModels {
    pub campaign: String,
    pub diameter_mm: u32,
    /// Whether it is several campaigns together.
    #[serde(default)]
    is_pool: bool,
    readings: usize,
    of: Option<usize>,
    rmse_n: Vec<ModelError>,
    /// The law alone where its error is clearly below that of the mixed model with what was found.
    #[serde(default)]
    better_law_alone: Option<LawAlone>,
    /// The error of the published law on all readings of the group, N; none where it does not answer all of them.
    #[serde(default)]
    published_n: Option<f64>,
}

/// The error of one model on unseen specimens, N.
#[derive(Deserialize, Serialize)]
struct ModelError {
    model: String,
    rmse: f64,
}

/// Prints the answers of the last run; says so where they are no longer those of the sessions.
pub(super) fn command(args: &SummaryArgs) -> Result<u8> {
    let places = args.places.places()?;
    let mut answers = Answers::load(&places.reports)?;
    let mut detail = Detail::InShort;
    if let Some(campaign) = &args.campaign {
        answers.narrow(campaign)?;
    }
    if args.full || args.campaign.is_some() {
        detail = Detail::Full;
    }
    // The reports alone, as somebody else may have them, have answers too.
    let missing = places.raw.iter().find(|raw| !raw.exists());
    let stale = match missing {
        Some(_) => None,
        None => Some(would_run(&places, args.places.jobs)?),
    };
    if args.places.json {
        print_json(&json!({ "answers": answers.as_json(), "would_run": stale }))?;
        return Ok(DONE);
    }
    if let Some(raw) = missing {
        line(format!(
            "not compared with the sessions, because there is no raw directory {} (--raw names another): these are the results of the last run",
            raw.display()
        ));
    }
    if let Some(stale @ 1..) = stale {
        line(format!(
            "out of date: {stale} results would be computed (`pipeline status` says why); this is what the last run found"
        ));
    }
    answers.print_extent();
    answers.print(detail);
    Ok(DONE)
}

/// How many results a run would compute; warns of doubtful sessions, as it would.
fn would_run(places: &Places, jobs: u64) -> Result<usize> {
    let options = options(places, jobs, None, true)?;
    let outcome = run::run(&options, &progress::Shown::new(true))?;
    print::diagnostics(&doubts::warnings(&outcome.doubtful), &options.raw, false);
    Ok(outcome.work.len())
}

impl Answers {
    /// What the last run left below `reports`.
    ///
    /// # Errors
    /// There was no run, or another version of the program wrote it.
    pub(super) fn load(reports: &Path) -> Result<Self> {
        Ok(Self {
            findings: read(&reports.join("findings.json"))?,
            summary: read(&reports.join("summary.json"))?,
            reports: reports.to_path_buf(),
        })
    }

    /// The answers for other programs.
    pub(super) fn as_json(&self) -> Value {
        let campaigns = self.findings.campaigns.iter();
        let one = |found: &CampaignFindings| {
            let models = self.models_of(found);
            let models =
                models.map(|m| json!({ "readings": m.readings, "of": m.of, "rmse_n": m.rmse_n }));
            let mut value = answers::as_json(found);
            value["models"] = json!(models);
            value
        };
        campaigns.map(one).collect()
    }

    /// One campaign alone.
    ///
    /// # Errors
    /// The last run found none of this name.
    fn narrow(&mut self, campaign: &str) -> Result<()> {
        let all = &mut self.findings.campaigns;
        if !all.iter().any(|found| found.campaign == campaign) {
            let mut names: Vec<&str> = all.iter().map(|found| found.campaign.as_str()).collect();
            names.dedup();
            let near = nearest(campaign, names.iter().copied());
            let hint = near.map_or_else(String::new, |near| format!("; did you mean {near}?"));
            return Err(Error::Usage(format!(
                "the last run has no campaign {campaign}; it has {}{hint}",
                names.join(", ")
            )));
        }
        all.retain(|found| found.campaign == campaign);
        Ok(())
    }

    /// The campaigns, one after the other.
    pub(super) fn print(&self, detail: Detail) {
        let campaigns = &self.findings.campaigns;
        let in_full = detail == Detail::Full;
        let shown = if in_full { campaigns.len() } else { SHOWN };
        if !in_full {
            self.print_zeros();
            line("");
            self.print_models(shown);
        }
        for found in campaigns.iter().take(shown) {
            if in_full {
                line("");
                let models = self.models_of(found).map(models_text);
                let lines = answers::lines(found, models.as_deref());
                lines.into_iter().for_each(line);
            } else {
                let alone = self.models_of(found).and_then(|m| m.better_law_alone);
                answers::in_short(found, alone).into_iter().for_each(line);
            }
        }
        self.print_unsearched();
        if !in_full {
            line("\n`pipeline summary CAMPAIGN` shows one campaign in full, --full all of them");
        }
        if campaigns.len() > shown {
            line(format!(
                "\nand {} more: {}",
                campaigns.len() - shown,
                self.reports.join("residual.pdf").display()
            ));
        }
        line("");
    }

    /// In how many sessions the zero of the force was replaced; nothing where in none.
    fn print_zeros(&self) {
        let used = &self.summary.sessions_used;
        let replaced = used.iter().filter(|s| s.usual_zero_n.is_some()).count();
        if replaced > 0 {
            line(format!(
                "zero logs that hold a pull of the actuator: {replaced} of {}; the usual zero of the campaign is taken instead (tables/zeros.csv; \
                 `usual_zeros = false` in [fit] keeps them)",
                counted(used.len(), "session", "sessions")
            ));
        }
    }

    /// Which groups were fitted and not searched: pools that are too large.
    fn print_unsearched(&self) {
        let is_searched = |m: &&GroupModels| {
            let mut all = self.findings.campaigns.iter();
            all.any(|found| {
                (found.campaign.as_str(), found.diameter_mm) == (&m.campaign, m.diameter_mm)
            })
        };
        for models in self
            .summary
            .models
            .iter()
            .filter(|m| m.is_pool && !is_searched(m))
        {
            line(format!(
                "{}, {} mm: a pool of more specimens than are searched together for effects (`pooled_specimens` in [diagnose])",
                models.campaign, models.diameter_mm
            ));
        }
    }

    /// A table of the models of the campaigns shown; nothing where no model stands beside the new one.
    fn print_models(&self, shown: usize) {
        let campaigns = self.findings.campaigns.iter().take(shown);
        let all: Vec<(&CampaignFindings, &GroupModels)> = campaigns
            .filter_map(|found| Some((found, self.models_of(found)?)))
            .collect();
        let mut ids: Vec<&str> = Vec::new();
        for id in all.iter().flat_map(|(_, models)| models.ids()) {
            if !ids.contains(&id) {
                ids.push(id);
            }
        }
        if ids.is_empty() {
            return;
        }
        let head = ["RMSE (N)", "readings"].map(ToOwned::to_owned);
        let names = ids.iter().map(|id| model_name(id, id).to_owned());
        let mut rows = vec![head.into_iter().chain(names).collect()];
        for (found, models) in all {
            let error = |id: &&str| models.rmse(id).map_or("–".to_owned(), |e| error(e, "N"));
            let readings = rounded(models.readings as f64, Rounding::Decimals(0));
            let first = [name::campaign(found), readings].into_iter();
            rows.push(first.chain(ids.iter().map(error)).collect());
        }
        let mut columns = vec![Align::Right; 2 + ids.len()];
        columns[0] = Align::Left;
        line(
            "Laws without effects, on the readings that all of them cover (fitted: by least squares to the other specimens):",
        );
        aligned(&rows, &columns).into_iter().for_each(line);
        line("");
    }

    /// How much was measured, and what was left out.
    fn print_extent(&self) {
        let all = &self.summary;
        let (used, rejected) = (all.sessions_used.len(), all.sessions_rejected.len());
        let excluded = all.sessions_used.iter().filter(|s| s.exclude.is_some());
        let doubtful = all.sessions_used.iter();
        let doubtful = doubtful.filter(|s| s.exclude.is_none() && s.doubtful.is_some());
        let doubtful = match doubtful.count() {
            0 => String::new(),
            n => format!(
                " {} kept apart because of their notes,",
                counted(n, "session", "sessions")
            ),
        };
        line(format!(
            "{} from {}; {} excluded in session.toml,{doubtful} {} and {} left out",
            counted(all.readings, "reading", "readings"),
            counted(used, "session", "sessions"),
            counted(excluded.count(), "session", "sessions"),
            counted(rejected, "session", "sessions"),
            counted(all.logs_rejected.len(), "log", "logs")
        ));
    }

    fn models_of(&self, found: &CampaignFindings) -> Option<&GroupModels> {
        let is = |m: &&GroupModels| {
            found.part.is_none()
                && (m.campaign.as_str(), m.diameter_mm) == (&found.campaign, found.diameter_mm)
        };
        self.summary.models.iter().find(is)
    }
}

/// That the published coefficients do better than those fitted to a group, where the last run says so: for whoever takes the fit. `mixed_n` is the error
/// of the mixed model on unseen specimens, N, where its law is the one that is taken. None where no run left a summary.
pub(super) fn better_published(
    reports: &Path,
    group: &Group,
    mixed_n: Option<f64>,
) -> Option<String> {
    let summary: Summary = read(&reports.join("summary.json")).ok()?;
    let is = |m: &&GroupModels| {
        (m.campaign.as_str(), m.diameter_mm) == (group.campaign.as_str(), group.diameter_mm)
    };
    let models = summary.models.iter().find(is)?;
    // Each pair on the same readings.
    let (fitted, published) = match mixed_n {
        Some(mixed) => (mixed, models.published_n?),
        None => models.both_laws()?,
    };
    (published < fitted).then(|| {
        format!(
            "on unseen specimens the published coefficients have an RMSE of {}, the fitted ones {} N: --model {PUBLISHED} uses the published ones",
            error(published, "N"),
            error(fitted, "N")
        )
    })
}

/// The models of every group of the last run; none where no run left a summary.
pub(super) fn models_of_run(reports: &Path) -> Vec<GroupModels> {
    let summary: Result<Summary> = read(&reports.join("summary.json"));
    summary.map_or_else(|_| Vec::new(), |s| s.models)
}

impl GroupModels {
    /// The models.
    pub(super) fn ids(&self) -> impl Iterator<Item = &str> {
        self.rmse_n.iter().map(|m| m.model.as_str())
    }

    /// The error of one of them, N.
    pub(super) fn rmse(&self, id: &str) -> Option<f64> {
        self.rmse_n.iter().find(|m| m.model == id).map(|m| m.rmse)
    }

    /// Errors of the new model, N: with fitted and with published coefficients.
    fn both_laws(&self) -> Option<(f64, f64)> {
        self.rmse(NEW).zip(self.rmse(PUBLISHED))
    }
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let bytes = std::fs::read(path).map_err(|e| {
        Error::Usage(format!(
            "cannot read {}: {e}; `pipeline run` writes it",
            path.display()
        ))
    })?;
    pipeline_base::json::from_slice(&bytes).map_err(|_| {
        Error::Usage(format!(
            "{} is not in the format of this version; `pipeline run` rewrites it",
            path.display()
        ))
    })
}

/// `RMSE on unseen specimens, laws alone by least squares: New model, fitted 13.2; Hunt 2017 18.1; Festo tool 25.6 N (on the 1290 of 1675
/// readings that all of them cover)`.
fn models_text(models: &GroupModels) -> String {
    let one = |m: &ModelError| {
        let fallback = if m.model == NEW { "new" } else { &m.model };
        format!("{} {}", model_name(&m.model, fallback), error(m.rmse, "N"))
    };
    let all: Vec<String> = models.rmse_n.iter().map(one).collect();
    let of = models.of.map_or_else(String::new, |of| format!(" of {of}"));
    let better = match models.both_laws() {
        Some((fitted, published)) if published < fitted => {
            "; there the published coefficients do better than the fitted ones"
        }
        _ => "",
    };
    let alone = models.better_law_alone.map_or_else(String::new, |law| {
        format!(
            "; {}, less than the mixed model with what was found",
            law.in_words()
        )
    });
    format!(
        "RMSE on unseen specimens, laws alone by least squares: {} N (on the {}{of} readings that all of them cover){better}{}",
        all.join("; "),
        models.readings,
        alone
    )
}
