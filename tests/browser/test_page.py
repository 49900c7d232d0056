"""The report's page in a real browser: its numbers are those of the tables, every control works, all can use it."""

from __future__ import annotations

import base64
import re

import numpy as np
import pytest

from tests.night import NIGHTLY

CASES = ["touching", "gap", "infill", "connected"]
PAPER = {"light": "rgb(250, 249, 246)", "dark": "rgb(17, 21, 26)"}


def cells(page, selector: str) -> list[list[str]]:
    """The texts of a table's body."""
    script = "rows => rows.map(row => [...row.cells].map(cell => cell.innerText))"
    return page.eval_on_selector_all(f"{selector} tbody tr", script)


def choose(page, name: str, value: str, within: str = "#look-around") -> None:
    page.locator(within).get_by_label(name, exact=True).select_option(label=value)


def told(page, key: str) -> list[str]:
    """What the chart says of the point that a key leads to."""
    chart = page.locator("#explorer")
    chart.press(key)
    return chart.locator(".tip").inner_text().splitlines()


def storeys(results, analysis: str, building: str):
    frame = results.storey()
    return frame[(frame["analysis"] == analysis) & (frame["building"] == building)]


# numbers


def test_the_explorer_draws_the_numbers_of_the_tables(visit, reports):
    """Means and extremes over the motions, then one motion, another quantity in its unit, building and analysis."""
    page, (results, _) = visit("kept"), reports("kept")
    grouped = storeys(results, "elastic", "stiff").groupby(["case", "storey"], observed=True)["V_ratio"]
    for storey, key in ((1, "ArrowUp"), (2, "ArrowUp"), (3, "ArrowUp")):
        said = told(page, key)
        assert said[0] == f"touching, stiff, storey {storey}"
        assert float(said[1].split()[-1]) == pytest.approx(grouped.mean()["touching", storey], rel=6e-4)
        ends = [float(number) for number in re.findall(r"\d[\d.]*", said[2])]
        wanted = grouped.min()["touching", storey], grouped.max()["touching", storey]
        assert ends == pytest.approx(wanted, rel=6e-4)
    assert told(page, "ArrowRight")[0] == "gap, stiff, storey 3"
    assert page.locator("#explorer g[data-series]").count() == len(CASES)
    page.locator("#explorer-legend").get_by_label("infill").uncheck()
    assert page.locator("#explorer g[data-series]").count() == len(CASES) - 1
    choose(page, "Motion", "taft")
    choose(page, "Analysis", "inelastic")
    choose(page, "Building", "soft")
    page.locator("#look-around").get_by_label("Quantity", exact=True).select_option(
        label="drift [mm]: largest storey drift"
    )
    exact = storeys(results, "inelastic", "soft").query("record == 'taft' and case == 'touching'").set_index("storey")
    said = told(page, "ArrowUp")
    assert said[0] == "touching, soft, storey 1"
    assert float(said[1].split()[-1]) == pytest.approx(1e3 * exact["drift"][1], rel=6e-4)
    page.locator("#explorer").press("Escape")
    assert page.locator("#explorer .tip").is_hidden()


def test_the_first_table_gives_the_largest_values(visit, reports):
    page, (results, _) = visit("kept"), reports("kept")
    table = cells(page, "[aria-label^='Peak responses and where they occur']")
    rows = [row for row in table if row[1] == "elastic"]
    assert [row[0].split()[0] for row in rows] == CASES
    elastic = results.storey().query("analysis == 'elastic'")
    for row, (_, some) in zip(rows, elastic.groupby("case", observed=True, sort=False), strict=True):
        largest = some.loc[some["V_ratio"].idxmax()]
        assert float(re.match(r"[\d.]+", row[3])[0]) == pytest.approx(largest["V_ratio"], rel=6e-3)
        assert f"{largest['building']}, storey {largest['storey']}, {largest['record']}" in row[3]


