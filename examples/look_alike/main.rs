//! How alike a simulated log looks to a measured one: the same staircase side by side, with the numbers that make a log.
//!
//! ```text
//! cargo run --release --example look_alike -- --measured ../shared/rig/isometric-10mm-2022-11/l182/c25 --out look.png
//! cargo run --release --example look_alike -- --measured SESSION --simulated truths/simulated-10mm.toml --out look.png
//! ```
//! Without `--simulated` the rig's defaults simulate the session's own actuator, length and runs. With a truth file, its session of
//! nearest resting length and contraction is taken. `--run N` draws another run than the first one of both. The numbers are medians over
//! all steady readings of all runs of a session.

mod figure;
mod look;

use look::{Look, checked};
use pipeline::base::columns::LENGTH;
use pipeline::base::session::{Sampling, Session};
use pipeline::report::raster::svg_to_png;
use pipeline::simulate::{read_truth, simulate};
use std::path::{Path, PathBuf};

type Failure = Box<dyn std::error::Error>;
/// Names and bytes of a session's files, `session.toml` first.
type Files = Vec<(String, Vec<u8>)>;

const DPI: f64 = 110.0;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().collect();
    let value = |name: &str| {
        let place = arguments.iter().position(|a| a == name)?;
        arguments.get(place + 1).cloned()
    };
    let usage = "--measured SESSION_DIR [--simulated TRUTH.toml] [--run N] --out FILE.png";
    let folder = PathBuf::from(value("--measured").ok_or(usage)?);
    let out = value("--out").ok_or(usage)?;
    let run = value("--run").map(|n| n.parse::<i64>()).transpose()?;
    let measured = Look::new("measured", &files_of(&folder)?)?;
    let truth = match value("--simulated") {
        Some(path) => std::fs::read_to_string(path)?,
        None => truth_like(&measured.session)?,
    };
    let simulated = simulated(&truth, &measured.session)?;
    println!(
        "measured {}, simulated {}\n",
        measured.session.id, simulated.session.id
    );
    println!("{:<44} {:>10} {:>10}", "", "measured", "simulated");
    for (a, b) in measured.numbers().iter().zip(simulated.numbers()) {
        println!("{:<44} {:>10.3} {:>10.3}", a.0, a.1, b.1);
    }
    let svg = figure::figure([&measured, &simulated], run).to_svg()?;
    std::fs::write(out, svg_to_png(&svg, DPI)?)?;
    Ok(())
}

fn files_of(folder: &Path) -> Result<Files, Failure> {
    let toml = std::fs::read(folder.join("session.toml"))?;
    let session = checked(&toml)?;
    let mut files = vec![("session.toml".to_owned(), toml)];
    for log in &session.logs {
        files.push((log.file.clone(), std::fs::read(folder.join(&log.file))?));
    }
    Ok(files)
}

/// A truth file without effects that measures the session's actuator at its length, on the rig as it is by default.
fn truth_like(session: &Session) -> Result<String, Failure> {
    let specimen = &session.specimen;
    let (rest, least) = (specimen.rest_length_m, specimen.contracted_length_m);
    let runs: Vec<String> = session
        .logs
        .iter()
        .filter(|l| !l.is_zero)
        .zip(1..)
        .map(|(l, k)| l.run.unwrap_or(k).to_string())
        .collect();
    Ok(format!(
        "schema = \"bpa-truth/1\"\ncampaign = \"look-alike\"\nseed = 1\ndiameter_mm = {}\ncoefficients = \"published\"\n\
         contractions = [{:.4}]\nruns = [{}]\nsampling = \"timeseries\"\n\
         [[specimen]]\nid = \"look-alike\"\nrest_length_mm = {:.2}\ncontraction_max = {:.5}\n",
        specimen.diameter_mm,
        (rest - length(session)?) / (rest - least),
        runs.join(", "),
        1e3 * rest,
        (rest - least) / rest,
    ))
}

fn length(session: &Session) -> Result<f64, Failure> {
    let length = session.setup_number(LENGTH);
    length.ok_or_else(|| "a session whose length is held".into())
}

/// The session of a truth file that is most like another.
fn simulated(truth: &str, like: &Session) -> Result<Look, Failure> {
    let truth = read_truth("truth file", truth).map_err(|mistakes| format!("{mistakes:?}"))?;
    if truth.sampling != Sampling::Timeseries {
        return Err("a truth file with sampling = \"timeseries\"".into());
    }
    let campaign = simulate(&truth);
    let wanted = [like.specimen.rest_length_m, length(like)?];
    let mut best: Option<(f64, &Files)> = None;
    for candidate in &campaign.sessions {
        let session = checked(&candidate.files[0].1)?;
        let lengths = [session.specimen.rest_length_m, length(&session)?];
        let far = (lengths[0] - wanted[0]).abs() + (lengths[1] - wanted[1]).abs();
        if best.is_none_or(|(least, _)| far < least) {
            best = Some((far, &candidate.files));
        }
    }
    Look::new("simulated", best.ok_or("a truth file with a session")?.1)
}
