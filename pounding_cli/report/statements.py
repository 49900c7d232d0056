"""What the paper says of a model of its own, judged at every point of the sweep."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from pounding_cli.report.web.story import Grid
from pounding_cli.store import Results
from pounding_cli.store.points import read_points

Statement = tuple[str, Callable[[Mapping[str, Any]], tuple[bool, str]]]
"""A sentence of the paper, and (values of a point) -> whether it holds, and what was found in words."""

CAPTION = "The paper’s statements at every point"

MOST_POINTS = 200
"""Points of a sweep at which they are judged."""


def judged(results: Results, statements: Sequence[Statement]) -> Grid:
    """Points down, sentences across."""
    rows = []
    for point in read_points(results, MOST_POINTS):
        verdicts = [judge(point.values) for _, judge in statements] if point.values["status"] == "done" else []
        found = [f"{'holds' if holds else 'does not hold'}: {words}" for holds, words in verdicts]
        rows.append([point.label or "as given", *(found or ["–"] * len(statements))])
    return Grid(["point", *(sentence for sentence, _ in statements)], rows)