def test_tables_open_and_sort(visit, reports):
    page, (results, _) = visit("kept"), reports("kept")
    page.locator("summary", has_text="Storeys").click()
    table = page.locator("[aria-label='Storeys']")
    head = table.locator("th", has_text="V [kN]").first
    for order in ("ascending", "descending"):
        head.get_by_role("button").press("Enter")
        assert head.get_attribute("aria-sort") == order
    column = table.locator("th[scope=col]").all_inner_texts().index("V [kN]")
    shown = [float(row[column]) for row in cells(page, "[aria-label='Storeys']")]
    assert shown == pytest.approx(sorted(results.storey()["V"] / 1e3, reverse=True), rel=6e-4)


def test_a_sweep_is_drawn_over_its_keys(visit, reports):
    page, (results, _) = visit("swept"), reports("swept")
    table = results.storey()
    table = table[(table["case"] == "gap") & (table["analysis"] == "elastic")]
    axes = ["cases.gap.gap", "impact.restitution"]
    means = table.groupby([*axes, "building", "storey"], observed=True)["V_ratio"].mean().groupby(axes).max()
    choose(page, "Building", "largest of all")
    told(page, "ArrowRight")
    said = told(page, "ArrowDown")
    gap, restitution = (float(re.search(rf"{key}\)?[^:]*: ([\d.]+)", said[0])[1]) for key in axes)
    assert said[0].startswith("gap, ")
    assert float(said[1].split()[-1]) == pytest.approx(means[gap / 1e3, restitution], rel=6e-4)
    points = "g => g.querySelectorAll('path').length"
    assert page.eval_on_selector("#explorer g[data-series=gap]", points) == 3
    assert page.locator("#explorer g[data-series=connected] .void").count() == 3  # it closes its gap everywhere
    page.locator("#look-around").get_by_label("Over", exact=True).select_option(index=2)
    assert page.eval_on_selector("#explorer g[data-series=gap]", points) == 2


def test_a_study_of_which_no_linked_scene_ended_opens(visit):
    page = visit("failed", 400)
    assert "unstable step" in page.locator("#what-was-simulated").inner_text()
    assert page.evaluate("document.documentElement.scrollWidth") <= 400


# the page as a whole


@pytest.mark.parametrize(
    "name", ["kept", "twisted", pytest.param("swept", marks=NIGHTLY), "gap", "fragility", "sensitivity", "optimise"]
)
def test_no_table_is_scrolled_sideways(visit, name):
    """At 1400 pixels, closed tables too. Fails if a table is wider than the page, or cells are cut."""
    page = visit(name, 1400)
    page.evaluate("document.querySelectorAll('details').forEach(one => one.open = true)")
    script = "all => all.filter(one => one.scrollWidth > one.clientWidth + 1).map(one => one.ariaLabel)"
    assert page.eval_on_selector_all(".scroll", script) == []
    assert page.locator(".grid").count() >= 6
    assert page.evaluate("document.documentElement.scrollWidth") <= 1400


def test_columns_without_room_are_named_with_their_file(visit, reports):
    """Fails if a column vanishes unsaid, or if one is left out that has room."""
    page, (results, path) = visit("kept", 1400), reports("kept")
    page.locator("summary", has_text="Means over the motions").click()
    opened = page.locator("details[open]")
    heads = opened.locator("th[scope=col]").all_inner_texts()
    shared, left_out = (note.partition(": ")[2].rstrip(".") for note in opened.locator(".note").all_inner_texts())
    told_above = [text.rpartition(" ")[0] for text in shared.split("; ")]
    assert told_above == ["records used", "records collapsed"]
    assert "Further columns in tables/summary.csv: " in opened.inner_text()
    table = [results.column("summary", str(name)).head for name in results.table("summary")]
    assert sorted([*heads, *told_above, *left_out.split(", ")]) == sorted(table)
    assert {"V ratio mean", "V ratio max", "acceleration ratio max"} <= set(heads)
    header = (path.parent / "tables" / "summary.csv").read_text().splitlines()[0]
    assert header.split(",") == list(results.table("summary"))


