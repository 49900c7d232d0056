"""Decide which effects a scene simulates; give the reason for each one omitted."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple

import numpy as np

from pounding_cli.laws import link_laws
from pounding_cli.laws.apart import Apart
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.parts import format_parts
from pounding_cli.model.scene import Analysis, Scene

RESIDUAL_DRIFTS = "residual drifts"
"""The effect of a scene that is followed until it is at rest."""

NOT_REQUESTED = "the study does not ask for them (key residual_drift)"
"""The reason to leave them out; without a colon, which ends the name of an effect."""

COUPLING = "coupling of the whole row"
"""The effect that is left out of a scene of parts that nothing links."""

TWIST_OF_FLOORS = "twist of floors"
"""The effect of a scene whose floors turn about vertical axes."""

NOTHING_ECCENTRIC = "nothing is eccentric, and buildings run without their plans"
"""The reason to leave the twist out of a scene of buildings that have plans; others do not speak of it."""

EXPECTED_EFFECTS = ("yielding storeys", "foundation motions", "P-Delta", RESIDUAL_DRIFTS, COUPLING, TWIST_OF_FLOORS)
"""Effects that a reader may expect in any study: where none of its scenes has one, the reason is stated."""

OVERRULING_REASONS = ("the analysis is elastic", "without a dashpot no link can pull")
"""Reasons to leave out an effect that the study asks for; it is not counted among those that the study does not use."""

NEVER_CLOSES = "the gap never closes"
"""The reason of links that never act, which the width that stays open follows."""


@dataclass(frozen=True)
class DroppedEffect:
    """An effect that a scene leaves out, or links of it that never act.

    effect : its name, such as "P-Delta"; LINKS of links that never act
    reason : in words
    links : the neighbours whose links these are, such as "stiff | soft"; "" of an effect
    """

    effect: str
    reason: str
    links: str = ""

    LINKS: ClassVar[str] = "links"

    @classmethod
    def of_open_gap(cls, neighbours: str, width: float) -> DroppedEffect:
        """Return the links of neighbours of which `width` of the gap stays open [m]."""
        return cls(cls.LINKS, f"{NEVER_CLOSES}, {width * 1000:.3g} mm of it stay open", neighbours)

    @classmethod
    def of_parts(cls, parts: str) -> DroppedEffect:
        """Return the coupling of a row whose `parts`, in words, nothing links."""
        return cls(COUPLING, f"no force passes between {parts}, and each is solved by itself")

    def __str__(self) -> str:
        return f"{self.effect} {self.links}".rstrip() + f": {self.reason}"


def summarize_effects(
    kept: Mapping[str, float], dropped: Mapping[DroppedEffect, float]
) -> Iterator[tuple[str, float, float, str]]:
    """Yield every effect of many scenes, the scenes that simulate it, those that leave it out, and the reason.

    Effects that are not used in the study, and that nobody expects, share the last row.

    Parameters
    ----------
    kept : effect -> scenes with it
    dropped : effect with its reason -> scenes without it; links that never act are no effect and are passed over
    """
    without: dict[str, dict[str, float]] = {name: {} for name in kept}
    for each, count in dropped.items():
        if not each.links:
            without.setdefault(each.effect, {})[each.reason] = count
    rest = [
        name
        for name, reasons in without.items()
        if name not in kept and name not in EXPECTED_EFFECTS and reasons.keys().isdisjoint(OVERRULING_REASONS)
    ]
    for name, reasons in without.items():
        if name in rest:
            continue
        parts = list(reasons)
        if len(reasons) > 1:
            parts = [f"{reason} ({round(count)})" for reason, count in reasons.items()]
        yield name, kept.get(name, 0), sum(reasons.values()), "; ".join(parts)
    if rest:
        kinds = [name.removesuffix(" links") for name in rest if name.endswith(" links")]
        others = [name for name in rest if not name.endswith(" links")]
        if kinds:
            others.append(f"links of the kinds {', '.join(kinds)}")
        reason = f"not used in this study: {', '.join(others)}"
        yield "all others", 0, sum(without[rest[0]].values()), reason


@dataclass(frozen=True)
class Effects:
    """The effects of a scene.

    yielding : storeys can leave their elastic branch
    collapse : a drift is looked for at which a storey counts as collapsed
    kept : the names of those that are simulated
    dropped : those that are left out
    """

    yielding: bool
    collapse: bool
    kept: tuple[str, ...]
    dropped: tuple[DroppedEffect, ...]


class LinkTraits(NamedTuple):
    """Properties of a link that decide about effects.

    kind : its law
    is_damped : it has a dashpot
    cuts_tension : no force of it pulls
    wants_cut : the study asks for that
    """

    kind: str
    is_damped: bool
    cuts_tension: bool
    wants_cut: bool

    @classmethod
    def of(cls, link: Link) -> LinkTraits:
        """Return the traits of a link."""
        law = link.law
        return cls(link.kind, law.is_damped, law.cuts_tension, getattr(law, "tension_cut", False))


def effects_of(scene: Scene) -> Effects:
    """Return the effects of a scene, which its own data decide alone."""
    links = tuple(sorted({LinkTraits.of(link) for link in scene.links}))
    effects = _decide_effects(scene.buildings, links, scene.analysis, scene.residual_drift)
    parts = format_parts(scene.buildings, scene.links)
    if not parts:
        return effects
    return replace(effects, dropped=(*effects.dropped, DroppedEffect.of_parts(parts)))


@functools.lru_cache(maxsize=256)  # the same for every motion and gap
def _decide_effects(
    buildings: tuple[Building, ...],
    links: tuple[LinkTraits, ...],
    analysis: Analysis,
    residual_drift: bool,
) -> Effects:
    """Return the effects of scenes that share these; links : each kind of traits once."""
    kept = list[str]()
    dropped = list[DroppedEffect]()

    def decide(needed: bool, effect: str, reason: str) -> bool:
        if needed:
            kept.append(effect)
        else:
            dropped.append(DroppedEffect(effect, reason))
        return needed

    inelastic = analysis == Analysis.INELASTIC
    yielding = decide(
        inelastic and any(building.can_yield.any() for building in buildings),
        "yielding storeys",
        "every yield shear is infinite" if inelastic else "the analysis is elastic",
    )
    has_foundation = any(building.foundation is not None for building in buildings)
    decide(has_foundation, "foundation motions", "every base is fixed")
    loads = (building.gravity_load for building in buildings)
    decide(any(load is not None and load.any() for load in loads), "P-Delta", "no building has it")
    can_collapse = any(np.isfinite(building.collapse_drift).any() for building in buildings)
    reason = "no storey can lose strength, and no collapse drift is set"
    if can_collapse:
        reason = "the analysis is elastic"
    collapse = decide(inelastic and can_collapse, "collapse", reason)
    if any(building.plan is not None for building in buildings):
        kept.append(TWIST_OF_FLOORS)
    decide(residual_drift, RESIDUAL_DRIFTS, NOT_REQUESTED)
    has_alpha = any(building.alpha > 0 for building in buildings)
    decide(has_alpha, "mass-proportional damping", "alpha is 0")
    has_beta = any(building.beta > 0 for building in buildings)
    decide(has_beta, "stiffness-proportional damping", "beta is 0")
    kinds = sorted({link.kind for link in links})
    study_kinds = [kind for kind in kinds if kind not in link_laws() and kind != Apart.name]
    for kind in (*link_laws(), *study_kinds):
        decide(kind in kinds, f"{kind} links", "the case has none")
    if kinds:
        decide(any(link.is_damped for link in links), "link dashpots", "restitution is 1")
        reason = "links may pull, as printed"
        if any(link.wants_cut for link in links):
            reason = "without a dashpot no link can pull"
        decide(any(link.cuts_tension for link in links), "tension cut-off", reason)
    return Effects(yielding, collapse, tuple(kept), tuple(dropped))
