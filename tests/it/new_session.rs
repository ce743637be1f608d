//! A look at a log that nobody has described: the guess, the files, and a run with what it wrote.

use crate::formats::fixture;
use crate::support::Bench;
use serde_json::Value;

/// The lines that a person fills in, for the simulated specimen of the small campaign.
fn corrected(session: &str) -> String {
    session
        .lines()
        .map(|line| match line.split(" = ").next() {
            Some("rest_length_mm") => "rest_length_mm = 112".to_owned(),
            Some("contracted_length_mm") => "contracted_length_mm = 94.08".to_owned(),
            Some("length_mm") => "length_mm = 112".to_owned(),
            _ => line.replace("FILL IN", ""),
        })
        .collect::<Vec<String>>()
        .join("\n")
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

#[test]
fn what_it_writes_is_read_back_and_once_corrected_runs() {
    let bench = Bench::small();
    let before = bench.snapshot("raw");
    let log = before
        .keys()
        .find(|f| f.ends_with("test8.csv"))
        .expect("a log")
        .clone();
    let said = bench.run(&[
        "new-session",
        &format!("raw/{log}"),
        "--out",
        "look",
        "--json",
    ]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!(
        bench.snapshot("raw"),
        before,
        "nothing below raw/ is written"
    );
    let said = json(&said.out);
    assert_eq!(
        (said["sampling"].as_str(), said["rows"].as_u64()),
        (Some("timeseries"), Some(4000))
    );
    let quantities: Vec<&str> = said["columns"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|c| c["quantity"].as_str())
        .collect();
    assert_eq!(quantities, ["force", "pressure", "time", "phase"]);
    let look = bench.snapshot("look");
    assert!(look["log.svg"].starts_with(b"<") && look["log.png"].starts_with(b"\x89PNG"));
    let session = String::from_utf8(look["session.toml"].clone()).unwrap();
    let run = Bench::empty();
    run.write("new/session.toml", &session);
    run.write("new/test8.csv", &before[&log]);
    let said = run.run(&["run"]);
    assert_eq!(
        said.code, 2,
        "what is still to be filled in keeps the session out"
    );
    for (k, line) in session
        .lines()
        .enumerate()
        .filter(|(_, l)| l.contains("FILL IN"))
    {
        let place = format!("new/session.toml:{}", k + 1);
        assert!(said.err.contains(&place), "{place}: {line}: {}", said.err);
    }
    run.write("new/session.toml", corrected(&session));
    let said = run.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(run.table("plateaus").len() > 10, "{}", said.err);
}

#[test]
fn nothing_is_overwritten_without_force() {
    let bench = Bench::empty();
    bench.write("points.csv", fixture("points.csv"));
    let look = ["new-session", "raw/points.csv"];
    assert_eq!(bench.run(&look).code, 0);
    let session = bench.root().join("points/session.toml");
    std::fs::write(&session, "mine").unwrap();
    let said = bench.run(&look);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("--force"), "{}", said.err);
    assert_eq!(std::fs::read_to_string(&session).unwrap(), "mine");
    assert_eq!(
        bench
            .run(&["new-session", "raw/points.csv", "--force"])
            .code,
        0
    );
}

#[test]
fn logs_of_one_name_become_sessions_of_their_own() {
    let bench = Bench::empty();
    let log = |force: u32| format!("p (kPa),F (N),l (mm)\n620,{force},182\n400,90,170\n");
    for (folder, force) in [("a", 300), ("b", 310)] {
        std::fs::create_dir(bench.root().join(folder)).unwrap();
        std::fs::write(bench.root().join(folder).join("test8.csv"), log(force)).unwrap();
    }
    let look = |rest: &[&str]| bench.run(&[&["new-session"], rest].concat());
    let said = look(&[
        "a/test8.csv",
        "b/test8.csv",
        "--out",
        "raw",
        "--copy",
        "--force",
    ]);
    assert_eq!(said.code, 0, "{}", said.err);
    for (folder, force) in [("a", 300), ("b", 310)] {
        let copy = bench.raw().join(format!("{folder}-test8/test8.csv"));
        assert_eq!(std::fs::read_to_string(copy).unwrap(), log(force));
        // One log a call.
        let (file, out) = (format!("{folder}/test8.csv"), format!("raw/{folder}/c00"));
        let said = look(&[&file, "--out", &out]);
        assert_eq!(said.code, 0, "{}", said.err);
    }
    let said = look(&["b/test8.csv", "--out", "raw/a-test8", "--copy", "--force"]);
    assert_eq!(said.code, 2, "a log is never replaced: {}", said.out);
    let sessions = bench.snapshot("raw").into_iter();
    let sessions = sessions.filter(|(name, _)| name.ends_with("session.toml"));
    let id = |(_, text): (String, Vec<u8>)| {
        let text: toml::Table = toml::from_slice(&text).unwrap();
        text["id"].as_str().unwrap().to_owned()
    };
    let ids: Vec<String> = sessions.map(id).collect();
    assert_eq!(ids, ["a-test8", "a-c00", "b-test8", "b-c00"]);
}

#[test]
fn a_clash_within_one_call_is_refused_before_anything_is_written() {
    let bench = Bench::empty();
    let log = "p (kPa),F (N),l (mm)\n620,300,182\n400,90,170\n";
    for name in ["test8.csv", "test8.txt", "test9.csv"] {
        std::fs::write(bench.root().join(name), log).unwrap();
    }
    let twice = ["new-session", "test9.csv", "test8.csv", "test8.txt"];
    let said = bench.run(&[&twice[..], &["--out", "raw", "--force"]].concat());
    assert_eq!(said.code, 2, "{}", said.out);
    said.warns_of(&[
        "test8.csv",
        "test8.txt",
        "session test8",
        "nothing was written",
    ]);
    assert!(bench.snapshot("raw").is_empty());
    bench.write("test8/session.toml", "mine");
    let said = bench.run(&["new-session", "test9.csv", "test8.csv", "--out", "raw"]);
    assert_eq!(said.code, 2, "{}", said.out);
    assert_eq!(bench.snapshot("raw").len(), 1);
}

#[test]
fn every_format_gives_the_same_guess() {
    let bench = Bench::empty();
    let guess = |file: &str, part: &[&str]| {
        bench.write(file, fixture(file));
        let path = format!("raw/{file}");
        let arguments = [&["new-session", &path, "--out", file, "--json"], part].concat();
        let said = bench.run(&arguments);
        assert_eq!(said.code, 0, "{file}: {}", said.err);
        json(&said.out)["columns"].clone()
    };
    let reference = guess("points.csv", &[]);
    let units: Vec<&str> = reference
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|c| c["unit"].as_str())
        .collect();
    assert_eq!(units, ["mm", "kPa", "N"]);
    for (file, part) in [
        ("semicolon.csv.gz", &[][..]),
        ("tab.txt", &[]),
        ("workbook.xlsx", &["--sheet", "Run 8"]),
        ("vectors.mat", &[]),
        ("structure.mat", &["--variable", "log"]),
        ("frame.parquet", &[]),
    ] {
        assert_eq!(guess(file, part), reference, "{file}");
    }
}

