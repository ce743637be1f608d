//! `check-session`: what it says of sound sessions, and of those that are not.

use crate::support::Bench;
use serde_json::Value;
use std::path::Path;
use std::time::Duration;

/// A session like one of the small campaign in a folder of its own, beside the raw directory, with some text of its description replaced. Its logs
/// have other line ends: another measurement has other bytes.
fn copied(bench: &Bench, replaced: &[(&str, &str)]) -> String {
    let from = bench.raw().join("small/b/c50");
    let to = bench.root().join("new");
    std::fs::create_dir_all(&to).unwrap();
    for entry in std::fs::read_dir(&from).unwrap() {
        let path = entry.unwrap().path();
        let mut text = std::fs::read_to_string(&path).unwrap();
        if path.extension().is_some_and(|e| e == "csv") {
            text = text.replace('\n', "\r\n");
        }
        std::fs::write(to.join(path.file_name().unwrap()), text).unwrap();
    }
    let description = to.join("session.toml");
    let mut text = std::fs::read_to_string(&description).unwrap();
    for (old, new) in [("small-b-c50", "new")].iter().chain(replaced) {
        assert!(text.contains(old), "{old} is not in\n{text}");
        text = text.replace(old, new);
    }
    std::fs::write(&description, text).unwrap();
    "new".to_owned()
}

fn checks<'v>(said: &'v Value, name: &str) -> Vec<&'v Value> {
    let all = said[0]["checks"].as_array().unwrap();
    all.iter().filter(|c| c["check"] == name).collect()
}

fn inspected(bench: &Bench, folder: &str) -> (i32, Value) {
    let said = bench.run(&["check-session", folder, "--json"]);
    let value = serde_json::from_str(&said.out);
    (
        said.code,
        value.unwrap_or_else(|e| panic!("{e}: {}{}", said.out, said.err)),
    )
}

/// The length that is set in the middle session of the campaign, as its description has it.
fn set_length(bench: &Bench) -> (String, f64) {
    let text = std::fs::read_to_string(bench.raw().join("small/b/c50/session.toml")).unwrap();
    let line = text.lines().find(|l| l.starts_with("length_mm")).unwrap();
    let value = line.split('=').nth(1).unwrap().trim().parse().unwrap();
    (line.to_owned(), value)
}

#[test]
fn a_sound_session_is_fine_and_nothing_is_written() {
    let bench = Bench::small_done();
    let before = bench.results();
    let folder = copied(&bench, &[]);
    let said = bench.run(&["check-session", &folder, "--plot", "plots"]);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(
        said.out.contains("new: ok") && said.out.contains("specimen gain"),
        "{}",
        said.out
    );
    assert!(bench.root().join("plots/new.svg").is_file());
    assert!(bench.results() == before);
}

#[test]
fn a_wrong_length_is_told_with_its_size() {
    let bench = Bench::small_done();
    let (line, length) = set_length(&bench);
    let folder = copied(
        &bench,
        &[(&line, &format!("length_mm = {}", length + 10.0))],
    );
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 2, "{found}");
    let own = checks(&found, "set_length")[0];
    assert_eq!(own["state"], "look");
    let deviations = own["value_mm"].as_f64().unwrap() / own["sd_mm"].as_f64().unwrap();
    assert!(deviations < -3.0, "{own}");
    let mistake = checks(&found, "mistake")[0];
    assert_eq!(mistake["error"]["quantity"], "length", "{mistake}");
    let size = mistake["error"]["value"].as_f64().unwrap();
    assert!((size + 10.0).abs() < 2.0, "{mistake}");
}

#[test]
fn without_a_run_the_published_law_is_the_yardstick() {
    let bench = Bench::small();
    let folder = copied(&bench, &[]);
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 0, "{found}");
    assert!(found[0]["against"].as_str().unwrap().contains("published"));
}

