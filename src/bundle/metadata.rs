//! `ro-crate-metadata.json`: the bundle, its files, the run and the program as linked data (RO-Crate 1.2, JSON-LD).

use crate::{About, Bundle, Contents, Packed, RAW, contents, kinds};
use pipeline_base::error::{Error, Result};
use pipeline_run::STAGES;
use serde_json::{Value, json};

/// Name of the file, by the standard.
pub(super) const NAME: &str = "ro-crate-metadata.json";
/// What a bundle is where its owner does not say it.
pub(super) const DESCRIPTION: &str = "Reports, tables, figures and tidy data that the program pipeline computed from raw test-rig sessions of braided pneumatic actuators, \
     with the configuration of the run and the SHA-256 of every raw file.";

const STANDARD: &str = "https://w3id.org/ro/crate/1.2";
const ROOT: &str = "./";
const RUN: &str = "#run";
const PROGRAM: &str = "#pipeline";
const NO_LICENSE: &str = "#no-license";

/// The metadata of a bundle.
///
/// # Errors
/// None for what can be written as JSON.
pub(super) fn of(bundle: &Bundle) -> Result<Vec<u8>> {
    let about = &bundle.about;
    let mut graph = vec![descriptor(), root(bundle), license(&about.license)];
    graph.extend(authors(about).into_iter().map(|(_, entity)| entity));
    graph.extend([program(about), run(bundle)]);
    graph.extend(folders(bundle).map(|folder| dataset(bundle, folder)));
    graph.extend(bundle.files.iter().map(file));
    let json = json!({ "@context": format!("{STANDARD}/context"), "@graph": graph });
    let mut bytes = serde_json::to_vec_pretty(&json).map_err(Error::internal)?;
    bytes.push(b'\n');
    Ok(bytes)
}

fn descriptor() -> Value {
    json!({
        "@id": NAME, "@type": "CreativeWork", "about": link(ROOT), "conformsTo": link(STANDARD),
        "name": "Metadata of this bundle",
    })
}

fn root(bundle: &Bundle) -> Value {
    let about = &bundle.about;
    let authors: Vec<Value> = authors(about).iter().map(|(id, _)| link(id)).collect();
    let mut root = json!({
        "@id": ROOT, "@type": "Dataset", "name": about.name, "description": about.description,
        "datePublished": date(about), "license": link(&license_id(&about.license)),
        "hasPart": parts(bundle, ""), "mentions": link(RUN),
    });
    if !authors.is_empty() {
        root["author"] = authors.into();
    }
    root
}

/// Year, month and day of the documents.
fn date(about: &About) -> String {
    let (year, month, day) = about.date;
    format!("{year:04}-{month:02}-{day:02}")
}

/// The address of a licence: an identifier of the SPDX list, or what is an address already.
fn license_id(license: &str) -> String {
    match license {
        "" => NO_LICENSE.to_owned(),
        address if address.contains("://") => address.to_owned(),
        spdx => format!("https://spdx.org/licenses/{spdx}.html"),
    }
}

fn license(license: &str) -> Value {
    let (name, description) = match license {
        "" => (
            "No license stated",
            "All rights are with the authors; ask them before this is used elsewhere.",
        ),
        license => (license, "The license of this bundle"),
    };
    json!({ "@id": license_id(license), "@type": "CreativeWork", "name": name, "description": description })
}

/// The authors with their identifiers.
fn authors(about: &About) -> Vec<(String, Value)> {
    let one = |(k, author): (usize, &pipeline_config::Author)| {
        let orcid = author.orcid.as_ref();
        let id = orcid.map_or_else(
            || format!("#author-{}", k + 1),
            |orcid| format!("https://orcid.org/{orcid}"),
        );
        let entity = json!({ "@id": id, "@type": "Person", "name": author.name });
        (id, entity)
    };
    about.authors.iter().enumerate().map(one).collect()
}

