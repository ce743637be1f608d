"""Opens explorer.html of a run in Chromium and holds what it shows and does to the tables.

Usage: python tests/scripts/explorer_in_browser.py BROWSER PROJECT CAMPAIGN, after a run of PROJECT. Needs pandas, pyarrow and playwright.
"""

import base64
import json
import pathlib
import re
import struct
import sys

import pandas
from playwright.sync_api import sync_playwright

browser, project, campaign = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), sys.argv[3]
page_file = (project / "reports/explorer.html").as_uri()
rows = pandas.read_parquet(project / "derived/rows.parquet")
forces = rows[rows.force_n.notna()]
own = forces[forces.campaign == campaign]
comparison = pandas.read_csv(project / "reports/tables/model_comparison.csv")
findings = json.loads((project / "reports/findings.json").read_text())["campaigns"]
found = next(f for f in findings if f["campaign"] == campaign)


def number(text):
    """The first number in a text."""
    return float(re.search(r"[−-]?\d[\d.,]*(e[+-]?\d+)?", text).group().replace("−", "-").replace(",", ""))


def agree(text, value, what):
    """A number shown with four digits is the one in the table."""
    assert abs(number(text) - value) <= 6e-4 * max(abs(value), 1e-2), f"{what}: page {text!r}, table {value}"


def reading(key):
    session, log, row = key.split("|")
    found = forces[(forces.session == session) & (forces.log == log) & (forces.row == int(row))]
    assert len(found) == 1, key
    return found.iloc[0]


def key_in(page):
    return page.evaluate("new URLSearchParams(location.hash.slice(1)).get('reading')")


def opened(context, address, said):
    page = context.new_page()
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: request.url.startswith(("file:", "data:", "blob:")) or said.append(request.url))
    page.goto(address)
    page.wait_for_selector(".u-over")
    return page


def holds_numbers(page):
    page.select_option("#campaign", campaign) if page.locator("#campaign option").count() > 1 else None
    assert number(page.inner_text("#errors b >> nth=0")) == len(own)
    lines = comparison[comparison.campaign == campaign].set_index(["model", "split"])
    fitted = own[(own.excluded == 0) & (own.role.isna() | (own.role == "train"))]
    assert len(fitted) == len(own), "the campaign has readings that no fit takes: another expectation is needed here"
    for model, column, split in [("new", "predicted_new_unseen_n", "loso"), ("hunt2017", "predicted_hunt2017_n", "all")]:
        page.select_option("#model", column)
        agree(page.inner_text("#rmse"), lines.loc[(model, split), "rmse"], f"RMSE of {model}")
    for step, side in [("predicted_loop_before_n", "before"), ("predicted_loop_conditional_n", None)]:
        page.locator(f"#steps input[value={step}]").check(force=True)
        left = (own.force_n - own[step]).dropna()
        agree(page.inner_text("#rmse"), (left**2).mean() ** 0.5, step)
        if side:
            agree(page.inner_text("#rmse"), found[side]["rmse_train"], f"{step} in findings.json")
    budget = page.inner_text("#answers article >> nth=0")
    assert all(f"{source['rmse']:.3g}"[:3] in budget.replace(",", "") for source in found["budget"] if source["rmse"] >= 1), budget


def holds_filters(page):
    low, high = own.pressure_kpa.quantile([0.25, 0.75])
    page.fill("#low", f"{low:.6g}")
    page.fill("#high", f"{high:.6g}")
    page.locator("#high").press("Tab")
    between = own[(own.pressure_kpa >= float(f"{low:.6g}")) & (own.pressure_kpa <= float(f"{high:.6g}"))]
    assert abs(number(page.inner_text("#errors b >> nth=0")) - len(between)) <= 2
    specimen = sorted(own.specimen.unique())[0]
    page.locator("#specimens summary").click()
    page.get_by_label(f"only {specimen}", exact=True).click()
    assert number(page.inner_text("#errors b >> nth=0")) == (between.specimen == specimen).sum()
    page.locator("#table summary").click()
    page.wait_for_selector("#table tbody tr")
    assert page.locator("#table tbody tr").count() == min(200, (between.specimen == specimen).sum())
    page.locator("#table summary").click()
    page.click("#reset")


