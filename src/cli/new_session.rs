//! `pipeline new-session`: a look at a log, and a first `session.toml` for it.

use super::DONE;
use super::columns::{Align, aligned};
use super::draft_places;
use super::predict::PNG_DPI;
use super::print::{line, print_json};
use pipeline_base::diagnostics::{Diagnostic, Severity};
use pipeline_base::error::{Error, Result};
use pipeline_base::session::{Encoding, Part, PartKind, TextFormat};
use pipeline_config::Config;
use pipeline_draft::{Draft, Guess, text};
use pipeline_formats::discover::SESSION_FILE;
use pipeline_formats::overview::{overview, place};
use pipeline_formats::session_toml::FILL_IN;
use pipeline_formats::{log_file, session_toml, text_format};
use pipeline_report::figures::{files, log};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Arguments of `new-session`.
#[derive(Debug, clap::Args)]
pub struct NewSessionArgs {
    /// The log, in any of the formats; each of several becomes a session in a folder named after it (and after its folder where names clash)
    #[arg(required = true, value_name = "LOG")]
    pub files: Vec<PathBuf>,
    /// Folder for session.toml and the plot, or for the folders of several logs [default: a new folder named after the log, here]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Copy the log beside session.toml
    #[arg(long)]
    pub copy: bool,
    /// Lines above the header or first row of a text log
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub skip_rows: u64,
    /// Character encoding of a text log
    #[arg(long, value_enum, default_value = "utf-8")]
    pub encoding: Written,
    /// The sheet of a workbook [default: the first]
    #[arg(long, value_name = "NAME", conflicts_with = "variable")]
    pub sheet: Option<String>,
    /// The matrix or structure of a MATLAB file [default: its vectors, or the only one]
    #[arg(long, value_name = "NAME")]
    pub variable: Option<String>,
    /// Overwrite files from an earlier call
    #[arg(long)]
    pub force: bool,
    /// Print what was guessed as JSON
    #[arg(long)]
    pub json: bool,
}

/// Character encoding of a text log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Written {
    /// What nearly every program writes today
    #[value(name = "utf-8")]
    Utf8,
    /// ISO 8859-1
    #[value(name = "latin-1")]
    Latin1,
}

/// A draft with the files that are written of it, and where.
struct Looked {
    draft: Draft,
    out: PathBuf,
    files: Vec<(String, Vec<u8>)>,
}

/// Looks at the logs, writes what was guessed and says it.
///
/// # Errors
/// A log that cannot be read, and files that exist already.
pub fn command(args: &NewSessionArgs) -> Result<u8> {
    let folders = draft_places::folders(&args.files, args.out.as_deref())?;
    // A mistake in the configuration is a matter of the commands that need it.
    let raw = Config::load(None).unwrap_or_default().paths.raw;
    let looked = args.files.iter().zip(folders);
    let looked = looked.map(|(file, out)| look(args, file, out, &raw));
    let looked: Vec<Looked> = looked.collect::<Result<_>>()?;
    if !args.force {
        looked.iter().try_for_each(Looked::check_nothing_there)?;
    }
    if args.copy {
        let mut both = looked.iter().zip(&args.files);
        both.try_for_each(|(looked, file)| check_no_other_log(&looked.copy(), file))?;
    }
    for (looked, file) in looked.iter().zip(&args.files) {
        write(&looked.out, &looked.files)?;
        let copy = looked.copy();
        if args.copy && !copy.exists() {
            std::fs::copy(file, &copy).map_err(Error::io("write", &copy))?;
        }
    }
    match (args.json, &looked[..]) {
        (true, [one]) => print_json(&one.as_json())?,
        (true, all) => print_json(&all.iter().map(Looked::as_json).collect())?,
        (false, [one]) => print(&one.draft, &one.out, &one.files),
        (false, all) => all.iter().for_each(Looked::print_in_short),
    }
    Ok(DONE)
}

