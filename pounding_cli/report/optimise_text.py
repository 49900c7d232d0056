"""The answer of `pound optimise` in sentences and rows that people read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pounding_cli.numbers import Unit, counted
from pounding_cli.report.evidence import Tables
from pounding_cli.store.answers import Answer
from pounding_cli.store.optimise import DESIGN, NOTHING, OPTIMUM, POINTS, UNSETTLED

_AT_END = 1e-6
"""Of a range: nearer to its end than that, the optimum lies at it [-]."""


@dataclass(frozen=True)
class Optimum:
    """The answer as it was read back.

    keys : a row of the table for each
    tried : every point
    design : what the buildings do at the optimum and with the study as written, a row of the table for each quantity
    generations : of the search, at most
    over_motions : what is taken of the values over the motions
    resolved : the study with every default filled in
    """

    keys: list[dict[Any, Any]]
    tried: Answer
    generations: int
    design: list[dict[Any, Any]]
    over_motions: str
    resolved: Mapping[str, Any]

    @property
    def is_found(self) -> bool:
        return self.first["outcome"] != NOTHING

    @property
    def first(self) -> dict[Any, Any]:
        """What is the same for all keys."""
        return self.keys[0]

    @property
    def points(self) -> int:
        return int(self.first["points"])

    @property
    def unit(self) -> str:
        """SI unit of the number sought; "" of a pure number."""
        unit = self.tried.meanings["value"][0]
        return "" if unit == "1" else unit

    @property
    def sought(self) -> str:
        """What is sought least or most."""
        return str(self.first["sought"]).partition(" ")[2]

    @property
    def direction(self) -> str:
        """least or most."""
        return str(self.first["sought"]).partition(" ")[0]

    def number(self, value: float) -> str:
        """A value of the number sought."""
        return f"{value:.5g}{f' {self.unit}' if self.unit else ''}"

    @property
    def label_of_value(self) -> str:
        """The number sought with its unit."""
        return f"{self.sought} [{self.unit}]" if self.unit else self.sought

    def label(self, key: dict[Any, Any]) -> str:
        """A key with its unit."""
        return self._unit(key).label(str(key["key"]))

    def text(self, key: dict[Any, Any], name: str, with_unit: bool = True) -> str:
        """A value of a key in the unit of the study; "-" where there is none."""
        option = {"value": "option", "written": "written_option"}.get(name)
        if option and key[option]:
            return str(key[option])
        if key[name] != key[name]:
            return "-"
        unit = self._unit(key)
        return (unit if with_unit else Unit("", unit.factor)).text(float(key[name]), digits=4)

    def span(self, key: dict[Any, Any], name: str) -> str:
        """A range of a key, without its unit."""
        ends = [self.text(key, f"{name}_{end}", with_unit=False) for end in ("from", "to")]
        return "-" if "-" in ends else " to ".join(ends)

    def _unit(self, key: dict[Any, Any]) -> Unit:
        return self.tried.units.get(key["key"], Unit())


def optimum_of(results: Tables) -> Optimum:
    """The answer of a results file."""
    keys = results.answer(OPTIMUM).frame.to_dict("records")
    asked = results.resolved.get("optimise") or {}
    design = results.answer(DESIGN).frame.to_dict("records")
    generations, over_motions = int(asked.get("generations", 0)), str(asked.get("over_motions", "mean"))
    return Optimum(keys, results.answer(POINTS), generations, design, over_motions, results.resolved)


def sentences(found: Optimum) -> list[str]:
    """The answer."""
    first = found.first
    what = f"{found.direction.capitalize()} of {found.sought}"
    if not found.is_found:
        return [f"{what}: no point gave a number that means something, so there is no answer."]
    error = first["error"]
    worth = f" ± {error:.1g}" if error == error and error > 0 else ""
    said = f"{what}: {first['optimum']:.5g}{worth}{f' {found.unit}' if found.unit else ''}"
    if first["as_written"] == first["as_written"]:
        said += f"; with the study as written: {found.number(first['as_written'])}"
    return [f"{said}.", design_note(found)]


def heads(found: Optimum) -> list[str]:
    """Headings of `cells`."""
    written = ["as written"] if any(found.text(key, "written") != "-" for key in found.keys) else []
    return ["key", "best", *written, "as good by itself", "as good with others", "searched"]


def cells(found: Optimum) -> list[list[str]]:
    """A row for each key."""
    rows = []
    for key in found.keys:
        written = [found.text(key, "written", with_unit=False)] if "as written" in heads(found) else []
        spans = [found.span(key, name) for name in ("flat", "together", "range")]
        if key["option"]:
            spans[-1] = ", ".join(dict.fromkeys(map(str, found.tried.frame[key["key"]])))
        rows.append([found.label(key), found.text(key, "value", with_unit=False), *written, *spans])
    return rows


DESIGN_HEADS = ("quantity", "at the optimum", "as written")


def design_cells(found: Optimum) -> list[list[str]]:
    """What the buildings do at the optimum, and beside it with the study as written."""

    def text(row: dict[Any, Any], value: float) -> str:
        if value != value:
            return "-"
        if row["of"]:
            return f"{value:.0f} of {row['of']}"
        return f"{value:.5g} {row['unit'] if row['unit'] != '1' else ''}".rstrip()

    rows = [
        row for row in found.design if row["quantity"] != "scenes that failed" or row["optimum"] or row["as_written"]
    ]
    return [[str(row["quantity"]), *(text(row, row[name]) for name in ("optimum", "as_written"))] for row in rows]


def design_note(found: Optimum) -> str:
    """What is left of contacts and flags at the optimum."""
    left = {row["quantity"]: row["optimum"] for row in found.design}
    flags = [name.partition(": ")[2] for name, count in left.items() if name.startswith("scenes flagged: ") and count]
    count, of = (
        left["scenes with contact"],
        next(r["of"] for r in found.design if r["quantity"] == "scenes with contact"),
    )
    contact = "no contact is left" if count == 0 else f"contact is left in {count:.0f} of {counted(of, 'scene')}"
    if count != count:
        contact = "contacts are not known, since a scene failed"
    return f"At the optimum {contact}; {'flagged: ' + ', '.join(flags) if flags else 'nothing is flagged'}."


def notes(found: Optimum) -> list[str]:
    """What a reader should know of the numbers."""
    first, said = found.first, []
    if found.is_found:
        said.append(
            f"As good: the number stays within {first['tolerance']:.2g}{f' {found.unit}' if found.unit else ''} of the "
            "optimum (1 % of it, or its error); by itself: of the other keys at their best; with others: among all "
            "points that were tried."
        )
        if first["error"] != first["error"]:
            said.append("The numerical error is not known: no scene near the optimum was assessed (`estimate:`).")
    for key in found.keys if found.is_found else ():
        ends = np.array([key["range_from"], key["range_to"]], float)
        near = np.abs(ends - key["value"]) <= _AT_END * abs(ends[1] - ends[0])
        if near.any():
            end = "range_from" if near[0] else "range_to"
            said.append(
                f"{key['key']} is best at the end of its range, {found.text(key, end)}: a better value may lie beyond."
            )
    if found.is_found:
        said.append(
            f"What the buildings do: of every storey, floor or link the {found.over_motions} over the motions, and of "
            "these the largest."
        )
    if first["outcome"] == UNSETTLED:
        said.append(
            f"The search ended after {counted(found.generations, 'generation')}, before the points of one were nearly "
            "as good: write more `generations:`."
        )
    if first["failed"]:
        said.append(
            f"{counted(int(first['failed']), 'point')} of {found.points} gave no number: a scene failed, "
            "also in a second solution with a hundred times finer accuracy, or has no such number."
        )
    if first["meaningless"]:
        said.append(
            f"{counted(int(first['meaningless']), 'point')} of {found.points} were excluded: a link left the range "
            "in which its law has a meaning (floors that would have struck, an infill beyond its thickness): "
            "`pound show FILE.h5 flagged`."
        )
    return said
