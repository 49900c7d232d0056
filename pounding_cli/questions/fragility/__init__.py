"""`pound fragility`."""

from __future__ import annotations

from pounding_cli.questions.fragility.spec import FragilitySpec
from pounding_cli.questions.fragility.tables import COLUMNS_BY_TABLE
from pounding_cli.questions.question import LateFunction, Question
from pounding_cli.study.schema.study import StudySection

QUESTION = Question(
    name="fragility",
    ask=LateFunction("pounding_cli.questions.fragility.question:Fragility"),
    section=StudySection("fragility", FragilitySpec, "settings of `pound fragility`"),
    tables=COLUMNS_BY_TABLE,
    sentences=LateFunction("pounding_cli.questions.fragility.words:list_sentences"),
    shown_tables=LateFunction("pounding_cli.questions.fragility.words:list_tables"),
    notes=LateFunction("pounding_cli.questions.fragility.words:list_notes"),
    figures=LateFunction("pounding_cli.questions.fragility.figures:list_figures"),
    cite=LateFunction("pounding_cli.questions.fragility.words:list_references"),
)
