"""`pound fragility`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pounding_cli.questions.fragility.spec import FragilitySpec
from pounding_cli.questions.fragility.tables import TABLES
from pounding_cli.questions.question import Question, StudyQuestion
from pounding_cli.study.schema import Section

if TYPE_CHECKING:
    from pounding_cli.report.document import Picture
    from pounding_cli.results.results import ResultTables
    from pounding_cli.study import Study
    from pounding_cli.tables import Table


def _ask(study: Study) -> StudyQuestion:
    from pounding_cli.questions.fragility.question import Fragility

    return Fragility(study)


def _sentences(results: ResultTables) -> Sequence[str]:
    from pounding_cli.questions.fragility.words import list_sentences

    return list_sentences(results)


def _shown_tables(results: ResultTables) -> Sequence[Table]:
    from pounding_cli.questions.fragility.words import list_tables

    return list_tables(results)


def _notes(results: ResultTables) -> Sequence[str]:
    from pounding_cli.questions.fragility.words import list_notes

    return list_notes(results)


def _figures(results: ResultTables) -> Sequence[Picture]:
    from pounding_cli.questions.fragility.figures import list_figures

    return list_figures(results)


def _cite(resolved: Mapping[str, Any]) -> Iterable[tuple[str, str]]:
    from pounding_cli.questions.fragility.words import list_references

    return list_references(resolved)


QUESTION = Question(
    name="fragility",
    ask=_ask,
    section=Section("fragility", FragilitySpec, "settings of `pound fragility`"),
    tables=TABLES,
    sentences=_sentences,
    shown_tables=_shown_tables,
    notes=_notes,
    figures=_figures,
    cite=_cite,
)
