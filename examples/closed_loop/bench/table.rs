//! The table in Markdown: what was tried, how often it was right, and the bar.

use super::outcome::Outcome;
use super::plan::{MANY_LENGTHS, MULTIPLES};
use super::rate::{Rate, median, quantile};
use super::trial::{Part, Trial};
use pipeline::simulate::rig_like::Scatter;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// A campaign and what came of it.
type Pair<'a> = (&'a Trial, &'a Outcome);

/// A line of the table of bars.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// What is counted.
    pub case: String,
    /// What came of it.
    pub result: String,
    /// What it has to be.
    pub bar: String,
    /// Whether it is; none where nothing was counted.
    pub met: Option<bool>,
}

impl Bar {
    /// The line of the table.
    pub fn line(&self) -> String {
        let met = if self.met == Some(true) {
            "met"
        } else {
            "**missed**"
        };
        let [case, result, bar] = [&self.case, &self.result, &self.bar];
        format!("| {case} | {result} | {bar} | {met} |")
    }

    /// A share within bounds.
    fn share(case: &str, rate: Rate, (low, high): (f64, f64)) -> Self {
        let percent = |x: f64| format!("{:.0}%", 100.0 * x);
        let bar = match (low > 0.0, high < 1.0) {
            (true, true) => format!("{} to {}", percent(low), percent(high)),
            (true, false) => format!("at least {}", percent(low)),
            _ => format!("at most {:.1}%", 100.0 * high),
        };
        let share = rate.share();
        Self {
            case: case.to_owned(),
            result: rate.to_string(),
            bar,
            met: (rate.of > 0).then_some(low <= share && share <= high),
        }
    }

    /// A number within bounds.
    fn number(case: &str, value: Option<f64>, bar: &str, (low, high): (f64, f64)) -> Self {
        Self {
            case: case.to_owned(),
            result: value.map_or("-".to_owned(), |x| format!("{x:.3}")),
            bar: bar.to_owned(),
            met: value.map(|x| low <= x && x <= high),
        }
    }
}

/// Every bar of one block.
pub fn bars(trials: &[Trial], outcomes: &[Outcome], scatter: Scatter) -> Vec<Bar> {
    let all: Vec<Pair> = trials
        .iter()
        .zip(outcomes)
        .filter(|(t, _)| t.scatter == scatter)
        .collect();
    let of = |part: Part| -> Vec<Pair> {
        all.iter()
            .copied()
            .filter(|(t, _)| t.part == part)
            .collect()
    };
    let mut list = of_nothing(&of(Part::Nothing), scatter);
    list.extend(of_singles(&of(Part::Single), scatter));
    let as_asked = |part: Part| -> Vec<Pair> {
        let all = of(part).into_iter();
        all.filter(|(_, o)| !o.size.capped).collect()
    };
    let two = as_asked(Part::Two);
    list.push(Bar::share(
        "two effects, 4 times the limit: both and nothing else",
        exact(&two),
        (0.85, 1.0),
    ));
    let forms = as_asked(Part::OtherForm);
    list.push(Bar::share(
        "another form, 4 times the limit: right id and nothing else",
        exact(&forms),
        (0.9, 1.0),
    ));
    let ratio = median(forms.iter().filter_map(|(_, o)| o.error_ratio));
    let title = "the same: error on unseen specimens, over that without the effect, median";
    list.push(Bar::number(title, ratio, "at most 1.10", (0.0, 1.1)));
    list.extend(of_outside(&as_asked(Part::Outside)));
    let few = ("6 to 8".to_owned(), 6..=8);
    let many = MANY_LENGTHS.map(|n| (n.to_string(), n..=n));
    for (lengths, range) in std::iter::once(few).chain(many) {
        let own = of(Part::Rediscovery).into_iter();
        let own = own.filter(|(t, _)| t.specimens.is_some_and(|n| range.contains(&n)));
        let found = Rate::of(own.map(|(_, o)| o.detected));
        let title =
            format!("Hunt 2017 or the Festo tool, {lengths} lengths: `rest_length_scaling` found");
        list.push(Bar::share(&title, found, (0.9, 1.0)));
    }
    let recording = of(Part::Recording);
    let pointed = Rate::of(recording.iter().map(|(_, o)| o.detected));
    list.push(Bar::share(
        "recording errors pointed at",
        pointed,
        (0.9, 1.0),
    ));
    let invented = Rate::of(recording.iter().map(|(_, o)| !o.found.is_empty()));
    list.push(Bar::share(
        "recording errors: an effect invented beside them",
        invented,
        (0.0, 0.05),
    ));
    list.retain(|b| b.met.is_some());
    list
}

