//! The lists and identifiers of a truth file, and the check that the rig can measure what the file asks for.

use super::chain::TOP_COUNT;
use super::rig_settings::within;
use super::truth::{Run, SpecimenTruth, Truth};
use pipeline_base::session::{Role, Sampling};
use pipeline_base::toml_reader::{Entry, Section};
use pipeline_mechanics::models::P_620_KPA;

/// A name that can be a folder on every system: letters, digits, `-`, `_`.
pub fn identifier(table: &Section, key: &'static str, expected: &str) -> Option<String> {
    let entry = table.require(key, expected, "add it")?;
    let text = entry.string()?;
    let good = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if text.is_empty() || text.len() > 60 || !text.chars().all(good) {
        entry.reject(
            "at most 60 letters, digits, hyphens and underscores",
            "it becomes the name of a folder",
        );
        return None;
    }
    Some(text)
}

/// A day or a month, ISO 8601.
pub fn date(entry: &Entry) -> Option<String> {
    let text = entry.as_string().unwrap_or_else(|| entry.describe());
    let part = |s: &str, digits: usize, top: u32| {
        s.len() == digits
            && s.bytes().all(|b| b.is_ascii_digit())
            && s.parse::<u32>().is_ok_and(|x| (1..=top).contains(&x))
    };
    let parts: Vec<&str> = text.split('-').collect();
    let good = match parts[..] {
        [y, m] => part(y, 4, 9999) && part(m, 2, 12),
        [y, m, d] => part(y, 4, 9999) && part(m, 2, 12) && part(d, 2, 31),
        _ => false,
    };
    if !good {
        let hint = "write \"2026-01\" or \"2026-01-31\"";
        entry.reject("a date, ISO 8601: a day or a month", hint);
        return None;
    }
    Some(text)
}

/// Label of a relative contraction in ids and folders: per cent, two digits.
pub fn contraction_label(contraction_rel: f64) -> String {
    format!("c{:02}", (100.0 * contraction_rel).round() as i64)
}

/// The relative contractions, each with a label of its own.
pub fn contractions(root: &Section) -> Option<Vec<f64>> {
    let read = |e: &Entry| within(e, 0.0, 1.2, "eps/eps_620", "0 is the resting length");
    let key = "contractions";
    let list = required_list(
        root,
        key,
        "a list of relative contractions",
        "[0, 0.5]",
        read,
    )?;
    distinct(root, key, &list, |c| contraction_label(*c)).then_some(list)
}

/// The runs with their speeds.
pub fn runs(root: &Section) -> Option<Vec<Run>> {
    let numbers = required_list(root, "runs", "a list of run numbers", "[8, 9, 10]", |e| {
        let number = e.integer()?;
        if !(0..=9999).contains(&number) {
            e.reject(
                "a whole number from 0 to 9999",
                "number the runs as in the file names",
            );
            return None;
        }
        Some(number)
    });
    let speeds = root.get("run_speed");
    let numbers = numbers?;
    if !distinct(root, "runs", &numbers, |n| n.to_string()) {
        return None;
    }
    let speeds = match speeds {
        None => (0..numbers.len())
            .map(|k| if k == 0 { 1.0 } else { 0.56 })
            .collect(),
        Some(entry) => {
            let speeds = all(&entry, |e| {
                within(e, 0.05, 5.0, "1", "1 is the rig's fast run")
            })?;
            if speeds.len() != numbers.len() {
                entry.reject(
                    &format!("{} numbers, one a run", numbers.len()),
                    "count the runs",
                );
                return None;
            }
            speeds
        }
    };
    let runs = numbers.into_iter().zip(speeds);
    Some(runs.map(|(number, speed)| Run { number, speed }).collect())
}

/// The pressures of steady readings, kPa: needed for points, unknown for logs over time.
pub fn pressures(root: &Section, sampling: Option<Sampling>) -> Option<Vec<f64>> {
    if sampling != Some(Sampling::Points) {
        return Some(Vec::new());
    }
    let read = |e: &Entry| within(e, 0.0, 740.0, "kPa", "write gauge pressures");
    let example = "[100, 200, 300, 400, 500, 620]";
    required_list(
        root,
        "pressures_kpa",
        "the pressures that are read",
        example,
        read,
    )
}

