//! Declared uncertainties of lengths: read, refused, carried to rows and tidy data, and nothing where none was declared.

use crate::support::Bench;
use pipeline::base::frame::Frame;
use pipeline::base::normalized::row;
use pipeline::base::reading::Reading;
use pipeline::base::session::Session;
use pipeline::formats::discover::discover;
use pipeline::formats::session_toml;
use std::collections::BTreeMap;

const FORCE: &str = r#"schema = "bpa-session/1"
id = "held"
kind = "isometric"
sampling = "points"
campaign = "hand"

[specimen]
id = "l182"
diameter_mm = 10
rest_length_mm = 182
contracted_length_mm = 152

[setup]
length_mm = 174.5
humidity = 40

[columns]
pressure = { index = 0, unit = "kPa" }
force = { index = 1, unit = "N" }

[[log]]
file = "points.csv"
"#;

const TORQUE: &str = r#"schema = "bpa-session/1"
id = "knee"
kind = "knee-torque"
sampling = "points"
campaign = "knee"

[specimen]
id = "l485"
diameter_mm = 10
rest_length_mm = 485
contracted_length_mm = 398

[joint]
knee = "pinned"
muscle = "flexor"
tendon_mm = 0

[columns]
angle = { index = 0, unit = "deg" }
torque = { index = 1, unit = "N.m" }
muscle_length = { index = 2, unit = "mm" }
moment_arm = { index = 3, unit = "mm" }
pressure = { index = 4, unit = "kPa" }

[[log]]
file = "points.csv"
"#;

/// The text with lines added at the end of a table.
fn with(text: &str, table: &str, lines: &str) -> String {
    let head = format!("[{table}]\n");
    assert!(text.contains(&head), "{table}");
    text.replacen(&head, &format!("{head}{lines}\n"), 1)
}

fn declared_force() -> String {
    let specimen = "rest_length_sd_mm = 0.5\ncontracted_length_sd_mm = 1";
    with(
        &with(FORCE, "specimen", specimen),
        "setup",
        "length_sd_mm = 0.2",
    )
}

fn declared_torque() -> String {
    with(
        TORQUE,
        "joint",
        "muscle_length_sd_mm = 3\nmoment_arm_sd_mm = 4.5",
    )
}

fn read(text: &str) -> Session {
    session_toml::read("a/session.toml", text).unwrap_or_else(|d| panic!("{d:?}"))
}

/// The messages that a text is refused with.
fn refused(text: &str) -> Vec<String> {
    match session_toml::read("a/session.toml", text) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(all) => all.iter().map(ToString::to_string).collect(),
    }
}

fn is(found: Option<f64>, mm: f64) -> bool {
    found.is_some_and(|m| (1e3 * m - mm).abs() < 1e-12)
}

fn reading() -> Reading {
    Reading {
        log: "points.csv".to_owned(),
        run: None,
        first_row: 1,
        last_row: 1,
        phase: None,
        samples: 1,
        sd_force_n: f64::NAN,
        sd_pressure_kpa: f64::NAN,
        zero_force_n: f64::NAN,
        zero_pressure_kpa: f64::NAN,
        values: BTreeMap::from([("pressure_kpa".to_owned(), 400.0)]),
        labels: BTreeMap::new(),
    }
}

#[test]
fn they_are_read_in_metres_and_none_is_made_up() {
    let session = read(&declared_force());
    let specimen = &session.specimen;
    assert!(is(specimen.rest_length_sd_m, 0.5) && is(specimen.contracted_length_sd_m, 1.0));
    assert!(is(session.length_sd_m, 0.2));
    let joint = read(&declared_torque()).joint.unwrap();
    assert!(is(joint.muscle_length_sd_m, 3.0) && is(joint.moment_arm_sd_m, 4.5));

    let plain = read(FORCE);
    assert_eq!(plain.specimen.rest_length_sd_m, None);
    assert_eq!(plain.specimen.contracted_length_sd_m, None);
    assert_eq!(plain.length_sd_m, None);
    let joint = read(TORQUE).joint.unwrap();
    assert_eq!(
        (joint.muscle_length_sd_m, joint.moment_arm_sd_m),
        (None, None)
    );
    // Of the largest that is possible and of a tiny one.
    for mm in ["50", "0.001"] {
        let text = with(FORCE, "setup", &format!("length_sd_mm = {mm}"));
        assert!(is(read(&text).length_sd_m, mm.parse().unwrap()));
    }
}

