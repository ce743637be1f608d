//! The arguments, with their help.

use crate::bundle::BundleArgs;
use crate::check::CheckArgs;
use crate::check_session::CheckSessionArgs;
use crate::design::DesignArgs;
use crate::diff::DiffArgs;
use crate::explain::ExplainArgs;
use crate::explore::ExploreArgs;
use crate::export::ExportArgs;
use crate::gc::GcArgs;
use crate::graph::GraphArgs;
use crate::init::InitArgs;
use crate::manual::{CompletionsArgs, ManArgs};
use crate::new_session::NewSessionArgs;
use crate::plan::PlanArgs;
use crate::predict::PredictArgs;
use clap::{ArgAction, Parser, Subcommand};
use pipeline_run::STAGES;
use pipeline_simulate::effects::EFFECTS;
use std::path::PathBuf;

/// From raw test-rig sessions of braided pneumatic actuators to a paper's tables, figures and reports.
#[derive(Debug, Parser)]
#[command(
    name = "pipeline",
    version,
    about = "From raw test-rig sessions of braided pneumatic actuators to a paper's tables, figures and reports",
    subcommand_required = true,
    arg_required_else_help = true,
    after_help = program_help()
)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// More threads than this help nobody.
const MOST_JOBS: u64 = 256;

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Create a project: pipeline.toml with its folders, settings for the golden tables, .gitignore
    #[command(
        after_help = "Example:\n  pipeline init my-muscles\n  cd my-muscles\n  pipeline new-session ~/logs/test8.csv --out raw/test8\n  pipeline run\n  pipeline check --init\n\nEvery command takes its directories from pipeline.toml; --raw, --derived and --reports override it."
    )]
    Init(InitArgs),
    /// Run every stage whose inputs changed
    #[command(
        after_help = "Examples:\n  pipeline run\n  pipeline run --raw raw --raw ../rig --explain\n  pipeline run --force fit --strict\n\nExit codes: 0 done; 2 usage, configuration or no usable input; 3 done, but sessions were rejected (with --strict); 4 internal; 5 done, but a figure or document was left out because of a program defect (summary.json names it)."
    )]
    Run(RunArgs),
    /// Show what would run and why; exit code 1 if anything would
    #[command(after_help = "Example:\n  pipeline status --raw ../rig")]
    Status(PlaceArgs),
    /// Print what the last run found: models, verdicts, errors and what to measure next, campaign by campaign
    #[command(
        after_help = "Examples:\n  pipeline summary\n  pipeline summary iso10-2022-11\n  pipeline summary --full\n  pipeline summary --json\n\nEach campaign, pool and joint gets three lines; with --full, or a campaign by its name, all there are. Nothing is computed; if the sessions have changed since, it says so."
    )]
    Summary(SummaryArgs),
    /// Bring the results up to date and compare the tables with the golden ones; exit code 1 on a difference
    #[command(
        after_help = "Examples:\n  pipeline check --init\n  pipeline check\n  pipeline check --bless --reason \"the zero of clipped logs is now the slack force\"\n\nExit codes: 0 equal; 1 a difference; 2 usage, or no golden tables; 4 internal."
    )]
    Check(CheckArgs),
    /// Predict the force of a muscle, or its torque about a knee, with an interval for muscles not measured
    #[command(
        after_help = "Examples:\n  pipeline predict --diameter 10 --rest-length 182mm --contracted-length 152mm --pressure 300kPa --contraction 5%\n  pipeline predict --diameter 20 --rest-length 12in --contraction-620 0.24 --pressure 4bar --sweep contraction --plot force.svg\n  pipeline predict --diameter 10 --rest-length 250mm --contraction-620 16.5% --table --csv force.csv\n  pipeline predict --diameter 10 --rest-length 182mm --contraction 5% --pressure-for 20N\n  pipeline predict --calibrate sessions/new-muscle --contraction 5% --pressure 500kPa\n  pipeline predict --diameter 10 --rest-length 182mm --pressure 500kPa --length-for 100N\n  pipeline predict --diameter 10 --rest-length 485mm --contracted-length 398mm --pressure 606kPa --knee pinned --route flexor --fitting 35.2mm --plot torque.svg\n\nUnits: m, cm, mm, in; kPa, Pa, MPa, bar, psi; contractions as 5% or 0.05. Pressures are gauge pressures."
    )]
    Predict(Box<PredictArgs>),
    /// Find the shortest muscle, among the diameters measured, that meets a force or torque curve
    #[command(
        after_help = "Examples:\n  pipeline design curve.csv --pressure 600kPa --plot design.svg\n  pipeline design torque.csv --knee pinned --route flexor --fitting 35.2mm\n\nThe curve is a CSV file with one of the headers contraction,force_n; travel_mm,force_n (shortening from the resting length); angle_deg,torque_nm. A muscle meets it where the lower end of its 95% interval does."
    )]
    Design(Box<DesignArgs>),
    /// Write a simulated campaign of raw sessions from a truth file
    #[command(after_help = simulate_help())]
    Simulate(SimulateArgs),
    /// Inspect a log, plot it, and write a draft session.toml for it
    #[command(after_help = new_session_help())]
    NewSession(NewSessionArgs),
    /// Assess a planned campaign: what it could show, the error to expect, what would lower it
    #[command(
        after_help = "Examples:\n  pipeline plan --example > plan.toml\n  pipeline plan plan.toml\n  pipeline plan plan.toml --csv limits.csv --json > plan.json\n\nThe planned campaign is simulated three times with the expected scatter and without any effect, and the residual search is run on each draw, and on draws of designs with one addition: half a minute to a few minutes, depending on the number of readings."
    )]
    Plan(PlanArgs),
    /// Compare two campaigns, runs or versions: coefficients, errors, findings, and whether the forces are equivalent
    #[command(
        after_help = "Examples:\n  pipeline diff iso10-2022-11 iso10-2023-04\n  pipeline diff ../before . --markdown > diff.md\n  pipeline diff ../other-lab:iso10 iso10-2022-11 --margin 5%\n\nA folder is a project with the results of a run; without a campaign, every campaign that both have is compared. Exit codes: 0 the forces are equivalent at the margin; 1 they differ, or neither can be shown; 2 usage."
    )]
    Diff(DiffArgs),
    /// Check a session while the actuator is still on the rig: logs, zero, specimen gain and set length against other sessions, recording errors
    #[command(
        after_help = "Examples:\n  pipeline check-session raw/test8\n  pipeline check-session raw/test8 --plot /tmp/test8\n  pipeline check-session raw/test9 --watch\n\nIt reads the session's logs as a run would and writes nothing. The reference is what an earlier run found for other sessions, if there was one. Exit codes: 0 nothing stands out; 1 something to look at; 2 something that cannot be used, or usage."
    )]
    CheckSession(CheckSessionArgs),
    /// Show where a table, figure, report or single number comes from: stages, options, files, digests
    #[command(
        after_help = "Examples:\n  pipeline explain reports/tables/coefficients.csv\n  pipeline explain coefficients.csv:2:value\n  pipeline explain force.pdf --json\n\nA number is FILE:LINE:COLUMN, with the line as an editor counts it; the campaign and session in its row narrow the answer."
    )]
    Explain(ExplainArgs),
    /// Write every reading of one campaign to one HTML file for a browser
    #[command(
        after_help = "Example:\n  pipeline explore simulated-10mm --out simulated-10mm.html\n\nA run writes reports/explorer.html for all campaigns, for a large laboratory with a sample of the readings. This command uses the results of the last run and computes nothing."
    )]
    Explore(ExploreArgs),
    /// Draw the stages and artifacts of the last run as Mermaid or Graphviz
    #[command(
        after_help = "Examples:\n  pipeline graph\n  pipeline graph --format dot --units | dot -Tsvg > graph.svg"
    )]
    Graph(GraphArgs),
    /// Delete cache entries that the last run did not use
    #[command(
        after_help = "Examples:\n  pipeline gc --dry-run\n  pipeline gc --older-than 7 --max-size 2GB\n\nWhat the last run used is always kept, and so is everything in reports/ and derived/sessions/."
    )]
    Gc(GcArgs),
    /// Export a run as a workflow for another engine, or a model as source code in other languages
    #[command(
        subcommand_required = true,
        arg_required_else_help = true,
        after_help = "Examples:\n  pipeline export snakemake > Snakefile\n  pipeline export model --campaign simulated-10mm --out bpa-10mm"
    )]
    Export(ExportArgs),
    /// Pack the last run as an RO-Crate for a repository: reports, tables, tidy data, configuration, digests of the raw files
    #[command(
        after_help = "Examples:\n  pipeline bundle\n  pipeline bundle --out force-2026.zip --with-raw\n\nThe last run has to be up to date. Name, description, license and authors are set under [bundle] in pipeline.toml; the date is that of the documents (report.date, else the last measurement). The same run gives the same bytes. Unpacked, a bundle with its raw files is a project: `pipeline run` in it gives the same results."
    )]
    Bundle(BundleArgs),
    /// Print the completion script for a shell
    #[command(
        after_help = "Examples:\n  pipeline completions bash > ~/.local/share/bash-completion/completions/pipeline\n  pipeline completions zsh > ~/.zfunc/_pipeline\n  pipeline completions fish > ~/.config/fish/completions/pipeline.fish\n  pipeline completions powershell >> $PROFILE"
    )]
    Completions(CompletionsArgs),
    /// Print the manual page, or write the pages of all commands
    #[command(
        after_help = "Examples:\n  pipeline man | man -l -\n  pipeline man --out ~/.local/share/man/man1"
    )]
    Man(ManArgs),
    /// Print all options with their defaults, as a pipeline.toml
    #[command(after_help = "Example:\n  pipeline config > pipeline.toml")]
    Config,
}

