//! What the tests share: the binary, a small campaign, and looking at what a run left.

use pipeline::base::row::Row;
use pipeline::config::{DiagnoseOptions, FitOptions};
use pipeline::inference::fit::Setting;
use pipeline::simulate;
use pipeline::stages::diagnose::base::Base;
use pipeline::stages::diagnose::data::Data;
use pipeline::stages::diagnose::length_law::{self, Outcome};
use pipeline::stages::diagnose::mixed_law::MixedLaw;
use pipeline::stages::diagnose::{Declared, decision, draws, library, suited};
use pipeline::stages::fit::Group;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use tempfile::TempDir;

/// A simulated campaign that is small enough to be run many times.
const TRUTH: &str = r#"
schema = "bpa-truth/1"
campaign = "small"
seed = 3
date = "2026-01"
notes = "for tests"
diameter_mm = 10
coefficients = "published"
contractions = [0, 0.5]
runs = [8]
run_speed = [1]
sampling = "timeseries"

[[specimen]]
id = "a"
rest_length_mm = 112
contraction_max = 0.16

[[specimen]]
id = "b"
rest_length_mm = 233
contraction_max = 0.17

[[specimen]]
id = "c"
rest_length_mm = 382
contraction_max = 0.17

[rig]
rows = 4000
zero_rows = 400
fill_share = 0.2
vent_share = 0.45
"#;

/// The configuration of [`Bench::quick`].
pub const FAST: &str = "fast.toml";

/// A directory with `raw/`, where a test runs the program.
pub struct Bench {
    root: TempDir,
}

/// What the program said.
pub struct Said {
    pub code: i32,
    pub out: String,
    pub err: String,
}

impl Said {
    /// Fails unless the messages have all these parts.
    pub fn warns_of(&self, parts: &[&str]) {
        for part in parts {
            assert!(self.err.contains(part), "{part:?} is not in\n{}", self.err);
        }
    }
}

impl Bench {
    /// An empty `raw/`.
    pub fn empty() -> Self {
        let root = tempfile::tempdir().unwrap();
        std::fs::create_dir(root.path().join("raw")).unwrap();
        Self { root }
    }

    /// `raw/` with the small campaign: 3 specimens, 2 contractions, 1 run and a zero log each.
    pub fn small() -> Self {
        let bench = Self::empty();
        let truth = simulate::read_truth("small.toml", TRUTH).unwrap_or_else(|d| panic!("{d:?}"));
        simulate::write(
            &simulate::simulate(&truth),
            &bench.raw().join("small"),
            None,
            false,
        )
        .unwrap();
        bench.age();
        bench
    }

    /// The small campaign with the options [`FAST`]: what takes long in six sessions are resamples and pictures.
    pub fn quick() -> Self {
        let bench = Self::small();
        let options =
            "[fit]\nbootstrap_refits = 20\n[diagnose]\ndraws = 49\n[report]\npng_dpi = 20.0\n";
        std::fs::write(bench.root().join(FAST), options).unwrap();
        bench
    }

    pub fn root(&self) -> &Path {
        self.root.path()
    }

    pub fn raw(&self) -> PathBuf {
        self.root.path().join("raw")
    }

    /// Makes every raw file look as if it had been written long ago, as in a real tree.
    pub fn age(&self) {
        let long_ago = std::time::SystemTime::now() - std::time::Duration::from_secs(3600);
        for file in files(&self.raw()) {
            let open = std::fs::File::options().write(true).open(&file).unwrap();
            open.set_modified(long_ago).unwrap();
        }
    }

    /// Writes a file below `raw/`.
    pub fn write(&self, path: &str, contents: impl AsRef<[u8]>) {
        let path = self.raw().join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, contents).unwrap();
    }

    /// Runs the program here.
    pub fn run(&self, arguments: &[&str]) -> Said {
        said(
            Command::new(env!("CARGO_BIN_EXE_pipeline"))
                .args(arguments)
                .current_dir(self.root())
                .output()
                .unwrap(),
        )
    }

    /// Begins a run here, of which nobody hears.
    pub fn start(&self, arguments: &[&str]) -> Child {
        Command::new(env!("CARGO_BIN_EXE_pipeline"))
            .args(arguments)
            .current_dir(self.root())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    }

    /// What a run says of itself for programs (`--json`).
    pub fn outcome(&self, run: &[&str]) -> serde_json::Value {
        let said = self.run(&[run, &["--json"]].concat());
        let value = serde_json::from_str(&said.out);
        value.unwrap_or_else(|e| panic!("{e}: {}{}", said.out, said.err))
    }

    /// Permissions of a file or folder here.
    #[cfg(unix)]
    pub fn set_mode(&self, path: &str, mode: u32) {
        use std::os::unix::fs::PermissionsExt;
        let permissions = std::fs::Permissions::from_mode(mode);
        std::fs::set_permissions(self.root().join(path), permissions).unwrap();
    }

    /// Runs the program as somebody who may not do everything: root becomes nobody, with a copy of the program, for nobody may not even look
    /// into the folder of root's in which it may lie.
    #[cfg(unix)]
    pub fn run_unprivileged(&self, arguments: &[&str]) -> Said {
        use std::os::unix::fs::{MetadataExt, PermissionsExt};
        use std::os::unix::process::CommandExt;
        let place = tempfile::tempdir().unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_pipeline"));
        if std::fs::metadata(place.path()).unwrap().uid() == 0 {
            let copy = place.path().join("pipeline");
            std::fs::copy(env!("CARGO_BIN_EXE_pipeline"), &copy).unwrap();
            let permissions = std::fs::Permissions::from_mode(0o755);
            std::fs::set_permissions(place.path(), permissions).unwrap();
            command = Command::new(copy);
            command.uid(65534);
        }
        let command = command.args(arguments).current_dir(self.root());
        said(command.output().unwrap())
    }

    /// Every file below a directory with its contents, by relative path.
    pub fn snapshot(&self, directory: &str) -> BTreeMap<String, Vec<u8>> {
        let root = self.root().join(directory);
        files(&root)
            .into_iter()
            .map(|f| {
                (
                    f.strip_prefix(&root).unwrap().display().to_string(),
                    std::fs::read(&f).unwrap(),
                )
            })
            .collect()
    }

    /// Every file of `reports/` and of `derived/` beside the cache, with its contents.
    pub fn results(&self) -> BTreeMap<String, Vec<u8>> {
        let mut all = self.snapshot("reports");
        let derived = self.snapshot("derived").into_iter();
        all.extend(derived.filter(|(name, _)| !name.starts_with("cache")));
        all
    }

    /// A table of the last run: header and rows, split at commas outside quotes.
    pub fn table(&self, name: &str) -> Vec<BTreeMap<String, String>> {
        read_table(
            &self
                .root()
                .join("reports/tables")
                .join(format!("{name}.csv")),
        )
    }
}

