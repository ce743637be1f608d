//! Torque through the program: a leg whose geometry is known in closed form, mistakes in its description, the laboratory's own tests.

use crate::support::{Bench, read_table, rig, rig_run};
use pipeline::models::new::NewPublished;
use pipeline::models::{Direction, ForceModel, State};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

/// Centre of the joint, origin and insertion relative to it, m: a triangle, whose third side is the path.
const CENTRE: [f64; 2] = [0.01, -0.4];
const ORIGIN: [f64; 2] = [-0.05, 0.48];
const INSERTION: [f64; 2] = [-0.03, -0.06];
const FITTING_M: f64 = 0.031;
const REST_M: f64 = 0.485;
const FREE_M: f64 = 0.398;

fn leg_toml() -> String {
    let origin = [CENTRE[0] + ORIGIN[0], CENTRE[1] + ORIGIN[1]];
    format!(
        "[joint]\nkind = \"pinned\"\nrange_deg = [-100, 10]\ncentre_m = {CENTRE:?}\n\n[[route]]\nname = \"own\"\npoint = [\n  \
         {{ femur_m = [{}, {}, 0.0] }},\n  {{ tibia_m = [{}, {}, 0.0] }},\n]\n",
        origin[0], origin[1], INSERTION[0], INSERTION[1]
    )
}

/// Length of the path and torque at an angle in degrees, by the law of cosines: L^2 = a^2 + b^2 - 2 a b cos(phi), r = a b sin(phi)/L.
fn leg(degrees: f64, fitting_m: f64) -> (f64, f64, f64) {
    let (a, b) = (
        libm::hypot(ORIGIN[0], ORIGIN[1]),
        libm::hypot(INSERTION[0], INSERTION[1]),
    );
    let phi = libm::atan2(INSERTION[1], INSERTION[0]) + degrees.to_radians()
        - libm::atan2(ORIGIN[1], ORIGIN[0]);
    let path = (a * a + b * b - 2.0 * a * b * libm::cos(phi)).sqrt();
    let arm = -a * b * libm::sin(phi) / path;
    let length = path - 2.0 * fitting_m;
    let state = State {
        diameter_mm: 10.0,
        rest_length_m: REST_M,
        contracted_length_m: FREE_M,
        length_m: length,
        pressure_kpa: 600.0,
        direction: Direction::Isometric,
    };
    let force = NewPublished.predict(&state).force_n().unwrap();
    (length, arm, arm * force)
}

const DEGREES: [f64; 6] = [-80.0, -60.0, -45.0, -30.0, -15.0, -5.0];

/// A session of the leg: its id, what else its head says, and by how much its torques are wrong.
fn write(bench: &Bench, id: &str, head: &str, wrong_nm: f64) {
    let mut data = String::from("a,t,l,r,p,session\n");
    for degrees in DEGREES {
        let (length, arm, torque) = leg(degrees, FITTING_M);
        let row = [
            degrees,
            torque + wrong_nm,
            1e3 * length,
            1e3 * arm.abs(),
            600.0,
        ];
        let cells: Vec<String> = row.iter().map(ToString::to_string).collect();
        data += &format!("{},{id}\n", cells.join(","));
    }
    let session = format!(
        "schema = \"bpa-session/1\"\nid = \"{id}\"\nkind = \"knee-torque\"\nsampling = \"points\"\ncampaign = \"own leg\"\n{head}\n\
         [specimen]\nid = \"a\"\ndiameter_mm = 10\nrest_length_mm = {}\ncontracted_length_mm = {}\n\n\
         [joint]\nknee = \"described\"\nfile = \"leg.toml\"\nmuscle = \"flexor\"\ntendon_mm = 0\n\n\
         [columns]\nangle = {{ name = \"a\", unit = \"deg\" }}\ntorque = {{ name = \"t\", unit = \"N.m\" }}\n\
         muscle_length = {{ name = \"l\", unit = \"mm\" }}\nmoment_arm = {{ name = \"r\", unit = \"mm\" }}\n\
         pressure = {{ name = \"p\", unit = \"kPa\" }}\n\n[[log]]\nfile = \"points.csv\"\n",
        1e3 * REST_M,
        1e3 * FREE_M
    );
    bench.write(&format!("{id}/session.toml"), session);
    bench.write(&format!("{id}/points.csv"), data);
    bench.write(&format!("{id}/leg.toml"), leg_toml());
}

