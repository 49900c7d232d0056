"""What the user should know about a finished run: links that went where their law has no meaning."""

from __future__ import annotations

from collections.abc import Sequence

from pounding_cli.laws import link_laws
from pounding_cli.laws.formula import WrittenJoint
from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solver.response import COLLAPSED, LinkResponse


def flags_of(scene: Scene, links: LinkResponse) -> tuple[str, ...]:
    """One sentence for each link compressed beyond its thickness or its gap (paper, after eqs 9 and 10): what is
    flagged, a colon, where and by how much. Where another link lets the floors strike, nothing is left out."""
    said = []
    for link, closing in zip(scene.links, links.max_closing.tolist(), strict=True):
        beyond = closing - link.gap
        if beyond <= 0 or not link.law.beyond_gap or (link.law.meaningless and _strikes(scene, link)):
            continue
        left, right = scene.buildings[link.left].name, scene.buildings[link.left + 1].name
        said.append(f"{link.law.beyond_gap}: {left} | {right}, floor {link.left_floor}, by {beyond * 1000:.3g} mm")
    return tuple(said)


def isolator_flags(scene: Scene, sways: Sequence[float]) -> tuple[str, ...]:
    """A sentence for each building whose base moved further [m] than its isolators can."""
    said = []
    for building, sway in zip(scene.buildings, sways, strict=True):
        isolation = None if building.foundation is None else building.foundation.isolation
        if isolation is not None and sway > isolation.capacity:
            beyond = 1000 * (sway - isolation.capacity)
            said.append(f"isolators moved beyond their capacity: {building.name}, by {beyond:.3g} mm")
    return tuple(said)


def _strikes(scene: Scene, link: Link) -> bool:
    """Whether another link lets the same floors strike each other."""
    floors = link.left, link.left_floor, link.right_floor
    return any(
        floors == (each.left, each.left_floor, each.right_floor) for each in scene.links if each.law.subtracts_gap
    )


def collapse_flag(scene: Scene, time: float, building: int, storey: int) -> tuple[str, ...]:
    """A sentence on the storey that collapsed, if one did."""
    if not storey:
        return ()
    return (f"{COLLAPSED}: {scene.buildings[building].name} storey {storey}, at {time:.4g} s",)


def is_meaningless(flag: str) -> bool:
    """Whether a flag takes the meaning from all numbers of its scene."""
    laws: tuple[type[LinkLaw], ...] = (*link_laws().values(), WrittenJoint)
    return flag.startswith(tuple(law.beyond_gap for law in laws if law.meaningless))
