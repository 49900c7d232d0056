"""Build the plans of buildings whose floors twist from what a study writes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from pounding_cli.model.plan import FloorPlan, FrameLine
from pounding_cli.study.plan_spec import PlanSpec

EVENLY_SPREAD = 1.0 / math.sqrt(12.0)
"""Distance of two equal lines from their centre, over the width, at which they resist the twist as frames do that stand
evenly across the width [-]."""


def sum_stiffness(plan: PlanSpec) -> np.ndarray:
    """Return the storey stiffnesses that lines give [N/m], shape (storeys,)."""
    return np.sum([np.array(line.stiffness) for line in plan.lines or ()], axis=0)


def sum_yield_shear(plan: PlanSpec, storeys: int) -> np.ndarray:
    """Return the storey yield shears that lines give [N], inf where one never yields, shape (storeys,)."""
    shears = [_take_never(line.yield_shear, storeys) for line in plan.lines or ()]
    return np.sum(shears, axis=0)


def build_plan(plan: PlanSpec, mass: np.ndarray, stiffness: np.ndarray, yield_shear: np.ndarray) -> FloorPlan:
    """Return the plan of a building.

    Parameters
    ----------
    mass : of the floors [kg], shape (storeys,)
    stiffness, yield_shear : of the storeys along the row [N/m], [N], shape (storeys,)

    Raises
    ------
    ValueError : its eccentricity leaves no torsional stiffness
    """
    centre = plan.centre_of_mass + plan.accidental * plan.width
    if abs(centre) >= 0.5 * plan.width:
        raise ValueError(f"plan: the centre of mass stands {centre:g} m off the middle of {plan.width:g} m")
    inertia = _find_inertia(plan, mass)
    torsional_stiffness = _fill(plan.torsional_stiffness or 0.0, mass.size)
    across = tuple(
        _build_line(f"across {number}", line.x, line, stiffness, yield_shear)
        for number, line in enumerate(plan.across, 1)
    )
    if plan.lines is None:
        lines, torsional_stiffness = _build_short_form(plan, centre, mass, inertia, stiffness, yield_shear)
    else:
        lines = tuple(
            _build_line(str(number), line.y - centre, line, stiffness, yield_shear)
            for number, line in enumerate(plan.lines, 1)
        )
    half = 0.5 * plan.width
    return FloorPlan(
        inertia, lines, torsional_stiffness, across, -half - centre, half - centre, plan.shift + centre,
        plan.twist == "always",
    )  # fmt: skip


def _find_inertia(plan: PlanSpec, mass: np.ndarray) -> np.ndarray:
    """Return the rotary inertias of the floors [kg m2], shape (storeys,); those of rectangles unless given."""
    if plan.inertia is not None:
        return _fill(plan.inertia, mass.size)
    assert plan.depth is not None
    return mass * (plan.width**2 + plan.depth**2) / 12.0


def _build_line(name: str, place: float, line: Any, stiffness: np.ndarray, yield_shear: np.ndarray) -> FrameLine:
    """Return a line; stiffness, yield_shear : of the storeys of the building, shape (storeys,)."""
    own_stiffness = _take_share(line.stiffness, stiffness)
    if line.yield_shear is None:
        return FrameLine(name, place, own_stiffness, yield_shear * (own_stiffness / stiffness))
    if line.yield_shear == "never":
        return FrameLine(name, place, own_stiffness, _take_never(line.yield_shear, stiffness.size))
    return FrameLine(name, place, own_stiffness, _take_share(line.yield_shear, yield_shear))


def _take_never(value: Any, storeys: int) -> np.ndarray:
    """Return yield shears [N] as an array, inf for `never`, shape (storeys,)."""
    return np.full(storeys, np.inf) if value == "never" else np.array(value)


def _take_share(value: Any, whole: np.ndarray) -> np.ndarray:
    """Return a list as an array, or a share of the whole."""
    return np.array(value) if isinstance(value, tuple) else value * whole


def _build_short_form(
    plan: PlanSpec,
    centre: float,
    mass: np.ndarray,
    inertia: np.ndarray,
    stiffness: np.ndarray,
    yield_shear: np.ndarray,
) -> tuple[tuple[FrameLine, ...], np.ndarray]:
    """Return two equal lines about the centre of stiffness, and the torsional stiffness beside them [N m].

    They stand as far apart as frames spread evenly across the width resist the twist, or closer where the plan ends or
    the ratio of frequencies asks for less.

    centre : y of the centre of mass from the middle of the plan [m]
    """
    assert plan.eccentricity is not None
    assert plan.frequency_ratio is not None
    eccentricity = plan.eccentricity * plan.width
    square_radius = np.cumsum(inertia[::-1])[::-1] / np.cumsum(mass[::-1])[::-1]
    square_reach = float(plan.frequency_ratio**2 * square_radius.min()) - eccentricity**2
    to_edge = 0.5 * plan.width - abs(centre + eccentricity)
    if square_reach <= 0.0 or to_edge <= 0.0:
        least = abs(eccentricity) / math.sqrt(float(square_radius.min()))
        raise ValueError(
            f"plan: an eccentricity of {100 * plan.eccentricity:.4g} % takes a frequency_ratio above {least:.4g} and a "
            f"centre of stiffness inside of the plan"
        )
    arm = min(EVENLY_SPREAD * plan.width, to_edge, math.sqrt(square_reach))
    lines = tuple(
        FrameLine(name, eccentricity + side * arm, 0.5 * stiffness, 0.5 * yield_shear)
        for name, side in (("1", -1.0), ("2", 1.0))
    )
    whole = plan.frequency_ratio**2 * square_radius * stiffness
    rest = whole - stiffness * (arm**2 + eccentricity**2)
    return lines, np.where(rest > 1e-12 * whole, rest, 0.0)


def _fill(value: Any, storeys: int) -> np.ndarray:
    """Return a value for every storey, shape (storeys,)."""
    return np.array(value) if isinstance(value, tuple) else np.full(storeys, float(value))
