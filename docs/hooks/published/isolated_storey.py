"""One storey on friction pendulums under both components of El Centro beside a paper's."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import CHOPRA_ELCENTRO, PEER_ELCENTRO, Entry, Row, compare
from scipy.constants import g as GRAVITY

PEER_ELCENTRO_270 = PEER_ELCENTRO.replace("ELC180-hor1", "ELC270-hor2")
FRICTION = "buildings.isolated.foundation.isolation.friction"
COMPONENTS = {
    "270 deg": ("270 deg", 119.5, 149.0),
    "180 deg": ("180 deg", 111.4, 138.8),
    "textbook": ("180 deg as a textbook has it", 111.4, 138.8),
}
"""Motion -> its name on the page, the paper's largest sliding [mm] and largest acceleration of the roof [g / 1000]."""


def compare_isolated_storey(solved: Any) -> Iterator[Row]:
    """Yield the sliding and the acceleration under both components."""
    slidings = 1e3 * solved.table("base").set_index([FRICTION, "record"])["isolator_displacement"]
    roofs = solved.table("floor").query("building == 'isolated' and floor == 1")
    accelerations = 1e3 * roofs.set_index([FRICTION, "record"])["acceleration"] / GRAVITY
    why = "with a friction of 2 %; {:.1f} with 10 %. The paper says neither this nor who digitised the motion"
    for motion, (name, sliding, acceleration) in COMPONENTS.items():
        smooth, rough = (slidings[friction, motion] for friction in (0.02, 0.1))
        yield compare(f"sliding [mm], {name}", sliding, smooth, ".1f", why.format(rough))
        smooth, rough = (accelerations[friction, motion] for friction in (0.02, 0.1))
        yield compare(f"acceleration of the roof [g / 1000], {name}", acceleration, smooth, ".1f", why.format(rough))


ENTRY = Entry(compare_isolated_storey, motions=(PEER_ELCENTRO, PEER_ELCENTRO_270, CHOPRA_ELCENTRO))