/// What is written of one log.
fn look(args: &NewSessionArgs, file: &Path, out: PathBuf, raw: &[PathBuf]) -> Result<Looked> {
    let draft = draft(args, file)?;
    let files = files_of(&draft, &draft_places::id(&out, raw, file))?;
    Ok(Looked { draft, out, files })
}

impl Looked {
    /// Where a copy of the log goes.
    fn copy(&self) -> PathBuf {
        self.out.join(&self.draft.file)
    }

    /// Refuses to overwrite a file.
    fn check_nothing_there(&self) -> Result<()> {
        let mut paths = self.files.iter().map(|(name, _)| self.out.join(name));
        match paths.find(|path| path.exists()) {
            None => Ok(()),
            Some(path) => Err(Error::Usage(format!(
                "{} exists already; nothing was written: choose another folder with --out, or overwrite it with --force",
                path.display()
            ))),
        }
    }

    fn as_json(&self) -> Value {
        let paths = self.files.iter();
        let paths: Vec<String> = paths
            .map(|(n, _)| self.out.join(n).display().to_string())
            .collect();
        as_json(&self.draft, &paths)
    }

    /// One line: what was found, and what was not.
    fn print_in_short(&self) {
        let found = self.draft.guesses.iter().filter_map(|g| g.quantity);
        let found: Vec<&str> = found.map(|q| q.quantity_name).collect();
        let missing = self.draft.missing();
        let missing = match missing.is_empty() {
            true => String::new(),
            false => format!("; not found: {}", missing.join(", ")),
        };
        line(format!(
            "{}: {}{missing}",
            self.out.join(SESSION_FILE).display(),
            found.join(", ")
        ));
    }
}

fn draft(args: &NewSessionArgs, file: &Path) -> Result<Draft> {
    let named = |kind, name: &Option<String>| name.clone().map(|name| Part { kind, name });
    let part = named(PartKind::Sheet, &args.sheet).or(named(PartKind::Variable, &args.variable));
    let shown = file.display().to_string();
    if !file.exists() {
        return Err(Error::Usage(missing(file)));
    }
    let refused = |d: Diagnostic| Error::Config(vec![d.with_severity(Severity::Error)]);
    let bytes = log_file::load(file, &shown).map_err(refused)?;
    let format = TextFormat {
        skip_rows: args.skip_rows,
        encoding: match args.encoding {
            Written::Utf8 => Encoding::Utf8,
            Written::Latin1 => Encoding::Latin1,
        },
    };
    let text = text_format::applied(&shown, &bytes, format).map_err(refused)?;
    let columns = overview(&shown, &text, part.as_ref()).map_err(|mut d| {
        if args.encoding == Written::Utf8 && text_format::lacks_encoding(&bytes) {
            d.hint = "give --encoding latin-1 if the log has umlauts, µ or °; else save it as CSV in UTF-8".into();
        }
        refused(d)
    })?;
    let name = file.file_name().unwrap_or_default();
    let mut draft = Draft::of(&name.to_string_lossy(), part, &columns);
    draft.format = format;
    Ok(draft)
}

/// That a log is missing, with where it was looked for.
fn missing(file: &Path) -> String {
    let shown = file.display();
    let looked = match std::path::absolute(file) {
        Ok(path) if path != file => format!(" (looked for {})", path.display()),
        _ => String::new(),
    };
    format!(
        "the log {shown} is missing{looked}; nothing was written: check the path, or quote it if it has spaces"
    )
}

/// Refuses a copy where another log is, which no draft replaces.
fn check_no_other_log(copy: &Path, log: &Path) -> Result<()> {
    let read = |path: &Path| std::fs::read(path).map_err(Error::io("read", path));
    if copy.exists() && read(copy)? != read(log)? {
        return Err(Error::Usage(format!(
            "{} is another log than {}; nothing was written: choose another folder with --out",
            copy.display(),
            log.display()
        )));
    }
    Ok(())
}

