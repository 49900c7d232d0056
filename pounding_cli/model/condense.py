"""Foundations too stiff to matter are held fixed: decided by a bound, before anything is simulated."""

from __future__ import annotations

import dataclasses

from pounding_cli.model.building import Building
from pounding_cli.model.scene import Scene

SHARE = 0.01
"""Part of the accuracy asked that leaving something out may cost."""


def condensed(scene: Scene, accuracy: float) -> tuple[Scene, tuple[str, ...]]:
    """The scene without the foundation motions that cannot matter, and a sentence on each.

    Of a base that sways, u_b k_h is at most the storey's push k D and the base's own inertia. Against the ground that
    inertia is m_b times at most omega^2 D, with omega^2 = 4 k / m the fastest a storey can be (Gershgorin); against the
    push, which blows between floors make as fast as (4 k + 2 s) / m, it is m_b (4 k + 2 s) / (m k_h) of the push.
    Rocking likewise, with the push's moment k D H on the arm H. A motion that adds less than SHARE of the accuracy to
    a drift D is held at zero.
    """
    if all([building.foundation is None for building in scene.buildings]):
        return scene, ()
    said: list[str] = []
    link = max((link.law.stiffest for link in scene.links), default=0.0)
    buildings = tuple(_condensed(building, link, SHARE * accuracy, said) for building in scene.buildings)
    return (dataclasses.replace(scene, buildings=buildings), tuple(said)) if said else (scene, ())


def _condensed(building: Building, link: float, bound: float, said: list[str]) -> Building:
    foundation = building.foundation
    if foundation is None:
        return building
    stiffest = float(building.stiffness.max())
    slow = 4 * stiffest / float(building.mass.min())
    fast = slow + 2 * link / float(building.mass.min())

    def share(push: float, inertia: float, spring: float) -> float:
        return (push * (1 + inertia * fast / spring) + inertia * slow) / spring

    sways, rocks = foundation.sways, foundation.rocks
    if sways:
        adds = share(stiffest, foundation.mass, foundation.sway_stiffness)
        sways = adds >= bound
        if not sways:
            said.append(_sentence("sway", building.name, adds))
    if rocks:
        tall = float(building.elevation[-1])
        adds = share(stiffest * tall**2, foundation.inertia, foundation.rocking_stiffness)
        rocks = adds >= bound
        if not rocks:
            said.append(_sentence("rocking", building.name, adds))
    if (sways, rocks) == (foundation.sways, foundation.rocks):
        return building
    left = dataclasses.replace(foundation, sways=sways, rocks=rocks) if sways or rocks else None
    return dataclasses.replace(building, foundation=left)


def _sentence(motion: str, name: str, share: float) -> str:
    return f"{motion} of {name}: the foundation is so stiff that it adds at most {share:.1g} of a drift; held fixed"
