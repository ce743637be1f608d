//! Bad input: a clear message, the rest of the run goes on, nothing is lost without being counted.

use crate::support::Bench;
use std::collections::BTreeMap;

type Row = BTreeMap<String, String>;

pub const POINTS: &str = r#"schema = "bpa-session/1"
id = "points"
kind = "isometric"
sampling = "points"
campaign = "hand"

[specimen]
id = "hand-l182"
diameter_mm = 10
rest_length_mm = 182
contracted_length_mm = 152

[columns]
length = { name = "length_mm", unit = "mm" }
pressure = { name = "pressure_kpa", unit = "kPa" }
force = { name = "force_n", unit = "N" }

[[log]]
file = "points.csv"
"#;

const DATA: &str = "length_mm,pressure_kpa,force_n\n182,620,388\n182,400,230\n174,620,280\n174,500,200\n167,620,140\n167,500,90\n160,620,50\n";

/// A session with a mistake: its folder, which is its id as well unless that is what is wrong, and its files.
struct Bad {
    name: String,
    session: String,
    log: Option<Vec<u8>>,
}

/// The good session with one replacement in a file.
fn bad(name: &str, file: &str, from: &str, to: &str) -> Bad {
    let (mut session, mut data) = (POINTS.to_owned(), DATA.to_owned());
    let target = if file == "session.toml" {
        &mut session
    } else {
        &mut data
    };
    assert!(target.contains(from), "{from:?}");
    *target = target.replacen(from, to, 1);
    Bad {
        name: name.to_owned(),
        session: session.replacen("\nid = \"points\"\n", &format!("\nid = \"{name}\"\n"), 1),
        log: Some(data.into_bytes()),
    }
}

/// The good session, and beside it these.
fn beside_a_good_one(all: &[Bad]) -> Bench {
    let bench = Bench::empty();
    bench.write("good/session.toml", POINTS.replacen("points", "good", 1));
    bench.write("good/points.csv", DATA);
    for bad in all {
        bench.write(&format!("{}/session.toml", bad.name), &bad.session);
        if let Some(log) = &bad.log {
            bench.write(&format!("{}/points.csv", bad.name), log);
        }
    }
    bench
}

/// The good session with one replacement, beside an untouched one.
fn with(file: &str, from: &str, to: &str) -> Bench {
    beside_a_good_one(&[bad("bad", file, from, to)])
}

