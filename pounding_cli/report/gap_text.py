"""The required separations in rows that people read: the floors that need most, widths in the unit of the study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from pounding_cli.numbers import Unit
from pounding_cli.store import Results
from pounding_cli.store.answers import Answer
from pounding_cli.store.gap import EXACT

Part = tuple[dict[str, Any], str, str, pd.DataFrame]
"""Point of the sweep, left and right building, and the rows of the floors that need most."""


def governing(frame: pd.DataFrame, keys: Sequence[str]) -> list[Part]:
    """Of every point of the sweep and pair of neighbours the rows of the floors whose exact mean is largest, by
    analysis.

    frame : of the table `gap`; keys : swept keys
    """
    exact = frame[(frame["rule"] == EXACT) & frame["mean"].notna()]
    among = [*keys, "left", "right", "analysis"]
    most = exact.loc[exact.groupby(among, sort=False)["mean"].idxmax(), [*among, "floor", "right_floor", "columns"]]
    rows = frame.merge(most, on=list(most.columns))
    found = []
    for _, part in rows.groupby([*keys, "left", "right"], sort=False):
        first = part.iloc[0]
        found.append(({key: first[key] for key in keys}, str(first["left"]), str(first["right"]), part))
    return found


def width_unit(answer: Answer) -> Unit:
    """The unit of widths."""
    return answer.units["mean"]


def contact_columns(answer: Answer) -> list[str]:
    """The columns of gaps for a probability of contact."""
    return [n for n in answer.meanings if n.startswith("contact_") and not n.endswith(("_low", "_high"))]


def _columns(answer: Answer) -> dict[str, str]:
    """Columns that are shown and their headings."""
    found = {"mean": "mean", "mean_plus_std": "mean + sigma", "largest": "largest"}
    shares = [name for name in answer.meanings if name.startswith("percentile_")]
    found |= {name: f"{name.removeprefix('percentile_')} %" for name in shares}
    return found | {name: f"contact {name.removeprefix('contact_')} %" for name in contact_columns(answer)}


def headings(answer: Answer) -> list[str]:
    """Headings of the rows of `numbers`; widths in `width_unit`."""
    unit = width_unit(answer).name
    return ["analysis", "rule", *(f"{heading}\n[{unit}]" for heading in _columns(answer).values()), "mean over\nexact"]


def numbers(answer: Answer, rows: pd.DataFrame) -> list[list[str]]:
    """The rows as texts; beside an exact width for a probability of contact its confidence interval."""
    unit, found = width_unit(answer), []
    for row in rows.to_dict("records"):
        cells = [str(row["analysis"]), str(row["rule"])]
        for name in _columns(answer):
            cells.append(_text(row[name], unit))
            if row["rule"] == EXACT and name.startswith("contact_") and row[name] == row[name]:
                cells[-1] += f" ({_text(row[name + '_low'], unit, 3)} to {_text(row[name + '_high'], unit, 3)})"
        found.append([*cells, f"{row['over_exact']:.3f}" if row["over_exact"] == row["over_exact"] else "-"])
    return found


def error_sentence(answer: Answer, error: float) -> str:
    """How wrong the widths may be, in words; `error`: the largest numerical error of one [m]."""
    if error != error:
        return "The numerical error was not estimated (estimate: none)."
    return f"No width has a numerical error above {width_unit(answer).text(error, 2)}."


def _text(value: float, unit: Unit, digits: int = 4) -> str:
    return f"{unit.number(value):#.{digits}g}".rstrip(".") if value == value else "-"


def pair_heading(results: Results, point: Mapping[str, Any], left: str, right: str, rows: pd.DataFrame) -> str:
    """Which floors of which buildings, and where on the sweep."""
    pairs = dict.fromkeys(zip(rows["floor"], rows["right_floor"], rows["columns"], strict=True))
    names = {"left": left, "right": right}
    floors = [
        f"floor {other if side == 'left' else one} beside columns of {names[side]} in storey "
        f"{one if side == 'left' else other}"
        if side
        else f"floor {one}" if one == other else f"floors {one} and {other}"
        for one, other, side in pairs
    ]  # fmt: skip
    swept = ", ".join(f"{key} = {results.value_label(key, value)}" for key, value in point.items())
    return f"{left} | {right}, {' or '.join(floors)}" + (f", {swept}" if swept else "")
