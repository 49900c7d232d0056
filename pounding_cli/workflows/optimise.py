"""`pound optimise`: what a study asks, checked; the search for the best values of keys, and its tables."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice, product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.errors import InputError, Problem
from pounding_cli.reading import shortened
from pounding_cli.results.dataset import dataset
from pounding_cli.results.flags import is_void, parted
from pounding_cli.solver.response import OUTCOMES
from pounding_cli.study import Plan, Study, expand
from pounding_cli.study.edit import with_values
from pounding_cli.study.expression import Expression, Quantity, read_expression
from pounding_cli.study.file import Problems, get, nearest, parse
from pounding_cli.study.questions import OptimiseSpec
from pounding_cli.study.vary import Factor, read_searched
from pounding_cli.variables import VARIABLES
from pounding_cli.workflows.expressions import at_points, error_of, read_all, values_of
from pounding_cli.workflows.search import Point, Search
from pounding_cli.workflows.workflow import Found, Table, Workflow, columns_of, refuse_histories, tabled

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver

OPTIMUM, DESIGN, POINTS = "optimise", "optimise_design", "optimise_points"
"""Names of the tables."""

MOST_CORNERS = 512
"""Corners of the ranges that are checked before anything is solved."""

FOUND = "found"
UNSETTLED = "the last generation was reached before its points were nearly as good"
NOTHING = "no point gave a number"
"""Outcomes."""


# What is asked


@dataclass(frozen=True, eq=False)
class Question:
    """What `pound optimise` is asked of a study.

    expression : the number that is optimised least, or most
    factors : the keys that vary
    case, analysis : that are looked at
    written : the point that the file itself stands for; None where it lies outside the ranges or a key is not written:
        a plan then has one point more, its last, for the study as it is written
    """

    study: Study
    expression: Expression
    factors: tuple[Factor, ...]
    case: str
    analysis: str
    written: Point | None

    @property
    def spec(self) -> OptimiseSpec:
        """The section of the study."""
        return self.study.model.optimise

    @property
    def sign(self) -> int:
        """1 where the least is sought, -1 where the most is: the search knows the least alone."""
        return 1 if self.spec.least is not None else -1

    @property
    def middle(self) -> Point:
        """The middle of all ranges and choices."""
        return tuple((0.5 + factor.options // 2) / (factor.options or 1) for factor in self.factors)

    def plan(self, points: Sequence[Point]) -> Plan:
        """The plan of some points; the last axis holds them, and behind them the study as it is written where no point
        stands for it.  Raises InputError: the study is not sound at one of them."""
        plan = expand(
            at_points(self.study, self.factors, np.array(points), and_written=self.written is None),
            asks=lambda _point, case, analysis, _record: (case, analysis) == (self.case, self.analysis),
        )
        return dataclasses.replace(plan, workflow="optimise", harder=True)

    def check_corners(self) -> None:
        """Raises InputError: the study is not sound with both ends of every range and every option of every choice."""
        ends = [[(n + 0.5) / each.options for n in range(each.options)] or [0.0, 1.0] for each in self.factors]
        at_points(self.study, self.factors, np.array(list(islice(product(*ends), MOST_CORNERS))))

    def text(self, point: Point) -> str:
        """The text of the study with the keys at a point; everything else stays as it is written (`with_values`)."""
        values = {factor.key: factor.value(u) for factor, u in zip(self.factors, point, strict=True)}
        return with_values(self.study.text, values, self.study.file)


def question_of(study: Study) -> Question:
    """What a study asks.

    Raises
    ------
    InputError : nothing to optimise, no key that varies, an expression that is not understood, several cases or
        analyses and none chosen
    """
    spec: OptimiseSpec = study.model.optimise
    problems, root = Problems(study.file), study.root
    key = "most" if spec.least is None and spec.most is not None else "least"
    texts = [text for text in (spec.least, spec.most) if text is not None]
    found = read_all(read_expression, study, "optimise", key, texts, problems)
    if not texts:
        hint = "write e.g. `optimise: {least: largest V_ratio in stiff}`"
        problems.at(root, ("optimise",), "`optimise:` lacks 'least' or 'most'", hint, key=True)
    factors = read_searched(root, problems) if get(root, "optimise", "over") is not None else []
    if not factors and not problems.found:
        hint = "write e.g. `over: {impact.restitution: {from: 0.3, to: 0.6}}`"
        problems.at(root, ("optimise",), "no key is given to vary", hint, key=True)
    case = _one(study, "case", "cases", spec.case, list(study.model.cases), problems)
    analysis = _one(study, "analysis", "analyses", spec.analysis, list(study.model.analyses), problems)
    refuse_histories(study, "the points of a search", problems)
    problems.check()
    given = [(factor, get(root, *factor.key.split("."))) for factor in factors]
    places = [None if value is None else factor.place(value) for factor, value in given]
    written = tuple(place for place in places if place is not None)
    is_point = len(written) == len(places)
    return Question(study, found[0], tuple(factors), case, analysis, written if is_point else None)


def _one(study: Study, what: str, many: str, wanted: str | None, names: list[str], problems: Problems) -> str:
    """The case or analysis that is looked at; what is wrong with the choice is noted."""
    if wanted is not None and wanted not in names:
        problems.at(study.root, ("optimise", what), f"{what}: no {what} '{wanted}'", nearest(wanted, names))
    elif wanted is None and len(names) > 1:
        hint = f"select one: `optimise: {{{what}: {names[0]}}}`"
        problems.at(study.root, ("optimise",), f"the study has {len(names)} {many}", hint, key=True)
    return str(wanted or names[0])


def check_written(study: Study, path: Path) -> None:
    """Make sure that the study with other values can be written to `path`: its text takes them, and its motions are
    found from there.

    Raises
    ------
    InputError : as `question_of` and `Question.text`; or the study would be another one there
    """
    question = question_of(study)
    text, first = question.text(question.middle), (0,) * len(study.axes)
    why = "its motions would be others"
    try:
        found = Study(path, text, parse(text, shortened(path)))
        one, other = ({n: used.use.digest for n, used in each.motions(first).items()} for each in (found, study))
        if one == other:
            return
    except InputError as error:
        why = error.problems[0].message
    hint = "write it beside the study: motions are sought there" if path.parent != study.path.parent else ""
    raise InputError(Problem(f"the study would not run from there: {why}", hint or "change the study", str(path)))


# The search


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

        def function(points: list[Point], is_rough: bool) -> tuple[np.ndarray, np.ndarray]:
            solved = _Solved(question, solver, points, is_rough)
            return question.sign * solved.sought[: len(points)], solved.errors[: len(points)]

        search = Search(function, [factor.options for factor in question.factors], question.spec, question.written)
        search.run()
        # what only led to the valley keeps its rough numbers
        whole, tried = _Solved(question, solver, list(search.tried), is_rough=True), list(search.tried)
        best = None if search.best is None else tried.index(search.best)
        written = len(whole.sought) - 1 if search.written is None else tried.index(search.written)
        tables = [
            tabled(OPTIMUM, _optimum(search, question, whole, written), star=question.expression.unit),
            tabled(DESIGN, _design(question, whole, {"optimum": best, "as_written": written})),
            _points(search, question, whole),
        ]
        return Found(whole.plan, whole.data, tables)


ASKED = Optimise()


class _Solved:
    """The scenes of some points; the last axis of their plan holds the points, and behind them the study as it is
    written where no point stands for it."""

    def __init__(self, question: Question, solver: Solver, points: Sequence[Point], is_rough: bool) -> None:
        self.question, self.plan = question, question.plan(points)
        self.data = dataset(self.plan, solver.responses(self.plan, rough=is_rough))
        self.one = self.data.sel(case=[question.case], analysis=[question.analysis])

    def by_point(self, values: np.ndarray) -> np.ndarray:
        """Values over all axes, the one case and the one analysis; shape (other points of the sweep, points, ...)."""
        axes = self.plan.axes
        return values.reshape(-1, len(axes[-1].values), *values.shape[len(axes) + 2 :])

    @cached_property
    def is_void(self) -> np.ndarray:
        """Whether the number means nothing at a point, because a link of a scene went where its law has no meaning."""
        void = np.vectorize(is_void, otypes=[bool])(self.one["flags"].values)
        return np.asarray(self.by_point(void.any(axis=-1)).any(axis=0))

    @cached_property
    def _sought(self) -> np.ndarray:
        """The number sought at every point of the sweep and of the search."""
        return self.by_point(values_of(self.question.expression, self.one, self.question.spec.over_motions))

    @cached_property
    def sought(self) -> np.ndarray:
        """The number sought at every point, over a sweep its mean or its worst; NaN where it has none or no meaning."""
        sign, is_mean = self.question.sign, self.question.spec.over_sweep == "mean"
        values = self._sought.mean(axis=0) if is_mean else sign * (sign * self._sought).max(axis=0)
        return np.where(self.is_void, np.nan, values)

    @property
    def errors(self) -> np.ndarray:
        """The numerical error of the number sought at every point."""
        errors = self.by_point(error_of(self.question.expression, self.one, self.question.spec.over_motions))
        if self.question.spec.over_sweep == "mean":
            return errors.mean(axis=0)
        worst = np.nan_to_num(self.question.sign * self._sought, nan=np.inf).argmax(axis=0)
        return errors[worst, np.arange(errors.shape[1])]

    def largest(self, quantity: Quantity) -> np.ndarray:
        """A quantity at every point: over the motions as the number sought is, over a sweep its mean or the largest."""
        expression = Expression(quantity.name, "", (quantity,), lambda value: value(quantity))
        values = self.by_point(values_of(expression, self.one, self.question.spec.over_motions))
        return values.mean(axis=0) if self.question.spec.over_sweep == "mean" else values.max(axis=0)


# The tables


def _optimum(search: Search, question: Question, whole: _Solved, written: int) -> pd.DataFrame:
    """A row for each key; `written` : number of the point of the study as it is written."""
    best, sign, tried = search.best, question.sign, search.tried
    void, near = int(whole.is_void[: len(tried)].sum()), list[Point]()
    first: dict[str, Any] = {
        "sought": f"{'least' if sign > 0 else 'most'} {question.expression}",
        "as_written": whole.sought[written],
        "outcome": NOTHING if best is None else FOUND if search.is_settled else UNSETTLED,
        "points": len(tried),
        "failed": int(np.isnan(whole.sought[: len(tried)]).sum()) - void,
        "meaningless": void,
    }
    if best is not None:
        tolerance, least = search.tolerance, search.value(best)
        first |= {"optimum": sign * least, "error": search.error, "tolerance": tolerance}
        near = [point for point, each in tried.items() if each.value <= least + tolerance]
    rows = []
    for number, factor in enumerate(question.factors):
        row = {**first, "key": factor.key, "unit": factor.unit.si or factor.unit.name, "spacing": factor.spacing}
        row |= {"option": "", "written_option": "", "mapped": int(number in search.mapped)}
        if best is not None:
            row |= {"place": best[number], **_value(factor, best[number], "value", "option")}
        if search.written is not None:
            row |= _value(factor, search.written[number], "written", "written_option")
        else:
            given = whole.plan.axes[-1].values[-1][number]
            row["written_option" if isinstance(given, str) else "written"] = given
        spans = {"flat": search.flat.get(number), "range": (0.0, 1.0)}
        if near:
            spans["together"] = min(point[number] for point in near), max(point[number] for point in near)
        for name, span in spans.items():
            if span is not None and not factor.options:
                row[f"{name}_from"], row[f"{name}_to"] = factor.number(np.array(span)).tolist()
        rows.append(row)
    return pd.DataFrame(rows).reindex(columns=list(columns_of(OPTIMUM)))


def _value(factor: Factor, u: float, number: str, option: str) -> dict[str, Any]:
    """A key at a point: its number under one name, or its option under another."""
    value = float(factor.number(np.array(u)))
    return {option: factor.labels[int(value)]} if factor.options else {number: value}


def _design(question: Question, whole: _Solved, at: dict[str, int | None]) -> pd.DataFrame:
    """What the buildings do at the optimum, and with the study as it is written: a row for each quantity.

    at : by the names of the columns, the numbers of these points
    """
    buildings, one = whole.plan.buildings, whole.one
    failed = ~np.isin(whole.by_point(one["status"].values), OUTCOMES)
    known, of = ~failed.any(axis=(0, 2)), failed[:, 0].size
    impacts, quantities = np.zeros(failed.shape), dict[str, Quantity]()
    for place, building in enumerate(buildings):
        for name in ("V_ratio", "mu", "drift", "acceleration"):
            quantities[f"largest {name} in {building}"] = Quantity(name, "largest", place)
    if whole.plan.links.places:
        impacts = np.nan_to_num(whole.by_point(one["impacts"].values)).sum(axis=-1)
        quantities |= {f"largest {name}": Quantity(name) for name in ("peak_force", "max_closing")}
    rows: list[tuple[str, str, int, np.ndarray]] = [
        (str(question.expression), question.expression.unit or "1", 0, whole.sought),
        ("contacts, all motions", "1", 0, np.where(known, impacts.sum(axis=(0, 2)), np.nan)),
        ("scenes with contact", "1", of, np.where(known, (impacts > 0).sum(axis=(0, 2)), np.nan)),
        ("scenes that failed", "1", of, failed.sum(axis=(0, 2))),
        *((text, VARIABLES[each.name].unit, 0, whole.largest(each)) for text, each in quantities.items()),
    ]
    flags = whole.by_point(one["flags"].values)
    shown = [number for number in at.values() if number is not None]
    for flag in dict.fromkeys(flag for cell in flags[:, shown].flat for flag, _ in parted(cell)):
        has = np.vectorize(lambda cell, flag=flag: any(flag == each for each, _ in parted(cell)), otypes=[bool])(flags)
        rows.append((f"scenes flagged: {flag}", "1", of, has.sum(axis=(0, 2))))
    frame = pd.DataFrame([row[:3] for row in rows], columns=["quantity", "unit", "of"])
    for name, number in at.items():
        frame[name] = [np.nan if number is None else float(values[number]) for *_, values in rows]
    return frame[list(columns_of(DESIGN))]


def _points(search: Search, question: Question, whole: _Solved) -> Table:
    """Every point that was tried, in the order in which the search asked for it."""
    cube, tried = np.array(list(search.tried)), list(search.tried.values())
    frame: dict[str, Any] = {"point": np.arange(1, len(cube) + 1), "stage": [each.stage for each in tried]}
    units, meant = {}, dict[str, tuple[str, str]]()
    for factor, u in zip(question.factors, cube.T, strict=True):
        values = factor.number(u)
        frame[factor.key] = [factor.labels[int(value)] for value in values] if factor.options else values
        meant[factor.key] = "" if factor.options else factor.unit.si or "1", f"varies: {factor.key}"
        if not factor.options:
            units[factor.key] = factor.unit
    frame["value"] = question.sign * np.array([each.value for each in tried])
    frame["error"] = [each.error for each in tried]
    frame["meaningless"] = whole.is_void[: len(tried)].astype(int)
    return tabled(POINTS, pd.DataFrame(frame), units=units, star=question.expression.unit, more=meant)