#[test]
fn the_held_lengths_is_no_constant_of_the_set_up() {
    let (declared, plain) = (read(&declared_force()), read(FORCE));
    assert_eq!(declared.setup, plain.setup);
    let (declared, plain) = (row(&declared, &reading()), row(&plain, &reading()));
    assert_eq!(declared.extras, plain.extras);
    assert_eq!(
        declared.extras.keys().collect::<Vec<_>>(),
        ["humidity"],
        "a constant of the user's own stays one"
    );
}

#[test]
fn rows_carry_them_and_nan_where_there_is_none() {
    let force = row(&read(&declared_force()), &reading());
    assert!(is(Some(force.rest_length_sd_m), 0.5));
    assert!(is(Some(force.contracted_length_sd_m), 1.0));
    assert!(is(Some(force.length_sd_m), 0.2));
    assert!(force.muscle_length_sd_m.is_nan() && force.moment_arm_sd_m.is_nan());
    let torque = row(&read(&declared_torque()), &reading());
    assert!(is(Some(torque.muscle_length_sd_m), 3.0));
    assert!(is(Some(torque.moment_arm_sd_m), 4.5));
    assert!(torque.length_sd_m.is_nan() && torque.rest_length_sd_m.is_nan());
    let plain = row(&read(FORCE), &reading());
    assert!(plain.length_sd_m.is_nan() && plain.rest_length_sd_m.is_nan());
    // What was measured does not change by what is said of its uncertainty.
    assert_eq!(
        (force.length_m, force.contraction, force.contraction_rel),
        (plain.length_m, plain.contraction, plain.contraction_rel)
    );
}

#[test]
fn every_key_refuses_what_is_no_standard_deviation_with_line_key_and_hint() {
    let keys = [
        (FORCE, "specimen", "rest_length_sd_mm"),
        (FORCE, "specimen", "contracted_length_sd_mm"),
        (FORCE, "setup", "length_sd_mm"),
        (TORQUE, "joint", "muscle_length_sd_mm"),
        (TORQUE, "joint", "moment_arm_sd_mm"),
    ];
    let range = "above 0 and at most 50";
    let values = [
        ("0", "found 0;", range),
        ("-0.5", "found -0.5;", range),
        ("50.1", "found 50.1;", range),
        ("290", "found 290;", range),
        ("nan", "found nan;", "a finite number"),
        ("inf", "found inf;", "a finite number"),
        ("\"0.5\"", "found \"0.5\";", "a finite number"),
        ("true", "found true;", "a finite number"),
    ];
    for (text, table, key) in keys {
        for (value, found, expected) in values {
            let text = with(text, table, &format!("{key} = {value}"));
            let line = 1 + text.lines().position(|l| l.starts_with(key)).unwrap();
            let said = refused(&text);
            assert_eq!(said.len(), 1, "{said:?}");
            let place = format!("a/session.toml:{line} [{table}.{key}]");
            for part in [place.as_str(), found, expected] {
                assert!(said[0].contains(part), "{part}: {}", said[0]);
            }
        }
    }
}