fn said(output: Output) -> Said {
    Said {
        code: output.status.code().unwrap_or(-1),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

/// All files below a directory, sorted.
pub fn files(root: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            if entry.path().is_dir() {
                folders.push(entry.path());
            } else {
                found.push(entry.path());
            }
        }
    }
    found.sort();
    found
}

/// A CSV table as rows by column name.
pub fn read_table(path: &Path) -> Vec<BTreeMap<String, String>> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut lines = text.lines();
    let header = fields(lines.next().unwrap());
    lines
        .map(|l| header.iter().cloned().zip(fields(l)).collect())
        .collect()
}

fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => fields.last_mut().unwrap().push(c),
        }
    }
    fields
}

/// A program that is no part of a Rust machine, from the environment variable or the path.
///
/// # Panics
/// If it does not answer to `probe`: a test that needs it is ignored (`mod outside`) unless it is asked for.
pub fn outside_program(variable: &str, usual: &str, probe: &[&str]) -> PathBuf {
    let program = std::env::var_os(variable).map_or_else(|| usual.into(), PathBuf::from);
    let answer = Command::new(&program).args(probe).output();
    let (shown, words) = (program.display(), probe.join(" "));
    let answer =
        answer.unwrap_or_else(|e| panic!("{shown} {words}: {e}; {variable} names another"));
    let said = String::from_utf8_lossy(&answer.stderr);
    assert!(
        answer.status.success(),
        "{shown} {words}: {said}; {variable} names another"
    );
    program
}

/// The laboratory's own sessions, which are not in the repository: the folder that `RIG_SESSIONS` names, or `../shared/rig`.
///
/// # Panics
/// If there is no such folder: a test that needs it is ignored (`mod rig`) unless it is asked for.
pub fn rig() -> PathBuf {
    let usual = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/rig");
    let rig = std::env::var_os("RIG_SESSIONS").map_or_else(usual, PathBuf::from);
    let is_there = rig.is_dir();
    assert!(
        is_there,
        "no sessions in {}: RIG_SESSIONS names another folder",
        rig.display()
    );
    rig
}

/// What a run of all the laboratory's sessions left, and said.
pub struct RigRun {
    pub bench: Bench,
    pub said: Said,
}

/// A run of all the laboratory's sessions, which takes minutes: one for all tests that want it at the same time, gone with the last of them.
pub fn rig_run() -> Arc<RigRun> {
    static CURRENT: Mutex<Weak<RigRun>> = Mutex::new(Weak::new());
    // A run that failed left nothing behind: the next test has its own, and its own message.
    let mut current = CURRENT.lock().unwrap_or_else(PoisonError::into_inner);
    current.upgrade().unwrap_or_else(|| {
        let bench = Bench::empty();
        let said = bench.run(&["run", "--raw", rig().to_str().unwrap()]);
        assert_eq!(said.code, 0, "{}", said.err);
        let run = Arc::new(RigRun { bench, said });
        *current = Arc::downgrade(&run);
        run
    })
}

/// The law of the mixed model that a search of some readings ends with.
pub fn searched_law(group: &Group, rows: &[&Row]) -> MixedLaw {
    searched(group.diameter_mm, rows, |outcome, setting| {
        let (problem, model) = (&outcome.problem, &outcome.found.model);
        MixedLaw::of(group, problem, setting, model, &[], None).unwrap()
    })
}

/// What follows from a search of some readings; nothing is set aside, and nothing is asked of it but this.
pub fn searched<T>(
    diameter_mm: u32,
    rows: &[&Row],
    asked: impl FnOnce(&Outcome, &Setting) -> T,
) -> T {
    let lengths: BTreeSet<u64> = rows.iter().map(|r| r.rest_length_m.to_bits()).collect();
    let base = Base::new(diameter_mm, true, lengths.len(), &FitOptions::default());
    let options = DiagnoseOptions::default();
    let data = Data::new(rows)
        .beside(&base)
        .with_placebo(options.seed)
        .thinned(options.most_readings);
    let library = library::terms(&data);
    let nobody = BTreeSet::new();
    let (problem, null) = suited(&base, &data, &library, &nobody, Declared::Taken);
    let laws = base.with_and_without_length_law();
    let normal = draws("draw", options.seed);
    let decision = decision(&options);
    let laws = laws.as_ref();
    let outcome = length_law::searched(problem, null, laws, &nobody, decision, &normal);
    asked(&outcome, &Setting::new(&outcome.problem))
}
