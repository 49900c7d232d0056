"""Plans of floors in words: how wide they are, where their lines stand, and which of them twist why."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from pounding_cli.model.building import Building
from pounding_cli.model.effects import NOTHING_ECCENTRIC
from pounding_cli.model.links import Link
from pounding_cli.model.plan import FloorPlan, FrameLine
from pounding_cli.model.twist import describe_eccentricity, find_twist_reasons
from pounding_cli.numbers import format_range, join_limited

MAX_SHOWN_PERIODS = 3
"""Number of natural periods that are told of a plan."""


def describe_plans(buildings: Sequence[Building]) -> Iterator[tuple[str, str]]:
    """Yield the name of every building of a row that has a plan, and its plan in words."""
    for building in buildings:
        if building.plan is not None:
            yield building.name, _describe_plan(building.plan, building.mass)


def _describe_plan(plan: FloorPlan, mass: np.ndarray) -> str:
    """Return a plan in words; mass : of the floors [kg], shape (n,)."""
    width = plan.high - plan.low
    middle = 0.5 * (plan.low + plan.high)
    ends = f"{plan.street + plan.low:.4g} to {plan.street + plan.high:.4g} m"
    words = [f"{width:.4g} m wide, {ends} along the street"]
    if abs(middle) > 1e-9 * width:
        words.append(f"centres of mass {_format_offset(-middle, width)} from the middle")
    words.append(f"lines from the middle: {_describe_lines(plan.lines, plan.stiffness, -middle)}")
    if plan.lines_across:
        places = join_limited(f"{line.arm:.4g} m" for line in plan.lines_across)
        words.append(f"lines across at {places} from the centre of mass")
    words.append(_describe_eccentricity(plan.eccentricity, width))
    periods = ", ".join(f"{period:.3g}" for period in plan.periods(mass)[:MAX_SHOWN_PERIODS])
    words.append(f"turns {plan.frequency_ratio(mass):.3g} times as fast as it moves along the row, each by itself")
    words.append(f"periods of both together {periods} s")
    return "; ".join(words)


def _describe_lines(lines: Sequence[FrameLine], stiffness: np.ndarray, centre: float) -> str:
    """Return where lines along the row stand, with their shares of the stiffness.

    stiffness : of the storeys [N/m], shape (n,)
    centre : y of the centres of mass from the middle of the plan [m]
    """
    texts = []
    for line in lines:
        shares = 100.0 * line.stiffness / stiffness
        parts = format_range(float(shares.min()), float(shares.max()), ".3g")
        texts.append(f"{line.arm + centre:.4g} m ({parts} %)")
    return join_limited(texts)


def _describe_eccentricity(eccentricity: np.ndarray, width: float) -> str:
    """Return how far the centres of stiffness stand from the centres of mass; eccentricity : shape (n,) [m]."""
    largest = float(eccentricity[np.abs(eccentricity).argmax()])
    if abs(largest) <= 1e-9 * width:
        return "centres of stiffness at those of mass"
    up_to = "" if np.ptp(eccentricity) <= 1e-9 * width else "up to "
    return f"centres of stiffness {up_to}{_format_offset(largest, width)} from those of mass"


def _format_offset(offset: float, width: float) -> str:
    """Return a distance across the row with its part of the width."""
    return f"{offset:.3g} m ({100 * offset / width:.3g} % of the width)"


def describe_twists(
    buildings: Sequence[Building], links_by_case: Mapping[str, Sequence[Link]]
) -> Iterator[tuple[str, str]]:
    """Yield every case, and `alone`, with which buildings twist in it and why, in words.

    buildings : of the row, with their plans
    """
    for case, links in links_by_case.items():
        reasons = find_twist_reasons(buildings, links)
        yield case, _join_reasons(buildings, reasons)
    yield "alone", _join_reasons(buildings, [describe_eccentricity(building) for building in buildings])


def _join_reasons(buildings: Sequence[Building], reasons: Sequence[str]) -> str:
    """Return the buildings of a row that twist with the reason, and those with a plan that do not.

    reasons : of every building, "" of those that do not twist
    """
    if not any(reasons):
        return NOTHING_ECCENTRIC
    texts = [f"{building.name}: {reason}" for building, reason in zip(buildings, reasons, strict=True) if reason]
    still = [
        building.name
        for building, reason in zip(buildings, reasons, strict=True)
        if building.plan is not None and not reason
    ]
    if still:
        without = "its plan" if len(still) == 1 else "their plans"
        texts.append(f"{join_limited(still)}: nothing is eccentric, run without {without}")
    return "; ".join(texts)