fn program_help() -> String {
    format!(
        "Example:\n  pipeline run --raw my-sessions --reports my-reports\n\nStages, in order: {}. Results are cached by content in derived/; a second \
         run does nothing.",
        STAGES.join(", ")
    )
}

fn simulate_help() -> String {
    let ids: Vec<&str> = EFFECTS.iter().map(|e| e.id).collect();
    format!(
        "Example:\n  pipeline simulate truths/closed-loop-10mm.toml --out /tmp/campaign --truth-out /tmp/truth.json\n\n\
         The truth file says what is measured (specimens, contractions, points or logs over time), on which rig, and what the models \
         lack:\n\n  [[effect]]\n  id = \"series_compliance\"\n  c_um_per_n = 6.0\n\nEffects: {}.\n\n\
         The session notes say that they are simulated, but nothing about effects. The values drawn (specimen gains, zeros, effect sizes) go to \
         the file given with --truth-out, outside the campaign folder. docs/simulate.md lists every key and the forms of each effect.",
        ids.join(", ")
    )
}

fn new_session_help() -> String {
    format!(
        "Examples:\n  pipeline new-session logs/test8.csv --out /tmp/test8\n  pipeline new-session logs/*.csv --out raw --copy\n  pipeline new-session old.txt --skip-rows 12 --encoding latin-1\n  pipeline new-session logs/runs.xlsx --sheet \"Run 8\"\n  \
         pipeline new-session logs/rig.mat --variable log --json\n\nFormats: {}; each also compressed with gzip. Guesses (quantities, units, \
         states, sampling) are noted in the comments of session.toml, and what no log can tell is marked FILL IN. Correct it, remove the marks and \
         put it beside the log; while a mark remains, a run leaves the session out and lists the lines.",
        pipeline_formats::list_of_formats()
    )
}

