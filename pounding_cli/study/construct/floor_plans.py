"""Build the plans of buildings whose floors twist from what a study writes."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from pounding_cli.errors import InputError, Issue
from pounding_cli.model.plan import FloorPlan, FrameLine, find_square_radii
from pounding_cli.model.stiffness import frequencies
from pounding_cli.study.schema.floor_plan import PlanSpec

EVENLY_SPREAD = 1.0 / math.sqrt(12.0)
"""Distance of two equal lines from their centre, over the width, at which they resist the twist as frames do that stand
evenly across the width [-]."""


NO_TORSIONAL_RESISTANCE = 1e-9
"""Torsional stiffness about the centre of stiffness over that of frames spread evenly [-] that counts as none."""


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
    InputError : nothing resists the twist, or a short form asks for what no lines give
    """
    centre = plan.centre
    inertia = _find_inertia(plan, mass)
    torsional_stiffness = _fill(plan.torsional_stiffness or 0.0, mass.size)
    across = tuple(
        _build_line(f"across {number}", line.x, line.stiffness, line.yield_shear, stiffness, yield_shear)
        for number, line in enumerate(plan.across, 1)
    )
    if plan.lines is None:
        nominal, torsional_stiffness = _build_short_form(plan, mass, inertia, stiffness, yield_shear)
        moved = plan.centre_of_mass - centre
        lines = tuple(replace(line, arm=line.arm + moved) for line in nominal)
    else:
        arms = [line.y - centre for line in plan.lines]
        parts = zip(arms, plan.fill_rest("stiffness"), plan.fill_rest("yield_shear"), strict=True)
        lines = tuple(_build_line(str(number), *part, stiffness, yield_shear) for number, part in enumerate(parts, 1))
    half = 0.5 * plan.width
    built = FloorPlan(
        inertia,
        lines,
        torsional_stiffness,
        across,
        low=-half - centre,
        high=half - centre,
        street=plan.shift + centre,
        twists_always=plan.twist == "always",
    )
    if plan.lines is not None:
        _check_resistance(built, plan)
    return built


def _check_resistance(built: FloorPlan, plan: PlanSpec) -> None:
    """Refuse a plan whose floors can turn about their centre of stiffness.  Raises InputError."""
    matrices = built.storey_matrices()
    about_centre = matrices[:, 1, 1] - built.eccentricity**2 * built.stiffness
    of_spread = (EVENLY_SPREAD * plan.width) ** 2 * built.stiffness
    free = np.flatnonzero(about_centre <= NO_TORSIONAL_RESISTANCE * of_spread)
    if free.size:
        which = "line stands" if len(built.lines) == 1 else "lines stand"
        message = f"nothing resists the twist of storey {free[0] + 1}: "
        message += f"its {which} at one place along the street"
        hint = "write a second line at another `y`, lines `across:`, "
        hint += "or `torsional_stiffness:`, e.g. `5e9 N m`"
        raise InputError([Issue(("lines",), message, hint)])


def _find_inertia(plan: PlanSpec, mass: np.ndarray) -> np.ndarray:
    """Return the rotary inertias of the floors [kg m2], shape (storeys,); those of rectangles unless given."""
    if plan.inertia is not None:
        return _fill(plan.inertia, mass.size)
    assert plan.depth is not None
    return mass * (plan.width**2 + plan.depth**2) / 12.0


def _build_line(
    name: str,
    arm: float,
    stiffness: Any,
    yield_shear: Any,
    whole_stiffness: np.ndarray,
    whole_yield_shear: np.ndarray,
) -> FrameLine:
    """Return a line.

    Parameters
    ----------
    arm : from the centres of mass [m]
    stiffness, yield_shear : of its storeys, or its shares; yield_shear None for its share of the stiffness
    whole_stiffness, whole_yield_shear : of the storeys of the building, shape (storeys,)
    """
    own_stiffness = _take_share(stiffness, whole_stiffness)
    if yield_shear is None:
        return FrameLine(name, arm, own_stiffness, whole_yield_shear * (own_stiffness / whole_stiffness))
    if yield_shear == "never":
        return FrameLine(name, arm, own_stiffness, _take_never(yield_shear, own_stiffness.size))
    return FrameLine(name, arm, own_stiffness, _take_share(yield_shear, whole_yield_shear))


