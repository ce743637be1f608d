//! Is there anything at all? The residual against every column, by permutation.
//!
//! The statistic is the share of the sum of squares that the means over (up to) eight classes of the column explain. What is
//! permuted must be exchangeable if the column says nothing:
//! - a column that differs within a log: its readings within each log;
//! - a column that is constant within a session: the means of the sessions, each specimen's own mean taken off where the column
//!   differs within specimens;
//! - a column that is constant within a specimen is answered by its strength, and is asked of the strengths.
//!
//! The p-values are corrected for the number of questions (Holm 1979).

use super::data::Data;
use super::findings::Question;
use crate::base::random::Stream;
use std::collections::BTreeSet;

/// Classes of a column.
const CLASSES: usize = 8;

/// A column of which the residual is asked.
#[derive(Clone, Debug)]
pub struct Asked {
    /// Name.
    pub name: String,
    /// One value a reading.
    pub values: Vec<f64>,
}

/// Every column and derived quantity of the readings.
pub fn columns(data: &Data, predicted: &[f64]) -> Vec<Asked> {
    let c = &data.conditions;
    let of = |name: &str, f: &dyn Fn(usize) -> f64| Asked {
        name: name.to_owned(),
        values: (0..data.len()).map(f).collect(),
    };
    let mut columns = vec![
        of("pressure_kpa", &|i| c[i].pressure_kpa),
        of("contraction_rel", &|i| {
            (c[i].rest_length_m - c[i].length_m) / (c[i].rest_length_m - c[i].contracted_length_m)
        }),
        of("force_n", &|i| predicted[i]),
        of("direction", &|i| c[i].direction),
        of("time_s", &|i| c[i].log_time_s),
        of("since_step_s", &|i| c[i].since_step_s),
        of("pressure_rate", &|i| c[i].rate_kpa_per_s),
        of("temperature_c", &|i| c[i].temperature_c),
        of("cycles", &|i| c[i].cycles),
        of("session_order", &|i| c[i].campaign_time),
        of("log", &|i| data.log[i] as f64),
        of("session", &|i| data.session[i] as f64),
        of("rest_length_m", &|i| c[i].rest_length_m),
    ];
    columns.extend(data.extras.iter().map(|e| Asked {
        name: e.name.clone(),
        values: e.values.clone(),
    }));
    columns.retain(|a| {
        let distinct: BTreeSet<u64> = a.values.iter().map(|x| x.to_bits()).collect();
        distinct.len() > 1
    });
    columns
}

/// Asks the residual; `strengths` answer for columns that are constant within a specimen.
pub fn ask(
    data: &Data,
    residuals: &[f64],
    columns: &[Asked],
    permutations: usize,
    seed: u64,
) -> Vec<Question> {
    let mut questions: Vec<Question> = columns
        .iter()
        .filter_map(|a| question(data, residuals, a, permutations, seed))
        .collect();
    holm(&mut questions);
    questions
}

fn holm(questions: &mut [Question]) {
    let mut order: Vec<usize> = (0..questions.len()).collect();
    order.sort_by(|a, b| questions[*a].p.total_cmp(&questions[*b].p).then(a.cmp(b)));
    let mut largest = 0.0_f64;
    for (rank, k) in order.into_iter().enumerate() {
        largest = largest.max(questions[k].p * (columns_left(rank, questions.len())));
        questions[k].p_adjusted = largest.min(1.0);
    }
}

fn columns_left(rank: usize, all: usize) -> f64 {
    (all - rank) as f64
}

/// Whether a column is constant within each of some groups.
fn constant_within(values: &[f64], groups: &[usize]) -> bool {
    let most = groups.iter().copied().max().map_or(0, |k| k + 1);
    let mut first: Vec<Option<f64>> = vec![None; most];
    values
        .iter()
        .zip(groups)
        .all(|(x, g)| *first[*g].get_or_insert(*x) == *x)
}

