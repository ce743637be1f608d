//! `findings.json` against its committed JSON Schema, and both against `docs/findings.md`. The check is structural: it knows the keywords that the
//! schema uses and stops at any other.

use serde_json::{Map, Value};

const SCHEMA: &str = include_str!("../../docs/bpa-findings-2.schema.json");
const PAGE: &str = include_str!("../../docs/findings.md");
/// Findings in which every field has a value.
const EXAMPLE: &str = include_str!("../data/findings-2.json");

fn schema() -> Value {
    serde_json::from_str(SCHEMA).unwrap()
}

/// What is wrong with a value, each with its place.
pub fn complaints(value: &Value) -> Vec<String> {
    let root = schema();
    let mut found = Vec::new();
    check(&root, &root, value, "$", &mut found);
    found
}

fn check(root: &Value, schema: &Value, value: &Value, at: &str, found: &mut Vec<String>) {
    for (keyword, says) in schema.as_object().unwrap() {
        let fine = match keyword.as_str() {
            "$schema" | "title" | "description" | "$defs" | "additionalProperties" | "maxItems" => {
                true
            }
            "$ref" => {
                let name = says.as_str().unwrap().rsplit('/').next().unwrap();
                check(root, &root["$defs"][name], value, at, found);
                true
            }
            "const" => says == value,
            "enum" => says.as_array().unwrap().contains(value),
            "type" => is_of(says, value),
            "minimum" => value.as_f64().is_none_or(|x| x >= says.as_f64().unwrap()),
            "anyOf" => says
                .as_array()
                .unwrap()
                .iter()
                .any(|one| fits(root, one, value)),
            "items" => each(root, value, |_| says, at, found),
            "prefixItems" => each(root, value, |k| &says[k], at, found),
            "minItems" => value.as_array().is_none_or(|list| {
                let ends = (says.as_u64().unwrap(), schema["maxItems"].as_u64().unwrap());
                (ends.0..=ends.1).contains(&(list.len() as u64))
            }),
            "required" => says
                .as_array()
                .unwrap()
                .iter()
                .all(|key| value.get(key.as_str().unwrap()).is_some()),
            "properties" => value
                .as_object()
                .is_none_or(|fields| known(root, schema, fields, at, found)),
            other => panic!("the check does not know the keyword {other}"),
        };
        if !fine {
            found.push(format!(
                "{at}: {keyword} {says} does not hold of {}",
                short(value)
            ));
        }
    }
    if let (Some(others), Some(fields), None) = (
        schema.get("additionalProperties").filter(|s| s.is_object()),
        value.as_object(),
        schema.get("properties"),
    ) {
        fields
            .iter()
            .for_each(|(key, one)| check(root, others, one, &format!("{at}.{key}"), found));
    }
}

/// Checks the fields of an object; whether none is unknown.
fn known(
    root: &Value,
    schema: &Value,
    fields: &Map<String, Value>,
    at: &str,
    found: &mut Vec<String>,
) -> bool {
    assert_eq!(schema["additionalProperties"], false, "{at}");
    let mut all = true;
    for (key, one) in fields {
        match schema["properties"].get(key) {
            Some(of) => check(root, of, one, &format!("{at}.{key}"), found),
            None => all = false,
        }
    }
    all
}

fn each<'a>(
    root: &Value,
    list: &Value,
    of: impl Fn(usize) -> &'a Value,
    at: &str,
    found: &mut Vec<String>,
) -> bool {
    let items = list.as_array().into_iter().flatten().enumerate();
    items.for_each(|(k, one)| check(root, of(k), one, &format!("{at}[{k}]"), found));
    true
}

fn fits(root: &Value, schema: &Value, value: &Value) -> bool {
    let mut found = Vec::new();
    check(root, schema, value, "", &mut found);
    found.is_empty()
}

fn is_of(types: &Value, value: &Value) -> bool {
    let is = |name: &Value| match name.as_str().unwrap() {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        other => panic!("no type {other}"),
    };
    types
        .as_array()
        .map_or_else(|| is(types), |list| list.iter().any(is))
}

fn short(value: &Value) -> String {
    value.to_string().chars().take(80).collect()
}

#[test]
fn an_example_with_every_field_fits_and_comes_back_the_same() {
    let value: Value = serde_json::from_str(EXAMPLE).unwrap();
    assert_eq!(complaints(&value), [""; 0]);
    let read: pipeline::findings::Findings = serde_json::from_str(EXAMPLE).unwrap();
    assert_eq!(read.schema, pipeline::findings::SCHEMA);
    let written = serde_json::to_value(&read).unwrap();
    assert_eq!(complaints(&written), [""; 0]);
    let again: pipeline::findings::Findings = serde_json::from_value(written).unwrap();
    assert_eq!(again, read);
}

#[test]
fn mistakes_are_found() {
    let mistake = |change: fn(&mut Value)| {
        let mut value: Value = serde_json::from_str(EXAMPLE).unwrap();
        change(&mut value["campaigns"][0]);
        complaints(&value).len()
    };
    assert_eq!(mistake(|_| ()), 0);
    assert_eq!(mistake(|c| c["verdict"] = "maybe".into()), 1);
    assert_eq!(mistake(|c| c["summary"] = "a sentence".into()), 1);
    assert_eq!(mistake(|c| c["noise"] = "2.6".into()), 1);
    assert_eq!(mistake(|c| c["effects"][0]["profile"][0] = 1.into()), 1);
    assert_eq!(
        mistake(|c| c["aliases"][0]["ids"] = Value::Array(vec!["a".into()])),
        1
    );
    assert_eq!(
        mistake(|c| drop(c.as_object_mut().unwrap().remove("budget"))),
        1
    );
    assert_eq!(mistake(|c| c["design"]["readings"] = (-1).into()), 1);
}

#[test]
fn the_page_names_every_field_and_value_under_its_heading() {
    let root = schema();
    for (name, of) in root["$defs"].as_object().unwrap() {
        let heading = format!("\n### {name}\n");
        let (_, after) = PAGE
            .split_once(&heading)
            .unwrap_or_else(|| panic!("no heading {name}"));
        let section = after.split("\n### ").next().unwrap();
        let fields = of
            .get("properties")
            .into_iter()
            .flat_map(|p| p.as_object().unwrap().keys());
        let values = of
            .get("enum")
            .into_iter()
            .flat_map(|e| e.as_array().unwrap().iter());
        let values = values.map(|v| v.as_str().unwrap());
        for key in fields.map(String::as_str).chain(values) {
            assert!(section.contains(&format!("| `{key}` |")), "{name}.{key}");
        }
    }
}
