"""The figures of a run, and the sections of its page behind the answer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from pounding_cli.questions.statements import STATEMENTS
from pounding_cli.report.document import Picture, Section
from pounding_cli.report.evidence import Evidence, find_nominal
from pounding_cli.report.figures import list_loops, list_profiles
from pounding_cli.report.sweep import SweepChoice, list_sweep_pictures
from pounding_cli.report.widgets import build_explorer_data, build_player_scenes

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables


def list_figures(results: ResultTables) -> list[Picture]:
    """Return the figure of the main building."""
    return list_profiles(find_nominal(results))[:1]


def further_sections(results: ResultTables, choice: SweepChoice | None = None) -> list[Section]:
    """Return the sections of the page behind the answer.

    choice : which figures are drawn over a sweep; the usual ones unless given
    """
    evidence = find_nominal(results)
    swept = list_sweep_pictures(results, evidence, choice)
    scenes = build_player_scenes(results)
    chart = build_explorer_data(results, evidence)
    explorer: dict[str, Any] = {"widget": "explorer", "data": chart} if chart["quantities"] else {}
    sentences = _describe_kept(results, evidence, scenes)
    return [
        *([Section("Over the sweep", pictures=swept)] if swept else []),
        Section("Look around", [chart["cut"]], **explorer),
        Section("Moving buildings", sentences, widget="player", data={"scenes": scenes}),
        Section("Figures", pictures=[*list_profiles(evidence)[1:], *list_loops(evidence)]),
        *_list_statement_sections(results),
    ]


def _list_statement_sections(results: ResultTables) -> list[Section]:
    """Return the section with every number of the statements; none where the study has no statements."""
    if STATEMENTS not in results.answers:
        return []
    return [Section("Numbers of the statements", (), [results.answer(STATEMENTS)], folded=True)]


def _describe_kept(results: ResultTables, evidence: Evidence, scenes: Sequence[Any]) -> list[str]:
    """Return a sentence where no time history is kept, or where a page has no room for all.

    scenes : those that the page has
    """
    kept = len(results.histories())
    if not kept:
        key = f"keep: {{histories: {{cases: [{evidence.cases[0]}], records: [{evidence.names('record')[0]}]}}}}"
        return [f"No time history is kept. To see moving buildings, add `{key}` to the study and run it again."]
    if len(scenes) == kept:
        return []
    count = f"{len(scenes)} of {kept} kept time histories have room here"
    return [f"{count}: keep fewer, or longer steps, `every: 20 ms`."]
