"""`pound run`: every time history of a study, and no table beyond those that every results file has."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from pounding_cli.questions.question import Answer, Question, StudyQuestion

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver
    from pounding_cli.report.document import Picture, Section
    from pounding_cli.report.sweep import SweepChoice
    from pounding_cli.results.results import ResultTables
    from pounding_cli.study import Plan
    from pounding_cli.tables import Table


class Run(StudyQuestion):
    """Every time history of a study."""

    name = "run"

    @cached_property
    def plan(self) -> Plan:
        """All time histories."""
        from pounding_cli.study import make_plan

        return make_plan(self.study)

    def answer(self, solver: Solver) -> Answer:
        """Return what all time histories did."""
        return Answer(self.plan, solver.solve_arrays(self.plan), ())


def _sentences(results: ResultTables) -> Sequence[str]:
    from pounding_cli.questions.run.words import list_sentences

    return list_sentences(results)


def _shown_tables(results: ResultTables) -> Sequence[Table]:
    from pounding_cli.questions.run.words import list_tables

    return list_tables(results)


def _notes(results: ResultTables) -> Sequence[str]:
    from pounding_cli.questions.run.words import list_notes

    return list_notes(results)


def _figures(results: ResultTables) -> Sequence[Picture]:
    from pounding_cli.questions.run.figures import list_figures

    return list_figures(results)


def _further_sections(results: ResultTables, choice: SweepChoice | None = None) -> Sequence[Section]:
    from pounding_cli.questions.run.figures import further_sections

    return further_sections(results, choice)


QUESTION = Question(
    name="run",
    ask=Run,
    sentences=_sentences,
    shown_tables=_shown_tables,
    notes=_notes,
    figures=_figures,
    further_sections=_further_sections,
)
"""`pound run`."""
