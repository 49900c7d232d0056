"""`pound optimise` on two connected oscillators against the closed form of Fig. 4 (docs/connector.md)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import minimize

from pounding_cli.batch import run_plan
from pounding_cli.connector.oscillators import Oscillators, response_ratios
from pounding_cli.store import open_results
from pounding_cli.study import load_study
from pounding_cli.study.optimise import expand_optimise

MASS, PERIOD, ZETA = 200e3, 0.5, 0.05
OMEGA = 2 * math.pi / PERIOD
K1 = MASS * OMEGA**2
RATIOS = (0.6, 0.9, 1.0)
"""Frequencies of the ground over that of the first system: both systems alone, and a stiffly joined pair, resonate."""

STUDY = """\
title: Spring and dashpot between two oscillators
records: {use: ["sine*.txt"], scale: 1}
buildings:
  first: {storeys: 1, period: 0.5 s, mass: 200 t, height: 3 m, damping: 5 %}
  second: {like: first, period: 0.8333333333333334 s}
group: [first, second]
cases:
  joined:
    link:
      - {link: connector, gap: 10 m, stiffness: 5 MN/m, damping_ratio: 0}
      - {link: damper, gap: 10 m, damping_coefficient: 1000 kN s/m}
analyses: [elastic]
estimate: sample
optimise:
  least: max(drift in first, drift in second)
  over_motions: largest
  over:
    cases.joined.link.0.stiffness: {from: 0.1 MN/m, to: 30 MN/m, spacing: log}
    cases.joined.link.1.damping_coefficient: {from: 10 kN s/m, to: 10000 kN s/m, spacing: log}
  slice_points: 11
  map_points: 5
  seed: SEED
"""


def worst(stiffness: float, dashpot: float) -> float:
    """The larger of both steady displacements, the largest over the frequencies [m]."""
    pair = Oscillators(MASS, MASS, K1, 0.36 * K1, ZETA, ZETA, stiffness, dashpot)
    omega = OMEGA * np.array(RATIOS)
    alone = [
        MASS / np.abs(k - MASS * omega**2 + 2j * ZETA * math.sqrt(k * MASS) * omega) for k in (pair.k1, pair.k2)
    ]  # fmt: skip
    return max(float((np.abs(r) * u).max()) for r, u in zip(response_ratios(pair, omega), alone, strict=True))


@pytest.fixture(scope="module")
def closed_form():
    """Stiffness [N/m], dashpot [N s/m] and value [m] of the least, by a fine grid and the simplex method."""
    grid = [(k, c) for k in np.geomspace(1e5, 3e7, 120) for c in np.geomspace(1e4, 1e7, 120)]
    begin = min(grid, key=lambda at: worst(*at))
    found = minimize(
        lambda x: worst(*np.exp(x)), np.log(begin), method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-14}
    )
    return (*np.exp(found.x), found.fun)


def sine(ratio: float) -> str:
    """60 cycles of growth without a kink, 8 of steady sine, 80 samples a cycle."""
    cycles = np.arange(0, 68, 1 / 80)
    growth = np.where(cycles < 60, 0.5 - 0.5 * np.cos(np.pi * cycles / 60), 1.0)
    step = PERIOD / ratio / 80
    lines = [
        f"{place * step:.9f} {value:.9f}" for place, value in enumerate(growth * np.sin(2 * np.pi * cycles))
    ]  # fmt: skip
    return "\n".join(["# unit m/s2", *lines, ""])


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_two_oscillators_from_three_seeds(tmp_path, closed_form, seed):
    """Value within 1e-3 (the sampled sine), place within the range that the answer calls as good, from every seed."""
    for number, ratio in enumerate(RATIOS):
        (tmp_path / f"sine{number}.txt").write_text(sine(ratio))
    path = tmp_path / "joined.yaml"
    path.write_text(STUDY.replace("SEED", str(seed)))
    run_plan(expand_optimise(load_study(path)), tmp_path / "r.h5", engine_name="serial")
    rows = open_results(tmp_path / "r.h5").table("optimise")
    stiffness, dashpot, value = closed_form
    assert rows["optimum"].tolist() == pytest.approx([value] * 2, rel=1e-3)
    assert rows["value"].tolist() == pytest.approx([stiffness, dashpot], rel=0.01)
    assert (rows["flat_from"] < [stiffness, dashpot]).all()
    assert (rows["flat_to"] > [stiffness, dashpot]).all()
    assert rows["as_written"].tolist() == pytest.approx([worst(5e6, 1e6)] * 2, rel=1e-3)
    for row, known in zip(rows.to_dict("records"), (stiffness, dashpot), strict=True):
        for end in ("flat_from", "flat_to"):  # where the closed form leaves the bottom by 1 %
            moved = [stiffness, dashpot]
            moved[moved.index(known)] = row[end]
            assert worst(*moved) == pytest.approx(1.01 * value, rel=3e-3)
