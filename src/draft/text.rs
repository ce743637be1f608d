//! The `session.toml` of a draft: what was guessed says so, and what a person has to fill in is marked.

use super::{Draft, Guess};
use pipeline_base::columns::{self, FORCE, KnownColumn, LENGTH};
use pipeline_base::session::{Encoding, Kind, Position, Sampling, TextFormat};
use pipeline_formats::session_toml::{FILL_IN, SCHEMA};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Samples at the lowest value, as a share, from which on the converter may clip there.
const CLIPPED_SHARE: f64 = 0.005;

/// The text of the file; `id` is that of the session to be.
pub fn session_toml(draft: &Draft, id: &str) -> String {
    let mut text = head(draft, id);
    text += SPECIMEN;
    if draft.kind == Kind::Isometric {
        text += if draft.quantity(LENGTH).is_none() {
            SETUP
        } else {
            SETUP_OF_LENGTHS
        };
    }
    if draft.kind == Kind::KneeTorque {
        text += JOINT;
    }
    text += &format_table(draft.format);
    text += &columns_table(draft);
    text += &log(draft);
    text
}

const SPECIMEN: &str = r#"
[specimen]
id = "specimen-1"            # FILL IN: the name of the physical actuator, the same in all of its sessions
diameter_mm = 10             # FILL IN: the uninflated inner diameter, in whole mm
rest_length_mm = 200         # FILL IN: the resting length, hose clamp to hose clamp
contracted_length_mm = 165   # FILL IN: the free length at 620 kPa without load
# How well these lengths are known, one standard deviation each: optional. Left out, the residual search
# takes 0.29 mm (rounded to 1 mm) for the resting length and estimates how contracted lengths scatter.
# rest_length_sd_mm = 0.5
# contracted_length_sd_mm = 1
"#;

const SETUP: &str = r#"
[setup]
length_mm = 200              # FILL IN: the length at which the actuator was held (no column looks like one)
# length_sd_mm = 0.5         # optional: how well it is known, one standard deviation; left out, the residual search estimates it
"#;

/// For a log with a column of lengths: the table is needed for nothing else.
const SETUP_OF_LENGTHS: &str = r#"
# [setup]
# length_sd_mm = 0.5         # optional: how well the lengths are known, one standard deviation; left out, the residual search estimates it
"#;

const JOINT: &str = r#"
[joint]
knee = "pinned"              # FILL IN: "pinned", "biomimetic", or "described" with file = "leg.toml"
muscle = "flexor"            # FILL IN: "flexor" or "extensor"
# How well the columns muscle_length and moment_arm are known that were measured by hand, one standard deviation each: optional; left out,
# the residual search estimates it, and takes 5 mm and 7 mm where there are fewer than 10.
# muscle_length_sd_mm = 5
# moment_arm_sd_mm = 7
"#;

fn head(draft: &Draft, id: &str) -> String {
    let (kind, sampling) = (kind(draft.kind), sampling(draft.sampling));
    let interval = match draft.interval_s {
        Some(s) => format!(
            "{} rows, {} ms apart in the median",
            draft.rows,
            short(1e3 * s)
        ),
        None => format!("{} rows, no time column", draft.rows),
    };
    format!(
        r#"# Written by `pipeline new-session`: guesses from the log, to be corrected. What no log can tell is marked in capitals: fill it in and remove the
# mark. The session is left out while a mark remains.
schema = "{SCHEMA}"
id = {id}      # unique over all sessions
kind = "{kind}"         # guessed from the columns: "isometric" or "knee-torque"
sampling = "{sampling}"    # guessed: {interval}
campaign = "campaign-1"      # {FILL_IN}: what was measured together, with one rig set-up
"#,
        id = quoted(id),
    )
}

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Isometric => "isometric",
        Kind::KneeTorque => "knee-torque",
    }
}

/// The word of `session.toml` for how a log was taken.
pub fn sampling(sampling: Sampling) -> &'static str {
    match sampling {
        Sampling::Timeseries => "timeseries",
        Sampling::Points => "points",
    }
}

/// A text as TOML writes it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// What a text log needs before it is a table, where it needs anything.
fn format_table(format: TextFormat) -> String {
    let mut text = String::new();
    if format.skip_rows > 0 {
        let _ = writeln!(text, "skip_rows = {}", format.skip_rows);
    }
    if format.encoding == Encoding::Latin1 {
        text += "encoding = \"latin-1\"\n";
    }
    if text.is_empty() {
        text
    } else {
        format!("\n[format]\n{text}")
    }
}

