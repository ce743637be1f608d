//! One campaign of the benchmark: what is put in, how large, and what comes of it.

use super::cases::{Case, right_columns};
use super::judge;
use super::outcome::{Limit, Outcome, Size};
use super::search::search;
use pipeline::findings::CampaignFindings;
use pipeline::simulate::rig_like::{
    Campaign, Family, Generating, Mistake, Pace, Put, Scatter, Settings, campaign,
};
use std::time::Instant;

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// Nothing is put in.
    Nothing,
    /// Nothing is put in; only there for its detection limits.
    Limits,
    /// One effect in the library's form.
    Single,
    /// Two effects.
    Two,
    /// An effect in another form.
    OtherForm,
    /// An effect outside the library.
    Outside,
    /// Nothing is put in, and the base model does not know the resting length.
    Rediscovery,
    /// A recording error.
    Recording,
}

/// One campaign of the benchmark.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The row of the table to which it belongs.
    pub part: Part,
    /// Constants of the generator.
    pub family: Family,
    /// How much everything scatters.
    pub scatter: Scatter,
    /// How it is measured.
    pub pace: Pace,
    /// Number of specimens, if it is not drawn.
    pub specimens: Option<usize>,
    /// What is put in.
    pub cases: Vec<Case>,
    /// How large, in detection limits.
    pub multiple: f64,
    /// The recording error.
    pub mistake: Option<Mistake>,
    /// The base model.
    pub base: &'static str,
    /// Seed.
    pub seed: u64,
}

/// Standard deviations at which the generating model's own detection limit lies: about the family-wise level and 80% power.
const GENERATING_LIMIT: f64 = 3.7 + 0.84;
/// Between these parts of its largest size an effect of the wanted strength is looked for, in so many steps.
const SMALLEST: f64 = 1e-4;
const LARGEST: f64 = 2.0;
const STEPS: usize = 10;

impl Trial {
    /// What names it in the log. A campaign without an effect is one thing, whatever it is there for.
    pub fn name(&self) -> String {
        let part = match self.part {
            Part::Limits => Part::Nothing,
            part => part,
        };
        let cases: Vec<String> = self.cases.iter().map(Case::name).collect();
        let specimens = self.specimens.map_or("drawn".to_owned(), |n| n.to_string());
        let mistake = self.mistake.map_or(String::new(), |m| format!("{m:?}"));
        format!(
            "{part:?} {:?} {:?} {:?} specimens {specimens} [{}] x{} {mistake} base {} seed {}",
            self.family,
            self.scatter,
            self.pace,
            cases.join(" + "),
            self.multiple,
            self.base,
            self.seed
        )
    }

    /// The same campaign without what is put in: its detection limits say how large that is. None where nothing is put in.
    pub fn without(&self) -> Option<Trial> {
        (!self.cases.is_empty()).then(|| Trial {
            part: Part::Limits,
            cases: Vec::new(),
            multiple: 0.0,
            ..self.clone()
        })
    }

    /// Makes and searches the campaign, given the outcome without what is put in.
    pub fn run(&self, without: Option<&Outcome>) -> Outcome {
        let plain = campaign(self.seed, &self.settings(Vec::new()));
        let (puts, size) = self.puts(&plain, without);
        let made = if puts.is_empty() {
            plain
        } else {
            campaign(self.seed, &self.settings(puts))
        };
        let start = Instant::now();
        let found = search(&made.rows, self.base);
        let seconds = start.elapsed().as_secs_f64();
        let mut outcome = self.judged(&found, &made);
        outcome.seconds = seconds;
        outcome.log_density_gap = self.log_density_gap(&found, &made);
        outcome.scatter_ratios = judge::scatter_ratios(&found, &made.truth.drawn.sizes);
        outcome.error_ratio = outcome
            .rmse
            .zip(without.and_then(|w| w.rmse))
            .map(|(a, b)| a / b);
        if self.part == Part::Single {
            outcome.covered = judge::covered(&found, &self.cases[0], size.amplitudes[0]);
        }
        if self.cases.is_empty() {
            outcome.limits = limits(&found);
        }
        outcome.size = size;
        outcome
    }

    fn settings(&self, effects: Vec<Put>) -> Settings {
        Settings {
            family: self.family,
            scatter: self.scatter,
            specimens: self.specimens,
            pace: self.pace,
            effects,
            mistake: self.mistake,
        }
    }

    fn judged(&self, found: &CampaignFindings, made: &Campaign) -> Outcome {
        let ids: Vec<&str> = self.cases.iter().map(|c| c.id).collect();
        match self.part {
            Part::Outside => judge::of_column(found, ids[0]),
            Part::Rediscovery => judge::of_effects(found, &["rest_length_scaling"]),
            Part::Recording => {
                let mistaken = made.truth.mistaken.as_ref().expect("a mistake was made");
                judge::of_mistake(found, mistaken)
            }
            _ => judge::of_effects(found, &ids),
        }
    }