fn program(about: &About) -> Value {
    json!({
        "@id": PROGRAM, "@type": "SoftwareApplication", "name": "pipeline", "version": about.version, "url": link(contents::CITATION),
        "description": "From raw test-rig sessions of braided pneumatic actuators to tables, figures and reports",
    })
}

/// What the program did: raw files and options in, everything else out.
fn run(bundle: &Bundle) -> Value {
    let is_input = |f: &&Packed| f.path.starts_with(RAW) || f.path == contents::CONFIG;
    let files = bundle.files.iter().filter(|f| f.path != contents::CITATION);
    let (inputs, outputs): (Vec<&Packed>, Vec<&Packed>) = files.partition(is_input);
    let links = |files: Vec<&Packed>| files.into_iter().map(|f| link(&id(f))).collect::<Vec<_>>();
    json!({
        "@id": RUN, "@type": "CreateAction", "name": "pipeline run",
        "description": format!("Stages: {}", STAGES.join(", ")),
        "actionStatus": "http://schema.org/CompletedActionStatus",
        "instrument": link(PROGRAM), "object": links(inputs), "result": links(outputs),
    })
}

/// The folders that hold a file of the bundle.
pub(super) fn folders(bundle: &Bundle) -> impl Iterator<Item = &'static str> {
    let known = kinds::FOLDERS.iter().map(|(folder, _)| *folder);
    known.filter(|folder| is_there(bundle, folder))
}

fn dataset(bundle: &Bundle, folder: &str) -> Value {
    json!({
        "@id": folder, "@type": "Dataset", "name": folder, "description": kinds::of_folder(folder),
        "hasPart": parts(bundle, folder),
    })
}

fn is_there(bundle: &Bundle, folder: &str) -> bool {
    let files = bundle.files.iter();
    files
        .filter(|f| f.is_in_it())
        .any(|f| f.path.starts_with(folder))
}

/// Links to what a folder holds: its folders, and the files of none of these. Raw files that are only named belong to the root.
fn parts(bundle: &Bundle, folder: &str) -> Vec<Value> {
    let below = folders(bundle).filter(|f| home(f.trim_end_matches('/')) == folder);
    let files = bundle.files.iter().filter(|f| f.home() == folder);
    below.map(link).chain(files.map(|f| link(&id(f)))).collect()
}

/// The innermost known folder of a path; empty for the root.
fn home(path: &str) -> &'static str {
    let known = kinds::FOLDERS.iter().map(|(name, _)| *name);
    let holding = known.filter(|f| path.starts_with(f));
    holding.max_by_key(|f| f.len()).unwrap_or("")
}

impl Packed {
    /// Whether its bytes are in the bundle.
    fn is_in_it(&self) -> bool {
        !matches!(self.contents, Contents::Absent)
    }

    /// The folder that lists it.
    fn home(&self) -> &'static str {
        if self.is_in_it() {
            home(&self.path)
        } else {
            ""
        }
    }
}

fn file(file: &Packed) -> Value {
    let mut entity = json!({
        "@id": id(file), "@type": "File", "name": file.path, "description": kinds::description(&file.path),
        "encodingFormat": kinds::media_type(&file.path), "contentSize": file.size.to_string(), "sha256": file.digest.hex(),
    });
    if !file.is_in_it() {
        entity["localPath"] = file.path.clone().into();
    }
    entity
}

/// The identifier of a file: its path, or, where its bytes are not in the bundle, a name within the metadata.
fn id(file: &Packed) -> String {
    let mark = if file.is_in_it() { "" } else { "#" };
    let plain = |b: u8| b.is_ascii_alphanumeric() || b"-._~/".contains(&b);
    let encoded = file.path.bytes().map(|b| match plain(b) {
        true => char::from(b).to_string(),
        false => format!("%{b:02X}"),
    });
    format!("{mark}{}", encoded.collect::<String>())
}

fn link(id: &str) -> Value {
    json!({ "@id": id })
}
