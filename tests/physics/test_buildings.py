"""Buildings from the keys of a study: stiffness from a period, damping of two modes, strengths by code."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

import pounding_cli as pound
from tests.adapter import solve

G = 9.80665


def matrix(stiffness: np.ndarray) -> np.ndarray:
    """Of a shear building on a fixed base [N/m]."""
    above = np.append(stiffness[1:], 0.0)
    return np.diag(stiffness + above) - np.diag(above[:-1], 1) - np.diag(above[:-1], -1)


def modes(building: pound.Building) -> tuple[np.ndarray, np.ndarray]:
    """Circular frequencies [rad/s] and shapes, M-normal."""
    squares, shapes = eigh(matrix(building.stiffness), np.diag(building.mass))
    return np.sqrt(squares), shapes


@pytest.mark.parametrize(
    ("mass", "period", "taper"), [([1e5], 0.3, 1.0), ([2e5] * 5, 0.36, 1 / 3), ([3e5, 1e4, 7e5, 2e5], 2.0, 3.0)]
)
def test_the_period_asked_for_is_the_period_found(mass: list[float], period: float, taper: float) -> None:
    """Fails if the scale is not squared, or the taper runs from the top down."""
    building = pound.building("b", mass=mass, period=period, taper=taper, storeys=len(mass))
    assert 2 * math.pi / modes(building)[0][0] == pytest.approx(period, rel=1e-9)
    k = building.stiffness
    assert k[-1] / k[0] == pytest.approx(taper if len(mass) > 1 else 1.0, rel=1e-12)
    assert np.diff(k, 2) == pytest.approx(np.zeros(max(len(mass) - 2, 0)), abs=1e-9 * k[0])


def test_a_uniform_building_has_the_sine_frequencies() -> None:
    """w_1 = 2 sqrt(k/m) sin(pi / (4n + 2)). Fails if the roof hangs on a storey above."""
    n, m = 7, 2e5
    building = pound.building("b", storeys=n, mass=m, period=0.7, taper=1.0)
    omega = 2 * math.sqrt(building.stiffness[0] / m) * math.sin(math.pi / (4 * n + 2))
    assert omega == pytest.approx(2 * math.pi / 0.7, rel=1e-10)


@pytest.mark.parametrize("n", [1, 2, 5])
def test_rayleigh_damping_of_the_first_two_modes(n: int) -> None:
    """Fails if beta is doubled, or the second mode is another."""
    building = pound.building("b", storeys=n, mass=np.linspace(1.0, 2.0, n).tolist(), period=0.5, damping=0.05)
    omega, shapes = modes(building)
    damping = building.alpha * np.diag(building.mass) + building.beta * matrix(building.stiffness)
    found = np.diag(shapes.T @ damping @ shapes)
    assert found[:2] == pytest.approx(2 * 0.05 * omega[:2], rel=1e-10)
    if n == 1:
        assert building.alpha == pytest.approx(building.beta * omega[0] ** 2, rel=1e-10)


CODES: tuple[tuple[dict[str, Any], float, float], ...] = (
    ({"code": "UBC-1991", "zone": 0.4, "soil": 1.2}, 0.36, 0.4 * 2.75 / 12),  # C = 2.96, cut at 2.75
    ({"code": "UBC-1991", "zone": 0.4, "soil": 1.2}, 0.60, 0.4 * 1.5 / 0.60 ** (2 / 3) / 12),
    (
        {"code": "UBC-1988", "zone": 0.3, "soil": 1.5, "importance": 1.25, "Rw": 8}, 2.0,
        0.3 * 1.25 * 1.875 / 2 ** (2 / 3) / 8,
    ),
    ({"code": "UBC-1994", "zone": 0.4, "soil": 1.2}, 3.0, 0.4 * 0.075),  # C / Rw = 0.060, raised to 0.075
    ({"code": "UBC-1985", "zone": 1.0, "soil": 1.2, "K": 1.0}, 0.60, 1.2 / (15 * math.sqrt(0.6))),
    ({"code": "UBC-1985", "zone": 1.0, "soil": 1.0, "K": 0.67}, 0.10, 0.67 * 0.12),  # C = 0.211, cut at 0.12
    ({"code": "UBC-1985", "zone": 0.75, "soil": 1.5, "K": 1.0}, 0.30, 0.75 * 0.14),  # C S = 0.18, cut at 0.14
    ({"base_shear": 0.1, "distribution": "triangular"}, 0.5, 0.1),
    ({"code": "UBC-1991", "zone": 0.4, "soil": 1.2, "overstrength": 2.0}, 0.36, 2 * 0.4 * 2.75 / 12),
)  # fmt: skip


@pytest.mark.parametrize(("design", "period", "share"), CODES, ids=lambda each: str(each)[:40])
def test_base_shear_by_code(design: dict[str, Any], period: float, share: float) -> None:
    """The lowest storey carries the whole base shear. Fails if a bound of C is dropped, or T has another power."""
    building = pound.building("b", storeys=5, mass=2e5, period=period, yield_=design)
    assert building.yield_shear[0] == pytest.approx(share * G * 1e6, rel=1e-10)
    assert (np.diff(building.yield_shear) < 0).all()


@pytest.mark.parametrize(("period", "at_top"), [(0.6, 0.0), (0.7, 0.0), (1.0, 0.07), (4.0, 0.25)])
def test_top_force(period: float, at_top: float) -> None:
    """0.07 T V above 0.7 s and at most V / 4; of the rest F_j = V j / 15 on five equal floors. Fails if the sum runs
    from the ground up, or the bound is dropped."""
    building = pound.building("b", storeys=5, mass=2e5, period=period, yield_={"code": "UBC-1991"})
    expected = at_top + (1 - at_top) * np.array([15, 14, 12, 9, 5]) / 15
    assert building.yield_shear / building.yield_shear[0] == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize(
    ("distribution", "weights"),
    [("triangular", [1, 2, 3]), ("uniform", [1, 1, 1]), ("parabolic", [1, 4, 9]), ("asce7", [1, 2**1.25, 3**1.25])],
)
def test_distributions_of_a_base_shear(distribution: str, weights: list[float]) -> None:
    """ASCE 7's k is 1.25 at 1 s, between 1 at 0.5 s and 2 at 2.5 s. Fails if forces go by another power of height."""
    design = {"base_shear": 0.1, "distribution": distribution}
    building = pound.building("b", storeys=3, mass=2e5, period=1.0, yield_=design)
    expected = np.cumsum(weights[::-1])[::-1] / sum(weights)
    assert building.yield_shear / building.yield_shear[0] == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize(("e", "xi"), [(0.5, 0.21545), (0.8, 0.07086), (1.0, 0.0)])
