"""Foundations too stiff to matter are held fixed: decided by a bound, before anything is simulated."""

from __future__ import annotations

import dataclasses

from pounding_cli.model.building import Building
from pounding_cli.model.scene import Scene

SHARE = 0.01
"""Part of the accuracy asked that leaving something out may cost."""


def condensed(scene: Scene, accuracy: float) -> tuple[Scene, tuple[str, ...]]:
    """The scene without the foundation motions that cannot matter, and a sentence on each.

    A base that sways moves by u_b = (V_1 + m_b a) / k_h. With V_1 at most k times a drift and a at most the square of
    the highest frequency times a drift, that is a share of at most (k + m_b omega^2) / k_h of a drift; rocking moves
    the floors by a share of at most (k H^2 + I omega^2) / k_r likewise. A motion whose share is below SHARE of the
    accuracy is held at zero.
    """
    said: list[str] = []
    link = max((max(link.stiffness, link.impact_stiffness) for link in scene.links), default=0.0)
    buildings = tuple(_condensed(building, link, SHARE * accuracy, said) for building in scene.buildings)
    return (dataclasses.replace(scene, buildings=buildings), tuple(said)) if said else (scene, ())


def _condensed(building: Building, link: float, bound: float, said: list[str]) -> Building:
    foundation = building.foundation
    if foundation is None:
        return building
    stiffest = float(building.stiffness.max())
    square = (4 * stiffest + 2 * link) / float(building.mass.min())  # no mode is faster, by Gershgorin
    tall = float(building.elevation[-1])
    sways, rocks = foundation.sways, foundation.rocks
    if sways:
        share = (stiffest + foundation.mass * square) / foundation.sway_stiffness
        sways = share >= bound
        if not sways:
            said.append(_sentence("sway", building.name, share))
    if rocks:
        inertia = foundation.inertia + float(building.mass @ building.elevation**2)
        share = (stiffest * tall**2 + inertia * square) / foundation.rocking_stiffness
        rocks = share >= bound
        if not rocks:
            said.append(_sentence("rocking", building.name, share))
    if (sways, rocks) == (foundation.sways, foundation.rocks):
        return building
    left = dataclasses.replace(foundation, sways=sways, rocks=rocks) if sways or rocks else None
    return dataclasses.replace(building, foundation=left)


def _sentence(motion: str, name: str, share: float) -> str:
    return f"{motion} of {name}: the foundation is so stiff that it adds at most {share:.1g} of a drift; held fixed"
