"""The parts of every question: its declaration, the question asked of one study, and the answer."""

from __future__ import annotations

import pkgutil
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

from pounding_cli.errors import KeyPath
from pounding_cli.study.schema.study import StudySection
from pounding_cli.study.text.file import Problems

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver
    from pounding_cli.errors import Issue
    from pounding_cli.report.document import Picture
    from pounding_cli.results.arrays import ResultArrays
    from pounding_cli.results.results import ResultTables
    from pounding_cli.study import Plan, Study
    from pounding_cli.tables import Column, Table

WALL_QUANTITIES = (
    *("V", "V0", "V_ratio", "drift", "drift0", "drift_ratio", "residual_drift"),
    *("acceleration", "acceleration0", "acceleration_ratio"),
    *("displacement", "displacement_max", "displacement_min"),
)
"""Quantities of which a wall on the soil has values."""


@dataclass(frozen=True, eq=False)
class Answer:
    """The result of a question.

    plan : of all time histories that the tables are about
    arrays : what these did, as the results file has it
    tables : the answer
    """

    plan: Plan
    arrays: ResultArrays
    tables: Sequence[Table]


@dataclass(frozen=True)
class LateFunction:
    """A function or class that is imported when it is first called: a declaration needs neither pandas nor matplotlib.

    place : of it, `package.module:name`
    """

    place: str

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        """Call the function."""
        return pkgutil.resolve_name(self.place)(*arguments, **options)


def _no_lines(_results: ResultTables) -> Sequence[Any]:
    return ()


def _no_references(_resolved: Mapping[str, Any]) -> Iterable[tuple[str, str]]:
    return ()


@dataclass(frozen=True)
class Question:
    """The declaration of a question, from which all that the program does with it follows.

    name : of its command, its module and its section of a study
    ask : study -> the question asked of it; raises InputError where the study asks what cannot be answered
    section : of a study file; None of a question without one
    tables : name of every table of its answer -> its columns; some are built from the study besides
    sentences : results -> what they say, the answer first
    shown_tables : results -> the tables that a terminal prints below the sentences
    notes : results -> what a reader should know of the numbers; an issue has a code, by which a study may silence it
    figures : results -> figures, the most important first
    further_sections : results, further arguments of the report -> sections of the page behind the answer
    scope : results -> what was computed, in a line, where the time histories of the file are not all of it
    is_sampled : whether its time histories are those of samples, whose own tables say nothing by themselves
    cite : study with every default filled in -> keys of references, and what each was used for
    """

    name: str
    ask: Callable[[Study], StudyQuestion]
    section: StudySection | None = None
    tables: Mapping[str, Sequence[Column]] = field(default_factory=dict)
    sentences: Callable[[ResultTables], Sequence[str]] = _no_lines
    shown_tables: Callable[[ResultTables], Sequence[Table]] = _no_lines
    notes: Callable[[ResultTables], Sequence[Issue | str]] = _no_lines
    figures: Callable[[ResultTables], Sequence[Picture]] = _no_lines
    further_sections: Callable[..., Sequence[Any]] = _no_lines
    scope: Callable[[ResultTables], str] | None = None
    is_sampled: bool = False
    cite: Callable[[Mapping[str, Any]], Iterable[tuple[str, str]]] = _no_references


class StudyQuestion(ABC):
    """A question asked of one study.  Raises InputError where the study asks what cannot be answered.

    name : of the question
    extent : whether it `has` the time histories of its plan, `has at most` these, or `begins with` them
    spec : the section of the study
    problems : what is wrong with it
    taken : what was taken of each file that its section names, in a sentence
    content : what its answer follows from besides the study and its time histories
    """

    name: ClassVar[str]
    extent = "has"
    spec: Any
    taken: tuple[str, ...] = ()
    content: str = ""

    def __init__(self, study: Study) -> None:
        self.study = study
        self.problems = Problems(study.file)
        self.spec = getattr(study.spec, self.name, None)

    def add_issues(self, issues: Iterable[Issue]) -> None:
        """Note what is wrong with the section, by paths in it."""
        for each in issues:
            self.problems.add_issue(self.study.tree, replace(each, path=(self.name, *each.path)))

    def add_problem(self, path: KeyPath, message: str, hint: str, key: bool = False) -> None:
        """Note what is wrong at a place of the section, or with the key of that place."""
        self.problems.add_at(self.study.tree, (self.name, *path), message, hint, key)

    def is_wall(self, place: int) -> bool:
        """Return whether a wall stands at a place of the group, from 0."""
        from pounding_cli.model.wall import Wall

        return isinstance(self.study.building(self.study.first_point, place), Wall)

    def lacks(self, place: int, quantity: str) -> bool:
        """Return whether a wall stands at a place of the group that has no values of a quantity.

        A wall that moves as the ground does has none at all, one on the soil behind it does not yield.
        """
        from pounding_cli.model.wall import Wall

        wall = self.study.building(self.study.first_point, place)
        return isinstance(wall, Wall) and not (wall.moves and quantity in WALL_QUANTITIES)

    def check_changes(self) -> None:  # noqa: B027 - most questions take every change
        """Raise InputError where a value that is changed for this run has no effect on the answer."""

    def refuse_histories(self, subject: str) -> None:
        """Note that histories are to be kept of a subject that nobody knows beforehand."""
        if self.study.spec.keep is not None:
            hint = "remove `keep:`; `pound run` keeps those of chosen points"
            self.problems.add_at(self.study.tree, ("keep",), f"histories cannot be kept of {subject}", hint, key=True)

    @property
    @abstractmethod
    def plan(self) -> Plan:
        """The time histories that may be wanted, as far as is known before anything is solved.  Raises InputError."""

    @property
    def expected_count(self) -> int:
        """Number of different time histories; about so many where it depends on results. Nothing is solved for it."""
        return len(self.plan)

    @abstractmethod
    def answer(self, solver: Solver) -> Answer:
        """Return the answer.  After an interruption it is asked again, and what was solved comes from the cache.

        Raises
        ------
        InputError : the study is not sound where the question takes it; the cache cannot be written
        """
