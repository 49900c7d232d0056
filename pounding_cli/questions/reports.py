"""The report of a results file: what its question says of it, and what stands behind every answer."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from pounding_cli.errors import InputError, Issue
from pounding_cli.questions import load_question
from pounding_cli.report.background import build_background, describe_scope, tell_notes
from pounding_cli.report.document import Report, Section
from pounding_cli.report.evidence import find_nominal
from pounding_cli.results.plausible import implausible_results

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pounding_cli.report.sweep import SweepChoice
    from pounding_cli.results.results import ResultTables


def build_report(results: ResultTables, choice: SweepChoice | None = None) -> Report:
    """Return the report of a results file.

    Parameters
    ----------
    results : of any command
    choice : for `pound run` over a sweep: which figures are drawn; the usual ones unless given

    Raises
    ------
    InputError : what is chosen is not there, or the file has no figures over a sweep
    """
    question = load_question(results.workflow)
    options: dict[str, Any] = {}
    if choice is not None:
        if reason := find_no_sweep(results):
            message = f"there are no figures over a sweep to choose: {reason}"
            raise InputError(Issue((), message, "leave `choice` out", file=str(results.path)))
        options = {"choice": choice}
    evidence = find_nominal(results.first_sample() if question.is_sampled else results)
    sample_keys = results.swept[-1] if question.is_sampled else ()
    of_file = "" if question.scope is None else "In the time histories of the file: "
    implausible = (
        replace(each, message=f"{of_file}{each.message}") for each in implausible_results(results, sample_keys)
    )
    notes = tell_notes([*question.notes(results), *implausible], results.accepted)
    answer = Section("", question.sentences(results), question.shown_tables(results), notes=notes)

    def more() -> list[Section]:
        from pounding_cli.report.from_above import list_plan_sections

        return [
            *list_plan_sections(evidence),
            *question.further_sections(results, **options),
            *build_background(results, evidence, question.is_sampled),
        ]

    def sketch() -> Figure:
        from pounding_cli.report.figures import draw_sketch

        return draw_sketch(evidence)

    return Report(
        results.title,
        answer,
        lambda: question.figures(results),
        more,
        describe_scope(results, evidence, question.is_sampled) if question.scope is None else question.scope(results),
        sketch if question.scope is None else None,
        results.study_text,
    )


def find_no_sweep(results: ResultTables) -> str:
    """Return why a results file has no figures over a sweep; "" where it has some."""
    if results.workflow != "run":
        return f"the file holds the answer of `pound {results.workflow}`"
    return "" if results.axes else "its study sweeps nothing"
