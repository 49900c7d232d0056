"""Strength by the Uniform Building Code or a base-shear coefficient: storey shears, displacements, separation.

Sources: ICBO, Uniform Building Code, editions 1985 and 1988 (sec. 2312), 1991 (secs 2331-2337) and
1994 (secs 1624-1631); clause numbers stand beside the formulas. ASCE/SEI 7-16 and FEMA 356 where they are named.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pounding_cli.units import GRAVITY


class Design:
    """Static design of a building on a fixed base; arrays run from the ground up, shape (n,).

    The arguments of its methods are floor masses [kg], storey heights [m], storey stiffnesses [N/m] and the
    fundamental period [s], all above zero.
    """

    def floor_forces(self, mass: np.ndarray, height: np.ndarray, period: float) -> np.ndarray:
        """Design force on every floor [N]; their sum is the base shear."""
        raise NotImplementedError

    def yield_shears(self, mass: np.ndarray, height: np.ndarray, period: float) -> np.ndarray:
        """Storey shears under the design forces [N].

        The paper takes them as the yield levels of the inelastic analyses (parametric studies).
        """
        return np.cumsum(self.floor_forces(mass, height, period)[::-1])[::-1]

    def displacements(self, mass: np.ndarray, height: np.ndarray, stiffness: np.ndarray, period: float) -> np.ndarray:
        """Floor displacements of the elastic building under the design forces [m], without P-Delta: delta_max of
        ASCE/SEI 7-16, 12.8.6, and d_e of EN 1998-1:2004, 4.3.4, where V is the design base shear of that code."""
        return np.cumsum(self.yield_shears(mass, height, period) / stiffness)


@dataclass(frozen=True)
class UbcDesign(Design):
    """Static lateral force procedure of one edition of the UBC.

    Parameters
    ----------
    edition : 1985, 1988, 1991 or 1994; the last three share their formulas
    zone : seismic zone factor Z [-], 0 < Z <= 1; in zone 4 0.4 from 1988 on (Table 23-I, in 1994 16-I), 1.0
        in 1985
    soil : site coefficient S [-]: 1.0, 1.2, 1.5 (2.0 from 1988 on)
    importance : importance factor I [-]
    rw : structural system coefficient Rw [-], from 1988 on: 12 for a special moment-resisting frame (Table
        23-O, in 1994 16-N)
    k : horizontal force factor K [-], 1985 (Table 23-I): 0.67 for a ductile moment-resisting frame
    """

    edition: int
    zone: float
    soil: float = 1.2
    importance: float = 1.0
    rw: float = 12.0
    k: float = 0.67

    def base_shear_coefficient(self, period: float) -> float:
        """Base shear over weight V/W [-] at the fundamental period [s].

        1988 on: V = Z I C W / Rw, C = 1.25 S / T^(2/3) <= 2.75, C / Rw >= 0.075
        (1988: sec. 2312(e)2; 1991: sec. 2334(b)1, eqs 34-1 and 34-2; 1994: sec. 1628.2.1, eqs 28-1 and 28-2).
        With S = 1.2 and Rw = 12 the lower bound governs above T = 2.15 s only: no building of the paper meets
        it.

        1985: V = Z I K C S W, C = 1 / (15 sqrt T) <= 0.12, C S <= 0.14 (sec. 2312(d), eqs 12-1 and 12-2).
        """
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

    def floor_forces(self, mass: np.ndarray, height: np.ndarray, period: float) -> np.ndarray:
        """Design force on every floor [N]: F_t at the roof, the rest of V by w_x h_x (1985: sec. 2312(e), eqs 12-5 to
        12-7; 1991: sec. 2334(d), eqs 34-6 to 34-8; 1994: sec. 1628.4, eqs 28-6 to 28-8)."""
        return _with_top_force(self.base_shear_coefficient(period) * GRAVITY * mass.sum(), mass, height, period)


@dataclass(frozen=True)
class BaseShearDesign(Design):
    """Yield shears from a base-shear coefficient and a distribution of the forces over the height.

    Parameters
    ----------
    coefficient : base shear over weight V/W [-], > 0
    distribution : the force on floor x is a share of V,
        uniform: w_x (FEMA 356, sec. 3.3.3.2.3, uniform pattern)
        triangular: w_x h_x (ASCE/SEI 7-16, sec. 12.8.3 with k = 1)
        parabolic: w_x h_x^2 (the same with k = 2)
        asce7: w_x h_x^k, k = 1 up to T = 0.5 s, 2 from 2.5 s on, linear between (the same, eqs 12.8-11 and 12.8-12)
        ubc: F_t = 0.07 T V <= 0.25 V at the roof, zero for T <= 0.7 s, the rest by w_x h_x (UBC 1991, sec. 2334(d))
    """

    coefficient: float
    distribution: str = "triangular"

    def floor_forces(self, mass: np.ndarray, height: np.ndarray, period: float) -> np.ndarray:
        """Force on every floor [N]; their sum is V."""
        shear = self.coefficient * GRAVITY * mass.sum()
        if self.distribution == "ubc":
            return _with_top_force(shear, mass, height, period)
        slope = min(max(1 + (period - 0.5) / 2, 1.0), 2.0)
        k = {"uniform": 0.0, "triangular": 1.0, "parabolic": 2.0, "asce7": slope}[self.distribution]
        share = mass * (np.cumsum(height) / height.sum()) ** k
        return shear * share / share.sum()


def _with_top_force(shear: float, mass: np.ndarray, height: np.ndarray, period: float) -> np.ndarray:
    """A base shear over the floors [N]: F_t = 0.07 T V <= 0.25 V at the roof above T = 0.7 s, the rest by w h."""
    top = min(0.07 * period, 0.25) * shear if period > 0.7 else 0.0
    moment = mass * np.cumsum(height)
    forces = (shear - top) * moment / moment.sum()
    forces[-1] += top
    return forces