#[test]
fn a_set_length_says_to_what_it_is_relative() {
    // What is subtracted of the length by the law: nothing without a run, else the median of the others.
    let subtracted = |bench: &Bench, error_mm: f64, others: usize| {
        let (line, length) = set_length(bench);
        let wrong = format!("length_mm = {}", length + error_mm);
        let folder = copied(bench, &[(&line, &wrong)]);
        let (_, found) = inspected(bench, &folder);
        let of = checks(&found, "set_length")[0];
        assert_eq!(of["others"], others, "{of}");
        let said = bench.run(&["check-session", &folder]).out;
        (
            of["by_law_mm"].as_f64().unwrap() - of["value_mm"].as_f64().unwrap(),
            said,
        )
    };
    let (nothing, said) = subtracted(&Bench::small(), 9.0, 0);
    assert_eq!(nothing, 0.0);
    assert!(said.contains("from the one noted, by the law: "), "{said}");
    let bench = Bench::small_done();
    let (first, _) = subtracted(&bench, 9.0, 6);
    let (second, said) = subtracted(&bench, 11.0, 6);
    assert!((first - second).abs() < 1e-9, "{first} {second}");
    for part in [
        "from the median of 6 other sessions",
        "from the one noted, by the law)",
        "(without effects)",
    ] {
        assert!(said.contains(part), "{part} is not in\n{said}");
    }
}

#[test]
fn a_measured_session_is_not_compared_with_simulated_ones() {
    let bench = Bench::small_done();
    let folder = copied(&bench, &[("simulated by pipeline simulate", "measured")]);
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 0, "{found}");
    assert!(
        found[0]["against"].as_str().unwrap().contains("published"),
        "{found}"
    );
}

/// What is named where the columns are described with a mistake: its kind, column and unit.
fn named_of_columns(replaced: &[(&str, &str)]) -> [Value; 3] {
    let bench = Bench::small_done();
    let folder = copied(&bench, replaced);
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 2, "{found}");
    let columns = checks(&found, "columns");
    assert_eq!(columns.len(), 1, "{found}");
    assert!(checks(&found, "mistake").is_empty(), "{found}");
    let otherwise = &columns[0]["otherwise"];
    [
        otherwise["kind"].clone(),
        otherwise["column"].clone(),
        otherwise["units"].clone(),
    ]
}

#[test]
fn exchanged_columns_are_named_though_no_reading_is_left() {
    let exchanged = [
        ("force = { index = 0", "force = { index = 1"),
        ("pressure = { index = 1", "pressure = { index = 0"),
    ];
    let [kind, column, _] = named_of_columns(&exchanged);
    assert_eq!((kind, column), ("swapped_columns".into(), Value::Null));
}

#[test]
fn a_wrong_sign_is_named_though_the_forces_look_clipped() {
    let [kind, column, _] = named_of_columns(&[("unit = \"N\"", "unit = \"N\", gain = -1")]);
    assert_eq!((kind, column), ("sign".into(), "force_n".into()));
}

#[test]
fn wrong_units_are_named_with_the_right_ones() {
    for (column, right, wrong) in [
        ("pressure_kpa", "kPa", "psi"),
        ("pressure_kpa", "kPa", "bar"),
        ("force_n", "N", "lbf"),
        ("force_n", "N", "kgf"),
    ] {
        let replaced = [format!("unit = \"{right}\""), format!("unit = \"{wrong}\"")];
        let [kind, of, units] = named_of_columns(&[(&replaced[0], &replaced[1])]);
        assert_eq!((kind, of), ("unit".into(), column.into()), "{wrong}");
        assert_eq!(units, serde_json::json!([wrong, right]));
    }
}

#[test]
fn readings_of_a_slack_actuator_tell_nothing_and_it_is_said() {
    let bench = Bench::small_done();
    let (line, length) = set_length(&bench);
    // So short that the actuator would be slack at any pressure: what its forces then are is no gain.
    let folder = copied(
        &bench,
        &[(&line, &format!("length_mm = {}", length - 40.0))],
    );
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 2, "{found}");
    let untold = checks(&found, "not_told");
    assert!(
        untold.iter().any(|c| c["quantity"] == "specimen_gain"),
        "{found}"
    );
}