/// The actuators.
pub fn specimens(root: &Section) -> Option<Vec<SpecimenTruth>> {
    let example = "an [[specimen]] with id, rest_length_mm and contraction_max";
    let list = required_list(
        root,
        "specimen",
        "at least one [[specimen]]",
        example,
        specimen,
    )?;
    distinct(root, "specimen.id", &list, |s| s.id.to_ascii_lowercase()).then_some(list)
}

fn specimen(entry: &Entry) -> Option<SpecimenTruth> {
    let table = entry.table()?;
    let id = identifier(&table, "id", "the name of the physical actuator");
    let hint = "write the distance between the hose clamps";
    let rest = table
        .require("rest_length_mm", "l_rest in mm", hint)
        .and_then(|e| within(&e, 20.0, 5000.0, "mm", hint));
    let hint = "a free actuator shortens by about a sixth (10 mm) or a quarter (20 mm)";
    let contraction = table
        .require("contraction_max", "eps_620", hint)
        .and_then(|e| within(&e, 0.02, 0.5, "1", hint));
    let roles = [
        ("train", Role::Train),
        ("validation", Role::Validation),
        ("holdout", Role::Holdout),
    ];
    let role = table.get("role").and_then(|e| e.choice(&roles));
    table.close();
    let (rest, contraction) = (rest?, contraction?);
    Some(SpecimenTruth {
        id: id?,
        rest_length_mm: rest,
        contracted_length_mm: (10.0 * rest * (1.0 - contraction)).round() / 10.0,
        role,
    })
}

fn required_list<T>(
    table: &Section,
    key: &'static str,
    expected: &str,
    example: &str,
    read: impl Fn(&Entry) -> Option<T>,
) -> Option<Vec<T>> {
    let entry = table.require(key, expected, &format!("write {example}"))?;
    let list = all(&entry, read)?;
    if list.is_empty() {
        entry.reject(expected, &format!("write {example}"));
        return None;
    }
    Some(list)
}

/// Every element, or nothing once all mistakes are recorded.
fn all<T>(entry: &Entry, read: impl Fn(&Entry) -> Option<T>) -> Option<Vec<T>> {
    let elements: Vec<Option<T>> = entry.list()?.iter().map(read).collect();
    elements.into_iter().collect()
}

fn distinct<T>(table: &Section, key: &str, list: &[T], label: impl Fn(&T) -> String) -> bool {
    let labels: Vec<String> = list.iter().map(label).collect();
    let repeated = (1..labels.len()).find(|k| labels[..*k].contains(&labels[*k]));
    if let Some(k) = repeated {
        let found = format!("`{}` a second time", labels[k]);
        let (line, path) = (table.line(), table.path_of(key));
        let hint = "each becomes a file or folder of its own";
        table
            .reader()
            .report(line, &path, found, "different entries", hint);
    }
    repeated.is_none()
}

/// What the rig cannot do: vent above its supply, or show a force beyond its converter (four standard deviations above the
/// strongest specimen).
pub fn check_rig(root: &Section, truth: &Truth) {
    let rig = &truth.rig;
    let report = |key: &str, found: String, expected: String, hint: &str| {
        let reader = root.reader();
        reader.report(root.line(), key, found, &expected, hint);
    };
    let supply = rig.supply_kpa - 4.0 * rig.supply_sd_kpa;
    if rig.floor_kpa >= supply {
        let found = format!("{} kPa", rig.floor_kpa);
        let expected = format!("a pressure below {supply} kPa, the lowest supply of a session");
        report(
            "rig.floor_kpa",
            found,
            expected,
            "lower it, or raise supply_kpa",
        );
    }
    let forces = truth
        .specimens
        .iter()
        .map(|s| truth.coefficients.f620(s.rest_length_mm * 1e-3));
    let strongest = forces.fold(0.0, f64::max) * (1.0 + 4.0 * rig.specimen_scatter);
    let pressure = (rig.supply_kpa + 4.0 * rig.supply_sd_kpa) / P_620_KPA;
    let needed = strongest * pressure + rig.zero_mean_n + 4.0 * rig.zero_sd_n;
    let quantum = rig.force_quantum_n;
    let top = rig.force_clip_n + TOP_COUNT * quantum;
    if truth.sampling == Sampling::Timeseries && needed > top {
        let found = format!("{quantum} N, with which the converter ends at {top:.0} N");
        let expected = format!("a converter that reaches {needed:.0} N");
        report("rig.force_quantum_n", found, expected, "raise it");
    }
}
