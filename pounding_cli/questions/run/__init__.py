"""`pound run`: every time history of a study, and what becomes of its statements."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from pounding_cli.questions.question import Answer, LateFunction, Question, StudyQuestion
from pounding_cli.questions.statements import STATEMENT_COLUMNS, STATEMENTS, build_statement_table, read_statements

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver
    from pounding_cli.study import Plan, Study


class Run(StudyQuestion):
    """Every time history of a study.

    statements : what should hold of its results
    """

    name = "run"

    def __init__(self, study: Study) -> None:
        super().__init__(study)
        self.statements = read_statements(self, keeps_histories=True)
        self.problems.check()
        self.content = repr(self.statements) if isinstance(study.spec.statements, str) else ""

    @cached_property
    def plan(self) -> Plan:
        """All time histories."""
        from pounding_cli.study import make_plan

        return make_plan(self.study)

    def answer(self, solver: Solver) -> Answer:
        """Return what all time histories did, and the numbers of the statements."""
        arrays = solver.solve_arrays(self.plan)
        if not self.statements:
            return Answer(self.plan, arrays, ())
        needs_histories = any(each.needs_histories for each in self.statements)
        histories = solver.iter_histories(self.plan, arrays) if needs_histories else ()
        return Answer(self.plan, arrays, [build_statement_table(self.plan, arrays, self.statements, histories)])


QUESTION = Question(
    name="run",
    ask=Run,
    tables={STATEMENTS: STATEMENT_COLUMNS},
    sentences=LateFunction("pounding_cli.questions.run.words:list_sentences"),
    shown_tables=LateFunction("pounding_cli.questions.run.words:list_tables"),
    notes=LateFunction("pounding_cli.questions.run.words:list_notes"),
    figures=LateFunction("pounding_cli.questions.run.figures:list_figures"),
    further_sections=LateFunction("pounding_cli.questions.run.figures:further_sections"),
)
"""`pound run`."""
