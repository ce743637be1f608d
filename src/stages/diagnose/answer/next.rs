//! What to measure next: the set points at which two explanations that remain differ most, and what would measure an effect by itself.

use super::super::Work;
use super::super::data::Data;
use super::super::findings::{Alias, EffectFinding, NextMeasurement, Reading, Unexplained};
use super::super::limits::Limits;
use super::super::linear::Linear;
use super::super::model::Model;
use super::super::search::{Search, State};
use super::super::term::Scope;
use super::readings::AS_GOOD;
use crate::effects;

/// Pressures of the grid of set points, kPa; relative contractions.
const PRESSURES_KPA: [f64; 9] = [0.0, 20.0, 50.0, 100.0, 200.0, 300.0, 400.0, 500.0, 620.0];
const CONTRACTIONS: [f64; 9] = [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];
/// Pairs that leave one trace and were not found, of which something is said.
const MOST_ALIASES: usize = 3;

/// What would decide, the most pressing first.
pub(super) fn next(
    search: &Search,
    work: &Work,
    effects: &[EffectFinding],
    unexplained: &[Unexplained],
    limits: &Limits,
    readings: &[Reading],
) -> Vec<NextMeasurement> {
    let mut list: Vec<NextMeasurement> = (0..work.best.chosen.len())
        .filter_map(|k| at_set_points(search, work, k))
        .collect();
    list.extend(effects.iter().map(by_itself));
    list.extend(unexplained.iter().map(of_column));
    list.extend(base(readings));
    let unsaid = |a: &&Alias| {
        !effects
            .iter()
            .any(|e| a.ids.iter().all(|id| e.class.contains(id)))
    };
    let aliases = limits.aliases.iter().take(MOST_ALIASES).filter(unsaid);
    list.extend(aliases.map(|a| NextMeasurement {
        separates: a.ids.to_vec(),
        action: each(&a.ids),
        difference_n: None,
    }));
    list
}

/// What measures each of some effects apart from the force.
fn each(ids: &[String]) -> String {
    let measurement = |id: &String| {
        effects::index(id).map_or_else(String::new, |k| {
            format!("{id}: {}", effects::all()[k].measurement())
        })
    };
    ids.iter()
        .map(measurement)
        .collect::<Vec<String>>()
        .join("; ")
}

/// What measures an effect apart from the force, or all of its class.
fn by_itself(effect: &EffectFinding) -> NextMeasurement {
    if effect.class.len() > 1 {
        return NextMeasurement {
            separates: effect.class.clone(),
            action: each(&effect.class),
            difference_n: None,
        };
    }
    NextMeasurement {
        separates: vec![effect.id.clone(), "every other explanation".to_owned()],
        action: effect.measurement.clone(),
        difference_n: None,
    }
}

/// What would show why the residual depends on a column.
fn of_column(unexplained: &Unexplained) -> NextMeasurement {
    let action = match unexplained.column.as_str() {
        "force_n" => "hang dead weights in the place of the actuator, five up and five down, and compare the force channel with them".to_owned(),
        "pressure_kpa" | "pressure_rate" => "compare the pressure sensor with a gauge at five steady pressures; repeat one log at half the rate".to_owned(),
        "contraction_rel" | "rest_length_m" => {
            "measure clamp to clamp with a caliper at every set length, loaded and unloaded".to_owned()
        }
        "direction" | "time_s" | "since_step_s" => {
            "hold one set point for ten minutes, reached once by filling and once by venting".to_owned()
        }
        "session" | "session_order" | "log" | "cycles" => {
            "repeat the first session at the end of the campaign, and one session on two days without taking the actuator out".to_owned()
        }
        other => format!("repeat a few set points at two values of {other}, everything else as it was, in an order that is drawn"),
    };
    NextMeasurement {
        separates: vec![unexplained.column.clone(), "what varied with it".to_owned()],
        action,
        difference_n: None,
    }
}

/// Whether the base needs its dependence on the resting length, where two readings of the data are as good.
fn base(readings: &[Reading]) -> Option<NextMeasurement> {
    let error = |r: &&Reading| r.errors.rmse_heldout;
    let least = |constant: bool| {
        let kind = readings
            .iter()
            .filter(|r| r.model.starts_with("F_620 constant") == constant);
        kind.min_by(|a, b| error(a).total_cmp(&error(b)))
    };
    let (law, constant) = (least(false)?, least(true)?);
    (constant.errors.rmse_heldout < AS_GOOD * law.errors.rmse_heldout).then(|| NextMeasurement {
        separates: vec![law.model.clone(), constant.model.clone()],
        action: "measure one actuator at two frame lengths, or on a stiffer frame; put a dial gauge on the crossmember; hang a dead weight in \
                 place of the actuator"
            .to_owned(),
        difference_n: None,
    })
}

