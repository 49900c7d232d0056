"""The report's page in a real browser: its numbers are those of the tables, every control works, all can use it."""

from __future__ import annotations

import csv
import re

import numpy as np
import pytest

CASES = ["touching", "gap", "infill", "connected"]


def cells(page, selector: str) -> list[list[str]]:
    """The texts of a table's body."""
    script = "rows => rows.map(row => [...row.cells].map(cell => cell.textContent))"
    return page.eval_on_selector_all(f"{selector} tbody tr", script)


def choose(page, name: str, value: str, within: str = "#explore") -> None:
    page.locator(within).get_by_label(name, exact=True).select_option(value)


def storeys(results, analysis: str, building: str):
    frame = results.storey()
    return frame[(frame["analysis"] == analysis) & (frame["building"] == building)]


# numbers


def test_charts_draw_the_numbers_of_the_tables(visit, reports):
    """Means and extremes over the motions, one motion, another quantity in its unit, another building and analysis."""
    page, (results, _) = visit("kept"), reports("kept")
    table = storeys(results, "elastic", "stiff")
    grouped = table.groupby(["case", "storey"], observed=True)["V_ratio"]
    for row in cells(page, "#explore-numbers"):
        place = row[0], int(row[1])
        wanted = grouped.mean()[place], grouped.min()[place], grouped.max()[place]
        assert [float(text) for text in row[2:5]] == pytest.approx(wanted, abs=6e-4)
    assert len(cells(page, "#explore-numbers")) == 12
    offered = page.get_by_label("Quantity", exact=True).first.evaluate(
        "one => [...one.options].map(each => each.value)"
    )
    assert len(offered) == len(set(offered)) > 8
    for quantity, column, unit in (("V", "V", 1e3), ("drift", "drift", 1e-3), ("mu", "mu", 1)):
        choose(page, "Motion", "taft")
        choose(page, "Quantity", quantity)
        choose(page, "Building", "soft")
        choose(page, "Analysis", "inelastic")
        exact = storeys(results, "inelastic", "soft")
        exact = exact[exact["record"] == "taft"].set_index(["case", "storey"])[column] / unit
        drawn = {(row[0], int(row[1])): float(row[2]) for row in cells(page, "#explore-numbers")}
        assert drawn == pytest.approx(exact.to_dict(), rel=6e-4)
        choose(page, "Building", "stiff")


def test_the_first_table_gives_the_largest_values(visit, reports):
    page, (results, _) = visit("kept"), reports("kept")
    rows = [row for row in cells(page, "[aria-label='Largest values']") if row[1] == "elastic"]
    assert [row[0].split()[0] for row in rows] == CASES
    elastic = results.storey().query("analysis == 'elastic'")
    for row, (_, some) in zip(rows, elastic.groupby("case", observed=True, sort=False), strict=True):
        largest = some.loc[some["V_ratio"].idxmax()]
        assert float(re.match(r"[\d.]+", row[4])[0]) == pytest.approx(largest["V_ratio"], rel=6e-3)
        assert f"{largest['building']}, storey {largest['storey']}, {largest['record']}" in row[4]


def test_tables_sort_filter_search_and_save(visit, reports, tmp_path):
    page, (results, _) = visit("kept"), reports("kept")
    page.get_by_role("button", name="Storeys").click()
    head = page.locator("#table-view th", has_text="V [kN]").first
    for order in ("ascending", "descending"):
        head.get_by_role("button").press("Enter")
        assert head.get_attribute("aria-sort") == order
    while (more := page.get_by_role("button", name=re.compile("^Show .* more"))).count():
        more.click()
    column = page.locator("#table-view th").all_inner_texts().index("V [kN]")
    shown = [float(row[column]) for row in cells(page, "#table-view")]
    assert shown == pytest.approx(sorted(results.storey()["V"] / 1e3, reverse=True), rel=6e-4)
    search = page.get_by_label("Search")
    for words, count in (("infill", 20), ("nowhere", 0), ("gap", 20)):
        search.fill(words)
        assert page.locator("#table-view .count").inner_text().startswith(f"{count} of {count} rows")
    page.get_by_role("button", name="Links").click()
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Save as CSV").click()
    saved = list(csv.DictReader(waiting.value.path().read_text(encoding="utf-8").splitlines()))
    forces = [float(row["peak force [kN]"]) for row in saved]
    assert forces == pytest.approx(list(results.link()["peak_force"].dropna() / 1e3), rel=1e-5)


