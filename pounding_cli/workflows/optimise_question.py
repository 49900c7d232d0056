"""`pound optimise`: what a study asks, checked; its points; the study with other values."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice, product
from pathlib import Path

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.reading import shortened
from pounding_cli.study import Plan, Study, expand
from pounding_cli.study.edit import with_values
from pounding_cli.study.expression import Expression
from pounding_cli.study.file import Map, Problems, get, nearest, parse
from pounding_cli.study.questions import OptimiseSpec
from pounding_cli.study.vary import Factor, read_searched
from pounding_cli.workflows.expressions import expressions
from pounding_cli.workflows.sampled import at_points

Point = tuple[float, ...]
"""Coordinates of the keys that vary, between 0 and 1."""

MOST_POINTS = 200_000

MOST_CORNERS = 512
"""Corners of the ranges that are checked before anything is solved."""


@dataclass(frozen=True, eq=False)
class Question:
    """What `pound optimise` is asked of a study.

    spec : its section
    expression : the number that is optimised least, or most
    factors : the keys that vary
    case, analysis : that are looked at, by number from 0
    written : the point that the file itself stands for; None where it lies outside the ranges or a key is not written:
        a plan then has one point more, its last, for the study as it is written
    """

    spec: OptimiseSpec
    expression: Expression
    factors: tuple[Factor, ...]
    case: int
    analysis: int
    written: Point | None

    @property
    def sign(self) -> int:
        """1 where the least is sought, -1 where the most is: the search knows the least alone."""
        return 1 if self.spec.least is not None else -1

    @property
    def middle(self) -> Point:
        """The middle of all ranges and choices."""
        return tuple((0.5 + factor.options // 2) / (factor.options or 1) for factor in self.factors)


def plan_of(study: Study, question: Question, points: Sequence[Point]) -> Plan:
    """The plan of some points; the last axis holds them, and behind them the study as it is written where no point
    stands for it.  Raises InputError: the study is not sound at one of them."""
    case, analysis = list(study.model.cases)[question.case], study.model.analyses[question.analysis]
    plan = expand(
        at_points(study, question.factors, np.array(points), and_written=question.written is None),
        asks=lambda _point, name, kind, _record: (name, kind) == (case, analysis),
    )
    return dataclasses.replace(plan, workflow="optimise", harder=True)


def check_corners(study: Study, question: Question) -> None:
    """Raises InputError: the study is not sound at a corner of the ranges."""
    at_points(study, question.factors, np.array(list(islice(_corners(question), MOST_CORNERS))))


def question_of(study: Study) -> Question:
    """What a study asks.

    Raises
    ------
    InputError : nothing to optimise, no key that varies, an expression that is not understood, several cases or
        analyses and none chosen
    """
    spec: OptimiseSpec = study.model.optimise
    problems, root = Problems(study.file), study.root
    example = "largest V_ratio in stiff"
    if spec.least is not None and spec.most is not None:
        what = "'least' and 'most' both stand here: give one of them"
        problems.at(root, ("optimise", "most"), what, "remove one of the two", key=True)
    key = "most" if spec.least is None and spec.most is not None else "least"
    text = getattr(spec, key)
    found = expressions(study, "optimise", key, () if text is None else (text,), problems, example)
    factors = read_searched(root, problems) if get(root, "optimise", "over") is not None else []
    if not factors and not problems.found:
        hint = "write e.g. `over: {impact.restitution: {from: 0.3, to: 0.6}}`"
        problems.at(root, ("optimise",), "no key is given to vary", hint, key=True)
    case = _one(spec.case, list(study.model.cases), "case", root, problems)
    analysis = _one(spec.analysis, [str(each) for each in study.model.analyses], "analysis", root, problems)
    if study.model.keep is not None:
        what = "histories cannot be kept of the points of a search"
        problems.at(root, ("keep",), what, "remove `keep:`; `pound run` keeps those of chosen points", key=True)
    points = spec.generations * (spec.population or 0)
    if points > MOST_POINTS:
        hint = f"keep it to {MOST_POINTS}: write fewer"
        problems.at(root, ("optimise", "generations"), f"generations and population make {points} points", hint)
    problems.check()
    (expression,) = found
    return Question(spec, expression, tuple(factors), case, analysis, _written(factors, root))


def text_at(study: Study, question: Question, point: Point) -> str:
    """The text of the study with the keys at a point; everything else stays as it is written.

    Raises
    ------
    InputError : a key stands where an anchor or alias of YAML makes it part of something else
    """
    values = {factor.key: factor.value(u) for factor, u in zip(question.factors, point, strict=True)}
    return with_values(study.text, values, study.file)


def check_written(study: Study, path: Path) -> None:
    """Make sure that the study with other values can be written to `path`: its text takes them, and its motions are
    found from there.

    Raises
    ------
    InputError : as `question_of` and `text_at`; or the study would be another one there
    """
    question = question_of(study)
    text = text_at(study, question, question.middle)
    try:
        found, why = Study(path, text, parse(text, shortened(path))), "its motions would be others"
        first = (0,) * len(study.axes)
        is_same = _digests(found, first) == _digests(study, first)
    except InputError as error:
        is_same, why = False, error.problems[0].message
    if not is_same:
        hint = "write it beside the study: motions are sought there" if path.parent != study.path.parent else ""
        raise InputError(Problem(f"the study would not run from there: {why}", hint or "change the study", str(path)))


def _digests(study: Study, point: tuple[int, ...]) -> dict[str, str]:
    return {name: used.use.digest for name, used in study.motions(point).items()}


def _one(name: str | None, names: Sequence[str], what: str, root: Map, problems: Problems) -> int:
    """The number of the case or analysis that is looked at."""
    if name in names:
        return names.index(name)
    if name is not None:
        problems.at(root, ("optimise", what), f"{what}: no {what} '{name}'", nearest(name, names))
    elif len(names) > 1:
        many = f"{len(names)} {'cases' if what == 'case' else 'analyses'}"
        hint = f"select one: `optimise: {{{what}: {names[0]}}}`"
        problems.at(root, ("optimise",), f"the study has {many}", hint, key=True)
    return 0


def _written(factors: Sequence[Factor], root: Map) -> Point | None:
    point = []
    for factor in factors:
        given = get(root, *factor.key.split("."))
        u = None if given is None else factor.place(given)
        if u is None:
            return None
        point.append(u)
    return tuple(point)


def _corners(question: Question) -> Iterator[tuple[float, ...]]:
    """Both ends of every range with every option of every choice."""
    yield from product(
        *(
            [(place + 0.5) / factor.options for place in range(factor.options)] if factor.options else [0.0, 1.0]
            for factor in question.factors
        )
    )