#[test]
fn slips_and_keys_in_the_wrong_table_are_pointed_at() {
    let cases = [
        (
            FORCE,
            "specimen",
            "rest_lenght_sd_mm",
            "did you mean `rest_length_sd_mm`?",
        ),
        (
            TORQUE,
            "joint",
            "moment_arm_sd",
            "did you mean `moment_arm_sd_mm`?",
        ),
        // Any name may stand in [setup]: these would become columns that the residual search looks at.
        (
            FORCE,
            "setup",
            "lenght_sd_mm",
            "did you mean `length_sd_mm`?",
        ),
        (FORCE, "setup", "length_sd", "did you mean `length_sd_mm`?"),
        (
            FORCE,
            "setup",
            "length_sd_cm",
            "did you mean `length_sd_mm`?",
        ),
        (
            FORCE,
            "setup",
            "length_sd_inch",
            "did you mean `length_sd_mm`?",
        ),
        (FORCE, "setup", "rest_length_sd_mm", "move it to [specimen]"),
        (
            FORCE,
            "setup",
            "contracted_length_sd_m",
            "did you mean `contracted_length_sd_mm` of [specimen]?",
        ),
        (FORCE, "setup", "muscle_length_sd_mm", "move it to [joint]"),
        (FORCE, "setup", "lenght_mm", "did you mean `length_mm`?"),
        (FORCE, "setup", "lengh_mm", "did you mean `length_mm`?"),
        (
            FORCE,
            "setup",
            "temprature_c",
            "did you mean `temperature_c`?",
        ),
        (
            FORCE,
            "setup",
            "presure_kpa",
            "did you mean `pressure_kpa`?",
        ),
    ];
    for (text, table, key, hint) in cases {
        let said = refused(&with(text, table, &format!("{key} = 0.5")));
        assert_eq!(said.len(), 1, "{said:?}");
        let place = format!("[{table}.{key}]");
        assert!(
            said[0].contains(&place) && said[0].contains(hint),
            "{said:?}"
        );
    }
    let torque = TORQUE.replacen("[joint]", "[setup]\nlength_sd_mm = 1\n\n[joint]", 1);
    let said = refused(&torque);
    assert!(
        said[0].contains("muscle_length_sd_mm in [joint]"),
        "{said:?}"
    );
    // Names of the user's own that only look alike.
    for own in [
        "height_sd_mm",
        "pressure_sd_kpa",
        "sd_of_force",
        "length_by",
        "length_below_mm",
        "supply_pressure_kpa",
        "width_mm",
    ] {
        let session = read(&with(FORCE, "setup", &format!("{own} = 0.5")));
        assert_eq!(session.setup_number(own), Some(0.5), "{own}");
    }
    // No column of a log may take the name of one that the pipeline writes.
    let column = with(FORCE, "columns", "length_sd_m = { index = 2 }");
    assert!(refused(&column)[0].contains("a name that the pipeline does not use itself"));
}

#[test]
fn sessions_that_declare_one_specimen_differently_are_noted_and_each_keeps_its_own() {
    let bench = Bench::empty();
    let named = |id: &str, lines: &str| {
        let text = FORCE.replace("id = \"held\"", &format!("id = \"{id}\""));
        with(&text, "specimen", lines)
    };
    for (id, lines) in [
        ("a", "rest_length_sd_mm = 0.5"),
        ("b", "rest_length_sd_mm = 0.5"),
        ("c", "rest_length_sd_mm = 2"),
        ("d", ""),
    ] {
        bench.write(&format!("{id}/session.toml"), named(id, lines));
    }
    let found = discover(&[bench.raw()]);
    assert_eq!((found.sessions.len(), found.unusable.len()), (4, 0));
    let said: Vec<String> = found.diagnostics.iter().map(ToString::to_string).collect();
    assert_eq!(said.len(), 2, "{said:?}");
    assert!(said[0].starts_with("warning: c/session.toml"), "{said:?}");
    assert!(
        said[0].contains("0.1820 m (standard deviation 2.000 mm), l_620 0.1520 m;")
            && said[0].contains("0.1820 m (standard deviation 0.500 mm)"),
        "{said:?}"
    );
    assert!(
        said[1].contains("(standard deviation not declared)"),
        "{said:?}"
    );
    let own = found.sessions.iter();
    let own: Vec<Option<f64>> = own.map(|s| s.session.specimen.rest_length_sd_m).collect();
    assert!(is(own[0], 0.5) && is(own[1], 0.5) && is(own[2], 2.0) && own[3].is_none());
}