#[test]
fn a_file_that_is_no_log_is_refused_with_what_to_do() {
    let bench = Bench::empty();
    bench.write("log", [0xfe_u8; 100]);
    let said = bench.run(&["new-session", "raw/log"]);
    assert_eq!(said.code, 2);
    assert!(
        said.err.contains("expected") && !bench.root().join("log").exists(),
        "{}",
        said.err
    );
}

#[test]
fn many_logs_at_once_become_sessions_and_a_campaign_says_once_what_they_have_in_common() {
    let bench = Bench::empty();
    let log = |force: u32| {
        format!("p (kPa),F (N),l (mm)\n620,{force},182\n500,{force},180\n400,90,170\n")
    };
    for (name, force) in [("a.csv", 300), ("b.csv", 310)] {
        std::fs::write(bench.root().join(name), log(force)).unwrap();
    }
    let said = bench.run(&["new-session", "a.csv", "b.csv", "--out", "raw", "--copy"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!(said.out.lines().count(), 2, "a line a log: {}", said.out);
    bench.write(
        "campaign.toml",
        "schema = \"bpa-campaign/1\"\nkind = \"isometric\"\nsampling = \"points\"\ncampaign = \"two\"\n\n[specimen]\nid = \"l182\"\ndiameter_mm = 10\n\
         rest_length_mm = 182\ncontracted_length_mm = 152\n\n[columns]\nforce = { name = \"F (N)\", unit = \"N\" }\n\
         pressure = { name = \"p (kPa)\", unit = \"kPa\" }\nlength = { name = \"l (mm)\", unit = \"mm\" }\n",
    );
    let own = |id: &str, more: &str| {
        format!("schema = \"bpa-session/1\"\nid = \"{id}\"\n{more}\n[[log]]\nfile = \"{id}.csv\"\n")
    };
    bench.write("a/session.toml", own("a", ""));
    // Another rest length, and the pressure in another column: the rest is the campaign's.
    let pressure = "[specimen]\nid = \"l190\"\nrest_length_mm = 190\n[columns]\npressure = { name = \"F (N)\", unit = \"kPa\" }\nforce = { name = \"p (kPa)\", unit = \"N\" }";
    bench.write("b/session.toml", own("b", pressure));
    bench.age();
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let sessions = bench.table("sessions");
    let of = |column: &str| {
        sessions
            .iter()
            .map(|s| s[column].clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(of("session"), ["a", "b"]);
    assert_eq!(of("campaign"), ["two", "two"]);
    let lengths: Vec<f64> = of("rest_length_mm")
        .iter()
        .map(|l| l.parse().unwrap())
        .collect();
    assert!((lengths[0] - 182.0).abs() < 1e-9 && (lengths[1] - 190.0).abs() < 1e-9);
    let rows = bench.table("plateaus");
    let force =
        |session: &str| rows.iter().find(|r| r["session"] == session).unwrap()["force_n"].clone();
    assert_eq!((force("a").as_str(), force("b").as_str()), ("300", "620"));
    assert_eq!(bench.run(&["status"]).code, 0);
    let explained = bench.run(&["explain", "force.pdf", "--verbose"]).out;
    assert!(explained.contains("campaign.toml"), "{explained}");
    // A change of the campaign is one of its sessions; a mistake in it is said once, with its place.
    let campaign = std::fs::read_to_string(bench.raw().join("campaign.toml")).unwrap();
    bench.write(
        "campaign.toml",
        campaign.replace("contracted_length_mm = 152", "contracted_length_mm = 150"),
    );
    assert!(bench.run(&["status"]).out.contains("ingest b"));
    bench.write(
        "campaign.toml",
        campaign.replace("diameter_mm", "diamter_mm"),
    );
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 2);
    let place = "campaign.toml:8 [specimen.diamter_mm]";
    assert_eq!(said.err.matches(place).count(), 1, "{}", said.err);
}

#[test]
fn a_log_with_a_preamble_in_latin_1_is_drafted_and_run() {
    let bench = Bench::empty();
    let head = b"Pr\xfcfstand 2\nBediener: J\xe4ger\nDruck (kPa);Kraft (N);L\xe4nge (mm)\n";
    let rows = b"620;388,5;182\n500;200,5;174\n400;90,1;170\n";
    std::fs::write(bench.root().join("old.txt"), [&head[..], rows].concat()).unwrap();
    let look = ["new-session", "old.txt", "--out", "raw/old", "--copy"];
    let said = bench.run(&look);
    said.warns_of(&["give --encoding latin-1"]);
    assert!(!said.err.contains("[format]"), "{}", said.err);
    let options = ["--skip-rows", "2", "--encoding", "latin-1"];
    let said = bench.run(&[&look[..], &options].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    let file = bench.raw().join("old/session.toml");
    let session = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, session.replace("FILL IN", "")).unwrap();
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert_eq!(bench.table("plateaus")[0]["force_n"], "388.5");
}

#[test]
fn what_is_to_be_filled_in_is_said_in_sentences() {
    let bench = Bench::empty();
    std::fs::write(bench.root().join("two.csv"), "1,2\n3,4\n").unwrap();
    let row = |k: u32| {
        format!(
            "{},{},{}\n",
            f64::from(k) * 0.01,
            3 * k % 400,
            5 * (k % 124)
        )
    };
    let log: String = (0..300).map(row).collect();
    std::fs::write(bench.root().join("three.csv"), log).unwrap();
    let look = [
        "new-session",
        "two.csv",
        "three.csv",
        "--out",
        "raw",
        "--copy",
    ];
    assert_eq!(bench.run(&look).code, 0);
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 2, "{}", said.out);
    assert!(!said.err.contains("[]"), "{}", said.err);
    let units = "kPa, Pa, MPa, bar, psi";
    said.warns_of(&[
        "[pressure]: found FILL IN; expected the column of the pressure with its unit",
        &format!("one of {units} (none looks like it); correct the line"),
        "[pressure]: found FILL IN; expected a quantity and unit that you have confirmed (guessed: it ends near the 620 kPa",
        "[length_mm]: found FILL IN; expected the length at which the actuator was held (no column looks like one); correct the line",
        "[id]: found FILL IN; expected the name of the physical actuator, the same in all of its sessions; correct the line",
        "error: raw/two/session.toml:7 [campaign]",
    ]);
    let said = bench.run(&["check-session", "raw/two"]);
    assert!(
        said.out
            .contains("error: raw/two/session.toml:7 [campaign]"),
        "{}",
        said.out
    );
}

#[test]
fn a_quantity_that_rests_on_the_size_of_numbers_is_left_to_a_person() {
    let bench = Bench::empty();
    // Without a header: the clock, a force, and two columns that may both be a pressure: one is the voltage of a laser.
    let row = |k: u32| {
        format!(
            "{},{},{},{}\n",
            f64::from(k) * 0.01,
            3 * k % 400,
            5 * (k % 124),
            600 + k % 7
        )
    };
    let log: String = (0..300).map(row).collect();
    bench.write("rig.csv", log);
    assert_eq!(bench.run(&["new-session", "raw/rig.csv"]).code, 0);
    let session = std::fs::read_to_string(bench.root().join("rig/session.toml")).unwrap();
    let line = |name: &str| {
        session
            .lines()
            .find(|l| l.starts_with(&format!("{name} = ")))
            .unwrap()
            .to_owned()
    };
    assert!(line("pressure").contains("FILL IN") && line("force").contains("FILL IN"));
    assert!(!line("time").contains("FILL IN"), "{}", line("time"));
}