#[test]
fn a_copy_of_a_log_and_lengths_that_others_have_otherwise_are_named() {
    let bench = Bench::small_done();
    let text = std::fs::read_to_string(bench.raw().join("small/b/c50/session.toml")).unwrap();
    let line = |key: &str| {
        text.lines()
            .find(|l| l.starts_with(key))
            .unwrap()
            .to_owned()
    };
    let rest = line("rest_length_mm");
    let length: f64 = rest.split('=').nth(1).unwrap().trim().parse().unwrap();
    let log = "\n[[log]]\nfile = \"copy.csv\"\nrole = \"zero\"\n\n[columns]";
    let folder = copied(
        &bench,
        &[
            (&rest, &format!("rest_length_mm = {}", length + 3.0)),
            ("\n[columns]", log),
        ],
    );
    let folder_of = bench.root().join(&folder);
    std::fs::copy(folder_of.join("test8.csv"), folder_of.join("copy.csv")).unwrap();
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 2, "{found}");
    let copies = checks(&found, "copy");
    assert_eq!(copies.len(), 1, "{found}");
    let otherwise = checks(&found, "otherwise");
    assert_eq!(otherwise.len(), 1, "{found}");
    assert_eq!(otherwise[0]["what"], "rest_length");
    let of = |key: &str| otherwise[0][key].as_f64().unwrap();
    assert!((of("here_mm") - of("others_mm") - 3.0).abs() < 1e-6);

    let session = folder_of.join("session.toml");
    let twice = std::fs::read_to_string(&session).unwrap();
    let twice = twice.replace("\"copy.csv\"\nrole = \"zero\"", "\"copy.csv\"");
    std::fs::write(session, twice).unwrap();
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 2, "{found}");
    let refused = checks(&found, "description")[0]["message"].to_string();
    assert!(
        refused.contains("test8.csv, which is copy.csv byte for byte"),
        "{refused}"
    );
}

#[test]
fn a_session_whose_logs_are_empty_cannot_be_used() {
    let bench = Bench::small();
    let folder = copied(&bench, &[]);
    std::fs::write(bench.root().join(&folder).join("test8.csv"), "").unwrap();
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 2, "{found}");
    assert_eq!(checks(&found, "not_compared")[0]["state"], "bad");
}

#[test]
fn a_force_that_is_cut_off_where_the_actuator_pulls_most_is_seen() {
    let bench = Bench::small();
    let line = std::fs::read_to_string(bench.raw().join("small/b/c50/session.toml")).unwrap();
    let force = line.lines().find(|l| l.starts_with("force")).unwrap();
    let limit = force.split("saturation_high = ").nth(1).unwrap();
    let limit = limit.split([',', ' ', '}']).next().unwrap();
    let high = format!("saturation_high = {limit}");
    let folder = copied(&bench, &[(&high, "saturation_high = 20.0")]);
    let (_, found) = inspected(&bench, &folder);
    let clipping = checks(&found, "clipping")[0];
    assert_eq!(clipping["state"], "look", "{clipping}");
    assert!(
        clipping["at_pressure"].as_f64().unwrap() > 0.5,
        "{clipping}"
    );
}

#[test]
fn a_force_that_is_cut_off_below_the_declared_limit_is_seen() {
    let bench = Bench::small();
    let folder = copied(&bench, &[]);
    let (_, found) = inspected(&bench, &folder);
    assert!(checks(&found, "flat_top").is_empty(), "{found}");
    cut_off(&bench, "force");
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 1, "{found}");
    let flat = checks(&found, "flat_top");
    assert_eq!(flat.len(), 1, "{found}");
    assert_eq!(flat[0]["log"], "test8.csv");
}

