//! Mistakes of recording: sessions and specimens that the rest of the campaign does not predict at all.
//!
//! An effect is a property of a rig or of actuators. A mistake is one session whose columns were swapped, one specimen with a wrong
//! resting length, a log read with another load cell's calibration. It is looked for before the search: every session is predicted from
//! all others (with its specimen's own strength), every specimen from all others. What is far off is named, with the usual mistake that
//! would explain it best. A session that no effect of the library could explain is set aside, so that it does not bend everything else.
//!
//! A mistake that all sessions share hides in the coefficients. Where published ones exist, the forces are compared with theirs.

use super::base::Base;
use super::data::Data;
use super::findings::Suspect;
use super::model::{Fitted, Model};
use crate::effects::{self, Conditions};
use crate::numerics::statistics::{mean, median, quantile};
use std::collections::BTreeSet;

/// How much larger than the median of the others' an error must be, and which share of the force's 95% quantile.
const FAR_OFF: (f64, f64) = (8.0, 0.1);
/// The same for a specimen, whose strength was taken off: where a usual mistake explains it, where none does, and the share.
const FAR_OFF_SPECIMEN: (f64, f64, f64) = (1.5, 3.0, 0.05);
/// Strengths beyond are no strengths of one make, relative to the median; and forces of a campaign relative to the published model.
const STRENGTHS: (f64, f64) = (0.75, 1.33);
/// The same for one specimen by the published model, from which short actuators on a yielding frame differ much.
const PUBLISHED: (f64, f64) = (0.6, 1.67);
/// Gains that a force channel can have by mistake: of units and of load cells.
const GAINS: (f64, f64) = (0.2, 5.0);
/// Gains of the pressure channel that are an effect; beyond, it is another unit.
const PRESSURE_GAINS: std::ops::RangeInclusive<f64> = 0.5..=2.0;
/// An explanation must bring the error down to this part.
const EXPLAINS: f64 = 0.4;
/// Swapped columns have no number that could be chosen, so they are believed even if something with one explains somewhat more.
const SWAPPED: f64 = 1.5;
/// Or if they leave no more than this part of the error.
const NOTHING_LEFT: f64 = 0.05;
/// Fewest sessions and specimens of which one can stand out.
const FEWEST: (usize, usize) = (6, 3);
/// Most sessions that can be mistaken, as a share.
const MOST: f64 = 0.2;

/// Everything that is far off.
pub fn suspects(base: &Base, data: &Data, published: Option<&Base>) -> Vec<Suspect> {
    // A wrong resting length makes all sessions of its specimen wrong, each in its own way: such specimens first.
    let mut found = Vec::new();
    let whole = specimens(base, data, true, &mut found);
    let rest = part(data, |i| !whole.contains(&data.specimen[i]));
    let left = sessions(base, &rest, &mut found);
    specimens(base, &rest.select(&left), false, &mut found);
    if let Some(published) = published {
        against_published(published, data, &mut found);
    }
    found
}

/// Sessions, the worst first and the others then judged without it; returns the readings of those that are not far off.
fn sessions(base: &Base, data: &Data, found: &mut Vec<Suspect>) -> Vec<usize> {
    let mut left: Vec<usize> = (0..data.len()).collect();
    let present: BTreeSet<usize> = data.session.iter().copied().collect();
    if present.len() < FEWEST.0 {
        return left;
    }
    let scale = quantile(&data.force, 0.95).abs();
    let most = (MOST * present.len() as f64) as usize;
    for _ in 0..most {
        let rest = data.select(&left);
        let from = fit(base, &rest, None);
        let here: BTreeSet<usize> = rest.session.iter().copied().collect();
        // A session that is mistaken bends the fit, and then a session at the edge may look worse than itself. The mistaken one is that
        // without which the others agree best.
        let trial = |s: usize| {
            let others = part(&rest, |i| rest.session[i] != s);
            let fitted = fit(base, &others, Some(&from));
            (fitted.sigma, s, fitted)
        };
        let best = here
            .iter()
            .map(|s| trial(*s))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, s, fitted)) = best else {
            break;
        };
        let of = |s: usize| part(&rest, |i| rest.session[i] == s);
        let off = error(base, &of(s), &fitted);
        let others: Vec<f64> = here
            .iter()
            .filter(|o| **o != s)
            .map(|o| error(base, &of(*o), &fitted))
            .collect();
        let usual = median(&others);
        if off < FAR_OFF.0 * usual || off < FAR_OFF.1 * scale {
            break;
        }
        let mistake = explanation(base, &of(s), &fitted, off, false);
        found.push(Suspect {
            what: format!("session {}", data.sessions[s]),
            error_n: off,
            usual_n: usual,
            set_aside: !mistake.is_an_effect,
            explanation: mistake.words,
            error_then_n: mistake.error_then_n,
        });
        left.retain(|i| data.session[*i] != s);
    }
    left
}

