"""Questions with a model of their own: the points of a study's sweep are solved one after the other, and written with
a table, figures and a page.

A question is a package (`connector`, `wall`), its command is its name. It offers

Study : pydantic model of its file; `fixed` are sections that no axis may touch
doubts(study) : (key, what is doubtful, what to do), beyond the plausible ranges of single keys
solve(study) : the values of VARIABLES by name, and `flags`, a list of sentences
lines(found) : what is printed of such values
STATEMENTS : sentences of the paper, each with (found) -> whether it holds, and what was found in words
figures(title, points, axes) : (heading, figure) by file name; beside(points, folder) : writes files for other programs
cites(study) : {reference: what for}
"""

from __future__ import annotations

import importlib
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import Unit, counted
from pounding_cli.outputs import check_folder, check_output
from pounding_cli.study.axes import SweepAxis, read_axes
from pounding_cli.study.file import Problems, put, read_study, refuse_other_kinds
from pounding_cli.study.plausible import doubt_values, few
from pounding_cli.study.words import value_at

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from pounding_cli.report.document import Report

_SHOWN = {
    "N": Unit("kN", 1e3, "N"), "N s": Unit("kN s", 1e3, "N s"), "N m": Unit("kN m", 1e3, "N m"),
    "N/m2": Unit("N/mm²", 1e6, "N/m2"), "s": Unit("ms", 1e-3, "s"),
}  # fmt: skip
"""SI unit -> the unit that the page shows."""

QUESTIONS = ("connector", "wall")
"""The packages."""


@dataclass(frozen=True)
class Point:
    """One point of the sweep: its place on every axis, in words, the study there, what each swept key is.

    found : what came of it, by variable; `status` says why there is nothing else
    """

    place: tuple[int, ...]
    label: str
    study: Any
    swept: Mapping[str, float | str]
    found: Mapping[str, Any]


@dataclass(frozen=True)
class Sweep:
    """A validated study of the command `name`, of the package `asked`: its points are not solved yet."""

    name: str
    asked: Any
    title: str
    text: str
    axes: tuple[SweepAxis, ...]
    points: tuple[Point, ...]
    warnings: tuple[Problem, ...]


def load(path: Path, name: str) -> Sweep:
    """Read and validate a study of a command.  Raises `InputError` with every problem and its place."""
    asked: Any = importlib.import_module(f"pounding_cli.{name}")
    text, root = read_study(path)
    refuse_other_kinds(root, str(path), name)
    problems, notes = Problems(str(path)), Problems(str(path))
    axes = read_axes(root, problems, asked.Study)
    for each in (each for axis in axes for each in axis.names if each.split(".")[0] in asked.Study.fixed):
        hint = "give one range for the study"
        problems.at(root, ("sweep", each), f"'{each}' cannot be an axis", hint, key=True)
    problems.check()
    points = []
    for place in product(*(range(len(axis)) for axis in axes)):
        tree, swept, words = root, {}, []
        for axis, at in zip(axes, place, strict=True):
            for path_, value, mark, unit in zip(axis.paths, axis.given[at], axis.marks[at], axis.units, strict=True):
                tree = put(tree, path_, value, mark)
                swept[".".join(path_)] = value_at(asked.Study, tuple(path_), value)
                words.append(f"{'.'.join(path_)} = {unit.text(swept['.'.join(path_)])}")
        try:
            study = asked.Study.model_validate(tree)
        except ValidationError as error:
            problems.validation(tree, error, (), asked.Study)
            continue
        points.append(Point(place, ", ".join(words), study, swept, {}))
        doubt_values(study, tree, (), notes)
        for path_, message, hint in asked.doubts(study):
            notes.at(tree, path_, message, hint)
    problems.check()
    return Sweep(name, asked, points[0].study.title, text, axes, tuple(points), tuple(few(notes.found)))


def solved(sweep: Sweep, point: Point) -> Point:
    """A point with its values; an error in it becomes its status."""
    begin = time.thread_time()
    try:
        values = sweep.asked.solve(point.study) | {"status": "done"}
    except InputError as refused:
        problem = refused.problems[0]
        values = {"status": f"refused: {problem.message}", "flags": [problem.hint]}
    return Point(point.place, point.label, point.study, point.swept, values | {"seconds": time.thread_time() - begin})


def table(sweep: Sweep, points: Sequence[Point]) -> pd.DataFrame:
    """One row a point: the swept keys, every variable that is one number (SI), `status`, processor time [s]."""
    import pandas as pd

    names = [*(v.name for v in sweep.asked.VARIABLES if not v.dims), "status", "seconds"]
    return pd.DataFrame([{**point.swept, **{name: point.found.get(name) for name in names}} for point in points])


