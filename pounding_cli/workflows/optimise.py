"""`pound optimise`: the search for the best values of keys, and its tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from pounding_cli.results.dataset import dataset
from pounding_cli.results.flags import counts_of_flags, parted
from pounding_cli.results.tables import Filled, Table, column
from pounding_cli.solver.response import OUTCOMES
from pounding_cli.study import Plan, Study
from pounding_cli.study.expression import Expression, Quantity
from pounding_cli.study.vary import Factor
from pounding_cli.variables import VARIABLES
from pounding_cli.workflows.expressions import Get, error_of, getter, values_of
from pounding_cli.workflows.optimise_question import Point, Question, check_corners, plan_of, question_of
from pounding_cli.workflows.search import Search, Settings
from pounding_cli.workflows.workflow import Found, Workflow

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


class Optimise(Workflow):
    """The values of keys at which a number is least, or most."""

    name = "optimise"

    def check(self, study: Study) -> Question:
        """What a study asks.  Raises InputError, see `question_of`."""
        return question_of(study)

    def plan(self, study: Study) -> Plan:
        """The scenes of the first points: the study as it is written, or else the middle of all ranges."""
        question = question_of(study)
        check_corners(study, question)
        middle = tuple((0.5 + factor.options // 2) / (factor.options or 1) for factor in question.factors)
        return plan_of(study, question, [question.written or middle])

    def goes_on(self, study: Study) -> bool:
        """Every point decides about the next."""
        return True

    def run(self, study: Study, solver: Solver) -> Found:
        """The optimum, what the buildings do there, and all points."""
        question = question_of(study)
        check_corners(study, question)
        hunt = Hunt(study, question, solver)
        hunt.search.run()
        plan = plan_of(study, question, list(hunt.search.values))
        data = hunt.dataset(plan, is_rough=True)  # what only led to the valley keeps its rough numbers
        hunt.note(plan, data)
        built = plan.axes[-1].values[-1] if question.written is None else None
        tables = {OPTIMUM: _optimum(hunt, built), DESIGN: _design(plan, hunt, data), POINTS: _points(hunt)}
        return Found(plan, data, [Table.of(name, columns) for name, columns in tables.items()])


ASKED = Optimise()


class Hunt:
    """A search over the points of a study.

    void : points whose number has no meaning
    built : number of the study as it is written, the least sought; NaN where it has none
    """

    def __init__(self, study: Study, question: Question, solver: Solver) -> None:
        self.study, self.question, self.solver, spec = study, question, solver, question.spec
        settings = Settings(spec.seed, spec.population, spec.generations, spec.slice_points, spec.map_points)
        self.search = Search(self.values, [factor.options for factor in question.factors], settings, question.written)
        self.void: set[Point] = set()
        self.built = np.nan

    @property
    def points(self) -> list[Point]:
        """All that were looked at."""
        return list(self.search.values)

    def values(self, points: list[Point], is_rough: bool) -> tuple[np.ndarray, np.ndarray]:
        """What the search is told of some points."""
        plan = plan_of(self.study, self.question, points)
        data = self.dataset(plan, is_rough)
        values, errors = _values(self.question, plan, getter(plan, data))
        void = _void(self.question, plan, data)[: len(points)]
        self.void |= {point for point, is_void in zip(points, void.tolist(), strict=True) if is_void}
        return np.where(void, np.nan, values[: len(points)]), errors[: len(points)]

    def dataset(self, plan: Plan, is_rough: bool) -> xr.Dataset:
        """What the scenes of a plan did; `is_rough`: their errors need not be known."""
        return dataset(plan, self.solver.responses(plan, rough=is_rough))

    def note(self, plan: Plan, data: xr.Dataset) -> None:
        """Keep the number of the study as it is written."""
        if self.search.written is not None:
            self.built = self.search.values[self.search.written]
        elif not _void(self.question, plan, data)[-1]:
            self.built = float(_values(self.question, plan, getter(plan, data))[0][-1])


def _values(question: Question, plan: Plan, get: Get) -> tuple[np.ndarray, np.ndarray]:
    """What the search is told of every point of the last axis: the number, negative where the most is sought, and its
    error."""
    spec = question.spec
    values = values_of(question.expression, get, spec.over_motions)
    errors = error_of(question.expression, get, spec.over_motions)
    points = len(plan.axes[-1].values)
    values, errors = (each[..., question.case, question.analysis].reshape(-1, points) for each in (values, errors))
    values = question.sign * values
    if spec.over_sweep == "mean":
        return values.mean(axis=0), errors.mean(axis=0)
    known = np.where(np.isnan(values), np.inf, values)  # a point that failed makes the worst unknown
    worst = known.argmax(axis=0)
    chosen = worst, np.arange(points)
    return values[chosen], errors[chosen]


def _void(question: Question, plan: Plan, data: xr.Dataset) -> np.ndarray:
    """Whether the number means nothing at a point, because a link of a scene went where its law has no meaning."""
    found = counts_of_flags(data["flags"].values)["records_meaningless"][..., question.case, question.analysis] > 0
    return np.asarray(found.reshape(-1, len(plan.axes[-1].values)).any(axis=0))


def _design(plan: Plan, hunt: Hunt, data: xr.Dataset) -> list[Filled]:
    """What the buildings do at the optimum, and with the study as it is written: a row for each quantity."""
    question, search, points = hunt.question, hunt.search, len(plan.axes[-1].values)
    get = getter(plan, data)
    shown = (
        hunt.points.index(search.best) if search.best is not None else None,
        points - 1 if search.written is None else hunt.points.index(search.written),
    )
    rows: list[tuple[str, str, int, list[float]]] = []

    def add(name: str, unit: str, values: np.ndarray, of: int = 0) -> None:
        rows.append((name, unit, of, [np.nan if at is None else float(values[at]) for at in shown]))

    def here(name: str) -> np.ndarray:
        """A variable, shape (other points of the sweep, points, motions, ...)."""
        whole = data[name].values
        moved = np.moveaxis(whole, (len(plan.axes), len(plan.axes) + 1), (0, 1))[question.case, question.analysis]
        return moved.reshape(-1, points, *moved.shape[len(plan.axes) :])

    add(str(question.expression), question.expression.unit or "1", _over_sweep(question, plan, get))
    has_links = bool(plan.links.places)
    failed = ~np.isin(here("status"), OUTCOMES)
    known, of = ~failed.any(axis=(0, 2)), failed[:, 0].size
    impacts = np.maximum(here("impacts"), 0).sum(axis=-1) if has_links else np.zeros(failed.shape)
    add("contacts, all motions", "1", np.where(known, impacts.sum(axis=(0, 2)), np.nan))
    add("scenes with contact", "1", np.where(known, (impacts > 0).sum(axis=(0, 2)), np.nan), of)
    add("scenes that failed", "1", failed.sum(axis=(0, 2)).astype(float), of)
    places: list[int | None] = list(range(len(plan.buildings)))
    for place in places if len(places) <= MOST_BUILDINGS else [None]:
        for name in ("V_ratio", "mu", "drift", "acceleration"):
            add(*_quantity(name, place, plan), _over_sweep(question, plan, get, Quantity(name, "largest", place)))
    for name in ("peak_force", "max_closing") if has_links else ():
        add(*_quantity(name, None, plan), _over_sweep(question, plan, get, Quantity(name)))
    flags = here("flags")
    said = {flag: None for at in shown if at is not None for cell in flags[:, at].flat for flag, _ in parted(cell)}
    for flag in said:
        has = np.array([any(flag == each for each, _ in parted(cell)) for cell in flags.flat]).reshape(flags.shape)
        add(f"scenes flagged: {flag}", "1", has.sum(axis=(0, 2)).astype(float), of)
    return [
        column("quantity", _text([name for name, *_ in rows]), "what is compared; largest over the storeys"),
        column("unit", _text([unit for _, unit, *_ in rows]), "its unit"),
        column("optimum", np.array([values[0] for *_, values in rows]), "at the optimum"),
        column("as_written", np.array([values[1] for *_, values in rows]), "with the study as it is written"),
        column("of", np.array([of for _, _, of, _ in rows], int), "scenes, where scenes are counted; otherwise 0", "1"),
    ]


def _quantity(name: str, place: int | None, plan: Plan) -> tuple[str, str]:
    """What a quantity is called, and its unit."""
    return f"largest {name}" + ("" if place is None else f" in {plan.buildings[place]}"), VARIABLES[name].unit


def _over_sweep(question: Question, plan: Plan, get: Get, quantity: Quantity | None = None) -> np.ndarray:
    """The number sought, or a quantity, at every point of the last axis: over the motions as the number sought is, over
    a sweep its mean or its worst, of a quantity the largest."""
    spec, points = question.spec, len(plan.axes[-1].values)
    expression, sign = question.expression, question.sign
    if quantity is not None:
        expression, sign = Expression(quantity.name, "", (quantity,), lambda value: value(quantity)), 1
    values = values_of(expression, get, spec.over_motions)[..., question.case, question.analysis].reshape(-1, points)
    if spec.over_sweep == "mean":
        return values.mean(axis=0)
    return sign * (sign * values).max(axis=0)  # NaN where one is


def _optimum(hunt: Hunt, built: tuple[float | str, ...] | None) -> list[Filled]:
    """A row for each key; `built` : what the study says of the keys, where that is no point of the search."""
    question, search = hunt.question, hunt.search
    best, sign, unit = search.best, question.sign, question.expression.unit or "1"
    values = np.array(list(search.values.values()))
    outcome = NOTHING if best is None else FOUND if search.is_settled else UNSETTLED
    keys, rows = len(question.factors), range(len(question.factors))

    def same(value: float | str | None) -> np.ndarray:
        if isinstance(value, str):
            return np.array([value] * keys, dtype=object)
        return np.full(keys, np.nan if value is None else value)

    def over_keys(ends: list[tuple[float, float] | None]) -> tuple[np.ndarray, np.ndarray]:
        both = [
            (np.nan, np.nan) if end is None else tuple(question.factors[row].number(np.array(end)))
            for row, end in enumerate(ends)
        ]
        low, high = np.array(both, float).reshape(-1, 2).T
        return low, high

    flat = over_keys([search.flat.get(row) for row in rows])
    together = over_keys([_together(hunt, row) for row in rows])
    ends = over_keys([None if factor.options else (0.0, 1.0) for factor in question.factors])
    at_best = [_value(factor, best, row) for row, factor in enumerate(question.factors)]
    at_written = [_value(factor, search.written, row) for row, factor in enumerate(question.factors)]
    if built is not None:
        at_written = [(np.nan, value) if isinstance(value, str) else (value, "") for value in built]
    place = [np.nan] * keys if best is None else list(best)
    flat_text = "of a key by itself, the others at the optimum"
    with_text = "among all points that were tried"
    bottom = "range over which the number stays within its tolerance"
    return [
        column("sought", same(f"{'least' if sign > 0 else 'most'} {question.expression}"), "number that is optimised"),
        column("optimum", same(None if best is None else sign * search.values[best]), "its best value", unit),
        column("error", same(None if best is None else search.error), "numerical error of that, at most", unit),
        column("tolerance", same(None if best is None else search.tolerance), "its error, or 1 % of it", unit),
        column("as_written", same(sign * hunt.built), "value of the file as written", unit),
        column("outcome", same(outcome), "outcome, or why there is no answer"),
        column("points", np.full(keys, values.size), "points that were tried", "1"),
        column("failed", np.full(keys, int(np.isnan(values).sum()) - len(hunt.void)), "points without a number", "1"),
        column("meaningless", np.full(keys, len(hunt.void)), "points whose number has no meaning", "1"),
        column("key", _text([factor.key for factor in question.factors]), "key that varies"),
        column("unit", _text([factor.unit.si or factor.unit.name for factor in question.factors]), "its unit"),
        column("value", np.array([number for number, _ in at_best]), "of the key at the optimum; NaN of a choice"),
        column("place", np.array(place), "of the optimum in what was searched, 0 to 1", "1"),
        column("option", _text([text for _, text in at_best]), "chosen at the optimum; empty of a number"),
        column("flat_from", flat[0], f"lower end: {bottom}, {flat_text}"),
        column("flat_to", flat[1], f"upper end: {bottom}, {flat_text}"),
        column("together_from", together[0], f"lower end: {bottom}, {with_text}"),
        column("together_to", together[1], f"upper end: {bottom}, {with_text}"),
        column("range_from", ends[0], "lower end of what was searched"),
        column("range_to", ends[1], "upper end of what was searched"),
        column("spacing", _text([factor.spacing for factor in question.factors]), "linear or log; empty of a choice"),
        column("written", np.array([number for number, _ in at_written]), "of the key as written"),
        column("written_option", _text([text for _, text in at_written]), "option as written"),
        column("mapped", np.array([row in (search.mapped or ()) for row in rows], int), "1 of a key of the map", "1"),
    ]  # fmt: skip


def _together(hunt: Hunt, number: int) -> tuple[float, float] | None:
    """Between which ends a key may lie so that some point that was tried is within the tolerance."""
    search = hunt.search
    if search.best is None or hunt.question.factors[number].options:
        return None
    bound = search.values[search.best] + search.tolerance
    inside = [point[number] for point, value in search.values.items() if value <= bound]
    return min(inside), max(inside)


def _value(factor: Factor, point: Point | None, number: int) -> tuple[float, str]:
    """A key at a point: its number, or its option."""
    if point is None:
        return np.nan, ""
    value = float(factor.number(np.array(point[number])))
    return (np.nan, factor.labels[int(value)]) if factor.options else (value, "")


def _points(hunt: Hunt) -> list[Filled]:
    """Every point that was tried, in the order in which the search asked for it."""
    question, search = hunt.question, hunt.search
    cube, unit = np.array(list(search.values)), question.expression.unit or "1"
    columns = [
        column("point", np.arange(1, len(cube) + 1), "number of the point", "1"),
        column("stage", _text([search.stages[point] for point in search.values]), "what it was tried for"),
    ]
    for number, factor in enumerate(question.factors):
        values = factor.number(cube[:, number])
        if factor.options:
            labels = _text([factor.labels[int(value)] for value in values])
            columns.append(column(factor.key, labels, f"varies: {factor.key}"))
        else:
            columns.append(column(factor.key, values, f"varies: {factor.key}", factor.unit.si or "1", factor.unit))
    found = question.sign * np.array(list(search.values.values()))
    columns.append(column("value", found, f"{question.expression}; NaN where it has none or no meaning", unit))
    columns.append(column("error", np.array(list(search.errors.values())), "numerical error of that, at most", unit))
    void = [point in hunt.void for point in search.values]
    columns.append(
        column("meaningless", np.array(void, int), "1 where a link left the range in which its law has a meaning", "1")
    )
    return columns


def _text(values: list[str]) -> np.ndarray:
    return np.array(values, dtype=object)
