"""The figures of a run, and the sections of its page behind the answer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pounding_cli.report.document import Picture, Section
from pounding_cli.report.evidence import find_nominal
from pounding_cli.report.figures import loop_pictures, profiles
from pounding_cli.report.sweep import SweepChoice, sweep_pictures
from pounding_cli.report.widgets import explored, players

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables


def list_figures(results: ResultTables) -> list[Picture]:
    """Return the figure of the main building."""
    return profiles(find_nominal(results))[:1]


def further_sections(results: ResultTables, choice: SweepChoice | None) -> list[Section]:
    """Return the sections of the page behind the answer.

    choice : which figures are drawn over a sweep
    """
    shown = find_nominal(results)
    swept = sweep_pictures(results, shown, choice)
    kept, scenes, said = len(results.histories()), players(results), list[str]()
    if not kept:
        keep = f"keep: {{histories: {{cases: [{shown.cases[0]}], records: [{shown.names('record')[0]}]}}}}"
        said = [f"No scene is kept over time. To see moving buildings, add `{keep}` to the study and run it again."]
    elif len(scenes) < kept:
        said = [f"{len(scenes)} of {kept} kept scenes have room here: keep fewer, or longer steps, `every: 20 ms`."]
    chart = explored(results, shown)
    drawn: dict[str, Any] = {"widget": "explorer", "data": chart} if chart["quantities"] else {}
    return [
        *([Section("Over the sweep", pictures=swept)] if swept else []),
        Section("Look around", [chart["cut"]], **drawn),
        Section("Moving buildings", said, widget="player", data={"scenes": scenes}),
        Section("Figures", pictures=[*profiles(shown)[1:], *loop_pictures(shown)]),
    ]
