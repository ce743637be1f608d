//! What the audit finds: a status for every claim, and a verdict for every test of consistency.

use super::beside::Beside;
use super::claims::{Claim, ClaimList};
use super::recompute::{Number, Status};

/// A claim with its status.
#[derive(Clone, Debug, PartialEq)]
pub struct ClaimFinding {
    /// Heading of its section.
    pub section: String,
    /// The paper, in one word.
    pub paper: String,
    /// The claim.
    pub claim: Claim,
    /// Recomputed all the way down.
    pub recomputed: Option<Number>,
    /// Recomputed with the numbers that the text prints; none where it rests on no other claim.
    pub from_print: Option<Number>,
    /// What became of it.
    pub status: Status,
    /// The claims that it rests on and that differ themselves, more than rounding explains: where its error comes from.
    pub traced_to: Vec<String>,
    /// What the measured campaigns or a model give beside it.
    pub beside: Vec<Beside>,
}

impl ClaimFinding {
    /// Whether the text's own arithmetic holds, with its own numbers and their rounding; none where it rests on no other claim.
    pub fn own_arithmetic_holds(&self) -> Option<bool> {
        let status = super::recompute::judge(&self.claim, self.from_print?);
        Some(match status {
            Status::Reproduced => true,
            Status::Differs { rounding, .. } => rounding,
            Status::CannotBeRecomputed(_) => false,
        })
    }
}

/// Whether a test of consistency is passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It is not: the numbers contradict each other.
    Inconsistent,
    /// It is; shown where the contrast with another case matters.
    Consistent,
}

impl Verdict {
    /// For a reader.
    pub fn name(self) -> &'static str {
        match self {
            Self::Inconsistent => "inconsistent",
            Self::Consistent => "consistent",
        }
    }
}

/// One case of a rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// What was tested: a quantity, a fit, a pair.
    pub subject: String,
    /// Ids of the claims, fits or pairs.
    pub of: Vec<String>,
    /// The verdict.
    pub verdict: Verdict,
    /// The first number compared.
    pub left: Option<f64>,
    /// The second.
    pub right: Option<f64>,
    /// Unit of both.
    pub unit: String,
    /// Why, in a sentence or two.
    pub reasoning: String,
}

/// A rule of consistency: it knows no particular claim.
pub struct Rule {
    /// Unique name in tables.
    pub id: &'static str,
    /// Heading.
    pub title: &'static str,
    /// What it tests and why, in a sentence or two.
    pub idea: &'static str,
    /// All cases that the list gives it.
    pub cases: fn(&ClaimList) -> Vec<Case>,
}

/// What a rule gave.
#[derive(Clone, Debug, PartialEq)]
pub struct RuleFinding {
    /// Name of the rule.
    pub id: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// Its idea.
    pub idea: &'static str,
    /// Its cases, passed ones included.
    pub cases: Vec<Case>,
}

/// Everything that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Audit {
    /// The claims, in the order of the papers.
    pub claims: Vec<ClaimFinding>,
    /// The rules, in the order of [`super::rules::ALL`].
    pub rules: Vec<RuleFinding>,
}

impl Audit {
    /// The finding of a claim.
    pub fn claim(&self, id: &str) -> Option<&ClaimFinding> {
        self.claims.iter().find(|c| c.claim.id == id)
    }

    /// The cases of a rule that are inconsistent.
    pub fn inconsistent(&self, rule: &str) -> Vec<&Case> {
        let rules = self.rules.iter().filter(|r| r.id == rule);
        let cases = rules.flat_map(|r| &r.cases);
        cases
            .filter(|c| c.verdict == Verdict::Inconsistent)
            .collect()
    }
}
