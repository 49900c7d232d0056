"""What `pound connector` and `pound wall` say and draw: sentences, tables at three widths, the data of the figures."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

from pounding_cli.numbers import Unit
from pounding_cli.paper.connector import (
    CONNECTOR_COLUMNS,
    ConnectorStudySpec,
    describe_bands,
    draw_ratios,
    list_connector_sentences,
    solve_connector,
)
from pounding_cli.paper.points import SweepPoint, build_variable, describe_extremes
from pounding_cli.paper.wall import SHOWN_COLUMNS, WALL_COLUMNS, list_wall_sentences
from pounding_cli.paper.wall.figures import COLORS, draw_histories, draw_stress
from pounding_cli.paper.wall.study import WallStudySpec
from pounding_cli.tables import Column, Table


def ratio_point(peak1: float, peak2: float, label: str = "") -> SweepPoint:
    """A solved point of two oscillators with these largest ratios."""
    study = ConnectorStudySpec.model_validate({"title": "t"})
    return SweepPoint(label, study, {}, {"peak1": peak1, "peak2": peak2})


@pytest.mark.parametrize(
    ("peaks", "start"),
    [
        ((3.5, 2.5), "The connector increases the largest displacements of both systems: "),
        ((3.5, 0.5), "The connector increases the largest displacement of system 1, and at no frequency that of "
                     "system 2: "),
        ((0.5, 3.5), "The connector increases the largest displacement of system 2, and at no frequency that of "
                     "system 1: "),
        ((1.0, 1.0), "The connector increases the displacement of neither system at any frequency: "),
    ],
)  # fmt: skip
def test_which_system_a_connector_makes_move_farther(peaks, start):
    """Fails if the systems are exchanged, or a ratio below one counts as an increase."""
    (sentence,) = list_connector_sentences([ratio_point(*peaks)])
    assert sentence.startswith(start)
    first, second = (f"{peak:#.4g}" for peak in peaks)
    assert f"system 1 moves {first} times as far as alone, and system 2 moves {second} times" in sentence


def test_one_point_of_a_sweep_that_increases_is_enough():
    points = [ratio_point(0.9, 0.8, "a = 1"), ratio_point(1.4, 0.7, "a = 2")]
    (sentence,) = list_connector_sentences(points)
    assert "increases the largest displacement of system 1, and at no frequency that of system 2" in sentence
    assert "system 1 moves 0.9000 (a = 1) to 1.400 (a = 2) times" in sentence
    assert "system 2 moves 0.7000 (a = 2) to 0.8000 (a = 1) times" in sentence


def test_bands_in_words():
    assert describe_bands(np.array([[0.6521, 0.7719], [1.0, 1.25]])).endswith("0.652 to 0.772 and 1.000 to 1.250")
    assert describe_bands(np.empty((0, 2))) == "at no frequency do both systems move farther than alone"


def test_the_ratios_are_drawn_against_the_frequency():
    """|R1| is the solid black line, |R2| the dashed blue one; grey where both exceed one. Fails if lines change
    places, or a band or a frequency is drawn at another place."""
    points = []
    for damping in ("5 %", "10 %"):
        study = ConnectorStudySpec.model_validate(
            {"title": "t", "damping": damping, "connector": {"damping_ratio": 0}, "frequencies": {"points": 101}}
        )
        answer = solve_connector(study)
        points.append(SweepPoint(f"damping = {damping}", study, {}, answer.numbers, answer.arrays))
    figure = draw_ratios("t", points)
    assert len(figure.axes) == 2
    for ax, point in zip(figure.axes, points, strict=True):
        first, second, *others = ax.lines
        np.testing.assert_array_equal(first.get_xdata(), np.linspace(0.2, 1.6, 101))
        np.testing.assert_array_equal(first.get_ydata(), point.values("R1"))
        np.testing.assert_array_equal(second.get_ydata(), point.values("R2"))
        assert (first.get_label(), first.get_color(), first.get_linestyle()) == ("system 1", "#000000", "-")
        assert (second.get_label(), second.get_color(), second.get_linestyle()) == ("system 2", "#0072B2", "--")
        places = [line.get_xdata()[0] for line in others if line.get_color() == "#AA2211"]
        assert places == [point.numbers["frequency_low"], point.numbers["frequency_high"]]
        bands = [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in ax.patches]
        np.testing.assert_allclose(bands, point.values("both_above"), rtol=1e-12)
        assert (ax.get_title(loc="left"), ax.get_xlabel()) == (point.label, "Ω / ω₁₀")
        assert ax.get_ylabel() == "largest displacement over that alone"


def test_points_beyond_those_drawn_are_told():
    study = ConnectorStudySpec.model_validate({"title": "t", "frequencies": {"points": 11}})
    answer = solve_connector(study)
    points = [SweepPoint(f"a = {n}", study, {}, answer.numbers, answer.arrays) for n in range(5)]
    assert "The first 4 of 5 points of the sweep." in draw_ratios("t", points).get_label()
    assert "points of the sweep" not in draw_ratios("t", points[:4]).get_label()


NUMBERS = {column.name: 1.0 for column in WALL_COLUMNS}
"""Of a point of the wall."""


def wall_point(label: str = "", bond: str = "unilateral", **numbers: float) -> SweepPoint:
    """A solved point of the wall."""
    study = WallStudySpec.model_validate({"title": "t", "contact": {"bond": bond}})
    return SweepPoint(label, study, {}, {**NUMBERS, **numbers})


def test_the_answer_of_an_impact():
    numbers = {"peak_force": 5.924e6, "averaged_stress": 32.57e6, "separation": 0.03751, "wall_stress": 99e6}
    (sentence,) = list_wall_sentences([wall_point(**numbers)])
    assert sentence == (
        "The largest contact force is 5924 kN; the largest von Mises stress, mean over 0.5 m, is 32.57 N/mm². "
        "The striker leaves the wall after 37.51 ms."
    )


@pytest.mark.parametrize("is_reversed", [False, True])
def test_the_ends_of_a_sweep_have_their_points(is_reversed):
    """Fails if the smallest stands with the point of the largest."""
    points = [wall_point("a = 1", peak_force=2e6), wall_point("a = 2", peak_force=3e6), wall_point("a = 3")]
    points[2] = replace(points[2], numbers={**NUMBERS, "peak_force": 1e6})
    (sentence,) = list_wall_sentences(points[::-1] if is_reversed else points)
    assert "force is 1000 (a = 3) to 3000 kN (a = 2);" in sentence
    column = Column("peak_force", unit=WALL_COLUMNS[0].unit)
    assert describe_extremes(points[:1], column) == "2000 kN"
    assert describe_extremes([points[0], points[0]], column) == "2000 kN"


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([wall_point(separation=np.nan)], "The striker leaves the wall at no time before the end of the analysis."),
        (
            [wall_point("a", separation=0.02), wall_point("b", separation=np.nan)],
            "The striker leaves the wall after 20.00 ms; at 1 point it does not leave it before the end of the "
            "analysis.",
        ),
        ([wall_point(bond="glued", separation=0.03)], "The glued striker begins to pull after 30.00 ms."),
        (
            [wall_point("a", separation=0.02), wall_point("b", bond="glued", separation=0.03)],
            "The striker leaves the wall after 20.00 ms. The glued striker begins to pull after 30.00 ms.",
        ),
    ],
)
def test_when_a_striker_leaves_the_wall(points, words):
    (sentence,) = list_wall_sentences(points)
    assert sentence.endswith(words)


SWEPT = (Column("contact.over"), Column("mesh.size", unit=Unit("m", 1.0, "m")))


@pytest.mark.parametrize("width", [80, 120, 200])
@pytest.mark.parametrize(
    ("swept", "columns"),
    [
        (SWEPT, [column for name in SHOWN_COLUMNS for column in WALL_COLUMNS if column.name == name]),
        ([Column("damping", unit=Unit("%", 0.01))], CONNECTOR_COLUMNS),
    ],
)
def test_tables_of_points_fit_the_terminal(width, swept, columns):
    """Fails if a heading is cut or wrapped, or an optional column goes without a word."""
    row = {"contact.over": "patch", "mesh.size": 0.125, "damping": 0.05}
    row |= {column.name: 1.2345 * column.unit.factor for column in columns}
    table = Table("", pd.DataFrame([row] * 2), [*swept, *columns])
    text = table.to_text(width)
    assert max(map(len, text.splitlines())) <= width
    assert "…" not in text
    for head in table.heads():
        assert head in text


# The figures of the wall

TIME = np.array([0.0, 0.01, 0.02])


def drawn_point(label: str, scale: float = 1.0) -> SweepPoint:
    """A point of the wall with arrays that tell each other apart."""
    histories = {
        "time": ("s", TIME),
        "force": ("N", scale * np.array([0.0, 4e6, 1e6])),
        "velocity": ("m/s", scale * np.array([0.5, 0.1, -0.4])),
        "striker_energy": ("J", np.array([9e3, 1e3, 2e3])),
        "kinetic_energy": ("J", np.array([0.0, 2e3, 3e3])),
        "strain_energy": ("J", np.array([0.0, 6e3, 4e3])),
    }
    arrays = {name: build_variable(unit, name, values, "instant") for name, (unit, values) in histories.items()}
    corners = np.array([[[0, 0], [1, 0], [1, 1], [0, 1]], [[1, 0], [2, 0], [2, 1], [1, 1]]], dtype=float)
    arrays |= {
        "cell_height": build_variable("m", "", np.array([13.0, 13.5, 14.0]), "cell"),
        "cell_stress": build_variable("N/m2", "", scale * np.array([10e6, 30e6, 20e6]), "cell"),
        "outline": build_variable("m", "", corners, "element", "side", "axis"),
        "stress_peak": build_variable("N/m2", "", np.array([5e6, 1e6]), "element"),
        "stress_envelope": build_variable("N/m2", "", np.array([8e6, 2e6]), "element"),
    }
    study = WallStudySpec.model_validate({"title": "t"})
    return SweepPoint(label, study, {}, {**NUMBERS, "time_of_peak": 0.0062}, arrays)


def test_the_histories_of_the_wall_are_drawn_in_their_units():
    """Force in MN, time in ms, energy in kJ, stress in N/mm², height from the contact. Fails if a quantity is in
    another unit than its axis, if points change colours, or energies their order."""
    points = [drawn_point("a = 1"), drawn_point("a = 2", scale=2.0)]
    figure = draw_histories("t", points)
    force, speed, energy, face = figure.axes
    labels = [ax.get_xlabel() for ax in figure.axes]
    assert labels == ["time [ms]"] * 3 + ["largest stress, mean over 0.5 m [N/mm²]"]
    labels = [ax.get_ylabel() for ax in figure.axes]
    assert labels == ["contact force [MN]", "velocity [m/s]", "energy [kJ]", "distance up from the contact [m]"]
    for place, line in enumerate(force.lines):
        np.testing.assert_allclose(line.get_xdata(), [0, 10, 20])
        np.testing.assert_allclose(line.get_ydata(), (place + 1) * np.array([0, 4, 1]))
        assert (line.get_label(), line.get_color()) == (points[place].label, COLORS[place])
        np.testing.assert_allclose(speed.lines[place].get_ydata(), (place + 1) * np.array([0.5, 0.1, -0.4]))
        assert speed.lines[place].get_color() == face.lines[place].get_color() == COLORS[place]
        np.testing.assert_allclose(face.lines[place].get_xdata(), (place + 1) * np.array([10, 30, 20]))
        np.testing.assert_allclose(face.lines[place].get_ydata(), [-0.5, 0, 0.5])
    assert [text.get_text() for text in energy.get_legend().get_texts()] == ["striker", "moving building", "strain"]
    tops = [area.get_paths()[0].vertices[:, 1].max() for area in energy.collections]
    np.testing.assert_allclose(tops, [9, 9, 9])  # the sum is 9 kJ at every instant
    middles = [area.get_paths()[0].vertices for area in energy.collections]
    heights = [sorted({y for x, y in vertices if x == 10}) for vertices in middles]
    np.testing.assert_allclose([level[-1] for level in heights], [1, 3, 9])
    assert all(lower[-1] == upper[0] for lower, upper in pairwise(heights))
    assert energy.get_title() == "Energy: a = 2"


def test_of_many_points_as_many_are_drawn_as_there_are_colours():
    points = [drawn_point(f"a = {n}") for n in range(len(COLORS) + 1)]
    figure = draw_histories("t", points)
    assert len(figure.axes[0].lines) == len(COLORS)
    assert figure.axes[2].get_title() == f"Energy: a = {len(COLORS) - 1}"
    assert f"The first {len(COLORS)} of {len(points)} points" in figure.get_label()


def test_the_stress_on_the_mesh_is_drawn_in_newtons_per_square_millimetre():
    """The envelope at the left, the instant of the peak at the right, on one scale of colours."""
    figure = draw_stress("t", drawn_point("a = 1"))
    whole, near, bar = figure.axes
    envelope, peak = whole.collections[0], near.collections[0]
    np.testing.assert_allclose(envelope.get_array(), [8, 2])
    np.testing.assert_allclose(peak.get_array(), [5, 1])
    assert envelope.get_clim() == peak.get_clim() == (0, 8)
    np.testing.assert_allclose(envelope.get_paths()[1].vertices[:4], [[1, 0], [2, 0], [2, 1], [1, 1]])
    assert bar.get_ylabel() == "von Mises stress [N/mm²]"
    assert (whole.get_title(loc="left"), near.get_title(loc="left")) == (
        "Largest over time",
        "Around the contact at 6.2 ms",
    )
    assert near.get_ylim() == pytest.approx((12.5, 14.5))  # 1 m around the contact at 13.5 m
