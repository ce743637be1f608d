//! The tables `[[effect]]` of a truth file: which effect, in which form, how large, and where it acts.
//!
//! ```toml
//! [[effect]]
//! id = "series_compliance"      # one of `effects::EFFECTS`
//! form = "stiffening"           # optional: "operator", the plain one, where it is left out
//! c_um_per_n = 6.0              # the form's numbers, unit in the key; the first is the size
//!
//! [[effect]]
//! id = "force_gain"
//! gain = 1.04
//! from_session = 12             # acts in the 12th session in time (counted from 1) and all later ones
//!
//! [[effect]]
//! id = "force_zero_offset"
//! sd = 3                        # a size for each session, drawn: mean as given (here left out, 0), standard deviation 3 N
//! per = "session"               # or "specimen" or "log"
//! ```
//!
//! `specimen = "..."` and `session = "..."` (with or without the campaign's id in front) confine an effect to one of them. An id may
//! stand several times, as for two specimens; the operators of one link work in the order of the file.

use super::effect_places::{Named, Place, place};
use super::effects::{self, Column, Effect, Form, MOST_PARAMETERS, Per};
use super::rig_settings::within;
use pipeline_base::toml_reader::{Entry, Section};
use serde::Serialize;
use std::collections::BTreeMap;

/// One effect of the truth file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectTruth {
    /// Id of the effect.
    pub id: &'static str,
    /// Name of its form.
    pub form: &'static str,
    /// Its numbers by key, defaults included.
    pub parameters: BTreeMap<&'static str, f64>,
    /// The column that it follows.
    pub column: Option<String>,
    /// Where it acts.
    pub place: Place,
    /// How its size is drawn, if it is.
    pub scatter: Option<Scatter>,
}

/// How the size of an effect is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scatter {
    /// Standard deviation, in the unit of the size.
    pub sd: f64,
    /// What shares one value.
    pub per: Per,
}

impl EffectTruth {
    /// The form, resolved.
    pub fn form(&self) -> &'static Form {
        let forms = effects::by_id(self.id).map_or(&[] as &[Form], |e| e.forms);
        let named = forms.iter().find(|f| f.name == self.form);
        named.expect("a form that was read from the list of effects")
    }

    /// The numbers in the order of the form's parameters.
    pub fn numbers(&self) -> [f64; MOST_PARAMETERS] {
        let mut numbers = [0.0; MOST_PARAMETERS];
        for (slot, parameter) in numbers.iter_mut().zip(self.form().parameters) {
            *slot = self.parameters[parameter.key];
        }
        numbers
    }
}

/// The effects of a truth file, in its order; mistakes go to the table's reader.
pub fn effects(root: &Section, named: &Named) -> Option<Vec<EffectTruth>> {
    let Some(entry) = root.get("effect") else {
        return Some(Vec::new());
    };
    let read = |e: &Entry| effect(&e.table()?, named);
    let list: Vec<Option<EffectTruth>> = entry.list()?.iter().map(read).collect();
    list.into_iter().collect()
}

fn effect(table: &Section, named: &Named) -> Option<EffectTruth> {
    let ids: Vec<(&'static str, &'static Effect)> =
        effects::EFFECTS.iter().map(|e| (e.id, *e)).collect();
    let hint = "name one of the effects that the simulator has";
    let effect = table
        .require("id", "the id of an effect", hint)?
        .choice(&ids)?;
    let form = form(table, effect)?;
    let place = place(table, named);
    let column = column(table, effect, named);
    let scatter = scatter(table, effect, form);
    let parameters = parameters(table, form, matches!(scatter, Some(Some(_))));
    table.close();
    Some(EffectTruth {
        id: effect.id,
        form: form.name,
        parameters: parameters?,
        column: column?,
        place: place?,
        scatter: scatter?,
    })
}

fn form(table: &Section, effect: &'static Effect) -> Option<&'static Form> {
    let plain = ("operator", &effect.forms[0]);
    let names = effect.forms.iter().map(|f| (f.name, f));
    let words: Vec<(&'static str, &'static Form)> = std::iter::once(plain).chain(names).collect();
    table
        .get("form")
        .map_or(Some(plain.1), |e| e.choice(&words))
}

fn parameters(table: &Section, form: &Form, drawn: bool) -> Option<BTreeMap<&'static str, f64>> {
    let mut numbers = BTreeMap::new();
    for (k, parameter) in form.parameters.iter().enumerate() {
        let free = (k == 0 && drawn).then_some(parameter.neutral);
        let number = match (table.get(parameter.key), parameter.default.or(free)) {
            (Some(entry), _) => within(
                &entry,
                parameter.low,
                parameter.high,
                parameter.unit,
                "see the effect's documentation",
            ),
            (None, Some(default)) => Some(default),
            (None, None) => {
                let expected = format!("a number ({})", parameter.unit);
                table.require(parameter.key, &expected, "say how large the effect is");
                None
            }
        };
        numbers.insert(parameter.key, number);
    }
    let all = numbers.into_iter().map(|(key, x)| Some((key, x?)));
    all.collect()
}

fn scatter(table: &Section, effect: &Effect, form: &Form) -> Option<Option<Scatter>> {
    let (unit, top) = (form.parameters[0].unit, form.parameters[0].high);
    let hint = "it is in the unit of the effect's size";
    let sd = table.get("sd").map(|e| within(&e, 0.0, top, unit, hint));
    let words = [
        ("session", Per::Session),
        ("specimen", Per::Specimen),
        ("log", Per::Log),
    ];
    let per = table.get("per");
    if let (Some(entry), None) = (&per, &sd) {
        entry.reject("`sd` beside it", "say how far the drawn sizes scatter");
        return None;
    }
    if sd.is_none() && form.two_batches {
        table.require(
            "sd",
            &format!("a number ({unit})"),
            "the batches lie at +sd and -sd",
        );
        return None;
    }
    let per = per.map_or(Some(effect.per), |e| e.choice(&words));
    match sd {
        None => Some(None),
        Some(sd) => Some(Some(Scatter { sd: sd?, per: per? })),
    }
}

fn column(table: &Section, effect: &Effect, named: &Named) -> Option<Option<String>> {
    let name = match effect.column {
        Column::None => return Some(None),
        Column::Named(name) => name.to_owned(),
        Column::Chosen => table
            .require("column", "the name of a [[column]]", "say what it follows")?
            .string()?,
    };
    let declared = named.columns.map(|c| c.iter().any(|c| c.name == name));
    if declared.unwrap_or(true) {
        return Some(Some(name));
    }
    let found = format!("no column `{name}`");
    let hint = format!("add [[column]] with name = \"{name}\"");
    let path = table.path_of("column");
    let reader = table.reader();
    reader.report(table.line(), &path, found, "a column that is logged", &hint);
    None
}
