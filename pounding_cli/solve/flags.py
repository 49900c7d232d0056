"""What the user should know about a finished run: links that went where their law has no meaning."""

from __future__ import annotations

from pounding_cli.model.links import Kind
from pounding_cli.model.scene import Scene
from pounding_cli.solve.response import LinkResponse


def flags_of(scene: Scene, links: LinkResponse) -> tuple[str, ...]:
    """One sentence for each link compressed beyond its thickness or its gap (paper, after eqs 9 and 10)."""
    said = []
    for e, link in enumerate(scene.links):
        beyond = float(links.max_closing[e]) - link.gap
        if beyond <= 0 or link.kind is Kind.POUNDING:
            continue
        left, right = scene.buildings[link.left].name, scene.buildings[link.left + 1].name
        what = (
            "infill compressed beyond its thickness"
            if link.kind is Kind.INFILL
            else "connector closes more than the gap, so the floors would have struck"
        )
        said.append(f"{what}: {left} | {right}, floor {link.left_floor}, by {beyond * 1000:.3g} mm")
    return tuple(said)
