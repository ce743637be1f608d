//! Broken sessions hide no other: what a sound campaign gives does not change when sessions broken in every way lie beside it.

use crate::formats::fixture;
use crate::support::{Bench, files};
use std::collections::BTreeMap;

/// Begins the folder and the id of every broken session, so that its lines are found in tables.
const BROKEN: &str = "broken-";

fn session(id: &str) -> String {
    format!(
        r#"schema = "bpa-session/1"
id = "{id}"
kind = "isometric"
sampling = "timeseries"
campaign = "small"

[specimen]
id = "a"
diameter_mm = 10
rest_length_mm = 112
contracted_length_mm = 94.08

[setup]
length_mm = 112

[columns]
force = {{ index = 0, unit = "N" }}
pressure = {{ index = 1, unit = "kPa" }}
time = {{ index = 2, unit = "s" }}

[[log]]
file = "log"
"#
    )
}

/// A log of so many rows.
fn rows(count: usize, row: impl Fn(usize) -> String) -> Vec<u8> {
    (0..count)
        .map(|k| row(k) + "\n")
        .collect::<String>()
        .into_bytes()
}

/// Logs that are none, each with what is said of it.
fn logs() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    let noise = |k: usize| (k.wrapping_mul(2_654_435_761) >> 7) as u8;
    let huge = rows(2000, |k| format!("1e308,-1e308,{}", k as f64 * 1e300));
    let cut = |name: &str| {
        let bytes = fixture(name);
        bytes[..bytes.len() / 2].to_vec()
    };
    vec![
        ("garbage", (0..50_000).map(noise).collect(), "UTF-8"),
        ("empty", Vec::new(), "an empty file"),
        ("blank", b"\n\n  \n".to_vec(), "an empty file"),
        ("huge", huge, "no steady reading"),
        (
            "infinite",
            rows(500, |_| "inf,nan,1e999".to_owned()),
            "a finite number",
        ),
        (
            "words",
            rows(500, |_| "no,number,here".to_owned()),
            "a finite number",
        ),
        (
            "narrow",
            rows(500, |k| k.to_string()),
            "a column with index",
        ),
        ("wide", vec![b','; 1 << 17], "a line of more than"),
        (
            "utf-8",
            b"1,2,3\n\xff\xfe,2,3\n".to_vec(),
            "log:2: found bytes that are not UTF-8",
        ),
        ("zeros", vec![0; 1 << 16], ""),
        ("gzip", cut("points.csv.gz"), "a damaged gzip archive"),
        ("workbook", cut("workbook.xlsx"), "an Excel workbook"),
        ("matlab", cut("structure.mat"), "a MATLAB file of level 5"),
        ("matlab73", cut("v73.mat"), "a MATLAB file of version 7.3"),
        ("parquet", cut("frame.parquet"), "a Parquet file"),
        (
            "xls",
            b"\xd0\xcf\x11\xe0 and so on".to_vec(),
            "an old Excel workbook",
        ),
    ]
}

/// Descriptions that are none.
fn descriptions() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    vec![
        ("toml-empty", Vec::new(), "found nothing"),
        ("toml-syntax", b"schema = [[[".to_vec(), "`key = value`"),
        (
            "toml-utf8",
            b"schema = \"\xff\"".to_vec(),
            "save the file as UTF-8",
        ),
        ("toml-noise", vec![0xfe; 4096], "save the file as UTF-8"),
        (
            "toml-deep",
            b"a = ".iter().copied().chain(vec![b'['; 100_000]).collect(),
            "`key = value`",
        ),
        ("toml-large", vec![b'#'; 2 << 20], "not data"),
    ]
}

/// Puts a session of every broken kind below `raw/`; what has to be said of each.
fn break_everything(bench: &Bench) -> Vec<(String, &'static str)> {
    let mut said = Vec::new();
    let folder = |name: &str| format!("{BROKEN}{name}");
    for (name, log, message) in logs() {
        bench.write(
            &format!("{}/session.toml", folder(name)),
            session(&folder(name)),
        );
        bench.write(&format!("{}/log", folder(name)), log);
        said.push((folder(name), message));
    }
    for (name, text, message) in descriptions() {
        bench.write(&format!("{}/session.toml", folder(name)), text);
        said.push((folder(name), message));
    }
    for (name, message) in [("missing", "no such file"), ("folder", "found a folder")] {
        bench.write(
            &format!("{}/session.toml", folder(name)),
            session(&folder(name)),
        );
        said.push((folder(name), message));
    }
    std::fs::create_dir(bench.raw().join(folder("folder")).join("log")).unwrap();
    let toml_folder = bench.raw().join(folder("toml-folder")).join("session.toml");
    std::fs::create_dir_all(toml_folder).unwrap();
    said.push((folder("toml-folder"), "something that is not a file"));
    bench.write(
        &format!("{}/session.toml", folder("twin")),
        session(&folder("garbage")),
    );
    said.push((folder("twin"), "an id that no other session has"));
    said.extend(system::break_more(bench, &folder, &session));
    said
}

