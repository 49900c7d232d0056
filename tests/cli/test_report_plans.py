"""The group from above in a report, and frame lines in its charts: places, scale and texts by the data of axes."""

from __future__ import annotations

import base64
import itertools
from pathlib import Path

import numpy as np
import pytest
from matplotlib.patches import Rectangle

import pounding_cli
from pounding_cli.report.evidence import find_nominal
from pounding_cli.report.figures import list_profiles
from pounding_cli.report.from_above import MOST_PANELS, MOST_PLANS, list_plan_sections
from pounding_cli.report.sweep import SweepChoice, list_sweep_pictures
from pounding_cli.report.widgets import build_explorer_data, build_player_scenes

from .conftest import TWO

STREET = """\
title: A street with plans
records: {use: [elcentro], duration: 2 s}
buildings:
  corner:
    mass: 200 t
    storeys: 2
    period: 0.4 s
    plan:
      width: 20 m
      inertia: 8000 t m2
      centre_of_mass: 1 m
      lines: [{y: -7 m, stiffness: 70 %}, {y: 6 m, stiffness: 30 %}]
      across: [{x: -3 m, stiffness: 60 %}, {x: 3 m, stiffness: 40 %}]
  soft:
    storeys: 3
    period: 0.6 s
    plan: {width: 16 m, depth: 12 m, shift: 3 m, eccentricity: 10 %, frequency_ratio: 1.1}
  plain: {storeys: 2, period: 0.3 s}
group: [corner, soft, plain]
cases:
  touch: {link: pounding, gap: 5 mm}
  wide: {link: pounding, gap: 80 cm}
  joined: {links: [{link: connector, gap: 5 cm, floors: [1], places: [[-3 m, 2 m]], pair: 1}]}
  apart: {link: none}
analyses: [inelastic]
estimate: none
keep: {histories: {cases: [touch, apart]}}
"""
SWEPT = STREET.replace("cases:\n", "sweep: {buildings.soft.plan.eccentricity: [0 %, 10 %]}\ncases:\n")


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    """A folder with street.h5, and swept.h5 over an eccentricity."""
    folder = tmp_path_factory.mktemp("plans")
    for name, text in (("street", STREET), ("swept", SWEPT)):
        (folder / f"{name}.yaml").write_text(text)
        pounding_cli.run(folder / f"{name}.yaml", folder / f"{name}.h5", engine="serial")
    return folder


@pytest.fixture(scope="module")
def picture(made):
    """The picture of the group from above."""
    (section,) = list_plan_sections(find_nominal(pounding_cli.open_results(made / "street.h5")))
    (only,) = section.pictures
    return only


@pytest.fixture(scope="module")
def panels(picture):
    """Its panels, by the cases that each stands for."""
    return {title: ax for ax in picture.draw().axes if (title := ax.get_title(loc="left"))}


def rectangles(ax) -> dict[str, Rectangle]:
    return {patch.get_label(): patch for patch in ax.patches if isinstance(patch, Rectangle)}


def marks(ax, marker: str) -> list[tuple[float, float]]:
    """The places of the marks of one form in a panel."""
    return [
        (float(line.get_xdata()[0]), float(line.get_ydata()[0]))
        for line in ax.lines
        if line.get_marker() == marker and len(line.get_xdata()) == 1
    ]


def test_plans_stand_at_their_places_to_one_scale(panels):
    """Edges along the street as the study has them; plans without a depth or without a plan are dashed."""
    ax = panels["touch, wide"]
    assert ax.get_aspect() == 1.0
    plans = rectangles(ax)
    depth = np.sqrt(12 * 8e6 / 2e5 - 20.0**2)  # of the rectangle with this rotary inertia
    wanted = {"corner": (-10, 20, depth), "soft": (-5, 16, 12), "plain": (-5, 16, (depth + 12) / 2)}
    assert list(plans) == list(wanted)
    for name, (low, width, deep) in wanted.items():
        assert (plans[name].get_y(), plans[name].get_height()) == pytest.approx((low, width))
        assert plans[name].get_width() == pytest.approx(deep)
        assert (plans[name].get_linestyle() == "-") == (name == "soft")
    gaps = [plans["soft"].get_x() - depth, plans["plain"].get_x() - plans["soft"].get_x() - 12]
    assert all(gap > 0.8 for gap in gaps)  # the widest gap of these cases is 80 cm, and links have room


