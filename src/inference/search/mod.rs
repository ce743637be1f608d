//! The search: forward from the null model, one term at a time, each tested against the maximum over all candidates; then deletions and
//! swaps among terms that show alike. A term that tells groups apart has to show beyond the scatter of its size among them as well
//! ([`crate::problem::Problem::scatters`]): what scatters from group to group differs between any two sets of groups. Where several came in, the search is
//! made again with another kind first, and the better one kept. At the end a term stays
//! only if it also shows where the size of any other one may bend along its own argument
//! ([`crate::problem::Problem::bends`]): an effect whose form the library does not have must not call up a second one.
//!
//! | file | idea |
//! |---|---|
//! | `step` | one term comes in, or none |
//! | `candidates` | the candidates beside a model, fitted in full |
//! | `worth` | which of some fits is preferred |
//! | `without` | the model without one of its terms |
//! | `bends` | what does not show beside another term that may bend goes |
//! | `tidy` | deletions, swaps, and what does as well in the place of a term |
//! | `pairs` | a term comes in while another gives way |
//! | `exchange` | the model built anew with other forms of what was found |

mod bends;
mod candidates;
mod exchange;
mod pairs;
mod step;
mod tidy;
mod without;
mod worth;

use crate::fit::{Fitted, Setting};
use crate::problem::{Point, Term};
use crate::screen::{Normal, Screen, Shown};
use crate::statistic::{critical, likelihood_ratio};
use std::collections::BTreeSet;
use without::LeftOut;

/// The numbers on which a search decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision {
    /// Family-wise level.
    pub level: f64,
    /// Draws of the bootstrap.
    pub draws: usize,
    /// Models whose log-likelihoods differ by less are alike: their terms are indistinguishable.
    pub alike: f64,
    /// Most terms in a model.
    pub most_terms: usize,
    /// Whether candidates are also looked for from nothing, and alternatives to what was accepted. Inside folds, where a search starts from what
    /// all readings gave, neither is needed.
    pub thorough: bool,
}

/// A term that was accepted.
#[derive(Clone, Debug, PartialEq)]
pub struct Accepted {
    /// Number of the term.
    pub term: usize,
    /// Family-wise probability, at the step where it came in.
    pub p: f64,
    /// The value of [`crate::statistic::deviate`] from which it was accepted.
    pub critical: f64,
    /// Gain in log-likelihood over the final model without it.
    pub gain: f64,
    /// Terms of other kinds that do as well in its place.
    pub in_its_place: Vec<Instead>,
}

impl Accepted {
    /// Names of the terms that do as well in its place, each once; those that have none are passed over.
    pub fn names_instead(&self, name: impl Fn(usize) -> Option<String>) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for name in self.in_its_place.iter().filter_map(|i| name(i.term)) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }
}

/// A term that does as well in the place of another.
#[derive(Clone, Debug, PartialEq)]
pub struct Instead {
    /// Number of the term.
    pub term: usize,
    /// Log-likelihood less that of the model.
    pub log_likelihood: f64,
    /// The model with it.
    pub point: Point,
}

/// What a search found; the models are where queries start.
#[derive(Clone, Debug)]
pub struct Found {
    /// The model without terms.
    pub null: Fitted,
    /// The final model.
    pub model: Fitted,
    /// Its terms, in the order in which they came in.
    pub accepted: Vec<Accepted>,
    /// Models on the way to it: a deletion leads back to one of them, if a fit from the larger model does not come as far.
    stages: Vec<Fitted>,
    /// The final model and others on the way without one of their terms.
    left_out: Vec<LeftOut>,
    /// The candidates beside the null, strongest first, with the number of the term.
    pub tested: Vec<(usize, Shown)>,
    /// Maxima of the draws from the null.
    pub draws: Vec<f64>,
    /// The value of [`crate::statistic::deviate`] from which a candidate is accepted.
    pub critical: f64,
}

