"""The report's page in a real browser: it loads, every control works, all can read it, it prints."""

from __future__ import annotations

import csv
import re

import pytest

from pounding_cli.laws.connector import Connector
from tests.helpers.page_study import FACTOR, KEPT, PEAKS, refuse
from tests.helpers.pages import choose

SWEEP = "sweep: {cases.gap.gap: [1 cm, 2 cm, 3 cm], impact.restitution: [0.4, 0.6]}\n"
MEAN = sum(PEAKS.values()) / 2


def cells(page, selector: str) -> list[list[str]]:
    """The texts of a table's body."""
    script = "rows => rows.map(row => [...row.cells].map(cell => cell.textContent))"
    return page.eval_on_selector_all(f"{selector} tbody tr", script)


def numbers_drawn(page) -> dict[tuple[str, str], str]:
    """Case and storey -> the number drawn."""
    return {(row[0], row[1]): row[2] for row in cells(page, "#explore-numbers")}


def test_the_title_is_text_and_nothing_else(study, visit):
    page = visit(study("moving", kept=KEPT) / "report.html")
    assert page.locator("h1").inner_text() == "Two buildings <known> & small"
    assert page.title() == "Two buildings <known> & small"


def test_the_page_begins_with_the_cases_side_by_side(moving):
    rows = {row[0].split()[0]: row for row in cells(moving, ".answer") if len(row) > 1}
    assert list(rows) == list(FACTOR)
    assert rows["touching"][1] == f"{FACTOR['touching'] * 2:.2f}storey 3"  # V/V0 of stiff, elastic
    assert rows["connected"][0] == "connected not meaningful"
    flags = moving.locator(".answer .flagged").all_inner_texts()
    assert flags == [
        "2 of 4 runs failed and are left out of the means",
        f"{Connector.beyond_gap}: elastic, 2 of 2 runs\n{Connector.beyond_gap}: inelastic, 2 of 2 runs",
    ]
    order = moving.eval_on_selector_all("main > header, main > section", "all => all.map(one => one.id)")
    assert order[:3] == ["overview", "explore", "motion"]
    assert order.index("claims") > 2
    assert moving.locator(".answer").bounding_box()["y"] < 400


def test_the_cases_of_three_buildings_fit_one_screen(study, visit):
    page = visit(study("three", group="soft, stiff, soft") / "report.html", 1400)
    table = page.locator(".answer table")
    assert table.locator("th[scope=colgroup]").all_inner_texts() == ["soft-1", "stiff", "soft-2"]
    assert page.locator(".answer").evaluate("one => one.scrollWidth <= one.clientWidth")
    box = table.bounding_box()
    assert box["y"] + box["height"] <= 900


def test_a_study_without_claims_has_no_section_of_them(study, visit):
    page = visit(study("plain", claims=False) / "report.html")
    assert page.locator("#claims").count() == 0
    assert "claim" not in page.locator("main").inner_text().lower()


@pytest.mark.parametrize("width", [1280, 400])
def test_axis_titles_stand_clear_of_the_ticks(moving, study, visit, width):
    page = visit(study("moving", kept=KEPT) / "report.html", width)
    for quantity in ("V_ratio", "V", "drift", "peak_force"):
        choose(page, "Quantity", quantity)
        boxes = page.eval_on_selector_all(
            "#explore-chart text",
            "all => all.map(one => [one.classList.contains('title'), one.getBoundingClientRect().toJSON()])",
        )
        titles, ticks = ([box for title, box in boxes if title == wanted] for wanted in (True, False))
        assert len(titles) == 2
        for title in titles:
            for tick in ticks:
                apart = title["right"] < tick["left"] or title["bottom"] < tick["top"] or title["top"] > tick["bottom"]
                assert apart, (quantity, title, tick)