/// Specimens, each judged by the others; returns them. `explained`: only those that one of the usual mistakes explains.
fn specimens(base: &Base, data: &Data, explained: bool, found: &mut Vec<Suspect>) -> Vec<usize> {
    let mut suspected = Vec::new();
    let here: Vec<usize> = data
        .specimen
        .iter()
        .copied()
        .collect::<BTreeSet<usize>>()
        .into_iter()
        .collect();
    if here.len() < FEWEST.1 {
        return suspected;
    }
    let from = fit(base, data, None);
    let scale = quantile(&data.force, 0.95).abs();
    let errors: Vec<(f64, f64, usize, Fitted)> = here
        .iter()
        .map(|k| {
            let others = part(data, |i| data.specimen[i] != *k);
            let mut fitted = fit(base, &others, Some(&from));
            let own = part(data, |i| data.specimen[i] == *k);
            let strength = factor(base, &own, &fitted);
            fitted.strengths[*k] = strength - 1.0;
            (error(base, &own, &fitted), strength, *k, fitted)
        })
        .collect();
    let usual = median(&errors.iter().map(|e| e.0).collect::<Vec<f64>>());
    let strengths = median(&errors.iter().map(|e| e.1).collect::<Vec<f64>>());
    for (off, strength, k, fitted) in errors {
        let relative = strength / strengths;
        let own = part(data, |i| data.specimen[i] == k);
        let mistake = explanation(base, &own, &fitted, off, true);
        let (mut words, then) = (mistake.words, mistake.error_then_n);
        let least = if then.is_some() {
            FAR_OFF_SPECIMEN.0
        } else {
            FAR_OFF_SPECIMEN.1
        };
        let far = off > least * usual && off > FAR_OFF_SPECIMEN.2 * scale;
        let odd = base.knows_lengths() && !(STRENGTHS.0..=STRENGTHS.1).contains(&relative);
        if (!far && !odd) || (explained && then.is_none()) {
            continue;
        }
        suspected.push(k);
        if odd {
            words = format!("{relative:.2} times as strong as the others predict; {words}");
        }
        found.push(Suspect {
            what: format!("specimen {}", data.specimens[k]),
            error_n: off,
            usual_n: usual,
            explanation: words,
            error_then_n: then,
            set_aside: false,
        });
    }
    suspected
}

