"""The laws of links and storeys, one file each. A new law of a link is a file here and a line in `BUILT_IN`.

Other packages add laws of theirs by an entry point of the group `pounding_cli.laws` that names the law's class."""

from __future__ import annotations

import functools
from importlib import metadata

from pounding_cli.laws.connector import Connector
from pounding_cli.laws.hertz import Hertz, HertzDamp
from pounding_cli.laws.infill import Infill
from pounding_cli.laws.jankowski import Jankowski
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.pounding import Pounding

BUILT_IN: tuple[type[LinkLaw], ...] = (Pounding, Infill, Connector, Hertz, HertzDamp, Jankowski)
"""In the order in which reference pages list them."""


@functools.cache
def link_laws() -> dict[str, type[LinkLaw]]:
    """The laws a link can have, by the name that a study file calls them; those of other packages come last."""
    found = {law.name: law for law in BUILT_IN}
    for entry in metadata.entry_points(group="pounding_cli.laws"):
        law = entry.load()
        if law.name in (*found, "none"):
            raise ValueError(f"two link laws are called '{law.name}': one of them is {entry.value}")
        found[law.name] = law
    return found


def drawn(name: str) -> str:
    """How pictures show a law (`LinkLaw.drawn`), also of one that is not installed here."""
    return link_laws().get(name, LinkLaw).drawn
