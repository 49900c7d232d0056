"""Keys of a study as people read them at an axis."""

from __future__ import annotations

import pytest
from matplotlib.figure import Figure
from matplotlib.text import Annotation

from pounding_cli.numbers import Unit
from pounding_cli.report.key_words import key_words, name_axis

RESOLVED = {"cases": {"tied": {"link": "connector"}, "filled": {"link": "infill"}, "both": {"link": ["pounding"]}}}


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("cases.tied.stiffness", "stiffness of the connector"),
        ("cases.filled.stiffness", "stiffness of the infill"),
        ("cases.both.stiffness", "stiffness of the link"),
        ("cases.tied.gap", "gap"),
        ("impact.stiffness", "impact stiffness"),
        ("impact.restitution", "coefficient of restitution of impacts"),
        ("buildings.soft.period", "period of soft"),
        ("buildings.soft.yield.base_shear", "base-shear coefficient of soft"),
        ("records.scale.pga", "peak ground acceleration"),
        ("accuracy", "accuracy"),
    ],
)
def test_a_key_in_words(key, words):
    assert key_words(key, RESOLVED) == words


@pytest.mark.parametrize("which", ["x", "y"])
def test_an_axis_has_the_words_and_in_small_the_key(which):
    ax = Figure().add_subplot()
    name_axis(ax, which, ["cases.tied.stiffness"], [Unit("MN/m", 1e6, "N/m")], RESOLVED)
    label = (ax.xaxis if which == "x" else ax.yaxis).label
    assert label.get_text() == "stiffness of the connector [MN/m]"
    (key,) = ax.findobj(Annotation)
    assert key.get_text() == "cases.tied.stiffness"
    assert key.get_fontsize() < label.get_fontsize()