#[test]
fn a_pressure_that_is_cut_off_is_seen_and_named() {
    let bench = Bench::small();
    let folder = copied(&bench, &[]);
    let (_, found) = inspected(&bench, &folder);
    assert!(checks(&found, "pressure_flat_top").is_empty(), "{found}");
    let limit = cut_off(&bench, "pressure");
    let (code, found) = inspected(&bench, &folder);
    assert_ne!(code, 0, "{found}");
    assert!(checks(&found, "flat_top").is_empty(), "{found}");
    let flat = checks(&found, "pressure_flat_top");
    assert_eq!(flat.len(), 1, "{found}");
    assert_eq!(flat[0]["log"], "test8.csv");
    assert!((flat[0]["at_kpa"].as_f64().unwrap() - limit).abs() < 1e-9);
    let said = bench.run(&["check-session", &folder]).out;
    let words = "the pressure stays at its highest value";
    assert!(said.contains(words), "{said}");
}

/// Cuts off a column of the log of [`copied`] at seven tenths of its range, and says where.
fn cut_off(bench: &Bench, column: &str) -> f64 {
    let path = bench.root().join("new/session.toml");
    let session: toml::Table = std::fs::read_to_string(&path).unwrap().parse().unwrap();
    let at = session["columns"][column]["index"].as_integer().unwrap() as usize;
    let log = bench.root().join("new/test8.csv");
    let rows: Vec<Vec<String>> = std::fs::read_to_string(&log)
        .unwrap()
        .lines()
        .map(|line| line.split(',').map(ToOwned::to_owned).collect())
        .collect();
    let number = |row: &Vec<String>| row[at].trim().parse::<f64>().unwrap();
    let highest = rows.iter().map(number).fold(f64::NEG_INFINITY, f64::max);
    let lowest = rows.iter().map(number).fold(f64::INFINITY, f64::min);
    let limit = lowest + 0.7 * (highest - lowest);
    let cut = rows.iter().map(|row| {
        let mut row = row.clone();
        row[at] = number(&row).min(limit).to_string();
        row.join(",") + "\n"
    });
    std::fs::write(&log, cut.collect::<String>()).unwrap();
    limit
}

#[test]
fn a_log_of_another_session_is_named_with_both_and_its_own_is_none() {
    let bench = Bench::small_done();
    let folder = copied(&bench, &[]);
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 0, "{found}");
    let original = bench.raw().join("small/a/c50");
    for log in ["test8.csv", "offset.csv"] {
        std::fs::copy(original.join(log), bench.root().join("new").join(log)).unwrap();
    }
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 2, "{found}");
    // A zero log may be shared.
    let copies = checks(&found, "copy");
    assert_eq!(copies.len(), 1, "{found}");
    assert_eq!(copies[0]["state"], "bad");
    let of = ["log", "of", "session"].map(|key| copies[0][key].as_str());
    assert_eq!(of, ["test8.csv", "test8.csv", "small-a-c50"].map(Some));
    let said = bench.run(&["check-session", &folder]).out;
    let words = "the same bytes as test8.csv of session small-a-c50";
    assert!(said.contains(words), "{said}");
    let (_, found) = inspected(&bench, "raw/small/a/c50");
    assert!(checks(&found, "copy").is_empty(), "{found}");
}

#[test]
fn exchanged_states_of_the_phase_are_bad() {
    let bench = Bench::small_done();
    let folder = copied(&bench, &[]);
    let (_, found) = inspected(&bench, &folder);
    assert!(checks(&found, "phases").is_empty(), "{found}");
    let states = |one, two| format!("{{ \"1\" = \"{one}\", \"2\" = \"{two}\" }}");
    let right = states("pressurizing", "depressurizing");
    let wrong = states("depressurizing", "pressurizing");
    let folder = copied(&bench, &[(&right, &wrong)]);
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 2, "{found}");
    let phases = checks(&found, "phases");
    assert_eq!(phases.len(), 1, "{found}");
    assert_eq!(phases[0]["state"], "bad");
    let of = |key: &str| phases[0][key].as_u64().unwrap();
    // At the highest plateau venting begins.
    assert!(of("against") + 1 >= of("steps"), "{found}");
    let said = bench.run(&["check-session", &folder]).out;
    assert!(said.contains("look exchanged in [columns]"), "{said}");
}

