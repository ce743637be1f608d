//! All campaigns of the benchmark.

use super::cases::{self, Case, SINGLE};
use super::trial::{Part, Trial};
use pipeline::simulate::rig_like::{Family, Mistake, Pace, Scatter};

/// Sizes of a single effect, in detection limits.
pub const MULTIPLES: [f64; 3] = [1.0, 1.5, 4.0];
/// Size of everything else.
const FOUR: f64 = 4.0;
/// Campaigns without an effect, for each seed of every effect.
const NOTHING: u64 = 10;
/// Campaigns with two effects, for the same.
const PAIRS: u64 = 5;
/// Base models that do not know the resting length.
const BASES: [&str; 2] = ["hunt2017", "festo_tool"];
/// Specimens, each of another length, where a campaign has many: as many as the laboratory's, ten of 10 mm from 112 to 518 mm, and more.
pub const MANY_LENGTHS: [usize; 2] = [10, 16];
/// Recording errors.
const MISTAKES: [Mistake; 4] = [
    Mistake::SwappedColumns,
    Mistake::RestLength,
    Mistake::SetLength,
    Mistake::Sign,
];

/// What the campaigns have in common.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Constants of the generator.
    pub family: Family,
    /// Seeds of every single effect: 20 for the whole table.
    pub seeds: u64,
}

impl Plan {
    /// The whole table: rig-like campaigns, then clean ones.
    pub fn trials(&self) -> Vec<Trial> {
        let rig = Scatter::RigLike;
        let mut list = self.nothing(rig, NOTHING * self.seeds);
        for multiple in MULTIPLES {
            list.extend(self.singles(rig, multiple, self.seeds));
        }
        list.extend(self.pairs(rig, PAIRS * self.seeds));
        list.extend(self.each(
            Part::OtherForm,
            rig,
            cases::other_forms(self.family),
            self.seeds,
        ));
        list.extend(self.each(Part::Outside, rig, cases::outside(self.family), self.seeds));
        list.extend(self.rediscovery(2 * self.seeds));
        for lengths in MANY_LENGTHS {
            list.extend(self.rediscovery_of(lengths, 2 * self.seeds));
        }
        list.extend(self.recording(3 * self.seeds));
        let clean = Scatter::Clean;
        list.extend(self.nothing(clean, NOTHING * self.seeds));
        list.extend(self.singles(clean, FOUR, self.seeds));
        list.extend(self.pairs(clean, PAIRS * self.seeds));
        list.extend(self.each(
            Part::OtherForm,
            clean,
            cases::other_forms(self.family),
            self.seeds,
        ));
        list.extend(self.each(
            Part::Outside,
            clean,
            cases::outside(self.family),
            self.seeds,
        ));
        list
    }

    /// A form of minutes: every row of the rig-like block.
    pub fn short(&self) -> Vec<Trial> {
        let rig = Scatter::RigLike;
        let mut list = self.nothing(rig, 8);
        list.extend(self.singles(rig, FOUR, 1));
        list.extend(self.pairs(rig, 4));
        let some = |cases: &'static [Case]| cases.iter().step_by(3).copied().collect::<Vec<Case>>();
        list.extend(self.each(
            Part::OtherForm,
            rig,
            &some(cases::other_forms(self.family)),
            1,
        ));
        list.extend(self.each(Part::Outside, rig, &some(cases::outside(self.family)), 2));
        list.extend(self.rediscovery(2));
        list.extend(self.recording(4));
        list
    }

    fn trial(&self, part: Part, scatter: Scatter, seed: u64) -> Trial {
        // Seeds of the published table are nobody else's.
        let apart = match self.family {
            Family::Design => 0,
            Family::Published => 700_000,
        };
        Trial {
            part,
            family: self.family,
            scatter,
            pace: Pace::Staircase,
            specimens: None,
            cases: Vec::new(),
            multiple: 0.0,
            mistake: None,
            base: "new",
            seed: apart + seed,
        }
    }

    fn nothing(&self, scatter: Scatter, n: u64) -> Vec<Trial> {
        let trial = |seed| self.trial(Part::Nothing, scatter, seed);
        (0..n).map(trial).collect()
    }

    fn singles(&self, scatter: Scatter, multiple: f64, n: u64) -> Vec<Trial> {
        let list = self.each(Part::Single, scatter, SINGLE, n).into_iter();
        list.map(|t| Trial { multiple, ..t }).collect()
    }