    /// Only where the base model is the one that generates, and nothing is written down wrongly.
    fn log_density_gap(&self, found: &CampaignFindings, made: &Campaign) -> Option<f64> {
        let comparable = [Part::Nothing, Part::Limits, Part::Single, Part::Two];
        let own = found.after.log_density_heldout?;
        comparable
            .contains(&self.part)
            .then(|| own - Generating::new(made).log_density())
    }

    /// The effects at their sizes.
    fn puts(&self, plain: &Campaign, without: Option<&Outcome>) -> (Vec<Put>, Size) {
        let sessions = plain.truth.drawn.setups.len();
        let sizing = Sizing {
            plain,
            sessions,
            limits: without.map_or(&[], |w| w.limits.as_slice()),
        };
        let mut size = Size::default();
        let mut puts = Vec::new();
        for (k, case) in self.cases.iter().enumerate() {
            let (limit, of_findings) = sizing.limit(case);
            size.generating_limit |= !of_findings;
            let wanted = match self.part {
                Part::OtherForm => sizing.as_strong_as(case, self.multiple * limit),
                Part::Outside if !case.is_line() => {
                    sizing.as_strong_as(case, self.multiple * limit)
                }
                _ => self.multiple * limit,
            };
            // Of another form also where the plain one would be absurd at that size.
            size.capped |= wanted > case.most || self.multiple * limit > case.most;
            let negative = case.both_signs && !(self.seed + k as u64).is_multiple_of(2);
            let sign = if negative { -1.0 } else { 1.0 };
            let amplitude = sign * wanted.min(case.most);
            size.amplitudes.push(amplitude);
            puts.push(case.put(amplitude, sessions));
        }
        (puts, size)
    }
}

/// How large an effect has to be.
struct Sizing<'a> {
    plain: &'a Campaign,
    sessions: usize,
    limits: &'a [Limit],
}

impl Sizing<'_> {
    /// The detection limit of a case, and whether it is the findings' own.
    fn limit(&self, case: &Case) -> (f64, bool) {
        let words = right_columns(case.id);
        let of_case = |l: &&Limit| {
            let is_column = words.iter().any(|w| l.id.starts_with(w));
            (l.id == case.id || is_column) && l.form == case.plain
        };
        // The findings' limits are of effects that act on all readings.
        let stated = self.limits.iter().find(of_case);
        match stated.filter(|_| case.from == 0.0) {
            Some(limit) if words.is_empty() => (limit.smallest.unwrap_or(f64::INFINITY), true),
            Some(limit) => (self.of_line(case, limit), true),
            None => (self.of_strength(case, GENERATING_LIMIT), false),
        }
    }

    /// The simulator's amplitude for a straight dependence on a column, of which the findings have the change over the column's range.
    fn of_line(&self, case: &Case, limit: &Limit) -> f64 {
        let Some(smallest) = limit.smallest else {
            return f64::INFINITY;
        };
        let rows = self.plain.rows.iter();
        let values = rows.map(|r| r.extras.get(&limit.id).map_or(r.force_n, |x| *x));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        case.of_slope * smallest / (high - low)
    }

    /// The amplitude at which an effect in another form is as strong as the plain form at an amplitude.
    fn as_strong_as(&self, case: &Case, amplitude: f64) -> f64 {
        let plain = Case {
            form: case.line,
            others: &[],
            ..*case
        };
        let strength = self.strength(&plain, amplitude.min(case.most));
        self.of_strength(case, strength)
    }

    /// By bisection: an angle's strength goes with its square, that of a threshold begins late.
    fn of_strength(&self, case: &Case, strength: f64) -> f64 {
        let (mut low, mut high) = (SMALLEST * case.most, LARGEST * case.most);
        for _ in 0..STEPS {
            let middle = (low * high).sqrt();
            if self.strength(case, middle) < strength {
                low = middle;
            } else {
                high = middle;
            }
        }
        (low * high).sqrt()
    }

    fn strength(&self, case: &Case, amplitude: f64) -> f64 {
        Generating::new(self.plain).strength(&[case.put(amplitude, self.sessions)])
    }
}

fn limits(found: &CampaignFindings) -> Vec<Limit> {
    let effects = found.detection_limits.iter();
    let effects = effects.filter(|l| l.smallest.is_finite() && l.smallest > 0.0);
    let effects = effects.map(|l| Limit {
        id: l.id.clone(),
        form: l.form.clone(),
        smallest: Some(l.smallest),
    });
    let columns = found.column_limits.iter().map(|l| Limit {
        id: l.column.clone(),
        form: l.shape.clone(),
        smallest: l.smallest,
    });
    effects.chain(columns).collect()
}