#[test]
fn a_session_that_its_owner_left_out_is_said_to_be() {
    let bench = Bench::small_done();
    let folder = copied(
        &bench,
        &[("campaign =", "exclude = \"bolt slipped\"\ncampaign =")],
    );
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 1, "{found}");
    assert_eq!(checks(&found, "excluded")[0]["why"], "bolt slipped");
}

#[test]
fn results_that_are_not_where_they_were_said_to_be_are_no_silent_default() {
    let bench = Bench::small();
    let folder = copied(&bench, &[]);
    let said = bench.run(&["check-session", &folder, "--derived", "elsewhere"]);
    assert_eq!(said.code, 2, "{}", said.out);
    said.warns_of(&["no results of a run in elsewhere"]);
}

#[test]
fn no_plot_is_written_beside_the_logs() {
    let bench = Bench::small();
    let folder = copied(&bench, &[]);
    let raw = bench.raw().join("plots").display().to_string();
    for plot in [folder.as_str(), &raw] {
        let said = bench.run(&["check-session", &folder, "--plot", plot]);
        assert_eq!(said.code, 2, "{plot}: {}", said.out);
        said.warns_of(&["nothing is written"]);
    }
}

#[test]
fn samples_that_are_missing_are_counted() {
    let bench = Bench::small();
    let folder = copied(&bench, &[]);
    let log = bench.root().join("new/test8.csv");
    let text = std::fs::read_to_string(&log).unwrap();
    let kept = text.lines().enumerate();
    let kept: Vec<&str> = kept
        .filter(|(k, _)| !(1000..1020).contains(k) && !(2000..2050).contains(k))
        .map(|(_, line)| line)
        .collect();
    std::fs::write(&log, kept.join("\n") + "\n").unwrap();
    let (code, found) = inspected(&bench, &folder);
    assert_eq!(code, 1, "{found}");
    let clocks = checks(&found, "clock");
    let of_log = clocks.iter().find(|c| c["log"] == "test8.csv").unwrap();
    assert_eq!(of_log["gaps"], 2, "{of_log}");
}

#[test]
fn a_folder_without_a_session_is_a_mistake_that_says_what_to_do() {
    let bench = Bench::small();
    std::fs::create_dir(bench.root().join("nothing")).unwrap();
    let said = bench.run(&["check-session", "nothing"]);
    assert_eq!(said.code, 2);
    said.warns_of(&["no session.toml in nothing", "pipeline new-session"]);
}

#[test]
fn a_log_is_checked_when_it_has_come() {
    let bench = Bench::small();
    let folder = copied(&bench, &[]);
    let log = bench.root().join("new/test8.csv");
    let offset = bench.root().join("new/offset.csv");
    let [bytes, zero] = [&log, &offset].map(|f| std::fs::read(f).unwrap());
    for file in [&log, &offset] {
        std::fs::remove_file(file).unwrap();
    }
    let comes = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(500));
        std::fs::write(&offset, zero).unwrap();
        append_slowly(&log, &bytes);
    });
    let said = bench.run(&["check-session", &folder, "--watch", "--logs", "2"]);
    comes.join().unwrap();
    let of_log = said.out.lines().find(|l| l.contains("test8.csv")).unwrap();
    assert!(of_log.starts_with("ok "), "{}", said.out);
    assert!(of_log.contains(" readings"), "{}", said.out);
}

/// Writes as a program does that records: a log that is looked at before its end would lack readings.
fn append_slowly(log: &Path, bytes: &[u8]) {
    use std::io::Write;
    let mut file = std::fs::File::create(log).unwrap();
    for part in bytes.chunks(bytes.len() / 4 + 1) {
        file.write_all(part).unwrap();
        file.flush().unwrap();
        std::thread::sleep(Duration::from_millis(600));
    }
}