def test_frame_lines_centres_and_links_stand_where_they_are(panels):
    """By hand: y counts from the middle of a plan, the shares weigh the lines, contacts stand at both common ends."""
    ax = panels["touch, wide"]
    plans = rectangles(ax)
    lines = {
        (round(float(line.get_xdata()[0]), 6), round(float(line.get_ydata()[0]), 6)): line.get_linewidth()
        for line in ax.lines
        if line.get_color() == "#0072B2"
    }
    edges = [0.0, round(plans["soft"].get_x(), 6)]
    arm = 16 / np.sqrt(12)
    places = [(edges[0], -7), (edges[0], 6), (edges[1], 4.6 - arm), (edges[1], 4.6 + arm)]
    assert np.array(sorted(lines)) == pytest.approx(np.array(places), abs=1e-6)
    thick = [lines[place] for place in sorted(lines)[:3]]
    assert (thick[0] - thick[1]) / (thick[0] - thick[2]) == pytest.approx((0.7 - 0.3) / (0.7 - 0.5))
    across = [float(line.get_xdata()[0]) for line in ax.lines if line.get_color() == "#7A7A7A"]
    middle = plans["corner"].get_width() / 2
    assert across == pytest.approx([middle - 3, middle + 3])
    assert [y for _, y in marks(ax, "+")] == pytest.approx([1, 3])
    assert [y for _, y in marks(ax, "s")] == pytest.approx([0.7 * -7 + 0.3 * 6, 3 + 1.6])
    stars = marks(ax, "*")
    assert sorted(y for _, y in stars) == pytest.approx([-5, -5, 10, 11])
    faces = plans["corner"].get_width(), plans["soft"].get_x()
    assert all(faces[0] < x < faces[1] or x > plans["soft"].get_x() + 12 for x, _ in stars)
    texts = [text.get_text() for text in ax.texts]
    for words in ("1: 70 %", "2: 30 %", "4.1 m, 21 %", "1.6 m, 10 %", "soft\n16 m × 12 m", "plain\nno plan"):
        assert words in texts
    assert "gap 5 mm, 800 mm\nfloors 1, 2" in texts


def test_cases_whose_links_differ_have_panels_of_their_own(panels, picture):
    """A connector between unlike places is inclined; a case without links is told in the caption."""
    assert list(panels) == ["touch, wide", "joined"]
    (bar,) = [line for line in panels["joined"].lines if line.get_color() == "#7B3294" and len(line.get_xdata()) == 2]
    assert bar.get_ydata() == pytest.approx([-3, 5])  # the middle of soft stands at 3 m
    assert not marks(panels["joined"], "*")
    caption = picture.draw().get_label()
    for words in ("apart: no links.", "no depth of corner", "No plan of plain", "gaps, which are drawn wider"):
        assert words in caption
    assert MOST_PANELS >= 2


def test_the_picture_from_above_reads_without_eyes(picture):
    for words in (
        "corner: from -10 to 10 m along the street",
        "line 1 at -7 m with 70 %",
        "centre of mass at 1 m, of stiffness at -3.1 m",
        "plain: no plan.",
        "corner | soft, floors 1, 2: pounding at -5 m.",
        "soft | plain, floors 1, 2: pounding at 11 m.",
        "joined: corner | soft, floor 1: connector at -3 m.",
    ):
        assert words in picture.text


def test_a_study_without_plans_has_no_picture_from_above(folder, pound):
    assert pound("run", "two.yaml", "-o", "two.h5", "-q")[0] == 0
    assert list_plan_sections(find_nominal(pounding_cli.open_results("two.h5"))) == []


def test_links_of_floors_that_do_not_twist_stand_for_the_whole_edge(folder):
    """Fails if a contact seems to be at one place where nothing is eccentric."""
    plan = "plan: {width: 20 m, depth: 10 m, lines: [{y: -8 m, stiffness: 50 %}, {y: 8 m, stiffness: 50 %}]}"
    text = TWO.replace("mass: 200 t}", f"mass: 200 t, {plan}}}").replace("like: stiff", "mass: 200 t")
    Path("even.yaml").write_text(text)
    results = pounding_cli.run("even.yaml", "even.h5", engine="serial")
    (section,) = list_plan_sections(find_nominal(results))
    (ax, *_) = section.pictures[0].draw().axes
    (star,) = [line for line in ax.lines if line.get_marker() == "*"]
    assert star.get_markerfacecolor() == "white"
    assert "pounding along the shared edge" in section.pictures[0].text


