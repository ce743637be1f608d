//! Raw formats: the same content gives the same tidy data, and what cannot be read is said in the format's own words.

use crate::support::Bench;
use pipeline::base::diagnostics::Diagnostic;
use pipeline::base::session::{Cells, Part, PartKind, Position};
use pipeline::formats::log::{self, RawLog, Request};
use std::collections::BTreeMap;
use std::path::Path;

/// A fixture of `tests/data/formats`, written by `tests/scripts/formats.py`.
pub fn fixture(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/formats");
    std::fs::read(folder.join(name)).unwrap()
}

/// The log in every format: file, the line of its [[log]] that names the part, and whether it holds the column of words.
const LOGS: &[(&str, &str, bool)] = &[
    ("points.csv", "", true),
    ("points.csv.gz", "", true),
    ("semicolon.csv", "", true),
    ("semicolon.csv.gz", "", true),
    ("tab.txt", "", true),
    ("tab.txt.gz", "", true),
    ("workbook.xlsx", "sheet = \"Run 8\"", true),
    ("vectors.mat", "", true),
    ("structure.mat", "variable = \"log\"", true),
    ("v73.mat", "", false),
    ("v73-compressed.mat", "", false),
    ("frame.parquet", "", true),
];

fn session(id: &str, file: &str, part: &str, bench: bool) -> String {
    let bench = if bench {
        "bench = { name = \"bench\" }"
    } else {
        ""
    };
    format!(
        r#"schema = "bpa-session/1"
id = "{id}"
kind = "isometric"
sampling = "points"
campaign = "formats"

[specimen]
id = "hand-l182"
diameter_mm = 10
rest_length_mm = 182
contracted_length_mm = 152

[columns]
length = {{ name = "length_mm", unit = "mm" }}
pressure = {{ name = "pressure_kpa", unit = "kPa" }}
force = {{ name = "force_n", unit = "N" }}
humidity = {{ name = "humidity" }}
{bench}

[[log]]
file = "{file}"
{part}
"#
    )
}

type Rows = Vec<BTreeMap<String, String>>;

/// The rows of one session, without what says where in which file they stand.
fn of_session(table: &Rows, id: &str) -> Rows {
    let mut rows: Rows = table
        .iter()
        .filter(|r| r["session"] == id)
        .cloned()
        .collect();
    for row in &mut rows {
        for place in ["session", "log", "first_row", "last_row", "row", "line"] {
            row.remove(place);
        }
    }
    rows
}

#[test]
fn the_same_content_in_every_format_gives_the_same_tidy_data() {
    let bench = Bench::empty();
    for (k, (file, part, words)) in LOGS.iter().enumerate() {
        bench.write(
            &format!("{k:02}/session.toml"),
            session(&format!("s{k:02}"), file, part, *words),
        );
        bench.write(&format!("{k:02}/{file}"), fixture(file));
    }
    let said = bench.run(&["run"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let (plateaus, rejects) = (bench.table("plateaus"), bench.table("rejects"));
    let reference = (of_session(&plateaus, "s00"), of_session(&rejects, "s00"));
    assert_eq!(reference.0.len(), 10);
    assert_eq!(reference.1.len(), 1, "the cell without a number is counted");
    for (k, (file, _, words)) in LOGS.iter().enumerate() {
        let id = format!("s{k:02}");
        let mut expected = reference.0.clone();
        if !words {
            for row in &mut expected {
                row.insert("bench".to_owned(), String::new());
            }
        }
        assert_eq!(of_session(&plateaus, &id), expected, "{file}");
        assert_eq!(of_session(&rejects, &id), reference.1, "{file}");
    }
}

fn by_name(names: &[&str]) -> Vec<Request> {
    names
        .iter()
        .map(|n| request(Position::Name((*n).to_owned())))
        .collect()
}

fn request(position: Position) -> Request {
    Request {
        name: "force_n".to_owned(),
        position,
        cells: Cells::Numbers,
        codes: Vec::new(),
    }
}

fn part(kind: PartKind, name: &str) -> Option<Part> {
    Some(Part {
        kind,
        name: name.to_owned(),
    })
}

fn read(file: &str, bytes: &[u8], part: Option<&Part>) -> Result<RawLog, Diagnostic> {
    log::read(file, bytes, part, &by_name(&["force_n"]))
}

#[test]
fn a_matrix_has_columns_by_index() {
    let requests = [request(Position::Index(2)), request(Position::Index(0))];
    let log = log::read("m", &fixture("matrix.mat"), None, &requests).unwrap();
    assert_eq!((log.columns[0][0], log.columns[1][0]), (388.25, 182.0));
    assert_eq!((log.columns[0].len(), log.bad_cells[0].line), (11, 5));
}

#[test]
fn what_a_file_holds_is_listed_where_the_part_is_wrong_or_missing() {
    let refused = |file: &str, part: Option<Part>| {
        read(file, &fixture(file), part.as_ref())
            .unwrap_err()
            .to_string()
    };
    let said = refused("workbook.xlsx", part(PartKind::Sheet, "Run 9"));
    assert!(
        said.contains("the sheets Notes, Run 8") && said.contains("\"Run 9\""),
        "{said}"
    );
    let said = refused("workbook.xlsx", None);
    assert!(said.contains("a column named \"force_n\""), "{said}");
    let said = refused("structure.mat", part(PartKind::Variable, "lug"));
    assert!(
        said.contains("log (a structure)") && said.contains("\"lug\""),
        "{said}"
    );
    let said = refused("points.csv", part(PartKind::Sheet, "Run 8"));
    assert!(said.contains("sheet = \"Run 8\""), "{said}");
    let said = refused("workbook.xlsx", part(PartKind::Variable, "log"));
    assert!(said.contains("`sheet`"), "{said}");
}

#[test]
fn damaged_and_foreign_files_are_refused_with_what_to_do() {
    for (file, expected) in [
        ("points.csv.gz", "a log compressed with gzip"),
        ("workbook.xlsx", "an Excel workbook (.xlsx)"),
        ("vectors.mat", "a MATLAB file of level 5"),
        ("structure.mat", "a MATLAB file of level 5"),
        ("v73.mat", "a MATLAB file of version 7.3"),
        ("frame.parquet", "a Parquet file"),
    ] {
        let bytes = fixture(file);
        let error = read(file, &bytes[..bytes.len() * 2 / 3], None).unwrap_err();
        assert_eq!(&*error.expected, expected, "{error}");
        assert!(!error.hint.is_empty());
    }
    let old = read("old.xls", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", None).unwrap_err();
    assert!(
        old.found.contains(".xls") && old.hint.contains(".xlsx"),
        "{old}"
    );
}
