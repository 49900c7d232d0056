"""The player of the report's page in a real browser: it opens, plays, finds impacts, says what it shows, records."""

from __future__ import annotations

import base64
import re

import pytest

from pounding_cli.report.web.story import digits
from pounding_cli.store import open_results
from tests.helpers.page_study import CONTACTS, DT, KEPT
from tests.helpers.pages import choose


def readout(page) -> dict[str, str]:
    script = "parts => Object.fromEntries(parts.map(one => [one.children[0].textContent, one.children[1].textContent]))"
    return page.eval_on_selector_all(".readout div", script)


def stage_pixels(page, colour: str) -> int:
    """Pixels of the stage in a colour."""
    return page.evaluate(
        """colour => {
        const canvas = document.querySelector('.stage canvas');
        const [r, g, b] = [1, 3, 5].map(at => parseInt(colour.slice(at, at + 2), 16));
        const copy = document.createElement('canvas');
        [copy.width, copy.height] = [canvas.width, canvas.height];
        const pen = copy.getContext('2d', { willReadFrequently: true });
        pen.drawImage(canvas, 0, 0);
        const all = pen.getImageData(0, 0, canvas.width, canvas.height).data;
        let count = 0;
        for (let at = 0; at < all.length; at += 4)
          if (all[at + 3] > 60 && Math.hypot(all[at] - r, all[at + 1] - g, all[at + 2] - b) < 16) count++;
        return count; }""",
        colour,
    )  # fmt: skip


def stars(page) -> int:
    """Pixels of the stage in the colour of an impact."""
    return stage_pixels(page, "#d9480f")


def seconds(page) -> float:
    return float(readout(page)["time"].removesuffix(" s"))


def pace(page) -> float:
    """Time on the stage over time in the room, over half a second."""
    return page.evaluate(
        f"""async () => {{
        const scrub = document.querySelector('#player input[type=range]');
        const read = () => [{DT} * Number(scrub.value), performance.now()];
        const [from, start] = read();
        await new Promise((done) => setTimeout(done, 500));
        const [to, end] = read();
        return (to - from) / ((end - start) / 1000); }}"""
    )


FRAMES = """async (source) => {
    const film = document.createElement('video');
    film.muted = true;
    film.src = source;
    await new Promise((done, wrong) => { film.onloadeddata = done; film.onerror = () => wrong(film.error.message); });
    const sheet = document.createElement('canvas');
    [sheet.width, sheet.height] = [film.videoWidth, film.videoHeight];
    const pictures = [];
    for (const time of [0, 1e6]) {
        const there = new Promise((done) => { film.onseeked = done; });
        film.currentTime = time;
        await there;
        sheet.getContext('2d').drawImage(film, 0, 0);
        pictures.push(sheet.toDataURL());
    }
    return [[film.videoWidth, film.videoHeight], pictures[0] !== pictures[1]];
}"""
"""The size of a film, and whether two of its pictures differ."""


def test_the_player_fits_one_screen(study, visit):
    page = visit(study("moving", kept=KEPT) / "report.html", 1400)
    page.evaluate("document.documentElement.style.scrollBehavior = 'auto'")
    page.locator("#motion").evaluate("one => one.scrollIntoView()")
    parts = ("#motion-head", ".stage canvas", "#player > canvas", "#player input[type=range]", "#player .primary")
    for part in parts:
        box = page.locator(part).first.bounding_box()
        assert box["y"] >= 0, part
        assert box["y"] + box["height"] <= 900, part


def test_storeys_are_red_only_where_they_can_yield(study, visit):
    page = visit(study("yielding", kept=(("touching", "elastic"), ("touching", "inelastic"))) / "report.html")
    place = page.get_by_label("Scene", exact=True)
    assert place.evaluate("list => [...list.options].map(one => one.text)") == [
        "touching, inelastic, strong", "touching, elastic, strong",
    ]  # fmt: skip
    page.get_by_label("Time", exact=True).fill("125")  # storey drifts of 10 and 20 mm, far beyond yield
    assert stage_pixels(page, "#9c1c1c") > 50
    assert "beyond the yield drift" in page.locator("#player .key").inner_text()
    choose(page, "Scene", "1", "#player")
    page.get_by_label("Time", exact=True).fill("125")
    assert stage_pixels(page, "#9c1c1c") == 0
    assert "no storey yields" in page.locator("#player .key").inner_text()


def test_player_opens_at_the_hardest_impact_and_shows_it(moving):
    assert readout(moving)["time"] == f"{CONTACTS[2][0]:.3f} s"
    assert readout(moving)["link force"] == "4000 kN at floor 2"
    assert readout(moving)["contacts so far"] == "2 of 2"
    assert stars(moving) > 50
    moving.locator("#player").press("Home")
    assert stars(moving) == 0
    assert readout(moving)["contacts so far"] == "0 of 2"


