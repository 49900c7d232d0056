"""What becomes of the statements of a study: every number that tests one, its margin, and the verdict."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.numbers import NOTHING, Unit, format_number
from pounding_cli.questions.expressions import (
    EVERY,
    FindAtInstant,
    Values,
    collect_values,
    compare_values,
    find_failed,
    find_missing_places,
    find_scope,
    find_spread,
    name_variables,
)
from pounding_cli.questions.frames import PURE_NUMBER, list_swept_columns
from pounding_cli.questions.instants import Instants
from pounding_cli.study.expressions.expression import ABSENT
from pounding_cli.study.expressions.statements import Statement, iter_comparisons, parse_statements
from pounding_cli.study.text.issues import Issues
from pounding_cli.tables import Column, Row, Table, build_table
from pounding_cli.units import find_unit_factor

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.questions.question import StudyQuestion
    from pounding_cli.results.arrays import ResultArrays
    from pounding_cli.results.results import ResultTables
    from pounding_cli.study import Study
    from pounding_cli.study.expressions.comparison import Comparison
    from pounding_cli.study.run_plan import Plan

STATEMENTS = "statements"
"""Name of the table."""

HOLDS, FAILS, UNDECIDED, UNKNOWN = "holds", "does not hold", "undecided", "not tested"
"""Outcomes of a comparison: it is met, missed, met or missed by less than the numerical error, without a number."""
PARTLY = "holds partly"
"""Verdict on a statement some of whose comparisons hold."""

ERROR, SENSITIVITY = "numerical error", "change of the motion by 0.1 %"
"""What may turn an outcome."""

TURNS_MARK = "~"
"""Stands behind a verdict that a small change of the motion may turn."""

MAX_LABEL = 40
"""Characters of a statement's words that a table shows where it has no name."""

SMALL_CHANGE = 1e-3
"""Change of a motion that its digits leave open: records are written with three or four [-]."""

STATEMENT_COLUMNS = (
    Column("statement", "name of the statement"),
    Column("says", "its words"),
    Column("source", "where they stand"),
    Column("reading", "how they are read"),
    Column("comparison", "what is tested"),
    Column("case", "case; empty where the comparison names its cases, or where it depends on none"),
    Column("analysis", "analysis, likewise"),
    Column("number", "number that decides, in its SI unit; of several motions that of the worst", digits=4),
    Column("unit", "SI unit of the number; empty of a pure number"),
    Column("written_unit", "unit in which the study writes it; empty where it writes none"),
    Column("bound", "what it should be"),
    Column("printed", "what the source prints for it, in its SI unit; NaN of a comparison", digits=4),
    Column("margin", "by how much the comparison is met, below 0 where it is missed, in its SI unit", digits=3),
    Column("error", "numerical error of the margin; NaN where no run was solved more finely", digits=2),
    Column(
        "sensitivity", "change of the margin under a small change of the motion; NaN where it is not known", digits=2
    ),
    Column("met", "motions under which the comparison is met", PURE_NUMBER, digits=0),
    Column("motions", "motions under which it is tested one by one; 1 of a mean", PURE_NUMBER, digits=0),
    Column("outcome", f"`{HOLDS}`, `{FAILS}`, `{UNDECIDED}` within the numerical error, or `{UNKNOWN}`"),
    Column("turns", f"`{ERROR}` or `{SENSITIVITY}` where that may turn the outcome; empty elsewhere"),
)
"""The table `statements`: a row a comparison at a point of the sweep, in a case and analysis."""


def read_statements(question: StudyQuestion, keeps_histories: bool = False) -> list[Statement]:
    """Return the statements of a study.  Note what is wrong with them.

    keeps_histories : whether the question keeps time histories, on which a statement may rest
    """
    study = question.study
    specs = study.spec.statements
    is_file = isinstance(specs, str)
    if is_file:
        specs = _read_statements_of(question, specs)
    statements, faults = parse_statements(specs, find_scope(study, whole=True))
    places = [(("statements", *each.path), each.message, each.hint) for each in faults]
    for number, statement in enumerate(statements):
        written = [" ".join(text.split()) for text in specs[number].holds]
        for comparison in statement.comparisons:
            text = comparison.text
            key = ("holds", written.index(text)) if text in written else ("number",)
            places += [(("statements", number, *key), *each) for each in find_missing_places(comparison, question)]
        places += [(("statements", number), *each) for each in _find_lost_histories(statement, study)]
        if statement.needs_histories and not keeps_histories:
            message = f"statement {statement.name} rests on an instant, and `pound {question.name}` keeps no histories"
            places.append((("statements", number), message, "move it to another study, for `pound run`"))
        elif statement.needs_histories and study.spec.keep is None:
            message = f"statement {statement.name} rests on an instant, and the study keeps no histories"
            places.append((("statements", number), message, "write e.g. `keep: {histories: {every: 1 ms}}`"))
    for path, message, hint in places:
        if is_file:
            message = f"{study.spec.statements}, statement {statements[int(path[1])].name}: {message}"
        question.problems.add_at(study.tree, path[:1] if is_file else path, message, hint)
    return statements


