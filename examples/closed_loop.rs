//! The benchmark of the residual search: campaigns with an effect that nothing tells, searched, and judged on what was found.
//!
//! ```sh
//! cargo run --release --example closed_loop -- [--seeds N] [--only WORD] [--list] [--log FILE]
//! ```
//!
//! 20 seeds are 200 campaigns without an effect, 20 of every single effect (half of them medium, half large), 20 of every other form, 100
//! of two effects, 100 of effects outside the library and 40 with a published base model: an hour on two cores. With `--log` every
//! campaign is written down as soon as it is done, and those that the file has are not run again.
use pipeline::base::session::Role;
use pipeline::config::{DiagnoseOptions, FitOptions};
use pipeline::simulate::campaign_rows;
use pipeline::simulate::trials::{self, Case, Size};
use pipeline::stages::diagnose::findings::{CampaignFindings, Verdict};
use pipeline::stages::diagnose::folds::Tally;
use pipeline::stages::diagnose::former as diagnose;
use pipeline::stages::fit::Group;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Mutex;

/// One campaign of the benchmark.
struct Trial {
    part: &'static str,
    cases: Vec<&'static Case>,
    size: Size,
    seed: u64,
    base: &'static str,
}

/// What came of it.
struct Outcome {
    hit: bool,
    covered: Option<bool>,
    ratio: f64,
    found: Vec<String>,
    seconds: f64,
    words: String,
}

impl Outcome {
    /// One line of the log, after the trial's name.
    fn line(&self) -> String {
        let covered = match self.covered {
            Some(true) => "in",
            Some(false) => "out",
            None => "-",
        };
        let found = if self.found.is_empty() {
            "none".to_owned()
        } else {
            self.found.join("+")
        };
        format!(
            "{}\t{covered}\t{:.4}\t{found}\t{:.1}\t{}",
            if self.hit { "+" } else { "-" },
            self.ratio,
            self.seconds,
            self.words
        )
    }

    fn parse(line: &str) -> Option<Self> {
        let parts: Vec<&str> = line.split('\t').collect();
        let [hit, covered, ratio, found, seconds, words] = parts[..] else {
            return None;
        };
        Some(Self {
            hit: hit == "+",
            covered: match covered {
                "in" => Some(true),
                "out" => Some(false),
                _ => None,
            },
            ratio: ratio.parse().ok()?,
            found: found
                .split('+')
                .filter(|f| *f != "none")
                .map(str::to_owned)
                .collect(),
            seconds: seconds.parse().ok()?,
            words: words.to_owned(),
        })
    }
}

