"""Commands with a model of their own: the points of a study's sweep are solved one after the other."""

from __future__ import annotations

import pkgutil
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel, ValidationError

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import Unit, pluralize
from pounding_cli.solver.response import DONE
from pounding_cli.study.axes import Axis, read_axes
from pounding_cli.study.file import Problems, read_study, refuse_other_kinds, with_value
from pounding_cli.study.warnings import Doubts, warn_values
from pounding_cli.study.words import describe_errors

if TYPE_CHECKING:
    import xarray as xr

    from pounding_cli.report.document import Picture, Report

POINT_COMMANDS = {
    "connector": "pounding_cli.paper.connector:CONNECTOR_COMMAND",
    "wall": "pounding_cli.paper.wall:WALL_COMMAND",
}
"""Command -> the place of its `PointCommand`; its module is imported when the command is used."""

MESH = ("element", "side", "axis")
"""Dimensions of fields on a mesh, which are drawn and not kept in the results file."""

_UNITS = {
    "N": Unit("kN", 1e3, "N"), "N s": Unit("kN s", 1e3, "N s"), "N m": Unit("kN m", 1e3, "N m"),
    "N/m2": Unit("N/mm²", 1e6, "N/m2"), "s": Unit("ms", 1e-3, "s"), "1": Unit("", 1.0, "1"),
}  # fmt: skip
"""SI unit -> the unit that tables show."""


@dataclass(frozen=True)
class PointCommand:
    """A command that solves the points of a study one after the other.

    name : of the command, and the kind of its results files
    spec : model of its study file
    solve : a study -> its values with unit and meaning (`to_variable`), and sentences in the attribute `notes`
    terminal_numbers : names of the values that a terminal prints
    cite_references : a study -> {key of a reference: what for}
    build_pictures : title and points -> figures of the report, the most important first
    """

    name: str
    spec: type[BaseModel]
    solve: Callable[[Any], xr.Dataset]
    terminal_numbers: tuple[str, ...]
    cite_references: Callable[[Any], Mapping[str, str]]
    build_pictures: Callable[[str, Sequence[SweepPoint]], Sequence[Picture]]


@dataclass(frozen=True)
class SweepPoint:
    """One point of the sweep: its label, the study there and the values of the swept keys.

    data : values of the point, as `PointCommand.solve` returns them
    status, advice : "done", or why there is nothing in `data`, and what to do about it
    """

    label: str
    study: Any
    swept: Mapping[str, float | str]
    data: Any = None
    status: str = ""
    advice: str = ""


@dataclass(frozen=True)
class Sweep:
    """A validated study of a command: its title, text, swept axes and points."""

    command: PointCommand
    title: str
    text: str
    axes: tuple[Axis, ...]
    points: tuple[SweepPoint, ...]
    warnings: tuple[Problem, ...] = ()


def to_variable(unit: str, text: str, number: Any, *dims: str) -> tuple[Any, ...]:
    """A variable of the Dataset of a point: in SI, with its meaning; `dims` of an array."""
    return dims, number, {"units": unit, "long_name": text}


def load_sweep(path: Path, name: str) -> Sweep:
    """Read and validate a study of a command.  Raises `InputError` with every problem and its place."""
    command: PointCommand = pkgutil.resolve_name(POINT_COMMANDS[name])
    text, root = read_study(path)
    refuse_other_kinds(root, str(path), name)
    problems = Problems(str(path))
    axes = read_axes(root, problems, command.spec)
    problems.check()
    points = []
    doubts = Doubts(str(path))
    for places in product(*(range(len(axis)) for axis in axes)):
        tree = root
        swept = dict[str, float | str]()
        for axis, index in zip(axes, places, strict=True):
            for key, value, mark in zip(axis.paths, axis.written_values[index], axis.marks[index], strict=True):
                tree = with_value(tree, key, value, mark)
            swept |= dict(zip(axis.names, axis.values[index], strict=True))
        label = ", ".join(axis.format_point(index) for axis, index in zip(axes, places, strict=True))
        try:
            study: Any = command.spec.model_validate(tree)
            points.append(SweepPoint(label, study, swept))
            warn_values(study, tree, (), doubts)
        except ValidationError as error:
            for issue in describe_errors(error, (), command.spec, tree):
                problems.add_issue(tree, issue)
    problems.check()
    warnings = sorted(doubts.iter_merged(), key=lambda warning: (warning.line, warning.column))
    return Sweep(command, points[0].study.title, text, axes, tuple(points), tuple(warnings))


