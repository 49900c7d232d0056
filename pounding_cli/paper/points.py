"""Commands with a model of their own: the points of a study's sweep are solved one after the other."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel, ValidationError

from pounding_cli.errors import InputError, Issue
from pounding_cli.numbers import Unit, pluralize
from pounding_cli.paper import load_point_command
from pounding_cli.questions.frames import list_swept_columns
from pounding_cli.solver.response import DONE
from pounding_cli.study.check.doubts import Doubts
from pounding_cli.study.check.values import Written, check_values
from pounding_cli.study.schema.lookup import describe_errors
from pounding_cli.study.text.file import Problems, read_study, refuse_other_kinds, with_value
from pounding_cli.study.vary.axes import Axis, read_axes
from pounding_cli.study.vary.changes import Change, apply_changes
from pounding_cli.tables import Column, Table, build_table, table_of_texts

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from pounding_cli.report.document import Picture, Report
    from pounding_cli.results.arrays import Array

MESH = ("element", "side", "axis")
"""Dimensions of fields on a mesh, which are drawn and not kept in the results file."""

STATUS_COLUMNS = (
    Column("status", "done, or what went wrong"),
    Column("seconds", "processor time", Unit("ms", 1e-3, "s"), "time"),
)
"""Columns behind the numbers of every point."""


@dataclass(frozen=True, eq=False)
class PointAnswer:
    """The answer of a model at one point.

    numbers : in SI, by the columns of its command
    arrays : histories and fields, by name
    notes : what a reader should know of them
    """

    numbers: Mapping[str, float]
    arrays: Mapping[str, Array]
    notes: Sequence[str] = ()


@dataclass(frozen=True)
class PointCommand:
    """A command that solves the points of a study one after the other.

    name : of the command, and the kind of its results files
    spec : model of its study file
    solve : study -> answer of a point; raises InputError where there is none
    columns : of the numbers of a point
    shown_columns : names of those that a terminal prints
    sentences : solved points -> the answer, the most important first
    figures : title and solved points -> figures, the most important first
    cite : study -> keys of references, and what each was used for
    """

    name: str
    spec: type[BaseModel]
    solve: Callable[[Any], PointAnswer]
    columns: Sequence[Column]
    shown_columns: Sequence[str]
    sentences: Callable[[Sequence[SweepPoint]], Sequence[str]]
    figures: Callable[[str, Sequence[SweepPoint]], Sequence[Picture]]
    cite: Callable[[Any], Iterable[tuple[str, str]]]

    def column(self, name: str) -> Column:
        """Return a column of the numbers.  Raises KeyError: there is none."""
        return {column.name: column for column in self.columns}[name]


@dataclass(frozen=True)
class SweepPoint:
    """One point of the sweep.

    label : its swept keys in words; "" where nothing is swept
    study : the study there
    swept : swept key -> value [SI] or text
    numbers, arrays, notes : of its answer; empty before it is solved, and where it failed
    status, advice : `DONE`, or why there are no numbers, and what to do about it
    seconds : processor time [s]
    """

    label: str
    study: Any
    swept: Mapping[str, float | str]
    numbers: Mapping[str, float] = field(default_factory=dict)
    arrays: Mapping[str, Array] = field(default_factory=dict)
    notes: Sequence[str] = ()
    status: str = ""
    advice: str = ""
    seconds: float = math.nan

    def values(self, name: str) -> np.ndarray:
        """Return the values of one of the arrays."""
        return self.arrays[name].values


@dataclass(frozen=True)
class Sweep:
    """A validated study of a command: its title, text, swept axes and points."""

    command: PointCommand
    title: str
    text: str
    axes: tuple[Axis, ...]
    points: tuple[SweepPoint, ...]
    warnings: tuple[Issue, ...] = ()

    @property
    def solved_points(self) -> list[SweepPoint]:
        """The points that have numbers."""
        return [point for point in self.points if point.status == DONE]

    @property
    def failed_points(self) -> list[SweepPoint]:
        """The points that have none."""
        return [point for point in self.points if point.status != DONE]


def build_variable(unit: str, text: str, values: Any, *dims: str) -> Array:
    """Return an array with its SI unit and its meaning."""
    from pounding_cli.results.arrays import Array  # with h5py, which `pound check` does not need

    return Array(dims, np.asarray(values), {"units": unit, "long_name": text})


def load_sweep(path: Path, name: str, changes: Sequence[Change] = ()) -> Sweep:
    """Read and validate a study of a command.  Raises `InputError` with every problem and its place.

    changes : values in place of those of the file
    """
    command = load_point_command(name)
    text, root = read_study(path)
    refuse_other_kinds(root, str(path), name)
    if changes:
        text, root = apply_changes(text, root, changes, str(path), command.spec)
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
            doubts.add(tree, check_values(Written(tree), study, ()))
        except ValidationError as error:
            for issue in describe_errors(error, (), command.spec, tree):
                problems.add_issue(tree, issue)
    problems.check()
    warnings = sorted(doubts.iter_merged(), key=lambda warning: (warning.line, warning.column))
    return Sweep(command, points[0].study.title, text, axes, tuple(points), tuple(warnings))


def solve_point(sweep: Sweep, point: SweepPoint) -> SweepPoint:
    """Return a point with its answer; whatever goes wrong in it becomes its status, and the others go on."""
    begin = time.thread_time()
    answer = PointAnswer({}, {})
    status = DONE
    advice = ""
    try:
        with np.errstate(all="ignore"):  # what is not finite in the end is refused
            answer = sweep.command.solve(point.study)
    except InputError as refused:
        (problem, *_) = refused.issues
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
    return replace(
        point,
        numbers=answer.numbers,
        arrays=answer.arrays,
        notes=answer.notes,
        status=status,
        advice=advice,
        seconds=time.thread_time() - begin,
    )


def build_dataset(sweep: Sweep) -> xr.Dataset:
    """Return every variable over the swept keys; arrays of points with fewer instants, cells or bands end in NaN."""
    import xarray as xr

    every = [_to_dataset(sweep.command, point).drop_dims(MESH, errors="ignore") for point in sweep.points]
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


def _to_dataset(command: PointCommand, point: SweepPoint) -> xr.Dataset:
    """Return the variables of one point."""
    import xarray as xr

    columns = {column.name: column for column in (*command.columns, *STATUS_COLUMNS)}
    values = {**point.numbers, "status": point.status, "seconds": point.seconds}
    variables: dict[str, Any] = {}
    for name, value in values.items():
        variables[name] = ((), value, {"units": columns[name].unit.si, "long_name": columns[name].text})
    for name, array in point.arrays.items():
        variables[name] = (array.dims, array.values, dict(array.attrs))
    return xr.Dataset(variables)


def is_written_by(name: str, file: Path) -> bool:
    """Return whether the command `name` wrote a file, damaged since or not."""
    import h5py

    try:
        with h5py.File(file) as results:
            return bool(results.attrs.get("kind") == name)
    except Exception:  # whatever HDF5 says of a file that is none
        return False


# What is shown of them


def build_points_table(sweep: Sweep) -> Table:
    """Return the numbers of every point, a row a point."""
    frame = _build_frame(sweep)
    declared = [*list_swept_columns(sweep.axes), *sweep.command.columns, *STATUS_COLUMNS]
    return build_table(sweep.command.name, frame, declared, caption="Numbers at every point")


def _build_frame(sweep: Sweep) -> pd.DataFrame:
    import pandas as pd

    names = [column.name for column in sweep.command.columns]
    rows = []
    for point in sweep.points:
        row: dict[str, Any] = dict(point.swept)
        row |= {name: point.numbers.get(name, math.nan) for name in names}
        row["status"] = point.status
        row["seconds"] = point.seconds
        rows.append(row)
    return pd.DataFrame(rows)


def build_report(sweep: Sweep) -> Report:
    """Return the report of a sweep: the answer, the numbers of every point, figures and references."""
    from pounding_cli.report.document import Report, Section
    from pounding_cli.report.references import REFERENCES

    command = sweep.command
    solved = sweep.solved_points
    table = build_points_table(sweep)
    pictures = command.figures(sweep.title, solved) if solved else []
    cited = [(REFERENCES[key].text, purpose) for key, purpose in command.cite(sweep.points[0].study)]
    notes = [": ".join(filter(None, (point.label, note))) for point in solved for note in point.notes]
    answer = Section("", _list_sentences(sweep), [_choose_columns(sweep, table)], notes=notes)
    return Report(
        sweep.title,
        answer,
        lambda: pictures[:1],
        lambda: [
            Section("Further figures", pictures=pictures[1:]),
            Section("Numbers", tables=[table]),
            Section("References", tables=[table_of_texts("", ("reference", "for"), cited)]),
            Section("Study", widget="study"),
        ],
        study=sweep.text,
    )


def _list_sentences(sweep: Sweep) -> list[str]:
    """Return the answer in sentences, and how many points failed."""
    solved = sweep.solved_points
    failed_count = len(sweep.failed_points)
    sentences = list(sweep.command.sentences(solved)) if solved else []
    if failed_count and solved:
        sentences.append(f"{pluralize(failed_count, 'point')} of {len(sweep.points)} failed.")
    elif failed_count:
        sentences.append("There is no answer: every point failed." if failed_count > 1 else "There is no answer.")
    return sentences


def _choose_columns(sweep: Sweep, table: Table) -> Table:
    """Return the columns that a terminal prints; the status where a point failed."""
    swept = [name for axis in sweep.axes for name in axis.names]
    shown = list(sweep.command.shown_columns) if sweep.solved_points else []
    status = ["status"] if sweep.failed_points else []
    return replace(table.view(*swept, *shown, *status), caption="")


def describe_extremes(points: Sequence[SweepPoint], column: Column) -> str:
    """Return the smallest and the largest number of some points in words, each with its point.

    "5598 (mesh.size = 0.125 m) to 7278 kN (mesh.size = 1 m)"; of one point, or where all are alike, the number alone.
    """
    known = [point for point in points if math.isfinite(point.numbers[column.name])]
    first = min(known, key=lambda point: point.numbers[column.name])
    last = max(known, key=lambda point: point.numbers[column.name])
    low = column.format(first.numbers[column.name])
    high = column.format_with_unit(last.numbers)
    if low == column.format(last.numbers[column.name]):
        return high
    return f"{low} ({first.label}) to {high} ({last.label})"


def iter_failures(sweep: Sweep) -> Iterator[tuple[str, str, str]]:
    """Yield of every failed point its label, what happened and what to do about it."""
    for point in sweep.failed_points:
        yield point.label or "the study", point.status, point.advice
