"""`pound optimise`: the search for the best values of keys, and its tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import xarray as xr

from pounding_cli.results.dataset import dataset
from pounding_cli.results.flags import counts_of_flags, parted
from pounding_cli.solver.response import OUTCOMES
from pounding_cli.study import Plan, Study
from pounding_cli.study.expression import Expression, Quantity
from pounding_cli.study.vary import Factor
from pounding_cli.variables import VARIABLES
from pounding_cli.workflows.expressions import error_of, getter, values_of
from pounding_cli.workflows.optimise_question import Point, Question, question_of
from pounding_cli.workflows.search import Search
from pounding_cli.workflows.workflow import Columns, Found, Table, Workflow, tabled

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver

OPTIMUM, DESIGN, POINTS = "optimise", "optimise_design", "optimise_points"
"""Names of the tables."""

MOST_BUILDINGS = 4
"""Buildings whose numbers stand beside each other; of more, the largest of all is told."""

FOUND = "found"
UNSETTLED = "the last generation was reached before its points were nearly as good"
NOTHING = "no point gave a number"
"""Outcomes."""

_SOUGHT = "unit of the number sought"
_FLAT = "of what stays within the tolerance"
_OPTIMUM: Columns = {
    "sought": ("", "number that is optimised"),
    "optimum": (_SOUGHT, "its best value"),
    "error": (_SOUGHT, "numerical error of that, at most"),
    "tolerance": (_SOUGHT, "its error, or 1 % of it"),
    "as_written": (_SOUGHT, "value of the file as written"),
    "outcome": ("", "outcome, or why there is no answer"),
    "points": ("1", "points that were tried"),
    "failed": ("1", "points without a number"),
    "meaningless": ("1", "points whose number has no meaning"),
    "key": ("", "key that varies"),
    "unit": ("", "its unit"),
    "value": ("", "of the key at the optimum; NaN of a choice"),
    "place": ("1", "of the optimum in what was searched, 0 to 1"),
    "option": ("", "chosen at the optimum; empty of a number"),
    "flat_from": ("", f"lower end {_FLAT}, of a key by itself, the others at the optimum"),
    "flat_to": ("", f"upper end {_FLAT}, of a key by itself, the others at the optimum"),
    "together_from": ("", f"lower end {_FLAT}, among all points that were tried"),
    "together_to": ("", f"upper end {_FLAT}, among all points that were tried"),
    "range_from": ("", "lower end of what was searched"),
    "range_to": ("", "upper end of what was searched"),
    "spacing": ("", "linear or log; empty of a choice"),
    "written": ("", "of the key as written"),
    "written_option": ("", "option as written"),
    "mapped": ("1", "1 of a key of the map"),
}
_DESIGN: Columns = {
    "quantity": ("", "what is compared; largest over the storeys"),
    "unit": ("", "its unit"),
    "optimum": ("", "at the optimum"),
    "as_written": ("", "with the study as it is written"),
    "of": ("1", "scenes, where scenes are counted; otherwise 0"),
}
_POINTS: Columns = {
    "point": ("1", "number of the point"),
    "stage": ("", "what it was tried for"),
    "value": (_SOUGHT, "of the number sought; NaN where it has none or no meaning"),
    "error": (_SOUGHT, "numerical error of that, at most"),
    "meaningless": ("1", "1 where a link left the range in which its law has a meaning"),
}


class Optimise(Workflow):
    """The values of keys at which a number is least, or most."""

    name = "optimise"

    def check(self, study: Study) -> Question:
        """What a study asks.  Raises InputError, see `question_of`."""
        return question_of(study)

    def plan(self, study: Study) -> Plan:
        """The scenes of the first points: the study as it is written, or else the middle of all ranges."""
        question = question_of(study)
        question.check_corners()
        return question.plan([question.written or question.middle])

    def goes_on(self, study: Study) -> bool:
        """Every point decides about the next."""
        return True

    def run(self, study: Study, solver: Solver) -> Found:
        """The optimum, what the buildings do there, and all points."""
        question = question_of(study)
        question.check_corners()
        void: set[Point] = set()

        def function(points: list[Point], is_rough: bool) -> tuple[np.ndarray, np.ndarray]:
            solved = _Solved(question, solver, points, is_rough)
            void.update(point for point, is_void in zip(points, solved.void, strict=False) if is_void)
            values = np.where(solved.void, np.nan, question.sign * solved.values())
            return values[: len(points)], solved.errors()[: len(points)]

        search = Search(function, [factor.options for factor in question.factors], question.spec, question.written)
        search.run()
        # what only led to the valley keeps its rough numbers
        whole = _Solved(question, solver, list(search.tried), is_rough=True)
        tables = [
            _optimum(search, question, whole, void),
            _design(search, question, whole),
            _points(search, question, void),
        ]
        return Found(whole.plan, whole.data, tables)


ASKED = Optimise()


class _Solved:
    """The scenes of some points; the last axis of their plan holds the points, and behind them the study as it is
    written where no point stands for it."""

    def __init__(self, question: Question, solver: Solver, points: Sequence[Point], is_rough: bool) -> None:
        self.question, self.plan = question, question.plan(points)
        self.data: xr.Dataset = dataset(self.plan, solver.responses(self.plan, rough=is_rough))
        self.get = getter(self.plan, self.data)
        self.count = len(self.plan.axes[-1].values)

    def here(self, values: np.ndarray) -> np.ndarray:
        """What belongs to the case and the analysis, shape (other points of the sweep, points, ...)."""
        axes, plan = len(self.plan.axes), self.plan
        place = plan.cases.index(self.question.case), plan.analyses.index(self.question.analysis)
        moved = np.moveaxis(values, (axes, axes + 1), (0, 1))[place]
        return moved.reshape(-1, self.count, *moved.shape[axes:])

    @property
    def void(self) -> np.ndarray:
        """Whether the number means nothing at a point, because a link of a scene went where its law has no meaning."""
        meaningless = counts_of_flags(self.data["flags"].values)["records_meaningless"]
        return np.asarray((self.here(meaningless) > 0).any(axis=0))

    def values(self, quantity: Quantity | None = None) -> np.ndarray:
        """The number sought, or a quantity, at every point: over the motions as the number sought is, over a sweep its
        mean or its worst, of a quantity the largest; NaN where one is."""
        question, expression = self.question, self.question.expression
        if quantity is not None:
            expression = Expression(quantity.name, "", (quantity,), lambda value: value(quantity))
        values = self.here(values_of(expression, self.get, question.spec.over_motions))
        if question.spec.over_sweep == "mean":
            return values.mean(axis=0)
        return values.min(axis=0) if quantity is None and question.sign < 0 else values.max(axis=0)

    def errors(self) -> np.ndarray:
        """The numerical error of the number sought at every point."""
        question = self.question
        errors = self.here(error_of(question.expression, self.get, question.spec.over_motions))
        if question.spec.over_sweep == "mean":
            return errors.mean(axis=0)
        values = question.sign * self.here(values_of(question.expression, self.get, question.spec.over_motions))
        worst = np.where(np.isnan(values), np.inf, values).argmax(axis=0)
        return errors[worst, np.arange(self.count)]


def _optimum(search: Search, question: Question, whole: _Solved, void: set[Point]) -> Table:
    """A row for each key."""
    best, sign, factors = search.best, question.sign, question.factors
    values = np.array([each.value for each in search.tried.values()])
    if search.written is not None:
        as_written = sign * search.tried[search.written].value
        written = _values(factors, search.written)
    else:
        as_written = np.nan if whole.void[-1] else float(whole.values()[-1])
        given = whole.plan.axes[-1].values[-1]
        written = [(np.nan, value) if isinstance(value, str) else (value, "") for value in given]
    at_best = _values(factors, best)
    frame = pd.DataFrame(
        {
            "sought": f"{'least' if sign > 0 else 'most'} {question.expression}",
            "optimum": np.nan if best is None else sign * search.value(best),
            "error": np.nan if best is None else search.error,
            "tolerance": np.nan if best is None else search.tolerance,
            "as_written": as_written,
            "outcome": NOTHING if best is None else FOUND if search.is_settled else UNSETTLED,
            "points": values.size,
            "failed": int(np.isnan(values).sum()) - len(void),
            "meaningless": len(void),
            "key": [factor.key for factor in factors],
            "unit": [factor.unit.si or factor.unit.name for factor in factors],
            "value": [number for number, _ in at_best],
            "place": np.nan if best is None else list(best),
            "option": [text for _, text in at_best],
        }
    )
    spans = {
        "flat": search.flat,
        "together": _together(search),
        "range": {number: (0.0, 1.0) for number in search.continuous},
    }
    for name, span in spans.items():
        nothing = np.array([np.nan, np.nan])
        ends = [factor.number(np.array(span[n])) if n in span else nothing for n, factor in enumerate(factors)]
        frame[f"{name}_from"], frame[f"{name}_to"] = np.array(ends, float).T
    frame["spacing"] = [factor.spacing for factor in factors]
    frame["written"], frame["written_option"] = [number for number, _ in written], [text for _, text in written]
    frame["mapped"] = [int(row in search.mapped) for row in range(len(factors))]
    return tabled(OPTIMUM, frame, _in(_OPTIMUM, question))


def _in(columns: Columns, question: Question) -> Columns:
    """The columns with the unit of the number sought."""
    unit = question.expression.unit or "1"
    return {name: (unit if si == _SOUGHT else si, text) for name, (si, text) in columns.items()}


def _together(search: Search) -> dict[int, tuple[float, float]]:
    """Between which ends a key may lie so that some point that was tried is within the tolerance."""
    if search.best is None:
        return {}
    bound = search.value(search.best) + search.tolerance
    inside = np.array([point for point, each in search.tried.items() if each.value <= bound])
    return {number: (inside[:, number].min(), inside[:, number].max()) for number in search.continuous}


def _values(factors: Sequence[Factor], point: Point | None) -> list[tuple[float, str]]:
    """The keys at a point: of each its number, or its option."""
    if point is None:
        return [(np.nan, "")] * len(factors)
    numbers = [float(factor.number(np.array(u))) for factor, u in zip(factors, point, strict=True)]
    return [
        (np.nan, factor.labels[int(number)]) if factor.options else (number, "")
        for factor, number in zip(factors, numbers, strict=True)
    ]


def _design(search: Search, question: Question, whole: _Solved) -> Table:
    """What the buildings do at the optimum, and with the study as it is written: a row for each quantity."""
    plan, points = whole.plan, list(search.tried)
    best = None if search.best is None else points.index(search.best)
    shown = best, whole.count - 1 if search.written is None else points.index(search.written)
    has_links = bool(plan.links.places)
    failed = ~np.isin(whole.here(whole.data["status"].values), OUTCOMES)
    known, of = ~failed.any(axis=(0, 2)), failed[:, 0].size
    impacts = np.zeros(failed.shape)
    if has_links:
        impacts = np.maximum(whole.here(whole.data["impacts"].values), 0).sum(axis=-1)
    rows: list[tuple[str, str, int, np.ndarray]] = [
        (str(question.expression), question.expression.unit or "1", 0, whole.values()),
        ("contacts, all motions", "1", 0, np.where(known, impacts.sum(axis=(0, 2)), np.nan)),
        ("scenes with contact", "1", of, np.where(known, (impacts > 0).sum(axis=(0, 2)), np.nan)),
        ("scenes that failed", "1", of, failed.sum(axis=(0, 2))),
    ]
    names = list(enumerate(plan.buildings)) if len(plan.buildings) <= MOST_BUILDINGS else [(None, "")]
    quantities = [
        (f"largest {name}" + f" in {building}" * bool(building), Quantity(name, "largest", place))
        for place, building in names
        for name in ("V_ratio", "mu", "drift", "acceleration")
    ]
    quantities += [(f"largest {name}", Quantity(name)) for name in ("peak_force", "max_closing") if has_links]
    rows += [(text, VARIABLES[each.name].unit, 0, whole.values(each)) for text, each in quantities]
    flags = whole.here(whole.data["flags"].values)
    said = [flag for at in shown if at is not None for cell in flags[:, at].flat for flag, _ in parted(cell)]
    for flag in dict.fromkeys(said):
        has = np.vectorize(lambda cell, flag=flag: any(flag == each for each, _ in parted(cell)), otypes=[bool])(flags)
        rows.append((f"scenes flagged: {flag}", "1", of, has.sum(axis=(0, 2))))
    frame = pd.DataFrame({
        "quantity": [text for text, *_ in rows],
        "unit": [unit for _, unit, *_ in rows],
        **{name: [np.nan if at is None else float(values[at]) for *_, values in rows]
           for name, at in zip(("optimum", "as_written"), shown, strict=True)},
        "of": [count for *_, count, _ in rows],
    })  # fmt: skip
    return tabled(DESIGN, frame, _DESIGN)


def _points(search: Search, question: Question, void: set[Point]) -> Table:
    """Every point that was tried, in the order in which the search asked for it."""
    cube, tried = np.array(list(search.tried)), list(search.tried.values())
    columns: dict[str, Any] = {"point": np.arange(1, len(cube) + 1), "stage": [each.stage for each in tried]}
    for number, factor in enumerate(question.factors):
        values = factor.number(cube[:, number])
        columns[factor.key] = [factor.labels[int(value)] for value in values] if factor.options else values
    columns["value"] = question.sign * np.array([each.value for each in tried])
    columns["error"] = [each.error for each in tried]
    columns["meaningless"] = [int(point in void) for point in search.tried]
    numbers = [factor for factor in question.factors if not factor.options]
    meant = {factor.key: ("", f"varies: {factor.key}") for factor in question.factors}
    meant |= {factor.key: (factor.unit.si or "1", f"varies: {factor.key}") for factor in numbers}
    shown = {factor.key: factor.unit for factor in numbers}
    return tabled(POINTS, pd.DataFrame(columns), {**meant, **_in(_POINTS, question)}, units=shown)
