"""Two damped oscillators joined by a spring and a dashpot: coupled frequencies and steady-state ratios."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Oscillators:
    """Two one-storey systems connected by a spring K and a dashpot c (paper, Fig. 4).

    Parameters
    ----------
    m1, m2 : masses [kg], > 0
    k1, k2 : stiffnesses [N/m], > 0
    zeta1, zeta2 : damping ratios of the two systems alone [-], >= 0
    stiffness : K of the connector [N/m], >= 0
    dashpot : c of the connector [N s/m], >= 0 (eq. 10)
    """

    m1: float
    m2: float
    k1: float
    k2: float
    zeta1: float
    zeta2: float
    stiffness: float
    dashpot: float = 0.0

    def __post_init__(self) -> None:
        for name in ("m1", "m2", "k1", "k2"):
            if not 0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} has to be positive and finite, not {getattr(self, name)!r}")
        for name in ("zeta1", "zeta2", "stiffness", "dashpot"):
            if not 0 <= getattr(self, name) < math.inf:
                raise ValueError(f"{name} has to be finite and not negative, not {getattr(self, name)!r}")

    @classmethod
    def from_ratios(
        cls,
        p: float,
        connector: float,
        damping: float,
        mass_ratio: float = 1.0,
        connector_damping: float = 0.0,
    ) -> Oscillators:
        """The pair in the paper's ratios, with m1 = 1 kg and omega10 = 1 rad/s.

        p : omega20 / omega10 [-]; connector : K / k1 [-]; damping : of both systems [-];
        mass_ratio : m2 / m1 [-]; connector_damping : xi of the connector's dashpot [-] (eq. 7).
        """
        dashpot = eq7_dashpot(connector, connector_damping, 1.0, mass_ratio)
        return cls(1.0, mass_ratio, 1.0, mass_ratio * p**2, damping, damping, connector, dashpot)

    @property
    def omega10(self) -> float:
        """Circular frequency of system 1 alone [rad/s]."""
        return math.sqrt(self.k1 / self.m1)

    @property
    def omega20(self) -> float:
        """Circular frequency of system 2 alone [rad/s]."""
        return math.sqrt(self.k2 / self.m2)

    @property
    def p(self) -> float:
        """omega20 / omega10 [-]."""
        return self.omega20 / self.omega10


def eq7_dashpot(stiffness: float, xi: float, m1: float, m2: float) -> float:
    """Dashpot of a connector, c = 2 xi sqrt(K m1 m2 / (m1 + m2)) [N s/m] (eq. 7, units corrected)."""
    return 2 * xi * math.sqrt(stiffness * m1 * m2 / (m1 + m2))


def coupled_frequencies(pair: Oscillators) -> tuple[float, float]:
    """The two undamped circular frequencies of the connected systems [rad/s], lower first.

    With a = (k1 + K) / m1, b = (k2 + K) / m2, the characteristic equation is
    (a - w^2) (b - w^2) = K^2 / (m1 m2). The lower root comes from the product of the roots,
    (k1 k2 + K (k1 + k2)) / (m1 m2), a sum of positive terms: nothing cancels for a stiff connector.
    """
    k = pair.stiffness
    a, b = (pair.k1 + k) / pair.m1, (pair.k2 + k) / pair.m2
    high = 0.5 * (a + b) + math.hypot(0.5 * (a - b), k / math.sqrt(pair.m1 * pair.m2))
    product = (pair.k1 / pair.m1) * (pair.k2 / pair.m2) + k * (pair.k1 + pair.k2) / (pair.m1 * pair.m2)
    return math.sqrt(product / high), math.sqrt(high)


def response_ratios(pair: Oscillators, omega: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Steady-state displacement, connected over alone, of both systems under a_g = exp(i Omega t).

    With D_j = k_j - m_j Omega^2 + i Omega c_j and Z = K + i Omega c, Cramer's rule gives

        R1 = D1 (D2 + Z (m1 + m2) / m1) / (D1 D2 + Z (D1 + D2)),

    and R2 by exchanging the indices, so that m1 R1 + m2 R2 = m1 + m2 whatever K, c, p and Omega are.

    Parameters
    ----------
    omega : circular frequencies of the ground motion [rad/s], shape (n,), > 0

    Returns
    -------
    R1, R2 : complex ratios [-], shape (n,); their absolute values are the paper's Fig. 5
    """
    omega = np.asarray(omega, dtype=float)
    d1 = pair.k1 - pair.m1 * omega**2 + 2j * pair.zeta1 * pair.omega10 * pair.m1 * omega
    d2 = pair.k2 - pair.m2 * omega**2 + 2j * pair.zeta2 * pair.omega20 * pair.m2 * omega
    z = pair.stiffness + 1j * omega * pair.dashpot
    total = pair.m1 + pair.m2
    determinant = d1 * d2 + z * (d1 + d2)
    return d1 * (d2 + z * total / pair.m1) / determinant, d2 * (d1 + z * total / pair.m2) / determinant