def _find_lost_histories(statement: Statement, study: Study) -> Iterator[tuple[str, str]]:
    """Yield the cases, analyses and motions whose histories a statement names and the study does not keep, and what to
    write."""
    keep = study.spec.keep
    if keep is None or isinstance(keep, str) or isinstance(keep.histories, str):
        return
    scope = find_scope(study, whole=True)
    chosen = (
        ("cases", keep.histories.cases, scope.cases, "case"),
        ("analyses", keep.histories.analyses, scope.analyses, "analysis"),
        ("records", keep.histories.records, scope.motions, "motion"),
    )
    for comparison in statement.comparisons:
        for part in comparison.quantities:
            for key, kept, names, kind in chosen:
                place = getattr(part, kind)
                if part.instant is None or kept is None or place in (None, ABSENT):
                    continue
                if names[place] not in kept:
                    message = f"'{comparison}' rests on a history of {names[place]}, which is not kept"
                    yield message, f"write {names[place]} in `{key}` of `keep: histories`"


def _read_statements_of(question: StudyQuestion, file: str) -> tuple[Any, ...]:
    """Return the statements of another study file as they are validated.  Note that it has none."""
    from pounding_cli.study.construct.written import read_specs
    from pounding_cli.study.text.file import read_study

    study = question.study
    path = study.path.resolve().parent / file
    try:
        _, tree = read_study(path)
    except InputError as error:
        question.problems.extend(error.issues)
        return ()
    issues = Issues()
    specs = read_specs(tree, issues, type(study.spec))
    found = specs.get(("statements",))
    if not isinstance(found, tuple) or not found:
        hint = "name a study file with a list under `statements:`"
        question.problems.add_at(study.tree, ("statements",), f"{file} has no list of statements", hint)
        return ()
    return found


class EvaluatedComparison(NamedTuple):
    """A comparison with its values, over sweep, cases, analyses and motions; lengths of 1 where these do not matter.

    parts : values of the parts of the comparison, one by one
    held : 1 where it holds, 0 where it does not, NaN where it is not known
    failed : whether a time history that it rests on has not run to its end
    margin, error, sensitivity : by how much it is met, and what moves that [SI]
    """

    statement: Statement
    comparison: Comparison
    parts: tuple[np.ndarray, ...]
    held: np.ndarray
    failed: np.ndarray
    margin: np.ndarray
    error: np.ndarray
    sensitivity: np.ndarray


def iter_evaluated(
    statements: list[Statement], values: Values, instants: FindAtInstant | None = None
) -> Iterator[EvaluatedComparison]:  # fmt: skip
    """Yield every comparison of statements with its numbers."""
    for statement, comparison in iter_comparisons(statements):
        over = statement.over_motions
        compared = compare_values(comparison, values, over, instants)

        error, sensitivity = (
            find_spread(comparison.quantities, comparison.margin, values, over, kind, instants)
            for kind in ("error", "sensitivity")
        )
        failed = find_failed(comparison.quantities, values, over)
        arrays = [compared.held, failed, compared.margin, error, SMALL_CHANGE * sensitivity, *compared.parts]
        if over != EVERY:
            arrays = [each[..., None] if each.ndim else each for each in arrays]
        held, failed, margin, error, sensitivity, *parts = np.broadcast_arrays(*arrays)
        yield EvaluatedComparison(statement, comparison, tuple(parts), held, failed, margin, error, sensitivity)


def find_values(plan: Plan, arrays: ResultArrays, statements: list[Statement]) -> Values:
    """Return the variables that statements rest on."""
    quantities = [part for _, each in iter_comparisons(statements) for part in each.quantities]
    axes = [axis.names[0] for axis in plan.axes]
    return collect_values(arrays, axes, sorted(name_variables(quantities) | {"kind", "gap"}))


