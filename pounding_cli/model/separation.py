"""Rules for the separation of two neighbours from the peaks of each alone, and those of codes.

The exact requirement is the largest closing u_left - u_right over time; a rule estimates it without the time at which
each building peaks. Lengths [m]; arrays of any shape, element by element."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from pounding_cli.model.building import Building

UBC, ASCE7, EN1998 = "UBC", "ASCE 7-16", "EN 1998-1"
"""Names of the rules of codes that take a displacement of every building."""


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


def asce7_displacement(elastic: ArrayLike, deflection_factor: float, importance: float) -> np.ndarray:
    """Maximum inelastic displacement delta_M of ASCE/SEI 7-16, 12.12.3 [m]: Cd delta_max / Ie (eq. 12.12-1).

    A building stays that far away from a property line; structures on one property stay sqrt(delta_M1^2 + delta_M2^2)
    apart (eq. 12.12-2).

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
