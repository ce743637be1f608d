//! Mistakes in a truth file.

use super::SMALL;
use crate::read_truth;

#[test]
fn every_mistake_of_a_truth_file_is_reported_with_line_and_hint() {
    let text = SMALL
        .replace("seed = 5", "sede = 5")
        .replace("[0, 0.5]", "[0, 3, 0]")
        .replace("contraction_max = 0.157", "contraction_max = 157")
        .replace(
            "rows = 600",
            "rows = 600\nsuply_kpa = 620\n[[effect]]\nid = \"creep\"",
        );
    let mistakes = read_truth("truth.toml", &text).expect_err("four mistakes");
    let lines: Vec<String> = mistakes.iter().map(ToString::to_string).collect();
    let has = |parts: &[&str]| lines.iter().any(|l| parts.iter().all(|p| l.contains(p)));
    assert!(has(&["truth.toml:1 [seed]", "found nothing"]), "{lines:#?}");
    assert!(
        has(&["truth.toml:4 [sede]", "did you mean `seed`?"]),
        "{lines:#?}"
    );
    assert!(
        has(&["truth.toml:7 [contractions[1]]", "found 3"]),
        "{lines:#?}"
    );
    assert!(
        has(&["[specimen[1].contraction_max]", "found 157"]),
        "{lines:#?}"
    );
    assert!(
        has(&["[rig.suply_kpa]", "did you mean `supply_kpa`?"]),
        "{lines:#?}"
    );
    assert!(has(&["[effect[0].k]", "found nothing"]), "{lines:#?}");
}

#[test]
fn a_mistake_that_hides_the_schedule_does_not_make_its_keys_unknown() {
    let points = "sampling = \"points\"\ndwell_s = [2]\ndirections = \"up-down\"\npressures_kpa = [100, 300]\nruns = []";
    let without = |key: &str| !key.starts_with("runs") && !key.starts_with("sampling");
    let kept: Vec<&str> = SMALL.lines().filter(|l| without(l)).collect();
    let text = format!("{points}\n{}", kept.join("\n"));
    let said = read_truth("t", &text).expect_err("no run");
    let found: Vec<&str> = said.iter().map(|d| &*d.found).collect();
    assert!(!found.contains(&"an unknown key"), "{said:?}");
    assert!(
        said.iter().any(|d| d.to_string().contains("[runs]")),
        "{said:?}"
    );
}

#[test]
fn what_the_rig_cannot_measure_is_refused() {
    let mistake = |text: &str| read_truth("t", text).expect_err("a mistake")[0].to_string();
    let strong = "coefficients = { b1 = 3000, b2 = 19, l_0 = 0.0075, c0 = 0.5, c1 = 4, c2 = 0.5 }";
    let text = SMALL.replace("coefficients = \"published\"", strong);
    assert!(
        mistake(&text).contains("force_quantum_n"),
        "{}",
        mistake(&text)
    );
    let text = SMALL.replace("diameter_mm = 10", "diameter_mm = 40");
    assert!(
        mistake(&text).contains("not published"),
        "{}",
        mistake(&text)
    );
    let text = SMALL.replace("id = \"b\"", "id = \"A\"");
    assert!(
        mistake(&text).contains("`a` a second time"),
        "{}",
        mistake(&text)
    );
    let text = SMALL.replace("rows = 600", "rows = 600\nfloor_kpa = 80\nsupply_kpa = 70");
    assert!(
        mistake(&text).contains("rig.floor_kpa"),
        "{}",
        mistake(&text)
    );
    let text = SMALL.replace("id = \"b\"", "id = \"../b\"");
    assert!(
        mistake(&text).contains("letters, digits"),
        "{}",
        mistake(&text)
    );
}

#[test]
fn effects_columns_dates_and_schedules_are_read_as_strictly() {
    let points = "\"points\"\npressures_kpa = [620, 300]\ndirections = \"up-down\"\n\
                  ramp_kpa_per_s = [2]\nfirst_date = \"2026-02-30\"\norder = \"shuffeld\"";
    let tables = r#"
[[column]]
name = "force_n"
[[column]]
name = "humidity"
sd_sesion = 3
[[effect]]
id = "series_complience"
[[effect]]
id = "series_compliance"
form = "stifening"
[[effect]]
id = "series_compliance"
c_um_per_n = 5000
specimen = "z"
[[effect]]
id = "force_gain"
gain = 1.1
per = "log"
[[effect]]
id = "specimen_variation"
form = "two_batch"
u = 0.1
[[effect]]
id = "length_offset"
offset_mm = 1
from_session = 5
growth_per_m = 1
[[effect]]
id = "unknown_column"
k_per_unit = 0.1
"#;
    let text = SMALL.replace("\"timeseries\"", points) + tables;
    let mistakes = read_truth("truth.toml", &text).expect_err("many mistakes");
    let lines: Vec<String> = mistakes.iter().map(ToString::to_string).collect();
    for parts in [
        ["[directions]", "rising"],
        ["[ramp_kpa_per_s]", "2 numbers, one a run"],
        ["[first_date]", "a day, ISO 8601"],
        ["[order]", "did you mean \"shuffled\"?"],
        ["[column[0].name]", "not taken"],
        ["[column[1].sd_sesion]", "did you mean `sd_session`?"],
        ["[effect[0].id]", "did you mean \"series_compliance\"?"],
        ["[effect[1].form]", "did you mean \"stiffening\"?"],
        ["[effect[2].c_um_per_n]", "found 5000"],
        ["[effect[2].specimen]", "a specimen of this file"],
        ["[effect[3].per]", "`sd` beside it"],
        ["[effect[4].sd]", "found nothing"],
        ["[effect[5].from_session]", "found 5"],
        ["[effect[5].growth_per_m]", "an unknown key"],
        ["[effect[6].column]", "found nothing"],
    ] {
        let found = lines.iter().any(|l| parts.iter().all(|p| l.contains(p)));
        assert!(found, "{parts:?}: {lines:#?}");
    }
    let needs = SMALL.to_owned() + "[[effect]]\nid = \"temperature\"\nk_per_c = -0.003\n";
    let mistakes = read_truth("truth.toml", &needs).expect_err("no such column");
    assert!(mistakes[0].to_string().contains("temperature_c"));
}