def test_charts_draw_the_quantity_building_analysis_and_motion_chosen(moving):
    choose(moving, "Motion", "weak")
    drawn = numbers_drawn(moving)
    for case, factor in FACTOR.items():
        for storey in (1, 2, 3):
            assert drawn[case, str(storey)] == f"{factor * (1 + storey) / 2:.3f}"
    choose(moving, "Quantity", "V")
    choose(moving, "Building", "soft", "#explore")
    assert numbers_drawn(moving)["touching", "2"] == f"{1e3 * FACTOR['touching'] * 1.5 * PEAKS['weak']:.0f}"  # in kN
    assert ("touching", "3") not in numbers_drawn(moving)
    choose(moving, "Quantity", "peak_force")
    choose(moving, "Analysis", "inelastic")
    assert numbers_drawn(moving)["gap", "2"] == "2000"


def test_means_leave_failed_runs_out_and_say_so(moving):
    choose(moving, "Quantity", "V")
    rows = {(row[0], row[1]): row for row in cells(moving, "#explore-numbers")}
    assert rows["touching", "1"][2] == f"{1e3 * FACTOR['touching'] * MEAN:.0f}"
    low, high = (f"{1e3 * FACTOR['touching'] * peak:.0f}" for peak in (PEAKS["weak"], PEAKS["strong"]))
    assert rows["touching", "1"][3:5] == [low, high]
    assert rows["infill", "1"][2] == f"{1e3 * FACTOR['infill'] * PEAKS['weak']:.0f}"
    choose(moving, "Motion", "strong")
    assert {case for case, _ in numbers_drawn(moving)} == {"touching", "gap", "connected"}
    failed = moving.locator("#simulated").inner_text()
    assert "event bound reached" in failed
    assert "loosen the accuracy" in failed
    assert moving.locator(".tile.bad").inner_text().splitlines()[-1] == "2 failed"


def test_cases_can_be_taken_out_of_the_chart(moving):
    names = "lines => lines.map(line => line.dataset.series)"
    assert moving.eval_on_selector_all("#explore-chart g", names) == list(FACTOR)
    moving.get_by_label("gap", exact=True).uncheck()
    assert moving.eval_on_selector_all("#explore-chart g", names) == ["touching", "infill", "connected"]
    for case in ("touching", "infill", "connected not meaningful"):
        moving.get_by_label(case, exact=True).uncheck()
    assert "Nothing to draw" in moving.locator("#explore-chart").inner_text()


def test_hover_and_arrow_keys_give_the_numbers(moving):
    choose(moving, "Motion", "strong")
    chart = moving.locator("#explore-chart")
    chart.focus()
    chart.press("ArrowUp")
    chart.press("ArrowUp")
    chart.press("ArrowRight")
    tip = moving.locator("#explore-chart .tip")
    said = tip.inner_text().splitlines()
    assert said[0] == "gap, storey 2"
    assert said[1] == f"V/V₀ {FACTOR['gap'] * 1.5:.3f}"
    assert re.match(r"error (not measured|[\d.]+×10⁻\S+, sensitivity [\d.]+)$", said[-1]), said[-1]
    moving.wait_for_function("() => document.getElementById('said').textContent.startsWith('gap, storey 2')")
    chart.press("Escape")
    assert tip.is_hidden()
    box = moving.locator("#explore-chart g[data-series=touching] circle").last.bounding_box()
    moving.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    assert tip.inner_text().splitlines()[0] == "touching, storey 3"


def test_tables_sort_filter_and_search(moving):
    moving.get_by_role("button", name="Storeys").click()
    head = moving.locator("#table-view th", has_text="V [kN]").first
    assert head.get_attribute("aria-sort") == "none"
    head.get_by_role("button").click()
    assert head.get_attribute("aria-sort") == "ascending"
    column = [text for text in moving.locator("#table-view th").all_inner_texts()].index("V [kN]")
    values = [float(row[column]) for row in cells(moving, "#table-view")]
    assert values == sorted(values)
    head.get_by_role("button").press("Enter")
    assert head.get_attribute("aria-sort") == "descending"
    assert moving.evaluate("document.activeElement.textContent") == "V [kN]"
    values = [float(row[column]) for row in cells(moving, "#table-view")]
    assert values[0] == pytest.approx(1e3 * FACTOR["touching"] * 2 * PEAKS["strong"])
    assert values == sorted(values, reverse=True)
    choose(moving, "case", moving.locator("#table-view").get_by_label("case").evaluate(
        "list => [...list.options].find(one => one.text === 'infill').value"), "#table-view")  # fmt: skip
    assert moving.locator("#table-view .count").inner_text().startswith("20 of 20 rows")
    moving.get_by_label("Search").fill("weak")
    assert moving.locator("#table-view .count").inner_text().startswith("10 of 10 rows")
    moving.get_by_label("Search").fill("nowhere")
    assert moving.locator("#table-view .count").inner_text().startswith("0 of 0 rows")


