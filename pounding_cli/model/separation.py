"""Rules for the separation of two neighbours from the peaks of each alone, and those of codes.

The exact requirement is the largest closing u_left - u_right over time; a rule estimates it without the time at which
each building peaks. Lengths [m]; arrays of any shape, element by element."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pounding_cli.model.building import Building
from pounding_cli.model.plan import FloorPlan
from pounding_cli.records.code_spectra import ASCE7, EN1998, GB50011, NTC2018
from pounding_cli.units import GRAVITY


def absolute_sum(left: ArrayLike, right: ArrayLike) -> np.ndarray:
    """ABS: both peaks at once and apart, the upper bound of what is required."""
    return np.abs(left) + np.abs(right)


def root_of_squares(left: ArrayLike, right: ArrayLike) -> np.ndarray:
    """SRSS: peaks that do not depend on one another."""
    return np.hypot(left, right)


def double_difference(left: ArrayLike, right: ArrayLike, correlation: ArrayLike) -> np.ndarray:
    """DDC: sqrt(uA^2 + uB^2 - 2 rho uA uB); buildings that move alike (rho = 1) need no more than their difference.

    correlation : rho of `cross_correlation`

    Source: Jeng, V., Kasai, K. & Maison, B. F. (1992). A spectral difference method to estimate building separations to
    avoid pounding. Earthquake Spectra 8(2), 201-223.
    """
    a, b = np.abs(left), np.abs(right)
    return np.sqrt(np.maximum(a**2 + b**2 - 2 * np.asarray(correlation) * a * b, 0.0))


def cross_correlation(
    left_period: float, right_period: float, left_damping: float = 0.05, right_damping: float = 0.05
) -> float:
    """rho of two oscillators under one white noise [-], from 0 to 1.

    Parameters
    ----------
    left_period, right_period : [s], > 0
    left_damping, right_damping : damping ratios [-], > 0

    Source: Der Kiureghian, A. (1981). A response spectrum method for random vibration analysis of MDF systems.
    Earthquake Eng. Struct. Dyn. 9(5), 419-435.
    """
    a, b, q = left_damping, right_damping, right_period / left_period
    above = 8 * math.sqrt(a * b) * (b + a * q) * q**1.5
    return above / ((1 - q**2) ** 2 + 4 * a * b * q * (1 + q**2) + 4 * (a**2 + b**2) * q**2)


def first_mode_damping(building: Building) -> float:
    """Damping ratio of the first mode of the fixed-base building [-]: (alpha / w + beta w) / 2."""
    omega = 2 * math.pi / float(building.periods[0])
    return (building.alpha / omega + building.beta * omega) / 2


def edge_displacement(plan: FloorPlan, shears: np.ndarray, arm: float) -> np.ndarray:
    """Return the static displacements of the floors of an elastic building at a place of its plan [m], shape (n,).

    The forces pass through the centres of mass, so that no torsional moment acts about these: every storey deforms by
    the drift d and the twist t of [[k, -k e], [-k e, k_t]] (d, t) = (V, 0), and the place by d - arm t.

    Parameters
    ----------
    plan : of the building
    shears : of the storeys under these forces [N], shape (n,)
    arm : of the place [m]
    """
    stiffness = plan.stiffness
    coupling = plan.eccentricity * stiffness
    turning = plan.torsional_stiffness + np.sum([line.arm**2 * line.stiffness for line in plan.all_lines], axis=0)
    drift = shears / (stiffness - coupling**2 / turning)
    twist = coupling / turning * drift
    return np.cumsum(drift - arm * twist)


def asce7_displacement(elastic: ArrayLike, deflection_factor: float, importance: float) -> np.ndarray:
    """Maximum inelastic displacement delta_M of ASCE/SEI 7-16, 12.12.3 [m]: Cd delta_max / Ie (eq. 12.12-1).

    A building stays that far away from a property line; structures on one property stay sqrt(delta_M1^2 + delta_M2^2)
    apart (eq. 12.12-2). Equation 16-64 of the International Building Code is the same.

    Parameters
    ----------
    elastic : delta_max, largest displacement of the elastic building under the design forces [m]
    deflection_factor, importance : Cd and Ie of the building [-]
    """
    return np.abs(elastic) * deflection_factor / importance


def en1998_displacement(elastic: ArrayLike, behaviour_factor: float) -> np.ndarray:
    """Displacement d_s of EN 1998-1:2004, 4.3.4 [m]: q_d d_e (eq. 4.23).

    A building stays that far away from a property line (4.4.2.7(2)(a)).

    Parameters
    ----------
    elastic : d_e, displacement by a linear analysis under the design forces [m]
    behaviour_factor : displacement behaviour factor q_d of the building [-]; q unless otherwise specified
    """
    return np.abs(elastic) * behaviour_factor


def en1998_separation(left: ArrayLike, right: ArrayLike, same_floors: ArrayLike) -> np.ndarray:
    """Distance of two buildings on one property, EN 1998-1:2004, 4.4.2.7 [m]: the square root of the sum of the squares
    of their displacements d_s (2)(b), times 0.7 where their floors have the same elevations (3).

    left, right : d_s at the level [m]; same_floors : whether the floors have the same elevations
    """
    return np.hypot(left, right) * np.where(same_floors, 0.7, 1.0)


GB_STEP = {6: 5.0, 7: 4.0, 8: 3.0, 9: 2.0}
"""GB 50011-2010: height above 15 m that widens the joint by 20 mm [m], by seismic fortification intensity."""

GB_SHARE = {"frame": 1.0, "frame-wall": 0.7, "wall": 0.5}
"""GB 50011-2010: share of a frame's joint width, by structural system."""


