"""`pound gap`: how wide must a gap be, and are the gaps of the cases enough?"""

from __future__ import annotations

from pounding_cli.questions.gap.spec import GapSpec
from pounding_cli.questions.gap.tables import COLUMNS_BY_TABLE
from pounding_cli.questions.question import LateFunction, Question
from pounding_cli.study.schema.study import StudySection

QUESTION = Question(
    name="gap",
    ask=LateFunction("pounding_cli.questions.gap.question:Gap"),
    section=StudySection(
        "gap",
        GapSpec,
        "settings of `pound gap`; gaps stand in cases, `cases: {near: {link: pounding, gap: 5 cm}}`",
        {"percentiles": "84 %"},
    ),
    tables=COLUMNS_BY_TABLE,
    sentences=LateFunction("pounding_cli.questions.gap.sentences:list_sentences"),
    shown_tables=LateFunction("pounding_cli.questions.gap.words:list_tables"),
    notes=LateFunction("pounding_cli.questions.gap.words:list_notes"),
    figures=LateFunction("pounding_cli.questions.gap.figures:list_figures"),
    cite=LateFunction("pounding_cli.questions.gap.words:list_references"),
)
"""`pound gap`."""