def test_player_steps_and_finds_impacts_by_key_and_button(moving):
    player = moving.locator("#player")
    player.press("p")
    assert readout(moving)["time"] == f"{CONTACTS[1][0]:.3f} s"
    assert readout(moving)["link force"] == "1000 kN at floor 1"
    player.press("ArrowRight")
    assert readout(moving)["time"] == f"{CONTACTS[1][0] + DT:.3f} s"
    assert readout(moving)["link force"] == "600 kN at floor 1"
    player.press("Shift+ArrowLeft")
    assert readout(moving)["time"] == "0.402 s"
    # 10 mm x 3 floors x sin(2 pi 0.402), twice as much in the second building of two floors
    assert readout(moving)["stiff roof"] == "17.33 mm"
    assert readout(moving)["soft roof"] == "23.10 mm"
    moving.get_by_role("button", name="Next impact").click()
    moving.get_by_role("button", name="Next impact").click()
    assert readout(moving)["time"] == "1.200 s"
    player.press("End")
    assert readout(moving)["time"] == "2.000 s"
    moving.wait_for_function("() => document.getElementById('said').textContent.startsWith('time 2.000 s')")
    moving.get_by_role("button", name="Largest impact").click()
    assert readout(moving)["time"] == "1.200 s"
    moving.get_by_label("Time", exact=True).fill("125")
    assert readout(moving)["time"] == "0.250 s"
    assert readout(moving)["stiff roof"] == "30.00 mm"


def test_player_plays_and_pauses(moving):
    player = moving.locator("#player")
    choose(moving, "Speed", "0.1")
    player.press("Home")
    player.press(" ")
    assert moving.get_by_role("button", name="Pause").is_visible()
    assert 0.02 < pace(moving) < 0.12
    player.press(" ")
    assert moving.get_by_role("button", name="Play").is_visible()
    reached = seconds(moving)
    assert 0 < reached < 0.45
    assert pace(moving) == 0
    assert seconds(moving) == reached


def test_impacts_are_played_slowly_unless_told_otherwise(moving):
    choose(moving, "Speed", "1")
    moving.get_by_role("button", name="Largest impact").click()
    moving.get_by_role("button", name="Play").click()
    assert 0 < pace(moving) < 0.03
    moving.get_by_label("slow at impacts").uncheck()
    moving.get_by_role("button", name="Largest impact").click()
    moving.get_by_role("button", name="Play").click()
    assert pace(moving) > 0.2
    moving.get_by_role("button", name="Play").wait_for()
    assert readout(moving)["time"] == "2.000 s"


def test_what_is_played_can_be_saved_as_a_film(moving, tmp_path):
    """The film has the picture's size, and its pictures differ. Fails if the picture is not drawn while it plays."""
    moving.locator("#player").press("Home")
    moving.get_by_role("button", name="Record a film").click()
    moving.get_by_role("button", name="Pause").wait_for()
    while seconds(moving) < 0.1:
        moving.wait_for_timeout(50)
    with moving.expect_download() as saved:
        moving.get_by_role("button", name="Save the film").click()
    path = tmp_path / saved.value.suggested_filename
    saved.value.save_as(path)
    assert "touching, elastic, strong" in path.stem
    source = f"data:video/{path.suffix[1:]};base64,{base64.b64encode(path.read_bytes()).decode()}"
    shape, different = moving.context.new_page().evaluate(FRAMES, source)  # the page itself plays no films
    width, height = moving.locator(".stage canvas").evaluate("canvas => [canvas.width, canvas.height]")
    assert shape[0] == width
    assert shape[1] > height
    assert different


def test_displacements_are_drawn_to_the_scale_chosen_and_told(moving):
    key = moving.locator("#player .key")
    first = key.inner_text()
    assert re.search(r"drawn \d+ times larger than heights", first)
    choose(moving, "Displacements drawn", "10")
    assert "drawn 10 times larger than heights" in key.inner_text()
    assert "10 times larger" in moving.locator(".stage canvas").get_attribute("aria-label")
    choose(moving, "Displacements drawn", "1")
    assert "to the scale of the heights" in key.inner_text()


def test_pointer_gives_the_numbers_of_a_floor_and_the_strips_the_time(moving, study):
    moving.get_by_label("Time", exact=True).fill("0")
    strip = moving.locator("#player > canvas")
    strip.scroll_into_view_if_needed()
    box = strip.bounding_box()
    moving.mouse.click(box["x"] + box["width"] / 4, box["y"] + 20)
    assert seconds(moving) == pytest.approx(0.5, abs=0.01)
    moving.get_by_label("Time", exact=True).fill("125")
    stage = moving.locator(".stage canvas")
    stage.scroll_into_view_if_needed()
    box = stage.bounding_box()
    tip = moving.locator(".stage .tip")
    shown = set()
    for part in range(20, 80, 4):
        for height in (0.3, 0.5, 0.7):
            moving.mouse.move(box["x"] + box["width"] * part / 100, box["y"] + box["height"] * height)
            if tip.is_visible():
                shown.add(tuple(tip.inner_text().splitlines()))
    made = open_results(study("moving") / "study.h5").buildings.set_index(["building", "storey"])
    limit = made["yield_shear"] / made["stiffness"]
    stiff, soft = digits(0.01 / limit["stiff", 2], 3), digits(0.02 / limit["soft", 1], 3)
    assert ("stiff, floor 2", "displacement 20.00 mm", f"storey drift {stiff} times yield") in shown
    assert ("soft, floor 1", "displacement 20.00 mm", f"storey drift {soft} times yield") in shown


def test_connectors_have_no_impacts_and_the_buttons_say_so(moving):
    choose(moving, "Scene", "1", "#player")
    assert readout(moving)["contacts so far"] == "0 of 0"
    assert moving.get_by_role("button", name="Largest impact").is_disabled()
    assert seconds(moving) == 0
    choose(moving, "Time shown below", "0.1")
    moving.get_by_label("Time", exact=True).fill("600")
    assert readout(moving)["link force"] == "4000 kN at floor 2"
