"""The few numbers of a results file that `pound run` prints, read without pandas."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any, overload

import h5py
import numpy as np

from pounding_cli.numbers import Unit
from pounding_cli.solver.response import NEVER_CLOSES
from pounding_cli.store.bracket import leading, said
from pounding_cli.store.files import opened
from pounding_cli.store.flagged import FlagGroup, SceneFlags, counts_of_flags, flag_groups
from pounding_cli.store.largest import Largest, largest_values
from pounding_cli.store.structure import strings
from pounding_cli.store.swept import assumed_heights, coordinate, pieces, written
from pounding_cli.texts import plain, plain_all

MEASURES = {"elastic": ("V_ratio", "V/V0"), "inelastic": ("mu_ratio", "mu/mu0")}
"""What is shown of each analysis: the paper's Figs 6 and 7 show these two."""


Axis = list[tuple[str, Any, Unit]]


class Points(Sequence[str]):
    """Points of a sweep in words, "impact.restitution = 0.5", the last axis fastest; made when they are looked at.

    axes : of each axis, of each key that moves on it: the key, its values, the unit they were written in
    """

    def __init__(self, axes: Sequence[Axis]) -> None:
        self._axes = axes
        self._sizes = [len(keys[0][1]) for keys in axes]

    def __len__(self) -> int:
        return math.prod(self._sizes)

    @overload
    def __getitem__(self, number: int) -> str: ...

    @overload
    def __getitem__(self, number: slice) -> list[str]: ...

    def __getitem__(self, number: int | slice) -> str | list[str]:
        if isinstance(number, slice):
            return [self[place] for place in range(*number.indices(len(self)))]
        places, number = [], range(len(self))[number]
        for size in reversed(self._sizes):
            number, place = divmod(number, size)
            places.append(place)
        return ", ".join(
            f"{name} = {unit.text(values[place])}"
            for keys, place in zip(self._axes, reversed(places), strict=True)
            for name, values, unit in keys
        )


@dataclass(frozen=True)
class Line:
    """Mean over the records of one ratio in one case, building by building; shapes (points,).

    roof : in the top storey [-]
    largest : the largest of a building's storeys [-]
    at : the storey it stands in, from 1; 0 where nothing is known
    error, sensitivity : numerical error and sensitivity of those means, the largest over storeys and points, one a
        building; nan where none was estimated [-]
    meaningless : whether the numbers of one of the scenes behind a mean mean nothing
    """

    case: str
    analysis: str
    roof: tuple[np.ndarray, ...]
    largest: tuple[np.ndarray, ...]
    at: tuple[np.ndarray, ...]
    error: tuple[float, ...]
    sensitivity: tuple[float, ...]
    meaningless: np.ndarray


@dataclass(frozen=True)
class Trust:
    """How far the numbers go: worst over the scenes that were assessed.

    assessed, scenes : how many scenes were assessed, and how many there are
    error : largest estimated numerical error [-]
    sensitivity : largest sensitivity [-], `where`: the scene it belongs to
    residual : largest energy residual [-]
    """

    assessed: int
    scenes: int
    error: float
    sensitivity: float
    where: str
    residual: float


@dataclass(frozen=True)
class Overview:
    """What a run found.

    largest : the largest values of every case and analysis, with their places
    assumed_heights : the buildings whose storey heights the study leaves to their default
    motions : source ("real", "stand-in", "user") -> names
    flags : what is flagged, by case and analysis
    meaningless : scenes whose numbers mean nothing
    ratios : analysis -> the ratio shown of it
    open_gaps : scenes with a gap that never closes
    points : those of the sweep, of a bracket only its middle; one, empty, where nothing is swept
    unknown : how results depend on unknown values, in sentences
    """

    title: str
    buildings: tuple[str, ...]
    lines: tuple[Line, ...]
    largest: tuple[Largest, ...]
    assumed_heights: tuple[str, ...]
    ratios: dict[str, str]
    motions: dict[str, list[str]]
    flags: tuple[FlagGroup, ...]
    meaningless: int
    open_gaps: int
    points: Points
    unknown: tuple[str, ...]
    records: int
    solver_seconds: float
    trust: Trust


