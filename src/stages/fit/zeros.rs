//! The zeros of a campaign's sessions beside one another: which of the logs taken for zeros were recorded while the actuator pulled.
//!
//! Without pressure an actuator pulls only where it is held at its resting length or beyond, hooked in and stretched. A zero log of such a session holds
//! that pull, which is then taken off every force of the session. Away from the resting length a vented actuator is slack, and what the load cell shows
//! is its zero. Where a session at resting length has a zero so far above those of the campaign's sessions away from it that it is none of these, their
//! median is taken off in its place, and in that of every other session at resting length with a zero above it: these were recorded in the same way, and a
//! pull may be small. What is declared gives way only where it is improbable by far, few sessions say little of how zeros scatter, and a zero far below is no
//! pull: the test is one-sided, Student's t of one more zero, at the probability that a normal distribution has beyond four standard deviations.

use pipeline_base::row::Row;
use pipeline_config::FitOptions;
use pipeline_numerics::distributions::{normal_cdf, student_t_quantile};
use pipeline_numerics::statistics::{mean, median, sd_by_median, standard_deviation};
use std::collections::{BTreeMap, BTreeSet};

/// A zero so many standard deviations from those of other sessions of its campaign is in doubt.
pub const FAR_FROM_OTHERS: f64 = 4.0;
/// Fewest other sessions that say what is usual.
const FEWEST_OTHERS: usize = 3;
/// Zeros scatter by this much at least, N: what a load cell does from day to day.
const LEAST_SD_N: f64 = 1.0;

/// Logged forces that differ by less are the same, N.
const SAME_N: f64 = 1e-6;

/// A zero beside those of other sessions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beside {
    /// Their median, N.
    pub median: f64,
    /// How far it is from that, in their standard deviations.
    pub deviations: f64,
}

/// A zero beside those of the other sessions of its campaign, N: a zero log that was recorded while the actuator was under tension has that in
/// it. Of fewer than three others none.
pub fn beside_others(applied_n: f64, others: &[f64]) -> Option<Beside> {
    if others.len() < FEWEST_OTHERS {
        return None;
    }
    let middle = median(others);
    let sizes: Vec<f64> = others.iter().map(|z| (z - middle).abs()).collect();
    let sd = sd_by_median(&sizes).max(LEAST_SD_N);
    Some(Beside {
        median: middle,
        deviations: (applied_n - middle) / sd,
    })
}

/// Whether a zero is above some others by more than one more of them could be, N.
fn is_above(zero_n: f64, others: &[f64]) -> bool {
    if others.len() < FEWEST_OTHERS {
        return false;
    }
    let n = others.len() as f64;
    let sd = standard_deviation(others).max(LEAST_SD_N) * (1.0 + 1.0 / n).sqrt();
    let limit = student_t_quantile(normal_cdf(FAR_FROM_OTHERS), n - 1.0);
    zero_n - mean(others) > limit * sd
}

/// What a session has of a zero, N, and the least and largest relative contraction at which it was tested.
struct Tested {
    zero_n: f64,
    contractions: (f64, f64),
}

/// The zero that is usual in its campaign, N, by session: of those whose zero was recorded while the actuator pulled.
pub fn usual_of_pulled(rows: &[Row], options: &FitOptions) -> BTreeMap<String, f64> {
    if !options.usual_zeros {
        return BTreeMap::new();
    }
    let mut campaigns: BTreeMap<(&str, u64), BTreeMap<&str, Tested>> = BTreeMap::new();
    let is_known =
        |r: &&Row| !r.excluded && r.zero_force_n.is_finite() && r.contraction_rel.is_finite();
    for row in rows.iter().filter(is_known) {
        let of_campaign = (row.campaign.as_str(), row.diameter_mm.to_bits());
        let sessions = campaigns.entry(of_campaign).or_default();
        let tested = sessions.entry(&row.session).or_insert(Tested {
            zero_n: row.zero_force_n,
            contractions: (f64::INFINITY, f64::NEG_INFINITY),
        });
        let (least, largest) = tested.contractions;
        tested.contractions = (
            least.min(row.contraction_rel),
            largest.max(row.contraction_rel),
        );
    }
    let mut usual = BTreeMap::new();
    for sessions in campaigns.into_values() {
        let away = sessions.values();
        let away = away.filter(|t| t.contractions.0 > options.at_rest);
        let away: Vec<f64> = away.map(|t| t.zero_n).collect();
        let at_rest = sessions.iter();
        let at_rest = at_rest.filter(|(_, t)| t.contractions.1 <= options.at_rest);
        if !at_rest.clone().any(|(_, t)| is_above(t.zero_n, &away)) {
            continue;
        }
        let usual_n = median(&away);
        let pulled = at_rest.filter(|(_, t)| t.zero_n > usual_n);
        usual.extend(pulled.map(|(session, _)| ((*session).to_owned(), usual_n)));
    }
    usual
}

