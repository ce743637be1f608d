//! `docs/simulate.md`: its example runs as printed and finds what was put in, its tables are those of the simulator, and no key is missing.

use crate::support::Bench;
use pipeline::simulate::effects::{Column, EFFECTS, Effect, Form, Link, Parameter, Per};
use pipeline::simulate::read_truth;
use pipeline::simulate::rig_settings::Rig;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

const PAGE: &str = include_str!("../../docs/simulate.md");

/// The first block of code in a language.
fn block(language: &str) -> &'static str {
    let begin = format!("```{language}\n");
    let rest = PAGE.split_once(&begin).unwrap().1;
    rest.split_once("```").unwrap().0
}

/// The commands of the page that follow the example.
fn commands() -> Vec<Vec<&'static str>> {
    let (_, after) = PAGE.split_once("```toml\n").unwrap();
    let (_, commands) = after.split_once("```sh\n").unwrap();
    let lines = commands.split_once("```").unwrap().0.lines();
    lines
        .map(|line| line.split_whitespace().skip(1).collect())
        .collect()
}

fn number(x: f64) -> String {
    if x == 0.0 || (1e-3..1e6).contains(&x.abs()) {
        x.to_string()
    } else {
        format!("{x:e}")
    }
}

/// The table of the rig's numbers but for their meaning.
fn of_rig() -> Vec<String> {
    let rigs = [10, 20, 40].map(|mm| serde_json::to_value(Rig::for_diameter(mm)).unwrap());
    let row = |(key, (low, high), unit): (&str, (f64, f64), &str)| {
        let defaults = rigs
            .each_ref()
            .map(|rig| number(rig[key].as_f64().unwrap()));
        format!(
            "| `{key}` | {unit} | {} to {} | {} |",
            number(low),
            number(high),
            defaults.join(" | ")
        )
    };
    Rig::ranges().into_iter().map(row).collect()
}

#[test]
fn the_table_of_the_rig_is_that_of_the_simulator() {
    for row in of_rig() {
        let line = PAGE.lines().find(|line| line.starts_with(&row));
        let meaning = line.map(|line| line[row.len()..].trim_matches([' ', '|']));
        assert!(
            meaning.is_some_and(|m| !m.is_empty()),
            "{row} is not in the page with its meaning; all rows begin:\n{}",
            of_rig().join("\n")
        );
    }
    for mm in [10, 20, 40] {
        let rig = Rig::for_diameter(mm);
        let rows = format!(
            "| {mm} mm: `rows` {}, `zero_rows` {}",
            rig.rows, rig.zero_rows
        );
        let said = rows.trim_start_matches("| ");
        assert!(PAGE.contains(said), "{said} is not in the page");
    }
}

fn acts_on(link: Link) -> &'static str {
    match link {
        Link::Pressure => "pressure",
        Link::Length => "length",
        Link::Frame => "frame",
        Link::Actuator => "actuator",
        Link::ForceSensor => "force sensor",
        Link::PressureSensor => "pressure sensor",
    }
}

/// What a form does, from the documentation at the head of the effect's file.
fn equation(effect: &Effect, form: &Form) -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/simulate/effects");
    let text = std::fs::read_to_string(file.join(format!("{}.rs", effect.id))).unwrap();
    let begin = format!("- `{}`: ", form.name);
    let lines = text.lines().filter_map(|line| line.strip_prefix("//! "));
    let mut lines = lines.skip_while(|line| !line.starts_with(&begin));
    let first = lines
        .next()
        .unwrap_or_else(|| panic!("{} {begin}", effect.id));
    let more = lines.take_while(|line| line.starts_with("  "));
    let whole: Vec<&str> = [&first[begin.len()..]]
        .into_iter()
        .chain(more.map(str::trim))
        .collect();
    whole.join(" ").trim_end_matches('.').replace('|', "\\|")
}

fn parameter(p: &Parameter) -> String {
    let default = p
        .default
        .map_or_else(String::new, |x| format!(", default {}", number(x)));
    let unit = if p.unit == "1" {
        String::new()
    } else {
        format!(" {}", p.unit)
    };
    format!(
        "`{}` {} to {}{unit}{default}",
        p.key,
        number(p.low),
        number(p.high)
    )
}