def test_missing_numbers_stay_below_whichever_way_a_table_is_sorted(moving):
    moving.get_by_role("button", name="Storeys").click()
    moving.get_by_role("button", name="Show 30 more").click()
    head = moving.locator("#table-view th", has_text="V [kN]").first.get_by_role("button")
    column = moving.locator("#table-view th").all_inner_texts().index("V [kN]")
    for _ in range(2):
        head.click()
        moving.get_by_role("button", name="Show 30 more").click()
        texts = [row[column] for row in cells(moving, "#table-view")]
        assert texts.count("–") == 10
        assert set(texts[-10:]) == {"–"}


def test_error_and_sensitivity_stand_in_every_table_of_numbers(moving):
    for table in ("Means over the motions", "Storeys", "Floors", "Links", "Runs"):
        moving.get_by_role("button", name=table).click()
        heads = " ".join(moving.locator("#table-view th").all_inner_texts())
        assert "error" in heads, table
        assert "sensitivity" in heads, table


def test_chosen_rows_can_be_taken_away(moving):
    moving.get_by_role("button", name="Links").click()
    choose(moving, "analysis", "0", "#table-view")
    with moving.expect_download() as waiting:
        moving.get_by_role("button", name="Save as CSV").click()
    assert waiting.value.suggested_filename == "link.csv"
    lines = waiting.value.path().read_text(encoding="utf-8").splitlines()
    assert len(lines) == 1 + 2 * (2 + 2 + 2 + 1)
    row = dict(zip(lines[0].split(","), lines[1].split(","), strict=True))
    assert row["case"] == "touching"
    assert float(row["peak force [kN]"]) == 1000


def test_a_saved_table_has_no_text_that_a_spreadsheet_would_calculate(study, visit):
    names = {"touching": '=HYPERLINK("http://x")', "gap": "+1", "infill": "@SUM(A1)", "connected": "-1+1"}
    page = visit(study("formulas", renamed=names, claims=False) / "report.html")
    page.get_by_role("button", name="Links").click()
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Save as CSV").click()
    rows = list(csv.DictReader(waiting.value.path().read_text(encoding="utf-8").splitlines()))
    assert {row["case"] for row in rows} == {f"'{name}" for name in names.values()}
    forces = {row["peak force [kN]"] for row in rows}
    assert forces == {"1000", "2000", ""}  # numbers are left as they are


def test_the_page_s_policy_allows_its_own_style_and_scripts_only(study, visit, browser):
    """`visit` sees a violation by the page itself as an error on the console."""
    file = study("moving", kept=KEPT) / "report.html"
    page = visit(file)
    policy = page.locator("meta[http-equiv='Content-Security-Policy']").get_attribute("content")
    assert "unsafe" not in policy
    assert page.evaluate("getComputedStyle(document.querySelector('.skip')).position") == "absolute"  # styled
    injected = browser.new_page()  # what a text could smuggle in is refused
    injected.goto(file.as_uri())
    refused = injected.evaluate(
        """async () => {
        const refused = new Set();
        document.addEventListener('securitypolicyviolation', (event) => refused.add(event.effectiveDirective));
        const styled = document.createElement('div');
        styled.innerHTML = '<p style="color: red">x</p><img src="https://example.org/x.png">';
        for (const tag of ['style', 'script']) styled.append(document.createElement(tag));
        for (const one of styled.querySelectorAll('style, script')) one.textContent = 'x {}';
        document.body.append(styled);
        await new Promise((done) => setTimeout(done, 300));
        return [...refused].sort();
        }"""
    )
    injected.close()
    assert refused == ["img-src", "script-src-elem", "style-src-attr", "style-src-elem"]


