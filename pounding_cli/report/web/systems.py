"""The page of `pound connector` and `pound wall` files: figure, the paper's statements, numbers, study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from pounding_cli.report.columns import Shown
from pounding_cli.report.web.data import MOST_ROWS, as_json, packed
from pounding_cli.report.web.page import PAGE, render
from pounding_cli.report.web.pictures import from_files

MOST_POINTS = 200
"""Points of a sweep in the table of statements; numbers.csv has them all."""


def write_system_page(
    title: str,
    study: str,
    folder: Path,
    claims: Sequence[Mapping[str, Any]],
    convergence: Sequence[str],
    figures: Mapping[Path, str],
    numbers: pd.DataFrame,
    looks: Mapping[str, Shown],
) -> Path:
    """Write `report.html` of a system without time histories of groups.

    claims : dicts with point, paper, found, holds
    convergence : sentences on what settles as the mesh is refined
    figures : files already drawn and their headings, the main one first
    numbers : one row a point of the sweep; looks : of its columns
    """
    table = packed("Numbers", numbers.head(MOST_ROWS), len(numbers), looks=looks)
    drawn = from_files(list(figures), {file.stem: (words, words) for file, words in figures.items()}, title)
    statements = list(dict.fromkeys(str(claim["paper"]) for claim in claims))
    points: dict[str, dict[str, Mapping[str, Any]]] = {}
    for claim in claims:
        points.setdefault(str(claim["point"]), {})[str(claim["paper"])] = claim
    rows = [(point or "as given", [here.get(one) for one in statements]) for point, here in points.items()]
    content = {
        "title": title,
        "data": as_json({"tables": {"numbers": table}}),
        "statements": statements,
        "claims": rows[:MOST_POINTS],
        "convergence": convergence,
        "main": drawn[:1],
        "pictures": drawn[1:],
        "carried": len(numbers.head(MOST_ROWS)),
        "left": max(len(numbers) - MOST_ROWS, 0),
        "study": study,
    }
    return render(folder / PAGE, "system.html.j2", content)