def build_statement_table(
    plan: Plan,
    arrays: ResultArrays,
    statements: list[Statement],
    histories: Iterable[tuple[tuple[int, ...], ResultArrays]],
) -> Table:
    """Return the table of the statements of a study.

    histories : kept ones, with the index of their rows
    """
    import pandas as pd

    values = find_values(plan, arrays, statements)
    gaps = None
    if "gap" in values:
        gaps = np.broadcast_to(values["gap"][..., 0, 0, :], (*plan.shape[:-2], values["gap"].shape[-1]))
    instants = Instants(plan.shape, histories, gaps)
    rows: list[dict[str, Any]] = []
    for tested in iter_evaluated(statements, values, instants):
        shape = tested.margin.shape
        is_counted = ~np.isnan(tested.margin) | tested.failed
        for *point, case, analysis in np.ndindex(shape[:-1]):
            if is_counted.any() and not is_counted[(*point, case, analysis)].any():
                continue  # no such number exists there: links of a law that the case does not have
            row: dict[str, Any] = {}
            for axis, place, size in zip(plan.axes, point, shape, strict=False):
                is_free = size == len(axis)  # else the comparison names its point, or does not depend on it
                for name, value in zip(axis.names, axis.values[place], strict=True):
                    row[name] = value if is_free else "" if isinstance(value, str) else math.nan
            row |= judge(tested, (*point, case, analysis))
            row["case"] = plan.cases[case] if shape[-3] == len(plan.cases) > 1 else ""
            row["analysis"] = plan.analyses[analysis] if shape[-2] == len(plan.analyses) > 1 else ""
            rows.append(row)
    keys = [name for axis in plan.axes for name in axis.names]
    frame = pd.DataFrame(rows, columns=[*keys, *(column.name for column in STATEMENT_COLUMNS)])
    columns = [*list_swept_columns(plan.axes), *STATEMENT_COLUMNS]
    return build_table(STATEMENTS, frame, columns, caption="Comparisons of the statements")


def judge(tested: EvaluatedComparison, at: tuple[int, ...]) -> dict[str, Any]:
    """Return the row of a comparison at one place: number, margin and outcome, of several motions of the worst."""
    is_counted = ~np.isnan(tested.margin[at]) | tested.failed[at]
    if not is_counted.any():
        is_counted = np.ones_like(is_counted)
    margins, held = (np.where(is_counted, each[at], np.inf) for each in (tested.margin, tested.held))
    is_known = ~np.isnan(margins)
    worst = int(np.nanargmin(margins)) if is_known.any() else 0
    place = (*at, worst)
    margin, error, sensitivity = (float(each[place]) for each in (tested.margin, tested.error, tested.sensitivity))
    number, bound = _tell_step(tested.comparison, [float(each[place]) for each in tested.parts])
    outcome, turns = _decide(margins, held, tested.error[at], tested.sensitivity[at])
    statement = tested.statement
    return {
        "statement": statement.name,
        "says": statement.says,
        "source": statement.source,
        "reading": statement.reading,
        "comparison": tested.comparison.text,
        "number": number,
        "written_unit": tested.comparison.written_unit,
        "bound": bound,
        "unit": tested.comparison.first.unit,
        "printed": math.nan if statement.printed is None else statement.printed,
        "margin": margin,
        "error": error,
        "sensitivity": sensitivity,
        "met": int((held == 1).sum()),
        "motions": int(is_counted.sum()),
        "outcome": outcome,
        "turns": turns,
    }


def _decide(
    margins: np.ndarray, held: np.ndarray, errors: np.ndarray, sensitivities: np.ndarray
) -> tuple[str, str]:  # fmt: skip
    """Return the outcome of a comparison under some motions, all of which must meet it, and what may turn it.

    It is unknown where a run failed; it fails where one motion misses it by more than the numerical error,
    however close another one comes to its limit.

    Shapes (motions,).
    """
    if np.isnan(margins).any():
        return UNKNOWN, ""
    is_open = (errors > 0) & (np.abs(margins) <= errors)
    is_missed = (held == 0) & ~is_open
    may_turn = (sensitivities > 0) & (np.abs(margins) <= sensitivities)
    if is_missed.any():
        return FAILS, SENSITIVITY if may_turn[is_missed].all() else ""
    if is_open.any():
        return UNDECIDED, ERROR
    return HOLDS, SENSITIVITY if may_turn.any() else ""


def _tell_step(comparison: Comparison, parts: Sequence[float]) -> tuple[float, str]:
    """Return the number that decides a comparison, and what it should be.

    parts : values of its parts [SI]
    """
    unit = comparison.first.unit
    steps = [float(each) for each in comparison.find_steps([np.asarray(each) for each in parts])]
    place = int(np.argmin(steps)) if np.isfinite(steps).any() else 0
    sign, left, right = comparison.signs[place], parts[place], parts[place + 1]
    if isinstance(comparison.parts[place], float):  # the number stands at the right
        sign, left, right = sign.translate(str.maketrans("<>", "><")), right, left
    return left, f"{sign} {format_value(right, unit, comparison.written_unit)}"


