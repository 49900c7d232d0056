"""Closed forms of single oscillators, impacts and hysteresis loops."""

from __future__ import annotations

import math
from dataclasses import dataclass


def oscillator_under_ramp(
    u0: float, v0: float, acceleration: float, slope: float, omega: float, xi: float, t: float
) -> tuple[float, float]:
    """u, u' at t of u'' + 2 xi w u' + w^2 u = -(a + s t) from u0, v0 (Chopra, Dynamics of Structures)."""
    c1 = -slope / omega**2
    c0 = (-acceleration - 2 * xi * omega * c1) / omega**2
    damped = omega * math.sqrt(1 - xi**2)
    a = u0 - c0
    b = (v0 - c1 + xi * omega * a) / damped
    decay, cos, sin = math.exp(-xi * omega * t), math.cos(damped * t), math.sin(damped * t)
    u = decay * (a * cos + b * sin) + c0 + c1 * t
    v = decay * ((b * damped - xi * omega * a) * cos - (a * damped + xi * omega * b) * sin) + c1
    return u, v


@dataclass(frozen=True)
class Impact:
    """Kelvin-Voigt impact of two free masses with closing speed v0.

    rebound : separation speed over v0 [-]
    time : duration of the force [s]
    peak_force : largest force [N]
    compression : largest compression [m]
    pull : largest pulling force [N], positive
    """

    rebound: float
    time: float
    peak_force: float
    compression: float
    pull: float


def kelvin_voigt(s: float, xi: float, reduced: float, v0: float, tension_cut: bool = False) -> Impact:
    """Impact by eqs (6) and (7) (with m' = m1 m2 / (m1 + m2)); contact ends at zero compression, or at zero
    force.

    v = v0 / wd exp(-xi w t) sin(wd t), F = s v + 2 xi sqrt(s m') v'; 0 < xi < 1/2.
    """
    w = math.sqrt(s / reduced)
    wd = w * math.sqrt(1 - xi**2)

    def v(t: float) -> float:
        return v0 / wd * math.exp(-xi * w * t) * math.sin(wd * t)

    def rate(t: float) -> float:
        return v0 * math.exp(-xi * w * t) * (math.cos(wd * t) - xi * w / wd * math.sin(wd * t))

    def force(t: float) -> float:
        return s * v(t) + 2 * xi * math.sqrt(s * reduced) * rate(t)

    compressed = math.atan2(wd, xi * w) / wd  # v' = 0
    strongest = math.atan2(wd, xi * w * (1 + 2 / (1 - 4 * xi**2))) / wd  # F' = 0
    end = math.pi / wd
    if tension_cut:  # F = 0: v' / v = -w / (2 xi)
        end = math.atan2(wd, xi * w - w / (2 * xi)) / wd
    return Impact(-rate(end) / v0, end, force(strongest), v(compressed), -force(math.pi / wd))


def infill_compression(energy: float, s_mat: float, s_imp: float, gap: float, printed: bool = False) -> float:
    """Largest compression [m] of an undamped infill that takes up `energy` [J]: quartic energy balance of eq.
    (9).

    p v^4 / 4 + s_mat v^2 / 2 = E up to the gap, p = (s_imp - s_mat) / (3 d^2); beyond it F(d) + s_imp (v -
    d), or s_imp v as printed.
    """
    p = (s_imp - s_mat) / (3 * gap**2)
    at_gap = p * gap**4 / 4 + s_mat * gap**2 / 2
    if energy <= at_gap:
        return math.sqrt((-s_mat / 2 + math.sqrt(s_mat**2 / 4 + p * energy)) / (p / 2))
    force = s_imp * gap if printed else p * gap**3 + s_mat * gap
    # force x + s_imp x^2 / 2 = E - E(d), x = v - d
    return gap + (-force + math.sqrt(force**2 + 2 * s_imp * (energy - at_gap))) / s_imp


@dataclass(frozen=True)
class Excursion:
    """First two half cycles of an undamped bilinear oscillator thrown from rest at v0, for an energy that
    yields both ways.

    first, second : drift at the two reversals [m]; shear : force at the first [N]; loop : energy lost up to
        the second [J]
    """

    first: float
    second: float
    shear: float
    loop: float


def bilinear_throw(mass: float, stiffness: float, yield_shear: float, hardening: float, v0: float) -> Excursion:
    """Energy balance over the skeleton Vy + a k (D - Dy) and the unloading branch of width 2 Vy."""
    dy, soft = yield_shear / stiffness, hardening * stiffness
    energy = mass * v0**2 / 2
    excess = energy - yield_shear * dy / 2  # Vy x + soft x^2 / 2
    first = dy + _stretch(yield_shear, soft, excess)
    shear = yield_shear + soft * (first - dy)
    # Back down: elastic over 2 Dy from shear to shear - 2 Vy, then at slope `soft` until the speed is 0.
    gained = (shear**2 - (shear - 2 * yield_shear) ** 2) / (2 * stiffness)
    second = first - 2 * dy - _stretch(2 * yield_shear - shear, soft, gained)
    lost = energy - _recoverable(second, stiffness, yield_shear, hardening)
    return Excursion(first, second, shear, lost)


def _stretch(force: float, slope: float, energy: float) -> float:
    """x > 0 with force x + slope x^2 / 2 = energy."""
    return 2 * energy / (force + math.sqrt(force**2 + 2 * slope * energy))


def _recoverable(drift: float, stiffness: float, yield_shear: float, hardening: float) -> float:
    """Energy stored at a reversal on the lower skeleton [J]: springs (1 - a) k and a k side by side."""
    dy = yield_shear / stiffness
    return (1 - hardening) * stiffness * dy**2 / 2 + hardening * stiffness * drift**2 / 2
