//! A run in which no file has changed asks no stage, and nothing that has changed is taken for unchanged.

use crate::support::{Bench, FAST, files};
use pipeline::base::digest::Digest;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Longer than what was written may change again without a new time stamp.
const SETTLING: Duration = Duration::from_millis(2200);
const NOTE: &str = "derived/cache/unchanged.jsonl";

fn run(bench: &Bench) -> String {
    let said = bench.run(&["run", "--config", FAST]);
    assert_eq!(said.code, 0, "{}", said.err);
    said.out
}

/// Exit code and lines of `status`.
fn status(bench: &Bench) -> (i32, String) {
    let said = bench.run(&["status", "--config", FAST]);
    (said.code, said.out)
}

/// Runs until the run has written down that the next has nothing to do.
fn settled(bench: &Bench) {
    for _ in 0..3 {
        run(bench);
        std::thread::sleep(SETTLING);
        run(bench);
        let before = fs::metadata(bench.root().join(NOTE)).and_then(|m| m.modified());
        run(bench);
        let after = fs::metadata(bench.root().join(NOTE)).and_then(|m| m.modified());
        if before.is_ok() && before.ok() == after.ok() {
            return;
        }
    }
    panic!("no run ends early");
}

fn logs(bench: &Bench) -> Vec<PathBuf> {
    let mut logs = files(&bench.raw());
    logs.retain(|f| f.file_name().is_some_and(|n| n == "test8.csv"));
    logs
}

/// Other contents of the same size, with the old time put back.
fn scribble(file: &Path) {
    let time = fs::metadata(file).unwrap().modified().unwrap();
    let mut bytes = fs::read(file).unwrap();
    let digit = bytes.iter().rposition(u8::is_ascii_digit).unwrap();
    bytes[digit] = if bytes[digit] == b'1' { b'2' } else { b'1' };
    fs::write(file, bytes).unwrap();
    let open = fs::File::options().write(true).open(file).unwrap();
    open.set_modified(time).unwrap();
}

fn swap(a: &Path, b: &Path) {
    let aside = a.with_extension("aside");
    fs::rename(a, &aside).unwrap();
    fs::rename(b, a).unwrap();
    fs::rename(aside, b).unwrap();
}

#[test]
fn every_change_of_a_file_is_seen_by_status_and_mended_by_the_run() {
    let bench = Bench::quick_done();
    settled(&bench);
    let good = bench.results();
    let log = logs(&bench)[0].clone();
    scribble(&log);
    assert_eq!(
        status(&bench).0,
        1,
        "other contents of the same size and time"
    );
    scribble(&log);
    settled(&bench);

    let (a, b) = (logs(&bench)[0].clone(), logs(&bench)[1].clone());
    swap(a.parent().unwrap(), b.parent().unwrap());
    let sessions = bench.raw().join("small");
    assert!(sessions.exists());
    assert_eq!(status(&bench).0, 1, "two folders that changed places");
    swap(a.parent().unwrap(), b.parent().unwrap());
    settled(&bench);

    let object = files(&bench.root().join("derived/cache/objects")).swap_remove(0);
    scribble(&object);
    run(&bench);
    for lost in ["reports/provenance.json", "derived/rows.parquet"] {
        fs::remove_file(bench.root().join(lost)).unwrap();
        let (code, said) = status(&bench);
        assert!(code == 1 && said.contains(lost), "{said}");
        run(&bench);
    }
    fs::remove_dir_all(bench.root().join("derived/sessions")).unwrap();
    let (code, said) = status(&bench);
    assert!(code == 1 && said.contains("derived/sessions/"), "{said}");
    run(&bench);
    settled(&bench);
    assert_eq!(status(&bench).0, 0);
    assert!(bench.results() == good, "not the same files again");
}

#[test]
fn what_a_removed_session_left_is_removed_and_what_others_put_there_stays() {
    let bench = Bench::quick_done();
    let sessions = bench.root().join("derived/sessions");
    let of = || fs::read_dir(&sessions).unwrap().count();
    let before = of();
    let gone = logs(&bench)[0].parent().unwrap().to_path_buf();
    let text = fs::read_to_string(gone.join("session.toml")).unwrap();
    let id = text
        .lines()
        .find_map(|l| l.strip_prefix("id = \""))
        .unwrap();
    let note = sessions.join(id.trim_end_matches('"')).join("note.txt");
    fs::write(&note, "mine").unwrap();
    fs::remove_dir_all(&gone).unwrap();
    run(&bench);
    assert_eq!(of(), before, "the note stays in its folder");
    assert_eq!(files(note.parent().unwrap()), std::slice::from_ref(&note));
    fs::remove_file(&note).unwrap();
    let other = logs(&bench)[0].parent().unwrap().to_path_buf();
    fs::remove_dir_all(other).unwrap();
    run(&bench);
    assert_eq!(of(), before - 2);
}

#[test]
fn provenance_has_the_digest_of_every_raw_file() {
    let bench = Bench::quick_done();
    let text = fs::read_to_string(bench.root().join("reports/provenance.json")).unwrap();
    let all = files(&bench.raw());
    assert!(all.iter().any(|f| f.ends_with("session.toml")));
    for file in &all {
        let digest = Digest::of(&fs::read(file).unwrap());
        assert!(text.contains(digest.hex()), "{}", file.display());
    }
    let session = all[0].parent().unwrap();
    let description = session.join("session.toml");
    let before = fs::read_to_string(&description).unwrap();
    fs::write(&description, format!("# a remark\n{before}")).unwrap();
    run(&bench);
    let text = fs::read_to_string(bench.root().join("reports/provenance.json")).unwrap();
    let digest = Digest::of(&fs::read(&description).unwrap());
    assert!(
        text.contains(digest.hex()),
        "a remark is a change of the file"
    );
    let artifact = "derived/sessions";
    let id = before
        .lines()
        .find_map(|l| l.strip_prefix("id = \""))
        .unwrap();
    let path = format!("{artifact}/{}/rows.parquet", id.trim_end_matches('"'));
    let said = bench.run(&["explain", &path, "--json"]);
    assert!(said.out.contains(digest.hex()), "{}{}", said.out, said.err);
}