def gb50011_width(height: float, intensity: int, structure: str = "frame") -> float:
    """Least width of a seismic joint between reinforced concrete buildings, GB 50011-2010, 6.1.4 [m].

    100 mm up to a height of 15 m, 20 mm more for every 5, 4, 3 or 2 m above it (intensity 6, 7, 8, 9); frame-wall
    structures 70 %, wall structures 50 % of that, and never below 100 mm.

    Parameters
    ----------
    height : of the lower building [m]
    intensity : one of GB_STEP
    structure : one of GB_SHARE

    Source: clause 6.1.4, item 1 of the code, which counts whole steps of height; a part of a step counts as one here.
    """
    steps = math.ceil(max(0.0, height - 15.0) / GB_STEP[intensity] - 1e-9)
    return max(0.1, GB_SHARE[structure] * (0.1 + 0.02 * steps))


def ntc_separation(
    left: float,
    right: float,
    level: float,
    left_height: float,
    right_height: float,
    acceleration: float,
    edition: int = 2018,
) -> float:
    """Return the distance of two constructions that face each other, NTC 2018, 7.2.1, or NTC 2008, 7.2.2 [m].

    It is the sum of both displacements at the limit state of life safety (SLV), and never below z / 100 times
    a_g S / (0.5 g), of which no more than 1 counts. A construction for which nothing is calculated moves by 1 / 100 of
    its height times a_g S / g (2018) or a_g S / (0.5 g) (2008).

    Parameters
    ----------
    left, right : displacements at the SLV at this level, mu_d times the elastic ones [m]; NaN where not calculated
    level : height z of the points that face each other above the foundation [m]
    left_height, right_height : of the constructions above the foundation [m]
    acceleration : a_g S over g [-]
    edition : 2018 or 2008

    Source: D.M. 17 gennaio 2018, 7.2.1, and D.M. 14 gennaio 2008, 7.2.2, "Distanza tra costruzioni contigue".
    """
    share = (1.0 if edition == 2018 else 2.0) * acceleration / 100
    left = share * left_height if math.isnan(left) else left
    right = share * right_height if math.isnan(right) else right
    return max(left + right, level / 100 * min(2 * acceleration, 1.0))


def tbdy2018_separation(left: float, right: float, level: float, same_floors: bool) -> float:
    """Return the width of a seismic joint, TBDY 2018, 4.9.3 [m].

    alpha times the square root of the sum of the squares of the reduced displacements, alpha = 0.25 R / I where the
    floors are at the same levels and 0.5 R / I elsewhere; at least 30 mm up to a height of 6 m and 10 mm more for every
    3 m above it.

    Parameters
    ----------
    left, right : R / I times the reduced displacement of each building at this level [m]: the clause has one R / I, and
        each building keeps its own here
    level : height above the base [m]; a part of a step of 3 m counts as one
    """
    steps = math.ceil(max(0.0, level - 6.0) / 3.0 - 1e-9)
    share = 0.25 if same_floors else 0.5
    return float(np.maximum(share * math.hypot(left, right), 0.03 + 0.01 * steps))


def e030_displacement(elastic: ArrayLike, reduction: float, irregular: bool = False) -> np.ndarray:
    """Return the lateral displacement of E.030 (Peru, 2018), article 31.1 [m]: 0.75 R times the elastic one under the
    reduced forces, 0.85 R of an irregular structure.

    reduction : R of the building [-]
    """
    return np.abs(elastic) * (0.85 if irregular else 0.75) * reduction


def e030_minimum(level: float) -> float:
    """Return the least separation s of E.030 (Peru, 2018), article 33.2 [m]: 0.006 h, at least 30 mm.

    level : height h above the ground [m]
    """
    return max(0.006 * level, 0.03)