def test_a_long_row_goes_on_below_to_one_scale(folder):
    """Fails if the plans of a long row are drawn so small that their texts cover each other, or a link is lost."""
    count = 2 * MOST_PLANS
    names = [f"b{number}" for number in range(count)]
    plan = "{width: 12 m, depth: 9 m, eccentricity: 5 %, frequency_ratio: 1.2}"
    buildings = "".join(f"  {name}: {{storeys: 1, period: 0.2 s, plan: {plan}}}\n" for name in names)
    Path("long.yaml").write_text(
        "records: {use: [elcentro], duration: 0.5 s}\nanalyses: [elastic]\nestimate: none\n"
        f"buildings:\n{buildings}group: [{', '.join(names)}]\ncases: {{near: {{link: pounding, gap: 1 cm}}}}\n"
    )
    results = pounding_cli.run("long.yaml", "long.h5", engine="serial")
    (section,) = list_plan_sections(find_nominal(results))
    *panels, _ = section.pictures[0].draw().axes
    plans = [list(rectangles(ax)) for ax in panels]
    assert [plan[0] for plan in plans[1:]] == [plan[-1] for plan in plans[:-1]]
    assert [*plans[0], *(name for plan in plans[1:] for name in plan[1:])] == names
    assert max(map(len, plans)) <= MOST_PLANS
    assert sum(len(marks(ax, "*")) for ax in panels) == 2 * (count - 1)
    assert len({ax.get_xlim() for ax in panels}) == 1


