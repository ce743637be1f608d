//! The readings on the page: every column that holds something, what models and the residual search expect, and what became of each reading.

use super::encode::{Encoded, numbers, texts};
use super::labels;
use super::sample::Extent;
use crate::input::ReportInput;
use pipeline_base::columns::{FORCE, TORQUE};
use pipeline_base::frame::{Frame, Values};
use pipeline_base::row::{self, Row};
use pipeline_base::session::Kind;
use pipeline_findings::Level;
use pipeline_torque::tidy;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Readings of one kind.
#[derive(Clone, Debug, Serialize)]
pub struct Set {
    /// "isometric" or "knee-torque".
    pub kind: &'static str,
    /// Title.
    pub title: &'static str,
    /// Column of what was measured.
    pub measured: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// How many there are.
    pub count: usize,
    /// How many there would be in full.
    pub of: usize,
    /// The columns.
    pub columns: Vec<Column>,
    /// What expects something of a reading.
    pub models: Vec<Model>,
}

/// A column.
#[derive(Clone, Debug, Serialize)]
pub struct Column {
    /// Name, as in the tidy data.
    pub name: String,
    /// For people.
    pub label: String,
    /// Unit; empty for texts and pure numbers.
    pub unit: String,
    /// Whether it is of texts.
    pub is_text: bool,
    /// The values.
    #[serde(flatten)]
    pub values: Encoded,
}

/// What expects something of a reading.
#[derive(Clone, Debug, Serialize)]
pub struct Model {
    /// The column of what it expects.
    pub column: String,
    /// For people.
    pub label: String,
    /// Whether it is the residual search.
    pub is_search: bool,
}

/// What the page calls the place of a session in the order of time.
const SESSION_ORDER: &str = "session_order";
/// What became of a reading.
const STATE: &str = "state";
/// Columns of which the page says the same otherwise.
const SAID_OTHERWISE: [&str; 4] = ["kind", "excluded", "doubtful", "fitted"];

/// The readings of forces; none where there are none.
pub fn forces(input: &ReportInput, extent: Extent) -> Option<Set> {
    let is_shown = |r: &Row| r.kind == Kind::Isometric && extent.takes(&r.campaign);
    let all: Vec<usize> = (0..input.rows.len())
        .filter(|k| is_shown(&input.rows[*k]))
        .collect();
    let of = all.len();
    let places = extent.thinned(all);
    let rows: Vec<Row> = places.iter().map(|k| input.rows[*k].clone()).collect();
    let states = states(input);
    let state = |r: &Row| Some(states.of(r).to_owned());
    let order = session_order(input);
    let place = |r: &Row| {
        order
            .get(r.session.as_str())
            .map_or(f64::NAN, |k| *k as f64)
    };
    let mut frame = row::to_frame(&rows)
        .with(STATE, Values::Text(rows.iter().map(state).collect()))
        .with(
            SESSION_ORDER,
            Values::Number(rows.iter().map(place).collect()),
        );
    for (name, values) in &input.predicted {
        let values = places.iter().map(|k| values[*k]).collect();
        frame = frame.with(name, Values::Number(values));
    }
    let units = |name: &str| labels::unit(name, &frame);
    let models = labels::of_forces(input, input.predicted.keys());
    let set = Set {
        kind: row::kind_name(Kind::Isometric),
        title: "Forces",
        measured: FORCE,
        unit: "N",
        count: rows.len(),
        of,
        columns: columns(&frame, None, &units),
        models,
    };
    (set.count > 0).then(|| set.without_empty_models().with_named_columns())
}

/// The readings of torque; none where there are none.
pub fn torques(input: &ReportInput, extent: Extent) -> Option<Set> {
    let campaigns = input.torque().iter().filter(|c| extent.takes(&c.campaign));
    let frame = tidy::frame(campaigns);
    let of = frame.height();
    let places = extent.thinned((0..of).collect());
    let flags = |name: &str| frame.integers(name).unwrap_or_default();
    let (excluded, doubtful, fitted) = (flags("excluded"), flags("doubtful"), flags("fitted"));
    let state = |k: usize| match (excluded[k], doubtful[k], fitted[k]) {
        (Some(1), ..) => "excluded",
        (_, Some(1), _) => "doubtful",
        (.., Some(1)) => "fitted",
        _ => "excluded from fits",
    };
    let states = (0..of).map(|k| Some(state(k).to_owned())).collect();
    let frame = frame.with(STATE, Values::Text(states));
    let units = |name: &str| labels::unit(name, &frame);
    let set = Set {
        kind: row::kind_name(Kind::KneeTorque),
        title: "Torques",
        measured: TORQUE,
        unit: "N.m",
        count: places.len(),
        of,
        columns: columns(&frame, Some(&places), &units),
        models: labels::of_torques(&frame),
    };
    (set.count > 0).then(|| set.without_empty_models().with_named_columns())
}