/// The rows of whole campaigns with the usual zero taken off where the session's own was recorded while the actuator pulled.
pub fn with_usual_zeros(rows: Vec<Row>, options: &FitOptions) -> Vec<Row> {
    let usual = usual_of_pulled(&rows, options);
    with_zeros(rows, &usual)
}

/// The same for rows of sessions as they are read by themselves, beside a run: one with the logged forces that it has in the run has the zero that it has
/// there; one that was described otherwise since then is another session.
pub fn with_zeros_of_run(rows: Vec<Row>, of_run: &[Row], options: &FitOptions) -> Vec<Row> {
    let own: BTreeMap<(&str, &str, i64), &Row> = rows.iter().map(|r| (reading(r), r)).collect();
    let logged = |r: &Row| r.force_n + r.zero_force_n;
    let in_run = of_run.iter().filter(|r| {
        let own = own.get(&reading(r)).map(|own| logged(own));
        own.is_some_and(|own| (own - logged(r)).abs() <= SAME_N)
    });
    let mut zeros: BTreeMap<String, f64> = in_run
        .map(|r| (r.session.clone(), r.zero_force_n))
        .collect();
    let sessions: BTreeSet<&str> = rows.iter().map(|r| r.session.as_str()).collect();
    let new = rows.iter().filter(|r| !zeros.contains_key(&r.session));
    let others = of_run
        .iter()
        .filter(|r| zeros.contains_key(&r.session) || !sessions.contains(r.session.as_str()));
    let together: Vec<Row> = new.chain(others).cloned().collect();
    for (session, zero) in usual_of_pulled(&together, options) {
        zeros.entry(session).or_insert(zero);
    }
    with_zeros(rows, &zeros)
}

/// What tells a reading from others.
fn reading(row: &Row) -> (&str, &str, i64) {
    (&row.session, &row.log, row.first_row)
}

