"""Walls in a group: no question gives them rows, or counts the numbers that they do not have as failed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from pounding_cli import open_results

STUDY = """\
title: A house between a rigid neighbour and the wall of its moat
records: {use: [elcentro, taft], scale: {pga: 0.3 g}, duration: 4 s}
buildings:
  house: {storeys: 2, period: 0.4 s}
  rigid: {wall: fixed}
  soil: {wall: {mass: 50 t, stiffness: 1e8 N/m}}
group: [rigid, house, soil]
cases: {gap: {link: pounding, gap: 1 cm}}
analyses: [inelastic]
estimate: none
sweep: {records.scale.pga: [0.1 g, 0.3 g, 1 g]}
fragility: {method: stripes, limits: [mu > 4, drift > 2 %, acceleration > 2 g, contact]}
uncertain:
  cases.gap.gap: {uniform: {from: 1 cm, to: 5 cm}}
  impact.restitution: {uniform: {from: 0.4, to: 0.6}}
sensitivity: {outputs: [largest mu, largest acceleration], samples: 4}
optimise:
  least: largest acceleration
  over: {cases.gap.gap: {from: 5 mm, to: 3 cm}}
  population: 5
  generations: 1
  slice_points: 5
"""
WALLS = ("rigid", "soil")


@pytest.mark.parametrize("question", ["run", "gap", "fragility", "sensitivity", "optimise"])
def test_a_wall_has_no_rows(pound, question):
    code, out, _ = pound(question, "two.yaml", "-o", "r.h5")
    assert code == 0
    results = open_results("r.h5")
    assert "failed" not in re.sub(r"\b0 failed", "", out)
    assert not re.search(r"\b(has|have) no value\b", out)
    for name in results.answers:
        table = results.table(name)
        assert not {"rigid", "soil"} & set(table.get("building", ())), name
        assert not [text for text in table.get("quantity", ()) if text.endswith(WALLS)], name
    first = out[: out.index("Time histories:")]
    assert not re.search(r"\b(rigid|soil), (storey|floor) 1\b", first)  # as the place of a largest value
    pound("report", "r.h5", "-q", "--no-figures", "-o", "page")
    page = Path("page/report.html").read_text(encoding="utf-8")
    assert "too few" not in page


def test_values_of_walls_count_in_no_largest(pound):
    """The wall on the soil has the largest acceleration of all; outputs and optima are of buildings."""
    pound("run", "two.yaml", "-q", "-o", "r.h5")
    floor = open_results("r.h5").floor()
    largest = floor.groupby("building")["acceleration"].max()
    assert largest["soil"] > largest["house"]
    pound("optimise", "two.yaml", "-q", "-o", "o.h5")
    design = open_results("o.h5").table("optimise_design").set_index("quantity")
    house = floor[floor["building"] == "house"].groupby(["records.scale.pga", "floor"])["acceleration"].mean().max()
    assert design.loc["largest acceleration", "as_written"] == pytest.approx(house, rel=1e-12)


@pytest.mark.parametrize(
    ("question", "before", "after", "place", "words"),
    [
        ("fragility", "mu > 4,", "mu in soil > 4,", "12:39", "soil is a wall, which has no mu"),
        ("fragility", "drift > 2 %", "drift in rigid > 2 %", "12:47", "rigid is a wall, which has no drift"),
        ("fragility", "contact]", "collapse in soil]", "12:80", "soil is a wall, which has no collapse"),
        ("sensitivity", "largest mu,", "largest mu in soil,", "16:25", "soil is a wall, which has no mu"),
        (
            "optimise",
            "least: largest",
            "least: mean mu in rigid + largest",
            "18:10",
            "rigid is a wall, which has no mu",
        ),
    ],
)
def test_what_a_wall_does_not_have_is_refused(pound, folder, question, before, after, place, words):
    (folder / "two.yaml").write_text(STUDY.replace(before, after, 1))
    code, _, err = pound(question, "two.yaml", "-o", "r.h5")
    assert code == 2
    assert f"two.yaml:{place}: " in err
    assert words in err
    assert "house" in err


def test_the_movement_of_a_wall_on_the_soil_may_be_limited(pound, folder):
    (folder / "two.yaml").write_text(STUDY.replace("drift > 2 %", "drift in soil > 1 mm"))
    assert pound("fragility", "two.yaml", "-o", "r.h5")[0] == 0
    table = open_results("r.h5").table("fragility")
    assert table.loc[table["building"] == "soil", "limit"].tolist() == 2 * ["drift in soil > 1 mm"]  # alone and not
    assert (table["failed"] == 0).all()