@pytest.mark.parametrize(("width", "theme"), [(1280, "light"), (400, "dark")])
def test_no_barrier_is_found(study, visit, width, theme):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    page = visit(study("moving", kept=KEPT) / "report.html", width, color_scheme=theme)
    assert page.evaluate("document.documentElement.dataset.theme") == theme
    page.locator("summary").click()
    found = axe.run(page)
    assert found.violations_count == 0, found.generate_report()


@pytest.mark.parametrize("width", [1280, 900, 400])
def test_nothing_runs_off_the_page(study, visit, width):
    page = visit(study("swept", SWEEP) / "report.html", width)
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_focus_is_seen_and_reaches_every_control(moving):
    reached = []
    for _ in range(90):
        moving.keyboard.press("Tab")
        name, style, width = moving.evaluate(
            """() => { const one = document.activeElement, look = getComputedStyle(one);
            const name = one.id || one.textContent.trim().slice(0, 20) || one.type;
            return [name, look.outlineStyle, look.outlineWidth]; }"""
        )
        reached.append(name)
        assert style != "none", name
        assert width == "3px", name
        if name == "study-text":
            break
    for wanted in (
        "Skip to the content",
        "Results by case",
        "explore-chart",
        "player",
        "Play",
        "Storeys",
        "Save as CSV",
    ):
        assert wanted in reached
    assert reached[-1] == "study-text"


def test_colours_can_be_changed(moving):
    before = moving.evaluate("getComputedStyle(document.body).backgroundColor")
    moving.get_by_role("button", name="Dark colours").click()
    assert moving.evaluate("getComputedStyle(document.body).backgroundColor") != before
    assert moving.get_by_role("button", name="Light colours").is_visible()


def test_it_prints_in_light_colours_without_controls(study, visit):
    page = visit(study("moving", kept=KEPT) / "report.html", color_scheme="dark")
    page.emulate_media(media="print")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    for hidden in (".contents", "#explore-controls", "#player .bar", ".tabs", ".copy"):
        assert page.locator(hidden).first.is_hidden(), hidden
    assert page.pdf(format="A4").startswith(b"%PDF")
    ink = page.evaluate("getComputedStyle(document.querySelector('h1')).color")
    assert ink == "rgb(27, 31, 36)"


def test_study_can_be_copied(moving):
    moving.context.grant_permissions(["clipboard-read", "clipboard-write"])
    moving.get_by_role("button", name="Copy the study").click()
    moving.get_by_role("button", name="Copied").wait_for()
    assert moving.evaluate("navigator.clipboard.readText()").startswith("title: Two buildings <known> & small\n")


def test_figures_have_texts_and_show(study, visit):
    folder = study("drawn", formats=("svg",))
    page = visit(folder / "report.html")
    loaded = page.eval_on_selector_all(
        "img", "all => all.map(one => [one.complete && one.naturalWidth > 0, one.alt.length])"
    )
    assert len(loaded) == len(list(folder.glob("*.svg"))) == 5
    assert all(there and words > 60 for there, words in loaded)
    text = page.locator("#figure-stiff-response img").get_attribute("alt")
    assert f"touching {FACTOR['touching'] * 2:.2f} (storey 3)" in text
    assert "keep: {histories:" in page.locator("#motion").inner_text()


def test_without_scripts_claims_and_figures_are_still_there(study, visit):
    page = visit(study("drawn", formats=("svg",)) / "report.html", scripts=False)
    assert "Scripts are off" in page.locator("noscript").inner_text()
    assert page.locator(".answer tbody").count() == len(FACTOR)
    assert page.locator("#claims").is_visible()
    assert page.locator("img").count() == 5
    assert page.locator("#explore").is_hidden()
    assert page.locator("#tables").is_hidden()


def told(page, *keys: str) -> list[str]:
    """What the sweep's chart tells of the point that the keys reach."""
    for key in keys:
        page.locator("#sweep-chart").press(key)
    return page.locator("#sweep-chart .tip").inner_text().splitlines()