def test_damping_ratio_of_a_restitution(e: float, xi: float) -> None:
    """xi = -ln e / sqrt(pi^2 + ln^2 e). Fails if it is e itself, or the logarithm has another base."""
    two = [pound.building("b", storeys=1, period=0.5)] * 2
    scene = pound.scene(two, pound.motion([0.0, 1.0], dt=0.1), gap=0.0, impact={"restitution": e})
    assert scene.links[0].law.damping_ratio == pytest.approx(xi, abs=1e-5)


SEPARATION = """\
title: code
records: {use: [elcentro], duration: 2 s}
buildings:
  stiff: {storeys: 5, period: 0.36 s, yield: {code: UBC-1991, zone: 0.4, soil: 1.2, Rw: 12}}
  soft: {like: stiff, period: 0.60 s}
group: [stiff, soft]
cases: {c: {link: pounding, gap: 0 cm}}
"""


def test_what_codes_and_rules_ask_for(tmp_path: Path) -> None:
    """The paper's pair: about 7 cm by UBC-1991, the flexibility of the whole building times 3 Rw / 8; the rules of
    peaks from the buildings alone; what is required, the largest closing. Fails with the amplification 3 Rw / 4, at
    another floor, or with another correlation."""
    (tmp_path / "s.yaml").write_text(SEPARATION)
    table = pound.run(tmp_path / "s.yaml", tmp_path / "s.h5", engine="serial", workflow="gap").table("gap")
    table = table[table["analysis"] == "elastic"].set_index(["rule", "floor"])["largest"]
    found = {rule: table[rule].to_numpy() for rule in ("exact", "ABS", "SRSS", "DDC", "UBC-1991")}

    motion, codes, peaks = pound.motion("elcentro", duration=2.0), [], []
    two = [pound.building("b", storeys=5, period=period) for period in (0.36, 0.60)]
    for building, share in zip(two, (0.4 * 2.75 / 12, 0.4 * 1.5 / 0.60 ** (2 / 3) / 12), strict=True):
        forces = share * G * building.mass.sum() * np.arange(1, 6) / 15
        codes.append(4.5 * np.linalg.solve(matrix(building.stiffness), forces))
        alone = solve(pound.scene([building], motion, analysis="elastic"), 1e-9)
        peaks.append(np.maximum(alone.displacement_max, -alone.displacement_min))
    assert found["UBC-1991"] == pytest.approx(sum(codes), rel=1e-6)
    assert found["UBC-1991"][-1] == pytest.approx(0.069, abs=5e-4)

    a, b = peaks
    r, xi = 0.6, 0.05
    rho = 8 * xi**2 * (1 + r) * r**1.5 / ((1 - r**2) ** 2 + 4 * xi**2 * r * (1 + r) ** 2)
    assert found["ABS"] == pytest.approx(a + b, rel=1e-6)
    assert found["SRSS"] == pytest.approx(np.hypot(a, b), rel=1e-6)
    assert found["DDC"] == pytest.approx(np.sqrt(a**2 + b**2 - 2 * rho * a * b), rel=1e-6)
    apart = solve(pound.scene(two, motion, analysis="elastic", gap=1.0), 1e-9)
    assert found["exact"] == pytest.approx(apart.max_closing, rel=1e-6)