#[test]
fn the_tidy_data_have_them_with_units_and_a_changed_one_is_not_taken_from_the_cache() {
    let bench = Bench::empty();
    bench.write("held/session.toml", declared_force());
    bench.write("held/points.csv", "620,200\n500,150\n400,100\n300,60\n");
    bench.write(
        "other/session.toml",
        FORCE
            .replace("\"held\"", "\"other\"")
            .replace("\"l182\"", "\"l182b\""),
    );
    bench.write("other/points.csv", "620,201\n500,150\n400,100\n300,60\n");
    bench.write("knee/session.toml", declared_torque());
    bench.write(
        "knee/points.csv",
        "-60,-8,430,45,600\n-30,-11,450,60,600\n0,-14,470,55,600\n",
    );
    let run = || {
        bench.age();
        let said = bench.run(&["run"]);
        assert_eq!(said.code, 0, "{}", said.err);
        let read = |file: &str| {
            let bytes = std::fs::read(bench.root().join("derived").join(file)).unwrap();
            Frame::from_parquet(&bytes).unwrap()
        };
        (read("rows.parquet"), read("torque.parquet"))
    };
    let (rows, torque) = run();
    let of = |frame: &Frame, session: &str, column: &str| {
        let ids = frame.texts("session").unwrap();
        let k = ids.iter().position(|id| id.as_deref() == Some(session));
        frame.numbers(column).unwrap()[k.unwrap()]
    };
    assert!(is(Some(of(&rows, "held", "rest_length_sd_m")), 0.5));
    assert!(is(Some(of(&rows, "held", "contracted_length_sd_m")), 1.0));
    assert!(is(Some(of(&rows, "held", "length_sd_m")), 0.2));
    let bytes = std::fs::read(bench.root().join("derived/rows.parquet")).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    for column in [
        "rest_length_sd_m",
        "contracted_length_sd_m",
        "length_sd_m",
        "muscle_length_sd_m",
        "moment_arm_sd_m",
    ] {
        assert!(of(&rows, "other", column).is_nan(), "{column}");
        // The units stand in the file's footer as they are, without compression.
        let unit = format!("\"{column}\":\"m\"");
        assert!(text.contains(&unit), "{unit}");
    }
    for frame in [&rows, &torque] {
        assert!(is(Some(of(frame, "knee", "muscle_length_sd_m")), 3.0));
        assert!(is(Some(of(frame, "knee", "moment_arm_sd_m")), 4.5));
    }
    let changed = declared_force().replace("length_sd_mm = 0.2", "length_sd_mm = 0.7");
    bench.write("held/session.toml", changed);
    let (rows, _) = run();
    assert!(is(Some(of(&rows, "held", "length_sd_m")), 0.7));
}

#[test]
fn a_drafted_session_offers_them_as_comments_that_can_be_taken_as_they_stand() {
    let bench = Bench::empty();
    let clock = |k: usize| format!("{k},{},{}", 3 * k, 2 * k);
    let force: Vec<String> = (0..6).map(clock).collect();
    let drafts = [
        (
            format!("pressure (kPa),force (N),x\n{}\n", force.join("\n")),
            &[
                "rest_length_sd_mm",
                "contracted_length_sd_mm",
                "length_sd_mm",
            ][..],
        ),
        (
            format!(
                "pressure (kPa),force (N),length (mm)\n{}\n",
                force.join("\n")
            ),
            &[
                "rest_length_sd_mm",
                "contracted_length_sd_mm",
                "length_sd_mm",
            ],
        ),
        (
            format!(
                "angle (deg),torque (N.m),pressure (kPa)\n{}\n",
                force.join("\n")
            ),
            &[
                "rest_length_sd_mm",
                "contracted_length_sd_mm",
                "muscle_length_sd_mm",
                "moment_arm_sd_mm",
            ],
        ),
    ];
    for (k, (log, keys)) in drafts.iter().enumerate() {
        bench.write(&format!("log{k}.csv"), log);
        let said = bench.run(&["new-session", &format!("raw/log{k}.csv")]);
        assert_eq!(said.code, 0, "{}", said.err);
        let file = bench.root().join(format!("log{k}/session.toml"));
        let text = std::fs::read_to_string(file).unwrap();
        let text = text.replace("FILL IN", "");
        let plain = read(&text);
        assert_eq!(
            (plain.length_sd_m, plain.specimen.rest_length_sd_m),
            (None, None)
        );
        assert!(text.contains("standard deviation"), "{text}");
        let mut taken = text.clone();
        for key in *keys {
            let line = format!("\n# {key} = ");
            assert!(text.contains(&line), "{key}: {text}");
            taken = taken.replace(&line, &format!("\n{key} = "));
        }
        let taken = read(&taken.replace("\n# [setup]", "\n[setup]"));
        assert!(taken.specimen.rest_length_sd_m.is_some());
        assert!(taken.specimen.contracted_length_sd_m.is_some());
        match taken.joint {
            None => assert!(taken.length_sd_m.is_some()),
            Some(joint) => {
                assert!(is(joint.muscle_length_sd_m, 5.0) && is(joint.moment_arm_sd_m, 7.0));
            }
        }
    }
}
