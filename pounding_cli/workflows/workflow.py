"""What every question is made of, how its tables are declared, and the first one: `pound run`."""

from __future__ import annotations

import csv
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from pounding_cli.model.wall import Wall
from pounding_cli.numbers import Unit
from pounding_cli.results.tables import ANSWERS, Column, Table
from pounding_cli.study.file import Problems
from pounding_cli.study.issues import KeyPath
from pounding_cli.variables import COORDINATE_VARIABLES

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.batch.solve import Solver
    from pounding_cli.results.group import Group
    from pounding_cli.study import Plan, Study
    from pounding_cli.study.axes import Axis

COLUMNS = Path(__file__).with_name("columns.csv")
"""Unit and meaning of the columns of answers; a table takes what it lacks there from the first table of its question.
The unit is SI, "1" of a pure number, empty of a text; `*` is one that the study decides."""

OF_MOVING_WALLS = (
    *("V", "V0", "V_ratio", "drift", "drift0", "drift_ratio", "residual_drift"),
    *("acceleration", "acceleration0", "acceleration_ratio"),
    *("displacement", "displacement_max", "displacement_min"),
)
"""What a wall on the soil has values of."""

_ENDS = {
    "_low": "lower end of the confidence interval: ",
    "_high": "upper end of the confidence interval: ",
    "_error": "standard error: ",
    "0": "buildings alone: ",
}
"""Ends of names of columns, and what they mean of the column without."""


@dataclass(frozen=True, eq=False)
class Found:
    """What a question came to.

    plan : of all scenes that tables are about
    contents : what these did, as the results file has it
    tables : the answer
    """

    plan: Plan
    contents: Group
    tables: list[Table]


class Workflow(ABC):
    """A question asked of a study.  Raises InputError where the study asks what cannot be answered.

    name : its command, and its section of a study file
    extent : whether it `has` the scenes of its plan, `has at most` these, or `begins with` them
    spec : the section
    problems : what is wrong with it
    """

    name: ClassVar[str]
    extent = "has"
    spec: Any

    def __init__(self, study: Study) -> None:
        self.study, self.problems = study, Problems(study.file)
        self.spec = getattr(study.spec, self.name, None)

    def wrong(self, path: KeyPath, message: str, hint: str, key: bool = False) -> None:
        """Note what is wrong at a place of the section, or with the key of that place."""
        self.problems.at(self.study.tree, (self.name, *path), message, hint, key)

    def is_wall(self, place: int) -> bool:
        """Return whether a wall stands at a place of the group, from 0."""
        return isinstance(self.study.building((0,) * len(self.study.axes), place), Wall)

    def lacks(self, place: int, quantity: str) -> bool:
        """Return whether a wall stands at a place of the group that has no values of a quantity: one that moves as the
        ground does has none at all, one on the soil behind it does not yield."""
        wall = self.study.building((0,) * len(self.study.axes), place)
        return isinstance(wall, Wall) and not (wall.moves and quantity in OF_MOVING_WALLS)

    def refuse_histories(self, of: str) -> None:
        """Note that histories are asked for of scenes that nobody knows beforehand."""
        if self.study.spec.keep is not None:
            hint = "remove `keep:`; `pound run` keeps those of chosen points"
            self.problems.at(self.study.tree, ("keep",), f"histories cannot be kept of {of}", hint, key=True)

    @property
    @abstractmethod
    def plan(self) -> Plan:
        """The scenes that may be wanted, as far as is known before anything is solved.  Raises InputError."""

    @property
    def expected_count(self) -> int:
        """Number of different time histories of the whole question; about so many where their number depends on
        results. Nothing is solved for it."""
        return len(self.plan)

    @abstractmethod
    def run(self, solver: Solver) -> Found:
        """The answer.  After an interruption it is asked again, and what was solved comes from the cache.

        Raises
        ------
        InputError : the study is not sound where the question takes it; the cache cannot be written
        """


class Run(Workflow):
    """`pound run`: every scene of a study, and no table beyond those that every file has."""

    name = "run"

    @cached_property
    def plan(self) -> Plan:
        """All scenes."""
        from pounding_cli.study import make_plan

        return make_plan(self.study)

    def run(self, solver: Solver) -> Found:
        """What all scenes did."""
        return Found(self.plan, solver.solve_dataset(self.plan), [])


def swept(axes: Sequence[Axis], points: Sequence[Sequence[int]], **more: Sequence[Any]) -> pd.DataFrame:
    """The swept values at some points, a row a point and a column a key.

    points : of every row its index on every axis
    more : further columns that say where something stands
    """
    import pandas as pd

    columns = {
        name: [axis.values[point[number]][key] for point in points]
        for number, axis in enumerate(axes)
        for key, name in enumerate(axis.names)
    }
    return pd.DataFrame(columns | more, index=range(len(points)))


@cache
def columns_of(table: str) -> dict[str, tuple[str, str]]:
    """Unit and meaning of every column of a table that COLUMNS has, in its order."""
    with COLUMNS.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {row["column"]: (row["unit"], row["meaning"]) for row in rows if row["table"] == table}


def tabled(
    name: str,
    frame: pd.DataFrame,
    axes: Sequence[Axis] = (),
    units: Mapping[str, Unit] | None = None,
    star: str = "",
    more: Mapping[str, tuple[str, str]] | None = None,
) -> Table:
    """A table of an answer.

    axes : of the sweep
    units : units that people read some columns in, with those of swept keys
    star : SI unit of the columns that have `*` in COLUMNS, "" for a pure number
    more : unit and meaning of columns that COLUMNS does not have
    """
    shown = {key: axis.units[number] for axis in axes for number, key in enumerate(axis.names)} | dict(units or {})
    swept_keys, found = {key for axis in axes for key in axis.names}, {}
    first = next(tables[0] for tables in ANSWERS.values() if name in tables)
    known = COORDINATE_VARIABLES | columns_of(first) | columns_of(name) | dict(more or {})
    for key in map(str, frame.columns):
        if key in swept_keys:
            si, text = "" if frame[key].dtype == object else shown[key].si, f"swept: {key}"
        else:
            si, text = _meant(key, known)
            si = star or "1" if si == "*" else si
        unit = shown.get(key, Unit("" if si == "1" else si))
        found[key] = Column(text, replace(unit, si=si), key)
    return Table(name, frame, found, name.replace("_", " ").capitalize())


def _meant(column: str, known: Mapping[str, tuple[str, str]]) -> tuple[str, str]:
    if column in known:
        return known[column]
    end = next(end for end in _ENDS if column.endswith(end))
    unit, text = _meant(column.removesuffix(end), known)
    return unit, _ENDS[end] + text
