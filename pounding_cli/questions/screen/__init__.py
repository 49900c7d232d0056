"""`pound screen`: how often does each pair of neighbours of a street strike?"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pounding_cli.errors import InputError, Issue
from pounding_cli.questions.question import LateFunction, Question, StudyQuestion
from pounding_cli.questions.screen.tables import COLUMNS_BY_TABLE

if TYPE_CHECKING:
    from pounding_cli.report.document import Section
    from pounding_cli.results.results import ResultTables
    from pounding_cli.study import Study


def _ask(study: Study) -> StudyQuestion:
    """Refuse a study: a screen asks of a table.  Raises InputError."""
    hint = "write `pound screen street.csv`; `pound gap` asks the same of one study"
    raise InputError(Issue((), "a screen asks of a table of neighbours, not of a study", hint, file=study.file))


def _further_sections(results: ResultTables) -> Sequence[Section]:
    """Return what `pound gap` says of the worst pair."""
    from pounding_cli.questions.gap.figures import list_figures
    from pounding_cli.questions.gap.sentences import list_sentences
    from pounding_cli.questions.screen.tables import SCREEN_TABLE
    from pounding_cli.report.document import Section

    worst = results.answer(SCREEN_TABLE).frame.iloc[0]
    lead = f"{worst['pair']}: the sections below are those of its study, as `pound gap` answers it."
    return [Section("The worst pair", [lead, *list_sentences(results)], pictures=list_figures(results))]


QUESTION = Question(
    name="screen",
    ask=_ask,
    tables=COLUMNS_BY_TABLE,
    sentences=LateFunction("pounding_cli.questions.screen.words:list_sentences"),
    shown_tables=LateFunction("pounding_cli.questions.screen.words:list_tables"),
    notes=LateFunction("pounding_cli.questions.screen.words:list_notes"),
    figures=LateFunction("pounding_cli.questions.screen.figures:list_figures"),
    further_sections=_further_sections,
    scope=LateFunction("pounding_cli.questions.screen.words:describe_scope"),
    cite=LateFunction("pounding_cli.questions.gap.words:list_references"),
)
"""`pound screen`."""