def test_two_swept_numbers_are_a_map(study, visit):
    page = visit(study("swept", SWEEP) / "report.html")
    sweep = page.locator("#sweep")
    assert sweep.locator("svg rect").count() == 6
    assert sweep.locator("svg .title").all_text_contents() == ["impact.restitution", "cases.gap.gap [cm]"]
    assert "touching: V/V₀, elastic, mean of 2 motions, largest of all buildings" in sweep.inner_text()
    choose(page, "Case", "1", "#sweep")
    shown = sweep.locator("svg .cell").all_text_contents()
    assert sorted(map(float, shown)) == [
        pytest.approx(FACTOR["gap"] * 2 * more, abs=0.005) for more in (1, 1, 1.1, 1.1, 1.2, 1.2)
    ]
    said = told(page, "ArrowRight", "ArrowUp", "ArrowUp")  # the lowest line first
    assert said[:2] == ["gap, cases.gap.gap = 3 cm, impact.restitution = 0.4", f"V/V₀ {FACTOR['gap'] * 1.2 * 2:.3f}"]
    assert said[2] == "stiff, storey 3"
    choose(page, "Storey", "1", "#sweep")
    choose(page, "Building", "1", "#sweep")
    assert told(page, "ArrowRight")[-1] == "soft, storey 1"
    choose(page, "Quantity", "V", "#sweep")
    said = told(page, "ArrowRight")
    assert said[1:3] == [f"V {1e3 * MEAN * FACTOR['gap']:.0f} kN", said[2]]
    low, high = (1e3 * peak * FACTOR["gap"] for peak in (PEAKS["weak"], PEAKS["strong"]))
    assert said[2] == f"motions from {low:.0f} to {high:.0f} kN"


def test_cells_and_points_without_meaning_are_marked_with_the_reason(study, visit):
    page = visit(study("swept", SWEEP) / "report.html")
    assert page.locator("#sweep-chart .void").count() == 0
    choose(page, "Case", "3", "#sweep")
    assert page.locator("#sweep-chart path.void").count() == 6
    assert page.locator("#sweep-void").is_visible()
    assert told(page, "ArrowRight")[-1] == f"not meaningful (2 motions): {Connector.beyond_gap}"
    choose(page, "Up", "-1", "#sweep")
    assert page.locator("#sweep-chart g[data-series=connected] .void").count() == 2
    assert page.locator("#sweep-chart g[data-series=gap] .void").count() == 0
    assert page.locator("#explore-chart g[data-series=connected] .void").count() == 3
    assert page.locator("#explore-chart g[data-series=gap] .void").count() == 0
    assert page.locator("#explore-legend .badge:visible").count() == 1


def test_sweep_is_drawn_as_curves_against_either_axis_and_points_can_be_chosen(study, visit):
    page = visit(study("swept", SWEEP) / "report.html")
    choose(page, "Up", "-1", "#sweep")
    points = "g => g.querySelectorAll('polygon, circle').length"
    assert page.eval_on_selector("#sweep-chart g[data-series=gap]", points) == 2
    choose(page, "Across", "0", "#sweep")
    assert page.eval_on_selector("#sweep-chart g[data-series=gap]", points) == 3
    choose(page, "impact.restitution", "1", "#sweep")
    said = told(page, "ArrowRight", "ArrowDown", "ArrowRight")
    assert said[0] == "gap, cases.gap.gap = 2 cm, impact.restitution = 0.6"
    assert said[1] == f"V/V₀ {FACTOR['gap'] * 1.1 * 2:.3f}"
    options = page.get_by_label("Point of the sweep", exact=True).evaluate(
        "list => [...list.options].map(one => one.text)"
    )
    assert len(options) == 6
    choose(page, "Point of the sweep", options[3])
    assert options[3] == "cases.gap.gap = 2 cm, impact.restitution = 0.6"
    assert numbers_drawn(page)["gap", "1"] == f"{FACTOR['gap'] * 1.1:.3f}"
    assert page.locator("#claims table tbody tr").count() == 6


def test_a_study_of_which_nothing_ended_says_so(study, visit):
    page = visit(study("refused", solve=refuse) / "report.html", 400)
    assert "Nothing to draw" in page.locator("#explore").inner_text()
    assert "16 failed" in page.locator(".tile.bad").inner_text()
    assert "no scene of this study ends" in page.locator("#simulated").inner_text()
    assert page.evaluate("document.documentElement.scrollWidth") <= 400
