"""The file formats of ground motions, one a module: how each is recognised and read.

Every module offers `recognises(text) -> bool` and `read(text, asked) -> Samples`.
"""

from __future__ import annotations

from collections.abc import Callable

from pounding_cli.records.formats import columns, cosmos, csmip, esm, knet, peer, smc
from pounding_cli.records.formats.text import Asked, Samples, Text

READERS: dict[str, Callable[[Text, Asked], Samples]] = {
    "at2": peer.read,
    "cosmos": cosmos.read,
    "csmip": csmip.read,
    "smc": smc.read,
    "knet": knet.read,
    "esm": esm.read,
    "two-column": columns.read_two_columns,
    "column": columns.read_column,
    "table": columns.read_table,
}
"""What reads each format."""

PLAIN = ("two-column", "column", "table")
"""Formats that need not state a unit: g is taken."""

CHANNELS = ("cosmos", "csmip")
"""Formats whose files may hold several channels."""

_KNOWN = {"at2": peer, "cosmos": cosmos, "csmip": csmip, "smc": smc, "knet": knet, "esm": esm}


def format_of(text: Text, asked: Asked) -> str:
    """The format of a file, by what stands in it.  Raises `InputError` where nothing tells it."""
    for name, module in _KNOWN.items():
        if module.recognises(text):
            return name
    return columns.kind_of(text, asked)
