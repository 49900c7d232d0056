"""`pound optimise`: the question, the search for the best values of keys, and the tables of its answer."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import islice, product
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.notes import NOTES
from pounding_cli.numbers import Unit
from pounding_cli.questions.chosen_points import build_key_frame, study_at_points
from pounding_cli.questions.expression_words import depends_on_contact, find_struck_buildings
from pounding_cli.questions.expressions import (
    Values,
    collect_values,
    compare_values,
    evaluate_error,
    evaluate_expression,
    find_scope,
    parse_all,
)
from pounding_cli.questions.frames import FOUND
from pounding_cli.questions.optimise.search import UNMET, Search, SearchPoint, evaluate_kink
from pounding_cli.questions.optimise.spec import OptimiseSpec
from pounding_cli.questions.optimise.tables import (
    DESIGN,
    DESIGN_COLUMNS,
    OPTIMUM,
    OPTIMUM_COLUMNS,
    SEARCHED_POINT_COLUMNS,
    SEARCHED_POINTS,
)
from pounding_cli.questions.question import Answer, StudyQuestion
from pounding_cli.results.arrays import ResultArrays
from pounding_cli.results.dataset import build_arrays
from pounding_cli.results.flags import is_void
from pounding_cli.solver.response import OUTCOMES
from pounding_cli.study import Plan, Study, make_plan
from pounding_cli.study.expressions.comparison import Comparison, parse_comparison
from pounding_cli.study.expressions.expression import parse_expression
from pounding_cli.study.text.edit import with_values
from pounding_cli.study.text.file import get, nearest
from pounding_cli.study.vary.inputs import DistributedInput, KeyInput
from pounding_cli.study.vary.uncertain import read_searched
from pounding_cli.tables import Table, build_table
from pounding_cli.variables import SCENE_DIMS, VARIABLES

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver

MAX_SEARCHED_CORNERS = 512
"""Corners of the ranges that are checked before anything is solved."""

FLAT = 0.01
"""As good as the optimum is what lies within this share of it [-]."""

UNSETTLED = "the last generation was reached before its points were nearly as good"
NO_VALUE = "no point has a value"
NOT_MET = "no point meets what is required"
"""Outcomes beside FOUND."""

NO_OPTIMUM = (NO_VALUE, NOT_MET)
"""Outcomes without an optimum."""

CONTACTS = "contacts, all motions"
WITH_CONTACT = "time histories with contact"
FAILED = "time histories that failed"
FLAGGED = "time histories flagged: "
"""Rows of the design that count; the last one begins so."""


_OF_SCENES = frozenset((*SCENE_DIMS, "building", "storey", "floor", "line", "link"))


class Optimise(StudyQuestion):
    """The question at which values of keys a number is least, or most.

    Raises InputError: nothing to optimise, no key that varies, an expression that is not understood, several cases or
    analyses and none chosen.

    expression : the number that is optimised
    required : statements that must hold at the optimum, under every motion
    sign : 1 where the least is sought, -1 where the most is: the search only minimises
    inputs : the keys that vary
    case, analysis : the rows that the number is taken from
    written_point : the point that the study stands for as written; None where it lies outside the ranges or a key is
        not written: a plan then has one point more, its last, for the study as it is written
    """

    name = "optimise"
    spec: OptimiseSpec
    extent = "begins with"  # every point decides about the next

    def __init__(self, study: Study) -> None:
        super().__init__(study)
        spec = self.spec
        problems = self.problems
        root = study.tree
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
        self.required: tuple[Comparison, ...] = parse_all(parse_comparison, self, "require", spec.require)
        self.case = self._choose("case", "cases", spec.case, list(study.spec.cases))
        self.analysis = self._choose("analysis", "analyses", spec.analysis, list(study.spec.analyses))
        self.refuse_histories("the points of a search")
        problems.check()
        self.expression = expressions[0]
        self.written_point = self._find_written_point()

    def _find_written_point(self) -> SearchPoint | None:
        """Return the point that the study stands for as written, if there is one."""
        point = []
        for each in self.inputs:
            value = get(self.study.tree, *each.key.split("."))
            u = None if value is None else each.quantile_of(value)
            if u is None:
                return None
            point.append(u)
        return tuple(point)

    def _choose(self, kind: str, kinds: str, name: str | None, names: list[str]) -> str:
        """Return the case or analysis that the number is taken from.  Note what is wrong with the choice.

        kind, kinds : "case" or "analysis", and its plural
        name : as the study writes it
        """
        if name is not None and name not in names:
            self.add_problem((kind,), f"{kind}: no {kind} '{name}'", nearest(name, names))
        elif name is None and len(names) > 1:
            hint = f"select one: `optimise: {{{kind}: {names[0]}}}`"
            self.add_problem((), f"the study has {len(names)} {kinds}", hint, key=True)
        return str(name or names[0])

    @property
    def middle(self) -> SearchPoint:
        """The middle of all ranges and choices."""
        return tuple(each.middle for each in self.inputs)

    def format_study(self, point: SearchPoint) -> str:
        """Return the text of the study with the keys at a point; everything else stays as written (`with_values`)."""
        values = {tuple(each.key.split(".")): each.values([u])[0] for each, u in zip(self.inputs, point, strict=True)}
        return with_values(self.study.text, values, self.study.file)

    def plan_points(self, points: Sequence[SearchPoint]) -> Plan:
        """Return the plan of some points, which stand on its last axis.

        Behind them stands the study as it is written, where no point stands for it.

        Raises InputError: the study is not sound at one of them.
        """
        plan = make_plan(
            study_at_points(self.study, self.inputs, np.array(points), and_written=self.written_point is None),
            row_filter=lambda _point, case, analysis, _record: (case, analysis) == (self.case, self.analysis),
        )
        return dataclasses.replace(plan, harder=True)

    @cached_property
    def plan(self) -> Plan:
        """The time histories of the first points: the study as it is written, or else the middle of all ranges.

        Raises InputError: the study is not sound there, at an end of a range, or with an option of a choice.
        """
        corners = product(*(each.end_quantiles() for each in self.inputs))
        study_at_points(self.study, self.inputs, np.array(list(islice(corners, MAX_SEARCHED_CORNERS))))
        return self.plan_points([self.written_point or self.middle])

    @property
    def expected_count(self) -> int:
        """Number of time histories of the whole search, about: that of a search for the lowest point of a kink."""
        search = Search(evaluate_kink, [each.option_count for each in self.inputs], self.spec, self.written_point)
        search.run()
        points = list(search.values)
        of_first = len(self.plan_points(points[:1]))
        of_further = len(self.plan_points(points[:2])) - of_first
        return of_first + of_further * (len(points) - 1)

    def answer(self, solver: Solver) -> Answer:
        """Return the optimum, what the buildings do there, and all points."""

        def function(points: list[SearchPoint], is_rough: bool) -> np.ndarray:
            plan = self.plan_points(points)
            arrays = build_arrays(plan, solver.solve_plan(plan, rough=is_rough))
            sought = _evaluate_sought(self, plan, _find_values(self, plan, arrays))
            score = np.where(sought["excess"] > 0, UNMET * (1 + sought["excess"]), self.sign * sought["value"])
            return np.asarray(score)[: len(points)]

        search = Search(function, [each.option_count for each in self.inputs], self.spec, self.written_point)
        search.run()
        points = list(search.values)
        plan = self.plan_points(points)
        solved = solver.solve_plan(plan, rough=True)  # what only led to the valley keeps its rough numbers
        arrays = build_arrays(plan, solved)
        values = _find_values(self, plan, arrays)
        sought = _evaluate_sought(self, plan, values)
        best = None if search.best_point is None else points.index(search.best_point)
        if search.best_point is not None and search.values[search.best_point] >= UNMET:
            best = None  # it meets less than what is required
        written = len(sought) - 1 if search.written_point is None else points.index(search.written_point)
        places = {"optimum": best, "as_written": written}
        unit = _unit_of(self.expression.unit)
        units = dict.fromkeys(("optimum", "error", "tolerance", "as_written"), unit)
        tables = [
            build_table(OPTIMUM, _build_optimum_frame(search, self, plan, sought, places), OPTIMUM_COLUMNS, units),
            build_table(DESIGN, _build_design_frame(self, plan, arrays, values, sought, places), DESIGN_COLUMNS),
            _build_point_table(search, self, sought[: len(points)], unit),
        ]
        return Answer(plan, arrays, tables)


def _unit_of(si: str) -> Unit:
    """Return an SI unit; "" of a pure number."""
    return Unit(si, 1.0, si or "1")


def _find_values(question: Optimise, plan: Plan, arrays: ResultArrays) -> Values:
    """Return the variables in the one case and analysis, shape (other points of the sweep, points, ...)."""
    axes = tuple(axis.names[0] for axis in plan.axes)
    place = {"case": plan.cases.index(question.case), "analysis": plan.analyses.index(question.analysis)}
    sizes = [len(axis) for axis in plan.axes]
    names = [name for name, array in arrays.data.items() if {*array.dims} <= _OF_SCENES.union(axes)]
    values = {}
    for name, array in collect_values(arrays, axes, names).items():
        for axis, number in enumerate(place.values(), len(axes)):
            array = array.take([number if array.shape[axis] > 1 else 0], axis=axis)
        behind = array.shape[len(axes) + len(place) :]
        values[name] = np.broadcast_to(array, (*sizes, 1, 1, *behind)).reshape(-1, sizes[-1], *behind)
    return values


def _evaluate_sought(question: Optimise, plan: Plan, values: Values) -> pd.DataFrame:
    """Return the number sought, a row for every point.

    Columns: value, over a sweep its mean or its worst, NaN where it has none or no meaning; error, its numerical error;
    meaningless, whether a link went where its law has no meaning; excess, of `_find_excess`.
    """
    spec = question.spec
    numbers = evaluate_expression(question.expression, values, spec.over_motions)
    errors = evaluate_error(question.expression, values, spec.over_motions)
    errors = np.broadcast_to(errors, numbers.shape)
    is_meaningless = np.vectorize(is_void, otypes=[bool])(values["flags"]).any(axis=(0, 2))
    if spec.over_sweep == "mean":
        number = numbers.mean(axis=0)
        error = errors.mean(axis=0)
    else:
        worst = np.nan_to_num(question.sign * numbers, nan=np.inf).argmax(axis=0)
        points = np.arange(numbers.shape[1])
        number = numbers[worst, points]
        error = errors[worst, points]
    excess = _find_excess(question.required, values)
    is_known = ~is_meaningless & ~np.isnan(excess)
    return pd.DataFrame(
        {
            "value": np.where(is_known, number, np.nan),
            "error": error,
            "meaningless": is_meaningless,
            "excess": np.where(is_known, excess, 0.0),
        }
    )


def _find_excess(required: Sequence[Comparison], values: Values) -> np.ndarray:
    """Return by how much points miss what is required, summed over statements: 0 where all hold, NaN where not known.

    A statement holds where it does under every motion and at every other point of a sweep; it is missed by a part of
    its value.

    values : of `_find_values`
    """
    total = np.zeros(values["status"].shape[1])
    for statement in required:
        over_motions = "smallest" if statement.bounds_below else "largest"
        _, margin, held = compare_values(statement, values, over_motions)
        missed = np.where(held == 1, 0.0, np.maximum(-margin / statement.scale, np.finfo(float).eps))
        total = total + np.where(np.isnan(margin), np.nan, missed).max(axis=0)
    return total


# The tables


def _build_optimum_frame(
    search: Search, question: Optimise, plan: Plan, sought: pd.DataFrame, places: Mapping[str, int | None]
) -> pd.DataFrame:
    """Return a row for each key.

    sought : of `_evaluate_sought`
    places : numbers of the best point (None: there is none) and of the study as written, by the names of the columns
    """
    cube = np.array(list(search.values))
    best = places["optimum"]
    tried = sought[: len(cube)]
    value = sought["value"].to_numpy()
    outcome = FOUND if search.is_converged else UNSETTLED
    if best is None:
        outcome = NO_VALUE if search.best_point is None else NOT_MET
    written_place = places["as_written"]
    assert written_place is not None
    common: dict[str, Any] = {
        "sought": f"{'least' if question.sign > 0 else 'most'} {question.expression}",
        "as_written": value[written_place],
        "outcome": outcome,
        "required": ", ".join(map(str, question.required)),
        "written_unmet": int(sought["excess"][written_place] > 0),
        "points": len(tried),
        "unmet": int((tried["excess"] > 0).sum()),
        "failed": int((tried["value"].isna() & ~tried["meaningless"]).sum()),
        "meaningless": int(tried["meaningless"].sum()),
    }
    is_as_good = np.zeros(0, bool)
    if best is not None:
        above = question.sign * (tried["value"].where(tried["excess"] == 0) - value[best])
        share = FLAT * abs(value[best])
        error = sought["error"][best]
        # where it is not known, the largest known among points as good
        largest_error = tried["error"][above <= share].max() if np.isnan(error) else error
        tolerance = np.fmax(largest_error, share)
        is_as_good = (above <= tolerance).to_numpy()
        common |= {"optimum": value[best], "error": error, "tolerance": tolerance}
    rows = []
    for number, each in enumerate(question.inputs):
        row = {**common, "key": each.key, "unit": each.unit.si or each.unit.name, "spacing": ""}
        row |= {"option": "", "written_option": ""}
        if best is not None:
            best_u = cube[best, number]
            best_value = _table_value(each, best_u)
            row |= {"place": best_u, "option" if isinstance(best_value, str) else "value": best_value}
        if search.written_point is not None:
            written = _table_value(each, search.written_point[number])
        else:
            written = plan.axes[-1].values[-1][number]
        row["written_option" if isinstance(written, str) else "written"] = written
        if isinstance(each, DistributedInput):
            row["spacing"] = each.distribution.spacing
            row["range_from"], row["range_to"] = each.to_column(np.array([0.0, 1.0])).tolist()
            if best is not None:
                good = cube[is_as_good, number]
                row["good_from"], row["good_to"] = each.to_column(np.array([good.min(), good.max()])).tolist()
        rows.append(row)
    return pd.DataFrame(rows).reindex(columns=[column.name for column in OPTIMUM_COLUMNS])


def _table_value(key_input: KeyInput, u: float) -> float | str:
    """Return the value of a key as a table has it: an SI number, or the text of its option."""
    value = key_input.to_column(np.array([u]))[0]
    return value if isinstance(value, str) else float(value)


def _build_design_frame(
    question: Optimise,
    plan: Plan,
    arrays: ResultArrays,
    values: Values,
    sought: pd.DataFrame,
    places: Mapping[str, int | None],
) -> pd.DataFrame:
    """Return what the buildings do at the optimum, and with the study as written: a row for each quantity.

    The number sought comes first; the others are the largest over all motions, points of the sweep, storeys, floors or
    links, or count time histories.

    values : of `_find_values`
    sought, places : as in `_build_optimum_frame`
    """
    has_failed = ~np.isin(values["status"], OUTCOMES)
    is_known = ~has_failed.any(axis=(0, 2))
    count = has_failed[:, 0].size
    impacts = np.zeros(has_failed.shape)
    if plan.links.places:
        impacts = np.nan_to_num(values["impacts"]).sum(axis=-1)
    numbers = [place for place in places.values() if place is not None]
    case = plan.cases.index(question.case)
    analysis = plan.analyses.index(question.analysis)
    struck = find_struck_buildings(plan, arrays, case, analysis, numbers)
    scope = find_scope(question.study)

    rows: list[dict[str, Any]] = []

    def add(text: str, of_points: np.ndarray, unit: str = "1", of: int = 0) -> None:
        """Add a row: its quantity, and its values at all points."""
        row: dict[str, Any] = {"quantity": text, "unit": unit, "of": of, "over_motions": "", "on_contact": 0}
        for column, place in places.items():
            row[column] = np.nan if place is None else float(of_points[place])
        rows.append(row)

    add(str(question.expression), sought["value"].to_numpy(), question.expression.unit or "1")
    rows[0]["over_motions"] = question.spec.over_motions if len(plan.records) > 1 else ""
    rows[0]["on_contact"] = int(depends_on_contact(question.expression.quantities, struck))
    add(CONTACTS, np.where(is_known, impacts.sum(axis=(0, 2)), np.nan))
    add(WITH_CONTACT, np.where(is_known, (impacts > 0).sum(axis=(0, 2)), np.nan), of=count)
    add(FAILED, has_failed.sum(axis=(0, 2)), of=count)
    for text, (name, demand) in _find_demands(question, plan, values).items():
        largest = np.fmax.reduce(demand, axis=(0, *range(2, demand.ndim)))
        add(text, np.where(is_known, largest, np.nan), VARIABLES[name].unit)
        if name != "shear_demand":
            rows[-1]["on_contact"] = int(depends_on_contact(parse_expression(text, scope).quantities, struck))
    flags = values["flags"]
    codes = dict.fromkeys(code for cell in flags[:, numbers].flat for code in cell.splitlines())
    for code in codes:
        is_flagged = np.array([[_has_flag(cells, code) for cells in by_point] for by_point in flags])
        add(f"{FLAGGED}{NOTES[code].title}", is_flagged.sum(axis=(0, 2)), of=count)
    return pd.DataFrame(rows)[[column.name for column in DESIGN_COLUMNS]]


def _find_demands(question: Optimise, plan: Plan, values: Values) -> dict[str, tuple[str, np.ndarray]]:
    """Return by the words of the table a variable and its values in one building or in all links.

    The values are NaN where there is none.  Shape (other points of the sweep, points, motions, ...).

    values : of `_find_values`
    """
    demands: dict[str, tuple[str, np.ndarray]] = {}
    places = plan.links.places
    for number, building in enumerate(plan.buildings):
        if question.is_wall(number):
            continue
        has_edges = question.study.building(question.study.first_point, number).plan is not None
        drift = "edge_drift" if has_edges else "drift"
        for name in ("V_ratio", "mu", drift, "acceleration"):
            demands[f"largest {name} in {building}"] = name, values[name][..., number, :]
        struck = [place.is_on_columns and place.struck_storey[0] == number for place in places]
        if any(struck):
            is_loaded = values["contact_time"] > 0  # of columns that no link loads nothing is said
            demand = np.where(is_loaded, values["shear_demand"], np.nan)
            demands[f"largest shear_demand in {building}"] = "shear_demand", demand[..., np.flatnonzero(struck)]
    if places:
        for name in ("peak_force", "max_closing"):
            demands[f"largest {name}"] = name, values[name]
    return demands


def _has_flag(cells: np.ndarray, code: str) -> list[bool]:
    """Return of every time history whether it carries a flag of a code.

    cells : the codes of time histories, one a line
    """
    return [code in cell.splitlines() for cell in cells]


def _build_point_table(search: Search, question: Optimise, sought: pd.DataFrame, unit: Unit) -> Table:
    """Return every point that was tried, in the order in which the search asked for it."""
    keys, columns = build_key_frame(question.inputs, np.array(list(search.values)))
    keys.insert(0, "point", range(1, len(keys) + 1))
    keys.insert(1, "stage", search.stages)
    frame = keys.join(sought.assign(unmet=sought["excess"] > 0).astype({"meaningless": int, "unmet": int}))
    frame = frame.drop(columns="excess")
    return build_table(SEARCHED_POINTS, frame, [*SEARCHED_POINT_COLUMNS, *columns], {"value": unit, "error": unit})
