"""The gaps that the cases of a study write, in a results file, whose own case has nothing between the buildings."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from pounding_cli.results.arrays import ResultArrays
    from pounding_cli.results.results import ResultTables
    from pounding_cli.study import Study

_NAME = "study_gaps"


class WrittenGap(NamedTuple):
    """A gap that a case writes.

    pair : number of the pair of neighbours, from 1; None of every pair
    gap : whatever the sweep has in its place [m]
    """

    pair: int | None
    gap: float


def add_written_gaps(arrays: ResultArrays, study: Study) -> ResultArrays:
    """Return arrays with the gaps that the cases of a study write, which `read_written_gaps` reads back."""
    from pounding_cli.study.construct.complete_links import complete_links  # here: results are printed without a study

    gaps = {}
    for name, case in study.spec.cases.items():
        links = complete_links(name, case, study.spec.impact)
        written = [WrittenGap(link.spec.pair, link.values["gap"]) for link in links if "gap" in link.values]
        gaps[name] = list(dict.fromkeys(written))
    return arrays.with_text(_NAME, json.dumps(gaps), "pairs and gaps that the cases of the study write, SI; JSON")


def read_written_gaps(results: ResultTables) -> dict[str, list[WrittenGap]]:
    """Return the different gaps that every case of the study writes, by its name; none of a case without links."""
    gaps = json.loads(str(results.values(_NAME).item()))
    return {name: [WrittenGap(*each) for each in written] for name, written in gaps.items()}
