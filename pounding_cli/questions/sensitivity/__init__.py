"""`pound sensitivity`."""

from __future__ import annotations

from pounding_cli.questions.question import LateFunction, Question
from pounding_cli.questions.sensitivity.spec import SensitivitySpec
from pounding_cli.questions.sensitivity.tables import COLUMNS_BY_TABLE
from pounding_cli.study.schema.study import StudySection

QUESTION = Question(
    name="sensitivity",
    ask=LateFunction("pounding_cli.questions.sensitivity.question:Sensitivity"),
    section=StudySection("sensitivity", SensitivitySpec, "settings of `pound sensitivity`"),
    tables=COLUMNS_BY_TABLE,
    sentences=LateFunction("pounding_cli.questions.sensitivity.words:list_sentences"),
    shown_tables=LateFunction("pounding_cli.questions.sensitivity.words:list_tables"),
    notes=LateFunction("pounding_cli.questions.sensitivity.words:list_notes"),
    figures=LateFunction("pounding_cli.questions.sensitivity.figures:list_figures"),
    cite=LateFunction("pounding_cli.questions.sensitivity.words:list_references"),
    is_sampled=True,
)
