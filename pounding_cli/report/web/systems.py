"""The page of `pound connector` and `pound wall` files: claims, figures, numbers, study, versions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from pounding_cli.report.web.data import MOST_ROWS, as_json, packed
from pounding_cli.report.web.page import PAGE, render
from pounding_cli.report.web.pictures import from_files


def write_system_page(
    title: str,
    study: str,
    folder: Path,
    claims: Sequence[Mapping[str, Any]],
    figures: Sequence[Path],
    numbers: pd.DataFrame,
) -> Path:
    """Write `report.html` of a system without time histories of groups.

    claims : dicts with point, paper, found, holds
    figures : files already drawn; the PNG ones are shown
    numbers : one row a point of the sweep
    """
    table = packed("Numbers", numbers.head(MOST_ROWS), len(numbers))
    drawn = from_files([file for file in figures if file.suffix == ".png"], {}, title)
    content = {
        "title": title,
        "data": as_json({"tables": {"numbers": table}}),
        "claims": claims,
        "pictures": drawn,
        "study": study,
    }
    return render(folder / PAGE, "system.html.j2", content)
