"""The keys of a study in the words of an axis title: "stiffness of the connector" for `cases.connected.stiffness`."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes

from pounding_cli.numbers import Unit
from pounding_cli.report.style import is_for_paper

_WORDS = {
    "pga": "peak ground acceleration", "pgv": "peak ground velocity", "sa": "spectral acceleration",
    "arias": "Arias intensity", "base_shear": "base-shear coefficient", "restitution": "coefficient of restitution",
    "mass": "floor mass", "height": "storey height", "columns": "share of the struck columns",
    "p_delta": "P-Delta", "Rw": "Rw", "K": "K", "Z": "Z",
}  # fmt: skip


def key_words(key: str, resolved: Mapping[str, Any]) -> str:
    """What a dotted key is, and of what; the key itself where it has one part.

    resolved : the study with every default filled in
    """
    section, *rest = key.split(".")
    if not rest:
        return key
    what = _WORDS.get(rest[-1], rest[-1].replace("_", " "))
    if section == "buildings":
        return f"{what} of {rest[0]}"
    if section == "impact":
        return f"impact {what}" if what == "stiffness" else f"{what} of impacts"
    if section == "cases" and len(rest) > 1:
        kind = (resolved.get("cases") or {}).get(rest[0], {}).get("link")
        if what == "gap":
            return what
        link = f"the {kind}" if kind in ("connector", "infill") else "the impact" if kind == "pounding" else "the link"
        return f"{what} of {link}"
    return what


def name_axis(
    ax: Axes,
    which: str,
    keys: Sequence[str],
    units: Sequence[Unit],
    resolved: Mapping[str, Any],
    size: float = 9.5,
    room: int = 0,
) -> None:
    """Entitle an axis ("x" or "y") with what the keys are, and in small with the keys; figures for a paper leave these
    out.

    room : characters in a line; 0: any number
    """
    words = ", ".join(unit.label(key_words(key, resolved)) for key, unit in zip(keys, units, strict=True))
    words = textwrap.fill(words, room) if room else words
    small: dict[str, Any] = {"textcoords": "offset points", "fontsize": max(size - 3, 5.5), "color": "0.35"}
    text = ", ".join(keys)
    if is_for_paper() or all(key_words(key, resolved) == key for key in keys):
        ax.set(**{f"{which}label": words})
    elif which == "x":
        label = ax.set_xlabel(words, fontsize=size)
        ax.annotate(text, (0.5, 0), (0, -1), label, ha="center", va="top", **small)
    else:
        label = ax.set_ylabel(words, fontsize=size)
        ax.annotate(text, (0, 0.5), (-1, 0), label, ha="right", va="center", rotation=90, **small)
