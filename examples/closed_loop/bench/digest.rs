//! The answers for a dozen fixed campaigns as one number, so that a test can say when the published table is out of date.

use super::findings_digest::of_findings;
use super::search::search;
use pipeline::findings::CampaignFindings;
use pipeline::simulate::rig_like::{Mistake, Pace, Put, Scatter, Settings, campaign};
use rayon::prelude::*;

/// First of the seeds; nobody else has them.
const FIRST_SEED: u64 = 31_400;

/// The digest of the findings.
pub fn answers() -> String {
    let settings = fixed();
    let findings: Vec<CampaignFindings> = settings
        .par_iter()
        .enumerate()
        .map(|(k, (settings, base))| {
            let made = campaign(FIRST_SEED + k as u64, settings);
            search(&made.rows, base)
        })
        .collect();
    of_findings(&findings)
}

/// The line of the documentation that states it.
pub fn line(answers: &str) -> String {
    format!("Answers to the twelve fixed campaigns: `{answers}`.")
}

/// The campaigns, with the base model of each search: none, one or two effects, other forms, a column, recording errors, another law.
fn fixed() -> Vec<(Settings, &'static str)> {
    let small = || Settings {
        specimens: Some(4),
        ..Settings::default()
    };
    let put = |id, form, size, from| Put {
        id,
        form,
        size,
        others: &[],
        from,
    };
    let with = |effects: Vec<Put>| Settings { effects, ..small() };
    let wrong = |mistake| Settings {
        mistake: Some(mistake),
        ..small()
    };
    let compliance = put("series_compliance", "linear", 12.0, 0.0);
    let threshold = put("bladder_threshold", "sharp", 55.0, 0.0);
    let of_the_new_law = [
        small(),
        Settings {
            scatter: Scatter::Clean,
            ..with(vec![compliance, put("temperature", "linear", 0.01, 0.0)])
        },
        with(vec![put("hysteresis", "constant", 4.0, 0.0), threshold]),
        with(vec![threshold]),
        with(vec![put("length_offset", "constant", 3.0, 0.0)]),
        with(vec![put("series_compliance", "stiffening", 40.0, 0.0)]),
        with(vec![put("pressure_gain", "constant", 1.1, 0.5)]),
        with(vec![put("humidity", "gain", 0.008, 0.0)]),
        Settings {
            pace: Pace::Dwell,
            ..with(vec![put("creep", "logarithm", 0.02, 0.0)])
        },
        wrong(Mistake::RestLength),
        wrong(Mistake::SwappedColumns),
    ];
    let of_others = with(vec![put("hysteresis", "constant", 4.0, 0.0)]);
    let of_the_new_law = of_the_new_law.map(|settings| (settings, "new"));
    of_the_new_law
        .into_iter()
        .chain([(of_others, "hunt2017")])
        .collect()
}