def _take_never(value: Any, storeys: int) -> np.ndarray:
    """Return yield shears [N] as an array, inf for `never`, shape (storeys,)."""
    return np.full(storeys, np.inf) if value == "never" else np.array(value)


def _take_share(value: Any, whole: np.ndarray) -> np.ndarray:
    """Return a list as an array, or a share of the whole."""
    return np.array(value) if isinstance(value, tuple) else value * whole


def _build_short_form(
    plan: PlanSpec,
    mass: np.ndarray,
    inertia: np.ndarray,
    stiffness: np.ndarray,
    yield_shear: np.ndarray,
) -> tuple[tuple[FrameLine, ...], np.ndarray]:
    """Return two equal lines about the centre of stiffness, and the torsional stiffness beside them [N m].

    They stand as far apart as frames spread evenly across the width resist the twist, or closer where the plan ends or
    the ratio of frequencies asks for less. Their places are from the centres of mass without what is accidental.

    Raises
    ------
    InputError : the eccentricity is too large for the plan, or for the ratio of frequencies
    """
    assert plan.eccentricity is not None
    assert plan.frequency_ratio is not None
    centre = plan.centre_of_mass
    eccentricity = plan.eccentricity * plan.width
    written = f"an eccentricity of {100 * plan.eccentricity:.4g} %"
    to_edge = 0.5 * plan.width - abs(centre + eccentricity)
    if to_edge <= 0.0:
        distance = f"{centre + eccentricity:.4g} m from the middle of the plan"
        message = f"{written} puts the centre of stiffness {distance}, outside of its {plan.width:g} m"
        low, high = (100 * (side * 0.5 - centre / plan.width) for side in (-1.0, 1.0))
        bounds = f"above {max(low, -50.0):.4g} % and below {min(high, 50.0):.4g} %"
        raise InputError([Issue(("eccentricity",), message, f"write an eccentricity {bounds}")])
    radii_at_one = _find_radii_at_ratio_one(mass, inertia, stiffness)
    whole_radii = plan.frequency_ratio * radii_at_one
    square_reach = float(whole_radii.min() ** 2) - eccentricity**2
    if square_reach <= 1e-9 * eccentricity**2:
        least = abs(eccentricity) / float(radii_at_one.min())
        most = 100 * float(whole_radii.min()) / plan.width
        message = f"{written} at a frequency_ratio of {plan.frequency_ratio:g} "
        message += "leaves nothing that resists the twist"
        hint = f"write a frequency_ratio above {_round_up(least):g}, "
        hint += f"or an eccentricity within {most:.3g} %"
        raise InputError([Issue(("frequency_ratio",), message, hint)])
    reach = min(EVENLY_SPREAD * plan.width, to_edge, math.sqrt(square_reach))
    lines = tuple(
        FrameLine(name, eccentricity + side * reach, 0.5 * stiffness, 0.5 * yield_shear)
        for name, side in (("1", -1.0), ("2", 1.0))
    )
    whole = whole_radii**2 * stiffness
    rest = whole - stiffness * (reach**2 + eccentricity**2)
    return lines, np.where(rest > 1e-12 * whole, rest, 0.0)


def _find_radii_at_ratio_one(mass: np.ndarray, inertia: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
    """Return the square roots of torsional over storey stiffness [m] with which a building turns as fast as it moves
    along the row, each without the other, shape (storeys,).

    They are in proportion to the radii of gyration of what stands above.
    """
    square_radius = find_square_radii(inertia, mass)
    ratio = frequencies(mass, stiffness)[0] / frequencies(inertia, square_radius * stiffness)[0]
    return np.asarray(ratio * np.sqrt(square_radius))


def _round_up(value: float) -> float:
    """Return a number rounded up to three digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - 2)
    return math.ceil(value / step) * step


def _fill(value: Any, storeys: int) -> np.ndarray:
    """Return a value for every storey, shape (storeys,)."""
    return np.array(value) if isinstance(value, tuple) else np.full(storeys, float(value))
