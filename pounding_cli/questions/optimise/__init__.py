"""`pound optimise`."""

from __future__ import annotations

from pounding_cli.questions.optimise.spec import OptimiseSpec
from pounding_cli.questions.optimise.tables import COLUMNS_BY_TABLE
from pounding_cli.questions.question import LateFunction, Question
from pounding_cli.study.schema.study import StudySection

QUESTION = Question(
    name="optimise",
    ask=LateFunction("pounding_cli.questions.optimise.question:Optimise"),
    section=StudySection("optimise", OptimiseSpec, "settings of `pound optimise`"),
    tables=COLUMNS_BY_TABLE,
    sentences=LateFunction("pounding_cli.questions.optimise.words:list_sentences"),
    shown_tables=LateFunction("pounding_cli.questions.optimise.words:list_tables"),
    notes=LateFunction("pounding_cli.questions.optimise.words:list_notes"),
    figures=LateFunction("pounding_cli.questions.optimise.figures:list_figures"),
    cite=LateFunction("pounding_cli.questions.optimise.words:list_references"),
    is_sampled=True,
)