/// Forces relative to the published coefficients: of all specimens, or of single ones.
fn against_published(published: &Base, data: &Data, found: &mut Vec<Suspect>) {
    let model = Model {
        base: published,
        data,
        terms: Vec::new(),
    };
    let fitted = model.fit(None, 0);
    let here: BTreeSet<usize> = data.specimen.iter().copied().collect();
    let factors: Vec<(usize, f64, f64)> = here
        .into_iter()
        .map(|k| {
            let part = part(data, |i| data.specimen[i] == k);
            let mut plain = fitted.clone();
            plain.strengths = vec![0.0; data.specimens.len()];
            (
                k,
                factor(published, &part, &plain),
                error(published, &part, &plain),
            )
        })
        .collect();
    let middle = median(&factors.iter().map(|f| f.1).collect::<Vec<f64>>());
    let usual = median(&factors.iter().map(|f| f.2).collect::<Vec<f64>>());
    let odd = |f: f64| !(STRENGTHS.0..=STRENGTHS.1).contains(&f);
    let words = |f: f64| {
        format!(
            "forces are {f:.2} times those of the published model: another calibration of the force channel, another diameter or another make"
        )
    };
    if factors.iter().all(|f| odd(f.1)) {
        found.push(Suspect {
            what: "the whole campaign".to_owned(),
            error_n: usual,
            usual_n: usual,
            explanation: words(middle),
            error_then_n: None,
            set_aside: false,
        });
        return;
    }
    let far = |f: f64| !(PUBLISHED.0..=PUBLISHED.1).contains(&f);
    for (k, f, off) in factors.iter().filter(|f| far(f.1)) {
        let what = format!("specimen {}", data.specimens[*k]);
        if found.iter().any(|s| s.what == what) {
            continue;
        }
        let own = part(data, |i| data.specimen[i] == *k);
        let mistake = explanation(published, &own, &fitted, *off, true);
        found.push(Suspect {
            what,
            error_n: *off,
            usual_n: usual,
            explanation: if mistake.error_then_n.is_some() {
                format!(
                    "forces are {f:.2} times those of the published model; {}",
                    mistake.words
                )
            } else {
                words(*f)
            },
            error_then_n: mistake.error_then_n,
            set_aside: false,
        });
    }
}

fn part(data: &Data, is_in: impl Fn(usize) -> bool) -> Data {
    data.select(
        &(0..data.len())
            .filter(|i| is_in(*i))
            .collect::<Vec<usize>>(),
    )
}

fn fit(base: &Base, data: &Data, from: Option<&Fitted>) -> Fitted {
    let model = Model {
        base,
        data,
        terms: Vec::new(),
    };
    model.fit(from, usize::from(from.is_none()))
}

/// The predicted force of a reading whose conditions may have been changed.
fn force(base: &Base, fitted: &Fitted, specimen: usize, at: &Conditions) -> f64 {
    effects::force(
        base,
        &fitted.base,
        1.0 + fitted.strengths[specimen],
        &[],
        at,
    )
}

/// RMS of measured less predicted with changed conditions and forces, N; with a factor on the prediction that is fitted, or 1.
fn changed(
    base: &Base,
    part: &Data,
    fitted: &Fitted,
    with_factor: bool,
    change: impl Fn(&mut Conditions, &mut f64),
) -> f64 {
    let pairs: Vec<(f64, f64)> = (0..part.len())
        .map(|i| {
            let (mut at, mut measured) = (part.conditions[i], part.force[i]);
            change(&mut at, &mut measured);
            (measured, force(base, fitted, part.specimen[i], &at))
        })
        .collect();
    let square: f64 = pairs.iter().map(|(_, f)| f * f).sum();
    let product: f64 = pairs.iter().map(|(y, f)| y * f).sum();
    let factor = if with_factor && square > 0.0 {
        product / square
    } else {
        1.0
    };
    let squares: f64 = pairs
        .iter()
        .map(|(y, f)| (y - factor * f) * (y - factor * f))
        .sum();
    (squares / part.len().max(1) as f64).sqrt()
}

fn error(base: &Base, part: &Data, fitted: &Fitted) -> f64 {
    changed(base, part, fitted, false, |_, _| {})
}

/// The factor between measured and predicted forces.
fn factor(base: &Base, part: &Data, fitted: &Fitted) -> f64 {
    let (mut product, mut square) = (0.0, 0.0);
    for i in 0..part.len() {
        let f = force(base, fitted, part.specimen[i], &part.conditions[i]);
        product += f * part.force[i];
        square += f * f;
    }
    if square > 0.0 { product / square } else { 1.0 }
}

/// A usual mistake.
struct Mistake {
    words: String,
    /// The error if it were so; none where none of them explains it.
    error_then_n: Option<f64>,
    /// Whether an effect of the library is of that kind and size, so that the search can find it.
    is_an_effect: bool,
}

