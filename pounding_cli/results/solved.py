"""Responses as rows of numbers, and the rows of a plan's scenes as arrays."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from pounding_cli.solver.response import DONE, OUTCOMES, Response
from pounding_cli.study.plan import Plan

TEXTS = ("status", "advice", "method")
SENTENCES = ("flags", "effects", "dropped")
SCALARS = (
    "accuracy", "time_step", "steps", "events", "orders", "seconds", "error_estimate", "sensitivity", "collapse_time",
    "collapse_building", "collapse_storey",
)  # fmt: skip
ENERGIES = ("input", "kinetic", "stored", "damping", "hysteresis", "links", "residual")
STOREYS = ("shear", "drift", "ductility", "acceleration", "displacement_max", "displacement_min", "residual_drift")
BASE = ("sway", "rocking", "isolator_displacement")
LINK = ("impacts", "peak_force", "max_closing", "impulse", "contact_time")
COLUMNS = ("shear_below", "shear_above", "demand")

Row = tuple[str, bytes]
"""A response: its kind as JSON (`Kind`), and its numbers, doubles in the order of `Kind.spans`."""


class Kind(NamedTuple):
    """What many responses share: texts, sentences, storeys of the buildings, links, those that strike columns."""

    texts: tuple[str, ...]
    sentences: tuple[tuple[str, ...], ...]
    storeys: tuple[int, ...]
    links: int
    struck: tuple[int, ...]

    @property
    def sizes(self) -> dict[str, int]:
        """Numbers of every quantity, in their order; "shear 1" is that of the second building."""
        found = dict.fromkeys((*SCALARS, *(f"energy_{name}" for name in ENERGIES)), 1)
        for place, storeys in enumerate(self.storeys):
            found |= {f"{name} {place}": storeys for name in STOREYS} | {f"{name} {place}": 1 for name in BASE}
        found |= {f"link.{name}": self.links for name in LINK}
        return found | {f"columns.{name}": len(self.struck) for name in COLUMNS}


def encode(response: Response) -> Row:
    """A response as a row; its end state is not kept."""
    r = response
    texts = tuple(str(getattr(r, name)) for name in TEXTS)
    sentences = tuple(tuple(map(str, getattr(r, name))) for name in SENTENCES)
    storeys = tuple(building.shear.size for building in r.buildings)
    struck = tuple(int(link) for link in r.columns.link)
    parts: list[Any] = [[getattr(r, name) for name in SCALARS], [r.energy.get(name, np.nan) for name in ENERGIES]]
    for building in r.buildings:
        parts += [getattr(building, name) for name in STOREYS]
        parts.append([getattr(building, name) for name in BASE])
    parts += [getattr(r.links, name) for name in LINK] + [getattr(r.columns, name) for name in COLUMNS]
    return _said(texts, sentences, storeys, r.links.impacts.size, struck), np.concatenate(parts, dtype=float).tobytes()


@lru_cache(maxsize=1024)
def _said(*kind: object) -> str:
    return json.dumps(kind)


@lru_cache(maxsize=1024)
def read_kind(text: str) -> tuple[Kind, dict[str, slice], int]:
    """A kind, where each of its quantities stands among the numbers, and how many these are."""
    texts, sentences, storeys, links, struck = json.loads(text)
    kind = Kind(tuple(texts), tuple(map(tuple, sentences)), tuple(storeys), links, tuple(struck))
    ends = np.cumsum(list(kind.sizes.values())).tolist()
    spans = {name: slice(end - size, end) for (name, size), end in zip(kind.sizes.items(), ends, strict=True)}
    return kind, spans, ends[-1]


def has_result(row: Row) -> bool:
    """Whether the scene ended with its motion, or with a collapse."""
    return read_kind(row[0])[0].texts[0] in OUTCOMES


def said(row: Row) -> tuple[str, str]:
    """Status and advice."""
    status, advice, _ = read_kind(row[0])[0].texts
    return status, advice


def seconds_of(row: Row) -> float:
    """Time inside the solver [s]."""
    return float(np.frombuffer(row[1])[SCALARS.index("seconds")])


class Solved:
    """The responses of a plan's scenes as arrays by scene number.  The last place, -1, stands for a scene that nobody
    asked for: it has no numbers.

    there : whether a scene was solved, shape (scenes + 1,)
    done, ended : whether it ended with its motion; with that or with a collapse
    values : "building.drift" (scenes + 1, buildings, storeys), a building alone at place 0; "building.sway"
        (scenes + 1, buildings); "link.impacts", "columns.demand" (scenes + 1, links of `plan.links`);
        "error_estimate", "collapse_storey", ... (scenes + 1,); NaN where there is nothing
    """

    def __init__(self, plan: Plan) -> None:
        count, buildings, links, storeys = (
            len(plan) + 1,
            len(plan.buildings),
            len(plan.links.places),
            most_storeys(plan),
        )
        self.plan, self.there = plan, np.zeros(count, bool)
        shapes: dict[str, tuple[int, ...]] = dict.fromkeys((*SCALARS, *(f"energy_{name}" for name in ENERGIES)), ())
        shapes |= {f"building.{name}": (buildings, storeys) for name in STOREYS}
        shapes |= {f"building.{name}": (buildings,) for name in BASE}
        shapes |= {f"link.{name}": (links,) for name in LINK} | {f"columns.{name}": (links,) for name in COLUMNS}
        self.values = {name: np.full((count, *shape), np.nan) for name, shape in shapes.items()}
        self._words: dict[str, int] = {"": 0}
        self._codes = {name: np.zeros(count, np.int32) for name in (*TEXTS, *SENTENCES)}
        self._order = _orders(plan)

    def fill(self, numbers: Iterable[int], rows: Iterable[Row]) -> None:
        """Take in the responses of scenes by number."""
        alike: dict[tuple[str, bytes], tuple[list[int], list[bytes]]] = {}
        for number, (text, content) in zip(numbers, rows, strict=True):
            places, contents = alike.setdefault((text, self._order[number].tobytes()), ([], []))
            places.append(number)
            contents.append(content)
        for (text, order), (places, contents) in alike.items():
            kind, spans, size = read_kind(text)
            values = np.frombuffer(b"".join(contents)).reshape(-1, size)
            self._put(kind, spans, np.frombuffer(order, np.int16), np.array(places), values)

    def _put(self, kind: Kind, spans: dict[str, slice], order: np.ndarray, at: np.ndarray, numbers: np.ndarray) -> None:
        """Rows of one kind, whose links stand in one order in the tables."""
        self.there[at] = True
        for name, text in zip((*TEXTS, *SENTENCES), (*kind.texts, *map("\n".join, kind.sentences)), strict=True):
            self._codes[name][at] = self._words.setdefault(text, len(self._words))
        for name in (*SCALARS, *(f"energy_{name}" for name in ENERGIES)):
            self.values[name][at] = numbers[:, spans[name].start]
        if kind.texts[0] not in OUTCOMES:
            return
        for place, storeys in enumerate(kind.storeys):
            for name in STOREYS:
                self.values[f"building.{name}"][at, place, :storeys] = numbers[:, spans[f"{name} {place}"]]
            for name in BASE:
                self.values[f"building.{name}"][at, place] = numbers[:, spans[f"{name} {place}"].start]
        if not kind.links:
            return
        column = np.argsort(np.where(order < 0, order.size, order), kind="stable")[: kind.links]
        for name in LINK:
            self.values[f"link.{name}"][at[:, None], column] = numbers[:, spans[f"link.{name}"]]
        for name in COLUMNS:
            self.values[f"columns.{name}"][at[:, None], column[list(kind.struck)]] = numbers[
                :, spans[f"columns.{name}"]
            ]

    @property
    def done(self) -> np.ndarray:
        """Scenes that ended with their motion, shape (scenes + 1,)."""
        return self._codes["status"] == self._words.get(DONE, -1)

    @property
    def ended(self) -> np.ndarray:
        """Scenes that ended with their motion, or with a collapse, shape (scenes + 1,)."""
        return np.isin(self._codes["status"], [self._words[word] for word in OUTCOMES if word in self._words])

    def texts(self, name: str) -> np.ndarray:
        """`status`, `advice`, `method`, or of `flags`, `effects`, `dropped` one a line; shape (scenes + 1,)."""
        return np.array(list(self._words), object)[self._codes[name]]


def _orders(plan: Plan) -> np.ndarray:
    """Of every scene `plan.links.order`, -1 of those that stand alone; shape (scenes, links)."""
    rows, columns = plan.first
    each = len(plan.analyses) * len(plan.records)
    order = plan.links.order.reshape(math.prod(plan.shape[:-2]), -1)[rows // each]
    return np.where(columns[:, None] > 0, np.int16(-1), order)


def most_storeys(plan: Plan) -> int:
    """Storeys of the highest building at any point of the sweep."""
    return max(
        plan.study.building(point, place).storeys
        for place in range(len(plan.buildings))
        for point in points(plan, "buildings", place)
    )


def points(plan: Plan, *subject: Any) -> np.ndindex:
    """A point of the sweep for every combination of the values that change something (`Study.touching`)."""
    touched = plan.study.touching(*subject)
    return np.ndindex(*(len(axis.values) if mine else 1 for axis, mine in zip(plan.axes, touched, strict=True)))
