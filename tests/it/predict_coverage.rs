//! Does the interval of a prediction keep its word? Simulated campaigns, and readings of specimens that were not in them.

use crate::support::searched_law;
use pipeline::base::row::Row;
use pipeline::predict::interval::Interval;
use pipeline::simulate::{self, Truth};
use pipeline::stages::diagnose::mixed_law::{MixedLaw, Muscle, Whose};
use pipeline::stages::fit::Group;
use rayon::prelude::*;

const TRUTH: &str = r#"
schema = "bpa-truth/1"
campaign = "coverage"
seed = 1
diameter_mm = 10
coefficients = "published"
contractions = [0, 0.25, 0.5, 0.75]
runs = [8]
run_speed = [1]
sampling = "timeseries"
"#;

/// A campaign of specimens with ids that begin with `name`; what a specimen is like is drawn from seed and id.
fn truth(name: &str, lengths_mm: &[f64]) -> Truth {
    let specimens: Vec<String> = lengths_mm
        .iter()
        .map(|l| {
            format!(
                "[[specimen]]\nid = \"{name}{l}\"\nrest_length_mm = {l}\ncontraction_max = 0.165\n"
            )
        })
        .collect();
    let text = format!("{TRUTH}\n{}", specimens.concat());
    simulate::read_truth("coverage.toml", &text).unwrap_or_else(|d| panic!("{d:?}"))
}

fn law_of(rows: &[Row]) -> MixedLaw {
    let group = Group {
        campaign: "coverage".to_owned(),
        diameter_mm: 10,
        members: vec!["coverage".to_owned()],
        simulated: true,
    };
    let rows: Vec<&Row> = rows.iter().collect();
    searched_law(&group, &rows)
}

/// Of 100, how many readings of unseen specimens lie inside their interval, and how many of those above 20 N; over so many campaigns of
/// specimens of these lengths. A reading below zero counts as zero: an actuator does not push.
fn coverage(lengths_mm: &[f64], unseen_mm: &[f64], campaigns: u64) -> (f64, f64) {
    let count = |seed: u64| {
        let (mut seen, mut unseen) = (truth("l", lengths_mm), truth("n", unseen_mm));
        (seen.seed, unseen.seed) = (seed, seed);
        let law = law_of(&simulate::campaign_rows(&seen).rows);
        let muscle = Muscle::unread(&law);
        let (mut all, mut pulling) = ([0_usize; 2], [0_usize; 2]);
        for row in simulate::campaign_rows(&unseen).rows {
            let state = [
                row.rest_length_m,
                row.contracted_length_m,
                row.length_m,
                row.pressure_kpa.max(0.0),
            ];
            let interval = Interval::of(&muscle.at(state, Whose::Rig), 0.0);
            let force = row.force_n.max(0.0);
            let inside = usize::from(interval.low_n <= force && force <= interval.high_n);
            all = [all[0] + inside, all[1] + 1];
            if force > 20.0 {
                pulling = [pulling[0] + inside, pulling[1] + 1];
            }
        }
        [all, pulling]
    };
    let counts: Vec<_> = (0..campaigns).into_par_iter().map(count).collect();
    let share = |which: usize| {
        let sum = |k: usize| counts.iter().map(|c| c[which][k]).sum::<usize>() as f64;
        100.0 * sum(0) / sum(1)
    };
    (share(0), share(1))
}

/// Minutes: run by `.ci/run`.
mod long {
    use super::*;

    /// Measured above 20 N: 98.8% (six specimens), 98.3% (four) and 98.9% (three). These campaigns have contracted lengths that are noted rightly, which
    /// four specimens can hardly tell: the interval counts what noted ones may be off by. Below 20 N a reading is mostly noise, cut at zero, and lies
    /// inside more often. Readings of one specimen share its gain, so that the 400 specimens of a line tell its share to about one or two percent.
    #[test]
    #[ignore = "long: 280 s of processor time"]
    fn about_95_of_100_forces_of_unseen_specimens_lie_inside() {
        let unseen = [90.0, 100.0, 150.0, 210.0, 270.0, 340.0, 400.0, 440.0];
        for lengths in [
            &[83.0, 112.0, 182.0, 257.0, 382.0, 455.0][..],
            &[83.0, 182.0, 300.0, 455.0],
            &[112.0, 233.0, 382.0],
        ] {
            let (all, pulling) = coverage(lengths, &unseen, 50);
            println!(
                "{} specimens: {all:.1}% of all readings, {pulling:.1}% of those above 20 N",
                lengths.len()
            );
            assert!((91.0..=99.0).contains(&pulling), "{pulling}");
            assert!((92.0..=99.5).contains(&all), "{all}");
        }
    }
}