fn campaign() -> Bench {
    let bench = Bench::empty();
    for id in ["t1", "t2", "t3"] {
        write(&bench, id, "", 0.0);
    }
    write(&bench, "t4", "exclude = \"bolt slipped\"\n", 3.0);
    write(&bench, "t5", "role = \"holdout\"\n", -3.0);
    bench.age();
    bench
}

fn number(row: &BTreeMap<String, String>, name: &str) -> f64 {
    row[name]
        .parse()
        .unwrap_or_else(|_| panic!("{name} of {row:?}"))
}

fn find<'a>(
    table: &'a [BTreeMap<String, String>],
    wanted: &[(&str, &str)],
) -> &'a BTreeMap<String, String> {
    let is = |row: &&BTreeMap<String, String>| wanted.iter().all(|(k, v)| row[*k] == *v);
    table
        .iter()
        .find(is)
        .unwrap_or_else(|| panic!("{wanted:?} not in {table:?}"))
}

#[test]
fn fittings_are_found_and_excluded_and_held_out_tests_take_no_part() {
    let bench = campaign();
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let fits = bench.table("knee_fittings");
    let fit = find(
        &fits,
        &[("law", "new_published"), ("origin", "fitted to a")],
    );
    assert!(
        (number(fit, "fitting_mm") - 1e3 * FITTING_M).abs() < 1e-4,
        "{fit:?}"
    );
    assert_eq!(fit["n_fitted"], "18");
    assert_eq!(fit["interval_by"], "jackknife by test");
    assert!(number(fit, "rmse_fitted_nm") < 1e-4);
    // All tests stay visible, whatever part they play.
    let errors = bench.table("knee_errors");
    for (session, by_hand) in [("t1", 0.0), ("t4", 3.0), ("t5", 3.0)] {
        let of = |basis| {
            let wanted = [
                ("session", session),
                ("model", "new_published"),
                ("basis", basis),
            ];
            find(&errors, &wanted)
        };
        assert!((number(of("by_hand"), "rmse_nm") - by_hand).abs() < 1e-6);
        let geometry = of("geometry");
        let expected: Vec<f64> = DEGREES
            .iter()
            .map(|d| {
                let sign = if session == "t4" { 1.0 } else { -1.0 };
                leg(*d, FITTING_M).2 + sign * by_hand - leg(*d, 0.0254).2
            })
            .collect();
        let sse: f64 = expected.iter().map(|e| e * e).sum();
        assert!(
            (number(geometry, "sse_nm2") - sse).abs() < 1e-6 * sse,
            "{geometry:?} {sse}"
        );
        let bias = expected.iter().sum::<f64>() / 6.0;
        assert!((number(geometry, "bias_nm") - bias).abs() < 1e-6);
    }
    let tests = bench.table("knee_tests");
    assert_eq!(
        find(&tests, &[("session", "t4")])["excluded"],
        "bolt slipped"
    );
    let longer = number(find(&tests, &[("session", "t1")]), "length_difference_mm");
    assert!((longer + 2e3 * (FITTING_M - 0.0254)).abs() < 1e-6);
    let pdf = std::fs::read(bench.root().join("reports/knee.pdf")).unwrap();
    assert!(pdf.starts_with(b"%PDF"));
    assert!(bench.root().join("derived/torque.parquet").is_file());
}