def overview(path: Path) -> Overview:
    """Read it from a results file.

    Raises
    ------
    InputError : not a results file of this program
    """
    with opened(path) as file:
        cases, analyses, buildings, records = (
            list(strings(file[name])) for name in ("case", "analysis", "building", "record")
        )
        sources = list(strings(file["record_source"]).reshape(-1, len(records))[0])
        swept, lead = json.loads(file.attrs["swept"]), leading(file)
        axes = [[(name, coordinate(file, name), written(file[name])) for name in names] for names in swept]
        # Storeys of a building, in whichever point of the sweep it has most of them.
        mass = file["mass"][()]
        there = np.isfinite(mass).any(axis=tuple(range(mass.ndim - 2)))
        worthless: list[np.ndarray] = []
        flags = flag_groups(_flags(file["flags"], Points(axes), (cases, analyses, records), worthless))
        meaningless = np.concatenate(worthless).reshape(*(len(keys[0][1]) for keys in axes), len(cases), len(analyses))
        marked = meaningless[lead].reshape(-1, len(cases), len(analyses)) > 0
        storeys, lines = there.sum(axis=-1).tolist(), {}
        for a, analysis in enumerate(analyses):
            ratio, _ = MEASURES[analysis]
            shape = len(cases), len(buildings), len(marked)
            seen: tuple[np.ndarray, ...] = np.empty(shape), np.empty(shape), np.empty(shape, np.int32)
            end = 0
            for piece in pieces(file[f"{ratio}_mean"], lead):
                begin, end = end, end + len(piece)
                for b, count in enumerate(storeys):
                    for whole, mine in zip(seen, _building(piece[:, :, a, b], count), strict=True):
                        whole[:, b, begin:end] = mine.T
            error, sensitivity = (_worst_of(file[f"{ratio}_mean_{what}"], lead, a) for what in ("error", "sensitivity"))
            for c, case in enumerate(cases):
                roof, largest, at = (tuple(whole[c]) for whole in seen)
                worst = tuple(error[c].tolist()), tuple(sensitivity[c].tolist())
                lines[c, a] = Line(case, analysis, roof, largest, at, *worst, marked[:, c, a])
        return Overview(
            plain(str(file.attrs["title"])),
            tuple(buildings),
            tuple(lines[place] for place in sorted(lines)),
            tuple(largest_values(file, lead)),
            assumed_heights(file),
            {analysis: MEASURES[analysis][1] for analysis in analyses},
            {source: [r for r, s in zip(records, sources, strict=True) if s == source] for source in sources},
            flags,
            int(meaningless.sum()),
            _open_gaps(file),
            Points([keys for keys, at in zip(axes, lead, strict=True) if isinstance(at, slice)]),
            tuple(said(file)),
            len(records),
            float(file.attrs["solver_seconds"]),
            _trust(file, (cases, analyses, records)),
        )


def _trust(file: h5py.File, names: tuple[list[str], list[str], list[str]]) -> Trust:
    assessed, scenes, where, worst = 0, 0, "", np.full(3, -np.inf)
    columns = (file[name] for name in ("error_estimate", "sensitivity", "energy_residual"))
    each = (pieces(column, (slice(None),) * (column.ndim - 3)) for column in columns)
    for errors, sensitivities, residuals in zip(*each, strict=True):
        known = np.isfinite(sensitivities)
        assessed, scenes = assessed + int(known.sum()), scenes + known.size
        largest = [_largest(values) for values in (errors, sensitivities, np.abs(residuals))]
        if largest[1] > worst[1]:
            at = np.unravel_index(np.argmax(np.where(known, sensitivities, -np.inf)), known.shape)
            where = ", ".join(words[int(i)] for words, i in zip(names, at[-3:], strict=True))
        worst = np.maximum(worst, largest)
    error, sensitivity, residual = np.where(worst > -np.inf, worst, np.nan).tolist()
    return Trust(assessed, scenes, error, sensitivity, where, residual)


def _largest(values: np.ndarray) -> float:
    """The largest finite value; -inf where there is none."""
    return float(values[np.isfinite(values)].max(initial=-np.inf))


def _flags(
    dataset: h5py.Dataset, points: Points, names: tuple[list[str], ...], worthless: list[np.ndarray]
) -> Iterator[SceneFlags]:
    """The flags of every scene; `worthless` gets, piece by piece, the records whose numbers mean nothing."""
    number = 0
    for piece in pieces(dataset.asstr(), (slice(None),) * (dataset.ndim - 3)):
        flags = np.array(plain_all(piece.flat), dtype=object).reshape(piece.shape)
        worthless.append(counts_of_flags(flags)["records_meaningless"].astype(np.int32))
        for cells in flags:
            point = points[number] if any(cells.flat) else ""  # that of a scene without flags is not asked for
            number += 1
            for (case, analysis, record), cell in zip(product(*names), cells.flat, strict=True):
                yield SceneFlags(point, case, analysis, record, cell)


def _open_gaps(file: h5py.File) -> int:
    """Scenes with a gap that never closes."""
    every = (slice(None),) * (file["dropped"].ndim - 3)
    return sum(NEVER_CLOSES in text for piece in pieces(file["dropped"].asstr(), every) for text in piece.flat)


def _worst_of(dataset: h5py.Dataset, lead: tuple[int | slice, ...], analysis: int) -> np.ndarray:
    """The largest of finite values over points and storeys, NaN where there is none, shape (cases, buildings)."""
    found = [
        np.where(np.isfinite(piece), piece, -np.inf)[:, :, analysis].max(axis=(0, -1))
        for piece in pieces(dataset, lead)
    ]
    worst = np.max(found, axis=0)
    return np.where(worst == -np.inf, np.nan, worst)


def _building(values: np.ndarray, storeys: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Roof, largest and its storey, each of shape (points, cases), from means of shape (points, cases, storeys)."""
    values = values[..., :storeys]
    known = np.isfinite(values)
    filled = np.where(known, values, -np.inf)
    some = known.any(axis=-1)
    largest = np.where(some, filled.max(axis=-1), np.nan)
    return values[..., -1], largest, np.where(some, filled.argmax(axis=-1) + 1, 0).astype(np.int32)
