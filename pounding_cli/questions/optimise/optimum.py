"""`pound optimise`: what a study asks, checked; the search for the best values of keys, and its tables."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from functools import cached_property
from itertools import islice, product
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.questions.expressions import (
    evaluate_error,
    evaluate_expression,
    key_columns,
    parse_all,
    study_at_points,
)
from pounding_cli.questions.frames import columns_of, tabled
from pounding_cli.questions.optimise.search import Point, Search, evaluate_kink
from pounding_cli.questions.optimise.spec import OptimiseSpec
from pounding_cli.questions.question import Answer, StudyQuestion
from pounding_cli.results.dataset import contents
from pounding_cli.results.flags import is_void, split_flag
from pounding_cli.solver.response import OUTCOMES
from pounding_cli.study import Plan, Study, make_plan
from pounding_cli.study.edit import with_values
from pounding_cli.study.expression import parse_expression
from pounding_cli.study.file import get, nearest
from pounding_cli.study.vary import DistributedInput, KeyInput, read_searched
from pounding_cli.tables import Table
from pounding_cli.variables import VARIABLES

if TYPE_CHECKING:
    import xarray as xr

    from pounding_cli.batch.solve import Solver

OPTIMUM, DESIGN, POINTS = "optimise", "optimise_design", "optimise_points"
"""Names of the tables."""

MAX_CORNERS = 512
"""Corners of the ranges that are checked before anything is solved."""

FLAT = 0.01
"""As good as the optimum is what lies within this share of it [-]."""

FOUND = "found"
UNSETTLED = "the last generation was reached before its points were nearly as good"
NOTHING = "no point gave a number"
"""Outcomes."""


class Optimise(StudyQuestion):
    """The values of keys at which a number is least, or most.

    Raises InputError: nothing to optimise, no key that varies, an expression that is not understood, several cases or
    analyses and none chosen.

    expression : the number that is optimised least, or most
    sign : 1 where the least is sought, -1 where the most is: the search knows the least alone
    inputs : the keys that vary
    case, analysis : that are looked at
    written : the point that the file itself stands for; None where it lies outside the ranges or a key is not written:
        a plan then has one point more, its last, for the study as it is written
    """

    name = "optimise"
    spec: OptimiseSpec
    extent = "begins with"  # every point decides about the next

    def __init__(self, study: Study) -> None:
        super().__init__(study)
        spec, problems, root = self.spec, self.problems, study.tree
        self.sign = -1 if spec.least is None and spec.most is not None else 1
        texts = [text for text in (spec.least, spec.most) if text is not None]
        key = "least" if self.sign > 0 else "most"
        expressions = parse_all(parse_expression, self, key, texts)
        if not texts:
            hint = f"write e.g. `optimise: {{least: largest V_ratio in {study.spec.group[0]}}}`"
            self.add_problem((), "`optimise:` lacks 'least' or 'most'", hint, key=True)
        self.inputs = read_searched(root, problems) if get(root, "optimise", "over") is not None else []
        if not self.inputs and not problems.found:
            hint = "write e.g. `over: {impact.restitution: {from: 0.3, to: 0.6}}`"
            self.add_problem((), "no key is given to vary", hint, key=True)
        self.case = self._one("case", "cases", spec.case, list(study.spec.cases))
        self.analysis = self._one("analysis", "analyses", spec.analysis, list(study.spec.analyses))
        self.refuse_histories("the points of a search")
        problems.check()
        self.expression = expressions[0]
        self.written = self._find_written_point()

    def _find_written_point(self) -> Point | None:
        """Return the point that the file itself stands for, if there is one."""
        point = []
        for each in self.inputs:
            value = get(self.study.tree, *each.key.split("."))
            u = None if value is None else each.quantile_of(value)
            if u is None:
                return None
            point.append(u)
        return tuple(point)

    def _one(self, what: str, many: str, wanted: str | None, names: list[str]) -> str:
        """The case or analysis that is looked at; what is wrong with the choice is noted."""
        if wanted is not None and wanted not in names:
            self.add_problem((what,), f"{what}: no {what} '{wanted}'", nearest(wanted, names))
        elif wanted is None and len(names) > 1:
            hint = f"select one: `optimise: {{{what}: {names[0]}}}`"
            self.add_problem((), f"the study has {len(names)} {many}", hint, key=True)
        return str(wanted or names[0])

    @property
    def middle(self) -> Point:
        """The middle of all ranges and choices."""
        return tuple(each.middle for each in self.inputs)

    def text(self, point: Point) -> str:
        """The text of the study with the keys at a point; everything else stays as it is written (`with_values`)."""
        values = {each.key: each.values([u])[0] for each, u in zip(self.inputs, point, strict=True)}
        return with_values(self.study.text, values, self.study.file)

    def plan_of(self, points: Sequence[Point]) -> Plan:
        """The plan of some points; the last axis holds them, and behind them the study as it is written where no point
        stands for it.  Raises InputError: the study is not sound at one of them."""
        plan = make_plan(
            study_at_points(self.study, self.inputs, np.array(points), and_written=self.written is None),
            row_filter=lambda _point, case, analysis, _record: (case, analysis) == (self.case, self.analysis),
        )
        return dataclasses.replace(plan, workflow="optimise", harder=True)

    @cached_property
    def plan(self) -> Plan:
        """The scenes of the first points: the study as it is written, or else the middle of all ranges.  Raises
        InputError: the study is not sound there, or with both ends of every range and every option of every choice."""
        corners = product(*(each.end_quantiles() for each in self.inputs))
        study_at_points(self.study, self.inputs, np.array(list(islice(corners, MAX_CORNERS))))
        return self.plan_of([self.written or self.middle])

    @property
    def expected_count(self) -> int:
        """Number of time histories of the whole search, about: that of a search for the lowest point of a kink."""
        search = Search(evaluate_kink, [each.option_count for each in self.inputs], self.spec, self.written)
        search.run()
        points = list(search.tried)[:2]
        of_one = len(self.plan_of(points[:1]))
        of_each_more = len(self.plan_of(points)) - of_one
        return of_one + of_each_more * (len(search.tried) - 1)

    def answer(self, solver: Solver) -> Answer:
        """The optimum, what the buildings do there, and all points."""

        def function(points: list[Point], is_rough: bool) -> np.ndarray:
            plan = self.plan_of(points)
            found = _sought(self, plan, contents(plan, solver.solve_plan(plan, rough=is_rough)).dataset())
            return self.sign * found["value"].to_numpy()[: len(points)]

        search = Search(function, [each.option_count for each in self.inputs], self.spec, self.written)
        search.run()
        tried = list(search.tried)
        plan = self.plan_of(tried)
        told = contents(
            plan, solver.solve_plan(plan, rough=True)
        )  # what only led to the valley keeps its rough numbers
        data = told.dataset()
        sought = _sought(self, plan, data)
        best = None if search.best is None else tried.index(search.best)
        written = len(sought) - 1 if search.written is None else tried.index(search.written)
        columns = {"optimum": best, "as_written": written}
        tables = [
            tabled(OPTIMUM, _optimum(search, self, plan, sought, columns), star=self.expression.unit),
            tabled(DESIGN, _design(self, plan, data, sought["value"], columns)),
            _points(search, self, sought[: len(tried)]),
        ]
        return Answer(plan, told, tables)


def _by_point(plan: Plan, values: np.ndarray) -> np.ndarray:
    """Values over all axes in the one case and analysis, shape (other points of the sweep, points, ...)."""
    return values.reshape(-1, len(plan.axes[-1].values), *values.shape[len(plan.axes) :])


def _sought(question: Optimise, plan: Plan, data: xr.Dataset) -> pd.DataFrame:
    """The number sought, a row for every point: over a sweep its mean or its worst (`value`, NaN where it has none or
    no meaning), its numerical error, and whether a link of a scene went where its law has no meaning."""
    spec, one = question.spec, data.sel(case=question.case, analysis=question.analysis)
    values, errors = (
        _by_point(plan, each(question.expression, one, spec.over_motions))
        for each in (evaluate_expression, evaluate_error)
    )
    void = np.vectorize(is_void, otypes=[bool])(_by_point(plan, one["flags"].values)).any(axis=(0, 2))
    if spec.over_sweep == "mean":
        value, error = values.mean(axis=0), errors.mean(axis=0)
    else:
        worst = np.nan_to_num(question.sign * values, nan=np.inf).argmax(axis=0), np.arange(values.shape[1])
        value, error = values[worst], errors[worst]
    return pd.DataFrame({"value": np.where(void, np.nan, value), "error": error, "meaningless": void})


# The tables


def _optimum(
    search: Search, question: Optimise, plan: Plan, sought: pd.DataFrame, at: dict[str, int | None]
) -> pd.DataFrame:
    """A row for each key.

    sought : `_sought`
    at : numbers of the best point and of the study as it is written
    """
    cube, best = np.array(list(search.tried)), at["optimum"]
    tried, value = sought[: len(cube)], sought["value"].to_numpy()
    first: dict[str, Any] = {
        "sought": f"{'least' if question.sign > 0 else 'most'} {question.expression}",
        "as_written": value[at["as_written"]],
        "outcome": NOTHING if best is None else FOUND if search.is_converged else UNSETTLED,
        "points": len(tried),
        "failed": int((tried["value"].isna() & ~tried["meaningless"]).sum()),
        "meaningless": int(tried["meaningless"].sum()),
    }
    near = np.zeros(0, bool)
    if best is not None:
        above, share = question.sign * (tried["value"] - value[best]), FLAT * abs(value[best])
        known = sought["error"][best]  # where it is not known, the largest known among points as good
        error = tried["error"][above <= share].max() if np.isnan(known) else known
        tolerance = np.fmax(error, share)
        near = (above <= tolerance).to_numpy()
        first |= {"optimum": value[best], "error": error, "tolerance": tolerance}
    rows = []
    for number, each in enumerate(question.inputs):
        row = {**first, "key": each.key, "unit": each.unit.si or each.unit.name, "spacing": ""}
        row |= {"option": "", "written_option": ""}
        if best is not None:
            best_u = cube[best, number]
            best_value = _table_value(each, best_u)
            row |= {"place": best_u, "option" if isinstance(best_value, str) else "value": best_value}
        if search.written is not None:
            written = _table_value(each, search.written[number])
        else:
            written = plan.axes[-1].values[-1][number]
        row["written_option" if isinstance(written, str) else "written"] = written
        if isinstance(each, DistributedInput):
            row["spacing"] = each.distribution.spacing
            row["range_from"], row["range_to"] = each.to_column(np.array([0.0, 1.0])).tolist()
            if best is not None:
                good = cube[near, number]
                row["good_from"], row["good_to"] = each.to_column(np.array([good.min(), good.max()])).tolist()
        rows.append(row)
    return pd.DataFrame(rows).reindex(columns=list(columns_of(OPTIMUM)))


def _table_value(key_input: KeyInput, u: float) -> float | str:
    """Return the value of a key as a table has it: an SI number, or the text of its option."""
    value = key_input.to_column(np.array([u]))[0]
    return value if isinstance(value, str) else float(value)


def _design(
    question: Optimise, plan: Plan, data: xr.Dataset, sought: pd.Series, at: dict[str, int | None]
) -> pd.DataFrame:
    """What the buildings do at the optimum, and with the study as it is written: a row for each quantity, that sought
    first; the others are the largest over all motions, points of the sweep, storeys, floors or links.

    sought : the number sought at every point
    at : by the names of the columns, the numbers of these points
    """
    one = data.sel(case=question.case, analysis=question.analysis)
    failed = ~np.isin(_by_point(plan, one["status"].values), OUTCOMES)
    known = ~failed.any(axis=(0, 2))
    scenes = failed[:, 0].size
    impacts = np.zeros(failed.shape)
    if plan.links.places:
        impacts = np.nan_to_num(_by_point(plan, one["impacts"].values)).sum(axis=-1)
    rows: list[tuple[str, str, int, np.ndarray]] = [
        (str(question.expression), question.expression.unit or "1", 0, sought.to_numpy()),
        ("contacts, all motions", "1", 0, np.where(known, impacts.sum(axis=(0, 2)), np.nan)),
        ("scenes with contact", "1", scenes, np.where(known, (impacts > 0).sum(axis=(0, 2)), np.nan)),
        ("scenes that failed", "1", scenes, failed.sum(axis=(0, 2))),
    ]
    for text, (name, values) in _demands(question, plan, one).items():
        largest = np.fmax.reduce(values, axis=(0, *range(2, values.ndim)))
        rows.append((text, VARIABLES[name].unit, 0, np.where(known, largest, np.nan)))
    flags = _by_point(plan, one["flags"].values)
    shown = [number for number in at.values() if number is not None]
    kinds = dict.fromkeys(split_flag(line)[0] for cell in flags[:, shown].flat for line in cell.splitlines())
    for kind in kinds:
        is_flagged = np.array([[_has_flag(cells, kind) for cells in by_point] for by_point in flags])
        rows.append((f"scenes flagged: {kind}", "1", scenes, is_flagged.sum(axis=(0, 2))))
    frame = pd.DataFrame([row[:3] for row in rows], columns=["quantity", "unit", "of"])
    frame["over_motions"] = [""] * len(frame)
    if len(plan.records) > 1:
        frame.loc[0, "over_motions"] = question.spec.over_motions
    for name, number in at.items():
        frame[name] = [np.nan if number is None else float(values[number]) for *_, values in rows]
    return frame[list(columns_of(DESIGN))]


def _demands(question: Optimise, plan: Plan, one: xr.Dataset) -> dict[str, tuple[str, np.ndarray]]:
    """Return by the words of the table a variable and its values in one building or in all links; NaN where there is
    none.  Shape (other points of the sweep, points, motions, ...).

    one : the variables in the case and analysis looked at
    """
    found = dict[str, tuple[str, np.ndarray]]()
    places = plan.links.places
    for place, building in enumerate(plan.buildings):
        if question.is_wall(place):
            continue
        for name in ("V_ratio", "mu", "drift", "acceleration"):
            found[f"largest {name} in {building}"] = name, _by_point(plan, one[name].values)[..., place, :]
        struck = [each.is_on_columns and each.struck_storey[0] == place for each in places]
        if any(struck):
            is_blow = _by_point(plan, one["impacts"].values) > 0  # of columns that no slab struck nothing is said
            demand = np.where(is_blow, _by_point(plan, one["shear_demand"].values), np.nan)
            found[f"largest shear_demand in {building}"] = "shear_demand", demand[..., np.flatnonzero(struck)]
    if places:
        for name in ("peak_force", "max_closing"):
            found[f"largest {name}"] = name, _by_point(plan, one[name].values)
    return found


def _has_flag(cells: np.ndarray, kind: str) -> list[bool]:
    """Return of every scene whether it carries a flag of a kind; `cells` : the flags of scenes, one a line."""
    return [any(split_flag(line)[0] == kind for line in cell.splitlines()) for cell in cells]


def _points(search: Search, question: Optimise, sought: pd.DataFrame) -> Table:
    """Every point that was tried, in the order in which the search asked for it."""
    keys, meant, units = key_columns(question.inputs, np.array(list(search.tried)))
    keys.insert(0, "point", range(1, len(keys) + 1))
    keys.insert(1, "stage", search.stages)
    found = keys.join(sought.astype({"meaningless": int}))
    return tabled(POINTS, found, units=units, star=question.expression.unit, more=meant)
