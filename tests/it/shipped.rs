//! The sessions in the repository's own `raw/`: what they are, and that they are what the truth files say.

use crate::support::{Bench, files, read_table};
use pipeline::simulate;
use std::collections::BTreeMap;
use std::path::Path;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_simulated_campaigns_are_what_their_truth_files_give() {
    for name in ["simulated-10mm", "simulated-20mm"] {
        let truth = std::fs::read_to_string(root().join(format!("truths/{name}.toml"))).unwrap();
        let truth = simulate::read_truth(name, &truth).unwrap_or_else(|d| panic!("{d:?}"));
        let directory = tempfile::tempdir().unwrap();
        simulate::write(
            &simulate::simulate(&truth),
            &directory.path().join("c"),
            None,
            false,
        )
        .unwrap();
        let (written, shipped) = (directory.path().join("c"), root().join("raw").join(name));
        let fresh = files(&written);
        assert_eq!(fresh.len(), files(&shipped).len());
        for file in fresh {
            let relative = file.strip_prefix(&written).unwrap();
            let same =
                std::fs::read(&file).unwrap() == std::fs::read(shipped.join(relative)).unwrap();
            assert!(
                same,
                "{name}/{} is not what the truth file gives",
                relative.display()
            );
        }
    }
}

#[test]
fn raw_is_small_and_every_simulated_session_says_so() {
    let all = files(&root().join("raw"));
    let sizes: Vec<u64> = all.iter().map(|f| f.metadata().unwrap().len()).collect();
    assert!(sizes.iter().sum::<u64>() < 15 << 20 && sizes.iter().all(|s| *s < 2_000_000));
    for file in all.iter().filter(|f| f.ends_with("session.toml")) {
        let text = std::fs::read_to_string(file).unwrap();
        let simulated = text.contains("notes = \"simulated");
        assert_eq!(
            simulated,
            file.to_string_lossy().contains("/raw/simulated-"),
            "{}",
            file.display()
        );
    }
}

/// Every campaign has its answer: in the file for programs, in the summary, in the tables, on paper and on the screen.
fn answers(out: &str, reports: &Path, summary: &serde_json::Value) {
    let pdf = std::fs::read(reports.join("residual.pdf")).unwrap();
    assert!(pdf.starts_with(b"%PDF") && pdf.len() > 50_000);
    assert!(out.contains("findings: "), "{out}");
    let findings = std::fs::read(reports.join("findings.json")).unwrap();
    let findings: serde_json::Value = serde_json::from_slice(&findings).unwrap();
    assert_eq!(crate::findings_schema::complaints(&findings), [""; 0]);
    let all = findings["campaigns"].as_array().unwrap();
    let joints = all.iter().filter(|c| c["kind"] == "knee-torque");
    assert_eq!(
        joints.count(),
        9,
        "one for each campaign, route and diameter"
    );
    let campaigns: Vec<_> = all.iter().filter(|c| c["kind"] == "isometric").collect();
    assert_eq!(
        campaigns.len(),
        4,
        "one for each campaign and diameter, none for those pooled"
    );
    let table = read_table(&reports.join("tables/findings.csv"));
    for (k, found) in campaigns.iter().enumerate() {
        let name = found["campaign"].as_str().unwrap();
        let verdict = found["verdict"].as_str().unwrap();
        assert_eq!(found["simulated"], name.starts_with("simulated"));
        assert_eq!(summary["verdicts"][k]["verdict"], verdict);
        assert!(
            !summary["verdicts"][k]["sentences"]
                .as_array()
                .unwrap()
                .is_empty()
        );
        let diameter = found["diameter_mm"].to_string();
        let of = |r: &&BTreeMap<String, String>| {
            r["campaign"] == name && r["diameter_mm"] == diameter && r["verdict"] == verdict
        };
        assert!(table.iter().any(|r| of(&r)), "{name}");
        let says = format!("{name}, {diameter} mm");
        assert!(out.lines().any(|line| line.starts_with(&says)), "{out}");
    }
}

/// Minutes: run by `.ci/run`.
mod long {
    use super::*;

    #[test]
    #[ignore = "long: 26 s of processor time"]
    fn the_main_job_gives_tables_figures_and_a_report_and_recovers_the_truth() {
        let bench = Bench::empty();
        let raw = root().join("raw");
        let said = bench.run(&["run", "--raw", raw.to_str().unwrap()]);
        assert_eq!(said.code, 0, "{}", said.err);
        let reports = bench.root().join("reports");
        let pdf = std::fs::read(reports.join("force.pdf")).unwrap();
        assert!(pdf.starts_with(b"%PDF") && pdf.len() > 100_000);
        for extension in ["csv", "tex", "typ", "md"] {
            assert!(
                reports
                    .join(format!("tables/model_comparison.{extension}"))
                    .is_file()
            );
        }
        for kind in [
            "f620",
            "rest",
            "isobars",
            "curves",
            "models",
            "predicted",
            "specimen-errors",
            "residuals",
        ] {
            for extension in ["svg", "pdf", "png"] {
                let name = format!("figures/{kind}-simulated-10mm.{extension}");
                assert!(reports.join(&name).is_file(), "{name}");
            }
        }
        let summary: serde_json::Value =
            serde_json::from_slice(&std::fs::read(reports.join("summary.json")).unwrap()).unwrap();
        assert_eq!(summary["sessions_used"].as_array().unwrap().len(), 56);
        let torque = std::fs::read(reports.join("knee.pdf")).unwrap();
        assert!(torque.starts_with(b"%PDF") && torque.len() > 100_000);
        answers(&said.out, &reports, &summary);
        let coefficients = read_table(&reports.join("tables/coefficients.csv"));
        let joint: Vec<_> = coefficients
            .iter()
            .filter(|r| {
                r["equation"] == "F(eps*, P*, l_rest)" && r["campaign"].starts_with("simulated")
            })
            .collect();
        assert_eq!(joint.len(), 10);
        for row in joint {
            let number = |name: &str| row[name].parse::<f64>().unwrap();
            assert!(
                number("ci_low") <= number("published") && number("published") <= number("ci_high"),
                "{row:?}"
            );
        }
    }
}