/// The usual mistake that explains most. A specimen's strength is fitted with each.
fn explanation(base: &Base, part: &Data, fitted: &Fitted, off: f64, specimen: bool) -> Mistake {
    let usual = usual_mistakes(base, part, fitted, specimen);
    let best = usual
        .into_iter()
        .min_by(|a, b| a.error_then_n.total_cmp(&b.error_then_n));
    let swapped = changed(base, part, fitted, false, |at, f| {
        std::mem::swap(&mut at.pressure_kpa, f);
    });
    let least = best.as_ref().map_or(f64::INFINITY, |b| b.error_then_n);
    if swapped < NOTHING_LEFT * off || (swapped < EXPLAINS * off && swapped < SWAPPED * least) {
        return Mistake {
            words: "columns of force and pressure that are swapped".to_owned(),
            error_then_n: Some(swapped),
            is_an_effect: false,
        };
    }
    match best.filter(|b| b.error_then_n < EXPLAINS * off) {
        Some(best) => Mistake {
            words: best.words,
            error_then_n: Some(best.error_then_n),
            is_an_effect: best.is_an_effect,
        },
        None => Mistake {
            words: "none of the usual mistakes explains it".to_owned(),
            error_then_n: None,
            is_an_effect: false,
        },
    }
}

/// A mistake of one number, at its best value.
struct Usual {
    error_then_n: f64,
    words: String,
    is_an_effect: bool,
}

/// A zero or a gain of a channel, or a wrong length: each at the value at which least is left.
fn usual_mistakes(base: &Base, part: &Data, fitted: &Fitted, specimen: bool) -> Vec<Usual> {
    let try_out = |change: fn(&mut Conditions, &mut f64, f64), low: f64, high: f64| {
        least(low, high, |x| {
            changed(base, part, fitted, specimen, |at, f| change(at, f, x))
        })
    };
    let usual = |error_then_n: f64, words: String, is_an_effect: bool| Usual {
        error_then_n,
        words,
        is_an_effect,
    };
    let misses: Vec<f64> = (0..part.len())
        .map(|i| part.force[i] - force(base, fitted, part.specimen[i], &part.conditions[i]))
        .collect();
    let offset = mean(&misses);
    let pressure = try_out(|at, _, p| at.pressure_kpa -= p, -150.0, 150.0);
    let (times, then) = try_out(|at, _, g| at.pressure_kpa *= g, 0.1, 10.0);
    let (mm, of_length, given) = if specimen {
        let (mm, of) = try_out(|at, _, d| at.rest_length_m += 1e-3 * d, -30.0, 30.0);
        (mm, of, ["resting length", "given"])
    } else {
        let (mm, of) = try_out(|at, _, d| at.length_m += 1e-3 * d, -30.0, 30.0);
        (mm, of, ["length", "set"])
    };
    let mut list = vec![
        usual(
            changed(base, part, fitted, specimen, |_, f| *f -= offset),
            format!("a zero of the force channel of {offset:+.1} N"),
            true,
        ),
        usual(
            of_length,
            format!("a {} that is {mm:+.1} mm of the one {}", given[0], given[1]),
            true,
        ),
        usual(
            pressure.1,
            format!("a zero of the pressure channel of {:+.0} kPa", pressure.0),
            true,
        ),
        usual(
            then,
            format!("a pressure that is {times:.2} times the one read"),
            PRESSURE_GAINS.contains(&times),
        ),
    ];
    // The gain of a specimen is its strength.
    let gain = factor(base, part, fitted);
    if !specimen && (GAINS.0..=GAINS.1).contains(&gain) {
        list.push(usual(
            changed(base, part, fitted, false, |_, f| *f /= gain),
            format!("a gain of the force channel of {gain:.2}"),
            true,
        ));
    }
    list
}

/// The least of a function between two bounds: a grid, then golden sections about its best place.
fn least(low: f64, high: f64, of: impl Fn(f64) -> f64) -> (f64, f64) {
    const GRID: usize = 24;
    let at = |k: usize| low + (high - low) * k as f64 / GRID as f64;
    let best = (0..=GRID)
        .min_by(|a, b| of(at(*a)).total_cmp(&of(at(*b))))
        .unwrap_or(0);
    let (mut a, mut b) = (at(best.saturating_sub(1)), at((best + 1).min(GRID)));
    let section = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..30 {
        let (c, d) = (b - section * (b - a), a + section * (b - a));
        if of(c) < of(d) {
            b = d;
        } else {
            a = c;
        }
    }
    let x = 0.5 * (a + b);
    (x, of(x))
}
