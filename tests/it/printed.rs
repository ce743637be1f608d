//! The tables in LaTeX, as LaTeX takes them.

/// With a LaTeX: run by `.ci/run` where there is one.
mod latex {
    use crate::support::{Bench, files, outside_program};
    use std::path::PathBuf;
    use std::process::Command;

    /// A line that is wider than the page by less is that of a cell whose number is as wide as its column, pt.
    const NO_OVERFLOW_PT: f64 = 5.0;

    /// What LaTeX says of a table that does not fit.
    fn misfit(line: &str) -> bool {
        let wide = line.strip_prefix("Overfull \\hbox (");
        let wide = wide.and_then(|rest| rest.split_once("pt")?.0.parse::<f64>().ok());
        line.contains("Float too large")
            || line.starts_with("Overfull \\vbox")
            || wide.is_some_and(|pt| pt > NO_OVERFLOW_PT)
    }

    #[test]
    #[ignore = "needs pdflatex with array, booktabs, graphicx, rotating and siunitx"]
    fn every_table_compiles_and_fits_a_page_of_article() {
        let pdflatex = outside_program("PDFLATEX", "pdflatex", &["--version"]);
        let bench = Bench::small_done();
        let is_table = |file: &PathBuf| file.extension().is_some_and(|e| e == "tex");
        let tables = files(&bench.root().join("reports/tables"));
        let tables: Vec<PathBuf> = tables.into_iter().filter(is_table).collect();
        assert!(tables.len() > 20, "{tables:?}");
        let first = std::fs::read_to_string(&tables[0]).unwrap();
        let needs = first.lines().next().unwrap().trim_start_matches("% needs ");
        let input = |table: &PathBuf| format!("\\input{{{}}}\\clearpage\n", table.display());
        let inputs: String = tables.iter().map(input).collect();
        let document = format!(
            "\\documentclass{{article}}\n{needs}\n\\begin{{document}}\n{inputs}\\end{{document}}\n"
        );
        std::fs::write(bench.root().join("all.tex"), document).unwrap();
        let output = Command::new(pdflatex)
            .args(["-interaction=nonstopmode", "-halt-on-error", "all.tex"])
            .current_dir(bench.root())
            .output()
            .unwrap();
        let log = std::fs::read(bench.root().join("all.log")).unwrap();
        let log = String::from_utf8_lossy(&log);
        assert!(output.status.success(), "{log}");
        let misfits: Vec<&str> = log.lines().filter(|line| misfit(line)).collect();
        assert!(misfits.is_empty(), "{misfits:?}");
    }
}
