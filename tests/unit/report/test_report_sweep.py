"""Figures of a sweep: curves over one axis, maps over two, what is chosen, what is marked."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import PatchCollection, QuadMesh

from pounding_cli.errors import InputError
from pounding_cli.numbers import Unit
from pounding_cli.report.evidence import points
from pounding_cli.report.maps import short
from pounding_cli.report.quantity import Choice
from pounding_cli.report.style import RC
from pounding_cli.report.sweep import Asked, sweep_figures
from tests.helpers.figures import assert_no_overlap, panels
from tests.helpers.report_tables import MOTIONS, make

STRUCK = "connector closes more than the gap, so the floors would have struck: stiff | soft, floor 5, by 3 mm"
EDITIONS = ["UBC-1985", "UBC-1988", "UBC-1991"]


def drawn(results, place=0, asked=None):
    return sweep_figures(results, points(results)[place], asked)


def grid(*axes, flagged=None):
    """Results over several axes (key, values): the ratios grow by 10 % a value of the first, 50 % of the second, ..."""
    results = make(axis=axes[0])
    frames = dict(results._frames)
    for growth, (key, values) in enumerate(axes[1:], start=1):
        for name in ("storey", "floor", "link", "scene"):
            parts = []
            for number, value in enumerate(values):
                part = frames[name].copy()
                part.insert(growth, key, value)
                if name == "storey":
                    part[["V_ratio", "mu_ratio"]] *= 1 + 0.5 * growth * number
                parts.append(part)
            frames[name] = pd.concat(parts, ignore_index=True)
    scene = frames["scene"]
    if flagged:
        here = np.logical_and.reduce([scene[key] == value for key, value in flagged.items()])
        scene.loc[here, "flags"] = STRUCK
    results._frames = frames
    results.units = {"gap_axis": Unit("cm", 0.01, "m")}
    return results


PERIOD = ("soft_T", [0.4, 0.5, 0.6])
GAP = ("gap_axis", [0.0, 0.05])


def mesh(ax):
    return np.asarray(next(part for part in ax.collections if isinstance(part, QuadMesh)).get_array())


def test_one_axis_gives_the_mean_with_a_band():
    figures = drawn(make(axis=("impact.restitution", [0.65, 0.4])))
    assert list(figures) == ["stiff-sweep", "soft-sweep"]
    ax = panels(figures["stiff-sweep"])[0]
    line = ax.lines[0]  # touching: top storey 1.4 x 1.04, a tenth more at the second value
    np.testing.assert_allclose(line.get_xdata(), [0.4, 0.65])
    mean = np.array([1.1, 1.0]) * 1.4 * 1.04
    np.testing.assert_allclose(line.get_ydata(), mean, rtol=1e-12)
    band = ax.collections[0].get_paths()[0].vertices
    spread = np.std(MOTIONS, ddof=1)
    at_right = sorted(set(band[band[:, 0] == 0.65][:, 1].round(12)))
    np.testing.assert_allclose(
        at_right[::2] if len(at_right) > 2 else at_right, mean[1] * np.array([1 - spread, 1 + spread])
    )
    assert "one standard deviation" in figures["stiff-sweep"].get_supxlabel()
    assert_no_overlap(figures["stiff-sweep"])


def test_sweep_over_words_stands_on_their_names():
    figure = drawn(make(axis=("buildings.stiff.yield.code", EDITIONS)))["soft-sweep"]
    assert [tick.get_text() for tick in panels(figure)[0].get_xticklabels()] == EDITIONS
    assert_no_overlap(figure)


def test_sweep_over_long_words_numbers_them_and_gives_the_key():
    yields = [
        "{code: UBC-1991, zone: 0.4, soil: 1.2, Rw: 12}",
        "{code: UBC-1985, zone: 1.0, soil: 1.2, K: 0.67}",
        "{code: UBC-1985, zone: 1.0, soil: 1.2, K: 1.0}",
    ]
    figure = drawn(make(axis=("buildings.stiff.yield", yields)))["soft-sweep"]
    assert [tick.get_text() for tick in panels(figure)[0].get_xticklabels()] == ["1", "2", "3"]
    key = figure.get_supxlabel().replace("\n", " ")
    assert f"(1) {yields[0]}; (2) {yields[1]}; (3) {yields[2]}." in key
    assert_no_overlap(figure)


def test_two_axes_give_maps_the_longer_axis_across():
    figures = drawn(grid(PERIOD, GAP))
    assert list(figures) == ["stiff-map", "soft-map"]
    ax = panels(figures["stiff-map"])[0]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("soft_T", "gap_axis [cm]")
    assert [tick.get_text() for tick in ax.get_yticklabels()] == ["0", "5"]
    expected = [[1.4 * 1.04 * (1 + 0.1 * i) * (1 + 0.5 * j) for i in range(3)] for j in range(2)]
    np.testing.assert_allclose(mesh(ax), expected, rtol=1e-12)
    printed = {text.get_text() for text in ax.texts}
    assert printed == {f"{value:.2f}" for row in expected for value in row}
    titles = [ax.get_title(loc="left") for ax in panels(figures["stiff-map"])]
    assert titles[:2] == ["touching, elastic", "gap, elastic"]
    for figure in figures.values():
        assert_no_overlap(figure)


def test_many_points_are_a_picture_without_numbers_and_with_the_line_of_one():
    fine = ("soft_T", list(np.linspace(0.2, 1.0, 15)))
    results = grid(fine, ("gap_axis", list(np.linspace(0, 0.3, 14))))
    results._frames["storey"][["V_ratio", "mu_ratio"]] /= 2
    figure = drawn(
        results, asked=Asked(("V_ratio",), Choice("", case="touching", building="stiff", analysis="elastic"))
    )
    ax = panels(figure["stiff-V_ratio-map"])[0]
    assert mesh(ax).shape == (14, 15)
    assert not ax.texts
    assert "White line: ratio 1" in figure["stiff-V_ratio-map"].get_supxlabel().replace("\n", " ")
    np.testing.assert_allclose(ax.get_ylim(), (-15 / 13, 30 + 15 / 13))


def test_of_more_axes_the_longest_are_drawn_and_the_others_said():
    third = ("e", [0.4, 0.5])
    results = grid(PERIOD, ("gap_axis", [0.0, 0.05, 0.1]), third)
    figure = drawn(results)["stiff-map"]
    assert "e = 0.4" in figure.get_supxlabel()
    np.testing.assert_allclose(mesh(panels(figure)[0])[0, 0], 1.4 * 1.04, rtol=1e-12)
    cut = drawn(results, asked=Asked(at={"e": 0.5}))["stiff-map"]
    np.testing.assert_allclose(mesh(panels(cut)[0])[0, 0], 1.4 * 1.04 * 2, rtol=1e-12)
    curve = drawn(results, asked=Asked(at={"e": 0.5, "gap_axis": 0.05}))["stiff-sweep"]
    assert "e = 0.5" in curve.get_supxlabel()
    assert "gap_axis = 5 cm" in curve.get_supxlabel()


def test_quantity_case_building_and_storey_are_chosen():
    results = grid(PERIOD, GAP)
    asked = Asked(("mu_ratio",), Choice("", case="touching", building="soft", storey=3))
    figures = drawn(results, asked=asked)
    assert list(figures) == ["soft-mu_ratio-map"]
    first = mesh(panels(figures["soft-mu_ratio-map"])[0])
    np.testing.assert_allclose(first[0, 0], 1 / 1.4, rtol=1e-12)
    assert "at storey 3" in figures["soft-mu_ratio-map"].get_supxlabel()
    worst = drawn(results, asked=Asked(("mu_ratio",), Choice("", case="worst", building="worst", analysis="elastic")))
    (ax, _) = panels(worst["worst-mu_ratio-map"])
    assert ax.get_title(loc="left") == "worst of all cases, elastic"
    np.testing.assert_allclose(mesh(ax)[0, 0], 1.5 * 1.04, rtol=1e-12)
    forces = drawn(results, asked=Asked(("peak_force",)))
    assert list(forces) == ["peak_force-map"]


def test_meaningless_scenes_are_hatched_and_explained():
    results = grid(PERIOD, GAP, flagged={"case": "connected", "soft_T": 0.6, "gap_axis": 0.05, "record": "taft"})
    figure = drawn(results)["stiff-map"]
    marked = [
        ax.get_title(loc="left") for ax in panels(figure) if any(type(c) is PatchCollection for c in ax.collections)
    ]
    assert marked == ["connected, elastic", "connected, inelastic"]
    ax = next(ax for ax in panels(figure) if ax.get_title(loc="left") == marked[0])
    (cells,) = [part for part in ax.collections if type(part) is PatchCollection]
    (box,) = [path.get_extents() for path in cells.get_paths()]
    np.testing.assert_allclose([box.x0, box.x1, box.y0, box.y1], [2.5, 3.5, 1.5, 2.5])
    assert "have no meaning, connector closes more than the gap" in figure.get_supxlabel().replace("\n", " ")
    one = make(axis=("e", [0.4, 0.5]))
    one._frames["scene"].loc[one.scene()["case"] == "connected", "flags"] = STRUCK
    words = drawn(one)["stiff-sweep"].get_supxlabel().replace("\n", " ")
    assert "Open grey markers (connected)" in words


def test_cases_without_the_quantity_are_left_out():
    results = grid(PERIOD, GAP)
    asked = Asked(("peak_force",), Choice("", floor=4, analysis="elastic"))
    titles = [ax.get_title(loc="left") for ax in panels(drawn(results, asked=asked)["peak_force-map"])]
    assert [title for title in titles if title] == ["touching, elastic", "gap, elastic", "infill, elastic"]


@pytest.mark.parametrize(
    ("results", "asked", "message"),
    [
        (make(), Asked(("drift",)), "nothing is swept"),
        (make(axis=PERIOD), Asked(("drift",), at={"soft_T": 0.4}), "all swept keys are fixed"),
        (make(axis=PERIOD), Asked(("drift",), Choice("", case="gip")), "there is no case 'gip'"),
    ],
)
def test_what_cannot_be_drawn_is_refused(results, asked, message):
    with pytest.raises(InputError, match=message):
        drawn(results, asked=asked)


def test_nothing_swept_gives_no_figure():
    assert drawn(make()) == {}


def test_numbers_in_cells_are_short():
    cases = {
        0.0: "0",
        0.123: "0.12",
        1.0: "1.00",
        9.996: "10.0",
        45.67: "45.7",
        99.96: "100",
        12345.6: "12346",
        2.5e6: "2e6",
    }
    assert {value: short(value) for value in cases} == cases


def test_hatching_is_thin_enough_to_read_numbers():
    assert RC["hatch.linewidth"] < 1


def test_swept_periods_are_not_written_under_the_drawing():
    results = make(axis=("soft_T", [0.4, 0.5]))
    parts = [results.buildings.assign(soft_T=value) for value in (0.4, 0.5)]
    for part in parts:
        part.loc[part["building"] == "soft", "period"] = part["soft_T"]
    results.buildings = pd.concat(parts, ignore_index=True)
    figure = drawn(results)["soft-sweep"]
    assert [text.get_text() for text in figure.axes[0].texts] == ["T = 0.36 s"]