fn columns_table(draft: &Draft) -> String {
    let mut text = String::from(
        "\n[columns]   # value = gain * logged + offset, in `unit`; add gain and offset where the log holds counts or volts\n",
    );
    let mut names = BTreeSet::new();
    for guess in &draft.guesses {
        text += &column(guess, &mut names);
    }
    for column in draft.missing() {
        if let Some(known) = columns::KNOWN.iter().find(|k| k.column == column) {
            text += &no_column(known);
        }
    }
    text
}

/// A quantity that is needed and that no column looks like, to be completed.
fn no_column(known: &KnownColumn) -> String {
    let name = known.quantity_name;
    let Some(quantity) = known.quantity else {
        return format!(
            "# {name} = {{ index = 0 }}   # {FILL_IN}: the column of the {name} (none looks like it)\n"
        );
    };
    let (usual, units) = (quantity.usual(), quantity.list_of_units());
    format!(
        "# {name} = {{ index = 0, unit = \"{usual}\" }}   # {FILL_IN}: the column of the {name} with its unit, one of {units} (none looks like it)\n"
    )
}

fn column(guess: &Guess, names: &mut BTreeSet<String>) -> String {
    let place = match &guess.position {
        Position::Index(index) => format!("index = {index}"),
        Position::Name(name) => format!("name = {}", quoted(name)),
    };
    let range = match guess.range() {
        Some((low, high)) => format!("logged {} to {}", short(low), short(high)),
        None => "words".to_owned(),
    };
    let Some(quantity) = guess.quantity else {
        return match &guess.position {
            Position::Name(name) => format!(
                "{} = {{ {place} }}   # {range}; {}\n",
                free_name(own_name(name), names),
                guess.why
            ),
            Position::Index(index) => {
                format!("# column_{index} = {{ {place} }}   # {range}; name it to carry it along\n")
            }
        };
    };
    let mut keys = vec![place];
    if let Some(unit) = guess.unit {
        keys.push(format!("unit = \"{}\"", unit.symbol));
    }
    if !guess.states.is_empty() {
        let states = guess.states.iter();
        let states = states.map(|(raw, phase)| format!("{} = \"{}\"", quoted(raw), phase.name()));
        let states: Vec<String> = states.collect();
        keys.push(format!("values = {{ {} }}", states.join(", ")));
    }
    let why = &guess.why;
    let note = if guess.doubtful {
        format!("{FILL_IN}: a quantity and unit that you have confirmed (guessed: {why}; {range})")
    } else {
        format!("{why}; {range}")
    };
    format!(
        "{} = {{ {} }}   # {note}{}\n",
        quantity.quantity_name,
        keys.join(", "),
        clipped(guess)
    )
}

/// A name for a column of the user's own: one that TOML needs no quotes for and the pipeline does not use itself.
fn own_name(name: &str) -> String {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '_'
        }
    };
    let name: String = name.trim().chars().map(plain).collect();
    let name = name.trim_matches('_');
    let taken = columns::is_reserved(name) || columns::by_quantity_name(name).is_some();
    match name {
        "" => "unnamed".to_owned(),
        name if taken => format!("logged_{name}"),
        name => name.to_owned(),
    }
}

/// The name, with a number behind it where it is taken.
fn free_name(name: String, taken: &mut BTreeSet<String>) -> String {
    let numbered = (2..).map(|n| format!("{name}_{n}"));
    let mut free = std::iter::once(name.clone()).chain(numbered);
    free.find(|n| taken.insert(n.clone())).unwrap_or(name)
}

/// A number with at most four decimals.
pub fn short(x: f64) -> String {
    let rounded = format!("{x:.4}");
    rounded
        .trim_end_matches('0')
        .trim_end_matches('.')
        .to_owned()
}

/// A note where a force stands at its lowest value suspiciously often.
fn clipped(guess: &Guess) -> String {
    let (Some(FORCE), Some((low, _))) = (guess.column(), guess.range()) else {
        return String::new();
    };
    let at_limit = guess.numbers.iter().filter(|x| **x == low).count();
    let share = at_limit as f64 / guess.numbers.len() as f64;
    if share < CLIPPED_SHARE || at_limit < 3 {
        return String::new();
    }
    format!(
        "\n# {:.1}% of its samples are at {low}: if the converter clips there, add saturation_low = {low}",
        100.0 * share
    )
}

fn log(draft: &Draft) -> String {
    let mut text = format!(
        "\n[[log]]   # of a workbook `sheet = \"Run 8\"` names the sheet, of a MATLAB file `variable = \"log\"` the variable\nfile = {}\n",
        quoted(&draft.file)
    );
    if let Some(part) = &draft.part {
        let _ = writeln!(text, "{} = {}", part.kind.key(), quoted(&part.name));
    }
    text += "# run = 1\n\n# A log without pressure, for the zero of the force channel:\n# [[log]]\n# file = \"offset.csv\"\n# role = \"zero\"\n";
    text
}
