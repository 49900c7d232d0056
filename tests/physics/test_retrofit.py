"""The retrofit of the gallery against matrices of its own, by DOP853: blows on columns and inclined dampers."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp

import pounding_cli

STUDY = Path(__file__).parents[2] / "docs" / "gallery" / "retrofit.yaml"
STEP, END = 0.01, 2.0
ALPHA, BETA = 0.5, 0.002
FRAME = 4.2 + 3.3 * np.arange(9)
BLOCK = 3.6 * np.arange(1, 7)
MASSES = 1e3 * np.array([420.0] * 8 + [350.0] + [380.0] * 6)
BLOWS_ON_COLUMNS = {1: 1, 2: 2, 4: 5, 5: 6, 6: 7}
"""Storey of the frame that each floor of the block strikes."""


def ground_acceleration(time: np.ndarray) -> np.ndarray:
    """Return an invented motion [m/s2]."""
    return 5.0 * np.sin(7.0 * time) * np.exp(-0.3 * time) + 2.0 * np.sin(16.0 * time)


def build_links(stiffnesses: np.ndarray, has_dampers: bool) -> list[tuple[np.ndarray, float, float, float]]:
    """Return the links: weights of the floors in the deformation, spring, dashpot, and the gap (-inf: it has none)."""
    spring, ratio = 20 * stiffnesses.max(), math.log(2) / math.hypot(math.pi, math.log(2))
    links = []
    for floor, storey in {3: None, **BLOWS_ON_COLUMNS}.items():
        weights, bending = np.zeros(15), 0.0
        weights[8 + floor] = -1.0
        if storey is None:
            weights[2] = 1.0
        else:
            foot = FRAME[storey - 2] if storey > 1 else 0.0
            part = (BLOCK[floor - 1] - foot) / (FRAME[storey - 1] - foot)
            share = 3 * part**2 - 2 * part**3
            weights[storey - 1] = share
            if storey > 1:
                weights[storey - 2] = 1 - share
            bending = 4 * (part * (1 - part)) ** 3 / stiffnesses[storey - 1]
        k = 1 / (1 / spring + bending)
        links.append((weights, k, 2 * ratio * math.sqrt(k / (weights**2 / MASSES).sum()), 0.04))
    for floor in (2, 4, 6) if has_dampers else ():
        weights = np.zeros(15)
        weights[[floor - 1, 8 + floor]] = np.array([1.0, -1.0]) * 2 / math.hypot(2, FRAME[floor - 1] - BLOCK[floor - 1])
        links.append((weights, 0.0, 2e6, -math.inf))
    return links


def find_peak_drifts(stiffnesses: np.ndarray, has_dampers: bool) -> np.ndarray:
    """Return the largest drift of every storey [m]."""
    drifts = np.eye(15) - np.diag(np.ones(14), -1)
    drifts[9, 8] = 0.0  # the block stands on the ground
    stiffness = drifts.T @ np.diag(stiffnesses) @ drifts
    damping = ALPHA * np.diag(MASSES) + BETA * stiffness
    links = build_links(stiffnesses, has_dampers)
    weights = np.array([link[0] for link in links])
    springs, dashpots, gaps = np.array([link[1:] for link in links]).T
    has_gap = np.isfinite(gaps)
    samples = ground_acceleration(STEP * np.arange(round(END / STEP) + 1))

    def derivative(time: float, state: np.ndarray) -> np.ndarray:
        u, v = state[:15], state[15:]
        closing = weights @ u - np.where(has_gap, gaps, 0.0)
        force = np.where(~has_gap | (closing > 0), springs * closing + dashpots * (weights @ v), 0.0)
        ground = np.interp(time, STEP * np.arange(samples.size), samples)
        return np.concatenate([v, -ground - (stiffness @ u + damping @ v + weights.T @ force) / MASSES])

    times = np.linspace(0, END, 8001)
    found = solve_ivp(derivative, (0, END), np.zeros(30), "DOP853", times, rtol=1e-9, atol=1e-11, max_step=STEP)
    sizes = np.abs(drifts @ found.y[:15])
    peaks = []
    for series in sizes:
        at = min(max(int(series.argmax()), 1), series.size - 2)
        before, middle, after = series[at - 1 : at + 2]
        peaks.append(middle + (after - before) ** 2 / (8 * (2 * middle - before - after)))  # of the parabola
    return np.array(peaks)


@pytest.mark.parametrize("case", ["as_built", "dampers"])
def test_the_retrofit_of_the_gallery_against_its_own_matrices(case: str, tmp_path: Path) -> None:
    study = yaml.safe_load(STUDY.read_text(encoding="utf-8"))
    np.savetxt(tmp_path / "motion.txt", ground_acceleration(STEP * np.arange(round(END / STEP) + 1)), fmt="%.17g")
    study["records"] = {"use": [{"file": str(tmp_path / "motion.txt"), "dt": f"{STEP} s", "unit": "m/s2"}]}
    for building in study["buildings"].values():
        building["rayleigh"] = {"alpha": ALPHA, "beta": BETA}
    study |= {"cases": {case: study["cases"][case]}, "analyses": ["elastic"], "accuracy": 1e-9}
    del study["optimise"], study["gap"]
    results = pounding_cli.run(pounding_cli.load_study(study), output=tmp_path / "results.h5")
    stiffnesses = results.table("buildings")["stiffness"].to_numpy()
    storeys = results.storey("drift")
    assert (results.link("impacts")["impacts"] > 0).sum() >= 2
    expected = find_peak_drifts(stiffnesses, case == "dampers")
    np.testing.assert_allclose(storeys["drift"].to_numpy(), expected, rtol=0, atol=1e-6 * expected.max())