NBC202_WIDTH = 0.04
"""Least physical separation of the blocks of a building, NBC 202:2015 (Nepal), "separation of blocks" [m]: the code
asks for 40 to 50 mm throughout the height above the plinth."""


# The rules of codes in one list


@dataclass(frozen=True)
class CodePlace:
    """A height where two neighbours face each other, as rules of codes see it.

    left, right : displacements there that the code expects [m]; NaN of a building without the factors of the code
    level : height above the base [m]
    left_height, right_height : of the buildings [m]
    same_floors : whether the floors of both have the same elevations
    """

    left: float
    right: float
    level: float
    left_height: float
    right_height: float
    same_floors: bool


@dataclass(frozen=True)
class CodeRule:
    """A rule of a code for the gap between two buildings.

    name : of the rule in tables; that of the UBC is followed by the edition
    clause : where the code has it
    separation : of a CodePlace and the keys of `section` [m]; NaN where it says nothing
    factors : keys of a building's `yield` that its displacement needs
    options : further keys of `yield`, which have a default
    displacement : of the elastic displacement under the design forces, the factors and the options [m]; None of a rule
        that has none, or whose design knows it (UBC)
    line : distance from a property line of the displacement and the height of a floor [m]; None where the rule has none
    section : key of `gap` that selects the rule and has its settings; "" of a rule that factors or `codes` select
    by_name : whether `gap.codes` must name it
    source : key of the reference that a study cites
    at_base : whether it holds at a base that moves, too
    """

    name: str
    clause: str
    separation: Callable[..., Any]
    factors: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    displacement: Callable[..., np.ndarray] | None = None
    line: Callable[[float, float], float] | None = None
    section: str = ""
    by_name: bool = False
    source: str = ""
    at_base: bool = False


UBC = "UBC"
NTC2008 = "NTC 2008"
TBDY2018 = "TBDY 2018"
E030 = "E.030"
NBC202 = "NBC 202"
"""Names of the rules of codes that `records.code_spectra` does not name."""


def _scale(elastic: ArrayLike, *factors: float) -> np.ndarray:
    """Return elastic displacements times all factors."""
    return np.abs(elastic) * math.prod(factors)


def _apply_ntc(place: CodePlace, ag: float, soil: float, edition: int) -> float:
    acceleration = ag * soil / GRAVITY
    return ntc_separation(
        place.left, place.right, place.level, place.left_height, place.right_height, acceleration, edition
    )


CODE_RULES = (
    CodeRule(
        GB50011,
        "6.1.4",
        lambda place, **keys: gb50011_width(min(place.left_height, place.right_height), **keys),
        section="gb50011",
        source="gb50011-2010",
        at_base=True,
    ),
    CodeRule(UBC, "1991: 2337(b)11", lambda place: absolute_sum(place.left, place.right)),
    CodeRule(
        ASCE7,
        "12.12.3",
        lambda place: root_of_squares(place.left, place.right),
        factors=("Cd", "Ie"),
        displacement=asce7_displacement,
        line=lambda displacement, _: displacement,
        source="asce2017",
    ),
    CodeRule(
        EN1998,
        "4.4.2.7",
        lambda place: en1998_separation(place.left, place.right, place.same_floors),
        factors=("qd",),
        displacement=en1998_displacement,
        line=lambda displacement, _: displacement,
        source="en1998",
    ),
    CodeRule(
        NTC2018,
        "7.2.1",
        lambda place, **keys: _apply_ntc(place, edition=2018, **keys),
        options=("mu_d",),
        displacement=_scale,
        section="ntc2018",
        source="ntc2018",
    ),
    CodeRule(
        NTC2008,
        "7.2.2",
        lambda place, **keys: _apply_ntc(place, edition=2008, **keys),
        options=("mu_d",),
        displacement=_scale,
        section="ntc2008",
        source="ntc2008",
    ),
    CodeRule(
        TBDY2018,
        "4.9.3",
        lambda place: tbdy2018_separation(place.left, place.right, place.level, place.same_floors),
        factors=("R", "Ie"),
        displacement=lambda elastic, reduction, importance: _scale(elastic, reduction / importance),
        by_name=True,
        source="tbdy2018",
    ),
    CodeRule(
        E030,
        "33",
        lambda place: np.maximum(2 / 3 * (place.left + place.right), e030_minimum(place.level)),
        factors=("R",),
        options=("irregular",),
        displacement=e030_displacement,
        line=lambda displacement, level: float(np.maximum(2 / 3 * displacement, e030_minimum(level) / 2)),
        by_name=True,
        source="e030-2018",
    ),
    CodeRule(NBC202, "separation of blocks", lambda place: NBC202_WIDTH, by_name=True, source="nbc202-2015"),
)
"""The rules of codes, in the order of the tables."""
