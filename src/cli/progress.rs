//! Progress: a bar on a terminal, nothing elsewhere (the outcome says it all).

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use pipeline_run::Progress;
use std::io::IsTerminal;
use std::time::Duration;

/// Progress as the user sees it.
pub struct Shown {
    bar: ProgressBar,
}

impl Shown {
    /// A bar on standard error if that is a terminal and `quiet` is not asked for.
    pub fn new(quiet: bool) -> Self {
        let visible = !quiet && std::io::stderr().is_terminal();
        let target = if visible {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(0), target);
        let style = ProgressStyle::with_template("{msg:10} {bar:30} {pos}/{len} {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        if visible {
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        Self { bar }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Shown {
    fn begin(&self, stage: &str, units: usize) {
        self.bar.set_message(stage.to_owned());
        self.bar.set_length(units as u64);
        self.bar.set_position(0);
    }

    fn tick(&self) {
        self.bar.inc(1);
    }

    fn note(&self, message: &str) {
        self.bar.suspend(|| eprintln!("{message}"));
    }
}
