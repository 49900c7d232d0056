"""Responses as rows of numbers, and the rows of a plan's scenes as arrays."""

from __future__ import annotations

import hashlib
import json
import math
import sys
from collections.abc import Iterator, Mapping
from functools import cache, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli import __version__
from pounding_cli.model.effects import DroppedEffect
from pounding_cli.solver.response import (
    BASES,
    COLLAPSES,
    COLUMNS,
    DONE,
    LINES,
    LINKS,
    OUTCOMES,
    STOREYS,
    TURNS,
    Flag,
    Response,
    peaks_type,
)

if TYPE_CHECKING:
    from pounding_cli.study.run_plan import Plan

TEXTS = (
    *("status", "advice", "method", "effects"),
    *("flags", "flag_details", "flag_severity", "dropped", "dropped_links", "dropped_reasons"),
)
"""Texts of a response; of the last seven one entry a line, "" of none."""

SCALARS = (
    "accuracy", "time_step", "steps", "events", "orders", "seconds", "error_estimate", "sensitivity",
)  # fmt: skip
ENERGIES = ("input", "kinetic", "stored", "damping", "hysteresis", "links", "residual")

PARTS = {"building.": (*STOREYS, *BASES, *COLLAPSES, *TURNS), "line.": LINES, "link.": LINKS, "columns.": COLUMNS}
"""Beginning of names in `Responses.values` -> the peaks of a response."""

Row = tuple[str, bytes]
"""A response: TEXTS and the arguments of `row_type` as JSON, and its numbers, a record of that type."""


@lru_cache(maxsize=1024)
def row_type(buildings: int, storeys: int, links: int, lines: int = 0) -> np.dtype:
    """The numbers of a scene: SCALARS, ENERGIES, and its peaks."""
    names = (*SCALARS, *(f"energy_{name}" for name in ENERGIES))
    peaks = peaks_type(buildings, storeys, links, lines)
    return np.dtype([*((name, "f8") for name in names), *((name, peaks[name]) for name in peaks.names or ())])


def encode_response(response: Response) -> Row:
    """Return a response as a row; its end state is not kept."""
    r = response
    texts_by_name = {
        "status": r.status,
        "advice": r.advice,
        "method": r.method,
        "effects": "\n".join(r.effects),
        "flags": "\n".join(each.code for each in r.flags),
        "flag_details": "\n".join(each.detail for each in r.flags),
        "flag_severity": "\n".join(repr(float(each.severity)) for each in r.flags),
        "dropped": "\n".join(each.effect for each in r.dropped),
        "dropped_links": "\n".join(each.links for each in r.dropped),
        "dropped_reasons": "\n".join(each.reason for each in r.dropped),
    }
    texts = [texts_by_name[name] for name in TEXTS]
    size = [len(r.storeys), max(r.storeys), r.peaks["impacts"].size]
    if "line_drift" in (r.peaks.dtype.names or ()):
        size.append(r.peaks["line_drift"].shape[-1])
    numbers = [*(getattr(r, name) for name in SCALARS), *(r.energy.get(name, np.nan) for name in ENERGIES)]
    return json.dumps([texts, size]), np.array(numbers, float).tobytes() + r.peaks.tobytes()


def decode_response(row: Row, storeys: tuple[int, ...]) -> Response:
    """Return the response of a row of `encode_response`, without its end state and effects, which its scene decides.

    storeys : of every building
    """
    texts, size = json.loads(row[0])
    numbers = np.frombuffer(row[1], row_type(*size))[0]
    text_by_name = dict(zip(TEXTS, texts, strict=True))
    peaks_of_row = peaks_type(*size)
    peaks = np.frombuffer(row[1], peaks_of_row, offset=len(row[1]) - peaks_of_row.itemsize)[0]
    facts: dict[str, Any] = {name: float(numbers[name]) for name in SCALARS}
    for name in ("steps", "events", "orders"):
        facts[name] = int(facts[name])
    return Response(
        peaks,
        storeys,
        status=text_by_name["status"],
        advice=text_by_name["advice"],
        method=text_by_name["method"],
        **facts,
        energy={name: float(numbers[f"energy_{name}"]) for name in ENERGIES},
        flags=tuple(decode_flags(*(text_by_name[name] for name in ("flags", "flag_details", "flag_severity")))),
    )


def decode_flags(codes: str, details: str, severities: str) -> Iterator[Flag]:
    """Yield the flags of a scene, of each text one entry a line."""
    for code, detail, severity in _split_lines(codes, details, severities):
        yield Flag(code, detail, float(severity))


def decode_dropped(names: str, links: str, reasons: str) -> Iterator[DroppedEffect]:
    """Yield the effects that a scene leaves out, of each text one entry a line."""
    for name, of_links, reason in _split_lines(names, links, reasons):
        yield DroppedEffect(name, reason, of_links)


def _split_lines(first: str, *others: str) -> Iterator[tuple[str, ...]]:
    """Yield the entries of texts of one entry a line, of which that of the first is never empty."""
    if first:
        yield from zip(first.split("\n"), *(text.split("\n") for text in others), strict=True)


def read_status(row: Row) -> str:
    """Return the status of the response of a row."""
    texts, _ = json.loads(row[0])
    status: str = texts[TEXTS.index("status")]
    return status