#[test]
fn the_stated_fittings_are_used_and_another_leg_is_another_result() {
    let bench = campaign();
    let stated = |bench: &Bench| {
        assert_eq!(bench.run(&["run"]).code, 0);
        let errors = bench.table("knee_errors");
        let wanted = [
            ("session", "t1"),
            ("model", "new_published"),
            ("basis", "geometry"),
        ];
        number(find(&errors, &wanted), "rmse_nm")
    };
    let before = stated(&bench);
    assert!(before > 0.5, "{before}");
    assert!(bench.run(&["run"]).out.contains("nothing to do"));
    for id in ["t1", "t2", "t3", "t4", "t5"] {
        let path = bench.raw().join(id).join("session.toml");
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(
            &path,
            text.replace("tendon_mm", "fitting_mm = 31\ntendon_mm"),
        )
        .unwrap();
    }
    assert!(stated(&bench) < 1e-6);
    let path = bench.raw().join("t1/leg.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(
        &path,
        text.replace("centre_m = [0.01,", "centre_m = [0.03,"),
    )
    .unwrap();
    assert!(stated(&bench) > 0.1);
    let tests = bench.table("knee_tests");
    let configuration = |session| find(&tests, &[("session", session)])["configuration"].clone();
    assert_ne!(configuration("t1"), configuration("t2"));
    assert_eq!(configuration("t2"), configuration("t3"));
}

#[test]
fn mistakes_in_a_joint_are_named_with_file_key_and_remedy() {
    let cases: [(&str, &str, &str, &[&str]); 8] = [
        (
            "leg.toml",
            "kind = \"pinned\"",
            "kind = \"pined\"",
            &["/leg.toml:2 [joint.kind]", "pinned"],
        ),
        (
            "leg.toml",
            "tibia_m",
            "femur_m",
            &["/leg.toml", "no point on femur or tibia"],
        ),
        (
            "session.toml",
            "file = \"leg.toml\"",
            "file = \"log.toml\"",
            &["/log.toml", "no such file", "beside session.toml"],
        ),
        (
            "session.toml",
            "file = \"leg.toml\"",
            "file = \"../leg.toml\"",
            &["[joint.file]", "below the session's folder"],
        ),
        (
            "session.toml",
            "file = \"leg.toml\"",
            "file = \"leg.toml\"\nroute = \"owm\"",
            &["[joint.route]", "did you mean `own`?"],
        ),
        (
            "session.toml",
            "knee = \"described\"",
            "knee = \"pinned\"",
            &["[joint.file]", "knee = \"described\""],
        ),
        (
            "session.toml",
            "file = \"leg.toml\"\n",
            "",
            &["joint.file", "the file that describes the leg"],
        ),
        (
            "session.toml",
            "pressure = { name = \"p\", unit = \"kPa\" }\n",
            "",
            &["[columns.pressure]", "pressure_kpa"],
        ),
    ];
    let bench = campaign();
    for (k, (file, from, to, _)) in cases.iter().enumerate() {
        let id = format!("wrong{k}");
        write(&bench, &id, "", 0.0);
        let path = bench.raw().join(&id).join(file);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{from}");
        std::fs::write(&path, text.replace(from, to)).unwrap();
    }
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    for (k, (.., parts)) in cases.iter().enumerate() {
        let place = format!(": raw/wrong{k}/");
        let own = said.err.lines().filter(|l| l.contains(&place));
        let own = own.collect::<Vec<&str>>().join("\n");
        for part in *parts {
            assert!(
                own.contains(part),
                "{part:?} is not in {own:?} of\n{}",
                said.err
            );
        }
    }
    let tests = bench.table("knee_tests");
    let used: Vec<&str> = tests.iter().map(|t| t["session"].as_str()).collect();
    assert_eq!(used, ["t1", "t2", "t3", "t4", "t5"]);
}

#[test]
fn an_angle_that_is_no_number_loses_its_row_only() {
    let bench = campaign();
    let path = bench.raw().join("t1/points.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replacen("-60,", "sixty,", 1)).unwrap();
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0);
    assert!(
        said.err.contains("t1/points.csv:3 [angle_rad]"),
        "{}",
        said.err
    );
    let tests = bench.table("knee_tests");
    assert_eq!(find(&tests, &[("session", "t1")])["readings"], "5");
}

