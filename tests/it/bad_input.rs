//! Bad input: a clear message, the rest of the run goes on, nothing is lost without being counted.

use crate::support::Bench;

const POINTS: &str = r#"schema = "bpa-session/1"
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

/// The good session with one replacement, beside an untouched one.
fn with(file: &str, from: &str, to: &str) -> Bench {
    let bench = Bench::empty();
    bench.write(
        "good/session.toml",
        POINTS.replace("\"points\"\nkind", "\"good\"\nkind"),
    );
    bench.write("good/points.csv", DATA);
    let (mut session, mut data) = (POINTS.to_owned(), DATA.to_owned());
    let target = if file == "session.toml" {
        &mut session
    } else {
        &mut data
    };
    assert!(target.contains(from), "{from:?}");
    *target = target.replacen(from, to, 1);
    bench.write("bad/session.toml", session);
    bench.write("bad/points.csv", data);
    bench
}

/// Runs and expects a message with these parts, the good session used, and a reject in the table.
fn expect(bench: &Bench, parts: &[&str]) {
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    for part in parts {
        assert!(said.err.contains(part), "{part:?} is not in\n{}", said.err);
    }
    let plateaus = bench.table("plateaus");
    assert_eq!(
        plateaus.iter().filter(|r| r["session"] == "good").count(),
        7
    );
    let rejects = bench.table("rejects");
    assert!(
        rejects
            .iter()
            .any(|r| r["session"] == "points" || r["session"] == "bad"),
        "{rejects:?}"
    );
}

#[test]
fn mistakes_in_session_toml_name_line_key_found_expected_and_hint() {
    let cases: [(&str, &str, &[&str]); 20] = [
        (
            "kind = \"isometric\"",
            "kind = \"isometrik\"",
            &["bad/session.toml:3 [kind]", "did you mean \"isometric\"?"],
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
            "diameter_mm = 15",
            &[":9 [specimen.diameter_mm]", "found 15", "10, 20 or 40"],
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
            &["bad/session.toml:2", "valid TOML"],
        ),
    ];
    for (from, to, parts) in cases {
        expect(&with("session.toml", from, to), parts);
    }
}

#[test]
fn all_mistakes_of_a_file_are_reported_at_once() {
    let bench = with(
        "session.toml",
        "rest_length_mm = 182",
        "rest_length_mm = -182\ncolour = \"red\"",
    );
    expect(&bench, &["found -182", "[specimen.colour]"]);
}

#[test]
fn a_bad_cell_costs_its_row_and_is_quoted_with_its_place() {
    for (to, quoted) in [
        ("182,abc,388", "\"abc\""),
        ("182,,388", "an empty field"),
        ("182,NaN,388", "\"NaN\""),
        ("182,620,inf", "\"inf\""),
    ] {
        let bench = with("points.csv", "182,620,388", to);
        expect(&bench, &["bad/points.csv:2", quoted, "a finite number"]);
        let left = bench
            .table("plateaus")
            .iter()
            .filter(|r| r["session"] == "points")
            .count();
        assert_eq!(left, 6, "{to}");
    }
}

#[test]
fn unreadable_logs_are_left_out_with_their_reason() {
    let replace = |contents: &[u8]| {
        let bench = with("points.csv", "182,620,388", "182,620,388");
        bench.write("bad/points.csv", contents);
        bench
    };
    expect(&replace(b""), &["bad/points.csv", "an empty file"]);
    expect(
        &replace(b"length_mm,pressure_kpa,force_n\n"),
        &["a header and no rows"],
    );
    expect(
        &replace(b"length_mm,pressure_kpa\n182,620\n"),
        &["a column named \"force_n\"", "length_mm, pressure_kpa"],
    );
    expect(
        &replace(b"length_mm,pressure_kpa,force_n\n182,\xff\xfe,3\n"),
        &["points.csv:2", "not UTF-8"],
    );
    expect(&replace(&[b'1'; 1 << 20]), &["a line of more than"]);
    let missing = with("points.csv", "182,620,388", "182,620,388");
    std::fs::remove_file(missing.raw().join("bad/points.csv")).unwrap();
    expect(&missing, &["bad/points.csv", "no such file"]);
    let rejects = missing.table("rejects");
    assert!(
        rejects
            .iter()
            .any(|r| r["extent"] == "log" && r["log"] == "points.csv"),
        "{rejects:?}"
    );
    assert!(
        rejects
            .iter()
            .any(|r| r["extent"] == "session" && r["session"] == "points"),
        "{rejects:?}"
    );
}

#[test]
fn a_line_of_a_gigabyte_is_refused_without_being_held_in_memory() {
    let bench = with("points.csv", "182,620,388", "182,620,388");
    let log = std::fs::File::create(bench.raw().join("bad/points.csv")).unwrap();
    log.set_len(1 << 30).unwrap();
    expect(&bench, &["bad/points.csv:1", "a line of more than"]);
}

#[test]
fn impossible_values_are_left_out_and_counted() {
    let bench = with("points.csv", "182,620,388", "182,53152,388");
    bench.run(&["run"]);
    let rejects = bench.table("rejects");
    assert!(
        rejects
            .iter()
            .any(|r| r["reason"].contains("pressure outside")
                && r["first_row"] == "2"
                && r["count"] == "1")
    );
    let bench = with("points.csv", "182,620,388", "-182,620,388");
    bench.run(&["run"]);
    assert!(
        bench
            .table("rejects")
            .iter()
            .any(|r| r["reason"].contains("length that is not positive"))
    );
}

#[test]
fn duplicate_ids_keep_the_first_and_name_both() {
    let bench = with("session.toml", "id = \"points\"", "id = \"good\"");
    let said = bench.run(&["run"]);
    assert!(
        said.err.contains("good/session.toml [id]") && said.err.contains("bad/session.toml"),
        "{}",
        said.err
    );
    assert_eq!(bench.table("plateaus").len(), 7);
}

#[cfg(unix)]
#[test]
fn a_loop_of_links_is_reported_and_not_entered() {
    let bench = with("points.csv", "182,620,388", "182,620,388");
    std::os::unix::fs::symlink("..", bench.raw().join("good/loop")).unwrap();
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0);
    assert!(
        said.err.contains("a link to a folder above itself"),
        "{}",
        said.err
    );
    assert_eq!(bench.table("plateaus").len(), 14);
}

#[cfg(unix)]
#[test]
fn an_unreadable_folder_is_reported_and_the_rest_is_used() {
    use std::os::unix::fs::PermissionsExt;
    let bench = with("points.csv", "182,620,388", "182,620,388");
    let locked = bench.raw().join("bad");
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o000)).unwrap();
    if std::fs::read_dir(&locked).is_ok() {
        println!("skipped the unreadable folder: this user may read everything");
        return;
    }
    let said = bench.run(&["run"]);
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o755)).unwrap();
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(
        said.err.contains("a readable file or folder"),
        "{}",
        said.err
    );
    assert_eq!(bench.table("plateaus").len(), 7);
}

#[test]
fn a_run_without_any_usable_session_is_no_success() {
    let bench = Bench::empty();
    bench.write("bad/session.toml", "schema = 1\n");
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 2, "{}{}", said.out, said.err);
    assert!(said.err.contains("bad/session.toml"), "{}", said.err);
}

#[test]
fn a_campaign_of_which_every_session_is_excluded_stops_nothing() {
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
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
}
