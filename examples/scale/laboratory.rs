//! The sessions of a laboratory of ten years, simulated.
//!
//! A campaign is ten specimens of one diameter at ten contractions: a hundred sessions of a zero log and three runs. Campaigns follow each other
//! over ten years, of 10 and 20 mm by turns, each with specimens of its own. Their notes do not say that they are simulated, so that the
//! diameters are pooled over all campaigns as measured ones are; they never leave the benchmark's folder.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, SystemTime};

const SPECIMENS: usize = 10;
const CONTRACTIONS: usize = 10;
/// Sessions of a whole campaign.
pub const CAMPAIGN: usize = SPECIMENS * CONTRACTIONS;
/// First year of measurement.
const FIRST_YEAR: usize = 2016;
const MONTHS: usize = 120;

/// Sessions below a folder.
pub struct Laboratory {
    /// Where they are.
    pub raw: PathBuf,
    /// How many.
    pub sessions: usize,
}

/// Makes `sessions` sessions of `rows` rows a log below `folder`, `fitted` of each campaign's and the others kept out of every fit, or takes those
/// that an earlier benchmark left there.
///
/// # Errors
/// What the program and the system say.
pub fn make(
    program: &Path,
    folder: &Path,
    sessions: usize,
    rows: usize,
    fitted: usize,
) -> Result<Laboratory, Box<dyn Error>> {
    let name = match fitted < CAMPAIGN {
        true => format!("raw-{sessions}-of-{rows}-fitted-{fitted}"),
        false => format!("raw-{sessions}-of-{rows}"),
    };
    let raw = folder.join(&name);
    let done = folder.join(format!("{name}.whole"));
    if !done.exists() {
        let _ = std::fs::remove_dir_all(&raw);
        let campaigns = sessions.div_ceil(CAMPAIGN);
        for k in 0..campaigns {
            let specimens = (sessions - k * CAMPAIGN)
                .min(CAMPAIGN)
                .div_ceil(CONTRACTIONS);
            let truth = folder.join("truth.toml");
            std::fs::write(&truth, truth_file(k, campaigns, specimens, rows))?;
            let out = raw.join(format!("campaign-{k:03}"));
            let mut simulate = Command::new(program);
            simulate.arg("simulate").arg(&truth).arg("--out").arg(&out);
            if !simulate
                .stdout(std::process::Stdio::null())
                .status()?
                .success()
            {
                return Err("the simulation failed".into());
            }
        }
        let mut session = 0;
        for file in files(&raw) {
            if file.file_name().is_some_and(|n| n == "session.toml") {
                // Spread over the specimens.
                describe(&file, session * fitted % CAMPAIGN < fitted)?;
                session += 1;
            }
            settle(&file)?;
        }
        std::fs::write(&done, b"")?;
    }
    Ok(Laboratory { raw, sessions })
}

fn truth_file(k: usize, campaigns: usize, specimens: usize, rows: usize) -> String {
    let month = k * MONTHS / campaigns;
    let contractions: Vec<String> = (0..CONTRACTIONS)
        .map(|c| format!("{}", c as f64 / 10.0))
        .collect();
    let mut text = format!(
        "schema = \"bpa-truth/1\"\ncampaign = \"c{k:03}\"\nseed = {k}\ndate = \"{}-{:02}\"\ndiameter_mm = {}\n\
         coefficients = \"published\"\ncontractions = [{}]\nruns = [8, 9, 10]\nrun_speed = [1, 0.7, 0.7]\nsampling = \"timeseries\"\n",
        FIRST_YEAR + month / 12,
        1 + month % 12,
        10 + 10 * (k % 2),
        contractions.join(", ")
    );
    for s in 0..specimens {
        let _infallible = write!(
            text,
            "\n[[specimen]]\nid = \"c{k:03}-s{s}\"\nrest_length_mm = {}\ncontraction_max = {}\n",
            100 + 37 * s + k % 30,
            0.155 + 0.002 * (s % 9) as f64
        );
    }
    let _infallible = write!(
        text,
        "\n[rig]\nrows = {rows}\nzero_rows = {}\nfill_share = 0.2\nvent_share = 0.45\n",
        rows / 10
    );
    text
}

/// Takes the note off a session, and keeps it out of every fit unless it `is_fitted`.
fn describe(file: &Path, is_fitted: bool) -> Result<(), Box<dyn Error>> {
    let text = std::fs::read_to_string(file)?;
    let mut lines: Vec<&str> = text
        .lines()
        .filter(|l| !l.starts_with("notes = "))
        .collect();
    if !is_fitted {
        lines.insert(0, "exclude = \"not fitted in this benchmark\"");
    }
    Ok(std::fs::write(file, lines.join("\n"))?)
}

/// Makes a file look as old as those of a real tree.
fn settle(file: &Path) -> Result<(), Box<dyn Error>> {
    let open = std::fs::File::options().write(true).open(file)?;
    open.set_modified(SystemTime::now() - Duration::from_secs(3600))?;
    Ok(())
}

/// All files below a folder, sorted.
pub fn files(root: &Path) -> Vec<PathBuf> {
    let below = walkdir::WalkDir::new(root)
        .sort_by_file_name()
        .into_iter()
        .flatten();
    below
        .filter(|e| e.file_type().is_file())
        .map(walkdir::DirEntry::into_path)
        .collect()
}

/// The logs among them.
pub fn logs(root: &Path) -> Vec<PathBuf> {
    let mut all = files(root);
    all.retain(|f| f.extension().is_some_and(|e| e == "csv"));
    all
}
