"""`pound fragility`."""

from __future__ import annotations

from pounding_cli.questions.fragility.spec import FragilitySpec
from pounding_cli.questions.fragility.tables import TABLES
from pounding_cli.questions.question import LateFunction, Question
from pounding_cli.study.schema import Section

QUESTION = Question(
    name="fragility",
    ask=LateFunction("pounding_cli.questions.fragility.question:Fragility"),
    section=Section("fragility", FragilitySpec, "settings of `pound fragility`"),
    tables=TABLES,
    sentences=LateFunction("pounding_cli.questions.fragility.words:list_sentences"),
    shown_tables=LateFunction("pounding_cli.questions.fragility.words:list_tables"),
    notes=LateFunction("pounding_cli.questions.fragility.words:list_notes"),
    figures=LateFunction("pounding_cli.questions.fragility.figures:list_figures"),
    cite=LateFunction("pounding_cli.questions.fragility.words:list_references"),
)