def test_lines_that_stand_close_have_fewer_labels(folder):
    """Fails if the labels of lines cover each other."""
    lines = ", ".join(f"{{y: {-9.5 + number} m, stiffness: 5 %}}" for number in range(20))
    plan = f"plan: {{width: 20 m, depth: 10 m, lines: [{lines}]}}"
    Path("many.yaml").write_text(TWO.replace("mass: 200 t}", f"mass: 200 t, {plan}}}"))
    results = pounding_cli.run("many.yaml", "many.h5", engine="serial")
    (section,) = list_plan_sections(find_nominal(results))
    figure = section.pictures[0].draw()
    figure.canvas.draw()
    labels = [text for text in figure.axes[0].texts if text.get_text().endswith(": 5 %")]
    boxes = sorted((text.get_window_extent().y0, text.get_window_extent().y1) for text in labels[: len(labels) // 2])
    assert len(boxes) > 4
    assert all(below[1] <= above[0] for below, above in itertools.pairwise(boxes))


def test_a_swept_plan_is_drawn_at_the_point_shown(made):
    results = pounding_cli.open_results(made / "swept.h5")
    (section,) = list_plan_sections(find_nominal(results))
    drawn = section.pictures[0].draw()
    assert [y for _, y in marks(drawn.axes[0], "s")] == pytest.approx([-3.1, 4.6])
    assert "eccentricity = 10 %" in drawn.get_label()


def test_the_explorer_has_frame_lines_edges_and_twist(made):
    """Every number of a line stands where the table of lines has it; lines that a building lacks are no choice."""
    results = pounding_cli.open_results(made / "street.h5")
    packed = build_explorer_data(results, find_nominal(results))
    quantities = {one["key"]: one for one in packed["quantities"]}
    assert {"edge_drift", "twist", "line_V", "line_mu", "line_drift", "line_V_ratio", "line_mu_ratio"} <= set(
        quantities
    )
    lines = quantities["line_drift"]
    assert lines["where"] == "frame line"
    assert lines["places"] == ["corner, line 1", "corner, line 2", "corner, line 3", "corner, line 4",
                               "soft, line 1", "soft, line 2"]  # fmt: skip
    values = np.array(lines["mean"], float).reshape(4, -1, 6, 3)  # cases, motions and analyses, lines, storeys
    exact = 1e3 * results.data["line_drift"].sel(case="touch", analysis="inelastic", record="elcentro")
    assert values[0, 0, 4:] == pytest.approx(exact.sel(building="soft").values[:, :2].T, rel=1e-5)


def test_every_frame_line_has_a_panel_over_the_height(made):
    """The ratios of each line along and across, and no such figure of a building that does not twist."""
    results = pounding_cli.open_results(made / "street.h5")
    pictures = {picture.name: picture for picture in list_profiles(find_nominal(results))}
    assert {name for name in pictures if name.endswith("-lines")} == {"corner-lines", "soft-lines"}
    titles = [ax.get_title(loc="left") for ax in pictures["corner-lines"].draw().axes]
    assert "Line 2, inelastic" in titles
    assert "Line 3 across the row, inelastic" in titles
    axes = [ax for ax in pictures["soft-lines"].draw().axes if ax.get_title(loc="left").startswith("Line")]
    assert [ax.get_title(loc="left") for ax in axes] == ["Line 1, inelastic", "Line 2, inelastic"]
    ratios = results.data["line_mu_ratio"].sel(case="touch", building="soft", analysis="inelastic", record="elcentro")
    for number, ax in enumerate(axes):
        assert ax.lines[0].get_xdata() == pytest.approx(ratios.values[:, number])


def test_figures_over_a_sweep_know_lines(made, folder, pound):
    """Fails if the number of the line is not taken, or the largest line is drawn whichever is asked for."""
    results = pounding_cli.open_results(made / "swept.h5")
    shown = find_nominal(results)
    for line in (1, 2):
        choice = SweepChoice(("line_mu",), {"building": "soft", "line": line, "case": "touch", "storey": 2})
        (picture,) = list_sweep_pictures(results, shown, choice)
        figure = picture.draw()
        assert f"line {line}" in figure.get_label()
        (curve,) = [
            each for ax in figure.axes for each in ax.lines if len(each.get_xdata()) == 2 and each.get_lw() == 1.6
        ]
        exact = results.data["line_mu"].sel(case="touch", building="soft", line=line, storey=2)
        assert curve.get_ydata() == pytest.approx(exact.values.ravel())
    code, _, err = pound("report", made / "swept.h5", "-q", "--quantity", "line_mu", "--where", "line=9")
    assert code == 2
    assert "there is no line '9' for line_mu" in err


def test_the_player_gets_plans_and_turns(made):
    """Series of the ground, floors, turns and links in this order; a time history without twist has no turns."""
    results = pounding_cli.open_results(made / "street.h5")
    scenes = {scene["case"]: scene for scene in build_player_scenes(results)}
    touch = scenes["touch"]
    series = np.frombuffer(base64.b64decode(touch["series"]), "<f4").reshape(-1, touch["count"])
    history = results.history("touch", "inelastic", "elcentro")
    twist = history.dataset["twist"].values
    floors = [len(building["heights"]) for building in touch["buildings"]]
    assert floors == [2, 3, 2]
    first = 1 + sum(floors)
    assert [building["plan"]["turns"] for building in touch["buildings"]] == [True, True, False]
    assert series[first : first + 2] == pytest.approx(twist[:, 0, :2].T)
    assert series[first + 2 : first + 5] == pytest.approx(twist[:, 1].T)
    assert np.abs(series[first : first + 5]).max() > 1e-5
    assert len(series) == first + 5 + len(touch["links"])
    number = list(history.links).index("corner|soft floor 2, place 1")
    at_place = history.displacement[:, :2, 1] - np.array([-5 - 1, -5 - 3]) * twist[:, :2, 1]
    assert at_place[:, 0] - at_place[:, 1] == pytest.approx(history.closing[:, number], abs=1e-8)
    assert [link["places"] for link in touch["links"][:2]] == [(-5, -5), (10, 10)]
    corner = touch["buildings"][0]["plan"]
    assert (corner["low"], corner["high"], corner["centre"], corner["known"]) == (-10, 10, 1, False)
    assert [line["place"] for line in corner["lines"]] == [-7, 6]
    stiffness = results.data["stiffness"].sel(building="corner", storey=1).item()
    strength = results.data["yield_shear"].sel(building="corner", storey=1).item()
    assert corner["lines"][0]["yield"][0] == pytest.approx(strength / stiffness, rel=1e-5)


def test_the_player_gets_a_wall_that_is_drawn_at_every_floor(folder):
    """Fails if a wall is drawn as a building without a plan, faded at all floors but the first."""
    plan = "plan: {width: 20 m, depth: 10 m, lines: [{y: -8 m, stiffness: 70 %}, {y: 8 m, stiffness: 30 %}]}"
    Path("walled.yaml").write_text(
        "records: {use: [elcentro], duration: 0.5 s}\nestimate: none\nkeep: histories\nanalyses: [elastic]\n"
        f"buildings:\n  dock: {{wall: fixed}}\n  tower: {{storeys: 2, period: 0.3 s, {plan}}}\n"
        "group: [dock, tower]\ncases: {near: {link: pounding, gap: 1 mm}}\n"
    )
    results = pounding_cli.run("walled.yaml", "walled.h5", engine="serial")
    (scene,) = build_player_scenes(results)
    plans = [building["plan"] for building in scene["buildings"]]
    assert [(plan["wall"], plan["known"]) for plan in plans] == [(True, True), (False, True)]
