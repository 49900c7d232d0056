"""`pound screen`: how often does each pair of neighbours of a street strike?"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pounding_cli.errors import InputError, Problem
from pounding_cli.questions.question import Question, StudyQuestion
from pounding_cli.questions.screen.tables import COLUMNS_BY_TABLE

if TYPE_CHECKING:
    from pounding_cli.report.document import Picture, Section
    from pounding_cli.results.results import ResultTables
    from pounding_cli.study import Study
    from pounding_cli.tables import Table


def _ask(study: Study) -> StudyQuestion:
    """Refuse a study: a screen asks of a table.  Raises InputError."""
    hint = "write `pound screen street.csv`; `pound gap` asks the same of one study"
    raise InputError(Problem("a screen asks of a table of neighbours, not of a study", hint, study.file))


def _sentences(results: ResultTables) -> Sequence[str]:
    from pounding_cli.questions.screen.words import list_sentences

    return list_sentences(results)


def _shown_tables(results: ResultTables) -> Sequence[Table]:
    from pounding_cli.questions.screen.words import list_tables

    return list_tables(results)


def _notes(results: ResultTables) -> Sequence[str]:
    from pounding_cli.questions.screen.words import list_notes

    return list_notes(results)


def _figures(results: ResultTables) -> Sequence[Picture]:
    from pounding_cli.questions.screen.figures import list_figures

    return list_figures(results)


def _scope(results: ResultTables) -> str:
    from pounding_cli.questions.screen.words import describe_scope

    return describe_scope(results)


def _further_sections(results: ResultTables) -> Sequence[Section]:
    """Return what `pound gap` says of the worst pair."""
    from pounding_cli.questions.gap.figures import list_figures
    from pounding_cli.questions.gap.words import list_sentences
    from pounding_cli.questions.screen.tables import SCREEN_TABLE
    from pounding_cli.report.document import Section

    worst = results.answer(SCREEN_TABLE).frame.iloc[0]
    lead = f"{worst['pair']}: the sections below are those of its study, as `pound gap` answers it."
    return [Section("The worst pair", [lead, *list_sentences(results)], pictures=list_figures(results))]


def _cite(resolved: Mapping[str, Any]) -> Iterable[tuple[str, str]]:
    from pounding_cli.questions.gap.words import list_references

    return list_references(resolved)


QUESTION = Question(
    name="screen",
    ask=_ask,
    tables=COLUMNS_BY_TABLE,
    sentences=_sentences,
    shown_tables=_shown_tables,
    notes=_notes,
    figures=_figures,
    further_sections=_further_sections,
    scope=_scope,
    cite=_cite,
)
"""`pound screen`."""