def test_a_sweep_is_a_map_and_curves(visit, reports):
    page, (results, _) = visit("swept"), reports("swept")
    table = results.storey()
    table = table[(table["case"] == "gap") & (table["analysis"] == "elastic")]
    axes = ["cases.gap.gap", "impact.restitution"]
    means = table.groupby([*axes, "building", "storey"], observed=True)["V_ratio"].mean().groupby(axes).max()
    choose(page, "Case", "1", "#sweep")
    shown = sorted(map(float, page.locator("#sweep svg .cell").all_text_contents()))
    assert shown == pytest.approx(sorted(means), abs=0.005)
    chart = page.locator("#sweep-chart")
    chart.press("ArrowRight")
    said = chart.locator(".tip").inner_text().splitlines()
    gap, restitution = (float(re.search(rf"{key} = ([\d.]+)", said[0])[1]) for key in axes)
    assert float(said[1].split()[-1]) == pytest.approx(means[gap / 1e3, restitution], abs=6e-4)
    choose(page, "Case", "3", "#sweep")
    assert page.locator("#sweep-chart path.void").count() == 6  # the connector closes its gap everywhere
    choose(page, "Up", "-1", "#sweep")
    points = "g => g.querySelectorAll('polygon, circle').length"
    assert page.eval_on_selector("#sweep-chart g[data-series=gap]", points) == 2
    choose(page, "Across", "0", "#sweep")
    assert page.eval_on_selector("#sweep-chart g[data-series=gap]", points) == 3


def test_a_study_of_which_no_linked_scene_ended_opens(visit):
    page = visit("failed", 400)
    assert "unstable step" in page.locator("#simulated").inner_text()
    assert page.evaluate("document.documentElement.scrollWidth") <= 400


# the player


def readout(page) -> dict[str, str]:
    script = "parts => Object.fromEntries(parts.map(one => [one.children[0].textContent, one.children[1].textContent]))"
    return page.eval_on_selector_all(".readout div", script)


def test_the_player_shows_the_history(visit, reports):
    """It opens at the hardest impact; every number is that of the history at its time."""
    page, (results, _) = visit("kept"), reports("kept")
    choose(page, "Scene", page.locator("#player").get_by_label("Scene", exact=True).evaluate(
        "list => [...list.options].find(one => one.text.includes('touching, elastic')).value"), "#player")  # fmt: skip
    history = results.history(case="touching", analysis="elastic", record="elcentro")
    hardest, floor = np.unravel_index(np.argmax(history.link_force), history.link_force.shape)

    def agrees(place: int) -> None:
        found = readout(page)
        assert found["time"] == f"{history.time[place]:.3f} s"
        for number, name in enumerate(("stiff", "soft")):
            roof = history.displacement[place, number][: 3 - number][-1]
            assert float(found[f"{name} roof"].replace("−", "-").split()[0]) == pytest.approx(1e3 * roof, abs=0.011)

    agrees(hardest)
    force = float(readout(page)["link force"].split()[0])
    assert force == pytest.approx(history.link_force[hardest, floor] / 1e3, rel=1e-3)
    assert f"floor {floor + 1}" in readout(page)["link force"]
    page.locator("#player").press("ArrowRight")
    agrees(hardest + 1)
    page.get_by_label("Time", exact=True).fill("100")
    agrees(100)
    page.locator("#player").press("End")
    agrees(len(history.time) - 1)
    counted = int(readout(page)["contacts so far"].split()[-1])
    impacts = results.link().query("case == 'touching' and analysis == 'elastic' and record == 'elcentro'")["impacts"]
    assert counted <= impacts.sum()  # contacts between two instants that are kept are not seen
    assert counted > 0.8 * impacts.sum()