fn exact(list: &[Pair]) -> Rate {
    Rate::of(list.iter().map(|(_, o)| o.exact))
}

fn of_nothing(list: &[Pair], scatter: Scatter) -> Vec<Bar> {
    let found = Rate::of(list.iter().map(|(_, o)| !o.found.is_empty()));
    let column = Rate::of(list.iter().map(|(_, o)| !o.columns.is_empty()));
    let pointed = Rate::of(list.iter().map(|(_, o)| !o.pointed.is_empty()));
    let mut bars = vec![
        Bar::share("no effect: one found", found, (0.0, 0.075)),
        Bar::share("no effect: a column found", column, (0.0, 0.075)),
        Bar::share(
            "no effect: a recording error pointed at",
            pointed,
            (0.0, 0.075),
        ),
    ];
    if scatter == Scatter::Clean {
        return bars;
    }
    for (k, name) in ["set length", "gain"].iter().enumerate() {
        let many = list.iter().filter(|(_, o)| o.specimens >= 6);
        let ratio = median(many.filter_map(|(_, o)| o.scatter_ratios[k]));
        let title = format!(
            "no effect, 6 specimens or more: estimated over true scatter of {name}, median"
        );
        bars.push(Bar::number(&title, ratio, "0.80 to 1.25", (0.8, 1.25)));
    }
    bars.push(gap("no effect", list));
    bars
}

/// Log density of held-out readings less the generating model's.
fn gap(of: &str, list: &[Pair]) -> Bar {
    let gap = median(list.iter().filter_map(|(_, o)| o.log_density_gap));
    let title =
        format!("{of}: held-out log density a reading, less the generating model's, median");
    Bar::number(&title, gap, "-0.05 to 0.05", (-0.05, 0.05))
}

fn of_singles(list: &[Pair], scatter: Scatter) -> Vec<Bar> {
    let mut bars = Vec::new();
    for multiple in MULTIPLES {
        let own: Vec<Pair> = list
            .iter()
            .copied()
            .filter(|(t, o)| t.multiple == multiple && !o.size.capped)
            .collect();
        let exact = exact(&own);
        let title = format!("one effect, {multiple} times the limit: it and nothing else");
        let bounds = match multiple {
            1.0 => (0.7, 0.9),
            4.0 => (0.9, 1.0),
            // Between the two: no bar of its own, but no worse than at the limit.
            _ => (0.7, 1.0),
        };
        bars.push(Bar::share(&title, exact, bounds));
        let detected = Rate::of(own.iter().map(|(_, o)| o.detected));
        let title = format!("one effect, {multiple} times the limit: it, whatever else");
        bars.push(Bar::share(&title, detected, bounds));
    }
    let found = Rate::of(list.iter().filter_map(|(_, o)| o.covered.found));
    bars.push(Bar::share(
        "intervals of those found cover",
        found,
        (0.9, 0.98),
    ));
    let either = |o: &Outcome| o.covered.found.or(o.covered.not_found);
    let all = Rate::of(list.iter().filter_map(|(_, o)| either(o)));
    bars.push(Bar::share("intervals of all cover", all, (0.9, 0.98)));
    let creep = list.iter().filter(|(t, _)| t.cases[0].id == "creep");
    let creep = Rate::of(creep.filter_map(|(_, o)| either(o)));
    bars.push(Bar::share(
        "intervals of creep's k cover",
        creep,
        (0.9, 1.0),
    ));
    if scatter == Scatter::RigLike {
        bars.push(gap("one effect", list));
    }
    bars
}