fn question(
    data: &Data,
    residuals: &[f64],
    asked: &Asked,
    permutations: usize,
    seed: u64,
) -> Option<Question> {
    if constant_within(&asked.values, &data.specimen) {
        return None;
    }
    let by_session = constant_within(&asked.values, &data.session);
    let (y, x, blocks, words) = if by_session || asked.name == "session" {
        let (y, x, blocks) = session_means(data, residuals, &asked.values);
        (y, x, blocks, "sessions within specimens")
    } else {
        (
            residuals.to_vec(),
            asked.values.clone(),
            data.log.clone(),
            "readings within logs",
        )
    };
    if asked.name == "session" {
        return Some(spread(data, residuals, permutations, seed));
    }
    let classes = classes(&x);
    let mut stream = Stream::new(seed, &["question", &asked.name]);
    let observed = between(&y, &classes);
    let (mut exceed, mut chance) = (1, 0.0);
    let mut shuffled = y.clone();
    let members = members(&blocks);
    for _ in 0..permutations {
        for block in &members {
            for k in (1..block.len()).rev() {
                let other = stream.below(k + 1);
                shuffled.swap(block[k], block[other]);
            }
        }
        let drawn = between(&shuffled, &classes);
        chance += drawn;
        if drawn >= observed {
            exceed += 1;
        }
    }
    let all: f64 = residuals.iter().map(|r| r * r).sum();
    let full = between(residuals, &self::classes(&asked.values));
    let by_chance = if observed > 0.0 {
        full * (chance / f64::from(permutations as u32)) / observed
    } else {
        0.0
    };
    Some(Question {
        column: asked.name.clone(),
        blocks: words.to_owned(),
        share: ((full - by_chance) / all.max(f64::MIN_POSITIVE)).max(0.0),
        p: f64::from(exceed) / (permutations + 1) as f64,
        p_adjusted: 1.0,
    })
}

/// Whether sessions differ from each other at all, whatever their order: readings permuted among the sessions of a specimen.
fn spread(data: &Data, residuals: &[f64], permutations: usize, seed: u64) -> Question {
    let mut stream = Stream::new(seed, &["question", "session"]);
    let observed = between(residuals, &data.session);
    let members = members(&data.specimen);
    let mut shuffled = residuals.to_vec();
    let (mut exceed, mut chance) = (1, 0.0);
    for _ in 0..permutations {
        for block in &members {
            for k in (1..block.len()).rev() {
                let other = stream.below(k + 1);
                shuffled.swap(block[k], block[other]);
            }
        }
        let drawn = between(&shuffled, &data.session);
        chance += drawn;
        if drawn >= observed {
            exceed += 1;
        }
    }
    let all: f64 = residuals.iter().map(|r| r * r).sum();
    Question {
        column: "session".to_owned(),
        blocks: "readings within specimens".to_owned(),
        share: ((observed - chance / f64::from(permutations as u32)) / all.max(f64::MIN_POSITIVE))
            .max(0.0),
        p: f64::from(exceed) / (permutations + 1) as f64,
        p_adjusted: 1.0,
    }
}

fn members(blocks: &[usize]) -> Vec<Vec<usize>> {
    let most = blocks.iter().copied().max().map_or(0, |k| k + 1);
    let mut members = vec![Vec::new(); most];
    for (i, b) in blocks.iter().enumerate() {
        members[*b].push(i);
    }
    members
}

/// Mean residual of each session less that of its specimen, its value of the column, and its specimen.
fn session_means(
    data: &Data,
    residuals: &[f64],
    values: &[f64],
) -> (Vec<f64>, Vec<f64>, Vec<usize>) {
    let sessions = data.sessions.len();
    let (mut sum, mut count, mut x) = (
        vec![0.0; sessions],
        vec![0.0; sessions],
        vec![f64::NAN; sessions],
    );
    for i in 0..data.len() {
        sum[data.session[i]] += residuals[i];
        count[data.session[i]] += 1.0;
        x[data.session[i]] = values[i];
    }
    let of = data.specimen_of_session();
    let present: Vec<usize> = (0..sessions).filter(|s| count[*s] > 0.0).collect();
    let mut means: Vec<f64> = present.iter().map(|s| sum[*s] / count[*s]).collect();
    let blocks: Vec<usize> = present.iter().map(|s| of[*s]).collect();
    for block in members(&blocks) {
        let mean = block.iter().map(|k| means[*k]).sum::<f64>() / block.len().max(1) as f64;
        for k in block {
            means[k] -= mean;
        }
    }
    (means, present.iter().map(|s| x[*s]).collect(), blocks)
}

/// The class of each value: by rank, equal values together.
pub fn classes(values: &[f64]) -> Vec<usize> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let classes = CLASSES.min(values.len() / 3).max(2);
    let edges: Vec<f64> = (1..classes)
        .map(|k| sorted[k * sorted.len() / classes])
        .collect();
    values
        .iter()
        .map(|x| edges.iter().take_while(|e| **e <= *x).count())
        .collect()
}

/// Sum of squares between classes.
fn between(y: &[f64], classes: &[usize]) -> f64 {
    let most = classes.iter().copied().max().map_or(0, |k| k + 1);
    let (mut sum, mut count) = (vec![0.0; most], vec![0.0; most]);
    for (v, c) in y.iter().zip(classes) {
        sum[*c] += v;
        count[*c] += 1.0;
    }
    let n: f64 = count.iter().sum();
    let mean = sum.iter().sum::<f64>() / n.max(1.0);
    (0..most)
        .filter(|c| count[*c] > 0.0)
        .map(|c| count[c] * (sum[c] / count[c] - mean) * (sum[c] / count[c] - mean))
        .sum()
}
