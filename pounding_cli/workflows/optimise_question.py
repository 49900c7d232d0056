"""`pound optimise`: what a study asks, checked; its points; the study with other values."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice, product
from pathlib import Path

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.reading import shortened
from pounding_cli.study import Plan, Study, expand
from pounding_cli.study.edit import with_values
from pounding_cli.study.expression import Expression
from pounding_cli.study.file import Problems, get, nearest, parse
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
    if spec.least is not None and spec.most is not None:
        what = "'least' and 'most' both stand here: give one of them"
        problems.at(root, ("optimise", "most"), what, "remove one of the two", key=True)
    key = "most" if spec.least is None and spec.most is not None else "least"
    text = getattr(spec, key)
    texts = () if text is None else (text,)
    found = expressions(study, "optimise", key, texts, problems, "largest V_ratio in stiff")
    factors = read_searched(root, problems) if get(root, "optimise", "over") is not None else []
    if not factors and not problems.found:
        hint = "write e.g. `over: {impact.restitution: {from: 0.3, to: 0.6}}`"
        problems.at(root, ("optimise",), "no key is given to vary", hint, key=True)
    case = _one(study, "case", spec.case, study.model.cases, problems)
    analysis = _one(study, "analysis", spec.analysis, study.model.analyses, problems)
    if study.model.keep is not None:
        what = "histories cannot be kept of the points of a search"
        problems.at(root, ("keep",), what, "remove `keep:`; `pound run` keeps those of chosen points", key=True)
    points = spec.generations * (spec.population or 0)
    if points > MOST_POINTS:
        hint = f"keep it to {MOST_POINTS}: write fewer"
        problems.at(root, ("optimise", "generations"), f"generations and population make {points} points", hint)
    problems.check()
    given = [(factor, get(root, *factor.key.split("."))) for factor in factors]
    places = [None if value is None else factor.place(value) for factor, value in given]
    written = tuple(place for place in places if place is not None)
    (expression,), is_point = found, len(written) == len(places)
    return Question(study, expression, tuple(factors), case, analysis, written if is_point else None)


def _one(study: Study, what: str, wanted: str | None, names: Sequence[str], problems: Problems) -> str:
    """The case or analysis that is looked at; what is wrong with the choice is noted."""
    known = [str(name) for name in names]
    if wanted is not None and wanted not in known:
        problems.at(study.root, ("optimise", what), f"{what}: no {what} '{wanted}'", nearest(wanted, known))
    elif wanted is None and len(known) > 1:
        many = f"{len(known)} {'cases' if what == 'case' else 'analyses'}"
        hint = f"select one: `optimise: {{{what}: {known[0]}}}`"
        problems.at(study.root, ("optimise",), f"the study has {many}", hint, key=True)
    return wanted or known[0]


def check_written(study: Study, path: Path) -> None:
    """Make sure that the study with other values can be written to `path`: its text takes them, and its motions are
    found from there.

    Raises
    ------
    InputError : as `question_of` and `Question.text`; or the study would be another one there
    """
    question = question_of(study)
    text, first = question.text(question.middle), (0,) * len(study.axes)
    try:
        found, why = Study(path, text, parse(text, shortened(path))), "its motions would be others"
        digests = [{name: used.use.digest for name, used in each.motions(first).items()} for each in (found, study)]
        is_same = digests[0] == digests[1]
    except InputError as error:
        is_same, why = False, error.problems[0].message
    if not is_same:
        hint = "write it beside the study: motions are sought there" if path.parent != study.path.parent else ""
        raise InputError(Problem(f"the study would not run from there: {why}", hint or "change the study", str(path)))