/// Rows with other zeros, N, by session.
fn with_zeros(mut rows: Vec<Row>, zeros: &BTreeMap<String, f64>) -> Vec<Row> {
    for row in &mut rows {
        if let Some(zero) = zeros.get(&row.session).filter(|z| **z != row.zero_force_n) {
            row.force_n += row.zero_force_n - zero;
            row.zero_force_n = *zero;
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_is_far_from_others_in_their_own_deviations() {
        let far = beside_others(1.0 + 5.0 * sd_by_median(&[1.0]), &[0.0, 1.0, 2.0]).unwrap();
        assert_eq!(far.median, 1.0);
        assert!((far.deviations - 5.0).abs() < 1e-12);
        // Others that agree to less than a load cell does from day to day.
        let near = beside_others(3.0, &[0.0, 0.0, 0.0]).unwrap();
        assert_eq!(near.deviations, 3.0);
        assert_eq!(beside_others(9.0, &[0.0, 0.0]), None);
    }

    /// A row at such a contraction, with such a zero taken off a logged force of 100 N.
    fn row(session: &str, contraction_rel: f64, zero_n: f64) -> Row {
        Row {
            session: session.to_owned(),
            contraction_rel,
            zero_force_n: zero_n,
            force_n: 100.0 - zero_n,
            ..Row::blank()
        }
    }

    #[test]
    fn a_zero_that_holds_the_pull_of_a_stretched_actuator_is_replaced_by_the_usual_one() {
        let mut rows = vec![
            row("a", 0.0, 15.0),
            row("b", -0.2, 12.0),
            row("c", 0.0, -30.0),
            row("d", 0.0, 1.5),
        ];
        let away = [0.0, 1.0, 2.0, 0.0, 1.0, 2.0, 1.0, 1.0];
        rows.extend(
            away.iter()
                .zip("efghijkl".chars())
                .map(|(z, s)| row(&s.to_string(), 0.5, *z)),
        );
        let options = FitOptions::default();
        let zeros = |rows: &[Row], options: &FitOptions| -> Vec<f64> {
            let after = with_usual_zeros(rows.to_vec(), options);
            let logged = |r: &Row| r.force_n + r.zero_force_n;
            assert!(after.iter().all(|r| (logged(r) - 100.0).abs() < 1e-12));
            after.iter().map(|r| r.zero_force_n).collect()
        };
        // c is no pull; d is a small one beside a and b.
        assert_eq!(zeros(&rows, &options)[..4], [1.0, 1.0, -30.0, 1.0]);
        assert_eq!(zeros(&rows, &options)[4..], away);
        // Another campaign says nothing, nor do few sessions away from rest, whose scatter is hardly known, nor one that was tested at rest and away from
        // it, whose zero has no length; and somebody may want zeros as they are declared.
        let declared = [15.0, 12.0, -30.0, 1.5];
        let mut apart = rows.clone();
        for r in apart.iter_mut().filter(|r| r.session.as_str() > "d") {
            r.campaign = "other".to_owned();
        }
        assert_eq!(zeros(&apart, &options)[..4], declared);
        assert_eq!(zeros(&rows[..8], &options)[..4], declared);
        let as_declared = FitOptions {
            usual_zeros: false,
            ..FitOptions::default()
        };
        assert_eq!(zeros(&rows, &as_declared)[..4], declared);
        rows.push(row("a", 0.4, 15.0));
        assert_eq!(zeros(&rows, &options)[..2], [15.0, 1.0]);
    }

    #[test]
    fn a_session_by_itself_has_the_zero_that_it_has_in_a_run() {
        let options = FitOptions::default();
        let away = (0..8).map(|k| row(&format!("away{k}"), 0.5, f64::from(k % 3)));
        let run: Vec<Row> = away
            .chain([row("a", 0.0, 15.0), row("b", 0.0, 1.5)])
            .collect();
        let run = with_usual_zeros(run, &options);
        let alone = vec![
            row("a", 0.0, 15.0),
            row("b", 0.0, 1.5),
            row("new", 0.0, 14.0),
        ];
        let alone = with_zeros_of_run(alone, &run, &options);
        for r in &alone[..2] {
            let same = run.iter().find(|k| k.session == r.session).unwrap();
            assert_eq!(
                (r.force_n, r.zero_force_n),
                (same.force_n, same.zero_force_n)
            );
        }
        // The zeros of the run are those that pulls are judged by.
        assert_eq!((alone[2].zero_force_n, alone[2].force_n), (1.0, 99.0));
        // The same session with another gain of the force is described otherwise.
        let mut otherwise = vec![row("b", 0.0, 1.5)];
        otherwise[0].force_n = 50.0;
        let otherwise = with_zeros_of_run(otherwise, &run, &options);
        assert_eq!(
            (otherwise[0].zero_force_n, otherwise[0].force_n),
            (1.5, 50.0)
        );
        let lone = with_zeros_of_run(vec![row("new", 0.0, 14.0)], &[], &options);
        assert_eq!(lone[0].zero_force_n, 14.0);
    }

    #[test]
    fn a_pull_is_beyond_what_one_more_zero_could_be() {
        // Mean 0, standard deviation 2: Student's t of 4 degrees of freedom at 1 - 3.167e-5 is 17.448228 (SciPy), times 2 sqrt(1.2).
        let others = [-2.0, -2.0, 0.0, 2.0, 2.0];
        let limit = 17.448_228 * 2.0 * 1.2_f64.sqrt();
        assert!(!is_above(0.9999 * limit, &others) && is_above(1.0001 * limit, &others));
        assert!(!is_above(1e3, &others[..2]));
    }
}
