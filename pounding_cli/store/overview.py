"""The few numbers of a results file that `pound run` prints, read without pandas."""

from __future__ import annotations

import json
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import h5py
import numpy as np

from pounding_cli.store.bracket import leading, said
from pounding_cli.store.files import opened
from pounding_cli.store.flagged import FlagGroup, SceneFlags, counts_of_flags, flag_groups
from pounding_cli.store.structure import strings
from pounding_cli.store.swept import coordinate, written
from pounding_cli.texts import plain

MEASURES = {"elastic": ("V_ratio", "V/V0"), "inelastic": ("mu_ratio", "mu/mu0")}
"""What is shown of each analysis: the paper's Figs 6 and 7 show these two."""


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

    assessed, scenes : how many scenes were solved once more, and how many there are
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

    motions : source ("real", "stand-in", "user") -> names
    flags : what is flagged, by case and analysis
    meaningless : scenes whose numbers mean nothing
    ratios : analysis -> the ratio shown of it
    not_simulated : scenes answered by proof from smaller groups, none of them simulated
    points : every point of the sweep in words, of a bracket only its middle; one, empty, where nothing is swept
    unknown : how results depend on unknown values, in sentences
    """

    title: str
    buildings: tuple[str, ...]
    lines: tuple[Line, ...]
    ratios: dict[str, str]
    motions: dict[str, list[str]]
    flags: tuple[FlagGroup, ...]
    meaningless: int
    not_simulated: int
    points: tuple[str, ...]
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
        axes = [axis for axis, at in zip(swept, lead, strict=True) if isinstance(at, slice)]
        means, errors, sensitivities = (
            {ratio: file[f"{ratio}_{what}"][()][lead] for ratio, _ in MEASURES.values()}
            for what in ("mean", "mean_error", "mean_sensitivity")
        )
        # Storeys of a building, in whichever point of the sweep it has most of them.
        mass = file["mass"][()]
        there = np.isfinite(mass).any(axis=tuple(range(mass.ndim - 2)))
        everywhere = _points([{name: _shown(file[name]) for name in names} for names in swept])
        flags = strings(file["flags"])
        worthless = counts_of_flags(flags)["records_meaningless"]
        marked = worthless[lead].reshape(-1, len(cases), len(analyses)) > 0
        scenes = (
            SceneFlags(*names, cell)
            for names, cell in zip(product(everywhere, cases, analyses, records), flags.flat, strict=True)
        )
        lines = []
        for c, case in enumerate(cases):
            for a, analysis in enumerate(analyses):
                ratio, _ = MEASURES[analysis]
                values = means[ratio].reshape(-1, *means[ratio].shape[len(axes) :])[:, c, a]
                each = [_building(values[:, b], int(there[b].sum())) for b in range(len(buildings))]
                roof, largest, at = zip(*each, strict=True)
                error, sensitivity = (
                    tuple(_worst(worth[ratio][..., c, a, b, :]) for b in range(len(buildings)))
                    for worth in (errors, sensitivities)
                )
                lines.append(Line(case, analysis, roof, largest, at, error, sensitivity, marked[:, c, a]))
        return Overview(
            plain(str(file.attrs["title"])),
            tuple(buildings),
            tuple(lines),
            {analysis: MEASURES[analysis][1] for analysis in analyses},
            {source: [r for r, s in zip(records, sources, strict=True) if s == source] for source in sources},
            flag_groups(scenes),
            int(worthless.sum()),
            int(np.sum((strings(file["status"]) == "done") & (file["steps"][()] == 0))),
            _points([{name: _shown(file[name]) for name in names} for names in axes]),
            tuple(said(file)),
            len(records),
            float(file.attrs["solver_seconds"]),
            _trust(file, (cases, analyses, records)),
        )


def _trust(file: h5py.File, names: tuple[list[str], list[str], list[str]]) -> Trust:
    errors, sensitivities = file["error_estimate"][()], file["sensitivity"][()]
    residuals = np.abs(file["energy_residual"][()])
    known = np.isfinite(sensitivities)
    where = ""
    if known.any():
        at = np.unravel_index(np.argmax(np.where(known, sensitivities, -np.inf)), sensitivities.shape)
        where = ", ".join(words[int(i)] for words, i in zip(names, at[-3:], strict=True))
    return Trust(int(known.sum()), int(known.size), _worst(errors), _worst(sensitivities), where, _worst(residuals))


def _worst(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(known.max()) if known.size else float("nan")


def _points(axes: list[dict[str, list[str]]]) -> tuple[str, ...]:
    """Points in words, the last axis fastest, as the arrays are laid out."""
    words = [
        [
            ", ".join(f"{name} = {value}" for name, value in zip(axis, row, strict=True))
            for row in zip(*axis.values(), strict=True)
        ]
        for axis in axes
    ]
    return tuple(", ".join(point) for point in product(*words))


def _shown(dataset: h5py.Dataset) -> list[str]:
    """The values of a swept key as the study wrote them."""
    unit = written(dataset)
    return [unit.text(value) for value in coordinate(dataset.file, dataset.name)]


def _building(values: np.ndarray, storeys: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Roof, largest and its storey, from means of shape (points, storeys)."""
    values = values[:, :storeys]
    known = np.isfinite(values)
    filled = np.where(known, values, -np.inf)
    largest = np.where(known.any(axis=1), filled.max(axis=1), np.nan)
    return values[:, -1], largest, np.where(known.any(axis=1), filled.argmax(axis=1) + 1, 0)