def test_the_group_is_drawn_once_and_a_title_stands_once(visit, reports):
    """Figures in files of their own have title, caption and group; on the page these stand once, as text."""
    page, (_, path) = visit("kept", 1400), reports("kept")
    sources = page.eval_on_selector_all("figure img", "all => all.map(one => one.src)")
    figures = [base64.b64decode(source.partition("base64,")[2]).decode() for source in sources]
    saved = [file.read_text() for file in path.parent.glob("*.svg")]
    assert len(figures) == len(saved) == 4
    for texts, is_saved in ((figures, False), (saved, True)):
        for svg in texts:
            text = " ".join(re.sub("<[^>]+>", " ", svg.partition("</metadata>")[2]).split())
            assert ("Two buildings" in text) == is_saved
            assert ("T = 0.30 s" in text) == is_saved  # below the drawing of the group
            assert ("Motions: stand-in" in text) == is_saved
    assert page.locator("img.sketch").count() == 1
    captions = page.locator("figcaption").all_inner_texts()
    assert len(captions) == len(figures)
    assert all("Motions: stand-in: elcentro, taft." in caption for caption in captions)


def test_sentences_come_before_the_figure_and_the_tables(visit):
    page = visit("kept", 1400)
    tops = [page.locator(f"header {part}").first.bounding_box()["y"] for part in ("h1", ".lead + p", "figure", ".grid")]
    assert tops == sorted(tops)


# the player


def readout(page) -> dict[str, str]:
    script = "parts => Object.fromEntries(parts.map(one => [one.children[0].textContent, one.children[1].textContent]))"
    return page.eval_on_selector_all(".readout div", script)


def test_the_player_shows_the_history(visit, reports):
    """It opens at the hardest impact; every number is that of the history at its time."""
    page, (results, _) = visit("kept"), reports("kept")
    choose(page, "Time history", "touching, elastic, elcentro", "#player")
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


def test_the_player_plays_and_pauses(visit):
    page = visit("kept")
    page.locator("#player").press("Home")
    page.locator("#player").press(" ")
    page.wait_for_function("() => Number(document.querySelector('#player input[type=range]').value) > 20")
    page.locator("#player").press(" ")
    assert page.get_by_role("button", name="Play").is_visible()
    time = readout(page)["time"]
    page.wait_for_timeout(300)
    assert readout(page)["time"] == time
    page.get_by_role("button", name="Largest impact").click()
    assert readout(page)["time"] != time


STARS = """canvas => {
    const { width, height } = canvas;
    const copy = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const pixels = copy.getImageData(0, 0, width, height).data;
    const found = [];
    for (let place = 0; place < pixels.length; place += 4)
        if (pixels[place] > 200 && pixels[place + 1] < 140 && pixels[place + 2] < 100)
            found.push([(place / 4) % width / width, Math.floor(place / 4 / width) / height]);
    const mean = (side) => found.reduce((sum, each) => sum + each[side], 0) / found.length;
    return [mean(0), mean(1), found.length]; }"""
"""Where the light of contacts stands on a canvas, and how many of its pixels have it."""


@NIGHTLY
def test_the_player_shows_floors_from_above(visit, reports):
    """Turns are those of the history; a contact is lit at its place along the street, of the floor that is chosen."""
    page, (results, _) = visit("twisted"), reports("twisted")
    history = results.history(case="touching", analysis="inelastic", record="elcentro")
    twist = history.dataset["twist"].values
    hardest = int(np.argmax(history.link_force.max(axis=1)))
    for key, place in (("", hardest), ("ArrowRight", hardest + 1), ("End", len(history.time) - 1)):
        if key:
            page.locator("#player").press(key)
        for building, top in ((0, 3), (1, 2)):
            said = readout(page)[f"{history.buildings[building]} roof turns"].replace("−", "-")
            assert float(said.split()[0]) == pytest.approx(1e3 * twist[place, building, top - 1], abs=6e-4)
    above = page.locator(".above canvas")
    lit = {}
    for end in ("place 1", "place 2"):
        force = np.where([name.endswith(end) for name in history.links], history.link_force, 0.0)
        time, number = np.unravel_index(np.argmax(force), force.shape)
        floor = history.links[number].partition("floor ")[2][0]
        page.get_by_label("Time", exact=True).fill(str(time))
        choose(page, "Seen from above", f"floor {floor}", "#player")
        assert above.get_attribute("aria-label").startswith(f"Floor {floor} of corner, soft from above")
        lit[end] = above.evaluate(STARS)
    assert lit["place 1"][1] > lit["place 2"][1] + 0.2  # the canvas goes down, the street goes up
    assert min(pixels for *_, pixels in lit.values()) > 60
    choose(page, "Seen from above", "floor 3", "#player")  # where soft has no floor
    assert above.evaluate(STARS)[2] == 0
    choose(page, "Time history", "joined, inelastic, elcentro", "#player")
    assert above.is_visible()
    plain = visit("kept")
    assert plain.locator(".above canvas").is_hidden()
    assert plain.get_by_label("Seen from above").count() == 0