impl Found {
    /// What its terms have to gain in log-likelihood to come in, each at a critical value of [`crate::statistic::deviate`].
    pub fn price(&self, terms: &[Term], critical: impl Fn(&Accepted) -> f64) -> f64 {
        let gains = self.accepted.iter();
        let gains = gains.map(|a| 0.5 * likelihood_ratio(critical(a), terms[a.term].amplitudes));
        gains.sum()
    }

    /// The term that came in first, where several did and are there still.
    fn first_of_several(&self) -> Option<usize> {
        let with_one = self.stages.get(1).filter(|_| self.accepted.len() > 1)?;
        with_one.point.terms.first().map(|(term, _)| *term)
    }
}

/// How many of the strongest candidates are fitted in full.
const FITTED: usize = 3;

/// A swap has to gain this much in log-likelihood, else the search would go in circles: fits end within less of the optimum.
pub const WORTH_A_SWAP: f64 = 0.1;

/// Most rounds of additions and deletions.
const MOST_ROUNDS: usize = 3;

/// A problem's search.
pub struct Search<'a> {
    /// The problem and its active part.
    pub setting: &'a Setting<'a>,
    /// What decides.
    pub decision: Decision,
    /// A model of the same problem whose terms are tried from its values, besides those that a screen shows.
    pub tried: Option<&'a Fitted>,
}

/// When a candidate is tested against draws from its own model as well as against those from the null.
#[derive(Clone, Copy)]
enum Drawn {
    /// Where the draws that were given, of another model of this kind, do not decide by far.
    IfDoubtful,
    /// Where that could change the answer in a design with many groups.
    IfClose,
    /// Wherever the null's draws do not make it improbable enough by far.
    Always,
}

/// How terms come in.
#[derive(Clone, Copy)]
struct Way {
    drawn: Drawn,
    /// Whether only terms with names do.
    named_only: bool,
    /// What each amplitude beyond the first has to gain for a term to be preferred to one without it.
    of_amplitude: f64,
    /// Whether one may come in while another gives way.
    in_pairs: bool,
    /// A kind that does not come in first.
    not_first: Option<usize>,
}

