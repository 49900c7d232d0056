"""What a scene calls for, and why the rest is left out: decided here, once, before anything is simulated."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from pounding_cli.laws import link_laws
from pounding_cli.model.links import APART
from pounding_cli.model.scene import Analysis, Scene


@dataclass(frozen=True)
class Effects:
    """The effects of a scene.

    yielding : storeys can leave their elastic branch
    collapse : a drift is looked for at which a storey counts as collapsed
    kept, dropped : all of them in words; what is dropped comes with the reason
    """

    yielding: bool
    collapse: bool
    kept: tuple[str, ...]
    dropped: tuple[str, ...]


def memories_flow(scene: Scene) -> bool:
    """Whether a storey remembers something that changes between events too (`StoreyLaw.flows`)."""
    return scene.analysis == Analysis.INELASTIC and any([building.memory_flows for building in scene.buildings])


@functools.lru_cache(maxsize=256)  # a run asks five times about one scene, and many scenes are laid out together
def effects_of(scene: Scene) -> Effects:
    """Derive what a scene needs from its own data alone."""
    kept, dropped = [], []

    def decide(needed: bool, effect: str, reason: str) -> bool:
        if needed:
            kept.append(effect)
        else:
            dropped.append(f"{effect}: {reason}")
        return needed

    buildings, links = scene.buildings, scene.links
    kinds = {link.kind for link in links}
    inelastic = scene.analysis == Analysis.INELASTIC
    can_yield = any(np.isfinite(b.yield_shear).any() for b in buildings)
    yielding = decide(
        inelastic and can_yield,  # fault: storeys-can-yield
        "yielding storeys",
        "every yield shear is infinite" if inelastic else "the analysis is elastic",
    )
    decide(any(b.foundation is not None for b in buildings), "foundation motions", "every base is fixed")
    loaded = any(b.gravity_load is not None and b.gravity_load.any() for b in buildings)
    decide(loaded, "P-Delta", "no building has it")
    collapse = decide(
        inelastic and any(np.isfinite(b.collapse_drift).any() for b in buildings),
        "collapse",
        "no storey can lose its resistance, and none is asked for" if inelastic else "the analysis is elastic",
    )
    decide(any(b.alpha > 0 for b in buildings), "mass-proportional damping", "alpha is 0")
    decide(any(b.beta > 0 for b in buildings), "stiffness-proportional damping", "beta is 0")
    for kind in (*link_laws(), *sorted(kinds - {*link_laws(), APART})):
        decide(kind in kinds, f"{kind} links", "the case has none")
    if links:
        damped = any(link.law.damped for link in links)
        decide(damped, "link dashpots", "restitution is 1")
        cut = any(link.law.cut for link in links)
        asked = any(getattr(link.law, "tension_cut", False) for link in links)
        decide(
            cut,
            "tension cut-off",
            "without a dashpot no link can pull" if asked else "links may pull, as printed",
        )
    return Effects(yielding, collapse, tuple(kept), tuple(dropped))