def test_the_group_is_seen_from_above_at_a_small_width(visit):
    """The picture is scrolled in its frame where the page is narrow, and its text says what it shows."""
    page = visit("twisted", 390)
    picture = page.locator("#figure-from-above img")
    assert "corner: from -10 to 10 m along the street" in picture.get_attribute("alt")
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert picture.bounding_box()["width"] > 500
    stage = page.locator(".stage")
    assert stage.evaluate("one => one.scrollWidth <= one.clientWidth + 1")
    boxes = [stage.locator(part).bounding_box() for part in (".side", ".above")]
    assert boxes[1]["y"] >= boxes[0]["y"] + boxes[0]["height"]  # one below the other


def test_the_explorer_offers_frame_lines(visit, reports):
    page, (results, _) = visit("twisted"), reports("twisted")
    options = page.locator("#look-around").get_by_label("Quantity", exact=True)
    label = next(text for text in options.locator("option").all_inner_texts() if text.startswith("drift of the line"))
    options.select_option(label=label)
    choose(page, "Frame line", "soft, line 2")
    said = told(page, "ArrowUp")
    assert said[0] == "touching, soft, line 2, storey 1"
    exact = results.data["line_drift"].sel(case="touching", building="soft", line=2, storey=1).item()
    assert float(said[1].split()[-1]) == pytest.approx(1e3 * exact, rel=6e-4)


# everybody


@pytest.mark.parametrize(
    ("name", "width", "theme"),
    [
        ("kept", 1280, "light"),
        pytest.param("kept", 400, "dark", marks=NIGHTLY),
        pytest.param("twisted", 400, "light", marks=NIGHTLY),
    ],
)
def test_no_barrier_is_found(visit, name, width, theme):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    page = visit(name, width, color_scheme=theme)
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == PAPER[theme]
    page.locator("summary").first.click()
    page.locator("#explorer").press("ArrowUp")
    found = axe.run(page)
    assert found.violations_count == 0, found.generate_report()
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_the_keyboard_reaches_every_control_and_focus_is_seen(visit):
    page, reached = visit("kept"), set()
    for _ in range(200):
        page.keyboard.press("Tab")
        name, style = page.evaluate(
            "() => { const one = document.activeElement, text = one.textContent.trim();"
            " return [one.id || text.slice(0, 20), getComputedStyle(one).outlineStyle]; }"
        )
        assert style != "none", name
        reached.add(name)
        if name == "study-text":
            break
    assert {"explorer", "player", "Play", "study-text"} <= reached
    assert any(name.startswith("Storeys") for name in reached)


def test_it_is_safe_and_prints_one_page_and_reads_without_scripts(visit, reports, browser):
    """Texts of the study are texts; nothing but its own style and scripts runs; the answer and figures need none."""
    page = visit("kept", color_scheme="dark")
    assert page.locator("h1").inner_text() == "Two buildings <known> & small"
    assert "unsafe" not in page.locator("meta[http-equiv='Content-Security-Policy']").get_attribute("content")
    page.emulate_media(media="print")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    printed = page.pdf(format="A4")
    assert printed.startswith(b"%PDF")
    assert len(re.findall(rb"/Type ?/Page\b", printed)) == 1
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
    assert plain.locator("header .grid tbody tr").count() > len(CASES)
    loaded = plain.eval_on_selector_all("img", "all => all.map(one => one.alt.length > 20)")
    assert len(loaded) >= 4
    assert all(loaded)
    assert plain.locator("#look-around").is_hidden()
