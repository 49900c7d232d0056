"""Small buildings, motions and links the verification tests share."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pounding_cli.laws import link_laws
from pounding_cli.laws.dashpot import damping_ratio
from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.building import Building, weight_above
from pounding_cli.model.code_design import UbcDesign
from pounding_cli.model.foundation import Foundation
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.model.stiffness import rayleigh_factors, stiffness_for_period
from pounding_cli.records.motion import Motion

XI = damping_ratio(0.5)
ELASTIC, INELASTIC = Analysis.ELASTIC, Analysis.INELASTIC
FOUNDATION = Foundation(2e5, 1e9, 1e7, 1e7, 1e11, 1e8)


def shear_building(
    period: float,
    storeys: int = 3,
    foundation: Foundation | None = None,
    strength: float = 1.0,
    damping: float = 0.05,
) -> Building:
    """A building of 200 t floors as in the paper's studies, of `strength` times the code's storey shears."""
    mass, height = np.full(storeys, 2e5), np.full(storeys, 3.0)
    k = stiffness_for_period(mass, period, 1 / 3)
    shears = strength * UbcDesign(1991, 0.4).yield_shears(mass, height, period)
    factors = rayleigh_factors(mass, k, damping)
    return Building(f"{period}", mass, height, k, shears, np.full(storeys, 0.05), *factors, foundation)


def oscillator(
    mass: float, stiffness: float, xi: float = 0.0, yield_shear: float = np.inf, hardening: float = 0.0
) -> Building:
    """One storey; Rayleigh damping of ratio xi, half from each factor."""
    alpha, beta = rayleigh_factors([mass], [stiffness], xi)
    return Building("oscillator", [mass], [3.0], [stiffness], [yield_shear], [hardening], alpha, beta)


def leaning(building: Building, theta: float | None = None) -> Building:
    """The building with P-Delta of one stability coefficient in all storeys, or of the weights above."""
    load = weight_above(building.mass) if theta is None else theta * building.stiffness * building.height
    return replace(building, gravity_load=load)


def standing(building: Building) -> Building:
    """The building, run on however far it drifts."""
    return replace(building, collapse=np.inf)


def still(duration: float, dt: float = 0.02) -> Motion:
    """Ground at rest."""
    return Motion("still", dt, np.zeros(round(duration / dt) + 1))


def shake(duration: float, peak: float = 4.0, seed: int = 1, dt: float = 0.02) -> Motion:
    """Smoothed noise that begins at zero, of a peak acceleration [m/s2]."""
    noise = np.random.default_rng(seed).normal(size=round(duration / dt) + 7)
    smooth = np.convolve(noise, np.hanning(9)[1:-1], "valid")
    smooth[0] = 0.0
    return Motion("noise", dt, smooth * peak / np.abs(smooth).max())


def law_of(kind: str, gap: float, stiffness: float, impact: float, xi: float, **more) -> LinkLaw:
    """A law from what all three have in common; an infill stiffens to `impact`."""
    if kind == "infill":
        more["impact_stiffness"] = impact
    return link_laws()[kind](gap=gap, stiffness=stiffness, damping_ratio=xi, **more)


def links(kind: str, gap: float, floors=(1, 2, 3), left: int = 0, xi: float = XI, **law) -> tuple[Link, ...]:
    """Links of one law at several floors: 2e10 N/m for impacts, 1.5e8 N/m for infill and connector."""
    stiffness = law.pop("stiffness", 2e10 if kind == "pounding" else 1.5e8)
    return tuple(Link(left, j, j, law_of(kind, gap, stiffness, 2e10, xi, **law)) for j in floors)


def changed(link: Link, **changes) -> Link:
    """The link with other parameters of its law."""
    return replace(link, law=replace(link.law, **changes))


def pair(kind: str, gap: float, motion: Motion, analysis: Analysis = ELASTIC, foundation=None, **law) -> Scene:
    """The 0.36 s and 0.60 s buildings, three storeys each, linked at every floor."""
    two = shear_building(0.36, foundation=foundation), shear_building(0.60, foundation=foundation)
    return Scene(two, links(kind, gap, **law), motion, analysis)


def gather(response, name: str) -> np.ndarray:
    """One quantity of all buildings of a response, left to right."""
    return np.concatenate([getattr(b, name) for b in response.buildings])
