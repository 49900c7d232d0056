"""Responses as rows of numbers, and the rows of a plan's scenes as arrays."""

from __future__ import annotations

import hashlib
import json
import math
import sys
from collections.abc import Mapping
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from pounding_cli import __version__
from pounding_cli.solver.response import DONE, OUTCOMES, Response
from pounding_cli.study.plan import Plan

TEXTS = ("status", "advice", "method", "flags", "effects", "dropped")
"""Texts of a response; of the last three one sentence a line."""

SCALARS = (
    "accuracy", "time_step", "steps", "events", "orders", "seconds", "error_estimate", "sensitivity", "collapse_time",
    "collapse_building", "collapse_storey",
)  # fmt: skip
ENERGIES = ("input", "kinetic", "stored", "damping", "hysteresis", "links", "residual")
STOREYS = ("shear", "drift", "ductility", "acceleration", "displacement_max", "displacement_min", "residual_drift")
BASE = ("sway", "rocking", "isolator_displacement")
LINK = ("impacts", "peak_force", "max_closing", "impulse", "contact_time")
COLUMNS = ("shear_below", "shear_above", "demand")

PARTS = {
    "scalars": ("", (*SCALARS, *(f"energy_{name}" for name in ENERGIES))),
    "storeys": ("building.", STOREYS),
    "bases": ("building.", BASE),
    "links": ("link.", LINK),
    "columns": ("columns.", COLUMNS),
}
"""Part of the numbers of a scene -> what the names in `Solved.values` begin with, and its fields."""

Row = tuple[str, bytes]
"""A response: TEXTS and the arguments of `layout` as JSON, and its numbers, a record of that layout."""


@lru_cache(maxsize=1024)
def layout(buildings: int, storeys: int, links: int) -> np.dtype:
    """The numbers of a scene: the fields of PARTS, of every building, storey and link."""
    of = {"scalars": (), "storeys": (buildings, storeys), "bases": (buildings,), "links": (links,), "columns": (links,)}
    return np.dtype([(name, "f8", (len(fields), *of[name])) for name, (_, fields) in PARTS.items()])


def encode(response: Response) -> Row:
    """A response as a row; its end state is not kept."""
    r = response
    texts = [each if isinstance(each, str) else "\n".join(each) for each in (getattr(r, name) for name in TEXTS)]
    size = len(r.buildings), max(b.shear.size for b in r.buildings), r.links.impacts.size
    row = np.full(1, np.nan, layout(*size))[0]
    row["scalars"] = [*(getattr(r, name) for name in SCALARS), *(r.energy.get(name, np.nan) for name in ENERGIES)]
    if r.has_result:
        for place, building in enumerate(r.buildings):
            row["storeys"][:, place, : building.shear.size] = [getattr(building, name) for name in STOREYS]
            row["bases"][:, place] = [getattr(building, name) for name in BASE]
        row["links"] = [getattr(r.links, name) for name in LINK]
        row["columns"][:, r.columns.link] = [getattr(r.columns, name) for name in COLUMNS]
    return json.dumps([texts, size]), row.tobytes()


class Solved:
    """The responses of a plan's scenes as arrays by scene number, as they are `put`.  The last place, -1, stands for
    a scene that nobody asked for: it has no numbers.

    there : whether a scene was solved, shape (scenes + 1,)
    texts : TEXTS by name, "" of a scene that was not solved, shape (scenes + 1,)
    values : "building.drift" (scenes + 1, buildings, storeys), a building alone at place 0; "building.sway" (scenes +
        1, buildings); "link.impacts", "columns.demand" (scenes + 1, links of `plan.links`); "error_estimate",
        "collapse_storey", "energy_input", ... (scenes + 1,); NaN where there is nothing
    """

    def __init__(self, plan: Plan) -> None:
        count = len(plan) + 1
        self.plan, self.there = plan, np.zeros(count, bool)
        self.texts = {name: np.full(count, "", object) for name in TEXTS}
        self._whole = np.full(count, np.nan, layout(len(plan.buildings), most_storeys(plan), len(plan.links.places)))
        fields = [(f"{prefix}{name}", of, k) for of, (prefix, names) in PARTS.items() for k, name in enumerate(names)]
        self.values = {name: self._whole[of][:, k] for name, of, k in fields}
        self._order = _orders(plan)

    def put(self, rows: Mapping[int, Row]) -> None:
        """Take in responses by scene number."""
        alike: dict[tuple[int, ...], list[int]] = {}
        for number, (kind, _) in rows.items():
            texts, size = json.loads(kind)
            alike.setdefault(tuple(size), []).append(number)
            for name, text in zip(TEXTS, texts, strict=True):
                self.texts[name][number] = sys.intern(text)  # many say the same
        for (buildings, storeys, links), at in alike.items():
            records = np.frombuffer(b"".join(rows[number][1] for number in at), layout(buildings, storeys, links))
            self.there[at] = True
            self._whole["scalars"][at] = records["scalars"]
            self._whole["storeys"][at, :, :buildings, :storeys] = records["storeys"]
            self._whole["bases"][at, :, :buildings] = records["bases"]
            order = self._order[at, None]
            for of in ("links", "columns") if links else ():
                mine = np.take_along_axis(records[of], np.maximum(order, 0), axis=2)
                self._whole[of][at] = np.where(order < 0, np.nan, mine)

    @property
    def done(self) -> np.ndarray:
        """Scenes that ended with their motion, shape (scenes + 1,)."""
        return self.texts["status"] == DONE

    @property
    def ended(self) -> np.ndarray:
        """Scenes that ended with their motion, or with a collapse, shape (scenes + 1,)."""
        return np.isin(self.texts["status"], OUTCOMES)


def _orders(plan: Plan) -> np.ndarray:
    """Of every scene `plan.links.order`, -1 of those that stand alone; shape (scenes, links)."""
    rows, columns = plan.first
    each = len(plan.analyses) * len(plan.records)
    order = plan.links.order.reshape(math.prod(plan.shape[:-2]), -1)[rows // each]
    return np.where(columns[:, None] > 0, -1, order)


def most_storeys(plan: Plan) -> int:
    """Storeys of the highest building at any point of the sweep."""
    return max(
        plan.study.building(point, place).storeys
        for place, name in enumerate(plan.study.model.group)
        for point in points(plan, ("buildings", name))
    )


def points(plan: Plan, subject: Any) -> np.ndindex:
    """A point of the sweep for every combination of the values that change something (`Study.touches`)."""
    touched = plan.study.touches(subject)
    return np.ndindex(*(len(axis.values) if mine else 1 for axis, mine in zip(plan.axes, touched, strict=True)))


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
    """What two solutions of one scene share exactly when they are the same number for number."""
    asked = f"accuracy {plan.accuracy!r}" if plan.time_step is None else f"time step {plan.time_step!r}"
    return f"solver {solver_version()} | method {plan.method} | {asked} | estimate {plan.estimate}"
