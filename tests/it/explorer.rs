//! `reports/explorer.html`: one file, of bounded size, with the readings of the tables; and the page of one campaign.

use crate::support::Bench;
use serde_json::Value;
use std::path::Path;

/// The data in a page.
fn data(page: &Path) -> Value {
    let text = std::fs::read_to_string(page).unwrap();
    let (_, data) = text.split_once("id=\"data\">").unwrap();
    let (data, _) = data.split_once("</script>").unwrap();
    serde_json::from_str(data).unwrap()
}

#[test]
fn the_page_has_every_reading_and_loads_nothing() {
    let bench = Bench::quick_done();
    let page = bench.root().join("reports/explorer.html");
    let text = std::fs::read_to_string(&page).unwrap();
    assert!(text.contains("default-src 'none'"));
    assert!(!text.contains(" src=") && !text.contains("<link"));
    for mark in ["/*data*/", "/*style*/", "/*scripts*/"] {
        assert!(!text.contains(mark), "{mark}");
    }
    let data = data(&page);
    let readings = bench.table("plateaus").len();
    let set = &data["sets"][0];
    assert_eq!(set["count"], readings);
    assert_eq!(set["of"], readings);
    let logs = data["traces"].as_array().unwrap().len();
    assert!(logs > 0);
    let answers = data["answers"].as_array().unwrap();
    assert!(
        answers
            .iter()
            .any(|a| a["budget"].as_array().unwrap().len() > 2)
    );
}

#[test]
fn one_campaign_is_made_in_full_from_what_a_run_left() {
    let bench = Bench::quick_done();
    let whole = data(&bench.root().join("reports/explorer.html"));
    let campaign = bench.table("sessions")[0]["campaign"].clone();
    let explore = |campaign: &str, out: &str| {
        let config = crate::support::FAST;
        bench.run(&["explore", campaign, "--out", out, "--config", config])
    };
    let said = explore(&campaign, "page.html");
    assert_eq!(said.code, 0, "{}", said.err);
    let one = data(&bench.root().join("page.html"));
    assert_eq!(one["campaign"], campaign);
    assert_eq!(one["sets"], whole["sets"]);
    let said = explore("other", "page.html");
    assert_eq!(said.code, 2);
    said.warns_of(&["\"other\"", &campaign]);
    let said = explore(&campaign, "raw/page.html");
    assert_eq!(said.code, 2);
    said.warns_of(&["--out"]);
    let session = bench.raw().join("small");
    std::fs::rename(session, bench.raw().join("small2")).unwrap();
    std::fs::remove_dir_all(bench.root().join("derived/cache")).unwrap();
    let said = explore(&campaign, "page.html");
    assert_eq!(said.code, 2);
    said.warns_of(&["`pipeline run`"]);
}

#[test]
fn where_there_is_no_campaign_what_to_do_is_said() {
    let bench = Bench::empty();
    let explore = || bench.run(&["explore", "x", "--out", "page.html"]);
    let said = explore();
    assert_eq!(said.code, 2);
    said.warns_of(&["no session.toml below raw", "pipeline new-session"]);
    bench.write("a/session.toml", "");
    let said = explore();
    assert_eq!(said.code, 2);
    said.warns_of(&["no campaign is called \"x\"", "no session can be used"]);
}

/// In a browser: run by `.ci/run`, which fetches one.
mod browser {
    use super::*;
    use crate::support::outside_program;
    use std::process::Command;

    const SCRIPT: &str = "tests/scripts/explorer_in_browser.py";

    #[test]
    #[ignore = "needs Chromium, and Python with pandas, pyarrow and playwright"]
    fn pointer_keys_link_and_numbers_of_the_page() {
        let probe = ["-c", "import pandas, pyarrow, playwright"];
        let python = outside_program("PYTHON", "python3", &probe);
        let browser = outside_program("BROWSER", "chromium", &["--version"]);
        let bench = Bench::quick_done();
        let campaign = bench.table("sessions")[0]["campaign"].clone();
        let output = Command::new(python)
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join(SCRIPT))
            .arg(browser)
            .arg(bench.root())
            .arg(campaign)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{said}");
    }
}
