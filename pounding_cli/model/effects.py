"""What a scene calls for, and why the rest is left out: decided here, once, before anything is simulated."""

from __future__ import annotations

import functools
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from pounding_cli.laws import link_laws
from pounding_cli.model.building import Building
from pounding_cli.model.links import APART, Link
from pounding_cli.model.scene import Analysis, Scene

EXPECTED = ("yielding storeys", "foundation motions", "P-Delta")
"""Effects that a reader may expect in any study: where none of its scenes has one, the reason is told."""


def others(names: Collection[str]) -> str:
    """Effects that no scene of a study calls for, in one sentence."""
    links = [name.removesuffix(" links") for name in names if name.endswith(" links")]
    rest = [name for name in names if not name.endswith(" links")]
    rest += [f"links of the kinds {', '.join(links)}"] if links else []
    return f"nothing in the study calls for: {', '.join(rest)}" if rest else ""


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


@dataclass(frozen=True)
class _Buildings:
    """What matters here of the buildings of a scene."""

    can_yield: bool
    founded: bool
    loaded: bool
    can_collapse: bool
    mass_damped: bool
    stiffness_damped: bool


@dataclass(frozen=True)
class _Links:
    """What matters here of the links of a scene. kinds : each once, sorted; cut_asked : for a tension cut-off."""

    kinds: tuple[str, ...]
    damped: bool
    cut: bool
    cut_asked: bool


@functools.lru_cache(maxsize=256)  # a run asks five times about one scene, and many scenes are laid out together
def effects_of(scene: Scene) -> Effects:
    """Derive what a scene needs from its own data alone."""
    return _effects_of(scene.buildings, scene.links, scene.analysis)


@functools.lru_cache(maxsize=64)  # the same for every motion
def _effects_of(buildings: tuple[Building, ...], links: tuple[Link, ...], analysis: Analysis) -> Effects:
    return _effects(_of_buildings(buildings), _of_links(links), analysis)


@functools.lru_cache(maxsize=256)
def _of_buildings(buildings: tuple[Building, ...]) -> _Buildings:
    return _Buildings(
        can_yield=any(np.isfinite(b.yield_shear).any() for b in buildings),
        founded=any(b.foundation is not None for b in buildings),
        loaded=any(b.gravity_load is not None and b.gravity_load.any() for b in buildings),
        can_collapse=any(np.isfinite(b.collapse_drift).any() for b in buildings),
        mass_damped=any(b.alpha > 0 for b in buildings),
        stiffness_damped=any(b.beta > 0 for b in buildings),
    )


@functools.lru_cache(maxsize=256)
def _of_links(links: tuple[Link, ...]) -> _Links:
    return _Links(
        kinds=tuple(sorted({link.kind for link in links})),
        damped=any(link.law.damped for link in links),
        cut=any(link.law.cut for link in links),
        cut_asked=any(getattr(link.law, "tension_cut", False) for link in links),
    )


@functools.lru_cache(maxsize=256)  # most scenes of a study call for the same
def _effects(buildings: _Buildings, links: _Links, analysis: Analysis) -> Effects:
    kept, dropped = [], []

    def decide(needed: bool, effect: str, reason: str) -> bool:
        if needed:
            kept.append(effect)
        else:
            dropped.append(f"{effect}: {reason}")
        return needed

    inelastic = analysis == Analysis.INELASTIC
    yielding = decide(
        inelastic and buildings.can_yield,
        "yielding storeys",
        "every yield shear is infinite" if inelastic else "the analysis is elastic",
    )
    decide(buildings.founded, "foundation motions", "every base is fixed")
    decide(buildings.loaded, "P-Delta", "no building has it")
    collapse = decide(
        inelastic and buildings.can_collapse,
        "collapse",
        "no storey can lose its resistance, and none is asked for" if inelastic else "the analysis is elastic",
    )
    decide(buildings.mass_damped, "mass-proportional damping", "alpha is 0")
    decide(buildings.stiffness_damped, "stiffness-proportional damping", "beta is 0")
    for kind in (*link_laws(), *(kind for kind in links.kinds if kind not in link_laws() and kind != APART)):
        decide(kind in links.kinds, f"{kind} links", "the case has none")
    if links.kinds:
        decide(links.damped, "link dashpots", "restitution is 1")
        decide(
            links.cut,
            "tension cut-off",
            "without a dashpot no link can pull" if links.cut_asked else "links may pull, as printed",
        )
    return Effects(yielding, collapse, tuple(kept), tuple(dropped))