def holds_pointer(page):
    """Hover says the numbers of a reading, a click opens the same one, with its plateau in the log."""
    page.select_option("#model", "predicted_new_n")
    page.locator("#plot").scroll_into_view_if_needed()
    box = page.locator("#plot .u-over").bounding_box()
    for k in range(400):
        x, y = box["x"] + box["width"] * (0.05 + 0.9 * (k % 20) / 19), box["y"] + box["height"] * (0.05 + 0.9 * (k // 20) / 19)
        page.mouse.move(x, y)
        if page.locator("#tip").is_visible():
            break
    assert page.locator("#tip").is_visible(), "no mark under the pointer"
    tip = page.inner_text("#tip")
    page.mouse.click(x, y)
    page.wait_for_selector("#reading canvas")
    row = reading(key_in(page))
    assert row.specimen in tip and row.session in tip, tip
    shown = dict(zip(*[iter(tip.split("\n")[2:])] * 2))
    agree(shown["force"], row.force_n, "force")
    agree(shown["pressure"], row.pressure_kpa, "pressure")
    agree(shown["measured minus predicted"], row.force_n - row.predicted_new_n, "residual")
    panel = page.inner_text("#reading")
    assert f"lines {row.row} to {row.last_row}" in panel and row.log in panel and f"pipeline explain {row.session}" in panel, panel
    of_model = page.inner_text("#reading tr:has(th:text-is('Hunt 2017')) td >> nth=0")
    agree(of_model, row.predicted_hunt2017_n, "Hunt 2017")
    holds_trace(page, row)
    return panel


def holds_trace(page, row):
    said = page.get_attribute("#reading .trace", "aria-label")
    first, last = (number(part) for part in said.split("from")[1].split(" to "))
    assert first <= row.time_s <= last and last - first < 5, f"{said}; the reading is at {row.time_s} s"
    drawn = "c => { const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; return d.some((x, k) => k % 4 === 3 && x > 0); }"
    assert page.locator("#reading canvas").count() == 2
    assert page.locator("#reading canvas").first.evaluate(drawn)
    whole = page.locator("#reading canvas").first.screenshot()
    page.get_by_role("button", name="Near the plateau").click()
    page.wait_for_timeout(100)
    assert page.locator("#reading canvas").first.screenshot() != whole


def holds_keys(page):
    page.keyboard.press("Escape")
    assert page.locator("#reading").is_hidden()
    page.focus("#plot")
    page.keyboard.press("Home")
    page.keyboard.press("ArrowRight")
    first = page.inner_text("#live")
    assert first.startswith("Reading 2 of "), first
    page.keyboard.press("ArrowUp")
    assert page.inner_text("#live") != first
    page.keyboard.press("Enter")
    page.wait_for_selector("#reading canvas")
    assert reading(key_in(page)).session in page.inner_text("#live")


def holds_link(context, page, said):
    """The address alone brings the view back, zoom and open reading included."""
    page.select_option("#x", "contraction_rel")
    page.select_option("#colour", "pressure_kpa")
    page.fill("#low", "100")
    page.locator("#low").press("Tab")
    box = page.locator("#plot .u-over").bounding_box()
    at = lambda x, y: page.mouse.move(box["x"] + box["width"] * x, box["y"] + box["height"] * y)
    at(0.2, 0.2)
    page.mouse.down()
    at(0.5, 0.5)
    at(0.8, 0.8)
    page.mouse.up()
    page.wait_for_function("location.hash.includes('zoom')")
    other = opened(context, page.url, said)
    view = "[...document.querySelectorAll('#controls select, #controls input')].map(c => c.value).join()"
    view += " + document.querySelector('#errors').innerText + document.querySelector('#reading').innerText + location.hash"
    assert other.evaluate(view) == page.evaluate(view)
    assert "zoom" in other.url and other.locator("#reading canvas").count() == 2


def without(column):
    """A copy of the page, of which a column has no number."""
    text = (project / "reports/explorer.html").read_text()
    before, rest = text.split('id="data">', 1)
    data, after = rest.split("</script>", 1)
    data = json.loads(data)
    forces = data["sets"][0]
    empty = next(c for c in forces["columns"] if c["name"] == column)
    for key in ["levels", "u16"]:
        empty.pop(key, None)
    empty["f32"] = base64.b64encode(struct.pack("<f", float("nan")) * forces["count"]).decode()
    copy = project / "without.html"
    copy.write_text(f'{before}id="data">{json.dumps(data)}</script>{after}')
    return copy.as_uri()


def holds_reasons(context, said):
    """A model without values cannot be chosen, and an empty plot says why it is empty."""
    column = "predicted_hunt2017_n"
    page = opened(context, f"{without(column)}#model={column}", said)
    assert page.locator(f"#model option[value={column}]").is_disabled()
    assert page.locator("#model option[value=predicted_new_n]").is_enabled()
    errors = page.inner_text("#errors")
    assert errors.startswith("0 readings: Hunt 2017 has no value for the ") and "choose another model" in errors, errors
    page.select_option("#y", "force_n")
    page.fill("#low", "9999")
    page.locator("#low").press("Tab")
    assert page.inner_text("#errors") == "0 readings: none passes the filters", page.inner_text("#errors")
    page.close()


with sync_playwright() as playwright:
    chromium = playwright.chromium.launch(executable_path=browser, args=["--no-sandbox", "--disable-gpu"])
    papers = []
    for scheme in ["light", "dark"]:
        context = chromium.new_context(viewport={"width": 1300, "height": 900}, color_scheme=scheme)
        said = []
        page = opened(context, page_file, said)
        papers.append(page.evaluate("getComputedStyle(document.body).backgroundColor"))
        holds_numbers(page)
        holds_filters(page)
        page.select_option("#campaign", campaign) if page.locator("#campaign option").count() > 1 else None
        holds_pointer(page)
        holds_keys(page)
        holds_link(context, page, said)
        holds_reasons(context, said)
        assert not said, said
        context.close()
    assert papers[0] != papers[1], papers
    chromium.close()
print("as the tables")