/// The set point at which the model that was chosen and the best one with another effect in the place of its `k`th differ most.
fn at_set_points(search: &Search, work: &Work, k: usize) -> Option<NextMeasurement> {
    let found = &search.candidates[work.best.chosen[k]];
    let id = found.id()?;
    let other = instead(search, work, k)?;
    let term = &search.candidates[*other.chosen.last()?];
    let grid = grid(search.data);
    let predict = |state: &State| {
        let terms = state.chosen.iter().map(|c| search.candidates[*c].clone());
        Model {
            base: search.base,
            data: &grid,
            terms: terms.collect(),
        }
        .predict(&state.fitted, true)
    };
    let (a, b) = (predict(&work.best), predict(&other));
    let (place, difference) = (0..grid.len())
        .map(|i| (i, (a[i] - b[i]).abs()))
        .max_by(|x, y| x.1.total_cmp(&y.1).then(y.0.cmp(&x.0)))?;
    if difference < 2.0 * work.best.fitted.sigma {
        return None;
    }
    let at = &grid.conditions[place];
    let contraction = (at.rest_length_m - at.length_m) / at.rest_length_m;
    let direction = match at.direction {
        d if d > 0.0 => ", pressurizing",
        d if d < 0.0 => ", venting",
        _ => "",
    };
    Some(NextMeasurement {
        separates: vec![id.to_owned(), term.id()?.to_owned()],
        action: format!(
            "measure a resting length of {:.0} mm at a contraction of {contraction:.3} and {:.0} kPa{direction}: with {} in the place of {} the \
             model says {difference:.1} N {} there",
            1e3 * at.rest_length_m,
            at.pressure_kpa,
            term.id()?,
            id,
            if b[place] > a[place] { "more" } else { "less" },
        ),
        difference_n: Some(difference),
    })
}

/// The model with the effect that explains most in the place of the `k`th: of its class, if it has one.
fn instead(search: &Search, work: &Work, k: usize) -> Option<State> {
    let mut chosen = work.best.chosen.clone();
    let found = &search.candidates[chosen.remove(k)];
    let without = search.state(chosen.clone(), Some(&work.best.fitted));
    let model = search.model(&chosen);
    let linear = Linear::new(
        &model,
        &without.fitted,
        without.fitted.scatter,
        search.candidates,
    );
    let stand = linear.stand(&linear.all_sessions(), &[]);
    let class = &work.judgements.get(k)?.class;
    let other = (0..search.candidates.len())
        .filter(|c| {
            let term = &search.candidates[*c];
            let alike = term.scope == found.scope || term.scope == Scope::Whole;
            alike && term.id().is_some() && term.id() != found.id() && !chosen.contains(c)
        })
        .filter(|c| class.is_empty() || class.contains(c))
        .max_by(|a, b| {
            let fall = |c: usize| stand.gain(c).fall;
            fall(*a).total_cmp(&fall(*b)).then(b.cmp(a))
        })?;
    chosen.push(other);
    Some(search.state(chosen, Some(&without.fitted)))
}

/// Set points within reach: every specimen, in both directions if the campaign has them, at each contraction and pressure.
fn grid(data: &Data) -> Data {
    let mut first: Vec<usize> = Vec::new();
    for i in 0..data.len() {
        let seen = first.iter().any(|j| {
            data.specimen[*j] == data.specimen[i]
                && data.conditions[*j].direction == data.conditions[i].direction
        });
        if !seen {
            first.push(i);
        }
    }
    let points = PRESSURES_KPA.len() * CONTRACTIONS.len();
    let places: Vec<usize> = first
        .iter()
        .flat_map(|i| std::iter::repeat_n(*i, points))
        .collect();
    let mut grid = data.select(&places);
    for (k, at) in grid.conditions.iter_mut().enumerate() {
        let (p, c) = (
            k % PRESSURES_KPA.len(),
            k / PRESSURES_KPA.len() % CONTRACTIONS.len(),
        );
        at.pressure_kpa = PRESSURES_KPA[p];
        at.length_m =
            at.rest_length_m - CONTRACTIONS[c] * (at.rest_length_m - at.contracted_length_m);
    }
    grid
}