/// Runs with all these mistakes at once and expects of each messages about its files with these parts, and a line in the table of rejects; and
/// the good session used.
fn expect(all: Vec<(Bad, &[&str])>) -> Bench {
    let (bad, parts): (Vec<Bad>, Vec<&[&str]>) = all.into_iter().unzip();
    let bench = beside_a_good_one(&bad);
    let said = bench.run(&["run", "--verbose"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let (plateaus, rejects) = (bench.table("plateaus"), bench.table("rejects"));
    let good = plateaus.iter().filter(|r| r["session"] == "good");
    assert_eq!(good.count(), 7);
    for (bad, parts) in bad.iter().zip(parts) {
        let place = format!(": raw/{}/", bad.name);
        let own = said.err.lines().filter(|l| l.contains(&place));
        let own = own.collect::<Vec<&str>>().join("\n");
        for part in parts {
            assert!(
                own.contains(part),
                "{part:?} is not in {own:?} of\n{}",
                said.err
            );
        }
        let is_counted = rejects.iter().any(|r| r["session"] == bad.name);
        assert!(is_counted, "{} is not in {rejects:?}", bad.name);
    }
    bench
}

#[test]
fn mistakes_in_session_toml_name_line_key_found_expected_and_hint() {
    let cases: [(&str, &str, &'static [&'static str]); 21] = [
        (
            "schema = \"bpa-session/1\"\n",
            "",
            &[
                "/session.toml:1 [schema]",
                "found nothing",
                "write schema = \"bpa-session/1\"",
            ],
        ),
        (
            "kind = \"isometric\"",
            "kind = \"isometrik\"",
            &["/session.toml:3 [kind]", "did you mean \"isometric\"?"],
        ),
        (
            "campaign = \"hand\"\n",
            "",
            &["[campaign]", "found nothing"],
        ),
        (
            "campaign = \"hand\"",
            "campain = \"hand\"",
            &[":5 [campain]", "did you mean `campaign`?"],
        ),
        (
            "diameter_mm = 10",
            "diameter_mm = 0.01",
            &[":9 [specimen.diameter_mm]", "found 0.01", "1 to 100"],
        ),
        (
            "rest_length_mm = 182",
            "rest_length_mm = -182",
            &["found -182", "positive", "hose clamps"],
        ),
        (
            "rest_length_mm = 182",
            "rest_length_mm = \"182\"",
            &["found \"182\"", "a finite number"],
        ),
        (
            "rest_length_mm = 182",
            "rest_length_mm = nan",
            &["a finite number"],
        ),
        (
            "contracted_length_mm = 152",
            "contracted_length_mm = 190",
            &["found 190", "below rest_length_mm", "swapped"],
        ),
        (
            "unit = \"kPa\"",
            "unit = \"kpa\"",
            &[":15", "found \"kpa\"", "did you mean \"kPa\"?"],
        ),
        (
            "unit = \"kPa\"",
            "unit = \"mm\"",
            &["found \"mm\"", "kPa, Pa, MPa, bar, psi"],
        ),
        (", unit = \"kPa\"", "", &["[columns.pressure]", "add `unit"]),
        (
            "name = \"force_n\"",
            "index = 2",
            &["by `index`", "by `name`"],
        ),
        (
            "file = \"points.csv\"",
            "file = \"../points.csv\"",
            &["found \"../points.csv\"", "below the session's folder"],
        ),
        (
            "[[log]]\nfile = \"points.csv\"\n",
            "",
            &["[log]", "at least one"],
        ),
        ("force = {", "forze = {", &["the column `force`"]),
        (
            "schema = \"bpa-session/1\"",
            "schema = \"bpa-session/9\"",
            &["bpa-session/1"],
        ),
        (
            "name = \"force_n\"",
            "name = \"pressure_kpa\"",
            &["[columns.force]", "not that of pressure_kpa"],
        ),
        (
            "unit = \"N\"",
            "unit = \"N\", saturation_low = 5, saturation_high = -5",
            &["below `saturation_high`", "exchange them"],
        ),
        (
            "campaign = \"hand\"",
            "campaign = \"hand\"\nexclude = \"\"",
            &[":6 [exclude]", "the reason why"],
        ),
        (
            "id = \"points\"",
            "id = \"points",
            &["/session.toml:2", "a closing quote"],
        ),
    ];
    let numbered = cases.into_iter().enumerate();
    let one = |(k, (from, to, parts)): (usize, (&str, &str, &'static [&'static str]))| {
        (bad(&format!("bad-{k:02}"), "session.toml", from, to), parts)
    };
    expect(numbered.map(one).collect());
}

#[test]
fn all_mistakes_of_a_file_are_reported_at_once() {
    let to = "rest_length_mm = -182\ncolour = \"red\"";
    let twice = bad("bad", "session.toml", "rest_length_mm = 182", to);
    expect(vec![(twice, &["found -182", "[specimen.colour]"])]);
}

#[test]
fn a_bad_cell_costs_its_row_and_is_quoted_with_its_place() {
    let cases: [(&str, &str, &[&str]); 4] = [
        (
            "no-number",
            "182,abc,388",
            &["/points.csv:2", "\"abc\"", "a finite number"],
        ),
        (
            "empty",
            "182,,388",
            &["/points.csv:2", "an empty field", "a finite number"],
        ),
        (
            "nan",
            "182,NaN,388",
            &["/points.csv:2", "\"NaN\"", "a finite number"],
        ),
        (
            "infinite",
            "182,620,inf",
            &["/points.csv:2", "\"inf\"", "a finite number"],
        ),
    ];
    let one = |(name, to, parts)| (bad(name, "points.csv", "182,620,388", to), parts);
    let bench = expect(cases.into_iter().map(one).collect());
    let plateaus = bench.table("plateaus");
    for (name, ..) in cases {
        let left = plateaus.iter().filter(|r| r["session"] == name);
        assert_eq!(left.count(), 6, "{name}");
    }
}

#[test]
fn unreadable_logs_are_left_out_with_their_reason() {
    type Case = (&'static str, Option<&'static [u8]>, &'static [&'static str]);
    let cases: [Case; 6] = [
        ("empty", Some(b""), &["/points.csv", "an empty file"]),
        (
            "header",
            Some(b"length_mm,pressure_kpa,force_n\n"),
            &["a header and no rows"],
        ),
        (
            "narrow",
            Some(b"length_mm,pressure_kpa\n182,620\n"),
            &["a column named \"force_n\"", "length_mm, pressure_kpa"],
        ),
        (
            "bytes",
            Some(b"length_mm,pressure_kpa,force_n\n182,\xff\xfe,3\n"),
            &["/points.csv:2", "not UTF-8"],
        ),
        ("wide", Some(&[b'1'; 1 << 20]), &["a line of more than"]),
        ("missing", None, &["/points.csv", "no such file"]),
    ];
    let one = |(name, log, parts): Case| {
        let sound = bad(name, "points.csv", "182,620,388", "182,620,388");
        let log = log.map(<[u8]>::to_vec);
        (Bad { log, ..sound }, parts)
    };
    let bench = expect(cases.into_iter().map(one).collect());
    let rejects = bench.table("rejects");
    for (name, ..) in cases {
        for (extent, log) in [("log", "points.csv"), ("session", "")] {
            let is = |r: &Row| r["session"] == name && r["extent"] == extent && r["log"] == log;
            assert!(rejects.iter().any(is), "{name} {extent}: {rejects:?}");
        }
    }
}

