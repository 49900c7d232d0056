"""`pound run`: every time history of a study, and no table beyond those that every results file has."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from pounding_cli.questions.question import Answer, LateFunction, Question, StudyQuestion

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver
    from pounding_cli.study import Plan


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


QUESTION = Question(
    name="run",
    ask=Run,
    sentences=LateFunction("pounding_cli.questions.run.words:list_sentences"),
    shown_tables=LateFunction("pounding_cli.questions.run.words:list_tables"),
    notes=LateFunction("pounding_cli.questions.run.words:list_notes"),
    figures=LateFunction("pounding_cli.questions.run.figures:list_figures"),
    further_sections=LateFunction("pounding_cli.questions.run.figures:further_sections"),
)
"""`pound run`."""
