//! What a file is, by its place and its ending.

/// Media types by ending; the last of a name counts.
const MEDIA: &[(&str, &str)] = &[
    ("cff", "application/yaml"),
    ("csv", "text/csv"),
    ("gz", "application/gzip"),
    ("html", "text/html"),
    ("json", "application/json"),
    ("mat", "application/x-matlab-data"),
    ("md", "text/markdown"),
    ("parquet", "application/vnd.apache.parquet"),
    ("pdf", "application/pdf"),
    ("png", "image/png"),
    ("svg", "image/svg+xml"),
    ("tex", "application/x-tex"),
    ("toml", "application/toml"),
    ("tsv", "text/tab-separated-values"),
    ("txt", "text/plain"),
    ("typ", "text/plain"),
    (
        "xlsx",
        "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
    ),
];

/// Endings of files that are compressed in themselves.
const COMPRESSED: &[&str] = &["gz", "parquet", "pdf", "png", "xlsx", "mat"];

/// Descriptions by the beginning and the end of a path; the first that fits.
const DESCRIPTIONS: &[(&str, &str, &str)] = &[
    ("CITATION.cff", "", "The program, and how to cite it"),
    ("pipeline.toml", "", "Every option of the run"),
    (
        "raw/",
        "session.toml",
        "Description of a session: what was measured, how, and its logs",
    ),
    (
        "raw/",
        "campaign.toml",
        "What the sessions of a campaign share",
    ),
    ("raw/", "", "A file of a raw session, as it was recorded"),
    (
        "reports/provenance.json",
        "",
        "The SHA-256 of every raw file, by session",
    ),
    (
        "reports/findings.json",
        "",
        "What the search of the residuals found, campaign by campaign (schema bpa-findings/2)",
    ),
    (
        "reports/summary.json",
        "",
        "Version, sessions used and rejected, verdicts, models, tables",
    ),
    ("reports/tables/", ".csv", "A table, full precision"),
    ("reports/tables/", "", "A table in print"),
    ("reports/figures/", ".csv", "What is drawn in a figure"),
    ("reports/figures/", "", "A figure"),
    (
        "reports/force.pdf",
        "",
        "Isometric force: what was measured, the models, what was found",
    ),
    (
        "reports/residual.pdf",
        "",
        "What the models lack, campaign by campaign, with the evidence",
    ),
    (
        "reports/knee.pdf",
        "",
        "Torque about the knee against the models",
    ),
    (
        "reports/supplement.pdf",
        "",
        "Sessions, specimens, intervals, statistics, provenance",
    ),
    (
        "reports/audit.pdf",
        "",
        "The papers' numeric claims, recomputed",
    ),
    ("reports/", "", "A report"),
    (
        "derived/rows.parquet",
        "",
        "Every steady reading with its specimen, contraction and pressure",
    ),
    (
        "derived/torque.parquet",
        "",
        "Every reading of torque with geometry and the torque of every model",
    ),
    (
        "derived/split.csv",
        "",
        "On which side of each split every reading lies",
    ),
    ("derived/fits.json", "", "Every fit with its refits"),
    (
        "derived/mixed_laws.json",
        "",
        "Every mixed model, as `pipeline predict` reads it",
    ),
    (
        "derived/layout.json",
        "",
        "How far the pages of the reports are filled",
    ),
    ("derived/", "", "Tidy data"),
];

/// The folders of a bundle, each with what it holds.
pub(super) const FOLDERS: &[(&str, &str)] = &[
    ("derived/", "Tidy data and fits, for other programs"),
    ("raw/", "Raw sessions, as they were recorded"),
    ("reports/", "Reports, tables, figures and findings"),
    (
        "reports/figures/",
        "Figures, each with the numbers that are drawn in it",
    ),
    (
        "reports/tables/",
        "Tables: CSV with full precision, the others for print",
    ),
];

/// The media type of a file.
pub(super) fn media_type(path: &str) -> &'static str {
    let ending = ending(path);
    let known = MEDIA.iter().find(|(e, _)| *e == ending);
    known.map_or("application/octet-stream", |(_, media)| media)
}

/// What a folder holds.
pub(super) fn of_folder(folder: &str) -> &'static str {
    let known = FOLDERS.iter().find(|(name, _)| *name == folder);
    known.map_or("", |(_, what)| what)
}

/// Whether compressing it again gains nothing.
pub(super) fn is_compressed(path: &str) -> bool {
    COMPRESSED.contains(&ending(path).as_str())
}

/// What it is, in a line.
pub(super) fn description(path: &str) -> &'static str {
    let fits =
        |(begin, end, _): &&(&str, &str, &str)| path.starts_with(begin) && path.ends_with(end);
    DESCRIPTIONS.iter().find(fits).map_or("A file", |d| d.2)
}

fn ending(path: &str) -> String {
    let file = path.rsplit('/').next().unwrap_or(path);
    let ending = file.rsplit_once('.').map_or("", |(_, ending)| ending);
    ending.to_ascii_lowercase()
}