#[test]
fn predict_tells_where_a_described_leg_meets_the_human_muscle() {
    let bench = campaign();
    std::fs::write(bench.root().join("leg.toml"), leg_toml()).unwrap();
    let muscle = [
        "predict",
        "--diameter",
        "10",
        "--rest-length",
        "485mm",
        "--contracted-length",
        "398mm",
        "--model",
        "new_published",
        "--pressure",
        "600kPa",
        "--knee",
        "leg.toml",
        "--fitting",
        "31mm",
    ];
    let said = bench.run(&[&muscle[..], &["--json"]].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    let value: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(value["torque"]["human"], "bifemsh");
    let angles = value["torque"]["angles"].as_array().unwrap();
    assert_eq!(angles.len(), 111);
    for a in angles {
        let number = |name: &str| a[name].as_f64().unwrap();
        let (length, arm, torque) = leg(number("angle_deg"), 0.031);
        assert!((number("length_m") - length).abs() < 1e-9);
        assert!((number("arm_m") - arm).abs() < 1e-9);
        assert!((number("torque_nm") - torque).abs() < 1e-6);
        let meets = torque <= number("human_nm");
        assert_eq!(a["meets"].as_bool(), Some(meets), "{a}");
    }
    let text = bench.run(&muscle);
    assert!(
        text.out.contains("meets bifemsh") && text.out.contains("short"),
        "{}",
        text.out
    );
    for (more, part) in [
        (&["--human", "vastii"][..], "did you mean vasti?"),
        (&["--route", "owm"], "did you mean own?"),
        (&["--fitting", "31"], "has no unit"),
    ] {
        let base = &muscle[..if more[0] == "--fitting" { 13 } else { 15 }];
        let said = bench.run(&[base, more].concat());
        assert_eq!(said.code, 2);
        assert!(said.err.contains(part), "{part}\n{}", said.err);
    }
    let several = bench.run(&[&muscle[..11], &["--knee", "pinned"]].concat());
    assert!(
        several.err.contains("give --route with one of flexor"),
        "{}",
        several.err
    );
}

type Table = Vec<BTreeMap<String, String>>;

/// What a run makes of the campaign of torque that the repository ships.
struct Shipped {
    fittings: Table,
    tests: Table,
    effects: Table,
    findings: serde_json::Value,
}

static SHIPPED: LazyLock<Shipped> = LazyLock::new(|| {
    let bench = Bench::empty();
    let raw = Path::new(env!("CARGO_MANIFEST_DIR")).join("raw/simulated-knee");
    let said = bench.run(&["run", "--raw", raw.to_str().unwrap()]);
    assert_eq!(said.code, 0, "{}", said.err);
    Shipped {
        fittings: bench.table("knee_fittings"),
        tests: bench.table("knee_tests"),
        effects: bench.table("knee_effects"),
        findings: findings(&bench),
    }
});

/// The campaign that the repository ships: fittings of 33 mm and a frame that yields by up to 6 mm, so that the torques have about 35 mm; noise of
/// 0.15 N.m and half a degree.
#[test]
fn the_shipped_campaign_is_recovered() {
    let fits = &SHIPPED.fittings;
    let wanted = [
        ("diameter_mm", "10"),
        ("muscle", "flexor"),
        ("law", "new_published"),
    ];
    let of = |origin| find(fits, &[&wanted[..], &[("origin", origin)]].concat());
    let fit = of("fitted to skn10-l485");
    assert!((33.0..36.0).contains(&number(fit, "fitting_mm")), "{fit:?}");
    assert!(number(fit, "rmse_held_out_nm") < 0.6, "{fit:?}");
    assert!(number(of("as stated"), "rmse_held_out_nm") > 5.0);
    let tests = &SHIPPED.tests;
    assert!(tests.iter().all(|t| t["simulated"] == "true"));
    let excluded = find(tests, &[("session", "sim-flxpin10-485-t4")]);
    assert_eq!(excluded["excluded"], "resting length uncertain");
}

/// The errors of a joint's tests make up those of the joint, without effects and with them; and the rigid leg, of which nothing is fitted, has one
/// error on the same readings, held out or not. Both take an actuator that would push as slack.
#[test]
fn a_joint_has_the_errors_of_its_tests() {
    let mut joints = 0;
    for found in SHIPPED.findings["campaigns"].as_array().unwrap() {
        let part = found["part"].as_str().unwrap();
        let diameter = found["diameter_mm"].to_string();
        let own = SHIPPED.effects.iter().filter(|t| {
            t["joint"] == part && t["diameter_mm"] == diameter && t["takes_part"] == "true"
        });
        let own: Vec<_> = own.collect();
        for (when, column) in [("before", "rigid_rmse_nm"), ("after", "fitted_rmse_nm")] {
            let squares = |t: &&_| {
                let error = number(t, column);
                number(t, "n") * error * error
            };
            let squares: f64 = own.iter().map(squares).sum();
            let readings: f64 = own.iter().map(|t| number(t, "n")).sum();
            let error = found[when]["rmse_train"].as_f64().unwrap();
            let of_tests = (squares / readings).sqrt();
            assert!(
                (error - of_tests).abs() < 1e-9 * of_tests,
                "{part}, {when}: {error} {of_tests}"
            );
        }
        let before = &found["before"];
        if let Some(held_out) = before["rmse_heldout"].as_f64() {
            let error = before["rmse_train"].as_f64().unwrap();
            assert!((error - held_out).abs() < 1e-9 * error, "{part}: {before}");
            joints += 1;
        }
    }
    assert!(joints > 0);
}

/// Beside what the measurers reached by hand over years (the specification of the knee, section "Series stiffness"): their 2.12 N.m on the 45.7 cm
/// flexor that took no part is not reached, because lengths and arms by hand ask for another geometry than the torques of two actuators alone;
/// brackets of 54 to 94 um/N. Their 1.62 N.m on the 48.5 cm flexor is what its tests reach here with an offset of the length for each of them, and
/// no value for all.
fn the_loop_finds_what_the_measurers_found(bench: &Bench) {
    let by_hand = bench.table("knee_by_hand");
    let of = |actuator| find(&by_hand, &[("actuator", actuator)]);
    // The only one of its joint, fitted by them as it is here.
    let row = of("42.3 cm");
    assert_eq!(row["part"], "fitted");
    assert!(
        number(row, "after_rmse_nm") < number(row, "theirs_rmse_nm"),
        "{row:?}"
    );
    let row = of("45.7 cm");
    assert!(
        number(row, "held_out_rmse_nm") < 0.7 * number(row, "rigid_rmse_nm"),
        "{row:?}"
    );
    let row = of("48.5 cm");
    assert!(
        number(row, "held_out_rmse_nm") < 0.45 * number(row, "rigid_rmse_nm"),
        "{row:?}"
    );
    let tests = bench.table("knee_effects");
    for k in 1..=4 {
        let session = format!("knee-flxpin10-48-t{k}");
        let row = find(&tests, &[("session", &session)]);
        assert!(number(row, "own_rmse_nm") < 1.8, "{row:?}");
    }
    let rejected = find(&tests, &[("session", "knee-flxpin10-48-t5-rejected")]);
    assert_eq!(rejected["takes_part"], "false");
    assert!(rejected["held_out_rmse_nm"].is_empty(), "{rejected:?}");

    let error =
        |found: &serde_json::Value, when: &str| found[when]["rmse_heldout"].as_f64().unwrap();
    let flexor = joint(&findings(bench), "pinned knee, flexor", 10);
    assert_eq!(ids(&flexor)[..2], ["series_compliance", "attachment_shift"]);
    // Before this the best of the loop was 3.37 N.m; a trial elsewhere came to 2.5.
    assert!(error(&flexor, "after") < 3.2, "{flexor}");
    // The arm by hand grows when the insertion moves this way (the specification of the loop: by (-4 to -8, -10 to -16) mm).
    let shift = flexor["effects"][1]["parameters"].as_array().unwrap();
    assert!(
        shift.iter().all(|p| p["ci_high"].as_f64().unwrap() < 0.0),
        "{shift:?}"
    );

    let extensor = joint(&findings(bench), "pinned knee, extensor", 10);
    // Without the tests that their owner doubts, which were furthest off.
    // Which of the two comes in first is a matter of tenths in log-likelihood.
    let mut first = ids(&extensor)[..2].to_vec();
    first.sort_unstable();
    assert_eq!(first, ["attachment_shift", "series_compliance"]);
    // Before this 1.72 N.m; a trial elsewhere came to 1.25.
    assert!(error(&extensor, "after") < 1.3, "{extensor}");
    let errors = extensor["recording_errors"].as_array().unwrap();
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(errors[0]["group"], "knee-extpin10-48-t2");
    for doubtful in ["42", "42ten", "48-t1"] {
        let session = format!("knee-extpin10-{doubtful}");
        let row = find(&tests, &[("session", &session)]);
        assert_eq!(row["takes_part"], "false", "{row:?}");
    }
}

/// The findings of one joint.
fn joint(findings: &serde_json::Value, part: &str, diameter_mm: u64) -> serde_json::Value {
    let campaigns = findings["campaigns"].as_array().unwrap();
    let is = |c: &&serde_json::Value| c["part"] == part && c["diameter_mm"] == diameter_mm;
    campaigns.iter().find(is).unwrap().clone()
}

fn findings(bench: &Bench) -> serde_json::Value {
    let text = std::fs::read_to_string(bench.root().join("reports/findings.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// The simulated campaign has fittings that are 15.2 mm longer than stated in all, and a frame that gives way by up to 6 mm (1 - exp(-F/150 N)); its
/// equations are not those of the search.
#[test]
fn the_loop_finds_the_length_that_the_simulated_legs_lack() {
    // One test of one actuator hardly tells a length from what yields: it has to find one of the two, and nothing else.
    for (part, diameter) in [
        ("pinned knee, flexor", 10),
        ("biomimetic knee, flexor", 10),
        ("biomimetic knee, flexor", 20),
    ] {
        let ids = ids(&joint(&SHIPPED.findings, part, diameter));
        assert!(!ids.is_empty(), "{part}");
        assert!(ids.iter().all(is_length), "{part}: {ids:?}");
    }
    // Or from how it is mounted, which then is as far off.
    for part in ONE_TEST {
        let found = joint(&SHIPPED.findings, part, 10);
        assert_eq!(ids(&found), [""; 0], "{part}");
        let scatter = found["scatter"].as_array().unwrap();
        let mounting = scatter.iter().find(|s| s["id"] == "length_offset").unwrap();
        let values = mounting["values"].as_object().unwrap();
        let [value] = values.values().collect::<Vec<_>>()[..] else {
            panic!("{mounting}");
        };
        assert!(
            (value.as_f64().unwrap() - 18.0).abs() < 3.0,
            "{part}: {value}"
        );
    }
    let found = joint(&SHIPPED.findings, "pinned knee, flexor", 10);
    assert_eq!(
        ids(&found),
        ["length_offset", "series_compliance"],
        "{found}"
    );
    // Compliance of another form takes part of the length.
    let d = found["effects"][0]["parameters"][0]["value"].as_f64();
    assert!((d.unwrap() - 15.2).abs() < 1.0, "{found}");
    // Without one of the two actuators the length alone is found: what yields is no more than a law that is not exact may be off by.
    assert!(
        found["after"]["rmse_heldout"].as_f64().unwrap() < 0.5,
        "{found}"
    );
}

/// Joints of the simulated campaign with one test that does not tell a length from its mounting.
const ONE_TEST: [&str; 3] = [
    "pinned knee, extensor",
    "biomimetic knee, extensor",
    "described knee, flexor",
];

/// Whether an effect is of what the simulated legs lack.
fn is_length(id: &String) -> bool {
    id == "length_offset" || id == "series_compliance"
}

/// The ids of the effects that were found.
fn ids(found: &serde_json::Value) -> Vec<String> {
    let effects = found["effects"].as_array().unwrap();
    let id = |e: &serde_json::Value| e["id"].as_str().map(str::to_owned);
    effects.iter().filter_map(id).collect()
}

/// The closed-form leg with its own fittings stated is what the rigid model says: nothing is to be found.
#[test]
fn the_loop_finds_nothing_in_a_rigid_leg() {
    let bench = Bench::empty();
    for (k, id) in ["t1", "t2", "t3", "t4", "t5"].iter().enumerate() {
        write(&bench, id, "", 0.02 * (k as f64 - 2.0));
        let file = bench.root().join("raw").join(id).join("session.toml");
        let text = std::fs::read_to_string(&file).unwrap();
        let stated = format!("tendon_mm = 0\nfitting_mm = {}", 1e3 * FITTING_M);
        std::fs::write(&file, text.replace("tendon_mm = 0", &stated)).unwrap();
    }
    bench.age();
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let found = joint(&findings(&bench), "described knee, flexor", 10);
    assert_eq!(found["verdict"], "none", "{found}");
}

/// What is not reached yet, and why: run by nobody.
mod not_reached {
    use super::*;

    /// What was reached at a level of 0.05, of the flexor with the draws of one seed at 0.02.
    #[test]
    #[ignore = "not reached: with one test a length is hardly told from a mounting (p = 0.026 to 0.029)"]
    fn one_test_shows_a_length() {
        for part in ONE_TEST {
            let ids = ids(&joint(&SHIPPED.findings, part, 10));
            assert!(
                !ids.is_empty() && ids.iter().all(is_length),
                "{part}: {ids:?}"
            );
        }
    }

    /// What was reached with a law that is taken as exact.
    #[test]
    #[ignore = "not reached: without one of two actuators what yields is no more than a law may be off by"]
    fn unseen_simulated_legs_are_predicted_to_a_sixteenth() {
        let found = joint(&SHIPPED.findings, "pinned knee, flexor", 10);
        assert!(
            found["after"]["rmse_heldout"].as_f64().unwrap() < 0.4,
            "{found}"
        );
    }

    /// What the search by sets reached on the flexors, and the mixed model does not: kept until it does.
    #[test]
    #[ignore = "not reached: lengths and arms by hand ask for another geometry than the torques of the flexors (docs/loop.md, the loop on torque)"]
    fn the_flexors_come_to_what_the_measurers_reached() {
        let rig = rig();
        let bench = Bench::empty();
        let raw = rig.join("knee-torque");
        let said = bench.run(&["run", "--raw", raw.to_str().unwrap()]);
        assert_eq!(said.code, 0, "{}", said.err);
        let by_hand = bench.table("knee_by_hand");
        let of = |actuator| find(&by_hand, &[("actuator", actuator)]);
        let row = of("45.7 cm");
        assert!(
            number(row, "held_out_rmse_nm") < number(row, "theirs_rmse_nm"),
            "{row:?}"
        );
        let row = of("48.5 cm");
        assert!(
            number(row, "held_out_rmse_nm") < 0.35 * number(row, "rigid_rmse_nm"),
            "{row:?}"
        );
        let tests = bench.table("knee_effects");
        for k in 1..=4 {
            let session = format!("knee-flxpin10-48-t{k}");
            let row = find(&tests, &[("session", &session)]);
            assert!(number(row, "own_rmse_nm") < 1.7, "{row:?}");
        }
        for part in ["pinned knee, flexor", "pinned knee, extensor"] {
            let found = joint(&findings(&bench), part, 10);
            let effect = &found["effects"][0];
            assert_eq!(effect["id"], "series_compliance");
            let compliance = &effect["parameters"][0];
            assert_eq!(compliance["unit"], "um/N");
            let end = |name: &str| compliance[name].as_f64().unwrap();
            assert!(end("ci_low") < 94.0 && end("ci_high") > 54.0, "{found}");
        }
    }

    /// The length itself, in every leg and inside its interval.
    #[test]
    #[ignore = "not reached: one test of one actuator does not tell a length from what yields, and compliance of another form takes 0.7 mm of the 15.2"]
    fn the_length_is_told_from_what_yields_in_every_simulated_leg() {
        for found in SHIPPED.findings["campaigns"].as_array().unwrap() {
            assert_eq!(found["effects"][0]["id"], "length_offset", "{found}");
        }
        let found = joint(&SHIPPED.findings, "pinned knee, flexor", 10);
        let d = &found["effects"][0]["parameters"][0];
        let end = |name: &str| d[name].as_f64().unwrap();
        assert!(end("ci_low") < 15.2 && 15.2 < end("ci_high"), "{d}");
    }
}

/// On the real rig sessions (`support::rig`): run by `.ci/run` where they are.
mod rig {
    use super::*;

    /// Yardsticks that were calculated apart from this program (the issue on the knee, and section "What the knee paper shows"): rigid RMSE of 4.2
    /// to 9.6 N.m for the tests of the 48.5 cm flexor, 1.2 to 2.4 N.m from length and arm by hand, and with fittings of 35.2 mm SSE 473 and 344.
    #[test]
    #[ignore = "needs the real rig sessions"]
    fn the_laboratorys_tests_give_the_known_errors() {
        let run = rig_run();
        let tables = run.bench.root().join("reports/tables");
        let table = |name: &str| read_table(&tables.join(format!("{name}.csv")));
        assert_eq!(table("knee_tests").len(), 22);
        let laws = table("knee_laws");
        let rigid: Vec<f64> = (1..=4)
            .map(|k| {
                let session = format!("knee-flxpin10-48-t{k}");
                let row = find(&laws, &[("session", &session), ("law", "new_published")]);
                let by_hand = number(row, "by_hand_rmse_nm");
                assert!((1.2..2.45).contains(&by_hand), "{row:?}");
                number(row, "rmse_nm")
            })
            .collect();
        for (found, known) in rigid.iter().zip([9.59, 9.31, 5.94, 4.21]) {
            assert!((found - known).abs() < 0.01, "{rigid:?}");
        }
        let errors = table("knee_fitting_errors");
        for (law, configuration, sse) in [
            ("new_published", "pinned-flexor-bpa10-l485", 473.4),
            ("new_published", "pinned-flexor-bpa10-l457", 344.6),
            // The paper has 554.6 and 315.3.
            ("knee_paper", "pinned-flexor-bpa10-l485", 520.7),
            ("knee_paper", "pinned-flexor-bpa10-l457", 312.5),
        ] {
            let wanted = [
                ("law", law),
                ("configuration", configuration),
                ("origin", "knee paper"),
            ];
            let found = number(find(&errors, &wanted), "sse_nm2");
            assert!((found - sse).abs() < 0.1, "{law} {configuration} {found}");
        }
        let fits = table("knee_fittings");
        for (law, length) in [("knee_paper", 35.36), ("new_published", 35.10)] {
            let fit = find(&fits, &[("law", law), ("origin", "fitted to bpa10-l485")]);
            assert!((number(fit, "fitting_mm") - length).abs() < 0.01, "{fit:?}");
            assert!(
                number(fit, "interval_mm_low") < 35.2 && 35.2 < number(fit, "interval_mm_high")
            );
            assert_eq!(
                (fit["n_fitted"].as_str(), fit["n_held_out"].as_str()),
                ("90", "65")
            );
        }
        let human = table("knee_human");
        for row in human.iter().filter(|r| r["against"].starts_with("OpenSim")) {
            match row["quantity"].as_str() {
                "moment arm" => assert!(number(row, "max") < 0.5, "{row:?}"),
                _ => assert!(number(row, "max_relative") < 3.0, "{row:?}"),
            }
        }
        the_loop_finds_what_the_measurers_found(&run.bench);
    }
}
