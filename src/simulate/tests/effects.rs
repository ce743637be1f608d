//! Campaigns with effects, from the truth file to the rows.

use super::super::*;
use super::truth;

const EXAMPLE: &str = include_str!("../../../truths/closed-loop-10mm.toml");

#[test]
fn the_rows_of_the_example_hold_what_its_truth_file_says() {
    let truth = truth(EXAMPLE);
    let campaign = campaign_rows(&truth);
    // 24 sessions, 2 runs, 7 pressures up and 6 down, 2 dwells.
    assert_eq!(campaign.rows.len(), 24 * 2 * 13 * 2);
    let mut error = 0.0;
    for (row, reading) in campaign.rows.iter().zip(&campaign.readings) {
        assert!(row.simulated && row.date.is_some() && row.phase.is_some());
        assert!(row.extras["dwell_s"] == 2.0 || row.extras["dwell_s"] == 20.0);
        assert!((row.extras["temperature_c"] - 21.0).abs() < 8.0);
        let session = &campaign.drawn.sessions[reading.session];
        let length = session.length_mm * 1e-3 - 6e-6 * reading.true_force_n;
        let force = campaign
            .drawn
            .actuator(session)
            .force(length, reading.at.pressure_kpa);
        assert!((force - reading.true_force_n).abs() < 1e-6);
        error += (row.force_n - reading.true_force_n).abs();
    }
    assert!(error / (campaign.rows.len() as f64) < 1.5);
}

#[test]
fn sizes_are_drawn_for_what_shares_them_and_act_where_they_should() {
    let effects = r#"
[[effect]]
id = "force_zero_offset"
sd = 3
per = "log"
[[effect]]
id = "force_gain"
gain = 1.1
from_session = 3
[[effect]]
id = "specimen_variation"
form = "two_batch"
sd = 0.05
[[effect]]
id = "length_offset"
offset_mm = 1
session = "small-a-c50"
"#;
    let truth = truth(&(super::SMALL.to_owned() + effects));
    let drawn = DrawnTruth::new(&truth);
    let of = |k: usize| &drawn.effects[k].values;
    assert_ne!(of(0)[0][0], of(0)[0][1]);
    let gains = [None, None, Some(1.1), Some(1.1)].map(|g| vec![g; 2]);
    assert_eq!(of(1)[..], gains);
    let u: Vec<f64> = of(2)
        .iter()
        .flatten()
        .map(|u| u.expect("everywhere"))
        .collect();
    assert!(u.iter().all(|u| u.abs() == 0.05) && u[0] == u[3] && u[4] == u[7]);
    assert_eq!(of(3)[..], [None, Some(1.0), None, None].map(|d| vec![d; 2]));
    let json = serde_json::to_string(&drawn).expect("JSON");
    assert!(json.contains("\"force_zero_offset\"") && json.contains("offset_mm"));
    let toml = |s: &SessionFiles| String::from_utf8(s.files[0].1.clone()).expect("UTF-8");
    assert!(
        simulate(&truth)
            .sessions
            .iter()
            .all(|s| !toml(s).contains("offset_mm"))
    );
}

#[test]
fn a_campaign_of_24_sessions_takes_milliseconds() {
    let truth = truth(EXAMPLE);
    let start = std::time::Instant::now();
    for _ in 0..20 {
        std::hint::black_box(campaign_rows(&truth));
    }
    let mean = start.elapsed() / 20;
    println!("{mean:?} a campaign");
    // Wide enough for a loaded machine: it takes 3 ms.
    assert!(mean.as_millis() < 100, "{mean:?}");
}
