//! What stands in the logs, and what the steady rows say instead.

use super::super::*;
use super::{COMMITTED, SMALL, truth};
use pipeline_numerics::plateaus::{PlateauOptions, find_plateaus};

/// The columns of a log.
fn columns(bytes: &[u8]) -> Vec<Vec<f64>> {
    let text = std::str::from_utf8(bytes).expect("UTF-8");
    let rows: Vec<Vec<f64>> = text
        .lines()
        .map(|l| l.split(',').map(|c| c.parse().expect("a number")).collect())
        .collect();
    (0..rows[0].len())
        .map(|k| rows.iter().map(|r| r[k]).collect())
        .collect()
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

#[test]
fn the_same_truth_gives_the_same_bytes_and_another_seed_gives_others() {
    let campaign = simulate(&truth(SMALL));
    assert_eq!(campaign, simulate(&truth(SMALL)));
    let other = simulate(&truth(&SMALL.replace("seed = 5", "seed = 6")));
    assert_ne!(campaign.sessions[0].files[1], other.sessions[0].files[1]);
}

#[test]
fn what_is_added_leaves_the_other_sessions_as_they_were() {
    let before = simulate(&truth(SMALL));
    let more = SMALL
        .replace("[0, 0.5]", "[0.25, 0, 0.5]")
        .replace("[8, 9]", "[10, 8, 9]\nrun_speed = [1, 1, 0.56]")
        .replace(
            "[[specimen]]\nid = \"a\"",
            "[[specimen]]\nid = \"new\"\nrest_length_mm = 300\ncontraction_max = 0.17\n[[specimen]]\nid = \"a\"",
        );
    let after = simulate(&truth(&more));
    assert_eq!(after.sessions.len(), 9);
    for old in &before.sessions {
        let new = after.sessions.iter().find(|s| s.folder == old.folder);
        let new = new.expect("the session is still there");
        for (name, bytes) in old.files.iter().filter(|f| f.0.ends_with(".csv")) {
            assert!(
                new.files.iter().any(|f| &f.0 == name && &f.1 == bytes),
                "{name}"
            );
        }
    }
}

#[test]
fn plateaus_of_a_noise_free_log_agree_with_the_model() {
    let mut truth = truth(&SMALL.replace("rows = 600", "rows = 12000\nfill_share = 0.2"));
    (truth.rig.force_noise_n, truth.rig.pressure_noise_kpa) = (0.0, 0.0);
    let options = PlateauOptions {
        bin_s: 0.02,
        step_rate_kpa_per_s: 60.0,
        settle_s: 0.15,
        window_s: 0.25,
        shortest_window_s: 0.1,
        distinct_kpa: 5.0,
        longest_gap_s: 0.1,
    };
    let campaign = simulate(&truth);
    for (files, drawn) in campaign.sessions.iter().zip(&campaign.drawn.sessions) {
        let actuator = campaign.drawn.actuator(drawn);
        let [force, pressure, time, _] = &columns(&files.files[2].1)[..] else {
            panic!("four columns");
        };
        let plateaus = find_plateaus(time, pressure, &options).plateaus;
        assert!(plateaus.len() >= 12, "{}", plateaus.len());
        for plateau in plateaus {
            let p = mean(&pressure[plateau.window.clone()]);
            let f = mean(&force[plateau.window.clone()]) - drawn.force_zero_n;
            let expected = actuator.force(drawn.length_mm * 1e-3, p);
            let clipped = expected + drawn.force_zero_n < truth.rig.force_clip_n;
            // Half a count of force, half a count of pressure at most 0.9 N/kPa.
            assert!(
                clipped || (f - expected).abs() < 0.6831,
                "{p} kPa: {f} N, {expected} N"
            );
        }
    }
}

#[test]
fn zero_logs_show_the_zero_and_clip_where_the_amplifier_does() {
    let zero = |mean_n: &str| {
        let rig = format!("zero_sd_n = 0\nzero_mean_n = {mean_n}\nzero_rows = 2000");
        let campaign = simulate(&truth(&SMALL.replace("zero_rows = 200", &rig)));
        columns(&campaign.sessions[0].files[1].1)[0].clone()
    };
    assert!((mean(&zero("7.5")) - 7.5).abs() < 0.1);
    let clipped = zero("-12");
    let low = clipped.iter().filter(|f| **f == -8.7354).count();
    assert!(low > 1900, "{low}");
}

#[test]
fn the_zero_wanders_and_the_strength_belongs_to_the_specimen() {
    let drawn = DrawnTruth::new(&truth(COMMITTED[0]));
    let of = |k: usize| drawn.sessions.iter().filter(move |s| s.specimen == k);
    for k in 0..6 {
        let gains: Vec<f64> = of(k).map(|s| s.gain).collect();
        assert!(gains.windows(2).all(|w| w[0] == w[1]));
        assert!((gains[0] - 1.0).abs() < 0.1);
    }
    let zeros: Vec<f64> = drawn.sessions.iter().map(|s| s.force_zero_n).collect();
    assert!(zeros.iter().any(|z| *z > 6.0) && zeros.iter().any(|z| *z < 2.0));
}

#[test]
fn steady_rows_agree_with_the_model_to_their_noise() {
    for text in COMMITTED {
        let (drawn, rows) = rows(&truth(text));
        assert!(rows.len() > 500, "{}", rows.len());
        let errors: Vec<f64> = rows
            .iter()
            .map(|row| {
                let session = &drawn.sessions[row.session];
                let length = session.length_mm * 1e-3;
                row.force_n - drawn.actuator(session).force(length, row.pressure_kpa)
            })
            .collect();
        let rmse = mean(&errors.iter().map(|e| e * e).collect::<Vec<f64>>()).sqrt();
        assert!(mean(&errors).abs() < 0.1 && rmse < 0.4, "{rmse}");
    }
}
