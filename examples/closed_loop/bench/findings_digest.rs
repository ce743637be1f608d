//! Findings as one number: the SHA-256 of them with every number rounded to six significant digits; what tables of the loop do not judge is left out.

use pipeline::base::digest::Digest;
use pipeline::findings::CampaignFindings;
use serde_json::Value;

/// What the table does not judge, beside free forms.
const NOT_JUDGED: [&str; 15] = [
    "reference_level",
    "of_level",
    "left_out",
    "noise_in_time",
    "smallest_p",
    "share_of_rest_length",
    "rmse_heldout_calibrated",
    "rmse_heldout_spread",
    "found_in_folds",
    "by_specimen",
    "next_measurement",
    "not_measurable",
    "alternatives",
    "explained_as_well_by",
    "black_box_rmse_heldout",
];

/// The digest of some findings.
pub fn of_findings(all: &[CampaignFindings]) -> String {
    let text = |found: &CampaignFindings| {
        let mut value = serde_json::to_value(found).expect("findings are JSON");
        for effect in value["effects"].as_array_mut().into_iter().flatten() {
            effect["free_form"] = Value::Null;
        }
        NOT_JUDGED.iter().for_each(|key| leave_out(&mut value, key));
        let mut text = String::new();
        canonical(&value, &mut text);
        text
    };
    let texts: Vec<String> = all.iter().map(text).collect();
    Digest::of(texts.join("\n").as_bytes()).hex().to_owned()
}

/// Leaves out a key, wherever it stands.
fn leave_out(value: &mut Value, key: &str) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(|v| leave_out(v, key)),
        Value::Object(map) => {
            map.remove(key);
            map.values_mut().for_each(|v| leave_out(v, key));
        }
        _ => {}
    }
}

/// One text for one meaning: keys in order, numbers to six significant digits.
fn canonical(value: &Value, text: &mut String) {
    match value {
        Value::Number(number) => {
            let x = number.as_f64().unwrap_or(f64::NAN);
            // No sign on a nought.
            text.push_str(&format!("{:.5e}", if x == 0.0 { 0.0 } else { x }));
        }
        Value::Array(list) => list.iter().for_each(|v| {
            canonical(v, text);
            text.push(',');
        }),
        Value::Object(map) => {
            let mut keys: Vec<&String> = map.keys().collect();
            keys.sort();
            for key in keys {
                text.push_str(key);
                text.push(':');
                canonical(&map[key], text);
                text.push(';');
            }
        }
        other => text.push_str(&other.to_string()),
    }
}