/// Names and contents of what is written: the session, checked by its own reader, and the plot.
fn files_of(draft: &Draft, id: &str) -> Result<Vec<(String, Vec<u8>)>> {
    let session = text::session_toml(draft, id);
    if draft.missing().is_empty() {
        let completed = session.replace(FILL_IN, "");
        session_toml::read(SESSION_FILE, &completed).map_err(Error::Config)?;
    }
    let mut written = vec![(SESSION_FILE.to_owned(), session.into_bytes())];
    if let Some(figure) = log::figure(draft) {
        let drawn = files(&figure.draw()?, PNG_DPI)?;
        written.extend(
            drawn
                .into_iter()
                .filter(|(name, _)| !name.ends_with(".pdf")),
        );
    }
    Ok(written)
}

fn write(out: &Path, written: &[(String, Vec<u8>)]) -> Result<()> {
    std::fs::create_dir_all(out).map_err(Error::io("create", out))?;
    for (name, bytes) in written {
        let path = out.join(name);
        std::fs::write(&path, bytes).map_err(Error::io("write", &path))?;
    }
    Ok(())
}

fn print(draft: &Draft, out: &Path, written: &[(String, Vec<u8>)]) {
    let cell = |text: &str| text.to_owned();
    let head = ["column", "quantity", "unit", "from", "to", "because"].map(cell);
    let rows = draft.guesses.iter().map(|g| row(g).to_vec());
    let rows: Vec<Vec<String>> = std::iter::once(head.to_vec()).chain(rows).collect();
    let columns = [
        Align::Left,
        Align::Left,
        Align::Left,
        Align::Right,
        Align::Right,
        Align::Left,
    ];
    for text in aligned(&rows, &columns) {
        line(text);
    }
    let interval = draft.interval_s.map_or_else(String::new, |s| {
        format!(", every {} ms", text::short(1e3 * s))
    });
    line(format!(
        "\n{}: {} rows{interval}",
        text::sampling(draft.sampling),
        draft.rows
    ));
    for column in draft.missing() {
        line(format!("not found: {column}"));
    }
    let names: Vec<&str> = written.iter().map(|(name, _)| name.as_str()).collect();
    line(format!("wrote {} into {}", names.join(", "), out.display()));
    // A log that was copied lies beside it.
    let place = if names.contains(&draft.file.as_str()) {
        String::new()
    } else {
        format!(", put it beside {}", draft.file)
    };
    line(format!(
        "correct {SESSION_FILE} (lines with {FILL_IN}){place}, and `pipeline run`"
    ));
}

fn row(guess: &Guess) -> [String; 6] {
    let end = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.3}"));
    let range = guess.range();
    [
        place(&guess.position),
        guess.quantity.map_or("", |q| q.quantity_name).to_owned(),
        guess.unit.map_or("", |u| u.symbol).to_owned(),
        end(range.map(|r| r.0)),
        end(range.map(|r| r.1)),
        guess.why.clone(),
    ]
}

fn as_json(draft: &Draft, written: &[String]) -> Value {
    let column = |g: &Guess| {
        json!({
            "column": place(&g.position),
            "quantity": g.quantity.map(|q| q.quantity_name),
            "unit": g.unit.map(|u| u.symbol),
            "states": g.states.iter().map(|(raw, phase)| (raw.clone(), phase.name())).collect::<std::collections::BTreeMap<_, _>>(),
            "smallest": g.range().map(|r| r.0),
            "largest": g.range().map(|r| r.1),
            "not_numbers": g.not_numbers(),
            "because": g.why,
        })
    };
    json!({
        "log": draft.file,
        "rows": draft.rows,
        "sampling": text::sampling(draft.sampling),
        "interval_s": draft.interval_s,
        "columns": draft.guesses.iter().map(column).collect::<Vec<_>>(),
        "not_found": draft.missing(),
        "written": written,
    })
}