/// Where the cache is: arguments of every command that looks at it alone.
#[derive(Debug, clap::Args)]
pub struct DerivedArgs {
    /// The cache and the tidy data [default: paths.derived of pipeline.toml, else derived]
    #[arg(long, value_name = "DIR")]
    pub derived: Option<PathBuf>,
    /// Configuration [default: pipeline.toml, if there is one]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
}

/// Where results are: arguments of every command that looks at what a run left.
#[derive(Debug, clap::Args)]
pub struct ResultArgs {
    /// Where the cache is
    #[command(flatten)]
    pub cache: DerivedArgs,
    /// Reports, tables and figures [default: paths.reports of pipeline.toml, else reports]
    #[arg(long, value_name = "DIR")]
    pub reports: Option<PathBuf>,
}

/// What is read, and where results are: arguments of every command that runs stages.
#[derive(Debug, clap::Args)]
pub struct PlaceArgs {
    /// Raw directory, read-only; may be given several times [default: paths.raw of pipeline.toml, else raw]
    #[arg(long, value_name = "DIR")]
    pub raw: Vec<PathBuf>,
    /// Where results are
    #[command(flatten)]
    pub results: ResultArgs,
    /// Threads; 0 for one per core
    #[arg(long, short, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=MOST_JOBS))]
    pub jobs: u64,
    /// Print the outcome as JSON
    #[arg(long)]
    pub json: bool,
    /// Print every message about the inputs, notes included
    #[arg(long, short, action = ArgAction::SetTrue)]
    pub verbose: bool,
}

/// Arguments of `summary`.
#[derive(Debug, clap::Args)]
pub struct SummaryArgs {
    /// Show one campaign only, in full
    pub campaign: Option<String>,
    /// Show every campaign in full
    #[arg(long)]
    pub full: bool,
    /// Where things are
    #[command(flatten)]
    pub places: PlaceArgs,
}

/// Arguments of `run`.
#[derive(Debug, clap::Args)]
pub struct RunArgs {
    /// Where things are
    #[command(flatten)]
    pub places: PlaceArgs,
    /// Rerun this stage regardless of the cache
    #[arg(long, value_name = "STAGE")]
    pub force: Option<String>,
    /// Exit with 3 if a session was rejected
    #[arg(long)]
    pub strict: bool,
    /// Print one line for every result that was computed, with the reason
    #[arg(long)]
    pub explain: bool,
    /// Show what would run, without running it
    #[arg(long)]
    pub dry_run: bool,
    /// If a program defect stops one session or group, continue with everything that does not need it, list what is missing and exit with 4.
    /// The reports are left as they are: none is made from part of the sessions
    #[arg(long)]
    pub keep_going: bool,
    /// Refuse raw directories that are network addresses. The program never uses the network anyway
    #[arg(long)]
    pub offline_only: bool,
    /// Run a single job and cache its result, alongside other processes doing the same (`pipeline export` lists the jobs)
    #[arg(long, value_name = "STAGE:UNIT")]
    pub only: Option<String>,
}

/// Arguments of `simulate`.
#[derive(Debug, clap::Args)]
pub struct SimulateArgs {
    /// The truth file: coefficients, specimens, rig, effects (TOML, schema bpa-truth/1)
    pub truth: PathBuf,
    /// Folder to write the campaign to
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Write the truth as drawn to this file, as JSON
    #[arg(long, value_name = "FILE")]
    pub truth_out: Option<PathBuf>,
    /// Replace an existing campaign
    #[arg(long)]
    pub replace: bool,
}
