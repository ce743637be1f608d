//! Progress: a bar on a terminal, nothing elsewhere (the outcome says it all).

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use pipeline_run::Progress;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::Duration;

/// What one unit of a stage costs, in arbitrary units: how far the bar moves with it, and so what time is left. One that is not named costs 1.
const COSTS: [(&str, u64); 5] = [
    ("fit", 150),
    ("compare", 2),
    ("diagnose", 250),
    ("torque", 300),
    ("report", 150),
];
/// Share of the work before which nothing is said of the time that is left.
const TOO_EARLY: f64 = 0.03;
/// Units at work that are named.
const NAMED: usize = 2;

/// Progress as the user sees it.
pub struct Shown {
    bar: ProgressBar,
    at_work: Mutex<BTreeSet<(&'static str, String)>>,
}

impl Shown {
    /// A bar on standard error if that is a terminal and `quiet` is not set.
    pub fn new(quiet: bool) -> Self {
        let visible = !quiet && std::io::stderr().is_terminal();
        let target = if visible {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(0), target);
        let style = ProgressStyle::with_template("{bar:20} {percent:>3}%{left} {wide_msg}");
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style.with_key("left", time_left));
        if visible {
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        Self {
            bar,
            at_work: Mutex::default(),
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Changes what is at work, and says it.
    fn change(&self, change: impl FnOnce(&mut BTreeSet<(&'static str, String)>)) {
        if let Ok(mut at_work) = self.at_work.lock() {
            change(&mut at_work);
            self.bar.set_message(message(&at_work));
        }
    }
}

fn message(at_work: &BTreeSet<(&'static str, String)>) -> String {
    let named = at_work.iter().take(NAMED);
    let named: Vec<String> = named.map(|(s, u)| format!("{s} {u}")).collect();
    let more = match at_work.len().saturating_sub(NAMED) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    named.join(", ") + &more
}

/// By what has been done so far, on the whole: a rate of late would call a long unit a standstill.
fn time_left(state: &ProgressState, text: &mut dyn Write) {
    let done = f64::from(state.fraction());
    if done > TOO_EARLY && done < 1.0 {
        let left_s = state.elapsed().as_secs_f64() * (1.0 / done - 1.0);
        let _ = write!(text, ", {}", about(left_s));
    }
}

/// `about 40 s left`, `about 3 min left`.
fn about(left_s: f64) -> String {
    if left_s < 90.0 {
        format!("about {:.0} s left", 10.0 * (left_s / 10.0).ceil())
    } else {
        format!("about {:.0} min left", left_s / 60.0)
    }
}

fn cost(stage: &str) -> u64 {
    let named = COSTS.iter().find(|(name, _)| *name == stage);
    named.map_or(1, |(_, cost)| *cost)
}

impl Progress for Shown {
    fn begin(&self, stages: &[(&'static str, usize)]) {
        let costs = stages.iter().map(|(s, units)| cost(s) * *units as u64);
        self.bar.set_length(costs.sum());
        self.bar.reset();
    }

    fn at(&self, stage: &'static str, unit: &str) {
        self.change(|at_work| {
            at_work.insert((stage, unit.to_owned()));
        });
    }

    fn done(&self, stage: &'static str, unit: &str) {
        self.bar.inc(cost(stage));
        self.change(|at_work| {
            at_work.remove(&(stage, unit.to_owned()));
        });
    }

    fn note(&self, message: &str) {
        self.bar.suspend(|| eprintln!("{message}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_at_work_is_named_and_the_rest_counted() {
        let at_work = |names: &[&str]| {
            let all = names.iter().map(|name| ("fit", (*name).to_owned()));
            message(&all.collect())
        };
        assert_eq!(at_work(&[]), "");
        assert_eq!(at_work(&["a", "b"]), "fit a, fit b");
        assert_eq!(at_work(&["a", "b", "c"]), "fit a, fit b and 1 more");
    }

    #[test]
    fn the_time_that_is_left_is_round() {
        assert_eq!(about(1.0), "about 10 s left");
        assert_eq!(about(41.0), "about 50 s left");
        assert_eq!(about(170.0), "about 3 min left");
    }

    #[test]
    fn a_bar_that_nobody_sees_counts_all_the_same() {
        let shown = Shown::new(true);
        shown.begin(&[("clean", 2), ("report", 1)]);
        for (stage, unit) in [("clean", "a"), ("clean", "b"), ("report", "tables")] {
            shown.at(stage, unit);
            shown.done(stage, unit);
        }
        assert_eq!(shown.bar.position(), shown.bar.length().unwrap());
        assert!(shown.at_work.lock().unwrap().is_empty());
    }
}