impl Search<'_> {
    /// Searches from a fitted null. `known` are draws of the same design, which stand for draws from this null. Where several terms came in, the search
    /// is made again with another kind first: of two that gain nearly as much by themselves chance decides which comes in first, and where that has
    /// a form that takes part of the other, what then comes in is what is left of both.
    pub fn run(&self, null: Fitted, normal: &Normal, known: Option<&[f64]>) -> Found {
        let begun = self.begun(null, normal, known);
        let way = Way {
            drawn: known.map_or(Drawn::IfClose, |_| Drawn::IfDoubtful),
            named_only: false,
            of_amplitude: self.decision.alike,
            in_pairs: false,
            not_first: None,
        };
        let mut found = self.completed(begun.clone(), normal, way);
        if let Some(first) = found.first_of_several()
            && self.decision.thorough
        {
            let other_first = Way {
                not_first: Some(self.setting.problem.terms()[first].kind),
                ..way
            };
            let mut other = begun;
            self.forward(&mut other, normal, other_first, found.accepted.len());
            // Each term at the price at which it came in: another model's draws may be wilder.
            let terms = self.setting.problem.terms();
            let worth = |f: &Found| self.weighed(&f.model) - f.price(terms, |a| a.critical);
            // Mostly the same terms come in by another way, to the same optimum.
            let is_same = terms_of(&other) == terms_of(&found)
                && self.weighed(&other.model) <= self.weighed(&found.model) + WORTH_A_SWAP;
            if !is_same {
                let other = self.completed(other, normal, other_first);
                if worth(&other) > worth(&found) + WORTH_A_SWAP {
                    found = other;
                }
            }
        }
        self.leave_out_bends(&mut found);
        found
    }

    /// Terms come in and go until nothing changes.
    fn completed(&self, mut found: Found, normal: &Normal, way: Way) -> Found {
        // What gave way to a term that then went itself may come back.
        let mut ended = Vec::new();
        for _ in 0..MOST_ROUNDS {
            self.forward(&mut found, normal, way, self.decision.most_terms);
            let before = found.accepted.len();
            let anything = Way {
                not_first: None,
                ..way
            };
            self.tidy(&mut found, anything);
            let terms: Vec<usize> = found.accepted.iter().map(|a| a.term).collect();
            if found.accepted.len() == before || terms == ended {
                break;
            }
            ended = terms;
        }
        found
    }

    /// The same, with exchanges after every step: the model is built anew with every choice of forms, because the first form to come in may lead
    /// the others to another optimum. Where a term without a name came in, the terms with names
    /// are also tried by themselves first: a flexible curve beside half of what is there must not stand for the other half. Further terms are
    /// tested against draws from the model itself: with a handful of groups, what is between groups in the null model makes its draws wilder
    /// than those of a model that explains it. Where none shows, one may come in while another gives way. A term with several amplitudes has to be worth
    /// each of them. For problems whose fits are cheap.
    pub fn run_exchanging(&self, null: Fitted, normal: &Normal, known: Option<&[f64]>) -> Found {
        let begun = self.begun(null, normal, known);
        let way = |named_only| Way {
            drawn: known.map_or(Drawn::Always, |_| Drawn::IfDoubtful),
            named_only,
            of_amplitude: self.decision.alike,
            in_pairs: true,
            not_first: None,
        };
        let mut found = self.grown(begun.clone(), normal, way(false));
        let is_named = |a: &Accepted| self.setting.problem.terms()[a.term].named;
        if !found.accepted.iter().all(is_named) {
            let named = self.grown(begun, normal, way(true));
            let named = self.grown(named, normal, way(false));
            if named.model.log_likelihood > found.model.log_likelihood - self.decision.alike {
                found = named;
            }
        }
        self.tidy(&mut found, way(false));
        found
    }

    /// Terms come in one by one, with exchanges after each.
    fn grown(&self, mut found: Found, normal: &Normal, way: Way) -> Found {
        loop {
            let before = found.accepted.len();
            self.forward(
                &mut found,
                normal,
                way,
                (before + 1).min(self.decision.most_terms),
            );
            if found.accepted.len() == before {
                return found;
            }
            self.exchange(&mut found, way);
        }
    }

    /// The null with its candidates and draws.
    fn begun(&self, null: Fitted, normal: &Normal, known: Option<&[f64]>) -> Found {
        let screen = Screen::new(self.setting, &null);
        let shown = screen.shown(2 * Screen::refined_in_draws());
        let draws = known.map_or_else(
            || screen.draws(self.decision.draws, normal),
            <[f64]>::to_vec,
        );
        Found {
            critical: critical(&draws, self.decision.level),
            tested: shown
                .iter()
                .map(|s| (screen.directions[s.direction].term, s.clone()))
                .collect(),
            model: null.clone(),
            null: null.clone(),
            accepted: Vec::new(),
            stages: Vec::new(),
            left_out: Vec::new(),
            draws,
        }
    }

    /// The candidates beside a model.
    fn screen<'s>(&self, setting: &'s Setting<'s>, model: &'s Fitted, way: Way) -> Screen<'s> {
        let mut screen = Screen::new(setting, model);
        if way.named_only {
            let terms = setting.problem.terms();
            let mut directions = std::mem::take(&mut screen.directions);
            directions.retain(|d| terms[d.term].named);
            screen = Screen::of(setting, model, directions).bounded();
        }
        screen
    }

    /// A fit from where a comparison left it to its estimates.
    fn estimated(&self, compared: &Fitted) -> Fitted {
        let starts = std::slice::from_ref(&compared.variances);
        self.setting.fit(&compared.point, starts)
    }
}

/// The terms that were found, in whatever order.
fn terms_of(found: &Found) -> BTreeSet<usize> {
    found.accepted.iter().map(|a| a.term).collect()
}
