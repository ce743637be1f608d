//! Tests of whole campaigns; the parts are tested in their own files.

mod effects;
mod files;
mod logs;
mod truth_files;

use super::*;

const COMMITTED: [&str; 2] = [
    include_str!("../../../truths/simulated-10mm.toml"),
    include_str!("../../../truths/simulated-20mm.toml"),
];

const SMALL: &str = r#"
schema = "bpa-truth/1"
campaign = "small"
seed = 5
diameter_mm = 10
coefficients = "published"
contractions = [0, 0.5]
runs = [8, 9]
sampling = "timeseries"
[[specimen]]
id = "a"
rest_length_mm = 182
contraction_max = 0.165
[[specimen]]
id = "b"
rest_length_mm = 83
contraction_max = 0.157
role = "holdout"
[rig]
rows = 600
zero_rows = 200
"#;

/// A truth file without mistakes.
fn truth(text: &str) -> Truth {
    read_truth("truth.toml", text).expect("a good truth file")
}