fn of_outside(list: &[Pair]) -> Vec<Bar> {
    let right = |o: &Outcome| o.detected && o.verdict == "unexplained";
    let right = Rate::of(list.iter().map(|(_, o)| right(o)));
    let named = Rate::of(list.iter().map(|(_, o)| !o.found.is_empty()));
    vec![
        Bar::share(
            "outside the library, 4 times the limit: unexplained, the right column",
            right,
            (0.9, 1.0),
        ),
        Bar::share("outside the library: a physical name", named, (0.0, 0.05)),
    ]
}

/// The whole document, but for its head.
pub fn document(trials: &[Trial], outcomes: &[Outcome]) -> String {
    let mut text = String::new();
    for (scatter, title) in [
        (Scatter::RigLike, "Rig-like campaigns"),
        (Scatter::Clean, "Clean campaigns"),
    ] {
        let bars = bars(trials, outcomes, scatter);
        if bars.is_empty() {
            continue;
        }
        let _ = writeln!(
            text,
            "\n## {title}\n\n| case | result | bar | |\n|---|---|---|---|"
        );
        for b in bars {
            let _ = writeln!(text, "{}", b.line());
        }
        text.push_str(&by_case(trials, outcomes, scatter));
        text.push_str(&by_specimens(trials, outcomes, scatter));
    }
    text.push_str(&capped(trials, outcomes));
    text.push_str(&times(trials, outcomes));
    text
}

/// Case by case: how often exact, and what was found instead.
fn by_case(trials: &[Trial], outcomes: &[Outcome], scatter: Scatter) -> String {
    let mut groups: BTreeMap<(Part, String, String), Vec<Pair>> = BTreeMap::new();
    for pair in trials
        .iter()
        .zip(outcomes)
        .filter(|(t, _)| t.scatter == scatter)
    {
        let (part, name, multiple) = label(pair.0);
        groups.entry((part, name, multiple)).or_default().push(pair);
    }
    let mut text = "\n| put in | limits | found, and nothing else | found | interval covers | error | found instead |\n".to_owned();
    text.push_str("|---|---|---|---|---|---|---|\n");
    for ((_, name, multiple), list) in &groups {
        let exact = Rate::of(list.iter().map(|(_, o)| o.exact));
        let detected = list.iter().filter(|(_, o)| o.detected).count();
        let covered = Rate::of(list.iter().filter_map(|(_, o)| o.covered.found));
        let covered = if covered.of == 0 {
            "-".to_owned()
        } else {
            format!("{}/{}", covered.hits, covered.of)
        };
        let ratio = median(list.iter().filter_map(|(_, o)| o.error_ratio));
        let ratio = ratio.map_or("-".to_owned(), |r| format!("{r:.2}"));
        let instead = instead(list);
        let _ = writeln!(
            text,
            "| {name} | {multiple} | {exact} | {detected} | {covered} | {ratio} | {instead} |"
        );
    }
    text
}

