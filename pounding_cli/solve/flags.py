"""What the user should know about a finished run: links that went where their law has no meaning."""

from __future__ import annotations

from pounding_cli.model.links import Kind
from pounding_cli.model.scene import Scene
from pounding_cli.solve.response import LinkResponse

INFILL_PRESSED_THROUGH = "infill compressed beyond its thickness"
CONNECTOR_STRUCK = "connector closes more than the gap, so the floors would have struck"

MEANINGLESS = (CONNECTOR_STRUCK,)
"""Flags of scenes whose numbers say nothing about the buildings: a connector takes the place of the impact, so a
scene in which its floors would have struck leaves out the very thing it is about. An infill pressed beyond its
thickness stays stiff as an impact there (paper, after eq. 9): worth knowing, but the floors do strike."""


def flags_of(scene: Scene, links: LinkResponse) -> tuple[str, ...]:
    """One sentence for each link compressed beyond its thickness or its gap (paper, after eqs 9 and 10): what is
    flagged, a colon, where and by how much."""
    said = []
    for e, link in enumerate(scene.links):
        beyond = float(links.max_closing[e]) - link.gap
        if beyond <= 0 or link.kind is Kind.POUNDING:
            continue
        left, right = scene.buildings[link.left].name, scene.buildings[link.left + 1].name
        what = INFILL_PRESSED_THROUGH if link.kind is Kind.INFILL else CONNECTOR_STRUCK
        said.append(f"{what}: {left} | {right}, floor {link.left_floor}, by {beyond * 1000:.3g} mm")
    return tuple(said)


def is_meaningless(flag: str) -> bool:
    """Whether a flag takes the meaning from all numbers of its scene."""
    return flag.startswith(MEANINGLESS)