# Verdicts


@dataclass(frozen=True)
class Verdict:
    """The verdict on a statement.

    name, says, source, reading : of the statement
    rows : of the table that test it
    """

    name: str
    says: str
    source: str
    reading: str
    rows: Sequence[Row]

    @property
    def label(self) -> str:
        """The name that the study gives the statement, else the beginning of its words."""
        if not self.name.isdigit():
            return self.name
        return self.says if len(self.says) <= MAX_LABEL else f"{self.says[: MAX_LABEL - 3].rstrip()}..."

    @property
    def word(self) -> str:
        """The verdict: holds where all tests do."""
        outcomes = {row["outcome"] for row in self.rows}
        if outcomes == {UNKNOWN}:
            return UNKNOWN
        if outcomes == {HOLDS}:
            return HOLDS
        if HOLDS in outcomes:
            return PARTLY
        return UNDECIDED if UNDECIDED in outcomes else FAILS

    @property
    def count(self) -> str:
        """How many of several tests are met, and under how many motions where each is looked at; "" where all are."""
        if self.word == UNKNOWN:
            return ""
        motions = sum(int(row["motions"]) for row in self.rows)
        met = sum(int(row["met"]) for row in self.rows)
        if any(row["motions"] > 1 for row in self.rows):
            return f"{met} of {motions} motions" if met < motions else ""
        held = sum(row["outcome"] == HOLDS for row in self.rows)
        return f"{held} of {len(self.rows)}" if 0 < held < len(self.rows) else ""

    @property
    def turns(self) -> str:
        """What may turn an outcome of a test; "" where nothing may."""
        found = {row["turns"] for row in self.rows}
        return ERROR if ERROR in found else SENSITIVITY if SENSITIVITY in found else ""

    def __str__(self) -> str:
        """The verdict, how many of several tests hold, and what may turn it."""
        count = f" ({self.count})" if self.count else ""
        return f"{self.word}{count}{f' {TURNS_MARK}' if self.turns == SENSITIVITY else ''}"


def list_verdicts(frame: pd.DataFrame) -> list[Verdict]:
    """Return the verdicts on the statements of a table `statements`, in the order of the study."""
    verdicts = []
    for name, rows in frame.groupby("statement", sort=False):
        says, source, reading = (str(rows[key].iloc[0]) for key in ("says", "source", "reading"))
        verdicts.append(Verdict(str(name), says, source, reading, rows.to_dict("records")))
    return verdicts


def format_value(value: float, unit: str, written: str = "") -> str:
    """Return a number of a statement with its unit.

    unit : SI
    written : the unit in which the study writes it; "" where it writes none
    """
    if not math.isfinite(value):
        return NOTHING
    factor = find_unit_factor(written, unit) if written else 1.0
    assert factor is not None  # else the study would not have been read
    return f"{format_number(value / factor, 4)} {written or unit}".rstrip()


def view_verdicts(results: ResultTables) -> Table:
    """Return the table that a terminal and a page show: a row a statement, with the number that decides it."""
    import pandas as pd

    rows = []
    for verdict in list_verdicts(results.answer(STATEMENTS).frame):
        worst = min(verdict.rows, key=lambda row: row["margin"] if math.isfinite(row["margin"]) else math.inf)
        printed, unit, written = (worst[key] for key in ("printed", "unit", "written_unit"))
        rows.append({
            "statement": verdict.label,
            "number": format_value(worst["number"], unit, written),
            "bound": worst["bound"] if math.isnan(printed) else format_value(printed, unit, written),
            "verdict": str(verdict),
        })  # fmt: skip
    text = Unit("", 1.0, "")
    columns = (
        Column("statement", "name of the statement", text),
        Column("number", "number found, of several the worst", text, label="found"),
        Column("bound", "what it should be, or what its source prints", text, label="should be", optional=True),
        Column("verdict", "verdict", text),
    )
    is_marked = any(TURNS_MARK in row["verdict"] for row in rows)
    caption = f"Statements ({TURNS_MARK}: a {SENSITIVITY} may turn the verdict)" if is_marked else "Statements"
    return Table("", pd.DataFrame(rows, columns=[each.name for each in columns]), columns, caption)


def summarize_verdicts(results: ResultTables) -> str:
    """Return how many statements hold, in a sentence."""
    words = [verdict.word for verdict in list_verdicts(results.answer(STATEMENTS).frame)]
    counts = [f"{words.count(word)} {word}" for word in dict.fromkeys(words)]
    return f"Of {len(words)} statements: {', '.join(counts)}."