def solve_point(sweep: Sweep, point: SweepPoint) -> SweepPoint:
    """Return a point with its values; whatever goes wrong in it becomes its status, and the others go on."""
    import xarray as xr

    begin = time.thread_time()
    data = xr.Dataset()
    status = DONE
    advice = ""
    try:
        with np.errstate(all="ignore"):  # what is not finite in the end is refused
            data = sweep.command.solve(point.study)
    except InputError as refused:
        (problem, *_) = refused.problems
        status = f"refused: {problem.message}"
        advice = problem.hint
    except ArithmeticError:
        status = "refused: numbers too large or too small to compute with"
        advice = "give values that differ by fewer powers of ten"
    except MemoryError:
        status = "refused: not enough memory"
        advice = "give a coarser mesh, larger steps or fewer frequencies"
    except Exception as error:  # one point must not take the others with it
        status = f"error: {type(error).__name__}: {error}"
        advice = "this is an internal error: please report it with the study file"
    data["status"] = to_variable("", "done, or what went wrong", status)
    data["seconds"] = to_variable("s", "processor time", time.thread_time() - begin)
    return replace(point, data=data, status=status, advice=advice)


def build_dataset(sweep: Sweep) -> xr.Dataset:
    """Every variable over the swept keys; arrays of points with fewer instants, cells or bands end in NaN."""
    import xarray as xr

    every = [point.data.drop_dims(MESH, errors="ignore").drop_attrs(deep=False) for point in sweep.points]
    index_dims = {dim for each in every for dim in each.sizes if dim not in each.coords}
    most = {dim: max(each.sizes.get(dim, 0) for each in every) for dim in index_dims}
    every = [each.pad({dim: (0, most[dim] - each.sizes[dim]) for dim in index_dims & {*each.sizes}}) for each in every]
    for axis in reversed(sweep.axes):
        rows = [every[first : first + len(axis)] for first in range(0, len(every), len(axis))]
        join_options: Any = {"join": "outer", "data_vars": "all", "coords": "minimal", "compat": "equals"}
        every = [xr.concat(row, axis.names[0], combine_attrs="override", **join_options) for row in rows]
    (merged,) = every
    for axis in sweep.axes:
        columns = zip(axis.names, zip(*axis.values, strict=True), strict=True)
        merged = merged.assign_coords({name: (axis.names[0], list(values)) for name, values in columns})
    return merged.assign_attrs({"kind": sweep.command.name, "title": sweep.title, "study": sweep.text})


def is_written_by(name: str, file: Path) -> bool:
    """Return whether the command `name` wrote a file, damaged since or not."""
    import h5py

    try:
        with h5py.File(file) as results:
            return bool(results.attrs.get("kind") == name)
    except Exception:  # whatever HDF5 says of a file that is none
        return False


def build_report(sweep: Sweep) -> Report:
    """The numbers of every point, figures and references."""
    import pandas as pd

    from pounding_cli.report.document import Report, Section
    from pounding_cli.report.references import REFERENCES
    from pounding_cli.report.table import from_rows
    from pounding_cli.results.tables import Column, Table

    command = sweep.command
    done = [point for point in sweep.points if point.status == DONE]
    frame = pd.DataFrame([
        {**point.swept, **{name: each.item() for name, each in point.data.items() if not each.dims}}
        for point in sweep.points
    ])  # fmt: skip
    swept = {name: unit for axis in sweep.axes for name, unit in zip(axis.names, axis.units, strict=True)}
    columns = {name: Column("swept", unit, name) for name, unit in swept.items()}
    for name, each in max((point.data for point in sweep.points), key=len).items():
        if not each.dims:
            si = each.attrs["units"]
            columns[name] = Column(each.attrs["long_name"], _UNITS.get(si, Unit(si, 1.0, si)), name.replace("_", " "))
    frame = frame[[*columns]]
    terminal_frame = frame[[*swept, *(command.terminal_numbers if done else ["status"])]]
    pictures = command.build_pictures(sweep.title, done) if done else []
    cited = [[REFERENCES[key].text, what] for key, what in command.cite_references(sweep.points[0].study).items()]
    notes = [": ".join(filter(None, (point.label, note))) for point in done for note in point.data.attrs["notes"]]
    failed_count = len(sweep.points) - len(done)
    sentences = [f"{pluralize(failed_count, 'point')} failed."] if failed_count else []
    return Report(
        sweep.title,
        Section("", sentences, [Table("", terminal_frame, columns)], pictures[:1], notes),
        lambda: [
            Section("Further figures", pictures=pictures[1:]),
            Section("Numbers", tables=[Table(command.name, frame, columns, "Numbers at every point")]),
            Section("References", tables=[from_rows("", ("reference", "for"), cited)]),
            Section("Study", widget="study"),
        ],
        study=sweep.text,
    )