def dataset(sweep: Sweep, points: Sequence[Point]) -> xr.Dataset:
    """Every variable over the swept keys; arrays of points with fewer instants, cells or rows end in NaN."""
    import xarray as xr

    shape, axes = tuple(map(len, sweep.axes)), [axis.names[0] for axis in sweep.axes]
    done = [point for point in points if point.found["status"] == "done"]
    found: dict[str, Any] = {"status": (axes, np.full(shape, "", object), {"long_name": "done, or what went wrong"})}
    for point in points:
        found["status"][1][point.place] = point.found["status"]
    for variable in sweep.asked.VARIABLES if done else ():
        arrays = [(point.place, np.asarray(point.found[variable.name], float)) for point in done]
        sizes = np.max([array.shape for _, array in arrays], axis=0).astype(int)
        whole = np.full((*shape, *sizes), np.nan)
        for place, array in arrays:
            at: Any = (*place, *(slice(size) for size in array.shape))
            whole[at] = array
        about = {"units": variable.unit, "long_name": variable.text}
        alone = variable.dims == (variable.name,)  # a coordinate, the same at all points
        found[variable.name] = (
            (variable.dims, arrays[0][1], about) if alone else ((*axes, *variable.dims), whole, about)
        )
    for number, axis in enumerate(sweep.axes):
        for name in axis.names:
            along = {point.place[number]: point.swept[name] for point in points}
            found[name] = (axes[number], [along[place] for place in sorted(along)])
    about = {"kind": sweep.name, "title": sweep.title, "study": sweep.text}
    data = xr.Dataset(found, attrs=about)
    return data.set_coords([name for axis in sweep.axes for name in axis.names])


def places(output: Path) -> tuple[Path, Path]:
    """Where the dataset is written, and the folder of its name for all else; raises `InputError` where neither can."""
    file = output if output.suffix else output.with_suffix(".h5")
    check_output(file, mine=lambda _, head: head.startswith(b"\x89HDF"))
    check_folder(file.with_suffix(""))
    return file, file.with_suffix("")


def write(sweep: Sweep, points: Sequence[Point], file: Path, folder: Path) -> list[Path]:
    """Write the dataset as netCDF, and into the folder the table, the figures and the page; the files."""
    draft = file.with_name(f".{file.name}.draft")
    try:  # made in memory, and renamed when it is whole: the disk may be full
        draft.write_bytes(dataset(sweep, points).to_netcdf(engine="h5netcdf"))
        draft.replace(file)
    finally:
        draft.unlink(missing_ok=True)
    table(sweep, points).to_csv(folder / f"{sweep.name}.csv", index=False)
    sweep.asked.beside([point for point in points if point.found["status"] == "done"], folder)
    return [file, folder / f"{sweep.name}.csv", *report(sweep, points).save(folder, ("png", "svg"))]


def report(sweep: Sweep, points: Sequence[Point]) -> Report:
    """The figures, what the paper says of them at every point, and the numbers."""
    from pounding_cli.report.document import Picture, Report, Section
    from pounding_cli.report.references import REFERENCES
    from pounding_cli.report.table import digits, from_rows

    asked, done = sweep.asked, [point for point in points if point.found["status"] == "done"]
    drawn = asked.figures(sweep.title, done, sweep.axes) if done else {}
    made = {name: figure for name, (_, figure) in drawn.items()}
    pictures = [
        Picture(name, heading, heading, partial(made.__getitem__, name), has_scale=True)
        for name, (heading, _) in drawn.items()
    ]
    judged = []
    for point in done:
        verdicts = [judge(point.found) for _, judge in asked.STATEMENTS]
        found = [f"{'holds' if holds else 'does not hold'}: {what}" for holds, what in verdicts]
        judged.append([point.label or "as given", *found])
    numbers = [v for v in asked.VARIABLES if not v.dims]
    units = [_SHOWN.get(v.unit, Unit("" if v.unit == "1" else v.unit)) for v in numbers]
    heads = ["point", *(unit.label(v.text) for v, unit in zip(numbers, units, strict=True))]
    rows = [
        [p.label or "as given", *(digits(p.found[v.name] / u.factor) for v, u in zip(numbers, units, strict=True))]
        for p in done
    ]
    cited = [[REFERENCES[key].text, what] for key, what in asked.cites(points[0].study).items()]
    statements = from_rows("The paper’s statements", ["point", *(text for text, _ in asked.STATEMENTS)], judged)
    said = [] if len(done) == len(points) else [f"{counted(len(points) - len(done), 'point')} failed."]
    return Report(
        sweep.title,
        Section("", said, pictures=pictures[:1]),
        lambda: [
            Section("Against the paper", tables=[statements]),
            *([Section("Further figures", pictures=pictures[1:])] if pictures[1:] else []),
            Section("Numbers", tables=[from_rows("Numbers at every point", heads, rows)]),
            Section("References", tables=[from_rows("References", ("reference", "for"), cited)]),
            Section("Study", widget="study"),
        ],
        study=sweep.text,
    )