impl Set {
    /// Without models that have no answer for any of the readings.
    fn without_empty_models(mut self) -> Self {
        let columns: BTreeSet<&str> = self.columns.iter().map(|c| c.name.as_str()).collect();
        self.models.retain(|m| columns.contains(m.column.as_str()));
        self
    }

    /// The columns of models called as the models are.
    fn with_named_columns(mut self) -> Self {
        let called: BTreeMap<&str, &str> = self
            .models
            .iter()
            .map(|m| (m.column.as_str(), m.label.as_str()))
            .collect();
        for column in &mut self.columns {
            if let Some(model) = called.get(column.name.as_str()) {
                column.label = format!("predicted, {model}");
            }
        }
        self
    }
}

/// The columns that hold something, of the readings at some places.
fn columns(frame: &Frame, places: Option<&[usize]>, unit: &dyn Fn(&str) -> String) -> Vec<Column> {
    let every: Vec<usize> = (0..frame.height()).collect();
    let places = places.unwrap_or(&every);
    let one = |name: &str, values: &Values| {
        let (is_text, values) = match values {
            Values::Text(x) => {
                let texts_of: Vec<Option<&str>> = places.iter().map(|k| x[*k].as_deref()).collect();
                texts_of.iter().any(Option::is_some).then_some(())?;
                (true, texts(&texts_of))
            }
            Values::Number(x) => (false, known(places.iter().map(|k| x[*k]).collect())?),
            Values::Integer(x) => {
                let number = |k: &usize| x[*k].map_or(f64::NAN, |i| i as f64);
                (false, known(places.iter().map(number).collect())?)
            }
        };
        Some(Column {
            name: name.to_owned(),
            label: labels::column(name),
            unit: unit(name),
            is_text,
            values,
        })
    };
    let shown = frame
        .columns
        .iter()
        .filter(|(name, _)| !SAID_OTHERWISE.contains(&name.as_str()));
    shown
        .filter_map(|(name, values)| one(name, values))
        .collect()
}

/// Numbers of which at least one is known.
fn known(values: Vec<f64>) -> Option<Encoded> {
    let is_known = values.iter().any(|x| x.is_finite());
    is_known.then(|| numbers(&values))
}

/// The place of every session in the order of time within its campaign, counted from 1.
fn session_order(input: &ReportInput) -> BTreeMap<&str, usize> {
    let sessions = input.sessions.iter().map(|s| &s.ingest.session);
    let keys: BTreeSet<(&str, &str, &str)> = sessions
        .map(|s| {
            (
                s.campaign.as_str(),
                s.date.as_deref().unwrap_or(""),
                s.id.as_str(),
            )
        })
        .collect();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    keys.into_iter()
        .map(|(campaign, _, id)| {
            let count = counts.entry(campaign).or_default();
            *count += 1;
            (id, *count)
        })
        .collect()
}

/// Sessions and specimens that the search set aside.
struct States<'a> {
    aside: BTreeSet<(&'a str, Level, &'a str)>,
}

fn states(input: &ReportInput) -> States<'_> {
    let groups = input.groups.iter().filter(|g| !g.fit.group.is_pool());
    let aside = groups.flat_map(|g| {
        let campaign = g.fit.group.campaign.as_str();
        g.doubtful()
            .map(move |e| (campaign, e.level, e.group.as_str()))
    });
    States {
        aside: aside.collect(),
    }
}

impl States<'_> {
    fn of(&self, row: &Row) -> &'static str {
        let campaign = row.campaign.as_str();
        let is_aside = [
            (Level::Session, &row.session),
            (Level::Specimen, &row.specimen),
        ];
        let is_aside =
            is_aside.map(|(level, id)| self.aside.contains(&(campaign, level, id.as_str())));
        match row.role {
            _ if row.excluded => "excluded",
            _ if is_aside.contains(&true) => "set aside",
            None => "fitted",
            Some(role) if row::role_name(role) == "train" => "fitted",
            Some(role) => row::role_name(role),
        }
    }
}