#[test]
fn a_line_of_a_gigabyte_is_refused_without_being_held_in_memory() {
    let bench = with("points.csv", "182,620,388", "182,620,388");
    let log = std::fs::File::create(bench.raw().join("bad/points.csv")).unwrap();
    log.set_len(1 << 30).unwrap();
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    said.warns_of(&["bad/points.csv:1", "a line of more than"]);
    let rejects = bench.table("rejects");
    assert!(rejects.iter().any(|r| r["session"] == "bad"), "{rejects:?}");
}

#[test]
fn impossible_values_are_left_out_and_counted() {
    let bench = beside_a_good_one(&[
        bad("pressure", "points.csv", "182,620,388", "182,53152,388"),
        bad("length", "points.csv", "182,620,388", "-182,620,388"),
    ]);
    assert_eq!(bench.run(&["run"]).code, 0);
    let rejects = bench.table("rejects");
    for (session, reason) in [
        ("pressure", "pressure outside"),
        ("length", "length that is not positive"),
    ] {
        let is = |r: &&Row| r["session"] == session && r["reason"].contains(reason);
        let found = rejects.iter().find(is);
        let found = found.unwrap_or_else(|| panic!("{session}: {rejects:?}"));
        assert_eq!(
            (found["first_row"].as_str(), found["count"].as_str()),
            ("2", "1")
        );
    }
}

#[test]
fn duplicate_ids_keep_the_first_and_name_both() {
    let mut same = bad("late", "session.toml", "182", "182");
    same.session = same.session.replacen("\"late\"", "\"good\"", 1);
    let bench = beside_a_good_one(&[same]);
    let said = bench.run(&["run"]);
    said.warns_of(&["late/session.toml:2 [id]", "good/session.toml"]);
    assert_eq!(bench.table("plateaus").len(), 7);
    let rejects = bench.table("rejects");
    let sessions: Vec<&str> = rejects.iter().map(|r| r["session"].as_str()).collect();
    assert_eq!(sessions, ["late"], "the good session keeps its name");
    let summary = std::fs::read(bench.root().join("reports/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
    assert_eq!(summary["sessions_used"][0]["id"], "good");
    assert_eq!(summary["sessions_rejected"][0]["session"], "late");
}

#[test]
fn one_log_under_two_sessions_is_refused_with_both_named() {
    let twin = bad("twin", "session.toml", "182", "182");
    let bench = beside_a_good_one(&[twin]);
    let said = bench.run(&["run"]);
    said.warns_of(&[
        "twin/session.toml:19 [log]",
        "good/points.csv byte for byte",
    ]);
    assert_eq!(bench.table("plateaus").len(), 7);
}

#[test]
fn a_copy_of_a_log_in_its_session_is_refused_with_its_line() {
    let copied = with("points.csv", "182,620,388", "182,620,389");
    let log = std::fs::read(copied.raw().join("bad/points.csv")).unwrap();
    copied.write("bad/copy.csv", log);
    let named = format!(
        "{}\n[[log]]\nfile = \"copy.csv\"\n",
        POINTS.replacen("points", "bad", 1)
    );
    copied.write("bad/session.toml", named);
    let said = copied.run(&["run"]);
    said.warns_of(&[
        "bad/session.toml:22 [log]",
        "found copy.csv, which is points.csv byte for byte",
        "a log that is named once",
    ]);
    assert_eq!(copied.table("plateaus").len(), 7, "the good session's");
}

#[test]
fn logs_that_no_session_names_are_told_and_other_files_are_not() {
    let bench = with("points.csv", "182,620,388", "182,620,389");
    for name in ["run2.csv", "run3.txt", "run4", "run5.dat"] {
        bench.write(&format!("bad/{name}"), DATA.replace(',', "\t"));
    }
    bench.write("alone/l200.csv", DATA);
    bench.write(
        "alone/notes.txt",
        "hung up at 12:30\nlength 200, 180 and 160 mm\n",
    );
    bench.write("good/README.md", "Measured by hand.\n");
    bench.write("good/.points.csv.swp", DATA);
    bench.write("broken/session.toml", "id = ");
    bench.write("broken/points.csv", DATA);
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    said.warns_of(&[
        "raw/bad: found run2.csv, run3.txt, run4 and 1 more, which no session names",
        "add a [[log]] for each to session.toml",
        "raw/alone: found l200.csv, which no session names",
        "`pipeline new-session` drafts one",
    ]);
    for quiet in [
        "notes.txt",
        "README.md",
        ".swp",
        "broken/points.csv",
        "raw/good",
    ] {
        assert!(!said.err.contains(quiet), "{quiet} is in\n{}", said.err);
    }
}

#[cfg(unix)]
#[test]
fn a_loop_of_links_is_reported_and_not_entered() {
    let bench = with("points.csv", "182,620,388", "182,620,389");
    std::os::unix::fs::symlink("..", bench.raw().join("good/loop")).unwrap();
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0);
    said.warns_of(&["a link to a folder above itself"]);
    assert_eq!(bench.table("plateaus").len(), 14);
}

#[cfg(unix)]
#[test]
fn an_unreadable_folder_is_reported_and_the_rest_is_used() {
    let bench = with("points.csv", "182,620,388", "182,620,388");
    bench.set_mode("", 0o777);
    bench.set_mode("raw/bad", 0o000);
    let said = bench.run_unprivileged(&["run"]);
    bench.set_mode("raw/bad", 0o755);
    assert_eq!(said.code, 0, "{}", said.err);
    said.warns_of(&["a readable file or folder"]);
    assert_eq!(bench.table("plateaus").len(), 7);
}

#[test]
fn a_run_without_any_usable_session_is_no_success() {
    let bench = Bench::empty();
    bench.write("bad/session.toml", "schema = 1\n");
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 2, "{}{}", said.out, said.err);
    said.warns_of(&["bad/session.toml"]);
}

