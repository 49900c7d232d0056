"""Strength by the Uniform Building Code or a base-shear coefficient: storey shears, displacements, separation.

Sources: ICBO, Uniform Building Code, editions 1985 and 1988 (sec. 2312), 1991 (secs 2331-2337) and
1994 (secs 1624-1631); clause numbers stand beside the formulas. ASCE/SEI 7-16 and FEMA 356 where they are named.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pounding_cli.model.stiffness import positive
from pounding_cli.records.motion import GRAVITY

EDITIONS = (1985, 1988, 1991, 1994)
"""Editions of the code that `UbcDesign` knows."""

DISTRIBUTIONS = ("triangular", "uniform", "parabolic", "asce7", "ubc")
"""Distributions of a base shear over the height that `BaseShearDesign` knows."""


@dataclass(frozen=True)
class UbcDesign:
    """Static lateral force procedure of one edition of the UBC.

    Parameters
    ----------
    edition : one of EDITIONS; 1988, 1991 and 1994 share their formulas
    zone : seismic zone factor Z [-], 0 < Z <= 1; in zone 4 0.4 from 1988 on (Table 23-I, in 1994 16-I), 1.0
        in 1985
    soil : site coefficient S [-]: 1.0, 1.2, 1.5 (2.0 from 1988 on)
    importance : importance factor I [-]
    rw : structural system coefficient Rw [-], from 1988 on: 12 for a special moment-resisting frame (Table
        23-O, in 1994 16-N)
    k : horizontal force factor K [-], 1985 (Table 23-I): 0.67 for a ductile moment-resisting frame

    Raises
    ------
    ValueError : an edition not in EDITIONS, or a factor outside its range
    """

    edition: int
    zone: float
    soil: float = 1.2
    importance: float = 1.0
    rw: float = 12.0
    k: float = 0.67

    def __post_init__(self) -> None:
        if self.edition not in EDITIONS:
            raise ValueError(f"UBC edition {self.edition}: choose one of {', '.join(map(str, EDITIONS))}")
        for name, word in (("zone", "Z"), ("soil", "S"), ("importance", "I"), ("rw", "Rw"), ("k", "K")):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{word} is {value:g}: it must be finite and above zero")
        if self.zone > 1:
            raise ValueError(f"Z is {self.zone:g}: give the zone factor (0.4 in zone 4; 1.0 in 1985), not its number")

    def base_shear_coefficient(self, period: float) -> float:
        """Base shear over weight V/W [-] at the fundamental period [s].

        1988 on: V = Z I C W / Rw, C = 1.25 S / T^(2/3) <= 2.75, C / Rw >= 0.075
        (1988: sec. 2312(e)2; 1991: sec. 2334(b)1, eqs 34-1 and 34-2; 1994: sec. 1628.2.1, eqs 28-1 and 28-2).
        With S = 1.2 and Rw = 12 the lower bound governs above T = 2.15 s only: no building of the paper meets
        it.

        1985: V = Z I K C S W, C = 1 / (15 sqrt T) <= 0.12, C S <= 0.14 (sec. 2312(d), eqs 12-1 and 12-2).

        Raises
        ------
        ValueError : period not finite and positive
        """
        _check_period(period)
        if self.edition == 1985:
            c = min(1 / (15 * math.sqrt(period)), 0.12)
            return self.zone * self.importance * self.k * min(c * self.soil, 0.14)
        c = min(1.25 * self.soil / period ** (2 / 3), 2.75)
        return self.zone * self.importance * max(c / self.rw, 0.075)

    @property
    def amplification(self) -> float:
        """Separation over elastic displacement under the design forces [-]: 3 Rw / 8, in 1985 3 / K.

        1991: sec. 2337(b)11; 1994: sec. 1631.2.11; 1985: sec. 2312(j)1.D (3.0 / K times the drift).
        """
        return 3 / self.k if self.edition == 1985 else 3 * self.rw / 8

    def floor_forces(self, mass: ArrayLike, height: ArrayLike, period: float) -> np.ndarray:
        """Design force on every floor [N], shape (n,): F_t at the roof, the rest of V by w_x h_x.

        F_t = 0.07 T V <= 0.25 V, zero for T <= 0.7 s (1985: sec. 2312(e), eqs 12-5 to 12-7; 1991: sec.
        2334(d), eqs 34-6 to 34-8; 1994: sec. 1628.4, eqs 28-6 to 28-8).

        Parameters
        ----------
        mass : floor masses [kg], from the ground up, shape (n,), > 0
        height : storey heights [m], from the ground up, shape (n,), > 0
        period : fundamental period [s], > 0

        Raises
        ------
        ValueError : shapes differ or a value is not finite and positive
        """
        m, h = _per_storey(mass=mass, height=height)
        return _with_top_force(self.base_shear_coefficient(period) * GRAVITY * m.sum(), m, h, period)

    def yield_shears(self, mass: ArrayLike, height: ArrayLike, period: float) -> np.ndarray:
        """Storey shears under the design forces [N], from the ground up, shape (n,).

        The paper takes them as the yield levels of the inelastic analyses (parametric studies). Arguments and
        errors as `floor_forces`.
        """
        return _storey_shears(self.floor_forces(mass, height, period))

    def design_displacements(
        self, mass: ArrayLike, height: ArrayLike, stiffness: ArrayLike, period: float
    ) -> np.ndarray:
        """Design maximum floor displacements on a fixed base [m], from the ground up, shape (n,).

        Elastic displacements under the design forces times `amplification`. `stiffness` : storey stiffnesses
        [N/m], from the ground up, shape (n,), > 0; other arguments and errors as `floor_forces`.
        """
        return self.amplification * _static_displacements(self, mass, height, stiffness, period)


@dataclass(frozen=True)
class BaseShearDesign:
    """Yield shears from a base-shear coefficient and a distribution of the forces over the height.

    Parameters
    ----------
    coefficient : base shear over weight V/W [-], > 0
    distribution : one of DISTRIBUTIONS; the force on floor x is a share of V,
        uniform: w_x (FEMA 356, sec. 3.3.3.2.3, uniform pattern)
        triangular: w_x h_x (ASCE/SEI 7-16, sec. 12.8.3 with k = 1)
        parabolic: w_x h_x^2 (the same with k = 2)
        asce7: w_x h_x^k, k = 1 up to T = 0.5 s, 2 from 2.5 s on, linear between (the same, eqs 12.8-11 and 12.8-12)
        ubc: F_t = 0.07 T V <= 0.25 V at the roof, zero for T <= 0.7 s, the rest by w_x h_x (UBC 1991, sec. 2334(d))

    Raises
    ------
    ValueError : a coefficient that is not finite and positive, or a distribution not in DISTRIBUTIONS
    """

    coefficient: float
    distribution: str = "triangular"

    def __post_init__(self) -> None:
        if not (math.isfinite(self.coefficient) and self.coefficient > 0):
            raise ValueError(f"V/W is {self.coefficient:g}: it must be finite and above zero")
        if self.distribution not in DISTRIBUTIONS:
            raise ValueError(f"distribution {self.distribution}: choose one of {', '.join(DISTRIBUTIONS)}")

    def floor_forces(self, mass: ArrayLike, height: ArrayLike, period: float) -> np.ndarray:
        """Force on every floor [N], shape (n,); their sum is V. Arguments and errors as `UbcDesign.floor_forces`."""
        _check_period(period)
        m, h = _per_storey(mass=mass, height=height)
        shear = self.coefficient * GRAVITY * m.sum()
        if self.distribution == "ubc":
            return _with_top_force(shear, m, h, period)
        slope = min(max(1 + (period - 0.5) / 2, 1.0), 2.0)
        k = {"uniform": 0.0, "triangular": 1.0, "parabolic": 2.0, "asce7": slope}[self.distribution]
        share = m * (np.cumsum(h) / h.sum()) ** k
        return shear * share / share.sum()

    def yield_shears(self, mass: ArrayLike, height: ArrayLike, period: float) -> np.ndarray:
        """Storey shears under those forces [N], from the ground up, shape (n,). Arguments and errors as there."""
        return _storey_shears(self.floor_forces(mass, height, period))

    def elastic_displacements(
        self, mass: ArrayLike, height: ArrayLike, stiffness: ArrayLike, period: float
    ) -> np.ndarray:
        """Floor displacements of the elastic building under those forces on a fixed base [m], without P-Delta, shape
        (n,), from the ground up: delta_max of ASCE/SEI 7-16, 12.8.6, and d_e of EN 1998-1:2004, 4.3.4, where V is the
        design base shear of that code.  Arguments and errors as `UbcDesign.design_displacements`."""
        return _static_displacements(self, mass, height, stiffness, period)


def _static_displacements(
    design: UbcDesign | BaseShearDesign, mass: ArrayLike, height: ArrayLike, stiffness: ArrayLike, period: float
) -> np.ndarray:
    """Elastic displacements under the design forces on a fixed base [m], shape (n,), from the ground up."""
    m, h, k = _per_storey(mass=mass, height=height, stiffness=stiffness)
    return np.cumsum(design.yield_shears(m, h, period) / k)


def _storey_shears(forces: np.ndarray) -> np.ndarray:
    """Sums of floor forces from every storey up [N], shape (n,)."""
    return np.cumsum(forces[::-1])[::-1]


def _with_top_force(shear: float, mass: np.ndarray, height: np.ndarray, period: float) -> np.ndarray:
    """A base shear over the floors [N]: F_t = 0.07 T V <= 0.25 V at the roof above T = 0.7 s, the rest by w h."""
    top = min(0.07 * period, 0.25) * shear if period > 0.7 else 0.0
    moment = mass * np.cumsum(height)
    forces = (shear - top) * moment / moment.sum()
    forces[-1] += top
    return forces


def code_separation(left: ArrayLike, right: ArrayLike) -> np.ndarray:
    """Separation two neighbours need at their common floors [m]: the sum of their design displacements.

    `left`, `right` : design displacements [m], from the ground up, shapes (n,) and (m,); storey heights are
    equal. Returns shape (min(n, m),); its last entry, at the lower roof, is the largest (UBC: clauses of
    `UbcDesign.amplification`; the paper's "sum of the design maximum displacements").

    Raises
    ------
    ValueError : an array is empty or a value is not finite and positive
    """
    (one,), (other,) = _per_storey(left=left), _per_storey(right=right)
    common = min(one.size, other.size)
    return one[:common] + other[:common]


def _check_period(period: float) -> None:
    if not (math.isfinite(period) and period > 0):
        raise ValueError(f"period is {period:g} s: it must be finite and above zero")


def _per_storey(**values: ArrayLike) -> list[np.ndarray]:
    arrays = {name: positive(name, value) for name, value in values.items()}
    if len({array.size for array in arrays.values()}) > 1:
        sizes = ", ".join(f"{array.size} of {name}" for name, array in arrays.items())
        raise ValueError(f"{sizes}: give one value of each per storey")
    return list(arrays.values())