/// The table of effects.
fn of_effects() -> String {
    let mut lines = vec![
        "| effect | form | acts on | equation | numbers | drawn per | follows |".to_owned(),
        "|---|---|---|---|---|---|---|".to_owned(),
    ];
    for effect in EFFECTS {
        let per = match effect.per {
            Per::Session => "session",
            Per::Specimen => "specimen",
            Per::Log => "log",
        };
        let follows = match effect.column {
            Column::None => "–".to_owned(),
            Column::Named(name) => format!("`{name}`"),
            Column::Chosen => "`column`".to_owned(),
        };
        for form in effect.forms {
            let numbers: Vec<String> = form.parameters.iter().map(parameter).collect();
            lines.push(format!(
                "| `{}` | `{}` | {} | {} | {} | {per} | {follows} |",
                effect.id,
                form.name,
                acts_on(form.link),
                equation(effect, form),
                numbers.join("; ")
            ));
        }
    }
    lines.join("\n")
}

#[test]
fn the_table_of_effects_is_that_of_the_simulator() {
    assert!(
        PAGE.contains(&of_effects()),
        "the table should be:\n{}",
        of_effects()
    );
}

/// The keys that a table may have, as the reader of truth files names them where one is unknown.
fn known_keys(text: &str) -> BTreeSet<String> {
    let mistakes = read_truth("truth.toml", text).unwrap_err();
    let unknown = mistakes.iter().find(|d| &*d.found == "an unknown key");
    let unknown = unknown.unwrap_or_else(|| panic!("{mistakes:?}"));
    let list = unknown.expected.strip_prefix("one of ").unwrap();
    list.split(", ").map(ToOwned::to_owned).collect()
}

/// The keys in the tables of a section of the page.
fn page_keys(heading: &str) -> BTreeSet<String> {
    let section = PAGE.split_once(&format!("### {heading}\n")).unwrap().1;
    let section = section.split("\n### ").next().unwrap();
    let rows = section.lines().filter_map(|line| line.strip_prefix("| `"));
    rows.map(|row| row.split('`').next().unwrap().to_owned())
        .collect()
}

#[test]
fn the_page_has_every_key_and_no_other() {
    let example = block("toml");
    let unknown = "unheard_of = 1\n";
    let below =
        |table: &str| example.replace(&format!("{table}\n"), &format!("{table}\n{unknown}"));
    for (heading, text) in [
        ("The campaign", format!("{unknown}{example}")),
        ("Specimens", below("[[specimen]]")),
        ("Columns", below("[[column]]")),
        (
            "Coefficients",
            example.replace("\"published\"", "{ unheard_of = 1 }"),
        ),
    ] {
        assert_eq!(page_keys(heading), known_keys(&text), "{heading}");
    }
    // Of an effect, all but the numbers of its form; `column` is known to effects that ask for one.
    let mut known = known_keys(&below("[[effect]]"));
    assert!(known.remove("c_um_per_n"));
    known.insert("column".to_owned());
    let ids: BTreeSet<String> = EFFECTS.iter().map(|e| e.id.to_owned()).collect();
    let keys = page_keys("Effects");
    assert_eq!(
        keys.difference(&ids).cloned().collect::<BTreeSet<_>>(),
        known
    );
    // Of the rig, those of the table and the three in the text above it.
    let rig = known_keys(&format!("{example}[rig]\n{unknown}"));
    let mut keys = page_keys("The rig");
    keys.extend(["log_unit", "rows", "zero_rows"].map(ToOwned::to_owned));
    assert_eq!(keys, rig);
}

/// More than ten seconds of processor time.
mod long {
    use super::*;

    #[test]
    #[ignore = "long: 13 s of processor time"]
    fn the_example_runs_as_printed_and_what_was_put_in_is_found() {
        let bench = Bench::empty();
        std::fs::write(bench.root().join("truth.toml"), block("toml")).unwrap();
        for command in commands() {
            let said = bench.run(&command);
            assert_eq!(said.code, 0, "{command:?}: {}", said.err);
            bench.age();
        }
        let text = std::fs::read_to_string(bench.root().join("reports/findings.json")).unwrap();
        let findings: Value = serde_json::from_str(&text).unwrap();
        let effects = findings["campaigns"][0]["effects"].as_array().unwrap();
        let found: Vec<&str> = effects.iter().filter_map(|e| e["id"].as_str()).collect();
        assert!(found.contains(&"series_compliance"), "{found:?}");
        assert!(!found.contains(&"temperature"), "{found:?}");
        let drawn = std::fs::read_to_string(bench.root().join("truth.json")).unwrap();
        let drawn: Value = serde_json::from_str(&drawn).unwrap();
        assert_eq!(drawn["schema"], "bpa-drawn-truth/1");
        assert_eq!(drawn["sessions"].as_array().unwrap().len(), 24);
    }
}