class Responses:
    """The responses of a plan's scenes as arrays by scene number, as they are added.  The last place, -1, stands for
    a scene that nobody asked for: it has no numbers.

    is_known : whether a scene was solved, shape (scenes + 1,)
    texts : TEXTS by name, "" of a scene that was not solved, shape (scenes + 1,)
    values : "building.drift" (scenes + 1, buildings, storeys), a building alone at place 0; "building.sway" (scenes +
        1, buildings); "line.line_shear" (scenes + 1, buildings, storeys, lines); "link.impacts", "columns.demand"
        (scenes + 1, links of `plan.links`); "error_estimate", "energy_input", ... (scenes + 1,); NaN where there is
        nothing
    """

    def __init__(self, plan: Plan) -> None:
        count = len(plan) + 1
        self.plan = plan
        self.is_known = np.zeros(count, bool)
        self.texts = {name: np.full(count, "", object) for name in TEXTS}
        size = (len(plan.buildings), max_storeys(plan), len(plan.links.places), max_lines(plan))
        self._whole = np.full(count, np.nan, row_type(*size))
        prefixes = {name: prefix for prefix, names in PARTS.items() for name in names}
        self.values = {prefixes.get(name, "") + name: self._whole[name] for name in self._whole.dtype.names}
        self._order = _orders(plan)

    def add(self, rows: Mapping[int, Row]) -> None:
        """Add responses by scene number."""
        alike: dict[tuple[int, ...], list[int]] = {}
        for number, (kind, _) in rows.items():
            texts, size = json.loads(kind)
            alike.setdefault(tuple(size), []).append(number)
            for name, text in zip(TEXTS, texts, strict=True):
                self.texts[name][number] = sys.intern(text)  # many say the same
        for (buildings, storeys, links, *lines), at in alike.items():
            of_rows = row_type(buildings, storeys, links, *lines)
            records = np.frombuffer(b"".join(rows[number][1] for number in at), of_rows)
            self.is_known[at] = True
            order = self._order[at]
            place = (at, slice(buildings), slice(storeys), slice(sum(lines)))
            for name in records.dtype.names or ():
                whole = self._whole[name]
                values = records[name]
                if name not in (*LINKS, *COLUMNS):
                    whole[place[: whole.ndim]] = values
                elif links:
                    ordered = np.take_along_axis(values, np.maximum(order, 0), axis=1)
                    whole[at] = np.where(order < 0, np.nan, ordered)

    @property
    def is_done(self) -> np.ndarray:
        """Scenes that ended with their motion, shape (scenes + 1,)."""
        return self.texts["status"] == DONE

    @property
    def is_whole(self) -> np.ndarray:
        """Buildings whose numbers are of a whole motion, shape (scenes + 1, buildings).

        They may stand in a scene that has collapsed, where nothing joins them to what collapsed.
        """
        return self.has_result[:, None] & np.isnan(self.values["building.collapse_time"])

    @property
    def has_result(self) -> np.ndarray:
        """Scenes that ended with their motion, or with a collapse, shape (scenes + 1,)."""
        return np.isin(self.texts["status"], OUTCOMES)


def _orders(plan: Plan) -> np.ndarray:
    """Return `plan.links.order` of every scene, -1 of those that stand alone; shape (scenes, links)."""
    rows, columns = plan.first
    each = len(plan.analyses) * len(plan.records)
    order = plan.links.order.reshape(math.prod(plan.shape[:-2]), -1)[rows // each]
    return np.where(columns[:, None] > 0, -1, order)


def max_storeys(plan: Plan) -> int:
    """Return the number of storeys of the highest building at any point of the sweep."""
    return max(
        plan.study.building(point, place).storeys
        for place, name in enumerate(plan.study.spec.group)
        for point in iter_section_points(plan, "buildings", name)
    )


def max_lines(plan: Plan) -> int:
    """Return the number of frame lines of the building with most of them at any point of the sweep; 0 without plans."""
    return max(
        plan.study.building(point, place).lines
        for place, name in enumerate(plan.study.spec.group)
        for point in iter_section_points(plan, "buildings", name)
    )


def iter_section_points(plan: Plan, *path: str) -> np.ndindex:
    """Return a point of the sweep for every combination of the values that change a section, or an entry of one."""
    changing = plan.study.axes_changing(*path)
    return np.ndindex(*(len(axis) if number in changing else 1 for number, axis in enumerate(plan.axes)))


# What a solution depends on besides its scene


@cache
def solver_version() -> str:
    """Package version and a digest of the solver's own source.

    Between two releases the version stands still while the solver changes; results of the old one must not be
    taken for the new one's.
    """
    root = Path(__file__).parents[1]
    own = [path for package in ("laws", "model", "solver") for path in sorted((root / package).glob("*.*"))]
    sha = hashlib.sha256()
    for path in [*own, Path(__file__)]:  # this file: how responses are kept
        sha.update(path.name.encode() + b"\0" + path.read_bytes())
    return f"{__version__}+{sha.hexdigest()[:12]}"


def solution_key(plan: Plan) -> str:
    """Return a text that two solutions of one scene share exactly when they are the same number for number."""
    asked = f"accuracy {plan.accuracy!r}" if plan.time_step is None else f"time step {plan.time_step!r}"
    return f"solver {solver_version()} | method {plan.method} | {asked} | estimate {plan.estimate}"
