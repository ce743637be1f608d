//! `[columns]` of a `session.toml`: which quantity stands where in the logs, and how it becomes a column inside.

use pipeline_base::columns::{self, KnownColumn};
use pipeline_base::diagnostics::nearest;
use pipeline_base::session::{Cells, ColumnSpec, Phase, Position};
use pipeline_base::toml_reader::{Entry, Section};
use std::collections::BTreeMap;

/// The columns of the table, in the order of the file; mistakes go to the table's reader.
pub fn column_specs(table: &Section) -> Vec<ColumnSpec> {
    let mut specs: Vec<ColumnSpec> = Vec::new();
    for (name, entry) in table.entries() {
        let Some(spec) = column_spec(&name, &entry) else {
            continue;
        };
        if let Some(other) = specs.iter().find(|s| s.position == spec.position) {
            entry.reject_for(
                "a column already in use",
                &format!("a column of its own, not that of {}", other.column),
                "correct `index` or `name` of one of them",
            );
        }
        specs.push(spec);
    }
    specs
}

fn column_spec(name: &str, entry: &Entry) -> Option<ColumnSpec> {
    let known = columns::by_quantity_name(name);
    if known.is_none() && columns::is_reserved(name) {
        entry.reject_for(
            &format!("the name {name}"),
            "a name that the pipeline does not use itself",
            "choose another name",
        );
        return None;
    }
    if entry.as_string().is_some() {
        let hint = format!(
            "write `{name} = {{ name = {}, unit = \"...\" }}`",
            entry.describe()
        );
        entry.reject("where the column is, and its unit", &hint);
        return None;
    }
    let table = entry.table()?;
    let position = position(entry, &table);
    let unit_entry = table.get("unit");
    let gain = table.get("gain").map_or(Some(1.0), |e| e.number());
    let offset = table.get("offset").map_or(Some(0.0), |e| e.number());
    let low = table.get("saturation_low").and_then(|e| e.number());
    let high = table.get("saturation_high").and_then(|e| e.number());
    let values = table.get("values");
    let text = table.get("text");
    let declared = [
        "unit",
        "gain",
        "offset",
        "saturation_low",
        "saturation_high",
    ]
    .into_iter()
    .find(|key| table.get(key).is_some());
    table.close();
    let cells = cells(known, text, declared)?;
    let (unit, factor, constant) = unit_of(name, known, entry, unit_entry)?;
    let (gain, offset) = (gain?, offset?);
    check_numbers(entry, gain, low, high)?;
    Some(ColumnSpec {
        column: known.map_or(name, |k| k.column).to_owned(),
        position: position?,
        cells,
        unit,
        factor: gain * factor,
        constant: offset * factor + constant,
        saturation_low: low.map(|x| x * factor + constant),
        saturation_high: high.map(|x| x * factor + constant),
        values: phase_values(known, entry, values)?,
    })
}

/// Whether a gain and the ends of a range mean something.
fn check_numbers(entry: &Entry, gain: f64, low: Option<f64>, high: Option<f64>) -> Option<()> {
    if gain == 0.0 {
        entry.reject_for(
            "gain = 0",
            "a gain other than 0",
            "write the converter's gain",
        );
        return None;
    }
    if let (Some(low), Some(high)) = (low, high)
        && low >= high
    {
        entry.reject_for(
            &format!("saturation_low = {low} and saturation_high = {high}"),
            "a `saturation_low` below `saturation_high`",
            "exchange them",
        );
        return None;
    }
    Some(())
}

/// What the cells of a column are; `declared` is a key that only numbers have.
fn cells(
    known: Option<&KnownColumn>,
    text: Option<Entry>,
    declared: Option<&str>,
) -> Option<Cells> {
    let is_text = match &text {
        Some(text) => Some(text.boolean()?),
        None => None,
    };
    match (is_text, known, declared, text) {
        (Some(_), Some(_), _, Some(text)) => {
            text.reject(
                "`text` at columns of your own only",
                "remove it, or name the column otherwise",
            );
            None
        }
        (Some(true), None, Some(key), Some(text)) => {
            text.reject(
                &format!("`text = true` without `{key}`, which only numbers have"),
                "remove one of them",
            );
            None
        }
        (Some(true), ..) => Some(Cells::Words),
        (Some(false), ..) | (_, Some(_), ..) | (_, _, Some(_), _) => Some(Cells::Numbers),
        (None, None, None, _) => Some(Cells::Either),
    }
}

fn position(entry: &Entry, table: &Section) -> Option<Position> {
    match (table.get("index"), table.get("name")) {
        (Some(index), None) => match index.integer()? {
            i if (0..10_000).contains(&i) => Some(Position::Index(i as usize)),
            _ => {
                index.reject("a column number from 0", "count the first column as 0");
                None
            }
        },
        (None, Some(name)) => name.string().map(Position::Name),
        (index, _) => {
            let found = match index {
                Some(_) => "both `index` and `name`",
                None => "neither `index` nor `name`",
            };
            entry.reject_for(
                found,
                "either `index` (file without header) or `name` (header line)",
                "say where the column is",
            );
            None
        }
    }
}

/// Unit as written, factor and constant to the unit used inside.
fn unit_of(
    name: &str,
    known: Option<&KnownColumn>,
    entry: &Entry,
    unit: Option<Entry>,
) -> Option<(String, f64, f64)> {
    let Some(quantity) = known.and_then(|k| k.quantity) else {
        let text = unit.map_or(Some(String::new()), |u| u.string())?;
        return Some((text, 1.0, 0.0));
    };
    let expected = format!("a unit of {name}: {}", quantity.list_of_units());
    let Some(unit_entry) = unit else {
        entry.reject_for("no unit", &expected, "add `unit = \"...\"`");
        return None;
    };
    let symbol = unit_entry.string()?;
    let Some(unit) = quantity.unit(&symbol) else {
        let hint = match nearest(&symbol, quantity.units().map(|u| u.symbol)) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => "convert it, or give gain and offset to one of these units".to_owned(),
        };
        unit_entry.reject(&expected, &hint);
        return None;
    };
    let constant = unit.to_inside(0.0);
    Some((symbol, unit.to_inside(1.0) - constant, constant))
}

fn phase_values(
    known: Option<&KnownColumn>,
    entry: &Entry,
    values: Option<Entry>,
) -> Option<BTreeMap<String, Phase>> {
    let is_phase = known.is_some_and(|k| k.column == columns::PHASE);
    match (is_phase, values) {
        (false, None) => Some(BTreeMap::new()),
        (false, Some(v)) => {
            v.reject_for("`values`", "`values` at the phase only", "remove it");
            None
        }
        (true, None) => {
            entry.reject_for(
                "no `values`",
                "`values`, which map the text of the log to pressurizing or depressurizing",
                "write values = { \"1\" = \"pressurizing\", \"2\" = \"depressurizing\" }",
            );
            None
        }
        (true, Some(v)) => {
            let mut map = BTreeMap::new();
            for (raw, state) in v.table()?.entries() {
                let phase = state.choice(&[
                    ("pressurizing", Phase::Pressurizing),
                    ("depressurizing", Phase::Depressurizing),
                ])?;
                map.insert(raw, phase);
            }
            Some(map)
        }
    }
}