def test_the_player_plays_pauses_and_records(visit, tmp_path):
    page = visit("kept")
    page.locator("#player").press("Home")
    page.locator("#player").press(" ")
    page.wait_for_function("() => Number(document.querySelector('#player input[type=range]').value) > 20")
    page.locator("#player").press(" ")
    assert page.get_by_role("button", name="Play").is_visible()
    time = readout(page)["time"]
    page.wait_for_timeout(300)
    assert readout(page)["time"] == time
    page.get_by_role("button", name="Record a film").click()
    page.wait_for_timeout(500)
    with page.expect_download() as saved:
        page.get_by_role("button", name="Save the film").click()
    saved.value.save_as(tmp_path / "film")
    assert (tmp_path / "film").stat().st_size > 1000


# everybody


@pytest.mark.parametrize(("width", "theme"), [(1280, "light"), (400, "dark")])
def test_no_barrier_is_found(visit, width, theme):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    page = visit("kept", width, color_scheme=theme)
    assert page.evaluate("document.documentElement.dataset.theme") == theme
    page.locator("summary").first.click()
    found = axe.run(page)
    assert found.violations_count == 0, found.generate_report()
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_the_keyboard_reaches_every_control_and_focus_is_seen(visit):
    page, reached = visit("kept"), set()
    for _ in range(150):
        page.keyboard.press("Tab")
        name, style = page.evaluate(
            "() => { const one = document.activeElement;"
            " return [one.id || one.textContent.trim().slice(0, 20), getComputedStyle(one).outlineStyle]; }"
        )
        assert style != "none", name
        reached.add(name)
        if name == "study-text":
            break
    assert {"explore-chart", "player", "Play", "Storeys", "Save as CSV", "study-text"} <= reached
    chart = page.locator("#explore-chart")
    for key in ("ArrowUp", "ArrowRight"):
        chart.press(key)
    row = next(row for row in cells(page, "#explore-numbers") if row[:2] == ["gap", "1"])
    said = chart.locator(".tip").inner_text().splitlines()
    assert said[0] == "gap, storey 1"
    assert row[2] in said[1]
    chart.press("Escape")
    assert chart.locator(".tip").is_hidden()


def test_it_is_safe_and_prints_and_reads_without_scripts(visit, reports, browser):
    """Texts of the study are texts; nothing but its own style and scripts runs; cases and figures need no script."""
    page = visit("kept", color_scheme="dark")
    assert page.locator("h1").inner_text() == "Two buildings <known> & small"
    assert "unsafe" not in page.locator("meta[http-equiv='Content-Security-Policy']").get_attribute("content")
    page.emulate_media(media="print")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert page.pdf(format="A4").startswith(b"%PDF")
    injected = browser.new_page()
    injected.goto(reports("kept")[1].as_uri())
    refused = injected.evaluate(
        """async () => {
        const refused = new Set();
        document.addEventListener('securitypolicyviolation', (event) => refused.add(event.effectiveDirective));
        const put = document.createElement('div');
        put.innerHTML = '<p style="color: red">x</p><img src="https://example.org/x.png">';
        put.append(document.createElement('script'));
        put.lastChild.textContent = 'x';
        document.body.append(put);
        await new Promise((done) => setTimeout(done, 300));
        return [...refused].sort(); }"""
    )
    injected.close()
    assert refused == ["img-src", "script-src-elem", "style-src-attr"]
    plain = visit("kept", scripts=False)
    assert plain.locator(".answer tbody tr").count() > len(CASES)
    loaded = plain.eval_on_selector_all("img", "all => all.map(one => one.alt.length > 20)")
    assert len(loaded) >= 4
    assert all(loaded)
    assert plain.locator("#explore").is_hidden()