    /// Campaigns of every case, at four detection limits. Their seeds are those of campaigns without an effect, so that these serve for
    /// the limits; as few cases as possible share one. A table of more seeds has all campaigns of a shorter one.
    fn each(&self, part: Part, scatter: Scatter, cases: &[Case], n: u64) -> Vec<Trial> {
        let one = |(k, case): (usize, &Case)| {
            let case = *case;
            (0..n).map(move |j| Trial {
                pace: case.pace,
                cases: vec![case],
                multiple: FOUR,
                ..self.trial(part, scatter, NOTHING * j + k as u64 % NOTHING)
            })
        };
        cases.iter().enumerate().flat_map(one).collect()
    }

    fn pairs(&self, scatter: Scatter, n: u64) -> Vec<Trial> {
        let pairs = cases::pairs();
        // A step that has no divisor in common with the number of pairs visits all of them.
        let step = (7..).find(|s| !pairs.len().is_multiple_of(*s)).unwrap_or(1);
        let one = |k: u64| Trial {
            cases: pairs[(k as usize * step) % pairs.len()].to_vec(),
            multiple: FOUR,
            ..self.trial(Part::Two, scatter, NOTHING * (k / PAIRS) + k % PAIRS)
        };
        (0..n).map(one).collect()
    }

    fn rediscovery(&self, n: u64) -> Vec<Trial> {
        let one = |k: u64| Trial {
            specimens: Some(6 + (k / 2) as usize % 3),
            base: BASES[k as usize % 2],
            ..self.trial(Part::Rediscovery, Scatter::RigLike, 9_000 + k)
        };
        (0..n).map(one).collect()
    }

    /// With so many lengths.
    fn rediscovery_of(&self, lengths: usize, n: u64) -> Vec<Trial> {
        let one = |k: u64| Trial {
            specimens: Some(lengths),
            base: BASES[k as usize % 2],
            ..self.trial(Part::Rediscovery, Scatter::RigLike, 9_500 + k)
        };
        (0..n).map(one).collect()
    }

    fn recording(&self, n: u64) -> Vec<Trial> {
        let one = |k: u64| Trial {
            mistake: Some(MISTAKES[k as usize % MISTAKES.len()]),
            ..self.trial(Part::Recording, Scatter::RigLike, 8_000 + k)
        };
        (0..n).map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_whole_table_has_as_many_campaigns_as_the_specification_asks_for() {
        let trials = Plan {
            family: Family::Published,
            seeds: 20,
        }
        .trials();
        let names: BTreeSet<String> = trials.iter().map(Trial::name).collect();
        assert_eq!(names.len(), trials.len());
        let rig = |part: Part| {
            let own = |t: &&Trial| t.part == part && t.scatter == Scatter::RigLike;
            trials.iter().filter(own).count()
        };
        assert_eq!(rig(Part::Nothing), 200);
        assert_eq!(rig(Part::Single), 20 * SINGLE.len() * MULTIPLES.len());
        assert_eq!(
            rig(Part::OtherForm),
            20 * cases::other_forms(Family::Published).len()
        );
        let rest = [Part::Two, Part::Outside, Part::Rediscovery, Part::Recording];
        assert_eq!(rest.map(rig), [100, 100, 120, 60]);
    }

    #[test]
    fn a_table_of_more_seeds_has_all_campaigns_of_a_shorter_one() {
        let names = |seeds: u64| -> BTreeSet<String> {
            let plan = Plan {
                family: Family::Published,
                seeds,
            };
            plan.trials().iter().map(Trial::name).collect()
        };
        assert!(names(1).is_subset(&names(2)) && names(2).is_subset(&names(20)));
    }

    #[test]
    fn every_pair_of_effects_has_its_turn() {
        let plan = Plan {
            family: Family::Design,
            seeds: 20,
        };
        let pairs = plan.pairs(Scatter::RigLike, cases::pairs().len() as u64);
        let names: BTreeSet<String> = pairs
            .iter()
            .map(|t| {
                t.cases
                    .iter()
                    .map(Case::name)
                    .collect::<Vec<String>>()
                    .join(" + ")
            })
            .collect();
        assert_eq!(names.len(), cases::pairs().len());
    }
}