/// What only some systems can break.
#[cfg(unix)]
mod system {
    use super::Bench;
    use std::os::unix::fs::{PermissionsExt, symlink};

    pub fn break_more(
        bench: &Bench,
        folder: &dyn Fn(&str) -> String,
        session: &dyn Fn(&str) -> String,
    ) -> Vec<(String, &'static str)> {
        let mut said = Vec::new();
        let mut log_of = |name: &str, message| {
            bench.write(
                &format!("{}/session.toml", folder(name)),
                session(&folder(name)),
            );
            said.push((folder(name), message));
            bench.raw().join(folder(name)).join("log")
        };
        symlink(
            "log",
            log_of("link-loop", "a link that leads to itself or to nothing"),
        )
        .unwrap();
        symlink(
            "nowhere",
            log_of("link-nowhere", "a link that leads to itself or to nothing"),
        )
        .unwrap();
        symlink(
            "/dev/zero",
            log_of("device", "something that is not a file"),
        )
        .unwrap();
        let pipe = log_of("pipe", "something that is not a file");
        let made = std::process::Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap();
        assert!(made.success());
        // Root may read it all the same: then it is an empty log.
        let locked = log_of("locked", "");
        std::fs::write(&locked, "").unwrap();
        std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o000)).unwrap();
        let above = bench.raw().join(folder("folder-loop"));
        std::fs::create_dir(&above).unwrap();
        symlink("..", above.join("up")).unwrap();
        said.push((folder("folder-loop"), "a link to a folder above itself"));
        said
    }
}

#[cfg(not(unix))]
mod system {
    use super::Bench;

    pub fn break_more(
        _: &Bench,
        _: &dyn Fn(&str) -> String,
        _: &dyn Fn(&str) -> String,
    ) -> Vec<(String, &'static str)> {
        Vec::new()
    }
}

/// The tables without the lines of broken sessions, and without that of digests: a fit has the broken sessions among its inputs, though
/// they give no rows.
fn tables(bench: &Bench) -> BTreeMap<String, Vec<String>> {
    let folder = bench.root().join("reports/tables");
    let csv = files(&folder)
        .into_iter()
        .filter(|f| f.extension().is_some_and(|e| e == "csv"));
    csv.filter(|file| !file.ends_with("provenance.csv"))
        .map(|file| {
            let text = std::fs::read_to_string(&file).unwrap();
            let kept = text
                .lines()
                .filter(|l| !l.contains(BROKEN))
                .map(ToOwned::to_owned);
            (
                file.file_name().unwrap().display().to_string(),
                kept.collect(),
            )
        })
        .collect()
}

#[test]
fn broken_sessions_of_every_kind_hide_nothing_of_the_sound_ones() {
    let (sound, mixed) = (Bench::small_done(), Bench::small());
    let broken = break_everything(&mixed);
    let beside = mixed.run(&["run", "--verbose"]);
    assert_eq!(beside.code, 0, "{}", beside.err);
    for (folder, message) in &broken {
        let about: Vec<&str> = beside
            .err
            .lines()
            .chain(beside.out.lines())
            .filter(|l| l.contains(folder.as_str()))
            .collect();
        assert!(!about.is_empty(), "nothing is said of {folder}");
        assert!(
            about.iter().any(|l| l.contains(message)),
            "{folder}: {message:?} is not in {about:#?}"
        );
    }
    let (alone, beside) = (tables(&sound), tables(&mixed));
    assert!(alone.len() > 10);
    for (name, lines) in &alone {
        assert_eq!(beside.get(name), Some(lines), "{name}");
    }
    let rejected = |folder: &str| {
        mixed
            .table("rejects")
            .iter()
            .any(|r| r["session"].contains(folder))
    };
    for (folder, _) in broken
        .iter()
        .filter(|(f, _)| !f.ends_with("folder-loop") && !f.ends_with("twin"))
    {
        assert!(rejected(folder), "{folder} is in no line of rejects.csv");
    }
}
