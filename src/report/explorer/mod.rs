//! `explorer.html`: every reading in one file that a browser opens without server or network.
//!
//! The page is put together here: its text and scripts stand in `page/`, the library that draws axes in `uplot/` (MIT, vendored: a page that
//! works without network carries it). Data are in the page as JSON with base64 columns ([`encode`]); what is shown of them is decided in the browser.
//! No number is computed but what a drawing needs: the lowest and highest sample of every stretch of a log ([`trace`]). Of a large laboratory
//! the page has an even share ([`sample`]), says so, and names the command that makes one campaign in full.

pub mod answers;
pub mod encode;
pub mod labels;
pub mod readings;
pub mod sample;
pub mod trace;

use crate::input::ReportInput;
use answers::Answer;
use pipeline_base::error::{Error, Result};
use pipeline_base::row;
use readings::Set;
use sample::Extent;
use serde::Serialize;
use std::collections::BTreeMap;
use trace::{Log, Trace};

/// What tells such a page from other files.
pub const MARK: &str = "<meta name=\"generator\" content=\"pipeline explorer\">";

/// Name of the file below `reports/`.
pub const FILE: &str = "explorer.html";

const TEMPLATE: &str = include_str!("page/page.html");
/// What the marks of the template stand for.
const PARTS: [(&str, &str); 4] = [
    ("/*uplot.css*/", include_str!("uplot/uPlot.min.css")),
    ("/*style*/", include_str!("page/style.css")),
    ("/*uplot.js*/", include_str!("uplot/uPlot.iife.min.js")),
    (
        "/*scripts*/",
        concat!(
            include_str!("page/data.js"),
            include_str!("page/state.js"),
            include_str!("page/marks.js"),
            include_str!("page/scatter.js"),
            include_str!("page/reading.js"),
            include_str!("page/controls.js"),
            include_str!("page/answers.js"),
            include_str!("page/main.js")
        ),
    ),
];
/// Where the data go; last, so that nothing in them is taken for a mark.
const DATA: &str = "/*data*/";

/// Everything on the page.
#[derive(Serialize)]
struct Page<'a> {
    schema: &'static str,
    version: &'static str,
    input: &'a str,
    /// The campaign, where it is in full.
    campaign: Option<&'a str>,
    sets: Vec<Set>,
    sessions: BTreeMap<&'a str, Session<'a>>,
    traces: &'a [Trace],
    answers: Vec<Answer>,
}

/// What is known of a session.
#[derive(Serialize)]
struct Session<'a> {
    kind: &'static str,
    date: Option<&'a str>,
    exclude: Option<&'a str>,
    notes: Option<&'a str>,
    simulated: bool,
    timed: bool,
}

/// The page.
///
/// # Errors
/// Data that cannot be written as JSON.
pub fn html(input: &ReportInput, extent: Extent) -> Result<String> {
    let sets = [
        readings::forces(input, extent),
        readings::torques(input, extent),
    ];
    let page = Page {
        schema: "bpa-explorer/1",
        version: env!("CARGO_PKG_VERSION"),
        input: &input.input_digest,
        campaign: match extent {
            Extent::Laboratory => None,
            Extent::Campaign(id) => Some(id),
        },
        sets: sets.into_iter().flatten().collect(),
        sessions: sessions(input, extent),
        traces: &input.logs,
        answers: answers::answers(input, extent),
    };
    let data = serde_json::to_string(&page).map_err(Error::internal)?;
    let begun = PARTS
        .iter()
        .fold(TEMPLATE.to_owned(), |text, (mark, part)| {
            text.replace(mark, part)
        });
    // A text that ends a script element would end the data.
    Ok(begun.replace(DATA, &data.replace('<', "\\u003c")))
}

/// Up to so many sessions the page has their notes: of thousands they would be most of it.
const MOST_NOTES: usize = 1000;

fn sessions<'a>(input: &'a ReportInput, extent: Extent) -> BTreeMap<&'a str, Session<'a>> {
    let sessions = input.sessions.iter().map(|s| &s.ingest.session);
    let shown: Vec<_> = sessions.filter(|s| extent.takes(&s.campaign)).collect();
    let with_notes = shown.len() <= MOST_NOTES;
    shown
        .into_iter()
        .map(|s| {
            let session = Session {
                kind: row::kind_name(s.kind),
                date: s.date.as_deref(),
                exclude: s.exclude.as_deref(),
                notes: s.notes.as_deref().filter(|_| with_notes),
                simulated: s.is_simulated(),
                timed: s.sampling == pipeline_base::session::Sampling::Timeseries,
            };
            (s.id.as_str(), session)
        })
        .collect()
}

/// The logs of which the page shows a trace: place of the session and name of the output that holds the samples, and the log with its plateaus.
pub fn logs_wanted<'a>(input: &'a ReportInput, extent: Extent) -> Vec<((usize, &'a str), Log<'a>)> {
    let mut plateaus: BTreeMap<(&str, &str), Vec<(i64, i64)>> = BTreeMap::new();
    for row in &input.rows {
        let of_log = plateaus.entry((&row.session, &row.log)).or_default();
        of_log.push((row.first_row, row.last_row));
    }
    let wanted = extent.logs(&input.sessions, &input.rows).into_iter();
    wanted
        .map(|(place, log)| {
            let session = &input.sessions[place].ingest;
            let header = &session.logs[log];
            let name = header.spec.name();
            let key = (session.session.id.as_str(), name.as_str());
            let mut plateaus = plateaus.get(&key).cloned().unwrap_or_default();
            plateaus.sort_unstable();
            let log = Log {
                session: &session.session.id,
                log: name.clone(),
                first_line: header.first_line,
                plateaus,
            };
            ((place, header.output.as_str()), log)
        })
        .collect()
}
