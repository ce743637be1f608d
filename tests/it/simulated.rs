//! Simulated files, read as any others, against the same campaign as rows without files.

use pipeline::base::row::Row;
use pipeline::config::CleanOptions;
use pipeline::formats::session_toml;
use pipeline::simulate::{self, Campaign, CampaignRows, Truth};
use pipeline::stages::{clean::clean, ingest::ingest, normalize::normalize};

const HEAD: &str = r#"
schema = "bpa-truth/1"
campaign = "small"
seed = 5
diameter_mm = 10
coefficients = "published"
contractions = [0, 0.25]
order = "shuffled"
first_date = "2026-01-30"
[[specimen]]
id = "a"
rest_length_mm = 182
contraction_max = 0.165
[[specimen]]
id = "b"
rest_length_mm = 112
contraction_max = 0.16
role = "holdout"
[[column]]
name = "temperature_c"
mean = 21
sd_session = 2
drift = 1
[[column]]
name = "humidity"
unit = "%"
mean = 40
sd_row = 1
[[effect]]
id = "series_compliance"
form = "stiffening"
c_um_per_n = 9
[[effect]]
id = "hysteresis"
form = "play"
half_width_kpa = 12
[[effect]]
id = "temperature"
k_per_c = -0.004
[[effect]]
id = "creep"
k = 0.02
[[effect]]
id = "rate_dependence"
form = "saturating"
n_s_per_kpa = -0.2
[[effect]]
id = "pressure_zero_offset"
zero_kpa = 9
[[effect]]
id = "force_zero_offset"
sd = 4
"#;

fn truth(keys: &str, rig: &str) -> Truth {
    let text = HEAD.replacen("seed = 5", &format!("seed = 5\n{keys}"), 1) + rig;
    simulate::read_truth("truth.toml", &text).unwrap_or_else(|d| panic!("{d:#?}"))
}

/// The rows that the first three stages make of the files.
fn through_the_stages(campaign: &Campaign) -> Vec<Row> {
    let mut rows = Vec::new();
    for files in &campaign.sessions {
        let text = std::str::from_utf8(&files.files[0].1).unwrap();
        let session = session_toml::read("session.toml", text).unwrap();
        let logs = files.files[1..].iter().map(|f| Ok(f.1.clone())).collect();
        let ingested = ingest(&session, "session", logs);
        assert!(ingested.header.rejects.is_empty());
        let cleaned = clean(&session, &ingested.logs, &CleanOptions::default());
        rows.extend(normalize(&session, &cleaned.readings).0);
    }
    rows
}

/// What points must have in common, reading by reading; the mean square difference of the forces.
fn compare_points(keys: &str) -> (CampaignRows, f64) {
    let truth = truth(keys, "");
    let files = through_the_stages(&simulate::simulate(&truth));
    let direct = simulate::campaign_rows(&truth);
    assert_eq!(files.len(), direct.rows.len());
    let mut squares = 0.0;
    for (file, row) in files.iter().zip(&direct.rows) {
        assert_eq!(
            (&file.session, &file.date, file.role),
            (&row.session, &row.date, row.role)
        );
        assert_eq!(
            (file.run, file.phase, &file.log),
            (row.run, row.phase, &row.log)
        );
        assert_eq!(
            (file.first_row, file.length_m),
            (row.first_row, row.length_m)
        );
        assert!(file.simulated && row.simulated);
        assert!((file.time_s - row.time_s).abs() < 1e-3);
        assert!((file.pressure_kpa - row.pressure_kpa).abs() < 3.0);
        assert!(
            file.extras.keys().eq(row.extras.keys()),
            "{:?}",
            file.extras
        );
        for (name, x) in &file.extras {
            let within = if name == "humidity" { 8.0 } else { 1e-3 };
            assert!((x - row.extras[name]).abs() < within, "{name}");
        }
        squares += (file.force_n - row.force_n) * (file.force_n - row.force_n);
    }
    (direct, squares / files.len() as f64)
}

#[test]
fn points_from_files_agree_with_rows_made_without_them() {
    // Two readings of noise 0.9 N and a step of 0.68 N differ by 1.4 N.
    let base = "sampling = \"points\"\npressures_kpa = [50, 200, 400, 620]\nruns = [1, 2, 3]\n";
    let dwell = format!("{base}directions = \"up-down\"\ndwell_s = [2, 20, 120]");
    let (dwelled, square) = compare_points(&dwell);
    assert_eq!(dwelled.rows.len(), 4 * 3 * 7 * 3);
    assert!(dwelled.rows.iter().any(|r| r.extras["dwell_s"] == 120.0));
    assert!(square.sqrt() < 1.7, "{square}");
    let ramp = format!("{base}directions = \"up-down\"\nramp_kpa_per_s = [2, 20, 100]");
    let (passed, square) = compare_points(&ramp);
    assert_eq!(passed.rows.len(), 4 * 3 * 7);
    assert!(
        passed
            .rows
            .iter()
            .any(|r| r.extras["rate_kpa_per_s"] == -100.0)
    );
    assert!(square.sqrt() < 1.7, "{square}");
}

#[test]
fn plateaus_from_logs_agree_with_rows_made_without_them() {
    let rig =
        "[rig]\nrows = 12000\nzero_rows = 2000\nfill_share = 0.2\nzero_mean_n = 8\nzero_sd_n = 2\n";
    let truth = truth("sampling = \"timeseries\"\nruns = [8, 9]\n", rig);
    let files = through_the_stages(&simulate::simulate(&truth));
    let direct = simulate::campaign_rows(&truth);
    let mut differences = Vec::new();
    for row in &files {
        let same = |r: &&Row| (&r.session, r.run, r.phase) == (&row.session, row.run, row.phase);
        // The clock of the log runs a little faster than the mean, and the switch to venting may fall into another step: what agrees
        // is the force as a function of pressure, which is a straight line between neighbours.
        let near = |side: f64| {
            let rows = direct.rows.iter().filter(same);
            let away = move |r: &&Row| side * (r.pressure_kpa - row.pressure_kpa);
            rows.filter(move |r| away(r) >= 0.0)
                .min_by(|a, b| away(a).total_cmp(&away(b)))
        };
        let (Some(low), Some(high)) = (near(-1.0), near(1.0)) else {
            continue;
        };
        if low.force_n < 10.0 {
            continue;
        }
        let part = (row.pressure_kpa - low.pressure_kpa) / (high.pressure_kpa - low.pressure_kpa);
        differences.push(row.force_n - low.force_n - part * (high.force_n - low.force_n));
        assert!((row.extras["temperature_c"] - low.extras["temperature_c"]).abs() < 0.2);
    }
    let share = differences.len() as f64 / files.len() as f64;
    let mean_square = differences.iter().map(|d| d * d).sum::<f64>() / differences.len() as f64;
    assert!(
        files.len() > 150 && share > 0.6,
        "{share} of {}",
        files.len()
    );
    assert!(mean_square.sqrt() < 1.0, "{}", mean_square.sqrt());
}