#[test]
fn a_run_of_which_every_session_is_excluded_is_no_success_and_says_why() {
    let bench = Bench::small();
    for file in crate::support::files(&bench.raw()) {
        if file.ends_with("session.toml") {
            let text = std::fs::read_to_string(&file).unwrap();
            let text = text.replacen(
                "\n[specimen]",
                "exclude = \"the bolt slipped\"\n\n[specimen]",
                1,
            );
            std::fs::write(&file, text).unwrap();
        }
    }
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 2, "{}{}", said.out, said.err);
    for part in ["6 of 6 sessions", "the bolt slipped"] {
        assert!(said.out.contains(part), "{part}: {}", said.out);
    }
    assert!(bench.root().join("reports/force.pdf").exists());
}

#[test]
fn a_session_or_log_that_is_left_out_is_said_once() {
    let no_steady_reading = bad(
        "slack",
        "points.csv",
        DATA,
        "length_mm,pressure_kpa,force_n\n1,620,3\n",
    );
    let misspelt = bad("misspelt", "session.toml", "kind =", "kin =");
    let bench = beside_a_good_one(&[no_steady_reading, misspelt]);
    let said = bench.run(&["run"]);
    let all = said.out + &said.err;
    let of = |name: &str| all.lines().filter(|l| l.contains(name)).count();
    assert_eq!(of("slack"), 1, "{all}");
    // One line for the key that is missing and one for that which is unknown.
    assert_eq!(of("misspelt"), 2, "{all}");
    assert!(all.contains("2 of 3 sessions"), "{all}");
}

#[test]
fn lengths_in_metres_are_refused_with_the_key_line_and_remedy() {
    let rest = bad(
        "rest",
        "session.toml",
        "rest_length_mm = 182",
        "rest_length_mm = 0.182",
    );
    let held = "[setup]\nlength_mm = 0.182\n\n[columns]";
    let held = bad(
        "held",
        "session.toml",
        "[columns]\nlength = { name = \"length_mm\", unit = \"mm\" }",
        held,
    );
    expect(vec![
        (
            rest,
            &[
                "/session.toml:10 [specimen.rest_length_mm]",
                "`rest_length_mm = 182`",
            ],
        ),
        (
            held,
            &[
                "/session.toml:14 [setup.length_mm]",
                "found 0.182 mm",
                "specimen of 182 mm",
            ],
        ),
    ]);
    let logged = with("session.toml", "unit = \"mm\"", "unit = \"m\"");
    let said = logged.run(&["run"]);
    for part in ["session bad", "182000.000 mm", "unit of the length"] {
        assert!(said.out.contains(part), "{part}: {}", said.out);
    }
}