/// Whether the family-wise test keeps its level, and intervals of unseen readings theirs: campaigns without an effect, by specimens.
fn by_specimens(trials: &[Trial], outcomes: &[Outcome], scatter: Scatter) -> String {
    let mut groups: BTreeMap<usize, Vec<&Outcome>> = BTreeMap::new();
    for (t, o) in trials.iter().zip(outcomes) {
        if t.scatter == scatter && t.part == Part::Nothing {
            groups.entry(o.specimens).or_default().push(o);
        }
    }
    let mut text = "\n| no effect, specimens | campaigns | p at most 0.05 | p at most 0.2 | p at most 0.5 | held-out readings inside their 50% interval | inside 95% |\n".to_owned();
    text.push_str("|---|---|---|---|---|---|---|\n");
    for (specimens, list) in &groups {
        let below = |p: f64| Rate::of(list.iter().filter_map(|o| Some(o.smallest_p? <= p)));
        let [half, most] = [0, 1].map(|k| {
            let known: Vec<f64> = list.iter().filter_map(|o| o.inside[k]).collect();
            let mean = known.iter().sum::<f64>() / known.len() as f64;
            if known.is_empty() {
                "-".to_owned()
            } else {
                format!("{:.0}%", 100.0 * mean)
            }
        });
        let [a, b, c] = [0.05, 0.2, 0.5].map(below);
        let _ = writeln!(
            text,
            "| {specimens} | {} | {a} | {b} | {c} | {half} | {most} |",
            list.len()
        );
    }
    if groups.is_empty() {
        return String::new();
    }
    text
}

/// The row of the detailed table.
fn label(trial: &Trial) -> (Part, String, String) {
    let names: Vec<String> = trial.cases.iter().map(super::cases::Case::name).collect();
    let name = match trial.part {
        Part::Nothing | Part::Limits => "nothing".to_owned(),
        Part::Two => "two effects".to_owned(),
        Part::Rediscovery => format!("nothing, base {}", trial.base),
        Part::Recording => trial.mistake.map_or(String::new(), |m| format!("{m:?}")),
        _ => names.join(" + "),
    };
    let multiple = if trial.cases.is_empty() {
        String::new()
    } else {
        trial.multiple.to_string()
    };
    (trial.part, name, multiple)
}

/// What was found where it was not exact, the most frequent first.
fn instead(list: &[Pair]) -> String {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for (_, o) in list.iter().filter(|(_, o)| !o.exact) {
        *counts.entry(o.text()).or_default() += 1;
    }
    let mut counts: Vec<(String, usize)> = counts.into_iter().collect();
    counts.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(&b.0)));
    let words: Vec<String> = counts
        .iter()
        .take(4)
        .map(|(w, n)| format!("{w} ({n})"))
        .collect();
    words.join(", ")
}

/// Campaigns whose effect would have been absurd at the size asked for: with the largest size that is not, which is a smaller multiple.
fn capped(trials: &[Trial], outcomes: &[Outcome]) -> String {
    let all = trials.iter().zip(outcomes);
    let all: Vec<Pair> = all.filter(|(_, o)| o.size.capped).collect();
    let of = |(part, name): (Part, &str)| {
        let own: Vec<Pair> = all
            .iter()
            .copied()
            .filter(|(t, _)| t.part == part)
            .collect();
        let rate = exact(&own);
        (rate.of > 0).then(|| format!("{name} {} of {}", rate.hits, rate.of))
    };
    let parts = [
        (Part::Single, "one effect"),
        (Part::Two, "two"),
        (Part::OtherForm, "another form"),
        (Part::Outside, "outside the library"),
    ];
    let rates: Vec<String> = parts.into_iter().filter_map(of).collect();
    if rates.is_empty() {
        return String::new();
    }
    format!(
        "\nIn {} of {} campaigns the size asked for would have been absurd. They are not counted in the rates of the first tables, but with the largest size \
         that is not absurd, a smaller multiple of the limit, the exact set was found: {}.\n",
        all.len(),
        outcomes.len(),
        rates.join(", ")
    )
}

fn times(trials: &[Trial], outcomes: &[Outcome]) -> String {
    let generating = outcomes.iter().filter(|o| o.size.generating_limit).count();
    let seconds = |p| quantile(outcomes.iter().map(|o| o.seconds), p).unwrap_or(f64::NAN);
    format!(
        "\nIn {generating} of {} campaigns the findings stated no detection limit for what was put in, and that of the generating model stood in for it. A \
         search took {:.1} s (median), {:.1} s at most, beside others on the same cores.\n",
        trials.len(),
        seconds(0.5),
        seconds(1.0)
    )
}
