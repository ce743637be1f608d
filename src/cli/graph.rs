//! `pipeline graph`: the stages and artifacts of the last run as a drawing for Mermaid or Graphviz.

use crate::DONE;
use crate::args::ResultArgs;
use crate::print::{line, print_json};
use clap::ValueEnum;
use pipeline_base::error::Result;
use pipeline_run::STAGES;
use pipeline_run::ancestry::{Ancestry, Unit};
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};

/// Arguments of `graph`.
#[derive(Debug, clap::Args)]
pub struct GraphArgs {
    /// Where results are
    #[command(flatten)]
    pub results: ResultArgs,
    /// Language of the output
    #[arg(long, value_enum, default_value = "mermaid")]
    pub format: Format,
    /// One node per session, group and report instead of one per stage
    #[arg(long)]
    pub units: bool,
    /// Print nodes and edges as JSON
    #[arg(long)]
    pub json: bool,
}

/// What draws it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Mermaid, as in Markdown
    Mermaid,
    /// Graphviz
    Dot,
}

/// Nodes with their words, and edges between them.
#[derive(Debug, Default, PartialEq, Eq)]
struct Drawing {
    nodes: BTreeMap<String, String>,
    edges: BTreeSet<(String, String)>,
}

/// Prints the drawing.
pub fn command(args: &GraphArgs) -> Result<u8> {
    let places = args.results.places()?;
    let ancestry = Ancestry::load(&places.derived)?;
    let raw = ancestry
        .raw_files(ancestry.units.iter(), &places.reports)
        .len();
    let drawing = drawing(&ancestry, raw, args.units);
    if args.json {
        print_json(&json!({ "nodes": drawing.nodes, "edges": drawing.edges }))?;
        return Ok(DONE);
    }
    line(match args.format {
        Format::Mermaid => drawing.mermaid(),
        Format::Dot => drawing.dot(),
    });
    Ok(DONE)
}

fn drawing(ancestry: &Ancestry, raw_files: usize, each_unit: bool) -> Drawing {
    let id = |k: usize| {
        if each_unit {
            format!("u{k}")
        } else {
            ancestry.units[k].stage_name().to_owned()
        }
    };
    let mut drawing = Drawing::default();
    let mut made: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (k, unit) in ancestry.units.iter().enumerate() {
        let words = if each_unit {
            format!("{} {}", unit.stage_name(), unit.name)
        } else {
            let units = ancestry
                .units
                .iter()
                .filter(|u| u.stage == unit.stage)
                .count();
            format!("{} ({units})", unit.stage_name())
        };
        drawing.nodes.insert(id(k), words);
        drawing
            .edges
            .extend(unit.from.iter().map(|from| (id(*from), id(k))));
        if unit.reads_raw() {
            let words = format!("raw ({raw_files} files)");
            drawing.nodes.insert("raw".to_owned(), words);
            drawing.edges.insert(("raw".to_owned(), id(k)));
        }
        if unit.stage + 1 == STAGES.len() {
            for (node, name) in artifacts(unit) {
                drawing.edges.insert((id(k), node.clone()));
                made.entry(node).or_default().insert(name);
            }
        }
    }
    let words = |(node, names): (String, BTreeSet<String>)| {
        let words = match FOLDERS.contains(&node.as_str()) {
            true => format!("{node} ({})", names.len()),
            false => names.into_iter().collect(),
        };
        (node, words)
    };
    drawing.nodes.extend(made.into_iter().map(words));
    drawing
}

/// Folders below `reports/` of which the drawing says how many things are in them: one in several formats is one.
const FOLDERS: [&str; 2] = ["tables", "figures"];

/// What a unit leaves below `reports/`: node and name.
fn artifacts(report: &Unit) -> impl Iterator<Item = (String, String)> {
    let below = |name: &str| {
        let name = name.strip_prefix("reports/")?;
        let Some((folder, file)) = name.split_once('/') else {
            return Some((name.replace('.', "_"), name.to_owned()));
        };
        let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
        Some((folder.to_owned(), stem.to_owned()))
    };
    report.entry.outputs.keys().filter_map(move |n| below(n))
}

impl Drawing {
    fn mermaid(&self) -> String {
        let nodes = self
            .nodes
            .iter()
            .map(|(id, words)| format!("  {id}[\"{}\"]", words.replace('"', "'")));
        let edges = self
            .edges
            .iter()
            .map(|(from, to)| format!("  {from} --> {to}"));
        let lines: Vec<String> = std::iter::once("flowchart LR".to_owned())
            .chain(nodes)
            .chain(edges)
            .collect();
        lines.join("\n")
    }

    fn dot(&self) -> String {
        let nodes = self
            .nodes
            .iter()
            .map(|(id, words)| format!("  {id} [label={words:?}];"));
        let edges = self
            .edges
            .iter()
            .map(|(from, to)| format!("  {from} -> {to};"));
        let first = [
            "digraph pipeline {".to_owned(),
            "  rankdir=LR; node [shape=box];".to_owned(),
        ];
        let lines: Vec<String> = first
            .into_iter()
            .chain(nodes)
            .chain(edges)
            .chain(["}".to_owned()])
            .collect();
        lines.join("\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drawing_has_its_nodes_and_edges_in_both_languages() {
        let drawing = Drawing {
            nodes: [("a", "ingest (2)"), ("b", "clean (2)")]
                .map(|(k, v)| (k.to_owned(), v.to_owned()))
                .into(),
            edges: [("a".to_owned(), "b".to_owned())].into(),
        };
        assert_eq!(
            drawing.mermaid(),
            "flowchart LR\n  a[\"ingest (2)\"]\n  b[\"clean (2)\"]\n  a --> b"
        );
        assert!(
            drawing.dot().contains("a [label=\"ingest (2)\"];")
                && drawing.dot().ends_with("a -> b;\n}")
        );
    }
}