impl Trial {
    /// What names it in the log.
    fn name(&self) -> String {
        let cases: Vec<String> = self
            .cases
            .iter()
            .map(|c| format!("{} {}", c.id, c.form))
            .collect();
        format!(
            "{}, {}, {:?}, seed {}, base {}",
            self.part,
            cases.join(" + "),
            self.size,
            self.seed,
            self.base
        )
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let value = |name: &str| {
        arguments
            .iter()
            .position(|a| a == name)
            .and_then(|i| arguments.get(i + 1))
    };
    let seeds: u64 = value("--seeds").and_then(|s| s.parse().ok()).unwrap_or(20);
    let only = value("--only").cloned().unwrap_or_default();
    let list = arguments.iter().any(|a| a == "--list");
    let trials = all(seeds);
    let trials: Vec<Trial> = trials
        .into_iter()
        .filter(|t| {
            only.is_empty()
                || t.part.contains(&only)
                || t.cases
                    .iter()
                    .any(|c| format!("{} {}", c.id, c.form).contains(&only))
        })
        .collect();
    let log = value("--log").cloned();
    let known = log
        .as_ref()
        .and_then(|file| std::fs::read_to_string(file).ok())
        .unwrap_or_default();
    let known: BTreeMap<&str, &str> = known.lines().filter_map(|l| l.split_once('\t')).collect();
    let file = log.map(|file| {
        let opened = std::fs::OpenOptions::new()
            .create(true)
            .append(true)
            .open(file);
        Mutex::new(opened.expect("a log file that can be written"))
    });
    let outcomes: Vec<Outcome> = trials
        .par_iter()
        .map(|t| {
            let name = t.name();
            if let Some(outcome) = known.get(name.as_str()).and_then(|l| Outcome::parse(l)) {
                return outcome;
            }
            let outcome = run(t);
            let line = format!("{name}\t{}\n", outcome.line());
            if let Some(file) = &file {
                let mut file = file.lock().expect("no thread has panicked");
                file.write_all(line.as_bytes()).expect("room for the log");
            }
            if list {
                print!("{line}");
            }
            outcome
        })
        .collect();
    report(&trials, &outcomes);
    confusion(&trials, &outcomes);
}

fn all(seeds: u64) -> Vec<Trial> {
    let mut list = Vec::new();
    for seed in 0..10 * seeds {
        list.push(Trial {
            part: "null",
            cases: vec![&trials::NULL],
            size: Size::Medium,
            seed,
            base: "new",
        });
    }
    let sizes = [Size::Medium, Size::Large];
    for (part, cases, n) in [
        ("single", trials::SINGLE, seeds),
        ("other form", trials::OTHER_FORMS, seeds),
        ("outside", trials::OUTSIDE, seeds),
    ] {
        for case in cases {
            for seed in 0..n {
                list.push(Trial {
                    part,
                    cases: vec![case],
                    size: sizes[(seed % 2) as usize],
                    seed: 1000 + seed,
                    base: "new",
                });
            }
        }
    }
    let pairable: Vec<&'static Case> = trials::SINGLE
        .iter()
        .filter(|c| c.design == trials::Design::Staircase && c.id != "specimen_variation")
        .collect();
    let mut seed = 5000;
    let mut k = 0;
    while k < 5 * seeds {
        let (a, b) = (
            pairable[(seed as usize * 7) % pairable.len()],
            pairable[(seed as usize * 11 + 3) % pairable.len()],
        );
        seed += 1;
        if a.id != b.id {
            list.push(Trial {
                part: "two",
                cases: vec![a, b],
                size: sizes[(seed % 2) as usize],
                seed,
                base: "new",
            });
            k += 1;
        }
    }
    for seed in 0..2 * seeds {
        let base = if seed % 2 == 0 {
            "hunt2017"
        } else {
            "festo_tool"
        };
        list.push(Trial {
            part: "rediscovery",
            cases: vec![&trials::NULL],
            size: Size::Medium,
            seed: 9000 + seed,
            base,
        });
    }
    list
}

fn run(trial: &Trial) -> Outcome {
    let tables: String = trial
        .cases
        .iter()
        .map(|c| c.table(trial.size))
        .collect::<Vec<String>>()
        .join("\n");
    let truth = trials::truth(trial.cases[0].design, &tables, trial.seed);
    let made = campaign_rows(&truth);
    let group = Group {
        campaign: "trial".into(),
        diameter_mm: 10,
        members: vec!["trial".into()],
        simulated: true,
    };
    let options = DiagnoseOptions {
        base_model: trial.base.into(),
        ..DiagnoseOptions::default()
    };
    let start = std::time::Instant::now();
    let found = diagnose(&group, &made.rows, &FitOptions::default(), &options)
        .expect("enough readings")
        .findings;
    let seconds = start.elapsed().as_secs_f64();
    // The error of the generating model on the held-out specimens, their strengths known to it. The model that was found may fit them as
    // well: how strong an unknown specimen is can be known to neither.
    let held: Vec<(f64, f64)> = made
        .rows
        .iter()
        .zip(&made.readings)
        .filter(|(row, _)| row.role == Some(Role::Holdout))
        .map(|(row, truth)| (row.force_n, truth.known_force_n))
        .collect();
    let (measured, expected): (Vec<f64>, Vec<f64>) = held.into_iter().unzip();
    let best = Tally::of(&measured, &expected, &expected).rmse();
    let has = |id: &str| {
        found
            .effects
            .iter()
            .any(|e| e.class.iter().any(|c| c == id))
    };
    let part = trial.part;
    let hit = match part {
        "null" => found.verdict == Verdict::None,
        "outside" => {
            found.verdict == Verdict::Unexplained
                && found
                    .unexplained
                    .iter()
                    .any(|u| u.column == trial.cases[0].id)
        }
        "rediscovery" => has("rest_length_scaling"),
        _ => trial.cases.iter().all(|c| has(c.id)),
    };
    let after = found.after_empirical.unwrap_or(found.after);
    Outcome {
        hit,
        covered: (part == "single").then(|| covered(&found, trial)).flatten(),
        ratio: after.rmse_heldout_own_strength / best,
        found: names(&found),
        seconds,
        words: words(&found),
    }
}

/// Whether the interval of the effect's own number covers what was put in; none where the class stands for it.
fn covered(found: &CampaignFindings, trial: &Trial) -> Option<bool> {
    let case = trial.cases[0];
    let effect = found.effects.iter().find(|e| e.id == case.id)?;
    let p = &effect.parameters[0];
    let truth = match (case.id, case.form) {
        ("force_drift", "campaign") => case.number(trial.size) * 23.0,
        ("hysteresis", _) | ("force_zero_offset", _) => case.number(trial.size),
        ("rate_dependence", _) => -case.number(trial.size),
        _ => case.number(trial.size),
    };
    // The drift along the campaign is counted from the first to the last searched session, of 32 with the held-out ones.
    if case.form == "campaign"
        || case.form.starts_with("each")
        || case.id == "temperature"
        || case.id == "specimen_variation"
    {
        return None;
    }
    Some(p.ci_low <= truth && truth <= p.ci_high)
}

/// Ids of the effects found, and columns that nothing explains with a question mark; nothing where there is nothing.
fn names(found: &CampaignFindings) -> Vec<String> {
    let effects = found.effects.iter().map(|e| e.id.clone());
    let columns = found.unexplained.iter().map(|u| format!("?{}", u.column));
    effects.chain(columns).collect()
}

fn words(found: &CampaignFindings) -> String {
    let effects = found.effects.iter().map(|e| {
        let p = &e.parameters[0];
        format!(
            "{}[{}] {}={:.4} ({:.4}..{:.4}) p {:.1e}",
            e.class.join("/"),
            e.acts_on,
            p.name,
            p.value,
            p.ci_low,
            p.ci_high,
            e.p_adjusted
        )
    });
    let columns = found
        .unexplained
        .iter()
        .map(|u| format!("?{} {} {:.2}", u.column, u.shape, u.share_of_residual));
    let rejected = found
        .rejected
        .iter()
        .filter(|r| !r.why.starts_with("explains"))
        .map(|r| format!("!{} {}", r.id, r.why));
    let asked = found
        .questions
        .iter()
        .filter(|q| q.p_adjusted < 0.1 || q.share > 0.05)
        .map(|q| format!("={} {:.2} p {:.3}", q.column, q.share, q.p_adjusted));
    let list: Vec<String> = effects
        .chain(columns)
        .chain(rejected)
        .chain(asked)
        .collect();
    format!("{:?} {}", found.verdict, list.join("; "))
}

fn report(trials: &[Trial], outcomes: &[Outcome]) {
    let mut groups: BTreeMap<(usize, String), Vec<usize>> = BTreeMap::new();
    const PARTS: [&str; 6] = [
        "null",
        "single",
        "other form",
        "two",
        "outside",
        "rediscovery",
    ];
    for (i, t) in trials.iter().enumerate() {
        let part = PARTS.iter().position(|p| *p == t.part).unwrap_or(0);
        groups.entry((part, String::new())).or_default().push(i);
        if ["single", "other form", "outside"].contains(&t.part) {
            groups
                .entry((part, format!("{} {}", t.cases[0].id, t.cases[0].form)))
                .or_default()
                .push(i);
        }
    }
    println!(
        "| case | campaigns | right | 95% bounds | interval covers | error ratio, median | above 1.10 | physical name | s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for ((part, name), members) in &groups {
        let hits = members.iter().filter(|i| outcomes[**i].hit).count();
        let covered: Vec<bool> = members
            .iter()
            .filter_map(|i| outcomes[*i].covered)
            .collect();
        // What was drawn for a session can be known to no model that has not seen it.
        let drawn = |i: &&usize| {
            let cases = &trials[**i].cases;
            cases
                .iter()
                .any(|c| ["each session", "wandering"].contains(&c.form))
        };
        let predictable = members.iter().filter(|i| !drawn(i));
        let mut ratios: Vec<f64> = predictable.map(|i| outcomes[*i].ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let above = ratios.iter().filter(|r| **r > 1.10).count();
        let ratio = ratios
            .get(ratios.len() / 2)
            .map_or("-".to_owned(), |r| format!("{r:.2}"));
        let physical = |i: &&usize| outcomes[**i].found.iter().any(|f| !f.starts_with('?'));
        let physical = members.iter().filter(physical).count();
        let seconds =
            members.iter().map(|i| outcomes[*i].seconds).sum::<f64>() / members.len() as f64;
        let n = members.len();
        let label = if name.is_empty() {
            format!("**{}**", PARTS[*part])
        } else {
            name.clone()
        };
        let cover = if covered.is_empty() {
            "-".to_owned()
        } else {
            format!(
                "{}/{}",
                covered.iter().filter(|c| **c).count(),
                covered.len()
            )
        };
        println!(
            "| {label} | {n} | {:.1}% | {:.1} to {:.1}% | {cover} | {ratio} | {above} | {:.0}% | {seconds:.1} |",
            100.0 * hits as f64 / n as f64,
            100.0 * lower(hits, n),
            100.0 * (1.0 - lower(n - hits, n)),
            100.0 * physical as f64 / n as f64
        );
    }
}

/// What was found where what was put in, by size: the confusion matrix, row by row.
fn confusion(trials: &[Trial], outcomes: &[Outcome]) {
    let mut rows: BTreeMap<(String, Size), BTreeMap<String, usize>> = BTreeMap::new();
    for (t, o) in trials.iter().zip(outcomes) {
        let single = t.cases.len() == 1 && t.base == "new";
        if single {
            let row = rows.entry((t.cases[0].id.to_owned(), t.size)).or_default();
            let found = if o.found.is_empty() {
                "none".to_owned()
            } else {
                o.found.join(" + ")
            };
            *row.entry(found).or_default() += 1;
        }
    }
    println!("\n| put in | size | found (times) |\n|---|---|---|");
    for ((id, size), found) in &rows {
        let mut list: Vec<(&String, &usize)> = found.iter().collect();
        list.sort_by(|a, b| b.1.cmp(a.1).then(a.0.cmp(b.0)));
        let words: Vec<String> = list.iter().map(|(f, n)| format!("{f} ({n})")).collect();
        println!("| {id} | {size:?} | {} |", words.join(", "));
    }
}

/// Lower end of the two-sided 95% interval of a rate (Clopper and Pearson 1934), by bisection on the binomial tail.
fn lower(hits: usize, n: usize) -> f64 {
    if hits == 0 {
        return 0.0;
    }
    let tail = |p: f64| {
        let mut term = 1.0 - p;
        term = libm::pow(term, n as f64);
        let mut below = 0.0;
        for k in 0..hits {
            below += term;
            term *= (n - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
        }
        1.0 - below
    };
    let (mut low, mut high) = (0.0, 1.0 - 1e-12);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if tail(middle) < 0.025 {
            low = middle
        } else {
            high = middle
        }
    }
    low
}
